#ifndef RECURVE_VOLUME_INTERNAL_DEFORMATION_FIELD_H
#define RECURVE_VOLUME_INTERNAL_DEFORMATION_FIELD_H

#include <recurve/core/exceptions.h>
#include <recurve/core/progress.h>
#include <recurve/core/types.h>
#include <recurve/volume/deformation_options.h>
#include <recurve/volume/influence.h>
#include <recurve/volume/internal/fast_sum.h>
#include <recurve/volume/internal/nearest_distance.h>
#include <recurve/volume/internal/point_access.h>
#include <recurve/volume/internal/point_tree.h>
#include <recurve/volume/internal/source_field.h>
#include <recurve/volume/internal/summation_kernels.h>

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <mutex>
#include <ranges>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace recurve::internal {

/// the summation that is estimated to be faster, sorting the sources included.
inline Summation faster_summation(std::size_t sources, std::size_t targets)
{
  // Seconds on one core with AVX-512; with narrower vectors all three grow alike. Where both cost the same, there are
  // about 2,500 sources or 1,700 targets.
  constexpr double plain_pair = 0.46e-9, fast_source = 0.8e-6, fast_target = 1.1e-6;

  const double n = static_cast<double>(sources), m = static_cast<double>(targets);
  return n * m * plain_pair <= n * fast_source + m * fast_target ? Summation::plain : Summation::fast;
}

/// degree of the expansions that sum fastest within an error bound (measured).
constexpr int expansion_degree(double error_bound)
{
  return error_bound >= 5e-3 ? 6 : error_bound >= 5e-4 ? 8 : 9;
}

/// Reports, from whichever thread, how much is done.
class Progress_meter
{
public:
  Progress_meter(const Progress_callback& callback, Index total)
    : callback_(callback), total_(std::max<Index>(1, total)), step_(std::max<Index>(1, total / 100))
  {
    report_progress(callback_, "deform", 0);
  }

  /// \throws Cancelled if the callback asks to stop.
  void add(Index count)
  {
    if (!callback_)
      return;
    const std::lock_guard lock(mutex_);
    done_ += count;
    if (done_ < next_)
      return;
    next_ = done_ + step_;
    if (done_ < total_) // the end is reported once all threads are back
      report_progress(callback_, "deform", static_cast<double>(done_) / static_cast<double>(total_));
  }

private:
  const Progress_callback& callback_;
  const Index total_, step_;
  std::mutex mutex_;
  Index done_ = 0, next_ = 0;
};

/// The work of `Interior_deformer`.
template <class I>
class Deformation_field
{
public:
  template <class Positions>
  Deformation_field(const Positions& positions, I influence, const Summation_options& options,
                    std::span<const double> weights);

  template <class Displacements>
  void set_displacements(const Displacements& displacements);

  /// calls `sink(m, s)` once for each of `points`, from several threads.
  template <class Points, class Sink>
  Deformation_report for_each_displacement(const Points& points, const Sink& sink) const;

  double bytes_per_source() const
  {
    return static_cast<double>(field_.bytes()) / static_cast<double>(std::max<Index>(1, field_.size()));
  }

private:
  struct Extreme
  {
    Index moved = 0;
    double largest = 0;
  };

  void check_options() const;
  Point scaled(const Point& p) const
  {
    return {(p[0] - origin_[0]) / unit_, (p[1] - origin_[1]) / unit_, (p[2] - origin_[2]) / unit_};
  }
  template <class Points>
  std::vector<Numbered_point> numbered(const Points& points) const;
  std::vector<double> fade(std::vector<Numbered_point>& targets) const;
  template <class Emit>
  Sum_tally sum_plainly(std::span<const Numbered_point> targets, const Emit& emit) const;
  template <class Emit>
  Sum_tally sum_fast(std::vector<Numbered_point> targets, const Emit& emit) const;

  // Below this the rounding of the expansions is no longer negligible.
  static constexpr double smallest_error_bound = 1e-9;

