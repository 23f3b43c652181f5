#!/usr/bin/python3
"""Reads the files of write_msh_samples with Gmsh itself: element types, nodes, physical groups and periodic links are
what was written; Gmsh's map of each cell and its Jacobian determinant are those of the polynomial that curved the cell.
Meshes that Gmsh wrote come back unchanged.

Gmsh 4.8 has no basis functions for prisms of degree 3 and more, although it reads and writes them: of these, the
positions of all nodes are compared after Gmsh has written the file again.

usage: gmsh_reader_test.py WRITE_MSH_SAMPLES FOLDER [MESH.msh ...]
"""
import random
import subprocess
import sys
from pathlib import Path

import gmsh
import numpy as np

SEED = 20240608
POINTS = 30
# For positions and determinants of about 2. Gmsh evaluates monomials and inverts their Vandermonde matrices, which loses
# digits with the degree: on hexahedra of degree 6 the worst seen was 1e-11 for positions and 6e-10 for determinants
# (degree 4: 6e-14 and 9e-13).
TOLERANCE = 1e-10
DETERMINANT_TOLERANCE = [1e-12, 1e-12, 1e-12, 1e-11, 1e-9, 1e-8]

# Gmsh's numbers of elements by degree, and its reference elements: corners of the cell in ours.
TYPES = {
    "triangle": [2, 9, 21, 23, 25, 42],
    "quadrangle": [3, 10, 36, 37, 38, 47],
    "tetrahedron": [4, 11, 29, 30, 31, 71],
    "pyramid": [7, 14, 118, 119, 120, 121],
    "prism": [6, 13, 90, 91, 106, 107],
    "hexahedron": [5, 12, 92, 93, 94, 95],
}
FACES = {
    "tetrahedron": ["triangle"] * 4,
    "pyramid": ["quadrangle"] + ["triangle"] * 4,
    "prism": ["quadrangle"] * 3 + ["triangle"] * 2,
    "hexahedron": ["quadrangle"] * 6,
}


def polynomial_map(degree, xi):
    x, y, z = xi
    return np.array((
        x + 0.2 * y + 0.05 * (0.3 + 0.5 * x - 0.4 * y + 0.3 * z) ** degree,
        y - 0.1 * z + 0.05 * (0.6 - 0.2 * x + 0.3 * y + 0.5 * z) ** degree,
        2 * z + 0.1 * x + 0.05 * (0.1 + 0.4 * x + 0.5 * y - 0.3 * z) ** degree,
    ))


def polynomial_jacobian(degree, xi):
    x, y, z = xi
    n = degree
    a = 0.05 * n * (0.3 + 0.5 * x - 0.4 * y + 0.3 * z) ** (n - 1)
    b = 0.05 * n * (0.6 - 0.2 * x + 0.3 * y + 0.5 * z) ** (n - 1)
    c = 0.05 * n * (0.1 + 0.4 * x + 0.5 * y - 0.3 * z) ** (n - 1)
    return np.linalg.det(np.array([[1 + 0.5 * a, 0.2 - 0.4 * a, 0.3 * a],
                                   [-0.2 * b, 1 + 0.3 * b, -0.1 + 0.5 * b],
                                   [0.1 + 0.4 * c, 0.5 * c, 2 - 0.3 * c]]))


def random_point(name):
    """Gmsh's reference coordinates, ours, and the volume of its reference element over ours, locally."""
    r, s, t = (random.random() for _ in range(3))
    if name == "tetrahedron":
        while r + s + t > 1:
            r, s, t = (random.random() for _ in range(3))
        return (r, s, t), (r, s, t), 1
    if name == "prism":
        if r + s > 1:
            r, s = 1 - r, 1 - s
        return (r, s, 2 * t - 1), (r, s, t), 2
    if name == "hexahedron":
        return (2 * r - 1, 2 * s - 1, 2 * t - 1), (r, s, t), 8
    t *= 0.95  # the map of the pyramid has no derivative at the apex
    x, y = r * (1 - t), s * (1 - t)
    return (2 * x - (1 - t), 2 * y - (1 - t), t), (x, y, t), 4


class Faults(list):
    def expect(self, where, what, found, expected):
        if found != expected:
            self.append(f"{where}: {what}: expected {expected}, found {found}")

    def expect_small(self, where, what, value, tolerance=TOLERANCE):
        if not value <= tolerance:
            self.append(f"{where}: {what}: {value:.1e}")


def nodes_of(tags):
    all_tags, coordinates, _ = gmsh.model.mesh.getNodes()
    positions = dict(zip(all_tags, coordinates.reshape(-1, 3)))
    return np.array([positions[tag] for tag in tags])


