#include <recurve/mesh/volume_mesh.h>

#include <support/small_meshes.h>

#include <catch2/catch.hpp>

using namespace recurve;

TEST_CASE("elements are counted through sections", "[volume_mesh]")
{
  const Volume_mesh mesh = test::mixed_box();
  REQUIRE(mesh.zones[0].cell_count() == 1 + 2 + 5 + 2); // hexahedron, prisms, pyramids, tetrahedra
  REQUIRE(mesh.cell_count() == 10);
  REQUIRE(test::two_zone_box(Element_type::hexahedron, Element_type::prism).cell_count() == 8 + 16);
}

TEST_CASE("find_element finds the section and the number inside it", "[volume_mesh]")
{
  std::vector<Section> sections = {{"a", Element_type::triangle, std::vector<Index>(6)},
                                   {"empty", Element_type::triangle, {}},
                                   {"b", Element_type::quadrangle, std::vector<Index>(12)}};
  for (Index number = 0; number < 5; ++number)
  {
    CAPTURE(number);
    const Section_entry entry = find_element(sections, number);
    CHECK(entry.section == (number < 2 ? 0 : 2));
    CHECK(entry.element == (number < 2 ? number : number - 2));
  }
  CHECK(find_element(sections, 5).section == no_index);
  CHECK(find_element(sections, -1).section == no_index);
  CHECK(find_element({}, 0).element == no_index);
}

TEST_CASE("find_zone finds by name", "[volume_mesh]")
{
  const Volume_mesh mesh = test::two_zone_box(Element_type::hexahedron, Element_type::hexahedron);
  CHECK(find_zone(mesh, "right") == &mesh.zones[1]);
  CHECK(find_zone(mesh, "Right") == nullptr);
}
