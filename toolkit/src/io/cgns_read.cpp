#include "cgns_reading.h"
#include "cgns_writing.h"

#include <recurve/io/cgns.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <new>

namespace recurve {

namespace internal::cgns {

std::string text_of(const Cgns_tree& tree, const Cgns_node& node, std::string_view label)
{
  const auto child = tree.child_with_label(node, label);
  return child ? tree.read_text(*child) : std::string();
}

std::vector<Descriptor> read_descriptors(const Cgns_tree& tree, const Cgns_node& node)
{
  std::vector<Descriptor> result;
  for (const Cgns_node& child : tree.children(node, "Descriptor_t"))
    result.push_back({.name = child.name(), .text = tree.read_text(child)});
  return result;
}

namespace {

/// 3400 for a file of version 3.4. A file that does not say is from before versions were written.
int read_version(const Cgns_tree& tree)
{
  const auto node = tree.child_with_label(tree.root(), "CGNSLibraryVersion_t");
  if (!node)
    return 1050;
  const std::vector<double> value = tree.read_reals(*node);
  return value.empty() || !(value[0] > 0 && value[0] < 1000) ? 1050 : static_cast<int>(std::lround(1000 * value[0]));
}

/// the first base with cells of dimension 3; notes the others.
Cgns_node choose_base(Cgns_reading& reading)
{
  const Cgns_tree& tree = reading.tree;
  const std::vector<Cgns_node> bases = tree.children(tree.root(), "CGNSBase_t");
  if (bases.empty())
    tree.fail("has no CGNSBase_t: no mesh");
  std::optional<Cgns_node> chosen;
  std::string seen;
  for (const Cgns_node& base : bases)
  {
    const std::vector<std::int64_t> dimensions = tree.read_integers(base);
    if (dimensions.size() < 2)
      tree.fail(fmt::format("base '{}' does not state its dimensions", base.name()));
    const bool is_3d = dimensions[0] == 3 && dimensions[1] == 3;
    if (is_3d && !chosen)
      chosen = base;
    else if (is_3d)
      reading.notes.push_back(fmt::format("base '{}' is left out: only the first 3D base is read", base.name()));
    else
      seen += fmt::format("{}base '{}' has cells of dimension {} in {}-dimensional space", seen.empty() ? "" : ", ",
                          base.name(), dimensions[0], dimensions[1]);
  }
  if (!chosen)
    tree.fail(fmt::format("{}: only 3D meshes can be read", seen));
  if (!seen.empty())
    reading.notes.push_back(fmt::format("left out: {}", seen));
  if (bases.size() > 1)
    reading.notes.push_back(fmt::format("{} bases, read base '{}'", bases.size(), chosen->name()));
  return *chosen;
}

/// five names of 32 characters: mass, length, time, temperature, angle.
std::optional<std::array<std::string, 5>> read_units(const Cgns_tree& tree, const Cgns_node& node)
{
  const auto child = tree.child_with_label(node, "DimensionalUnits_t");
  if (!child)
    return std::nullopt;
  std::string text = tree.read_text(*child);
  std::array<std::string, 5> units;
  text.resize(units.size() * longest_cgns_name, ' ');
  for (std::size_t m = 0; m < units.size(); ++m)
  {
    units[m] = text.substr(m * longest_cgns_name, longest_cgns_name);
    units[m].erase(units[m].find_last_not_of(' ') + 1);
    if (units[m] == "Null" || units[m] == "UserDefined")
      units[m].clear();
  }
  return units;
}

void read_families(const Cgns_tree& tree, const Cgns_node& base, Volume_mesh& mesh)
{
  for (const Cgns_node& node : tree.children(base, "Family_t"))
  {
    const auto condition = tree.child_with_label(node, "FamilyBC_t");
    mesh.families.push_back({.name = node.name(), .kind = condition ? tree.read_text(*condition) : std::string()});
  }
}

/// adds the families that zones and patches name and the file does not define, so that a name always means something.
void add_missing_families(Volume_mesh& mesh, std::vector<std::string>& notes)
{
  std::string added;
  const auto add = [&](const std::string& name) {
    const bool is_known = name.empty() || std::any_of(mesh.families.begin(), mesh.families.end(),
                                                      [&](const Family& family) { return family.name == name; });
    if (is_known)
      return;
    mesh.families.push_back({.name = name, .kind = {}});
    added += (added.empty() ? "" : ", ") + name;
  };
  for (const Zone& zone : mesh.zones)
  {
    add(zone.family);
    for (const Patch& patch : zone.patches)
      add(patch.family);
  }
  if (!added.empty())
    notes.push_back(fmt::format("families that are named but not defined in the file, added: {}", added));
}

void check_not_empty(const Cgns_tree& tree, const Volume_mesh& mesh, std::vector<std::string>& notes)
{
  Index cells = 0, faces = 0;
  for (const Zone& zone : mesh.zones)
  {
    cells += zone.cell_count();
    faces += zone.face_count();
  }
  if (cells == 0 && faces == 0)
    tree.fail(fmt::format("base '{}' has neither cells nor faces: the mesh is empty", mesh.name));
  if (cells == 0)
    notes.push_back(fmt::format("base '{}' has faces but no cells: a surface, not a volume mesh", mesh.name));
}

Zonal_mesh read_base(Cgns_reading& reading, const Progress_callback& progress)
{
  const Cgns_tree& tree = reading.tree;
  reading.version = read_version(tree);
  const Cgns_node base = choose_base(reading);
  Volume_mesh mesh;
  mesh.name = base.name();
  mesh.descriptors = read_descriptors(tree, base);
  mesh.units = read_units(tree, base).value_or(mesh.units);
  reading.angles_in_degrees = mesh.units[4] == "Degree";
  read_families(tree, base, mesh);

  const std::vector<Cgns_node> zones = tree.children(base, "Zone_t");
  if (zones.empty())
    tree.fail(fmt::format("base '{}' has no zones: the mesh is empty", base.name()));
  for (std::size_t z = 0; z < zones.size(); ++z)
  {
    report_progress(progress, "read", static_cast<double>(z) / static_cast<double>(zones.size()));
    reading.zones.push_back(read_zone(reading, zones[z]));
    read_patches(reading, reading.zones.back());
  }
  read_interfaces(reading, mesh.name);
  Zonal_mesh result = {.degree = std::max(1, reading.degree), .linear = {}, .zones = {}};
  for (Zone_reading& zone : reading.zones)
  {
    mesh.zones.push_back(std::move(zone.zone));
    if (result.degree > 1)
      result.zones.push_back(std::move(zone.elements));
  }
  add_missing_families(mesh, reading.notes);
  check_not_empty(tree, mesh, reading.notes);
  report_progress(progress, "read", 1);
  result.linear = std::move(mesh);
  return result;
}

Zonal_mesh read_file(const std::filesystem::path& file, int largest_degree, Read_report* report,
                     const Progress_callback& progress)
try
{
  const Cgns_tree tree(file);
  Cgns_reading reading = {.tree = tree, .largest_degree = largest_degree, .zones = {}, .notes = {}};
  Zonal_mesh mesh = read_base(reading, progress);
  if (report != nullptr)
    report->notes.insert(report->notes.end(), reading.notes.begin(), reading.notes.end());
  return mesh;
}
catch (const std::bad_alloc&)
{
  throw Format_error(fmt::format("{}: takes more memory than there is", file.string()));
}

} // namespace

} // namespace internal::cgns

Volume_mesh read_cgns(const std::filesystem::path& file, Read_report* report, const Progress_callback& progress)
{
  return internal::cgns::read_file(file, 1, report, progress).linear;
}

Zonal_mesh read_curved_cgns(const std::filesystem::path& file, Read_report* report, const Progress_callback& progress)
{
  return internal::cgns::read_file(file, internal::cgns::largest_cgns_degree, report, progress);
}

} // namespace recurve
