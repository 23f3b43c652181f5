#!/usr/bin/env python3
"""Draws a mesh before and after curving, without a display.

usage: render.py CURVED.cgns DIRECTORY [--patch NAME ...] [--at X Y Z] [--from X Y Z] [--width W] [--section X WIDTH]
                 [--pixels COLUMNS ROWS]

Writes before.png and after.png: the boundary faces of the patches (names or wildcards; default: all), seen along the
direction from --from to --at, W wide, each element as its polynomial is, edges of elements in dark; by default the
whole of them from above and aside. "Before" are the same faces with straight sides between their corners, which
curving leaves where they were. With --section also section.png: the edges of the same patches in the plane y = 0
around (X, 0, 0), both meshes in one plot. Needs numpy, h5py and matplotlib.
"""
import argparse
import fnmatch
from pathlib import Path

import h5py
import matplotlib
import numpy as np

matplotlib.use("Agg")
from matplotlib import pyplot  # noqa: E402  (the backend comes first)

# CGNS element type -> (number of corners, degree)
FACE_TYPES = {5: (3, 1), 6: (3, 2), 26: (3, 3), 42: (3, 4), 7: (4, 1), 9: (4, 2), 28: (4, 3), 44: (4, 4)}
SUBDIVISIONS = 10  # of an element's edge: far finer than a pixel of curvature
SUPERSAMPLING = 2  # pixels per pixel of the picture, in each direction


def children(group, label):
    return [child for child in group.values()
            if isinstance(child, h5py.Group) and child.attrs.get("label", b"").decode().rstrip("\0") == label]


def name_of(group):
    return group.name.rsplit("/", 1)[1]


def data_of(group, child=None):
    return (group[child] if child else group)[" data"][()]


def element_numbers(condition):
    for key in ("PointList", "ElementList"):
        if key in condition:
            return data_of(condition, key).ravel()
    for key in ("PointRange", "ElementRange"):
        if key in condition:
            first, last = data_of(condition, key).ravel()
            return np.arange(first, last + 1)
    return np.array([], dtype=int)


def read_faces(path, patches):
    """(corners, degree, nodes[element, node, xyz]) for each type of face of the patches."""
    blocks = []
    with h5py.File(path, "r") as file:
        for zone in children(children(file, "CGNSBase_t")[0], "Zone_t"):
            grid = children(zone, "GridCoordinates_t")[0]
            points = np.stack([data_of(grid, "Coordinate" + axis) for axis in "XYZ"], axis=1)
            wanted = [np.array([], dtype=int)]
            for conditions in children(zone, "ZoneBC_t"):
                for condition in children(conditions, "BC_t"):
                    if any(fnmatch.fnmatchcase(name_of(condition), patch) for patch in patches):
                        wanted.append(element_numbers(condition))
            wanted = np.concatenate(wanted)
            for section in children(zone, "Elements_t"):
                kind = int(data_of(section).ravel()[0])
                if kind not in FACE_TYPES:
                    continue
                first, last = data_of(section, "ElementRange").ravel()
                nodes = data_of(section, "ElementConnectivity").reshape(last - first + 1, -1)
                chosen = np.isin(np.arange(first, last + 1), wanted)
                if chosen.any():
                    blocks.append((*FACE_TYPES[kind], points[nodes[chosen] - 1]))
    return blocks


