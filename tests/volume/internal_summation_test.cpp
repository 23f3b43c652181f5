#include <recurve/volume/internal/expansion_table.h>
#include <recurve/volume/internal/nearest_distance.h>
#include <recurve/volume/internal/point_tree.h>
#include <recurve/volume/internal/simd_kernels.h>

#include <volume/deformation_fields.h>

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <memory>
#include <random>
#include <set>
#include <span>
#include <vector>

using namespace recurve;
using namespace recurve::internal;
using namespace recurve::tests;

namespace {

std::vector<Numbered_point> numbered(const std::vector<Point>& points)
{
  std::vector<Numbered_point> result;
  for (std::size_t m = 0; m < points.size(); ++m)
    result.push_back({points[m], static_cast<Index>(m)});
  return result;
}

template <class Real>
struct alignas(64) Packs
{
  Pack<Real> of[4 * max_term_count + 16];
};

/// everything that one set of kernels computes from random input.
struct Kernel_results
{
  std::vector<double> sums;
  Packs<double> derivatives = {}, local = {};
  Packs<float> float_derivatives = {}, float_local = {};
};

template <class Real>
void run_expansion(const Expansion<Real>& kernels, int degree, Packs<Real>& derivatives, Packs<Real>& local,
                   const Sums& sums)
{
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(-1, 1);
  const Expansion_table& table = Expansion_table::instance();
  const auto packs = std::make_unique<Packs<Real>>();
  std::vector<Real> moments(static_cast<std::size_t>(lanes<Real>) * (4 * max_term_count + 16));
  for (Real& m : moments)
    m = static_cast<Real>(uniform(random));
  alignas(64) Pack<Real> offsets[3], near_factors, radial[max_expansion_degree + 1], factors[max_expansion_degree + 1];
  const Real* rows[lanes<Real>];
  for (int lane = 0; lane < lanes<Real>; ++lane)
  {
    for (auto& offset : offsets)
      offset[lane] = static_cast<Real>(3 + uniform(random));
    near_factors[lane] = static_cast<Real>(0.5 + uniform(random) / 4);
    for (auto& factor : factors)
      factor[lane] = static_cast<Real>(1 + uniform(random) / 4);
    rows[lane] = moments.data() + static_cast<std::size_t>(lane) * (4 * max_term_count + 16);
  }
  kernels.radial_derivatives(offsets, near_factors, degree, radial);
  kernels.derivative_tensor(degree, offsets, radial, derivatives.of);
  kernels.translate(table, degree, derivatives.of, rows, factors, factors, packs->of, local.of);
  kernels.add_expansion(term_count(degree), derivatives.of, rows[0], 1.25, sums);
}

std::unique_ptr<Kernel_results> run_kernels(const Kernels& kernels, int degree)
{
  auto result = std::make_unique<Kernel_results>();
  std::mt19937 random(2);
  std::uniform_real_distribution<double> uniform(-1, 1);
  const Index source_count = 104, target_count = 48;
  std::vector<double> sources(7 * std::size_t(source_count)), targets(3 * std::size_t(target_count));
  for (auto* list : {&sources, &targets})
    for (double& x : *list)
      x = uniform(random);
  const std::vector<float> float_sources(sources.begin(), sources.end()), float_targets(targets.begin(), targets.end());
  const double *s = sources.data(), *t = targets.data();
  const float *fs = float_sources.data(), *ft = float_targets.data();
  const Index n = source_count, m = target_count;
  result->sums.assign(4 * std::size_t(m), 0.0);
  double* sums = result->sums.data();
  const Sums out = {sums, sums + m, sums + 2 * m, sums + 3 * m};
  kernels.add_direct({s, s + n, s + 2 * n, s + 3 * n, s + 4 * n, s + 5 * n, s + 6 * n}, n - 3, {t, t + m, t + 2 * m}, m,
                     0.6, out);
  kernels.add_direct_float({fs, fs + n, fs + 2 * n, fs + 3 * n, fs + 4 * n, fs + 5 * n, fs + 6 * n}, n - 3,
                           {ft, ft + m, ft + 2 * m}, m, 0.6F, out);
  const Expansion_table& table = Expansion_table::instance();
  std::vector<double> moments(4 * std::size_t(term_count(degree)), 0.0);
  const auto packs = std::make_unique<Packs<double>>();
  kernels.add_moments(table, degree, {s, s + n, s + 2 * n, s + 3 * n, s + 4 * n, s + 5 * n, s + 6 * n}, n, packs->of,
                      moments.data());
  kernels.add_local(table, degree, moments.data(), {t, t + m, t + 2 * m}, m, out);
  std::vector<float> floats(static_cast<std::size_t>(m));
  kernels.floats.to_relative(t, m, 0.123, 1.5, floats.data());
  run_expansion(kernels.doubles, degree, result->derivatives, result->local, out);
  run_expansion(kernels.floats, degree, result->float_derivatives, result->float_local, out);
  result->sums.insert(result->sums.end(), floats.begin(), floats.end());
  result->sums.insert(result->sums.end(), moments.begin(), moments.end());
  return result;
}

template <class T>
bool is_same_to_the_bit(const T& a, const T& b)
{
  return std::ranges::equal(std::as_bytes(std::span(&a, 1)), std::as_bytes(std::span(&b, 1)));
}

} // namespace

