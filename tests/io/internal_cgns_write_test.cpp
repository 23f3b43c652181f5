#include "cgns_fixture.h"
#include "single_cell_mesh.h"

#include "../../toolkit/src/io/cgns_names.h"
#include "../../toolkit/src/io/cgns_writing.h"

#include <recurve/core/exceptions.h>

using namespace recurve;
using namespace recurve::test;

TEST_CASE("write_cgns splits sections that 32-bit sizes do not hold, and patches still find their faces")
{
  // Five hexahedra in a row, with all faces above and below them as a section of ten.
  Curved_mesh mesh;
  Zone zone;
  Section cells{"cells", Element_type::hexahedron, {}}, faces{"faces", Element_type::quadrangle, {}};
  for (int i = 0; i < 6; ++i)
    for (int corner = 0; corner < 4; ++corner)
      zone.points.push_back({double(i), double(corner == 1 || corner == 2), double(corner > 1)});
  for (Index i = 0; i < 5; ++i)
  {
    const Index a = 4 * i, b = 4 * i + 4;
    for (const Index node : {a, b, b + 1, a + 1, a + 3, b + 3, b + 2, a + 2})
      cells.nodes.push_back(node);
    for (const Index node : {a, b, b + 1, a + 1, a + 3, b + 3, b + 2, a + 2})
      faces.nodes.push_back(node);
  }
  zone.name = "Zone";
  zone.cells = {cells};
  zone.faces = {faces};
  zone.patches = {{"low", "BCWall", "", {0, 2, 4, 6, 8}}, {"high", "BCWall", "", {1, 3, 5, 7, 9}}};
  mesh.linear.zones = {zone};
  mesh.nodes = zone.points;
  Curved_zone curved;
  for (std::size_t m = 0; m < mesh.nodes.size(); ++m)
    curved.nodes.push_back(static_cast<Index>(m));
  curved.cells = {{"cells", Element_type::hexahedron, cells.nodes}};
  curved.faces = {{"faces", Element_type::quadrangle, faces.nodes}};
  mesh.zones = {curved};

  const Temporary_folder folder;
  internal::cgns::write_cgns_within(mesh, folder / "mesh.cgns", {}, {.section_entries = 17, .piece = 5});
  const Zone found = read_cgns(folder / "mesh.cgns").zones.at(0);
  CHECK(found.points == zone.points);
  REQUIRE(found.cells.size() == 3);
  CHECK(found.cells[2].name == "cells_3");
  std::vector<Index> nodes;
  for (const Section& section : found.cells)
  {
    CHECK(section.nodes.size() <= 17);
    nodes.insert(nodes.end(), section.nodes.begin(), section.nodes.end());
  }
  CHECK(nodes == cells.nodes);
  REQUIRE(found.faces.size() == 3);
  nodes.clear();
  for (const Section& section : found.faces)
    nodes.insert(nodes.end(), section.nodes.begin(), section.nodes.end());
  CHECK(nodes == faces.nodes);
  REQUIRE(found.patches.size() == 2);
  CHECK(found.patches[0].faces == zone.patches[0].faces);
  CHECK(found.patches[1].faces == zone.patches[1].faces);
}

TEST_CASE("names of CGNS nodes are short, without slash and different")
{
  internal::cgns::Cgns_names names = {"taken"};
  CHECK(names.take("free") == "free");
  CHECK(names.take("free") == "free_2");
  CHECK(names.take("free_2") == "free_2_2");
  CHECK(names.take("taken") == "taken_2");
  CHECK(names.take("a/b\n") == "a_b");
  CHECK(names.take(".") == "unnamed");
  CHECK(names.take("") == "unnamed_2");
  const std::string longest(32, 'x');
  CHECK(names.take(longest + "tail") == longest);
  CHECK(names.take(longest) == longest.substr(0, 30) + "_2");
  CHECK(internal::cgns::cut_name("aäb", 2) == "a");
  CHECK(internal::cgns::cut_name("aäb", 3) == "aä");
}
