#include "support/sphere_shell.h"

#include <recurve/core/exceptions.h>
#include <recurve/run/curve_mesh.h>
#include <recurve/run/feature_file.h>
#include <recurve/run/list_features.h>

#include <catch2/catch.hpp>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <set>
#include <sstream>

using namespace recurve;
using Catch::Matchers::Contains;
using Kind = Feature_edit_kind;

namespace {

/// the shell around a sphere in a box: the features are the edges of the box, four mesh edges each. Coordinates are
/// rounded, so that the box is exactly [-2, 2]^3 and an edge of it has points at -2, -0.828125, 0, ...
Volume_mesh shell()
{
  Volume_mesh mesh = test::sphere_shell({4, 2, Element_type::hexahedron, test::Outer_shape::box});
  for (Point& p : mesh.zones[0].points)
    for (double& x : p)
      x = std::round(1024 * x) / 1024;
  return mesh;
}

constexpr const char* all_kinds = R"(
start = "none"
turning_angle = 35
chain_angle = 12.5

[[edit]]
action = "add"
edges = [[[0.1, -1e-300, 3], [1, 2.5, 3]],
         [{zone = "blk \"1\"", node = 7}, {at = [1, 2, 3], copy = 1}]]
[[edit]]
action = "add"
path = [[0, 0, 0], [1, 0, 0], [1, 1, 0]]
[[edit]]
action = "remove"
crease = [[0, 0, 0], [1, 0, 0]]
[[edit]]
action = "add"
chain = [[0, 0, 0], [1, 0, 0]]
angle = 20
[[edit]]
action = "remove"
box = [[0, 0, 0], [1, 1, 1]]
[[edit]]
action = "add"
patches = ["upper", "lower"]
[[edit]]
action = "add"
patches = ["upper"]
[[edit]]
action = "mark"
vertices = [[0, 0, 0]]
[[edit]]
action = "unmark"
vertices = [[1, 0, 0]]
)";

Feature_file parse(const std::string& text)
{
  return parse_feature_file(text, "edits.toml");
}

Feature_listing list(const std::string& edits)
{
  return list_features(shell(), {.feature_edits = parse(edits)});
}

Index edge_count(const Feature_listing& listing)
{
  Index count = 0;
  for (const Listed_curve& curve : listing.curves)
    count += static_cast<Index>(curve.points.size()) - (curve.is_closed ? 0 : 1);
  return count;
}

void check_equal(const Feature_listing& a, const Feature_listing& b)
{
  REQUIRE(a.curves.size() == b.curves.size());
  for (std::size_t i = 0; i < a.curves.size(); ++i)
  {
    CHECK(a.curves[i].points == b.curves[i].points);
    CHECK(a.curves[i].is_closed == b.curves[i].is_closed);
  }
  CHECK(a.sharp_points == b.sharp_points);
  CHECK(to_csv(a) == to_csv(b));
}

} // namespace

TEST_CASE("feature file: every kind of edit is read")
{
  const Feature_file file = parse(all_kinds);
  CHECK_FALSE(file.starts_from_detection);
  CHECK(file.options.turning_angle == 35);
  CHECK(file.options.chain_angle == 12.5);
  CHECK(file.options.corner_defect == Feature_edit_options{}.corner_defect);
  REQUIRE(file.edits.size() == 9);
  const Kind expected[] = {Kind::edges,   Kind::shortest_path, Kind::crease_path, Kind::chain,   Kind::box,
                           Kind::patches, Kind::patches,       Kind::vertices,    Kind::vertices};
  const bool is_added[] = {true, true, false, true, false, true, true, true, false};
  for (std::size_t i = 0; i < 9; ++i)
  {
    CHECK(file.edits[i].edit.kind == expected[i]);
    CHECK(file.edits[i].edit.is_added == is_added[i]);
  }
  const Feature_file_edit& edges = file.edits[0];
  REQUIRE(edges.edit.vertices.size() == 4);
  CHECK(edges.edit.vertices[0].position == Point{0.1, -1e-300, 3});
  CHECK(edges.nodes[0].zone.empty());
  CHECK(edges.nodes[2].zone == "blk \"1\"");
  CHECK(edges.nodes[2].node == 7);
  CHECK(edges.edit.vertices[3].copy == 1);
  CHECK(edges.edit.origin == "edits.toml, line 6");
  CHECK(file.edits[1].edit.vertices.size() == 3);
  CHECK(file.edits[3].edit.angle == 20);
  CHECK(file.edits[4].edit.largest == Point{1, 1, 1});
  CHECK(file.edits[5].patches == std::array<std::string, 2>{"upper", "lower"});
  CHECK(file.edits[6].patches == std::array<std::string, 2>{"upper", ""});
  CHECK(parse("").starts_from_detection);
}

