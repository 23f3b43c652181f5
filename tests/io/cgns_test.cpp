#include "cgns_fixture.h"

#include <recurve/core/exceptions.h>

#include <limits>
#include <numbers>

using namespace recurve;
using namespace recurve::test;

namespace {

/// checks that `mesh` holds the four cells of the fixture, with their faces.
void check_four_cells(const Zone& zone)
{
  const Four_cells truth;
  CHECK(zone.points == truth.points);
  REQUIRE(zone.cells.size() == 4);
  const std::array<std::pair<Element_type, Numbers>, 4> cells = {{{Element_type::hexahedron, truth.hexahedron},
                                                                  {Element_type::prism, truth.prism},
                                                                  {Element_type::pyramid, truth.pyramid},
                                                                  {Element_type::tetrahedron, truth.tetrahedron}}};
  for (const auto& [cell_type, nodes] : cells)
  {
    const Element_type type = cell_type;
    const auto section =
      std::find_if(zone.cells.begin(), zone.cells.end(), [&](const Section& s) { return s.type == type; });
    REQUIRE(section != zone.cells.end());
    CHECK(section->nodes == from_zero(nodes));
  }
  REQUIRE(zone.faces.size() == 2);
  for (const Section& faces : zone.faces)
    CHECK(faces.nodes == from_zero(faces.type == Element_type::triangle ? truth.triangles : truth.quads));
}

} // namespace

TEST_CASE("read_cgns reads all cell types in HDF5 and ADF, in double and single precision")
{
  const Temporary_folder folder;
  const int file_type = GENERATE(CG_FILE_HDF5, CG_FILE_ADF);
  const DataType_t real = GENERATE(RealDouble, RealSingle);
  CAPTURE(file_type, real);
  {
    Raw_cgns raw(folder / "mesh.cgns", file_type);
    raw.base("my base");
    write_four_cells(raw, "a zone with spaces", real);
  }
  Read_report report;
  const Volume_mesh mesh = read_cgns(folder / "mesh.cgns", &report);
  CHECK(mesh.name == "my base");
  REQUIRE(mesh.zones.size() == 1);
  CHECK(mesh.zones[0].name == "a zone with spaces");
  check_four_cells(mesh.zones[0]);
  CHECK(mesh.zones[0].cells[1].name == "prisms");
  CHECK(mesh.zones[0].patches.empty());
  CHECK(report.notes.empty());
}

TEST_CASE("read_cgns splits mixed sections by type and keeps the order, with and without ElementStartOffset")
{
  const Temporary_folder folder;
  const Four_cells truth;
  const auto typed = [](ElementType_t type, Numbers nodes) {
    nodes.insert(nodes.begin(), type);
    return nodes;
  };
  std::vector<Numbers> faces;
  for (std::size_t f = 0; f < 6; ++f) // triangles and quadrangles by turns: elements 5, 7, .. and 6, 8, ..
  {
    faces.push_back(
      typed(TRI_3, Numbers(truth.triangles.begin() + 3 * long(f), truth.triangles.begin() + 3 * long(f) + 3)));
    faces.push_back(typed(QUAD_4, Numbers(truth.quads.begin() + 4 * long(f), truth.quads.begin() + 4 * long(f) + 4)));
  }
  {
    Raw_cgns raw(folder / "mesh.cgns");
    raw.base();
    raw.zone("Zone", 11, 4);
    raw.coordinates(truth.points);
    raw.mixed_section("a section whose name is so long", 1,
                      {typed(TETRA_4, truth.tetrahedron), typed(HEXA_8, truth.hexahedron), typed(PYRA_5, truth.pyramid),
                       typed(PENTA_6, truth.prism)});
    raw.mixed_section("walls", 5, faces);
    raw.mixed_section("lines", 17, {typed(BAR_2, {1, 2}), typed(NODE, {3}), typed(BAR_2, {2, 3})});
    raw.condition("all triangles", BCWall, PointList, {5, 7, 9, 11, 13, 15}, FaceCenter);
    raw.condition("two quads", BCInflow, PointList, {16, 6}, FaceCenter);
  }
  const bool has_offsets = GENERATE(true, false);
  if (!has_offsets)
  {
    const Node_editor editor(folder / "mesh.cgns");
    for (const char* section : {"a section whose name is so long", "walls", "lines"})
      editor.remove(std::string("/Base/Zone/") + section, "ElementStartOffset");
    editor.set_version(2.54F);
  }
  const Volume_mesh mesh = read_cgns(folder / "mesh.cgns");
  const Zone& zone = mesh.zones.at(0);
  check_four_cells(zone);
  CHECK(zone.cells[0].name == "a section whose name is so_tetra");
  CHECK(zone.cells[0].name.size() == 32);
  CHECK(zone.faces[0].name == "walls_tri");
  CHECK(zone.faces[1].name == "walls_quad");
  REQUIRE(zone.bars.size() == 1);
  CHECK(zone.bars[0].name == "lines"); // one type besides the single nodes, which are dropped
  CHECK(zone.bars[0].nodes == std::vector<Index>{0, 1, 1, 2});
  REQUIRE(zone.patches.size() == 2);
  CHECK(zone.patches[0].faces == std::vector<Index>{0, 1, 2, 3, 4, 5});
  CHECK(zone.patches[1].kind == "BCInflow");
  CHECK(zone.patches[1].faces == std::vector<Index>{6, 11});
}

