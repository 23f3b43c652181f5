#include <recurve/surface/local_fit.h>

#include <catch2/catch.hpp>

#include <cmath>
#include <random>
#include <type_traits>

using namespace recurve;

static_assert(std::is_trivially_copyable_v<Local_fit>);

namespace {

constexpr std::uint32_t seed = 42;

/// a fit of random coefficients in a frame that is neither at the origin nor along the axes.
Local_fit random_fit(int degree, std::mt19937& random)
{
  std::uniform_real_distribution<double> uniform(-1, 1);
  Local_fit fit;
  fit.origin = {3, -2, 5};
  const double s = std::sqrt(0.5);
  fit.u = {s, s, 0};
  fit.v = {0, 0, 1};
  fit.n = {s, -s, 0};
  fit.scale = 0.25;
  fit.degree = degree;
  for (int m = 0; m < coefficient_count(degree); ++m)
    fit.coefficients[static_cast<std::size_t>(m)] = uniform(random);
  return fit;
}

/// the polynomial term by term, as its definition reads.
double height_by_terms(const Local_fit& fit, double u, double v)
{
  double sum = 0;
  for (int j = 0; j <= fit.degree; ++j)
    for (int k = 0; j + k <= fit.degree; ++k)
      sum += fit.coefficients[static_cast<std::size_t>(coefficient_number(j, k))] * std::pow(u / fit.scale, j) *
             std::pow(v / fit.scale, k);
  return fit.scale * sum;
}

} // namespace

TEST_CASE("coefficients are numbered by degree, then by the power of v", "[local_fit]")
{
  int expected = 0;
  for (int degree = 0; degree <= max_fit_degree; ++degree)
  {
    for (int k = 0; k <= degree; ++k)
      CHECK(coefficient_number(degree - k, k) == expected++);
    CHECK(coefficient_count(degree) == expected);
  }
  CHECK(expected == static_cast<int>(Local_fit().coefficients.size()));
}

TEST_CASE("a fit evaluates its polynomial", "[local_fit]")
{
  std::mt19937 random(seed);
  const int degree = GENERATE(1, 2, 3, 4, 5, 6);
  CAPTURE(degree, seed);
  const Local_fit fit = random_fit(degree, random);
  for (const auto& [u, v] : {std::pair{0.0, 0.0}, {0.1, -0.2}, {-0.3, 0.25}})
  {
    CHECK(fit.height(u, v) == Approx(height_by_terms(fit, u, v)).epsilon(1e-13));
    const Point local = fit.local_coordinates(fit.point(u, v));
    CHECK(local[0] == Approx(u).margin(1e-14));
    CHECK(local[1] == Approx(v).margin(1e-14));
    CHECK(local[2] == Approx(fit.height(u, v)).margin(1e-14));
  }
}

TEST_CASE("the normal of a fit is normal to finite differences", "[local_fit]")
{
  std::mt19937 random(seed);
  const int degree = GENERATE(1, 2, 3, 4, 5, 6);
  CAPTURE(degree, seed);
  const Local_fit fit = random_fit(degree, random);
  const double u = 0.07, v = -0.05, step = 1e-6;
  const Point normal = fit.normal(u, v);
  double along_u = 0, along_v = 0, square = 0, along_n = 0;
  for (int i = 0; i < 3; ++i)
  {
    along_u += normal[i] * (fit.point(u + step, v)[i] - fit.point(u - step, v)[i]) / (2 * step);
    along_v += normal[i] * (fit.point(u, v + step)[i] - fit.point(u, v - step)[i]) / (2 * step);
    square += normal[i] * normal[i];
    along_n += normal[i] * fit.n[i];
  }
  CHECK(along_u == Approx(0).margin(1e-8));
  CHECK(along_v == Approx(0).margin(1e-8));
  CHECK(square == Approx(1).epsilon(1e-14));
  CHECK(along_n > 0);
}

TEST_CASE("a displacement ends on the surface and runs along the normal of the frame", "[local_fit]")
{
  std::mt19937 random(seed);
  const Local_fit fit = random_fit(4, random);
  const Point x = {3.05, -1.9, 5.1};
  const Point way = fit.displacement(x);
  const Point there = fit.local_coordinates({x[0] + way[0], x[1] + way[1], x[2] + way[2]});
  const Point here = fit.local_coordinates(x);
  CHECK(there[0] == Approx(here[0]).margin(1e-14));
  CHECK(there[1] == Approx(here[1]).margin(1e-14));
  CHECK(there[2] == Approx(fit.height(here[0], here[1])).margin(1e-14));
}

TEST_CASE("a flat fit displaces nothing", "[local_fit]")
{
  CHECK(Local_fit().is_flat());
  CHECK(Local_fit().displacement({1, 2, 3}) == Point{0, 0, 0});
}
