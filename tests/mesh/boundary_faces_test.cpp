#include <recurve/mesh/boundary_faces.h>

#include <support/small_meshes.h>

#include <catch2/catch.hpp>
#include <tbb/global_control.h>

using namespace recurve;

namespace {

Point centre_of(const Zone& zone, const Index* nodes, int count)
{
  Point centre = {};
  for (int c = 0; c < count; ++c)
    for (int axis = 0; axis < 3; ++axis)
      centre[axis] += zone.points[nodes[c]][axis] / count;
  return centre;
}

Point normal_of(const Zone& zone, const Index* nodes, int count)
{
  const Point &a = zone.points[nodes[0]], &b = zone.points[nodes[1]], &c = zone.points[nodes[count - 1]];
  Point normal;
  for (int axis = 0; axis < 3; ++axis)
  {
    const int y = (axis + 1) % 3, z = (axis + 2) % 3;
    normal[axis] = (b[y] - a[y]) * (c[z] - a[z]) - (b[z] - a[z]) * (c[y] - a[y]);
  }
  return normal;
}

/// whether every face looks out of its first cell and really is the stated face of it.
bool all_faces_look_outward(const Volume_mesh& mesh, const Boundary_faces& boundary)
{
  for (std::size_t z = 0; z < mesh.zones.size(); ++z)
  {
    const Zone& zone = mesh.zones[z];
    if (boundary.owners[z].size() != static_cast<std::size_t>(zone.face_count()))
      return false;
    for (Index f = 0; f < zone.face_count(); ++f)
    {
      const Section_entry entry = find_element(zone.faces, f);
      const int count = corner_count(zone.faces[entry.section].type);
      const Index* const nodes = zone.faces[entry.section].nodes.data() + entry.element * count;
      const Cell_face& owner = boundary.owners[z][f].first;
      if (owner.zone == no_index)
        continue;
      const Section_entry cell = find_element(mesh.zones[owner.zone].cells, owner.cell);
      const Section& section = mesh.zones[owner.zone].cells[cell.section];
      const Reference_element& reference = reference_element(section.type);
      const Index* const cell_nodes = section.nodes.data() + cell.element * reference.corner_count;
      std::vector<Point> corners, stated;
      for (int c = 0; c < count; ++c)
      {
        corners.push_back(zone.points[nodes[c]]);
        stated.push_back(mesh.zones[owner.zone].points[cell_nodes[reference.faces[owner.face].corners[c]]]);
      }
      std::sort(corners.begin(), corners.end());
      std::sort(stated.begin(), stated.end());
      const Point normal = normal_of(zone, nodes, count), centre = centre_of(zone, nodes, count);
      const Point inside = centre_of(mesh.zones[owner.zone], cell_nodes, reference.corner_count);
      double outward = 0;
      for (int axis = 0; axis < 3; ++axis)
        outward += normal[axis] * (centre[axis] - inside[axis]);
      if (outward <= 0 || corners != stated)
        return false;
    }
  }
  return true;
}

Boundary_faces find(Volume_mesh& mesh)
{
  return find_boundary_faces(mesh, join_zones(mesh));
}

const Patch& patch_named(const Zone& zone, const std::string& name)
{
  for (const Patch& patch : zone.patches)
    if (patch.name == name)
      return patch;
  FAIL("no patch " + name);
  return zone.patches[0];
}

} // namespace

TEST_CASE("a box with all its patches has nothing to complain of", "[boundary_faces]")
{
  for (const Element_type type : test::cell_types)
  {
    CAPTURE(element_name(type));
    Volume_mesh mesh = test::relabelled(test::box(type, {.cubes = {3, 2, 4}}), 7);
    const Index faces = mesh.zones[0].face_count();
    const Boundary_faces boundary = find(mesh);
    CHECK(boundary.report.boundary_faces == test::hull_face_count(mesh.zones[0]));
    CHECK(boundary.report.boundary_faces == faces);
    CHECK(boundary.report.unassigned_faces == 0);
    CHECK(boundary.report.interface_faces == 0);
    CHECK(boundary.report.faces_without_cell == 0);
    CHECK(boundary.report.duplicate_faces == 0);
    CHECK(boundary.report.crowded_faces == 0);
    CHECK(boundary.report.internal_patches.empty());
    CHECK(boundary.report.interface_patches.empty());
    CHECK(mesh.zones[0].patches.size() == 6);
    CHECK(all_faces_look_outward(mesh, boundary));
  }
}