TEST_CASE("read_cgns understands the element types of CGNS 3.0, which counted differently")
{
  const Temporary_folder folder;
  {
    Raw_cgns raw(folder / "mesh.cgns");
    raw.base();
    write_four_cells(raw);
  }
  {
    const Node_editor editor(folder / "mesh.cgns");
    editor.set_version(3.0F);
    editor.set<std::int32_t>("/Base/Zone/prisms", "I4", {15, 0});    // PENTA_6 of 3.0
    editor.set<std::int32_t>("/Base/Zone/hexahedra", "I4", {18, 0}); // HEXA_8 of 3.0
  }
  check_four_cells(read_cgns(folder / "mesh.cgns").zones.at(0));
}

TEST_CASE("read_cgns reads files of versions that libcgns refuses, and 64-bit files")
{
  const Temporary_folder folder;
  const float version = GENERATE(1.27F, 3.21F, 4.0F, 4.5F, 5.0F);
  CAPTURE(version);
  {
    Raw_cgns raw(folder / "mesh.cgns");
    raw.base();
    write_four_cells(raw);
    raw.condition("top", BCWall, PointRange, {11, 12}, FaceCenter);
  }
  {
    const Node_editor editor(folder / "mesh.cgns");
    editor.set_version(version);
    editor.set<std::int64_t>("/Base/Zone", "I8", {11, 4, 0}, {1, 3});
    editor.set<std::int64_t>("/Base/Zone/prisms/ElementConnectivity", "I8", {2, 9, 3, 6, 10, 7});
    editor.set<std::int64_t>("/Base/Zone/prisms/ElementRange", "I8", {2, 2});
    editor.set<std::int64_t>("/Base/Zone/ZoneBC/top/PointRange", "I8", {11, 12}, {1, 2});
  }
  const Volume_mesh mesh = read_cgns(folder / "mesh.cgns");
  check_four_cells(mesh.zones.at(0));
  REQUIRE(mesh.zones[0].patches.size() == 1);
  CHECK(mesh.zones[0].patches[0].faces == std::vector<Index>{6, 7});
}

