#ifndef RECURVE_VOLUME_ELEMENT_BLOCK_H
#define RECURVE_VOLUME_ELEMENT_BLOCK_H

#include <recurve/core/types.h>
#include <recurve/elements/element.h>

#include <concepts>
#include <ranges>
#include <span>

namespace recurve {

/// A view of elements of one type and degree: `node_count(type, degree)` node numbers per element, one element after
/// the other, each in canonical order (elements/node_layout.h). What the passes over the volume see of a mesh.
struct Element_block
{
  Element_type type = Element_type::tetrahedron;
  std::span<const Index> nodes;
};

/// Anything with a `type` and contiguous `nodes`: `Element_block`, and the sections of a `Curved_mesh` as they are.
template <class T>
concept Element_block_like = requires(const T& block)
{
  {
    block.type
    } -> std::convertible_to<Element_type>;
  std::span<const Index>(block.nodes);
};

/// A range of such blocks, for example `mesh.zones[0].cells`, or one `std::vector<Element_block>` for all zones.
template <class Range>
concept Element_block_range =
  std::ranges::input_range<const Range> && Element_block_like<std::ranges::range_value_t<const Range>>;

} // namespace recurve

#endif
