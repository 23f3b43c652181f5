#include "support/feature_check.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <limits>
#include <set>

using namespace recurve;
using namespace recurve::test;

namespace {

/// The flagged edges as pairs of vertex numbers, and the flagged vertices.
struct Flags
{
  std::set<std::pair<std::size_t, std::size_t>> edges;
  std::set<std::size_t> vertices;
  bool operator==(const Flags&) const = default;
};

Flags flags_of(const Detection& d, const std::vector<std::size_t>& old_number = {})
{
  const auto number = [&](std::size_t v) { return old_number.empty() ? v : old_number[v]; };
  Flags flags;
  for (const auto e : d.mesh.edges())
    if (d.edge_is_critical[e.idx()])
      flags.edges.insert(std::minmax(number(d.mesh.vertex(e, 0).idx()), number(d.mesh.vertex(e, 1).idx())));
  for (const auto v : d.mesh.vertices())
    if (d.vertex_is_sharp[v.idx()])
      flags.vertices.insert(number(v.idx()));
  return flags;
}

std::vector<Surface> assorted_surfaces()
{
  return {cube(3, Split::same),
          cylinder(12, 4, true, Split::alternating),
          cone(24, 1.7, Split::quads),
          uv_sphere(16, 8, Split::same),
          wing(16, false, Split::same),
          frustum_joint(20, 24, Split::quads),
          crease([](double x) { return 90 * (1 - x); }, Split::alternating),
          roughen(cube(8, Split::same), 0.03, 11),
          roughen(icosphere(3), 0.03, 12)};
}

Surface transformed(Surface s, const std::function<Point(const Point&)>& f)
{
  for (Point& p : s.points)
    p = f(p);
  s.is_feature = [](const Point&, const Point&) { return false; };
  return s;
}

struct Flagged
{
  Mesh mesh;
  Mesh::Property_map<Mesh::Edge_index, bool> critical;
  Mesh::Property_map<Mesh::Vertex_index, bool> sharp;

  explicit Flagged(Mesh m) : mesh(std::move(m))
  {
    critical = mesh.add_property_map<Mesh::Edge_index, bool>("e:critical", true).first;
    sharp = mesh.add_property_map<Mesh::Vertex_index, bool>("v:sharp", true).first;
  }
};

} // namespace

TEST_CASE("detect_features: the dihedral method is the plain test")
{
  for (const double degrees : {20., 40.})
  {
    const Surface s = crease([=](double) { return degrees; }, Split::quads);
    const auto hits = [&](double threshold) {
      return detect(s, {.method = Feature_method::dihedral, .dihedral_angle = threshold}).score.hits;
    };
    CHECK(hits(degrees - 0.001) == 16);
    CHECK(hits(degrees + 0.001) == 0);
  }
}

TEST_CASE("detect_features: without a method only the borders are left")
{
  const auto d = detect(rough_sheet(4, 0, Split::same, 1), {.method = Feature_method::none});
  CHECK(d.report.critical_edges == 16);
  CHECK(d.report.sharp_vertices == 4);
  CHECK(detect(cube(2, Split::same), {.method = Feature_method::none}).report.sharp_vertices == 0);
}

TEST_CASE("detect_features: both maps are written completely, a second call is equal")
{
  const Surface s = cylinder(24, 4, true, Split::same);
  Flagged f(to_mesh(s));
  const Mesh before = f.mesh;
  const auto report = detect_features(f.mesh, f.critical, f.sharp);
  CHECK(report.critical_edges == 48);
  CHECK(std::count_if(f.mesh.edges().begin(), f.mesh.edges().end(), [&](auto e) { return f.critical[e]; }) == 48);
  CHECK(std::none_of(f.mesh.vertices().begin(), f.mesh.vertices().end(), [&](auto v) { return f.sharp[v]; }));
  CHECK(std::equal(f.mesh.points().begin(), f.mesh.points().end(), before.points().begin()));
  const auto again = detect_features(f.mesh, f.critical, f.sharp);
  CHECK(again.critical_edges == report.critical_edges);
  CHECK(again.curves.size() == report.curves.size());
}

TEST_CASE("detect_features: nothing depends on position, attitude or unit")
{
  for (const Surface& s : assorted_surfaces())
  {
    const Flags expected = flags_of(detect(transformed(s, [](const Point& p) { return p; })));
    const auto rotated = [](const Point& p) {
      return Point{0.36 * p[0] + 0.48 * p[1] - 0.8 * p[2], -0.8 * p[0] + 0.6 * p[1],
                   0.48 * p[0] + 0.64 * p[1] + 0.6 * p[2]};
    };
    CHECK(flags_of(detect(transformed(s, rotated))) == expected);
    for (const double scale : {1e-6, 1e6})
      CHECK(flags_of(detect(transformed(s, [=](const Point& p) {
              return Point{scale * p[0], scale * p[1], scale * p[2]};
            }))) == expected);
    CHECK(flags_of(detect(transformed(s, [](const Point& p) {
            return Point{p[0] + 1e6, p[1] - 2e6, p[2] + 5e5};
          }))) == expected);
  }
}