TEST_CASE("read_cgns follows links to other files")
{
  const Temporary_folder folder;
  {
    Raw_cgns raw(folder / "mesh.cgns");
    raw.base();
    write_four_cells(raw);
  }
  {
    Raw_cgns raw(folder / "other.cgns");
    raw.base();
    raw.zone("Zone", 11, 4);
    REQUIRE(cg_goto(raw.number, raw.base_number, "Zone_t", 1, "end") == CG_OK);
    for (const char* name : {"GridCoordinates", "hexahedra", "prisms", "pyramids", "tetrahedra", "quads", "triangles"})
      REQUIRE(cg_link_write(name, "mesh.cgns", (std::string("/Base/Zone/") + name).c_str()) == CG_OK);
  }
  check_four_cells(read_cgns(folder / "other.cgns").zones.at(0));
  std::filesystem::remove(folder / "mesh.cgns");
  CHECK(read_failure(folder / "other.cgns").find("other.cgns") != std::string::npos);
}

TEST_CASE("read_cgns takes boundary conditions in every form that names elements")
{
  const Temporary_folder folder;
  {
    Raw_cgns raw(folder / "mesh.cgns");
    raw.base();
    write_four_cells(raw);
    raw.condition("point range", BCWall, PointRange, {5, 6}, FaceCenter);
    raw.condition("point list", BCInflow, PointList, {12, 7}, FaceCenter, "inlets");
    raw.condition("element range", BCOutflow, PointRange, {13, 14}, FaceCenter);
    raw.condition("element list", BCSymmetryPlane, PointList, {9, 8}, FaceCenter);
    raw.condition("on cells", BCFarfield, PointList, {10, 1}, CellCenter);
    raw.condition("only cells", BCGeneral, PointList, {1, 2}, CellCenter);
    raw.condition("overlap", BCWallInviscid, PointList, {5, 15}, FaceCenter);
    raw.condition("on edges", BCWall, PointList, {1}, EdgeCenter);
    raw.condition("not on points", FamilySpecified, PointList, {16}, Vertex, "inlets"); // forgot its GridLocation
    REQUIRE(cg_goto(raw.number, raw.base_number, "end") == CG_OK);
    int family = 0, condition = 0;
    REQUIRE(cg_family_write(raw.number, raw.base_number, "inlets", &family) == CG_OK);
    REQUIRE(cg_fambc_write(raw.number, raw.base_number, family, "FamBC", BCInflow, &condition) == CG_OK);
  }
  {
    const Node_editor editor(folder / "mesh.cgns");
    editor.rename("/Base/Zone/ZoneBC/element range", "PointRange", "ElementRange");
    editor.rename("/Base/Zone/ZoneBC/element list", "PointList", "ElementList");
    editor.remove("/Base/Zone/ZoneBC/element range", "GridLocation");
    editor.remove("/Base/Zone/ZoneBC/element list", "GridLocation");
    editor.set_text("/Base/Zone/ZoneBC/point range", "UserDefined");
    editor.set_text("/Base/Zone/ZoneBC/on cells/GridLocation", "CellCenter");
    editor.set_text("/Base/Zone/ZoneBC/only cells/GridLocation", "CellCenter");
  }
  Read_report report;
  const Volume_mesh mesh = read_cgns(folder / "mesh.cgns", &report);
  struct Row
  {
    const char* name;
    const char* kind;
    const char* family;
    std::vector<Index> faces;
  };
  const std::vector<Row> truth = {{"point range", "BCTypeUserDefined", "", {0, 1}},
                                  {"point list", "BCInflow", "inlets", {2, 7}},
                                  {"element range", "BCOutflow", "", {8, 9}},
                                  {"element list", "BCSymmetryPlane", "", {3, 4}},
                                  {"on cells", "BCFarfield", "", {5}},
                                  {"overlap", "BCWallInviscid", "", {10}},
                                  {"not on points", "FamilySpecified", "inlets", {11}}};
  const std::vector<Patch>& patches = mesh.zones.at(0).patches;
  REQUIRE(patches.size() == truth.size());
  for (std::size_t p = 0; p < truth.size(); ++p)
  {
    CAPTURE(truth[p].name);
    CHECK(patches[p].name == truth[p].name);
    CHECK(patches[p].kind == truth[p].kind);
    CHECK(patches[p].family == truth[p].family);
    CHECK(patches[p].faces == truth[p].faces);
  }
  REQUIRE(mesh.families.size() == 1);
  CHECK(mesh.families[0].name == "inlets");
  CHECK(mesh.families[0].kind == "BCInflow");
  CHECK(has_note(report, {"'on cells'", "CellCenter"}));
  CHECK(has_note(report, {"'only cells'", "no faces, left out: 2"}));
  CHECK(has_note(report, {"'overlap'", "earlier", ": 1"}));
  CHECK(has_note(report, {"'on edges'", "left out"}));
  CHECK(has_note(report, {"'not on points'", "read as elements"}));
}

