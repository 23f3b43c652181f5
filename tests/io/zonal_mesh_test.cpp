#include "io/single_cell_mesh.h"
#include "io/small_meshes.h"

#include <recurve/io/mesh_io.h>
#include <recurve/mesh/join_zones.h>

#include <catch2/catch.hpp>

#include <map>
#include <set>

using namespace recurve;
namespace fs = std::filesystem;
using namespace recurve::test;

TEST_CASE("a curved cell comes back from CGNS to the bit")
{
  const Element_type type =
    GENERATE(Element_type::tetrahedron, Element_type::pyramid, Element_type::prism, Element_type::hexahedron);
  const int degree = GENERATE(1, 2, 3, 4);
  CAPTURE(element_name(type), degree);
  const Temporary_file temporary("cell.cgns");
  const fs::path& file = temporary.path();
  const Curved_mesh mesh = test::single_cell_mesh(type, degree);
  write_mesh(mesh, file);
  Read_report report;
  const Curved_mesh back = read_curved_mesh(file, &report);
  CHECK(report.notes.empty());
  REQUIRE(back.degree == degree);
  CHECK(back.nodes == mesh.nodes);
  CHECK(back.zones[0].cells[0].nodes == mesh.zones[0].cells[0].nodes);
  CHECK(element_positions(back, &Curved_zone::faces) == element_positions(mesh, &Curved_zone::faces));
  CHECK(back.zones[0].is_straight == mesh.zones[0].is_straight);
  CHECK(back.linear.zones[0].points == mesh.linear.zones[0].points);
  CHECK(back.linear.zones[0].patches.size() == mesh.linear.zones[0].patches.size());
}

TEST_CASE("zones that share an interface share its nodes when they come back")
{
  const bool with_interface = GENERATE(true, false);
  const int degree = GENERATE(1, 2, 3, 4);
  CAPTURE(with_interface, degree);
  Volume_mesh linear = two_zones(with_interface);
  const Joined_zones joined = join_zones(linear);
  Curved_mesh mesh = elevate(std::move(linear), joined, degree);
  const auto nodes = static_cast<std::size_t>((2 * degree + 1) * (degree + 1) * (degree + 1));
  REQUIRE(mesh.nodes.size() == nodes);
  bend(mesh);
  const Temporary_file temporary("zones.cgns");
  const fs::path& file = temporary.path();
  write_mesh(mesh, file);
  Read_report report;
  const Curved_mesh back = read_curved_mesh(file, &report);
  CHECK(report.notes.empty());
  CHECK(back.nodes.size() == nodes);
  CHECK(element_positions(back, &Curved_zone::cells) == element_positions(mesh, &Curved_zone::cells));
  CHECK(element_positions(back, &Curved_zone::faces) == element_positions(mesh, &Curved_zone::faces));
  std::set<Index> shared(back.zones[0].nodes.begin(), back.zones[0].nodes.end());
  Index count = 0;
  for (const Index node : back.zones[1].nodes)
    count += static_cast<Index>(shared.count(node));
  CHECK(count == (degree + 1) * (degree + 1));
}

TEST_CASE("straight cells of an elevated mesh are straight when they come back")
{
  Volume_mesh linear = two_zones(true);
  const Joined_zones joined = join_zones(linear);
  const Curved_mesh mesh = elevate(std::move(linear), joined, 3);
  const Temporary_file temporary("straight.cgns");
  const fs::path& file = temporary.path();
  write_mesh(mesh, file);
  const Curved_mesh back = read_curved_mesh(file);
  for (const Curved_zone& zone : back.zones)
    CHECK(zone.is_straight == std::vector<std::uint8_t>{1});
}

TEST_CASE("nodes that zones share but place apart are told")
{
  Zonal_mesh mesh;
  mesh.degree = 2;
  Curved_mesh raised = elevate(two_zones(true), join_zones(two_zones(true)), 2);
  for (std::size_t z = 0; z < 2; ++z)
  {
    Zone zone = raised.linear.zones[z];
    Zonal_elements elements = {raised.zones[z].cells, raised.zones[z].faces, {}};
    std::map<Index, Index> numbers;
    zone.points.clear();
    for (const Index node : raised.zones[z].nodes)
    {
      numbers.emplace(node, static_cast<Index>(zone.points.size()));
      zone.points.push_back(raised.nodes[static_cast<std::size_t>(node)]);
    }
    for (auto* sections : {&elements.cells, &elements.faces})
      for (Curved_section& section : *sections)
        for (Index& node : section.nodes)
          node = numbers.at(node);
    mesh.linear.zones.push_back(zone);
    mesh.zones.push_back(elements);
  }
  const double shift = GENERATE(1e-7, 0.01);
  CAPTURE(shift);
  // the node in the middle of the face between the zones
  const int middle = first_face_node(Element_type::hexahedron, 2, 4);
  mesh.linear.zones[1]
    .points[static_cast<std::size_t>(mesh.zones[1].cells[0].nodes[static_cast<std::size_t>(middle)])][0] += shift;
  Read_report report;
  const Curved_mesh curved = to_curved_mesh(mesh, &report);
  CHECK(curved.nodes.size() == (shift < 1e-4 ? 45 : 46)); // nodes that far apart are two nodes
  CHECK(report.notes.size() == (shift < 1e-4 ? 1 : 0));
}
