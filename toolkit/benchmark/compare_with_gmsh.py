#!/usr/bin/env python3
"""The same random cells through bound_jacobian_benchmark and Gmsh's plugin AnalyseMeshQuality: cells per second, and
whether the verdicts agree. Gmsh knows no certificate: it takes the smallest Jacobian determinant within a tolerance.

usage: compare_with_gmsh.py BENCHMARK [CELLS]      on a quiet machine, with python3-gmsh
"""
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import gmsh

# Not linear tetrahedra: for those the plugin answers 1 without looking.
CASES = [("tetrahedron", p, a) for p, a in ((2, 0.5), (3, 0.4), (4, 0.25))] + \
        [("hexahedron", p, a) for p, a in ((1, 0.5), (2, 0.3), (3, 0.2), (4, 0.1))]


def ours(benchmark, path, name, degree, cells, amplitude):
    """seconds, and per cell (verdict, lower bound, value that is reached)"""
    lines = subprocess.run([benchmark, "msh", str(path), name, str(degree), str(cells), str(amplitude)], check=True,
                           capture_output=True, text=True).stdout.splitlines()
    cells = [line.split() for line in lines[1:]]
    return float(lines[0].split()[0]), [(int(v), float(low), float(reached)) for v, low, reached in cells]


def theirs(path):
    """seconds, and per cell the smallest determinant, with respect to Gmsh's own reference element"""
    gmsh.clear()
    gmsh.open(str(path))
    plugin = gmsh.plugin
    for option, value in (("JacobianDeterminant", 1), ("CreateView", 1), ("Recompute", 1), ("DimensionOfElements", 3)):
        plugin.setNumber("AnalyseMeshQuality", option, value)
    start = time.perf_counter()
    plugin.run("AnalyseMeshQuality")
    seconds = time.perf_counter() - start
    values = {}
    for tag in gmsh.view.getTags():
        name = gmsh.option.getString(f"View[{gmsh.view.getIndex(tag)}].Name")
        if "min" in name.lower():
            _, tags, data, _, _ = gmsh.view.getModelData(tag, 0)
            values = {t: d[0] for t, d in zip(tags, data)}
    return seconds, [values[t] for t in sorted(values)]


def main():
    benchmark = sys.argv[1]
    cells = int(sys.argv[2]) if len(sys.argv) > 2 else 10000
    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    gmsh.option.setNumber("General.NumThreads", 1)
    print(f"{'cells':16} {'ours /s':>10} {'gmsh /s':>10} {'valid':>7} {'undecided':>9} {'agree':>7}  disagree, and how")
    with tempfile.TemporaryDirectory() as folder:
        for name, degree, amplitude in CASES:
            path = Path(folder) / "cells.msh"
            our_seconds, bounds = ours(benchmark, path, name, degree, cells, amplitude)
            their_seconds, minima = theirs(path)
            agree = sum((v == 0) == (m > 0) for (v, _, _), m in zip(bounds, minima) if v != 2)
            odd = [(v, low, reached, m) for (v, low, reached), m in zip(bounds, minima) if v != 2 and (v == 0) != (m > 0)]
            valid = sum(v == 0 for v, _, _ in bounds)
            undecided = sum(v == 2 for v, _, _ in bounds)
            print(f"{name + ' p=' + str(degree):16} {cells / our_seconds:10.0f} {cells / their_seconds:10.0f} {valid:7} "
                  f"{undecided:9} {agree:7}  {len(odd)} {odd[:2]}")


if __name__ == "__main__":
    main()
