#ifndef RECURVE_VOLUME_INTERNAL_FADE_BALLS_H
#define RECURVE_VOLUME_INTERNAL_FADE_BALLS_H

#include <recurve/core/types.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <map>
#include <set>
#include <span>
#include <vector>

namespace recurve::internal {

/// A ball in which displacements are scaled: by `factor` up to its radius, by 1 from twice the radius on, and smoothly
/// between.
struct Fade_ball
{
  Point center = {};
  double radius = 0;
  double factor = 1;

  double factor_at(const Point& p) const
  {
    const double distance = std::hypot(p[0] - center[0], p[1] - center[1], p[2] - center[2]);
    if (!(distance < 2 * radius))
      return 1;
    if (distance <= radius)
      return factor;
    const double t = distance / radius - 1;
    return factor + (1 - factor) * t * t * (3 - 2 * t);
  }
};

/// Many balls of any sizes, to be asked which factor they give to a point: the smallest. Balls of similar size share a
/// grid whose cells are wider than they are, so that each is listed in the cells of the corners of its box.
class Fade_balls
{
public:
  explicit Fade_balls(std::span<const Fade_ball> balls) : balls_(balls.begin(), balls.end())
  {
    for (std::size_t b = 0; b < balls_.size(); ++b)
      if (balls_[b].radius > 0)
      {
        const int size = std::ilogb(4 * balls_[b].radius) + 1;
        for (const Place& at : places(balls_[b], size))
          grids_[size][at].push_back(b);
      }
  }

  double factor_at(const Point& p) const
  {
    double factor = 1;
    for (const auto& [size, grid] : grids_)
      if (const auto found = grid.find(place(p, size)); found != grid.end())
        for (const std::size_t b : found->second)
          factor = std::min(factor, balls_[b].factor_at(p));
    return factor;
  }

private:
  using Place = std::array<double, 3>; ///< whole numbers; those of tiny cells far away exceed integers

  static Place place(const Point& p, int size)
  {
    return {std::floor(std::ldexp(p[0], -size)), std::floor(std::ldexp(p[1], -size)),
            std::floor(std::ldexp(p[2], -size))};
  }

  /// of the corners of the box about what the ball scales; each once.
  static std::set<Place> places(const Fade_ball& ball, int size)
  {
    std::set<Place> result;
    for (int corner = 0; corner < 8; ++corner)
    {
      Point p = ball.center;
      for (std::size_t d = 0; d < 3; ++d)
        p[d] += (corner >> d & 1) != 0 ? 2 * ball.radius : -2 * ball.radius;
      result.insert(place(p, size));
    }
    return result;
  }

  std::vector<Fade_ball> balls_;
  std::map<int, std::map<Place, std::vector<std::size_t>>> grids_; ///< by the power of two of the width
};

} // namespace recurve::internal

#endif
