#ifndef RECURVE_VOLUME_INTERNAL_RESTORATION_H
#define RECURVE_VOLUME_INTERNAL_RESTORATION_H

#include <recurve/core/types.h>
#include <recurve/elements/element.h>
#include <recurve/elements/node_layout.h>
#include <recurve/volume/bound_jacobian.h>
#include <recurve/volume/internal/curving_levels.h>
#include <recurve/volume/internal/fade_balls.h>
#include <recurve/volume/internal/flat_cell.h>
#include <recurve/volume/internal/repair_interior.h>
#include <recurve/volume/internal/restoration_cells.h>
#include <recurve/volume/internal/wall_relief.h>
#include <recurve/volume/restoration_report.h>

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <map>
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
              std::span<const Node_role> roles, const Linked_nodes& linked, const Restoration_options& options,
              const Visit& visit)
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
      failing = repair(std::move(failing));
      report_.repaired_cells = std::max(report_.failing_cells - static_cast<Index>(failing.size()), Index(0));
      failing = relieve(std::move(failing));
      if (!failing.empty() && !reduce_nearby(failing))
        fade(std::move(failing));
      reduce(repair(cells_.with(Restoration_cells::failing)), most_rounds);
      report_.restored = certify_all(); // anew: nothing rests on what was remembered
      report_.uncertified = cells_.with(Restoration_cells::failing);
    }
    count_nodes();
    return std::move(report_);
  }

  /// share of its displacement that a node has kept.
  double factor(Index node) const { return levels_.factor(node); }

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

  void note(Block_element cell, Validity verdict)
  {
    if (cells_.has(Restoration_cells::excluded, cell))
      return;
    std::uint8_t& flags = cells_.flags(cell);
    if (verdict == Validity::valid)
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
        note({block, element}, bounds.verdict);
        visit_(block, element, bounds);
      });
  }

  /// certifies the cells with a changed node anew, without much effort: what takes more counts as failing until the
  /// end. Returns those of them that fail.
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
    const Jacobian_options quick = quick_options();
    const auto noted = [this](Index block, Index element, const Jacobian_bounds& bounds) {
      const Block_element cell{block, element};
      const bool is_certified = is_straight(cell); // at the start, with all effort
      note(cell, is_certified ? Validity::valid : bounds.verdict);
    };
    using Bounder = Block_bounder<Points, decltype(short_test), decltype(noted)>;
    for (auto first = selection.begin(); first != selection.end();)
    {
      std::vector<Index> elements;
      const Index block = first->block;
      for (; first != selection.end() && first->block == block; ++first)
        elements.push_back(first->element);
      Bounder(nodes_, cells_.block(block), block, cells_.degree(), quick, short_test, noted, bounders_)
        .report(elements);
    }
  }

  /// Effort for a cell that is only being considered: one that takes more is not worth having, and the certificate has
  /// the last word anyway.
  Jacobian_options quick_options() const
  {
    constexpr int few_parts = 500, few_exact_parts = 8;
    Jacobian_options options = options_.jacobian;
    options.max_parts = std::min(options.max_parts, few_parts);
    options.max_exact_parts = std::min(options.max_exact_parts, few_exact_parts);
    return options;
  }

  /// whether the cell would be certified, without much effort, with its nodes at `position(node)`.
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
                            quick_options());
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
    const auto is_valid_at = [this](Block_element cell, const auto& position) {
      return this->is_valid(cell, position);
    };
    Interior_repair(cells_, levels_, roles_, options_, is_valid_at).run(failing);
    report_.repaired_nodes += levels_.change_count();
    certify_changes();
    return cells_.with(Restoration_cells::failing);
  }

  /// lowers as little of the wall as failing cells need, lets the interior follow, and lowers more where that does not
  /// help. What has not helped in the end is undone. Returns the cells that still fail.
  std::vector<Block_element> relieve(std::vector<Block_element> failing)
  {
    if (options_.repair_layers == 0 || failing.empty())
      return failing;
    const auto is_valid_at = [this](Block_element cell, const auto& position) {
      return this->is_valid(cell, position);
    };
    Wall_relief relief(cells_, levels_, roles_, is_valid_at);
    constexpr int few = 12; // rounds; nearly always one does
    for (int round = 0; round < few && !failing.empty() && relief.grant(failing); ++round)
    {
      ++report_.rounds;
      certify_changes();
      failing = repair(cells_.with(Restoration_cells::failing));
    }
    if (!relief.take_back())
      return failing;
    certify_changes();
    return repair(cells_.with(Restoration_cells::failing));
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

  /// More than any run can take: each round of reduction lowers a node.
  static constexpr Index most_rounds = std::numeric_limits<Index>::max();

  /// reduces until no cell fails, or for so many rounds. Every failing cell decides from the same levels; the largest
  /// level asked for counts. Returns whether no cell fails.
  bool reduce(std::vector<Block_element> failing, Index rounds)
  {
    for (; !failing.empty() && rounds > 0; --rounds)
    {
      ++report_.rounds;
      std::vector<Reduction> reductions(failing.size());
      tbb::parallel_for(std::size_t(0), failing.size(),
                        [&](std::size_t f) { reductions[f] = mildest_reduction(failing[f]); });
      for (std::size_t f = 0; f < failing.size(); ++f)
        for (const Index node : cells_.nodes(failing[f]))
          levels_.request(node, reduced_level(node, reductions[f]));
      if (!levels_.has_changes())
        return false; // cells that are straight, and fail: not of a conforming mesh
      levels_.apply();
      failing = certify_changes();
    }
    return failing.empty();
  }

  /// reduces failing cells one by one and lets that fade out over their neighbours. In layers thinner than the
  /// displacement that makes the neighbours fail in turn, and so on: then nothing is done. Returns whether it was.
  bool reduce_nearby(const std::vector<Block_element>& failing)
  {
    constexpr Index few = 8; // rounds; a reduction that stays local needs fewer
    const std::vector<std::uint8_t> before(levels_.levels().begin(), levels_.levels().end());
    if (reduce(failing, few))
    {
      smooth();
      if (reduce(certify_changes(), few))
        return true;
    }
    levels_.reset(before);
    levels_.apply();
    certify_changes();
    return false;
  }

  /// scales the displacements around failing cells, smoothly over the size of the cells along their longest edges, so
  /// that all layers of a thin stack keep the same share. What fails again is scaled more, by the steps of the ladder;
  /// after the last of them the cell is straight. Of failing cells that share nodes the smallest come first: a large
  /// one may fail because of a small neighbour, and would take much more of the surface with it.
  void fade(std::vector<Block_element> failing)
  {
    std::map<Block_element, std::size_t> steps;
    while (!failing.empty())
    {
      ++report_.rounds;
      std::erase_if(failing, [&](Block_element cell) { return steps[cell] == straight_level; });
      if (failing.empty())
        return;
      std::vector<Fade_ball> balls;
      for (const auto& [cell, ball] : smallest_of_clusters(failing))
      {
        balls.push_back(ball);
        balls.back().factor = curving_factors[++steps[cell]];
      }
      const Fade_balls all(balls);
      const auto count = static_cast<Index>(levels_.levels().size());
      std::vector<double> shares(static_cast<std::size_t>(count), 1);
      tbb::parallel_for(Index(0), count, [&](Index n) {
        if (levels_.is_displaced(n))
          shares[static_cast<std::size_t>(n)] = all.factor_at(levels_.straight(n));
      });
      for (Index n = 0; n < count; ++n)
        if (shares[static_cast<std::size_t>(n)] != 1)
          levels_.fade(n, shares[static_cast<std::size_t>(n)]);
      levels_.apply();
      certify_changes();
      failing = cells_.with(Restoration_cells::failing);
    }
  }

  /// of the cells that are linked by shared nodes, those not much larger than the smallest, and balls around them.
  std::vector<std::pair<Block_element, Fade_ball>> smallest_of_clusters(std::span<const Block_element> cells) const
  {
    constexpr double not_much = 2;
    const std::vector<std::size_t> cluster = cells_.clusters(cells, [](Index) { return true; });
    std::vector<Fade_ball> balls;
    balls.reserve(cells.size());
    for (const Block_element cell : cells)
      balls.push_back(ball_around(cell));
    std::vector<double> smallest(cells.size(), std::numeric_limits<double>::infinity());
    for (std::size_t c = 0; c < cells.size(); ++c)
      smallest[cluster[c]] = std::min(smallest[cluster[c]], balls[c].radius);
    std::vector<std::pair<Block_element, Fade_ball>> result;
    for (std::size_t c = 0; c < cells.size(); ++c)
      if (balls[c].radius <= not_much * smallest[cluster[c]])
        result.emplace_back(cells[c], balls[c]);
    return result;
  }

  /// about the middle of the corners, with room for all of them and a little more, for rounding.
  Fade_ball ball_around(Block_element cell) const
  {
    const auto corners = cells_.nodes(cell).first(static_cast<std::size_t>(corner_count(cells_.type(cell))));
    Fade_ball ball;
    Point least = levels_.straight(corners[0]), largest = least;
    for (const Index node : corners)
    {
      const Point p = levels_.straight(node);
      for (std::size_t d = 0; d < 3; ++d)
      {
        least[d] = std::min(least[d], p[d]);
        largest[d] = std::max(largest[d], p[d]);
      }
    }
    for (std::size_t d = 0; d < 3; ++d)
      ball.center[d] = least[d] + (largest[d] - least[d]) / 2;
    ball.radius = 0.55 * std::hypot(largest[0] - least[0], largest[1] - least[1], largest[2] - least[2]);
    return ball;
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

  /// the first factor of the ladder that is not above `factor`.
  static std::size_t rung(double factor)
  {
    std::size_t level = 0;
    while (curving_factors[level] > factor)
      ++level;
    return level;
  }

  void count_nodes()
  {
    for (Index n = 0; n < static_cast<Index>(levels_.levels().size()); ++n)
      if (levels_.is_displaced(n))
        ++report_.nodes_of_level[rung(levels_.factor(n))];
    report_.reduced_cells = static_cast<Index>(cells_
                                                 .select([this](Block_element cell) {
                                                   const auto nodes = cells_.nodes(cell);
                                                   return std::any_of(nodes.begin(), nodes.end(), [this](Index n) {
                                                     return levels_.factor(n) != 1 && levels_.is_displaced(n);
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