TEST_CASE("read_cgns finds the faces of boundary conditions given by points")
{
  // A block of 2 x 1 x 1 cubes, without or with face elements. Points 1..12, x fastest.
  const Temporary_folder folder;
  const bool has_faces = GENERATE(false, true);
  CAPTURE(has_faces);
  std::vector<Point> points;
  for (int k = 0; k < 2; ++k)
    for (int j = 0; j < 2; ++j)
      for (int i = 0; i < 3; ++i)
        points.push_back({double(i), double(j), double(k)});
  {
    Raw_cgns raw(folder / "mesh.cgns");
    raw.base();
    raw.zone("Zone", 12, 2);
    raw.coordinates(points);
    raw.section("cubes", HEXA_8, 1, {1, 2, 5, 4, 7, 8, 11, 10, 2, 3, 6, 5, 8, 9, 12, 11});
    if (has_faces)
      raw.section("middle", QUAD_4, 3, {2, 5, 11, 8});
    raw.condition("low z", BCWall, PointRange, {1, 6}, Vertex);
    raw.condition("low y", BCWall, PointList, {1, 2, 3, 7, 8, 9}, Vertex);
    raw.condition("between", BCWall, PointList, {2, 5, 8, 11}, Vertex);
    raw.condition("an edge", BCWall, PointList, {1, 2}, Vertex);
  }
  Read_report report;
  const Zone zone = read_cgns(folder / "mesh.cgns", &report).zones.at(0);
  REQUIRE(zone.patches.size() == (has_faces ? 3 : 2));
  CHECK(zone.patches[0].name == "low z");
  CHECK(zone.patches[0].faces.size() == 2);
  CHECK(zone.patches[1].name == "low y");
  CHECK(zone.patches[1].faces.size() == 2);
  for (std::size_t p = 0; p < 2; ++p)
    for (const Index face : zone.patches[p].faces)
    {
      const Section_entry entry = find_element(zone.faces, face);
      const Section& section = zone.faces[std::size_t(entry.section)];
      CHECK(section.name == zone.patches[p].name);
      for (int c = 0; c < 4; ++c)
        CHECK(points[std::size_t(section.nodes[std::size_t(4 * entry.element + c)])][p == 0 ? 2 : 1] == 0);
    }
  if (has_faces) // a face inside the volume is one only if it is listed
  {
    CHECK(zone.patches[2].name == "between");
    CHECK(zone.patches[2].faces == std::vector<Index>{0});
  }
  CHECK(has_note(report, {"'between'", "left out"}) != has_faces);
  CHECK(has_note(report, {"'an edge'", "has no face"}));
}

TEST_CASE("read_cgns gives a triangle whose corners are on the rim of two patches to the one it is coplanar with")
{
  // Two tetrahedra share the triangle (1, 2, 3). Their floor is (1, 2, 4) and (1, 5, 2); the two sides over point 4 are
  // the roof. All corners of the floor's triangle (1, 2, 4) are in the list of the roof too.
  const Temporary_folder folder;
  {
    Raw_cgns raw(folder / "mesh.cgns");
    raw.base();
    raw.zone("Zone", 5, 2);
    raw.coordinates({{0, 0, 0}, {1, 0, 0}, {0.5, 0.2, 1}, {0.5, 1, 0}, {0.5, -1, 0}});
    raw.section("cells", TETRA_4, 1, {1, 2, 4, 3, 1, 5, 2, 3});
    raw.condition("roof", BCWall, PointList, {1, 2, 3, 4}, Vertex);
    raw.condition("floor", BCSymmetryPlane, PointList, {1, 2, 4, 5}, Vertex);
  }
  const Zone zone = read_cgns(folder / "mesh.cgns").zones.at(0);
  REQUIRE(zone.patches.size() == 2);
  CHECK(zone.patches[0].name == "roof");
  CHECK(zone.patches[0].faces.size() == 2);
  CHECK(zone.patches[1].name == "floor");
  CHECK(zone.patches[1].faces.size() == 2);
}