TEST_CASE("summation kernels: every instruction set gives the same bits", "[volume]")
{
  const int degree = GENERATE(1, 4, 6, 9, 10);
  CAPTURE(degree);
  const auto narrow = run_kernels(select_kernels<3, 5>("baseline"), degree);
  for (const char* set : {"avx2", "avx512"})
  {
    const Kernels kernels = select_kernels<3, 5>(set);
    CAPTURE(set, kernels.name); // "baseline" where the processor has no more
    const auto wide = run_kernels(kernels, degree);
    CHECK(wide->sums == narrow->sums);
    CHECK(is_same_to_the_bit(wide->derivatives, narrow->derivatives));
    CHECK(is_same_to_the_bit(wide->local, narrow->local));
    CHECK(is_same_to_the_bit(wide->float_derivatives, narrow->float_derivatives));
    CHECK(is_same_to_the_bit(wide->float_local, narrow->float_local));
  }
}

TEST_CASE("summation kernels: derivatives of an inverse power, by differences", "[volume]")
{
  const Kernels& kernels = internal::kernels<3, 5>();
  const Expansion_table& table = Expansion_table::instance();
  constexpr int degree = 5;
  const double step = 1e-3;
  const auto derivatives_at = [&](const Point& p) {
    auto result = std::make_unique<Packs<double>>();
    alignas(64) Pack<double> offsets[3], near_factors, radial[degree + 1];
    for (int lane = 0; lane < lanes<double>; ++lane)
    {
      near_factors[lane] = 0.59;
      for (std::size_t d = 0; d < 3; ++d)
        offsets[d][lane] = p[d];
    }
    kernels.doubles.radial_derivatives(offsets, near_factors, degree, radial);
    kernels.doubles.derivative_tensor(degree, offsets, radial, result->of);
    return result;
  };
  const Point p = {1.1, -0.7, 0.9};
  const auto here = derivatives_at(p);
  const double q = p[0] * p[0] + p[1] * p[1] + p[2] * p[2];
  CHECK(here->of[0][0] == Approx(std::pow(q, -1.5) + 0.59 * std::pow(q, -2.5)).epsilon(1e-14));
  for (int g = 1; g < term_count(degree); ++g)
  {
    const Expansion_table::Recurrence& r = table.recurrence(g);
    Point low = p, high = p;
    low[std::size_t(r.axis)] -= step;
    high[std::size_t(r.axis)] += step;
    const double difference =
      (derivatives_at(high)->of[r.parent][0] - derivatives_at(low)->of[r.parent][0]) / (2 * step);
    CHECK(here->of[g][3] == Approx(difference).epsilon(1e-3).margin(1e-3));
  }
}

