#include "surface/curved_surfaces.h"

#include <recurve/surface/surface_intersections.h>

#include <catch2/catch.hpp>

using namespace recurve;
using namespace test_surfaces;

namespace {

Polygons joined(Polygons a, const Polygons& b)
{
  const int first = static_cast<int>(a.points.size());
  a.points.insert(a.points.end(), b.points.begin(), b.points.end());
  for (auto face : b.faces)
  {
    for (int& corner : face)
      corner += first;
    a.faces.push_back(face);
  }
  return a;
}

Polygons moved(Polygons polygons, double factor, double dx)
{
  for (Point& x : polygons.points)
    x = {factor * x[0] + dx, factor * x[1], factor * x[2]};
  return polygons;
}

std::vector<Face_intersection> intersections(const Mesh& mesh, int degree)
{
  return find_surface_intersections(mesh, curved(mesh, 2, degree));
}

} // namespace

TEST_CASE("a sphere does not intersect itself", "[surface_intersections]")
{
  const int degree = GENERATE(1, 2, 3, 6);
  CHECK(intersections(make_mesh(icosphere(2)), degree).empty());
  CHECK(intersections(make_mesh(cubed_sphere(4)), degree).empty());
}

TEST_CASE("faults of the input are told from those of the curving", "[surface_intersections]")
{
  // Two unit spheres whose straight-sided faces leave a gap that the curved faces close: the bulges are 1 - cos of half
  // an edge's angle high.
  const Polygons left = cubed_sphere(4);
  const double face_radius = std::cos(std::numbers::pi / 4 / 4 * 1.3);
  const double apart = GENERATE(1.0, 1.9, 2.2); // deep in each other, touching with curved faces only at most, apart
  CAPTURE(apart, face_radius);
  const Mesh mesh = make_mesh(joined(left, moved(left, 1, apart)));
  const std::vector<Face_intersection> found = intersections(mesh, 3);
  if (apart == 2.2)
    CHECK(found.empty());
  else
  {
    REQUIRE_FALSE(found.empty());
    const Index faces_of_one = static_cast<Index>(left.faces.size());
    for (const Face_intersection& pair : found)
    {
      CHECK(pair.first < faces_of_one);
      CHECK(pair.second >= faces_of_one);
    }
  }
  if (apart == 1.0)
    CHECK(std::any_of(found.begin(), found.end(), [](const Face_intersection& pair) { return pair.is_in_input; }));
}

TEST_CASE("two spheres that only curving brings together", "[surface_intersections]")
{
  // The coarse cubes' faces lie at 1/sqrt(3) of the sphere; the corners do not face each other.
  const Polygons cube = cubed_sphere(2);
  const Mesh mesh = make_mesh(joined(cube, moved(cube, 1, 1.99)));
  Surface_nodes<Mesh> nodes(mesh, 2);
  CHECK_FALSE(find_surface_intersections(mesh, nodes).empty()); // at degree 2 the vertices at (1, 0, 0) cross
  for (const Face_intersection& pair : find_surface_intersections(mesh, nodes))
    CHECK(pair.is_in_input);
  // Between two parallel sheets, a node is pulled through.
  Polygons sheets =
    joined(grid(4, 4, 1, 1, [](double, double) { return 0.0; }), grid(4, 4, 1, 1, [](double, double) { return 0.1; }));
  const Mesh two = make_mesh(sheets);
  Surface_nodes<Mesh> pulled(two, 2);
  CHECK(find_surface_intersections(two, pulled).empty());
  const auto face = *two.faces().begin();
  pulled.set_face_node(face, 0, Point_3(0.125, 0.125, 0.15));
  const std::vector<Face_intersection> found = find_surface_intersections(two, pulled);
  REQUIRE(found.size() == 1);
  CHECK(found[0] == Face_intersection{0, 16, false});
}
