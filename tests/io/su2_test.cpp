#include "io/jacobian_signs.h"
#include "io/single_cell_mesh.h"
#include "io/small_meshes.h"
#include "support/shared_data.h"

#include <recurve/core/exceptions.h>
#include <recurve/io/mesh_io.h>

#include <catch2/catch.hpp>

#include <cmath>
#include <fstream>
#include <map>
#include <set>
#include <sstream>

using namespace recurve;
using namespace recurve::test;
using Catch::Matchers::Contains;

namespace {

Zonal_mesh read_text(const std::string& text, Read_report* report = nullptr)
{
  const Temporary_file file("text.su2");
  std::ofstream(file.path(), std::ios::binary) << text;
  return read_su2(file.path(), report);
}

std::string with(std::string text, const std::string& from, const std::string& to)
{
  const std::size_t at = text.find(from);
  REQUIRE(at != std::string::npos);
  return text.replace(at, from.size(), to);
}

const std::string tetrahedron = "NDIME= 3\nNELEM= 1\n10 0 1 2 3 0\nNPOIN= 4\n0 0 0 0\n1 0 0 1\n0 1 0 2\n0 0 1 3\n"
                                "NMARK= 2\nMARKER_TAG= wall\nMARKER_ELEMS= 2\n5 0 2 1\n5 0 1 3\n"
                                "MARKER_TAG= far field\nMARKER_ELEMS= 1\n5 1 2 3\n";

int vtk_type(Element_type type)
{
  const std::map<Element_type, int> types = {{Element_type::triangle, 5},     {Element_type::quadrangle, 9},
                                             {Element_type::tetrahedron, 10}, {Element_type::hexahedron, 12},
                                             {Element_type::prism, 13},       {Element_type::pyramid, 14}};
  return types.at(type);
}

/// one curved cell as SU2 writes it: the nodes of the lattice in rows, here by their positions on the lattice.
std::string cell_text(Element_type type, int degree)
{
  const Curved_mesh mesh = single_cell_mesh(type, degree);
  std::map<std::array<int, 3>, Index> by_row; // k slowest
  const auto lattice = canonical_nodes(type, degree);
  for (std::size_t m = 0; m < lattice.size(); ++m)
    by_row[{lattice[m][2], lattice[m][1], lattice[m][0]}] = static_cast<Index>(m);
  std::ostringstream text;
  text.precision(17);
  text << "% a comment\nNDIME= 3 % another\n\nNELEM= 1\n" << 100 * (degree - 1) + vtk_type(type);
  if (degree > 1)
    for (const auto& [position, node] : by_row)
      text << ' ' << node;
  else
    for (const Index node : mesh.zones[0].nodes)
      text << ' ' << node;
  text << " 0\nNPOIN= " << mesh.nodes.size() << "\n";
  for (const Point& x : mesh.nodes)
    text << x[0] << ' ' << x[1] << ' ' << x[2] << '\n';
  text << "NMARK= 0\n";
  return text.str();
}

} // namespace

TEST_CASE("a curved cell in SU2's rows is the cell")
{
  const Element_type type =
    GENERATE(Element_type::tetrahedron, Element_type::pyramid, Element_type::prism, Element_type::hexahedron);
  const int degree = GENERATE(1, 2, 3, 4, 5, 6);
  CAPTURE(element_name(type), degree);
  const Curved_mesh mesh = to_curved_mesh(read_text(cell_text(type, degree)));
  CHECK(mesh.degree == degree);
  CHECK(element_positions(mesh) == element_positions(single_cell_mesh(type, degree)));
}

TEST_CASE("markers are patches")
{
  Read_report report;
  const Zone zone = read_text(tetrahedron, &report).linear.zones.at(0);
  CHECK(report.notes.empty());
  REQUIRE(zone.patches.size() == 2);
  CHECK(zone.patches[0].name == "wall");
  CHECK(zone.patches[0].faces == std::vector<Index>{0, 1});
  CHECK(zone.patches[1].name == "far field");
  CHECK(zone.patches[1].faces == std::vector<Index>{2});
  CHECK(zone.cells.at(0).nodes == std::vector<Index>{0, 1, 2, 3});
}

TEST_CASE("points may come first, lines may end as on Windows, what is not understood is passed over")
{
  std::string text = "NDIME=3\r\nNPOIN= 4 3\r\n0 0 0\r\n1 0 0\r\n0 1 0\r\n0 0 +1e0\r\nNELEM=1\r\n10 0 1 2 3\r\n"
                     "AOA= 3.0\r\nNMARK=1\r\nMARKER_TAG=SEND_RECEIVE\r\nMARKER_ELEMS=1\r\nSEND_RECV=1\r\n1 0 0\r\n"
                     "NPERIODIC=2\r\nPERIODIC_INDEX=0\r\n0 0 0\r\n";
  Read_report report;
  const Volume_mesh mesh = read_text(text, &report).linear;
  CHECK(mesh.zones.at(0).cell_count() == 1);
  CHECK(mesh.zones[0].points[3] == Point{0, 0, 1});
  CHECK(report.notes.size() == 2);
}

TEST_CASE("several zones keep their own points")
{
  const std::string text = "NZONE= 2\nIZONE= 1\n" + tetrahedron + "IZONE= 2\n" + tetrahedron;
  const Zonal_mesh mesh = read_text(text);
  REQUIRE(mesh.linear.zones.size() == 2);
  CHECK(mesh.linear.zones[0].name == "zone_1");
  CHECK(mesh.linear.zones[1].name == "zone_2");
  for (const Zone& zone : mesh.linear.zones)
  {
    CHECK(zone.points.size() == 4);
    CHECK(zone.face_count() == 3);
  }
}

