#!/usr/bin/python3
"""Reads the cells that write_vtk_samples wrote with VTK itself and compares VTK's map of each cell and face, at random
points, with the polynomial that curved them.

usage: vtk_reader_test.py WRITE_VTK_SAMPLES FOLDER
"""
import random
import subprocess
import sys
from pathlib import Path

import vtk

SEED = 20240607
POINTS = 50
# Positions are about 2; at degree 6 the basis functions cancel a digit or two (1.1e-14 was the worst seen).
TOLERANCE = 1e-13

# Facts of the reference elements (SIDS), stated here a second time: corners and faces.
CORNERS = {
    "tetrahedron": [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)],
    "pyramid": [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1)],
    "prism": [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (0, 1, 1)],
    "hexahedron": [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)],
}
FACES = {
    "tetrahedron": [(0, 2, 1), (0, 1, 3), (1, 2, 3), (2, 0, 3)],
    "pyramid": [(0, 3, 2, 1), (0, 1, 4), (1, 2, 4), (2, 3, 4), (3, 0, 4)],
    "prism": [(0, 1, 4, 3), (1, 2, 5, 4), (2, 0, 3, 5), (0, 2, 1), (3, 4, 5)],
    "hexahedron": [(0, 3, 2, 1), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (0, 4, 7, 3), (4, 5, 6, 7)],
}
CELL_TYPE = {"tetrahedron": 71, "pyramid": 72, "prism": 73, "hexahedron": 72}
TYPE_NUMBER = {"triangle": 1, "quadrangle": 2, "tetrahedron": 3, "pyramid": 4, "prism": 5, "hexahedron": 6}


def polynomial_map(degree, xi):
    x, y, z = xi
    return (
        x + 0.2 * y + 0.05 * (0.3 + 0.5 * x - 0.4 * y + 0.3 * z) ** degree,
        y - 0.1 * z + 0.05 * (0.6 - 0.2 * x + 0.3 * y + 0.5 * z) ** degree,
        2 * z + 0.1 * x + 0.05 * (0.1 + 0.4 * x + 0.5 * y - 0.3 * z) ** degree,
    )


def random_point_in_cell(name):
    """VTK's parametric coordinates, and ours."""
    r, s, t = (random.random() for _ in range(3))
    if name == "tetrahedron":
        while r + s + t > 1:
            r, s, t = (random.random() for _ in range(3))
    if name == "prism" and r + s > 1:
        r, s = 1 - r, 1 - s
    if name == "pyramid":  # written as a hexahedron collapsed onto the apex
        return (r, s, t), (r * (1 - t), s * (1 - t), t)
    return (r, s, t), (r, s, t)


def random_point_in_face(corners):
    """VTK's parametric coordinates in the face, and our coordinates in the cell."""
    r, s = random.random(), random.random()
    if len(corners) == 3:
        if r + s > 1:
            r, s = 1 - r, 1 - s
        weights = (1 - r - s, r, s)
    else:
        weights = ((1 - r) * (1 - s), r * (1 - s), r * s, (1 - r) * s)
    return (r, s, 0), tuple(sum(w * c[i] for w, c in zip(weights, corners)) for i in range(3))


def location(cell, parametric):
    position, sub_id = [0.0, 0.0, 0.0], vtk.reference(0)
    cell.EvaluateLocation(sub_id, parametric, position, [0.0] * cell.GetNumberOfPoints())
    return position


def distance(a, b):
    return max(abs(x - y) for x, y in zip(a, b))


