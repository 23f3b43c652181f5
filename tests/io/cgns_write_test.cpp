#include "cgns_fixture.h"
#include "single_cell_mesh.h"

#include <recurve/core/exceptions.h>

#include <csignal>
#include <numeric>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

using namespace recurve;
using namespace recurve::test;

namespace {

/// a linear mesh as a curved one of degree 1, zones side by side without joining.
Curved_mesh straight_mesh(Volume_mesh linear)
{
  Curved_mesh mesh;
  for (const Zone& zone : linear.zones)
  {
    Curved_zone curved;
    const Index first = static_cast<Index>(mesh.nodes.size());
    mesh.nodes.insert(mesh.nodes.end(), zone.points.begin(), zone.points.end());
    curved.nodes.resize(zone.points.size());
    std::iota(curved.nodes.begin(), curved.nodes.end(), first);
    const auto copy = [&](const std::vector<Section>& from, std::vector<Curved_section>& to) {
      for (const Section& section : from)
      {
        to.push_back({section.name, section.type, section.nodes});
        for (Index& node : to.back().nodes)
          node += first;
      }
    };
    copy(zone.cells, curved.cells);
    copy(zone.faces, curved.faces);
    copy(zone.bars, curved.bars);
    mesh.zones.push_back(curved);
  }
  mesh.linear = std::move(linear);
  return mesh;
}

/// Two zones of the four cells, with everything that a file can say about them.
Volume_mesh rich_mesh()
{
  const Four_cells cells;
  Volume_mesh mesh;
  mesh.name = "a base";
  mesh.families = {{"solid wall", "BCWallViscous"}, {"fluid", ""}, {"named only", ""}};
  mesh.descriptors = {{"author", "nobody\nin particular"}};
  mesh.units = {"Kilogram", "Inch", "Second", "Kelvin", "Degree"};
  Zone zone;
  zone.name = "one";
  zone.family = "fluid";
  zone.points = cells.points;
  zone.cells = {{"tetrahedra", Element_type::tetrahedron, from_zero(cells.tetrahedron)},
                {"hexahedra", Element_type::hexahedron, from_zero(cells.hexahedron)},
                {"pyramids", Element_type::pyramid, from_zero(cells.pyramid)},
                {"prisms", Element_type::prism, from_zero(cells.prism)}};
  zone.faces = {{"triangles", Element_type::triangle, from_zero(cells.triangles)},
                {"quads", Element_type::quadrangle, from_zero(cells.quads)}};
  zone.bars = {{"edges", Element_type::line, {0, 1, 1, 2}}};
  zone.patches = {{"range", "BCSymmetryPlane", "", {3, 4, 5, 6, 7}},
                  {"list", "FamilySpecified", "solid wall", {0, 2, 9}}};
  zone.descriptors = {{"origin", "by hand"}};
  zone.interfaces = {{.name = "to another",
                      .donor_zone = "another",
                      .location = Zone_interface::Location::vertex,
                      .is_abutting_one_to_one = true,
                      .points = {0, 3, 7},
                      .donor_points = {1, 2, 6},
                      .periodicity = std::nullopt},
                     {.name = "faces to another",
                      .donor_zone = "another",
                      .location = Zone_interface::Location::face,
                      .is_abutting_one_to_one = true,
                      .points = {8, 10},
                      .donor_points = {11, 6},
                      .periodicity = std::nullopt},
                     {.name = "around",
                      .donor_zone = "one",
                      .location = Zone_interface::Location::vertex,
                      .is_abutting_one_to_one = true,
                      .points = {0},
                      .donor_points = {1},
                      .periodicity = Periodicity{{1, 2, 3}, {0, 0, 0.5}, {0, 0.25, 0}}}};
  mesh.zones = {zone, zone};
  mesh.zones[1].name = "another";
  mesh.zones[1].family = "";
  for (Point& point : mesh.zones[1].points)
    point[0] += 1.0 / 3;
  mesh.zones[1].interfaces.clear();
  return mesh;
}

bool operator==(const Section& a, const Section& b)
{
  return a.name == b.name && a.type == b.type && a.nodes == b.nodes;
}

bool operator==(const Patch& a, const Patch& b)
{
  return a.name == b.name && a.kind == b.kind && a.family == b.family && a.faces == b.faces;
}

bool operator==(const Descriptor& a, const Descriptor& b)
{
  return a.name == b.name && a.text == b.text;
}

bool operator==(const Family& a, const Family& b)
{
  return a.name == b.name && a.kind == b.kind;
}

template <class T>
bool same(const std::vector<T>& a, const std::vector<T>& b)
{
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const T& x, const T& y) { return x == y; });
}

