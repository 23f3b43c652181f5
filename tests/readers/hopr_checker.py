#!/usr/bin/python3
"""Checks an HDF5 mesh against every rule of HOPR's specification of its format ("HOPR HDF5 Curved Mesh Format"), written
from that document alone: it shares nothing with the writer.

usage: hopr_checker.py MESH.h5 ...
"""
import sys

import h5py
import numpy as np

# The SIDS's reference elements: corners on the lattice of degree 1, and the corners of their sides, seen from outside.
CORNERS = {
    4: [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)],
    5: [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1)],
    6: [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (0, 1, 1)],
    8: [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)],
}
SIDES = {
    4: [(0, 2, 1), (0, 1, 3), (1, 2, 3), (2, 0, 3)],
    5: [(0, 3, 2, 1), (0, 1, 4), (1, 2, 4), (2, 3, 4), (3, 0, 4)],
    6: [(0, 1, 4, 3), (1, 2, 5, 4), (2, 0, 3, 5), (0, 2, 1), (3, 4, 5)],
    8: [(0, 3, 2, 1), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (0, 4, 7, 3), (4, 5, 6, 7)],
}
ELEMENT_TYPES = [104, 204, 105, 115, 205, 106, 116, 206, 108, 118, 208]
SIDE_TYPES = [3, 23, 4, 14, 24]
PERIODIC, INNER = 1, 100


def lattice(corners, degree):
    """algorithm 8: the nodes of an element row by row"""
    limit = {4: lambda i, j, k: i + j + k <= degree, 5: lambda i, j, k: max(i, j) + k <= degree,
             6: lambda i, j, k: i + j <= degree, 8: lambda i, j, k: True}[corners]
    numbers = range(degree + 1)
    return [(i, j, k) for k in numbers for j in numbers for i in numbers if limit(i, j, k)]


