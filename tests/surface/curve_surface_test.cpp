#include "surface/test_surfaces.h"
#include "surface/transformations.h"

#include <recurve/surface/curve_surface.h>
#include <recurve/surface/reconstruct_surface.h>

#include <CGAL/boost/graph/properties.h>
#include <boost/property_map/property_map.hpp>
#include <catch2/catch.hpp>
#include <tbb/global_control.h>

#include <cmath>
#include <set>

using namespace recurve;
using namespace test_surfaces;

namespace {

constexpr std::uint32_t seed = 2018;

using Curves = std::vector<Feature_curve<Mesh>>;
using Fits = Mesh::Property_map<Mesh::Face_index, Local_fit>;
using Critical_edges = Mesh::Property_map<Mesh::Edge_index, bool>;

/// A mesh with fits and feature curves.
struct Surface
{
  Mesh mesh;
  Fits fits;
  Critical_edges is_critical;
  Curves curves;

  explicit Surface(const Polygons& polygons)
    : mesh(make_mesh(polygons)), fits(mesh.add_property_map<Mesh::Face_index, Local_fit>("f:fit").first),
      is_critical(mesh.add_property_map<Mesh::Edge_index, bool>("e:critical", false).first)
  {}

  /// marks as critical the edges for which `is_marked(a, b)`, with the points of their ends.
  template <class Predicate>
  void mark_edges(const Predicate& is_marked)
  {
    for (const auto e : mesh.edges())
      is_critical[e] = is_marked(to_point(mesh.point(mesh.vertex(e, 0))), to_point(mesh.point(mesh.vertex(e, 1))));
  }

  void fit(int degree)
  {
    const auto nothing_sharp = boost::static_property_map<bool, Mesh::Vertex_index>(false);
    curves = trace_feature_curves(mesh, is_critical, nothing_sharp);
    reconstruct_surface(mesh, fits, {.degree = degree}, CGAL::parameters::edge_is_constrained_map(is_critical));
  }

  Curving_surface_report curve(Surface_nodes<Mesh>& nodes) const
  {
    return curve_surface(mesh, fits, curves, nodes.edge_map(), nodes.face_map(), {.degree = nodes.degree()});
  }
};

bool is_equal(const Surface_nodes<Mesh>& a, const Surface_nodes<Mesh>& b)
{
  return std::equal(a.edge_nodes().begin(), a.edge_nodes().end(), b.edge_nodes().begin(), b.edge_nodes().end()) &&
         std::equal(a.face_nodes().begin(), a.face_nodes().end(), b.face_nodes().begin(), b.face_nodes().end());
}

/// A map that checks who writes what, and keeps only the names of the nodes.
struct Logging_map
{
  using key_type = Edge_node<Mesh>;
  using value_type = Point_3;
  using reference = void;
  using category = boost::writable_property_map_tag;

  std::set<std::pair<unsigned, int>>* seen;

  friend void put(const Logging_map& map, const Edge_node<Mesh>& key, const Point_3&)
  {
    CHECK(unsigned(key.halfedge) % 2 == 0); // the first of the two, as the edges of mesh.edges() have it
    CHECK(map.seen->insert({unsigned(key.halfedge), key.k}).second);
  }
};

/// a disc: triangles in the middle, quads around them.
Polygons disc(int rings, int around)
{
  Polygons result;
  result.points.push_back({0, 0, 0});
  for (int j = 1; j <= rings; ++j)
    for (int i = 0; i < around; ++i)
    {
      const double angle = 2 * std::numbers::pi * i / around;
      result.points.push_back({std::cos(angle) * j / rings, std::sin(angle) * j / rings, 0});
    }
  const auto at = [&](int i, int j) { return 1 + i % around + (j - 1) * around; };
  for (int i = 0; i < around; ++i)
    result.faces.push_back({0, at(i, 1), at(i + 1, 1)});
  for (int j = 1; j < rings; ++j)
    for (int i = 0; i < around; ++i)
      result.faces.push_back({at(i, j), at(i, j + 1), at(i + 1, j + 1), at(i + 1, j)});
  return result;
}

bool is_on_rim(const Point& a, const Point& b)
{
  return std::hypot(a[0], a[1]) > 0.999 && std::hypot(b[0], b[1]) > 0.999;
}

} // namespace

