#include "support/feature_check.h"

#include <recurve/features/edit_features.h>

#include <CGAL/boost/graph/graph_traits_PolyMesh_ArrayKernelT.h>
#include <CGAL/boost/graph/graph_traits_TriMesh_ArrayKernelT.h>
#include <OpenMesh/Core/Mesh/PolyMesh_ArrayKernelT.hh>
#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>

#include <CGAL/Polyhedron_3.h>
#include <CGAL/boost/graph/copy_face_graph.h>

#include <catch2/catch.hpp>

#include <cmath>
#include <map>
#include <random>
#include <set>

using namespace recurve;
using namespace recurve::test;
using Catch::Matchers::Contains;

namespace {

using Kind = Feature_edit_kind;
using Edits = std::vector<Feature_edit>;

/// edges as pairs of points, smaller one first.
using Edge_set = std::set<std::pair<Point, Point>>;
using Point_set = std::set<Point>;

std::vector<Vertex_name> at(const std::vector<Point>& points)
{
  std::vector<Vertex_name> names;
  names.reserve(points.size());
  for (const Point& p : points)
    names.push_back({.position = p});
  return names;
}

/// the single edges of a line through `points`.
Feature_edit line(const std::vector<Point>& points, bool is_added = true)
{
  Feature_edit edit{.kind = Kind::edges, .is_added = is_added};
  for (std::size_t i = 0; i + 1 < points.size(); ++i)
    for (const Point& p : {points[i], points[i + 1]})
      edit.vertices.push_back({.position = p});
  return edit;
}

template <class Graph>
Point point_of(const Graph& g, typename boost::graph_traits<Graph>::vertex_descriptor v)
{
  const auto p = get(get(CGAL::vertex_point, g), v);
  return {CGAL::to_double(p[0]), CGAL::to_double(p[1]), CGAL::to_double(p[2])};
}

/// The flags of any model, to be edited.
template <class Graph>
struct Flags
{
  explicit Flags(const Graph& graph) : g(graph)
  {
    for (const auto e : CGAL::make_range(edges(g)))
      edge_flags[e] = 0;
    for (const auto v : CGAL::make_range(vertices(g)))
      vertex_flags[v] = false;
  }

  Feature_edit_report apply(const Edits& edits, const Feature_edit_options& options = {})
  {
    return apply_feature_edits(g, edits, boost::associative_property_map(edge_flags),
                               boost::associative_property_map(vertex_flags), options);
  }

  Edge_set critical() const
  {
    Edge_set result;
    for (const auto& [e, flag] : edge_flags)
      if (flag)
        result.insert(std::minmax({point_of(g, source(e, g)), point_of(g, target(e, g))}));
    return result;
  }

  Point_set sharp() const
  {
    Point_set result;
    for (const auto& [v, flag] : vertex_flags)
      if (flag)
        result.insert(point_of(g, v));
    return result;
  }

  const Graph& g;
  std::map<typename boost::graph_traits<Graph>::edge_descriptor, char> edge_flags;
  std::map<typename boost::graph_traits<Graph>::vertex_descriptor, bool> vertex_flags;
};

Surface flat_sheet(int n = 4)
{
  return rough_sheet(n, 0, Split::quads, 1);
}

double length(const Edge_set& edges)
{
  double sum = 0;
  for (const auto& [a, b] : edges)
    sum += std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
  return sum;
}

} // namespace

TEST_CASE("apply_feature_edits: a curve that grows edge by edge is sharp where it turns")
{
  const Mesh mesh = to_mesh(flat_sheet());
  Flags s(mesh);
  const Edits edits = {line({{0, 2, 0}, {1, 2, 0}}), line({{1, 2, 0}, {2, 2, 0}}), line({{2, 2, 0}, {2, 3, 0}})};
  const Feature_edit_report report = s.apply(edits);
  CHECK(s.critical() == Edge_set{{{0, 2, 0}, {1, 2, 0}}, {{1, 2, 0}, {2, 2, 0}}, {{2, 2, 0}, {2, 3, 0}}});
  CHECK(s.sharp() == Point_set{{2, 2, 0}});
  REQUIRE(report.edits.size() == 3);
  CHECK(report.edits[0].turnings.empty());
  REQUIRE(report.edits[1].turnings.size() == 1);
  CHECK(report.edits[1].turnings[0].angle == Approx(0).margin(1e-9));
  CHECK_FALSE(report.edits[1].turnings[0].is_sharp);
  REQUIRE(report.edits[2].turnings.size() == 1);
  CHECK(report.edits[2].turnings[0].angle == Approx(90));
  CHECK(report.edits[2].turnings[0].is_sharp);
  CHECK(report.edits[2].sharpened == 1);
  CHECK(report.edits[2].length == Approx(1));

  Flags tolerant(mesh);
  tolerant.apply(edits, {.turning_angle = 91});
  CHECK(tolerant.sharp().empty());
}