class Layout:
    """where corners and nodes of sides stand in the node list of an element"""

    def __init__(self, corners, degree):
        self.nodes = lattice(corners, degree)
        place = {node: m for m, node in enumerate(self.nodes)}
        points = [np.array(corner) * degree for corner in CORNERS[corners]]
        self.corners = [place[tuple(point)] for point in points]
        self.side_corners = [[self.corners[c] for c in side] for side in SIDES[corners]]
        self.frames = [[points[c] for c in side] for side in SIDES[corners]]
        self.place, self.degree = place, degree

    def side_nodes(self, side, first=0, step=1):
        """all nodes of a side row by row, in the frame whose corners are first, first + step, ..."""
        frame, count, degree = self.frames[side], len(self.frames[side]), self.degree
        origin, along, across = (frame[m % count] for m in (first, first + step, first - step))
        rows = [(i, j) for j in range(degree + 1) for i in range(degree + 1) if count == 4 or i + j <= degree]
        return [self.place[tuple((origin + (i * (along - origin) + j * (across - origin)) // degree))] for i, j in rows]


class Checker:
    def __init__(self, path):
        self.faults = []
        with h5py.File(path) as file:
            self.attributes = {name: np.ravel(value)[0] for name, value in file.attrs.items()}
            self.arrays = {name: item[()] for name, item in file.items()}
            self.types = {name: item.dtype for name, item in file.items()}

    def expect(self, condition, message):
        if not condition:
            self.faults.append(message)
        return condition

    def check(self):
        if self.check_arrays() and self.check_elements():
            self.check_nodes()
            if self.check_sides():
                self.check_conditions()
                self.check_connections()
            self.check_curve()
        return self.faults

    def check_arrays(self):
        a = self.attributes
        for name in ("Version", "Ngeo", "nElems", "nSides", "nNodes", "nUniqueSides", "nUniqueNodes", "nBCs"):
            if not self.expect(name in a, f"attribute {name} is missing"):
                return False
        self.expect(isinstance(a["Version"], np.float64), "Version is no REAL")
        for name in a:
            if name.startswith("n") or name == "Ngeo":
                self.expect(isinstance(a[name], np.int32), f"attribute {name} is no 32-bit INTEGER")
        shapes = {"ElemInfo": (a["nElems"], 6), "SideInfo": (a["nSides"], 5), "NodeCoords": (a["nNodes"], 3),
                  "GlobalNodeIDs": (a["nNodes"],), "BCNames": (a["nBCs"],), "BCType": (a["nBCs"], 4),
                  "ElemBarycenters": (a["nElems"], 3), "ElemWeight": (a["nElems"],), "ElemCounter": (11, 2)}
        reals = ("NodeCoords", "ElemBarycenters", "ElemWeight")
        for name, shape in shapes.items():
            if not self.expect(name in self.arrays, f"array {name} is missing"):
                return False
            self.expect(self.arrays[name].shape == shape, f"{name} has shape {self.arrays[name].shape}, not {shape}")
            kind = np.dtype("S255") if name == "BCNames" else np.float64 if name in reals else np.int32
            self.expect(self.types[name] == kind, f"{name} is of type {self.types[name]}")
        return not self.faults

    def check_elements(self):
        info, degree = self.arrays["ElemInfo"], int(self.attributes["Ngeo"])
        self.corners = info[:, 0] % 10
        if not self.expect(np.isin(info[:, 0], ELEMENT_TYPES).all(), "unknown element types"):
            return False
        self.layouts = {n: Layout(n, degree) for n in (4, 5, 6, 8)}
        self.expect((info[:, 1] >= 1).all(), "zones are not counted from 1")
        for column, sizes, what in ((2, {n: len(SIDES[n]) for n in SIDES}, "sides"),
                                    (4, {n: len(self.layouts[n].nodes) for n in SIDES}, "nodes")):
            expected = np.concatenate(([0], np.cumsum([sizes[n] for n in self.corners])))
            self.expect((info[:, column] == expected[:-1]).all() and (info[:, column + 1] == expected[1:]).all(),
                        f"offsets of {what} are not those of the element types")
            self.expect(expected[-1] == self.attributes["nSides" if what == "sides" else "nNodes"], f"total of {what}")
        counter = self.arrays["ElemCounter"]
        self.expect(list(counter[:, 0]) == ELEMENT_TYPES, "rows of ElemCounter")
        self.expect([int((info[:, 0] == t).sum()) for t in ELEMENT_TYPES] == list(counter[:, 1]), "ElemCounter")
        return not self.faults

    def check_nodes(self):
        ids, x = self.arrays["GlobalNodeIDs"], self.arrays["NodeCoords"]
        unique, first, inverse = np.unique(ids, return_index=True, return_inverse=True)
        self.expect(np.isfinite(x).all(), "coordinates that are no numbers")
        self.expect(np.array_equal(unique, np.arange(1, self.attributes["nUniqueNodes"] + 1)),
                    "unique nodes are not numbered from 1 to nUniqueNodes")
        self.expect((x[first][inverse] == x).all(), "one unique node in two places")
        info = self.arrays["ElemInfo"]
        scale = np.ptp(x, axis=0).max()
        # Right-handed at the first corner, for each element type.
        for n, layout in self.layouts.items():
            offsets = info[self.corners == n, 4]
            along = {4: (1, 2, 3), 5: (1, 3, 4), 6: (1, 2, 3), 8: (1, 3, 4)}[n]
            # HOPR writes the mean of the corners; its document does not say which mean it is.
            means = np.mean([x[offsets + corner] for corner in layout.corners], axis=0)
            error = np.abs(means - self.arrays["ElemBarycenters"][self.corners == n])
            self.expect(error.size == 0 or error.max() < 1e-12 * scale, "barycentres")
            edges = [x[offsets + layout.corners[c]] - x[offsets + layout.corners[0]] for c in along]
            volumes = np.einsum("ij,ij->i", np.cross(edges[0], edges[1]), edges[2])
            self.expect((volumes > 0).all(), f"elements with {n} corners that are inside out")

    def check_sides(self):
        sides = self.arrays["SideInfo"]
        self.element_of = np.repeat(np.arange(len(self.corners)), [len(SIDES[n]) for n in self.corners])
        self.local_of = np.concatenate([np.arange(len(SIDES[n])) for n in self.corners])
        counts = np.concatenate([[len(side) for side in SIDES[n]] for n in self.corners])
        self.expect(np.isin(sides[:, 0], SIDE_TYPES).all(), "unknown side types")
        self.expect((sides[:, 0] % 10 == counts).all(), "side types do not fit the corners of sides")
        curved = sides[:, 0] > 20
        self.expect(not curved.any() or self.attributes["Ngeo"] > 1, "non-linear sides at Ngeo 1")
        numbers = np.unique(np.abs(sides[:, 1]))
        self.expect(np.array_equal(numbers, np.arange(1, self.attributes["nUniqueSides"] + 1)),
                    "unique sides are not numbered from 1 to nUniqueSides")
        self.expect(len(np.unique(sides[:, 1])) == len(sides), "a global side number occurs twice with one sign")
        is_connected = sides[:, 2] > 0
        self.expect((sides[~is_connected, 1] > 0).all(), "a side without neighbour is a slave")
        self.expect((sides[~is_connected, 2:4] == 0).all(), "a side without neighbour has a neighbour's side or flip")
        self.expect((sides[:, 2] <= len(self.corners)).all(), "a neighbour that does not exist")
        masters, slaves = sides[is_connected & (sides[:, 1] > 0), 1], -sides[is_connected & (sides[:, 1] < 0), 1]
        self.expect(np.array_equal(np.sort(masters), np.sort(slaves)), "masters and slaves are not the same sides")
        return not self.faults

    def check_conditions(self):
        sides, types = self.arrays["SideInfo"], self.arrays["BCType"]
        names = [bytes(name).decode().rstrip() for name in self.arrays["BCNames"]]
        self.names = names
        self.expect(all(names) and len(set(names)) == len(names), f"names of boundary conditions: {names}")
        conditions, is_connected = sides[:, 4], sides[:, 2] > 0
        if not self.expect(((conditions >= 0) & (conditions <= len(names))).all(), "a boundary condition that is none"):
            return
        self.expect((conditions[~is_connected] > 0).all(), "boundary sides without condition")
        kind = np.where(conditions > 0, types[conditions - 1, 0], 0)
        self.expect(np.isin(kind[is_connected & (conditions > 0)], (PERIODIC, INNER)).all(),
                    "connected sides with a condition that is neither periodic nor inner")
        self.expect(not np.isin(kind[~is_connected], (PERIODIC, INNER)).any(),
                    "periodic or inner sides without neighbour")
        for name, (boundary, _, _, index) in zip(names, types):
            if boundary == PERIODIC:
                partners = [other for other in types if other[0] == PERIODIC and other[3] == -index]
                self.expect(index != 0 and len(partners) > 0, f"'{name}': no condition with the opposite periodic index")

    def check_connections(self):
        """every pair of sides: each names the other, flips agree, and all nodes of the sides are the same or, on periodic
        sides, one vector apart"""
        sides, info = self.arrays["SideInfo"], self.arrays["ElemInfo"]
        ids, x, types = self.arrays["GlobalNodeIDs"], self.arrays["NodeCoords"], self.arrays["BCType"]
        shifts = {}
        for row in np.flatnonzero(sides[:, 2] > 0):
            element, local = self.element_of[row], self.local_of[row]
            _, number, neighbor, code, condition = sides[row]
            neighbor, other_side, flip = neighbor - 1, code // 10 - 1, code % 10
            where = f"side {local + 1} of element {element + 1}"
            n, m = self.corners[element], self.corners[neighbor]
            if not self.expect(0 <= other_side < len(SIDES[m]), f"{where}: no such side of the neighbour"):
                continue
            back = sides[info[neighbor, 2] + other_side]
            self.expect(back[1] == -number, f"{where}: the global number of the neighbour's side")
            self.expect(back[2] == element + 1 and back[3] // 10 == local + 1, f"{where}: the neighbour names another")
            self.expect(back[3] % 10 == flip, f"{where}: the neighbour has another flip")
            count = len(SIDES[n][local])
            if not self.expect(len(SIDES[m][other_side]) == count and 1 <= flip <= count, f"{where}: flip {flip}"):
                continue
            own = info[element, 4] + np.array(self.layouts[n].side_nodes(local))
            there = info[neighbor, 4] + np.array(self.layouts[m].side_nodes(other_side, flip - 1, -1))
            if condition == 0 or types[condition - 1, 0] != PERIODIC:
                self.expect((ids[own] == ids[there]).all(), f"{where}: its nodes are not those of the neighbour")
            else:
                shift = x[there] - x[own]
                expected = shifts.setdefault(condition, shift[0])
                self.expect(np.abs(shift - expected).max() < 1e-9 * np.abs(expected).max(),
                            f"{where}: periodic nodes are not one vector apart")
        for condition, shift in shifts.items():
            index = types[condition - 1, 3]
            for other, vector in shifts.items():
                if types[other - 1, 3] == -index:
                    self.expect(np.abs(shift + vector).max() < 1e-9 * np.abs(shift).max(),
                                f"'{self.names[condition - 1]}' and its partner are not opposite")

    def check_curve(self):
        """consecutive elements are near each other: a tenth of random neighbours' distance where there are many"""
        x = self.arrays["ElemBarycenters"]
        if len(x) < 1000:
            return
        step = np.linalg.norm(np.diff(x, axis=0), axis=1).mean()
        random = np.linalg.norm(np.diff(np.random.default_rng(1).permutation(x), axis=0), axis=1).mean()
        self.expect(step < 0.3 * random, f"elements do not follow a curve: steps of {step:.3g}, random ones {random:.3g}")


def main():
    is_good = True
    for path in sys.argv[1:]:
        checker = Checker(path)
        faults = checker.check()
        is_good = is_good and not faults
        print(f"{path}: " + ("\n  ".join(faults[:20]) if faults else "keeps every rule"))
    sys.exit(0 if is_good else 1)


if __name__ == "__main__":
    main()
