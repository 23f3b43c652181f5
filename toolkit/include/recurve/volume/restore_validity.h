#ifndef RECURVE_VOLUME_RESTORE_VALIDITY_H
#define RECURVE_VOLUME_RESTORE_VALIDITY_H

#include <recurve/core/types.h>
#include <recurve/volume/bound_jacobian.h>
#include <recurve/volume/element_block.h>
#include <recurve/volume/internal/curving_levels.h>
#include <recurve/volume/internal/point_access.h>
#include <recurve/volume/internal/restoration.h>
#include <recurve/volume/restoration_report.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <ranges>
#include <span>
#include <vector>

namespace recurve {

/// What `restore_validity()` may be told about the nodes, and what it tells.
struct Restoration_nodes
{
  std::span<const Node_role> roles; ///< one per node

  /// Pairs of nodes that have to keep the same share of their displacement, such as the two sides of a periodic
  /// boundary.
  std::span<const std::array<Index, 2>> linked = {};

  /// Result, one per node or empty: the share of its displacement that the node has kept, from 0 to 1.
  std::span<double> factors = {};

  /// Where the second node of a linked pair belongs if the first one is at a position: there it goes when both keep a
  /// part of their displacement, so that the two sides stay congruent to the bit. Without it each node goes along its
  /// own line, and rounding may differ. Called from several threads.
  Linked_image image = {};
};

/// makes every cell of a curved mesh certified valid whose straight-sided cell is, by giving up as little curvature as
/// it takes.
///
/// 1. The straight-sided cells are certified; what fails there is named, and excluded from the promise.
/// 2. The cells with displaced nodes are certified (`bound_jacobian()`); undecided counts as failing.
/// 3. Around failing cells, nodes inside the volume are moved so that the cells resemble the straight-sided ones as
///    closely as the boundary lets them, with a barrier against folding. What this makes worse is undone.
/// 4. A cell that could not be valid wherever its inner nodes were is relieved: the edges and insides of faces on the
///    curved boundary are lowered that cost the fewest faces their full curvature, as little as will do, and 3 follows.
///    What has not helped is taken back.
/// 5. Cells that still fail lower the factors of their vertices, edges, faces and interior on the ladder
///    `curving_factors`: those of the inside alone if that makes the cell valid, else also those of followers, else of
///    all. All failing cells decide from the same state, the smallest factor asked for counts, and then every cell that
///    shares a node is certified anew. From here on factors never grow, and a cell whose factors are all 0 is the
///    straight-sided one: so it ends.
/// 6. Reductions fade out over some layers; then 5 again. Where this does not come to rest soon (in layers thinner than
///    the displacement), it is undone, and displacements are scaled smoothly around failing cells instead.
/// 7. All cells are certified, with nothing taken over from before.
///
/// A node shared by cells, or by zones, stays shared; one that has not been displaced stays where it is, to the bit;
/// one that only loses curvature stays on the line between its two positions, hence in a plane that has both.
/// The result depends neither on the number of threads nor on the order of the cells.
///
/// \tparam Points    model of `Point_range`, writable.
/// \tparam Straight  model of `Point_range`.
/// \tparam Blocks    model of `Element_block_range`: all cells of a conforming mesh.
/// \tparam Visit     callable (Index block, Index element, const Jacobian_bounds&), from several threads: for each cell
///                   once or twice; the last call has its final bounds.
/// \param nodes      curved positions.
/// \param straight   positions in the straight-sided mesh, one per node: at its corners and, with the other nodes
///                   interpolated from them, for every cell.
/// \throws Input_error if sizes do not match, an option is out of range, or as `bound_jacobians()`.
/// \par Complexity   two certifications of the mesh and one of its straight cells; each round one pass over the
///                   connectivity. Memory: 1 byte per cell and 2 per node, and more only for nodes that change.
template <Point_range Points, Point_range Straight, Element_block_range Blocks, class Visit = Ignore_bounds>
Restoration_report restore_validity(Points&& nodes, const Straight& straight, const Blocks& blocks, int degree,
                                    const Restoration_nodes& about, const Restoration_options& options = {},
                                    const Visit& visit = {})
{
  std::vector<Element_block> views;
  if constexpr (std::ranges::sized_range<const Blocks>)
    views.reserve(std::ranges::size(blocks));
  for (const auto& block : blocks)
    views.push_back({block.type, std::span<const Index>(block.nodes)});
  internal::check_restoration(views, degree, std::ranges::size(nodes), std::ranges::size(straight), about.roles.size(),
                              about.factors.size(), about.linked, options);
  internal::Restoration restoration(nodes, straight, views, degree, about.roles, {about.linked, about.image}, options,
                                    visit);
  Restoration_report report = restoration.run();
  for (std::size_t n = 0; n < about.factors.size(); ++n)
    about.factors[n] = restoration.factor(static_cast<Index>(n));
  return report;
}

} // namespace recurve

#endif
