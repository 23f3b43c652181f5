#include <recurve/core/exceptions.h>
#include <recurve/mesh/boundary_faces.h>
#include <recurve/mesh/join_zones.h>

#include <support/small_meshes.h>

#include <catch2/catch.hpp>
#include <tbb/global_control.h>

#include <set>

using namespace recurve;
using Catch::Contains;

namespace {

/// the points at x = 1 of both zones of a two-zone box, paired by position.
Zone_interface seam(const Volume_mesh& mesh)
{
  Zone_interface interface;
  interface.name = "seam";
  interface.donor_zone = mesh.zones[1].name;
  const auto& left = mesh.zones[0].points;
  const auto& right = mesh.zones[1].points;
  for (std::size_t a = 0; a < left.size(); ++a)
    for (std::size_t b = 0; b < right.size(); ++b)
      if (left[a] == right[b])
      {
        interface.points.push_back(static_cast<Index>(a));
        interface.donor_points.push_back(static_cast<Index>(b));
      }
  return interface;
}

/// whether the zones are joined exactly where points of different zones were put on one position (before `moved`).
bool is_joined_as_built(const Volume_mesh& built, const Joined_zones& joined)
{
  std::map<Point, Index> vertex_at;
  std::set<Index> vertices;
  for (std::size_t z = 0; z < built.zones.size(); ++z)
    for (std::size_t n = 0; n < built.zones[z].points.size(); ++n)
    {
      const Index vertex = joined.vertex_of_point[z][n];
      vertices.insert(vertex);
      if (vertex_at.emplace(built.zones[z].points[n], vertex).first->second != vertex)
        return false;
    }
  return vertices.size() == vertex_at.size() && joined.vertex_count == static_cast<Index>(vertex_at.size()) &&
         *vertices.rbegin() == joined.vertex_count - 1;
}

} // namespace

TEST_CASE("the points of one zone stay apart, even where they coincide", "[join_zones]")
{
  Volume_mesh mesh = test::box(Element_type::tetrahedron);
  mesh.zones[0].points.push_back(mesh.zones[0].points[0]);
  const Joined_zones joined = join_zones(mesh);
  REQUIRE(joined.vertex_count == static_cast<Index>(mesh.zones[0].points.size()));
  for (Index n = 0; n < joined.vertex_count; ++n)
    CHECK(joined.vertex_of_point[0][n] == n);
  CHECK(joined.pairs.empty());
}

TEST_CASE("zones are joined where they touch, whatever unit, place and labels", "[join_zones]")
{
  const double scale = GENERATE(1.0, 1e-6, 1e6);
  const double shift = GENERATE(0.0, 1.0 / 3, 1e6);
  const unsigned seed = GENERATE(1u, 2u);
  CAPTURE(scale, shift, seed);
  for (const Element_type type : test::cell_types)
  {
    CAPTURE(element_name(type));
    const Volume_mesh built = test::relabelled(test::two_zone_box(type, type, 3), seed);
    Volume_mesh mesh = built;
    test::move_points(mesh, [&](const Point& x) {
      return Point{scale * (x[0] + shift), scale * (x[1] - shift), scale * (x[2] + shift)};
    });
    const Joined_zones joined = join_zones(mesh);
    CHECK(is_joined_as_built(built, joined));
    REQUIRE(joined.pairs.size() == 1);
    CHECK(joined.pairs[0].zone_a == "left");
    CHECK(joined.pairs[0].zone_b == "right");
    CHECK(joined.pairs[0].points_by_geometry == 16);
    CHECK(joined.pairs[0].points_by_connectivity == 0);
    CHECK(joined.pairs_refused_by_zone == 0);
  }
}