  // Points in a leaf, at most (measured): so many that vectors are filled, that a moment's memory is shared by enough
  // sources and an expansion's work by enough targets; so few that cells are small compared with their distances.
  static constexpr Index target_capacity = 64;
  static constexpr Index source_capacity = 160;
  static constexpr Index source_capacity_in_doubles = 256; // a moment takes twice the memory

  I influence_;
  Summation_options options_;
  double unit_;
  Point origin_ = {0, 0, 0};
  bool is_fast_;
  Source_field field_;
  std::vector<Point> positions_; ///< scaled, by the caller's numbers; only kept where `reach` needs them
  Point_tree moving_;            ///< sources that move; only where `reach` needs them
  Index moving_sources_ = 0;
  double largest_given_ = 0;
};

/// the middle of the box of `points`. \throws Input_error if a coordinate is not finite.
template <class Points>
Point middle_of(const Points& points, const char* what)
{
  constexpr double infinity = std::numeric_limits<double>::infinity();
  Point low = {infinity, infinity, infinity}, high = {-infinity, -infinity, -infinity};
  Index m = 0;
  for (const auto& point : points)
  {
    const Point p = coordinates(point);
    if (!std::isfinite(p[0]) || !std::isfinite(p[1]) || !std::isfinite(p[2]))
      throw Input_error("Interior_deformer: " + std::string(what) + " " + std::to_string(m) + " is not finite");
    for (std::size_t d = 0; d < 3; ++d)
    {
      low[d] = std::min(low[d], p[d]);
      high[d] = std::max(high[d], p[d]);
    }
    ++m;
  }
  if (m == 0)
    return {0, 0, 0};
  return {low[0] + (high[0] - low[0]) / 2, low[1] + (high[1] - low[1]) / 2, low[2] + (high[2] - low[2]) / 2};
}

/// the weights divided by the largest, so that nothing depends on their unit.
inline std::vector<double> relative_weights(std::span<const double> weights)
{
  double largest = 0;
  for (std::size_t m = 0; m < weights.size(); ++m)
  {
    if (!(weights[m] >= 0 && std::isfinite(weights[m])))
      throw Input_error("Interior_deformer: the weight of source " + std::to_string(m) +
                        " has to be finite and not negative, not " + std::to_string(weights[m]));
    largest = std::max(largest, weights[m]);
  }
  if (!weights.empty() && largest == 0)
    throw Input_error("Interior_deformer: all weights are zero");
  std::vector<double> result(weights.begin(), weights.end());
  for (double& w : result)
    w /= largest;
  return result;
}

template <class I>
template <class Positions>
Deformation_field<I>::Deformation_field(const Positions& positions, I influence, const Summation_options& options,
                                        std::span<const double> weights)
  : influence_(std::move(influence)), options_(options), unit_(influence_.length())
{
  check_options();
  const std::size_t n = std::ranges::size(positions);
  if (!weights.empty() && weights.size() != n)
    throw Input_error("Interior_deformer: " + std::to_string(n) + " sources, but " + std::to_string(weights.size()) +
                      " weights");
  // Coordinates relative to the middle of the sources keep their digits wherever the mesh lies.
  origin_ = middle_of(positions, "source");
  std::vector<Numbered_point> sources = numbered(positions);
  if (options_.reach > 0)
    for (const Numbered_point& s : sources)
      positions_.push_back(s.position);
  is_fast_ =
    Expandable_influence<I> && (options_.method == Summation::fast ||
                                (options_.method == Summation::automatic && faster_summation(n, n) == Summation::fast));
  const bool keeps_floats = is_fast_ && Fast_sum<I>::uses_floats(options_.error_bound);
  field_ =
    Source_field(std::move(sources), relative_weights(weights), is_fast_ ? expansion_degree(options_.error_bound) : -1,
                 keeps_floats, keeps_floats ? source_capacity : source_capacity_in_doubles);
}

