#include <recurve/mesh/orient_cells.h>

#include <support/small_meshes.h>

#include <catch2/catch.hpp>

using namespace recurve;

TEST_CASE("cells the right way round stay as they are", "[orient_cells]")
{
  for (const Element_type type : test::cell_types)
  {
    CAPTURE(element_name(type));
    Volume_mesh mesh = test::box(type);
    const std::vector<Index> before = mesh.zones[0].cells[0].nodes;
    const Orientation_report report = orient_cells(mesh);
    CHECK(report.mirrored_cells == 0);
    CHECK(report.invalid_cells.empty());
    CHECK(report.collapsed_cells.empty());
    CHECK(mesh.zones[0].cells[0].nodes == before);
  }
}

TEST_CASE("cells inside out are mirrored, whatever unit and place", "[orient_cells]")
{
  const double scale = GENERATE(1.0, 1e-6, 1e6);
  const double shift = GENERATE(0.0, 1e6);
  CAPTURE(scale, shift);
  for (const Element_type type : test::cell_types)
  {
    CAPTURE(element_name(type));
    Volume_mesh mesh = test::box(type);
    test::move_points(mesh, [&](const Point& x) {
      return Point{scale * (shift - x[0]), scale * (x[1] + shift), scale * (x[2] - shift)};
    });
    CHECK(orient_cells(mesh).mirrored_cells == mesh.cell_count());
    const std::vector<Index> turned = mesh.zones[0].cells[0].nodes;
    CHECK(orient_cells(mesh).mirrored_cells == 0); // now all corners are positive
    CHECK(mesh.zones[0].cells[0].nodes == turned);
  }
}

TEST_CASE("a mirrored cell keeps its corners, edges and faces", "[orient_cells]")
{
  for (const Element_type type : test::cell_types)
  {
    CAPTURE(element_name(type));
    Volume_mesh mesh = test::box(type);
    const auto before = test::faces_of_cells(mesh.zones[0]);
    test::move_points(mesh, [](const Point& x) { return Point{x[0], -x[1], x[2]}; });
    orient_cells(mesh);
    const auto after = test::faces_of_cells(mesh.zones[0]);
    REQUIRE(after.size() == before.size());
    for (const auto& [key, face] : before)
      CHECK(after.at(key).cells == face.cells);
  }
}

TEST_CASE("only the cells inside out are touched", "[orient_cells]")
{
  Volume_mesh mesh = test::box(Element_type::hexahedron);
  std::vector<Index>& nodes = mesh.zones[0].cells[0].nodes;
  const std::vector<Index> before = nodes;
  for (int c = 0; c < 4; ++c)
    std::swap(nodes[3 * 8 + c], nodes[3 * 8 + c + 4]); // top for bottom: a mirror image
  CHECK(orient_cells(mesh).mirrored_cells == 1);
  CHECK(std::vector<Index>(nodes.begin(), nodes.begin() + 24) ==
        std::vector<Index>(before.begin(), before.begin() + 24));
  CHECK(std::vector<Index>(nodes.begin() + 32, nodes.end()) == std::vector<Index>(before.begin() + 32, before.end()));
}

TEST_CASE("folded and collapsed cells are named, not repaired", "[orient_cells]")
{
  Volume_mesh mesh = test::box(Element_type::hexahedron);
  Zone& zone = mesh.zones[0];
  std::vector<Index>& nodes = zone.cells[0].nodes;
  SECTION("two corners swapped")
  {
    std::swap(nodes[8], nodes[9]);
    const std::vector<Index> before = nodes;
    const Orientation_report report = orient_cells(mesh);
    CHECK(report.invalid_cells == std::vector<Cell_number>{{0, 1}});
    CHECK(report.collapsed_cells.empty());
    CHECK(report.mirrored_cells == 0);
    CHECK(nodes == before);
  }
  SECTION("an edge of length zero: the prism that a hexahedron may be collapsed to")
  {
    nodes[8 + 3] = nodes[8 + 2];
    nodes[8 + 7] = nodes[8 + 6];
    const Orientation_report report = orient_cells(mesh);
    CHECK(report.collapsed_cells == std::vector<Cell_number>{{0, 1}});
    CHECK(report.invalid_cells.empty());
    CHECK(report.mirrored_cells == 0);
  }
  SECTION("a flat cell")
  {
    for (int c = 0; c < 4; ++c)
      nodes[7 * 8 + 4 + c] = nodes[7 * 8 + c];
    const Orientation_report report = orient_cells(mesh);
    CHECK(report.collapsed_cells == std::vector<Cell_number>{{0, 7}});
    CHECK(report.mirrored_cells == 0);
  }
  SECTION("a flat tetrahedron in a place that doubles do not hit exactly")
  {
    mesh = test::one_cell(Element_type::tetrahedron);
    test::move_points(mesh, [](const Point& x) {
      const double u = x[0] + 0.3 * x[2], v = x[1] + 0.4 * x[2];
      return Point{0.1 * u - 0.7 * v, 0.3 * u + 0.2 * v, 0.6 * u + 0.9 * v};
    });
    CHECK(orient_cells(mesh).collapsed_cells == std::vector<Cell_number>{{0, 0}});
  }
}

TEST_CASE("thin cells are not collapsed", "[orient_cells]")
{
  for (const Element_type type : test::cell_types)
  {
    CAPTURE(element_name(type));
    Volume_mesh mesh = test::box(type);
    test::move_points(mesh, [](const Point& x) { return Point{x[0], x[1] + 0.3 * x[0], 1e-8 * x[2]}; });
    const Orientation_report report = orient_cells(mesh);
    CHECK(report.collapsed_cells.empty());
    CHECK(report.invalid_cells.empty());
  }
}
