#include "io/single_cell_mesh.h"
#include "io/small_meshes.h"
#include "support/shared_data.h"

#include "../../toolkit/src/io/msh_layout.h"

#include <recurve/core/exceptions.h>
#include <recurve/io/gmsh.h>
#include <recurve/io/mesh_io.h>
#include <recurve/mesh/boundary_faces.h>
#include <recurve/mesh/join_zones.h>

#include <catch2/catch.hpp>

#include <bit>
#include <cmath>
#include <cstring>
#include <fstream>
#include <map>
#include <set>
#include <sstream>

using namespace recurve;
using namespace recurve::test;
namespace fs = std::filesystem;
using Catch::Matchers::Contains;

namespace {

Curved_mesh round_trip(const Curved_mesh& mesh, const Msh_options& options, Read_report& report)
{
  const Temporary_file file("round_trip.msh");
  write_msh(mesh, file.path(), options);
  return read_curved_mesh(file.path(), &report);
}

std::string content(const fs::path& file)
{
  std::ostringstream text;
  text << std::ifstream(file, std::ios::binary).rdbuf();
  return text.str();
}

/// reads `text` as an MSH file.
Zonal_mesh read_text(const std::string& text, Read_report* report = nullptr)
{
  const Temporary_file file("text.msh");
  std::ofstream(file.path(), std::ios::binary) << text;
  return read_msh(file.path(), report);
}

/// one tetrahedron and two of its faces, version 4.1, that tests alter.
const std::string tetrahedron_4 = "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n"
                                  "$PhysicalNames\n2\n2 2 \"wall\"\n3 1 \"fluid\"\n$EndPhysicalNames\n"
                                  "$Entities\n0 0 2 1\n1 0 0 0 1 1 1 1 2 0\n2 0 0 0 1 1 1 0 0\n"
                                  "1 0 0 0 1 1 1 1 1 2 1 2\n$EndEntities\n"
                                  "$Nodes\n1 4 1 4\n3 1 0 4\n1\n2\n3\n4\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n$EndNodes\n"
                                  "$Elements\n3 3 1 3\n2 1 2 1\n1 1 3 2\n2 2 2 1\n2 1 2 4\n3 1 4 1\n3 1 2 3 4\n"
                                  "$EndElements\n";

const std::string tetrahedron_2 = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n"
                                  "$PhysicalNames\n2\n2 2 \"wall\"\n3 1 \"fluid\"\n$EndPhysicalNames\n"
                                  "$Nodes\n4\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n$EndNodes\n"
                                  "$Elements\n3\n1 2 2 2 1 1 3 2\n2 2 2 0 2 1 2 4\n3 4 2 1 1 1 2 3 4\n$EndElements\n";

std::string with(std::string text, const std::string& from, const std::string& to)
{
  const std::size_t at = text.find(from);
  REQUIRE(at != std::string::npos);
  return text.replace(at, from.size(), to);
}

} // namespace

TEST_CASE("a curved cell comes back from MSH to the bit")
{
  const Element_type type =
    GENERATE(Element_type::tetrahedron, Element_type::pyramid, Element_type::prism, Element_type::hexahedron);
  const int degree = GENERATE(1, 2, 3, 4, 5, 6);
  const Msh_version version = GENERATE(Msh_version::v2_2, Msh_version::v4_1);
  const bool is_ascii = GENERATE(false, true);
  CAPTURE(element_name(type), degree, version, is_ascii);
  const Curved_mesh mesh = single_cell_mesh(type, degree);
  Read_report report;
  const Curved_mesh back = round_trip(mesh, {version, is_ascii}, report);
  CHECK(report.notes.empty());
  REQUIRE(back.degree == degree);
  CHECK(back.nodes == mesh.nodes);
  CHECK(back.zones[0].cells[0].nodes == mesh.zones[0].cells[0].nodes);
  CHECK(element_positions(back, &Curved_zone::faces) == element_positions(mesh, &Curved_zone::faces));
  CHECK(back.linear.zones[0].points == mesh.linear.zones[0].points);
  CHECK(back.linear.zones[0].name == mesh.linear.zones[0].name);
  REQUIRE(back.linear.zones[0].patches.size() == mesh.linear.zones[0].patches.size());
  for (std::size_t p = 0; p < mesh.linear.zones[0].patches.size(); ++p)
  {
    CHECK(back.linear.zones[0].patches[p].name == mesh.linear.zones[0].patches[p].name);
    CHECK(back.linear.zones[0].patches[p].faces == mesh.linear.zones[0].patches[p].faces);
  }
}