TEST_CASE("apply_feature_edits: curves that cross are sharp where they do, until one is taken away")
{
  const Mesh mesh = to_mesh(flat_sheet());
  Flags s(mesh);
  s.apply({line({{0, 2, 0}, {1, 2, 0}, {2, 2, 0}, {3, 2, 0}, {4, 2, 0}})});
  CHECK(s.sharp().empty());
  s.apply({line({{2, 2, 0}, {2, 3, 0}})});
  CHECK(s.sharp() == Point_set{{2, 2, 0}});
  const auto report = s.apply({line({{2, 3, 0}, {2, 2, 0}}, false)});
  CHECK(s.sharp().empty());
  CHECK(s.critical().size() == 4);
  CHECK(report.edits[0].smoothed == 1);
  CHECK(report.edits[0].changed_edges == 1);
}

TEST_CASE("apply_feature_edits: a vertex that is named has the last word")
{
  const Mesh mesh = to_mesh(flat_sheet());
  Flags s(mesh);
  s.apply({{.kind = Kind::vertices, .is_added = false, .vertices = at({{1, 1, 0}})},
           {.kind = Kind::vertices, .vertices = at({{3, 1, 0}, {4, 4, 0}})},
           line({{1, 0, 0}, {1, 1, 0}, {2, 1, 0}, {3, 1, 0}})});
  CHECK(s.sharp() == Point_set{{3, 1, 0}, {4, 4, 0}});
}

TEST_CASE("apply_feature_edits: a corner without curves stays sharp when its edges go")
{
  const Mesh mesh = to_mesh(cube(2, Split::quads));
  Flags s(mesh);
  s.apply({{.kind = Kind::box, .smallest = {0, 0, 0}, .largest = {1, 1, 1}, .angle = 45}});
  CHECK(s.critical().size() == 24);
  CHECK(s.sharp().size() == 8);
  s.apply({{.kind = Kind::box, .is_added = false, .smallest = {0, 0, 0}, .largest = {1, 1, 1}}});
  CHECK(s.critical().empty());
  CHECK(s.sharp().size() == 8); // 90 degrees are missing at each
}

TEST_CASE("apply_feature_edits: the shortest way along edges is as short as another method finds")
{
  const unsigned seed = std::random_device()();
  CAPTURE(seed);
  const Mesh mesh = to_mesh(rough_sheet(7, 0.8, Split::alternating, seed));
  std::mt19937 random(seed);
  for (int trial = 0; trial < 10; ++trial)
  {
    const auto any = [&] { return Mesh::Vertex_index(static_cast<Mesh::size_type>(random() % mesh.num_vertices())); };
    const auto a = any(), b = any();
    if (a == b)
      continue;
    std::vector<double> distance(mesh.num_vertices(),
                                 1e300); // Bellman and Ford's relaxation of all edges, again and again
    distance[a.idx()] = 0;
    for (std::size_t round = 0; round < mesh.num_vertices(); ++round)
      for (const auto h : mesh.halfedges())
      {
        const double l = std::sqrt(CGAL::squared_distance(mesh.point(mesh.source(h)), mesh.point(mesh.target(h))));
        distance[mesh.target(h).idx()] = std::min(distance[mesh.target(h).idx()], distance[mesh.source(h).idx()] + l);
      }
    Flags s(mesh);
    s.apply({{.kind = Kind::shortest_path, .vertices = at({point_of(mesh, a), point_of(mesh, b)})}});
    CHECK(length(s.critical()) == Approx(distance[b.idx()]));
  }
}

