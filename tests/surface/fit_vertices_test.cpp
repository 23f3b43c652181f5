#include "surface/test_surfaces.h"
#include "surface/transformations.h"

#include <recurve/surface/curve_surface.h>
#include <recurve/surface/fit_vertices.h>

#include <catch2/catch.hpp>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

using namespace recurve;
using namespace test_surfaces;

namespace {

using Distance = std::function<double(const Point&)>;

/// all nodes of degree `degree` with the default fits.
Surface_nodes<Mesh> curved(const Mesh& mesh, int fit_degree, int degree, Reconstruction_report* report = nullptr)
{
  Surface_nodes<Mesh> nodes(mesh, degree);
  const Vertex_fits<Mesh> fits = fit_vertices(mesh, {.degree = fit_degree}, no_parameters, Compact_policies{}, report);
  curve_surface(mesh, fits.face_map(), std::vector<Feature_curve<Mesh>>{}, nodes.edge_map(), nodes.face_map(),
                {.degree = degree});
  return nodes;
}

double largest_error(const Surface_nodes<Mesh>& nodes, const Distance& distance)
{
  double largest = 0;
  for (const Point_3& x : nodes.edge_nodes())
    largest = std::max(largest, distance(to_point(x)));
  for (const Point_3& x : nodes.face_nodes())
    largest = std::max(largest, distance(to_point(x)));
  return largest;
}

/// the largest error of the nodes of each face.
std::vector<double> errors_of_faces(const Mesh& mesh, const Surface_nodes<Mesh>& nodes, const Distance& distance)
{
  std::vector<double> errors;
  for (const auto f : mesh.faces())
  {
    double largest = 0;
    for (const auto h : mesh.halfedges_around_face(mesh.halfedge(f)))
      for (int k = 1; k < nodes.degree(); ++k)
        largest = std::max(largest, distance(to_point(nodes.edge_node(h, k))));
    for (int m = 0; m < nodes.face_node_count(f); ++m)
      largest = std::max(largest, distance(to_point(nodes.face_node(f, m))));
    errors.push_back(largest);
  }
  return errors;
}

/// m times n quads (or triangles) over [0, 1]^2, mapped by `surface`; the first coordinate may be periodic.
Polygons mapped_grid(int m, int n, bool is_periodic, const std::function<Point(double, double)>& surface)
{
  Polygons result;
  const int columns = is_periodic ? m : m + 1;
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i < columns; ++i)
      result.points.push_back(surface(static_cast<double>(i) / m, static_cast<double>(j) / n));
  const auto at = [&](int i, int j) { return (is_periodic ? i % m : i) + j * columns; };
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < m; ++i)
      result.faces.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)});
  return result;
}

Point on_cylinder(double turn, double z)
{
  const double a = 2 * std::numbers::pi * turn;
  return {std::cos(a), std::sin(a), z};
}

double distance_to_cylinder(const Point& x)
{
  return std::abs(std::hypot(x[0], x[1]) - 1);
}

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

struct Shape
{
  std::string name;
  Polygons mesh;
  Distance distance;
};

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
  shapes.push_back({"torus, faces 1:17", grid_torus(200, 12, 2, 0.8, 0, 1),
                    [](const Point& x) { return distance_to_torus(x, 2, 0.8); }});
  // Long faces in rows that bend: near the top the straight ones are right by accident along some circle.
  for (const int sides : {14, 16, 20, 32})
    for (const double tube : {0.3, 0.8, 1.5})
      shapes.push_back({"torus of " + std::to_string(sides) + " times 100 sides, tube " + std::to_string(tube),
                        grid_torus(sides, 100, 2, tube, 0, 1),
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
  for (const int chords : {10, 12, 16, 20, 32, 64})
    add_wing("NACA 0012", naca(0.12, 0), chords, even);
  add_wing("NACA 0012, crowded at the tail", naca(0.12, 0), 130, [](double a) {
    const double u = 2 * a - 1;
    return 0.5 + 0.5 * std::copysign(std::pow(std::abs(u), 0.7), u);
  });
  add_wing("NACA 0024", naca(0.24, 0), 14, even);
  add_wing("NACA 4412", naca(0.12, 0.04), 12, even);
  add_wing("Joukowski", joukowski(), 24, even);
  add_wing("Joukowski, crowded at the tail", joukowski(), 64,
           [](double a) { return a - 0.9 * std::sin(2 * std::numbers::pi * a) / (2 * std::numbers::pi); });
  return shapes;
}

} // namespace

