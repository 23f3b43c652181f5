#ifndef RECURVE_CORE_NAMED_PARAMETERS_H
#define RECURVE_CORE_NAMED_PARAMETERS_H

#include <CGAL/Named_function_parameters.h>

#include <type_traits>

namespace recurve {

/// The type of `params` when a caller passes none: `const NamedParameters& params = no_parameters`.
using No_parameters = CGAL::parameters::Default_named_parameters;
inline const No_parameters no_parameters = CGAL::parameters::default_values();

/// The names that this library takes, in CGAL's own spelling at the caller:
/// `CGAL::parameters::vertex_point_map(map).edge_is_constrained_map(map)`.
namespace names {
using vertex_point_map = CGAL::internal_np::vertex_point_t;
using vertex_normal_map = CGAL::internal_np::vertex_normal_map_t;
using vertex_index_map = CGAL::internal_np::vertex_index_t;
using edge_index_map = CGAL::internal_np::edge_index_t;
using face_index_map = CGAL::internal_np::face_index_t;
using edge_is_constrained_map = CGAL::internal_np::edge_is_constrained_t;
using vertex_is_constrained_map = CGAL::internal_np::vertex_is_constrained_t;
using face_patch_map = CGAL::internal_np::face_patch_t;
using geom_traits = CGAL::internal_np::geom_traits_t;
} // namespace names

/// Whether every name in `NamedParameters` is one of `Allowed`. CGAL itself ignores unknown names silently, so each
/// public function states
/// `static_assert(only_names<NamedParameters, names::vertex_point_map, ...>, "...")`.
template <class NamedParameters, class... Allowed>
inline constexpr bool only_names = false;

template <class T, class Tag, class Base, class... Allowed>
inline constexpr bool only_names<CGAL::Named_function_parameters<T, Tag, Base>, Allowed...> =
  (std::is_same_v<Tag, CGAL::internal_np::all_default_t> || (std::is_same_v<Tag, Allowed> || ...)) &&
  (std::is_same_v<Base, CGAL::internal_np::No_property> || only_names<Base, Allowed...>);

/// Whether the caller gave the parameter `Name`.
template <class NamedParameters, class Name>
inline constexpr bool has_parameter = !CGAL::parameters::is_default_parameter<NamedParameters, Name>::value;

/// the value that the caller gave for `Name`, or `otherwise`.
template <class Name, class NamedParameters, class Default>
auto parameter_or(const NamedParameters& params, Default otherwise)
{
  if constexpr (has_parameter<NamedParameters, Name>)
    return CGAL::parameters::get_parameter(params, Name());
  else
    return otherwise;
}

} // namespace recurve

#endif
