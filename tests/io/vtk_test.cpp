#include "io/single_cell_mesh.h"
#include "io/small_meshes.h"

#include <recurve/core/exceptions.h>
#include <recurve/elements/basis.h>
#include <recurve/io/mesh_io.h>
#include <recurve/io/vtk.h>
#include <recurve/mesh/join_zones.h>

#include <catch2/catch.hpp>

#include <bit>
#include <cstring>
#include <fstream>
#include <map>
#include <regex>
#include <sstream>

using namespace recurve;
using namespace recurve::test;
namespace fs = std::filesystem;

namespace {

fs::path scratch_file(const std::string& name)
{
  const fs::path folder = fs::temp_directory_path() / "recurve_vtk_test";
  fs::create_directories(folder);
  return folder / name;
}

/// The arrays of a VTU file by name, as bytes: read by the rules of the format (a 64-bit count, then the data, at the
/// offset behind the underscore), without a line of the writer.
class Vtu_arrays
{
public:
  explicit Vtu_arrays(const fs::path& file)
  {
    std::ostringstream stream;
    stream << std::ifstream(file, std::ios::binary).rdbuf();
    text_ = stream.str();
    const std::size_t start = text_.find("<AppendedData encoding=\"raw\">\n_");
    REQUIRE(start != std::string::npos);
    const std::string header = text_.substr(0, start);
    const char* const data = text_.data() + text_.find('_', start) + 1;
    const std::regex pattern("<DataArray type=\"(\\w+)\" Name=\"([^\"]+)\"[^>]*offset=\"(\\d+)\"");
    for (std::sregex_iterator match(header.begin(), header.end(), pattern), end; match != end; ++match)
    {
      std::uint64_t size = 0;
      const char* const array = data + std::stoull((*match)[3]);
      std::memcpy(&size, array, sizeof size);
      bytes_[(*match)[2]] = std::string(array + sizeof size, size);
    }
    const std::regex piece("NumberOfPoints=\"(\\d+)\" NumberOfCells=\"(\\d+)\"");
    std::smatch match;
    REQUIRE(std::regex_search(header, match, piece));
    points = std::stoull(match[1]);
    cells = std::stoull(match[2]);
  }

  template <class Value>
  std::vector<Value> values(const std::string& name) const
  {
    const std::string& bytes = bytes_.at(name);
    std::vector<Value> result(bytes.size() / sizeof(Value));
    std::memcpy(result.data(), bytes.data(), bytes.size());
    return result;
  }

  std::size_t points = 0, cells = 0;

private:
  std::string text_;
  std::map<std::string, std::string> bytes_;
};

std::vector<std::string> folder_content(const fs::path& folder)
{
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder))
    names.push_back(entry.path().filename().string());
  return names;
}

} // namespace

TEST_CASE("a VTU file holds cells and faces of patches, of every type and degree")
{
  const auto type =
    GENERATE(Element_type::tetrahedron, Element_type::pyramid, Element_type::prism, Element_type::hexahedron);
  const int degree = GENERATE(range(1, max_degree + 1));
  CAPTURE(element_name(type), degree);
  const Curved_mesh mesh = test::single_cell_mesh(type, degree);
  const fs::path file = scratch_file("single.vtu");
  write_vtu(mesh, file);

  const Vtu_arrays vtu(file);
  const auto points = vtu.values<double>("Points");
  const auto connectivity = vtu.values<std::int64_t>("connectivity");
  const auto offsets = vtu.values<std::int64_t>("offsets");
  CHECK(vtu.cells == 1 + static_cast<std::size_t>(reference_element(type).face_count));
  CHECK(points.size() == 3 * vtu.points);
  CHECK(offsets.size() == vtu.cells);
  CHECK(static_cast<std::size_t>(offsets.back()) == connectivity.size());
  CHECK(vtu.values<std::uint8_t>("types").size() == vtu.cells);
  for (std::int64_t node : connectivity)
    CHECK((node >= 0 && static_cast<std::size_t>(node) < vtu.points));
  for (std::size_t n = 0; n < mesh.nodes.size(); ++n)
    CHECK(Point{points[3 * n], points[3 * n + 1], points[3 * n + 2]} == mesh.nodes[n]);
  if (type != Element_type::pyramid)
    CHECK(vtu.points == mesh.nodes.size());
}

