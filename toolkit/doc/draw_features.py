#!/usr/bin/env python3
"""Draws the feature curves that the program finds on a mesh, without a display.

usage: draw_features.py MESH.cgns PICTURE.png [--program PROGRAM] [--patch NAME ...] [--at X Y Z] [--from X Y Z]
                        [--width W] [-- OPTION ...]

Runs `recurve features MESH.cgns -o curves.csv` with the options after --, and draws the boundary faces of the patches (names
or wildcards; default: all) seen along the direction from --from to --at, W wide, with their edges in grey and each feature
curve in a colour. Needs numpy, h5py, matplotlib and Pillow.
"""
import argparse
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
from matplotlib import colormaps
from PIL import Image

import render

PIXELS = 1200, 900
COLORS = 128  # of the picture: it stays small, and no colour of a curve turns grey
MARGIN = 12  # pixels around what is shown
HIDDEN = 1  # pixels by which a line may lie behind the surface and is still drawn


class Feature_picture(render.Picture):
    def draw_wires(self, segments, color, radius):
        """segments[segment, end, xyz] as lines of 2 radius + 1 pixels, where the surface does not hide them."""
        seen = self.project(segments.reshape(-1, 3)).reshape(-1, 2, 3)
        lengths = np.abs(seen[:, 1, :2] - seen[:, 0, :2]).max(axis=1)
        for (a, b), length in zip(seen, lengths):
            if (np.maximum(a, b)[:2] < 0).any() or (np.minimum(a, b)[:2] > (self.columns, self.rows)).any():
                continue
            way = np.linspace(0, 1, int(length) + 2)[:, None]
            points = a + way * (b - a)
            for dx in range(-radius, radius + 1):
                for dy in range(-radius, radius + 1):
                    column, row = (points[:, :2] + (dx, dy)).astype(int).T
                    inside = (column >= 0) & (column < self.columns) & (row >= 0) & (row < self.rows)
                    column, row, z = column[inside], row[inside], points[inside, 2]
                    front = z + (3 * radius + HIDDEN) * render.SUPERSAMPLING > self.depth[row, column]
                    self.color[row[front], column[front]] = color

    def save_small(self, path):
        s = render.SUPERSAMPLING
        picture = self.color.reshape(self.rows // s, s, self.columns // s, s, 3).mean(axis=(1, 3))
        rows, columns = np.nonzero((picture < 1).any(axis=2))
        shown = picture[max(rows.min() - MARGIN, 0):rows.max() + MARGIN, max(columns.min() - MARGIN, 0):columns.max() + MARGIN]
        image = Image.fromarray((255 * np.clip(shown, 0, 1)).astype(np.uint8))
        image.quantize(COLORS, dither=Image.Dither.NONE).save(path, optimize=True)


def find_curves(options):
    """The critical edges as segments[edge, end, xyz], and the number of the curve of each."""
    with tempfile.TemporaryDirectory() as folder:
        table = Path(folder) / "curves.csv"
        subprocess.run([options.program, "features", options.mesh, "-o", table, "--quiet", *options.options], check=True)
        rows = np.genfromtxt(table, delimiter=",", skip_header=1).reshape(-1, 7)
    return rows[:, :6].reshape(-1, 2, 3), rows[:, 6].astype(int)


def edges_of(faces):
    """faces[face, corner, xyz] -> segments[edge, end, xyz]"""
    return np.stack([faces, np.roll(faces, -1, axis=1)], axis=2).reshape(-1, 2, 3)


def main():
    arguments = sys.argv[1:]
    split = arguments.index("--") if "--" in arguments else len(arguments)
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("mesh", type=Path)
    parser.add_argument("picture", type=Path)
    parser.add_argument("--program", default="recurve")
    parser.add_argument("--patch", nargs="+", default=["*"])
    parser.add_argument("--at", nargs=3, type=float)
    parser.add_argument("--from", nargs=3, type=float)
    parser.add_argument("--width", type=float)
    options = parser.parse_args(arguments[:split])
    options.options = arguments[split + 1:]

    blocks = render.read_faces(options.mesh, options.patch)
    render.fit_view(blocks, options)
    picture = Feature_picture(options.at, getattr(options, "from"), options.width, PIXELS)
    for corners, _, nodes in blocks:
        faces = nodes[:, :corners]
        for first in range(1, corners - 1):
            picture.draw_triangles(faces[:, [0, first, first + 1]])
    for corners, _, nodes in blocks:
        picture.draw_wires(edges_of(nodes[:, :corners]), (0.45, 0.50, 0.56), 0)
    segments, curves = find_curves(options)
    colors = np.delete(colormaps["tab10"](np.arange(10))[:, :3], 7, axis=0)  # without its grey
    for curve in np.unique(curves):
        picture.draw_wires(segments[curves == curve], colors[curve % len(colors)], 2)
    picture.save_small(options.picture)


if __name__ == "__main__":
    main()
