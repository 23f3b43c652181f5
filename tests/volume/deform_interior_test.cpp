#include <recurve/volume/deform_interior.h>

#include <recurve/core/exceptions.h>
#include <volume/deformation_fields.h>

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <Eigen/Geometry>
#include <catch2/catch.hpp>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

using namespace recurve;
using namespace recurve::tests;

namespace {

constexpr double no_number = std::numeric_limits<double>::quiet_NaN();

/// the paper's formulas (5) and (6), written down as they stand there, in extended precision.
Point formula(const std::vector<Point>& sources, const std::vector<Point>& displacements, const Point& r,
              const Deformation_options& options, const std::vector<double>& areas = {})
{
  using Real = long double;
  std::array<Real, 4> sums = {};
  for (std::size_t i = 0; i < sources.size(); ++i)
  {
    Real q = 0;
    for (std::size_t d = 0; d < 3; ++d)
      q += (Real(r[d]) - Real(sources[i][d])) * (Real(r[d]) - Real(sources[i][d]));
    const Real ratio = Real(options.length) / std::sqrt(q);
    const Real w = (std::pow(ratio, Real(options.a)) + std::pow(Real(options.alpha) * ratio, Real(options.b))) *
                   (areas.empty() ? 1 : Real(areas[i]));
    sums[0] += w;
    for (std::size_t d = 0; d < 3; ++d)
      sums[d + 1] += w * Real(displacements[i][d]);
  }
  return {double(sums[1] / sums[0]), double(sums[2] / sums[0]), double(sums[3] / sums[0])};
}

std::vector<Point> displacements_at(const std::vector<Point>& targets, const std::vector<Point>& sources,
                                    const std::vector<Point>& given, double length, const Summation_options& options,
                                    Deformation_report* report = nullptr)
{
  Interior_deformer<> deformer(sources, Inverse_distance<>(length), options);
  deformer.set_displacements(given);
  std::vector<Point> result(targets.size());
  const Deformation_report r = deformer.evaluate(targets, result);
  if (report)
    *report = r;
  return result;
}

} // namespace

TEST_CASE("deform_interior: the paper's formula", "[volume]")
{
  const double a = GENERATE(3.0, 2.0, 3.5), b = GENERATE(5.0, 4.0, 6.25), alpha = GENERATE(0.9, 0.0, 2.0);
  const double length = GENERATE(0.05, 3.0);
  const Summation method = GENERATE(Summation::plain, Summation::fast);
  CAPTURE(a, b, alpha, length);
  const std::vector<Point> sources = fibonacci_sphere(300), given = smooth_field(sources);
  std::vector<double> areas;
  if (GENERATE(false, true))
    for (std::size_t m = 0; m < sources.size(); ++m)
      areas.push_back(0.1 + std::abs(sources[m][2]));
  Deformation_options options = {.length = length, .alpha = alpha, .a = a, .b = b};
  options.summation.method = method;
  options.summation.error_bound = 1e-9;
  const std::vector<Point> before = points_off_sphere(40, 1, 1e-4, 3);
  std::vector<Point> targets = before;
  const Deformation_report report = deform_interior(sources, given, targets, options, areas);
  CHECK(report.is_fast == (method == Summation::fast));
  for (std::size_t m = 0; m < targets.size(); ++m)
  {
    const Point s = formula(sources, given, before[m], options, areas);
    for (std::size_t d = 0; d < 3; ++d)
      CHECK(std::abs(targets[m][d] - before[m][d] - s[d]) < 2e-9);
  }
}

TEST_CASE("deform_interior: the plain sum is exact to rounding", "[volume]")
{
  const std::vector<Point> sources = random_box(5000, 2), given = smooth_field(sources);
  const std::vector<Point> targets = points_off_box(30, 3);
  Deformation_report report;
  const auto s = displacements_at(targets, sources, given, 0.01, {.method = Summation::plain}, &report);
  CHECK(report.error_bound == 0);
  CHECK(report.pairs == 5000 * 30);
  for (std::size_t m = 0; m < targets.size(); ++m)
    CHECK(distance(s[m], formula(sources, given, targets[m], {.length = 0.01})) < 1e-13);
}