TEST_CASE("a node on an edge is the mean of both fits, a node in a face takes the face's fit", "[curve_surface]")
{
  Surface sphere(icosphere(2));
  sphere.fit(3);
  const int p = 4;
  Surface_nodes<Mesh> nodes(sphere.mesh, p);
  const Surface_nodes<Mesh> straight = nodes;
  const Curving_surface_report report = sphere.curve(nodes);
  CHECK(report.faces == static_cast<Index>(sphere.mesh.number_of_faces()));
  CHECK(report.edges == static_cast<Index>(sphere.mesh.number_of_edges()));
  CHECK(report.curve_edges == 0);
  CHECK(report.moved_edge_nodes == report.edges * (p - 1));
  CHECK(report.moved_face_nodes == report.faces * 3);
  double difference = 0, largest = 0;
  for (const auto e : sphere.mesh.edges())
    for (int k = 1; k < p; ++k)
    {
      const auto h = sphere.mesh.halfedge(e);
      const Point x = to_point(straight.edge_node(h, k));
      const Point a = sphere.fits[sphere.mesh.face(h)].displacement(x);
      const Point b = sphere.fits[sphere.mesh.face(sphere.mesh.opposite(h))].displacement(x);
      const Point found = to_point(nodes.edge_node(h, k));
      for (int i = 0; i < 3; ++i)
        difference = std::max(difference, std::abs(found[i] - (x[i] + (a[i] + b[i]) / 2)));
      largest = std::max(largest, norm(difference_of(found, x)));
      CHECK(nodes.edge_node(h, k) == nodes.edge_node(sphere.mesh.opposite(h), p - k));
    }
  for (const auto f : sphere.mesh.faces())
    for (int m = 0; m < nodes.face_node_count(f); ++m)
    {
      const Point x = to_point(straight.face_node(f, m));
      const Point found = to_point(nodes.face_node(f, m));
      difference = std::max(difference, norm(difference_of(found, moved(x, sphere.fits[f].displacement(x)))));
      largest = std::max(largest, norm(difference_of(found, x)));
    }
  CHECK(difference < 1e-15);
  CHECK(report.largest_displacement == Approx(largest).epsilon(1e-12));
  CHECK(report.largest_relative_displacement > report.largest_displacement);
}

TEST_CASE("on a border the one fit places the nodes", "[curve_surface]")
{
  Surface bowl(grid(6, 6, 1, 1, [](double x, double y) { return 0.2 * (x * x + y * y); }));
  bowl.fit(2);
  Surface_nodes<Mesh> nodes(bowl.mesh, 2);
  const Surface_nodes<Mesh> straight = nodes;
  bowl.curve(nodes);
  for (const auto h : bowl.mesh.halfedges())
    if (bowl.mesh.is_border(h))
    {
      const Point x = to_point(straight.edge_node(h, 1));
      const Point way = bowl.fits[bowl.mesh.face(bowl.mesh.opposite(h))].displacement(x);
      CHECK(norm(difference_of(to_point(nodes.edge_node(h, 1)), moved(x, way))) < 1e-15);
    }
}

