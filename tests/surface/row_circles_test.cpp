#include <recurve/surface/row_circles.h>
#include <recurve/surface/vertex_fit.h>

#include <catch2/catch.hpp>

#include <array>
#include <cmath>

using namespace recurve;

TEST_CASE("coordinates along and across circles", "[fit_vertices]")
{
  constexpr double step = 1e-6;
  for (const double radius : {-0.7, 0.5, 3.0, 1e6})
    for (const double unit : {1.0, 0.01}) // of t; that of s is 1
    {
      const Row_circles rows = {1 / radius, unit / radius};
      CAPTURE(radius, unit);
      for (const double along : {-0.4, 0.0, 0.3})
        for (const double out : {-0.1, 0.2})
        {
          // a point of the circle of radius `radius` + `out`
          const double a = along / radius, r = radius + out;
          const double s = r * std::sin(a), t = (out - r * 2 * std::pow(std::sin(a / 2), 2)) / unit;
          REQUIRE(rows.is_on_near_side(t));
          CHECK(rows.place(s, t).along == Approx(along).margin(1e-14));
          CHECK(rows.place(s, t).across == Approx(out / unit).epsilon(1e-9));
          const Row_circles::Slopes slopes = rows.slopes(s, t);
          const auto slope = [&](double ds, double dt, auto coordinate) {
            return (rows.place(s + ds, t + dt).*coordinate - rows.place(s - ds, t - dt).*coordinate) / (2 * step);
          };
          CHECK(slopes.along_by_s == Approx(slope(step, 0, &Row_circles::Place::along)).margin(1e-7));
          CHECK(slopes.along_by_t == Approx(slope(0, step, &Row_circles::Place::along)).margin(1e-7));
          CHECK(slopes.across_by_s == Approx(slope(step, 0, &Row_circles::Place::across)).margin(1e-7));
          CHECK(slopes.across_by_t == Approx(slope(0, step, &Row_circles::Place::across)).margin(1e-7));
        }
    }
  CHECK(Row_circles().place(2, 3).along == 2);
  CHECK(Row_circles().place(2, 3).across == 3);
}

TEST_CASE("curvatures of a fit over circles are those of its heights", "[fit_vertices]")
{
  const std::array<double, 6> coefficients = {0, 0.4, -0.7, 0.3, 0.2, -0.5};
  const Vertex_fit fit = {.s_axis = {2, 0, 0},
                          .t_axis = {0, 5, 0},
                          .rows = {0.6, 0.24},
                          .size = 0.3,
                          .degree = 2,
                          .state = Vertex_fit_state::curved,
                          .coefficients = coefficients};
  const auto z = [&](double x, double y) { return fit.height(2 * x, 5 * y); };
  constexpr double step = 1e-4;
  const double p = (z(step, 0) - z(-step, 0)) / (2 * step), q = (z(0, step) - z(0, -step)) / (2 * step);
  const double r = (z(step, 0) + z(-step, 0)) / (step * step), t = (z(0, step) + z(0, -step)) / (step * step);
  const double m = (z(step, step) - z(step, -step) - z(-step, step) + z(-step, -step)) / (4 * step * step);
  const double stretch = 1 + p * p + q * q;
  const auto [largest, smallest] = fit.principal_curvatures();
  CHECK(largest * smallest == Approx((r * t - m * m) / (stretch * stretch)).epsilon(1e-5));
  CHECK(0.5 * (largest + smallest) ==
        Approx(-((1 + q * q) * r - 2 * p * q * m + (1 + p * p) * t) / (2 * std::pow(stretch, 1.5))).epsilon(1e-5));
}