TEST_CASE("zones, patches and the nodes they share come back from MSH")
{
  const int degree = GENERATE(1, 2, 3);
  const Msh_version version = GENERATE(Msh_version::v2_2, Msh_version::v4_1);
  const bool is_ascii = GENERATE(false, true);
  CAPTURE(degree, version, is_ascii);
  Volume_mesh linear = two_zones(true);
  const Joined_zones joined = join_zones(linear);
  make_periodic(linear);
  Curved_mesh mesh = elevate(std::move(linear), joined, degree);
  bend(mesh);
  Read_report report;
  const Curved_mesh back = round_trip(mesh, {version, is_ascii}, report);
  CHECK(report.notes.empty());
  REQUIRE(back.zones.size() == 2);
  CHECK(back.nodes.size() == mesh.nodes.size());
  CHECK(element_positions(back) == element_positions(mesh));
  CHECK(element_positions(back, &Curved_zone::faces) == element_positions(mesh, &Curved_zone::faces));
  for (std::size_t z = 0; z < 2; ++z)
  {
    CHECK(back.linear.zones[z].name == mesh.linear.zones[z].name);
    REQUIRE(back.linear.zones[z].patches.size() == 1);
    CHECK(back.linear.zones[z].patches[0].name == mesh.linear.zones[z].patches[0].name);
  }
  const std::vector<Zone_interface>& interfaces = back.linear.zones[0].interfaces;
  REQUIRE(interfaces.size() == 2);
  CHECK(interfaces[0].name == "to_right");
  CHECK(interfaces[0].points == std::vector<Index>{1, 2, 5, 6});
  CHECK(interfaces[0].donor_points.size() == 4);
  for (const std::size_t connection : {0, 1})
    for (std::size_t m = 0; m < interfaces[connection].points.size(); ++m)
    {
      const Point& own = back.linear.zones[0].points[static_cast<std::size_t>(interfaces[connection].points[m])];
      const Point& other =
        back.linear.zones[1].points[static_cast<std::size_t>(interfaces[connection].donor_points[m])];
      CHECK(other[0] - own[0] == Approx(connection == 0 ? 0 : 2).margin(0.2)); // corners are bent
    }
  CHECK_FALSE(interfaces[0].periodicity);
  CHECK(interfaces[1].donor_zone == "right");
  CHECK(std::set<Index>(interfaces[1].points.begin(), interfaces[1].points.end()) == std::set<Index>{0, 3, 4, 7});
  REQUIRE(interfaces[1].periodicity);
  CHECK(interfaces[1].periodicity->translation == Point{2, 0, 0});
  CHECK(interfaces[1].periodicity->rotation_angle == Point{});
}

