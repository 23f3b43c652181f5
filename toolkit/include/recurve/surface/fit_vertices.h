#ifndef RECURVE_SURFACE_FIT_VERTICES_H
#define RECURVE_SURFACE_FIT_VERTICES_H

#include <recurve/core/exceptions.h>
#include <recurve/core/named_parameters.h>
#include <recurve/core/progress.h>
#include <recurve/surface/compact_policies.h>
#include <recurve/surface/internal/fit_all_vertices.h>
#include <recurve/surface/internal/gather_surface.h>
#include <recurve/surface/internal/straight_nodes.h>
#include <recurve/surface/reconstruction_report.h>
#include <recurve/surface/vertex_fits.h>

#include <algorithm>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace recurve {

/// Degree of the polynomials that `fit_vertices()` takes for rate d + 1: the next even number above d, which is 2, 4,
/// 4, 6, 6, 8 for d = 1 to 6. Compact stencils have the points for it at less cost than the wide stencil of a face has
/// at degree d, and errors of even degree cancel between the two ends of an edge.
constexpr int vertex_fit_degree(int degree)
{
  return degree / 2 * 2 + 2;
}

/// Highest degree of the polynomials on a rim and next to it, where those elsewhere have `polynomial_degree`: points on
/// one side alone need about twice the degree to be as near to the surface as points all around.
constexpr int vertex_fit_degree_at_rim(int polynomial_degree)
{
  return polynomial_degree <= 2 ? polynomial_degree : std::min(2 * polynomial_degree, max_vertex_fit_degree);
}

/// What the polynomials of `fit_vertices()` are fitted to.
enum class Vertex_fit_data : std::uint8_t
{
  points,            ///< positions of the vertices
  points_and_normals ///< Hermite: those of `vertex_normal_map` too, which is then needed. A vertex counts for three,
                     ///< and stencils are smaller: exact normals of a known shape gain much, normals that are averages
                     ///< of faces spoil the fit
};

/// What a call to `fit_vertices()` may vary. How stencils grow, how points are weighted and how the equations are
/// solved are types: see `Reconstruction_policies`.
struct Vertex_fit_options
{
  int degree = 2;            ///< d, 1 <= d <= 6: errors fall with the power d + 1 of the size of the faces, or faster
  int polynomial_degree = 0; ///< 1 to max_vertex_fit_degree; 0: vertex_fit_degree(degree)
  int more_degrees_at_rim = -1; ///< added, at most, to the degree of polynomials next to a border or critical edge,
                                ///< whose points lie on one side: 0 or more, up to `max_vertex_fit_degree` in all; -1:
                                ///< see `vertex_fit_degree_at_rim()`. At most two where the rim is two edges away or
                                ///< more. Taken where terms of higher degree get smaller, for polynomials of degree 5
                                ///< or more.
  double largest_displacement = 0.3; ///< a fit that moves the middle of an edge at its vertex farther is lowered; in
                                     ///< lengths of the edge. 0.3 is the rise of an arc of 124 degrees.
  double largest_disagreement = 0.5; ///< where the fits of both ends of an edge displace its middle so differently,
                                     ///< relative to the larger displacement, they are lowered
  Vertex_fit_data data = Vertex_fit_data::points;
  Progress_callback progress = {}; ///< called with the stage "reconstruct surface"
};

