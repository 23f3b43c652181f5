#include <recurve/surface/internal/face_normal.h>

#include <catch2/catch.hpp>

#include <cmath>
#include <random>

using namespace recurve;
using namespace recurve::internal::surface;

TEST_CASE("normals of slivers and collapsed quads are exact", "[face_normal]")
{
  // Far from the origin, in the plane z = x: a sliver 1e-11 high, all coordinates multiples of 2^-36.
  const double unit = std::ldexp(1.0, -36);
  const auto at = [&](double along, double across) -> Point {
    return {8 + along, 8 + across, 8 + along}; // sums are exact
  };
  const std::vector<Point> points = {at(0, 0), at(0.5, 0), at(0.25, unit), at(0.25, unit)};
  const std::vector<Index> triangle = {0, 1, 2}, collapsed = {0, 1, 2, 3}, line = {0, 1, 0, 1};
  const double h = std::sqrt(0.5);
  for (const auto& face : {triangle, collapsed})
  {
    const Point n = face_normal(face, points);
    CHECK(n[0] == Approx(-h).margin(1e-15));
    CHECK(n[1] == Approx(0).margin(1e-15));
    CHECK(n[2] == Approx(h).margin(1e-15));
  }
  CHECK(face_normal(line, points) == Point{0, 0, 0});
  CHECK(exact_newell_direction(line, points) == Point{0, 0, 0});
}

TEST_CASE("exact and floating normals agree where both are certain", "[face_normal]")
{
  const unsigned seed = 5;
  CAPTURE(seed);
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (int round = 0; round < 200; ++round)
  {
    std::vector<Point> points(4);
    for (Point& point : points)
      point = {uniform(random), uniform(random), uniform(random)};
    const std::vector<Index> face = {0, 1, 2, 3};
    const Point a = face_normal(face, points), b = normalized(exact_newell_direction(face, points));
    for (std::size_t i = 0; i < 3; ++i)
      CHECK(a[i] == Approx(b[i]).margin(1e-12));
  }
}