TEST_CASE("a rotation survives in a periodic link")
{
  Volume_mesh linear = two_zones(true);
  make_periodic(linear);
  const Periodicity map = {{0.5, -1, 2}, {0.3, -0.4, 0.5}, {1, 2, 3}};
  linear.zones[0].interfaces[1].periodicity = map;
  const Joined_zones joined = join_zones(two_zones(true));
  Read_report report;
  const Curved_mesh back = round_trip(elevate(std::move(linear), joined, 1), {Msh_version::v4_1, false}, report);
  const Periodicity found = back.linear.zones[0].interfaces.at(1).periodicity.value();
  for (std::size_t axis = 0; axis < 3; ++axis)
    CHECK(found.rotation_angle[axis] == Approx(map.rotation_angle[axis]).epsilon(1e-12));
  // The centre goes into the translation: both maps take the centre to centre + translation.
  const auto turned = [&](const Point& x) {
    const auto& [a, b, c] = found.rotation_angle;
    const Point x1 = {x[0], std::cos(a) * x[1] - std::sin(a) * x[2], std::sin(a) * x[1] + std::cos(a) * x[2]};
    const Point x2 = {std::cos(b) * x1[0] + std::sin(b) * x1[2], x1[1], -std::sin(b) * x1[0] + std::cos(b) * x1[2]};
    return Point{std::cos(c) * x2[0] - std::sin(c) * x2[1] + found.translation[0],
                 std::sin(c) * x2[0] + std::cos(c) * x2[1] + found.translation[1], x2[2] + found.translation[2]};
  };
  for (std::size_t axis = 0; axis < 3; ++axis)
    CHECK(turned(map.rotation_center)[axis] ==
          Approx(map.rotation_center[axis] + map.translation[axis]).epsilon(1e-12));
}

TEST_CASE("physical groups have names and numbers of their own")
{
  Curved_mesh mesh = single_cell_mesh(Element_type::hexahedron, 2);
  Zone& zone = mesh.linear.zones[0];
  zone.name = "wall";
  zone.patches[0].name = "wall";
  zone.patches[1].name = "wall";
  zone.patches[2].name = "a \"quoted\" name";
  zone.patches[3].name = std::string(200, 'x');
  zone.patches[4].name = std::string(200, 'x') + "y";
  const Temporary_file file("names.msh");
  write_msh(mesh, file.path(), {Msh_version::v4_1, true});
  const std::string text = content(file.path());
  CHECK_THAT(text, Contains("3 1 \"wall\"\n") && Contains("2 2 \"wall\"\n") && Contains("\"a 'quoted' name\"") &&
                     Contains("\"" + std::string(127, 'x') + "\"") && Contains("\"" + std::string(125, 'x') + "_2\""));
  const Curved_mesh back = read_curved_mesh(file.path());
  CHECK(back.linear.zones[0].patches.size() == 5); // two had one name
  CHECK(back.linear.zones[0].patches[0].faces == std::vector<Index>{0, 1});
}

TEST_CASE("faces in no patch become a group named like their section")
{
  Curved_mesh mesh = single_cell_mesh(Element_type::tetrahedron, 2);
  mesh.linear.zones[0].patches.erase(mesh.linear.zones[0].patches.begin());
  Read_report report;
  const Curved_mesh back = round_trip(mesh, {}, report);
  std::set<std::string> names;
  for (const Patch& patch : back.linear.zones[0].patches)
    names.insert(patch.name);
  CHECK(names == std::set<std::string>{"face 0", "face 1", "face 2", "face 3"});
}

TEST_CASE("surfaces in no physical group are sections in no patch")
{
  const std::string& text = GENERATE(tetrahedron_4, tetrahedron_2);
  const Volume_mesh mesh = read_text(text).linear;
  const Zone& zone = mesh.zones.at(0);
  CHECK(zone.name == "fluid");
  REQUIRE(zone.faces.size() == 2);
  CHECK(zone.faces[0].name == "wall");
  CHECK(zone.faces[1].name == "surface_2");
  REQUIRE(zone.patches.size() == 1);
  CHECK(zone.patches[0].faces == std::vector<Index>{0});
  CHECK(zone.cells[0].nodes == std::vector<Index>{0, 1, 2, 3});
}

TEST_CASE("node numbers may have gaps and any order")
{
  std::string text = with(tetrahedron_2, "1 0 0 0\n2 1 0 0", "2000000000 0 0 0\n2 1 0 0");
  text = with(text, "1 2 2 2 1 1 3 2", "1 2 2 2 1 2000000000 3 2");
  text = with(text, "2 2 2 0 2 1 2 4", "2 2 2 0 2 2000000000 2 4");
  text = with(text, "3 4 2 1 1 1 2 3 4", "3 4 2 1 1 2000000000 2 3 4");
  const Zone zone = read_text(text).linear.zones.at(0);
  CHECK(zone.points == std::vector<Point>{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, 0}});
  CHECK(zone.cells[0].nodes == std::vector<Index>{3, 0, 1, 2});
}