TEST_CASE("what SU2 files may have wrong is named, with its line")
{
  struct Fault
  {
    std::string text;
    std::vector<std::string> words;
  };
  const std::string large = "4000000000000";
  const std::vector<Fault> faults = {
    {"", {"NDIME"}},
    {"hello\n", {"NDIME"}},
    {with(tetrahedron, "NDIME= 3", "NDIME= 2"), {"line 2", "2: only 3D"}},
    {with(tetrahedron, "NDIME= 3", "NDIME= x"), {"'x'"}},
    {with(tetrahedron, "NDIME= 3\n", ""), {"NDIME"}},
    {with(tetrahedron, "NELEM= 1", "NELEM= " + large), {large}},
    {with(tetrahedron, "NELEM= 1", "NELEM= -1"), {"-1 elements"}},
    {with(tetrahedron, "NELEM= 1", "NELEM= 99999999999999999999"), {"99999999999999999999"}},
    {with(tetrahedron, "NPOIN= 4", "NPOIN= " + large), {large}},
    {with(tetrahedron, "NPOIN= 4", "NPOIN= 5"), {"coordinate"}},
    {with(tetrahedron, "NPOIN= 4", "NPOIN= 3"), {"tetrahedron 1", "number 3", "0..2"}},
    {with(tetrahedron, "10 0 1 2 3 0", "10 0 1 2 4"), {"number 4"}},
    {with(tetrahedron, "10 0 1 2 3 0", "10 0 1 2 -1"), {"number -1"}},
    {with(tetrahedron, "10 0 1 2 3 0", "10 0 1 2"), {"ends where"}},
    {with(tetrahedron, "10 0 1 2 3 0", "11 0 1 2 3"), {"type 11"}},
    {with(tetrahedron, "10 0 1 2 3 0", "5 0 1 2"), {"type 5", "dimension 3"}},
    {with(tetrahedron, "10 0 1 2 3 0", "1012 0 1 2"), {"type 1012"}},
    {with(tetrahedron, "10 0 1 2 3 0", "-90 0 1 2"), {"type -90"}},
    {with(tetrahedron, "5 0 2 1", "205 0 2 1"), {"degree 3", "degree 1"}},
    {with(tetrahedron, "5 0 2 1", "5 0 2 9"), {"wall", "number 9"}},
    {with(tetrahedron, "1 0 0 1", "1 nan 0 1"), {"point 1", "Y", "nan"}},
    {with(tetrahedron, "MARKER_TAG= wall\n", ""), {"MARKER_TAG"}},
    {with(tetrahedron, "MARKER_ELEMS= 1", "MARKER_ELEMS= 2"), {"ends after 1 of 2", "far field"}},
    {with(tetrahedron, "NMARK", "NPOIN= 0\nNMARK"), {"NPOIN= twice"}},
    {"NDIME= 3\nNPOIN= 1\n0 0 0\n", {"no cells"}},
    {"NDIME= 3\nNELEM= 0\n", {"no NPOIN"}}};
  for (const Fault& fault : faults)
  {
    CAPTURE(fault.text);
    try
    {
      read_text(fault.text);
      FAIL("was read");
    }
    catch (const Format_error& error)
    {
      for (const std::string& word : fault.words)
        CHECK_THAT(error.what(), Contains(word) && Contains("line "));
    }
  }
}

TEST_CASE("SU2's linear brick is read whole")
{
  const auto file = shared_data("reader/mesh_brick_pyra_ffd.su2");
  if (!file)
    return;
  const Volume_mesh mesh = read_mesh(*file);
  CHECK(mesh.cell_count() == 72625);
  CHECK(mesh.zones.at(0).points.size() == 14030);
  std::map<std::string, std::size_t> patches;
  for (const Patch& patch : mesh.zones[0].patches)
    patches[patch.name] = patch.faces.size();
  CHECK(patches == std::map<std::string, std::size_t>{
                     {"x_m", 722}, {"x_p", 722}, {"y_m", 1482}, {"y_p", 1482}, {"z_m", 741}, {"z_p", 1482}});
}

TEST_CASE("SU2's cubic sphere has its wall nodes on the sphere and no cell inside out")
{
  const auto file = shared_data("curved/SphereViscous_QuadDominant_Coarse_nPoly3.su2");
  if (!file)
    return;
  const Curved_mesh mesh = read_curved_mesh(*file);
  CHECK(mesh.degree == 3);
  CHECK(mesh.cell_count() == 3272);
  CHECK(mesh.nodes.size() == 31338);
  CHECK(smallest_middle_jacobian(mesh) > 0);
  Index wall_nodes = 0;
  for (std::size_t f = 0; f < mesh.zones.at(0).faces.size(); ++f)
    if (mesh.linear.zones[0].faces[f].name.starts_with("Sphere"))
      for (const Index node : mesh.zones[0].faces[f].nodes)
      {
        const Point& x = mesh.nodes[static_cast<std::size_t>(node)];
        CHECK(std::hypot(x[0], x[1], x[2]) == Approx(1).epsilon(1e-8));
        ++wall_nodes;
      }
  CHECK(wall_nodes > 92 * 10);
}