template <class I>
void Deformation_field<I>::check_options() const
{
  if (!(unit_ > 0) || !std::isfinite(unit_))
    throw Input_error("Interior_deformer: the influence's length has to be positive and finite, not " +
                      std::to_string(unit_));
  if (!(options_.error_bound >= smallest_error_bound && options_.error_bound <= 1))
    throw Input_error("Interior_deformer: the error bound has to be between 1e-9 and 1, not " +
                      std::to_string(options_.error_bound));
  if (!(options_.reach >= 0))
    throw Input_error("Interior_deformer: the reach has to be zero (no limit) or positive, not " +
                      std::to_string(options_.reach));
  if (options_.method == Summation::fast && !Expandable_influence<I>)
    throw Input_error("Interior_deformer: this influence cannot be summed fast, since it has no expansion");
}

template <class I>
template <class Points>
std::vector<Numbered_point> Deformation_field<I>::numbered(const Points& points) const
{
  const auto n = static_cast<Index>(std::ranges::size(points));
  std::vector<Numbered_point> result(static_cast<std::size_t>(n));
  tbb::parallel_for(Index(0), n, [&](Index m) {
    result[static_cast<std::size_t>(m)] = {scaled(coordinates(std::ranges::begin(points)[m])), m};
  });
  return result;
}

template <class I>
template <class Displacements>
void Deformation_field<I>::set_displacements(const Displacements& displacements)
{
  const auto n = static_cast<Index>(std::ranges::size(displacements));
  if (n != field_.size())
    throw Input_error("Interior_deformer: " + std::to_string(field_.size()) + " sources, but " + std::to_string(n) +
                      " displacements");
  middle_of(displacements, "displacement"); // checks that all are finite
  const auto displacement = [&](Index m) { return coordinates(std::ranges::begin(displacements)[m]); };
  const auto length = [](const Point& s) { return std::hypot(s[0], s[1], s[2]); };
  moving_sources_ = 0;
  largest_given_ = 0;
  std::vector<Numbered_point> moving;
  for (Index m = 0; m < n; ++m)
    if (const double l = length(displacement(m)); l > 0)
    {
      ++moving_sources_;
      largest_given_ = std::max(largest_given_, l);
      if (options_.reach > 0)
        moving.push_back({positions_[static_cast<std::size_t>(m)], m});
    }
  moving_ = Point_tree(std::move(moving), source_capacity);
  if (moving_sources_ > 0)
    field_.set_displacements([&](Index m) {
      const Point s = displacement(m);
      return Point{s[0] / largest_given_, s[1] / largest_given_, s[2] / largest_given_};
    });
}

/// drops the targets beyond reach; returns, by the targets' numbers, the factor by which the motion of the others has
/// faded.
template <class I>
std::vector<double> Deformation_field<I>::fade(std::vector<Numbered_point>& targets) const
{
  std::vector<double> factors(targets.size());
  const double reach = options_.reach / unit_;
  tbb::parallel_for(std::size_t(0), targets.size(), [&](std::size_t m) {
    const double x = 2 - 2 * nearest_distance(moving_, targets[m].position, reach) / reach; // 0 at the end, 1 half-way
    const double t = std::clamp(x, 0.0, 1.0);
    factors[static_cast<std::size_t>(targets[m].number)] = t * t * (3 - 2 * t);
  });
  std::erase_if(targets, [&](const Numbered_point& t) { return factors[static_cast<std::size_t>(t.number)] == 0; });
  return factors;
}