TEST_CASE("read_cgns prefers whole sections where conditions given by points overlap")
{
  const Temporary_folder folder;
  {
    Raw_cgns raw(folder / "mesh.cgns");
    raw.base();
    write_four_cells(raw);
    raw.condition("everything", BCWall, PointRange, {1, 11}, Vertex);
    raw.condition("triangles", BCFarfield, PointList, {2, 3, 5, 6, 7, 8, 9, 10, 11}, Vertex);
  }
  Read_report report;
  const Zone zone = read_cgns(folder / "mesh.cgns", &report).zones.at(0);
  REQUIRE(zone.patches.size() == 2);
  CHECK(zone.patches[0].faces == std::vector<Index>{0, 1, 2, 3, 4, 5});
  CHECK(zone.patches[1].faces == std::vector<Index>{6, 7, 8, 9, 10, 11});
  CHECK(has_note(report, {"'triangles'", "2 boundary conditions"}));
}

TEST_CASE("read_cgns reads bars, units, descriptors, zone families, and says what it leaves out")
{
  const Temporary_folder folder;
  {
    Raw_cgns raw(folder / "mesh.cgns");
    raw.base("flat", 2, 3);
    raw.base("Base");
    REQUIRE(cg_goto(raw.number, raw.base_number, "end") == CG_OK);
    REQUIRE(cg_dataclass_write(Dimensional) == CG_OK);
    REQUIRE(cg_units_write(Kilogram, Millimeter, Second, Kelvin, Degree) == CG_OK);
    REQUIRE(cg_descriptor_write("author", "a text\nof two lines") == CG_OK);
    write_four_cells(raw);
    raw.section("edges", BAR_2, 17, {1, 2, 2, 3});
    raw.section("probes", NODE, 19, {4, 5, 6});
    REQUIRE(cg_goto(raw.number, raw.base_number, "Zone_t", 1, "end") == CG_OK);
    REQUIRE(cg_famname_write("solid") == CG_OK);
    REQUIRE(cg_descriptor_write("origin", "somewhere") == CG_OK);
    raw.base("second");
  }
  Read_report report;
  const Volume_mesh mesh = read_cgns(folder / "mesh.cgns", &report);
  CHECK(mesh.units == std::array<std::string, 5>{"Kilogram", "Millimeter", "Second", "Kelvin", "Degree"});
  REQUIRE(mesh.descriptors.size() == 1);
  CHECK(mesh.descriptors[0].name == "author");
  CHECK(mesh.descriptors[0].text == "a text\nof two lines");
  const Zone& zone = mesh.zones.at(0);
  REQUIRE(zone.bars.size() == 1);
  CHECK(zone.bars[0].nodes == std::vector<Index>{0, 1, 1, 2});
  CHECK(zone.family == "solid");
  REQUIRE(zone.descriptors.size() == 1);
  CHECK(zone.descriptors[0].text == "somewhere");
  REQUIRE(mesh.families.size() == 1);
  CHECK(has_note(report, {"base 'second' is left out"}));
  CHECK(has_note(report, {"base 'flat'", "dimension 2"}));
  CHECK(has_note(report, {"read base 'Base'"}));
  CHECK(has_note(report, {"'probes'", "3 NODE"}));
  CHECK(has_note(report, {"families", "solid"}));
}

