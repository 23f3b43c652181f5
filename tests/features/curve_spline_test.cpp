#include <recurve/features/curve_spline.h>

#include <catch2/catch.hpp>

#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

using namespace recurve;

namespace {

constexpr double pi = std::numbers::pi;

double distance(const Point& a, const Point& b)
{
  return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
}

/// A curve over [0, 1], to be sampled at uneven parameters.
struct Exact_curve
{
  const char* name;
  std::function<Point(double)> at;
  bool is_closed;
};

const Exact_curve exact_curves[] = {
  {"circle",
   [](double t) {
     return Point{std::cos(2 * pi * t), std::sin(2 * pi * t), 1};
   },
   true},
  {"arc of a circle",
   [](double t) {
     return Point{std::cos(2 * pi * t / 1.3), std::sin(2 * pi * t / 1.3), 1};
   },
   false},
  {"ellipse",
   [](double t) {
     return Point{1.5 * std::cos(2 * pi * t), std::sin(2 * pi * t), 0};
   },
   true},
  {"arc of an ellipse",
   [](double t) {
     return Point{1.5 * std::cos(0.5 + 3 * t), std::sin(0.5 + 3 * t), 0};
   },
   false},
  {"helix",
   [](double t) {
     return Point{std::cos(6 * t), std::sin(6 * t), 3 * t};
   },
   false},
  {"closed wave",
   [](double t) {
     return Point{std::cos(2 * pi * t), std::sin(2 * pi * t), 0.1 * std::cos(4 * pi * t)};
   },
   true}};

/// parameters of n edges; a smooth stretching, so that edges are unequal and the rate can be measured.
double parameter(double i, int n, bool is_closed)
{
  const double t = i / n;
  return is_closed ? t + 0.02 * std::sin(2 * pi * t) : t + 0.1 * t * (1 - t);
}

Curve_spline fit(const Exact_curve& curve, int n, const Curve_fit_options& options)
{
  std::vector<Point> points;
  points.reserve(static_cast<std::size_t>(n) + 1);
  for (int i = 0; i < n + (curve.is_closed ? 0 : 1); ++i)
    points.push_back(curve.at(parameter(i, n, curve.is_closed)));
  return Curve_spline(points, curve.is_closed, options);
}

/// the distance of `p` from the curve, by Newton's method on the squared distance from a parameter nearby.
double distance_from(const Exact_curve& curve, const Point& p, double t)
{
  const double h = 1e-4;
  for (int i = 0; i < 20; ++i)
  {
    const Point a = curve.at(t - h), b = curve.at(t), c = curve.at(t + h);
    double slope = 0, bend = 0;
    for (int k = 0; k < 3; ++k)
    {
      const double d = (c[k] - a[k]) / (2 * h), dd = (c[k] - 2 * b[k] + a[k]) / (h * h);
      slope += (b[k] - p[k]) * d;
      bend += d * d + (b[k] - p[k]) * dd;
    }
    t -= slope / bend;
  }
  return distance(p, curve.at(t));
}

/// the largest distance over the fractions 1/6, 2/6, ... of all segments.
double error(const Exact_curve& curve, int n, const Curve_fit_options& options)
{
  const Curve_spline spline = fit(curve, n, options);
  REQUIRE(spline.number_of_segments() == n);
  double most = 0;
  for (int i = 0; i < n; ++i)
    for (int k = 1; k < 6; ++k)
      most = std::max(most, distance_from(curve, spline(i, k / 6.), parameter(i + k / 6., n, curve.is_closed)));
  return most;
}

void require_rate(const Exact_curve& curve, const Curve_fit_options& options, double rate)
{
  constexpr double round_off = 1e-14;
  std::vector<double> errors;
  for (const int n : {8, 16, 32, 64, 128})
    errors.push_back(error(curve, n, options));
  const double found = std::log2(errors[2] / errors[4]) / 2; // coarser ones are not yet at their rate at high degrees
  CAPTURE(curve.name, options.degree, static_cast<int>(options.method), errors, found);
  CHECK((found > rate - 0.3 || errors[4] < round_off));
  for (std::size_t i = 0; i + 1 < errors.size(); ++i)
    CHECK((errors[i + 1] < errors[i] / 2 || errors[i + 1] < round_off));
}

std::vector<Point> random_points(int n, unsigned seed)
{
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> coordinate(-1, 1);
  std::vector<Point> points;
  points.reserve(static_cast<std::size_t>(n));
  for (int i = 0; i < n; ++i)
    points.push_back({i + 0.3 * coordinate(random), coordinate(random), coordinate(random)});
  return points;
}

const Curve_method methods[] = {Curve_method::cubic_spline, Curve_method::local};

} // namespace

TEST_CASE("Curve_spline: the cubic spline converges at rate 4 up to the ends")
{
  for (const Exact_curve& curve : exact_curves)
    require_rate(curve, {.method = Curve_method::cubic_spline}, 4);
}

