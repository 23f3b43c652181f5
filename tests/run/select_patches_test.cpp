#include "support/sphere_shell.h"

#include <recurve/core/exceptions.h>
#include <recurve/mesh/join_zones.h>
#include <recurve/run/select_patches.h>

#include <catch2/catch.hpp>

#include <numeric>

using namespace recurve;
using Catch::Matchers::Contains;

namespace {

/// Two shells in a row of names; what lies where does not matter, faces are made up.
struct Two_zones
{
  Two_zones()
  {
    const auto zone = [](const std::string& name, std::vector<Patch> patches, Index face_count) {
      Zone result;
      result.name = name;
      result.faces = {{"faces", Element_type::triangle, std::vector<Index>(static_cast<std::size_t>(3 * face_count))}};
      result.patches = std::move(patches);
      return result;
    };
    mesh.zones = {
      zone("rotor", {{"blade_1", "BCWall", "walls", {0, 1}}, {"hub", "BCWall", "walls", {2}}, {"fan", "", "", {3}}}, 5),
      zone("stator", {{"blade_1", "BCWall", "", {0}}, {"blade*", "", "", {1}}, {"gap", "", "", {2}}}, 3)};
    faces.owners.resize(2);
    for (std::size_t z = 0; z < 2; ++z)
      for (Index face = 0; face < mesh.zones[z].face_count(); ++face)
        faces.owners[z].push_back({{static_cast<Index>(z), face, 0}, {}});
    // "fan" and "gap" are the two sides of an interface.
    const Cell_face fan{0, 3, 0}, gap{1, 2, 0};
    faces.owners[0][3] = {fan, gap};
    faces.owners[1][2] = {gap, fan};
  }

  Face_selection select(const std::vector<std::string>& curve, const std::vector<std::string>& keep = {}) const
  {
    return select_patches(mesh, faces, curve, keep);
  }

  Volume_mesh mesh;
  Boundary_faces faces;
};

using Flags = std::vector<std::uint8_t>;

} // namespace

TEST_CASE("all boundary patches are curved by default, and nothing inside")
{
  const Two_zones zones;
  // Face 4 of the first zone is in no patch.
  CHECK(zones.select({}) == Face_selection{Flags{1, 1, 1, 0, 0}, Flags{1, 1, 0}});
  CHECK(zones.select({}, {"hub"}) == Face_selection{Flags{1, 1, 0, 0, 0}, Flags{1, 1, 0}});
}

TEST_CASE("patches are named by name, zone, family or wildcard")
{
  const Two_zones zones;
  CHECK(zones.select({"blade_1"}) == Face_selection{Flags{1, 1, 0, 0, 0}, Flags{1, 0, 0}});
  CHECK(zones.select({"stator/blade_1"}) == Face_selection{Flags{0, 0, 0, 0, 0}, Flags{1, 0, 0}});
  CHECK(zones.select({"stator/*"}, {"gap"}) == Face_selection{Flags{0, 0, 0, 0, 0}, Flags{1, 1, 0}});
  CHECK(zones.select({"walls"}) == Face_selection{Flags{1, 1, 1, 0, 0}, Flags{0, 0, 0}});
  CHECK(zones.select({"[bh]*"}) == Face_selection{Flags{1, 1, 1, 0, 0}, Flags{1, 1, 0}});
  CHECK(zones.select({"h?b", "stator/blade_1"}) == Face_selection{Flags{0, 0, 1, 0, 0}, Flags{1, 0, 0}});
}

TEST_CASE("an exact name goes before a wildcard")
{
  const Two_zones zones;
  CHECK(zones.select({"blade*"}) == Face_selection{Flags{0, 0, 0, 0, 0}, Flags{0, 1, 0}});
}

TEST_CASE("a patch inside the mesh is curved if it is named")
{
  const Two_zones zones;
  CHECK(zones.select({"gap"}) == Face_selection{Flags{0, 0, 0, 0, 0}, Flags{0, 0, 1}});
  CHECK(zones.select({"gap", "fan"}) == Face_selection{Flags{0, 0, 0, 1, 0}, Flags{0, 0, 1}});
}

TEST_CASE("faces without a cell are not curved")
{
  Two_zones zones;
  zones.faces.owners[0][0] = {};
  CHECK(zones.select({"blade_1"}) == Face_selection{Flags{0, 1, 0, 0, 0}, Flags{1, 0, 0}});
}

TEST_CASE("an unknown name is answered with the names there are")
{
  const Two_zones zones;
  CHECK_THROWS_AS(zones.select({"blde_1"}), Input_error);
  CHECK_THROWS_WITH(zones.select({"blde_1"}), Contains("\"blde_1\"") && Contains("did you mean \"blade_1\"?") &&
                                                Contains("blade*, blade_1, fan, gap, hub, walls"));
  CHECK_THROWS_WITH(zones.select({}, {"casing"}), Contains("\"casing\"") && !Contains("did you mean"));
  CHECK_THROWS_WITH(zones.select({"hub", "x*"}), Contains("\"x*\""));
}
