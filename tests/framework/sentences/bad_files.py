"""Files that cannot be used, each wrong in one way, for the table of sentences."""

import pickle
from io import BytesIO
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import xarray as xr

from pellicle.results import storage

START = """
title = "bad input"
outputs = []
[grid]
points = 16
size = "0.4472 mm"
boundary = "free"
[kernel]
type = "tensed_membrane"
reduced_modulus = "10 kPa"
tension = "1 N/m"
[indenter]
type = "paraboloid"
radius = "1 mm"
[loading]
depth = ["10 um", "20 um"]
[solver]
type = "conjugate_gradient"
tolerance = 1e-6
[[corrections]]
type = "yastrebov"
"""
STICKY = """
grid = { points = 32, size = "0.6 mm", boundary = "free" }
kernel = { type = "half_space", reduced_modulus = "700 kPa" }
indenter = { type = "paraboloid", radius = "1 mm" }
interaction = { type = "jkr", work_of_adhesion = "50 mJ/m^2" }
loading = { depth = ["5 um", "0 um"] }
solver = { type = "active_set", tolerance = 1e-6 }
"""
DROPS = """
grid = { points = 16, size = "1 mm", boundary = "free" }
kernel = { type = "tensed_membrane", reduced_modulus = "10 kPa", tension = "0.1 N/m" }
[load]
type = "droplet"
surface_tension = "30 mN/m"
contact_angle = "60 degree"
radius = ["0.1 mm", "0.2 mm", "0.3 mm"]
"""
GOOD = np.zeros((16, 16))
NAN = np.where(np.eye(16) > 0, np.nan, 0.0)
HUGE = {"descr": "<f8", "fortran_order": False, "shape": (10**9, 10**9)}
BYTES = {
    "start.toml": START.encode(),
    "sticky.toml": STICKY.encode(),
    "drops.toml": DROPS.encode(),
    "nothing_presses.toml": DROPS.partition("[load]")[0].encode(),
    "vary.toml": f"{START}[study.vary]\n'kernel.tension' = [0, '10 mN/m']\n".encode(),
    "syntax.toml": b"title = 'a'\n[grid]\npoints = \n",
    "key_twice.toml": b"a = 1\na = 2\n",
    "table_twice.toml": b"[grid]\na = 1\n[b]\n[grid]\nb = 2\n",
    "dotted_table_twice.toml": b"[a]\nb.c = 1\n[a.b]\n",
    "unit_without_quotes.toml": b"[grid]\npoints = 3\nsize = 1 mm  # of the gel\n",
    "word_without_quotes.toml": b"type = sphere\n",
    "unit_without_quotes_in_a_list.toml": b'a = ["1 mm", 2 mm]\n',
    "unit_without_quotes_in_a_ramp.toml": b"depth = {start = 1 um, stop = 2 um, num = 3}\n",
    "Pythons_true.toml": b"a = True\n",
    "number_with_a_comma.toml": b"a = 1,5\n",
    "configuration_of_a_fit.toml": b"curves = ['a.csv']\nindenter.type = 'sphere'\n",
    "end_of_file.toml": b"a = 1\nb = [",
    "encoding.toml": b"title = '\xff\xfe'",
    "binary.toml": b"\x00\x01",
    "empty.toml": b"",
    "fit_unknown_key.toml": b"baselin = 1\nindenter = { type = 'sphere', radius = '5 um' }\n",
    "fit_no_indenter.toml": b"poissons_ratio = 0.4\n",
    "fit_unknown_type.toml": b'[indenter]\ntype = "ball"',
    "fit_force_for_length.toml": b'[indenter]\ntype = "sphere"\nradius = "5 N"',
    "fit_unknown_field.toml": b'[indenter]\ntype = "sphere"\nradios = 1',
    "fit_no_match.toml": b'curves = ["*.none"]\nindenter = "sphere"',
    "fit_no_deep_match.toml": b'curves = ["**.none"]\nindenter = "sphere"',
    "fit_no_radius.toml": b'curves = ["elastic.csv"]\nindenter = "sphere"',
    "fit_curve_is_a_number.toml": b'curves = [1]\nindenter = "sphere"',
    "fit_fix_is_a_number.toml": b'indenter = "sphere"\nfix = 1',
    "fit_fix_unknown.toml": b'indenter = "sphere"\n[fix]\nmodulus = 1',
    "fit_points_without_pool.toml": b'indenter = "sphere"\ncontact_points = true',
    "fit_kernel_without_modulus.toml": b'indenter = "sphere"\nkernel = "winkler"',
    "fit_unknown_executor.toml": b'indenter = "sphere"\nexecutor = "abacus"',
    "fit_one_value_per_file.toml": b'indenter = "sphere"\n[per_file]\nradius = "1 um"',
    "fit_of_a_grid.toml": b'indenter = "sphere"\n[grid]\npoints = 9',
    "fit_of_a_table.toml": b"position [um],force [nN]\n1,2\n",
    "brace.json": b"{",
    "list.json": b"[]",
    "no_files.json": b'{"configuration": {"indenter": "cone"}, "curves": []}',
    "ball.json": b'{"configuration": {"indenter": "ball", "curves": "a.csv"}, "curves": []}',
    "no_unit.csv": b"position,force\n1,2\n3,4\n",
    "volts.csv": b"position [um],force [V]\n1,2\n3,4\n",
    "nanometres.csv": b"position [um],force [nm]\n1,2\n3,4\n",
    "load.csv": b"position [um],load [nN]\n1,2\n3,4\n",
    "indentation.csv": b"Indentation (um),Force (nN)\n1,2\n3,4\n",
    "height.csv": b"height [um],force [nN]\n1,2\n3,4\n",
    "two_forces.csv": b"force [nN],force [nN]\n1,2\n3,4\n",
    "z_f.csv": b"Z,F\n1,2\n3,4\n",
    "z_f_f.csv": b"Z,F,F\n1,2,3\n4,5,6\n",
    "numbers.csv": b"1,2\n3,4\n",
    "powers.csv": b"position (um*9**9**9**9),force (nN)\n1,2\n",
    "blanks.csv": b"position" + b" " * 100_000 + b"(,force (nN)\n1,2\n",
    "blanks_first.csv": b" " * 100_000 + b"[[,force (nN)\n1,2\n",
    "endless_number.csv": b"position (um),force (nN)\n" + b"1" * 300_000 + b",2\n",
    "sheet.xlsx": b"PK\x03\x04\0",
    "sheet.ods": b"PK\x03\x04\0",
    "junk.mat": b"no such thing",
    "broken.mat": b"MATLAB 5.0 MAT-file" + bytes(200),
    "broken.h5": b"\x89HDF\r\n\x1a\nbroken",
    "classic.nc": b"CDF\x01",
    "list.csv": b"file,radius [um]\nelastic.csv,1\n,2\n",
    "empty.npy": b"",
    "junk.npy": b"junk junk",
    "pickle.npy": pickle.dumps(GOOD),
    "words.txt": b"one two\nthree",
    "blank.csv": b"# a\n\n",
    "ragged.txt": b"1 2\n3",
    "complex.txt": b"1+2j 2",
    "nan.txt": b"1 nan",
    "binary.txt": b"\xff\xfe1",
    "rows.csv": b"0;0;0\n0;0;0\n",
    "junk.csv": b"force [N]\n1\n",
    "empty.h5": b"",
    "junk.h5": b"junk",
}
ARRAYS: dict[str, Any] = {
    "good.npy": GOOD,
    "pickled.npy": np.array([[{}]], dtype=object),
    "nan.npy": NAN,
    "complex.npy": GOOD * 1j,
    "bool.npy": GOOD > 0,
    "1d.npy": GOOD[0],
    "no_cells.npy": GOOD[:0],
    "half.npy": GOOD[:8],
}
HDF5: dict[str, dict[str, Any]] = {
    "none.h5": {},
    "one.h5": {"top": GOOD},
    "two.h5": {"top": GOOD, "bottom": GOOD},
    "text.h5": {"a": "x"},
}


