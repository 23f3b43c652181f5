#ifndef RECURVE_VOLUME_INTERNAL_RESTORATION_H
#define RECURVE_VOLUME_INTERNAL_RESTORATION_H

#include <recurve/core/types.h>
#include <recurve/elements/element.h>
#include <recurve/elements/node_layout.h>
#include <recurve/volume/bound_jacobian.h>
#include <recurve/volume/internal/curving_levels.h>
#include <recurve/volume/internal/flat_cell.h>
#include <recurve/volume/internal/repair_interior.h>
#include <recurve/volume/internal/restoration_cells.h>
#include <recurve/volume/restoration_report.h>

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

namespace recurve::internal {

/// The work of `restore_validity()`.
template <class Points, class Straight, class Visit>
class Restoration
{
public:
  Restoration(Points& nodes, const Straight& straight, std::span<const Element_block> blocks, int degree,
              std::span<const Node_role> roles, std::span<const std::array<Index, 2>> linked,
              const Restoration_options& options, const Visit& visit)
    : nodes_(nodes), straight_(straight), cells_(blocks, degree), roles_(roles), options_(options), visit_(visit),
      levels_(nodes, straight, linked), bounders_(wide_kernel())
  {}

  Restoration_report run()
  {
    certify_straight();
    report_.deformed = certify_all();
    std::vector<Block_element> failing = cells_.with(Restoration_cells::failing);
    report_.failing_cells = static_cast<Index>(failing.size());
    if (failing.empty())
      report_.restored = report_.deformed;
    else
    {
      reduce(repair_with_surface(std::move(failing)));
      smooth();
      reduce(repair(certify_changes()));
      report_.restored = certify_all(); // anew: nothing rests on what was remembered
      report_.uncertified = cells_.with(Restoration_cells::failing);
    }
    count_nodes();
    return std::move(report_);
  }

  std::span<const std::uint8_t> levels() const { return levels_.levels(); }

private:
  // Certification. ---------------------------------------------------------------------------------------------------

  void certify_straight()
  {
    const auto always = [](Index, Index) { return true; };
    report_.straight = bound_jacobians(straight_, cells_.blocks(), cells_.degree(), options_.jacobian, always,
                                       [this](Index block, Index element, const Jacobian_bounds& bounds) {
                                         const Block_element cell{block, element};
                                         if (bounds.verdict != Validity::valid)
                                           cells_.flags(cell) = Restoration_cells::excluded;
                                       });
    report_.excluded = cells_.with(Restoration_cells::excluded);
  }

  /// whether the short test of the corners suffices.
  bool is_straight(Block_element cell) const
  {
    const auto nodes = cells_.nodes(cell);
    return std::all_of(nodes.begin(), nodes.end(),
                       [this](Index n) { return levels_.current(n) == levels_.straight(n); });
  }

  void note(Block_element cell, const Jacobian_bounds& bounds)
  {
    if (cells_.has(Restoration_cells::excluded, cell))
      return;
    std::uint8_t& flags = cells_.flags(cell);
    if (bounds.verdict == Validity::valid)
      flags &= static_cast<std::uint8_t>(~Restoration_cells::failing);
    else
      flags |= Restoration_cells::failing;
  }

  Jacobian_report certify_all()
  {
    return bound_jacobians(
      nodes_, cells_.blocks(), cells_.degree(), options_.jacobian,
      [this](Index block, Index element) {
        return is_straight({block, element});
      },
      [this](Index block, Index element, const Jacobian_bounds& bounds) {
        note({block, element}, bounds);
        visit_(block, element, bounds);
      });
  }

  /// certifies the cells with a changed node anew. Returns those of them that fail.
  std::vector<Block_element> certify_changes()
  {
    const std::vector<Block_element> touched = cells_.touching(levels_.changed());
    levels_.forget_changes();
    certify(touched);
    std::vector<Block_element> failing;
    std::copy_if(touched.begin(), touched.end(), std::back_inserter(failing),
                 [this](Block_element cell) { return cells_.has(Restoration_cells::failing, cell); });
    return failing;
  }

  void certify(std::span<const Block_element> selection)
  {
    const auto short_test = [this](Index block, Index element) { return is_straight({block, element}); };
    const auto noted = [this](Index block, Index element, const Jacobian_bounds& bounds) {
      note({block, element}, bounds);
    };
    using Bounder = Block_bounder<Points, decltype(short_test), decltype(noted)>;
    for (auto first = selection.begin(); first != selection.end();)
    {
      std::vector<Index> elements;
      const Index block = first->block;
      for (; first != selection.end() && first->block == block; ++first)
        elements.push_back(first->element);
      Bounder(nodes_, cells_.block(block), block, cells_.degree(), options_.jacobian, short_test, noted, bounders_)
        .report(elements);
    }
  }