TEST_CASE("apply_feature_edits: a way along the crease follows the rim that the shortest way cuts short")
{
  const Mesh mesh = to_mesh(cylinder(32, 4, true, Split::quads));
  Flags s(mesh);
  std::vector<Point> rim;
  for (const auto v : mesh.vertices())
    if (const Point p = point_of(mesh, v); near(p[2], 2) && near(std::hypot(p[0], p[1]), 1))
      rim.push_back(p);
  REQUIRE(rim.size() == 32);
  const auto by_x = [](const Point& a, const Point& b) { return a[0] < b[0]; };
  const auto ends =
    at({*std::min_element(rim.begin(), rim.end(), by_x), *std::max_element(rim.begin(), rim.end(), by_x)});
  s.apply({{.kind = Kind::shortest_path, .vertices = ends}});
  CHECK(length(s.critical()) == Approx(2)); // across the cap
  Flags t(mesh);
  const auto report = t.apply({{.kind = Kind::crease_path, .vertices = ends}});
  CHECK(t.critical().size() == 16);
  CHECK(length(t.critical()) == Approx(16 * 2 * std::sin(pi / 32)));
  CHECK(t.sharp().empty());
  REQUIRE(report.edits[0].turnings.size() == 15);
  for (const Curve_turning& turning : report.edits[0].turnings)
    CHECK(turning.angle == Approx(360. / 32));
  // Taking it away again leads along critical edges, by whichever rule.
  t.apply({{.kind = Kind::shortest_path, .is_added = false, .vertices = ends}});
  CHECK(t.critical().empty());
}

TEST_CASE("apply_feature_edits: way points lead a path around")
{
  const Mesh mesh = to_mesh(flat_sheet());
  Flags s(mesh);
  s.apply({{.kind = Kind::shortest_path, .vertices = at({{0, 0, 0}, {0, 4, 0}, {4, 4, 0}, {4, 0, 0}})}});
  CHECK(s.critical().size() == 12);
  CHECK(s.sharp() == Point_set{{0, 4, 0}, {4, 4, 0}});
}

TEST_CASE("apply_feature_edits: a chain grows until the dihedral angle drops, and goes as it came")
{
  const Mesh mesh = to_mesh(crease([](double x) { return 40 * (1 - x); }, Split::quads)); // 16 edges along x
  const Point a = {0.125, 0, 0}, b = {0.1875, 0, 0};
  Flags s(mesh);
  s.apply({{.kind = Kind::chain, .vertices = at({a, b}), .angle = 20}});
  CHECK(s.critical().size() == 8); // 21 degrees in the middle of the eighth, 19 in that of the ninth
  for (const auto& [p, q] : s.critical())
    CHECK((p[1] == 0 && q[1] == 0 && q[0] <= 0.5));
  s.apply({{.kind = Kind::chain, .is_added = false, .vertices = at({b, a})}});
  CHECK(s.critical().empty());

  const Mesh round = to_mesh(cylinder(24, 4, true, Split::same));
  for (const double angle : {30., 80.})
  {
    Flags rim(round);
    const Point p = point_of(round, *round.vertices().begin());
    const auto h = *std::find_if(round.halfedges().begin(), round.halfedges().end(), [&](auto candidate) {
      const Point from = point_of(round, round.source(candidate)), to = point_of(round, round.target(candidate));
      return from == p && near(to[2], from[2]) && near(std::hypot(to[0], to[1]), 1);
    });
    rim.apply({{.kind = Kind::chain, .vertices = at({p, point_of(round, round.target(h))}), .angle = angle}});
    CHECK(rim.critical().size() == 24);
    CHECK(rim.sharp().empty());
  }
}