TEST_CASE("read_cgns reads interfaces by points and by faces, periodic ones too")
{
  const Temporary_folder folder;
  {
    Raw_cgns raw(folder / "mesh.cgns");
    raw.base();
    REQUIRE(cg_goto(raw.number, raw.base_number, "end") == CG_OK);
    REQUIRE(cg_units_write(Kilogram, Meter, Second, Kelvin, Degree) == CG_OK);
    write_four_cells(raw, "one");
    raw.connection("points", Vertex, {1, 4, 8}, "two", {2, 3, 7});
    const int periodic = raw.connection("turned", Vertex, {1, 2}, "one", {3, 4});
    const std::array<float, 3> center = {1, 2, 3}, angle = {0, 0, 90}, translation = {0, 0.5, 0};
    REQUIRE(cg_conn_periodic_write(raw.number, raw.base_number, 1, periodic, center.data(), angle.data(),
                                   translation.data()) == CG_OK);
    raw.connection("overset", Vertex, {1}, "two", {1}, Overset);
    raw.connection("lost", Vertex, {1}, "nowhere", {1});
    write_four_cells(raw, "two");
    raw.connection("faces", FaceCenter, {5, 12}, "Base/one", {6, 11});
    raw.connection("cells", FaceCenter, {5}, "one", {1});
  }
  Read_report report;
  const Volume_mesh mesh = read_cgns(folder / "mesh.cgns", &report);
  const std::vector<Zone_interface>& one = mesh.zones.at(0).interfaces;
  REQUIRE(one.size() == 3);
  CHECK(one[0].donor_zone == "two");
  CHECK(one[0].location == Zone_interface::Location::vertex);
  CHECK(one[0].is_abutting_one_to_one);
  CHECK(one[0].points == std::vector<Index>{0, 3, 7});
  CHECK(one[0].donor_points == std::vector<Index>{1, 2, 6});
  CHECK(!one[0].periodicity);
  REQUIRE(one[1].periodicity);
  CHECK(one[1].periodicity->rotation_center == Point{1, 2, 3});
  CHECK(one[1].periodicity->rotation_angle[2] == Approx(std::numbers::pi / 2));
  CHECK(one[1].periodicity->translation == Point{0, 0.5, 0});
  CHECK(!one[2].is_abutting_one_to_one);
  const std::vector<Zone_interface>& two = mesh.zones.at(1).interfaces;
  REQUIRE(two.size() == 2);
  CHECK(two[0].donor_zone == "one");
  CHECK(two[0].location == Zone_interface::Location::face);
  CHECK(two[0].points == std::vector<Index>{0, 7});
  CHECK(two[0].donor_points == std::vector<Index>{1, 6});
  CHECK(!two[1].is_abutting_one_to_one);
  CHECK(has_note(report, {"'overset'", "Overset"}));
  CHECK(has_note(report, {"'lost'", "nowhere"}));
  CHECK(has_note(report, {"'cells'", "name only"}));
}

