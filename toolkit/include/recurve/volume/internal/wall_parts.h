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

/// What a node keeps of its displacement, and how long that is in full.
struct Kept_displacement
{
  double share = 1, length = 0;
};

/// How the nodes inside a face follow its edges: each keeps the mean of what the edges keep, in which an edge counts by
/// its displacement and by the inverse of its distance in the reference face. So a face bends over from the edge that
/// is lowered to its others, and where that edge makes most of the bulge of the face, it takes most of it back.
///
/// \param kept   callable (number of a node in the face) -> Kept_displacement.
/// \param visit  callable (number of a node inside the face, the share that it keeps).
template <class Kept, class Visit>
void follow_edges(Element_type face_type, int degree, const Kept& kept, const Visit& visit)
{
  const Reference_element& face = reference_element(face_type);
  std::array<Kept_displacement, 4> edges;
  for (int e = 0; e < face.edge_count; ++e)
    for (const int m : inside_edge(face_type, degree, e))
    {
      const Kept_displacement node = kept(m);
      Kept_displacement& edge = edges[static_cast<std::size_t>(e)];
      edge = {std::min(edge.share, node.share), std::max(edge.length, node.length)};
    }
  const auto lattice = canonical_nodes(face_type, degree);
  for (int m = first_interior_node(face_type, degree); m < node_count(face_type, degree); ++m)
  {
    const Lattice_point& at = lattice[static_cast<std::size_t>(m)];
    const int i = at[0], j = at[1];
    const std::array<int, 4> distances = face_type == Element_type::triangle
                                           ? std::array<int, 4>{j, degree - i - j, i, 0}
                                           : std::array<int, 4>{j, degree - i, degree - j, i};
    double weights = 0, lost = 0;
    for (std::size_t e = 0; e < static_cast<std::size_t>(face.edge_count); ++e)
    {
      const double weight = edges[e].length / distances[e];
      weights += weight;
      lost += weight * (1 - edges[e].share);
    }
    visit(m, weights > 0 ? 1 - lost / weights : 1);
  }
}

} // namespace recurve::internal

#endif