TEST_CASE("deform_interior: exact cases", "[volume]")
{
  const Summation method = GENERATE(Summation::plain, Summation::fast);
  const Summation_options options = {.method = method};

  SECTION("a translation of all sources is one of all targets")
  {
    const std::vector<Point> sources = fibonacci_sphere(5000), targets = points_off_sphere(500, 4, 1e-6, 10);
    const Point given = {0.3, -2, 0.001};
    const auto s = displacements_at(targets, sources, std::vector<Point>(sources.size(), given), 0.01, options);
    for (const Point& p : s)
      CHECK(distance(p, given) < 1e-5 * 2.1); // numerator and denominator share their errors, but for rounding
  }
  SECTION("midway between two sources it is the mean")
  {
    const std::vector<Point> sources = {{0, 0, 0}, {2, 0, 0}}, given = {{1, 0, 0}, {0, 4, -2}};
    const auto s = displacements_at({{1, 0.7, -3}}, sources, given, 0.1, options);
    CHECK(distance(s[0], {0.5, 2, -1}) < (method == Summation::plain ? 1e-15 : 1e-6));
  }
  SECTION("at a source it is that of the source")
  {
    const std::vector<Point> sources = fibonacci_sphere(3000), given = curving_field(sources);
    const auto s = displacements_at(sources, sources, given, 0.02, options);
    for (std::size_t m = 0; m < sources.size(); ++m)
      CHECK(distance(s[m], given[m]) < 1e-14);
  }
  SECTION("at two sources in one place it is their mean")
  {
    const std::vector<Point> sources = {{1, 1, 1}, {1, 1, 1}, {5, 5, 5}}, given = {{1, 0, 0}, {0, 1, 0}, {9, 9, 9}};
    CHECK(distance(displacements_at({{1, 1, 1}}, sources, given, 1, options)[0], {0.5, 0.5, 0}) < 1e-15);
  }
  SECTION("a single source moves everything")
  {
    const auto s = displacements_at({{1e3, 0, 0}, {0, 0, 1e-9}, {0, 0, 0}}, {{0, 0, 0}}, {{1, 2, 3}}, 1, options);
    for (const Point& p : s)
      CHECK(distance(p, {1, 2, 3}) < 1e-14);
  }
  SECTION("far away it is the mean of all")
  {
    const std::vector<Point> sources = random_box(1000, 5), given = smooth_field(sources);
    Point mean = {0, 0, 0};
    for (const Point& p : given)
      for (std::size_t d = 0; d < 3; ++d)
        mean[d] += p[d] / double(given.size());
    CHECK(distance(displacements_at({{1e9, 0, 0}}, sources, given, 0.1, options)[0], mean) < 1e-7);
  }
  SECTION("nothing leaves the hull of what is given")
  {
    const std::vector<Point> sources = fibonacci_sphere(4000), targets = points_off_sphere(2000, 6, 1e-5, 1);
    std::vector<Point> given = random_field(sources, 7);
    for (Point& p : given)
      p = {std::abs(p[0]), std::abs(p[1]), 0};
    for (const Point& p : displacements_at(targets, sources, given, 0.02, options))
    {
      CHECK(p[0] >= -1e-5);
      CHECK(p[1] >= -1e-5);
      CHECK(p[2] == 0); // what no source has, no target gets: planar stays planar to the bit
    }
  }
}

TEST_CASE("deform_interior: the fast sum keeps its bound", "[volume]")
{
  const double bound = GENERATE(1e-2, 1e-4, 1e-6);
  const auto [name, sources, targets, length] = GENERATE(from_range(deformation_cases()));
  const Field_kind kind = GENERATE(Field_kind::smooth, Field_kind::curving, Field_kind::random, Field_kind::patch);
  CAPTURE(bound, name, int(kind));
  const std::vector<Point> given = field(kind, sources, 11);
  Deformation_report report;
  const auto fast =
    displacements_at(targets, sources, given, length, {.method = Summation::fast, .error_bound = bound}, &report);
  const auto plain = displacements_at(targets, sources, given, length, {.method = Summation::plain});
  double error = 0;
  for (std::size_t m = 0; m < targets.size(); ++m)
    error = std::max(error, distance(fast[m], plain[m]));
  CHECK(error <= report.error_bound * report.largest_given);
  CHECK(report.error_bound <= bound);
  // and it is a fast sum that was tested
  CHECK(report.is_fast);
  CHECK(report.translations > 0);
  CHECK(report.pairs < report.sources * report.targets);
}

