#!/usr/bin/env python3
"""Draws the figure of the error study: plot_study.py study.csv study.png

One panel per family of meshes; error against mean edge length, both logarithmic; the paper's method dashed, the default
solid; one colour per degree d.
"""
import csv
import sys
from collections import defaultdict

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
from matplotlib.ticker import NullFormatter


def read(path):
    series = defaultdict(list)
    with open(path, newline="") as file:
        for row in csv.DictReader(file):
            series[row["family"], row["preset"], int(row["d"])].append((float(row["h"]), float(row["error"])))
    return series


def main():
    series = read(sys.argv[1])
    families = list(dict.fromkeys(key[0] for key in series))
    figure, panels = plt.subplots(1, len(families), figsize=(4.2 * len(families), 5), squeeze=False, sharey=True)
    for panel, family in zip(panels[0], families):
        for (name, preset, d), points in series.items():
            if name != family:
                continue
            sizes, errors = zip(*sorted(points))
            panel.loglog(sizes, errors, "o--" if preset == "paper" else "o-", color=f"C{d - 1}", markersize=4,
                         alpha=0.6 if preset == "paper" else 1, label=f"d = {d}, {preset}")
        panel.set_title(family)
        panel.set_xlabel("mean edge length")
        panel.xaxis.set_minor_formatter(NullFormatter())
        panel.grid(True, which="both", alpha=0.3)
    panels[0][0].set_ylabel("largest distance from the exact surface")
    panels[0][-1].legend(fontsize=7)
    figure.tight_layout()
    figure.savefig(sys.argv[2], dpi=80)


if __name__ == "__main__":
    main()