  /// whether the cell would be certified with its nodes at `position(node)`.
  template <class Position>
  bool is_valid(Block_element cell, const Position& position) const
  {
    const auto nodes = cells_.nodes(cell);
    std::array<Point, node_count(Element_type::hexahedron, max_degree)> points;
    bool is_straight = true;
    for (std::size_t m = 0; m < nodes.size(); ++m)
    {
      points[m] = position(nodes[m]);
      is_straight = is_straight && points[m] == levels_.straight(nodes[m]);
    }
    const Element_type type = cells_.type(cell);
    const auto bounds = [&](int degree) {
      return bound_jacobian(type, degree, std::span(points).first(static_cast<std::size_t>(node_count(type, degree))),
                            options_.jacobian);
    };
    if (is_straight)
    {
      const Jacobian_bounds short_bounds = bounds(1);
      const auto corners = std::span(points).first(static_cast<std::size_t>(corner_count(type)));
      if (short_bounds.verdict != Validity::valid || !may_be_flat(short_bounds.lower, corners))
        return short_bounds.verdict == Validity::valid;
    }
    return bounds(cells_.degree()).verdict == Validity::valid;
  }

  // Repair. ----------------------------------------------------------------------------------------------------------

  /// moves inner nodes around failing cells. Returns the cells that still fail.
  std::vector<Block_element> repair(std::vector<Block_element> failing)
  {
    if (options_.repair_layers == 0 || failing.empty())
      return failing;
    const auto is_valid_at = [this](Block_element cell, const auto& position) { return is_valid(cell, position); };
    Interior_repair(cells_, levels_, roles_, options_, is_valid_at).run(failing);
    report_.repaired_nodes += levels_.change_count();
    certify_changes();
    std::vector<Block_element> rest = cells_.with(Restoration_cells::failing);
    report_.repaired_cells += static_cast<Index>(failing.size()) - static_cast<Index>(rest.size());
    return rest;
  }

  /// repairs; where that does not suffice, lowers the boundary of failing cells by one step of the ladder, and repairs
  /// again: the inside follows the boundary better than by giving up its own displacement.
  std::vector<Block_element> repair_with_surface(std::vector<Block_element> failing)
  {
    failing = repair(std::move(failing));
    bool is_better = options_.repair_layers > 0;
    for (int step = 0; is_better && step < straight_level && lower_boundary(failing); ++step)
    {
      ++report_.rounds;
      certify_changes();
      std::vector<Block_element> rest = repair(cells_.with(Restoration_cells::failing));
      is_better = rest.size() < failing.size();
      failing = std::move(rest);
    }
    return failing;
  }

  /// lowers displaced nodes on the boundary of failing cells by one level. Returns whether there were any.
  bool lower_boundary(std::span<const Block_element> failing)
  {
    std::vector<std::pair<Index, std::uint8_t>> wanted;
    for (const Block_element cell : failing)
      for (const Index node : cells_.nodes(cell))
        if (const std::uint8_t level = levels_.level(node);
            roles_[static_cast<std::size_t>(node)] != Node_role::inside && level < straight_level &&
            levels_.is_displaced(node))
          wanted.emplace_back(node, static_cast<std::uint8_t>(level + 1));
    for (const auto& [node, level] : wanted)
      levels_.request(node, level);
    levels_.apply();
    return !wanted.empty();
  }

  // Reduction. -------------------------------------------------------------------------------------------------------

  /// A way to reduce a cell: all its nodes of `role` and of those before it, to at least `level`.
  struct Reduction
  {
    Node_role role;
    std::uint8_t level;
  };

  static constexpr Reduction to_straight = {Node_role::surface, straight_level};

  std::uint8_t reduced_level(Index node, const Reduction& reduction) const
  {
    const std::uint8_t own = levels_.level(node);
    return roles_[static_cast<std::size_t>(node)] <= reduction.role ? std::max(own, reduction.level) : own;
  }

  bool changes(Block_element cell, const Reduction& reduction) const
  {
    const auto nodes = cells_.nodes(cell);
    return std::any_of(nodes.begin(), nodes.end(), [&](Index n) {
      return reduced_level(n, reduction) != levels_.level(n) && levels_.is_displaced(n);
    });
  }