TEST_CASE("comments, unknown sections, points and lines are passed over")
{
  std::string text = "$Comments\nby hand $End\n$EndComments\n" + tetrahedron_2;
  text = with(text, "$Nodes", "$Surprise\n1 2 3\n$Nothing\n$EndSurprise\n\n  $Nodes");
  text = with(text, "$Elements\n3\n", "$Elements\n5\n8 15 2 1 1 1\n9 1 2 1 1 1 2\n");
  Read_report report;
  CHECK(read_text(text, &report).linear.zones.at(0).cell_count() == 1);
  CHECK(report.notes == std::vector<std::string>{"points and lines, left out: 2"});
}

TEST_CASE("files of the other byte order read the same")
{
  const bool is_4 = GENERATE(true, false);
  CAPTURE(is_4);
  std::string text;
  const auto put = [&text](auto value) {
    std::array<char, sizeof value> bytes;
    std::memcpy(bytes.data(), &value, sizeof value);
    if constexpr (std::endian::native == std::endian::little)
      std::reverse(bytes.begin(), bytes.end()); // always big endian
    text.append(bytes.data(), bytes.size());
  };
  const auto put_ints = [&](std::initializer_list<std::int32_t> values) {
    std::for_each(values.begin(), values.end(), put);
  };
  const auto put_sizes = [&](std::initializer_list<std::uint64_t> values) {
    std::for_each(values.begin(), values.end(), put);
  };
  const std::vector<Point> points = {{0, 0, 0}, {1.5, 0, 0}, {0, 1, 0}, {0, 0, 0.1}};
  text = is_4 ? "$MeshFormat\n4.1 1 8\n" : "$MeshFormat\n2.2 1 8\n";
  put_ints({1});
  text += "\n$EndMeshFormat\n";
  if (is_4)
  {
    text += "$Entities\n";
    put_sizes({0, 0, 0, 1});
    put_ints({1});
    for (int m = 0; m < 6; ++m)
      put(0.0);
    put_sizes({1});
    put_ints({-7});
    put_sizes({0});
    text += "\n$EndEntities\n$Nodes\n";
    put_sizes({1, 4, 1, 4});
    put_ints({3, 1, 0});
    put_sizes({4, 1, 2, 3, 4});
    for (const Point& point : points)
      for (const double x : point)
        put(x);
    text += "\n$EndNodes\n$Elements\n";
    put_sizes({1, 1, 1, 1});
    put_ints({3, 1, 4});
    put_sizes({1, 1, 1, 2, 3, 4});
  }
  else
  {
    text += "$Nodes\n4\n";
    for (int m = 0; m < 4; ++m)
    {
      put_ints({m + 1});
      for (const double x : points[static_cast<std::size_t>(m)])
        put(x);
    }
    text += "\n$EndNodes\n$Elements\n1\n";
    put_ints({4, 1, 2, 1, 7, 1, 1, 2, 3, 4});
  }
  text += "\n$EndElements\n";
  const Zone zone = read_text(text).linear.zones.at(0);
  CHECK(zone.name == "physical_7");
  CHECK(zone.points == points);
  CHECK(zone.cells[0].nodes == std::vector<Index>{0, 1, 2, 3});
}

