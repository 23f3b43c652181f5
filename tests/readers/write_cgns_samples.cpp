// Writes CGNS files for cgns_reader_test.py into the folder given: one curved cell of each type and degree, and each
// mesh named on the command line, read and raised to the degrees 1 to 4 (large ones 2 and 3). Prints what it read, one
// JSON object per line.
//
// usage: recurve_write_cgns_samples FOLDER [MESH.cgns ...]
#include "io/single_cell_mesh.h"

#include <recurve/io/cgns.h>
#include <recurve/mesh/join_zones.h>

#include <nlohmann/json.hpp>

#include <filesystem>
#include <iostream>
#include <string>

namespace {

using namespace recurve;
using nlohmann::json;

json counts(const std::vector<Section>& sections)
{
  json result = json::object();
  for (const Section& section : sections)
  {
    const std::string name(element_name(section.type));
    result[name] = result.value(name, Index(0)) + section.size();
  }
  return result;
}

json summary(const Volume_mesh& mesh, const Read_report& report)
{
  json zones = json::array();
  for (const Zone& zone : mesh.zones)
  {
    json patches = json::object(), interfaces = json::object();
    for (const Patch& patch : zone.patches)
      patches[patch.name] = patch.faces.size();
    for (const Zone_interface& interface : zone.interfaces)
      interfaces[interface.name] = interface.points.size();
    zones.push_back({{"name", zone.name},
                     {"points", zone.points.size()},
                     {"cells", counts(zone.cells)},
                     {"faces", counts(zone.faces)},
                     {"bars", counts(zone.bars)},
                     {"patches", patches},
                     {"interfaces", interfaces}});
  }
  return {{"base", mesh.name}, {"zones", zones}, {"notes", report.notes}};
}

void write_cells(const std::filesystem::path& folder)
{
  for (const Element_type type : all_element_types)
    for (int degree = 1; degree <= 4 && reference_element(type).dimension == 3; ++degree)
      write_cgns(test::single_cell_mesh(type, degree),
                 folder / (std::string(element_name(type)) + "_" + std::to_string(degree) + ".cgns"));
}

void write_mesh(const std::filesystem::path& input, const std::filesystem::path& folder)
{
  Read_report report;
  const Volume_mesh mesh = read_cgns(input, &report);
  json line = summary(mesh, report);
  line["file"] = input.string();
  const Joined_zones joined = join_zones(mesh);
  Index cells = 0;
  for (const Zone& zone : mesh.zones)
    cells += zone.cell_count();
  const bool is_large = cells > 25000; // these only where it matters most, for the sake of time
  for (int degree = is_large ? 2 : 1; degree <= (is_large ? 3 : 4); ++degree)
  {
    const std::filesystem::path output = folder / (input.stem().string() + "_p" + std::to_string(degree) + ".cgns");
    write_cgns(elevate(mesh, joined, degree), output);
    line["outputs"][std::to_string(degree)] = output.string();
  }
  std::cout << line.dump() << std::endl;
}

} // namespace

int main(int argc, char** argv)
try
{
  if (argc < 2)
    return 1;
  const std::filesystem::path folder = argv[1];
  std::filesystem::create_directories(folder);
  write_cells(folder);
  for (int m = 2; m < argc; ++m)
    write_mesh(argv[m], folder);
}
catch (const std::exception& error)
{
  std::cerr << error.what() << '\n';
  return 2;
}
