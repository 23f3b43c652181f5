#ifndef RECURVE_VOLUME_INTERNAL_FAST_SUM_H
#define RECURVE_VOLUME_INTERNAL_FAST_SUM_H

#include <recurve/core/types.h>
#include <recurve/volume/influence.h>
#include <recurve/volume/internal/expansion_table.h>
#include <recurve/volume/internal/point_tree.h>
#include <recurve/volume/internal/simd_kernels.h>
#include <recurve/volume/internal/source_field.h>
#include <recurve/volume/internal/sum_budget.h>
#include <recurve/volume/internal/summation_kernels.h>

#include <tbb/cache_aligned_allocator.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_invoke.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <utility>
#include <vector>

namespace recurve::internal {

/// Counts and bounds of a fast summation.
struct Sum_tally
{
  Index pairs = 0;        ///< of a source and a target, summed directly
  Index translations = 0; ///< of a cell of sources to a cell of targets, or to one target
  double error = 0;       ///< guaranteed bound of the largest error

  Sum_tally& operator+=(const Sum_tally& other)
  {
    pairs += other.pairs;
    translations += other.translations;
    error = std::max(error, other.error);
    return *this;
  }
};

/// A fast multipole method for quotients: s(r) = sum w s_i / sum w at many targets.
///
/// Sources and targets are sorted into trees. A cell of sources far enough from a cell of targets is expanded in a
/// Taylor series about both centers, truncated at a common total degree; one that is nearer, or to few targets, about
/// its own center only, at each target; the rest is summed directly. What may be expanded is for the `Sum_budget` to
/// say.
template <class I>
class Fast_sum
{
public:
  /// Successive targets of a leaf that have to be near each other: they fill a vector of floats of any width.
  static constexpr Index group_size = 16;

  /// Rounding of pairs that are summed in single precision, at most; relative like the tolerance.
  static constexpr double float_rounding = 1e-5;

  /// With a tolerance of this and more, rounding to single precision is a small part of it.
  static constexpr double smallest_float_tolerance = 5e-5;

  /// Whether distant pairs and moments are kept in single precision.
  static constexpr bool uses_floats(double tolerance)
  {
    return Summation_kernels<I>::has_floats && tolerance >= smallest_float_tolerance;
  }

  /// \param tolerance  the largest error allowed, relative to the largest displacement of a source.
  Fast_sum(const Source_field& sources, const I& influence, double tolerance, const Point_tree& targets)
    : sources_(sources), targets_(targets), kernels_(influence), uses_floats_(uses_floats(tolerance)),
      budget_(sources, influence, uses_floats_ ? tolerance - float_rounding : tolerance, uses_floats_)
  {}

  /// calls `emit(points, x, y, z)` for each leaf of the targets, with arrays of the displacements of its points; from
  /// several threads.
  template <class Emit>
  Sum_tally operator()(const Emit& emit) const
  {
    return targets_.is_empty() ? Sum_tally{} : visit({0, {0}, {}, {}, {}}, emit);
  }

private:
  using Node = Point_tree::Node;

  /// A cell of sources that is expanded.
  struct Cell
  {
    Index node;
    int degree;
  };

  /// Targets of a leaf that are next to each other, for which together it is decided what to do with what is near.
  struct Group
  {
    Node box;  ///< its points are numbered from the first one of the leaf
    Sums sums; ///< of its targets
    Account account;
    std::vector<Index> candidates; ///< source cells that may be expanded at each target
  };

  /// What a source cell costs at each target of a group, in directly summed pairs.
  struct Price
  {
    double per_target;
    bool is_expanded; ///< else summed
  };

  /// One cell of targets, as its parent hands it down.
  struct Task
  {
    Index node;
    std::vector<Index> candidates; ///< source cells that are neither expanded nor summed yet
    std::vector<double> local;     ///< local expansion about the center of the parent; empty: zero
    Point local_center;
    Account account;
  };

  // Vectors are loaded at half the speed where they are not aligned.
  template <class T>
  using Aligned_vector = std::vector<T, tbb::cache_aligned_allocator<T>>;

