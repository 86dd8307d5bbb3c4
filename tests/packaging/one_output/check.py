"""Check that the output keeps its contract."""

from pellicle_hottest import Hottest

from pellicle.testing import check_output

check_output(Hottest())