TEST_CASE("a pyramid is written as the hexahedron that is collapsed onto its apex")
{
  const int degree = GENERATE(range(1, max_degree + 1));
  CAPTURE(degree);
  const fs::path file = scratch_file("pyramid.vtu");
  write_vtu(test::single_cell_mesh(Element_type::pyramid, degree), file);
  const Vtu_arrays vtu(file);
  const auto points = vtu.values<double>("Points");
  const auto connectivity = vtu.values<std::int64_t>("connectivity");
  REQUIRE(vtu.values<std::int64_t>("offsets")[0] == node_count(Element_type::hexahedron, degree));

  // The nodes of the mesh sample a polynomial, which the extra points must continue.
  const auto order = canonical_of_foreign(Node_order::vtk, Element_type::hexahedron, degree);
  for (std::size_t m = 0; m < order.size(); ++m)
  {
    const Lattice_point lattice = canonical_nodes(Element_type::hexahedron, degree)[static_cast<std::size_t>(order[m])];
    const double z = double(lattice[2]) / degree;
    const Point expected =
      test::polynomial_map(degree, {lattice[0] * (1 - z) / degree, lattice[1] * (1 - z) / degree, z});
    const auto at = 3 * static_cast<std::size_t>(connectivity[m]);
    for (std::size_t c = 0; c < 3; ++c)
      CHECK(points[at + c] == Approx(expected[c]).margin(1e-12));
  }
}

TEST_CASE("faces outside patches are left out and patches of one name share a number")
{
  Curved_mesh mesh = test::single_cell_mesh(Element_type::hexahedron, 2);
  mesh.linear.zones[0].patches = {{"wall", "BCWall", "", {0}}, {"inlet", "BCInflow", "", {2}}};
  mesh.zones.push_back(mesh.zones[0]);
  mesh.linear.zones.push_back(mesh.linear.zones[0]);
  mesh.linear.zones[1].name = "second";
  mesh.linear.zones[1].patches = {{"inlet", "BCInflow", "", {1, 3}}};

  const fs::path file = scratch_file("patches.vtu");
  write_vtu(mesh, file, {{"quality", {0.25, 0.5}}});
  const Vtu_arrays vtu(file);
  CHECK(vtu.values<std::int32_t>("zone") == std::vector<std::int32_t>{0, 1, 0, 0, 1, 1});
  CHECK(vtu.values<std::int32_t>("patch") == std::vector<std::int32_t>{-1, -1, 0, 1, 1, 1});
  const auto quality = vtu.values<double>("quality");
  REQUIRE(quality.size() == 6);
  CHECK(quality[0] == 0.25);
  CHECK(quality[1] == 0.5);
  CHECK(std::isnan(quality[2]));
}

TEST_CASE("fields that do not fit are refused before a file is made")
{
  const Curved_mesh mesh = test::single_cell_mesh(Element_type::prism, 1);
  const fs::path file = scratch_file("refused.vtu");
  CHECK_THROWS_AS(write_vtu(mesh, file, {{"quality", {1.0, 2.0}}}), Input_error);
  CHECK_THROWS_AS(write_vtu(mesh, file, {{"patch", {1.0}}}), Input_error);
  CHECK_THROWS_AS(write_vtu(mesh, file, {{"", {1.0}}}), Input_error);
  CHECK_FALSE(fs::exists(file));
}

TEST_CASE("a VTU file that is cancelled is removed")
{
  const Curved_mesh mesh = test::single_cell_mesh(Element_type::prism, 3);
  const fs::path file = scratch_file("cancelled.vtu");
  CHECK_THROWS_AS(write_vtu(mesh, file, {}, [](std::string_view, double fraction) { return fraction < 0.5; }),
                  Cancelled);
  CHECK_FALSE(fs::exists(file));
  CHECK_THROWS_AS(write_vtu(mesh, file.parent_path() / "missing" / "a.vtu"), Format_error);
  CHECK(folder_content(file.parent_path()).size() ==
        static_cast<std::size_t>(std::count_if(fs::directory_iterator(file.parent_path()), fs::directory_iterator(),
                                               [](const auto& entry) { return entry.path().extension() == ".vtu"; })));
}

