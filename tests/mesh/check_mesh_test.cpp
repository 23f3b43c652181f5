#include <recurve/core/exceptions.h>
#include <recurve/mesh/check_mesh.h>

#include <support/small_meshes.h>

#include <catch2/catch.hpp>

#include <limits>

using namespace recurve;
using Catch::Contains;

namespace {

Volume_mesh good()
{
  return test::two_zone_box(Element_type::tetrahedron, Element_type::tetrahedron);
}

std::string fault_of(const Volume_mesh& mesh)
{
  try
  {
    check_mesh(mesh);
  }
  catch (const Input_error& error)
  {
    return error.what();
  }
  return "no fault";
}

} // namespace

TEST_CASE("good meshes pass", "[check_mesh]")
{
  for (const Element_type type : test::cell_types)
    CHECK_NOTHROW(check_mesh(test::box(type)));
  CHECK_NOTHROW(check_mesh(test::mixed_box()));
  CHECK_NOTHROW(check_mesh(good()));
}

TEST_CASE("an empty mesh is refused", "[check_mesh]")
{
  CHECK_THAT(fault_of({}), Contains("no zones"));
  Volume_mesh mesh = good();
  mesh.zones[1].cells.clear();
  CHECK_THAT(fault_of(mesh), Contains("zone 'right' has no cells"));
  mesh = good();
  mesh.zones[0].points.clear();
  CHECK_THAT(fault_of(mesh), Contains("zone 'left' has no points"));
}

TEST_CASE("coordinates must be finite", "[check_mesh]")
{
  for (const double x : {std::numeric_limits<double>::quiet_NaN(), -std::numeric_limits<double>::infinity()})
  {
    Volume_mesh mesh = good();
    mesh.zones[1].points[6][1] = x;
    CHECK_THAT(fault_of(mesh), Contains("zone 'right'") && Contains("coordinate Y of node 7"));
  }
}

TEST_CASE("node numbers must name nodes of the zone", "[check_mesh]")
{
  const Index beyond = static_cast<Index>(good().zones[0].points.size());
  for (const Index node : {Index(-1), beyond, Index(1) << 40})
  {
    CAPTURE(node);
    Volume_mesh mesh = good();
    mesh.zones[0].cells[0].nodes[9] = node;
    CHECK_THAT(fault_of(mesh), Contains("zone 'left', section 'tetrahedron', element 3: node " +
                                        std::to_string(node + 1) + " does not exist"));
    mesh = good();
    mesh.zones[0].faces[1].nodes[2] = node;
    CHECK_THAT(fault_of(mesh), Contains("section '" + mesh.zones[0].faces[1].name + "', element 1: node"));
    mesh = good();
    mesh.zones[0].bars.push_back({"wire", Element_type::line, {0, node}});
    CHECK_THAT(fault_of(mesh), Contains("section 'wire', element 1: node"));
  }
}

TEST_CASE("sections hold whole elements of their dimension", "[check_mesh]")
{
  Volume_mesh mesh = good();
  mesh.zones[0].cells[0].nodes.pop_back();
  CHECK_THAT(fault_of(mesh), Contains("section 'tetrahedron'") && Contains("multiple of 4"));
  mesh = good();
  mesh.zones[0].cells.push_back(mesh.zones[0].faces[0]);
  CHECK_THAT(fault_of(mesh), Contains("type triangle have dimension 2, expected 3"));
}

TEST_CASE("zones have names of their own", "[check_mesh]")
{
  Volume_mesh mesh = good();
  mesh.zones[1].name = "left";
  CHECK_THAT(fault_of(mesh), Contains("two zones are named 'left'"));
}

TEST_CASE("patches list existing faces once", "[check_mesh]")
{
  Volume_mesh mesh = good();
  mesh.zones[0].patches[1].faces.push_back(mesh.zones[0].face_count());
  CHECK_THAT(fault_of(mesh), Contains("patch '" + mesh.zones[0].patches[1].name + "'") && Contains("does not exist"));
  mesh = good();
  mesh.zones[0].patches[1].faces = {mesh.zones[0].patches[0].faces[0]};
  CHECK_THAT(fault_of(mesh), Contains("is in patch"));
  mesh = good();
  mesh.zones[0].patches[1].faces.push_back(mesh.zones[0].patches[1].faces.back());
  CHECK_THAT(fault_of(mesh), Contains("listed twice"));
}

TEST_CASE("interfaces name zones and nodes that exist", "[check_mesh]")
{
  Zone_interface interface;
  interface.name = "seam";
  interface.donor_zone = "right";
  interface.points = {0, 1};
  interface.donor_points = {0, 1};
  const auto with = [&] {
    Volume_mesh mesh = good();
    mesh.zones[0].interfaces.push_back(interface);
    return fault_of(mesh);
  };
  CHECK(with() == "no fault");
  interface.donor_points = {0, 10000};
  CHECK_THAT(with(), Contains("interface 'seam'") && Contains("node 10001 of zone 'right'"));
  interface.location = Zone_interface::Location::face;
  CHECK_THAT(with(), Contains("face 10001 of zone 'right'"));
  interface.donor_points = {0};
  CHECK_THAT(with(), Contains("2 points meet 1"));
  interface.donor_zone = "nobody";
  CHECK_THAT(with(), Contains("there is no zone 'nobody'"));
  interface.is_abutting_one_to_one = false; // kept as a name only
  CHECK(with() == "no fault");
}