def check_cell(path, name, degree, faults):
    gmsh.open(str(path))
    where = path.name
    types, tags, nodes = gmsh.model.mesh.getElements(3)
    faults.expect(where, "types of cells", list(types), [TYPES[name][degree - 1]])
    types, tags, _ = gmsh.model.mesh.getElements(2)
    faults.expect(where, "types of faces", sorted({t: len(e) for t, e in zip(types, tags)}.items()),
                  sorted((TYPES[kind][degree - 1], FACES[name].count(kind)) for kind in set(FACES[name])))
    groups = {(d, gmsh.model.getPhysicalName(d, t)): gmsh.model.getEntitiesForPhysicalGroup(d, t)
              for d, t in gmsh.model.getPhysicalGroups()}
    faults.expect(where, "groups", sorted(groups),
                  [(2, f"face {f}") for f in range(len(FACES[name]))] + [(3, f"unit {name}")])
    lattice = nodes_of(nodes[0])
    error = determinant_error = 0.0
    if name != "prism" or degree < 3:
        for _ in range(POINTS):
            local, xi, scale = random_point(name)
            _, determinants, points = gmsh.model.mesh.getJacobians(TYPES[name][degree - 1], local)
            error = max(error, np.abs(np.array(points) - polynomial_map(degree, xi)).max())
            determinant_error = max(determinant_error, abs(determinants[0] * scale - polynomial_jacobian(degree, xi)))
    faults.expect_small(where, "position", error)
    faults.expect_small(where, "determinant", determinant_error, DETERMINANT_TOLERANCE[degree - 1])
    rewritten = path.with_name("rewritten_" + path.name)
    gmsh.option.setNumber("Mesh.MshFileVersion", 2.2 if "v22" in path.name else 4.1)
    gmsh.option.setNumber("Mesh.Binary", 0 if "ascii" in path.name else 1)
    gmsh.option.setNumber("Mesh.SaveAll", 1)
    gmsh.write(str(rewritten))
    gmsh.open(str(rewritten))
    _, _, nodes = gmsh.model.mesh.getElements(3)
    faults.expect_small(where, "nodes after Gmsh wrote them", np.abs(nodes_of(nodes[0]) - lattice).max())
    return error, determinant_error


def check_two_zones(path, faults):
    gmsh.open(str(path))
    where = path.name
    groups = {(d, gmsh.model.getPhysicalName(d, t)) for d, t in gmsh.model.getPhysicalGroups()}
    faults.expect(where, "groups", groups, {(3, "left"), (3, "right"), (2, "inlet"), (2, "outlet")})
    tags, _, _ = gmsh.model.mesh.getNodes()
    faults.expect(where, "nodes", len(tags), 7 * 4 * 4)
    if "v22" in where:
        return  # Gmsh 4.8 drops the periodic links of version 2.2 where there is no geometry, also those it wrote itself
    surfaces = {gmsh.model.getPhysicalName(2, t): gmsh.model.getEntitiesForPhysicalGroup(2, t)[0]
                for d, t in gmsh.model.getPhysicalGroups(2)}
    master, slaves, masters, affine = gmsh.model.mesh.getPeriodicNodes(2, surfaces["outlet"], True)
    faults.expect(where, "master of outlet", master, surfaces["inlet"])
    faults.expect(where, "pairs of periodic nodes", len(slaves), 16)
    shift = nodes_of(slaves) - nodes_of(masters)
    faults.expect_small(where, "shift of periodic nodes", np.abs(shift - [2, 0, 0]).max())
    faults.expect(where, "matrix", list(affine), [1, 0, 0, 2, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1])


def elements_of(path):
    """node positions of all cells and faces by type, in the order of the file."""
    gmsh.open(str(path))
    all_tags, coordinates, _ = gmsh.model.mesh.getNodes()
    positions = np.zeros((int(max(all_tags)) + 1, 3))
    positions[np.array(all_tags, dtype=int)] = coordinates.reshape(-1, 3)
    result = {}
    for dimension in (2, 3):
        for entity in gmsh.model.getEntities(dimension):
            types, _, nodes = gmsh.model.mesh.getElements(*entity)
            for kind, own in zip(types, nodes):
                size = gmsh.model.mesh.getElementProperties(kind)[3] if kind not in (90, 91) else {90: 40, 91: 75}[kind]
                rows = positions[np.array(own, dtype=int)].reshape(-1, 3 * size)
                result.setdefault(int(kind), []).append(rows)
    return {kind: np.unique(np.concatenate(rows), axis=0) for kind, rows in result.items()}


def main():
    program, folder, meshes = sys.argv[1], Path(sys.argv[2]), [Path(m) for m in sys.argv[3:] if Path(m).exists()]
    subprocess.run([program, str(folder)] + [str(m) for m in meshes], check=True)
    random.seed(SEED)
    faults = Faults()
    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    print(f"Gmsh {gmsh.option.getString('General.Version')}, seed {SEED}")
    for name in FACES:
        for degree in range(1, 7):
            errors = [check_cell(folder / f"{name}_{degree}_{version}{kind}.msh", name, degree, faults)
                      for version in ("v22", "v41") for kind in ("", "_ascii")]
            print(f"{name:12} degree {degree}: position {max(e[0] for e in errors):.1e}, "
                  f"determinant {max(e[1] for e in errors):.1e}")
    for version in ("v22", "v41"):
        for kind in ("", "_ascii"):
            check_two_zones(folder / f"two_zones_{version}{kind}.msh", faults)
    for mesh in meshes:
        ours, theirs = elements_of(folder / f"again_{mesh.name}"), elements_of(mesh)
        faults.expect(mesh.name, "element types", sorted(ours), sorted(theirs))
        for kind in set(ours) & set(theirs):
            same = ours[kind].shape == theirs[kind].shape and (ours[kind] == theirs[kind]).all()
            faults.expect(mesh.name, f"nodes of elements of type {kind} are those of the file, to the bit", same, True)
    gmsh.finalize()
    print(f"meshes of Gmsh read and written again: {len(meshes)}")
    print("\n".join(faults))
    sys.exit(1 if faults else 0)


if __name__ == "__main__":
    main()