TEST_CASE("zones whose coordinates went through float32 are joined", "[join_zones]")
{
  const unsigned seed = GENERATE(11u, 12u, 13u);
  const double shift = GENERATE(0.0, 50.0); // cells of size 1/3: 2^-24 of 50 is 1e-5 of a cell
  CAPTURE(seed, shift);
  const Volume_mesh built = test::two_zone_box(Element_type::hexahedron, Element_type::tetrahedron, 3);
  Volume_mesh mesh = built;
  std::mt19937 random(seed);
  std::uniform_int_distribution<int> step(-1, 1);
  test::move_points(mesh, [&](const Point& x) {
    Point moved;
    for (int axis = 0; axis < 3; ++axis)
    {
      const float exact = float(0.7 * x[axis] + 0.1 * x[(axis + 1) % 3] + shift);
      const int steps = step(random); // the two zones were computed apart: the last bit differs
      moved[axis] = steps == 0 ? exact : std::nextafterf(exact, steps > 0 ? 1e30f : -1e30f);
    }
    return moved;
  });
  CHECK(is_joined_as_built(built, join_zones(mesh)));
}

TEST_CASE("the float32 slack is not taken where coordinates are doubles", "[join_zones]")
{
  // A gap of a hundredth of a cell, which float32 could not even tell at this offset.
  Volume_mesh mesh = test::two_zone_box(Element_type::hexahedron, Element_type::hexahedron, 3);
  test::move_points(mesh, [&](const Point& x) { return Point{x[0] + 1e6 + 0.1, x[1] / 3, x[2]}; });
  for (Point& point : mesh.zones[1].points)
    point[0] += 0.01 / 3;
  CHECK(join_zones(mesh).pairs.empty());
}

TEST_CASE("points farther apart than the tolerance stay apart", "[join_zones]")
{
  const double gap = GENERATE(0.0, 0.9e-4, 1.1e-4, 1e-2); // relative to the edge
  CAPTURE(gap);
  Volume_mesh mesh = test::two_zone_box(Element_type::hexahedron, Element_type::hexahedron, 3);
  for (Point& point : mesh.zones[1].points)
    point[0] += gap / 3;
  test::move_points(mesh, [](const Point& x) { return Point{0.1 * x[0], 0.1 * x[1], 0.1 * x[2]}; });
  const Joined_zones joined = join_zones(mesh);
  CHECK(joined.pairs.size() == (gap < 1e-4 ? 1 : 0));
  if (gap > 0 && gap < 1e-4)
  {
    CHECK(joined.pairs[0].largest_gap == Approx(0.1 * gap / 3).epsilon(1e-6));
    const std::vector<Point> points = joined_points(mesh, joined);
    CHECK(points[joined.vertex_of_point[1][0]] == mesh.zones[0].points[joined.vertex_of_point[1][0]]);
  }
}

TEST_CASE("the tolerance is local: boundary layers are joined too", "[join_zones]")
{
  // Cells 1 x 1 at the top, 1 x 1e-6 at the bottom: one tolerance for all would join the layers or nothing.
  const Volume_mesh built = test::two_zone_box(Element_type::hexahedron, Element_type::hexahedron, 4);
  Volume_mesh mesh = built;
  test::move_points(mesh, [](const Point& x) { return Point{4 * x[0], 4 * x[1], std::pow(10.0, 8 * (x[2] - 1))}; });
  CHECK(is_joined_as_built(built, join_zones(mesh)));
}

TEST_CASE("connectivity joins without geometry, and counts as such", "[join_zones]")
{
  Volume_mesh mesh = test::two_zone_box(Element_type::hexahedron, Element_type::hexahedron, 2);
  const Volume_mesh built = mesh;
  mesh.zones[0].interfaces.push_back(seam(mesh));
  Zone_interface back = mesh.zones[0].interfaces[0];
  back.donor_zone = "left";
  std::swap(back.points, back.donor_points);
  mesh.zones[1].interfaces.push_back(back); // files state both views
  const Joined_zones joined = join_zones(mesh, {.use_geometry = false});
  CHECK(is_joined_as_built(built, joined));
  REQUIRE(joined.pairs.size() == 1);
  CHECK(joined.pairs[0].points_by_connectivity == 9);
  CHECK(join_zones(mesh, {.use_connectivity = false}).pairs[0].points_by_geometry == 9);
  CHECK(join_zones(mesh, {.use_connectivity = false, .use_geometry = false}).pairs.empty());
  CHECK(join_zones(mesh).pairs[0].points_by_geometry == 0);
}

