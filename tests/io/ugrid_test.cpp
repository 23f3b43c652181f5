#include "io/jacobian_signs.h"
#include "io/small_meshes.h"

#include <recurve/core/exceptions.h>
#include <recurve/io/mesh_io.h>

#include <catch2/catch.hpp>

#include <algorithm>
#include <bit>
#include <cstring>
#include <fstream>
#include <map>

using namespace recurve;
using namespace recurve::test;
namespace fs = std::filesystem;
using Catch::Matchers::Contains;

namespace {

/// A UGRID file number by number, for every encoding.
struct Numbers
{
  std::vector<std::int32_t> counts;
  std::vector<double> coordinates;
  std::vector<std::int32_t> rest;
};

/// One cell of each type, side by side, with a triangle of surface 3 and two quadrangles of the surfaces 3 and 7.
/// Points: the unit cube 1..8, a pyramid on its top (apex 9), a prism on the face x = 1 (10, 11 beyond), and a
/// tetrahedron on a face of the pyramid (12).
Numbers one_of_each()
{
  return {{12, 1, 2, 1, 1, 1, 1},
          {0, 0, 0, 1, 0, 0, 1,   1,   0, 0, 1, 0,   0, 0, 1,   1,   0,  1,
           1, 1, 1, 0, 1, 1, 0.5, 0.5, 2, 2, 0, 0.5, 2, 1, 0.5, 0.5, -1, 2},
          {5, 6,  9,                    // triangle
           1, 4,  3,  2, 1, 5,  8, 4,   // quadrangles
           3, 3,  7,                    // their surfaces
           5, 12, 6,  9,                // tetrahedron
           6, 5,  9,  7, 8,             // pyramid: base 5 6 7 8, the apex third
           2, 6,  10, 3, 7, 11,         // prism
           1, 2,  3,  4, 5, 6,  7, 8}}; // hexahedron
}

std::string encoded(const Numbers& numbers, const std::string& encoding)
{
  std::string text;
  if (encoding.empty())
  {
    for (const auto* group : {&numbers.counts, &numbers.rest})
    {
      for (const std::int32_t value : *group)
        text += std::to_string(value) + (text.size() % 7 == 0 ? "\n" : " ");
      if (group == &numbers.counts)
        for (const double value : numbers.coordinates)
          text += std::to_string(value) + "\n";
    }
    return text;
  }
  const auto put = [&](auto value) {
    std::array<char, sizeof value> bytes;
    std::memcpy(bytes.data(), &value, sizeof value);
    if ((std::endian::native == std::endian::little) != encoding.starts_with("l"))
      std::reverse(bytes.begin(), bytes.end());
    text.append(bytes.data(), bytes.size());
  };
  std::for_each(numbers.counts.begin(), numbers.counts.end(), put);
  for (const double value : numbers.coordinates)
    encoding.back() == '8' ? put(value) : put(static_cast<float>(value));
  std::for_each(numbers.rest.begin(), numbers.rest.end(), put);
  return text;
}

Zonal_mesh read_numbers(const Numbers& numbers, const std::string& encoding)
{
  const Temporary_file file("mesh" + (encoding.empty() ? "" : "." + encoding) + ".ugrid");
  std::ofstream(file.path(), std::ios::binary) << encoded(numbers, encoding);
  return read_ugrid(file.path());
}

} // namespace

