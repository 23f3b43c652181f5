#ifndef RECURVE_VOLUME_INTERNAL_SUM_BUDGET_H
#define RECURVE_VOLUME_INTERNAL_SUM_BUDGET_H

#include <recurve/core/types.h>
#include <recurve/volume/internal/point_tree.h>
#include <recurve/volume/internal/source_field.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

namespace recurve::internal {

/// What a cell of targets knows about the sum of weights at its targets, and about what has been spent of it.
struct Account
{
  double lowest = 0;   ///< lower bound of the sum of all weights
  double expanded = 0; ///< lower bound of the part that is in expansions
  double error = 0;    ///< bound of the error of the sum
};

/// What it would mean to expand a source cell in a cell of targets, or at each of its targets.
struct Offer
{
  Index node;
  double own;         ///< lower bound of the source cell's weight at any of the targets
  double typical;     ///< its weight at the center
  double distance;    ///< of the centers, or of the source cell's center from the nearest target
  double mean_radius; ///< of what the series is in: the source cell's, with the target cell's or without
  double radius;      ///< the largest such
  double error;       ///< bound of the error at the full degree
};

/// Decides what a cell of targets may expand. Since all weights are positive and no displacement exceeds 1, an error e
/// of the sum of weights (and of each weighted displacement) is an error of at most 2 e / sum w of the quotient. So a
/// cell of targets may spend `tolerance / 2` times a lower bound of its sum of weights: part of it goes to all source
/// cells in proportion to their own weights, part where it saves most, to cells that are far and many but weigh little,
/// and the rest to the nearest. What is spent is bounded strictly and counted.
template <class I>
class Sum_budget
{
public:
  using Node = Point_tree::Node;

  /// \param tolerance  largest error of a quotient. \param uses_floats  whether sums may be in single precision.
  Sum_budget(const Source_field& sources, const I& influence, double tolerance, bool uses_floats)
    : sources_(sources), influence_(influence), tolerance_(tolerance), uses_floats_(uses_floats)
  {}

  /// a lower bound of what source cells weigh at any target. \param stack  room.
  double lowest_weight(const Node& target, std::span<const Index> cells, std::vector<Index>& stack) const;

  /// computes what it would mean to expand a source cell about the center of the targets; false if it is too close.
  bool make_offer(const Node& target, Index source, Offer& offer) const;

  /// the same for an expansion at each target.
  bool make_offer_at_targets(const Node& target, Index source, Offer& offer) const;

  /// Whether the series about the centers of both cells converges.
  bool is_expandable(const Node& target, const Node& source) const
  {
    return is_far(target.radius + source.radius, squared_distance(target.center, source.center));
  }

  /// Whether a source cell is far enough from all targets for its series to converge there, and not too far for single
  /// precision.
  bool is_expandable_at_targets(const Node& target, const Node& source) const
  {
    const double radius = source.radius * source.radius;
    return is_far(source.radius, squared_gap(target, source.center)) &&
           squared_distance(target.center, source.center) < farthest_at_targets * farthest_at_targets * radius &&
           (!uses_floats_ || is_float_safe(target, source));
  }

  /// the error that a cell may make regardless of what others need: a part in proportion to its own weight, and a share
  /// of the other half of the budget.
  double share(const Offer& offer, const Account& account) const;

  /// a low degree whose error is at most `allowed` and within what is left, which is charged to the account; -1 if not
  /// even the full one is.
  /// \param part  of the budget that may be spent.
  int accept(const Offer& offer, double allowed, Account& account, double part = 1) const;

  /// Whether the pairs of a cell of targets and a leaf of sources can be summed in single precision, with coordinates
  /// relative to the sources' center: they are so far apart that rounding a coordinate changes a distance by a few
  /// units in its last place only, and no power of a distance leaves the range of a float.
  bool is_float_safe(const Node& target, const Node& source) const;

private:
  void weigh(const Node& target, Index source, Offer& offer) const;
  double left(const Offer& offer, const Account& account, double part) const;
  static bool is_far(double radius, double squared_distance)
  {
    return radius * radius < largest_ratio * largest_ratio * squared_distance;
  }

  // Radii that add up to more than this part of the distance let the series converge too slowly to be considered.
  static constexpr double largest_ratio = 0.5;

  // The centers of cells that are farther off, in their radii, are no unit for powers of a distance in single
  // precision.
  static constexpr double farthest_at_targets = 64;