TEST_CASE("Curve_spline: the local fit converges at rate degree + 1 up to the ends")
{
  for (const Exact_curve& curve : exact_curves)
    for (const int degree : {3, 4, 5, 6})
      require_rate(curve, {.method = Curve_method::local, .degree = degree}, degree + 1);
}

TEST_CASE("Curve_spline: the automatic choice keeps up with the degree")
{
  for (const Exact_curve& curve : exact_curves)
    for (const int degree : {2, 3, 4, 5, 6})
    {
      require_rate(curve, {.degree = degree}, degree + 1);
    }
}

TEST_CASE("Curve_spline: goes through its points exactly")
{
  const auto points = random_points(9, 5);
  for (const auto method : methods)
    for (const bool is_closed : {false, true})
    {
      const Curve_spline spline(points, is_closed, {.method = method, .degree = 5});
      REQUIRE(spline.number_of_segments() == (is_closed ? 9 : 8));
      for (Index i = 0; i < spline.number_of_segments(); ++i)
      {
        CHECK(spline(i, 0) == points[i]);
        CHECK(spline(i, 1) == points[(i + 1) % 9]);
      }
    }
}

TEST_CASE("Curve_spline: the cubic spline is twice continuously differentiable, not-a-knot at its ends")
{
  const unsigned seed = GENERATE(1u, 2u, 3u);
  CAPTURE(seed);
  const auto points = random_points(8, seed);
  for (const bool is_closed : {false, true})
  {
    const Curve_spline spline(points, is_closed, {.method = Curve_method::cubic_spline});
    const Index n = spline.number_of_segments();
    const auto chord = [&](Index i) { return distance(points[i], points[(i + 1) % 8]); };
    const auto slope = [&](Index i, double t, int k) { return spline.derivative(i, t)[k] / chord(i); };
    const auto bend = [&](Index i, double t, int k) { // exact: the slope is a parabola
      const double h = 0.25;
      const double inward = t == 0 ? 1 : -1;
      return inward * (-3 * slope(i, t, k) + 4 * slope(i, t + inward * h, k) - slope(i, t + 2 * inward * h, k)) /
             (2 * h * chord(i));
    };
    for (Index i = 0; i + 1 < n + (is_closed ? 1 : 0); ++i)
      for (int k = 0; k < 3; ++k)
      {
        CHECK(slope(i, 1, k) == Approx(slope((i + 1) % n, 0, k)).margin(1e-9));
        CHECK(bend(i, 1, k) == Approx(bend((i + 1) % n, 0, k)).margin(1e-9));
      }
    if (!is_closed)
      for (int k = 0; k < 3; ++k)
      {
        const auto third = [&](Index i) { return (bend(i, 1, k) - bend(i, 0, k)) / chord(i); };
        CHECK(third(0) == Approx(third(1)).margin(1e-9));
        CHECK(third(n - 1) == Approx(third(n - 2)).margin(1e-9));
      }
  }
}

TEST_CASE("Curve_spline: the derivative is that of the position")
{
  const auto points = random_points(8, 9);
  for (const auto method : methods)
  {
    const Curve_spline spline(points, false, {.method = method, .degree = 5});
    for (Index i = 0; i < 7; ++i)
      for (const double t : {0.2, 0.5, 0.9})
      {
        const double h = 1e-6;
        const Point before = spline(i, t - h), after = spline(i, t + h), d = spline.derivative(i, t);
        for (int k = 0; k < 3; ++k)
          CHECK(d[k] == Approx((after[k] - before[k]) / (2 * h)).margin(1e-7));
      }
  }
}

TEST_CASE("Curve_spline: two points give a line, three a parabola")
{
  const std::vector<Point> two = {{0, 0, 0}, {2, 1, 0}};
  const std::vector<Point> three = {{0, 0, 0}, {1, 1, 0}, {2, 0, 0}};
  for (const auto method : methods)
  {
    CHECK(Curve_spline(two, false, {.method = method})(0, 0.5) == Point{1, 0.5, 0});
    const Curve_spline parabola(three, false, {.method = method, .degree = 1});
    if (method == Curve_method::cubic_spline) // by chord length, here equal: y = x (2 - x)
      for (const double t : {0.25, 0.5})
      {
        CHECK(parabola(0, t)[0] == Approx(t));
        CHECK(parabola(0, t)[1] == Approx(t * (2 - t)));
        CHECK(parabola(1, t)[1] == Approx((1 + t) * (1 - t)));
      }
  }
}

