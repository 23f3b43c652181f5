#ifndef RECURVE_TESTS_VOLUME_DEFORMATION_FIELDS_H
#define RECURVE_TESTS_VOLUME_DEFORMATION_FIELDS_H

#include <recurve/core/types.h>

#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <string>
#include <vector>

namespace recurve::tests {

inline double distance(const Point& a, const Point& b)
{
  return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
}

/// n points spread evenly over the unit sphere.
inline std::vector<Point> fibonacci_sphere(int n)
{
  std::vector<Point> points;
  for (int m = 0; m < n; ++m)
  {
    const double z = 1 - (2 * m + 1.0) / n, r = std::sqrt(1 - z * z);
    const double angle = m * std::numbers::pi * (3 - std::sqrt(5.0));
    points.push_back({r * std::cos(angle), r * std::sin(angle), z});
  }
  return points;
}

/// n random points off the unit sphere, their distances from it spread evenly on a logarithmic scale.
inline std::vector<Point> points_off_sphere(int n, unsigned seed, double nearest, double farthest)
{
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform(std::log(nearest), std::log(farthest));
  std::vector<Point> points;
  for (int m = 0; m < n; ++m)
  {
    const Point p = {normal(random), normal(random), normal(random)};
    const double factor = (1 + std::exp(uniform(random))) / std::hypot(p[0], p[1], p[2]);
    points.push_back({factor * p[0], factor * p[1], factor * p[2]});
  }
  return points;
}

/// n random points on the surface of the unit cube, in clumps: as scattered as a surface gets.
inline std::vector<Point> random_box(int n, unsigned seed)
{
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(0, 1);
  std::vector<Point> points;
  for (int m = 0; m < n; ++m)
  {
    const auto face = static_cast<std::size_t>(random() % 6);
    Point p = {std::pow(uniform(random), 3), uniform(random), uniform(random)};
    p[face / 2] = double(face % 2);
    points.push_back(p);
  }
  return points;
}

/// n^2 points on each face of the unit cube, on a grid: many coordinates are equal, and nodes on edges are there twice.
inline std::vector<Point> grid_box(int n)
{
  std::vector<Point> points;
  for (std::size_t face = 0; face < 6; ++face)
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i)
      {
        Point p;
        p[face / 2] = double(face % 2);
        p[(face / 2 + 1) % 3] = double(i) / (n - 1);
        p[(face / 2 + 2) % 3] = double(j) / (n - 1);
        points.push_back(p);
      }
  return points;
}

inline std::vector<Point> points_off_box(int n, unsigned seed)
{
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(0, 1), logarithm(-12, 0);
  std::vector<Point> points;
  for (int m = 0; m < n; ++m)
  {
    Point p = {uniform(random), uniform(random), uniform(random)};
    if (m % 2 == 0) // close to a face
      p[random() % 3] = std::exp(logarithm(random)) / 2;
    points.push_back(p);
  }
  return points;
}

/// A wall z = 0 with a symmetry plane y = 0 that cuts its boundary layer: columns of nodes whose spacing grows from
/// 1e-6 of the wall's.
inline std::vector<Point> layered_sources(int n)
{
  std::vector<Point> points;
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i)
      points.push_back({double(i), double(j), 0});
  for (int i = 0; i < n; ++i)
    for (double z = 1e-6, step = 1e-6; z < n; z += step, step *= 1.3)
      points.push_back({double(i), 0, z});
  return points;
}

inline std::vector<Point> layered_targets(int n, int count, unsigned seed)
{
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(0, n - 1), logarithm(std::log(1e-7), std::log(double(n)));
  std::vector<Point> points;
  for (int m = 0; m < count; ++m)
  {
    // columns above nodes of the wall and beside those of the symmetry plane
    const double x = m % 2 == 0 ? std::floor(uniform(random)) : uniform(random);
    const double y = m % 3 == 0 ? std::exp(logarithm(random)) : uniform(random);
    points.push_back({x, y, std::exp(logarithm(random))});
  }
  return points;
}

/// a field that varies slowly; displacements of length 1 at most.
inline std::vector<Point> smooth_field(const std::vector<Point>& points)
{
  std::vector<Point> field;
  for (const Point& p : points)
  {
    const double f = std::sin(2 * p[0]) * std::cos(p[1] + 3 * p[2]) / 2;
    field.push_back({f, 0.3 * f * f, std::cos(p[0] - p[2]) / 2});
  }
  return field;
}

/// the field of curving: zero at every other node (the corners), a sagitta at the others.
inline std::vector<Point> curving_field(const std::vector<Point>& points)
{
  std::vector<Point> field = smooth_field(points);
  for (std::size_t m = 0; m < field.size(); m += 2)
    field[m] = {0, 0, 0};
  return field;
}

inline std::vector<Point> random_field(const std::vector<Point>& points, unsigned seed)
{
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  std::vector<Point> field;
  for (std::size_t m = 0; m < points.size(); ++m)
    field.push_back({uniform(random), uniform(random), uniform(random)});
  return field;
}

/// most sources at rest, those of one corner displaced alike.
inline std::vector<Point> patch_field(const std::vector<Point>& points)
{
  std::vector<Point> field;
  field.reserve(points.size());
  for (const Point& p : points)
    field.push_back(p[0] > 0.8 && p[1] > 0 ? Point{0, -1, 0.5} : Point{0, 0, 0});
  return field;
}

enum class Field_kind
{
  smooth,
  curving,
  random,
  patch
};

inline std::vector<Point> field(Field_kind kind, const std::vector<Point>& points, unsigned seed)
{
  switch (kind)
  {
  case Field_kind::smooth: return smooth_field(points);
  case Field_kind::curving: return curving_field(points);
  case Field_kind::random: return random_field(points, seed);
  case Field_kind::patch: return patch_field(points);
  }
  return {};
}

struct Deformation_case
{
  std::string name;
  std::vector<Point> sources, targets;
  double length;
};

inline const std::vector<Deformation_case>& deformation_cases()
{
  static const std::vector<Deformation_case> cases = {
    {"sphere", fibonacci_sphere(24000), points_off_sphere(4000, 31, 1e-4, 2), 0.02},
    {"sphere, long L", fibonacci_sphere(24000), points_off_sphere(4000, 32, 1e-4, 2), 2},
    {"scattered box", random_box(24000, 33), points_off_box(4000, 34), 0.02},
    {"grid box", grid_box(64), points_off_box(4000, 35), 1.0 / 64},
    {"boundary layer", layered_sources(120), layered_targets(120, 4000, 36), 1}};
  return cases;
}

} // namespace recurve::tests

#endif
