#!/usr/bin/python3
"""Converts meshes to every format with the program, each from the one before, and compares what foreign readers find there
(h5py for CGNS and HOPR's format, Gmsh, VTK) with what they find in the first: zones and patches by name, the degree, and
every element with the bits of all its nodes.

usage: convert_reader_test.py RECURVE FOLDER MESH ...       those that are neither CGNS nor MSH begin as CGNS
"""
import shutil
import subprocess
import sys
from collections import defaultdict
from pathlib import Path

import gmsh
import h5py
import numpy as np
import vtk
from vtk.util.numpy_support import vtk_to_numpy

from hopr_checker import SIDES, Layout

# Complete families of CGNS by their code: corners and nodes; MIXED holds any of them.
FAMILIES = {10: (4, (4, 10, 20, 35)), 12: (5, (5, 14, 30, 55)), 14: (6, (6, 18, 40, 75)), 17: (8, (8, 27, 64, 125)),
            5: (3, (3, 6, 10, 15)), 7: (4, (4, 9, 16, 25))}
CODES = {5: (5, 1), 6: (5, 2), 26: (5, 3), 42: (5, 4), 7: (7, 1), 9: (7, 2), 28: (7, 3), 44: (7, 4), 10: (10, 1),
         11: (10, 2), 30: (10, 3), 47: (10, 4), 12: (12, 1), 13: (12, 2), 33: (12, 3), 50: (12, 4), 14: (14, 1),
         16: (14, 2), 36: (14, 3), 53: (14, 4), 17: (17, 1), 19: (17, 2), 39: (17, 3), 56: (17, 4)}
MIXED, FACES = 20, (5, 7)


def signatures_of_points(points):
    """64 bits for each point, from the bits of its coordinates"""
    bits = np.ascontiguousarray(points, dtype=np.float64).view(np.uint64).reshape(-1, 3)
    result = np.zeros(len(bits), dtype=np.uint64)
    for axis in range(3):
        result = (result ^ bits[:, axis]) * np.uint64(0x9E3779B97F4A7C15)
        result ^= result >> np.uint64(29)
    return result * np.uint64(0xBF58476D1CE4E5B9)


class Mesh:
    """per zone and per patch the signatures of elements: sums over their nodes, of all and of the corners alone"""

    def __init__(self):
        self.degrees = set()
        self.cells, self.corners = defaultdict(list), defaultdict(list)
        self.faces, self.face_corners = defaultdict(list), defaultdict(list)
        self.pyramids = defaultdict(list)  # by corners

    def add(self, name, is_face, signatures, corner_count):
        """signatures: one row per element, the corners first"""
        corners = signatures[:, :corner_count].sum(axis=1, dtype=np.uint64)
        if corner_count == 5 and not is_face:
            self.pyramids[name].append(corners)
        else:
            (self.faces if is_face else self.cells)[name].append(signatures.sum(axis=1, dtype=np.uint64))
        (self.face_corners if is_face else self.corners)[name].append(corners)

    def table(self, which):
        return {name: np.sort(np.concatenate(parts)) for name, parts in getattr(self, which).items()}


# Readers.

def label(item):
    return item.attrs.get("label", b"") if isinstance(item, h5py.Group) else b""


def split_mixed(data):
    """elements of a mixed section: their codes and nodes"""
    at, elements = 0, []
    while at < len(data):
        family, degree = CODES[data[at]]
        count = FAMILIES[family][1][degree - 1]
        elements.append((data[at], data[at + 1:at + 1 + count]))
        at += 1 + count
    return elements