TEST_CASE("vertex fits reproduce polynomial surfaces", "[fit_vertices]")
{
  const int degree = GENERATE(1, 2, 3, 4, 5, 6);
  const auto height = [degree](double x, double y) {
    double sum = 0, factor = 0.2;
    for (int p = 1; p <= degree; ++p, factor *= 0.5)
      sum += factor * (std::pow(x, p) - 0.7 * std::pow(x, p - 1) * y + 0.4 * std::pow(y, p));
    return sum;
  };
  const Polygons quads = grid(14, 14, 1, 1, height);
  const Mesh mesh = make_mesh(GENERATE(true, false) ? quads : split_quads(quads));
  const Vertex_fits<Mesh> fits = fit_vertices(mesh, {.degree = degree});
  for (const auto f : mesh.faces())
  {
    const Vertex_fit& fit = fits.fit_at_corner(f, 0);
    REQUIRE(fit.state == (degree == 1 ? Vertex_fit_state::planar : Vertex_fit_state::curved));
    if (degree == 1)
      continue;
    // A height function over z is not a polynomial over the vertex's own plane: near the vertex it is.
    const double way = fit.way_along({fit.origin[0] + 0.01, fit.origin[1] + 0.01, 0}, {0, 0, 1});
    CHECK(std::abs(way - height(fit.origin[0] + 0.01, fit.origin[1] + 0.01)) < 3e-5 * std::pow(0.4, degree));
  }
}

TEST_CASE("planar surfaces stay to the bit, however they lie", "[fit_vertices]")
{
  Polygons plane = grid(9, 7, 1, 1, [](double, double) { return 0.0; });
  const double shift = GENERATE(0.0, 1e6);
  for (Point& x : plane.points)
    x = {0.6 * x[0] - 0.8 * x[1] + shift, 0.8 * 0.6 * x[0] + 0.36 * x[1] - 0.8 * 0.1,
         0.64 * x[0] + 0.48 * x[1] + shift};
  const Mesh mesh = make_mesh(split_quads(plane));
  Reconstruction_report report;
  const Surface_nodes<Mesh> nodes = curved(mesh, 4, 3, &report);
  const Surface_nodes<Mesh> straight(mesh, 3);
  CHECK(report.planar_faces == static_cast<Index>(mesh.number_of_faces()));
  CHECK(report.lowered_faces == 0);
  CHECK(std::equal(nodes.edge_nodes().begin(), nodes.edge_nodes().end(), straight.edge_nodes().begin()));
  CHECK(std::equal(nodes.face_nodes().begin(), nodes.face_nodes().end(), straight.face_nodes().begin()));
}

TEST_CASE("vertex fits do not depend on unit, place or threads", "[fit_vertices]")
{
  Polygons sphere = icosphere(3);
  perturb_sphere(sphere, 0.02, 3);
  const Surface_nodes<Mesh> expected = curved(make_mesh(sphere), 4, 4);
  const Mesh same = make_mesh(sphere);
  for (const std::size_t threads : {1U, 2U, 7U})
  {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    const Surface_nodes<Mesh> nodes = curved(same, 4, 4);
    CHECK(std::equal(nodes.edge_nodes().begin(), nodes.edge_nodes().end(), expected.edge_nodes().begin()));
    CHECK(std::equal(nodes.face_nodes().begin(), nodes.face_nodes().end(), expected.face_nodes().begin()));
  }
  for (const double unit : {1e-6, 1e6})
    for (const double shift : {0.0, 1e3})
    {
      Polygons moved = sphere;
      for (Point& x : moved.points)
        x = {unit * (x[0] + shift), unit * (x[1] - shift), unit * x[2]};
      const Surface_nodes<Mesh> nodes = curved(make_mesh(moved), 4, 4);
      double difference = 0;
      for (std::size_t i = 0; i < nodes.edge_nodes().size(); ++i)
      {
        const Point x = to_point(nodes.edge_nodes()[i]), y = to_point(expected.edge_nodes()[i]);
        difference = std::max({difference, std::abs(x[0] / unit - shift - y[0]), std::abs(x[1] / unit + shift - y[1]),
                               std::abs(x[2] / unit - y[2])});
      }
      CHECK(difference < (shift == 0 ? 1e-12 : 1e-9));
    }
}

