#ifndef RECURVE_VOLUME_INTERNAL_FAST_SUM_H
#define RECURVE_VOLUME_INTERNAL_FAST_SUM_H

#include <recurve/core/types.h>
#include <recurve/volume/influence.h>
#include <recurve/volume/internal/expansion_table.h>
#include <recurve/volume/internal/point_tree.h>
#include <recurve/volume/internal/simd_kernels.h>
#include <recurve/volume/internal/source_field.h>
#include <recurve/volume/internal/summation_kernels.h>

#include <tbb/cache_aligned_allocator.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_invoke.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <utility>
#include <vector>

namespace recurve::internal {

/// Counts and bounds of a fast summation.
struct Sum_tally
{
  Index pairs = 0;        ///< of a source and a target, summed directly
  Index translations = 0; ///< of a cell of sources to a cell of targets
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
/// Taylor series about both centers, truncated at a common total degree; the rest is summed directly. Since all weights
/// are positive and no |s_i| exceeds 1, an error e of the sum of weights (and of each weighted displacement) is an
/// error of at most 2 e / sum w of the quotient. So each cell of targets may spend `tolerance / 2` times a lower bound
/// of its sum of weights: part of it goes to all source cells in proportion to their own weights, part where it saves
/// most, to cells that are far and many but weigh little, and the rest to the nearest. What is spent is bounded
/// strictly and counted.
template <class I>
class Fast_sum
{
public:
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
    : sources_(sources), targets_(targets), influence_(influence), kernels_(influence),
      uses_floats_(uses_floats(tolerance)), tolerance_(uses_floats_ ? tolerance - float_rounding : tolerance)
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

  struct Cell
  {
    Index node;
    int degree;
  };

  /// What a cell of targets knows about the sum of weights at its targets, and about what has been spent of it.
  struct Account
  {
    double lowest = 0;   ///< lower bound of the sum of all weights
    double expanded = 0; ///< lower bound of the part that is in expansions
    double error = 0;    ///< bound of the error of the sum
  };

  /// What it would mean to expand a source cell in a cell of targets.
  struct Offer
  {
    Index node;
    double own;     ///< lower bound of the source cell's weight at any of the targets
    double typical; ///< its weight at the center
    double distance, mean_radius, radii;
    double error; ///< bound of the error at the full degree
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
    std::vector<Index> stack, direct;
    std::vector<Cell> expanded;
    std::vector<Offer> pending;
    Translation_room<double> doubles;
    Translation_room<float> floats;
    Aligned_vector<double> coordinates, sums;
    Aligned_vector<float> float_targets;
  };

  template <class Emit>
  Sum_tally visit(Task task, const Emit& emit) const;
  template <class Emit>
  Sum_tally visit_leaf(Task& task, Scratch& scratch, const Emit& emit) const;

  void raise_lowest(const Node& target, std::span<const Index> candidates, double known, Account& account,
                    std::vector<Index>& stack) const;
  bool make_offer(const Node& target, Index source, Offer& offer) const;
  double share(const Offer& offer, const Account& account) const;
  double left(const Offer& offer, const Account& account) const;
  int accept(const Offer& offer, double allowed, Account& account) const;
  std::vector<Index> sort_candidates(Task& task, Scratch& scratch) const;
  void split_near(Task& task, Scratch& scratch) const;
  void sort_leaf_candidates(Task& task, Scratch& scratch) const;

  static double expansion_unit(const Node& target, const Node& source);
  void move_local(const Point& center, Task& task) const;
  void add_expanded(const Node& target, Scratch& scratch, Task& task) const;
  template <class Real>
  void add_expanded(const Node& target, std::span<const Cell> cells, Translation_room<Real>& room, Task& task) const;
  template <class Real>
  void translate(const Node& target, std::span<const Cell> cells, Translation_room<Real>& room) const;

  Sums prepare_leaf(const Node& target, Scratch& scratch) const;
  Index sum_direct(const Node& target, Scratch& scratch, const Sums& sums) const;
  bool is_float_safe(const Node& target, const Node& source) const;