TEST_CASE("planar surfaces with straight feature curves get no node written", "[curve_surface]")
{
  const bool is_triangulated = GENERATE(true, false);
  const double offset = GENERATE(0.0, 1e6);
  const int degree = GENERATE(2, 3, 6);
  CAPTURE(is_triangulated, offset, degree, seed);
  Polygons plane = grid(6, 5, 1.3, 0.8, [](double, double) { return 0.0; });
  if (is_triangulated)
    plane = split_quads(plane);
  const Polygons upright = plane;
  const Rotation rotation = random_rotation(seed);
  for (Point& x : plane.points)
    x = moved(rotated(rotation, x), {offset, -offset, offset / 3});
  Surface surface(plane);
  // The border and a line across.
  for (const auto e : surface.mesh.edges())
  {
    const Point& a = upright.points[surface.mesh.vertex(e, 0)];
    const Point& b = upright.points[surface.mesh.vertex(e, 1)];
    surface.is_critical[e] = surface.mesh.is_border(e) || (a[0] == b[0] && std::abs(a[0] - 0.65) < 1e-9);
  }
  // The corners of the plate are sharp; otherwise the curve would go round them.
  const auto is_sharp = surface.mesh.add_property_map<Mesh::Vertex_index, bool>("v:sharp", false).first;
  for (const auto v : surface.mesh.vertices())
    is_sharp[v] = surface.mesh.degree(v) == 2 ||
                  (std::abs(upright.points[v][0] - 0.65) > 0.6 && std::abs(upright.points[v][1] - 0.4) > 0.39);
  const Curves curves = trace_feature_curves(surface.mesh, surface.is_critical, is_sharp);
  CHECK(curves.size() == 7);
  reconstruct_surface(surface.mesh, surface.fits, {.degree = 4},
                      CGAL::parameters::edge_is_constrained_map(surface.is_critical));
  Surface_nodes<Mesh> nodes(surface.mesh, degree);
  const Surface_nodes<Mesh> straight = nodes;
  const Curving_surface_report report =
    curve_surface(surface.mesh, surface.fits, curves, nodes.edge_map(), nodes.face_map(), {.degree = degree});
  CHECK(report.curve_edges > 0);
  CHECK(report.moved_edge_nodes == 0);
  CHECK(report.moved_face_nodes == 0);
  CHECK(report.largest_displacement == 0);
  CHECK(is_equal(nodes, straight));
}

TEST_CASE("the rim of a disc is round, its plane stays a plane, its faces stay unfolded", "[curve_surface]")
{
  const int degree = GENERATE(2, 3, 4, 6);
  CAPTURE(degree);
  constexpr int around = 12, rings = 3;
  Surface plate(disc(rings, around));
  plate.mark_edges(is_on_rim);
  plate.fit(2);
  REQUIRE(plate.curves.size() == 1);
  Surface_nodes<Mesh> nodes(plate.mesh, degree);
  const Surface_nodes<Mesh> straight = nodes;
  const Curving_surface_report report = plate.curve(nodes);
  CHECK(report.curve_edges == around);
  CHECK(report.moved_edge_nodes == around * (degree - 1));
  CHECK(report.moved_face_nodes == around * (degree - 1) * (degree - 1)); // the outermost quads follow their rim

  const double sagitta = 1 - std::cos(std::numbers::pi / around);
  for (const auto e : plate.mesh.edges())
    for (int k = 1; k < degree; ++k)
    {
      const Point x = to_point(nodes.edge_node(plate.mesh.halfedge(e), k));
      CHECK(x[2] == 0);
      if (plate.is_critical[e])
        CHECK(std::abs(norm(x) - 1) < 0.02 * sagitta);
    }
  for (const auto f : plate.mesh.faces())
    for (int m = 0; m < nodes.face_node_count(f); ++m)
      CHECK(to_point(nodes.face_node(f, m))[2] == 0);

  // In an outermost quad the rows of nodes are blended between the straight inner and the round outer side.
  const auto outer = Mesh::Face_index(around * rings - 1);
  const auto first = plate.mesh.halfedge(outer);
  for (int j = 1; j < degree; ++j)
    for (int i = 1; i < degree; ++i)
    {
      const int m = (i - 1) + (j - 1) * (degree - 1);
      const Point way = difference_of(to_point(nodes.face_node(outer, m)), to_point(straight.face_node(outer, m)));
      // Which side of the canonical quad is the rim depends on where the face starts.
      std::array<int, 4> distance = {j, degree - i, degree - j, i};
      std::array<int, 4> node = {i, j, degree - i, degree - j};
      auto h = first;
      for (std::size_t side = 0; side < 4; ++side, h = plate.mesh.next(h))
        if (plate.is_critical[plate.mesh.edge(h)])
        {
          const Point rim =
            difference_of(to_point(nodes.edge_node(h, node[side])), to_point(straight.edge_node(h, node[side])));
          const Point expected = test_surfaces::scaled(1 - static_cast<double>(distance[side]) / degree, rim);
          CHECK(norm(difference_of(way, expected)) < 1e-15);
        }
    }
}