TEST_CASE("faces meet, and corners stay", "[fit_vertices]")
{
  Polygons sphere = cubed_sphere(6);
  perturb_sphere(sphere, 0.03, 5);
  const Mesh mesh = make_mesh(sphere);
  const Vertex_fits<Mesh> fits = fit_vertices(mesh, {.degree = 3});
  for (const auto e : mesh.edges())
  {
    const auto h = mesh.halfedge(e), o = mesh.opposite(h);
    const Point a = to_point(mesh.point(mesh.source(h))), b = to_point(mesh.point(mesh.target(h)));
    const auto left = fits.face_map().edge_fit(h), right = fits.face_map().edge_fit(o);
    const double t = 0.3;
    const Point x = {a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1]), a[2] + t * (b[2] - a[2])};
    const Point from_left = left.displacement(x, std::array<double, 2>{1 - t, t});
    const Point from_right = right.displacement(x, std::array<double, 2>{t, 1 - t});
    for (int i = 0; i < 3; ++i)
      CHECK(std::abs(from_left[i] - from_right[i]) < 1e-15);
    CHECK(norm(left.displacement(a, std::array<double, 2>{1, 0})) < 1e-15);
    CHECK(norm(left.displacement(b, std::array<double, 2>{0, 1})) < 1e-15);
  }
}

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

TEST_CASE("planes beside rounded edges stay planes", "[fit_vertices]")
{
  // A plate of half thickness 0.2 whose edges are half circles of `chords` chords; borders at both ends.
  for (const int chords : {3, 6})
    for (const bool is_split : {false, true})
    {
      std::vector<Point> outline;
      for (const double side : {1.0, -1.0})
      {
        for (int i = 0; i <= chords; ++i)
        {
          const double a = std::numbers::pi * (0.5 - 1.0 * i / chords);
          outline.push_back({side * (1 + 0.2 * std::cos(a)), side * 0.2 * std::sin(a), 0});
        }
        for (int i = 1; i < 8; ++i)
          outline.push_back({side * (1 - 0.25 * i), -side * 0.2, 0});
      }
      const int around = static_cast<int>(outline.size());
      Polygons plate = mapped_grid(around, 6, true, [&](double a, double b) {
        Point x = outline[static_cast<std::size_t>(std::lround(a * around)) % outline.size()];
        x[2] = 1.5 * b;
        return x;
      });
      for (auto& face : plate.faces)
        std::reverse(face.begin(), face.end());
      const Mesh mesh = make_mesh(is_split ? split_quads(plate) : plate);
      const Surface_nodes<Mesh> straight(mesh, 3);
      for (const int d : {2, 4, 6})
      {
        CAPTURE(chords, is_split, d);
        const Surface_nodes<Mesh> nodes = curved(mesh, d, 3);
        Index planar_edges = 0, bent_edges = 0;
        for (const auto e : mesh.edges())
        {
          const auto h = mesh.halfedge(e);
          const Point a = to_point(mesh.point(mesh.source(h))), b = to_point(mesh.point(mesh.target(h)));
          const Point x = to_point(nodes.edge_node(h, 1)), y = to_point(straight.edge_node(h, 1));
          const bool is_inside_plane = std::abs(a[0] + b[0]) < 1.99 && std::abs(a[1] + b[1]) > 0.399;
          if (is_inside_plane)
            CHECK(x == y);
          planar_edges += is_inside_plane;
          bent_edges += x != y;
        }
        CHECK(planar_edges > 0);
        CHECK(bent_edges >= 2 * 7 * chords); // the chords are round
      }
    }
}