TEST_CASE("connectivity joins points with a gap that geometry would not", "[join_zones]")
{
  Volume_mesh mesh = test::two_zone_box(Element_type::hexahedron, Element_type::hexahedron, 2);
  const Volume_mesh built = mesh;
  mesh.zones[0].interfaces.push_back(seam(mesh));
  for (Point& point : mesh.zones[1].points)
    point[0] += 1e-3;
  CHECK(is_joined_as_built(built, join_zones(mesh)));
}

TEST_CASE("an interface of faces joins their corners", "[join_zones]")
{
  const Element_type type = GENERATE(Element_type::hexahedron, Element_type::tetrahedron);
  Volume_mesh mesh = test::two_zone_box(type, type, 2);
  const Volume_mesh built = mesh;
  Zone_interface interface;
  interface.name = "faces";
  interface.donor_zone = "right";
  interface.location = Zone_interface::Location::face;
  std::vector<std::map<std::vector<Point>, Index>> face_at(2); // by their sorted corners
  for (int z = 0; z < 2; ++z)
  {
    Zone& zone = mesh.zones[z];
    test::add_hull_patches(zone, [](const Point& x) { return x[0] == 1 ? "seam" : ""; });
    const Section& section = zone.faces.back();
    for (Index e = 0; e < section.size(); ++e)
    {
      std::vector<Point> corners(static_cast<std::size_t>(corner_count(section.type)));
      for (std::size_t c = 0; c < corners.size(); ++c)
        corners[c] = zone.points[section.nodes[e * static_cast<Index>(corners.size()) + c]];
      std::sort(corners.begin(), corners.end());
      face_at[z][corners] = zone.face_count() - section.size() + e;
    }
  }
  for (const auto& [corners, face] : face_at[0])
  {
    interface.points.push_back(face);
    interface.donor_points.push_back(face_at[1].at(corners));
  }
  mesh.zones[0].interfaces.push_back(interface);
  CHECK(is_joined_as_built(built, join_zones(mesh, {.use_geometry = false})));
}

TEST_CASE("periodic interfaces join nothing", "[join_zones]")
{
  Volume_mesh mesh = test::two_zone_box(Element_type::hexahedron, Element_type::hexahedron, 2);
  Zone_interface periodic;
  periodic.name = "period";
  periodic.donor_zone = "right";
  for (Index n = 0; n < 27; n += 3) // x = 0 of the left zone, x = 2 of the right
  {
    periodic.points.push_back(n);
    periodic.donor_points.push_back(n + 2);
  }
  const Index vertices = join_zones(mesh).vertex_count;
  SECTION("stated")
  {
    periodic.periodicity = Periodicity{.translation = {2, 0, 0}};
    mesh.zones[0].interfaces.push_back(periodic);
    const Joined_zones joined = join_zones(mesh);
    CHECK(joined.vertex_count == vertices);
    CHECK(joined.pairs_refused_by_distance == 0);
  }
  SECTION("not stated: the distance tells")
  {
    mesh.zones[0].interfaces.push_back(periodic);
    const Joined_zones joined = join_zones(mesh);
    CHECK(joined.vertex_count == vertices);
    CHECK(joined.pairs_refused_by_distance == 9);
    REQUIRE_FALSE(joined.notes.empty());
    CHECK_THAT(joined.notes[0], Contains("zone 'left'") && Contains("zone 'right'") && Contains("apart"));
  }
  SECTION("other kinds of connection")
  {
    periodic.is_abutting_one_to_one = false;
    periodic.donor_points.clear();
    mesh.zones[0].interfaces.push_back(periodic);
    CHECK(join_zones(mesh).vertex_count == vertices);
  }
}