  const Source_field& sources_;
  const I& influence_;
  double tolerance_;
  bool uses_floats_;
};

template <class I>
double Sum_budget<I>::lowest_weight(const Node& target, std::span<const Index> cells, std::vector<Index>& stack) const
{
  // Opened until the nearest and the farthest point of a cell weigh about the same.
  constexpr double small_ratio = 0.25;

  double sum = 0;
  stack.assign(cells.begin(), cells.end());
  while (!stack.empty())
  {
    const Index s = stack.back();
    stack.pop_back();
    const Node& source = sources_.tree().node(s);
    const double squared = squared_span(target, source);
    if (squared > 0 &&
        (source.radius * source.radius < small_ratio * small_ratio * squared || sources_.tree().is_leaf(s)))
      sum += sources_.weight(s) * influence_(squared);
    else if (!sources_.tree().is_leaf(s))
      stack.insert(stack.end(), {2 * s + 1, 2 * s + 2});
  }
  return sum;
}

template <class I>
bool Sum_budget<I>::make_offer(const Node& target, Index number, Offer& offer) const
{
  const Node& source = sources_.tree().node(number);
  if (!is_expandable(target, source))
    return false;
  offer.radius = target.radius + source.radius;
  offer.distance = std::sqrt(squared_distance(target.center, source.center));
  offer.mean_radius = target.radius + sources_.mean_radius(number);
  weigh(target, number, offer);
  return true;
}

template <class I>
bool Sum_budget<I>::make_offer_at_targets(const Node& target, Index number, Offer& offer) const
{
  const Node& source = sources_.tree().node(number);
  if (!is_expandable_at_targets(target, source))
    return false;
  offer.radius = source.radius;
  offer.distance = std::sqrt(squared_gap(target, source.center));
  offer.mean_radius = sources_.mean_radius(number);
  weigh(target, number, offer);
  return true;
}

/// completes an offer whose lengths are known.
template <class I>
void Sum_budget<I>::weigh(const Node& target, Index number, Offer& offer) const
{
  const Node& source = sources_.tree().node(number);
  const double squared = squared_distance(target.center, source.center), weight = sources_.weight(number);
  const double farthest = std::sqrt(squared) + target.radius + source.radius;
  offer.node = number;
  offer.own = weight * influence_(farthest * farthest);
  offer.typical = weight * influence_(squared);
  offer.error = weight * influence_.remainder(offer.distance, offer.mean_radius, offer.radius, sources_.degree());
}

template <class I>
double Sum_budget<I>::share(const Offer& offer, const Account& account) const
{
  // Cells of one size at one distance from the targets form a ring. Work is least if the rings get error in proportion
  // to a small power of their weights; it fades slowly, so that there are effectively six of them.
  constexpr double part_of_ring = 0.5;

  const double cells_in_ring = 4 * offer.distance * offer.distance / (offer.radius * offer.radius);
  const double weight_of_ring = std::min(1.0, offer.typical * cells_in_ring / account.lowest);
  return tolerance_ / 4 *
         (offer.own + part_of_ring * account.lowest * std::sqrt(std::sqrt(weight_of_ring)) / cells_in_ring);
}

/// what may still be spent: the errors of all cells stay within tolerance / 2 times the sum of weights at each target.
template <class I>
double Sum_budget<I>::left(const Offer& offer, const Account& account, double part) const
{
  return part * tolerance_ / 2 * std::max(account.expanded + offer.own, account.lowest) - account.error;
}

template <class I>
int Sum_budget<I>::accept(const Offer& offer, double allowed, Account& account, double part) const
{
  allowed = std::min(allowed, left(offer, account, part));
  if (!(offer.error <= allowed))
    return -1;
  int least = -1, degree = sources_.degree();
  double error = offer.error;
  while (degree - least > 1)
  {
    const int middle = (least + degree) / 2;
    const double e =
      sources_.weight(offer.node) * influence_.remainder(offer.distance, offer.mean_radius, offer.radius, middle);
    if (e <= allowed)
    {
      degree = middle;
      error = e;
    }
    else
      least = middle;
  }
  account.expanded += offer.own;
  account.error += error;
  return degree;
}

template <class I>
bool Sum_budget<I>::is_float_safe(const Node& target, const Node& source) const
{
  constexpr double nearest = 1e-5, farthest = 1e5;
  const double gap = squared_gap(target, source);
  return uses_floats_ && gap >= source.radius * source.radius / 4 && gap > nearest * nearest &&
         squared_span(target, source) < farthest * farthest;
}

} // namespace recurve::internal

#endif
