#!/usr/bin/python3
"""Runs the program as a user does: output, messages, exit status, and what is left on the disk.

usage: command_line_test.py RECURVE WRITE_SAMPLE_MESHES FOLDER
"""
import json
import os
import pty
import resource
import shutil
import signal
import subprocess
import sys
import time
import unittest
from pathlib import Path

import h5py
import numpy
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkIOImage import vtkPNGReader

RECURVE, WRITE_SAMPLES, FOLDER = None, None, None

DONE, USAGE, BAD_INPUT, UNCERTIFIED, INTERRUPTED = 0, 1, 2, 3, 130

WING = Path(__file__).resolve().parents[2] / "data" / "wing_tetrahedra.cgns"

# Options of the detection with values other than the defaults, in the right order among themselves.
THRESHOLDS = {"--weak-angle": 12.5, "--end-angle": 26, "--strong-angle": 51, "--strong-edges": 6, "--sharp-angle": 66,
              "--acute-angle": 91.5, "--corner-defect": 61, "--turning-angle": 45, "--ridge-deviation": 21,
              "--ridge-ratio": 0.6, "--smooth-angle": 41, "--smooth-contrast": 2.5, "--crease-contrast": 3.5}
SWITCHES = {"--no-border-ends": ("border_ends", False), "--no-reject-smooth": ("reject_smooth", False),
            "--patch-edges": ("patch_edges", True), "--smooth-patches": ("smooth_patches", True)}


def recurve(*arguments, **options):
    return subprocess.run([RECURVE, *map(str, arguments)], capture_output=True, text=True, timeout=300, **options)


def read_png(path):
    """rows from the top of pixels of red, green and blue, as VTK reads them."""
    reader = vtkPNGReader()
    reader.SetFileName(str(path))
    reader.Update()
    width, height, _ = reader.GetOutput().GetDimensions()
    pixels = vtk_to_numpy(reader.GetOutput().GetPointData().GetScalars())
    return pixels.reshape(height, width, -1)[::-1]