TEST_CASE("read_cgns turns structured zones into hexahedra with patches and interfaces")
{
  // Zone "a" is the box 0..3 x 0..2 x 0..1 with spacing 1. Zone "b" continues it in x, but its own directions (i, j, k)
  // run along (-y, -z, x) of space, so that i of "a" meets k of "b".
  const Temporary_folder folder;
  const auto points_a = [] {
    std::vector<Point> points;
    for (int k = 0; k < 2; ++k)
      for (int j = 0; j < 3; ++j)
        for (int i = 0; i < 4; ++i)
          points.push_back({double(i), double(j), double(k)});
    return points;
  }();
  const auto points_b = [] {
    std::vector<Point> points;
    for (int k = 0; k < 3; ++k)
      for (int j = 0; j < 2; ++j)
        for (int i = 0; i < 3; ++i)
          points.push_back({3.0 + k, 2.0 - i, 1.0 - j});
    return points;
  }();
  {
    Raw_cgns raw(folder / "mesh.cgns");
    raw.base();
    raw.structured_zone("a", 4, 3, 2);
    raw.coordinates(points_a);
    raw.condition("inflow", BCInflow, PointRange, {1, 1, 1, 1, 3, 2}, Vertex, nullptr, 3);
    raw.condition("ground", BCWall, PointRange, {1, 1, 1, 3, 2, 1}, KFaceCenter, nullptr, 3);
    raw.condition("ground again", BCWall, PointRange, {1, 1, 1, 2, 2, 1}, Vertex, nullptr, 3);
    raw.condition("line", BCWall, PointRange, {1, 1, 1, 4, 1, 1}, Vertex, nullptr, 3);
    raw.condition("listed", BCSymmetryPlane, PointList, {1, 1, 1, 2, 1, 1, 1, 1, 2, 2, 1, 2}, Vertex, nullptr, 3);
    raw.condition("block", BCWall, PointRange, {1, 1, 1, 2, 2, 2}, Vertex, nullptr, 3);
    const std::array<cgsize_t, 6> range = {4, 1, 1, 4, 3, 2}, donor = {3, 2, 1, 1, 1, 1};
    const std::array<int, 3> transform = {3, -1, -2};
    int index = 0;
    REQUIRE(cg_1to1_write(raw.number, raw.base_number, raw.zone_number, "a to b", "b", range.data(), donor.data(),
                          transform.data(), &index) == CG_OK);
    raw.structured_zone("b", 3, 2, 3);
    raw.coordinates(points_b);
    const std::array<cgsize_t, 6> low_k = {1, 1, 1, 3, 2, 1};
    const Numbers there = {4, 3, 2, 4, 2, 2, 4, 1, 2, 4, 3, 1, 4, 2, 1, 4, 1, 1}; // (i, j, k) of zone "a"
    REQUIRE(cg_conn_write(raw.number, raw.base_number, raw.zone_number, "b to a", Vertex, Abutting1to1, PointRange, 2,
                          low_k.data(), "a", Structured, PointListDonor, Integer, 6, there.data(), &index) == CG_OK);
  }
  Read_report report;
  const Volume_mesh mesh = read_cgns(folder / "mesh.cgns", &report);
  REQUIRE(mesh.zones.size() == 2);
  const Zone& a = mesh.zones[0];
  const Zone& b = mesh.zones[1];
  CHECK(a.points == points_a);
  REQUIRE(a.cells.size() == 1);
  CHECK(a.cells[0].size() == 6);
  CHECK(b.cells[0].size() == 8 / 2);
  for (const Zone* zone : {&a, &b}) // each cell is the unit cube in the order of the SIDS: volume 1 by its corners
    for (Index cell = 0; cell < zone->cells[0].size(); ++cell)
    {
      const auto corner = [&](int c) {
        return zone->points[std::size_t(zone->cells[0].nodes[std::size_t(8 * cell + c)])];
      };
      const Point o = corner(0), x = corner(1), y = corner(3), z = corner(4), opposite = corner(6);
      Point u, v, w;
      for (std::size_t d = 0; d < 3; ++d)
      {
        u[d] = x[d] - o[d];
        v[d] = y[d] - o[d];
        w[d] = z[d] - o[d];
        CHECK(opposite[d] == o[d] + u[d] + v[d] + w[d]);
      }
      const double volume =
        u[0] * (v[1] * w[2] - v[2] * w[1]) + u[1] * (v[2] * w[0] - v[0] * w[2]) + u[2] * (v[0] * w[1] - v[1] * w[0]);
      CHECK(volume == 1);
    }

  REQUIRE(a.patches.size() == 3);
  CHECK(a.patches[0].name == "inflow");
  CHECK(a.patches[0].faces.size() == 2);
  CHECK(a.patches[1].name == "ground");
  CHECK(a.patches[1].faces.size() == 6);
  CHECK(a.patches[2].name == "listed");
  CHECK(a.patches[2].faces.size() == 1);
  for (const Patch& patch : a.patches)
    for (const Index face : patch.faces)
    {
      const Section_entry entry = find_element(a.faces, face);
      const Section& section = a.faces[std::size_t(entry.section)];
      const std::size_t normal = patch.name == "inflow" ? 0 : patch.name == "ground" ? 2 : 1;
      for (int c = 0; c < 4; ++c)
        CHECK(a.points[std::size_t(section.nodes[std::size_t(4 * entry.element + c)])][normal] == 0);
    }
  CHECK(has_note(report, {"'ground again'", "earlier", ": 1"}));
  CHECK(has_note(report, {"'line'", "left out"}));
  CHECK(has_note(report, {"'block'", "left out"}));
  CHECK(has_note(report, {"zone 'b'", "structured"}));

  REQUIRE(a.interfaces.size() == 1);
  const Zone_interface& interface = a.interfaces[0];
  CHECK(interface.donor_zone == "b");
  REQUIRE(interface.points.size() == 6);
  REQUIRE(interface.donor_points.size() == 6);
  for (std::size_t m = 0; m < 6; ++m) // paired points are the same point
    CHECK(a.points[std::size_t(interface.points[m])] == b.points[std::size_t(interface.donor_points[m])]);
  REQUIRE(b.interfaces.size() == 1);
  REQUIRE(b.interfaces[0].points.size() == 6);
  REQUIRE(b.interfaces[0].donor_points.size() == 6);
  for (std::size_t m = 0; m < 6; ++m)
    CHECK(b.points[std::size_t(b.interfaces[0].points[m])] == a.points[std::size_t(b.interfaces[0].donor_points[m])]);
}

