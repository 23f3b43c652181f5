#include <recurve/mesh/openmesh.h>

#include <CGAL/Surface_mesh.h>
#include <CGAL/boost/graph/copy_face_graph.h>
#include <CGAL/boost/graph/helpers.h>

#include <catch2/catch.hpp>

#include <algorithm>
#include <type_traits>
#include <vector>

using namespace recurve;

using Point_3 = CGAL::Exact_predicates_inexact_constructions_kernel::Point_3;

TEST_CASE("positions survive the way through OpenMesh to the bit", "[openmesh]")
{
  CGAL::Surface_mesh<Point_3> source;
  const Point_3 a(1.0 / 3, 1e6 + 1e-9, 0.1), b(1, 0, 1e-17), c(0.2, 1, 0), d(-1.0 / 7, 1, 1);
  CGAL::make_quad(a, b, c, d, source);
  Openmesh_polygons mesh;
  CGAL::copy_face_graph(source, mesh, CGAL::parameters::default_values(),
                        CGAL::parameters::vertex_point_map(openmesh_point_map(mesh)));
  REQUIRE(mesh.n_vertices() == 4);
  REQUIRE(mesh.n_faces() == 1);
  const auto map = openmesh_point_map(mesh);
  std::vector<Point_3> found, expected;
  for (const auto v : vertices(mesh))
    found.push_back(get(map, v));
  for (const auto v : vertices(source))
    expected.push_back(source.point(v));
  std::sort(found.begin(), found.end());
  std::sort(expected.begin(), expected.end());
  CHECK(found == expected);
}

TEST_CASE("the map writes and reads doubles", "[openmesh]")
{
  Openmesh_polygons mesh;
  const auto v = mesh.add_vertex({0, 0, 0});
  const auto map = openmesh_point_map(mesh);
  put(map, v, Point_3(0.1, 1.0 / 3, 1e300));
  CHECK(map[v] == Point_3(0.1, 1.0 / 3, 1e300));
  CHECK(mesh.point(v)[1] == 1.0 / 3);
  STATIC_REQUIRE(std::is_same_v<boost::property_traits<decltype(map)>::value_type, Point_3>);
}