TEST_CASE("a partitioned file reads as the whole; faces between partitions stay out")
{
  // Entity (2, 9) comes from partitioning: its parent is a volume.
  const std::string text =
    "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$PhysicalNames\n2\n2 2 \"wall\"\n3 1 \"fluid\"\n$EndPhysicalNames\n"
    "$Entities\n0 0 1 1\n1 0 0 0 1 1 1 1 2 0\n1 0 0 0 1 1 1 1 1 0\n$EndEntities\n"
    "$PartitionedEntities\n2\n0\n0 0 2 2\n"
    "8 2 1 1 1 0 0 0 1 1 1 1 2 0\n9 3 1 2 1 2 0 0 0 1 1 1 0 0\n"
    "5 3 1 1 1 0 0 0 1 1 1 1 1 0\n6 3 1 1 2 0 0 0 1 1 1 1 1 0\n$EndPartitionedEntities\n"
    "$Nodes\n2 5 1 5\n3 5 0 4\n1\n2\n3\n4\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 6 0 1\n5\n1 1 1\n$EndNodes\n"
    "$Elements\n4 4 1 4\n2 8 2 1\n1 1 3 2\n2 9 2 1\n2 2 3 4\n3 5 4 1\n3 1 2 3 4\n3 6 4 1\n4 2 3 4 5\n$EndElements\n"
    "$GhostElements\n1\n3 1 1 2\n$EndGhostElements\n";
  Read_report report;
  const Volume_mesh mesh = read_text(text, &report).linear;
  REQUIRE(mesh.zones.size() == 1);
  CHECK(mesh.zones[0].name == "fluid");
  CHECK(mesh.zones[0].cell_count() == 2);
  CHECK(mesh.zones[0].face_count() == 1);
  CHECK(mesh.zones[0].patches.at(0).name == "wall");
  CHECK(report.notes == std::vector<std::string>{"faces between partitions, left out: 1"});
}

TEST_CASE("a periodic link without a matrix is a translation if its nodes say so")
{
  const std::string link = GENERATE("2 1 2\n0\n1\n2 1\n", "2 1 2\n0\n2\n2 1\n4 1\n");
  CAPTURE(link);
  Read_report report;
  const Volume_mesh mesh = read_text(tetrahedron_4 + "$Periodic\n1\n" + link + "$EndPeriodic\n", &report).linear;
  if (report.notes.empty())
    CHECK(mesh.zones[0].interfaces.at(0).periodicity->translation == Point{1, 0, 0});
  else
    CHECK(mesh.zones[0].interfaces.empty());
  CHECK(report.notes.empty() == (link.size() < 15));
}

