// The same surface as a Surface_mesh, a Polyhedron_3 and an OpenMesh gives the same bits.

#include <recurve/mesh/openmesh.h>

#include "surface/test_surfaces.h"

#include <recurve/surface/curve_surface.h>
#include <recurve/surface/reconstruct_surface.h>

#include <CGAL/Polyhedron_3.h>
#include <CGAL/boost/graph/Euler_operations.h>
#include <CGAL/boost/graph/graph_traits_Polyhedron_3.h>
#include <catch2/catch.hpp>

#include <map>

using namespace recurve;
using namespace test_surfaces;

namespace {

using Polyhedron = CGAL::Polyhedron_3<Kernel>;

/// By position: the fits and the nodes of each edge and face, of a surface bent along a feature curve.
struct Result
{
  std::map<Point, Local_fit> fits;                ///< by the origin
  std::map<std::pair<Point, Point>, Point> edges; ///< middle node, by the ends
  std::map<Point, Point> faces;                   ///< middle node, by the origin of the fit
};

template <class Graph, class VertexPointMap>
Result curve(const Graph& g, VertexPointMap points)
{
  const auto fits = get(CGAL::dynamic_face_property_t<Local_fit>(), g);
  const auto is_critical = get(CGAL::dynamic_edge_property_t<char>(), g);
  const auto is_sharp = get(CGAL::dynamic_vertex_property_t<char>(), g);
  for (const auto v : vertices(g))
    put(is_sharp, v, 0);
  for (const auto e : edges(g))
  {
    const auto h = halfedge(e, g);
    put(is_critical, e, get(points, source(h, g)).x() == 1 && get(points, target(h, g)).x() == 1);
  }
  reconstruct_surface(g, fits, {.degree = 3},
                      CGAL::parameters::vertex_point_map(points).edge_is_constrained_map(is_critical));
  Surface_nodes<Graph, Point_3> nodes(g, 2, points);
  const Surface_nodes<Graph, Point_3> straight = nodes;
  curve_surface(g, fits, trace_feature_curves(g, is_critical, is_sharp), nodes.edge_map(), nodes.face_map(),
                {.degree = 2}, CGAL::parameters::vertex_point_map(points));
  Result result;
  for (const auto e : edges(g))
  {
    const auto h = halfedge(e, g);
    const Point a = to_point(get(points, source(h, g))), b = to_point(get(points, target(h, g)));
    result.edges[std::minmax(a, b)] = to_point(nodes.edge_node(h, 1));
  }
  for (const auto f : faces(g))
  {
    const Local_fit fit = get(fits, f);
    result.fits[fit.origin] = fit;
    if (nodes.face_node_count(f) > 0)
      result.faces[fit.origin] = to_point(nodes.face_node(f, 0));
  }
  return result;
}

/// quads and triangles over [0, 2] x [0, 1], with a crease at x = 1 that is round.
Polygons creased_surface()
{
  Polygons surface = grid(8, 6, 2, 1, [](double x, double y) {
    return 0.2 * y * y + (x < 1 ? 0.5 * x + 0.1 * x * x : 0.6 - 0.2 * (x - 1) * (1 + y));
  });
  const Polygons triangles = split_quads(surface);
  surface.faces.resize(24);
  surface.faces.insert(surface.faces.end(), triangles.faces.begin() + 48, triangles.faces.end());
  return surface;
}

/// builds a mesh of any class with the vertices and faces in the order of `polygons` (which copy_face_graph() does not
/// keep, and sums in another order have other last digits).
template <class Graph, class VertexPointMap>
void build(const Polygons& polygons, Graph& g, VertexPointMap points)
{
  std::vector<typename boost::graph_traits<Graph>::vertex_descriptor> vertices;
  for (const Point& x : polygons.points)
  {
    vertices.push_back(add_vertex(g));
    put(points, vertices.back(), Point_3(x[0], x[1], x[2]));
  }
  for (const auto& face : polygons.faces)
  {
    std::vector<typename boost::graph_traits<Graph>::vertex_descriptor> corners;
    corners.reserve(face.size());
    for (const int corner : face)
      corners.push_back(vertices[static_cast<std::size_t>(corner)]);
    CGAL::Euler::add_face(corners, g);
  }
}

void check_equal(const Result& a, const Result& b)
{
  REQUIRE(a.fits.size() == b.fits.size());
  for (auto i = a.fits.begin(), j = b.fits.begin(); i != a.fits.end(); ++i, ++j)
  {
    CHECK(i->first == j->first);
    CHECK(i->second.u == j->second.u);
    CHECK(i->second.n == j->second.n);
    CHECK(i->second.scale == j->second.scale);
    CHECK(i->second.degree == j->second.degree);
    CHECK(i->second.coefficients == j->second.coefficients);
  }
  // Nodes start from one end of their edge or one corner of their face, which each graph chooses: last digits differ.
  const auto is_near = [](const Point& x, const Point& y) {
    return std::abs(x[0] - y[0]) + std::abs(x[1] - y[1]) + std::abs(x[2] - y[2]) < 1e-15;
  };
  REQUIRE(a.edges.size() == b.edges.size());
  for (auto i = a.edges.begin(), j = b.edges.begin(); i != a.edges.end(); ++i, ++j)
    CHECK((i->first == j->first && is_near(i->second, j->second)));
  REQUIRE(a.faces.size() == b.faces.size());
  for (auto i = a.faces.begin(), j = b.faces.begin(); i != a.faces.end(); ++i, ++j)
    CHECK((i->first == j->first && is_near(i->second, j->second)));
}

} // namespace

TEST_CASE("Surface_mesh, Polyhedron_3 and OpenMesh are curved alike", "[reconstruct_surface][curve_surface]")
{
  const Mesh mesh = make_mesh(creased_surface());
  const Result expected = curve(mesh, get(CGAL::vertex_point, mesh));
  REQUIRE(expected.fits.size() == mesh.number_of_faces());
  SECTION("Polyhedron_3")
  {
    Polyhedron polyhedron;
    build(creased_surface(), polyhedron, get(CGAL::vertex_point, polyhedron));
    const Polyhedron& constant = polyhedron;
    check_equal(expected, curve(constant, get(CGAL::vertex_point, constant)));
  }
  SECTION("OpenMesh")
  {
    Openmesh_polygons polygons;
    const auto points = openmesh_point_map(polygons);
    build(creased_surface(), polygons, points);
    const Openmesh_polygons& constant = polygons;
    check_equal(expected, curve(constant, points));
  }
}