void check_same(const Zone_interface& a, const Zone_interface& b)
{
  CHECK(a.name == b.name);
  CHECK(a.donor_zone == b.donor_zone);
  CHECK(a.location == b.location);
  CHECK(a.is_abutting_one_to_one == b.is_abutting_one_to_one);
  CHECK(a.points == b.points);
  CHECK(a.donor_points == b.donor_points);
  REQUIRE(a.periodicity.has_value() == b.periodicity.has_value());
  if (!a.periodicity)
    return;
  for (std::size_t d = 0; d < 3; ++d) // single precision in the file
  {
    CHECK(a.periodicity->rotation_center[d] == Approx(b.periodicity->rotation_center[d]).epsilon(1e-6));
    CHECK(a.periodicity->rotation_angle[d] == Approx(b.periodicity->rotation_angle[d]).epsilon(1e-6));
    CHECK(a.periodicity->translation[d] == Approx(b.periodicity->translation[d]).epsilon(1e-6));
  }
}

void check_same(const Volume_mesh& a, const Volume_mesh& b)
{
  CHECK(a.name == b.name);
  CHECK(a.units == b.units);
  CHECK(same(a.families, b.families));
  CHECK(same(a.descriptors, b.descriptors));
  REQUIRE(a.zones.size() == b.zones.size());
  for (std::size_t z = 0; z < a.zones.size(); ++z)
  {
    const Zone& x = a.zones[z];
    const Zone& y = b.zones[z];
    CAPTURE(x.name);
    CHECK(x.name == y.name);
    CHECK(x.family == y.family);
    CHECK(x.points == y.points);
    CHECK(same(x.cells, y.cells));
    CHECK(same(x.faces, y.faces));
    CHECK(same(x.bars, y.bars));
    CHECK(same(x.patches, y.patches));
    CHECK(same(x.descriptors, y.descriptors));
    REQUIRE(x.interfaces.size() == y.interfaces.size());
    for (std::size_t m = 0; m < x.interfaces.size(); ++m)
      check_same(x.interfaces[m], y.interfaces[m]);
  }
}

/// The connectivity and coordinates of a file, read by libcgns.
struct Raw_section
{
  std::string name;
  ElementType_t type = ElementTypeNull;
  cgsize_t first = 0, last = 0;
  Numbers nodes;
};

struct Raw_zone
{
  std::vector<Point> points;
  std::vector<Raw_section> sections;
};

Raw_zone read_raw(const std::filesystem::path& file)
{
  int number = 0, sections = 0;
  REQUIRE(cg_open(file.c_str(), CG_MODE_READ, &number) == CG_OK);
  std::array<char, 33> name = {};
  std::array<cgsize_t, 3> size = {};
  REQUIRE(cg_zone_read(number, 1, 1, name.data(), size.data()) == CG_OK);
  Raw_zone zone;
  zone.points.resize(static_cast<std::size_t>(size[0]));
  static constexpr std::array<const char*, 3> names = {"CoordinateX", "CoordinateY", "CoordinateZ"};
  for (std::size_t d = 0; d < 3; ++d)
  {
    std::vector<double> component(zone.points.size());
    const cgsize_t low = 1;
    REQUIRE(cg_coord_read(number, 1, 1, names[d], RealDouble, &low, size.data(), component.data()) == CG_OK);
    for (std::size_t m = 0; m < component.size(); ++m)
      zone.points[m][d] = component[m];
  }
  REQUIRE(cg_nsections(number, 1, 1, &sections) == CG_OK);
  for (int s = 1; s <= sections; ++s)
  {
    Raw_section section;
    int boundary = 0, parents = 0;
    cgsize_t entries = 0;
    REQUIRE(cg_section_read(number, 1, 1, s, name.data(), &section.type, &section.first, &section.last, &boundary,
                            &parents) == CG_OK);
    section.name = name.data();
    REQUIRE(cg_ElementDataSize(number, 1, 1, s, &entries) == CG_OK);
    section.nodes.resize(static_cast<std::size_t>(entries));
    REQUIRE(cg_elements_read(number, 1, 1, s, section.nodes.data(), nullptr) == CG_OK);
    zone.sections.push_back(section);
  }
  REQUIRE(cg_close(number) == CG_OK);
  return zone;
}

} // namespace

