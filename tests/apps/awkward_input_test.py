#!/usr/bin/python3
"""Awkward and malformed meshes, one test per kind: a script writes each file, small, and the program does with it what it is
documented to do.

usage: awkward_input_test.py RECURVE FOLDER
"""
import json
import shutil
import subprocess
import sys
import unittest
from pathlib import Path

import h5py
import numpy

RECURVE, FOLDER = None, None
DONE, BAD_INPUT, UNCERTIFIED = 0, 2, 3
GMSH_TYPES = {"triangle": 2, "quadrangle": 3, "tetrahedron": 4, "hexahedron": 5, "prism": 6, "pyramid": 7,
              "tetrahedron of degree 2": 11}


def point(i, j, k, n=2):
    """number of a point of box(), counted from 1"""
    return 1 + i + (n + 1) * (j + (n + 1) * k)


def box(n=2):
    """points, zones and patches of a unit cube of n^3 hexahedra"""
    points = [(i / n, j / n, k / n) for k in range(n + 1) for j in range(n + 1) for i in range(n + 1)]
    corners = ((0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1))
    cells = [("hexahedron", [point(i + a, j + b, k + c, n) for a, b, c in corners])
             for k in range(n) for j in range(n) for i in range(n)]
    patches = {}
    for axis, end in ((axis, end) for axis in range(3) for end in (0, n)):
        def at(u, v, axis=axis, end=end):
            return point(*[(end, u, v), (u, end, v), (u, v, end)][axis], n)
        patches["xyz"[axis] + ("min" if end == 0 else "max")] = [
            ("quadrangle", [at(u, v), at(u + 1, v), at(u + 1, v + 1), at(u, v + 1)])
            for u in range(n) for v in range(n)]
    return points, {"box": cells}, patches


def write_msh(path, points, zones, patches):
    """as MSH 2.2; a patch without a name is in no physical group"""
    groups = [(3, 1 + z, name, cells) for z, (name, cells) in enumerate(zones.items())]
    groups += [(2, 100 + p if name else 0, name, faces) for p, (name, faces) in enumerate(patches.items())]
    names = [f'{dimension} {number} "{name}"' for dimension, number, name, _ in groups if number]
    elements = [(GMSH_TYPES[kind], number, nodes) for _, number, _, members in groups for kind, nodes in members]
    lines = ["$MeshFormat", "2.2 0 8", "$EndMeshFormat", "$PhysicalNames", len(names), *names, "$EndPhysicalNames",
             "$Nodes", len(points), *(f"{m} {x!r} {y!r} {z!r}" for m, (x, y, z) in enumerate(points, 1)), "$EndNodes",
             "$Elements", len(elements),
             *(f"{e} {kind} 2 {group} {group} {' '.join(map(str, nodes))}"
               for e, (kind, group, nodes) in enumerate(elements, 1)), "$EndElements"]
    path.write_text("\n".join(map(str, lines)) + "\n")


def recurve(*arguments):
    return subprocess.run([RECURVE, *map(str, arguments)], capture_output=True, text=True, timeout=300)


