#ifndef RECURVE_TESTS_SURFACE_TEST_SURFACES_H
#define RECURVE_TESTS_SURFACE_TEST_SURFACES_H

#include <recurve/core/types.h>

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Surface_mesh.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <map>
#include <numbers>
#include <random>
#include <utility>
#include <vector>

/// Meshes of surfaces that are known exactly, for tests.
namespace test_surfaces {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point_3 = Kernel::Point_3;
using Mesh = CGAL::Surface_mesh<Point_3>;
using recurve::Index;
using recurve::Point;

/// Points and the corners of each face (three or four, outward); what every mesh class is built from.
struct Polygons
{
  std::vector<Point> points;
  std::vector<std::vector<int>> faces;
};

template <class Graph = Mesh>
Graph make_mesh(const Polygons& polygons)
{
  Graph mesh;
  std::vector<typename Graph::Vertex_index> vertices;
  for (const Point& x : polygons.points)
    vertices.push_back(mesh.add_vertex(Point_3(x[0], x[1], x[2])));
  for (const auto& face : polygons.faces)
  {
    std::vector<typename Graph::Vertex_index> corners;
    corners.reserve(face.size());
    for (const int corner : face)
      corners.push_back(vertices[static_cast<std::size_t>(corner)]);
    mesh.add_face(corners);
  }
  return mesh;
}

inline Point to_point(const Point_3& p)
{
  return {p.x(), p.y(), p.z()};
}

inline double norm(const Point& x)
{
  return std::hypot(x[0], x[1], x[2]);
}

inline Point on_unit_sphere(const Point& x)
{
  const double r = norm(x);
  return {x[0] / r, x[1] / r, x[2] / r};
}

/// an octant-free sphere of 20 * 4^level triangles: the icosahedron, edges halved and put back `level` times.
inline Polygons icosphere(int level)
{
  const double g = std::numbers::phi;
  Polygons sphere;
  for (const Point& x :
       {Point{-1, g, 0}, Point{1, g, 0}, Point{-1, -g, 0}, Point{1, -g, 0}, Point{0, -1, g}, Point{0, 1, g},
        Point{0, -1, -g}, Point{0, 1, -g}, Point{g, 0, -1}, Point{g, 0, 1}, Point{-g, 0, -1}, Point{-g, 0, 1}})
    sphere.points.push_back(on_unit_sphere(x));
  sphere.faces = {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                  {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
                  {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
  for (int i = 0; i < level; ++i)
  {
    std::map<std::pair<int, int>, int> middles;
    const auto middle = [&](int a, int b) {
      const auto [place, is_new] = middles.try_emplace(std::minmax(a, b), static_cast<int>(sphere.points.size()));
      if (is_new)
      {
        const Point x = sphere.points[static_cast<std::size_t>(a)];
        const Point y = sphere.points[static_cast<std::size_t>(b)];
        sphere.points.push_back(on_unit_sphere({x[0] + y[0], x[1] + y[1], x[2] + y[2]}));
      }
      return place->second;
    };
    std::vector<std::vector<int>> finer;
    for (const auto& f : sphere.faces)
    {
      const int a = middle(f[0], f[1]), b = middle(f[1], f[2]), c = middle(f[2], f[0]);
      finer.insert(finer.end(), {{f[0], a, c}, {f[1], b, a}, {f[2], c, b}, {a, b, c}});
    }
    sphere.faces = std::move(finer);
  }
  return sphere;
}

/// a sphere of 6 n^2 quads: the cube with equal angles along its edges.
inline Polygons cubed_sphere(int n)
{
  Polygons sphere;
  std::map<std::array<int, 3>, int> numbers; // lattice points on the cube [0, n]^3
  const auto vertex = [&](const std::array<int, 3>& lattice) {
    const auto [place, is_new] = numbers.try_emplace(lattice, static_cast<int>(sphere.points.size()));
    if (is_new)
    {
      Point x = {};
      for (int i = 0; i < 3; ++i)
        x[i] = std::tan((2.0 * lattice[i] / n - 1) * std::numbers::pi / 4);
      sphere.points.push_back(on_unit_sphere(x));
    }
    return place->second;
  };
  for (int axis = 0; axis < 3; ++axis)
    for (const int side : {0, n})
      for (int j = 0; j < n; ++j)
        for (int i = 0; i < n; ++i)
        {
          const auto at = [&](int a, int b) {
            std::array<int, 3> lattice = {};
            lattice[axis] = side;
            lattice[(axis + 1) % 3] = a;
            lattice[(axis + 2) % 3] = b;
            return vertex(lattice);
          };
          std::vector<int> face = {at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)};
          if (side == 0)
            std::reverse(face.begin(), face.end());
          sphere.faces.push_back(face);
        }
  return sphere;
}

/// the quads of a lattice of m times n, whose point (i, j) has the number `at(i, j)`.
inline std::vector<std::vector<int>> lattice_faces(int m, int n, const std::function<int(int, int)>& at)
{
  std::vector<std::vector<int>> faces;
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < m; ++i)
      faces.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)});
  return faces;
}

