#include "io/jacobian_signs.h"
#include "io/single_cell_mesh.h"
#include "io/small_meshes.h"
#include "support/shared_data.h"

#include "../../toolkit/src/io/hilbert_order.h"
#include "../../toolkit/src/io/hopr_sides.h"

#include <recurve/core/exceptions.h>
#include <recurve/io/mesh_io.h>
#include <recurve/mesh/join_zones.h>

#include <catch2/catch.hpp>

#include <cstdlib>
#include <fstream>
#include <set>

using namespace recurve;
using namespace recurve::test;
using Catch::Matchers::Contains;

TEST_CASE("a curved cell comes back from HOPR's format to the bit")
{
  const Element_type type =
    GENERATE(Element_type::tetrahedron, Element_type::pyramid, Element_type::prism, Element_type::hexahedron);
  const int degree = GENERATE(1, 2, 3, 4, 5, 6);
  CAPTURE(element_name(type), degree);
  const Curved_mesh mesh = single_cell_mesh(type, degree);
  const Temporary_file file("cell.h5");
  write_hopr(mesh, file.path());
  Read_report report;
  const Curved_mesh back = read_curved_mesh(file.path(), &report);
  CHECK(report.notes.empty());
  CHECK(back.degree == degree);
  CHECK(back.nodes == mesh.nodes);
  CHECK(element_positions(back) == element_positions(mesh));
  CHECK(element_positions(back, &Curved_zone::faces) == element_positions(mesh, &Curved_zone::faces));
  CHECK(back.linear.zones[0].name == mesh.linear.zones[0].name);
  REQUIRE(back.linear.zones[0].patches.size() == mesh.linear.zones[0].patches.size());
  for (std::size_t p = 0; p < mesh.linear.zones[0].patches.size(); ++p)
    CHECK(back.linear.zones[0].patches[p].name == mesh.linear.zones[0].patches[p].name);
}

TEST_CASE("zones, shared nodes and periodic sides come back from HOPR's format")
{
  const int degree = GENERATE(1, 2, 3);
  Volume_mesh linear = two_zones(true);
  const Joined_zones joined = join_zones(linear);
  make_periodic(linear);
  Curved_mesh mesh = elevate(std::move(linear), joined, degree);
  bend(mesh);
  const Temporary_file file("zones.h5");
  write_hopr(mesh, file.path());
  const Curved_mesh back = read_curved_mesh(file.path());
  REQUIRE(back.zones.size() == 2);
  CHECK(back.linear.zones[0].name == "left");
  CHECK(back.linear.zones[1].name == "right");
  CHECK(back.nodes.size() == mesh.nodes.size());
  CHECK(element_positions(back) == element_positions(mesh));
  // Sides that were in no patch are now in "unassigned".
  std::set<std::string> names;
  for (const Zone& zone : back.linear.zones)
    for (const Patch& patch : zone.patches)
      names.insert(patch.name);
  CHECK(names == std::set<std::string>{"inlet", "outlet", "unassigned"});
  std::vector<Point> translations;
  for (const Zone& zone : back.linear.zones)
    for (const Zone_interface& interface : zone.interfaces)
      if (interface.periodicity)
      {
        CHECK(interface.points.size() == 4);
        translations.push_back(interface.periodicity->translation);
      }
  REQUIRE(!translations.empty());
  for (const Point& translation : translations)
  {
    CHECK(std::abs(translation[0]) == Approx(2));
    CHECK(translation[1] == Approx(0).margin(1e-12));
  }
}

TEST_CASE("a patch between two cells is an inner condition")
{
  // The face between the two cubes, listed by the left one.
  Volume_mesh linear = two_zones(true);
  linear.zones[0].faces.push_back({"screen", Element_type::quadrangle, {1, 2, 6, 5}});
  linear.zones[0].patches.push_back({"screen", "BCTypeUserDefined", "", {1}});
  const Joined_zones joined = join_zones(linear);
  const Curved_mesh mesh = elevate(std::move(linear), joined, 2);
  const internal::hopr::Ordered_cells cells(mesh);
  const internal::hopr::Side_table table = connect_sides(mesh, cells);
  Index inner = 0;
  for (const internal::hopr::Side& side : table.sides)
    if (side.condition > 0 && table.conditions[static_cast<std::size_t>(side.condition - 1)].name == "screen")
    {
      ++inner;
      CHECK(side.neighbor > 0);
      CHECK(table.conditions[static_cast<std::size_t>(side.condition - 1)].type[0] == 100);
    }
  CHECK(inner == 2);
  CHECK(table.unique_count == 11);
}

