#include "surface/curved_surfaces.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

using namespace recurve;
using namespace test_surfaces;

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
