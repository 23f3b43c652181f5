#ifndef RECURVE_SURFACE_CURVE_SURFACE_H
#define RECURVE_SURFACE_CURVE_SURFACE_H

#include <recurve/core/exceptions.h>
#include <recurve/core/named_parameters.h>
#include <recurve/core/progress.h>
#include <recurve/core/types.h>
#include <recurve/features/feature_curves.h>
#include <recurve/surface/curving_surface_report.h>
#include <recurve/surface/internal/place_all_nodes.h>
#include <recurve/surface/local_fit.h>
#include <recurve/surface/surface_nodes.h>

#include <string>
#include <vector>

namespace recurve {

/// What a call to `curve_surface()` may vary.
struct Surface_curving_options
{
  int degree = 2; ///< degree p of the elements, 2 <= p <= 6 (1: nothing to place)
  Curve_fit_options curve_fit = {.method = Curve_method::cubic_spline}; ///< of feature curves of two or more edges; the
                                                                        ///< default is the paper's
  Progress_callback progress = {};                                      ///< called with the stage "curve surface"
};

/// places the nodes of degree p on the edges and inside the faces of `g`. Corners never move.
///
/// *Only nodes that move are written*: a node whose displacement is below round-off (1e-13 of the edge length, or the
/// resolution of the coordinates) gets no `put()`. Fill the nodes with their straight-sided positions first (as
/// `elevate()` and `Surface_nodes` do); what was planar then stays planar to the bit, whatever formula filled it.
///
/// - A node on an edge of a feature curve of two or more edges lies on the curve's spline.
/// - A node on any other edge is the mean of where the fits of the two faces lift its straight-sided position (the one
///   fit on a border). A flat fit (degree 0) leaves it in place.
/// - A node inside a face is lifted by the face's fit from its straight-sided position. In a face that has an edge on
///   such a spline it starts from the blend of the displaced edges, since the spline also moves nodes along the
///   surface; a flat fit then leaves it in the blend, and a flat blend of vertex fits in that of whatever edges move.
///
/// Each edge is written once, so that faces meet exactly: in the order of `edges(g)`, from the view of `halfedge(e, g)`
/// for each e of that range. (An edge that was made by `edge(h, g)` may have another half-edge: CGAL remembers h.) `g`
/// is not changed; results do not depend on the number of threads.
///
/// \tparam Graph        model of `FaceListGraph`; triangles and quads.
/// \tparam FaceFitMap   model of `ReadablePropertyMap`: face_descriptor -> `Local_fit`, as `reconstruct_surface()`
///                      writes them, or `Vertex_fits::face_map()`. Read by several threads at once.
/// \tparam EdgeNodeMap  model of `WritablePropertyMap`: `Edge_node<Graph>` -> Point_3. Written by one thread at a time.
/// \tparam FaceNodeMap  model of `WritablePropertyMap`: `Face_node<Graph>` -> Point_3. Written by one thread at a time.
/// \param curves        as `trace_feature_curves()` returns them; their edges are edges of `g`.
/// \param params        `vertex_point_map` (default: the internal one), `geom_traits`.
/// \throws Input_error if `options.degree` is outside [1, 6] or a face is neither triangle nor quad; nothing is then
///         written.
/// \throws Cancelled if the progress callback asks to stop; some nodes are then written.
/// \par Complexity  linear in the nodes.
/// \par Source      Ims & Wang 2018, section 3.3; the blend: Gordon & Hall 1973 in quads, Szabo & Babuska 1991 in
///                  triangles.
template <class Graph, class FaceFitMap, class EdgeNodeMap, class FaceNodeMap, class NamedParameters = No_parameters>
Curving_surface_report curve_surface(const Graph& g, FaceFitMap fits, const std::vector<Feature_curve<Graph>>& curves,
                                     EdgeNodeMap edge_nodes, FaceNodeMap face_nodes,
                                     const Surface_curving_options& options = {},
                                     const NamedParameters& params = no_parameters)
{
  static_assert(only_names<NamedParameters, names::vertex_point_map, names::geom_traits>,
                "curve_surface takes vertex_point_map and geom_traits only");
  internal::surface::check_element_degree(options.degree);
  internal::surface::check_corner_counts(g);
  const auto vertex_points = parameter_or<names::vertex_point_map>(params, get(CGAL::vertex_point, g));
  const internal::surface::Curve_places<Graph> places(g, curves, vertex_points, options.curve_fit);
  const internal::surface::Node_placer placer(g, fits, vertex_points, places, options.degree);
  return internal::surface::place_all_nodes(g, placer, places, edge_nodes, face_nodes, options.degree,
                                            options.progress);
}

} // namespace recurve

#endif