TEST_CASE("faces look outward, however the file has them", "[boundary_faces]")
{
  for (const Element_type type : test::cell_types)
  {
    CAPTURE(element_name(type));
    Volume_mesh mesh = test::box(type);
    int n = 0;
    std::vector<Index> first_corners;
    for (Section& section : mesh.zones[0].faces)
      for (Index e = 0; e < section.size(); ++e)
      {
        Index* const nodes = section.nodes.data() + e * corner_count(section.type);
        if (++n % 3 == 0)
          std::reverse(nodes, nodes + corner_count(section.type));
        std::rotate(nodes, nodes + n % corner_count(section.type), nodes + corner_count(section.type));
        first_corners.push_back(nodes[0]);
      }
    CHECK(all_faces_look_outward(mesh, find(mesh)));
    std::size_t i = 0;
    for (const Section& section : mesh.zones[0].faces)
      for (Index e = 0; e < section.size(); ++e)
        CHECK(section.nodes[e * corner_count(section.type)] == first_corners[i++]);
  }
}

TEST_CASE("faces that no patch names become a patch of their own", "[boundary_faces]")
{
  Volume_mesh mesh = test::mixed_box(); // without any patch
  test::add_hull_patches(mesh.zones[0], [](const Point& x) { return x[0] == 0 ? "inlet" : ""; });
  const std::vector<Index> inlet = mesh.zones[0].faces[0].nodes;
  const Boundary_faces boundary = find(mesh);
  const Zone& zone = mesh.zones[0];
  CHECK(boundary.report.boundary_faces == test::hull_face_count(zone));
  CHECK(boundary.report.unassigned_faces == test::hull_face_count(zone) - 1);
  REQUIRE(zone.patches.size() == 2);
  CHECK(zone.patches[1].name == "unassigned");
  CHECK(static_cast<Index>(zone.patches[1].faces.size()) == boundary.report.unassigned_faces);
  CHECK(std::is_sorted(zone.patches[1].faces.begin(), zone.patches[1].faces.end()));
  REQUIRE(zone.faces.size() == 3);
  CHECK(zone.faces[1].name == "unassigned_triangle");
  CHECK(zone.faces[2].name == "unassigned_quadrangle");
  CHECK(zone.faces[1].size() == 2 + 2 * 2);              // of the tetrahedra, of the prisms
  CHECK(zone.patches[0].faces == std::vector<Index>{0}); // and the old numbers still mean the old faces
  CHECK(std::is_permutation(inlet.begin(), inlet.end(), zone.faces[0].nodes.begin()));
  CHECK(all_faces_look_outward(mesh, boundary));

  const Boundary_faces again = find(mesh);
  CHECK(again.report.unassigned_faces == 0);
  CHECK(mesh.zones[0].patches.size() == 2);
}

TEST_CASE("faces added later join the patch of those added before", "[boundary_faces]")
{
  Volume_mesh mesh = test::box(Element_type::hexahedron, {.cubes = {1, 1, 1}});
  Zone& zone = mesh.zones[0];
  for (Patch& patch : zone.patches)
    patch.name = patch.name == "x_min" ? "unassigned" : patch.name;
  for (Section& section : zone.faces)
    section.name = section.name == "x_min" ? "unassigned_quadrangle" : section.name;
  zone.patches.pop_back();
  zone.faces.pop_back();
  find(mesh);
  CHECK(patch_named(zone, "unassigned").faces.size() == 2);
  CHECK(zone.faces.back().name == "unassigned_quadrangle_2");
}

