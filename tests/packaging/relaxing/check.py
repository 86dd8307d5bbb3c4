"""Check the contract of the gel, and of a skin on it."""

import pellicle as pl
from pellicle.testing import check_kernel

gel = pl.kernel("gel", reduced_modulus="10 kPa", time="1 s")
check_kernel(gel)
check_kernel(pl.kernel("coated", tension="50 mN/m", substrate=gel))
