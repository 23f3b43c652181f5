#ifndef RECURVE_VOLUME_INTERNAL_REPAIR_INTERIOR_H
#define RECURVE_VOLUME_INTERNAL_REPAIR_INTERIOR_H

#include <recurve/core/types.h>
#include <recurve/volume/internal/repair_component.h>
#include <recurve/volume/internal/restoration_cells.h>
#include <recurve/volume/internal/untangle.h>
#include <recurve/volume/restoration_report.h>

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <unordered_map>
#include <utility>
#include <vector>

namespace recurve::internal {

/// Moves nodes inside the volume around failing cells: parts the cells there into components that share no node that
/// may move, and minimises the distortion of each. What does not help, or harms a cell that was valid, is left undone.
///
/// \tparam Levels  `Curving_levels`. \tparam IsValid  callable (cell, position of a node) -> bool.
template <class Levels, class IsValid>
class Interior_repair
{
public:
  Interior_repair(Restoration_cells& cells, Levels& levels, std::span<const Node_role> roles,
                  const Restoration_options& options, const IsValid& is_valid)
    : cells_(cells), levels_(levels), roles_(roles), options_(options), is_valid_(is_valid)
  {}

  /// \param failing  ascending
  void run(std::span<const Block_element> failing)
  {
    find_region(failing);
    find_movable();
    const std::vector<Component> components = find_components();
    std::vector<Moves> moves(components.size());
    tbb::parallel_for(std::size_t(0), components.size(), [&](std::size_t c) { moves[c] = repaired(components[c]); });
    for (const Moves& list : moves)
      for (const auto& [node, position] : list)
        levels_.move(node, position);
    for (const Block_element cell : region_)
      cells_.flags(cell) &= static_cast<std::uint8_t>(~Restoration_cells::in_region);
  }

private:
  using Component = std::vector<Block_element>;
  using Moves = std::vector<std::pair<Index, Point>>;

  void find_region(std::span<const Block_element> failing)
  {
    region_.assign(failing.begin(), failing.end());
    for (int layer = 0; layer < options_.repair_layers; ++layer)
    {
      std::vector<std::uint8_t> marks(levels_.levels().size());
      for (const Block_element cell : region_)
        for (const Index node : cells_.nodes(cell))
          marks[static_cast<std::size_t>(node)] = 1;
      region_ = cells_.touching(marks);
    }
    std::erase_if(region_, [this](Block_element cell) { return cells_.has(Restoration_cells::excluded, cell); });
    for (const Block_element cell : region_)
      cells_.flags(cell) |= Restoration_cells::in_region;
  }

  /// A node may move if it is inside the volume and no corner, nothing has been taken from it, and all its cells are in
  /// the region.
  void find_movable()
  {
    is_movable_.assign(levels_.levels().size(), 0);
    for (const Block_element cell : region_)
      for (const Index node : cells_.nodes(cell))
        is_movable_[static_cast<std::size_t>(node)] =
          roles_[static_cast<std::size_t>(node)] == Node_role::inside && levels_.factor(node) == 1;
    const auto fix = [this](std::span<const Index> nodes) {
      for (const Index node : nodes)
        is_movable_[static_cast<std::size_t>(node)] = 0;
    };
    for (const Block_element cell : region_)
      fix(cells_.nodes(cell).first(static_cast<std::size_t>(corner_count(cells_.type(cell)))));
    const std::vector<Block_element> around = cells_.select([this](Block_element cell) {
      return !cells_.has(Restoration_cells::in_region, cell) &&
             std::ranges::any_of(cells_.nodes(cell), [this](Index n) { return may_move(n); });
    });
    for (const Block_element cell : around)
      fix(cells_.nodes(cell));
  }

  bool may_move(Index node) const { return is_movable_[static_cast<std::size_t>(node)] != 0; }

