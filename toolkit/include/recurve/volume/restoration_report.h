#ifndef RECURVE_VOLUME_RESTORATION_REPORT_H
#define RECURVE_VOLUME_RESTORATION_REPORT_H

#include <recurve/core/types.h>
#include <recurve/volume/jacobian_bounds.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

namespace recurve {

/// What a node belongs to, and with it the order in which curvature is given up: inside first, surface last.
enum class Node_role : std::uint8_t
{
  inside,   ///< of the volume; also at interfaces between zones
  follower, ///< on a boundary that keeps its shape and follows the rim of a curved one
  surface   ///< on a curved boundary
};

/// Where the second node of a linked pair belongs if the first one is at `position`; `pair` is the number of the pair.
using Linked_image = std::function<Point(std::size_t pair, const Point& position)>;

/// The shares of its displacement that a node may keep when a cell is reduced. Each vertex, edge, face and cell
/// interior has one of them: its level. The last one takes it back to where the straight-sided mesh has it, to the bit.
inline constexpr std::array<double, 6> curving_factors = {1, 0.75, 0.5, 0.25, 0.125, 0};

/// The level of a node that is back on the straight-sided mesh.
inline constexpr std::uint8_t straight_level = curving_factors.size() - 1;

/// What a call to `restore_validity()` may vary.
struct Restoration_options
{
  Jacobian_options jacobian = {}; ///< how long to try to decide about a cell

  /// Layers of cells around a failing one, whose inner nodes may be moved to make it valid without giving up any
  /// curvature of the boundary, or after a few edges and faces of the boundary have been lowered; 0: no such repair.
  int repair_layers = 3;

  /// Largest number of nodes that one repair moves; more of them are left to the factors. A step costs about a
  /// microsecond for each.
  Index largest_repair = 200000;

  /// Layers of faces and cells around one that has been reduced as a whole that are reduced as well, less and less, so
  /// that the surface does not kink. Where edges and faces of the boundary are lowered for a repair, the faces beside
  /// them bend over to the others by themselves.
  int smoothing_layers = 1;
};

/// A cell by its block and its number in the block.
struct Block_element
{
  Index block = no_index;
  Index element = no_index;

  friend bool operator==(const Block_element&, const Block_element&) = default;
  // NOLINTNEXTLINE(modernize-use-nullptr): false alarm
  friend auto operator<=>(const Block_element&, const Block_element&) = default;
};

/// What `restore_validity()` did.
struct Restoration_report
{
  Jacobian_report straight; ///< of the straight-sided mesh
  Jacobian_report deformed; ///< of the mesh as it came
  Jacobian_report restored; ///< of the mesh as it is now

  /// Cells that the promise leaves out, ascending: the straight-sided cell is invalid, collapsed, or so flat that the
  /// rounding of its nodes folds it.
  std::vector<Block_element> excluded;

  /// Cells that were promised and are not certified, ascending. There are none, unless the mesh is not one: faces that
  /// share nodes but not all of them.
  std::vector<Block_element> uncertified;

  Index failing_cells = 0;  ///< promised cells that were not valid as they came
  Index repaired_cells = 0; ///< of them, those that moving inner nodes has made valid, and nothing else
  Index repaired_nodes = 0; ///< inner nodes that were moved for it, or after the boundary was lowered
  Index reduced_cells = 0;  ///< cells with a node that has lost curvature
  std::array<Index, curving_factors.size()> nodes_of_level =
    {};             ///< displaced nodes by the first of `curving_factors` that is not above theirs
  Index rounds = 0; ///< of lowering and certification

  bool is_certified() const { return uncertified.empty(); }
};

} // namespace recurve

#endif