TEST_CASE("UGRID reads the same in every encoding")
{
  const std::string encoding = GENERATE("", "b8", "lb8", "b4", "lb4");
  CAPTURE(encoding);
  const Zonal_mesh mesh = read_numbers(one_of_each(), encoding);
  const Zone& zone = mesh.linear.zones.at(0);
  REQUIRE(zone.cells.size() == 4);
  CHECK(zone.points[8] == Point{0.5, 0.5, 2});
  for (const Section& section : zone.cells)
    CHECK(section.size() == 1);
  CHECK(zone.cells[1].type == Element_type::pyramid);
  CHECK(zone.cells[1].nodes == std::vector<Index>{4, 5, 6, 7, 8});
  CHECK(zone.cells[2].nodes == std::vector<Index>{1, 5, 9, 2, 6, 10});
  REQUIRE(zone.patches.size() == 2);
  CHECK(zone.patches[0].name == "surface_3");
  CHECK(zone.patches[0].faces == std::vector<Index>{0, 1});
  CHECK(zone.patches[1].name == "surface_7");
  CHECK(zone.patches[1].faces == std::vector<Index>{2});
  // Every cell is the right way out: the corners stand in the order that is claimed.
  CHECK(smallest_middle_jacobian(to_curved_mesh(mesh)) > 0);
}

TEST_CASE("names and kinds of surfaces come from the file beside it")
{
  const Temporary_file file("named.b8.ugrid"), names("named.mapbc");
  std::ofstream(file.path(), std::ios::binary) << encoded(one_of_each(), "b8");
  std::ofstream(names.path()) << "3\n3 4000 wing\n7 6662   symmetry plane\n9 5000 far\n";
  const Zone zone = read_ugrid(file.path()).linear.zones.at(0);
  CHECK(zone.patches.at(0).name == "wing");
  CHECK(zone.patches[0].kind == "BCWallViscous");
  CHECK(zone.patches.at(1).name == "symmetry");
  CHECK(zone.patches[1].kind == "BCSymmetryPlane");
}

TEST_CASE("what UGRID files may have wrong is named")
{
  const std::string encoding = GENERATE("", "b8", "lb8");
  CAPTURE(encoding);
  const auto fails_with = [&](const Numbers& numbers, const std::string& words) {
    CHECK_THROWS_AS(read_numbers(numbers, encoding), Format_error);
    CHECK_THROWS_WITH(read_numbers(numbers, encoding), Contains(words));
  };
  Numbers numbers = one_of_each();
  numbers.counts[3] = 2147483647; // tetrahedra
  fails_with(numbers, "bytes of the nodes and elements");
  numbers = one_of_each();
  numbers.counts = {2147483647, 2147483647, 2147483647, 2147483647, 2147483647, 2147483647, 2147483647};
  fails_with(numbers, "bytes of the nodes and elements"); // and no sum overflows
  numbers = one_of_each();
  numbers.counts[0] = -1;
  fails_with(numbers, "-1");
  numbers = one_of_each();
  numbers.rest[14] = 13;
  fails_with(numbers, "tetrahedron 1: node 1 is number 13, outside 1..12");
  numbers.rest[14] = 0;
  fails_with(numbers, "number 0");
  numbers = one_of_each();
  numbers.coordinates[4] = std::numeric_limits<double>::quiet_NaN();
  fails_with(numbers, "node 2: coordinate Y is");
  numbers = one_of_each();
  numbers.rest.resize(14);
  std::fill(numbers.counts.begin() + 3, numbers.counts.end(), 0);
  fails_with(numbers, "no cells");
  fails_with({{}, {}, {}}, encoding.empty() ? "ends where" : "ends too early");
}

TEST_CASE("a binary UGRID file that is cut anywhere is refused")
{
  const std::string whole = encoded(one_of_each(), "b8");
  const Temporary_file file("cut.b8.ugrid");
  for (std::size_t size = 0; size < whole.size(); size += 3)
  {
    std::ofstream(file.path(), std::ios::binary) << whole.substr(0, size);
    CHECK_THROWS_AS(read_ugrid(file.path()), Format_error);
  }
}

TEST_CASE("Fortran records and the other byte order are told")
{
  CHECK_THROWS_WITH(read_ugrid("mesh.r8.ugrid"), Contains("Fortran"));
  const Temporary_file file("mesh.lb8.ugrid");
  std::ofstream(file.path(), std::ios::binary) << encoded(one_of_each(), "b8");
  CHECK_THROWS_WITH(read_ugrid(file.path()), Contains("bytes of the nodes and elements"));
}