TEST_CASE("deform_interior: the fast sum keeps its bound where signs conspire", "[volume]")
{
  // The field that makes the most of the error at one target: each source moves with the sign of what its own expansion
  // omits there, to the extent that a finite difference between two bounds shows it.
  const std::vector<Point> sources = fibonacci_sphere(6000);
  const std::vector<Point> targets = points_off_sphere(3000, 21, 1e-3, 1);
  const Interior_deformer<> loose(sources, Inverse_distance<>(0.05), {.method = Summation::fast, .error_bound = 1e-2});
  std::vector<Point> given(sources.size(), Point{0, 0, 0});
  // errors of single sources, seen from the first target, in groups of one moving source each
  std::vector<double> signs(sources.size(), 1);
  for (std::size_t group = 0; group < 60; ++group)
  {
    Interior_deformer<> fast = loose;
    Interior_deformer<> plain(sources, Inverse_distance<>(0.05), {.method = Summation::plain});
    std::vector<Point> one(sources.size(), Point{0, 0, 0});
    for (std::size_t m = group; m < sources.size(); m += 60)
      one[m] = {1, 0, 0};
    fast.set_displacements(one);
    plain.set_displacements(one);
    std::vector<Point> a(targets.size()), b(1);
    fast.evaluate(targets, a);
    plain.evaluate(std::vector<Point>{targets[0]}, b);
    const double sign = a[0][0] > b[0][0] ? 1 : -1;
    for (std::size_t m = group; m < sources.size(); m += 60)
      signs[m] = sign;
  }
  for (std::size_t m = 0; m < sources.size(); ++m)
    given[m] = {signs[m], 0, 0};
  Deformation_report report;
  const auto fast =
    displacements_at(targets, sources, given, 0.05, {.method = Summation::fast, .error_bound = 1e-2}, &report);
  const auto plain = displacements_at(targets, sources, given, 0.05, {.method = Summation::plain});
  double error = 0;
  for (std::size_t m = 0; m < targets.size(); ++m)
    error = std::max(error, distance(fast[m], plain[m]));
  CHECK(error > 0);
  CHECK(error <= report.error_bound);
}

TEST_CASE("deform_interior: four times the sources add the same work for a target, not four times as much", "[volume]")
{
  // What the expansion of a cell at a target costs, in pairs.
  constexpr double cost_of_expansion = 60;

  const std::vector<Point> targets = points_off_sphere(20000, 11, 1e-3, 1);
  std::vector<double> work;
  for (const int n : {5000, 20000, 80000})
  {
    const std::vector<Point> sources = fibonacci_sphere(n);
    std::vector<Point> result(targets.size());
    Interior_deformer<> deformer(sources, Inverse_distance<>(2 * std::sqrt(4 * std::acos(-1) / n)),
                                 {.method = Summation::fast});
    deformer.set_displacements(curving_field(sources));
    const Deformation_report report = deformer.evaluate(targets, result);
    work.push_back((static_cast<double>(report.pairs) + cost_of_expansion * static_cast<double>(report.translations)) /
                   static_cast<double>(targets.size()));
  }
  CAPTURE(work);
  CHECK(work[2] - work[1] < 1.5 * (work[1] - work[0]));
}

TEST_CASE("deform_interior: the number of threads does not matter, to the bit", "[volume]")
{
  const Summation method = GENERATE(Summation::plain, Summation::fast);
  const std::vector<Point> sources = fibonacci_sphere(20000), given = curving_field(sources);
  const std::vector<Point> targets = points_off_sphere(20000, 8, 1e-3, 1);
  const Summation_options options = {.method = method, .reach = 0.8};
  std::vector<std::vector<Point>> results;
  std::vector<Deformation_report> reports(3);
  for (const std::size_t threads : {1, 2, 7})
  {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
    results.push_back(displacements_at(targets, sources, given, 0.02, options, &reports[results.size()]));
  }
  CHECK(results[0] == results[1]);
  CHECK(results[0] == results[2]);
  CHECK(results[0] == displacements_at(targets, sources, given, 0.02, options));
  for (const Deformation_report& r : reports)
  {
    CHECK(r.moved_targets == reports[0].moved_targets);
    CHECK(r.largest_displacement == reports[0].largest_displacement);
    CHECK(r.error_bound == reports[0].error_bound);
    CHECK(r.pairs == reports[0].pairs);
    CHECK(r.translations == reports[0].translations);
  }
}