TEST_CASE("write_cgns and read_cgns give a linear mesh back as it was, to the bit")
{
  const Temporary_folder folder;
  const Volume_mesh mesh = rich_mesh();
  write_cgns(straight_mesh(mesh), folder / "mesh.cgns");
  Read_report report;
  check_same(mesh, read_cgns(folder / "mesh.cgns", &report));
  CHECK(report.notes.empty());
}

TEST_CASE("write_cgns writes every complete element family, to the bit")
{
  const Temporary_folder folder;
  const auto type =
    GENERATE(Element_type::tetrahedron, Element_type::pyramid, Element_type::prism, Element_type::hexahedron);
  const int degree = GENERATE(1, 2, 3, 4);
  const Curved_mesh mesh = single_cell_mesh(type, degree);
  CAPTURE(element_name(type), degree);
  write_cgns(mesh, folder / "mesh.cgns");
  const Raw_zone raw = read_raw(folder / "mesh.cgns");
  CHECK(raw.points == mesh.nodes); // in the order of Curved_zone::nodes
  const Curved_zone& zone = mesh.zones[0];
  REQUIRE(raw.sections.size() == 1 + zone.faces.size());
  for (std::size_t s = 0; s < raw.sections.size(); ++s)
  {
    const Curved_section& section = s == 0 ? zone.cells[0] : zone.faces[s - 1];
    const Raw_section& found = raw.sections[s];
    int width = 0;
    REQUIRE(cg_npe(found.type, &width) == CG_OK);
    CHECK(width == node_count(section.type, degree)); // a complete family
    CHECK(found.name == section.name);
    CHECK(found.first == cgsize_t(s + 1));
    REQUIRE(found.nodes.size() == section.nodes.size());
    const auto order = foreign_of_canonical(Node_order::cgns, section.type, degree);
    for (std::size_t m = 0; m < section.nodes.size(); ++m)
      CHECK(found.nodes[std::size_t(order[m])] == section.nodes[m] + 1);
  }
}

TEST_CASE("write_cgns writes bars of every degree")
{
  const Temporary_folder folder;
  const int degree = GENERATE(1, 2, 3, 4);
  Curved_mesh mesh = single_cell_mesh(Element_type::tetrahedron, degree);
  Curved_section bars{"bars", Element_type::line, {}};
  for (const int node : edge_nodes(Element_type::tetrahedron, degree, 3))
    bars.nodes.push_back(node);
  mesh.linear.zones[0].bars = {{"bars", Element_type::line, {bars.nodes[0], bars.nodes[1]}}};
  mesh.zones[0].bars = {bars};
  write_cgns(mesh, folder / "mesh.cgns");
  const Raw_section found = read_raw(folder / "mesh.cgns").sections.back();
  CHECK(found.type == std::array{BAR_2, BAR_3, BAR_4, BAR_5}[std::size_t(degree - 1)]);
  REQUIRE(found.nodes.size() == bars.nodes.size());
  // The SIDS: both ends, then the inner nodes from the first end to the second.
  for (std::size_t m = 0; m < bars.nodes.size(); ++m)
    CHECK(found.nodes[m] == bars.nodes[m] + 1);
}

