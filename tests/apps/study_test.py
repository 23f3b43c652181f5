"""Runs recurve-study on small meshes and the script that draws its figure: study_test.py PROGRAM PLOT_SCRIPT FOLDER.

The orders in the file must be those of formula (7) of the lines before them, and the paper's method must converge with
d + 1 at least.
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
    subprocess.run([program, table, "2"], check=True)
    with open(table, newline="") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == 4 * 2 * 6 * 2, len(rows)
    for coarse, fine in zip(rows[::2], rows[1::2]):
        assert (coarse["family"], coarse["preset"], coarse["d"]) == (fine["family"], fine["preset"], fine["d"])
        assert not coarse["order"] and float(fine["h"]) < 0.6 * float(coarse["h"])
        order = math.log(float(fine["error"]) / float(coarse["error"])) / math.log(float(fine["h"]) / float(coarse["h"]))
        assert abs(order - float(fine["order"])) < 1e-3 * abs(order), (fine, order)
        degree = int(fine["d"])
        if fine["preset"] == "paper" and fine["family"].startswith("sphere"):
            assert order > degree + 1 - 0.5, fine
    assert subprocess.run([program, os.path.join(folder, "none", "study.csv"), "2"], check=False).returncode == 1
    assert subprocess.run([program, table, "1"], check=False).returncode == 2
    subprocess.run([sys.executable, plot_script, table, figure], check=True)
    with open(figure, "rb") as file:
        assert file.read(8) == b"\x89PNG\r\n\x1a\n"
    print("study: all well")


main()
