#ifndef RECURVE_SURFACE_ROW_CIRCLES_H
#define RECURVE_SURFACE_ROW_CIRCLES_H

#include <cmath>

namespace recurve {

/// Coordinates in the plane of a `Vertex_fit` for long faces that stand in rows which bend within the surface, such as
/// rings round a torus, a nacelle's lip or a pole: along circles and across them.
///
/// The rows near the vertex are taken for circles about one centre on the t-axis, the row through the vertex for that
/// of radius r about (0, -r). A function of the distance from the row, as the height of a torus is near its top, is
/// then one of one coordinate; over the straight ones s and t it is a bent valley much narrower than a face is long,
/// for which polynomials of low degree are no match.
struct Row_circles
{
  double s_over_radius = 0; ///< unit of s over r; negative where the centre is at t > 0; 0: rows are straight
  double t_over_radius = 0; ///< the same for the unit of t

  /// Coordinates along and across the circles, in the units of s and t: (0, 0) at the vertex, where they are s and t to
  /// first order.
  struct Place
  {
    double along = 0, across = 0;
  };

  /// Their derivatives by s and t.
  struct Slopes
  {
    double along_by_s = 1, along_by_t = 0, across_by_s = 0, across_by_t = 1;
  };

  bool are_straight() const { return s_over_radius == 0; }

  /// whether a point with this t is clearly on the vertex's side of the centre, where the circles have an end.
  bool is_on_near_side(double t) const { return 1 + t_over_radius * t > 0.1; }

  Place place(double s, double t) const
  {
    if (are_straight())
      return {s, t};
    const double x = s_over_radius * s, y = 1 + t_over_radius * t;
    const double less_one = x * x + t_over_radius * t * (1 + y); // of the square of the distance from the centre
    return {std::atan2(x, y) / s_over_radius, less_one / (t_over_radius * (1 + std::sqrt(x * x + y * y)))};
  }

  Slopes slopes(double s, double t) const
  {
    if (are_straight())
      return {};
    const double x = s_over_radius * s, y = 1 + t_over_radius * t;
    const double square = x * x + y * y, distance = std::sqrt(square);
    return {.along_by_s = y / square,
            .along_by_t = -s * t_over_radius / square,
            .across_by_s = x * s_over_radius / (t_over_radius * distance),
            .across_by_t = y / distance};
  }

  /// second derivatives at the vertex; the others are 0.
  double across_by_ss() const { return are_straight() ? 0 : s_over_radius * s_over_radius / t_over_radius; }
  double along_by_st() const { return -t_over_radius; }
};

} // namespace recurve

#endif
