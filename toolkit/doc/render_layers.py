#!/usr/bin/env python3
"""Draws the layers of cells behind a curved wall: straight, with the wall alone curved, and after they have followed it.

usage: render_layers.py UNDEFORMED.cgns DEFORMED.cgns PICTURE.png [--plane AXIS VALUE] [--at U V] [--width W]

The two meshes come from `recurve curve IN OUT` with and without --no-deform. Drawn are the edges of cells that lie in the
plane AXIS = VALUE (an axis x, y, z), inside the mesh too, each as its polynomial is; corners as dots; W wide around (U, V),
the coordinates along the other two axes. The picture of the manual is made by

    recurve curve data/cylinder_hexahedra.cgns a.cgns -p 3 --no-deform
    recurve curve data/cylinder_hexahedra.cgns b.cgns -p 3
    render_layers.py a.cgns b.cgns boundary_layer.png --plane z 0.333333333 --at 0.535 0.065 --width 0.14

Needs numpy, h5py and matplotlib.
"""
import argparse

import h5py
import matplotlib
import numpy as np

matplotlib.use("Agg")
from matplotlib import pyplot  # noqa: E402  (the backend comes first)

HEXAHEDRON = ((0, 1), (1, 2), (2, 3), (3, 0), (0, 4), (1, 5), (2, 6), (3, 7), (4, 5), (5, 6), (6, 7), (7, 4))
PRISM = ((0, 1), (1, 2), (2, 0), (0, 3), (1, 4), (2, 5), (3, 4), (4, 5), (5, 3))
PYRAMID = ((0, 1), (1, 2), (2, 3), (3, 0), (0, 4), (1, 4), (2, 4), (3, 4))
TETRAHEDRON = ((0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3))

# CGNS element type -> (nodes, corners, degree, edges); the nodes inside edges follow the corners, edge by edge.
CELL_TYPES = {11: (10, 4, 2, TETRAHEDRON), 30: (20, 4, 3, TETRAHEDRON), 47: (35, 4, 4, TETRAHEDRON),
              13: (14, 5, 2, PYRAMID), 33: (30, 5, 3, PYRAMID), 50: (55, 5, 4, PYRAMID),
              16: (18, 6, 2, PRISM), 36: (40, 6, 3, PRISM), 53: (75, 6, 4, PRISM),
              19: (27, 8, 2, HEXAHEDRON), 39: (64, 8, 3, HEXAHEDRON), 56: (125, 8, 4, HEXAHEDRON)}
POINTS = 40  # of a drawn edge


def children(group, label):
    return [child for child in group.values()
            if isinstance(child, h5py.Group) and child.attrs.get("label", b"").decode().rstrip("\0") == label]


def read_edges(path):
    """nodes[edge, p + 1, xyz] in order along each edge of each cell; an edge occurs once for each cell."""
    result = []
    with h5py.File(path, "r") as file:
        for zone in children(children(file, "CGNSBase_t")[0], "Zone_t"):
            grid = children(zone, "GridCoordinates_t")[0]
            points = np.stack([grid["Coordinate" + axis][" data"][()] for axis in "XYZ"], axis=1)
            for section in children(zone, "Elements_t"):
                if int(section[" data"][0]) not in CELL_TYPES:
                    continue
                nodes, corners, degree, edges = CELL_TYPES[int(section[" data"][0])]
                cells = section["ElementConnectivity"][" data"][()].reshape(-1, nodes) - 1
                for number, (a, b) in enumerate(edges):
                    inside = range(corners + number * (degree - 1), corners + (number + 1) * (degree - 1))
                    result.append(points[cells[:, [a, *inside, b]]])
    if not result:
        raise SystemExit(f"{path}: no cells of degree 2 to 4")
    return np.concatenate(result)


def polynomials(edges):
    """points[edge, POINTS, xyz] along the polynomials through equidistant nodes."""
    degree = edges.shape[1] - 1
    at = np.linspace(0, 1, POINTS)
    powers = np.vander(np.linspace(0, 1, degree + 1), increasing=True)
    weights = np.vander(at, degree + 1, increasing=True) @ np.linalg.inv(powers)
    return np.einsum("tn,enx->etx", weights, edges)


def in_window(edges, plane, value, axes, middle, width):
    """edges whose nodes all lie in the plane, and some of whose points are near the window."""
    tolerance = 1e-3 * width
    flat = np.abs(edges[:, :, plane] - value).max(axis=1) < tolerance
    ends = edges[flat][:, [0, -1]][:, :, axes]
    lengths = np.linalg.norm(ends[:, 0] - ends[:, 1], axis=1)
    distance = np.abs(ends - np.array(middle)).max(axis=2).min(axis=1)
    return edges[flat][distance < width + lengths]


def draw(panel, edges, axes, middle, width, title):
    for line in polynomials(edges)[:, :, axes]:
        panel.plot(line[:, 0], line[:, 1], color="#1b3a5c", linewidth=0.8)
    ends = edges[:, [0, -1]][:, :, axes].reshape(-1, 2)
    panel.plot(ends[:, 0], ends[:, 1], ".", color="#d95f02", markersize=3)
    panel.set_xlim(middle[0] - width / 2, middle[0] + width / 2)
    panel.set_ylim(middle[1] - 0.75 * width, middle[1] + 0.75 * width)
    panel.set_aspect("equal")
    panel.set_title(title, fontsize=11)
    panel.tick_params(labelsize=7)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("undeformed")
    parser.add_argument("deformed")
    parser.add_argument("picture")
    parser.add_argument("--plane", nargs=2, default=["z", "0"], metavar=("AXIS", "VALUE"))
    parser.add_argument("--at", nargs=2, type=float, default=[0, 0], metavar=("U", "V"))
    parser.add_argument("--width", type=float, default=1)
    arguments = parser.parse_args()
    plane = "xyz".index(arguments.plane[0])
    axes = [axis for axis in range(3) if axis != plane]

    def chosen(edges):
        return in_window(edges, plane, float(arguments.plane[1]), axes, arguments.at, arguments.width)

    undeformed, deformed = chosen(read_edges(arguments.undeformed)), chosen(read_edges(arguments.deformed))
    figure, panels = pyplot.subplots(1, 3, figsize=(12, 6.4), constrained_layout=True)
    draw(panels[0], undeformed[:, [0, -1]], axes, arguments.at, arguments.width, "straight")
    draw(panels[1], undeformed, axes, arguments.at, arguments.width, "wall curved: its cells fold")
    draw(panels[2], deformed, axes, arguments.at, arguments.width, "layers follow the wall")
    figure.savefig(arguments.picture, dpi=90)


if __name__ == "__main__":
    main()