  // A subtree with fewer targets is not worth a task.
  static constexpr Index parallel_size = 2048;

  // Radii that add up to more than this part of the distance let the series converge too slowly to be considered.
  static constexpr double largest_ratio = 0.5;

  // What the translation of one cell costs, by degree, in directly summed pairs (measured).
  static constexpr std::array<Index, max_expansion_degree + 1> translation_cost = {30,  40,  60,   90,   160, 300,
                                                                                   560, 900, 1450, 2250, 3500};

  const Source_field& sources_;
  const Point_tree& targets_;
  const I& influence_;
  Summation_kernels<I> kernels_;
  bool uses_floats_;
  double tolerance_;
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
    raise_lowest(target, task.candidates, task.account.expanded, task.account, scratch.stack);
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

  // What is too close to be expanded in any case comes first: then it is known how much weight there is at least.
  split_near(task, scratch);
  Sum_tally tally;
  tally.pairs = sum_direct(target, scratch, sums);
  const double near = (1 - float_rounding) * *std::min_element(sums.weight, sums.weight + target.size());
  raise_lowest(target, task.candidates, task.account.expanded + near, task.account, scratch.stack);
  sort_leaf_candidates(task, scratch);
  tally.pairs += sum_direct(target, scratch, sums);

  tally.translations = static_cast<Index>(scratch.expanded.size());
  move_local(target.center, task);
  add_expanded(target, scratch, task);
  const std::size_t n = scratch.coordinates.size() / 6;
  const double* relative = scratch.coordinates.data() + 3 * n;
  if (!task.local.empty())
    kernels_.common().add_local(table_, sources_.degree(), task.local.data(),
                                {relative, relative + n, relative + 2 * n}, static_cast<Index>(n), sums);

