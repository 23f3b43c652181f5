#!/usr/bin/python3
"""Checks CGNS files that recurve wrote with cgnscheck and h5py, which share no code with recurve:

- one curved cell of each type and degree: element type, and every node at its place in the order of the SIDS;
- meshes (small ones of data/, and those of others where they are): what recurve read against what h5py finds in the
  file, and the meshes that recurve wrote at degree 1 to 4 (large ones 2 and 3) against the mesh that it read.

usage: cgns_reader_test.py WRITE_CGNS_SAMPLES FOLDER SOURCE [MESH.cgns or folder ...]
SOURCE is the source tree. Without meshes: those of its data/, and those of others in the folder that the environment
variable RECURVE_SHARED_DATA names, else in ../shared/data beside the source tree.
"""
import json
import os
import subprocess
import sys
from pathlib import Path

import h5py
import numpy as np

TYPES = {  # CGNS element type numbers of the complete families, by degree
    "line": [3, 4, 24, 40],
    "triangle": [5, 6, 26, 42],
    "quadrangle": [7, 9, 28, 44],
    "tetrahedron": [10, 11, 30, 47],
    "pyramid": [12, 13, 33, 50],
    "prism": [14, 16, 36, 53],
    "hexahedron": [17, 19, 39, 56],
}
NODES = {
    "line": [2, 3, 4, 5],
    "triangle": [3, 6, 10, 15],
    "quadrangle": [4, 9, 16, 25],
    "tetrahedron": [4, 10, 20, 35],
    "pyramid": [5, 14, 30, 55],
    "prism": [6, 18, 40, 75],
    "hexahedron": [8, 27, 64, 125],
}
FAMILY = {"tetrahedron": "TETRA", "pyramid": "PYRA", "prism": "PENTA", "hexahedron": "HEXA"}
CELLS = set(FAMILY)
MIXED = 20
TYPE_NAME = {codes[p]: (name, p + 1) for name, codes in TYPES.items() for p in range(4)}

failures = []


def check(condition, message):
    if not condition:
        failures.append(message)
        print("FAILED:", message)


# --- reading a CGNS/HDF5 file ---------------------------------------------------------------------------------------


def label(group):
    value = group.attrs.get("label")
    return value.decode().strip("\x00 ") if value is not None else ""


def groups(parent, wanted):
    return [g for g in parent.values() if isinstance(g, h5py.Group) and label(g) == wanted]


def data(group):
    return group[" data"][()]


def text(group):
    return bytes(data(group).tobytes()).decode().strip("\x00 ")


def name_of(group):
    return group.name.rsplit("/", 1)[1]


def split_mixed(connectivity):
    """(type name, nodes) of each element of a MIXED section."""
    at = 0
    while at < len(connectivity):
        name, degree = TYPE_NAME[int(connectivity[at])]
        width = NODES[name][degree - 1]
        yield name, connectivity[at + 1 : at + 1 + width]
        at += 1 + width


def read_zone(zone):
    result = {"points": int(data(zone).reshape(-1)[0]), "counts": {}, "kind": {}, "patches": {}, "interfaces": {}}
    result["structured"] = text(zone["ZoneType"]) == "Structured"
    result["x"] = np.stack([data(zone["GridCoordinates/Coordinate" + a]).reshape(-1) for a in "XYZ"], 1).astype(float)
    result["sections"] = {}
    for section in groups(zone, "Elements_t"):
        code = int(data(section)[0])
        first, last = (int(v) for v in data(section["ElementRange"]))
        connectivity = data(section["ElementConnectivity"])
        if code == MIXED:
            elements = list(split_mixed(connectivity))
            assert len(elements) == last - first + 1
        else:
            name, degree = TYPE_NAME[code]
            nodes = connectivity.reshape(last - first + 1, -1)
            assert nodes.shape[1] == NODES[name][degree - 1]
            result["sections"][name_of(section)] = (name, degree, nodes)
            elements = [(name, row) for row in nodes]
        for number, (name, nodes) in enumerate(elements):
            result["counts"][name] = result["counts"].get(name, 0) + 1
            result["kind"][first + number] = (name, nodes)
    for boundary in groups(zone, "ZoneBC_t"):
        for condition in groups(boundary, "BC_t"):
            result["patches"][name_of(condition)] = read_condition(condition)
    for connections in groups(zone, "ZoneGridConnectivity_t"):
        for connection in groups(connections, "GridConnectivity_t"):
            result["interfaces"][name_of(connection)] = len(data(connection["PointList"]).reshape(-1))
    return result


