#include "io/single_cell_mesh.h"
#include "io/small_meshes.h"

#include <recurve/core/exceptions.h>
#include <recurve/io/surface_files.h>

#include <catch2/catch.hpp>

#include <cmath>
#include <cstring>
#include <fstream>
#include <map>
#include <sstream>

using namespace recurve;
using namespace recurve::test;

namespace {

struct Off
{
  std::vector<Point> points;
  std::vector<std::vector<std::size_t>> faces;
};

Off read_off(const std::filesystem::path& file)
{
  std::ifstream stream(file);
  std::string word;
  std::size_t points = 0, faces = 0, edges = 0;
  stream >> word >> points >> faces >> edges;
  REQUIRE(word == "OFF");
  Off off = {std::vector<Point>(points), std::vector<std::vector<std::size_t>>(faces)};
  for (Point& x : off.points)
    stream >> x[0] >> x[1] >> x[2];
  for (std::vector<std::size_t>& face : off.faces)
  {
    std::size_t count = 0;
    stream >> count;
    face.resize(count);
    for (std::size_t& corner : face)
      stream >> corner;
  }
  CHECK(stream);
  CHECK_FALSE(stream >> word);
  return off;
}

} // namespace

TEST_CASE("OFF holds the boundary as a closed surface that encloses the cell")
{
  const Element_type type =
    GENERATE(Element_type::tetrahedron, Element_type::pyramid, Element_type::prism, Element_type::hexahedron);
  const int degree = GENERATE(1, 2, 3, 6);
  CAPTURE(element_name(type), degree);
  const Curved_mesh mesh = single_cell_mesh(type, degree);
  const Temporary_file file("surface.off");
  write_off(mesh, file.path());
  const Off off = read_off(file.path());
  const std::size_t on_surface = mesh.nodes.size() - static_cast<std::size_t>(interior_node_count(type, degree));
  CHECK(off.points.size() == on_surface);
  for (std::size_t m = 0; m < on_surface; ++m)
    CHECK(off.points[m] == mesh.nodes[m]); // canonical order: what is inside comes last
  CHECK(off.faces.size() == static_cast<std::size_t>(reference_element(type).face_count * degree * degree));
  std::map<std::pair<std::size_t, std::size_t>, int> edges;
  double volume = 0;
  for (const std::vector<std::size_t>& face : off.faces)
    for (std::size_t c = 0; c < face.size(); ++c)
    {
      ++edges[{face[c], face[(c + 1) % face.size()]}];
      const Point &a = off.points[face[0]], &b = off.points[face[c]], &d = off.points[face[(c + 1) % face.size()]];
      volume +=
        (a[0] * (b[1] * d[2] - b[2] * d[1]) + a[1] * (b[2] * d[0] - b[0] * d[2]) + a[2] * (b[0] * d[1] - b[1] * d[0])) /
        6;
    }
  for (const auto& [edge, count] : edges)
  {
    CHECK(count == 1);
    CHECK(edges.count({edge.second, edge.first}) == 1);
  }
  CHECK(volume > 0); // seen from outside
  // Euler: one closed surface without holes.
  CHECK(off.points.size() + off.faces.size() == edges.size() / 2 + 2);
}

TEST_CASE("PLY has the size that its header states, names of patches and their numbers")
{
  const Curved_mesh mesh = single_cell_mesh(Element_type::prism, 2);
  const Temporary_file file("surface.ply");
  write_ply(mesh, file.path());
  std::ostringstream stream;
  stream << std::ifstream(file.path(), std::ios::binary).rdbuf();
  const std::string text = stream.str();
  CHECK(text.starts_with("ply\nformat binary_little_endian 1.0\ncomment patch 0 face 0\n"));
  CHECK(text.find("element vertex 18\n") != std::string::npos); // all nodes of the quadratic prism are on its surface
  CHECK(text.find("element face 20\n") != std::string::npos);
  const std::string end = "end_header\n";
  const std::size_t data = text.find(end) + end.size();
  CHECK(text.size() - data == 18 * 24 + 12 * (1 + 16 + 4) + 8 * (1 + 12 + 4));
  double x = 0;
  std::memcpy(&x, text.data() + data, sizeof x);
  CHECK(x == mesh.nodes[0][0]);
}

TEST_CASE("a mesh without patches has no surface to write")
{
  Curved_mesh mesh = single_cell_mesh(Element_type::prism, 2);
  mesh.linear.zones[0].patches.clear();
  const Temporary_file file("none.off");
  CHECK_THROWS_AS(write_off(mesh, file.path()), Input_error);
  CHECK_FALSE(std::filesystem::exists(file.path()));
}