TEST_CASE("cells that overlap or are inside out are refused")
{
  const Joined_zones joined = join_zones(two_zones(true));
  Volume_mesh twice = two_zones(true);
  twice.zones[0].cells[0].nodes.insert(twice.zones[0].cells[0].nodes.end(), {0, 1, 2, 3, 4, 5, 6, 7});
  const Temporary_file file("bad.h5");
  CHECK_THROWS_WITH(write_hopr(elevate(twice, joined, 1), file.path()), Contains("overlap"));
  Volume_mesh mirrored = two_zones(true);
  mirrored.zones[1].cells[0].nodes = {4, 5, 6, 7, 0, 1, 2, 3};
  CHECK_THROWS_WITH(write_hopr(elevate(mirrored, joined, 1), file.path()), Contains("inside out"));
  CHECK_FALSE(std::filesystem::exists(file.path()));
}

TEST_CASE("what 32 bits cannot count is refused")
{
  const Index most = 2147483647;
  CHECK_NOTHROW(internal::hopr::check_counts(most, most));
  CHECK_THROWS_AS(internal::hopr::check_counts(most + 1, 6), Input_error);
  CHECK_THROWS_AS(internal::hopr::check_counts(6, most + 1), Input_error);
}

TEST_CASE("Hilbert's curve visits every cell of a cube, one step at a time")
{
  // The coarsest three levels: 8^3 cells.
  constexpr int levels = 3, shift = 21 - levels;
  std::vector<std::pair<std::uint64_t, std::array<int, 3>>> cells;
  for (int x = 0; x < 8; ++x)
    for (int y = 0; y < 8; ++y)
      for (int z = 0; z < 8; ++z)
        cells.push_back(
          {internal::hilbert_key({static_cast<std::uint32_t>(x) << shift, static_cast<std::uint32_t>(y) << shift,
                                  static_cast<std::uint32_t>(z) << shift}) >>
             (3 * shift),
           {x, y, z}});
  std::sort(cells.begin(), cells.end());
  for (std::size_t m = 0; m < cells.size(); ++m)
  {
    CHECK(cells[m].first == m);
    if (m > 0)
      CHECK(std::abs(cells[m].second[0] - cells[m - 1].second[0]) +
              std::abs(cells[m].second[1] - cells[m - 1].second[1]) +
              std::abs(cells[m].second[2] - cells[m - 1].second[2]) ==
            1);
  }
}

TEST_CASE("the order along the curve depends on places alone, and is total")
{
  const std::vector<Point> points = {{1, 1, 1}, {0, 0, 0}, {1, 1, 1}, {0, 0, 1}, {0, 0, 0}};
  const std::vector<Index> order = internal::hilbert_order(points);
  CHECK(std::set<Index>(order.begin(), order.end()).size() == 5);
  std::vector<Point> scaled;
  scaled.reserve(points.size());
  for (const Point& x : points)
    scaled.push_back({1e6 * x[0] - 3e6, 1e6 * x[1], 1e6 * x[2]});
  CHECK(internal::hilbert_order(scaled) == order);
  CHECK(internal::hilbert_order(std::vector<Point>(3, Point{7, 7, 7})) == std::vector<Index>{0, 1, 2});
  CHECK(internal::hilbert_order({}).empty());
}

TEST_CASE("the mesh that HOPR wrote is read whole")
{
  const auto file = shared_data("curved/NACA0012_652_Ng2_mesh.h5");
  if (!file)
    return;
  Read_report report;
  const Curved_mesh mesh = read_curved_mesh(*file, &report);
  CHECK(mesh.degree == 2);
  CHECK(mesh.cell_count() == 652);
  CHECK(mesh.nodes.size() == 8064);
  CHECK(report.notes.empty());
  CHECK(smallest_middle_jacobian(mesh) > 0);
  const Zone& zone = mesh.linear.zones.at(0);
  REQUIRE(zone.patches.size() == 5);
  CHECK(zone.patches[0].name == "BC_wall");
  CHECK(zone.patches[0].kind == "BCWallViscous");
  REQUIRE(!zone.interfaces.empty());
  CHECK(std::abs(zone.interfaces[0].periodicity.value().translation[2]) == Approx(1));
}