TEST_CASE("where a wall changes the side to which it bends, the rate stays", "[fit_vertices]")
{
  // Rows of vertices lie on the lines of inflection of a wavy wall: the faces around each of them are in one plane.
  const auto height = [](double x) { return 0.1 * std::sin(2 * std::numbers::pi * x); };
  const Distance distance = [&](const Point& x) { return std::abs(x[2] - height(x[0])); };
  for (const int d : {2, 4})
  {
    std::array<double, 2> errors;
    for (int i = 0; i < 2; ++i)
    {
      const int n = 24 << i;
      const Mesh mesh = make_mesh(mapped_grid(2 * n, 16, false, [&](double a, double b) {
        return Point{2 * a, 16.0 / n * b, height(2 * a)};
      }));
      errors[static_cast<std::size_t>(i)] = largest_error(curved(mesh, d, 3), distance);
    }
    CAPTURE(d, errors[0], errors[1]);
    CHECK(std::log2(errors[0] / errors[1]) > d + 1 - 0.4);
  }
}

TEST_CASE("noise is little amplified beside rims", "[fit_vertices]")
{
  // Polynomials of high degree amplify noise most from one side. They are only taken where the last two degrees change
  // the bend of an edge by less than a twentieth; raised ones by much less.
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(-1, 1);
  constexpr int around = 80;
  const double edge_length = 2 * std::numbers::pi / around;
  for (const double relative : {1e-5, 1e-3})
    for (const bool is_split : {false, true})
    {
      Polygons band = mapped_grid(around, around / 2, true,
                                  [=](double a, double b) { return on_cylinder(a, edge_length * around / 2 * b); });
      for (Point& x : band.points)
        for (double& c : x)
          c += relative * edge_length * uniform(random);
      const Mesh mesh = make_mesh(is_split ? split_quads(band) : band);
      for (const int d : {2, 4, 6})
      {
        CAPTURE(relative, is_split, d);
        const double bend = edge_length * edge_length / 8;
        const double found = largest_error(curved(mesh, d, 2), distance_to_cylinder);
        CHECK(found < 4 * relative * edge_length + 0.05 * bend);
      }
    }
}

TEST_CASE("noise is not amplified", "[fit_vertices]")
{
  std::mt19937 random(11);
  std::uniform_real_distribution<double> uniform(-1, 1);
  const double edge_length = 1.1 / 16;
  for (const double relative : {1e-7, 1e-3})
  {
    Polygons sphere = icosphere(4);
    for (Point& x : sphere.points)
      for (double& c : x)
        c += relative * edge_length * uniform(random);
    for (const int d : {2, 4, 6})
    {
      CAPTURE(relative, d);
      const double without = d == 2 ? 1e-8 : 0; // the fit's own error
      CHECK(largest_error(curved(make_mesh(sphere), d, 2), distance_to_sphere) < 4 * relative * edge_length + without);
    }
  }
}

TEST_CASE("the tip of a cone is told from the mesh", "[fit_vertices]")
{
  // 20 around, from the tip downwards; the tip is not marked as sharp.
  for (const double slope : {0.25, 0.5, 1.0, 3.0})
  {
    CAPTURE(slope);
    Polygons cone = mapped_grid(20, 6, true, [=](double a, double b) {
      const Point x = on_cylinder(a, 0);
      const double r = 0.15 + b;
      return Point{r * x[0], r * x[1], r / slope};
    });
    const int tip = static_cast<int>(cone.points.size());
    cone.points.push_back({0, 0, 0});
    for (int i = 0; i < 20; ++i)
      cone.faces.push_back({(i + 1) % 20, i, tip});
    const Mesh mesh = make_mesh(cone);
    const auto distance = [=](const Point& x) {
      return std::abs(std::hypot(x[0], x[1]) - slope * x[2]) / std::hypot(1, slope);
    };
    const std::vector<double> straight = errors_of_faces(mesh, Surface_nodes<Mesh>(mesh, 3), distance);
    const double largest_straight = *std::max_element(straight.begin(), straight.end());
    for (const int d : {2, 4, 6})
    {
      CAPTURE(d);
      const std::vector<double> errors = errors_of_faces(mesh, curved(mesh, d, 3), distance);
      for (std::size_t f = 0; f < errors.size(); ++f)
        CHECK(errors[f] < 1.15 * straight[f] + 1e-3 * largest_straight);
    }
  }
}

