#include "surface/test_surfaces.h"

#include <recurve/elements/node_layout.h>
#include <recurve/surface/surface_nodes.h>

#include <catch2/catch.hpp>

using namespace recurve;
using namespace test_surfaces;

TEST_CASE("straight nodes stand in the canonical order of the elements", "[surface_nodes]")
{
  const int degree = GENERATE(2, 3, 4, 5, 6);
  const int corners = GENERATE(3, 4);
  CAPTURE(degree, corners);
  const Polygons face = corners == 3 ? Polygons{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}}
                                     : Polygons{{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {{0, 1, 2, 3}}};
  const Mesh mesh = make_mesh(face);
  const auto f = *mesh.faces().begin();
  const Point origin = to_point(mesh.point(mesh.source(mesh.halfedge(f))));
  const Point next = to_point(mesh.point(mesh.target(mesh.halfedge(f))));
  const Point last = to_point(mesh.point(mesh.source(mesh.prev(mesh.halfedge(f)))));
  const Surface_nodes<Mesh> nodes(mesh, degree);
  const Element_type type = corners == 3 ? Element_type::triangle : Element_type::quadrangle;
  const auto layout = canonical_nodes(type, degree);
  REQUIRE(nodes.face_node_count(f) == interior_node_count(type, degree));
  for (int m = 0; m < nodes.face_node_count(f); ++m)
  {
    const auto lattice = layout[static_cast<std::size_t>(first_interior_node(type, degree) + m)];
    const Point x = to_point(nodes.face_node(f, m));
    for (int i = 0; i < 3; ++i)
      CHECK(x[i] ==
            Approx(origin[i] + (lattice[0] * (next[i] - origin[i]) + lattice[1] * (last[i] - origin[i])) / degree)
              .margin(1e-15));
  }
  for (const auto h : mesh.halfedges())
    for (int k = 1; k < degree; ++k)
    {
      const Point a = to_point(mesh.point(mesh.source(h))), b = to_point(mesh.point(mesh.target(h)));
      const Point x = to_point(nodes.edge_node(h, k));
      for (int i = 0; i < 3; ++i)
        CHECK(x[i] == Approx(a[i] + k * (b[i] - a[i]) / degree).margin(1e-15));
    }
}

TEST_CASE("both half-edges of an edge name the same nodes", "[surface_nodes]")
{
  const Mesh mesh = make_mesh(icosphere(1));
  Surface_nodes<Mesh> nodes(mesh, 4);
  const auto h = *(mesh.halfedges().begin() + 7);
  put(nodes.edge_map(), Edge_node<Mesh>{h, 1}, Point_3(1, 2, 3));
  put(nodes.edge_map(), Edge_node<Mesh>{mesh.opposite(h), 2}, Point_3(4, 5, 6));
  CHECK(nodes.edge_node(mesh.opposite(h), 3) == Point_3(1, 2, 3));
  CHECK(nodes.edge_node(h, 2) == Point_3(4, 5, 6));
  const auto f = mesh.face(h);
  put(nodes.face_map(), Face_node<Mesh>{f, 2}, Point_3(7, 8, 9));
  CHECK(nodes.face_node(f, 2) == Point_3(7, 8, 9));
  CHECK(nodes.face_nodes()[static_cast<std::size_t>(3 * int(f) + 2)] == Point_3(7, 8, 9));
}

TEST_CASE("nodes are refused for wrong degrees and polygons", "[surface_nodes]")
{
  const Mesh mesh = make_mesh(icosphere(1));
  CHECK_THROWS_AS(Surface_nodes<Mesh>(mesh, 0), Input_error);
  CHECK_THROWS_AS(Surface_nodes<Mesh>(mesh, 7), Input_error);
  const Mesh pentagon =
    make_mesh({{{0, 0, 0}, {1, 0, 0}, {1.5, 1, 0.1}, {0.5, 1.5, 0}, {-0.5, 1, 0}}, {{0, 1, 2, 3, 4}}});
  CHECK_THROWS_AS(Surface_nodes<Mesh>(pentagon, 2), Input_error);
}
