#include "surface/curved_surfaces.h"

#include <recurve/surface/fit_vertices.h>

#include <catch2/catch.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>
#include <string>
#include <vector>

using namespace recurve;
using namespace test_surfaces;

namespace {

/// A plane curve, from parameter `first` to `last`.
struct Plane_curve
{
  std::function<std::array<double, 2>(double)> at;
  double first = -1, last = 1;
};

/// An aerofoil of NACA's four-digit series with a closed trailing edge, which is at -1 (below) and 1; the nose is at 0,
/// and x = u^2. \param camber  in chords, at 0.4 of the chord.
Plane_curve naca(double thickness, double camber)
{
  return {[=](double u) {
    const double x = u * u;
    const double half =
      5 * thickness *
      (0.2969 * std::sqrt(x) - 0.126 * x - 0.3516 * x * x + 0.2843 * x * x * x - 0.1036 * x * x * x * x);
    const double mean = x < 0.4 ? camber / 0.16 * (0.8 * x - x * x) : camber / 0.36 * (0.2 + 0.8 * x - x * x);
    return std::array<double, 2>{x, mean + std::copysign(half, u)};
  }};
}

/// The image of a circle by x + 1/x: its trailing edge, at both ends, is a cusp.
Plane_curve joukowski()
{
  return {[](double turn) {
            constexpr double radius = 1.1, tilt = 0.05;
            const double x = 1 + radius * (std::cos(turn - tilt) - std::cos(tilt));
            const double y = radius * (std::sin(turn - tilt) + std::sin(tilt));
            const double square = x * x + y * y;
            return std::array<double, 2>{x + x / square, y - y / square};
          },
          0, 2 * std::numbers::pi};
}

/// from `x` to the cylinder over a curve, by search along the curve: the nearest of many points, then golden sections.
double distance_to_curve(const Plane_curve& curve, const Point& x)
{
  const auto square = [&](double u) {
    const auto p = curve.at(u);
    return (p[0] - x[0]) * (p[0] - x[0]) + (p[1] - x[1]) * (p[1] - x[1]);
  };
  const double step = (curve.last - curve.first) / 400;
  double best = curve.first;
  for (int i = 0; i <= 400; ++i)
    if (square(curve.first + i * step) < square(best))
      best = curve.first + i * step;
  double low = std::max(curve.first, best - step), high = std::min(curve.last, best + step);
  for (int i = 0; i < 60; ++i)
  {
    const double a = low + 0.381966 * (high - low), b = high - 0.381966 * (high - low);
    (square(a) < square(b) ? high : low) = square(a) < square(b) ? b : a;
  }
  return std::sqrt(square(0.5 * (low + high)));
}

std::vector<Shape> stretched_shapes()
{
  std::vector<Shape> shapes;
  for (const double ratio : {1.0, 1e3, 1e4})
    shapes.push_back({"cylinder, faces 1:" + std::to_string(static_cast<int>(ratio)),
                      mapped_grid(24, 8, true, [=](double a, double b) { return on_cylinder(a, 2 * ratio * b); }),
                      distance_to_cylinder});
  shapes.push_back({"cylinder, thin rings",
                    mapped_grid(24, 12, true, [](double a, double b) { return on_cylinder(a, 3e-3 * b); }),
                    distance_to_cylinder});
  shapes.push_back({"cylinder of six sides",
                    mapped_grid(6, 8, true, [](double a, double b) { return on_cylinder(a, 8 * b); }),
                    distance_to_cylinder});
  shapes.push_back({"cylinder, strip one face wide",
                    mapped_grid(24, 1, true, [](double a, double b) { return on_cylinder(a, 0.2 * b); }),
                    distance_to_cylinder});
  shapes.push_back(
    {"cylinder, doubling rings",
     mapped_grid(32, 14, true, [](double a, double b) { return on_cylinder(a, 1e-3 * std::pow(2, 14 * b)); }),
     distance_to_cylinder});
  shapes.push_back({"cone, doubling rings",
                    mapped_grid(24, 12, true,
                                [](double a, double b) {
                                  const double z = std::pow(2, 6 * b) / 16;
                                  const Point x = on_cylinder(a, z);
                                  return Point{0.5 * z * x[0], 0.5 * z * x[1], z};
                                }),
                    [](const Point& x) { return std::abs(std::hypot(x[0], x[1]) - 0.5 * x[2]) / std::sqrt(1.25); }});
  shapes.push_back({"sphere, rings crowded at the ends",
                    mapped_grid(32, 16, true,
                                [](double a, double b) {
                                  const double t = 1.4 * std::tanh(3 * (2 * b - 1)) / std::tanh(3.0);
                                  const Point x = on_cylinder(a, 0);
                                  return Point{std::cos(t) * x[0], std::cos(t) * x[1], std::sin(t)};
                                }),
                    distance_to_sphere});
  shapes.push_back({"sphere, wide rings between narrow ones",
                    mapped_grid(16, 6, true,
                                [](double a, double b) {
                                  const double t = 1.4 * std::tanh(4 * (2 * b - 1)) / std::tanh(4.0);
                                  const Point x = on_cylinder(a, 0);
                                  return Point{std::cos(t) * x[0], std::cos(t) * x[1], std::sin(t)};
                                }),
                    distance_to_sphere});
  shapes.push_back({"torus, faces 1:17", grid_torus(200, 12, 2, 0.8, 0, 1),
                    [](const Point& x) { return distance_to_torus(x, 2, 0.8); }});
  // Long faces in rows that bend: near the top the straight ones are right by accident along some circle.
  for (const int sides : {8, 10, 12, 14, 16, 20, 32})
    for (const int rings : {10, 24, 100})
      for (const double tube : {0.3, 0.8, 1.5})
        shapes.push_back({"torus of " + std::to_string(sides) + " times " + std::to_string(rings) + " sides, tube " +
                            std::to_string(tube),
                          grid_torus(sides, rings, 2, tube, 0, 1),
                          [=](const Point& x) { return distance_to_torus(x, 2, tube); }});
  const auto add_wing = [&](const std::string& name, const Plane_curve& curve, int chords,
                            const std::function<double(double)>& spacing) {
    const Distance distance = [curve](const Point& x) { return distance_to_curve(curve, x); };
    const auto surface = [&](double a, double b) {
      const auto x = curve.at(curve.first + (curve.last - curve.first) * spacing(a));
      return Point{x[0], x[1], b};
    };
    shapes.push_back(
      {name + " of " + std::to_string(chords) + " chords", mapped_grid(chords, 5, false, surface), distance});
  };
  const auto even = [](double a) { return a; };
  for (const int chords : {8, 10, 12, 16, 20, 32, 64})
    add_wing("NACA 0012", naca(0.12, 0), chords, even);
  add_wing("NACA 0012, crowded at the tail", naca(0.12, 0), 130, [](double a) {
    const double u = 2 * a - 1;
    return 0.5 + 0.5 * std::copysign(std::pow(std::abs(u), 0.7), u);
  });
  add_wing("NACA 0024", naca(0.24, 0), 14, even);
  add_wing("NACA 4412", naca(0.12, 0.04), 12, even);
  for (const int chords : {10, 12, 14, 16, 24})
    add_wing("Joukowski", joukowski(), chords, even);
  add_wing("Joukowski, crowded at the tail", joukowski(), 64,
           [](double a) { return a - 0.9 * std::sin(2 * std::numbers::pi * a) / (2 * std::numbers::pi); });
  return shapes;
}

} // namespace

