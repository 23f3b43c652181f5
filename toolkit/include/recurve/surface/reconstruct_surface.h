#ifndef RECURVE_SURFACE_RECONSTRUCT_SURFACE_H
#define RECURVE_SURFACE_RECONSTRUCT_SURFACE_H

#include <recurve/core/exceptions.h>
#include <recurve/core/named_parameters.h>
#include <recurve/core/progress.h>
#include <recurve/surface/internal/fit_faces.h>
#include <recurve/surface/internal/gather_surface.h>
#include <recurve/surface/local_fit.h>
#include <recurve/surface/policies.h>
#include <recurve/surface/reconstruction_report.h>

#include <string>

namespace recurve {

/// What a call to `reconstruct_surface()` may vary. How stencils grow, how points are weighted and how the equations
/// are solved are types: see `Reconstruction_policies`.
struct Reconstruction_options
{
  int degree = 2; ///< degree d of the local polynomials, 1 <= d <= 6
  double largest_displacement =
    100; ///< a fit that moves a corner, mid-edge or centre of its face farther is lowered; in
         ///< sizes of the face (largest distance of a corner from the centre). The paper's
         ///< check is "hundreds of times"; 1 already is more than any arc of a half circle.
  bool interpolates_corners = false; ///< corner correction: the fit of a triangle or quad goes through its corners, by
                                     ///< a linear function of their residuals more (and, in a quad of degree 2 and
                                     ///< more, one quadratic). Gains up to 3 times at d = 2; the paper has none.
  Progress_callback progress = {};   ///< called with the stage "reconstruct surface"
};

/// fits, for each face of `g`, a weighted least-squares polynomial height function over the tangent plane at the mean
/// of its corners, from the vertices around it that no critical edge separates from it.
///
/// A planar surface gets fits that are exactly flat. A polynomial surface of degree <= `options.degree` is reproduced
/// to the accuracy of the solver (1e-8 of the heights by default); a smooth one is approximated to O(h^(degree+1)).
/// Where a fit is not finite or moves the face too far, the face is fitted again with a degree
/// one lower, down to 0, which leaves it straight; the report tells where and why. A face without a normal (zero area)
/// gets a flat fit.
///
/// Lengths are in the unit of the points; nothing depends on that unit nor on the place of the mesh. The result is
/// independent of the number of threads (oneTBB; limit it with `tbb::global_control`) and, to the solver's bound, of
/// the numbering. `g` is not changed; faces of `g` are consistently oriented, which side is outside does not matter.
///
/// \tparam Graph       model of `FaceListGraph`; faces with three or more corners. Faces that meet in a vertex but not
///                     in an edge (non-manifold vertex) count as separate sheets.
/// \tparam FaceFitMap  model of `WritablePropertyMap`: face_descriptor -> `Local_fit`. Written by one thread at a time.
/// \param params       `vertex_point_map` (default: the internal one), `vertex_normal_map` (outward unit normals;
///                     default: mean of the face normals weighted by the faces' angles. Critical vertices always take
///                     that mean, over the faces of each surface region alone), `edge_is_constrained_map` (critical
///                     edges; default: none), `vertex_is_constrained_map` (sharp vertices; default: none. A vertex
///                     where three or more critical edges meet is always taken as sharp), `geom_traits`.
/// \param policies     the paper's choices by default.
/// \throws Input_error if `options.degree` is outside [1, 6], the largest displacement is not positive or a coordinate
/// is not finite; `fits` is then untouched. \throws Cancelled if the progress callback asks to stop; some fits are then
/// written. \par Complexity  linear in the faces; memory about 500 bytes per vertex at its peak, plus 4 bytes per
/// vertex and thread. \par Source      Ims & Wang 2018, section 3.3; Jiao & Wang 2012 (WALF).
template <class Graph, class FaceFitMap, class NamedParameters = No_parameters, class Policies = Paper_policies>
Reconstruction_report reconstruct_surface(const Graph& g, FaceFitMap fits, const Reconstruction_options& options = {},
                                          const NamedParameters& params = no_parameters, const Policies& policies = {})
{
  static_assert(only_names<NamedParameters, names::vertex_point_map, names::vertex_normal_map,
                           names::edge_is_constrained_map, names::vertex_is_constrained_map, names::geom_traits>,
                "reconstruct_surface takes vertex_point_map, vertex_normal_map, edge_is_constrained_map, "
                "vertex_is_constrained_map and geom_traits only");
  if (options.degree < 1 || options.degree > max_fit_degree)
    throw Input_error("degree of the fits: expected 1 to 6, found " + std::to_string(options.degree));
  if (!(options.largest_displacement > 0))
    throw Input_error("largest displacement of the fits: expected a positive number");
  const internal::surface::Surface_arrays surface = internal::surface::gather_surface(g, params);
  return internal::surface::fit_faces(g, surface, fits,
                                      {options.degree, options.largest_displacement, options.interpolates_corners},
                                      policies, options.progress);
}

} // namespace recurve

#endif