TEST_CASE("write_cgns makes names that CGNS takes, and keeps what they connect")
{
  const Temporary_folder folder;
  Volume_mesh mesh = rich_mesh();
  const std::string name = "a name of more than thirty-two characters, number ";
  mesh.zones[0].name = name + "1";
  mesh.zones[1].name = name + "2";
  mesh.zones[0].interfaces[0].donor_zone = mesh.zones[1].name;
  mesh.zones[0].interfaces[1].donor_zone = mesh.zones[1].name;
  mesh.zones[0].interfaces[2].donor_zone = mesh.zones[0].name;
  mesh.families[0].name = mesh.zones[0].patches[1].family = mesh.zones[1].patches[1].family = "in/out";
  mesh.families[2].name = mesh.zones[0].name;
  mesh.zones[0].cells[0].name = mesh.zones[0].cells[1].name = "ZoneBC";
  mesh.zones[0].faces[0].name = "";
  mesh.zones[0].patches[0].name = mesh.zones[0].patches[1].name = "äöüßäöüßäöüßäöüßäöüß";
  write_cgns(straight_mesh(mesh), folder / "mesh.cgns");
  const Volume_mesh found = read_cgns(folder / "mesh.cgns");
  CHECK(found.zones[0].name == "a name of more than thirty-two c");
  CHECK(found.zones[1].name == "a name of more than thirty-two_2");
  CHECK(found.zones[0].interfaces[0].donor_zone == found.zones[1].name);
  CHECK(found.zones[0].interfaces[2].donor_zone == found.zones[0].name);
  CHECK(found.families[0].name == "in_out");
  CHECK(found.zones[0].patches[1].family == "in_out");
  CHECK(found.families[2].name == "a name of more than thirty-two_3");
  CHECK(found.zones[0].cells[0].name == "ZoneBC_2");
  CHECK(found.zones[0].cells[1].name == "ZoneBC_3");
  CHECK(found.zones[0].faces[0].name == "unnamed");
  CHECK(found.zones[0].patches[0].name == "äöüßäöüßäöüßäöüß");
  CHECK(found.zones[0].patches[1].name == "äöüßäöüßäöüßäöü_2");
}

TEST_CASE("write_cgns refuses degrees that CGNS has no elements for, and says what to do")
{
  const Temporary_folder folder;
  Curved_mesh mesh = straight_mesh(rich_mesh());
  mesh.degree = GENERATE(0, 5, 6);
  try
  {
    write_cgns(mesh, folder / "mesh.cgns");
    FAIL("no exception");
  }
  catch (const Input_error& error)
  {
    const std::string message = error.what();
    CHECK(message.find("degree") != std::string::npos);
    CHECK(message.find("VTU") != std::string::npos);
  }
  CHECK(!std::filesystem::exists(folder / "mesh.cgns"));
}

TEST_CASE("write_cgns leaves no file behind when it fails or is cancelled")
{
  const Temporary_folder folder;
  const Curved_mesh mesh = straight_mesh(rich_mesh());
  CHECK_THROWS_AS(write_cgns(mesh, folder / "absent/mesh.cgns"), Format_error);
  std::filesystem::create_directory(folder / "folder.cgns");
  CHECK_THROWS_AS(write_cgns(mesh, folder / "folder.cgns"), Format_error);
  int calls = 0;
  CHECK_THROWS_AS(write_cgns(mesh, folder / "mesh.cgns", [&](std::string_view, double) { return ++calls < 5; }),
                  Cancelled);
  CHECK(!std::filesystem::exists(folder / "mesh.cgns"));
  write_cgns(mesh, folder / "mesh.cgns"); // libcgns is in order again
  CHECK(std::filesystem::exists(folder / "mesh.cgns"));
}

TEST_CASE("write_cgns reports a disk that is full, or fills while it writes")
{
  // A limit on the size of files stands in for the disk. In a process of its own, since HDF5 may not recover.
  const Temporary_folder folder;
  const Curved_mesh mesh = straight_mesh(rich_mesh());
  write_cgns(mesh, folder / "whole.cgns");
  const auto size = std::filesystem::file_size(folder / "whole.cgns");
  const bool is_full_before = GENERATE(true, false);
  constexpr int parts = 24;
  for (int part = 0; part < parts; ++part)
  {
    CAPTURE(is_full_before, part);
    const pid_t child = fork();
    REQUIRE(child >= 0);
    if (child == 0)
    {
      std::signal(SIGXFSZ, SIG_IGN);
      rlimit limit = {};
      limit.rlim_cur = limit.rlim_max = size * static_cast<rlim_t>(part) / parts;
      const auto fill = [&](std::string_view, double fraction) {
        return (fraction == 0 && !is_full_before) || setrlimit(RLIMIT_FSIZE, &limit) == 0;
      };
      bool is_good = false;
      try
      {
        write_cgns(mesh, folder / "mesh.cgns", fill);
      }
      catch (const Format_error& error)
      {
        is_good = std::string(error.what()).find("mesh.cgns: ") != std::string::npos;
      }
      is_good = is_good && !std::filesystem::exists(folder / "mesh.cgns");
      _exit(is_good ? 0 : 1);
    }
    int status = -1;
    REQUIRE(waitpid(child, &status, 0) == child);
    CHECK(status == 0);
  }
}