TEST_CASE("what MSH files may have wrong is named, with its place")
{
  struct Fault
  {
    std::string text;
    std::vector<std::string> words;
  };
  const std::string &v4 = tetrahedron_4, &v2 = tetrahedron_2;
  const std::string huge = "18446744073709551615", large = "4000000000000";
  const std::vector<Fault> faults = {
    {"", {"$MeshFormat"}},
    {"solid nonsense\n", {"line 2", "section"}},
    {"$NOD\n1\n1 0 0 0\n$ENDNOD\n", {"version 1"}},
    {with(v4, "4.1 0 8", "4 0 8"), {"version 4", "msh41"}},
    {with(v4, "4.1 0 8", "3.0 0 8"), {"version 3"}},
    {with(v4, "4.1 0 8", "4.1 0 16"), {"16 bytes"}},
    {with(v4, "4.1 0 8", "4.1 x 8"), {"line 2", "'x'"}},
    {with(v4, "$EndNodes", "$EndNode"), {"$EndNodes"}},
    {v4.substr(0, v4.find("0 1 0\n0 0 1")), {"4 nodes", "rest of the file"}},
    {v2.substr(0, v2.find("3 4 2 1 1")), {"ends where"}},
    {v2.substr(0, v2.find("$Elements")), {"$Elements"}},
    {with(v4, "3 1 2 3 4\n", "3 1 2 3 5\n"), {"element 3", "number 5"}},
    {with(v2, "3 4 2 1 1 1 2 3 4", "3 4 2 1 1 1 2 3 0"), {"element 3", "node 4", "number 0"}},
    {with(v2, "3 4 2 1 1 1 2 3 4", "3 4 2 1 1 1 2 3 -4"), {"element 3", "number -4"}},
    {with(v2, "3 4 2 1 1 1 2 3 4", "3 4 -2 1 1 1 2 3 4"), {"-2 tags"}},
    {with(v2, "3 4 2 1 1", "3 4 " + large), {"tags"}},
    {with(v2, "3 4 2 1 1", "3 4 2 99999999999 1"), {"tag 99999999999"}},
    {with(v2, "$Nodes\n4", "$Nodes\n-4"), {"-4 nodes"}},
    {with(v2, "$Nodes\n4", "$Nodes\n" + large), {large, "nodes", "rest of the file"}},
    {with(v2, "$Nodes\n4", "$Nodes\n" + huge), {"number of nodes"}},
    {with(v2, "$Elements\n3", "$Elements\n" + large), {large, "elements"}},
    {with(v4, "$Nodes\n1 4", "$Nodes\n1 " + huge), {huge}},
    {with(v4, "$Nodes\n1 4", "$Nodes\n" + large + " 4"), {large, "blocks"}},
    {with(v4, "$Nodes\n1 4 1 4\n3 1 0 4", "$Nodes\n1 4 1 4\n3 1 0 5"), {"more nodes"}},
    {with(v4, "$Nodes\n1 4", "$Nodes\n1 5"), {"4 nodes", "states 5"}},
    {with(v4, "$Elements\n3 3", "$Elements\n3 4"), {"3 elements", "states 4"}},
    {with(v4, "3 1 4 1\n3 1", "3 1 4 2\n3 1"), {"more elements"}},
    {with(v4, "$Entities\n0 0 2", "$Entities\n0 0 " + large), {large, "entities"}},
    {with(v2, "4 0 0 1", "4 0 nan 1"), {"node 4", "Y", "nan"}},
    {with(v2, "4 0 0 1", "4 0 0 inf"), {"node 4", "Z", "inf"}},
    {with(v2, "4 0 0 1", "4 0 0 1e999"), {"1e999"}},
    {with(v2, "4 0 0 1", "3 0 0 1"), {"two nodes of number 3"}},
    {with(v2, "3 4 2 1 1 1 2 3 4", "3 17 2 1 1 1 2 3 4"), {"type 17", "complete"}},
    {with(v2, "3 4 2 1 1 1 2 3 4", "3 999999 2 1 1 1 2 3 4"), {"type 999999"}},
    {with(v2, "3 4 2 1 1 1 2 3 4", "3 11 2 1 1 1 2 3 4 1 2 3 4 1 2"), {"degree 2", "degree 1"}},
    {with(v2, "$Elements\n3", "$Elements\n2").replace(v2.find("3 4 2 1 1"), 18, ""), {"3D"}},
    {with(v2, "2 2 \"wall\"", "2 2 wall"), {"group 2", "quotation"}},
    {v2 + v2.substr(v2.find("$Nodes")), {"$Nodes twice"}},
    {with(v2, "$Nodes", "$Nades"), {"ends inside $Nades"}},
    {v4 + "$Periodic\n1\n2 1 2\n0\n1\n2 99\n$EndPeriodic\n", {"$Periodic", "node 99"}},
    {v4 + "$Periodic\n1\n2 1 2\n" + large + "\n1\n2 99\n$EndPeriodic\n", {large}},
    {std::string(100000, 'x'), {"line 1"}},
    {"$MeshFormat\n" + std::string(100000, 'x'), {"without end"}}};
  for (const Fault& fault : faults)
  {
    CAPTURE(fault.text.substr(0, 2000));
    try
    {
      read_text(fault.text);
      FAIL("was read");
    }
    catch (const Format_error& error)
    {
      const std::string message = error.what();
      CHECK_THAT(message, Contains("text.msh: "));
      for (const std::string& word : fault.words)
        CHECK_THAT(message, Contains(word));
      CHECK(message.find('\n') == std::string::npos);
    }
  }
}

