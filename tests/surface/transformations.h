#ifndef RECURVE_TESTS_SURFACE_TRANSFORMATIONS_H
#define RECURVE_TESTS_SURFACE_TRANSFORMATIONS_H

#include "surface/test_surfaces.h"

#include <numeric>

/// What a surface must not care about: its place, its attitude, its unit, its numbering.
namespace test_surfaces {

using Rotation = std::array<Point, 3>; ///< rows

/// a rotation from a random unit quaternion.
inline Rotation random_rotation(std::uint32_t seed)
{
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  std::array<double, 4> q = {normal(random), normal(random), normal(random), normal(random)};
  const double size = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  for (double& x : q)
    x /= size;
  const auto [w, x, y, z] = q;
  return {Point{1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)},
          Point{2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)},
          Point{2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)}};
}

inline Point rotated(const Rotation& rotation, const Point& x)
{
  Point y = {};
  for (int i = 0; i < 3; ++i)
    y[i] = rotation[i][0] * x[0] + rotation[i][1] * x[1] + rotation[i][2] * x[2];
  return y;
}

inline Point scaled(double factor, const Point& x)
{
  return {factor * x[0], factor * x[1], factor * x[2]};
}

inline Point moved(const Point& x, const Point& way)
{
  return {x[0] + way[0], x[1] + way[1], x[2] + way[2]};
}

inline Point difference_of(const Point& a, const Point& b)
{
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}

/// The same faces under other numbers, each starting at another corner.
struct Renumbered
{
  Polygons polygons;
  std::vector<std::size_t> new_vertices;
  std::vector<std::size_t> new_faces;
};

inline std::vector<std::size_t> random_permutation(std::size_t size, std::mt19937& random)
{
  std::vector<std::size_t> permutation(size);
  std::iota(permutation.begin(), permutation.end(), std::size_t(0));
  std::shuffle(permutation.begin(), permutation.end(), random);
  return permutation;
}

inline Renumbered renumbered(const Polygons& polygons, std::uint32_t seed)
{
  std::mt19937 random(seed);
  Renumbered result;
  result.new_vertices = random_permutation(polygons.points.size(), random);
  result.new_faces = random_permutation(polygons.faces.size(), random);
  result.polygons.points.resize(polygons.points.size());
  result.polygons.faces.resize(polygons.faces.size());
  for (std::size_t v = 0; v < polygons.points.size(); ++v)
    result.polygons.points[result.new_vertices[v]] = polygons.points[v];
  for (std::size_t f = 0; f < polygons.faces.size(); ++f)
  {
    std::vector<int> face = polygons.faces[f];
    for (int& corner : face)
      corner = static_cast<int>(result.new_vertices[static_cast<std::size_t>(corner)]);
    std::rotate(face.begin(), face.begin() + static_cast<std::ptrdiff_t>(random() % face.size()), face.end());
    result.polygons.faces[result.new_faces[f]] = face;
  }
  return result;
}

} // namespace test_surfaces

#endif