def read_condition(condition):
    """(location, numbers of points or elements)"""
    location = text(condition["GridLocation"]) if "GridLocation" in condition else "Vertex"
    for name in ("PointList", "PointRange", "ElementList", "ElementRange"):
        if name in condition:
            values = data(condition[name]).reshape(-1)
            if name.endswith("Range"):
                values = np.arange(values[0], values[1] + 1)
            return ("FaceCenter" if name.startswith("Element") else location), values
    return location, np.array([], int)


def read_file(path):
    with h5py.File(path) as file:
        base = next(b for b in groups(file, "CGNSBase_t") if list(data(b)) == [3, 3])
        version = float(data(file["CGNSLibraryVersion"])[0])
        return version, {name_of(zone): read_zone(zone) for zone in groups(base, "Zone_t")}


# --- checks ---------------------------------------------------------------------------------------------------------


def run_cgnscheck(path):
    done = subprocess.run(["cgnscheck", str(path)], capture_output=True, text=True, errors="replace")
    errors = [line for line in (done.stdout + done.stderr).splitlines() if "ERROR" in line.upper()]
    check(done.returncode == 0 and not errors, f"cgnscheck {path}: status {done.returncode}, {errors[:3]}")


def polynomial_map(degree, xi):
    x, y, z = xi
    return np.array(
        [
            x + 0.2 * y + 0.05 * (0.3 + 0.5 * x - 0.4 * y + 0.3 * z) ** degree,
            y - 0.1 * z + 0.05 * (0.6 - 0.2 * x + 0.3 * y + 0.5 * z) ** degree,
            2 * z + 0.1 * x + 0.05 * (0.1 + 0.4 * x + 0.5 * y - 0.3 * z) ** degree,
        ]
    )


def pyramid_edges(p):
    """The corners and the nodes inside edges of a pyramid of degree p in the order of the SIDS; what follows (faces and
    interior) is compared as a set by check_cell()."""
    corners = [(0, 0, 0), (p, 0, 0), (p, p, 0), (0, p, 0), (0, 0, p)]
    nodes = list(corners)
    for a, b in ((0, 1), (1, 2), (2, 3), (3, 0), (0, 4), (1, 4), (2, 4), (3, 4)):
        for m in range(1, p):
            nodes.append(tuple((corners[a][d] * (p - m) + corners[b][d] * m) // p for d in range(3)))
    return nodes


def check_cell(path, kind, p, orderings):
    version, zones = read_file(path)
    check(3.29 < version < 3.5, f"{path}: version {version}")
    zone = next(iter(zones.values()))
    cells = [s for s in zone["sections"].values() if s[0] in CELLS]
    check(len(cells) == 1 and cells[0][:2] == (kind, p), f"{path}: sections {[s[:2] for s in cells]}")
    found = zone["x"][cells[0][2][0] - 1]
    if kind == "pyramid":
        truth = pyramid_edges(p)
        inside = {(i, j, k) for k in range(p + 1) for j in range(p - k + 1) for i in range(p - k + 1)} - set(truth)
        rest = sorted(tuple(np.round(polynomial_map(p, np.array(n) / p), 9)) for n in inside)
        check(rest == sorted(tuple(np.round(x, 9)) for x in found[len(truth) :]), f"{path}: inner nodes")
    elif p == 1:
        truth = {
            "tetrahedron": [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)],
            "prism": [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (0, 1, 1)],
            "hexahedron": [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)],
        }[kind]
    else:
        truth = orderings["cgns"][f"{FAMILY[kind]}_{NODES[kind][p - 1]}"]["nodes"]
    for m, lattice in enumerate(truth):
        distance = np.abs(found[m] - polynomial_map(p, np.array(lattice) / p)).max()
        check(distance < 1e-14 * 8, f"{path}: node {m + 1} is {distance:.2g} away from its place")
    # The faces: each patch is the face that its name says, with the nodes of the cell that lie on it.
    for name, (location, numbers) in zone["patches"].items():
        check(location == "FaceCenter" and len(numbers) == 1, f"{path}: patch {name}")
        face_kind, nodes = zone["kind"][int(numbers[0])]
        check(len(set(nodes)) == NODES[face_kind][p - 1], f"{path}: nodes of {name}")
        check(set(nodes) <= set(cells[0][2][0]), f"{path}: nodes of {name} are not the cell's")


