#include <recurve/surface/row_circles.h>
#include <recurve/surface/vertex_fit.h>

#include <catch2/catch.hpp>

#include <array>
#include <cmath>
#include <cstddef>

using namespace recurve;

namespace {

double dot(const Point& a, const Point& b)
{
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/// the rotation about a unit axis by Rodrigues' formula.
Point rotated(const Point& x, const Point& axis, double angle)
{
  const Point across = {axis[1] * x[2] - axis[2] * x[1], axis[2] * x[0] - axis[0] * x[2],
                        axis[0] * x[1] - axis[1] * x[0]};
  Point result = {};
  for (std::size_t i = 0; i < 3; ++i)
    result[i] = std::cos(angle) * x[i] + std::sin(angle) * across[i] + (1 - std::cos(angle)) * dot(axis, x) * axis[i];
  return result;
}

void check_close(const Point& found, const Point& expected, double margin)
{
  for (std::size_t i = 0; i < 3; ++i)
    CHECK(found[i] == Approx(expected[i]).epsilon(0).margin(margin));
}

} // namespace

TEST_CASE("places along and across circles are turned back about their axis", "[fit_vertices]")
{
  constexpr double step = 1e-6, s_unit = 0.8;
  for (const Point& bend : {Point{0, 0.5, 0}, Point{0, -1.5, 0}, Point{0, 0.4, -0.7}, Point{0, -0.3, -0.2}})
    for (const double t_unit : {1.0, 0.01})
    {
      const Row_circles rows = {bend[1], bend[2], s_unit, t_unit};
      CAPTURE(bend, t_unit);
      const double square = dot(bend, bend), radius = 1 / std::sqrt(square);
      const Point center = {0, bend[1] / square, bend[2] / square};
      const Point axis = {0, -bend[2] * radius, bend[1] * radius}; // turns the vertex towards s > 0
      const auto local = [&](const Point& x) { return Point{x[0] / s_unit, x[1] / t_unit, x[2]}; };
      for (const double along : {-0.5, 0.0, 0.4})
        for (const Point& place : {Point{along, 0.1, -0.2}, Point{along, -0.2, 0.1}, Point{along, 0, 0}})
        {
          const double angle = along / radius;
          Point x = rotated({0, place[1] - center[1], place[2] - center[2]}, axis, angle);
          x = {x[0], x[1] + center[1], x[2] + center[2]};
          REQUIRE(rows.is_on_near_side(local(x)));
          check_close(rows.place(local(x)), local(place), 1e-13 / t_unit);
          const Row_circles::Turn turn = rows.turn(local(x));
          for (const Point& way : {Point{1, 0, 0}, Point{0, 1, 0}, Point{0, 0, 1}})
          {
            check_close(rows.turned_back(turn, local(rotated(way, axis, angle))), local(way), 1e-13 / t_unit);
            const Point u = local(way);
            const auto moved = [&](double by) {
              const Point at = local(x);
              return rows.place({at[0] + by * u[0], at[1] + by * u[1], at[2] + by * u[2]});
            };
            const Point after = moved(step), before = moved(-step);
            check_close(rows.change(local(x), u),
                        {(after[0] - before[0]) / (2 * step), (after[1] - before[1]) / (2 * step),
                         (after[2] - before[2]) / (2 * step)},
                        1e-8 / t_unit);
          }
        }
    }
  check_close(Row_circles().place({2, 3, 4}), {2, 3, 4}, 0);
}

TEST_CASE("heights, normals and curvatures of a fit over circles are those of its surface", "[fit_vertices]")
{
  const std::array<double, 6> coefficients = {0, 0.4, -0.7, 0.3, 0.2, -0.5};
  const Vertex_fit fit = {.s_axis = {2, 0, 0},
                          .t_axis = {0, 5, 0},
                          .rows = {1.2, -0.5, 0.5, 0.2},
                          .size = 0.3,
                          .degree = 2,
                          .state = Vertex_fit_state::curved,
                          .coefficients = coefficients};
  for (const Point& x : {Point{0.1, 0.05, 0}, Point{-0.2, 0.1, 0}})
  {
    const Point place = fit.row_coordinates({x[0], x[1], fit.height(2 * x[0], 5 * x[1])});
    CHECK(place[2] == Approx(fit.height_in_rows(place[0], place[1])).epsilon(1e-12));
  }
  const auto z = [&](double x, double y) { return fit.height(2 * x, 5 * y); };
  constexpr double step = 1e-4;
  const double p = (z(step, 0) - z(-step, 0)) / (2 * step), q = (z(0, step) - z(0, -step)) / (2 * step);
  const double r = (z(step, 0) + z(-step, 0)) / (step * step), t = (z(0, step) + z(0, -step)) / (step * step);
  const double m = (z(step, step) - z(step, -step) - z(-step, step) + z(-step, -step)) / (4 * step * step);
  const Vertex_fit::Height at = fit.height_and_slopes(0.2, 0.3);
  CHECK(at.by_s == Approx((z(0.1 + step, 0.06) - z(0.1 - step, 0.06)) / (4 * step)).epsilon(1e-6));
  CHECK(at.by_t == Approx((z(0.1, 0.06 + step) - z(0.1, 0.06 - step)) / (10 * step)).epsilon(1e-6));
  const Point normal = fit.normal(0, 0);
  CHECK(-normal[0] / normal[2] == Approx(p).epsilon(1e-6));
  CHECK(-normal[1] / normal[2] == Approx(q).epsilon(1e-6));
  const double stretch = 1 + p * p + q * q;
  const auto [largest, smallest] = fit.principal_curvatures();
  CHECK(largest * smallest == Approx((r * t - m * m) / (stretch * stretch)).epsilon(1e-5));
  CHECK(0.5 * (largest + smallest) ==
        Approx(-((1 + q * q) * r - 2 * p * q * m + (1 + p * p) * t) / (2 * std::pow(stretch, 1.5))).epsilon(1e-5));
}
