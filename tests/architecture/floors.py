#!/usr/bin/env python3
"""Checks who includes whom: the table of floors of toolkit/doc/architecture.md, as data, against every #include.

usage: floors.py SOURCE_DIR        prints one line per fault, exit status 1 if there is any
"""
import re
import sys
from pathlib import Path

# Folders of include/recurve and src that a folder may include, besides itself.
LOWER = {
    "core": set(),
    "elements": {"core"},
    "mesh": {"core", "elements"},
    "features": {"core", "elements"},
    "surface": {"core", "elements"},
    "volume": {"core", "elements"},
    "io": {"core", "elements", "mesh"},
    "run": {"core", "elements", "mesh", "features", "surface", "volume", "io"},
    "": {"core", "elements", "mesh", "features", "surface", "volume", "io", "run"},  # recurve/recurve.h
    "apps": {"core", "elements", "mesh", "features", "surface", "volume", "io", "run", ""},
}
# Single headers that a folder, or one file of it, may include from elsewhere.
EXCEPTIONS = {
    ("surface", "features/feature_curves.h"),  # only result types
    ("surface", "features/feature_report.h"),
    ("volume/restore_validity.h", "mesh/curved_mesh.h"),
}

# Foreign packages by the spelling of their headers.
PACKAGES = [
    ("CGAL", r"CGAL/"),
    ("Eigen", r"Eigen/"),
    ("Boost", r"boost/"),
    ("TBB", r"(tbb|oneapi)/"),
    ("fmt", r"fmt/"),
    ("json", r"nlohmann/"),
    ("toml++", r"toml\+\+/"),
    ("CLI11", r"CLI/"),
    ("CGNS", r"cgns\w*\.h$|cgio.*\.h$|pcgnslib\.h$"),
    ("HDF5", r"hdf5.*\.h$|H5\w*\.h$"),
    ("OpenMesh", r"OpenMesh/"),
    ("TetGen", r"tetgen\.h$"),
    ("Catch2", r"catch2/"),
]
# What public headers (seen by every user of a floor) and the rest of a folder may include of them.
FOREIGN_IN_HEADERS = {
    "core": set(),
    "elements": {"Eigen"},
    "mesh": set(),
    "features": {"CGAL", "Boost"},
    "surface": {"CGAL", "Eigen", "Boost", "TBB"},
    "volume": {"Eigen", "TBB"},
    "io": set(),
    "run": set(),
    "": set(),
    "apps": set(),
}
FOREIGN_IN_SOURCES = {
    "core": set(),
    "elements": {"Eigen"},
    "mesh": {"Eigen", "TBB", "fmt"},
    "features": {"CGAL", "Boost"},
    "surface": {"CGAL", "Eigen", "Boost", "TBB"},
    "volume": {"Boost", "Eigen", "TBB"},
    "io": {"CGNS", "HDF5", "Eigen", "TBB", "fmt"},
    "run": {"CGAL", "Eigen", "Boost", "TBB", "fmt", "json", "toml++"},
    "": set(),
    "apps": {"CLI11", "TBB", "fmt", "json"},
}
# Single files with a package of their own.
FOREIGN_EXCEPTIONS = {
    "core/named_parameters.h": {"CGAL"},
    "mesh/boundary_surface.h": {"CGAL", "Boost"},
    "mesh/openmesh.h": {"CGAL", "Boost", "OpenMesh"},
    "volume/internal/exact_number.h": {"Boost"},  # integers of any length
}

# CGAL's named parameters are not a stable interface: one file touches them.
NAMED_PARAMETER_INTERNALS = re.compile(
    r"\binternal_np\b|\bCGAL/Named_function_parameters\.h|\bCGAL::parameters::(get_parameter|choose_parameter|is_default_parameter)\b")
NAMED_PARAMETER_FILE = "core/named_parameters.h"
UMBRELLA = "CGAL/Polygon_mesh_processing.h"

INCLUDE = re.compile(r'^\s*#\s*include\s*([<"])([^>"]+)[>"]')


def folder_of(relative):
    """'mesh' of 'mesh/internal/a.h'; '' of 'recurve.h'."""
    return relative.split("/")[0] if "/" in relative else ""


def package_of(header):
    for package, pattern in PACKAGES:
        if re.match(pattern, header):
            return package
    return None


