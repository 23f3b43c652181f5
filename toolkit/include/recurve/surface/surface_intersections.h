#ifndef RECURVE_SURFACE_SURFACE_INTERSECTIONS_H
#define RECURVE_SURFACE_SURFACE_INTERSECTIONS_H

#include <recurve/core/named_parameters.h>
#include <recurve/core/types.h>
#include <recurve/surface/internal/face_triangles.h>
#include <recurve/surface/surface_nodes.h>

#include <CGAL/boost/graph/properties.h>

#include <algorithm>
#include <vector>

namespace recurve {

/// Two faces that have no vertex in common and intersect.
struct Face_intersection
{
  Index first = no_index;   ///< position in `faces(g)`
  Index second = no_index;  ///< larger than `first`
  bool is_in_input = false; ///< the straight-sided faces intersect already; else the curving did it

  friend bool operator==(const Face_intersection&, const Face_intersection&) = default;
};

/// finds the pairs of curved faces that intersect though they have no vertex in common.
///
/// A curved face of degree p is taken as the triangles between its nodes, p^2 of them in a triangle and 2 p^2 in a
/// quad; whether two triangles intersect is decided exactly (they are closed: to touch is to intersect). A contact
/// between the nodes that is smaller than the distance of the curved face from these triangles may be missed or
/// reported. Pairs that the curving has parted again are not listed. Triangles without area are left out.
///
/// \tparam Graph  model of `FaceListGraph`; triangles and quads.
/// \param nodes   as `curve_surface()` fills them.
/// \param params  `vertex_point_map` (default: the internal one).
/// \return ascending by first and second; independent of the number of threads.
/// \par Complexity  O(n log^2 n + pairs of boxes that overlap), n triangles.
/// \par Source      box intersection: Zomorodian & Edelsbrunner 2002, as in CGAL.
template <class Graph, class Point3, class NamedParameters = No_parameters>
std::vector<Face_intersection> find_surface_intersections(const Graph& g, const Surface_nodes<Graph, Point3>& nodes,
                                                          const NamedParameters& params = no_parameters)
{
  static_assert(only_names<NamedParameters, names::vertex_point_map, names::geom_traits>,
                "find_surface_intersections takes vertex_point_map and geom_traits only");
  namespace s = internal::surface;
  const auto vertex_points = parameter_or<names::vertex_point_map>(params, get(CGAL::vertex_point, g));
  const std::vector<std::vector<Index>> corners = s::vertices_of_faces(g);
  const auto curved = s::intersecting_faces(s::triangles_between_nodes(g, nodes, vertex_points), corners);
  const auto straight = s::intersecting_faces(s::triangles_of_faces(g, vertex_points), corners);
  std::vector<Face_intersection> result;
  result.reserve(curved.size());
  for (const auto& pair : curved)
    result.push_back({pair.first, pair.second, std::binary_search(straight.begin(), straight.end(), pair)});
  return result;
}

} // namespace recurve

#endif