TEST_CASE("a cubic triangle at a round rim takes a quarter of each of its rim's displacements", "[curve_surface]")
{
  // A displacement along the rim is la lb f(lb - la) with a linear f, at its nodes 2/9 f(-1/3) and 2/9 f(1/3); at the
  // centroid it is 1/9 f(0), a quarter of their sum.
  Surface plate(disc(1, 8));
  plate.mark_edges(is_on_rim);
  plate.fit(2);
  Surface_nodes<Mesh> nodes(plate.mesh, 3);
  const Surface_nodes<Mesh> straight = nodes;
  CHECK(plate.curve(nodes).moved_face_nodes == 8);
  for (const auto h : plate.mesh.halfedges())
  {
    if (plate.mesh.is_border(h) || !plate.is_critical[plate.mesh.edge(h)])
      continue;
    Point expected = to_point(straight.face_node(plate.mesh.face(h), 0));
    for (int k = 1; k <= 2; ++k)
    {
      const Point way = difference_of(to_point(nodes.edge_node(h, k)), to_point(straight.edge_node(h, k)));
      expected = moved(expected, test_surfaces::scaled(1.0 / 4, way));
    }
    const Point found = to_point(nodes.face_node(plate.mesh.face(h), 0));
    CHECK(norm(difference_of(found, expected)) < 1e-15);
    CHECK(found[2] == 0);
  }
}

TEST_CASE("curves of two or more edges take the spline, one-edge curves the fits", "[curve_surface]")
{
  // A cylinder's open end: half its border is one curve, two single edges are curves of their own, the rest is none.
  constexpr int around = 16;
  Polygons tube;
  for (int j = 0; j <= 6; ++j)
    for (int i = 0; i < around; ++i)
      tube.points.push_back(
        {std::cos(2 * std::numbers::pi * i / around), std::sin(2 * std::numbers::pi * i / around), 0.4 * j});
  for (int j = 0; j < 6; ++j)
    for (int i = 0; i < around; ++i)
      tube.faces.push_back(
        {i + j * around, (i + 1) % around + j * around, (i + 1) % around + (j + 1) * around, i + (j + 1) * around});
  Surface surface(tube);
  surface.fit(2);
  const auto border = [&](int i) {
    return surface.mesh.halfedge(Mesh::Vertex_index(static_cast<unsigned>(i)),
                                 Mesh::Vertex_index(static_cast<unsigned>((i + 1) % around)));
  };
  Curves curves(2);
  for (int i = 0; i < 6; ++i)
    curves[0].halfedges.push_back(border(i));
  curves[1].halfedges.push_back(border(9));
  Surface_nodes<Mesh> with_curves(surface.mesh, 3), without(surface.mesh, 3);
  const auto report =
    curve_surface(surface.mesh, surface.fits, curves, with_curves.edge_map(), with_curves.face_map(), {.degree = 3});
  curve_surface(surface.mesh, surface.fits, Curves{}, without.edge_map(), without.face_map(), {.degree = 3});
  CHECK(report.curve_edges == 6);
  std::vector<Point> points;
  for (int i = 0; i <= 6; ++i)
    points.push_back(tube.points[static_cast<std::size_t>(i)]);
  const Curve_spline spline(points, false, {.method = Curve_method::cubic_spline});
  for (int i = 0; i < around; ++i)
    for (int k = 1; k <= 2; ++k)
    {
      const Point x = to_point(with_curves.edge_node(border(i), k));
      if (i < 6)
        CHECK(norm(difference_of(x, spline(i, k / 3.0))) < 1e-14);
      else
        CHECK(x == to_point(without.edge_node(border(i), k)));
    }
}

TEST_CASE("curves may run against the half-edges that name their edges", "[curve_surface]")
{
  Surface forward(disc(2, 10));
  forward.mark_edges(is_on_rim);
  forward.fit(2);
  Surface backward = forward;
  for (auto& curve : backward.curves)
  {
    std::reverse(curve.halfedges.begin(), curve.halfedges.end());
    for (auto& h : curve.halfedges)
      h = backward.mesh.opposite(h);
  }
  Surface_nodes<Mesh> a(forward.mesh, 5), b(backward.mesh, 5);
  forward.curve(a);
  backward.curve(b);
  for (std::size_t i = 0; i < a.edge_nodes().size(); ++i)
    CHECK(norm(difference_of(to_point(a.edge_nodes()[i]), to_point(b.edge_nodes()[i]))) < 1e-14);
}

