#include "surface/curved_surfaces.h"

#include <recurve/surface/fit_vertices.h>

#include <catch2/catch.hpp>
#include <tbb/global_control.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <random>
#include <utility>
#include <vector>

using namespace recurve;
using namespace test_surfaces;

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
  const auto error_of = [&](const Vertex_fits<Mesh>& fits) { return largest_error(curved(mesh, fits, 2), distance); };
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