class Sample:
    def __init__(self, folder, name, degree):
        self.name, self.degree = name, degree
        self.faults, self.largest_error = [], 0.0
        reader = vtk.vtkXMLUnstructuredGridReader()
        reader.SetFileName(str(folder / f"{name}_{degree}.vtu"))
        reader.Update()
        self.grid = reader.GetOutput()

    def expect(self, found, expected, what):
        if found != expected:
            self.faults.append(f"{self.name} of degree {self.degree}: {what}: expected {expected}, found {found}")

    def check(self):
        faces = FACES[self.name]
        self.expect(self.grid.GetNumberOfCells(), 1 + len(faces), "cells")
        if self.faults:
            return
        self.expect(self.grid.GetCellType(0), CELL_TYPE[self.name], "VTK type of the cell")
        self.check_data(faces)
        for _ in range(POINTS):
            self.check_point(0, *random_point_in_cell(self.name))
        for f, face in enumerate(faces):
            self.expect(self.grid.GetCellType(1 + f), 69 if len(face) == 3 else 70, f"VTK type of face {f}")
            for _ in range(POINTS):
                self.check_point(1 + f, *random_point_in_face([CORNERS[self.name][c] for c in face]))
        if self.largest_error > TOLERANCE:
            self.faults.append(f"{self.name} of degree {self.degree}: off by {self.largest_error:.1e}")

    def check_surface(self, path):
        """the faces as p^2 straight pieces each, with the number of their patch"""
        is_vtp = path.suffix == ".vtp"
        reader = vtk.vtkXMLPolyDataReader() if is_vtp else vtk.vtkPLYReader()
        reader.SetFileName(str(path))
        reader.Update()
        surface, faces = reader.GetOutput(), FACES[self.name]
        self.expect(surface.GetNumberOfPolys(), len(faces) * self.degree ** 2, f"pieces in {path.name}")
        if not is_vtp or self.faults:
            return
        patches = surface.GetCellData().GetArray("patch")
        names = surface.GetFieldData().GetAbstractArray("patch_names")
        self.expect(names.GetValue(len(faces) - 1), f"face {len(faces) - 1}", "patch_names")
        self.expect([patches.GetTuple1(c) for c in range(patches.GetNumberOfTuples())],
                    [f for f in range(len(faces)) for _ in range(self.degree ** 2)], "patch of pieces")
        positions = {self.grid.GetPoint(m) for m in range(self.grid.GetNumberOfPoints())}
        self.expect([surface.GetPoint(m) in positions for m in range(surface.GetNumberOfPoints())],
                    [True] * surface.GetNumberOfPoints(), "points of the surface are nodes")

    def check_point(self, cell, parametric, xi):
        found = location(self.grid.GetCell(cell), parametric)
        self.largest_error = max(self.largest_error, distance(found, polynomial_map(self.degree, xi)))

    def check_data(self, faces):
        data, field_data = self.grid.GetCellData(), self.grid.GetFieldData()
        values = {data.GetArrayName(a): [data.GetArray(a).GetTuple1(c) for c in range(1 + len(faces))]
                  for a in range(data.GetNumberOfArrays())}
        self.expect(values["zone"], [0] * (1 + len(faces)), "zone")
        self.expect(values["patch"], [-1] + list(range(len(faces))), "patch")
        face_types = [TYPE_NUMBER["triangle" if len(face) == 3 else "quadrangle"] for face in faces]
        self.expect(values["element_type"], [TYPE_NUMBER[self.name]] + face_types, "element_type")
        self.expect(values["is_straight"], [1 if self.degree == 1 else 0] + [-1] * len(faces), "is_straight")
        self.expect(values["seven"][0], 7, "field of the caller")
        self.expect([v == v for v in values["seven"][1:]], [False] * len(faces), "field is a number on faces")
        for name, strings in (("zone_names", [f"unit {self.name}"]),
                              ("patch_names", [f"face {f}" for f in range(len(faces))])):
            array = field_data.GetAbstractArray(name)
            self.expect([array.GetValue(i) for i in range(array.GetNumberOfValues())], strings, name)
        array = field_data.GetAbstractArray("element_type_names")
        self.expect(array.GetValue(TYPE_NUMBER[self.name]), self.name, "element_type_names")


def main():
    program, folder = sys.argv[1], Path(sys.argv[2])
    subprocess.run([program, str(folder)], check=True)
    random.seed(SEED)
    print(f"VTK {vtk.vtkVersion().GetVTKVersion()}, seed {SEED}")
    faults = []
    for name in CORNERS:
        for degree in range(1, 7):
            sample = Sample(folder, name, degree)
            sample.check()
            for suffix in (".vtp", ".ply"):
                sample.check_surface(folder / f"{name}_{degree}{suffix}")
            print(f"{name:12} degree {degree}: largest error {sample.largest_error:.1e}")
            faults += sample.faults
    print("\n".join(faults))
    sys.exit(1 if faults else 0)


if __name__ == "__main__":
    main()