TEST_CASE("a curved cell comes back from VTU to the bit")
{
  const Element_type type =
    GENERATE(Element_type::tetrahedron, Element_type::pyramid, Element_type::prism, Element_type::hexahedron);
  const int degree = GENERATE(1, 2, 3, 4, 5, 6);
  CAPTURE(element_name(type), degree);
  const Curved_mesh mesh = single_cell_mesh(type, degree);
  const Temporary_file file("back.vtu");
  write_vtu(mesh, file.path());
  Read_report report;
  const Curved_mesh back = read_curved_mesh(file.path(), &report);
  CHECK(report.notes.empty());
  CHECK(back.degree == degree);
  CHECK(back.nodes == mesh.nodes);
  CHECK(element_positions(back) == element_positions(mesh));
  CHECK(element_positions(back, &Curved_zone::faces) == element_positions(mesh, &Curved_zone::faces));
  REQUIRE(back.linear.zones[0].patches.size() == mesh.linear.zones[0].patches.size());
  for (std::size_t p = 0; p < mesh.linear.zones[0].patches.size(); ++p)
    CHECK(back.linear.zones[0].patches[p].name == mesh.linear.zones[0].patches[p].name);
}

TEST_CASE("zones and the nodes they share come back from VTU")
{
  Volume_mesh linear = two_zones(true);
  const Joined_zones joined = join_zones(linear);
  linear.zones[0].name = "left <&\"> \xC3\xA4";
  linear.zones[0].interfaces.clear();
  Curved_mesh mesh = elevate(std::move(linear), joined, 3);
  bend(mesh);
  const Temporary_file file("zones.vtu");
  write_vtu(mesh, file.path());
  const Curved_mesh back = read_curved_mesh(file.path());
  CHECK(back.linear.zones.at(0).name == "left <&\"> \xC3\xA4");
  CHECK(back.nodes.size() == mesh.nodes.size());
  CHECK(element_positions(back) == element_positions(mesh));
}

TEST_CASE("VTU files of others and damaged ones are refused")
{
  const Temporary_file file("damaged.vtu");
  write_vtu(single_cell_mesh(Element_type::pyramid, 3), file.path());
  std::ostringstream stream;
  stream << std::ifstream(file.path(), std::ios::binary).rdbuf();
  const std::string whole = stream.str();
  const auto refuse = [&](const std::string& text, const std::string& word) {
    std::ofstream(file.path(), std::ios::binary) << text;
    CHECK_THROWS_AS(read_vtu(file.path()), Format_error);
    CHECK_THROWS_WITH(read_vtu(file.path()), Catch::Matchers::Contains(word));
  };
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string text = whole;
    const std::size_t at = text.find(from);
    REQUIRE(at != std::string::npos);
    return text.replace(at, from.size(), to);
  };
  refuse(with("version=\"2.2\"", "version=\"1.0\""), "as recurve writes them");
  refuse(with("NumberOfPoints=\"", "NumberOfPoints=\"9"), "Points");
  refuse(with("NumberOfCells=\"", "NumberOfCells=\"9"), "lacks arrays");
  refuse(with("Name=\"pyramid_nodes\"", "Name=\"another_array\""), "pyramid_nodes");
  refuse(with("encoding=\"raw\"", "encoding=\"b64\""), "raw");
  refuse(with("Name=\"offsets\" NumberOfComponents=\"1\"", "Name=\"offsets\" NumberOfComponents=\"3\""), "offsets");
  for (std::size_t size = 0; size + 40 < whole.size(); size += 101)
  {
    CAPTURE(size);
    std::ofstream(file.path(), std::ios::binary) << whole.substr(0, size);
    CHECK_THROWS_AS(read_vtu(file.path()), Format_error);
  }
}