TEST_CASE("Expansion_table: products and recurrences of monomials", "[volume]")
{
  const Expansion_table& table = Expansion_table::instance();
  std::set<std::array<std::int8_t, 3>> seen;
  for (int g = 0; g < max_term_count; ++g)
  {
    const auto& p = table.powers(g);
    CHECK(seen.insert(p).second);
    CHECK(table.degree(g) == p[0] + p[1] + p[2]);
    CHECK(g < term_count(table.degree(g)));
    CHECK(g >= term_count(table.degree(g) - 1));
    if (g == 0)
      continue;
    const Expansion_table::Recurrence& r = table.recurrence(g);
    auto parent = table.powers(r.parent);
    CHECK(parent[std::size_t(r.axis)] == r.power);
    ++parent[std::size_t(r.axis)];
    CHECK(parent == p);
  }
  for (int b = 0; b < max_term_count; ++b)
    for (int a = 0; a < term_count(max_expansion_degree - table.degree(b)); ++a)
      for (std::size_t d = 0; d < 3; ++d)
        REQUIRE(table.powers(table.products(b)[a])[d] == table.powers(a)[d] + table.powers(b)[d]);
}

TEST_CASE("Point_tree: every point in one leaf, boxes and radii tight", "[volume]")
{
  const int n = GENERATE(1, 2, 7, 64, 65, 1000, 40000);
  const Index capacity = GENERATE(2, 10, 64);
  const bool has_equal_points = GENERATE(false, true);
  std::vector<Point> points = random_box(n, 5);
  if (has_equal_points)
    std::fill(points.begin(), points.begin() + n / 2, Point{0.5, 0, 0});
  const Point_tree tree(numbered(points), capacity);
  REQUIRE(tree.points().size() == std::size_t(n));
  std::vector<int> count(std::size_t(n), 0);
  for (Index node = 0; node < tree.node_count(); ++node)
  {
    const Point_tree::Node& cell = tree.node(node);
    if (tree.is_leaf(node))
    {
      CHECK(cell.size() <= capacity);
      CHECK(cell.size() > 0);
      if (n > capacity)
        CHECK(2 * cell.size() >= capacity - 1);
    }
    else
    {
      CHECK(tree.node(2 * node + 1).begin == cell.begin);
      CHECK(tree.node(2 * node + 1).end == tree.node(2 * node + 2).begin);
      CHECK(tree.node(2 * node + 2).end == cell.end);
    }
    Point low = {1e9, 1e9, 1e9}, high = {-1e9, -1e9, -1e9};
    double radius = 0;
    for (Index m = cell.begin; m < cell.end; ++m)
    {
      const Numbered_point& p = tree.points()[std::size_t(m)];
      if (tree.is_leaf(node))
      {
        ++count[std::size_t(p.number)];
        CHECK(p.position == points[std::size_t(p.number)]);
      }
      for (std::size_t d = 0; d < 3; ++d)
      {
        low[d] = std::min(low[d], p.position[d]);
        high[d] = std::max(high[d], p.position[d]);
      }
      radius = std::max(radius, distance(p.position, cell.center));
    }
    REQUIRE(cell.low == low);
    REQUIRE(cell.high == high);
    REQUIRE(cell.radius >= radius);
    REQUIRE(cell.radius <= radius * (1 + 1e-14));
  }
  CHECK(std::ranges::all_of(count, [](int c) { return c == 1; }));
  CHECK(Point_tree({}, 10).is_empty());
}

TEST_CASE("nearest_distance: against all points", "[volume]")
{
  const std::vector<Point> points = random_box(3000, 6);
  const Point_tree tree(numbered(points), 16);
  for (const Point& p : points_off_sphere(200, 7, 1e-3, 3))
  {
    double nearest = 1e300;
    for (const Point& q : points)
      nearest = std::min(nearest, distance(p, q));
    CHECK(nearest_distance(tree, p, 100) == Approx(nearest).epsilon(1e-14));
    CHECK(nearest_distance(tree, p, nearest / 2) == Approx(nearest / 2).epsilon(1e-14));
  }
  CHECK(nearest_distance(Point_tree({}, 10), {0, 0, 0}, 3) == 3);
}