TEST_CASE("poles of coarse rings are no tips", "[fit_vertices]")
{
  // Rings 36 degrees apart, many faces around: the pole has more of the curvature than its neighbours, but not per
  // area.
  for (const int meridians : {24, 40, 72})
  {
    CAPTURE(meridians);
    Polygons sphere = mapped_grid(meridians, 3, true, [](double a, double b) {
      const double t = std::numbers::pi * (0.2 + 0.6 * b);
      const Point x = on_cylinder(a, 0);
      return Point{std::sin(t) * x[0], std::sin(t) * x[1], -std::cos(t)};
    });
    const int pole = static_cast<int>(sphere.points.size());
    sphere.points.push_back({0, 0, -1});
    sphere.points.push_back({0, 0, 1});
    for (int i = 0; i < meridians; ++i)
    {
      sphere.faces.push_back({(i + 1) % meridians, i, pole});
      sphere.faces.push_back({3 * meridians + i, 3 * meridians + (i + 1) % meridians, pole + 1});
    }
    const Mesh mesh = make_mesh(sphere);
    const auto fits = fit_vertices(mesh, {.degree = 2});
    CHECK(fits.all()[static_cast<std::size_t>(pole)].state != Vertex_fit_state::none);
    CHECK(fits.all()[static_cast<std::size_t>(pole) + 1].state != Vertex_fit_state::none);
  }
}

TEST_CASE("exact normals as data gain", "[fit_vertices]")
{
  Polygons ellipsoid = icosphere(4);
  perturb_sphere(ellipsoid, 0.01, 5);
  for (Point& x : ellipsoid.points)
    x = {2 * x[0], 1.3 * x[1], x[2]};
  Mesh mesh = make_mesh(ellipsoid);
  const auto normals = mesh.add_property_map<Mesh::Vertex_index, Kernel::Vector_3>("v:normal").first;
  for (const auto v : mesh.vertices())
  {
    const Point_3& x = mesh.point(v);
    const Kernel::Vector_3 across(x.x() / 4, x.y() / 1.69, x.z());
    normals[v] = across / std::sqrt(across.squared_length());
  }
  const auto distance = [](const Point& x) {
    const Point gradient = {x[0] / 4, x[1] / 1.69, x[2]};
    return std::abs(x[0] * x[0] / 4 + x[1] * x[1] / 1.69 + x[2] * x[2] - 1) / (2 * norm(gradient));
  };
  const auto error_of = [&](const Vertex_fits<Mesh>& fits) {
    Surface_nodes<Mesh> nodes(mesh, 2);
    curve_surface(mesh, fits.face_map(), {}, nodes.edge_map(), nodes.face_map(), {.degree = 2});
    return largest_error(nodes, distance);
  };
  for (const int d : {2, 4, 6})
  {
    CAPTURE(d);
    Vertex_fit_options options{.degree = d};
    const double points_alone = error_of(fit_vertices(mesh, options));
    options.data = Vertex_fit_data::points_and_normals;
    CHECK_THROWS_AS(fit_vertices(mesh, options), Input_error);
    const double exact = error_of(fit_vertices(mesh, options, CGAL::parameters::vertex_normal_map(normals)));
    CHECK(exact < 0.5 * points_alone);
  }
}

