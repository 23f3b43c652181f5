#ifndef RECURVE_VOLUME_BOUNDARY_SOURCES_H
#define RECURVE_VOLUME_BOUNDARY_SOURCES_H

#include <recurve/core/exceptions.h>
#include <recurve/core/types.h>
#include <recurve/elements/element.h>
#include <recurve/elements/node_layout.h>
#include <recurve/volume/element_block.h>
#include <recurve/volume/internal/point_access.h>

#include <array>
#include <cmath>
#include <ranges>
#include <span>
#include <string>
#include <vector>

namespace recurve {

/// the mean length of the edges of `faces`, each face counting its own: the length L of the deformation formula, if
/// they are the faces of the active surface. Corner to corner; 0 if there is no face. \tparam PointRange  model of
/// `Point_range`. \tparam BlockRange  model of `Element_block_range`: triangles and
///                     quadrangles; others are ignored. \param degree  of all faces.
/// \throws Input_error if `degree` is outside [1, max_degree], a block is no multiple of its elements' nodes, or a face
///         names a node that does not exist.
/// \par Complexity  linear in the faces.
template <Point_range PointRange, Element_block_range BlockRange>
double mean_edge_length(const PointRange& nodes, const BlockRange& faces, int degree);

/// the area that each node stands for: each face is cut into `degree`^2 equal parts of its area (in the parameter), and
/// each part gives equal shares to its corners. The sum over the nodes is the area of the straight-sided faces; of two
/// walls, the one that is meshed more finely then has no more influence than the other.
/// \return one per node of `nodes`; 0 for nodes of no face.
/// \par Complexity  linear in the nodes and faces. Throws as `mean_edge_length()`.
template <Point_range PointRange, Element_block_range BlockRange>
std::vector<double> node_areas(const PointRange& nodes, const BlockRange& faces, int degree);

namespace internal {

/// calls `visit(type, nodes of the face)` for each face, in order, after checking it.
template <class BlockRange, class Visit>
void for_each_face(const BlockRange& faces, int degree, std::size_t node_count_of_mesh, const Visit& visit)
{
  if (degree < 1 || degree > max_degree)
    throw Input_error("boundary faces: degree " + std::to_string(degree) + " is outside [1, " +
                      std::to_string(max_degree) + "]");
  for (const auto& block : faces)
  {
    const Element_type type = block.type;
    if (type != Element_type::triangle && type != Element_type::quadrangle)
      continue;
    const std::span<const Index> nodes(block.nodes);
    const auto n = static_cast<std::size_t>(node_count(type, degree));
    if (nodes.size() % n != 0)
      throw Input_error("boundary faces: " + std::to_string(nodes.size()) + " nodes of a block are no multiple of " +
                        std::to_string(n));
    for (std::size_t first = 0; first < nodes.size(); first += n)
    {
      const auto face = nodes.subspan(first, n);
      for (const Index node : face)
        if (node < 0 || static_cast<std::size_t>(node) >= node_count_of_mesh)
          throw Input_error("boundary faces: " + std::string(element_name(type)) + " " + std::to_string(first / n) +
                            " names node " + std::to_string(node) + " of " + std::to_string(node_count_of_mesh));
      visit(type, face);
    }
  }
}

/// half the cross product of the diagonals: the vector area of a quadrangle, or of a triangle a, b, c, c.
inline double face_area(const Point& a, const Point& b, const Point& c, const Point& d)
{
  const Point u = {c[0] - a[0], c[1] - a[1], c[2] - a[2]}, v = {d[0] - b[0], d[1] - b[1], d[2] - b[2]};
  return std::hypot(u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]) / 2;
}

/// per canonical node, how many corners of the face's parts it is, divided by the number of all of them.
inline std::vector<double> node_shares(Element_type type, int degree)
{
  const std::span<const Lattice_point> lattice = canonical_nodes(type, degree);
  std::vector<double> shares(lattice.size());
  for (std::size_t m = 0; m < lattice.size(); ++m)
  {
    const int i = lattice[m][0], j = lattice[m][1];
    if (type == Element_type::quadrangle)
    {
      const int along_i = i > 0 && i < degree ? 2 : 1, along_j = j > 0 && j < degree ? 2 : 1;
      shares[m] = along_i * along_j / (4.0 * degree * degree);
    }
    else
    {
      const int zeros = (i == 0) + (j == 0) + (i + j == degree); // 2 at a corner, 1 on an edge
      shares[m] = (zeros == 2 ? 1 : zeros == 1 ? 3 : 6) / (3.0 * degree * degree);
    }
  }
  return shares;
}

} // namespace internal

template <Point_range PointRange, Element_block_range BlockRange>
double mean_edge_length(const PointRange& nodes, const BlockRange& faces, int degree)
{
  double sum = 0;
  Index count = 0;
  internal::for_each_face(faces, degree, std::ranges::size(nodes), [&](Element_type type, std::span<const Index> face) {
    const int n = corner_count(type);
    for (int c = 0; c < n; ++c)
    {
      const Point a = internal::coordinates(std::ranges::begin(nodes)[face[static_cast<std::size_t>(c)]]);
      const Point b = internal::coordinates(std::ranges::begin(nodes)[face[static_cast<std::size_t>((c + 1) % n)]]);
      sum += std::hypot(b[0] - a[0], b[1] - a[1], b[2] - a[2]);
    }
    count += n;
  });
  return count > 0 ? sum / static_cast<double>(count) : 0;
}

template <Point_range PointRange, Element_block_range BlockRange>
std::vector<double> node_areas(const PointRange& nodes, const BlockRange& faces, int degree)
{
  std::vector<double> areas(std::ranges::size(nodes), 0.0);
  if (degree < 1 || degree > max_degree)
    throw Input_error("boundary faces: degree " + std::to_string(degree) + " is outside [1, " +
                      std::to_string(max_degree) + "]");
  const std::array shares = {internal::node_shares(Element_type::triangle, degree),
                             internal::node_shares(Element_type::quadrangle, degree)};
  internal::for_each_face(faces, degree, areas.size(), [&](Element_type type, std::span<const Index> face) {
    const auto corner = [&](std::size_t c) { return internal::coordinates(std::ranges::begin(nodes)[face[c]]); };
    const bool is_triangle = type == Element_type::triangle;
    const double area = internal::face_area(corner(0), corner(1), corner(2), corner(is_triangle ? 2 : 3));
    const std::vector<double>& share = shares[is_triangle ? 0 : 1];
    for (std::size_t m = 0; m < face.size(); ++m)
      areas[static_cast<std::size_t>(face[m])] += share[m] * area;
  });
  return areas;
}

} // namespace recurve

#endif
