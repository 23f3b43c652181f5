#!/usr/bin/python3
"""Checks the files of write_hopr_samples against HOPR's specification, and their nodes against the polynomial that curved
them; a file that HOPR itself wrote passes the same check, and damaged files do not.

usage: hopr_reader_test.py WRITE_HOPR_SAMPLES FOLDER [HOPR_FILE.h5] [MESH ...]
"""
import shutil
import subprocess
import sys
from pathlib import Path

import h5py
import numpy as np

from hopr_checker import Checker, lattice

CORNERS = {"tetrahedron": 4, "pyramid": 5, "prism": 6, "hexahedron": 8}


def polynomial_map(degree, xi):
    x, y, z = np.asarray(xi).T
    return np.stack((
        x + 0.2 * y + 0.05 * (0.3 + 0.5 * x - 0.4 * y + 0.3 * z) ** degree,
        y - 0.1 * z + 0.05 * (0.6 - 0.2 * x + 0.3 * y + 0.5 * z) ** degree,
        2 * z + 0.1 * x + 0.05 * (0.1 + 0.4 * x + 0.5 * y - 0.3 * z) ** degree), axis=1)


def check_positions(path, name, degree):
    with h5py.File(path) as file:
        error = np.abs(file["NodeCoords"][()] -
                       polynomial_map(degree, np.array(lattice(CORNERS[name], degree)) / degree)).max()
    return [] if error < 1e-15 * 10 else [f"nodes are off by {error:.1e}"]


def damaged_copies(path, folder):
    """files with one number of one array changed: each breaks a rule"""
    for array, place, change in (("SideInfo", (8, 3), 1), ("SideInfo", (8, 1), 7), ("SideInfo", (2, 2), 1),
                                 ("GlobalNodeIDs", (0,), 1), ("ElemInfo", (1, 4), 1), ("ElemInfo", (0, 0), 1),
                                 ("NodeCoords", (3, 1), 0.25), ("ElemBarycenters", (1, 0), 0.5), ("BCType", (0, 3), 3),
                                 ("ElemCounter", (10, 1), 1)):
        copy = folder / f"damaged_{array}_{'_'.join(map(str, place))}.h5"
        shutil.copy(path, copy)
        with h5py.File(copy, "r+") as file:
            file[array][place] += change
        yield copy


def main():
    program, folder = sys.argv[1], Path(sys.argv[2])
    given = [Path(name) for name in sys.argv[3:] if Path(name).exists()]
    meshes, own = [m for m in given if m.suffix != ".h5"], [m for m in given if m.suffix == ".h5"]
    subprocess.run([program, str(folder)] + [str(m) for m in given], check=True)
    faults = {}
    for name in CORNERS:
        for degree in range(1, 7):
            path = folder / f"{name}_{degree}.h5"
            faults[path] = Checker(path).check() + check_positions(path, name, degree)
    for path in [*sorted(folder.glob("two_zones_*.h5")), *own, *(folder / f"mesh_{m.stem}.h5" for m in given)]:
        faults[path] = Checker(path).check()
    for path in damaged_copies(folder / "two_zones_2.h5", folder):
        faults[path] = [] if Checker(path).check() else ["is damaged, and the checker does not see it"]
    for path in own:  # what HOPR wrote, read and written again, is the same set of elements
        with h5py.File(path) as file, h5py.File(folder / f"mesh_{path.stem}.h5") as again:
            elements = [np.sort(f["NodeCoords"][()].reshape(f.attrs["nElems"][0], -1), axis=0) for f in (file, again)]
            if not np.array_equal(*elements):
                faults[path].append("elements differ after reading and writing")
            types = [sorted(map(tuple, f["BCType"][:, [0, 3]])) for f in (file, again)]
            names = [sorted(bytes(n).decode().strip() for n in f["BCNames"][()]) for f in (file, again)]
            if names[0] != names[1] or [t[0] == 1 for t in types[0]] != [t[0] == 1 for t in types[1]]:
                faults[path].append(f"boundary conditions differ after reading and writing: {names} {types}")
    bad = {path: messages for path, messages in faults.items() if messages}
    for path, messages in bad.items():
        print(path.name, *messages[:10], sep="\n  ")
    print(f"files checked: {len(faults)}, of HOPR itself: {len(own)}, meshes: {len(meshes)}")
    sys.exit(1 if bad else 0)


if __name__ == "__main__":
    main()