TEST_CASE("the cut of a zone with itself is joined where the mesh says so", "[join_zones]")
{
  // One zone of two boxes that touch, with points of their own.
  Volume_mesh mesh = test::two_zone_box(Element_type::hexahedron, Element_type::hexahedron, 2);
  const Zone_interface cut = seam(mesh);
  const Index offset = static_cast<Index>(mesh.zones[0].points.size());
  Volume_mesh one;
  Zone& zone = one.zones.emplace_back(mesh.zones[0]);
  zone.faces.clear();
  zone.patches.clear();
  zone.points.insert(zone.points.end(), mesh.zones[1].points.begin(), mesh.zones[1].points.end());
  for (const Index node : mesh.zones[1].cells[0].nodes)
    zone.cells[0].nodes.push_back(node + offset);
  CHECK(join_zones(one).vertex_count == 54);
  zone.interfaces.push_back(cut);
  zone.interfaces[0].donor_zone = zone.name;
  for (Index& point : zone.interfaces[0].donor_points)
    point += offset;
  CHECK(join_zones(one).vertex_count == 54 - 9);
}

TEST_CASE("two points of one zone are not joined through a third", "[join_zones]")
{
  // The left zone has a slit of 5e-5 at the seam; the points of the right zone lie in it, nearer to the lower part.
  Volume_mesh mesh;
  mesh.zones.push_back(test::box_zone(Element_type::hexahedron, {.cubes = {1, 1, 1}}, "slit"));
  const Zone upper = test::box_zone(Element_type::hexahedron, {.cubes = {1, 1, 1}, .origin = {0, 0, 1.00005}}, "upper");
  for (const Index node : upper.cells[0].nodes)
    mesh.zones[0].cells[0].nodes.push_back(node + 8);
  mesh.zones[0].points.insert(mesh.zones[0].points.end(), upper.points.begin(), upper.points.end());
  mesh.zones.push_back(
    test::box_zone(Element_type::hexahedron, {.cubes = {1, 1, 1}, .origin = {1, 0, 0.00002}}, "right"));
  const Joined_zones joined = join_zones(mesh);
  REQUIRE(joined.pairs.size() == 1);
  CHECK(joined.pairs[0].points_by_geometry == 4);
  CHECK(joined.pairs_refused_by_zone == 2);
  CHECK(joined.notes.size() == 2);
  for (const Index n : {4, 6}) // x = 1, z = 1.00002
    CHECK(joined.vertex_of_point[1][n] == joined.vertex_of_point[0][n + 1]);
  for (std::size_t z = 0; z < 2; ++z)
  {
    const std::set<Index> distinct(joined.vertex_of_point[z].begin(), joined.vertex_of_point[z].end());
    CHECK(distinct.size() == mesh.zones[z].points.size());
  }
}

TEST_CASE("a baffle that runs through an interface keeps its sides", "[join_zones]")
{
  // Both zones consist of a lower and an upper box that do not share their points at z = 1: position alone cannot tell
  // which of the two points there belongs to which.
  const unsigned seed = GENERATE(1u, 2u, 3u, 4u, 5u);
  CAPTURE(seed);
  Volume_mesh mesh;
  for (const double x : {0.0, 1.0})
  {
    Zone zone =
      test::box_zone(Element_type::hexahedron, {.cubes = {2, 3, 2}, .origin = {x, 0, 0}}, x == 0 ? "left" : "right");
    const Zone upper = test::box_zone(Element_type::hexahedron, {.cubes = {2, 3, 2}, .origin = {x, 0, 1}});
    const Index offset = static_cast<Index>(zone.points.size());
    zone.points.insert(zone.points.end(), upper.points.begin(), upper.points.end());
    for (const Index node : upper.cells[0].nodes)
      zone.cells[0].nodes.push_back(node + offset);
    mesh.zones.push_back(std::move(zone));
  }
  mesh = test::relabelled(mesh, seed);
  const Joined_zones joined = join_zones(mesh);
  CHECK(joined.pairs[0].points_by_geometry == 24);
  const Boundary_report report = find_boundary_faces(mesh, joined).report;
  CHECK(report.interface_faces == 12);
  CHECK(report.crowded_faces == 0);
}