def read_cgns(path):
    mesh = Mesh()
    with h5py.File(path) as file:
        base = next(item for item in file.values() if label(item) == b"CGNSBase_t")
        for zone in base.values():
            if label(zone) != b"Zone_t":
                continue
            name = zone.name.split("/")[-1]
            points = np.stack([zone[f"GridCoordinates/Coordinate{x}/ data"][()] for x in "XYZ"], axis=1)
            signatures, faces = signatures_of_points(points), {}
            for section in zone.values():
                if label(section) != b"Elements_t":
                    continue
                code, first = section[" data"][0], section["ElementRange/ data"][0]
                nodes = section["ElementConnectivity/ data"][()]
                groups = defaultdict(lambda: ([], []))
                if code == MIXED:
                    for element, (kind, numbers) in enumerate(split_mixed(nodes)):
                        groups[kind][0].append(first + element)
                        groups[kind][1].append(numbers)
                elif code in CODES:
                    family, degree = CODES[code]
                    rows = nodes.reshape(-1, FAMILIES[family][1][degree - 1])
                    groups[code] = (range(first, first + len(rows)), rows)
                for kind, (numbers, rows) in groups.items():
                    family, degree = CODES[kind]
                    mesh.degrees.add(degree)
                    rows = signatures[np.array(rows) - 1]
                    if family in FACES:
                        faces.update(zip(numbers, ((rows[m:m + 1], FAMILIES[family][0]) for m in range(len(rows)))))
                    else:
                        mesh.add(name, False, rows, FAMILIES[family][0])
            for conditions in zone.values():
                if label(conditions) != b"ZoneBC_t":
                    continue
                for patch in conditions.values():
                    key = next(k for k in patch if k in ("PointList", "PointRange", "ElementList", "ElementRange"))
                    numbers = patch[key + "/ data"][()].ravel()
                    for number in range(numbers[0], numbers[-1] + 1) if key.endswith("Range") else numbers:
                        mesh.add(patch.name.split("/")[-1], True, *faces[number])
    return mesh


def read_msh(path):
    mesh = Mesh()
    gmsh.initialize(["-v", "1"])
    gmsh.option.setNumber("General.Terminal", 0)
    gmsh.open(str(path))
    tags, coordinates, _ = gmsh.model.mesh.getNodes()
    by_tag = np.zeros(int(tags.max()) + 1, dtype=np.uint64)
    by_tag[tags] = signatures_of_points(coordinates)
    for dimension, group in gmsh.model.getPhysicalGroups():
        name = gmsh.model.getPhysicalName(dimension, group)
        for entity in gmsh.model.getEntitiesForPhysicalGroup(dimension, group):
            for kind, elements, nodes in zip(*gmsh.model.mesh.getElements(dimension, entity)):
                _, _, degree, count, _, corner_count = gmsh.model.mesh.getElementProperties(kind) if kind not in PRISMS \
                    else (0, 0, *PRISMS[kind], [], 6)
                mesh.degrees.add(degree)
                mesh.add(name, dimension == 2, by_tag[nodes.reshape(-1, count)], corner_count)
    gmsh.finalize()
    return mesh


PRISMS = {90: (3, 40), 91: (4, 75), 106: (5, 126), 107: (6, 196)}  # of which Gmsh 4.8 cannot tell the properties


def read_vtu(path):
    mesh = Mesh()
    reader = vtk.vtkXMLUnstructuredGridReader()
    reader.SetFileName(str(path))
    reader.Update()
    grid = reader.GetOutput()
    signatures = signatures_of_points(vtk_to_numpy(grid.GetPoints().GetData()))
    offsets = vtk_to_numpy(grid.GetCells().GetOffsetsArray())
    connectivity = vtk_to_numpy(grid.GetCells().GetConnectivityArray())
    zones, patches = (vtk_to_numpy(grid.GetCellData().GetArray(name)) for name in ("zone", "patch"))
    names = {}
    for kind in ("zone", "patch"):
        array = grid.GetFieldData().GetAbstractArray(kind + "_names")
        names[kind] = [array.GetValue(m) for m in range(array.GetNumberOfValues())]
    corner_counts = {vtk.VTK_LAGRANGE_TRIANGLE: 3, vtk.VTK_LAGRANGE_QUADRILATERAL: 4, vtk.VTK_LAGRANGE_TETRAHEDRON: 4,
                     vtk.VTK_LAGRANGE_WEDGE: 6, vtk.VTK_LAGRANGE_HEXAHEDRON: 8}
    degree_of = {(4, 4, 3): 1, (4, 10, 3): 2, (4, 20, 3): 3, (4, 35, 3): 4}
    for cell in range(grid.GetNumberOfCells()):
        nodes = connectivity[offsets[cell]:offsets[cell + 1]]
        corner_count, is_face = corner_counts[grid.GetCellType(cell)], patches[cell] >= 0
        name = names["patch"][patches[cell]] if is_face else names["zone"][zones[cell]]
        if not is_face and corner_count == 4:
            mesh.degrees.add(degree_of[(4, len(nodes), 3)])
        if corner_count == 8 and len({signatures[node] for node in nodes[:8]}) == 5:
            nodes, corner_count = nodes[:5], 5  # a pyramid is a hexahedron with its top in one point
        mesh.add(name, is_face, signatures[nodes][None, :], corner_count)
    return mesh


