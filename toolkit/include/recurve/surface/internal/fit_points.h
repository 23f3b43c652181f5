#ifndef RECURVE_SURFACE_INTERNAL_FIT_POINTS_H
#define RECURVE_SURFACE_INTERNAL_FIT_POINTS_H

#include <recurve/surface/internal/surface_arrays.h>
#include <recurve/surface/internal/vector_3.h>
#include <recurve/surface/weighted_points.h>

#include <cstddef>
#include <span>
#include <vector>

namespace recurve::internal::surface {

/// The data of one fit after another; keeps its memory from fit to fit.
class Fit_points
{
public:
  /// forgets all points. \param most  that will be added at most.
  void start(std::size_t most)
  {
    size_ = 0;
    if (u_.size() < most)
      for (std::vector<double>* const values : {&u_, &v_, &height_, &weight_})
        values->resize(most);
    for (std::vector<double>* const values : {&slope_u_, &slope_v_, &by_u_, &by_v_, &slope_weight_})
      values->clear();
  }

  void add(double u, double v, double height, double weight)
  {
    u_[size_] = u;
    v_[size_] = v;
    height_[size_] = height;
    weight_[size_] = weight;
    ++size_;
  }

  void add_slope(double u, double v, double by_u, double by_v, double weight)
  {
    slope_u_.push_back(u);
    slope_v_.push_back(v);
    by_u_.push_back(by_u);
    by_v_.push_back(by_v);
    slope_weight_.push_back(weight);
  }

  std::size_t size() const { return size_; }

  Weighted_points view(bool is_through_origin) const
  {
    const auto used = [this](const std::vector<double>& values) {
      return std::span<const double>(values.data(), size_);
    };
    return {used(u_),      used(v_),          used(height_),
            used(weight_), is_through_origin, {slope_u_, slope_v_, by_u_, by_v_, slope_weight_}};
  }

private:
  std::size_t size_ = 0;
  std::vector<double> u_, v_, height_, weight_; ///< more may be there than are used
  std::vector<double> slope_u_, slope_v_, by_u_, by_v_, slope_weight_;
};

/// Where a feature curve ends within a surface, a stencil may hold both sides of one vertex: the point counts once,
/// with the normal that agrees better. \param vertices  ascending. \return whether entry `i` is the one that counts.
inline bool is_best_side(const Surface_arrays& surface, std::span<const Index> vertices, std::size_t i,
                         const Point& normal)
{
  const auto original = [&](std::size_t j) { return surface.original_vertices[vertices[j]]; };
  const auto cosine = [&](std::size_t j) { return dot(surface.normals[vertices[j]], normal); };
  for (std::size_t j = i; j-- > 0 && original(j) == original(i);)
    if (cosine(j) >= cosine(i))
      return false;
  for (std::size_t j = i + 1; j < vertices.size() && original(j) == original(i); ++j)
    if (cosine(j) > cosine(i))
      return false;
  return true;
}

} // namespace recurve::internal::surface

#endif
