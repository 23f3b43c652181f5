#ifndef RECURVE_VOLUME_INTERNAL_CURVING_LEVELS_H
#define RECURVE_VOLUME_INTERNAL_CURVING_LEVELS_H

#include <recurve/core/types.h>
#include <recurve/volume/internal/point_access.h>
#include <recurve/volume/restoration_report.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <ranges>
#include <span>
#include <unordered_map>
#include <utility>
#include <vector>

namespace recurve::internal {

/// Pairs of nodes that keep the same share of their displacement, and where the second one of a pair belongs.
struct Linked_nodes
{
  std::span<const std::array<Index, 2>> pairs;
  const Linked_image& image;
};

/// The nodes between their straight and their fully curved positions: who has lost how much.
template <class Points, class Straight>
class Curving_levels
{
public:
  Curving_levels(Points& nodes, const Straight& straight, const Linked_nodes& linked)
    : nodes_(nodes), straight_(straight), linked_(linked), levels_(std::ranges::size(nodes)),
      changed_(std::ranges::size(nodes))
  {
    find_leaders();
  }

  Point straight(Index node) const { return coordinates(std::ranges::begin(straight_)[node]); }
  Point current(Index node) const { return coordinates(std::ranges::begin(nodes_)[node]); }
  std::uint8_t level(Index node) const { return levels_[static_cast<std::size_t>(node)]; }
  std::span<const std::uint8_t> levels() const { return levels_; }

  /// fully curved.
  Point full(Index node) const
  {
    const auto found = full_.find(node);
    return found == full_.end() ? current(node) : found->second;
  }

  bool is_displaced(Index node) const { return full(node) != straight(node); }

  /// the share of its displacement that the node keeps at a level.
  double factor(Index node, std::uint8_t level) const { return curving_factors[level] * fade_of(node); }
  double factor(Index node) const { return factor(node, level(node)); }

  /// where the node stands at a level. A coordinate that both positions share is theirs, to the bit. The image of
  /// another node goes with that one.
  Point position(Index node, std::uint8_t level) const
  {
    const double share = factor(node, level);
    if (share != 0 && share != 1 && is_displaced(node))
      if (const auto pair = leader_.find(node); pair != leader_.end())
        if (const Index first = linked_.pairs[pair->second][0]; is_displaced(first))
          return linked_.image(pair->second, position(first, level));
    return position_keeping(node, share);
  }

  /// where the node stands by itself with a share of its displacement.
  Point position_keeping(Index node, double share) const
  {
    const Point from = straight(node), to = full(node);
    if (share == 1)
      return to;
    if (share == 0 || from == to)
      return from;
    Point result;
    for (std::size_t d = 0; d < 3; ++d)
      result[d] = from[d] + share * (to[d] - from[d]);
    return result;
  }

  /// asks for at least `level`. Takes effect with `apply()`.
  void request(Index node, std::uint8_t level)
  {
    std::uint8_t& own = levels_[static_cast<std::size_t>(node)];
    if (level <= own)
      return;
    own = level;
    mark(node);
  }

  /// asks for a displacement of at most `share`, beside what levels ask for. Takes effect with `apply()`.
  void fade(Index node, double share)
  {
    double& own = fades_.try_emplace(node, 1).first->second;
    if (share >= own)
      return;
    own = share;
    mark(node);
  }

  /// forgets every `fade()`. Takes effect with `apply()`.
  void forget_fades()
  {
    for (const auto& [node, share] : fades_)
      mark(node);
    fades_.clear();
  }

  /// takes levels back to what they were. Takes effect with `apply()`.
  void reset(std::span<const std::uint8_t> levels)
  {
    for (Index node = 0; node < static_cast<Index>(levels_.size()); ++node)
      if (level(node) != levels[static_cast<std::size_t>(node)])
      {
        levels_[static_cast<std::size_t>(node)] = levels[static_cast<std::size_t>(node)];
        mark(node);
      }
  }

  /// gives a node that has its full displacement another one. Takes effect at once.
  void move(Index node, const Point& position)
  {
    if (factor(node) != 1)
      return;
    set(node, position);
    mark(node);
  }

  /// moves the nodes to their levels, after linked nodes have agreed.
  void apply()
  {
    agree();
    for (const Index node : changes_)
    {
      if (factor(node) != 1)
        full_.try_emplace(node, current(node));
      set(node, position(node, level(node)));
    }
  }

  /// Nodes that changed since `forget_changes()`, as marks.
  std::span<const std::uint8_t> changed() const { return changed_; }
  bool has_changes() const { return !changes_.empty(); }
  Index change_count() const { return static_cast<Index>(changes_.size()); }

  void forget_changes()
  {
    for (const Index node : changes_)
      changed_[static_cast<std::size_t>(node)] = 0;
    changes_.clear();
  }

private:
  double fade_of(Index node) const
  {
    const auto found = fades_.find(node);
    return found == fades_.end() ? 1 : found->second;
  }

  /// of several pairs with the same image the last one leads. Periods in three directions make chains of three; what
  /// is much longer may be a circle, and is cut.
  void find_leaders()
  {
    if (!linked_.image)
      return;
    for (std::size_t pair = 0; pair < linked_.pairs.size(); ++pair)
      leader_[linked_.pairs[pair][1]] = pair;
    constexpr int longest_chain = 8;
    for (const auto& [first, image] : linked_.pairs)
    {
      int links = 0;
      for (auto found = leader_.find(image); found != leader_.end();
           found = leader_.find(linked_.pairs[found->second][0]))
        if (++links > longest_chain)
        {
          leader_.erase(image);
          break;
        }
    }
  }

  void mark(Index node)
  {
    if (std::exchange(changed_[static_cast<std::size_t>(node)], std::uint8_t(1)) == 0)
      changes_.push_back(node);
  }

  void set(Index node, const Point& position)
  {
    using Value = std::ranges::range_value_t<Points>;
    std::ranges::begin(nodes_)[node] = make_point<Value>(position);
  }

  void agree()
  {
    for (bool is_settled = false; !is_settled;)
    {
      is_settled = true;
      for (const auto& [a, b] : linked_.pairs)
      {
        const std::uint8_t common = std::max(level(a), level(b));
        is_settled = is_settled && level(a) == common && level(b) == common;
        request(a, common);
        request(b, common);
        const double share = std::min(factor(a, 0), factor(b, 0));
        is_settled = is_settled && factor(a, 0) == share && factor(b, 0) == share;
        fade(a, share);
        fade(b, share);
      }
    }
  }

  Points& nodes_;
  const Straight& straight_;
  Linked_nodes linked_;
  std::vector<std::uint8_t> levels_, changed_;
  std::vector<Index> changes_;
  std::unordered_map<Index, std::size_t> leader_; ///< of an image: the pair that says where it goes
  std::unordered_map<Index, Point> full_;         ///< of nodes that are or were reduced
  std::unordered_map<Index, double> fades_;       ///< share that is kept beside what the levels take; 1 where absent
};

} // namespace recurve::internal

#endif
