#!/usr/bin/python3
"""The traps between formats, one check each: what goes wrong if a file is written a little differently, and where foreign
readers are known to be wrong, that they are wrong in the known way and not we.

usage: traps_test.py WRITE_VTK_SAMPLES WRITE_CGNS_SAMPLES WRITE_MSH_SAMPLES FOLDER
"""
import random
import shutil
import subprocess
import sys
import unittest
from pathlib import Path

import h5py
import numpy as np
import vtk

from vtk_reader_test import CORNERS, distance, location, polynomial_map, random_point_in_cell

FOLDER = None
EXACT, WRONG = 1e-13, 1e-3  # round-off; and what is plainly another cell


def read_vtu(path):
    reader = vtk.vtkXMLUnstructuredGridReader()
    reader.SetFileName(str(path))
    reader.Update()
    return reader.GetOutput()


def read_cgns(path):
    reader = vtk.vtkCGNSReader()
    reader.SetFileName(str(path))
    reader.Update()
    iterator = reader.GetOutput().NewIterator()
    iterator.InitTraversal()
    return iterator.GetCurrentDataObject()


def error_of(cell, name, degree):
    """distance of VTK's map from the polynomial that curved the cell"""
    random.seed(20240611)
    points = [random_point_in_cell(name) for _ in range(40)]
    return max(distance(location(cell, parametric), polynomial_map(degree, xi)) for parametric, xi in points)


def nodes(cell):
    return np.array([cell.GetPoints().GetPoint(m) for m in range(cell.GetNumberOfPoints())])


def volume(cell_type, points):
    grid, coordinates, ids = vtk.vtkUnstructuredGrid(), vtk.vtkPoints(), vtk.vtkIdList()
    for point in points:
        ids.InsertNextId(coordinates.InsertNextPoint(point))
    grid.SetPoints(coordinates)
    grid.InsertNextCell(cell_type, ids)
    sizes = vtk.vtkCellSizeFilter()
    sizes.SetInputData(grid)
    sizes.Update()
    return sizes.GetOutput().GetCellData().GetArray("Volume").GetTuple1(0)


# Elements that PyFR knows, and the numbers of their nodes.
PYFR_TYPES = {2: 3, 9: 6, 21: 10, 23: 15, 3: 4, 10: 9, 36: 16, 37: 25, 4: 4, 11: 10, 29: 20, 30: 35, 5: 8, 12: 27,
              92: 64, 93: 125, 6: 6, 13: 18, 90: 40, 91: 75, 7: 5, 14: 14, 118: 30, 119: 55}


def sections_of(path):
    """the lines of each section of a text MSH file; every section is closed by its own mark"""
    lines = iter(path.read_text().splitlines())
    sections = {}
    for line in lines:
        name, content = line[1:], []
        assert line == f"${name}" and name not in sections, line
        for inner in lines:
            if inner == f"$End{name}":
                break
            content.append(inner.split())
        else:
            raise AssertionError(f"${name} is not closed")
        sections[name] = content
    return sections


def check_as_pyfr(test, path):
    """PyFR takes text of version 4.1; names and numbers of groups may occur once, whatever the dimension, and every
    entity with elements belongs to exactly one"""
    sections = sections_of(path)
    test.assertEqual(sections["MeshFormat"], [["4.1", "0", "8"]])
    names = [(int(line[1]), " ".join(line[2:]).lower()) for line in sections["PhysicalNames"][1:]]
    test.assertEqual(int(sections["PhysicalNames"][0][0]), len(names))
    test.assertEqual(len({number for number, _ in names}), len(names))
    test.assertEqual(len({name for _, name in names}), len(names))
    group_of, entities = {}, iter(sections["Entities"])
    points, curves, surfaces, volumes = map(int, next(entities))
    test.assertEqual((points, curves), (0, 0))
    for dimension, count in ((2, surfaces), (3, volumes)):
        for line in (next(entities) for _ in range(count)):
            test.assertEqual(line[7], "1")
            group_of[dimension, int(line[0])] = int(line[8])
    test.assertTrue(set(group_of.values()) <= {number for number, _ in names})
    nodes = iter(sections["Nodes"])
    blocks, count, first, last = map(int, next(nodes))
    test.assertEqual((first, last), (1, count))
    numbers = []
    for _ in range(blocks):
        size = int(next(nodes)[3])
        numbers += [int(next(nodes)[0]) for _ in range(size)]
        test.assertTrue(all(len(next(nodes)) == 3 for _ in range(size)))
    test.assertEqual(sorted(numbers), list(range(1, count + 1)))
    elements = iter(sections["Elements"])
    blocks, count = map(int, next(elements)[:2])
    for _ in range(blocks):
        dimension, tag, kind, size = map(int, next(elements))
        test.assertIn((dimension, tag), group_of)
        test.assertTrue(all(len(next(elements)) == 1 + PYFR_TYPES[kind] for _ in range(size)))
        count -= size
    test.assertEqual((count, list(elements)), (0, []))