TEST_CASE("a binary MSH file that is cut anywhere is refused")
{
  const Msh_version version = GENERATE(Msh_version::v2_2, Msh_version::v4_1);
  const Temporary_file file("cut.msh");
  write_msh(single_cell_mesh(Element_type::prism, 2), file.path(), {version, false});
  const std::string whole = content(file.path());
  const std::size_t end = whole.find("$EndElements");
  for (std::size_t size = 0; size < end; size += 7)
  {
    CAPTURE(size);
    CHECK_THROWS_AS(read_text(whole.substr(0, size)), Format_error);
  }
}

TEST_CASE("MSH 2.2 refuses what 32 bits cannot count")
{
  const Index most = 2147483647;
  CHECK_NOTHROW(internal::msh::check_counts_of_2(most, most));
  CHECK_THROWS_AS(internal::msh::check_counts_of_2(most + 1, 1), Input_error);
  CHECK_THROWS_WITH(internal::msh::check_counts_of_2(1, most + 1), Contains("2147483648") && Contains("4.1"));
}

namespace {

/// the files of shared/data/curved with this stem, whatever version and degree.
std::vector<fs::path> shared_meshes(const std::string& stem)
{
  std::vector<fs::path> files;
  for (int degree = 1; degree <= 4; ++degree)
    for (const char* version : {"v22", "v41"})
    {
      // Version 4.1 is there for the odd degrees only.
      if (std::string(version) == "v41" && degree % 2 == 0)
        continue;
      if (const auto file = shared_data("curved/" + stem + "_p" + std::to_string(degree) + "_" + version + ".msh"))
        files.push_back(*file);
    }
  return files;
}

} // namespace

TEST_CASE("meshes that Gmsh curved around a sphere and a cylinder have their nodes on them")
{
  struct Family
  {
    std::string stem;
    bool is_sphere;
    double radius;
  };
  const Family family =
    GENERATE(Family{"tet_sphere_R0.5_in_box", true, 0.5}, Family{"hex_annulus_R0.5_R2", false, 0.5},
             Family{"prism_annulus_R0.5_R2", false, 0.5}, Family{"mixed_pyr_tet_hex_cylinder_R1", false, 1});
  const std::vector<fs::path> files = shared_meshes(family.stem);
  if (files.empty())
    return;
  for (const fs::path& file : files)
  {
    CAPTURE(file);
    const Curved_mesh mesh = read_curved_mesh(file);
    CHECK(file.string().find("_p" + std::to_string(mesh.degree)) != std::string::npos);
    Index on_surface = 0;
    for (const Point& x : mesh.nodes)
      on_surface += std::abs(std::hypot(x[0], x[1], family.is_sphere ? x[2] : 0) - family.radius) < 1e-12;
    CHECK(on_surface >= 16);
    // Patches of the boundary, and every face of them a face of a cell, in agreement with the cell on all its nodes.
    std::map<std::vector<Index>, int> sides;
    for (const Curved_section& section : mesh.zones.at(0).cells)
      for (std::size_t first = 0; first < section.nodes.size();
           first += static_cast<std::size_t>(node_count(section.type, mesh.degree)))
        for (int f = 0; f < reference_element(section.type).face_count; ++f)
        {
          std::vector<Index> nodes;
          for (const int node : face_nodes(section.type, mesh.degree, f))
            nodes.push_back(section.nodes[first + static_cast<std::size_t>(node)]);
          std::sort(nodes.begin(), nodes.end());
          ++sides[nodes];
        }
    Index faces = 0;
    for (const Curved_section& section : mesh.zones.at(0).faces)
      for (std::size_t first = 0; first < section.nodes.size();
           first += static_cast<std::size_t>(node_count(section.type, mesh.degree)), ++faces)
      {
        std::vector<Index> nodes(section.nodes.begin() + static_cast<std::ptrdiff_t>(first),
                                 section.nodes.begin() + static_cast<std::ptrdiff_t>(first) +
                                   node_count(section.type, mesh.degree));
        std::sort(nodes.begin(), nodes.end());
        CHECK(sides[nodes] == 1);
      }
    CHECK(faces > 0);
  }
}