template <class I>
template <class Points, class Sink>
Deformation_report Deformation_field<I>::for_each_displacement(const Points& points, const Sink& sink) const
{
  Deformation_report report;
  report.sources = field_.size();
  report.moving_sources = moving_sources_;
  report.targets = static_cast<Index>(std::ranges::size(points));
  report.largest_given = largest_given_;
  middle_of(points, "target"); // checks that all are finite
  std::vector<Numbered_point> targets = numbered(points);
  std::vector<double> factors;
  if (moving_sources_ == 0)
    targets.clear();
  else if (options_.reach > 0)
    factors = fade(targets);
  if (targets.size() < static_cast<std::size_t>(report.targets))
    tbb::parallel_for(Index(0), report.targets, [&](Index m) {
      if (factors.empty() || factors[static_cast<std::size_t>(m)] == 0)
        sink(m, Point{0, 0, 0});
    });

  tbb::enumerable_thread_specific<Extreme> extremes;
  Progress_meter progress(options_.progress, static_cast<Index>(targets.size()));
  const auto emit = [&](std::span<const Numbered_point> list, const double* x, const double* y, const double* z) {
    Extreme& extreme = extremes.local();
    for (std::size_t m = 0; m < list.size(); ++m)
    {
      const double f =
        factors.empty() ? largest_given_ : largest_given_ * factors[static_cast<std::size_t>(list[m].number)];
      const Point s = {f * x[m], f * y[m], f * z[m]};
      const double squared = x[m] * x[m] + y[m] * y[m] + z[m] * z[m];
      extreme.moved += s != Point{0, 0, 0};
      extreme.largest = std::max(extreme.largest, f * std::sqrt(squared));
      sink(list[m].number, s);
    }
    progress.add(static_cast<Index>(list.size()));
  };
  Sum_tally tally;
  if constexpr (Expandable_influence<I>)
    tally = is_fast_ ? sum_fast(std::move(targets), emit) : sum_plainly(targets, emit);
  else
    tally = sum_plainly(targets, emit);
  report_progress(options_.progress, "deform", 1);
  for (const Extreme& extreme : extremes)
  {
    report.moved_targets += extreme.moved;
    report.largest_displacement = std::max(report.largest_displacement, extreme.largest);
  }
  report.error_bound = tally.error;
  report.is_fast = is_fast_;
  report.pairs = tally.pairs;
  report.translations = tally.translations;
  return report;
}

template <class I>
template <class Emit>
Sum_tally Deformation_field<I>::sum_fast(std::vector<Numbered_point> targets, const Emit& emit) const
{
  const Point_tree tree(std::move(targets), target_capacity, Fast_sum<I>::group_size);
  return Fast_sum<I>(field_, influence_, options_.error_bound, tree)(emit);
}

template <class I>
template <class Emit>
Sum_tally Deformation_field<I>::sum_plainly(std::span<const Numbered_point> targets, const Emit& emit) const
{
  constexpr std::size_t target_block = 64;
  constexpr Index source_block = 512; // 28 KiB: stays in the first-level cache while all targets of a block pass

  const Summation_kernels<I> kernels(influence_);
  const std::size_t blocks = (targets.size() + target_block - 1) / target_block;
  tbb::parallel_for(std::size_t(0), blocks, [&](std::size_t block) {
    const auto list =
      targets.subspan(block * target_block, std::min(target_block, targets.size() - block * target_block));
    std::array<std::array<double, target_block>, 3> x;
    for (std::size_t m = 0; m < target_block; ++m)
      for (std::size_t d = 0; d < 3; ++d)
        x[d][m] = list[std::min(m, list.size() - 1)].position[d];
    std::array<std::array<double, target_block>, 4> sums = {};
    for (Index first = 0; first < field_.size(); first += source_block)
      kernels.add_direct(field_.charges(first), std::min(source_block, field_.size() - first),
                         {x[0].data(), x[1].data(), x[2].data()}, target_block,
                         {sums[0].data(), sums[1].data(), sums[2].data(), sums[3].data()});
    for (std::size_t m = 0; m < target_block; ++m)
      for (std::size_t d = 1; d < 4; ++d)
        sums[d][m] = sums[0][m] > 0 ? sums[d][m] / sums[0][m] : 0;
    emit(list, sums[1].data(), sums[2].data(), sums[3].data());
  });
  return {static_cast<Index>(targets.size()) * field_.size(), 0, 0};
}

} // namespace recurve::internal

#endif