TEST_CASE("apply_feature_edits: boxes and patch pairs; pinned edges stay")
{
  Mesh mesh = to_mesh(cube(2, Split::quads));
  auto critical = mesh.add_property_map<Mesh::Edge_index, char>("c", 0).first;
  auto sharp = mesh.add_property_map<Mesh::Vertex_index, bool>("s", false).first;
  auto pinned = mesh.add_property_map<Mesh::Edge_index, bool>("p", false).first;
  auto patch = mesh.add_property_map<Mesh::Face_index, int>("f", 0).first;
  for (const auto f : mesh.faces())
  {
    double z = 0;
    for (const auto v : mesh.vertices_around_face(mesh.halfedge(f)))
      z += mesh.point(v).z();
    patch[f] = z == 0 ? 1 : z == 4 ? 2 : 3; // bottom, top, sides
  }
  const auto params = CGAL::parameters::face_patch_map(patch).edge_is_constrained_map(pinned);
  const auto count = [&] {
    return std::count_if(mesh.edges().begin(), mesh.edges().end(), [&](auto e) { return critical[e] != 0; });
  };
  const auto apply = [&](const Edits& edits) { return apply_feature_edits(mesh, edits, critical, sharp, {}, params); };

  apply({{.kind = Kind::patches, .patches = {3, 1}}});
  CHECK(count() == 8);
  apply({{.kind = Kind::patches, .patches = {2, no_index}}});
  CHECK(count() == 16);
  for (const auto e : mesh.edges())
    pinned[e] = critical[e] && mesh.point(mesh.vertex(e, 0)).z() == 0;
  const auto report = apply({{.kind = Kind::box, .is_added = false, .smallest = {0, 0, 0}, .largest = {1, 1, 1}}});
  CHECK(count() == 8);
  CHECK(report.edits[0].pinned_edges == 8);
  CHECK(report.edits[0].changed_edges == 8);
  CHECK_THROWS_WITH(apply({{.kind = Kind::patches, .patches = {1, 2}}}), Contains("share no edge"));
  CHECK_THROWS_WITH(apply({line({{0, 0, 0}, {0.5, 0, 0}}, false)}), Contains("constrained"));
}

TEST_CASE("apply_feature_edits: refuses what is not there or contradicts, and changes nothing then")
{
  const Mesh mesh = to_mesh(flat_sheet());
  Flags s(mesh);
  const auto fails = [&](const Edits& edits, const auto&... words) {
    Edits all = {line({{1, 1, 0}, {2, 1, 0}})}; // valid, and must not be applied
    all.insert(all.end(), edits.begin(), edits.end());
    for (const std::string& word : {std::string(words)...})
      CHECK_THROWS_WITH(s.apply(all), Contains(word));
    CHECK_THROWS_AS(s.apply(all), Input_error);
    CHECK(s.critical().empty());
    CHECK(s.sharp().empty());
  };
  fails({line({{1, 1.1, 0}, {2, 1, 0}})}, "edit 2: there is no vertex at [1, 1.1000000000000001, 0]",
        "nearest are at [1, 1, 0]");
  fails({line({{1, 1, 0}, {3, 1, 0}})}, "no edge between [1, 1, 0] and [3, 1, 0]", "edges lead to [2, 1, 0]");
  fails({{.kind = Kind::edges, .vertices = at({{1, 1, 0}}), .origin = "wing.toml, line 7"}},
        "wing.toml, line 7: edges");
  fails({line({{3, 1, 0}, {3, 2, 0}}), line({{3, 2, 0}, {3, 1, 0}}, false)}, "edit 3: the edge between",
        "edit 2 says that it is added");
  fails({{.kind = Kind::vertices, .vertices = at({{1, 1, 0}})},
         {.kind = Kind::vertices, .is_added = false, .vertices = at({{1, 1, 0}})}},
        "unmarked", "edit 2");
  fails({line({{0, 0, 0}, {0, 1, 0}}, false)}, "border");
  fails({{.kind = Kind::vertices}}, "no vertex");
  fails({{.kind = Kind::vertices, .vertices = {{.numbers = {25}}}}}, "from 0 to 24");
  fails({{.kind = Kind::vertices, .vertices = {{.position = {1, 1, 0}, .copy = 1}}}}, "copy 1");
  fails({{.kind = Kind::shortest_path, .vertices = at({{0, 0, 0}})}}, "way points");
  fails({{.kind = Kind::crease_path, .vertices = at({{0, 0, 0}, {0, 0, 0}})}}, "way points");
  fails({{.kind = Kind::shortest_path, .is_added = false, .vertices = at({{0, 0, 0}, {0, 2, 0}})}}, "critical edges");
  fails({{.kind = Kind::chain, .vertices = at({{1, 2, 0}, {2, 2, 0}})}}, "dihedral angle of 0");
  fails({{.kind = Kind::box, .smallest = {0, 0, 1}, .largest = {4, 4, 2}}}, "no edge is inside", "nearest");
  fails({{.kind = Kind::box, .smallest = {0, 0, 1}, .largest = {4, 4, 0}}}, "empty");
  fails({{.kind = Kind::patches, .patches = {0, 1}}}, "face_patch_map");
  fails({{.kind = Kind::chain, .vertices = at({{0, 0, 0}, {1, 0, 0}}), .angle = 181}}, "angle");
  CHECK_THROWS_AS(s.apply({}, {.turning_angle = -1}), Input_error);
  CHECK_THROWS_AS(s.apply({}, {.tolerance = -1}), Input_error);
}

