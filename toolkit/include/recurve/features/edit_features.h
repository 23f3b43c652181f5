#ifndef RECURVE_FEATURES_EDIT_FEATURES_H
#define RECURVE_FEATURES_EDIT_FEATURES_H

#include <recurve/core/named_parameters.h>
#include <recurve/features/feature_edit.h>
#include <recurve/features/internal/feature_editor.h>

#include <CGAL/boost/graph/named_params_helper.h>

#include <span>
#include <utility>
#include <vector>

namespace recurve {

/// edge_is_critical and vertex_is_sharp: applies the changes of `edits` one after the other to the features of `g`,
/// whether they were detected or not; later ones see and override what earlier ones did.
///
/// A vertex on an added edge becomes sharp where more than two critical edges meet, or two of them turn by more than
/// `options.turning_angle`. A vertex that loses an edge ceases to be sharp unless one of the two still holds or it is a
/// corner by itself. Vertices that an edit marks or unmarks by name are in the end as it says, whatever the curves do.
/// Border and constrained edges stay critical: naming one of them to be removed is an error, in a larger area they are
/// left out and counted. A path that is removed leads along critical edges, a chain to the ends of its curve. Where
/// several vertices have one position (as at non-manifold vertices), its name means all of them.
///
/// The same edits on the same graph give the same flags, and on another model of it with the same order of vertices
/// too. `g` is not changed.
///
/// \tparam Graph              model of `FaceListGraph`; planar or nearly planar faces of any size.
/// \tparam EdgeIsCriticalMap  model of `ReadWritePropertyMap`: edge_descriptor -> bool or char.
/// \tparam VertexIsSharpMap   model of `ReadWritePropertyMap`: vertex_descriptor -> bool or char.
/// \param params  `vertex_point_map`; `geom_traits` (taken for the sake of uniformity: angles are measured in doubles);
///                `edge_is_constrained_map` (default: none); `face_patch_map`: face_descriptor -> an integer, for edits
///                between patches (default: none).
/// \throws Input_error if `options` break the rules of `check()`, a position is not finite, or an edit names an edge or
///         vertex that is not there (the nearest ones are told), contradicts another one (the same single edge is added
///         and removed, the same vertex marked and unmarked), or is incomplete; both maps are then untouched.
/// \par Complexity  linear in the size of `g`, and for each path n log n in the part of it that the search visits.
/// \par Source      Ims & Wang 2018, section 3.2.
template <class Graph, class EdgeIsCriticalMap, class VertexIsSharpMap, class NamedParameters = No_parameters>
Feature_edit_report apply_feature_edits(const Graph& g, std::span<const Feature_edit> edits,
                                        EdgeIsCriticalMap edge_is_critical, VertexIsSharpMap vertex_is_sharp,
                                        const Feature_edit_options& options = {},
                                        const NamedParameters& params = no_parameters)
{
  static_assert(
    only_names<NamedParameters, names::vertex_point_map, names::geom_traits, names::edge_is_constrained_map,
               names::face_patch_map>,
    "apply_feature_edits() takes vertex_point_map, geom_traits, edge_is_constrained_map and face_patch_map");
  namespace f = internal::features;
  check(options);
  const auto surface =
    f::flatten(g, parameter_or<names::vertex_point_map>(params, CGAL::get_const_property_map(CGAL::vertex_point, g)));
  std::vector<char> constrained;
  if constexpr (has_parameter<NamedParameters, names::edge_is_constrained_map>)
    constrained = f::read_flags(edges(g), parameter_or<names::edge_is_constrained_map>(params, 0));
  std::vector<Index> patches;
  if constexpr (has_parameter<NamedParameters, names::face_patch_map>)
    patches = f::read_patches(g, parameter_or<names::face_patch_map>(params, 0));

  f::Feature_editor editor(surface, constrained, std::move(patches), options, f::read_flags(edges(g), edge_is_critical),
                           f::read_flags(vertices(g), vertex_is_sharp));
  Feature_edit_report report = editor.run(edits);
  f::write_flags(edges(g), editor.edge_is_critical(), edge_is_critical);
  f::write_flags(vertices(g), editor.vertex_is_sharp(), vertex_is_sharp);
  return report;
}

} // namespace recurve

#endif