TEST_CASE("detect_features: turning the surface inside out changes nothing")
{
  for (Surface s : assorted_surfaces())
  {
    const Flags expected = flags_of(detect(transformed(s, [](const Point& p) { return p; })));
    for (auto& face : s.faces)
      std::reverse(face.begin(), face.end());
    CHECK(flags_of(detect(transformed(s, [](const Point& p) { return p; }))) == expected);
  }
}

TEST_CASE("detect_features: nothing depends on the numbering")
{
  const unsigned seed = GENERATE(1u, 2u, 3u);
  CAPTURE(seed);
  std::mt19937 random(seed);
  for (const Surface& s : assorted_surfaces())
  {
    const Flags expected = flags_of(detect(transformed(s, [](const Point& p) { return p; })));
    std::vector<std::size_t> old_number(s.points.size()), new_number(s.points.size());
    for (std::size_t i = 0; i < old_number.size(); ++i)
      old_number[i] = i;
    std::shuffle(old_number.begin(), old_number.end(), random);
    Surface t;
    for (std::size_t i = 0; i < old_number.size(); ++i)
    {
      t.points.push_back(s.points[old_number[i]]);
      new_number[old_number[i]] = i;
    }
    t.faces = s.faces;
    for (auto& face : t.faces)
    {
      for (std::size_t& v : face)
        v = new_number[v];
      std::rotate(face.begin(), face.begin() + static_cast<std::ptrdiff_t>(random() % face.size()), face.end());
    }
    std::shuffle(t.faces.begin(), t.faces.end(), random);
    CHECK(flags_of(detect(t), old_number) == expected);
  }
}

TEST_CASE("detect_features: constrained edges are critical whatever the options")
{
  const Surface s = icosphere(3);
  Flagged f(to_mesh(s));
  auto constrained = f.mesh.add_property_map<Mesh::Edge_index, bool>("e:constrained", false).first;
  int n = 0;
  for (const auto e : f.mesh.edges())
    if (e.idx() % 7 == 0)
      constrained[e] = true, ++n;
  for (const auto method : {Feature_method::classified, Feature_method::dihedral})
  {
    const auto report = detect_features(f.mesh, f.critical, f.sharp, {.method = method, .dihedral_angle = 170},
                                        CGAL::parameters::edge_is_constrained_map(constrained));
    CHECK(report.pinned_edges == n);
    CHECK(report.critical_edges == n);
    for (const auto e : f.mesh.edges())
      CHECK(f.critical[e] == constrained[e]);
  }
}

TEST_CASE("detect_features: what is known of patches decides what angles cannot")
{
  // Five sides of one cell each: a pentagonal bar, or a coarse cylinder if its side is one patch.
  const Surface s = bar(regular_polygon(5), std::vector<int>(5, 1), 4, Split::same);
  Flagged f(to_mesh(s));
  auto patch = f.mesh.add_property_map<Mesh::Face_index, int>("f:patch").first;
  for (const auto face : f.mesh.faces())
  {
    const auto [low, high] = std::minmax({f.mesh.point(f.mesh.source(f.mesh.halfedge(face))).z(),
                                          f.mesh.point(f.mesh.target(f.mesh.halfedge(face))).z(),
                                          f.mesh.point(f.mesh.target(f.mesh.next(f.mesh.halfedge(face)))).z()});
    patch[face] = low == high ? static_cast<int>(low) : 2;
  }
  const auto params = CGAL::parameters::face_patch_map(patch);
  CHECK(detect_features(f.mesh, f.critical, f.sharp, {}, params).critical_edges == 30);
  for (const auto method : {Feature_method::classified, Feature_method::dihedral})
    CHECK(
      detect_features(f.mesh, f.critical, f.sharp, {.method = method, .smooth_patches = true}, params).critical_edges ==
      10);
  CHECK_THROWS_AS(detect_features(f.mesh, f.critical, f.sharp, {.smooth_patches = true}), Input_error);
  CHECK_THROWS_AS(detect_features(f.mesh, f.critical, f.sharp, {.patch_edges = true}), Input_error);

  // A plane of two patches has no feature inside, unless their common line is asked for.
  Flagged sheet(to_mesh(rough_sheet(4, 0, Split::quads, 1)));
  auto half = sheet.mesh.add_property_map<Mesh::Face_index, int>("f:patch").first;
  for (const auto face : sheet.mesh.faces())
    half[face] =
      CGAL::to_double(sheet.mesh.point(sheet.mesh.source(sheet.mesh.halfedge(face))).x() +
                      sheet.mesh.point(sheet.mesh.target(sheet.mesh.next(sheet.mesh.halfedge(face)))).x()) < 4;
  const auto halves = CGAL::parameters::face_patch_map(half);
  CHECK(detect_features(sheet.mesh, sheet.critical, sheet.sharp, {}, halves).critical_edges == 16);
  const auto report = detect_features(sheet.mesh, sheet.critical, sheet.sharp, {.patch_edges = true}, halves);
  CHECK(report.critical_edges == 20);
  CHECK(report.pinned_edges == 20);
  CHECK(report.sharp_vertices == 4 + 2);
}