def check_against_input(line):
    """what recurve read, against the file."""
    if not h5py.is_hdf5(line["file"]):
        return None
    _, zones = read_file(line["file"])
    check([z["name"] for z in line["zones"]] == list(zones), f"{line['file']}: zones {list(zones)}")
    for read in line["zones"]:
        zone = zones[read["name"]]
        where = f"{line['file']}, zone {read['name']}"
        if zone["structured"]:
            continue
        check(read["points"] == len(zone["x"]), f"{where}: {read['points']} points")
        counts = {**read["cells"], **read["faces"], **read["bars"]}
        check(counts == zone["counts"], f"{where}: {counts} instead of {zone['counts']}")
        for name, size in read["patches"].items():
            location, numbers = zone["patches"][name]
            if location == "Vertex":
                # no independent answer, but bounds: no more than the faces with all nodes in the list
                points = set(numbers)
                inside = sum(k not in CELLS and k != "line" and points.issuperset(n) for k, n in zone["kind"].values())
                check(0 < size <= inside, f"{where}: patch {name} has {size} of {inside} faces")
            else:
                faces = [n for n in numbers if zone["kind"][int(n)][0] in ("triangle", "quadrangle")]
                check(size == len(faces), f"{where}: patch {name} has {size} faces instead of {len(faces)}")
        check(read["interfaces"] == zone["interfaces"], f"{where}: interfaces {read['interfaces']}")
    return zones


def check_output(line, path, degree, zones):
    """what recurve wrote, against what it read."""
    version, written = read_file(path)
    check(3.29 < version < 3.5, f"{path}: version {version}")
    check(list(written) == [z["name"] for z in line["zones"]], f"{path}: zones {list(written)}")
    for read in line["zones"]:
        zone = written[read["name"]]
        where = f"{path}, zone {read['name']}"
        counts = {**read["cells"], **read["faces"], **read["bars"]}
        check(zone["counts"] == counts, f"{where}: {zone['counts']} instead of {counts}")
        check(all(s[1] == degree for s in zone["sections"].values()), f"{where}: degrees")
        patches = {name: len(numbers) for name, (_, numbers) in zone["patches"].items()}
        check(patches == read["patches"], f"{where}: patches {patches}")
        for name, (location, numbers) in zone["patches"].items():
            kinds = {zone["kind"][int(n)][0] for n in numbers}
            check(location == "FaceCenter" and kinds <= {"triangle", "quadrangle"}, f"{where}: patch {name} on {kinds}")
        used = np.concatenate([s[2].reshape(-1) for s in zone["sections"].values()])
        check(used.min() >= 1 and used.max() <= zone["points"], f"{where}: node numbers")
        check(np.isfinite(zone["x"]).all() and len(zone["x"]) == zone["points"], f"{where}: coordinates")
        if zones is not None and not zones[read["name"]]["structured"] and len(written) == 1:
            corners = zone["x"][: read["points"]]  # joined zones share positions, a single one keeps its own
            check(np.array_equal(corners, zones[read["name"]]["x"]), f"{where}: the points have moved")


def main():
    program, folder, source = sys.argv[1], Path(sys.argv[2]), Path(sys.argv[3])
    orderings = json.loads(next((source / "tests").rglob("node_orderings.json")).read_text())
    shared = os.environ.get("RECURVE_SHARED_DATA", source / "../shared/data")
    meshes = []
    for argument in sys.argv[4:] or [source / "data", shared]:
        path = Path(argument)
        if path.is_dir():
            meshes += sorted(path.rglob("*.cgns"))
        elif path.exists():
            meshes.append(path)
        else:
            print("skipped: there is no", path)
    folder.mkdir(parents=True, exist_ok=True)
    subprocess.run([program, folder], check=True)
    for kind in sorted(CELLS):
        for p in range(1, 5):
            path = folder / f"{kind}_{p}.cgns"
            run_cgnscheck(path)
            check_cell(path, kind, p, orderings)
    for mesh in meshes:  # one at a time, so that the files need little space
        done = subprocess.run([program, folder, mesh], capture_output=True, text=True)
        check(done.returncode == 0, f"{mesh}: {done.stderr.strip()}")
        if done.returncode != 0:
            continue
        line = json.loads(done.stdout)
        zones = check_against_input(line)
        for degree, output in line["outputs"].items():
            run_cgnscheck(output)
            check_output(line, output, int(degree), zones)
            os.remove(output)
        print("checked", mesh)
    print(f"{len(failures)} failures, {4 * len(CELLS)} cells and {len(meshes)} meshes checked")
    sys.exit(1 if failures else 0)


main()