/// a torus of m times n quads around z and around its tube; each angle is moved by at most `jitter` of the spacing.
inline Polygons grid_torus(int m, int n, double ring_radius, double tube_radius, double jitter, std::uint32_t seed)
{
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-jitter, jitter);
  Polygons torus;
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < m; ++i)
    {
      const double a = 2 * std::numbers::pi * (i + uniform(random)) / m;
      const double b = 2 * std::numbers::pi * (j + uniform(random)) / n;
      const double r = ring_radius + tube_radius * std::cos(b);
      torus.points.push_back({r * std::cos(a), r * std::sin(a), tube_radius * std::sin(b)});
    }
  torus.faces = lattice_faces(m, n, [=](int i, int j) { return i % m + (j % n) * m; });
  return torus;
}

/// splits every quad along a diagonal, which alternates.
inline Polygons split_quads(const Polygons& quads)
{
  Polygons triangles{quads.points, {}};
  bool is_first = true;
  for (const auto& f : quads.faces)
  {
    if (is_first)
      triangles.faces.insert(triangles.faces.end(), {{f[0], f[1], f[2]}, {f[0], f[2], f[3]}});
    else
      triangles.faces.insert(triangles.faces.end(), {{f[0], f[1], f[3]}, {f[1], f[2], f[3]}});
    is_first = !is_first;
  }
  return triangles;
}

/// moves every point of a unit sphere by a random vector of [-amplitude, amplitude]^3 and puts it back.
inline void perturb_sphere(Polygons& sphere, double amplitude, std::uint32_t seed)
{
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-amplitude, amplitude);
  for (Point& x : sphere.points)
  {
    const Point way = {uniform(random), uniform(random), uniform(random)};
    x = on_unit_sphere({x[0] + way[0], x[1] + way[1], x[2] + way[2]});
  }
}

/// a plane grid of m times n quads over [0, width] x [0, depth], z = height(x, y).
inline Polygons grid(int m, int n, double width, double depth, const std::function<double(double, double)>& height)
{
  Polygons result;
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= m; ++i)
    {
      const double x = width * i / m, y = depth * j / n;
      result.points.push_back({x, y, height(x, y)});
    }
  result.faces = lattice_faces(m, n, [=](int i, int j) { return i + j * (m + 1); });
  return result;
}

/// m times n quads over [0, 1]^2, mapped by `surface`; the first coordinate may be periodic.
inline Polygons mapped_grid(int m, int n, bool is_periodic, const std::function<Point(double, double)>& surface)
{
  Polygons result;
  const int columns = is_periodic ? m : m + 1;
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i < columns; ++i)
      result.points.push_back(surface(static_cast<double>(i) / m, static_cast<double>(j) / n));
  result.faces = lattice_faces(m, n, [=](int i, int j) { return (is_periodic ? i % m : i) + j * columns; });
  return result;
}

/// a point of the cylinder of radius 1 around z.
inline Point on_cylinder(double turn, double z)
{
  const double a = 2 * std::numbers::pi * turn;
  return {std::cos(a), std::sin(a), z};
}

inline double distance_to_sphere(const Point& x)
{
  return std::abs(norm(x) - 1);
}

inline double distance_to_cylinder(const Point& x)
{
  return std::abs(std::hypot(x[0], x[1]) - 1);
}

inline double distance_to_torus(const Point& x, double ring_radius, double tube_radius)
{
  return std::abs(std::hypot(std::hypot(x[0], x[1]) - ring_radius, x[2]) - tube_radius);
}

/// distance to the ellipsoid of half-axes `axes`: the foot point is axes_i^2 x_i / (t + axes_i^2) at the largest root
/// t.
inline double distance_to_ellipsoid(const Point& x, const Point& axes)
{
  double t = 0; // points are near the surface, and t = 0 on it
  for (int round = 0; round < 60; ++round)
  {
    double f = -1, slope = 0;
    for (int i = 0; i < 3; ++i)
    {
      const double a = axes[i] * axes[i];
      const double q = axes[i] * x[i] / (t + a);
      f += q * q;
      slope -= 2 * q * q / (t + a);
    }
    const double step = f / slope;
    t -= step;
    if (std::abs(step) < 1e-17)
      break;
  }
  Point way = {};
  for (int i = 0; i < 3; ++i)
    way[i] = t * x[i] / (t + axes[i] * axes[i]);
  return norm(way);
}

} // namespace test_surfaces

#endif