  /// the mildest way that makes the cell valid if its neighbours stay as they are.
  Reduction mildest_reduction(Block_element cell) const
  {
    for (const Node_role role : {Node_role::inside, Node_role::follower, Node_role::surface})
      for (std::uint8_t level = 1; level <= straight_level; ++level)
        if (const Reduction reduction{role, level}; changes(cell, reduction) && is_valid(cell, [&](Index n) {
                                                      return levels_.position(n, reduced_level(n, reduction));
                                                    }))
          return reduction;
    return to_straight;
  }

  /// reduces until no cell fails. Every failing cell decides from the same levels; the largest level asked for counts.
  void reduce(std::vector<Block_element> failing)
  {
    while (!failing.empty())
    {
      ++report_.rounds;
      std::vector<Reduction> reductions(failing.size());
      tbb::parallel_for(std::size_t(0), failing.size(),
                        [&](std::size_t f) { reductions[f] = mildest_reduction(failing[f]); });
      for (std::size_t f = 0; f < failing.size(); ++f)
        for (const Index node : cells_.nodes(failing[f]))
          levels_.request(node, reduced_level(node, reductions[f]));
      if (!levels_.has_changes())
        return; // cells that are straight, and fail: not of a conforming mesh
      levels_.apply();
      failing = certify_changes();
    }
  }

  /// lets reductions fade out: on the boundary from face to face, inside from cell to cell.
  void smooth()
  {
    std::vector<std::uint8_t> reach(levels_.levels().begin(), levels_.levels().end());
    const int layers = options_.smoothing_layers;
    for (int layer = 1; layer <= layers; ++layer)
    {
      const std::vector<Block_element> touched = cells_.touching(reach);
      std::vector<std::uint8_t> next = reach;
      for (const Block_element cell : touched)
        spread(cell, reach, next);
      reach = std::move(next);
      for (const Block_element cell : touched)
        for (const Index node : cells_.nodes(cell))
          levels_.request(node, static_cast<std::uint8_t>(reach[static_cast<std::size_t>(node)] * (layers + 1 - layer) /
                                                          (layers + 1)));
    }
    levels_.apply();
  }

  void spread(Block_element cell, const std::vector<std::uint8_t>& reach, std::vector<std::uint8_t>& next) const
  {
    const auto nodes = cells_.nodes(cell);
    const auto largest = [&](const auto& numbers, const auto& node_of) {
      std::uint8_t result = 0;
      for (const auto number : numbers)
        result = std::max(result, reach[static_cast<std::size_t>(node_of(number))]);
      return result;
    };
    const auto raise = [&](Index node, std::uint8_t level) {
      std::uint8_t& own = next[static_cast<std::size_t>(node)];
      own = std::max(own, level);
    };
    const auto is_inside = [this](Index node) { return roles_[static_cast<std::size_t>(node)] == Node_role::inside; };
    std::uint8_t inside = 0; // of the nodes that are
    for (const Index node : nodes)
      if (is_inside(node))
        inside = std::max(inside, reach[static_cast<std::size_t>(node)]);
    for (const Index node : nodes)
      if (is_inside(node))
        raise(node, inside);
    const Element_type type = cells_.type(cell);
    for (int f = 0; f < reference_element(type).face_count; ++f)
    {
      const auto numbers = face_nodes(type, cells_.degree(), f);
      const auto node_of = [&](int m) { return nodes[static_cast<std::size_t>(m)]; };
      if (std::any_of(numbers.begin(), numbers.end(), [&](int m) { return is_inside(node_of(m)); }))
        continue;
      const std::uint8_t in_face = largest(numbers, node_of);
      for (const int m : numbers)
        raise(node_of(m), in_face);
    }
  }

  // Report. ----------------------------------------------------------------------------------------------------------

  void count_nodes()
  {
    for (Index n = 0; n < static_cast<Index>(levels_.levels().size()); ++n)
      if (levels_.is_displaced(n))
        ++report_.nodes_of_level[levels_.level(n)];
    report_.reduced_cells = static_cast<Index>(cells_
                                                 .select([this](Block_element cell) {
                                                   const auto nodes = cells_.nodes(cell);
                                                   return std::any_of(nodes.begin(), nodes.end(), [this](Index n) {
                                                     return levels_.level(n) > 0 && levels_.is_displaced(n);
                                                   });
                                                 })
                                                 .size());
  }

  Points& nodes_;
  const Straight& straight_;
  Restoration_cells cells_;
  std::span<const Node_role> roles_;
  const Restoration_options& options_;
  const Visit& visit_;
  Curving_levels<Points, Straight> levels_;
  tbb::enumerable_thread_specific<Jacobian_bounder> bounders_;
  Restoration_report report_;
};

} // namespace recurve::internal

#endif
