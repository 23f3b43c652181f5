#ifndef RECURVE_TESTS_IO_SINGLE_CELL_MESH_H
#define RECURVE_TESTS_IO_SINGLE_CELL_MESH_H

#include <recurve/elements/node_layout.h>
#include <recurve/mesh/curved_mesh.h>

#include <cmath>

namespace recurve::test {

/// A polynomial of total degree `degree` in each coordinate, in the space of every element of that degree: what the
/// nodes of `single_cell_mesh()` sample. For degree 1 it is affine, and always invertible on the unit cube.
inline Point polynomial_map(int degree, const Point& xi)
{
  const auto& [x, y, z] = xi;
  return {x + 0.2 * y + 0.05 * std::pow(0.3 + 0.5 * x - 0.4 * y + 0.3 * z, degree),
          y - 0.1 * z + 0.05 * std::pow(0.6 - 0.2 * x + 0.3 * y + 0.5 * z, degree),
          2 * z + 0.1 * x + 0.05 * std::pow(0.1 + 0.4 * x + 0.5 * y - 0.3 * z, degree)};
}

inline std::string face_patch_name(int face)
{
  return "face " + std::to_string(face);
}

/// One curved cell: the image of the reference element under `polynomial_map()`, each of its faces a patch.
inline Curved_mesh single_cell_mesh(Element_type type, int degree)
{
  const Reference_element& element = reference_element(type);
  Curved_mesh mesh;
  mesh.degree = degree;
  Zone linear;
  Curved_zone curved;
  linear.name = "unit " + std::string(element_name(type));
  linear.cells = {{"cells", type, {}}};
  curved.cells = {{"cells", type, {}}};
  curved.is_straight = {static_cast<std::uint8_t>(degree == 1)};

  for (const Lattice_point& lattice : canonical_nodes(type, degree))
  {
    curved.nodes.push_back(static_cast<Index>(mesh.nodes.size()));
    mesh.nodes.push_back(
      polynomial_map(degree, {double(lattice[0]) / degree, double(lattice[1]) / degree, double(lattice[2]) / degree}));
  }
  curved.cells[0].nodes = curved.nodes;
  linear.points.assign(mesh.nodes.begin(), mesh.nodes.begin() + element.corner_count);
  linear.cells[0].nodes.assign(curved.nodes.begin(), curved.nodes.begin() + element.corner_count);

  for (int f = 0; f < element.face_count; ++f)
  {
    const Reference_face& face = element.faces[static_cast<std::size_t>(f)];
    Section linear_face{face_patch_name(f), face.type, {}};
    Curved_section curved_face{face_patch_name(f), face.type, {}};
    linear_face.nodes.assign(face.corners.begin(), face.corners.begin() + face.corner_count);
    for (int node : face_nodes(type, degree, f))
      curved_face.nodes.push_back(node);
    linear.faces.push_back(linear_face);
    curved.faces.push_back(curved_face);
    linear.patches.push_back({face_patch_name(f), "BCWall", "", {f}});
  }
  mesh.linear.zones = {linear};
  mesh.zones = {curved};
  return mesh;
}

} // namespace recurve::test

#endif
