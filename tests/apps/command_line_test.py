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

RECURVE, WRITE_SAMPLES, FOLDER = None, None, None

DONE, USAGE, BAD_INPUT, UNCERTIFIED, INTERRUPTED = 0, 1, 2, 3, 130


def recurve(*arguments, **options):
    return subprocess.run([RECURVE, *map(str, arguments)], capture_output=True, text=True, timeout=300, **options)


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
        self.assertEqual(self.files(), ["shell.cgns"])

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

    # What does not.

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
        for number, word in ((19, "HEXA_27"), (22, "NGON_n"), (23, "NFACE_n")):
            self.edit("Base/shell/cells", lambda values: values.__setitem__(0, number))
            self.assert_refuses(BAD_INPUT, "shell.cgns", "shell", "cells", word)

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