def cgns_lattice(corners, degree):
    """Lattice points of a triangle or quadrangle in the order of CGNS: corners, edges, then inner rings."""
    corner_points = [(0, 0), (degree, 0), (0, degree)] if corners == 3 else \
        [(0, 0), (degree, 0), (degree, degree), (0, degree)]
    if degree == 0:
        return [(0, 0)]
    points = list(corner_points)
    for a, b in zip(corner_points, corner_points[1:] + corner_points[:1]):
        points += [tuple((a[i] * (degree - k) + b[i] * k) // degree for i in (0, 1)) for k in range(1, degree)]
    if corners == 3 and degree >= 3:
        points += [(i + 1, j + 1) for i, j in cgns_lattice(3, degree - 3)]
    if corners == 4 and degree >= 2:
        points += [(i + 1, j + 1) for i, j in ring_walk(degree - 2)]
    return points


def ring_walk(degree):
    """The inside of a quadrangle: the ring walked from its first corner, then the next ring."""
    if degree < 0:
        return []
    if degree == 0:
        return [(0, 0)]
    n = degree
    ring = [(k, 0) for k in range(n)] + [(n, k) for k in range(n)] + [(n - k, n) for k in range(n)] + \
        [(0, n - k) for k in range(n)]
    return ring + [(i + 1, j + 1) for i, j in ring_walk(degree - 2)]


def monomials(corners, degree, points):
    powers = [(i, j) for i in range(degree + 1) for j in range(degree + 1) if corners == 4 or i + j <= degree]
    return np.stack([points[:, 0] ** i * points[:, 1] ** j for i, j in powers], axis=1)


def interpolation(corners, degree, points):
    """Matrix that takes the nodes of an element to its positions at reference points in [0, 1]^2."""
    lattice = np.array(cgns_lattice(corners, degree)) / degree
    return monomials(corners, degree, points) @ np.linalg.inv(monomials(corners, degree, lattice))


def subdivision(corners):
    """Reference points and small triangles of one element."""
    n = SUBDIVISIONS
    lattice = [(i, j) for j in range(n + 1) for i in range(n + 1) if corners == 4 or i + j <= n]
    number = {point: k for k, point in enumerate(lattice)}
    triangles = []
    for i, j in lattice:
        for triangle in (((i, j), (i + 1, j), (i, j + 1)), ((i + 1, j), (i + 1, j + 1), (i, j + 1))):
            if all(point in number for point in triangle):
                triangles.append([number[point] for point in triangle])
    return np.array(lattice) / n, np.array(triangles)


def edge_points(corners, count):
    """Reference points along each edge of an element."""
    ends = np.array([(0, 0), (1, 0), (0, 1)] if corners == 3 else [(0, 0), (1, 0), (1, 1), (0, 1)], dtype=float)
    way = np.linspace(0, 1, count)[:, None]
    return [a + way * (b - a) for a, b in zip(ends, np.roll(ends, -1, axis=0))]


class Picture:
    """A depth buffer, seen along a direction without perspective."""

    def __init__(self, at, camera, width, pixels):
        self.at = np.array(at, dtype=float)
        backward = np.array(camera, dtype=float) - self.at
        backward /= np.linalg.norm(backward)
        right = np.cross((0, 0, 1), backward)
        right /= np.linalg.norm(right)
        self.axes = np.stack([right, np.cross(backward, right), backward])
        self.columns, self.rows = (SUPERSAMPLING * side for side in pixels)
        self.scale = self.columns / width
        self.depth = np.full((self.rows, self.columns), -np.inf)
        self.color = np.ones((self.rows, self.columns, 3))
        self.light = np.array((-0.35, 0.55, 0.75)) / np.linalg.norm((-0.35, 0.55, 0.75))

    def project(self, points):
        seen = (points - self.at) @ self.axes.T * self.scale
        return seen * (1, -1, 1) + (self.columns / 2, self.rows / 2, 0)

    def draw_triangles(self, points):
        """points[triangle, corner, xyz]; both sides look the same."""
        normals = np.cross(points[:, 1] - points[:, 0], points[:, 2] - points[:, 0]) @ self.axes.T
        lengths = np.linalg.norm(normals, axis=1)
        seen = self.project(points)
        low = np.floor(seen[:, :, :2].min(axis=1)).astype(int)
        high = np.ceil(seen[:, :, :2].max(axis=1)).astype(int) + 1
        visible = (lengths > 0) & (high > 0).all(axis=1) & (low < (self.columns, self.rows)).all(axis=1)
        for t in np.flatnonzero(visible):
            normal = normals[t] / lengths[t] * np.sign(normals[t, 2])
            shade = 0.55 + 0.45 * (normal @ self.light)  # never quite dark, so that a bend away from the light shows
            self.fill(seen[t], np.maximum(low[t], 0), np.minimum(high[t], (self.columns, self.rows)),
                      shade * np.array((0.62, 0.74, 0.88)) + 0.12)

    def fill(self, triangle, low, high, color):
        a, b, c = triangle
        area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
        if area == 0:
            return
        x, y = np.meshgrid(np.arange(low[0], high[0]) + 0.5, np.arange(low[1], high[1]) + 0.5)
        u = ((x - a[0]) * (c[1] - a[1]) - (y - a[1]) * (c[0] - a[0])) / area
        v = ((b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0])) / area
        z = a[2] + u * (b[2] - a[2]) + v * (c[2] - a[2])
        window = (slice(low[1], high[1]), slice(low[0], high[0]))
        inside = (u >= 0) & (v >= 0) & (u + v <= 1) & (z > self.depth[window])
        self.depth[window][inside] = z[inside]
        self.color[window][inside] = color

    def draw_lines(self, points):
        """points[line, point, xyz], densely sampled; a little in front of the surface that they lie on."""
        seen = self.project(points.reshape(-1, 3))
        for dx in (-1, 0, 1):
            for dy in (-1, 0, 1):
                column, row = (seen[:, :2] + (dx, dy)).astype(int).T
                inside = (column >= 0) & (column < self.columns) & (row >= 0) & (row < self.rows)
                column, row, z = column[inside], row[inside], seen[inside, 2]
                front = z + 6 * SUPERSAMPLING > self.depth[row, column]
                self.color[row[front], column[front]] = (0.10, 0.13, 0.20)

    def save(self, path):
        s = SUPERSAMPLING
        picture = self.color.reshape(self.rows // s, s, self.columns // s, s, 3).mean(axis=(1, 3))
        pyplot.imsave(path, np.clip(picture, 0, 1))


def draw(blocks, path, options):
    picture = Picture(options.at, getattr(options, "from"), options.width, options.pixels)
    near = [(corners, degree, nodes[(np.abs(nodes.mean(axis=1) - picture.at) < 1.5 * options.width).all(axis=1)])
            for corners, degree, nodes in blocks]
    for corners, degree, nodes in near:
        points, triangles = subdivision(corners)
        positions = interpolation(corners, degree, points) @ nodes
        picture.draw_triangles(positions[:, triangles].reshape(-1, 3, 3))
    for corners, degree, nodes in near:
        for points in edge_points(corners, 1000):
            picture.draw_lines(interpolation(corners, degree, points) @ nodes)
    picture.save(path)


def section_lines(blocks, width):
    """Element edges with both ends in the plane y = 0, as polylines in (x, z)."""
    lines, ends = [], []
    for corners, degree, nodes in blocks:
        for points in edge_points(corners, 4 * SUBDIVISIONS):
            positions = interpolation(corners, degree, points) @ nodes
            in_plane = (np.abs(positions[:, :, 1]) < 1e-9 * width).all(axis=1)
            lines += list(positions[in_plane][:, :, (0, 2)])
            ends += list(positions[in_plane][:, (0, -1)][:, :, (0, 2)].reshape(-1, 2))
    return lines, ends


def draw_section(before, after, path, options):
    figure, axes = pyplot.subplots(figsize=(9, 6.75), dpi=133)
    for blocks, style in ((before, {"color": "tab:red", "linewidth": 1, "label": "before"}),
                          (after, {"color": "tab:blue", "linewidth": 1.8, "label": "after"})):
        lines, ends = section_lines(blocks, options.width)
        for line in lines:
            axes.plot(line[:, 0], line[:, 1], **style)
            style.pop("label", None)
    if ends:
        axes.plot(*np.array(ends).T, "k.", label="vertices of the mesh")
    axes.set_aspect("equal")
    x, width = options.section
    axes.set_xlim(x - width / 2, x + width / 2)
    axes.set_ylim(-width * 3 / 8, width * 3 / 8)
    axes.set_xlabel("x")
    axes.set_ylabel("z")
    axes.set_title("edges of the elements in the plane y = 0")
    axes.legend()
    figure.savefig(path)


def straight_sided(blocks):
    """The same elements with their corners only."""
    return [(corners, 1, nodes[:, :corners]) for corners, _, nodes in blocks]


def fit_view(blocks, options):
    """Sets what the caller left open of the view: all of the patches, from above and aside."""
    points = np.concatenate([nodes.reshape(-1, 3) for _, _, nodes in blocks])
    low, high = points.min(axis=0), points.max(axis=0)
    diagonal = np.linalg.norm(high - low)
    if options.at is None:
        options.at = (low + high) / 2
    if getattr(options, "from") is None:
        setattr(options, "from", np.array(options.at) + diagonal * np.array((-1, 1, 1)))
    if options.width is None:
        options.width = 1.05 * diagonal


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("curved", type=Path)
    parser.add_argument("directory", type=Path)
    parser.add_argument("--patch", nargs="+", default=["*"])
    parser.add_argument("--at", nargs=3, type=float)
    parser.add_argument("--from", nargs=3, type=float)
    parser.add_argument("--width", type=float)
    parser.add_argument("--section", nargs=2, type=float, metavar=("X", "WIDTH"))
    parser.add_argument("--pixels", nargs=2, type=int, metavar=("COLUMNS", "ROWS"), default=(1200, 900))
    options = parser.parse_args()

    after = read_faces(options.curved, options.patch)
    if not after:
        parser.error("no boundary faces in patches " + " ".join(options.patch))
    before = straight_sided(after)
    fit_view(after, options)
    options.directory.mkdir(parents=True, exist_ok=True)
    draw(before, options.directory / "before.png", options)
    draw(after, options.directory / "after.png", options)
    if options.section:
        draw_section(before, after, options.directory / "section.png", options)


if __name__ == "__main__":
    main()