TEST_CASE("stencils do not wrap round a thin plate", "[fit_vertices]")
{
  // Two parallel sheets, closed by a bend of three faces that no edge marks as critical.
  const double thickness = 0.01;
  const auto profile = [&](double s) -> Point {
    if (s < 0.45)
      return {1 - s / 0.45, 0.5 * thickness, 0};
    if (s > 0.55)
      return {(s - 0.55) / 0.45, -0.5 * thickness, 0};
    const double a = std::numbers::pi * (0.5 + 10 * (s - 0.45));
    return {0.5 * thickness * std::cos(a), 0.5 * thickness * std::sin(a), 0};
  };
  const Mesh mesh = make_mesh(mapped_grid(40, 10, false, [&](double a, double b) {
    Point x = profile(a);
    x[2] = b;
    return x;
  }));
  for (const int d : {2, 6})
    for (const Point_3& x : curved(mesh, d, 2).edge_nodes())
      CHECK(std::abs(x.y()) < thickness); // the sheets are at 0.5; fits round the bend would be off by whole faces
}

TEST_CASE("documented outcomes of degenerate input", "[fit_vertices]")
{
  CHECK(fit_vertices(Mesh(), {.degree = 3}).all().empty());
  Mesh one;
  const auto first = one.add_vertex({0, 0, 0}), second = one.add_vertex({1, 0, 0}), third = one.add_vertex({0, 1, 0});
  one.add_face(first, second, third);
  CHECK(fit_vertices(one).fit_at_corner(*one.faces().begin(), 0).state == Vertex_fit_state::planar);
  one.point(third) = Point_3(2, 0, 0); // no area
  Reconstruction_report report;
  fit_vertices(one, {}, no_parameters, Compact_policies{}, &report);
  REQUIRE(report.lowerings.size() == 1);
  CHECK(report.lowerings[0].reason == Lowering_reason::no_normal);
  CHECK_THROWS_AS(fit_vertices(one, {.degree = 0}), Input_error);
  CHECK_THROWS_AS(fit_vertices(one, {.degree = 7}), Input_error);
  CHECK_THROWS_AS(fit_vertices(one, {.polynomial_degree = max_vertex_fit_degree + 1}), Input_error);
  CHECK_THROWS_AS(fit_vertices(one, {.more_degrees_at_rim = -2}), Input_error);
  CHECK_THROWS_AS(fit_vertices(one, {.more_degrees_at_rim = max_vertex_fit_degree + 1}), Input_error);
  one.point(third) = Point_3(2, std::nan(""), 0);
  CHECK_THROWS_AS(fit_vertices(one), Input_error);
}

TEST_CASE("curvatures of vertex fits", "[fit_vertices]")
{
  Polygons shape = icosphere(3);
  perturb_sphere(shape, 0.02, 9);
  const Mesh mesh = make_mesh(shape);
  const Vertex_fits<Mesh> fits = fit_vertices(mesh, {.degree = 4});
  for (const Vertex_fit& fit : fits.all())
  {
    const auto [largest, smallest] = fit.principal_curvatures();
    CHECK(largest == Approx(1).margin(1e-4));
    CHECK(smallest == Approx(1).margin(1e-4));
    const Point n = fit.normal(0, 0);
    CHECK(norm({n[0] - fit.origin[0], n[1] - fit.origin[1], n[2] - fit.origin[2]}) < 1e-5);
  }
}

