#include "support/sphere_shell.h"

#include <recurve/core/exceptions.h>
#include <recurve/run/mesh_summary.h>

#include <catch2/catch.hpp>

using namespace recurve;

TEST_CASE("a mesh is summarized with what it says and what is implied")
{
  Volume_mesh mesh = test::sphere_shell({3, 2, Element_type::prism, test::Outer_shape::sphere});
  mesh.zones[0].patches.pop_back();
  mesh.zones[0].faces.pop_back();
  auto& prisms = mesh.zones[0].cells[0].nodes;
  for (std::size_t n = 0; n < 3; ++n)
    std::swap(prisms[n], prisms[n + 3]); // the first prism upside down is inside out
  std::vector<Stage_time> times;
  const Mesh_structure structure = find_structure(mesh, {}, times);
  const Mesh_summary summary = summarize(mesh, structure);

  CHECK(summary.cell_count() == 216); // two layers over the halves of 54 quadrangles
  CHECK(summary.cell_count(Element_type::prism) == summary.cell_count());
  CHECK(summary.cell_count(Element_type::hexahedron) == 0);
  CHECK(summary.point_count() == 168); // three times the 56 points on the surface of a cube
  REQUIRE(summary.patches.size() == 2);
  CHECK(summary.patches[0].name == "sphere");
  CHECK(summary.patches[0].triangles == 108);
  CHECK(summary.patches[0].quadrangles == 0);
  CHECK(summary.patches[0].place == Patch_place::boundary);
  CHECK(summary.patches[1].name == "unassigned");
  CHECK(summary.patches[1].triangles == 108);
  CHECK(summary.boundary.unassigned_faces == 108);
  CHECK(summary.orientation.mirrored_cells == 1);
  REQUIRE(times.size() == 3);
  CHECK(times[1].stage == "join zones");
}

TEST_CASE("a broken mesh is refused")
{
  Volume_mesh mesh = test::sphere_shell({2, 1, Element_type::hexahedron, test::Outer_shape::box});
  mesh.zones[0].cells[0].nodes[3] = 1000;
  std::vector<Stage_time> times;
  CHECK_THROWS_AS(find_structure(mesh, {}, times), Input_error);
}