def read_hopr(path):
    mesh = Mesh()
    with h5py.File(path) as file:
        degree = int(file.attrs["Ngeo"][0])
        mesh.degrees.add(degree)
        elements, sides, signatures = file["ElemInfo"][()], file["SideInfo"][()], signatures_of_points(file["NodeCoords"])
        zones = [bytes(name).decode().strip() for name in file["ZoneNames"]]
        patches = [bytes(name).decode().strip() for name in file["BCNames"]]
    for corner_count in SIDES:
        layout = Layout(corner_count, degree)
        order = layout.corners + [m for m in range(len(layout.nodes)) if m not in layout.corners]
        for _, zone, first_side, _, first, _ in elements[elements[:, 0] % 10 == corner_count]:
            mesh.add(zones[zone - 1], False, signatures[first + np.array(order)][None, :], corner_count)
            for side, corners in enumerate(layout.side_corners):
                condition = sides[first_side + side, 4]
                if condition > 0:
                    mesh.add(patches[condition - 1], True, signatures[first + np.array(corners)][None, :], len(corners))
    return mesh


# Comparison.

def same(a, b):
    return sorted(a) == sorted(b) and all(np.array_equal(a[name], b[name]) for name in a)


def compare(before, after, whole_faces):
    faults = [] if before.degrees == after.degrees or not after.degrees else [f"degrees {after.degrees}"]
    for which in ("cells", "pyramids", "corners", "faces" if whole_faces else "face_corners"):
        a, b = before.table(which), after.table(which)
        if not same(a, b):
            faults.append(f"{which}: " + ", ".join(
                f"'{name}' {len(a.get(name, ()))}/{len(b.get(name, ()))}" for name in sorted({*a, *b})
                if name not in a or name not in b or not np.array_equal(a[name], b[name])))
    return faults


def main():
    program, folder = sys.argv[1], Path(sys.argv[2])
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    meshes = [Path(name) for name in sys.argv[3:] if Path(name).exists()]
    print(f"{len(meshes)} of {len(sys.argv[3:])} meshes are there")
    is_good = len(meshes) > 0
    for mesh in meshes:
        if mesh.suffix not in (".cgns", ".msh"):
            source, mesh = mesh, folder / f"{mesh.stem}_first.cgns"
            subprocess.run([program, "convert", source, mesh, "-q"], check=True)
        before = read_msh(mesh) if mesh.suffix == ".msh" else read_cgns(mesh)
        source = mesh
        for suffix, options, read in ((".cgns", (), read_cgns), (".msh", (), read_msh),
                                      (".msh", ("--msh-version", "2.2"), read_msh), (".vtu", (), read_vtu),
                                      (".h5", (), read_hopr), (".cgns", (), read_cgns)):
            target = folder / f"{mesh.stem}_{len(list(folder.iterdir()))}{suffix}"
            run = subprocess.run([program, "convert", source, target, *options], capture_output=True, text=True)
            faults = [run.stderr] if run.returncode != 0 or run.stderr.count("\n") > 1 else []
            faults = faults or compare(before, read(target), suffix != ".h5")
            print(f"{mesh.name} -> {target.name} {' '.join(options)}: {'; '.join(faults) or 'the same'}  {run.stderr.strip()}")
            is_good = is_good and not faults
            source = target
    sys.exit(0 if is_good else 1)


if __name__ == "__main__":
    main()