def make(folder: Path) -> None:
    """Write all files, beside two runs that can be solved."""
    for name in ("folder.npy", "folder.h5"):
        (folder / name).mkdir()
    for name, content in BYTES.items():
        (folder / name).write_bytes(content)
    for name, array in ARRAYS.items():
        np.save(folder / name, array, allow_pickle=True)
    for name, arrays in HDF5.items():
        with h5py.File(folder / name, "w") as file:
            for key, values in arrays.items():
                file[key] = values
    whole = BytesIO()
    np.save(whole, GOOD)
    (folder / "truncated.npy").write_bytes(whole.getvalue()[:-99])
    with (folder / "exabyte.npy").open("wb") as stream:
        np.lib.format.write_array_header_1_0(stream, HUGE)
    with (folder / "npz.npy").open("wb") as stream:
        np.savez(stream, GOOD)
    netcdf = xr.Dataset({"a": ("x", [1.0])})
    netcdf.to_netcdf(folder / "netcdf.h5", engine="h5netcdf")
    for name, version in (("newer.h5", 99), ("versionless.h5", "x")):
        header = {"schema_version": version, "configuration": "{}", "versions": "pellicle 9.0"}
        xr.Dataset(attrs=header).to_netcdf(folder / name, engine="h5netcdf")
    damaged = xr.Dataset({"pressure": (("step", "x", "y"), np.ones((1, 8, 8)))})
    storage.write(damaged.assign_attrs(configuration="{}", versions="0"), folder / "damaged.h5")
    (folder / "damaged.h5").write_bytes((folder / "damaged.h5").read_bytes()[:-500])