TEST_CASE("deform_interior: unit, origin and orientation do not matter", "[volume]")
{
  const Summation method = GENERATE(Summation::plain, Summation::fast);
  const double scale = GENERATE(1e-6, 1.0, 1e6), offset = GENERATE(0.0, 1e6);
  CAPTURE(scale, offset);
  const double bound = 1e-4;
  const Eigen::Matrix3d rotation =
    (Eigen::AngleAxisd(0.4, Eigen::Vector3d::UnitX()) * Eigen::AngleAxisd(-1.1, Eigen::Vector3d::UnitZ()))
      .toRotationMatrix();
  const auto turned = [&](const Point& p) {
    const Eigen::Vector3d v = rotation * Eigen::Vector3d(p[0], p[1], p[2]);
    return Point{v[0], v[1], v[2]};
  };
  const std::vector<Point> sources = fibonacci_sphere(3000), given = smooth_field(sources);
  const std::vector<Point> targets = points_off_sphere(400, 9, 1e-2, 1);
  std::vector<Point> moved_sources, moved_given, moved_targets;
  const auto place = [&](const Point& p) {
    const Point q = turned(p);
    return Point{scale * (q[0] + offset), scale * (q[1] - offset), scale * (q[2] + offset)};
  };
  std::ranges::transform(sources, std::back_inserter(moved_sources), place);
  std::ranges::transform(targets, std::back_inserter(moved_targets), place);
  for (const Point& p : given)
  {
    const Point q = turned(p);
    moved_given.push_back({scale * q[0], scale * q[1], scale * q[2]});
  }
  const Summation_options options = {.method = method, .error_bound = bound};
  const auto s = displacements_at(targets, sources, given, 0.03, options);
  const auto t = displacements_at(moved_targets, moved_sources, moved_given, 0.03 * scale, options);
  // An offset of 1e6 sizes rounds positions to 1e-10 of them, which shows 1e-2 off the wall.
  const double tolerance = (method == Summation::plain ? 1e-12 : 2 * bound) + (offset > 0 ? 1e-7 : 0);
  for (std::size_t m = 0; m < targets.size(); ++m)
  {
    const Point q = turned(s[m]);
    CHECK(distance({t[m][0] / scale, t[m][1] / scale, t[m][2] / scale}, q) < tolerance);
  }
}

TEST_CASE("deform_interior: the order of sources and targets does not matter", "[volume]")
{
  const Summation method = GENERATE(Summation::plain, Summation::fast);
  std::vector<Point> sources = fibonacci_sphere(3000), given = curving_field(sources);
  std::vector<Point> targets = points_off_sphere(1000, 10, 1e-3, 1);
  const auto s = displacements_at(targets, sources, given, 0.03, {.method = method});
  for (auto* list : {&sources, &given, &targets})
    std::ranges::reverse(*list);
  const auto t = displacements_at(targets, sources, given, 0.03, {.method = method});
  for (std::size_t m = 0; m < s.size(); ++m)
    CHECK(distance(s[m], t[s.size() - 1 - m]) < (method == Summation::plain ? 1e-13 : 2e-4));
}

TEST_CASE("deform_interior: a weight of three is three sources", "[volume]")
{
  const Summation method = GENERATE(Summation::plain, Summation::fast);
  const std::vector<Point> sources = fibonacci_sphere(2000), given = smooth_field(sources);
  std::vector<Point> repeated, repeated_given;
  std::vector<double> weights;
  for (std::size_t m = 0; m < sources.size(); ++m)
  {
    weights.push_back(m % 3 == 0 ? 3e-7 : 1e-7); // only their ratios count
    for (int k = 0; k < (m % 3 == 0 ? 3 : 1); ++k)
    {
      repeated.push_back(sources[m]);
      repeated_given.push_back(given[m]);
    }
  }
  const std::vector<Point> targets = points_off_sphere(500, 12, 1e-3, 1);
  Interior_deformer<> deformer(sources, Inverse_distance<>(0.04), {.method = method}, weights);
  deformer.set_displacements(given);
  std::vector<Point> s(targets.size());
  deformer.evaluate(targets, s);
  const auto t = displacements_at(targets, repeated, repeated_given, 0.04, {.method = method});
  for (std::size_t m = 0; m < s.size(); ++m)
    CHECK(distance(s[m], t[m]) < (method == Summation::plain ? 1e-13 : 2e-4));
}