/// fits, for each vertex of `g` and each surface region around it, a weighted least-squares polynomial that goes
/// through the vertex, from the vertices of the region around it. Over a face the fits of its corners are blended: see
/// `Vertex_fits`. For `curve_surface()`.
///
/// Compared with `reconstruct_surface()` there are half as many fits on triangles, from stencils that are half as wide:
/// the error is smaller (see the manual page) at about the same cost or less. A planar surface gets fits that are
/// exactly flat. A smooth surface is approximated to O(h^(degree+1)).
///
/// A fit is checked against those of its neighbours; where two disagree on the edge between them, or a fit moves an
/// edge too far, it is fitted again with a lower degree. A parabola stands if it is nearer to what the normals tell
/// than no displacement is; else the degree is 0, which leaves the surface straight there.
///
/// Lengths are in the unit of the points; nothing depends on that unit nor on the place of the mesh. Long thin faces
/// are measured by their own lengths, along their rows where these bend. The result is independent of the number of
/// threads. `g` is not changed and must outlive the result.
///
/// \tparam Graph   model of `FaceListGraph`; triangles and quads.
/// \param params   as for `reconstruct_surface()`. A sharp vertex without critical edges (the tip of a cone) gets no
///                 fit. On critical edges and borders normals of `vertex_normal_map` are no data.
/// \param policies the compact ones by default. A stencil grows from one vertex, `Stencil_point::distance` is in units
///                 of the mean distance of the neighbours (of each direction's own, on long thin faces).
/// \param report   if not null, set. A face has the lowest degree of its corners' fits, at most `options.degree`.
/// \throws Input_error if a field of `options` is out of its range, normals are to be data and `vertex_normal_map` is
///         missing, a face is neither triangle nor quad or a coordinate is not finite.
/// \throws Cancelled if the progress callback asks to stop.
/// \par Complexity  linear in the vertices; memory about 0.5 kB (d = 2, quads) to 0.9 kB (d = 6, triangles) per
///                 vertex at its peak, and 4 bytes for each thread.
/// \par Source      Jiao & Wang 2012 (WALF: fits of vertices, averaged).
template <class Graph, class NamedParameters = No_parameters, class Policies = Compact_policies>
Vertex_fits<Graph> fit_vertices(const Graph& g, const Vertex_fit_options& options = {},
                                const NamedParameters& params = no_parameters, const Policies& policies = {},
                                Reconstruction_report* report = nullptr)
{
  static_assert(only_names<NamedParameters, names::vertex_point_map, names::vertex_normal_map,
                           names::edge_is_constrained_map, names::vertex_is_constrained_map, names::geom_traits>,
                "fit_vertices takes vertex_point_map, vertex_normal_map, edge_is_constrained_map, "
                "vertex_is_constrained_map and geom_traits only");
  if (options.degree < 1 || options.degree > max_fit_degree)
    throw Input_error("degree of the fits: expected 1 to 6, found " + std::to_string(options.degree));
  if (options.polynomial_degree < 0 || options.polynomial_degree > max_vertex_fit_degree)
    throw Input_error("degree of the polynomials: expected 0 to " + std::to_string(max_vertex_fit_degree) + ", found " +
                      std::to_string(options.polynomial_degree));
  if (options.more_degrees_at_rim < -1 || options.more_degrees_at_rim > max_vertex_fit_degree)
    throw Input_error("degrees more at rims: expected -1 to " + std::to_string(max_vertex_fit_degree) + ", found " +
                      std::to_string(options.more_degrees_at_rim));
  if (!(options.largest_displacement > 0) || !(options.largest_disagreement > 0))
    throw Input_error("largest displacement and disagreement of the fits: expected positive numbers");
  if (options.data == Vertex_fit_data::points_and_normals && !has_parameter<NamedParameters, names::vertex_normal_map>)
    throw Input_error("fits of points and normals: expected a vertex_normal_map");
  namespace s = internal::surface;
  s::check_corner_counts(g);
  s::Surface_arrays surface = s::gather_surface(g, params, s::Neighbor_rule::whole_region);
  const int polynomial_degree =
    options.polynomial_degree > 0 ? options.polynomial_degree : vertex_fit_degree(options.degree);
  const int degree_at_rim = options.more_degrees_at_rim >= 0 ? polynomial_degree + options.more_degrees_at_rim
                                                             : vertex_fit_degree_at_rim(polynomial_degree);
  s::Vertex_fit_bounds bounds{polynomial_degree, std::min(degree_at_rim, max_vertex_fit_degree),
                              options.largest_displacement, options.largest_disagreement};
  std::vector<Point> data_normals;
  if (options.data == Vertex_fit_data::points_and_normals)
  {
    data_normals = s::normals_off_rims(surface);
    bounds.data_normals = data_normals;
  }
  s::All_vertex_fits<Policies> all(surface, policies, bounds);
  all.run(options.progress, "reconstruct surface");
  if (report)
    *report = s::Face_reporter(surface, all.outcomes(), options.degree, polynomial_degree).report();
  return Vertex_fits<Graph>(g, std::move(surface), all.fits());
}

} // namespace recurve

#endif