TEST_CASE("feature file: what is written reads as the same, to the last bit")
{
  Feature_file file = parse(all_kinds);
  file.edits[0].edit.vertices[0].position = {1 / 3., std::nextafter(1, 2), -1e22};
  file.edits[3].edit.angle = std::nextafter(20, 21);
  file.edits[5].patches[0] = "up\\per \"a\"\n";
  const Feature_file again = parse(to_toml(file));
  CHECK(to_toml(again) == to_toml(file));
  REQUIRE(again.edits.size() == file.edits.size());
  for (std::size_t i = 0; i < file.edits.size(); ++i)
  {
    const Feature_file_edit &a = file.edits[i], &b = again.edits[i];
    CHECK(a.edit.kind == b.edit.kind);
    CHECK(a.edit.is_added == b.edit.is_added);
    CHECK(a.edit.angle == b.edit.angle);
    CHECK(a.edit.smallest == b.edit.smallest);
    CHECK(a.edit.largest == b.edit.largest);
    CHECK(a.patches == b.patches);
    REQUIRE(a.edit.vertices.size() == b.edit.vertices.size());
    for (std::size_t v = 0; v < a.edit.vertices.size(); ++v)
    {
      CHECK(a.edit.vertices[v].position == b.edit.vertices[v].position);
      CHECK(a.edit.vertices[v].copy == b.edit.vertices[v].copy);
      CHECK(a.nodes[v].zone == b.nodes[v].zone);
      CHECK(a.nodes[v].node == b.nodes[v].node);
    }
  }
  const auto path = std::filesystem::temp_directory_path() / "recurve_feature_file_test.toml";
  write_feature_file(file, path);
  CHECK(to_toml(read_feature_file(path)) == to_toml(file));
  std::filesystem::remove(path);
  CHECK_THROWS_AS(read_feature_file(path), Format_error);
  CHECK_THROWS_WITH(read_feature_file(path), Contains("recurve_feature_file_test.toml: cannot be read"));
}

TEST_CASE("feature file: mistakes are told with file and line")
{
  const auto fails = [](const std::string& text, const std::string& place, const std::string& word) {
    CAPTURE(text);
    CHECK_THROWS_AS(parse(text), Format_error);
    CHECK_THROWS_WITH(parse(text), Contains("edits.toml" + place) && Contains(word));
  };
  const std::string edit = "# comment\n[[edit]]\naction = \"add\"\n";
  fails("start = ", ", line 1", "");
  fails("start = \"auto\"\nstart = \"auto\"", ", line 2", "start");
  fails("\nstart = \"never\"", ", line 2", "\"auto\" or \"none\", found \"never\"");
  fails("start = 1", ", line 1", "found no text");
  fails("begin = 1", ", line 1", "unknown key \"begin\"");
  fails("turning_angle = \"wide\"", ", line 1", "turning_angle");
  fails("turning_angle = nan", ", line 1", "finite");
  fails("turning_angle = 400", "", "between 0 and 180");
  fails("edit = 3", ", line 1", "[[edit]]");
  fails(edit, ", line 2", "does not say what");
  fails("[[edit]]\nvertices = [[0, 0, 0]]", ", line 1", "no action");
  fails("[[edit]]\naction = \"add\"\nvertices = [[0, 0, 0]]", ", line 2", "\"mark\" or \"unmark\"");
  fails(edit + "path = [[0, 0, 0]]", ", line 4", "two or more");
  fails(edit + "path = [[0, 0, 0], [0, 0]]", ", line 4", "three coordinates");
  fails(edit + "path = [[0, 0, 0], [0, 0, \"1\"]]", ", line 4", "coordinate");
  fails(edit + "path = [[0, 0, 0], [0, 0, inf]]", ", line 4", "finite");
  fails(edit + "path = [[0, 0, 0],\n{node = 3}]", ", line 5", "a vertex is written as");
  fails(edit + "path = [[0, 0, 0], {zone = \"a\", node = -1}]", ", line 4", "from 0");
  fails(edit + "path = [[0, 0, 0], {zone = \"a\", point = 1}]", ", line 4", "unknown key \"point\"");
  fails(edit + "edges = [[0, 0, 0], [1, 0, 0]]", ", line 4", "an edge is written as");
  fails(edit + "edges = []", ", line 4", "no edge");
  fails(edit + "chain = [[0, 0, 0], [1, 0, 0], [2, 0, 0]]", ", line 4", "one edge");
  fails(edit + "chain = [[0, 0, 0], [1, 0, 0]]\nangle = 200", ", line 2", "200");
  fails(edit + "path = [[0, 0, 0], [1, 0, 0]]\nangle = 20", ", line 2", "angle belongs");
  fails(edit + "box = [[0, 0, 0]]", ", line 4", "two corners");
  fails(edit + "box = [[0, 0, 0], [1, -1, 1]]", ", line 4", "smaller");
  fails(edit + "patches = []", ", line 4", "one or two");
  fails(edit + "patches = [\"a\", 2]", ", line 4", "string");
  fails(edit + "patches = [\"a\"]\npath = [[0, 0, 0], [1, 0, 0]]", ", line", "one thing");
  fails(edit + "colour = 1", ", line 4", "unknown key \"colour\"");
}