TEST_CASE("deform_interior: displacements may be set again", "[volume]")
{
  const std::vector<Point> sources = fibonacci_sphere(6000), first = smooth_field(sources),
                           second = curving_field(sources);
  const std::vector<Point> targets = points_off_sphere(300, 13, 1e-3, 1);
  const Summation_options options = {.method = Summation::fast};
  Interior_deformer<> deformer(sources, Inverse_distance<>(0.03), options);
  std::vector<Point> s(targets.size());
  for (const auto* given : {&first, &second, &first})
  {
    deformer.set_displacements(*given);
    deformer.evaluate(targets, s);
    CHECK(s == displacements_at(targets, sources, *given, 0.03, options));
  }
}

TEST_CASE("deform_interior: beyond reach nothing moves", "[volume]")
{
  const Summation method = GENERATE(Summation::plain, Summation::fast);
  const std::vector<Point> sources = fibonacci_sphere(5000);
  std::vector<Point> given(sources.size(), Point{0, 0, 0});
  for (std::size_t m = 0; m < sources.size(); ++m)
    if (sources[m][2] > 0.9)
      given[m] = {0.01, 0.02, 0.03};
  const std::vector<Point> targets = points_off_sphere(3000, 14, 1e-3, 2);
  const double reach = 0.5;
  Deformation_report report;
  const auto all = displacements_at(targets, sources, given, 0.03, {.method = method});
  const auto s = displacements_at(targets, sources, given, 0.03, {.method = method, .reach = reach}, &report);
  Index moved = 0, untouched = 0;
  for (std::size_t m = 0; m < targets.size(); ++m)
  {
    double nearest = 1e300;
    for (std::size_t i = 0; i < sources.size(); ++i)
      if (given[i][0] != 0)
        nearest = std::min(nearest, distance(targets[m], sources[i]));
    moved += s[m] != Point{0, 0, 0};
    if (nearest > reach)
    {
      ++untouched;
      CHECK(s[m] == Point{0, 0, 0});
    }
    else
    {
      const double t = std::min(1.0, 2 - 2 * nearest / reach), factor = t * t * (3 - 2 * t);
      for (std::size_t d = 0; d < 3; ++d)
        CHECK(std::abs(s[m][d] - factor * all[m][d]) < 2e-4 * 0.04);
    }
  }
  CHECK(untouched > 100);
  CHECK(moved > 100);
  CHECK(report.moved_targets == moved);

  // moving in place: what does not move keeps its bits
  std::vector<Point> moved_targets = targets;
  deform_interior(sources, given, moved_targets, {.length = 0.03, .summation = {.method = method, .reach = reach}});
  for (std::size_t m = 0; m < targets.size(); ++m)
    if (s[m] == Point{0, 0, 0})
      CHECK(moved_targets[m] == targets[m]);
    else
      CHECK(moved_targets[m] == Point{targets[m][0] + s[m][0], targets[m][1] + s[m][1], targets[m][2] + s[m][2]});
}

namespace {

/// A user's own influence: no expansion, so the plain sum.
struct Gaussian
{
  double length() const { return 0.3; }
  double operator()(double q) const { return std::exp(-q); }
};

} // namespace

TEST_CASE("deform_interior: an influence of the user's", "[volume]")
{
  static_assert(Influence<Gaussian> && !Expandable_influence<Gaussian>);
  static_assert(Expandable_influence<Inverse_distance<>> && Expandable_influence<Inverse_distance_powers>);
  const std::vector<Point> sources = {{0, 0, 0}, {1, 0, 0}}, given = {{1, 0, 0}, {0, 1, 0}};
  std::vector<Point> targets = {{0.2, 0, 0}};
  const Deformation_report report = deform_interior(sources, given, targets, Gaussian(), Summation_options{});
  CHECK_FALSE(report.is_fast);
  const double a = std::exp(-0.04 / 0.09), b = std::exp(-0.64 / 0.09);
  CHECK(targets[0][0] == Approx(0.2 + a / (a + b)).epsilon(1e-14));
  CHECK(targets[0][1] == Approx(b / (a + b)).epsilon(1e-14));
  CHECK_THROWS_AS(deform_interior(sources, given, targets, Gaussian(), Summation_options{.method = Summation::fast}),
                  Input_error);
}