TEST_CASE("regular meshes with rims get the same fits wherever they are", "[fit_vertices]")
{
  // Their points are equally far in pairs: round-off must not choose between these.
  const auto radius = [](double b) { return 1 + 0.1 * std::sin(5 * b); };
  const auto height = [](double x, double y) { return 0.3 * std::cos(2 * x - 1) * std::cos(2 * y - 1); };
  const std::vector<Shape> shapes = {
    {"revolved",
     mapped_grid(24, 24, true,
                 [=](double a, double b) {
                   const Point x = on_cylinder(a, 6 * b);
                   return Point{radius(b) * x[0], radius(b) * x[1], x[2]};
                 }),
     [=](const Point& x) { return std::abs(std::hypot(x[0], x[1]) - radius(x[2] / 6)); }},
    {"square patch", grid(24, 24, 1, 1, height), [=](const Point& x) { return std::abs(x[2] - height(x[0], x[1])); }},
    {"torus", grid_torus(16, 48, 2, 0.5, 0, 1), [](const Point& x) { return distance_to_torus(x, 2, 0.5); }}};
  constexpr Point shift = {0.123, 0.7, -0.31};
  for (const Shape& shape : shapes)
  {
    CAPTURE(shape.name);
    const Surface_nodes<Mesh> expected = curved(make_mesh(shape.mesh), 4, 3);
    Polygons moved = shape.mesh;
    for (Point& x : moved.points)
      for (std::size_t i = 0; i < 3; ++i)
        x[i] += shift[i];
    const Surface_nodes<Mesh> nodes = curved(make_mesh(moved), 4, 3);
    double difference = 0;
    for (std::size_t n = 0; n < nodes.edge_nodes().size(); ++n)
    {
      const Point x = to_point(nodes.edge_nodes()[n]), y = to_point(expected.edge_nodes()[n]);
      for (std::size_t i = 0; i < 3; ++i)
        difference = std::max(difference, std::abs(x[i] - shift[i] - y[i]));
    }
    CHECK(difference < 1e-10);        // round-off times the condition of polynomials of degree 6 to 12
    if (shape.name == "square patch") // faces beside its corners are as good as others
    {
      const Mesh mesh = make_mesh(shape.mesh);
      double largest = 0;
      for (const auto e : mesh.edges())
        for (int k = 1; k < 3 && !mesh.is_border(e); ++k)
          largest = std::max(largest, shape.distance(to_point(expected.edge_node(mesh.halfedge(e), k))));
      CHECK(largest < 1e-9); // (pi / 36)^8 / 20 is what terms of degree 8 are at an edge's end
    }
  }
}

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

TEST_CASE("curvatures where rows of long faces bend", "[fit_vertices]")
{
  constexpr double ring = 2, tube = 0.3;
  std::array<double, 2> errors = {};
  for (std::size_t i = 0; i < errors.size(); ++i)
  {
    const Mesh mesh = make_mesh(grid_torus(i == 0 ? 24 : 48, i == 0 ? 100 : 200, ring, tube, 0, 1));
    const Vertex_fits<Mesh> fits = fit_vertices(mesh, {.degree = 2});
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

TEST_CASE("copies of fits outlive what they were copied from", "[fit_vertices]")
{
  const auto height = [](double x, double y) { return 0.3 * std::sin(3 * x) * std::cos(2 * y); };
  const Mesh mesh = make_mesh(grid(26, 26, 1, 1, height));
  const auto largest_error_of_fits = [&](const Vertex_fits<Mesh>& fits) {
    double error = 0;
    for (const Vertex_fit& fit : fits.all())
    {
      const double x = fit.origin[0] + (fit.origin[0] < 0.5 ? 0.02 : -0.02), y = fit.origin[1];
      error = std::max(error, std::abs(fit.way_along({x, y, 0}, {0, 0, 1}) - height(x, y)));
    }
    return error;
  };
  const auto count_of_highest = [](const Vertex_fits<Mesh>& fits) {
    return std::count_if(fits.all().begin(), fits.all().end(),
                         [](const Vertex_fit& fit) { return fit.degree == max_vertex_fit_degree; });
  };
  std::optional<Vertex_fits<Mesh>> original(fit_vertices(mesh, {.degree = 4}));
  for (const Vertex_fit& fit : original->all())
    REQUIRE(fit.coefficients.size() == static_cast<std::size_t>(coefficient_count(fit.degree)));
  CHECK(largest_error_of_fits(*original) < 1e-6);
  CHECK(count_of_highest(*original) > 0); // at the border
  Vertex_fits<Mesh> copy = *original;
  original.reset();
  original.emplace(fit_vertices(mesh, {.degree = 1})); // likely where the first ones were
  CHECK(largest_error_of_fits(copy) < 1e-6);
  const Vertex_fits<Mesh> moved = std::move(copy);
  CHECK(largest_error_of_fits(moved) < 1e-6);
  CHECK(count_of_highest(moved) > 0);
  copy = moved;
  CHECK(count_of_highest(copy) == count_of_highest(moved));
}