TEST_CASE("long thin faces, graded faces and coarse noses are nowhere worse than straight ones", "[fit_vertices]")
{
  for (const Shape& shape : stretched_shapes())
    for (const bool is_split : {false, true})
    {
      const Mesh mesh = make_mesh(is_split ? split_quads(shape.mesh) : shape.mesh);
      const std::vector<double> straight = errors_of_faces(mesh, Surface_nodes<Mesh>(mesh, 3), shape.distance);
      const double largest_straight = *std::max_element(straight.begin(), straight.end());
      for (const int d : {2, 4, 6})
      {
        CAPTURE(shape.name, is_split, d);
        const std::vector<double> errors = errors_of_faces(mesh, curved(mesh, d, 3), shape.distance);
        int worse = 0;
        for (std::size_t f = 0; f < errors.size(); ++f)
          if (errors[f] > 1.15 * straight[f] && errors[f] > 1e-3 * largest_straight)
            ++worse;
        CHECK(worse == 0);
        CHECK(*std::max_element(errors.begin(), errors.end()) < largest_straight);
      }
    }
}

TEST_CASE("a few long faces round a surface of revolution are as good as many", "[fit_vertices]")
{
  // Turned about the axis, the meridian alone is to be found, and its points are close.
  constexpr double ring = 2, tube = 0.8;
  const auto distance = [](const Point& x) { return distance_to_torus(x, ring, tube); };
  for (const int sides : {8, 12, 24})
  {
    const Mesh mesh = make_mesh(grid_torus(sides, 100, ring, tube, 0, 1));
    const Vertex_fits<Mesh> fits = fitted(mesh, 4);
    const Surface_nodes<Mesh> nodes = curved(mesh, fits, 4);
    const double straight = largest_error(Surface_nodes<Mesh>(mesh, 4), distance);
    double largest = 0;
    int faces = 0;
    for (const auto f : mesh.faces())
    {
      bool has_rows = true;
      for (int corner = 0; corner < 4; ++corner)
        has_rows = has_rows && !fits.fit_at_corner(f, corner).rows.are_straight();
      if (!has_rows)
        continue;
      ++faces;
      for (int m = 0; m < nodes.face_node_count(f); ++m)
        largest = std::max(largest, distance(to_point(nodes.face_node(f, m))));
    }
    CAPTURE(sides, faces);
    CHECK(faces > 20 * sides);
    CHECK(largest < 1e-4 * straight);
  }
}