TEST_CASE("read_cgns strips the rind of structured zones")
{
  const Temporary_folder folder;
  {
    Raw_cgns raw(folder / "mesh.cgns");
    raw.base();
    raw.structured_zone("Zone", 2, 2, 2);
    int grid = 0;
    REQUIRE(cg_grid_write(raw.number, raw.base_number, raw.zone_number, "GridCoordinates", &grid) == CG_OK);
    REQUIRE(cg_goto(raw.number, raw.base_number, "Zone_t", 1, "GridCoordinates_t", 1, "end") == CG_OK);
    const std::array<int, 6> rind = {1, 0, 0, 0, 0, 2};
    REQUIRE(cg_rind_write(rind.data()) == CG_OK);
    std::vector<Point> points;
    for (int k = 0; k < 4; ++k)
      for (int j = 0; j < 2; ++j)
        for (int i = -1; i < 2; ++i)
          points.push_back({double(i), double(j), double(k)});
    static constexpr std::array<const char*, 3> names = {"CoordinateX", "CoordinateY", "CoordinateZ"};
    const std::array<cgsize_t, 3> low = {0, 1, 1}, high = {2, 2, 4};
    for (std::size_t d = 0; d < 3; ++d)
    {
      std::vector<double> component(points.size());
      std::transform(points.begin(), points.end(), component.begin(), [d](const Point& point) { return point[d]; });
      int index = 0;
      REQUIRE(cg_coord_partial_write(raw.number, raw.base_number, raw.zone_number, RealDouble, names[d], low.data(),
                                     high.data(), component.data(), &index) == CG_OK);
    }
  }
  const Zone zone = read_cgns(folder / "mesh.cgns").zones.at(0);
  CHECK(zone.points ==
        std::vector<Point>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}, {0, 0, 1}, {1, 0, 1}, {0, 1, 1}, {1, 1, 1}});
}

TEST_CASE("read_cgns reports progress and can be cancelled")
{
  const Temporary_folder folder;
  {
    Raw_cgns raw(folder / "mesh.cgns");
    raw.base();
    write_four_cells(raw);
  }
  double last = -1;
  read_cgns(folder / "mesh.cgns", nullptr, [&](std::string_view, double fraction) {
    CHECK(fraction >= last);
    last = fraction;
    return true;
  });
  CHECK(last == 1);
  CHECK_THROWS_AS(read_cgns(folder / "mesh.cgns", nullptr, [](std::string_view, double) { return false; }), Cancelled);
}