  /// Room for translations in one precision.
  template <class Real>
  struct Translation_room
  {
    alignas(64) Pack<Real> offsets[3], units, scales;
    alignas(64) Pack<Real> radial[max_expansion_degree + 1];
    alignas(64) Pack<Real> source_factors[max_expansion_degree + 1], target_factors[max_expansion_degree + 1];
    Aligned_vector<Real> derivatives, transposed, lane_sums, zeros;
    double reference = 1; ///< length in whose units the lane sums count weights

    static Pack<Real>* packs(Aligned_vector<Real>& v) { return reinterpret_cast<Pack<Real>*>(v.data()); }
  };

  /// Room for the work on one cell, reused from cell to cell.
  struct Scratch
  {
    std::vector<Index> stack;
    std::vector<Cell> expanded;  ///< about the center of the targets
    std::vector<Offer> pending;  ///< could be, but for the error
    std::vector<Index> near;     ///< left to the groups, since the center is too near
    std::vector<Index> rejected; ///< left to them for other reasons
    std::vector<Group> groups;   ///< of a leaf
    Translation_room<double> doubles;
    Translation_room<float> floats;
    Aligned_vector<double> coordinates, sums;
    alignas(64) std::array<float, 3 * group_size> float_targets;
  };

  template <class Emit>
  Sum_tally visit(Task task, const Emit& emit) const;
  template <class Emit>
  Sum_tally visit_leaf(Task& task, Scratch& scratch, const Emit& emit) const;

  std::vector<Index> sort_candidates(Task& task, Scratch& scratch) const;
  void split_near(Task& task, Scratch& scratch) const;
  Price price_for_groups(const Node& target, Index source, Account account) const;
  void sort_leaf_candidates(Task& task, Scratch& scratch) const;
  void sort_pending(double lanes_filled, Task& task, Scratch& scratch) const;

  Sums prepare_leaf(const Node& target, Scratch& scratch) const;
  void prepare_groups(const Node& target, const Sums& sums, Scratch& scratch) const;
  Sum_tally sum_nearest(Group& group, Scratch& scratch) const;
  Sum_tally sum_near(Group& group, Scratch& scratch) const;

  static double expansion_unit(const Node& target, const Node& source);
  void move_local(const Point& center, Task& task) const;
  void add_expanded(const Node& target, Scratch& scratch, Task& task) const;
  template <class Real>
  void add_expanded(const Node& target, std::span<const Cell> cells, Translation_room<Real>& room, Task& task) const;
  template <class Real>
  void translate(const Node& target, std::span<const Cell> cells, Translation_room<Real>& room) const;
  void add_at_targets(const Cell& cell, const Group& group, Scratch& scratch) const;
  template <class Real>
  void add_at_targets(const Cell& cell, const Group& group, const Scratch& scratch, Translation_room<Real>& room) const;
  Index add_direct(Index leaf, const Group& group, Scratch& scratch) const;

  // A subtree with fewer targets is not worth a task.
  static constexpr Index parallel_size = 2048;

  // What the translation of one cell costs, by degree, in directly summed pairs (measured).
  static constexpr std::array<Index, max_expansion_degree + 1> translation_cost = {30,  40,  60,   90,   160, 300,
                                                                                   560, 900, 1450, 2250, 3500};

  // What the expansion of one cell at one target costs, likewise.
  static constexpr std::array<Index, max_expansion_degree + 1> cost_at_target = {20,  24,  32,  44,  60, 86,
                                                                                 124, 175, 245, 335, 450};