TEST_CASE("Curve_spline: points on a line give the line, constant coordinates stay to the bit")
{
  std::mt19937 random(3);
  std::uniform_real_distribution<double> step(0.1, 1);
  const double third = 1. / 3;
  std::vector<Point> line, flat;
  double x = 0.1;
  for (int i = 0; i < 12; ++i, x += step(random))
  {
    line.push_back({x, third, 2 * x + 7});
    flat.push_back({std::cos(x), third, std::sin(x)});
  }
  for (const auto method : methods)
    for (const int degree : {2, 4, 6})
    {
      const Curve_spline straight(line, false, {.method = method, .degree = degree});
      const Curve_spline bent(flat, false, {.method = method, .degree = degree});
      for (Index i = 0; i < 11; ++i)
        for (const double t : {0.25, 0.5, 0.7})
        {
          CHECK(bent(i, t)[1] == third);
          CHECK(straight(i, t)[1] == third);
          for (const int k : {0, 2})
          {
            const double a = line[i][k], b = line[i + 1][k];
            CHECK(straight(i, t)[k] == (t <= 0.5 ? a + t * (b - a) : b - (1 - t) * (b - a)));
          }
        }
    }
}

TEST_CASE("Curve_spline: the opposite direction gives the same curve")
{
  const auto points = random_points(9, 21);
  const std::vector<Point> reversed(points.rbegin(), points.rend());
  for (const auto method : methods)
  {
    const Curve_spline one(points, false, {.method = method, .degree = 5});
    const Curve_spline other(reversed, false, {.method = method, .degree = 5});
    for (Index i = 0; i < 8; ++i)
      for (const double t : {0.25, 0.5})
        CHECK(distance(one(i, t), other(7 - i, 1 - t)) < 1e-12);
  }
}

TEST_CASE("Curve_spline: nothing depends on position and unit")
{
  for (const auto method : methods)
    for (const double scale : {1e-6, 1e6})
    {
      const auto points = random_points(9, 4);
      auto moved = points;
      for (Point& p : moved)
        for (double& c : p)
          c *= scale;
      const Curve_spline one(points, true, {.method = method, .degree = 5});
      const Curve_spline other(moved, true, {.method = method, .degree = 5});
      for (Index i = 0; i < 9; ++i)
        for (int k = 0; k < 3; ++k)
          CHECK(other(i, 0.3)[k] / scale == Approx(one(i, 0.3)[k]).margin(1e-12));
    }
}

TEST_CASE("Curve_spline: equal fractions are equal arc lengths, nearly")
{
  for (const Exact_curve& curve : exact_curves)
  {
    const auto unevenness = [&](int n) {
      const Curve_spline spline = fit(curve, n, {.degree = 6});
      double most = 0;
      for (Index i = 0; i < n; ++i)
        for (const double t : {0., 0.25, 0.5, 1.})
        {
          const Point d = spline.derivative(i, t);
          most = std::max(most, std::abs(std::hypot(d[0], d[1], d[2]) / spline.length(i) - 1));
        }
      return most;
    };
    CAPTURE(curve.name, unevenness(64), unevenness(128));
    CHECK(unevenness(64) < 1e-4);
    CHECK(unevenness(128) < unevenness(64) / 32);
  }
}

TEST_CASE("Curve_spline: a bend too tight for its points stays near them")
{
  // two straight lines and one vertex between: no polynomial of high degree may swing out
  std::vector<Point> points;
  for (int i = -6; i <= 6; ++i)
    points.push_back({std::abs(i) * 1., i * 1., 0});
  for (const int degree : {4, 5, 6})
  {
    const Curve_spline spline(points, false, {.degree = degree});
    for (Index i = 0; i < 12; ++i)
      for (const double t : {0.25, 0.5, 0.75})
      {
        const Point p = spline(i, t);
        CHECK(std::abs(std::abs(p[1]) - p[0]) < 0.4);
      }
  }
}

TEST_CASE("Curve_spline: repeated points, closed pairs and bad input")
{
  const std::vector<Point> repeated = {{0, 0, 0}, {1, 0, 0}, {1, 0, 0}, {2, 1, 0}, {2, 1, 0}};
  for (const auto method : methods)
    for (const bool is_closed : {false, true})
    {
      const Curve_spline spline(repeated, is_closed, {.method = method});
      CHECK(spline(1, 0.5) == Point{1, 0, 0});
      CHECK(spline(3, 0.3) == Point{2, 1, 0});
      for (Index i = 0; i < spline.number_of_segments(); ++i)
        for (const double c : spline(i, 0.4))
          CHECK(std::isfinite(c));
    }
  const std::vector<Point> pair = {{0, 0, 0}, {2, 0, 0}}, one = {{0, 0, 0}};
  CHECK(Curve_spline(pair, true)(1, 0.5) == Point{1, 0, 0});
  CHECK_THROWS_AS(Curve_spline(one, false), Input_error);
  CHECK_THROWS_AS(Curve_spline(pair, false, {.degree = 7}), Input_error);
  CHECK_THROWS_AS(Curve_spline(pair, false, {.degree = 0}), Input_error);
  const std::vector<Point> bad = {{0, 0, 0}, {2, std::numeric_limits<double>::quiet_NaN(), 0}};
  CHECK_THROWS_AS(Curve_spline(bad, false), Input_error);
}