class Traps(unittest.TestCase):
    def test_hexahedra_of_vtk_files_before_version_2(self):
        """VTK 9.1 renumbered two edges of hexahedra and takes files of version 1 for the old numbering"""
        path = FOLDER / "vtk" / "hexahedron_3.vtu"
        self.assertLess(error_of(read_vtu(path).GetCell(0), "hexahedron", 3), EXACT)
        old = FOLDER / "old_version.vtu"
        old.write_bytes(path.read_bytes().replace(b'version="2.2"', b'version="1.0"'))
        self.assertGreater(error_of(read_vtu(old).GetCell(0), "hexahedron", 3), WRONG)

    def test_orientation_of_wedges(self):
        """VTK's linear wedge has its triangles the other way round than CGNS, Gmsh and its own Lagrange wedge"""
        prism = CORNERS["prism"]
        self.assertLess(volume(vtk.VTK_WEDGE, prism), 0)
        self.assertGreater(volume(vtk.VTK_LAGRANGE_WEDGE, prism), 0)
        grid = read_vtu(FOLDER / "vtk" / "prism_1.vtu")
        self.assertEqual(grid.GetCellType(0), vtk.VTK_LAGRANGE_WEDGE)
        self.assertGreater(volume(vtk.VTK_LAGRANGE_WEDGE, nodes(grid.GetCell(0))), 0)

    def test_pyramids_in_vtk_files(self):
        """VTK has no Lagrange pyramid: of such a cell it makes none; ours is a hexahedron, which is the same cell"""
        for degree in range(1, 7):
            cell = read_vtu(FOLDER / "vtk" / f"pyramid_{degree}.vtu").GetCell(0)
            self.assertEqual(cell.GetCellType(), vtk.VTK_LAGRANGE_HEXAHEDRON)
            self.assertLess(error_of(cell, "pyramid", degree), EXACT)

    def test_cgns_where_vtk_is_right(self):
        for name, degree in (("tetrahedron", 1), ("tetrahedron", 2), ("tetrahedron", 3), ("prism", 1), ("prism", 2),
                             ("hexahedron", 1), ("hexahedron", 2), ("pyramid", 1)):
            cell = read_cgns(FOLDER / "cgns" / f"{name}_{degree}.cgns").GetCell(0)
            self.assertLess(error_of(cell, name, degree), EXACT, (name, degree))

    def test_cubic_cgns_cells_in_vtk(self):
        """VTK 9.1 reads HEXA_64 with two edges and PENTA_40 with one face in an order that its own cells do not have; its
        later versions agree with the SIDS. Its nodes are those of our VTU file, which it evaluates exactly, but for
        those."""
        for name, swapped in (("hexahedron", {28: 30, 29: 31, 30: 28, 31: 29}),
                              ("prism", {34: 35, 35: 34, 36: 37, 37: 36})):
            ours = nodes(read_vtu(FOLDER / "vtk" / f"{name}_3.vtu").GetCell(0))
            theirs = nodes(read_cgns(FOLDER / "cgns" / f"{name}_3.cgns").GetCell(0))
            order = [swapped.get(m, m) for m in range(len(ours))]
            with self.subTest(name):
                self.assertTrue(np.array_equal(theirs, ours) or np.array_equal(theirs, ours[order]))

    def test_quartic_cgns_cells_in_vtk(self):
        """VTK 9.1 makes empty cells of them, later versions a wrong TETRA_35: no reader to compare with. The order is that
        of the SIDS by its own tables, see cgns_reader_test.py."""
        for name in ("tetrahedron", "hexahedron"):
            grid = read_cgns(FOLDER / "cgns" / f"{name}_4.cgns")
            if grid.GetCellType(0) == vtk.VTK_EMPTY_CELL:
                continue
            if name == "hexahedron":
                self.assertLess(error_of(grid.GetCell(0), name, 4), EXACT)

    def test_groups_of_msh_files_for_pyfr(self):
        for name in ("two_zones", *(f"{cell}_{degree}" for cell in CORNERS for degree in range(1, 5))):
            check_as_pyfr(self, FOLDER / "msh" / f"{name}_v41_ascii.msh")

    def test_tags_of_msh_files_for_mfem(self):
        """MFEM reads version 2.2 alone, and stops at an element whose first tag, its physical group, is not positive"""
        for name in ("two_zones", *(f"{cell}_{degree}" for cell in CORNERS for degree in range(1, 7))):
            sections = sections_of(FOLDER / "msh" / f"{name}_v22_ascii.msh")
            self.assertEqual(sections["MeshFormat"], [["2.2", "0", "8"]])
            groups = {int(line[1]) for line in sections["PhysicalNames"][1:]}
            for _, _, tags, group, *_ in sections["Elements"][1:]:
                self.assertGreaterEqual(int(tags), 2)
                self.assertIn(int(group), groups)
                self.assertGreater(int(group), 0)

    def test_version_stamps_of_cgns(self):
        """libcgns 3 refuses files stamped 4.0 and later; ours are stamped below, whatever wrote them"""
        path = FOLDER / "cgns" / "prism_2.cgns"
        with h5py.File(path) as file:
            stamp = float(file["CGNSLibraryVersion/ data"][0])
        self.assertLess(stamp, 4)
        later = FOLDER / "later.cgns"
        shutil.copy(path, later)
        with h5py.File(later, "r+") as file:
            file["CGNSLibraryVersion/ data"][0] = 4.5
        check = [subprocess.run(["cgnscheck", str(p)], capture_output=True, text=True) for p in (path, later)]
        self.assertEqual(check[0].returncode, 0)
        self.assertIn("more recent version", check[1].stdout + check[1].stderr)


if __name__ == "__main__":
    FOLDER = Path(sys.argv[4])
    for program, name in ((sys.argv[1], "vtk"), (sys.argv[2], "cgns"), (sys.argv[3], "msh")):
        subprocess.run([program, str(FOLDER / name)], check=True)
    unittest.main(argv=sys.argv[:1], verbosity=2)