TEST_CASE("each node is written at most once, by the edge's own half-edge", "[curve_surface]")
{
  Surface sphere(icosphere(1));
  sphere.fit(2);
  std::set<std::pair<unsigned, int>> seen;
  Surface_nodes<Mesh> nodes(sphere.mesh, 3);
  curve_surface(sphere.mesh, sphere.fits, Curves{}, Logging_map{&seen}, nodes.face_map(), {.degree = 3});
  CHECK(seen.size() == 2 * sphere.mesh.number_of_edges());
}

TEST_CASE("the number of threads changes no bit of the nodes", "[curve_surface]")
{
  Surface sphere(cubed_sphere(12));
  sphere.fit(3);
  const auto on_threads = [&](std::size_t threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    Surface_nodes<Mesh> nodes(sphere.mesh, 3);
    sphere.curve(nodes);
    return nodes;
  };
  const auto alone = on_threads(1);
  CHECK(is_equal(alone, on_threads(2)));
  CHECK(is_equal(alone, on_threads(7)));
}

TEST_CASE("degenerate surfaces can be curved", "[curve_surface]")
{
  SECTION("no face")
  {
    Surface nothing{Polygons{}};
    nothing.fit(2);
    Surface_nodes<Mesh> nodes(nothing.mesh, 3);
    CHECK(nothing.curve(nodes).moved_edge_nodes == 0);
  }
  SECTION("one triangle")
  {
    Surface one(Polygons{{{0, 0, 0}, {1, 0, 0.5}, {0, 1, 0.2}}, {{0, 1, 2}}});
    one.fit(2);
    Surface_nodes<Mesh> nodes(one.mesh, 6);
    const Curving_surface_report report = one.curve(nodes);
    CHECK(report.faces == 1);
    CHECK(report.moved_edge_nodes + report.moved_face_nodes == 0);
  }
  SECTION("degree 1 has no nodes")
  {
    Surface sphere(icosphere(1));
    sphere.fit(2);
    Surface_nodes<Mesh> nodes(sphere.mesh, 1);
    CHECK(sphere.curve(nodes).moved_edge_nodes == 0);
  }
  SECTION("a face without area stays straight, its neighbours do not")
  {
    Polygons polygons = icosphere(2);
    const std::vector<int> face = polygons.faces[0];
    polygons.points[static_cast<std::size_t>(face[0])] = polygons.points[static_cast<std::size_t>(face[1])];
    Surface sphere(polygons);
    sphere.fit(2);
    Surface_nodes<Mesh> nodes(sphere.mesh, 3);
    const Surface_nodes<Mesh> straight = nodes;
    CHECK(sphere.curve(nodes).moved_face_nodes == static_cast<Index>(sphere.mesh.number_of_faces()) - 2);
    CHECK(nodes.face_node(Mesh::Face_index(0), 0) == straight.face_node(Mesh::Face_index(0), 0));
    for (const Point_3& x : nodes.edge_nodes())
      CHECK(std::isfinite(norm(to_point(x))));
  }
}

TEST_CASE("curve_surface refuses wrong input before it writes anything", "[curve_surface]")
{
  Surface sphere(icosphere(1));
  sphere.fit(2);
  Surface_nodes<Mesh> nodes(sphere.mesh, 2);
  const auto run = [&](int degree) {
    curve_surface(sphere.mesh, sphere.fits, Curves{}, nodes.edge_map(), nodes.face_map(), {.degree = degree});
  };
  CHECK_THROWS_AS(run(0), Input_error);
  CHECK_THROWS_AS(run(7), Input_error);
  Surface pentagon(Polygons{{{0, 0, 0}, {1, 0, 0}, {1.5, 1, 0.1}, {0.5, 1.5, 0}, {-0.5, 1, 0}}, {{0, 1, 2, 3, 4}}});
  pentagon.fit(2); // fits take any polygon
  CHECK_THROWS_AS(curve_surface(pentagon.mesh, pentagon.fits, Curves{}, nodes.edge_map(), nodes.face_map()),
                  Input_error);
}
