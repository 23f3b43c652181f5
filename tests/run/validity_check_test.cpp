#include <recurve/run/validity_check.h>

#include <recurve/io/mesh_io.h>
#include <recurve/mesh/join_zones.h>
#include <support/small_meshes.h>

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <string>

using namespace recurve;

namespace {

Curved_mesh curved_cell(Element_type type, int degree)
{
  Volume_mesh linear = test::one_cell(type);
  test::add_hull_patches(linear.zones[0], [](const Point& centre) { return centre[2] == 0 ? "floor" : "rest"; });
  const Joined_zones joined = join_zones(linear);
  return elevate(std::move(linear), joined, degree);
}

} // namespace

TEST_CASE("check_validity: a folded cell is named with its place and patches")
{
  const Element_type type = GENERATE(from_range(test::cell_types));
  const int degree = GENERATE(2, 4, 6);
  CAPTURE(element_name(type), degree);
  Curved_mesh mesh = curved_cell(type, degree);
  const Validity_check before = check_validity(mesh);
  CHECK(before.is_valid());
  CHECK(before.jacobians.straight_elements == 1);

  mesh.nodes.back() = {-3, -3, -3}; // no corner
  update_straight_cells(mesh);
  const Validity_check check = check_validity(mesh, 5);
  CHECK(!check.is_valid());
  CHECK(check.cells == 1);
  REQUIRE(check.worst.size() == 1);
  CHECK(check.worst[0].verdict == Validity::invalid);
  CHECK(check.worst[0].type == type);
  CHECK(check.worst[0].zone == "zone");
  REQUIRE(check.worst[0].patches.size() >= 2);
  CHECK(check.worst[0].patches[0].substr(0, 5) == "floor");
  CHECK(check.worst[0].patches[1].substr(0, 4) == "rest");
  CHECK(check.worst[0].position[2] > 0.1);
  CHECK(check.worst[0].position[2] < 0.6);
  CHECK(check.bounds.verdicts == std::vector<Validity>{Validity::invalid});

  const auto json = nlohmann::json::parse(to_json(check));
  CHECK(json["is_valid"] == false);
  CHECK(json["jacobians"]["by_type"][std::string(element_name(type))]["invalid"] == 1);
  CHECK(json["worst_cells"][0]["verdict"] == "invalid");
  const auto fields = cell_fields(check.bounds);
  REQUIRE(fields.size() == 2);
  CHECK(fields[1].values == std::vector<double>{1});
}

TEST_CASE("worst_cells: ascending, ties by number")
{
  Cell_bounds bounds(5);
  bounds.scaled = {0.5, -1, 0.2, -1, 0.9};
  CHECK(worst_cells(bounds, 3) == std::vector<Index>{1, 3, 2});
  CHECK(worst_cells(bounds, 9) == std::vector<Index>{1, 3, 2, 0, 4});
  CHECK(worst_cells(bounds, 0).empty());
}
