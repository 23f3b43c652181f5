#ifndef RECURVE_SURFACE_INTERNAL_FIND_ROW_CIRCLES_H
#define RECURVE_SURFACE_INTERNAL_FIND_ROW_CIRCLES_H

#include <recurve/surface/row_circles.h>

#include <cmath>

namespace recurve::internal::surface {

/// Finds how the rows of faces bend at a vertex: the parabola t = a + b s^2 that fits its neighbours best.
class Row_finder
{
public:
  void add(double s, double t)
  {
    const double square = s * s;
    count_ += 1;
    s2_ += square;
    s4_ += square * square;
    t_ += t;
    t2_ += t * t;
    s2t_ += square * t;
  }

  /// \param ratio  unit of t over that of s.
  /// \return straight rows where the parabola does not explain most of what the neighbours differ in t: so it is for
  /// all faces that are not much longer than wide.
  Row_circles circles(double ratio) const
  {
    constexpr double unexplained = 0.25; // of the sum of squares: what remains is half as wide at most
    const double spread = count_ * s4_ - s2_ * s2_;
    if (!(spread > 0))
      return {};
    const double b = (count_ * s2t_ - s2_ * t_) / spread;
    const double a = (t_ - b * s2_) / count_;
    const double remaining = t2_ - a * t_ - b * s2t_;
    if (b == 0 || !(remaining < unexplained * t2_))
      return {};
    const double s_over_radius = -2 * b * ratio; // T t = - (S s)^2 / (2 r) in units S and T
    return {s_over_radius, ratio * s_over_radius};
  }

private:
  double count_ = 0, s2_ = 0, s4_ = 0, t_ = 0, t2_ = 0, s2t_ = 0;
};

} // namespace recurve::internal::surface

#endif