TEST_CASE("a section without a patch becomes one", "[boundary_faces]")
{
  Volume_mesh mesh = test::box(Element_type::hexahedron);
  Zone& zone = mesh.zones[0];
  zone.patches.erase(zone.patches.begin());            // all faces of section x_max
  const Index left_out = zone.patches[0].faces.back(); // one of section x_min, whose patch keeps its name
  zone.patches[0].faces.pop_back();
  const std::string first = zone.faces[0].name, second = zone.faces[1].name;
  CHECK(find(mesh).report.unassigned_faces == 0);
  CHECK(patch_named(zone, first).faces == std::vector<Index>{0, 1, 2, 3});
  CHECK(patch_named(zone, second + "_2").faces == std::vector<Index>{left_out});
}

TEST_CASE("an interface of zones is no boundary", "[boundary_faces]")
{
  for (const Element_type type : test::cell_types)
  {
    CAPTURE(element_name(type));
    Volume_mesh mesh = test::relabelled(test::two_zone_box(type, type, 3), 5);
    const Index outer = mesh.zones[0].face_count() + mesh.zones[1].face_count();
    const Boundary_faces boundary = find(mesh);
    CHECK(boundary.report.interface_faces == (type == Element_type::tetrahedron ? 18 : 9));
    CHECK(boundary.report.boundary_faces == outer);
    CHECK(boundary.report.unassigned_faces == 0);
    CHECK(all_faces_look_outward(mesh, boundary));
  }
  SECTION("but it is where the zones are not joined")
  {
    Volume_mesh mesh = test::two_zone_box(Element_type::hexahedron, Element_type::hexahedron, 3);
    const Joined_zones apart = join_zones(mesh, {.use_geometry = false});
    CHECK(find_boundary_faces(mesh, apart).report.unassigned_faces == 18);
  }
}

TEST_CASE("a patch on an interface of zones is named as such", "[boundary_faces]")
{
  const bool is_in_both = GENERATE(false, true);
  Volume_mesh mesh = test::two_zone_box(Element_type::tetrahedron, Element_type::tetrahedron, 2);
  for (Zone& zone : mesh.zones)
    if (is_in_both || zone.name == "left")
      test::add_hull_patches(zone, [](const Point& x) { return x[0] == 1 ? "seam" : ""; });
  const Boundary_faces boundary = find(mesh);
  CHECK(boundary.report.interface_patches.size() == (is_in_both ? 2 : 1));
  CHECK(boundary.report.interface_patches[0] == "left/seam");
  CHECK(boundary.report.internal_patches.empty());
  CHECK(boundary.report.duplicate_faces == 0);
  CHECK(all_faces_look_outward(mesh, boundary));
  for (std::size_t z = 0; z < (is_in_both ? 2 : 1); ++z)
    for (const Index face : patch_named(mesh.zones[z], "seam").faces)
    {
      CHECK(place_of(boundary.owners[z][face]) == Face_place::zone_interface);
      CHECK(boundary.owners[z][face].first.zone == static_cast<Index>(z)); // each sees it from its own cells
      CHECK(boundary.owners[z][face].second.zone == 1 - static_cast<Index>(z));
    }
}

TEST_CASE("patches inside the volume have two sides", "[boundary_faces]")
{
  Volume_mesh mesh = test::box(Element_type::hexahedron, {.cubes = {1, 1, 2}});
  Zone& zone = mesh.zones[0];
  SECTION("listed once")
  {
    test::add_patch(zone, "baffle", Element_type::quadrangle, {{4, 6, 7, 5}});
    const Boundary_faces boundary = find(mesh);
    CHECK(boundary.report.internal_patches == std::vector<std::string>{"zone/baffle"});
    CHECK(boundary.report.duplicate_faces == 0);
    const Face_owners& owners = boundary.owners[0].back();
    CHECK(place_of(owners) == Face_place::inside);
    CHECK(owners.first == Cell_face{0, 0, 5}); // top of the lower cell
    CHECK(owners.second == Cell_face{0, 1, 0});
    CHECK(all_faces_look_outward(mesh, boundary));
  }
  SECTION("listed by two patches: each has a side")
  {
    test::add_patch(zone, "lower", Element_type::quadrangle, {{4, 6, 7, 5}});
    test::add_patch(zone, "upper", Element_type::quadrangle, {{4, 6, 7, 5}});
    const Boundary_faces boundary = find(mesh);
    CHECK(boundary.report.internal_patches == std::vector<std::string>{"zone/lower", "zone/upper"});
    CHECK(boundary.report.duplicate_faces == 0);
    CHECK(boundary.owners[0].back().first == Cell_face{0, 1, 0});
    CHECK(all_faces_look_outward(mesh, boundary));
  }
  SECTION("listed twice by one patch, and a third time by another")
  {
    test::add_patch(zone, "baffle", Element_type::quadrangle, {{4, 6, 7, 5}, {5, 7, 6, 4}});
    CHECK(find(mesh).report.duplicate_faces == 1);
    test::add_patch(zone, "again", Element_type::quadrangle, {{4, 6, 7, 5}});
    CHECK(find(mesh).report.duplicate_faces == 2);
  }
}

