#!/usr/bin/python3
"""Runs `recurve convert` as a user does: what a mesh keeps from format to format, what is said of the rest, and what is
left on the disk.

usage: convert_test.py RECURVE WRITE_SAMPLE_MESHES FOLDER
"""
import ctypes
import hashlib
import os
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
DONE, USAGE, BAD_INPUT, INTERRUPTED = 0, 1, 2, 130


def give_up_root():
    """lets permissions count for root too: the next program cannot pass over them (PR_CAPBSET_DROP, CAP_DAC_OVERRIDE)"""
    if os.geteuid() == 0 and ctypes.CDLL(None, use_errno=True).prctl(24, 1, 0, 0, 0) != 0:
        raise OSError(ctypes.get_errno(), "prctl")


def recurve(*arguments, **options):
    return subprocess.run([RECURVE, *map(str, arguments)], capture_output=True, text=True, timeout=300, **options)


def cgns_arrays(path):
    """every array of a CGNS file by its path, without what the writing library adds"""
    arrays = {}
    with h5py.File(path) as file:
        file.visititems(lambda name, item: arrays.update({name: item[()]})
                        if isinstance(item, h5py.Dataset) and not name.startswith(" ") else None)
    return arrays


def element_positions(path):
    """positions of the nodes of every element in their order, section by section"""
    result = {}
    with h5py.File(path) as file:
        for zone in file["Base"].values():
            if not isinstance(zone, h5py.Group) or "GridCoordinates" not in zone:
                continue
            points = numpy.stack([zone[f"GridCoordinates/Coordinate{x}/ data"][()] for x in "XYZ"], axis=1)
            for name, section in zone.items():
                if isinstance(section, h5py.Group) and "ElementConnectivity" in section:
                    nodes = section["ElementConnectivity/ data"][()] - 1
                    result[zone.name + "/" + name] = points[nodes].tobytes()
    return result