TEST_CASE("deform_interior: takes any range of points", "[volume]")
{
  using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
  const std::vector<Point> sources = fibonacci_sphere(500), given = smooth_field(sources);
  std::vector<Point> targets = points_off_sphere(100, 15, 1e-3, 1);
  std::vector<Kernel::Point_3> cgal_sources, cgal_targets;
  std::vector<Kernel::Vector_3> cgal_given;
  std::vector<Eigen::Vector3d> eigen_targets;
  cgal_sources.reserve(sources.size());
  cgal_given.reserve(given.size());
  cgal_targets.reserve(targets.size());
  eigen_targets.reserve(targets.size());
  for (const Point& p : sources)
    cgal_sources.emplace_back(p[0], p[1], p[2]);
  for (const Point& p : given)
    cgal_given.emplace_back(p[0], p[1], p[2]);
  for (const Point& p : targets)
  {
    cgal_targets.emplace_back(p[0], p[1], p[2]);
    eigen_targets.emplace_back(p[0], p[1], p[2]);
  }
  const Deformation_options options = {.length = 0.1};
  deform_interior(sources, given, targets, options);
  deform_interior(cgal_sources, cgal_given, cgal_targets, options);
  deform_interior(sources, given, eigen_targets, options);
  for (std::size_t m = 0; m < targets.size(); ++m)
    for (int d = 0; d < 3; ++d)
    {
      CHECK(cgal_targets[m][d] == targets[m][std::size_t(d)]);
      CHECK(eigen_targets[m][d] == targets[m][std::size_t(d)]);
    }
}

TEST_CASE("deform_interior: degenerate input", "[volume]")
{
  const Summation method = GENERATE(Summation::automatic, Summation::plain, Summation::fast);
  const Summation_options options = {.method = method};
  const std::vector<Point> none;
  const std::vector<Point> somewhere = {{1, 2, 3}, {-1, 0, 5}};

  SECTION("no sources: nothing moves")
  {
    CHECK(displacements_at(somewhere, none, none, 1, options) == std::vector<Point>(2, Point{0, 0, 0}));
  }
  SECTION("no targets")
  {
    Deformation_report report;
    CHECK(displacements_at(none, somewhere, somewhere, 1, options, &report).empty());
    CHECK(report.targets == 0);
  }
  SECTION("all at rest: nothing moves, and nothing is summed")
  {
    const std::vector<Point> sources = fibonacci_sphere(3000);
    Deformation_report report;
    const auto s = displacements_at(somewhere, sources, std::vector<Point>(3000, Point{0, 0, 0}), 1, options, &report);
    CHECK(s == std::vector<Point>(2, Point{0, 0, 0}));
    CHECK(report.pairs == 0);
    CHECK(report.moved_targets == 0);
  }
  SECTION("all sources in one place")
  {
    const std::vector<Point> sources(1000, Point{1, 1, 1}), given(1000, Point{0, 0, 2});
    for (const Point& p : displacements_at(somewhere, sources, given, 1, options))
      CHECK(distance(p, {0, 0, 2}) < 1e-4);
    CHECK(distance(displacements_at({{1, 1, 1}}, sources, given, 1, options)[0], {0, 0, 2}) < 1e-12);
  }
  SECTION("all sources and targets on a line")
  {
    std::vector<Point> sources, given, targets;
    for (int m = 0; m < 2000; ++m)
    {
      sources.push_back({m * 1e-3, 0, 0});
      given.push_back({0, std::sin(m * 0.01), 0});
      targets.push_back({m * 1e-3 + 3e-4, 0, 0});
    }
    const auto s = displacements_at(targets, sources, given, 1e-3, options);
    const auto plain = displacements_at(targets, sources, given, 1e-3, {.method = Summation::plain});
    for (std::size_t m = 0; m < s.size(); ++m)
      CHECK(distance(s[m], plain[m]) <= 1e-4);
  }
  SECTION("tiny clusters far apart, and targets next to and far from them")
  {
    std::vector<Point> sources, given, targets;
    for (int m = 0; m < 3000; ++m)
    {
      const double t = 1e-9 * m;
      sources.push_back({m % 3 == 0 ? t : 1e5 + t, t * t, m % 3 == 1 ? 7.0 : -7.0});
      given.push_back({std::sin(m), 0, 1});
      targets.push_back({m % 2 == 0 ? t + 5e-10 : 3.0 * m, 1e-9, m % 3 == 1 ? 7.0 : -7.0});
    }
    const auto s = displacements_at(targets, sources, given, 1e-3, options);
    const auto plain = displacements_at(targets, sources, given, 1e-3, {.method = Summation::plain});
    for (std::size_t m = 0; m < s.size(); ++m)
      CHECK(distance(s[m], plain[m]) <= 1e-4 * std::sqrt(2));
  }
}