  if (task.account.error > 0)
    tally.error = 2 * task.account.error / std::max(task.account.lowest, task.account.expanded);
  if (uses_floats_)
    tally.error += float_rounding;
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

/// improves the lower bound of the sum of weights in a cell of targets: `known` plus what the candidates weigh, at
/// least.
template <class I>
void Fast_sum<I>::raise_lowest(const Node& target, std::span<const Index> candidates, double known, Account& account,
                               std::vector<Index>& stack) const
{
  // Opened until the nearest and the farthest point of a cell weigh about the same.
  constexpr double small_ratio = 0.25;

  double sum = known;
  stack.assign(candidates.begin(), candidates.end());
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
  account.lowest = std::max(account.lowest, sum);
}

/// computes what it would mean to expand a source cell; false if it is too close.
template <class I>
bool Fast_sum<I>::make_offer(const Node& target, Index number, Offer& offer) const
{
  const Node& source = sources_.tree().node(number);
  const double squared = squared_distance(target.center, source.center);
  const double radii = target.radius + source.radius;
  if (radii * radii >= largest_ratio * largest_ratio * squared)
    return false;
  const double distance = std::sqrt(squared), weight = sources_.weight(number);
  offer.node = number;
  offer.own = weight * influence_((distance + radii) * (distance + radii));
  offer.typical = weight * influence_(squared);
  offer.distance = distance;
  offer.mean_radius = target.radius + sources_.mean_radius(number);
  offer.radii = radii;
  offer.error = weight * influence_.remainder(distance, offer.mean_radius, radii, sources_.degree());
  return true;
}

/// the error that a cell may make regardless of what others need: a part in proportion to its own weight, and a share
/// of the other half of the budget.
template <class I>
double Fast_sum<I>::share(const Offer& offer, const Account& account) const
{
  // Cells of one size at one distance from the targets form a ring. Work is least if the rings get error in proportion
  // to a small power of their weights; it fades slowly, so that there are effectively six of them.
  constexpr double part_of_ring = 0.5;

  const double cells_in_ring = 4 * offer.distance * offer.distance / (offer.radii * offer.radii);
  const double weight_of_ring = std::min(1.0, offer.typical * cells_in_ring / account.lowest);
  return tolerance_ / 4 *
         (offer.own + part_of_ring * account.lowest * std::sqrt(std::sqrt(weight_of_ring)) / cells_in_ring);
}

/// what may still be spent: the errors of all cells stay within tolerance / 2 times the sum of weights at each target.
template <class I>
double Fast_sum<I>::left(const Offer& offer, const Account& account) const
{
  return tolerance_ / 2 * std::max(account.expanded + offer.own, account.lowest) - account.error;
}

/// the lowest degree whose error is allowed, which is charged to the account; -1 if there is none.
template <class I>
int Fast_sum<I>::accept(const Offer& offer, double allowed, Account& account) const
{
  allowed = std::min(allowed, left(offer, account));
  if (!(offer.error <= allowed))
    return -1;
  int degree = sources_.degree();
  double error = offer.error;
  const double weight = sources_.weight(offer.node);
  while (degree > 0)
  {
    const double next = weight * influence_.remainder(offer.distance, offer.mean_radius, offer.radii, degree - 1);
    if (!(next <= allowed))
      break;
    error = next;
    --degree;
  }
  account.expanded += offer.own;
  account.error += error;
  return degree;
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
    const int degree = make_offer(target, s, offer) ? accept(offer, share(offer, task.account), task.account) : -1;
    if (degree >= 0)
      scratch.expanded.push_back({s, degree});
    else if (!tree.is_leaf(s) && tree.node(s).radius > target.radius)
      scratch.stack.insert(scratch.stack.end(), {2 * s + 2, 2 * s + 1});
    else
      undecided.push_back(s);
  }
  return undecided;
}

/// moves the candidates of a leaf that are too close to be expanded to `scratch.direct`.
template <class I>
void Fast_sum<I>::split_near(Task& task, Scratch& scratch) const
{
  const Node& target = targets_.node(task.node);
  const Point_tree& tree = sources_.tree();
  std::vector<Index> others;
  scratch.direct.clear();
  scratch.stack.assign(task.candidates.rbegin(), task.candidates.rend());
  while (!scratch.stack.empty())
  {
    const Index s = scratch.stack.back();
    scratch.stack.pop_back();
    const double radii = target.radius + tree.node(s).radius;
    if (radii * radii < largest_ratio * largest_ratio * squared_distance(target.center, tree.node(s).center))
      others.push_back(s);
    else if (tree.is_leaf(s))
      scratch.direct.push_back(s);
    else
      scratch.stack.insert(scratch.stack.end(), {2 * s + 2, 2 * s + 1});
  }
  task.candidates = std::move(others);
}

/// decides for the other candidates of a leaf whether they are expanded or summed directly.
template <class I>
void Fast_sum<I>::sort_leaf_candidates(Task& task, Scratch& scratch) const
{
  const Node& target = targets_.node(task.node);
  const Point_tree& tree = sources_.tree();
  scratch.expanded.clear();
  scratch.direct.clear();
  scratch.pending.clear();
  const auto lanes_filled = static_cast<Index>(scratch.coordinates.size() / 6); // a part of a vector costs a whole one
  Offer offer;
  scratch.stack.assign(task.candidates.rbegin(), task.candidates.rend());
  while (!scratch.stack.empty())
  {
    const Index s = scratch.stack.back();
    scratch.stack.pop_back();
    const bool is_offered = make_offer(target, s, offer);
    Account charged = task.account;
    const int degree = is_offered ? accept(offer, share(offer, task.account), charged) : -1;
    if (degree >= 0 && lanes_filled * tree.node(s).size() > translation_cost[static_cast<std::size_t>(degree)])
    {
      task.account = charged;
      scratch.expanded.push_back({s, degree});
    }
    else if (!tree.is_leaf(s))
      scratch.stack.insert(scratch.stack.end(), {2 * s + 2, 2 * s + 1});
    else if (is_offered)
      scratch.pending.push_back(offer);
    else
      scratch.direct.push_back(s);
  }

  // What is left of the budget goes to the cells that need least of it.
  std::ranges::stable_sort(scratch.pending, {}, &Offer::error);
  const Index cost = translation_cost[static_cast<std::size_t>(sources_.degree())];
  for (const Offer& o : scratch.pending)
    if (lanes_filled * tree.node(o.node).size() > cost && accept(o, o.error, task.account) >= 0)
      scratch.expanded.push_back({o.node, sources_.degree()});
    else
      scratch.direct.push_back(o.node);
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
  const Translation<Real>& kernels = kernels_.template translation<Real>();
  const auto packs = [](Aligned_vector<Real>& v) { return Translation_room<Real>::packs(v); };
  kernels.derivative_tensor(table_, degree, room.offsets, room.radial, packs(room.derivatives));
  kernels.translate(table_, degree, packs(room.derivatives), moments, room.source_factors, room.target_factors,
                    packs(room.transposed), packs(room.lane_sums));
}

/// lays out the targets of a leaf in arrays, and returns their sums, all zero.
template <class I>
Sums Fast_sum<I>::prepare_leaf(const Node& target, Scratch& scratch) const
{
  constexpr std::size_t group = 16; // fills vectors of floats of any width
  const auto points =
    targets_.points().subspan(static_cast<std::size_t>(target.begin), static_cast<std::size_t>(target.size()));
  const std::size_t n = (points.size() + group - 1) / group * group;
  // Positions as they are, then relative to the center. What is added to fill a vector repeats the last point.
  scratch.coordinates.resize(6 * n);
  scratch.float_targets.resize(3 * n);
  for (std::size_t m = 0; m < n; ++m)
    for (std::size_t d = 0; d < 3; ++d)
    {
      const double x = points[std::min(m, points.size() - 1)].position[d];
      scratch.coordinates[d * n + m] = x;
      scratch.coordinates[(3 + d) * n + m] = x - target.center[d];
    }
  scratch.sums.assign(4 * n, 0.0);
  double* sums = scratch.sums.data();
  return {sums, sums + n, sums + 2 * n, sums + 3 * n};
}

/// Whether the pairs of a cell of targets and a leaf of sources can be summed in single precision, with coordinates
/// relative to the sources' center: they are so far apart that rounding a coordinate changes a distance by a few units
/// in its last place only, and no power of a distance leaves the range of a float.
template <class I>
bool Fast_sum<I>::is_float_safe(const Node& target, const Node& source) const
{
  constexpr double nearest = 1e-5, farthest = 1e5;
  const double gap = squared_gap(target, source);
  return uses_floats_ && gap >= source.radius * source.radius / 4 && gap > nearest * nearest &&
         squared_span(target, source) < farthest * farthest;
}

/// sums the pairs of the target's points and the sources in `scratch.direct`; returns their number.
template <class I>
Index Fast_sum<I>::sum_direct(const Node& target, Scratch& scratch, const Sums& sums) const
{
  const auto n = static_cast<Index>(scratch.coordinates.size() / 6);
  const double* x = scratch.coordinates.data();
  float* relative = scratch.float_targets.data();
  Index pairs = 0;
  for (const Index s : scratch.direct)
  {
    const Node& source = sources_.tree().node(s);
    pairs += target.size() * source.size();
    if (!is_float_safe(target, source))
      kernels_.add_direct(sources_.charges(source.begin), source.size(), {x, x + n, x + 2 * n}, n, sums);
    else if constexpr (Summation_kernels<I>::has_floats)
    {
      for (Index d = 0; d < 3; ++d)
        kernels_.common().to_floats(x + d * n, n, source.center[static_cast<std::size_t>(d)], relative + d * n);
      kernels_.add_direct(sources_.float_charges(source.begin), source.size(),
                          Coordinates<float>{relative, relative + n, relative + 2 * n}, n, sums);
    }
  }
  return pairs;
}

} // namespace recurve::internal

#endif