  const Source_field& sources_;
  const Point_tree& targets_;
  Summation_kernels<I> kernels_;
  bool uses_floats_;
  Sum_budget<I> budget_;
  const Expansion_table& table_ = Expansion_table::instance();
  mutable tbb::enumerable_thread_specific<Scratch> scratch_;
};

template <class I>
template <class Emit>
Sum_tally Fast_sum<I>::visit(Task task, const Emit& emit) const
{
  const Node& target = targets_.node(task.node);
  Sum_tally tally;
  std::array<Task, 2> children;
  {
    // Not held across the parallel calls below, during which this thread may work on another cell.
    Scratch& scratch = scratch_.local();
    if (targets_.is_leaf(task.node))
      return visit_leaf(task, scratch, emit);
    task.account.lowest = std::max(
      task.account.lowest, task.account.expanded + budget_.lowest_weight(target, task.candidates, scratch.stack));
    std::vector<Index> undecided = sort_candidates(task, scratch);
    tally.translations = static_cast<Index>(scratch.expanded.size());
    move_local(target.center, task);
    add_expanded(target, scratch, task);
    children[0] = {2 * task.node + 1, undecided, task.local, target.center, task.account};
    children[1] = {2 * task.node + 2, std::move(undecided), std::move(task.local), target.center, task.account};
  }
  std::array<Sum_tally, 2> tallies;
  const auto first = [&] { tallies[0] = visit(std::move(children[0]), emit); };
  const auto second = [&] { tallies[1] = visit(std::move(children[1]), emit); };
  if (target.size() >= parallel_size)
    tbb::parallel_invoke(first, second);
  else
  {
    first();
    second();
  }
  return (tally += tallies[0]) += tallies[1];
}

template <class I>
template <class Emit>
Sum_tally Fast_sum<I>::visit_leaf(Task& task, Scratch& scratch, const Emit& emit) const
{
  const Node& target = targets_.node(task.node);
  const Sums sums = prepare_leaf(target, scratch);
  Sum_tally tally;

  // What is too close to be expanded in any case comes first: then it is known how much weight there is at least.
  split_near(task, scratch);
  const double far = task.account.expanded + budget_.lowest_weight(target, task.candidates, scratch.stack);
  double lowest = std::numeric_limits<double>::infinity();
  for (Group& group : scratch.groups)
  {
    tally += sum_nearest(group, scratch);
    group.account.lowest += far;
    lowest = std::min(lowest, group.account.lowest);
  }
  task.account.lowest = std::max(task.account.lowest, lowest);

  sort_leaf_candidates(task, scratch);
  tally.translations += static_cast<Index>(scratch.expanded.size());
  for (Group& group : scratch.groups)
  {
    group.account = {std::max(task.account.lowest, group.account.lowest), task.account.expanded, task.account.error};
    tally += sum_near(group, scratch);
  }

  move_local(target.center, task);
  add_expanded(target, scratch, task);
  const std::size_t n = scratch.coordinates.size() / 6;
  const double* relative = scratch.coordinates.data() + 3 * n;
  if (!task.local.empty())
    kernels_.common().add_local(table_, sources_.degree(), task.local.data(),
                                {relative, relative + n, relative + 2 * n}, static_cast<Index>(n), sums);
  for (Index m = 0; m < target.size(); ++m)
  {
    const double quotient = sums.weight[m] > 0 ? 1 / sums.weight[m] : 0;
    sums.x[m] *= quotient;
    sums.y[m] *= quotient;
    sums.z[m] *= quotient;
  }
  emit(targets_.points().subspan(static_cast<std::size_t>(target.begin), static_cast<std::size_t>(target.size())),
       sums.x, sums.y, sums.z);
  return tally;
}

/// decides for each candidate of an inner cell, and for the cells below it, whether it is expanded or left to the
/// children.
template <class I>
std::vector<Index> Fast_sum<I>::sort_candidates(Task& task, Scratch& scratch) const
{
  const Node& target = targets_.node(task.node);
  const Point_tree& tree = sources_.tree();
  std::vector<Index> undecided;
  Offer offer;
  scratch.expanded.clear();
  scratch.stack.assign(task.candidates.rbegin(), task.candidates.rend());
  while (!scratch.stack.empty())
  {
    const Index s = scratch.stack.back();
    scratch.stack.pop_back();
    const int degree = budget_.make_offer(target, s, offer)
                         ? budget_.accept(offer, budget_.share(offer, task.account), task.account)
                         : -1;
    if (degree >= 0)
      scratch.expanded.push_back({s, degree});
    else if (!tree.is_leaf(s) && tree.node(s).radius > target.radius)
      scratch.stack.insert(scratch.stack.end(), {2 * s + 2, 2 * s + 1});
    else
      undecided.push_back(s);
  }
  return undecided;
}

/// moves the candidates of a leaf that are too close to be expanded about its center to `scratch.near`.
template <class I>
void Fast_sum<I>::split_near(Task& task, Scratch& scratch) const
{
  const Node& target = targets_.node(task.node);
  const Point_tree& tree = sources_.tree();
  std::vector<Index> others;
  scratch.near.clear();
  scratch.stack.assign(task.candidates.rbegin(), task.candidates.rend());
  while (!scratch.stack.empty())
  {
    const Index s = scratch.stack.back();
    scratch.stack.pop_back();
    if (budget_.is_expandable(target, tree.node(s)))
      others.push_back(s);
    else if (!tree.is_leaf(s) && tree.node(s).radius > target.radius)
      scratch.stack.insert(scratch.stack.end(), {2 * s + 2, 2 * s + 1});
    else
      scratch.near.push_back(s);
  }
  task.candidates = std::move(others);
}

/// what a source cell would cost the groups of a leaf.
template <class I>
typename Fast_sum<I>::Price Fast_sum<I>::price_for_groups(const Node& target, Index source, Account account) const
{
  const Price direct = {static_cast<double>(sources_.tree().node(source).size()), false};
  Offer offer;
  if (!budget_.make_offer_at_targets(target, source, offer))
    return direct;
  const int degree = budget_.accept(offer, budget_.share(offer, account), account);
  if (degree < 0)
    return direct;
  const Price expanded = {static_cast<double>(cost_at_target[static_cast<std::size_t>(degree)]), true};
  return expanded.per_target < direct.per_target ? expanded : direct;
}

/// decides for the other candidates of a leaf whether they are expanded about its center, or left to its groups.
template <class I>
void Fast_sum<I>::sort_leaf_candidates(Task& task, Scratch& scratch) const
{
  const Node& target = targets_.node(task.node);
  const Point_tree& tree = sources_.tree();
  const std::size_t padded = scratch.coordinates.size() / 6;
  const auto lanes_filled = static_cast<double>(padded); // a part of a vector costs a whole one
  scratch.expanded.clear();
  scratch.rejected.clear();
  scratch.pending.clear();
  Offer offer;
  scratch.stack.assign(task.candidates.rbegin(), task.candidates.rend());
  while (!scratch.stack.empty())
  {
    const Index s = scratch.stack.back();
    scratch.stack.pop_back();
    const Price other = price_for_groups(target, s, task.account);
    Account account = task.account;
    const bool is_offered = budget_.make_offer(target, s, offer);
    const int degree = is_offered ? budget_.accept(offer, budget_.share(offer, account), account) : -1;
    if (degree >= 0 && translation_cost[static_cast<std::size_t>(degree)] < lanes_filled * other.per_target)
    {
      task.account = account;
      scratch.expanded.push_back({s, degree});
    }
    else if (other.is_expanded || (!is_offered && tree.is_leaf(s)))
      scratch.rejected.push_back(s);
    else if (tree.is_leaf(s))
      scratch.pending.push_back(offer);
    else
      scratch.stack.insert(scratch.stack.end(), {2 * s + 2, 2 * s + 1});
  }
  sort_pending(lanes_filled, task, scratch);
}

/// expands those of the pending cells that need least of what is left of the budget.
template <class I>
void Fast_sum<I>::sort_pending(double lanes_filled, Task& task, Scratch& scratch) const
{
  // of the whole budget; the rest is for the groups
  constexpr double largest_part = 0.7;

  std::ranges::stable_sort(scratch.pending, {}, &Offer::error);
  const double cost = translation_cost[static_cast<std::size_t>(sources_.degree())];
  for (const Offer& o : scratch.pending)
    if (lanes_filled * static_cast<double>(sources_.tree().node(o.node).size()) > cost &&
        budget_.accept(o, o.error, task.account, largest_part) >= 0)
      scratch.expanded.push_back({o.node, sources_.degree()});
    else
      scratch.rejected.push_back(o.node);
}

/// moves the parent's local expansion to `center`.
template <class I>
void Fast_sum<I>::move_local(const Point& center, Task& task) const
{
  if (task.local.empty())
    return;
  const int degree = sources_.degree();
  const Point& from = task.local_center;
  const auto shift = scaled_monomials({center[0] - from[0], center[1] - from[1], center[2] - from[2]}, degree);
  std::vector<double> moved(task.local.size(), 0.0);
  for (int b = 0; b < term_count(degree); ++b)
  {
    const std::int16_t* product = table_.products(b);
    std::array<double, 4> sum = {};
    for (int a = 0; a < term_count(degree - table_.degree(b)); ++a)
      for (std::size_t c = 0; c < 4; ++c)
        sum[c] += shift[static_cast<std::size_t>(a)] * task.local[static_cast<std::size_t>(4 * product[a]) + c];
    std::copy(sum.begin(), sum.end(), moved.begin() + 4 * b);
  }
  task.local = std::move(moved);
}

/// a length in whose units no power of a distance leaves the range of a float, unless its term is negligible.
template <class I>
double Fast_sum<I>::expansion_unit(const Node& target, const Node& source)
{
  constexpr double smallest = 1e-3; // of the distance: for cells of one point
  return std::max({target.radius, source.radius, smallest * std::sqrt(squared_distance(target.center, source.center))});
}

/// adds the expansions of the accepted source cells to the local expansion.
template <class I>
void Fast_sum<I>::add_expanded(const Node& target, Scratch& scratch, Task& task) const
{
  if (scratch.expanded.empty())
    return;
  // Cells of like degree go together; each group takes the highest of its own.
  std::ranges::stable_sort(scratch.expanded, std::ranges::greater{}, &Cell::degree);
  if constexpr (Summation_kernels<I>::has_floats)
    if (uses_floats_)
      return add_expanded(target, scratch.expanded, scratch.floats, task);
  add_expanded(target, scratch.expanded, scratch.doubles, task);
}

template <class I>
template <class Real>
void Fast_sum<I>::add_expanded(const Node& target, std::span<const Cell> cells, Translation_room<Real>& room,
                               Task& task) const
{
  constexpr auto n = static_cast<std::size_t>(lanes<Real>);
  const auto values = static_cast<std::size_t>(4 * term_count(sources_.degree()));
  room.lane_sums.assign(values * n, 0);
  room.transposed.resize(sources_.stride() * n);
  room.derivatives.resize(values / 4 * n);
  room.zeros.assign(sources_.stride(), 0);
  room.reference = expansion_unit(target, sources_.tree().node(cells.front().node));
  for (std::size_t first = 0; first < cells.size(); first += n)
    translate(target, cells.subspan(first, std::min(n, cells.size() - first)), room);

  // The lanes hold the expansion in units of the target's radius.
  task.local.resize(values, 0.0);
  const double inverse_unit = target.radius > 0 ? 1 / target.radius : 0;
  double factor = kernels_.scale(room.reference);
  int degree = 0;
  for (std::size_t m = 0; m < values; ++m)
  {
    if (const int d = table_.degree(static_cast<int>(m / 4)); d != degree)
    {
      factor *= inverse_unit;
      degree = d;
    }
    double sum = 0;
    for (std::size_t lane = 0; lane < n; ++lane)
      sum += static_cast<double>(room.lane_sums[m * n + lane]);
    task.local[m] += factor * sum;
  }
}

/// adds the expansions of up to `lanes` source cells to the lane sums.
template <class I>
template <class Real>
void Fast_sum<I>::translate(const Node& target, std::span<const Cell> cells, Translation_room<Real>& room) const
{
  const int degree = cells.front().degree;
  const Real* moments[lanes<Real>];
  for (std::size_t lane = 0; lane < static_cast<std::size_t>(lanes<Real>); ++lane)
  {
    // An unused lane repeats the first cell, without its charges.
    const Index number = cells[lane < cells.size() ? lane : 0].node;
    const Node& source = sources_.tree().node(number);
    moments[lane] = lane < cells.size() ? sources_.template moments<Real>(number) : room.zeros.data();
    const double unit = expansion_unit(target, source);
    for (std::size_t d = 0; d < 3; ++d)
      room.offsets[d][lane] = static_cast<Real>((target.center[d] - source.center[d]) / unit);
    room.units[lane] = static_cast<Real>(unit);
    const double source_ratio = sources_.moment_unit(number) / unit, target_ratio = target.radius / unit;
    double source_factor = 1, target_factor = 1;
    for (int k = 0; k <= degree; ++k, source_factor *= source_ratio, target_factor *= target_ratio)
    {
      room.source_factors[k][lane] = static_cast<Real>(source_factor);
      room.target_factors[k][lane] = static_cast<Real>(target_factor);
    }
  }
  kernels_.radial_derivatives(room.offsets, room.units, static_cast<Real>(room.reference), degree, room.radial,
                              room.scales);
  for (int k = 0; k <= degree; ++k)
    for (int lane = 0; lane < lanes<Real>; ++lane)
      room.target_factors[k][lane] *= room.scales[lane];
  const Expansion<Real>& kernels = kernels_.template expansion<Real>();
  const auto packs = [](Aligned_vector<Real>& v) { return Translation_room<Real>::packs(v); };
  kernels.derivative_tensor(degree, room.offsets, room.radial, packs(room.derivatives));
  kernels.translate(table_, degree, packs(room.derivatives), moments, room.source_factors, room.target_factors,
                    packs(room.transposed), packs(room.lane_sums));
}

/// lays out the targets of a leaf in arrays, and returns their sums, all zero.
template <class I>
Sums Fast_sum<I>::prepare_leaf(const Node& target, Scratch& scratch) const
{
  constexpr auto group = static_cast<std::size_t>(group_size);
  const auto points =
    targets_.points().subspan(static_cast<std::size_t>(target.begin), static_cast<std::size_t>(target.size()));
  const std::size_t n = (points.size() + group - 1) / group * group;
  // Positions as they are, then relative to the center. What is added to fill a vector repeats the last point.
  scratch.coordinates.resize(6 * n);
  for (std::size_t m = 0; m < n; ++m)
    for (std::size_t d = 0; d < 3; ++d)
    {
      const double x = points[std::min(m, points.size() - 1)].position[d];
      scratch.coordinates[d * n + m] = x;
      scratch.coordinates[(3 + d) * n + m] = x - target.center[d];
    }
  scratch.sums.assign(4 * n, 0.0);
  double* sums = scratch.sums.data();
  prepare_groups(target, {sums, sums + n, sums + 2 * n, sums + 3 * n}, scratch);
  return {sums, sums + n, sums + 2 * n, sums + 3 * n};
}

template <class I>
void Fast_sum<I>::prepare_groups(const Node& target, const Sums& sums, Scratch& scratch) const
{
  const Index count = (target.size() + group_size - 1) / group_size;
  scratch.groups.resize(static_cast<std::size_t>(count));
  for (Index g = 0; g < count; ++g)
  {
    Group& group = scratch.groups[static_cast<std::size_t>(g)];
    const Index first = g * group_size, last = std::min(first + group_size, target.size());
    group.box = targets_.measured(target.begin + first, target.begin + last);
    group.box.begin = first;
    group.box.end = last;
    group.sums = {sums.weight + first, sums.x + first, sums.y + first, sums.z + first};
  }
}

/// sums what is too near to be expanded at the targets of a group; the rest of what is near becomes its candidates.
/// Sets the lower bound of what all that weighs.
template <class I>
Sum_tally Fast_sum<I>::sum_nearest(Group& group, Scratch& scratch) const
{
  Sum_tally tally;
  group.candidates.clear();
  scratch.stack.assign(scratch.near.rbegin(), scratch.near.rend());
  while (!scratch.stack.empty())
  {
    const Index s = scratch.stack.back();
    scratch.stack.pop_back();
    if (budget_.is_expandable_at_targets(group.box, sources_.tree().node(s)))
      group.candidates.push_back(s);
    else if (sources_.tree().is_leaf(s))
      tally.pairs += add_direct(s, group, scratch);
    else
      scratch.stack.insert(scratch.stack.end(), {2 * s + 2, 2 * s + 1});
  }
  const double least = *std::min_element(group.sums.weight, group.sums.weight + group.box.size());
  group.account.lowest =
    (1 - float_rounding) * least + budget_.lowest_weight(group.box, group.candidates, scratch.stack);
  return tally;
}

/// expands or sums what is left to a group.
template <class I>
Sum_tally Fast_sum<I>::sum_near(Group& group, Scratch& scratch) const
{
  Sum_tally tally;
  Offer offer;
  scratch.stack.assign(scratch.rejected.rbegin(), scratch.rejected.rend());
  scratch.stack.insert(scratch.stack.end(), group.candidates.rbegin(), group.candidates.rend());
  while (!scratch.stack.empty())
  {
    const Index s = scratch.stack.back();
    scratch.stack.pop_back();
    Account account = group.account;
    const int degree = budget_.make_offer_at_targets(group.box, s, offer)
                         ? budget_.accept(offer, budget_.share(offer, account), account)
                         : -1;
    if (degree >= 0 && cost_at_target[static_cast<std::size_t>(degree)] < sources_.tree().node(s).size())
    {
      group.account = account;
      add_at_targets({s, degree}, group, scratch);
      tally.translations += group.box.size();
    }
    else if (sources_.tree().is_leaf(s))
      tally.pairs += add_direct(s, group, scratch);
    else
      scratch.stack.insert(scratch.stack.end(), {2 * s + 2, 2 * s + 1});
  }
  if (group.account.error > 0)
    tally.error = 2 * group.account.error / std::max(group.account.lowest, group.account.expanded);
  if (uses_floats_)
    tally.error += float_rounding;
  return tally;
}

/// adds the expansion of a source cell at each target of a group to their sums.
template <class I>
void Fast_sum<I>::add_at_targets(const Cell& cell, const Group& group, Scratch& scratch) const
{
  if constexpr (Summation_kernels<I>::has_floats)
    if (uses_floats_)
      return add_at_targets(cell, group, scratch, scratch.floats);
  add_at_targets(cell, group, scratch, scratch.doubles);
}

template <class I>
template <class Real>
void Fast_sum<I>::add_at_targets(const Cell& cell, const Group& group, const Scratch& scratch,
                                 Translation_room<Real>& room) const
{
  const auto n = static_cast<Index>(scratch.coordinates.size() / 6);
  const Expansion<Real>& kernels = kernels_.template expansion<Real>();
  const Point& center = sources_.tree().node(cell.node).center;
  const double unit = sources_.moment_unit(cell.node);
  std::ranges::fill(room.units, static_cast<Real>(unit));
  room.derivatives.resize(static_cast<std::size_t>(term_count(sources_.degree()) * lanes<Real>));
  Pack<Real>* const derivatives = Translation_room<Real>::packs(room.derivatives);
  const double factor = kernels_.scale(static_cast<double>(static_cast<Real>(unit)));
  for (Index t = 0; t < group_size; t += lanes<Real>)
  {
    for (std::size_t d = 0; d < 3; ++d)
      kernels.to_relative(scratch.coordinates.data() + static_cast<Index>(d) * n + group.box.begin + t, lanes<Real>,
                          center[d], 1 / unit, room.offsets[d]);
    kernels_.radial_derivatives(room.offsets, room.units, static_cast<Real>(unit), cell.degree, room.radial,
                                room.scales);
    kernels.derivative_tensor(cell.degree, room.offsets, room.radial, derivatives);
    kernels.add_expansion(term_count(cell.degree), derivatives, sources_.template moments<Real>(cell.node), factor,
                          {group.sums.weight + t, group.sums.x + t, group.sums.y + t, group.sums.z + t});
  }
}

/// sums the pairs of a leaf of sources and the targets of a group; returns their number.
template <class I>
Index Fast_sum<I>::add_direct(Index leaf, const Group& group, Scratch& scratch) const
{
  const auto n = static_cast<Index>(scratch.coordinates.size() / 6);
  const double* x = scratch.coordinates.data() + group.box.begin;
  float* relative = scratch.float_targets.data();
  const Node& source = sources_.tree().node(leaf);
  if (!budget_.is_float_safe(group.box, source))
    kernels_.add_direct(sources_.charges(source.begin), source.size(), {x, x + n, x + 2 * n}, group_size, group.sums);
  else if constexpr (Summation_kernels<I>::has_floats)
  {
    for (Index d = 0; d < 3; ++d)
      kernels_.common().floats.to_relative(x + d * n, group_size, source.center[static_cast<std::size_t>(d)], 1,
                                           relative + d * group_size);
    kernels_.add_direct(sources_.float_charges(source.begin), source.size(),
                        Coordinates<float>{relative, relative + group_size, relative + 2 * group_size}, group_size,
                        group.sums);
  }
  return group.box.size() * source.size();
}

} // namespace recurve::internal

#endif
