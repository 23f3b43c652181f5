#ifndef RECURVE_SURFACE_INTERNAL_BLENDED_FIT_H
#define RECURVE_SURFACE_INTERNAL_BLENDED_FIT_H

#include <recurve/surface/internal/vector_3.h>
#include <recurve/surface/vertex_fit.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>

namespace recurve::internal::surface {

/// The vertex fits at the ends of an edge or at the corners of a face, blended: the mean of the fits, each corrected
/// linearly (bilinearly) by its residuals at the other corners, weighted with the (bi)linear shape functions. It goes
/// through the corners. That of an edge depends on its two ends alone, so that faces meet; that of a face comes near it
/// as far as the fits agree.
class Blended_fit
{
public:
  Blended_fit() = default;

  /// \param fits  of two (edge), three or four corners; they must outlive this object.
  explicit Blended_fit(std::span<const Vertex_fit* const> fits) : count_(static_cast<int>(fits.size()))
  {
    bool is_planar = false;
    for (int i = 0; i < count_; ++i)
    {
      fits_[i] = fits[static_cast<std::size_t>(i)];
      is_flat_ = is_flat_ && fits_[i]->state != Vertex_fit_state::curved;
      is_planar = is_planar || fits_[i]->state == Vertex_fit_state::planar;
    }
    is_flat_ = is_flat_ || is_planar; // all faces at a planar vertex are in its plane
    if (is_flat_)
      return;
    for (int i = 0; i < count_; ++i)
      for (int j = 0; j < count_; ++j)
        if (i != j)
        {
          residuals_[i][j] = residual(*fits_[i], fits_[j]->origin);
          longest_side_ = std::max(longest_side_, length(subtract(fits_[j]->origin, fits_[i]->origin)));
        }
    weigh_stories();
  }

  bool is_flat() const { return is_flat_; }

  /// way from `x` to the surface. \param weights  values of the shape functions of the corners at x; their sum is 1.
  Point displacement(const Point& x, std::span<const double> weights) const
  {
    if (is_flat_)
      return {0, 0, 0};
    Point direction;
    if (!find_direction(weights, direction))
      return {0, 0, 0};
    double total = 0, sum = 0;
    for (int i = 0; i < count_; ++i)
      if (counts(i, weights))
      {
        const double weight = weights[static_cast<std::size_t>(i)];
        total += weight;
        sum += weight * belief_[static_cast<std::size_t>(i)] * corrected_way(i, x, direction, weights);
      }
    const bool is_sane = total > 0 && std::abs(sum) <= largest_way * total * longest_side_;
    return scaled(is_sane ? sum / total : 0, direction);
  }

private:
  static constexpr double largest_way = 0.5;     ///< in longest sides: the rise of a half circle
  static constexpr double least_direction = 0.1; ///< normals that nearly cancel say nothing
  static constexpr double harmless_part = 0.1;   ///< of the bend: fits that resolve the surface differ by less
  static constexpr double largest_ratio = 2;     ///< between displacements of fits that see the same surface
  static constexpr double certain_part = 0.25;   ///< of what the normals tell

  bool counts(int corner, std::span<const double> weights) const
  {
    return fits_[corner]->state != Vertex_fit_state::none && weights[static_cast<std::size_t>(corner)] > 0;
  }

  /// the mean of the normals. \return whether it says anything.
  bool find_direction(std::span<const double> weights, Point& direction) const
  {
    direction = {0, 0, 0};
    for (int i = 0; i < count_; ++i)
      direction = add(direction, scaled(weights[static_cast<std::size_t>(i)], direction_at(i)));
    const double norm = length(direction);
    if (!(norm > least_direction))
      return false;
    direction = scaled(1 / norm, direction);
    return true;
  }

  /// Where the fits tell different stories of the middle, by a good part of the bend, the least of them is believed:
  /// none displaces it more than `largest_ratio` times as far, and where they do not agree on the side the surface
  /// stays straight. (A fit that failed tells no story.) So a rounded edge does not bulge into the plane beside it.
  /// What is believed of a fit in the middle is believed of it everywhere, so that an edge stays smooth.
  void weigh_stories()
  {
    std::array<double, 4> weights = {}, ways = {};
    Point middle = {0, 0, 0};
    for (int i = 0; i < count_; ++i)
    {
      weights[static_cast<std::size_t>(i)] = 1.0 / count_;
      middle = add(middle, scaled(1.0 / count_, subtract(fits_[i]->origin, fits_[0]->origin)));
    }
    Point direction;
    if (!find_direction(weights, direction))
      return;
    double low = std::numeric_limits<double>::infinity(), high = -low, bend = 0;
    for (std::size_t i = 0; i < static_cast<std::size_t>(count_); ++i)
    {
      if (fits_[i]->state == Vertex_fit_state::none)
        continue;
      ways[i] = corrected_way(static_cast<int>(i), add(fits_[0]->origin, middle), direction, weights);
      if (fits_[i]->state == Vertex_fit_state::flat)
        continue;
      low = std::min(low, ways[i]);
      high = std::max(high, ways[i]);
      bend = std::max(bend, middle_bend(*fits_[i]));
    }
    if (high - low > harmless_part * bend)
    {
      const double most = low * high <= 0 ? 0 : largest_ratio * std::min(std::abs(low), std::abs(high));
      for (std::size_t i = 0; i < static_cast<std::size_t>(count_); ++i)
        limit(i, ways[i], most);
    }
    doubt_last_resorts(ways);
  }