class Convert(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.samples = FOLDER / "samples"
        subprocess.run([WRITE_SAMPLES, str(cls.samples)], check=True)

    def setUp(self):
        self.folder = FOLDER / self.id().split(".")[-1]
        shutil.rmtree(self.folder, ignore_errors=True)
        self.folder.mkdir(parents=True)
        self.linear = self.samples / "shell.cgns"
        self.curved = self.samples / "curved_zones.cgns"

    def convert(self, source, target, *arguments):
        run = recurve("convert", source, self.folder / target, *arguments)
        self.assertEqual(run.returncode, DONE, run.stderr)
        return run

    def files(self):
        return sorted(path.name for path in self.folder.iterdir())

    def test_cgns_to_cgns_keeps_everything(self):
        for source in (self.linear, self.curved):
            run = self.convert(source, "same.cgns")
            self.assertEqual(run.stderr, "")
            before, after = cgns_arrays(source), cgns_arrays(self.folder / "same.cgns")
            self.assertEqual(sorted(before), sorted(after))
            for name in before:
                if "GridCoordinates/" in name:  # nodes that zones share may stand elsewhere in the later zone
                    self.assertEqual(sorted(before[name]), sorted(after[name]), name)
                elif not name.endswith("ElementConnectivity/ data"):
                    self.assertTrue(numpy.array_equal(before[name], after[name]), name)
            self.assertEqual(*(element_positions(path) for path in (source, self.folder / "same.cgns")))
            self.convert(self.folder / "same.cgns", "again.cgns")
            again = cgns_arrays(self.folder / "again.cgns")
            for name in after:
                self.assertTrue(numpy.array_equal(after[name], again[name]), name)

    def test_msh_keeps_nodes_elements_zones_and_patches(self):
        for options in ((), ("--ascii",), ("--msh-version", "2.2"), ("--msh-version", "2.2", "--ascii")):
            run = self.convert(self.curved, "mesh.msh", *options)
            self.assertEqual(run.stderr.count("\n"), 1)
            for word in ("mesh.msh", "MSH does not hold", "families", "kinds of boundary conditions", "units",
                         "descriptors"):
                self.assertIn(word, run.stderr)
            self.assertIn("degree 3, 2 cells, 112 nodes, 2 zones, 2 patches", run.stdout)
            text = (self.folder / "mesh.msh").read_bytes()
            self.assertTrue(text.startswith(b"$MeshFormat\n2.2" if "2.2" in options else b"$MeshFormat\n4.1"))
            self.convert(self.folder / "mesh.msh", "back.cgns")
            before, after = cgns_arrays(self.curved), cgns_arrays(self.folder / "back.cgns")
            for zone in ("left", "right"):
                points = [{tuple(point) for point in
                           zip(*(arrays[f"Base/{zone}/GridCoordinates/Coordinate{x}/ data"] for x in "XYZ"))}
                          for arrays in (before, after)]
                self.assertEqual(points[0], points[1])

    def test_msh_to_msh_is_the_same_file(self):
        for options in ((), ("--msh-version", "2.2", "--ascii")):
            self.convert(self.linear, "a.msh", *options)
            self.convert(self.folder / "a.msh", "b.msh", *options)
            self.assertEqual((self.folder / "a.msh").read_bytes(), (self.folder / "b.msh").read_bytes())

    def test_usage(self):
        for arguments, words in (((self.linear, "x.step"), ("x.step", "extension")),
                                 ((self.linear,), ("OUT",)),
                                 ((self.linear, self.linear), ("same file",)),
                                 (("x.stl", self.folder / "x.msh"), ("x.stl", "extension")),
                                 ((self.linear, self.folder / "x.msh", "--msh-version", "3"), ("--msh-version",))):
            run = recurve("convert", *arguments)
            self.assertEqual(run.returncode, USAGE, run.stderr)
            self.assertEqual(run.stderr.count("\n"), 1)
            for word in words:
                self.assertIn(word, run.stderr)
        self.assertEqual(self.files(), [])

    def test_bad_input_leaves_nothing(self):
        bad = self.folder / "bad.msh"
        bad.write_text("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n5\n1 0 0 0\n")
        run = recurve("convert", bad, self.folder / "out.cgns")
        self.assertEqual(run.returncode, BAD_INPUT)
        self.assertIn("bad.msh: line 5", run.stderr)
        self.assertEqual(self.files(), ["bad.msh"])

    def test_curving_a_curved_mesh_is_refused(self):
        run = recurve("curve", self.curved, self.folder / "out.msh")
        self.assertEqual(run.returncode, BAD_INPUT)
        self.assertIn("degree 3", run.stderr)
        self.assertEqual(self.files(), [])

    def test_curving_says_what_the_output_does_not_hold(self):
        run = recurve("curve", self.linear, self.folder / "out.msh")
        self.assertEqual(run.returncode, DONE, run.stderr)
        self.assertEqual(run.stderr, f"recurve: {self.folder / 'out.msh'}: MSH does not hold, and this mesh has: "
                                     "kinds of boundary conditions\n")

    def test_full_disk_keeps_the_old_file(self):
        for target in ("out.msh", "out.cgns", "out.vtu", "out.h5"):
            (self.folder / target).write_text("old")
            run = recurve("convert", self.curved, self.folder / target,
                          preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (1000, 1000)))
            self.assertEqual(run.returncode, BAD_INPUT, run.stderr)
            self.assertIn(target, run.stderr)
            self.assertNotIn(".part", run.stderr)
            self.assertEqual((self.folder / target).read_text(), "old")
        self.assertEqual(self.files(), ["out.cgns", "out.h5", "out.msh", "out.vtu"])

    def test_read_only_folder_keeps_the_old_file(self):
        for target in ("out.msh", "out.cgns", "out.vtu", "out.h5"):
            (self.folder / target).write_text("old")
        before = self.files()
        self.folder.chmod(0o555)
        try:
            for target in (*before, "new.msh"):
                run = recurve("convert", self.curved, self.folder / target, preexec_fn=give_up_root)
                self.assertEqual(run.returncode, BAD_INPUT, run.stderr)
                self.assertEqual(run.stderr.count("\n"), 1)
                self.assertIn(f"{target}: cannot be created in the directory", run.stderr)
        finally:
            self.folder.chmod(0o755)
        self.assertEqual(self.files(), before)
        for target in before:
            self.assertEqual((self.folder / target).read_text(), "old")

    def test_what_stands_in_the_way_of_the_output(self):
        (self.folder / "folder.msh").mkdir()
        for target, word in (("folder.msh", "directory"), ("missing/out.msh", "does not exist")):
            run = recurve("convert", self.curved, self.folder / target)
            self.assertEqual(run.returncode, BAD_INPUT, run.stderr)
            self.assertIn(word, run.stderr)
        self.assertEqual(self.files(), ["folder.msh"])

    def test_a_killed_conversion_leaves_the_old_file(self):
        large = self.samples / "large.cgns"
        target = self.folder / "out.msh"
        target.write_text("old")
        for delay in (0.02, 0.1, 0.3):
            process = subprocess.Popen([RECURVE, "convert", str(large), str(target), "--ascii", "-q"],
                                       stderr=subprocess.DEVNULL)
            time.sleep(delay)
            process.send_signal(signal.SIGTERM)
            status = process.wait(timeout=60)
            if status == DONE:  # it was quicker
                target.write_text("old")
            self.assertEqual(target.read_text(), "old")
            self.assertEqual(self.files(), ["out.msh"])

    def end_while_writing(self, number, content):
        """sends a signal as soon as something is written; the status, the messages and the unfinished files"""
        target = self.folder / "out.msh"
        for _ in range(20):  # in some it may be done before the signal comes
            target.unlink(missing_ok=True)
            if content is not None:
                target.write_text(content)
            process = subprocess.Popen([RECURVE, "convert", str(self.samples / "large.cgns"), str(target), "--ascii",
                                        "-q"], stderr=subprocess.PIPE, text=True)
            while process.poll() is None and not any(part.stat().st_size > 0 for part in self.folder.glob(".*.part")):
                pass
            process.send_signal(number)
            _, messages = process.communicate(timeout=60)
            if process.returncode == DONE:
                continue
            self.assertEqual(target.read_text() if target.exists() else None, content)
            parts = list(self.folder.glob(".*.part"))
            self.assertEqual(len(list(self.folder.iterdir())), len(parts) + (content is not None))
            return process.returncode, messages, parts
        self.fail("the signal always came too late")

    def test_killed_in_the_middle_of_writing(self):
        """not even a signal that no program can catch makes the target a half file"""
        for content in ("old", None):
            status, _, parts = self.end_while_writing(signal.SIGKILL, content)
            self.assertEqual(status, -signal.SIGKILL)
            for part in parts:
                part.unlink()

    def test_a_crash_leaves_no_half_file(self):
        for content in ("old", None):
            status, messages, parts = self.end_while_writing(signal.SIGSEGV, content)
            self.assertEqual((status, parts), (-signal.SIGSEGV, []))
            self.assertEqual(messages, "recurve: crashed; a damaged input can be the cause, else please report it\n")

    def test_output_does_not_depend_on_the_number_of_threads(self):
        digests = set()
        for cores in ({0}, os.sched_getaffinity(0)):
            run = recurve("convert", self.samples / "large.cgns", self.folder / "out.msh",
                          preexec_fn=lambda cores=cores: os.sched_setaffinity(0, cores))
            self.assertEqual(run.returncode, DONE, run.stderr)
            digests.add(hashlib.sha256((self.folder / "out.msh").read_bytes()).hexdigest())
        self.assertEqual(len(digests), 1)


if __name__ == "__main__":
    RECURVE, WRITE_SAMPLES, FOLDER = sys.argv[1], sys.argv[2], Path(sys.argv[3])
    unittest.main(argv=sys.argv[:1], verbosity=2)
