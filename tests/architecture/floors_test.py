#!/usr/bin/env python3
"""Builds small trees with one fault each and checks that floors.py names it, and only it."""
import tempfile
import unittest
from pathlib import Path

from floors import Checker


def guarded(relative, body=""):
    guard = "RECURVE_" + relative.replace("/", "_").replace(".", "_").upper()
    return f"#ifndef {guard}\n#define {guard}\n{body}\n#endif\n"


class Floors_test(unittest.TestCase):
    def faults(self, files):
        with tempfile.TemporaryDirectory() as folder:
            for name, text in files.items():
                path = Path(folder) / name
                path.parent.mkdir(parents=True, exist_ok=True)
                path.write_text(text)
            checker = Checker(folder)
            checker.check_all()
            return checker.faults

    def header(self, relative, body):
        return self.faults({f"toolkit/include/recurve/{relative}": guarded(relative, body)})

    def source(self, relative, body):
        return self.faults({f"toolkit/src/{relative}": body})

    def assert_fault(self, faults, text):
        self.assertEqual(len(faults), 1, faults)
        self.assertIn(text, faults[0])

    def test_lower_floors_are_allowed(self):
        self.assertEqual(self.header("mesh/a.h", "#include <recurve/elements/element.h>\n#include <vector>"), [])
        self.assertEqual(self.header("mesh/a.h", "#include <recurve/mesh/internal/b.h>"), [])
        self.assertEqual(self.header("surface/a.h", "#include <recurve/features/feature_curves.h>"), [])
        self.assertEqual(self.source("io/a.cpp", "#include <cgnslib.h>\n#include <hdf5.h>"), [])

    def test_upper_floor(self):
        self.assert_fault(self.header("elements/a.h", "#include <recurve/mesh/volume_mesh.h>"),
                          "elements/ may not include mesh/volume_mesh.h")
        self.assert_fault(self.source("io/a.cpp", "#include <recurve/run/curve_mesh.h>"), "io/ may not include run/")

    def test_sideways(self):
        self.assert_fault(self.header("volume/a.h", "#include <recurve/surface/b.h>"), "volume/ may not include")
        self.assert_fault(self.header("surface/a.h", "#include <recurve/features/detect_features.h>"),
                          "surface/ may not include features/detect_features.h")

    def test_internal(self):
        self.assert_fault(self.header("run/a.h", "#include <recurve/mesh/internal/b.h>"), "internal to mesh/")
        self.assert_fault(self.faults({"tests/mesh/a_test.cpp": "#include <recurve/mesh/internal/b.h>"}), "is internal")
        self.assertEqual(self.faults({"tests/mesh/internal_b_test.cpp": "#include <recurve/mesh/internal/b.h>"}), [])

    def test_foreign_headers(self):
        self.assert_fault(self.header("io/a.h", "#include <cgnslib.h>"), "may not include CGNS")
        self.assert_fault(self.header("io/a.h", "#  include <hdf5.h>"), "may not include HDF5")
        self.assert_fault(self.header("mesh/a.h", "#include <CGAL/Surface_mesh.h>"), "may not include CGAL")
        self.assertEqual(self.header("mesh/boundary_surface.h", "#include <CGAL/Surface_mesh.h>"), [])
        self.assert_fault(self.header("features/a.h", "#include <CGAL/Polygon_mesh_processing.h>"), "minute")

    def test_named_parameters(self):
        self.assert_fault(self.header("surface/a.h", "using T = CGAL::internal_np::vertex_point_t;"), "named-parameter")

    def test_guard(self):
        self.assert_fault(self.faults({"toolkit/include/recurve/mesh/a.h": "#pragma once\n"}), "RECURVE_MESH_A_H")

    def test_unknown_folder(self):
        self.assert_fault(self.header("cellar/a.h", ""), "stands on no floor")


if __name__ == "__main__":
    unittest.main()
