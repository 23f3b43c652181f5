#include <recurve/volume/boundary_sources.h>

#include <recurve/core/exceptions.h>
#include <volume/small_meshes.h>

#include <catch2/catch.hpp>

#include <numeric>

using namespace recurve;
using namespace recurve::tests;

namespace {

/// the square [0, 2]^2 at z = 5 as n^2 quadrangles or twice as many triangles.
Small_mesh square(Element_type type, int degree, int n)
{
  Small_mesh mesh;
  mesh.degree = degree;
  const auto vertex = [n](int i, int j) { return Point{2.0 * i / n, 2.0 * j / n, 5}; };
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i)
      if (type == Element_type::quadrangle)
        mesh.add(type, {vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1), vertex(i, j + 1)});
      else
      {
        mesh.add(type, {vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1)});
        mesh.add(type, {vertex(i, j), vertex(i + 1, j + 1), vertex(i, j + 1)});
      }
  return mesh;
}

} // namespace

TEST_CASE("mean_edge_length: squares and triangles", "[volume]")
{
  const int degree = GENERATE(1, 2, 5);
  CHECK(mean_edge_length(square(Element_type::quadrangle, degree, 4).nodes,
                         square(Element_type::quadrangle, degree, 4).blocks(), degree) == Approx(0.5).epsilon(1e-15));
  const Small_mesh triangles = square(Element_type::triangle, degree, 1);
  CHECK(mean_edge_length(triangles.nodes, triangles.blocks(), degree) ==
        Approx(2 * (2 + std::sqrt(2)) / 3).epsilon(1e-15));
  const Small_mesh cells = box_of(Element_type::tetrahedron, 2, 1); // cells are no faces
  CHECK(mean_edge_length(cells.nodes, cells.blocks(), 2) == 0);
  CHECK(mean_edge_length(std::vector<Point>{}, std::vector<Element_block>{}, 1) == 0);
}

TEST_CASE("node_areas: they add up to the area and are even", "[volume]")
{
  const Element_type type = GENERATE(Element_type::triangle, Element_type::quadrangle);
  const int degree = GENERATE(1, 2, 3, 6);
  const int n = 6;
  const Small_mesh mesh = square(type, degree, n);
  const std::vector<double> areas = node_areas(mesh.nodes, mesh.blocks(), degree);
  REQUIRE(areas.size() == mesh.nodes.size());
  CHECK(std::accumulate(areas.begin(), areas.end(), 0.0) == Approx(4).epsilon(1e-13));
  // every node inside the square has the same surroundings
  const double expected = 4.0 / (n * n * degree * degree);
  std::size_t inside = 0;
  for (std::size_t m = 0; m < areas.size(); ++m)
  {
    const Point& p = mesh.nodes[m];
    CHECK(areas[m] > 0);
    if (p[0] > 1e-9 && p[0] < 2 - 1e-9 && p[1] > 1e-9 && p[1] < 2 - 1e-9)
    {
      ++inside;
      CHECK(areas[m] == Approx(expected).epsilon(1e-12));
    }
  }
  CHECK(inside == std::size_t((n * degree - 1) * (n * degree - 1)));
}

TEST_CASE("node_areas: nodes of no face have none", "[volume]")
{
  Small_mesh mesh = square(Element_type::quadrangle, 2, 1);
  mesh.nodes.push_back({7, 7, 7});
  CHECK(node_areas(mesh.nodes, mesh.blocks(), 2).back() == 0);
}

TEST_CASE("boundary faces: bad input is refused", "[volume]")
{
  Small_mesh mesh = square(Element_type::quadrangle, 2, 1);
  CHECK_THROWS_AS(mean_edge_length(mesh.nodes, mesh.blocks(), 0), Input_error);
  CHECK_THROWS_AS(node_areas(mesh.nodes, mesh.blocks(), 7), Input_error);
  CHECK_THROWS_AS(mean_edge_length(mesh.nodes, mesh.blocks(), 3), Input_error);
  mesh.elements[Element_type::quadrangle][4] = 99;
  CHECK_THROWS_WITH(node_areas(mesh.nodes, mesh.blocks(), 2), Catch::Contains("node 99"));
}