  /// the cells of the region that a failing one is linked with by nodes that may move. Each in an order of its own that
  /// does not depend on that of the cells.
  std::vector<Component> find_components() const
  {
    const std::vector<std::size_t> cluster = cells_.clusters(region_, [this](Index node) { return may_move(node); });
    std::vector<Component> all(region_.size());
    for (std::size_t c = 0; c < region_.size(); ++c)
      all[cluster[c]].push_back(region_[c]);
    std::erase_if(all, [this](const Component& cells) {
      return std::ranges::none_of(cells, [this](Block_element c) { return cells_.has(Restoration_cells::failing, c); });
    });
    for (Component& cells : all)
      std::ranges::sort(cells, [this](Block_element a, Block_element b) {
        return std::ranges::lexicographical_compare(cells_.nodes(a), cells_.nodes(b));
      });
    return all;
  }

  /// A component with its own numbers of nodes, those that may move first.
  struct Numbering
  {
    std::vector<Index> nodes;
    std::size_t movable = 0;
    std::unordered_map<Index, int> numbers;
  };

  Numbering numbered(const Component& component) const
  {
    Numbering result;
    for (const bool is_movable : {true, false})
    {
      for (const Block_element cell : component)
        for (const Index node : cells_.nodes(cell))
          if (may_move(node) == is_movable &&
              result.numbers.try_emplace(node, static_cast<int>(result.nodes.size())).second)
            result.nodes.push_back(node);
      if (is_movable)
        result.movable = result.nodes.size();
    }
    return result;
  }

  Moves repaired(const Component& component) const
  {
    const Numbering numbering = numbered(component);
    if (numbering.movable == 0 || static_cast<Index>(numbering.movable) > options_.largest_repair)
      return {};
    Repair_component repair = prepared(component, numbering);
    const auto moved = [&](Index node) {
      const auto number = static_cast<std::size_t>(numbering.numbers.at(node));
      if (number >= numbering.movable)
        return levels_.current(node);
      Point p = levels_.straight(node);
      for (std::size_t d = 0; d < 3; ++d)
        p[d] += repair.displacements()[number][d];
      return p;
    };
    // Those that fail come first, so that a negative answer comes soon.
    Component failing_first = component;
    std::stable_partition(failing_first.begin(), failing_first.end(),
                          [this](Block_element c) { return cells_.has(Restoration_cells::failing, c); });
    const auto all_valid = [&] {
      return std::ranges::all_of(failing_first, [&](auto c) { return is_valid_(c, moved); });
    };
    if (!untangle(repair, all_valid) && !helps(component, moved))
      return {};
    Moves moves;
    for (std::size_t n = 0; n < numbering.movable; ++n)
      if (const Point p = moved(numbering.nodes[n]); p != levels_.current(numbering.nodes[n]))
        moves.emplace_back(numbering.nodes[n], p);
    return moves;
  }

  Repair_component prepared(const Component& component, const Numbering& numbering) const
  {
    std::vector<Point> displacements;
    for (const Index node : numbering.nodes)
    {
      const Point from = levels_.straight(node), to = levels_.current(node);
      displacements.push_back({to[0] - from[0], to[1] - from[1], to[2] - from[2]});
    }
    std::vector<Distorted_cell> cells;
    cells.reserve(component.size());
    for (const Block_element cell : component)
    {
      const Element_type type = cells_.type(cell);
      cells.push_back({type, &distortion_points(type, cells_.degree()), {}, {}});
      for (const Index node : cells_.nodes(cell))
      {
        cells.back().straight.push_back(levels_.straight(node));
        cells.back().nodes.push_back(numbering.numbers.at(node));
      }
    }
    return Repair_component(cells, std::move(displacements), numbering.movable);
  }

  /// whether fewer cells would fail, and none of those that do not now.
  template <class Position>
  bool helps(const Component& component, const Position& position) const
  {
    bool is_better = false;
    for (const Block_element cell : component)
    {
      const bool was_failing = cells_.has(Restoration_cells::failing, cell);
      const bool is_failing = !is_valid_(cell, position);
      if (is_failing && !was_failing)
        return false;
      is_better = is_better || (was_failing && !is_failing);
    }
    return is_better;
  }

  Restoration_cells& cells_;
  Levels& levels_;
  std::span<const Node_role> roles_;
  const Restoration_options& options_;
  const IsValid& is_valid_;
  std::vector<Block_element> region_;
  std::vector<std::uint8_t> is_movable_; ///< per node
};

} // namespace recurve::internal

#endif