TEST_CASE("deform_interior: bad input is refused", "[volume]")
{
  std::vector<Point> two = {{0, 0, 0}, {1, 0, 0}};
  const std::vector<Point> one = {{1, 1, 1}}, broken = {{0, 0, 0}, {0, no_number, 0}};
  const Inverse_distance<> influence(1);
  CHECK_THROWS_AS(deform_interior(two, two, two, Deformation_options{}), Input_error); // no length
  CHECK_THROWS_AS(Inverse_distance<>(-1), Input_error);
  CHECK_THROWS_AS(Inverse_distance<>(1, no_number), Input_error);
  CHECK_THROWS_AS(Inverse_distance_powers(1, 0.9, 0, 5), Input_error);
  CHECK_THROWS_AS(deform_interior(two, one, two, influence, {}), Input_error);
  CHECK_THROWS_WITH(deform_interior(broken, two, two, influence, {}), Catch::Contains("source 1"));
  CHECK_THROWS_WITH(deform_interior(two, broken, two, influence, {}), Catch::Contains("displacement 1"));
  std::vector<Point> targets = broken;
  CHECK_THROWS_WITH(deform_interior(two, two, targets, influence, {}), Catch::Contains("target 1"));
  CHECK(targets[0] == Point{0, 0, 0});
  CHECK_THROWS_AS(deform_interior(two, two, two, influence, {.error_bound = 0}), Input_error);
  CHECK_THROWS_AS(deform_interior(two, two, two, influence, {.error_bound = no_number}), Input_error);
  CHECK_THROWS_AS(deform_interior(two, two, two, influence, {.reach = -1}), Input_error);
  CHECK_THROWS_AS(deform_interior(two, two, two, influence, {}, std::vector<double>{1}), Input_error);
  CHECK_THROWS_AS(deform_interior(two, two, two, influence, {}, std::vector<double>{1, -1}), Input_error);
  CHECK_THROWS_AS(deform_interior(two, two, two, influence, {}, std::vector<double>{0, 0}), Input_error);
  const Interior_deformer<> deformer(two, influence);
  std::vector<Point> room(1);
  CHECK_THROWS_AS(deformer.evaluate(two, room), Input_error);
}

TEST_CASE("deform_interior: progress is reported, and can stop it", "[volume]")
{
  const Summation method = GENERATE(Summation::plain, Summation::fast);
  const std::vector<Point> sources = fibonacci_sphere(3000), given = smooth_field(sources);
  const std::vector<Point> targets = points_off_sphere(5000, 16, 1e-3, 1);
  std::vector<double> fractions;
  Summation_options options = {.method = method};
  options.progress = [&](std::string_view stage, double fraction) {
    CHECK(stage == "deform");
    fractions.push_back(fraction);
    return true;
  };
  displacements_at(targets, sources, given, 0.1, options);
  REQUIRE(fractions.size() > 2);
  CHECK(fractions.size() <= 110);
  CHECK(fractions.front() == 0);
  CHECK(fractions.back() == 1);
  CHECK(std::ranges::is_sorted(fractions));
  options.progress = [](std::string_view, double fraction) { return fraction < 0.5; };
  CHECK_THROWS_AS(displacements_at(targets, sources, given, 0.1, options), Cancelled);
}

TEST_CASE("deform_interior: what is cheaper is chosen", "[volume]")
{
  const std::vector<Point> few = fibonacci_sphere(100), many = fibonacci_sphere(50000);
  const std::vector<Point> targets = points_off_sphere(20000, 17, 1e-3, 1);
  std::vector<Point> moved = targets;
  CHECK_FALSE(deform_interior(few, smooth_field(few), moved, {.length = 0.1}).is_fast);
  moved = targets;
  CHECK(deform_interior(many, smooth_field(many), moved, {.length = 0.01}).is_fast);
  moved.resize(3);
  CHECK_FALSE(deform_interior(many, smooth_field(many), moved, {.length = 0.01}).is_fast);
}
