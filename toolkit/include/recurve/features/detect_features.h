#ifndef RECURVE_FEATURES_DETECT_FEATURES_H
#define RECURVE_FEATURES_DETECT_FEATURES_H

#include <recurve/core/named_parameters.h>
#include <recurve/features/feature_options.h>
#include <recurve/features/feature_report.h>
#include <recurve/features/internal/detect.h>

#include <CGAL/boost/graph/named_params_helper.h>

#include <utility>
#include <vector>

namespace recurve {

/// edge_is_critical and vertex_is_sharp: finds the edges of `g` at which its surface has a crease, and the vertices at
/// which creases end in a corner, turn or meet, or that are corners by themselves such as the tip of a cone.
///
/// Edges are ranked by their dihedral angle, absolute and relative to the other edges at their vertices, and by how
/// they continue the ridge there; vertices by their angle defect. What is strong at both its ends becomes a candidate;
/// candidates are assembled into curves; curves that fade out, end in doubt or are as bent as their surroundings are
/// rejected, until none is left to reject. The result does not depend on the order of vertices, edges and faces.
/// Border edges and constrained edges are always critical. Edges of faces without area have no dihedral angle.
/// Both maps are written completely; `g` is not changed.
///
/// \tparam Graph              model of `FaceListGraph`; planar or nearly planar faces of any size.
/// \tparam EdgeIsCriticalMap  model of `WritablePropertyMap`: edge_descriptor -> bool or char.
/// \tparam VertexIsSharpMap   model of `WritablePropertyMap`: vertex_descriptor -> bool or char.
/// \param params  `vertex_point_map`; `geom_traits` (taken for the sake of uniformity: angles are measured in doubles);
///                `edge_is_constrained_map` (edges that are critical in any case and do not take part in the ranking;
///                default: none); `face_patch_map`: face_descriptor -> an integer, for the options `patch_edges` and
///                `smooth_patches`.
/// \throws Input_error if `options` break the rules of `check()` or need a `face_patch_map` that is not given, or if a
///         position is not finite; both maps are then untouched.
/// \par Complexity  linear in the size of `g`, times the rounds of rejection among candidates (a handful).
/// \par Source      Jiao & Bayyana 2008, "Identification of C1 and C2 discontinuities for surface meshes in CAD",
///                  its C1 part; Ims & Wang 2018, section 3.2.
template <class Graph, class EdgeIsCriticalMap, class VertexIsSharpMap, class NamedParameters = No_parameters>
Feature_report detect_features(const Graph& g, EdgeIsCriticalMap edge_is_critical, VertexIsSharpMap vertex_is_sharp,
                               const Feature_options& options = {}, const NamedParameters& params = no_parameters)
{
  static_assert(only_names<NamedParameters, names::vertex_point_map, names::geom_traits, names::edge_is_constrained_map,
                           names::face_patch_map>,
                "detect_features() takes vertex_point_map, geom_traits, edge_is_constrained_map and face_patch_map");
  check(options);
  if (!has_parameter<NamedParameters, names::face_patch_map> && (options.patch_edges || options.smooth_patches))
    throw Input_error("feature options: patch_edges and smooth_patches need a face_patch_map");
  const auto surface = internal::features::flatten(
    g, parameter_or<names::vertex_point_map>(params, CGAL::get_const_property_map(CGAL::vertex_point, g)));
  std::vector<char> constrained;
  if constexpr (has_parameter<NamedParameters, names::edge_is_constrained_map>)
    constrained = internal::features::read_flags(edges(g), parameter_or<names::edge_is_constrained_map>(params, 0));
  std::vector<Index> patches;
  if constexpr (has_parameter<NamedParameters, names::face_patch_map>)
    patches = internal::features::read_patches(g, parameter_or<names::face_patch_map>(params, 0));

  auto detected = internal::features::detect(surface, constrained, patches, options);
  internal::features::write_flags(edges(g), detected.edge_is_critical, edge_is_critical);
  internal::features::write_flags(vertices(g), detected.vertex_is_sharp, vertex_is_sharp);
  return std::move(detected.report);
}

} // namespace recurve

#endif