TEST_CASE("detect_features: borders are curves, cut at their corners")
{
  const auto d = detect(rough_sheet(4, 0, Split::quads, 1));
  CHECK(d.report.critical_edges == 16);
  CHECK(d.report.sharp_vertices == 4);
  REQUIRE(d.report.curves.size() == 4);
  for (const auto& curve : d.report.curves)
  {
    CHECK(curve.is_pinned);
    CHECK(curve.length == Approx(4));
    CHECK(curve.first_end == Curve_end::corner);
  }
  const auto tube = detect(cylinder(24, 4, false, Split::same));
  CHECK(tube.report.curves.size() == 2);
  CHECK(tube.report.sharp_vertices == 0);
}

TEST_CASE("detect_features: a positions map of the caller is used")
{
  Flagged f(to_mesh(cube(2, Split::quads)));
  auto flat = f.mesh.add_property_map<Mesh::Vertex_index, Kernel::Point_3>("v:other").first;
  for (const auto v : f.mesh.vertices())
    flat[v] = f.mesh.point(v);
  for (const auto v : f.mesh.vertices())
    f.mesh.point(v) = CGAL::ORIGIN;
  CHECK(detect_features(f.mesh, f.critical, f.sharp, {}, CGAL::parameters::vertex_point_map(flat)).critical_edges ==
        24);
}

TEST_CASE("detect_features: degenerate input")
{
  SECTION("empty")
  {
    const auto d = detect(Surface{});
    CHECK(d.report.critical_edges == 0);
    CHECK(d.report.curves.empty());
  }
  SECTION("one face")
  {
    Surface s;
    s.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    s.faces = {{0, 1, 2}};
    const auto d = detect(s);
    CHECK(d.report.critical_edges == 3);
    CHECK(d.report.sharp_vertices == 3);
  }
  SECTION("an isolated vertex is not sharp")
  {
    Surface s = cube(1, Split::quads);
    s.points.push_back({5, 5, 5});
    CHECK(detect(s).report.sharp_vertices == 8);
  }
  SECTION("two cubes that touch at a vertex")
  {
    Surface s = cube(1, Split::quads);
    const auto other = cube(1, Split::quads);
    std::vector<std::size_t> number;
    for (const Point& p : other.points)
    {
      const Point moved = {p[0] + 1, p[1] + 1, p[2] + 1};
      const auto place = std::find(s.points.begin(), s.points.end(), moved);
      number.push_back(static_cast<std::size_t>(place - s.points.begin()));
      if (place == s.points.end())
        s.points.push_back(moved);
    }
    const auto shared = number[static_cast<std::size_t>(
      std::find(other.points.begin(), other.points.end(), Point{0, 0, 0}) - other.points.begin())];
    REQUIRE(shared < 8);
    // a face graph holds such a vertex once for each of its fans
    s.points.push_back(s.points[shared]);
    for (auto face : other.faces)
    {
      for (auto& v : face)
        v = number[v] == shared ? s.points.size() - 1 : number[v];
      s.faces.push_back(face);
    }
    CHECK(detect(s).report.critical_edges == 24);
  }
  SECTION("faces without area have no angle")
  {
    Surface s = rough_sheet(3, 0, Split::same, 1);
    const auto before = detect(s).report.critical_edges;
    for (Point& p : s.points)
      if (near(p[0], 1))
        p[0] = 2;
    CHECK(detect(s).report.critical_edges == before);
  }
}

TEST_CASE("detect_features: bad input is refused before anything is written")
{
  Flagged f(to_mesh(cube(1, Split::quads)));
  const auto refuses = [&](const Feature_options& options) {
    CHECK_THROWS_AS(detect_features(f.mesh, f.critical, f.sharp, options), Input_error);
    for (const auto e : f.mesh.edges())
      CHECK(f.critical[e]);
  };
  refuses({.weak_angle = 30});
  refuses({.end_angle = 70});
  refuses({.strong_angle = 66});
  refuses({.sharp_angle = 91});
  refuses({.turning_angle = 39});
  refuses({.ridge_deviation = 21});
  refuses({.dihedral_angle = -1});
  refuses({.weak_angle = std::numeric_limits<double>::quiet_NaN()});
  f.mesh.point(Mesh::Vertex_index(3)) = {0, 0, std::numeric_limits<double>::quiet_NaN()};
  refuses({});
}

TEST_CASE("Feature_report: parts add up")
{
  Feature_report sum = detect(cube(2, Split::quads)).report;
  sum += detect(icosphere(2)).report;
  CHECK(sum.critical_edges == 24);
  CHECK(sum.curves.size() == 12);
  CHECK(sum.rejected_edges[static_cast<int>(Rejection::smooth)] == 300);
  CHECK(to_string(Rejection::smooth) == "smooth");
  CHECK(to_string(Curve_end::terminus) == "terminus");
}
