"""Runs recurve-study on small meshes and the script that draws its figure: study_test.py PROGRAM PLOT_SCRIPT FOLDER.

The orders in the file must be those of formula (7) of the lines before them, and on spheres both methods must converge with
d + 1 at least, as the paper's Table 1 has it.
"""
import csv
import math
import os
import subprocess
import sys


def main():
    program, plot_script, folder = sys.argv[1:4]
    os.makedirs(folder, exist_ok=True)
    table, figure = os.path.join(folder, "study.csv"), os.path.join(folder, "study.png")
    for path in (table, figure):
        if os.path.exists(path):
            os.remove(path)
    subprocess.run([program, table, "3"], check=True)
    with open(table, newline="") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == 4 * 2 * 6 * 3, len(rows)
    for number, (coarse, fine) in enumerate(zip(rows, rows[1:])):
        if number % 3 == 2:
            assert not fine["order"], fine  # the coarsest of the next family, preset or degree
            continue
        assert (coarse["family"], coarse["preset"], coarse["d"]) == (fine["family"], fine["preset"], fine["d"])
        assert float(fine["h"]) < 0.6 * float(coarse["h"])
        order = math.log(float(fine["error"]) / float(coarse["error"])) / math.log(float(fine["h"]) / float(coarse["h"]))
        assert abs(order - float(fine["order"])) < 1e-3 * abs(order), (fine, order)
        if number % 3 == 1 and fine["family"].startswith("sphere"):  # the two densest
            assert order > int(fine["d"]) + 1 - 0.5, fine
    assert subprocess.run([program, os.path.join(folder, "none", "study.csv"), "2"], check=False).returncode == 1
    assert subprocess.run([program, table, "1"], check=False).returncode == 2
    subprocess.run([sys.executable, plot_script, table, figure], check=True)
    with open(figure, "rb") as file:
        assert file.read(8) == b"\x89PNG\r\n\x1a\n"
    print("study: all well")


main()