TEST_CASE("list_features: the edges of a box, as a table, as curves, and as a file that replays")
{
  const Feature_listing listing = list_features(shell());
  CHECK(listing.curves.size() == 12);
  CHECK(edge_count(listing) == 48);
  CHECK(std::set<Point>(listing.sharp_points.begin(), listing.sharp_points.end()) ==
        std::set<Point>{
          {-2, -2, -2}, {-2, -2, 2}, {-2, 2, -2}, {-2, 2, 2}, {2, -2, -2}, {2, -2, 2}, {2, 2, -2}, {2, 2, 2}});

  std::istringstream table(to_csv(listing));
  std::string row;
  std::getline(table, row);
  CHECK(row == "x1,y1,z1,x2,y2,z2,curve");
  std::set<int> curves;
  int rows = 0;
  for (; std::getline(table, row); ++rows)
  {
    double x[6], curve = -1;
    std::istringstream fields(row);
    std::string field;
    for (double& value : x)
      value = std::getline(fields, field, ',') ? std::strtod(field.c_str(), nullptr) : NAN;
    fields >> curve;
    curves.insert(static_cast<int>(curve));
    int along = 0;
    for (int c = 0; c < 3; ++c)
      if (x[c] == x[c + 3])
        CHECK(std::abs(x[c]) == 2); // on a side of the box
      else
        ++along;
    CHECK(along == 1);
  }
  CHECK(rows == 48);
  CHECK(curves.size() == 12);

  const Feature_file replay = parse(to_toml(listing.file));
  CHECK_FALSE(replay.starts_from_detection);
  check_equal(list_features(shell(), {.feature_edits = replay}), listing);
}

TEST_CASE("list_features: edits by node, by patch and by position; the record of them replays too")
{
  CHECK(edge_count(list("start = \"none\"")) == 0);
  const Volume_mesh mesh = shell();
  // An edge on the sphere is a side of a cell in the first layer: the first face of the patch has one.
  const Section& faces = mesh.zones[0].faces[0];
  const Index a = faces.nodes[0], b = faces.nodes[1];
  const std::string nodes =
    "[{zone = \"shell\", node = " + std::to_string(a) + "}, {zone = \"shell\", node = " + std::to_string(b) + "}]";
  const Feature_listing one = list("start = \"none\"\n[[edit]]\naction = \"add\"\nedges = [" + nodes + "]\n");
  REQUIRE(one.curves.size() == 1);
  const auto& zone_points = mesh.zones[0].points;
  CHECK(std::set<Point>(one.curves[0].points.begin(), one.curves[0].points.end()) ==
        std::set<Point>{zone_points[static_cast<std::size_t>(a)], zone_points[static_cast<std::size_t>(b)]});

  const Feature_listing edited =
    list("[[edit]]\naction = \"add\"\nedges = [" + nodes + "]\n[[edit]]\naction = \"remove\"\n" +
         "chain = [[-2, -2, 2], [-2, -0.828125, 2]]\n[[edit]]\naction = \"unmark\"\n"
         "vertices = [[2, 2, 2]]\n[[edit]]\naction = \"mark\"\nvertices = [[0, 2, 2]]\n");
  CHECK(edge_count(edited) == 48 - 4 + 1);
  CHECK(edited.report.critical_edges == 45);
  CHECK(std::count(edited.sharp_points.begin(), edited.sharp_points.end(), Point{2, 2, 2}) == 0);
  CHECK(std::count(edited.sharp_points.begin(), edited.sharp_points.end(), Point{0, 2, 2}) == 1);
  check_equal(list_features(shell(), {.feature_edits = parse(to_toml(edited.file))}), edited);

  const std::string line = "\n[[edit]]\naction = \"add\"\n";
  CHECK_THROWS_WITH(list(line + "patches = [\"sphere\", \"wing\"]"),
                    Contains("edits.toml, line 2: there is no patch \"wing\"; patches are: outer, sphere"));
  CHECK_THROWS_WITH(list(line + "path = [{zone = \"a\", node = 0}, [0, 0, 0]]"),
                    Contains("line 2: there is no zone \"a\"; zones are: shell"));
  CHECK_THROWS_WITH(list(line + "path = [{zone = \"shell\", node = 294}, [0, 0, 0]]"), Contains("from 0 to 293"));
  CHECK_THROWS_WITH(list(line + "path = [[-2, -2, -2], [-2, -2, 2.5]]"),
                    Contains("no vertex at [-2, -2, 2.5]") && Contains("[-2, -2, 2]"));
}

TEST_CASE("curve_mesh: takes the features of a file")
{
  Curving_report report;
  curve_mesh(shell(),
             {.feature_edits = parse("start = \"none\"\n[[edit]]\naction = \"add\"\n"
                                     "chain = [[-2, -2, 2], [-2, -0.828125, 2]]\n")},
             &report);
  CHECK(report.features.critical_edges == 4);
  REQUIRE(report.features.curves.size() == 1);
  CHECK(report.features.curves[0].length == Approx(4));
  CHECK_THROWS_AS(curve_mesh(shell(), {.feature_edits = Feature_file{.options = {.turning_angle = 181}}}), Input_error);
}