class Command_line(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.samples = FOLDER / "samples"
        subprocess.run([WRITE_SAMPLES, str(cls.samples)], check=True)

    def setUp(self):
        self.folder = FOLDER / self.id().split(".")[-1]
        shutil.rmtree(self.folder, ignore_errors=True)
        self.folder.mkdir(parents=True)
        self.mesh = self.folder / "shell.cgns"
        shutil.copy(self.samples / "shell.cgns", self.mesh)
        self.out = self.folder / "out.cgns"
        self.report = self.folder / "report.json"

    def files(self):
        return sorted(path.name for path in self.folder.iterdir())

    def assert_fails(self, run, status, *words):
        """one line on standard error with all of `words`, nothing on standard output"""
        self.assertEqual(run.returncode, status, run.stderr)
        self.assertEqual(run.stdout, "")
        self.assertTrue(run.stderr.startswith("recurve: "), run.stderr)
        self.assertEqual(run.stderr.count("\n"), 1, run.stderr)
        self.assertTrue(run.stderr.endswith("\n"))
        for word in words:
            self.assertIn(word, run.stderr)

    def assert_refuses(self, status, *words, arguments=(), mesh=None):
        """`recurve curve` fails and leaves nothing behind"""
        before = self.files()
        run = recurve("curve", mesh or self.mesh, self.out, "--report", self.report, *arguments)
        self.assert_fails(run, status, *words)
        self.assertEqual(self.files(), before)

    # What the program says of itself.

    def test_help_and_version(self):
        run = recurve("--help")
        self.assertEqual(run.returncode, DONE)
        for word in ("Examples:", "recurve curve wing.cgns curved.cgns", "Exit status", "info"):
            self.assertIn(word, run.stdout)
        for option in ("--degree", "--fit-degree", "--curve", "--keep", "--features", "--feature-angle", "--report",
                       "--threads", "--quiet"):
            self.assertIn(option, recurve("curve", "--help").stdout)
        self.assertIn("--output", recurve("features", "--help").stdout)
        for command in ("check", "convert", "curve", "features", "formats", "info"):
            text = recurve(command, "--help").stdout
            self.assertIn("Usage: recurve " + command, text)
            self.assertNotIn("{", text)  # how CLI11 writes flags with a value
            self.assertNotIn(" :", text)
        self.assertRegex(recurve("--version").stdout, r"^recurve \d+\.\d+\.\d+\n$")

    # The command line itself.

    def test_usage(self):
        self.assert_fails(recurve(), USAGE, "--help")
        self.assert_fails(recurve("bend"), USAGE, "bend")
        self.assert_fails(recurve("curve", self.mesh), USAGE, "OUT")
        self.assert_refuses(USAGE, "--speed", arguments=["--speed", "3"])
        self.assert_refuses(USAGE, "7", arguments=["--degree", "7"])
        self.assert_refuses(USAGE, "0", arguments=["--threads", "0"])
        self.assert_refuses(USAGE, "--feature-angle", arguments=["--features", "none", "--feature-angle", "30"])

    def test_output_that_cannot_hold_the_result(self):
        self.assert_refuses(USAGE, "out.cgns", "degree 5", "VTU", arguments=["--degree", "5"])
        self.out = self.folder / "out.stl"
        self.assert_refuses(USAGE, "out.stl", ".cgns", ".vtu")

    def test_input_is_never_overwritten(self):
        before = self.mesh.read_bytes()
        self.out = self.mesh
        self.assert_refuses(USAGE, "shell.cgns", "same file")
        os.link(self.mesh, self.folder / "hard.cgns")
        self.out = self.folder / "hard.cgns"
        self.assert_refuses(USAGE, "hard.cgns", "same file")
        (self.folder / "soft.cgns").symlink_to("shell.cgns")
        self.out = self.folder / "soft.cgns"
        self.assert_refuses(USAGE, "soft.cgns", "same file")
        self.out, self.report = self.folder / "out.cgns", self.mesh
        self.assert_refuses(USAGE, "shell.cgns", "report")
        self.assertEqual(self.mesh.read_bytes(), before)

    # What works.

    def test_info(self):
        run = recurve("info", self.mesh)
        self.assertEqual((run.returncode, run.stderr), (DONE, ""))
        for word in ("192 cells in 1 zone", "192 hexahedra", "294 points", "sphere", "BCWall", "outer", "BCFarfield"):
            self.assertIn(word, run.stdout)
        summary = json.loads(recurve("info", self.mesh, "--json").stdout)
        self.assertEqual(summary["cells_by_type"], {"tetrahedron": 0, "pyramid": 0, "prism": 0, "hexahedron": 192})
        self.assertEqual([(p["name"], p["quadrangles"], p["place"]) for p in summary["patches"]],
                         [("sphere", 96, "boundary"), ("outer", 96, "boundary")])
        self.assertEqual((summary["degree"], summary["nodes"], summary["straight_cells"]), (1, 294, 192))
        self.assertEqual(self.files(), ["shell.cgns"])

    def test_info_on_a_curved_mesh(self):
        recurve("curve", self.mesh, self.out, "-p", "3")
        run = recurve("info", self.out)
        self.assertEqual((run.returncode, run.stderr), (DONE, ""))
        nodes = 96 * 9 * 7 + 2 * 7  # 96 faces of 3 x 3 nodes around and 2 more, in 2 layers of 3 nodes and 1 more
        self.assertIn(f"of degree 3: {nodes:,} nodes", run.stdout)
        summary = json.loads(recurve("info", self.out, "--json").stdout)
        self.assertEqual((summary["degree"], summary["nodes"], summary["cells"]), (3, nodes, 192))

    def test_check(self):
        run = recurve("check", self.mesh)
        self.assertEqual((run.returncode, run.stderr), (DONE, ""))
        for word in ("degree 1", "192 cells", "hexahedra", "worst cells", "every cell is certified valid"):
            self.assertIn(word, run.stdout)
        recurve("curve", self.mesh, self.out)
        found = json.loads(recurve("check", self.out, "--json", "--worst", "3").stdout)
        self.assertTrue(found["is_valid"])
        self.assertEqual((found["degree"], found["cells"], len(found["worst_cells"])), (2, 192, 3))
        self.assertEqual(found["jacobians"]["by_type"]["hexahedron"]["valid"], 192)

    def test_check_finds_a_folded_cell(self):
        recurve("curve", self.mesh, self.out)
        with h5py.File(self.out, "r+") as file:
            zone = file["Base/shell"]
            nodes = zone["cells/ElementConnectivity/ data"][:27]
            inside = nodes[26] - 1  # the node in the middle of the first cell goes where its first corner is
            for c in "XYZ":
                x = zone[f"GridCoordinates/Coordinate{c}/ data"]
                x[inside] = x[nodes[0] - 1]
        picture = self.folder / "verdict.vtu"
        run = recurve("check", self.out, "--vtu", picture)
        self.assertEqual((run.returncode, run.stderr), (UNCERTIFIED, ""))
        for word in ("NOT VALID: 1 invalid", "invalid hexahedron 0", "sphere"):
            self.assertIn(word, run.stdout)
        self.assertTrue(picture.exists())

    def test_check_refuses(self):
        self.assert_fails(recurve("check", self.folder / "none.cgns"), BAD_INPUT, "none.cgns")
        self.assert_fails(recurve("check"), USAGE, "FILE")
        self.assert_fails(recurve("check", self.mesh, "--vtu", "a.txt"), USAGE, "a.txt")
        empty = self.folder / "empty.msh"
        empty.write_text("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n1\n1 0 0 0\n$EndNodes\n$Elements\n0\n$EndElements\n")
        self.assert_fails(recurve("check", empty), BAD_INPUT, "no cells")

    def test_curve(self):
        before = self.mesh.read_bytes()
        run = recurve("curve", self.mesh, self.out, "--report", self.report)
        self.assertEqual((run.returncode, run.stderr), (DONE, ""))
        for word in ("192 hexahedra", "degree 2", "sphere, outer", "largest displacement", "certified valid: all 192 cells"):
            self.assertIn(word, run.stdout)
        self.assertEqual(self.files(), ["out.cgns", "report.json", "shell.cgns"])
        self.assertEqual(self.mesh.read_bytes(), before)
        report = json.loads(self.report.read_text())
        self.assertTrue(report["validity"]["is_certified"])
        self.assertEqual(report["validity"]["after_restoration"]["invalid"], 0)
        self.assertEqual(report["options"]["fit_degree"], 2)
        self.assertEqual(report["patches"][0]["curved_faces"], 96)
        self.assertEqual([s["stage"] for s in report["stages"]][0], "read")
        self.assertEqual([s["stage"] for s in report["stages"]][-1], "write")
        self.assertGreater(report["displacement"]["largest"]["length"], 0)
        self.assertEqual(report["displacement"]["largest"]["patch"], "sphere")
        with h5py.File(self.out) as file:
            zone = file["Base/shell"]
            self.assertEqual(list(zone["cells/ data"][:]), [19, 0])  # HEXA_27
            points = numpy.stack([zone[f"GridCoordinates/Coordinate{c}/ data"][:] for c in "XYZ"], axis=1)
        # The surface of a cube of 8 x 8 x 8 has 386 nodes; two layers of quadratic cells make five such surfaces.
        self.assertEqual(len(points), 5 * 386)
        radius = numpy.linalg.norm(points, axis=1)
        # A quarter turn of the sphere in four edges: the straight edges' middles are up to 0.019 inside the sphere.
        self.assertGreater(radius.min(), 1 - 0.002)

    def test_interior(self):
        picture = self.folder / "jacobians.svg"
        run = recurve("curve", self.mesh, self.out, "--report", self.report, "--histogram", picture)
        self.assertEqual(run.returncode, DONE, run.stderr)
        report = json.loads(self.report.read_text())
        self.assertEqual([s["stage"] for s in report["jacobians"]], ["straight", "curved", "deformed", "certified"])
        self.assertEqual(report["jacobians"][2]["valid"], report["cells"]["total"])
        self.assertGreater(report["deformation"]["moved_nodes"], 0)
        self.assertTrue(picture.read_text().startswith("<svg"))
        self.assertIn("0 cells inverted", run.stdout)
        picture = picture.with_suffix(".png")
        run = recurve("curve", self.mesh, self.out, "--histogram", picture)
        self.assertEqual(run.returncode, DONE, run.stderr)
        pixels = read_png(picture)
        self.assertEqual(pixels.shape, (420, 900, 3))
        for stage, color in zip(report["jacobians"], ((176, 176, 176), (217, 95, 2), (27, 108, 168), (117, 112, 179))):
            # Along a row that all bars reach, they are the stretches of the stage's colour.
            is_bar = (pixels[420 - 63] == color).all(axis=1)
            bars = numpy.count_nonzero(numpy.diff(is_bar.astype(int)) == 1)
            counts = [stage["inverted"] + stage["wrong_before"], *stage["histogram"]]
            self.assertEqual(bars, numpy.count_nonzero(counts), stage["stage"])
        run = recurve("curve", self.mesh, self.out, "--report", self.report, "--no-deform", "--area-weights",
                      "--influence-radius", "2", "--deform-error", "1e-3")
        self.assertEqual(run.returncode, DONE, run.stderr)
        report = json.loads(self.report.read_text())
        self.assertIsNone(report["deformation"])
        self.assertEqual(report["options"]["deformation"]["influence_radius"], 2)
        for arguments in (["--histogram", "picture.jpg"], ["--histogram", self.report], ["--periodic", "sphere"],
                          ["--periodic", "a,b,c"]):
            run = recurve("curve", self.mesh, self.out, "--report", self.report, *arguments)
            self.assertEqual(run.returncode, USAGE, arguments)
        for name, values in (("radius", ("0", "-1", "inf", "nan", "far")), ("length", ("0", "nan")),
                             ("alpha", ("-1", "nan", "inf")), ("far", ("0", "nan", "1e300")), ("near", ("21",))):
            for value in values:
                option = f"--influence-{name}"
                self.assert_refuses(USAGE, option, "expected", value, arguments=[option, value])
        for value in ("0", "2", "nan"):
            self.assert_refuses(USAGE, "--deform-error", "expected 1e-9 to 1", value,
                                arguments=["--deform-error", value])
        run = recurve("curve", self.mesh, self.out, "--periodic", "sphere,nowhere")
        self.assertEqual(run.returncode, BAD_INPUT)
        self.assertIn("nowhere", run.stderr)

    def test_surface_file(self):
        surface = self.folder / "tetrahedron.off"
        surface.write_text("OFF\n4 4 0\n1 1 1\n1 -1 -1\n-1 1 -1\n-1 -1 1\n3 0 1 2\n3 0 3 1\n3 0 2 3\n3 1 3 2\n")
        out = self.folder / "tetrahedron.vtu"
        run = recurve("curve", surface, out)
        self.assertEqual(run.returncode, DONE, run.stderr)
        self.assertIn("4 faces", run.stdout)
        self.assertTrue(out.exists())
        out.unlink()
        for arguments in (["--report", self.folder / "r.json"], ["--histogram", self.folder / "h.svg"],
                          ["--periodic", "a,b"], ["--curve", "wall"]):
            run = recurve("curve", surface, out, *arguments)
            self.assertEqual(run.returncode, USAGE, arguments)
            self.assertIn("surface mesh", run.stderr)
            self.assertFalse(out.exists())

    def test_quiet(self):
        run = recurve("curve", self.mesh, self.out, "--quiet")
        self.assertEqual((run.returncode, run.stdout, run.stderr), (DONE, "", ""))
        self.assertEqual(self.files(), ["out.cgns", "shell.cgns"])

    def test_selection(self):
        for arguments, curved in ((["--curve", "sph*"], [96, 0]), (["--keep", "outer"], [96, 0]),
                                  (["--curve", "sphere,outer"], [96, 96]), (["--keep", "*"], [0, 0])):
            run = recurve("curve", self.mesh, self.out, "--report", self.report, *arguments)
            self.assertEqual(run.returncode, DONE, run.stderr)
            report = json.loads(self.report.read_text())
            self.assertEqual([patch["curved_faces"] for patch in report["patches"]], curved)

    def test_threads_do_not_change_a_bit(self):
        contents = []
        for threads in (1, 2, 7):
            out = self.folder / f"out{threads}.vtu"
            run = recurve("curve", self.mesh, out, "--degree", 4, "--threads", threads)
            self.assertEqual(run.returncode, DONE, run.stderr)
            contents.append(out.read_bytes())
        self.assertEqual(contents[0], contents[1])
        self.assertEqual(contents[0], contents[2])

    def test_old_results_are_replaced(self):
        self.out.write_text("old")
        self.report.write_text("old")
        self.assertEqual(recurve("curve", self.mesh, self.out, "--report", self.report).returncode, DONE)
        self.assertGreater(self.out.stat().st_size, 1000)
        json.loads(self.report.read_text())

    def test_progress_on_a_terminal_only(self):
        leader, follower = pty.openpty()
        run = subprocess.Popen([RECURVE, "curve", str(self.mesh), str(self.out)], stderr=follower,
                               stdout=subprocess.DEVNULL)
        os.close(follower)
        text = b""
        while True:
            try:
                part = os.read(leader, 65536)
            except OSError:  # the other end is closed
                break
            if not part:
                break
            text += part
        os.close(leader)
        self.assertEqual(run.wait(), DONE)
        for word in (b"read", b"reconstruct surface", b"write", b"100 %", b"\r"):
            self.assertIn(word, text)

    def test_features(self):
        run = recurve("features", self.mesh)
        self.assertEqual((run.returncode, run.stderr), (DONE, ""))
        self.assertIn("48 critical edges, 12 curves, 8 sharp vertices", run.stdout)
        edits, table, curves = (self.folder / f"edges.{kind}" for kind in ("toml", "csv", "vtp"))
        for file in (edits, table, curves):
            run = recurve("features", self.mesh, "-o", file, "--quiet")
            self.assertEqual((run.returncode, run.stdout, run.stderr), (DONE, "", ""))
        rows = numpy.genfromtxt(table, delimiter=",", names=True)
        self.assertEqual(rows.dtype.names, ("x1", "y1", "z1", "x2", "y2", "z2", "curve"))
        self.assertEqual(len(rows), 48)
        self.assertEqual(set(rows["curve"]), set(range(12)))
        # On an edge of the box two coordinates are 2 in size at both ends.
        for row in rows:
            ends = [(row[c + "1"], row[c + "2"]) for c in "xyz"]
            self.assertEqual(sum(abs(abs(a) - 2) < 1e-12 and abs(a - b) < 1e-12 for a, b in ends), 2)

        # The file gives the same edges again, and the same mesh.
        again = self.folder / "again.csv"
        self.assertEqual(recurve("features", self.mesh, "--features", edits, "-o", again).returncode, DONE)
        self.assertEqual(again.read_bytes(), table.read_bytes())
        points = []
        for arguments in ([], ["--features", edits]):
            self.assertEqual(recurve("curve", self.mesh, self.out, *arguments).returncode, DONE)
            with h5py.File(self.out) as file:
                points.append([file[f"Base/shell/GridCoordinates/Coordinate{c}/ data"][:] for c in "XYZ"])
        self.assertTrue(numpy.array_equal(points[0], points[1]))
        run = recurve("features", self.mesh, "--features", "none")
        self.assertIn("0 critical edges", run.stdout)

        # Edits after the detection.
        edits.write_text('start = "auto"\n[[edit]]\naction = "remove"\nbox = [[-3, -3, -3], [3, 3, 0]]\n')
        self.assertIn("24 critical edges", recurve("features", self.mesh, "--features", edits).stdout.split("\n")[0])

    def test_thresholds_of_the_detection(self):
        for command in ("curve", "features"):
            text = recurve(command, "--help").stdout
            for option in (*THRESHOLDS, *SWITCHES, "--feature-angle"):
                self.assertIn(option, text)

        def found(*arguments):
            run = recurve("curve", self.mesh, self.out, "--report", self.report, *arguments)
            self.assertEqual(run.returncode, DONE, run.stderr)
            return json.loads(self.report.read_text())["options"]["features"]

        defaults = found()
        given = found(*(word for option in THRESHOLDS.items() for word in option), *SWITCHES)
        expected = {option[2:].replace("-", "_"): value for option, value in THRESHOLDS.items()}
        expected |= dict(SWITCHES.values())
        for field, value in expected.items():
            self.assertEqual(given[field], value)
            self.assertNotEqual(defaults[field], value)
        # Nothing but the method and its angle has no option of its own.
        self.assertEqual(set(defaults) - set(expected), {"method", "dihedral_angle"})
        angle = found("--feature-angle", 44)
        self.assertEqual((angle["method"], angle["dihedral_angle"]), ("dihedral", 44))
        # Each option counts alone.
        for option in SWITCHES:
            self.assertEqual({k for k, v in found(option).items() if v != defaults[k]}, {SWITCHES[option][0]})
        self.assertEqual(found("--weak-angle", 20)["weak_angle"], 20)

    def test_thresholds_that_cannot_be(self):
        for arguments, words in ((["--weak-angle", 30], ("weak_angle", "end_angle", "30", "25")),
                                 (["--end-angle", 70], ("end_angle", "sharp_angle")),
                                 (["--turning-angle", 39], ("turning_angle", "twice ridge_deviation")),
                                 (["--feature-angle", 181], ("dihedral_angle", "180")),
                                 (["--corner-defect", "nan"], ("corner_defect",)),
                                 (["--strong-edges", "many"], ("--strong-edges",)),
                                 (["--features", "none", "--sharp-angle", 70], ("--sharp-angle", "no effect")),
                                 (["--feature-angle", 20, "--weak-angle", 5], ("--weak-angle", "no effect"))):
            self.assert_refuses(USAGE, *words, arguments=arguments)
            self.assert_fails(recurve("features", self.mesh, *arguments), USAGE, *words)
        edits = self.folder / "edges.toml"
        edits.write_text('start = "none"\n')
        self.assert_refuses(USAGE, "edges.toml", 'start = "none"', "--feature-angle", "no effect",
                            arguments=["--features", edits, "--feature-angle", 20])
        self.assertEqual(recurve("features", self.mesh, "--features", edits, "--turning-angle", 50).returncode, DONE)

    def list_wing(self, *arguments):
        run = recurve("features", WING, "--json", *arguments)
        self.assertEqual((run.returncode, run.stderr), (DONE, ""))
        return json.loads(run.stdout)

    def test_patches_as_evidence(self):
        # 32 edges at the trailing edge, around the wing at its root and its tip, and around the far field.
        self.assertEqual(self.list_wing()["critical_edges"], 4 * 32)
        # The patches of the wing meet at the leading edge too, smoothly.
        pinned = self.list_wing("--patch-edges")
        self.assertEqual(pinned["critical_edges"], 5 * 32)
        self.assertIn([[0, 0, 0], [0.5, 1.5, 0]],
                      [sorted([curve["first_point"], curve["last_point"]]) for curve in pinned["curves"]])
        self.assertEqual(self.list_wing("--feature-angle", 5, "--smooth-patches")["critical_edges"], 5 * 32)
        self.assertGreater(self.list_wing("--feature-angle", 5)["critical_edges"], 10 * 32)

    def test_report_of_features(self):
        report = self.list_wing()
        ends = [(curve["closed"], curve["first_end"], curve["last_end"], curve["edges"]) for curve in report["curves"]]
        self.assertEqual(sorted(ends), sorted([(False, "corner", "corner", 32)] * 3 + [(True, "none", "none", 32)]))
        trailing = [curve for curve in report["curves"] if curve["first_point"] == [1, 0, 0] and
                    numpy.allclose(curve["last_point"], [1.1, 1.5, 0])]
        self.assertAlmostEqual(trailing[0]["length"], numpy.hypot(1.5, 0.1))
        rejected = report["longest_rejected_curves"]
        self.assertEqual(len(rejected), report["rejected_curves"])
        for reason, count in report["rejected_edges"].items():
            self.assertEqual(sum(curve["edges"] for curve in rejected if curve["reason"] == reason), count)
        self.assertEqual([c["length"] for c in rejected], sorted((c["length"] for c in rejected), reverse=True))
        self.assertTrue(any(c["closed"] for c in rejected))
        text = recurve("features", WING).stdout
        self.assertIn(f"{len(rejected)} candidate curves were not taken ({report['candidate_edges'] - 128} edges)", text)
        self.assertRegex(text, r"\n  32 .*closed +smooth: ")
        self.assertRegex(text, r"\n  1 +32 +1\.50333 +164\.6 +\(1, 0, 0\) +\(1\.1, 1\.5, 0\) +wing_lower, wing_upper\n")
        self.assertEqual(trailing[0]["patches"], ["wing_lower", "wing_upper"])

    def edited(self, text):
        edits = self.folder / "edits.toml"
        edits.write_text(text)
        return self.list_wing("--features", edits)

    def test_every_kind_of_edit(self):
        leading = "[0, 0, 0], [0.5, 1.5, 0]"
        start = 'start = "none"\n'
        for kind in ("path", "crease"):
            found = self.edited(f'{start}[[edit]]\naction = "add"\n{kind} = [{leading}]\n')
            self.assertEqual([(c["edges"], c["last_point"]) for c in found["curves"]], [(32, [0.5, 1.5, 0])])
            self.assertAlmostEqual(found["curves"][0]["length"], numpy.hypot(0.5, 1.5))
        with h5py.File(WING) as file:
            zone = next(name for name, group in file["Base"].items() if "GridCoordinates" in group)
            points = numpy.stack([file[f"Base/{zone}/GridCoordinates/Coordinate{c}/ data"][:] for c in "XYZ"], axis=1)
        on_edge = [n for n, (x, y, z) in enumerate(points) if z == 0 and 0 < y < 1.5 and abs(x - 1 - y / 15) < 1e-12]
        self.assertEqual(len(on_edge), 31)
        node = min(on_edge, key=lambda n: points[n][1])
        edge = f'[[1, 0, 0], {{zone = "{zone}", node = {node}}}]'
        one = self.edited(f'{start}[[edit]]\naction = "add"\nedges = [{edge}]\n')
        self.assertEqual(one["critical_edges"], 1)
        chain = self.edited(f'{start}[[edit]]\naction = "add"\nchain = {edge}\nangle = 100\n')
        self.assertEqual([c["edges"] for c in chain["curves"]], [32])
        tip = chain["curves"][0]["last_point"]  # as the file has it; 1.1 is not quite what it is
        self.assertTrue(numpy.allclose(tip, [1.1, 1.5, 0]))
        # Where a curve drawn by hand turns or meets another, the vertex is sharp.
        met = self.edited(f'{start}[[edit]]\naction = "add"\nchain = {edge}\nangle = 100\n'
                          f'[[edit]]\naction = "add"\npatches = ["wing_upper", "wing_tip"]\n'
                          f'[[edit]]\naction = "add"\npatches = ["wing_tip", "wing_lower"]\n')
        self.assertEqual((met["critical_edges"], met["sharp_vertices"]), (32 + 32, 1))
        turned = self.edited(f'{start}turning_angle = 15\n[[edit]]\naction = "add"\n'
                             'patches = ["wing_tip", "wing_upper"]\n[[edit]]\naction = "add"\n'
                             'patches = ["wing_tip", "wing_lower"]\n')
        self.assertEqual([(e["edges"], e["changed_edges"], e["sharpened"]) for e in turned["edits"]],
                         [(16, 16, 0), (16, 16, 1)])
        self.assertTrue(turned["edits"][0]["origin"].endswith("edits.toml, line 3"))
        self.assertGreater(turned["edits"][1]["largest_turning"], 150)  # at the trailing edge, whose angle is 15 degrees
        text = recurve("features", WING, "--features", self.folder / "edits.toml").stdout
        self.assertRegex(text, r"\n  \S+edits.toml, line 3 +16 +16 ")
        self.assertEqual(turned["sharp_vertices"], 1)  # the trailing edge; the nose turns by 12 degrees a vertex
        box = self.edited('[[edit]]\naction = "remove"\nbox = [[-9, -9, -9], [9, 0, 9]]\n')
        self.assertEqual(box["critical_edges"], 2 * 32)
        patches = self.edited('[[edit]]\naction = "remove"\npatches = ["symmetry"]\n')
        self.assertEqual(patches["critical_edges"], 2 * 32)
        inside = self.edited(f'{start}[[edit]]\naction = "add"\npatches = ["wing_tip", "wing_tip"]\n')
        self.assertEqual(inside["critical_edges"], (3 * 30 - 32) // 2)  # of 30 triangles with 32 border edges
        marked = self.edited('[[edit]]\naction = "mark"\nvertices = [[0, 0, 0]]\n'
                             '[[edit]]\naction = "unmark"\nvertices = [' + json.dumps(tip) + ']\n')
        self.assertEqual(marked["sharp_vertices"], 2)
        typed = self.edited(f'{start}tolerance = 1e-3\n[[edit]]\naction = "add"\n'
                            f'path = [[0, 1e-5, 0], [0.5, 1.5, -1e-4]]\n')
        self.assertEqual(typed["critical_edges"], 32)

    def test_edits_replay(self):
        edits, again, tables = self.folder / "edits.toml", self.folder / "again.toml", []
        edits.write_text('[[edit]]\naction = "add"\ncrease = [[0, 0, 0], [0.5, 1.5, 0]]\n'
                         '[[edit]]\naction = "remove"\npatches = ["symmetry", "farfield"]\n'
                         '[[edit]]\naction = "mark"\nvertices = [[0, 0, 0]]\n')
        self.assertEqual(recurve("features", WING, "--features", edits, "-o", again).returncode, DONE)
        for file in (edits, again):
            for kind in ("csv", "vtp"):
                tables.append(self.folder / f"{file.stem}.{kind}")
                self.assertEqual(recurve("features", WING, "--features", file, "-o", tables[-1]).returncode, DONE)
        self.assertEqual(tables[0].read_bytes(), tables[2].read_bytes())
        self.assertEqual(tables[1].read_bytes(), tables[3].read_bytes())
        self.assertEqual(len(tables[0].read_text().splitlines()), 1 + 4 * 32)

    # What does not.

    def test_edits_that_cannot_be(self):
        start = '[[edit]]\naction = "add"\n'
        for text, words in (
                (start + "edges = [[[1, 0, 0], [0, 0, 0]]]", ("line 1", "no edge between", "edges lead to")),
                (start + "path = [[0, 0, 0.001], [0.5, 1.5, 0]]", ("no vertex at", "nearest", "[0, 0, 0]")),
                (start + 'path = [{zone = "wings", node = 1}, [0, 0, 0]]', ('no zone "wings"', "zones are")),
                (start + 'patches = ["wing_uper"]', ('no patch "wing_uper"', "wing_upper")),
                (start + 'patches = ["wing_tip", "farfield"]', ("share no edge",)),
                (start + "box = [[8, 8, 8], [9, 9, 9]]", ("no edge is inside",)),
                ('[[edit]]\naction = "mark"\nvertices = [[0, 0, 0]]\n'
                 '[[edit]]\naction = "unmark"\nvertices = [[0, 0, 0]]\n', ("line 4", "line 1", "unmarked"))):
            edits = self.folder / "edits.toml"
            edits.write_text(text)
            self.assert_fails(recurve("features", WING, "--features", edits), BAD_INPUT, "edits.toml", *words)

    def test_feature_files_that_cannot_be(self):
        edits = self.folder / "edges.toml"
        for text, words in (("start = ", ("edges.toml, line 1",)), ("\nbegin = 1", ("edges.toml, line 2", "begin")),
                            ('[[edit]]\naction = "add"\nchain = [[0, 0, 0], [9, 9, 9]]\n',
                             ("edges.toml, line 1", "no vertex", "nearest"))):
            edits.write_text(text)
            self.assert_refuses(BAD_INPUT, *words, arguments=["--features", edits])
            self.assert_fails(recurve("features", self.mesh, "--features", edits), BAD_INPUT, *words)
        self.assert_refuses(USAGE, "--features", "somehow", arguments=["--features", "somehow"])
        self.assert_fails(recurve("features", self.mesh, "-o", self.folder / "edges.xls"), USAGE, ".toml, .csv or .vtp")
        self.assert_fails(recurve("features", self.mesh, "-o", self.mesh), USAGE)

    def test_patch_that_does_not_exist(self):
        self.assert_refuses(BAD_INPUT, '"spere"', 'did you mean "sphere"', "outer", arguments=["--curve", "spere"])
        self.assert_refuses(BAD_INPUT, '"wing*"', "sphere", arguments=["--keep", "wing*"])

    def test_input_that_is_no_mesh(self):
        self.assert_refuses(BAD_INPUT, "none.cgns", "No such file", mesh=self.folder / "none.cgns")
        (self.folder / "dir.cgns").mkdir()
        self.assert_refuses(BAD_INPUT, "dir.cgns", "is a directory", mesh=self.folder / "dir.cgns")
        self.mesh.write_bytes(b"")
        self.assert_refuses(BAD_INPUT, "shell.cgns", "is empty")
        self.mesh.write_text("solid not a mesh\n" * 1000)
        self.assert_refuses(BAD_INPUT, "shell.cgns")
        self.assert_fails(recurve("info", self.mesh), BAD_INPUT, "shell.cgns")

    def test_truncated_input(self):
        whole = self.mesh.read_bytes()
        for part in (0.999, 0.9, 0.5, 0.1):
            self.mesh.write_bytes(whole[:int(part * len(whole))])
            self.assert_refuses(BAD_INPUT, "shell.cgns")

    def edit(self, path, change):
        with h5py.File(self.mesh, "r+") as file:
            data = file[path + "/ data"]
            values = data[...]
            change(values)
            data[...] = values

    def test_coordinate_that_is_no_number(self):
        for value in (numpy.nan, numpy.inf):
            self.edit("Base/shell/GridCoordinates/CoordinateY", lambda values: values.__setitem__(6, value))
            self.assert_refuses(BAD_INPUT, "shell.cgns", "shell", "7")

    def test_node_that_does_not_exist(self):
        for node in (0, -3, 295, 2**31 - 1):
            self.edit("Base/shell/cells/ElementConnectivity", lambda values: values.__setitem__(8 * 4, node))
            self.assert_refuses(BAD_INPUT, "shell.cgns", "shell", "cells", "5", str(node))

    def test_elements_that_are_not_linear_cells(self):
        for number, word in ((22, "NGON_n"), (23, "NFACE_n")):
            self.edit("Base/shell/cells", lambda values: values.__setitem__(0, number))
            self.assert_refuses(BAD_INPUT, "shell.cgns", "shell", "cells", word)

    def test_elements_of_several_degrees(self):
        hexa_27 = 19
        self.edit("Base/shell/cells", lambda values: values.__setitem__(0, hexa_27))
        self.assert_refuses(BAD_INPUT, "shell.cgns", "shell", "QUAD_4", "degree 2")

    def test_mesh_that_is_curved_already(self):
        curved = self.mesh.with_name("curved.cgns")
        self.assertEqual(recurve("curve", self.mesh, curved).returncode, 0)
        self.assert_fails(recurve("curve", curved, self.mesh.with_name("again.cgns")), BAD_INPUT, "curved.cgns", "degree 2")

    def test_mesh_without_cells(self):
        with h5py.File(self.mesh, "r+") as file:
            del file["Base/shell/cells"]
        self.assert_refuses(BAD_INPUT, "shell.cgns", "shell", "no cells")

    def test_two_dimensional_mesh(self):
        self.edit("Base", lambda values: values.__setitem__(0, 2))
        self.assert_refuses(BAD_INPUT, "shell.cgns")

    def test_output_that_cannot_be_written(self):
        out, report = self.out, self.report
        self.out = self.folder / "missing" / "out.cgns"
        self.assert_refuses(BAD_INPUT, "out.cgns", "missing", "does not exist")
        self.out, self.report = out, self.folder / "missing" / "report.json"
        self.assert_refuses(BAD_INPUT, "report.json", "missing", "does not exist")
        self.out, self.report = self.folder / "dir.vtu", report
        self.out.mkdir()
        self.assert_refuses(BAD_INPUT, "dir.vtu", "directory")
        self.out, self.report = out, Path("/dev/full")
        self.assert_refuses(BAD_INPUT, "/dev/full", "No space left")
        if os.geteuid() != 0:  # nothing is read-only to root
            self.report = report
            self.folder.chmod(0o500)
            try:
                self.assert_refuses(BAD_INPUT, "Permission denied")
            finally:
                self.folder.chmod(0o700)

    def test_full_disk(self):
        for name in ("out.cgns", "out.vtu"):
            self.out = self.folder / name
            self.assertEqual(recurve("curve", self.mesh, self.out).returncode, DONE)
            size = self.out.stat().st_size
            self.out.unlink()
            before = self.files()
            for limit in (100, size // 2, size - 1):
                run = recurve("curve", self.mesh, self.out, "--report", self.report,
                              preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit)))
                self.assert_fails(run, BAD_INPUT, name)
                self.assertNotIn(".part", run.stderr)
                self.assertEqual(self.files(), before)

    def interrupt(self, stage, signals):
        """sends Ctrl-C when the progress bar names `stage`; returns exit status and what stood on the terminal"""
        leader, follower = pty.openpty()
        run = subprocess.Popen([RECURVE, "curve", str(self.samples / "large.cgns"), str(self.out), "--degree", "3",
                                "--report", str(self.report)], stderr=follower, stdout=subprocess.DEVNULL)
        os.close(follower)
        text, is_sent = b"", False
        while True:
            try:
                part = os.read(leader, 65536)
            except OSError:  # the other end is closed
                break
            if not part:
                break
            text += part
            if not is_sent and stage in text:
                is_sent = True
                for _ in range(signals):
                    run.send_signal(signal.SIGINT)
                    time.sleep(0.01)
        os.close(leader)
        self.assertTrue(is_sent)
        return run.wait(), text

    def test_interrupt(self):
        for stage in (b"check cells", b"raise degree", b"write"):
            status, text = self.interrupt(stage, 1)
            self.assertEqual(status, INTERRUPTED, text)
            self.assertIn(b"\nrecurve: interrupted", text)
            self.assertEqual(self.files(), ["shell.cgns"])
        # A second Ctrl-C does not wait for the next step.
        status, text = self.interrupt(b"raise degree", 2)
        self.assertEqual(status, INTERRUPTED, text)
        self.assertEqual(self.files(), ["shell.cgns"])


if __name__ == "__main__":
    RECURVE, WRITE_SAMPLES = sys.argv[1:3]
    FOLDER = Path(sys.argv[3])
    unittest.main(argv=sys.argv[:1] + sys.argv[4:], verbosity=2)