TEST_CASE("apply_feature_edits: a position that was typed means the one vertex near it, if a tolerance says so")
{
  Surface surface = flat_sheet();
  for (Point& p : surface.points)
    p[2] += 1e-9;
  const Mesh mesh = to_mesh(surface);
  Flags s(mesh);
  const Edits typed = {line({{1, 1, 0}, {2, 1.001, 0}})};
  CHECK_THROWS_WITH(s.apply(typed), Contains("no vertex at [1, 1, 0]"));
  CHECK_THROWS_WITH(s.apply(typed, {.tolerance = 1e-4}), Contains("no vertex at [2, 1.0009999999999999, 0]"));
  CHECK_THROWS_WITH(s.apply(typed, {.tolerance = 2}),
                    Contains("several vertices are within the tolerance of [1, 1, 0]"));
  CHECK(s.critical().empty());
  s.apply(typed, {.tolerance = 0.01});
  CHECK(s.critical() == Edge_set{{{1, 1, 1e-9}, {2, 1, 1e-9}}});
}

namespace {

struct Double_traits : OpenMesh::DefaultTraits
{
  using Point = OpenMesh::Vec3d;
  using Normal = OpenMesh::Vec3d;
};
using Open_mesh = OpenMesh::PolyMesh_ArrayKernelT<Double_traits>;
using Open_triangle_mesh = OpenMesh::TriMesh_ArrayKernelT<Double_traits>;

template <class OpenMeshType>
OpenMeshType to_open_mesh(const Surface& surface)
{
  OpenMeshType open;
  std::vector<typename OpenMeshType::VertexHandle> handles, corners;
  for (const Point& p : surface.points)
    handles.push_back(open.add_vertex({p[0], p[1], p[2]}));
  for (const auto& face : surface.faces)
  {
    corners.clear();
    for (const std::size_t v : face)
      corners.push_back(handles[v]);
    open.add_face(corners);
  }
  return open;
}

} // namespace

TEST_CASE("apply_feature_edits: equal on OpenMesh's triangle meshes")
{
  const Surface surface = rough_sheet(6, 0.2, Split::same, 5);
  const Mesh mesh = to_mesh(surface);
  const Edits edits = {{.kind = Kind::crease_path, .vertices = at({surface.points[0], surface.points[44]})},
                       {.kind = Kind::chain, .vertices = at({surface.points[8], surface.points[9]}), .angle = 1},
                       {.kind = Kind::box, .smallest = {2, 2, -9}, .largest = {4, 5, 9}}};
  Flags expected(mesh);
  expected.apply(edits);
  CHECK(expected.critical().size() > 10);
  const auto open = to_open_mesh<Open_triangle_mesh>(surface);
  Flags on_open(open);
  on_open.apply(edits);
  CHECK(on_open.critical() == expected.critical());
  CHECK(on_open.sharp() == expected.sharp());
}

