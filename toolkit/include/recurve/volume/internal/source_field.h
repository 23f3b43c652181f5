#ifndef RECURVE_VOLUME_INTERNAL_SOURCE_FIELD_H
#define RECURVE_VOLUME_INTERNAL_SOURCE_FIELD_H

#include <recurve/core/types.h>
#include <recurve/volume/internal/expansion_table.h>
#include <recurve/volume/internal/point_tree.h>
#include <recurve/volume/internal/simd_kernels.h>

#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>

#include <array>
#include <cmath>
#include <span>
#include <type_traits>
#include <vector>

namespace recurve::internal {

/// The sources of a deformation, sorted into a tree, with the moments of each node's charges. Lengths are in units of
/// the influence's length, relative to an origin near the sources; displacements are in units of the largest one.
class Source_field
{
public:
  Source_field() = default;

  /// sorts the sources. \param weights  one per source, or empty: all 1. \param degree  of the expansions; -1: there
  /// are none, and the sources stay in their order. \param keeps_floats  whether moments are kept, and charges as well,
  /// in single precision.
  Source_field(std::vector<Numbered_point> sources, std::span<const double> weights, int degree, bool keeps_floats,
               Index leaf_capacity);

  /// takes displacements, by the caller's numbers, already scaled.
  template <class DisplacementOf>
  void set_displacements(const DisplacementOf& displacement);

  const Point_tree& tree() const { return tree_; }
  int degree() const { return degree_; }
  Index size() const { return static_cast<Index>(numbers_.size()); }
  double weight(Index node) const { return summaries_[static_cast<std::size_t>(node)].weight; }

  /// mean of order degree + 1 of the distances of the node's sources from its center.
  double mean_radius(Index node) const { return summaries_[static_cast<std::size_t>(node)].mean_radius; }

  /// moments of the four charges of a node: term_count(degree) times four numbers, then zeros up to `stride()`; those
  /// of degree k divided by `moment_unit(node)`^k.
  template <class Real>
  const Real* moments(Index node) const
  {
    const std::size_t at = static_cast<std::size_t>(node) * stride();
    if constexpr (std::is_same_v<Real, float>)
      return float_moments_.data() + at;
    else
      return moments_.data() + at;
  }

  double moment_unit(Index node) const
  {
    const double radius = tree_.node(node).radius;
    return radius > 0 ? radius : 1;
  }

  std::size_t stride() const { return (4 * static_cast<std::size_t>(term_count(degree_)) + 15) / 16 * 16; }

  Point position(Index m) const
  {
    const auto i = static_cast<std::size_t>(m);
    return {x_[i], y_[i], z_[i]};
  }
  double source_weight(Index m) const { return weight_[static_cast<std::size_t>(m)]; }

  /// the sources from number `first`, in the tree's order, on.
  Charges<double> charges(Index first) const
  {
    return {x_.data() + first,          y_.data() + first,          z_.data() + first,         weight_.data() + first,
            weighted_x_.data() + first, weighted_y_.data() + first, weighted_z_.data() + first};
  }

  /// the same in single precision, with positions relative to the center of their leaf.
  Charges<float> float_charges(Index first) const
  {
    const float* f = floats_.data() + first;
    const Index n = size();
    return {f, f + n, f + 2 * n, f + 3 * n, f + 4 * n, f + 5 * n, f + 6 * n};
  }

  std::size_t bytes() const
  {
    return tree_.bytes() + 8 * (7 * weight_.size() + numbers_.size() + moments_.size()) +
           4 * (float_moments_.size() + floats_.size()) + summaries_.size() * sizeof(Summary);
  }

private:
  struct Summary
  {
    double weight, mean_radius;
  };

  void summarize(Index node);
  std::vector<double> expand(Index node);
  void add_leaf_moments(Index node, std::span<double> moments) const;
  void add_child_moments(Index node, Index child, std::span<const double> given, std::span<double> moments) const;
  void keep(Index node, std::span<const double> moments);
  void keep_float_charges(Index leaf);

  static constexpr Index parallel_size = 4096; // sources of a subtree that is worth a task