  /// A parabola that is what is left after better fits have failed moves the middle no farther than the normals tell,
  /// and beside a corner where it has failed as well by what is certain of that: few points tell to which side such a
  /// surface bends. (Measured on coarse aerofoils and tori: believed more, faces at points of inflection are worse than
  /// straight ones; believed less, blunt noses stay straight.)
  void doubt_last_resorts(const std::array<double, 4>& ways)
  {
    const auto fits = std::span(fits_).first(static_cast<std::size_t>(count_));
    if (std::none_of(fits.begin(), fits.end(), [](auto fit) { return fit->is_last_resort; }))
      return;
    const bool has_failed =
      std::any_of(fits.begin(), fits.end(), [](auto fit) { return fit->state == Vertex_fit_state::flat; });
    const double likely = (has_failed ? certain_part : 1) * way_by_normals();
    for (std::size_t i = 0; i < fits.size(); ++i)
      if (fits[i]->is_last_resort)
        limit(i, ways[i], ways[i] * likely > 0 ? std::abs(likely) : 0);
  }

  /// has the displacement of the middle by a fit be `most` at most.
  void limit(std::size_t corner, double way, double most)
  {
    if (std::abs(way) > most)
      belief_[corner] = std::min(belief_[corner], most / std::abs(way));
  }

  /// how far the normals at the corners tell the middle to move: that of the quadratic surface whose sides are
  /// displaced as in estimated_displacement().
  double way_by_normals() const
  {
    double sum = 0; // of the sides
    for (int i = 0; i < count_; ++i)
    {
      const Vertex_fit &a = *fits_[i], &b = *fits_[(i + 1) % count_];
      sum += 0.125 * dot(subtract(b.vertex_normal, a.vertex_normal), subtract(b.origin, a.origin));
    }
    return sum * (count_ == 3 ? 4.0 / 9 : 0.5);
  }

  /// how far the terms of second degree, and bent rows, bend the middle of an edge to a neighbour.
  static double middle_bend(const Vertex_fit& fit)
  {
    const auto& c = fit.coefficients;
    double along = 0.5 * fit.rows.bend_off_plane * fit.rows.s_unit * fit.rows.s_unit;
    if (fit.degree < 2)
      return std::abs(along) / 4;
    along += fit.size * c[3];
    return (std::abs(along) + fit.size * (std::abs(c[4]) + std::abs(c[5]))) / 4;
  }

  Point direction_at(int corner) const { return fits_[corner]->vertex_normal; }

  /// from `x` to the surface of the fit of `corner`; 0 for a fit that is not curved.
  double way(int corner, const Point& x, const Point& direction) const
  {
    const Vertex_fit& fit = *fits_[corner];
    if (fit.state != Vertex_fit_state::curved)
      return 0;
    const double result = fit.way_along(x, direction);
    return std::isfinite(result) ? result : 0;
  }

  /// from `x` to the surface of a fit, along the fit's own normal: other corners may have normals that are far from it.
  static double residual(const Vertex_fit& fit, const Point& x)
  {
    if (fit.state != Vertex_fit_state::curved)
      return 0;
    const Point local = fit.local_coordinates(x);
    const double result = fit.height(local[0], local[1]) - local[2];
    return std::isfinite(result) ? result : 0;
  }

  double corrected_way(int corner, const Point& x, const Point& direction, std::span<const double> weights) const
  {
    double shift = 0;
    for (int j = 0; j < count_; ++j)
      shift += weights[static_cast<std::size_t>(j)] * residuals_[corner][j];
    return way(corner, add(x, scaled(shift, fits_[corner]->n)), direction);
  }

  int count_ = 0;
  bool is_flat_ = true;
  double longest_side_ = 0; ///< or diagonal
  std::array<const Vertex_fit*, 4> fits_ = {};
  std::array<double, 4> belief_ = {1, 1, 1, 1}; ///< in the displacements by each fit, 0 to 1
  std::array<std::array<double, 4>, 4> residuals_ =
    {}; ///< [i][j]: from corner j to the surface of fit i, along its normal
};

} // namespace recurve::internal::surface

#endif