TEST_CASE("rows of long faces beside a rim are not bent by its jitter", "[fit_vertices]")
{
  // a half cylinder of faces that are eight times as long as wide, along its axis; its rims are two of its lines
  std::mt19937 random(3);
  std::uniform_real_distribution<double> jitter(-0.25, 0.25);
  constexpr int columns = 24, rows = 12;
  const auto surface = [&](double a, double b) {
    return on_cylinder(0.5 * (a + jitter(random) / columns), 4 * std::numbers::pi * b);
  };
  const Vertex_fits<Mesh> fits = fitted(make_mesh(mapped_grid(columns, rows, false, surface)), 4);
  for (const Vertex_fit& fit : fits.all())
    CHECK(fit.rows.are_straight());
}

TEST_CASE("normals as data where rows of long faces bend", "[fit_vertices]")
{
  constexpr double ring = 2, tube = 0.8;
  Mesh mesh = make_mesh(grid_torus(12, 32, ring, tube, 0, 1));
  const auto normals = mesh.add_property_map<Mesh::Vertex_index, Kernel::Vector_3>("v:normal").first;
  for (const auto v : mesh.vertices())
  {
    const Point x = to_point(mesh.point(v));
    const double r = std::hypot(x[0], x[1]), out = (r - ring) / r;
    normals[v] = Kernel::Vector_3(out * x[0], out * x[1], x[2]) / tube;
  }
  const auto with_normals = recurve::fit_vertices(mesh, {.degree = 2, .data = Vertex_fit_data::points_and_normals},
                                                  CGAL::parameters::vertex_normal_map(normals));
  int bent = 0;
  double largest = 0, largest_without = 0;
  const Vertex_fits<Mesh> without = fitted(mesh, 2);
  const auto off = [&](const Vertex_fit& fit) {
    const double r = std::hypot(fit.origin[0], fit.origin[1]), out = (r - ring) / r;
    const Point n = fit.normal(0, 0);
    return 1 - (n[0] * out * fit.origin[0] + n[1] * out * fit.origin[1] + n[2] * fit.origin[2]) / tube;
  };
  for (std::size_t v = 0; v < mesh.number_of_vertices(); ++v)
    if (!with_normals.all()[v].rows.are_straight())
    {
      ++bent;
      largest = std::max(largest, off(with_normals.all()[v]));
      largest_without = std::max(largest_without, off(without.all()[v]));
    }
  CHECK(bent > 0);
  CHECK(largest < largest_without / 4); // of half the square of an angle
}

TEST_CASE("curvatures where rows of long faces bend", "[fit_vertices]")
{
  constexpr double ring = 2, tube = 0.3;
  std::array<double, 2> errors = {};
  for (std::size_t i = 0; i < errors.size(); ++i)
  {
    const Mesh mesh = make_mesh(grid_torus(i == 0 ? 24 : 48, i == 0 ? 100 : 200, ring, tube, 0, 1));
    const Vertex_fits<Mesh> fits = fitted(mesh, 2);
    int bent = 0;
    for (const Vertex_fit& fit : fits.all())
    {
      bent += !fit.rows.are_straight();
      const double out = std::hypot(fit.origin[0], fit.origin[1]) - ring; // of the tube's centre
      const auto [largest, smallest] = fit.principal_curvatures();
      errors[i] = std::max({errors[i], std::abs(largest - 1 / tube), std::abs(smallest - out / tube / (ring + out))});
    }
    CHECK(bent > 0);
  }
  CAPTURE(errors[0], errors[1]);
  CHECK(errors[0] < 0.01 / tube);
  CHECK(errors[1] < errors[0] / 4); // the points have rate d + 1 = 3 at least, and four in practice: two less
}