TEST_CASE("apply_feature_edits: equal on all models of a graph, however it is scaled, and again")
{
  const Surface surface = rough_sheet(6, 0.2, Split::quads, 5);
  const Mesh mesh = to_mesh(surface);
  const auto corner = [&](std::size_t i) { return surface.points[i % surface.points.size()]; };
  const Edits edits = {{.kind = Kind::crease_path, .vertices = at({corner(0), corner(30), corner(44)})},
                       {.kind = Kind::shortest_path, .vertices = at({corner(3), corner(40)})},
                       {.kind = Kind::box, .smallest = {2, 2, -9}, .largest = {4, 5, 9}}};
  Flags expected(mesh);
  expected.apply(edits);
  CHECK(expected.critical().size() > 10);
  CHECK_FALSE(expected.sharp().empty());
  const auto again = expected.critical();
  expected.apply(edits);
  CHECK(expected.critical() == again);

  CGAL::Polyhedron_3<Kernel> polyhedron;
  CGAL::copy_face_graph(mesh, polyhedron);
  Flags on_polyhedron(polyhedron);
  on_polyhedron.apply(edits);
  CHECK(on_polyhedron.critical() == expected.critical());
  CHECK(on_polyhedron.sharp() == expected.sharp());

  const auto open = to_open_mesh<Open_mesh>(surface);
  Flags on_open(open);
  on_open.apply(edits);
  CHECK(on_open.critical() == expected.critical());
  CHECK(on_open.sharp() == expected.sharp());

  for (const double scale : {0x1p-20, 0x1p20}) // exact, so that the same ways are shortest
  {
    const auto scaled = [&](Point p) { return Point{scale * p[0], scale * p[1], scale * p[2]}; };
    Surface other = surface;
    for (Point& p : other.points)
      p = scaled(p);
    Edits scaled_edits = edits;
    for (Feature_edit& edit : scaled_edits)
    {
      edit.smallest = scaled(edit.smallest);
      edit.largest = scaled(edit.largest);
      for (Vertex_name& name : edit.vertices)
        name.position = scaled(name.position);
    }
    const Mesh scaled_mesh = to_mesh(other);
    Flags s(scaled_mesh);
    s.apply(scaled_edits);
    Edge_set scaled_edges;
    for (const auto& [p, q] : expected.critical())
      scaled_edges.insert({scaled(p), scaled(q)});
    CHECK(s.critical() == scaled_edges);
  }
}

TEST_CASE("apply_feature_edits: an empty surface and an empty list")
{
  const Mesh empty;
  Flags s(empty);
  CHECK(s.apply({}).edits.empty());
  CHECK_THROWS_AS(s.apply({line({{0, 0, 0}, {1, 0, 0}})}), Input_error);
  const Mesh sheet = to_mesh(flat_sheet());
  Flags t(sheet);
  CHECK(t.apply({}).edits.empty());
  CHECK(t.critical().empty());
}

TEST_CASE("apply_feature_edits: where vertices have one position, its name means all of them, or one by its number")
{
  Surface surface = flat_sheet();
  const std::size_t n = surface.points.size();
  const auto faces = surface.faces;
  surface.points.insert(surface.points.end(), surface.points.begin(), surface.points.begin() + std::ptrdiff_t(n));
  for (auto face : faces)
  {
    for (std::size_t& v : face)
      v += n;
    surface.faces.push_back(face);
  }
  const Mesh mesh = to_mesh(surface);
  const auto count = [](const auto& flags) {
    return std::count_if(flags.begin(), flags.end(), [](const auto& entry) { return entry.second; });
  };
  Flags s(mesh);
  s.apply({line({{1, 1, 0}, {2, 1, 0}}), {.kind = Kind::vertices, .vertices = at({{3, 3, 0}})}});
  CHECK(count(s.edge_flags) == 2);
  CHECK(count(s.vertex_flags) == 2);

  Flags t(mesh);
  Feature_edit second = line({{1, 1, 0}, {2, 1, 0}});
  second.vertices[0].copy = 1;
  t.apply({second, {.kind = Kind::vertices, .vertices = {{.position = {3, 3, 0}, .copy = 0}}}});
  CHECK(count(t.edge_flags) == 1);
  CHECK(count(t.vertex_flags) == 1);
  for (const auto& [v, is_sharp] : t.vertex_flags)
    CHECK(is_sharp == (v.idx() < n && point_of(mesh, v) == Point{3, 3, 0}));
  for (const auto& [e, flag] : t.edge_flags)
    CHECK((!flag || mesh.vertex(e, 0).idx() >= n));
}
