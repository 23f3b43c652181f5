#include "cgns_fixture.h"
#include "support/ordinary_user.h"

#include <limits>

using namespace recurve;
using namespace recurve::test;

namespace {

/// One thing that is wrong with a file, and what the message has to say about it.
struct Fault
{
  const char* name;
  std::function<void(const Node_editor&)> make;
  std::vector<std::string> message;
};

constexpr double nan_value = std::numeric_limits<double>::quiet_NaN();
constexpr double infinity = std::numeric_limits<double>::infinity();

void set_type(const Node_editor& editor, const char* section, std::int32_t type)
{
  editor.set<std::int32_t>(std::string("/Base/Zone/") + section, "I4", {type, 0});
}

void set_range(const Node_editor& editor, const char* section, std::int32_t first, std::int32_t last)
{
  editor.set<std::int32_t>(std::string("/Base/Zone/") + section + "/ElementRange", "I4", {first, last});
}

template <class T>
void set_nodes(const Node_editor& editor, const char* section, const std::vector<T>& nodes)
{
  editor.set<T>(std::string("/Base/Zone/") + section + "/ElementConnectivity", sizeof(T) == 4 ? "I4" : "I8", nodes);
}

void set_y(const Node_editor& editor, double value)
{
  editor.set<double>("/Base/Zone/GridCoordinates/CoordinateY", "R8", {0, 0, value, 1, 0, 0, 1, 1, 0.5, 0.5, 0.5});
}

std::vector<Fault> faults()
{
  using I4 = std::int32_t;
  using I8 = std::int64_t;
  const auto edit = [](auto f) { return std::function<void(const Node_editor&)>(f); };
  return {
    {"node number 0",
     edit([](auto& e) {
       set_nodes<I4>(e, "prisms", {2, 0, 3, 6, 10, 7});
     }),
     {"zone 'Zone', section 'prisms', element 2: node 2 is number 0, outside 1..11"}},
    {"node number beyond the end",
     edit([](auto& e) {
       set_nodes<I4>(e, "quads", {1, 4, 3, 2, 1, 2, 6, 5, 3, 4, 8, 12, 1, 5, 8, 4, 2, 9, 10, 6, 9, 3, 7, 10});
     }),
     {"section 'quads', element 7: node 4 is number 12"}},
    {"negative node number",
     edit([](auto& e) {
       set_nodes<I4>(e, "prisms", {2, 9, 3, 6, 10, -7});
     }),
     {"'prisms'", "node 6 is number -7"}},
    {"node number beyond 32 bits",
     edit([](auto& e) {
       set_nodes<I8>(e, "prisms", {2, 9, 3, 6, 10, (I8(1) << 32) + 7});
     }),
     {"'prisms'", "4294967303"}},
    {"NaN", edit([](auto& e) { set_y(e, nan_value); }), {"zone 'Zone', node 3: CoordinateY is nan"}},
    {"infinity", edit([](auto& e) { set_y(e, -infinity); }), {"node 3: CoordinateY is -inf"}},
    {"too few coordinates",
     edit([](auto& e) { e.set("/Base/Zone/GridCoordinates/CoordinateZ", "R8", std::vector<double>(10)); }),
     {"zone 'Zone'", "11 points", "CoordinateZ has 10"}},
    {"no CoordinateZ",
     edit([](auto& e) { e.rename("/Base/Zone/GridCoordinates", "CoordinateZ", "CoordinateTheta"); }),
     {"zone 'Zone' has no CoordinateZ", "CoordinateTheta"}},
    {"coordinates of integers",
     edit([](auto& e) { e.set("/Base/Zone/GridCoordinates/CoordinateX", "I4", std::vector<I4>(11)); }),
     {"CoordinateX", "I4"}},
    {"connectivity of reals",
     edit([](auto& e) { e.set("/Base/Zone/prisms/ElementConnectivity", "R8", std::vector<double>(6)); }),
     {"ElementConnectivity", "R8"}},
    {"no coordinates",
     edit([](auto& e) { e.remove("/Base/Zone", "GridCoordinates"); }),
     {"zone 'Zone'", "Coordinates"}},
    {"negative count of points",
     edit([](auto& e) {
       e.template set<I4>("/Base/Zone", "I4", {-11, 4, 0}, {1, 3});
     }),
     {"zone 'Zone' states -11 points"}},
    {"no points",
     edit([](auto& e) {
       e.template set<I4>("/Base/Zone", "I4", {0, 4, 0}, {1, 3});
     }),
     {"zone 'Zone' states 0 points"}},
    {"negative count of cells",
     edit([](auto& e) {
       e.template set<I4>("/Base/Zone", "I4", {11, -4, 0}, {1, 3});
     }),
     {"zone 'Zone' states -4 cells"}},
    {"more points than the file can hold",
     edit([](auto& e) {
       e.template set<I4>("/Base/Zone", "I4", {2000000000, 4, 0}, {1, 3});
       for (const char* name : {"X", "Y", "Z"})
         e.set_unwritten(std::string("/Base/Zone/GridCoordinates/Coordinate") + name, "R8", {2000000000});
     }),
     {"2000000000 points of zone 'Zone'"}},
    {"more elements than the file can hold",
     edit([](auto& e) {
       set_range(e, "tetrahedra", 4, 500000003);
       e.set_unwritten("/Base/Zone/tetrahedra/ElementConnectivity", "I4", {2000000000});
     }),
     {"ElementConnectivity", "bytes"}},
    {"more elements than connectivity",
     edit([](auto& e) { set_range(e, "tetrahedra", 4, 2000000000); }),
     {"section 'tetrahedra'", "1999999997 elements"}},
    {"range that ends before it begins",
     edit([](auto& e) { set_range(e, "prisms", 2, 0); }),
     {"section 'prisms'", "2..0"}},
    {"range that begins with 0", edit([](auto& e) { set_range(e, "prisms", 0, 0); }), {"section 'prisms'", "0..0"}},
    {"connectivity too short",
     edit([](auto& e) {
       set_nodes<I4>(e, "prisms", {2, 9, 3, 6, 10});
     }),
     {"section 'prisms'", "6 node numbers, but the file has 5"}},
    {"no connectivity",
     edit([](auto& e) { e.remove("/Base/Zone/prisms", "ElementConnectivity"); }),
     {"section 'prisms'", "no ElementConnectivity"}},
    {"no range",
     edit([](auto& e) { e.remove("/Base/Zone/prisms", "ElementRange"); }),
     {"section 'prisms'", "no ElementRange"}},
    {"polyhedra", edit([](auto& e) { set_type(e, "prisms", NGON_n); }), {"section 'prisms'", "NGON_n", "polyhedra"}},
    {"polyhedra by faces", edit([](auto& e) { set_type(e, "prisms", NFACE_n); }), {"NFACE_n", "polyhedra"}},
    {"high order",
     edit([](auto& e) { set_type(e, "tetrahedra", TETRA_10); }),
     {"section 'tetrahedra'", "TETRA_10", "high order"}},
    {"high-order boundary",
     edit([](auto& e) { set_type(e, "triangles", TRI_6); }),
     {"'triangles'", "TRI_6", "high order"}},
    {"unknown element type", edit([](auto& e) { set_type(e, "prisms", 99); }), {"section 'prisms'", "99"}},
    {"negative element type", edit([](auto& e) { set_type(e, "prisms", -1); }), {"section 'prisms'", "-1"}},
    {"mixed section with an unknown type",
     edit([](auto& e) {
       set_type(e, "prisms", MIXED);
       set_nodes<I4>(e, "prisms", {77, 2, 9, 3, 6, 10, 7});
     }),
     {"section 'prisms', element 2", "77"}},
    {"mixed section in a mixed section",
     edit([](auto& e) {
       set_type(e, "prisms", MIXED);
       set_nodes<I4>(e, "prisms", {MIXED, 2, 9, 3, 6, 10, 7});
     }),
     {"section 'prisms', element 2", "MIXED"}},
    {"mixed section with polygons",
     edit([](auto& e) {
       set_type(e, "prisms", MIXED);
       set_nodes<I4>(e, "prisms", {NGON_n, 2, 9, 3, 6, 10, 7});
     }),
     {"section 'prisms', element 2", "NGON_n"}},
    {"mixed section cut short",
     edit([](auto& e) {
       set_type(e, "prisms", MIXED);
       set_nodes<I4>(e, "prisms", {PENTA_6, 2, 9, 3, 6, 10});
     }),
     {"section 'prisms'", "ends in element 2"}},
    {"mixed section too long",
     edit([](auto& e) {
       set_type(e, "prisms", MIXED);
       set_nodes<I4>(e, "prisms", {PENTA_6, 2, 9, 3, 6, 10, 7, PENTA_6});
     }),
     {"section 'prisms'", "goes on after its 1 elements"}},
    {"mixed section with a bad node",
     edit([](auto& e) {
       set_type(e, "prisms", MIXED);
       set_nodes<I4>(e, "prisms", {PENTA_6, 2, 9, 3, 6, 10, 12});
     }),
     {"section 'prisms', element 2: node 6 is number 12"}},
    {"element numbers that overlap",
     edit([](auto& e) { set_range(e, "triangles", 10, 15); }),
     {"'by element'", "overlap"}},
    {"condition on a missing element",
     edit([](auto& e) {
       e.template set<I4>("/Base/Zone/ZoneBC/by element/PointList", "I4", {10, 17}, {1, 2});
     }),
     {"zone 'Zone', boundary condition 'by element'", "element 17"}},
    {"condition on an endless range",
     edit([](auto& e) {
       e.rename("/Base/Zone/ZoneBC/by element", "PointList", "PointRange");
       e.template set<I4>("/Base/Zone/ZoneBC/by element/PointRange", "I4", {5, 2000000000}, {1, 2});
     }),
     {"'by element'", "element 17"}},
    {"condition on half a range",
     edit([](auto& e) {
       e.rename("/Base/Zone/ZoneBC/by element", "PointList", "PointRange");
       e.template set<I4>("/Base/Zone/ZoneBC/by element/PointRange", "I4", {5}, {1, 1});
     }),
     {"'by element'", "range of 1 numbers"}},
    {"condition on a missing point",
     edit([](auto& e) {
       e.template set<I4>("/Base/Zone/ZoneBC/by point/PointList", "I4", {1, 2, 3, 17}, {1, 4});
     }),
     {"zone 'Zone', boundary condition 'by point'", "point 17, outside 1..11"}},
    {"connection of a missing point",
     edit([](auto& e) {
       e.template set<I4>("/Base/Zone/ZoneGridConnectivity/joint/PointList", "I4", {0, 2}, {1, 2});
     }),
     {"zone 'Zone', connection 'joint'", "point 0"}},
    {"connection to a missing point",
     edit([](auto& e) {
       e.template set<I4>("/Base/Zone/ZoneGridConnectivity/joint/PointListDonor", "I4", {3, 12}, {1, 2});
     }),
     {"zone 'Zone', connection 'joint'", "point 12"}},
    {"unknown zone type",
     edit([](auto& e) { e.set_text("/Base/Zone/ZoneType", "Cartesian"); }),
     {"zone 'Zone'", "Cartesian"}},
    {"zone of the wrong size",
     edit([](auto& e) { e.set_text("/Base/Zone/ZoneType", "Structured"); }),
     {"zone 'Zone'", "structured"}},
    {"2D mesh",
     edit([](auto& e) {
       e.template set<I4>("/Base", "I4", {2, 3});
     }),
     {"base 'Base'", "dimension 2", "3D"}},
    {"no zone", edit([](auto& e) { e.remove("/Base", "Zone"); }), {"base 'Base'", "empty"}},
    {"no base", edit([](auto& e) { e.remove("", "Base"); }), {"no CGNSBase_t"}},
    {"no elements",
     edit([](auto& e) {
       for (const char* section : {"hexahedra", "prisms", "pyramids", "tetrahedra", "quads", "triangles", "ZoneBC"})
         e.remove("/Base/Zone", section);
     }),
     {"base 'Base'", "empty"}},
  };
}

void write_sound_file(const std::filesystem::path& file, int type = CG_FILE_HDF5)
{
  Raw_cgns raw(file, type);
  raw.base();
  write_four_cells(raw);
  raw.condition("by element", BCWall, PointList, {10}, FaceCenter);
  raw.condition("by point", BCWall, PointList, {1, 2, 3, 4}, Vertex);
  raw.connection("joint", Vertex, {1, 2}, "Zone", {3, 4});
}

std::string contents(const std::filesystem::path& file)
{
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

void write_contents(const std::filesystem::path& file, const std::string& text)
{
  std::ofstream(file, std::ios::binary) << text;
}

} // namespace

TEST_CASE("read_cgns names the place of every fault of a file")
{
  const Temporary_folder folder;
  const std::filesystem::path file = folder / "mesh.cgns";
  const int type = GENERATE(CG_FILE_HDF5, CG_FILE_ADF);
  for (const Fault& fault : faults())
  {
    CAPTURE(type, fault.name);
    write_sound_file(file, type);
    REQUIRE(read_failure(file).empty());
    {
      const Node_editor editor(file);
      fault.make(editor);
    }
    const std::string message = read_failure(file);
    CAPTURE(message);
    CHECK(message.starts_with(file.string() + ": "));
    for (const std::string& text : fault.message)
      CHECK(message.find(text) != std::string::npos);
    CHECK(message.find('\n') == std::string::npos);
  }
}

TEST_CASE("read_cgns refuses what is no CGNS file in one line")
{
  const Temporary_folder folder;
  CHECK(read_failure(folder / "absent.cgns").find("No such file") != std::string::npos);
  std::filesystem::create_directory(folder / "folder.cgns");
  CHECK(read_failure(folder / "folder.cgns").find("directory") != std::string::npos);
  write_contents(folder / "empty.cgns", "");
  CHECK(read_failure(folder / "empty.cgns").find("no CGNS file") != std::string::npos);
  write_contents(folder / "text.cgns", std::string(5000, 'x'));
  CHECK(read_failure(folder / "text.cgns").find("no CGNS file") != std::string::npos);
  write_sound_file(folder / "locked.cgns");
  std::filesystem::permissions(folder / "locked.cgns", std::filesystem::perms::none);
  const Ordinary_user user;
  CHECK(read_failure(folder / "locked.cgns").find("denied") != std::string::npos);
}

TEST_CASE("read_cgns survives a damaged byte, wherever")
{
  const Temporary_folder folder;
  const int type = GENERATE(CG_FILE_HDF5, CG_FILE_ADF);
  CAPTURE(type);
  write_sound_file(folder / "whole.cgns", type);
  const std::string whole = contents(folder / "whole.cgns");
  constexpr std::size_t step = 23;
  for (std::size_t at = 0; at < whole.size(); at += step)
  {
    CAPTURE(at, whole.size());
    std::string damaged = whole;
    damaged[at] = static_cast<char>(~damaged[at]);
    // A new name each time: HDF5 may fail to close a damaged file, and would then take the next for it.
    const std::filesystem::path file = folder / (std::to_string(at) + ".cgns");
    write_contents(file, damaged);
    CHECK(read_failure(file).find('\n') == std::string::npos);
    std::filesystem::remove(file);
  }
}

TEST_CASE("read_cgns refuses files that are cut short, wherever")
{
  const Temporary_folder folder;
  const int type = GENERATE(CG_FILE_HDF5, CG_FILE_ADF);
  CAPTURE(type);
  write_sound_file(folder / "whole.cgns", type);
  const std::string whole = contents(folder / "whole.cgns");
  constexpr std::size_t cuts = 40;
  for (std::size_t cut = 1; cut < cuts; ++cut)
  {
    const std::size_t length = whole.size() * cut / cuts;
    CAPTURE(length, whole.size());
    write_contents(folder / "cut.cgns", whole.substr(0, length));
    const std::string message = read_failure(folder / "cut.cgns");
    if (message.empty()) // ADF fills its last block up; without that filling the mesh is whole
      CHECK(type == CG_FILE_ADF);
    if (message.empty())
      CHECK(whole.substr(length).find_first_not_of(whole.back()) == std::string::npos);
    CHECK(message.find('\n') == std::string::npos);
  }
}
