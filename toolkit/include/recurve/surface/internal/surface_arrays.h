#ifndef RECURVE_SURFACE_INTERNAL_SURFACE_ARRAYS_H
#define RECURVE_SURFACE_INTERNAL_SURFACE_ARRAYS_H

#include <recurve/core/types.h>

#include <cstdint>
#include <span>
#include <vector>

namespace recurve::internal::surface {

/// How neighbours are told, for the growth of stencils.
enum class Neighbor_rule : std::uint8_t
{
  along_curves, ///< the paper's: from a critical vertex along critical edges only, from a sharp one nowhere
  whole_region  ///< all neighbours within the surface region, but none of an isolated sharp vertex
};

/// A face graph as flat arrays, cut open along its critical edges: a vertex on a feature curve is here once for each
/// surface region around it, with the normal of that region. Whatever walks along faces and edges of these arrays
/// therefore cannot cross a feature curve.
///
/// A *corner* is a vertex in a face; corners are numbered face by face and name the face's edge that starts there.
/// In each face corner 0 is the one with the lowest vertex number, whichever halfedge the graph starts from.
struct Surface_arrays
{
  // per vertex
  std::vector<Point> points;
  std::vector<Point> normals;           ///< unit, or zero where no face has a normal
  std::vector<Index> original_vertices; ///< position in vertices(g); ascending
  std::vector<std::uint8_t> is_rim;     ///< on a critical edge or border
  std::vector<std::uint8_t> is_tip;     ///< sharp, and no critical edge or border at it: the tip of a cone
  std::vector<Index> neighbor_first;    ///< CSR; one entry more than vertices
  std::vector<Index> neighbors;         ///< by the neighbour rules of stencil growth; ascending for each vertex
  std::vector<Index> corner_first;      ///< CSR; one entry more than vertices
  std::vector<Index> vertex_corners;    ///< ascending for each vertex

  // per face
  std::vector<Index> face_first;           ///< first corner; one entry more than faces
  std::vector<Point> face_normals;         ///< unit, or zero
  std::vector<std::int32_t> graph_corners; ///< which of its corners is source(halfedge(f, g))

  // per corner
  std::vector<Index> corner_vertices;
  std::vector<Index> corner_faces;
  std::vector<std::uint8_t> is_critical_edge; ///< of the edge that starts at the corner

  Index face_count() const { return static_cast<Index>(face_first.size()) - 1; }
  Index vertex_count() const { return static_cast<Index>(points.size()); }

  Index next_corner(Index corner) const
  {
    const Index face = corner_faces[corner];
    return corner + 1 == face_first[face + 1] ? face_first[face] : corner + 1;
  }

  Index previous_corner(Index corner) const
  {
    const Index face = corner_faces[corner];
    return corner == face_first[face] ? face_first[face + 1] - 1 : corner - 1;
  }

  std::span<const Index> corners_of_face(Index face) const
  {
    return {corner_vertices.data() + face_first[face], corner_vertices.data() + face_first[face + 1]};
  }

  std::span<const Index> neighbors_of(Index vertex) const
  {
    return {neighbors.data() + neighbor_first[vertex], neighbors.data() + neighbor_first[vertex + 1]};
  }

  std::span<const Index> corners_of_vertex(Index vertex) const
  {
    return {vertex_corners.data() + corner_first[vertex], vertex_corners.data() + corner_first[vertex + 1]};
  }
};

} // namespace recurve::internal::surface

#endif