TEST_CASE("the poles of two grids are joined in step", "[join_zones]")
{
  // Wedges around the z axis, stacked as two zones, with points of their own on the axis for each wedge.
  const Index n = 12;
  const unsigned seed = GENERATE(1u, 2u, 3u);
  CAPTURE(seed);
  Volume_mesh mesh;
  for (const int level : {0, 1})
  {
    Zone zone;
    zone.name = level == 0 ? "lower" : "upper";
    for (int k = 0; k <= 1; ++k)
      for (Index j = 0; j < n; ++j)
        for (int i = 0; i <= 1; ++i)
          zone.points.push_back({i * std::cos(6.283185307179586 * double(j) / double(n)),
                                 i * std::sin(6.283185307179586 * double(j) / double(n)), double(level + k)});
    const auto at = [&](Index i, Index j, Index k) { return i + 2 * (j % n + n * k); };
    for (Index j = 0; j < n; ++j)
      test::add_cell(zone, Element_type::hexahedron,
                     {at(0, j, 0), at(1, j, 0), at(1, j + 1, 0), at(0, j + 1, 0), at(0, j, 1), at(1, j, 1),
                      at(1, j + 1, 1), at(0, j + 1, 1)});
    mesh.zones.push_back(std::move(zone));
  }
  mesh = test::relabelled(mesh, seed);
  const Joined_zones joined = join_zones(mesh);
  CHECK(joined.pairs[0].points_by_geometry == 2 * n);
  CHECK(find_boundary_faces(mesh, joined).report.interface_faces == n);
}

TEST_CASE("many zones meet in one point", "[join_zones]")
{
  Volume_mesh mesh;
  for (int octant = 0; octant < 8; ++octant)
    mesh.zones.push_back(
      test::box_zone(Element_type::prism,
                     {.cubes = {2, 2, 2}, .origin = {double(octant & 1), double(octant >> 1 & 1), double(octant >> 2)}},
                     "octant " + std::to_string(octant)));
  const Joined_zones joined = join_zones(mesh);
  CHECK(joined.vertex_count == 125);
  CHECK(is_joined_as_built(mesh, joined));
  CHECK(joined.pairs.size() == 28); // every two octants share at least the centre
}

TEST_CASE("joining does not depend on the number of threads", "[join_zones]")
{
  const Volume_mesh mesh =
    test::relabelled(test::two_zone_box(Element_type::tetrahedron, Element_type::tetrahedron, 17), 3);
  std::vector<std::vector<std::vector<Index>>> results;
  for (const std::size_t threads : {1, 2, 7})
  {
    tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    results.push_back(join_zones(mesh).vertex_of_point);
  }
  CHECK(results[1] == results[0]);
  CHECK(results[2] == results[0]);
}

TEST_CASE("interfaces to nowhere are refused", "[join_zones]")
{
  Volume_mesh mesh = test::two_zone_box(Element_type::hexahedron, Element_type::hexahedron, 2);
  Zone_interface interface = seam(mesh);
  const auto with = [&](const Zone_interface& bad) {
    mesh.zones[0].interfaces = {bad};
    return join_zones(mesh);
  };
  Zone_interface bad = interface;
  bad.donor_zone = "nobody";
  CHECK_THROWS_WITH(with(bad), Contains("there is no zone 'nobody'"));
  bad = interface;
  bad.points[3] = 27;
  CHECK_THROWS_WITH(with(bad), Contains("node 28 of zone 'left'"));
  bad = interface;
  bad.donor_points[3] = -1;
  CHECK_THROWS_WITH(with(bad), Contains("node 0 of zone 'right'"));
  bad = interface;
  bad.donor_points.pop_back();
  CHECK_THROWS_AS(with(bad), Input_error);
  bad = interface;
  bad.location = Zone_interface::Location::face;
  bad.points = bad.donor_points = {1000};
  CHECK_THROWS_WITH(with(bad), Contains("face 1001"));
}