TEST_CASE("faults of the boundary are counted", "[boundary_faces]")
{
  Volume_mesh mesh = test::box(Element_type::hexahedron);
  Zone& zone = mesh.zones[0];
  SECTION("a face of no cell")
  {
    test::add_patch(zone, "adrift", Element_type::triangle, {{0, 1, 3}});
    const Boundary_faces boundary = find(mesh);
    CHECK(boundary.report.faces_without_cell == 1);
    CHECK(place_of(boundary.owners[0].back()) == Face_place::nowhere);
    CHECK(boundary.report.unassigned_faces == 0);
  }
  SECTION("a face without area")
  {
    test::add_patch(zone, "line", Element_type::triangle, {{0, 1, 1}});
    CHECK(find(mesh).report.faces_without_cell == 1);
  }
  SECTION("a boundary face listed by two patches")
  {
    const auto first = zone.faces[0].nodes.begin();
    test::add_patch(zone, "twice", Element_type::quadrangle, {{first, first + 4}});
    CHECK(find(mesh).report.duplicate_faces == 1);
  }
  SECTION("cells on top of each other")
  {
    std::vector<Index>& nodes = zone.cells[0].nodes;
    nodes.insert(nodes.end(), nodes.begin(), nodes.begin() + 8);
    nodes.insert(nodes.end(), nodes.begin(), nodes.begin() + 8);
    CHECK(find(mesh).report.crowded_faces == 6);
  }
}

TEST_CASE("the sides of a collapsed hexahedron meet triangles", "[boundary_faces]")
{
  // A cube cut in a prism and in a hexahedron of which two edges are collapsed: the same prism in disguise.
  Volume_mesh mesh;
  Zone& zone = mesh.zones.emplace_back(test::box_zone(Element_type::hexahedron, {.cubes = {1, 1, 2}}));
  zone.cells.clear();
  test::add_cell(zone, Element_type::hexahedron, {0, 1, 3, 3, 4, 5, 7, 7}); // points count in rows: i + 2 j + 4 k
  test::add_cell(zone, Element_type::prism, {0, 3, 2, 4, 7, 6});
  test::add_cell(zone, Element_type::prism, {4, 5, 7, 8, 9, 11});
  test::add_cell(zone, Element_type::prism, {4, 7, 6, 8, 11, 10});
  const Boundary_faces boundary = find(mesh);
  CHECK(boundary.report.boundary_faces == 4 * 2 + 2 * 2); // sides and ends of the column
  REQUIRE(zone.faces.size() == 2);
  CHECK(zone.faces[0].size() == 4); // also the one that the cell has as a quadrangle
  CHECK(zone.faces[1].size() == 8);
}

TEST_CASE("the boundary does not depend on the number of threads", "[boundary_faces]")
{
  std::vector<std::vector<Index>> results;
  for (const std::size_t threads : {1, 2, 7})
  {
    tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    Volume_mesh mesh = test::relabelled(test::two_zone_box(Element_type::tetrahedron, Element_type::pyramid, 19), 3);
    for (Zone& zone : mesh.zones)
      zone.patches.clear(), zone.faces.clear();
    find(mesh);
    results.push_back(mesh.zones[0].faces[0].nodes);
    results.back().insert(results.back().end(), mesh.zones[1].faces[0].nodes.begin(),
                          mesh.zones[1].faces[0].nodes.end());
  }
  CHECK(results[1] == results[0]);
  CHECK(results[2] == results[0]);
}