class Checker:
    def __init__(self, source_dir):
        self.root = Path(source_dir)
        self.faults = []
        self.files = 0

    def fault(self, path, line, text):
        self.faults.append(f"{path.relative_to(self.root)}:{line}: {text}")

    def check_all(self):
        toolkit = self.root / "toolkit"
        for base, is_header in ((toolkit / "include" / "recurve", True), (toolkit / "src", False)):
            for path in sorted(base.rglob("*")):
                if path.suffix in (".h", ".ipp", ".cpp"):
                    self.check_toolkit_file(path, path.relative_to(base).as_posix(), is_header and path.suffix == ".h")
        for path in sorted((toolkit / "apps").rglob("*")):
            if path.suffix in (".h", ".ipp", ".cpp"):
                self.check_toolkit_file(path, "apps/" + path.relative_to(toolkit / "apps").as_posix(), False)
        for base in ("tests", "examples", "data", "toolkit/benchmark"):
            for path in sorted((self.root / base).rglob("*")):
                if path.suffix in (".h", ".ipp", ".cpp"):
                    self.check_user_file(path)

    def check_toolkit_file(self, path, relative, is_header):
        """`relative`: folder/..., the same for a header and its source."""
        self.files += 1
        folder = folder_of(relative)
        if folder not in LOWER:
            self.fault(path, 1, f"folder {folder}/ stands on no floor")
            return
        for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
            if relative != NAMED_PARAMETER_FILE and NAMED_PARAMETER_INTERNALS.search(line):
                self.fault(path, number, f"only {NAMED_PARAMETER_FILE} touches CGAL's named-parameter internals")
            match = INCLUDE.match(line)
            if match:
                self.check_include(path, number, relative, folder, is_header, match[1], match[2])
        if is_header:
            self.check_guard(path, relative)

    def check_include(self, path, number, relative, folder, is_header, quote, header):
        if header == UMBRELLA:
            self.fault(path, number, f"{UMBRELLA} costs a minute: include the single headers")
        if header.startswith("recurve/"):
            self.check_own_include(path, number, relative, folder, header[len("recurve/"):])
        elif quote == '"':
            if is_header:
                self.fault(path, number, f'write <recurve/...>, not "{header}"')
        else:
            package = package_of(header)
            is_public = is_header and "/internal/" not in relative
            allowed = (FOREIGN_IN_HEADERS if is_public else FOREIGN_IN_SOURCES)[folder]
            if package and package not in allowed | FOREIGN_EXCEPTIONS.get(relative, set()):
                where = "public headers" if is_public else "sources"
                self.fault(path, number, f"{where} of {folder}/ may not include {package} (<{header}>)")

    def check_own_include(self, path, number, relative, folder, header):
        target = folder_of(header)
        if "/internal/" in header and target != folder:
            self.fault(path, number, f"{header} is internal to {target}/")
        is_exception = (folder, header) in EXCEPTIONS or (relative, header) in EXCEPTIONS
        if target != folder and target not in LOWER[folder] and not is_exception:
            self.fault(path, number, f"{folder}/ may not include {header}")

    def check_guard(self, path, relative):
        guard = "RECURVE_" + re.sub(r"[^A-Za-z0-9]", "_", relative).upper()
        text = path.read_text(encoding="utf-8")
        if f"#ifndef {guard}\n#define {guard}\n" not in text:
            self.fault(path, 1, f"the include guard is not {guard}")

    def check_user_file(self, path):
        """Tests, examples, generators: any public header; internal ones only in internal_*_test.cpp of their folder."""
        self.files += 1
        for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
            match = INCLUDE.match(line)
            if match and match[2].startswith("recurve/") and "/internal/" in match[2]:
                folder = folder_of(match[2][len("recurve/"):])
                if path.parent.name != folder or not re.fullmatch(r"internal_\w+_test\.cpp", path.name):
                    self.fault(path, number, f"{match[2]} is internal: only tests/{folder}/internal_*_test.cpp may see it")


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    checker = Checker(sys.argv[1])
    checker.check_all()
    for fault in checker.faults:
        print(fault)
    print(f"{checker.files} files, {len(checker.faults)} faults")
    # A tree without files is a wrong path, not a clean house.
    sys.exit(1 if checker.faults or checker.files == 0 else 0)


if __name__ == "__main__":
    main()