  Point_tree tree_;
  int degree_ = -1;
  std::vector<Index> numbers_;
  std::vector<double> x_, y_, z_, weight_, weighted_x_, weighted_y_, weighted_z_;
  std::vector<Summary> summaries_;
  bool keeps_floats_ = false;
  std::vector<double> moments_;
  std::vector<float> floats_; ///< seven arrays, one after the other
  std::vector<float> float_moments_;
};

inline Source_field::Source_field(std::vector<Numbered_point> sources, std::span<const double> weights, int degree,
                                  bool keeps_floats, Index leaf_capacity)
  : degree_(degree), keeps_floats_(keeps_floats)
{
  const std::size_t n = sources.size();
  std::vector<Numbered_point> unsorted;
  if (degree >= 0)
    tree_ = Point_tree(std::move(sources), leaf_capacity);
  else
    unsorted = std::move(sources);
  const auto points = degree >= 0 ? tree_.points() : std::span<const Numbered_point>(unsorted);
  for (auto* array : {&x_, &y_, &z_, &weight_, &weighted_x_, &weighted_y_, &weighted_z_})
    array->resize(n);
  numbers_.resize(n);
  tbb::parallel_for(std::size_t(0), n, [&](std::size_t m) {
    numbers_[m] = points[m].number;
    x_[m] = points[m].position[0];
    y_[m] = points[m].position[1];
    z_[m] = points[m].position[2];
    weight_[m] = weights.empty() ? 1 : weights[static_cast<std::size_t>(points[m].number)];
  });
  tree_.drop_points();
  summaries_.resize(static_cast<std::size_t>(tree_.node_count()));
  if (!summaries_.empty())
    summarize(0);
}

inline void Source_field::summarize(Index number)
{
  const Point_tree::Node& node = tree_.node(number);
  Summary& summary = summaries_[static_cast<std::size_t>(number)];
  summary = {0, 0};
  for (Index m = node.begin; m < node.end; ++m)
  {
    const Point p = position(m);
    const double x = p[0] - node.center[0], y = p[1] - node.center[1], z = p[2] - node.center[2];
    const double q = x * x + y * y + z * z;
    double power = (degree_ + 1) % 2 == 1 ? std::sqrt(q) : 1;
    for (int k = 0; k < (degree_ + 1) / 2; ++k)
      power *= q;
    summary.weight += source_weight(m);
    summary.mean_radius += source_weight(m) * power;
  }
  if (summary.weight > 0)
    summary.mean_radius = std::min(node.radius, std::pow(summary.mean_radius / summary.weight, 1.0 / (degree_ + 1)));
  if (tree_.is_leaf(number))
    return;
  const auto left = [&] { summarize(2 * number + 1); };
  const auto right = [&] { summarize(2 * number + 2); };
  if (node.size() >= parallel_size)
    tbb::parallel_invoke(left, right);
  else
  {
    left();
    right();
  }
}

template <class DisplacementOf>
void Source_field::set_displacements(const DisplacementOf& displacement)
{
  tbb::parallel_for(std::size_t(0), numbers_.size(), [&](std::size_t m) {
    const Point s = displacement(numbers_[m]);
    weighted_x_[m] = weight_[m] * s[0];
    weighted_y_[m] = weight_[m] * s[1];
    weighted_z_[m] = weight_[m] * s[2];
  });
  if (tree_.node_count() == 0)
    return;
  const std::size_t size = static_cast<std::size_t>(tree_.node_count()) * stride();
  if (keeps_floats_)
  {
    float_moments_.resize(size);
    floats_.resize(7 * numbers_.size());
  }
  else
    moments_.resize(size);
  expand(0);
}

/// computes and keeps the moments of a node and of all below it.
inline std::vector<double> Source_field::expand(Index number)
{
  std::vector<double> moments(static_cast<std::size_t>(4 * term_count(degree_)), 0.0);
  if (tree_.is_leaf(number))
  {
    add_leaf_moments(number, moments);
    if (keeps_floats_)
      keep_float_charges(number);
  }
  else
  {
    std::array<std::vector<double>, 2> below;
    const auto left = [&] { below[0] = expand(2 * number + 1); };
    const auto right = [&] { below[1] = expand(2 * number + 2); };
    if (tree_.node(number).size() >= parallel_size)
      tbb::parallel_invoke(left, right);
    else
    {
      left();
      right();
    }
    add_child_moments(number, 2 * number + 1, below[0], moments);
    add_child_moments(number, 2 * number + 2, below[1], moments);
  }
  keep(number, moments);
  return moments;
}

inline void Source_field::keep(Index number, std::span<const double> moments)
{
  const Expansion_table& table = Expansion_table::instance();
  const double inverse_unit = 1 / moment_unit(number);
  std::array<double, max_expansion_degree + 1> factors;
  factors[0] = 1;
  for (std::size_t k = 1; k < factors.size(); ++k)
    factors[k] = factors[k - 1] * inverse_unit;
  const std::size_t at = static_cast<std::size_t>(number) * stride();
  for (std::size_t m = 0; m < moments.size(); ++m)
  {
    const double value = moments[m] * factors[static_cast<std::size_t>(table.degree(static_cast<int>(m / 4)))];
    if (keeps_floats_)
      float_moments_[at + m] = static_cast<float>(value);
    else
      moments_[at + m] = value;
  }
}

inline void Source_field::keep_float_charges(Index leaf)
{
  const Point_tree::Node& node = tree_.node(leaf);
  const std::array arrays = {&x_, &y_, &z_, &weight_, &weighted_x_, &weighted_y_, &weighted_z_};
  for (std::size_t c = 0; c < 7; ++c)
    for (Index m = node.begin; m < node.end; ++m)
      floats_[c * numbers_.size() + static_cast<std::size_t>(m)] =
        static_cast<float>((*arrays[c])[static_cast<std::size_t>(m)] - (c < 3 ? node.center[c] : 0));
}

inline void Source_field::add_leaf_moments(Index number, std::span<double> moments) const
{
  const Point_tree::Node& node = tree_.node(number);
  constexpr Index block = 64; // sources at a time; a multiple of lanes<double>
  std::array<std::array<double, block>, 7> buffer;
  std::vector<double> lane_sums(static_cast<std::size_t>(4 * term_count(degree_) * lanes<double>));
  for (Index first = node.begin; first < node.end; first += block)
  {
    const Index count = std::min(block, node.end - first);
    const Index padded = (count + lanes<double> - 1) / lanes<double> * lanes<double>;
    const Charges<double> s = charges(first);
    const std::array<const double*, 7> arrays = {s.x, s.y, s.z, s.weight, s.weighted_x, s.weighted_y, s.weighted_z};
    for (std::size_t c = 0; c < 7; ++c)
      for (Index m = 0; m < padded; ++m)
        buffer[c][static_cast<std::size_t>(m)] = m < count ? arrays[c][m] - (c < 3 ? node.center[c] : 0) : 0;
    kernels<3, 5>().add_moments(Expansion_table::instance(), degree_,
                                {buffer[0].data(), buffer[1].data(), buffer[2].data(), buffer[3].data(),
                                 buffer[4].data(), buffer[5].data(), buffer[6].data()},
                                padded, reinterpret_cast<Pack<double>*>(lane_sums.data()), moments.data());
  }
}

/// x^i y^j z^k / (i! j! k!) of one point.
inline std::array<double, max_term_count> scaled_monomials(const Point& x, int degree)
{
  const Expansion_table& table = Expansion_table::instance();
  std::array<double, max_term_count> result;
  result[0] = 1;
  for (int g = 1; g < term_count(degree); ++g)
  {
    const Expansion_table::Recurrence& r = table.recurrence(g);
    result[static_cast<std::size_t>(g)] = result[static_cast<std::size_t>(r.parent)] *
                                          x[static_cast<std::size_t>(r.axis)] *
                                          inverse_integers[static_cast<std::size_t>(r.power + 1)];
  }
  return result;
}

/// adds the moments of a child, moved to the center of its parent.
inline void Source_field::add_child_moments(Index number, Index child, std::span<const double> given,
                                            std::span<double> moments) const
{
  const Expansion_table& table = Expansion_table::instance();
  const Point &to = tree_.node(number).center, &from = tree_.node(child).center;
  const auto shift = scaled_monomials({to[0] - from[0], to[1] - from[1], to[2] - from[2]}, degree_);
  for (int b = 0; b < term_count(degree_); ++b)
  {
    const std::int16_t* product = table.products(b);
    const double factor = shift[static_cast<std::size_t>(b)];
    for (int a = 0; a < term_count(degree_ - table.degree(b)); ++a)
      for (std::size_t c = 0; c < 4; ++c)
        moments[static_cast<std::size_t>(4 * product[a]) + c] += factor * given[static_cast<std::size_t>(4 * a) + c];
  }
}

} // namespace recurve::internal

#endif
