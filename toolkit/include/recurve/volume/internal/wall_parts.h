#ifndef RECURVE_VOLUME_INTERNAL_WALL_PARTS_H
#define RECURVE_VOLUME_INTERNAL_WALL_PARTS_H

#include <recurve/core/types.h>
#include <recurve/elements/element.h>
#include <recurve/elements/node_layout.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>
#include <vector>

namespace recurve::internal {

/// What of a cell lies on curved boundaries: numbers of its edges and faces of which all nodes do, corners apart.
struct Wall_parts
{
  std::vector<int> edges, faces;

  /// \param is_on_wall  callable (number of a node in the cell) -> bool.
  template <class IsOnWall>
  Wall_parts(Element_type type, int degree, const IsOnWall& is_on_wall)
  {
    if (degree == 1)
      return;
    const Reference_element& element = reference_element(type);
    const auto are_all = [&](std::span<const int> numbers, int corners) {
      return std::ranges::all_of(numbers.subspan(static_cast<std::size_t>(corners)), is_on_wall);
    };
    for (int e = 0; e < element.edge_count; ++e)
      if (are_all(edge_nodes(type, degree, e), 2))
        edges.push_back(e);
    for (int f = 0; f < element.face_count; ++f)
      if (are_all(face_nodes(type, degree, f), element.faces[static_cast<std::size_t>(f)].corner_count))
        faces.push_back(f);
  }
};

/// the nodes inside an edge, by their numbers in the cell.
inline std::span<const int> inside_edge(Element_type type, int degree, int edge)
{
  return edge_nodes(type, degree, edge).subspan(2);
}

/// the nodes inside a face, by their numbers in the cell.
inline std::span<const int> inside_face(Element_type type, int degree, int face)
{
  const Element_type face_type = reference_element(type).faces[static_cast<std::size_t>(face)].type;
  return face_nodes(type, degree, face).subspan(static_cast<std::size_t>(first_interior_node(face_type, degree)));
}

/// How the nodes inside a face follow its edges: each keeps the mean of what they keep, in which an edge counts by the
/// inverse of its distance in the reference face. So a face that shares one reduced edge bends over to its others.
///
/// \param share  callable (number of a node in the face) -> what it keeps of its displacement.
/// \param visit  callable (number of a node inside the face, what it keeps).
template <class Share, class Visit>
void follow_edges(Element_type face_type, int degree, const Share& share, const Visit& visit)
{
  const Reference_element& face = reference_element(face_type);
  std::array<double, 4> of_edge = {1, 1, 1, 1};
  for (int e = 0; e < face.edge_count; ++e)
    for (const int m : inside_edge(face_type, degree, e))
      of_edge[static_cast<std::size_t>(e)] = std::min(of_edge[static_cast<std::size_t>(e)], share(m));
  const auto lattice = canonical_nodes(face_type, degree);
  for (int m = first_interior_node(face_type, degree); m < node_count(face_type, degree); ++m)
  {
    const auto [i, j, k] = lattice[static_cast<std::size_t>(m)];
    const std::array<int, 4> distances = face_type == Element_type::triangle
                                           ? std::array<int, 4>{j, degree - i - j, i, 0}
                                           : std::array<int, 4>{j, degree - i, degree - j, i};
    double weights = 0, sum = 0;
    for (std::size_t e = 0; e < static_cast<std::size_t>(face.edge_count); ++e)
    {
      weights += 1.0 / distances[e];
      sum += (1 - of_edge[e]) / distances[e];
    }
    visit(m, 1 - sum / weights);
  }
}

} // namespace recurve::internal

#endif