class Awkward_input(unittest.TestCase):
    def setUp(self):
        self.folder = FOLDER / self.id().split(".")[-1]
        shutil.rmtree(self.folder, ignore_errors=True)
        self.folder.mkdir(parents=True)
        self.mesh = self.folder / "mesh.msh"
        self.points, self.zones, self.patches = box()
        self.cells = self.zones["box"]

    def write(self):
        write_msh(self.mesh, self.points, self.zones, self.patches)

    def write_cgns(self):
        """the same as CGNS, for what only CGNS can say"""
        self.write()
        cgns = self.folder / "mesh.cgns"
        self.assertEqual(recurve("convert", self.mesh, cgns, "-q").returncode, DONE)
        self.mesh.unlink()
        self.mesh = cgns

    def info(self):
        run = recurve("info", self.mesh, "--json")
        self.assertEqual((run.returncode, run.stderr), (DONE, ""))
        return json.loads(run.stdout)

    def patch(self, name):
        return next(patch for patch in self.info()["patches"] if patch["name"] == name)

    def assert_told(self, *words):
        told = recurve("info", self.mesh).stdout
        for word in words:
            self.assertIn(word, told)

    def assert_curved(self):
        """`curve` works, and what it writes is certified valid"""
        out = self.folder / "out.msh"
        run = recurve("curve", self.mesh, out, "-q")
        self.assertEqual(run.returncode, DONE, run.stderr)
        self.assertEqual(recurve("check", out).returncode, DONE)
        return out

    def assert_refused(self, *words, commands=("info", "check", "convert", "curve")):
        """one line that names the file and the fault, and no output"""
        before = sorted(self.folder.iterdir())
        for command in commands:
            run = recurve(command, self.mesh, *([self.folder / "out.cgns"] if command in ("convert", "curve") else []))
            self.assertEqual((run.returncode, run.stdout), (BAD_INPUT, ""), command)
            self.assertEqual(run.stderr.count("\n"), 1, run.stderr)
            self.assertNotIn("\x1b", run.stderr)
            for word in (str(self.mesh), *words):
                self.assertIn(word, run.stderr)
        self.assertEqual(sorted(self.folder.iterdir()), before)

    # Nodes.

    def test_node_that_does_not_exist(self):
        for node in (0, 28, -1, 2**31, 2**32 + 1, 10**30):
            self.cells[3] = ("hexahedron", self.cells[3][1][:7] + [node])
            self.write()
            self.assert_refused("mesh.msh: line ", str(node))

    def test_coordinate_that_is_no_number(self):
        for value in ("nan", "inf"):
            self.points[5] = (0.0, float(value), 0.0)
            self.write()
            self.assert_refused("node 6", "coordinate Y", value)

    def test_duplicated_node_in_a_zone(self):
        """a zone means what it says: the cells are apart there, and the faces between them are boundary"""
        self.points.append(self.points[point(1, 1, 1) - 1])
        kind, nodes = self.cells[7]
        self.cells[7] = (kind, [28 if node == point(1, 1, 1) else node for node in nodes])
        self.write()
        self.assertEqual(self.info()["points"], 28)
        self.assertEqual(self.patch("unassigned")["quadrangles"], 6)
        self.assert_curved()

    def test_unused_node(self):
        self.points.append((5.0, 5.0, 5.0))
        self.write()
        self.assertEqual(self.info()["points"], 28)
        out = self.folder / "ascii.msh"
        self.assertEqual(recurve("convert", self.mesh, out, "--ascii", "-q").returncode, DONE)
        self.assertIn(b"\n5 5 5", out.read_bytes())
        self.assert_curved()

    def test_small_cells_far_from_the_origin(self):
        """cells of 1e-6 at 1e6: their coordinates have four digits left"""
        self.points = [tuple(1e6 + 1e-6 * x for x in p) for p in self.points]
        self.write()
        self.assert_curved()

    def test_cells_a_hundred_thousand_times_as_long_as_thick(self):
        self.points = [(x, y, 1e-5 * z) for x, y, z in self.points]
        self.write()
        self.assert_curved()

    # Cells.

    def test_duplicated_cell(self):
        self.cells.append(self.cells[0])
        self.write()
        self.assert_told("3 faces have more than two cells: cells overlap")

    def test_cells_inside_out(self):
        """are turned for curving; `check` and `convert` take the file as it is"""
        for which in (range(8), [3]):
            _, zones, _ = box()
            for m in which:
                nodes = zones["box"][m][1]
                self.cells[m] = ("hexahedron", nodes[4:] + nodes[:4])
            self.write()
            self.assert_told(f"{len(which)} cells are inside out and are turned")
            self.assertEqual(recurve("check", self.mesh).returncode, UNCERTIFIED)
            self.assert_curved()
            self.setUp()

    def test_folded_cell(self):
        """is named and stays; the rest is curved"""
        nodes = self.cells[3][1]
        self.cells[3] = ("hexahedron", nodes[:6] + [nodes[7], nodes[6]])
        self.write()
        self.assert_told("1 cells are folded (corner Jacobians of both signs)")
        check = recurve("check", self.mesh)
        self.assertEqual(check.returncode, UNCERTIFIED)
        self.assertIn("invalid", check.stdout)
        self.assertEqual(recurve("curve", self.mesh, self.folder / "out.msh", "-q").returncode, DONE)

    def test_collapsed_hexahedron(self):
        """a prism in the disguise of a hexahedron is a cell like others, but no determinant is positive at its edge"""
        a, b, c, d, e, f, g, h = (point(*ijk, 1) for ijk in ((0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1),
                                                             (1, 0, 1), (1, 1, 1), (0, 1, 1)))
        self.points = box(1)[0]
        self.zones = {"box": [("hexahedron", [a, b, c, c, e, f, g, g]), ("prism", [a, c, d, e, g, h])]}
        self.patches = {}
        self.write()
        summary = self.info()
        self.assertEqual((summary["cells_by_type"]["hexahedron"], summary["cells_by_type"]["prism"]), (1, 1))
        self.assertEqual(recurve("curve", self.mesh, self.folder / "out.msh", "-q").returncode, DONE)

    def test_hanging_nodes(self):
        """one large cell beside four small ones: the faces do not meet and are boundary, which is told"""
        coarse = [point(1, 0, 0), 28, 29, point(1, 2, 0), point(1, 0, 2), 30, 31, point(1, 2, 2)]
        self.points += [(2.0, 0.0, 0.0), (2.0, 1.0, 0.0), (2.0, 0.0, 1.0), (2.0, 1.0, 1.0)]
        self.zones = {"box": [cell for m, cell in enumerate(self.cells) if m % 2 == 0] + [("hexahedron", coarse)]}
        del self.patches["xmax"]
        self.write()
        self.assertGreaterEqual(self.patch("unassigned")["quadrangles"], 5)
        self.assert_told('boundary faces are in no patch; they became the patch "unassigned"')
        self.assert_curved()

    # Faces.

    def test_boundary_faces_without_a_patch(self):
        self.patches = {"xmin": self.patches["xmin"]}
        self.write()
        self.assertEqual(self.patch("unassigned")["quadrangles"], 20)
        self.assert_curved()

    def test_faces_in_no_physical_group(self):
        self.patches[""] = self.patches.pop("xmin")
        self.write()
        self.assertEqual(self.patch("surface_0")["quadrangles"], 4)
        self.assert_curved()

    def test_duplicated_boundary_face(self):
        for name in ("xmin", "again"):
            self.patches.setdefault(name, []).append(self.patches["xmin"][0])
            self.write()
            self.assert_told("1 faces are listed more than once")
            self.assert_curved()
            self.setUp()

    def test_boundary_faces_either_way_round(self):
        """are oriented by their cells: the curved mesh is the same"""
        self.write()
        before = self.assert_curved().read_bytes()
        sound = self.patches["xmin"]
        self.patches["xmin"] = [(kind, nodes[:1] + nodes[:0:-1]) if m % 2 else (kind, nodes)
                                for m, (kind, nodes) in enumerate(sound)]
        self.assertNotEqual(self.patches["xmin"], sound)
        self.write()
        self.assertEqual(self.assert_curved().read_bytes(), before)

    def test_face_without_area(self):
        self.patches["line"] = [("triangle", [1, 2, 2])]
        self.write()
        self.assert_told("1 faces belong to no cell")
        self.assert_curved()

    def test_face_of_no_cell(self):
        self.patches["adrift"] = [("triangle", [1, 14, 27])]
        self.write()
        self.assertEqual(self.patch("adrift")["place"], "nowhere")
        self.assert_told("1 faces belong to no cell")
        self.assert_curved()

    def test_patch_inside_the_volume(self):
        """a baffle, or a condition on faces that two cells share: kept, named as internal, straight unless named"""
        self.patches["baffle"] = [("quadrangle", [point(1, j, k) for j, k in ((0, 0), (1, 0), (1, 1), (0, 1))])]
        self.write()
        self.assertEqual(self.patch("baffle")["place"], "internal")
        self.assert_curved()

    def test_bodies_that_touch_in_an_edge_or_a_vertex(self):
        """the boundary is no manifold there and comes apart"""
        for kept in ((0, 3), (0, 7)):  # cells of a cube of eight that share an edge, a vertex
            self.zones = {"box": [self.cells[m] for m in kept]}
            self.patches = {}
            self.write()
            self.assertEqual(self.patch("unassigned")["quadrangles"], 12)
            self.assert_curved()

    # Counts, files and their kinds.

    def test_counts_that_cannot_be(self):
        self.write()
        sound = self.mesh.read_text()
        for count in ("-8", "9000000000", "18446744073709551615", "1e9"):
            for section, old in (("$Nodes", "27"), ("$Elements", "32")):
                self.mesh.write_text(sound.replace(f"{section}\n{old}\n", f"{section}\n{count}\n"))
                self.assertNotEqual(self.mesh.read_text(), sound)
                self.assert_refused("mesh.msh: line ", count)

    def test_file_cut_anywhere(self):
        self.write()
        sound = self.mesh.read_bytes()
        for part in (0, 0.01, 0.3, 0.6, 0.9):
            self.mesh.write_bytes(sound[:int(part * len(sound))])
            self.assert_refused()

    def test_cgns_cut_anywhere(self):
        self.write_cgns()
        sound = self.mesh.read_bytes()
        for part in (0, 0.01, 0.3, 0.6, 0.9):
            self.mesh.write_bytes(sound[:int(part * len(sound))])
            self.assert_refused()

    def test_two_dimensional_mesh(self):
        self.zones = {}
        self.patches = {"plane": self.patches["zmin"]}
        self.write()
        self.assert_refused("only 3D meshes")

    def test_old_msh_versions(self):
        self.write()
        sound = self.mesh.read_text()
        self.mesh.write_text(sound.replace("2.2 0 8", "4 0 8"))
        self.assert_refused("version 4", "msh41")
        self.mesh.write_text("$NOD\n1\n1 0 0 0\n$ENDNOD\n$ELM\n0\n$ENDELM\n")
        self.assert_refused("version 1", "msh41")

    def test_mesh_of_high_order(self):
        """is converted and checked, but not curved once more"""
        points, patches = [(0., 0., 0.), (1., 0., 0.), (0., 1., 0.), (0., 0., 1.)], {}
        points += [tuple((a + b) / 2 for a, b in zip(points[m], points[n]))
                   for m, n in ((0, 1), (1, 2), (2, 0), (3, 0), (2, 3), (1, 3))]
        write_msh(self.mesh, points, {"cell": [("tetrahedron of degree 2", list(range(1, 11)))]}, patches)
        self.assert_refused("degree 2", commands=("curve",))
        self.assertEqual(recurve("check", self.mesh).returncode, DONE)
        self.assertEqual(recurve("convert", self.mesh, self.folder / "out.cgns").returncode, DONE)

    def test_elements_of_two_degrees(self):
        self.points += [(0., 0., 5.)] * 6
        self.cells.append(("tetrahedron of degree 2", [1, 2, 4, 10, 28, 29, 30, 31, 32, 33]))
        self.write()
        self.assert_refused("degree 2", "degree 1")

    # What CGNS says.

    def test_polyhedra(self):
        self.write_cgns()
        for kind, name in ((22, "NGON_n"), (23, "NFACE_n")):
            with h5py.File(self.mesh, "r+") as file:
                file["Base/box/hexahedron/ data"][0] = kind
            self.assert_refused("zone 'box', section 'hexahedron'", name, "polyhedra")

    def test_several_bases(self):
        """the first 3D one is read, the others are named"""
        self.write_cgns()
        with h5py.File(self.mesh, "r+") as file:
            file.copy("Base", "Second")
            file["Second"].attrs["name"] = numpy.array("Second", dtype="S33")
        self.assert_told("'Second' is left out", "2 bases")
        self.assert_curved()

    def test_node_number_that_overflows(self):
        self.write_cgns()
        with h5py.File(self.mesh, "r+") as file:
            file["Base/box/hexahedron/ElementConnectivity/ data"][11] = -2**31
        self.assert_refused("zone 'box', section 'hexahedron', element 2: node 4 is number -2147483648")

    def test_zones_that_touch_without_saying_so(self):
        """nodes that coincide within a tolerance are one; what was the boundary between is an interface"""
        left, right = [cell for m, cell in enumerate(self.cells) if m % 2 == 0], self.cells[1::2]
        first = len(self.points)
        shifted = [(x + (1e-9 if x == 0.5 else 0), y, z) for x, y, z in self.points]
        self.points += shifted
        self.zones = {"left": left, "right": [(kind, [node + first for node in nodes]) for kind, nodes in right]}
        self.patches = {}
        self.write()
        self.assertEqual(self.patch("unassigned")["quadrangles"], 12)
        self.assert_curved()

    def test_zones_that_do_not_match(self):
        """stay apart: both sides are boundary"""
        first = len(self.points)
        self.points += [(x + 1, 0.9 * y, z) for x, y, z in self.points]
        self.zones = {"left": self.cells, "right": [(kind, [n + first for n in nodes]) for kind, nodes in self.cells]}
        self.patches = {}
        self.write()
        self.assertEqual(self.patch("unassigned")["quadrangles"], 24)
        self.assert_curved()

    def test_names(self):
        """with spaces, of 32 characters, beyond that, and in UTF-8"""
        for name in ("a zone", "x" * 32, "y" * 50, "Flügel äöü"):
            self.setUp()
            self.zones = {name: self.cells}
            self.patches = {f"{name} {number}": faces for number, faces in enumerate(self.patches.values())}
            self.write()
            self.assertEqual([zone["name"] for zone in self.info()["zones"]], [name])
            self.write_cgns()
            summary = self.info()
            self.assertEqual([zone["name"] for zone in summary["zones"]], [name[:32]])
            self.assertEqual(len({patch["name"] for patch in summary["patches"]}), 6)
            self.assert_curved()


if __name__ == "__main__":
    RECURVE, FOLDER = sys.argv[1], Path(sys.argv[2])
    unittest.main(argv=sys.argv[:1], verbosity=2)
