#include "exact_geometry.h"

#include <recurve/io/cgns.h>

#include <catch2/catch.hpp>

#include <map>
#include <string>
#include <vector>

using namespace recurve;

namespace {

/// A row of the table in data/README.md.
struct Stored_mesh
{
  std::string file;
  Index points;
  std::map<Element_type, Index> cells;
  std::map<std::string, Index> faces; ///< by patch
  test::Exact_geometry geometry;
  double size;
};

std::vector<Stored_mesh> stored_meshes()
{
  using enum Element_type;
  const test::Exact_geometry sphere = test::sphere_geometry();
  return {
    {"wing_tetrahedra.cgns",
     2994,
     {{tetrahedron, 14268}},
     {{"wing_upper", 1024}, {"wing_lower", 1024}, {"wing_tip", 30}, {"symmetry", 576}, {"farfield", 480}},
     test::wing_geometry(),
     5},
    {"sphere_tetrahedra.cgns", 555, {{tetrahedron, 2216}}, {{"sphere", 320}, {"box", 432}}, sphere, 2},
    {"sphere_hexahedra.cgns", 1526, {{hexahedron, 1296}}, {{"sphere", 216}, {"box", 216}}, sphere, 2},
    {"sphere_prisms.cgns", 1526, {{prism, 2592}}, {{"sphere", 432}, {"box", 432}}, sphere, 2},
    {"sphere_pyramids.cgns", 874, {{pyramid, 2304}}, {{"sphere", 96}, {"box", 96}}, sphere, 2},
    {"sphere_mixed.cgns",
     618,
     {{hexahedron, 128}, {prism, 256}, {pyramid, 704}, {tetrahedron, 128}},
     {{"sphere", 160}, {"box", 160}},
     sphere,
     2},
    {"cylinder_hexahedra.cgns",
     2016,
     {{hexahedron, 1440}},
     {{"cylinder", 72}, {"farfield", 72}, {"z_low", 480}, {"z_high", 480}},
     test::cylinder_geometry(),
     5},
  };
}

} // namespace

TEST_CASE("meshes of data/ are what data/README.md says")
{
  for (const Stored_mesh& expected : stored_meshes())
  {
    CAPTURE(expected.file);
    const Volume_mesh mesh = read_cgns(RECURVE_SOURCE_DIR "/data/" + expected.file);
    REQUIRE(mesh.zones.size() == 1);
    const Zone& zone = mesh.zones[0];
    CHECK(static_cast<Index>(zone.points.size()) == expected.points);

    std::map<Element_type, Index> cells;
    for (const Section& section : zone.cells)
      cells[section.type] += section.size();
    CHECK(cells == expected.cells);

    std::map<std::string, Index> faces;
    for (const Patch& patch : zone.patches)
    {
      CAPTURE(patch.name);
      faces[patch.name] = static_cast<Index>(patch.faces.size());
      CHECK(test::largest_residual(zone, patch, expected.geometry) <= 4e-16 * expected.size);
    }
    CHECK(faces == expected.faces);
    CHECK(test::volumes(zone)[1] > 0);
  }
}
