#include "cgns_element_codes.h"
#include "cgns_names.h"
#include "cgns_tree.h"
#include "cgns_writing.h"
#include "disk_space.h"

#include <recurve/core/exceptions.h>
#include <recurve/elements/node_layout.h>
#include <recurve/io/cgns.h>

#include <cgnslib.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <memory>
#include <numbers>
#include <numeric>
#include <string_view>
#include <utility>

namespace recurve {

namespace internal::cgns {

namespace {

/// the boundary condition that `kind` names; user defined where libcgns knows no such.
BCType_t condition_type(const std::string& kind)
{
  for (int m = 0; m < NofValidBCTypes; ++m)
    if (kind == cg_BCTypeName(static_cast<BCType_t>(m)))
      return static_cast<BCType_t>(m);
  return BCTypeUserDefined;
}

/// the unit `name`, among `count` that libcgns knows.
template <class Unit>
Unit unit_of(const std::string& name, int count, const char* (*name_of)(Unit))
{
  for (int m = 0; m < count; ++m)
    if (name == name_of(static_cast<Unit>(m)))
      return static_cast<Unit>(m);
  return static_cast<Unit>(name.empty() ? CG_Null : CG_UserDefined);
}

/// A file that libcgns writes.
class Cgns_output
{
public:
  explicit Cgns_output(const std::filesystem::path& file) : file_(file)
  {
    cg_error_handler([](int, char*) {}); // libcgns prints warnings otherwise
    cg_set_file_type(CG_FILE_HDF5);
    if (cg_open(file.c_str(), CG_MODE_WRITE, &number_) != CG_OK)
      throw Format_error(fmt::format("{}: cannot be written: {}", file.string(), cg_get_error()));
  }
  ~Cgns_output()
  {
    if (number_ != 0)
      cg_close(number_);
    cg_error_handler(nullptr);
  }
  Cgns_output(const Cgns_output&) = delete;
  Cgns_output& operator=(const Cgns_output&) = delete;

  int number() const { return number_; }

  void check(int status, std::string_view what) const
  {
    if (status != CG_OK)
      throw Format_error(fmt::format("{}: {} cannot be written: {}", file_.string(), what, cg_get_error()));
  }

  void finish()
  {
    const int number = std::exchange(number_, 0);
    check(cg_close(number), "the end of the file");
  }

private:
  std::filesystem::path file_;
  int number_ = 0;
};

/// Numbers that libcgns gave to nodes.
struct Writing
{
  const Curved_mesh& mesh;
  Cgns_output& output;
  const Progress_callback& progress;
  const Cgns_write_limits& limits;
  int file = 0;
  int base = 0;
  std::map<std::string, std::string> zone_names, family_names; ///< names in the mesh to names in the file
  std::vector<cgsize_t> local_number; ///< per node of the mesh, its number in the running zone (from 1)
  Index entries_done = 0, entries_total = 0, percent = 0;

  void report(Index entries)
  {
    entries_done += entries;
    if (const Index now = 100 * entries_done / std::max<Index>(entries_total, 1); now != percent)
    {
      percent = now;
      report_progress(progress, "write", static_cast<double>(now) / 100);
    }
  }
};

/// where the elements of a zone's faces begin in the file.
struct Zone_numbers
{
  int zone = 0;
  Index first_face = 1; ///< element number of face 0
  std::string where;
};

std::string file_name(const std::map<std::string, std::string>& names, const std::string& name)
{
  const auto found = names.find(name);
  return found == names.end() ? cut_name(name, longest_cgns_name) : found->second;
}

void write_units(const Writing& w)
{
  const std::array<std::string, 5>& units = w.mesh.linear.units;
  if (std::all_of(units.begin(), units.end(), [](const std::string& unit) { return unit.empty(); }))
    return;
  w.output.check(cg_goto(w.file, w.base, "end"), "units");
  w.output.check(cg_dataclass_write(Dimensional), "units");
  w.output.check(cg_units_write(unit_of(units[0], NofValidMassUnits, cg_MassUnitsName),
                                unit_of(units[1], NofValidLengthUnits, cg_LengthUnitsName),
                                unit_of(units[2], NofValidTimeUnits, cg_TimeUnitsName),
                                unit_of(units[3], NofValidTemperatureUnits, cg_TemperatureUnitsName),
                                unit_of(units[4], NofValidAngleUnits, cg_AngleUnitsName)),
                 "units");
}

void write_base(Writing& w)
{
  const Volume_mesh& linear = w.mesh.linear;
  Cgns_names roots = {"CGNSLibraryVersion"};
  w.output.check(cg_base_write(w.file, roots.take(linear.name).c_str(), 3, 3, &w.base), "base");
  write_units(w);
  Cgns_names names = {"DataClass", "DimensionalUnits"};
  for (const Zone& zone : linear.zones)
    w.zone_names.emplace(zone.name, names.take(zone.name));
  for (const Family& family : linear.families)
  {
    const std::string name = names.take(family.name);
    if (!w.family_names.emplace(family.name, name).second)
      continue;
    int number = 0, condition = 0;
    w.output.check(cg_family_write(w.file, w.base, name.c_str(), &number), fmt::format("family '{}'", name));
    if (!family.kind.empty())
      w.output.check(cg_fambc_write(w.file, w.base, number, "FamBC", condition_type(family.kind), &condition),
                     fmt::format("family '{}'", name));
  }
  w.output.check(cg_goto(w.file, w.base, "end"), "base");
  for (const Descriptor& descriptor : linear.descriptors)
    w.output.check(cg_descriptor_write(names.take(descriptor.name).c_str(), descriptor.text.c_str()),
                   fmt::format("descriptor '{}'", descriptor.name));
}

void write_coordinates(Writing& w, const Curved_zone& zone, const Zone_numbers& z)
{
  static constexpr std::array<const char*, 3> names = {"CoordinateX", "CoordinateY", "CoordinateZ"};
  const auto count = static_cast<Index>(zone.nodes.size());
  std::vector<double> piece;
  for (std::size_t d = 0; d < 3; ++d)
    for (Index begin = 0; begin < count; begin += w.limits.piece)
    {
      const Index end = std::min(count, begin + w.limits.piece);
      piece.clear();
      for (Index m = begin; m < end; ++m)
        piece.push_back(w.mesh.nodes[static_cast<std::size_t>(zone.nodes[static_cast<std::size_t>(m)])][d]);
      const cgsize_t first = static_cast<cgsize_t>(begin + 1), last = static_cast<cgsize_t>(end);
      int number = 0;
      w.output.check(
        cg_coord_partial_write(w.file, w.base, z.zone, RealDouble, names[d], &first, &last, piece.data(), &number),
        fmt::format("{}, {}", z.where, names[d]));
      w.report(end - begin);
    }
}

/// writes elements `first` .. `last` (counted from 0) of a section under the numbers that begin with `number`.
void write_elements(Writing& w, const Curved_section& section, Index first, Index last, Index number,
                    const std::string& name, const Zone_numbers& z)
{
  const int degree = w.mesh.degree;
  const Index width = node_count(section.type, degree);
  const std::span<const int> order = canonical_of_foreign(Node_order::cgns, section.type, degree);
  const ElementType_t code =
    element_codes[static_cast<std::size_t>(section.type)][static_cast<std::size_t>(degree - 1)];
  const std::string what = fmt::format("{}, section '{}'", z.where, name);
  const Index count = last - first + 1;
  int index = 0;
  w.output.check(cg_section_partial_write(w.file, w.base, z.zone, name.c_str(), code, static_cast<cgsize_t>(number),
                                          static_cast<cgsize_t>(number + count - 1), 0, &index),
                 what);
  const Index step = std::max<Index>(1, w.limits.piece / width);
  std::vector<cgsize_t> piece;
  for (Index begin = 0; begin < count; begin += step)
  {
    const Index end = std::min(count, begin + step);
    piece.clear();
    for (Index element = first + begin; element < first + end; ++element)
      for (const int canonical : order)
        piece.push_back(w.local_number[static_cast<std::size_t>(
          section.nodes[static_cast<std::size_t>(element * width + canonical)])]);
    w.output.check(cg_elements_partial_write(w.file, w.base, z.zone, index, static_cast<cgsize_t>(number + begin),
                                             static_cast<cgsize_t>(number + end - 1), piece.data()),
                   what);
    w.report((end - begin) * width);
  }
}

/// writes all sections of a zone; cells first, then faces, then bars. Sets the number of the first face.
void write_sections(Writing& w, const Curved_zone& zone, Cgns_names& names, Zone_numbers& z)
{
  Index number = 1;
  for (const std::vector<Curved_section>* sections : {&zone.cells, &zone.faces, &zone.bars})
  {
    if (sections == &zone.faces)
      z.first_face = number;
    for (const Curved_section& section : *sections)
    {
      const Index width = node_count(section.type, w.mesh.degree);
      const Index count = static_cast<Index>(section.nodes.size()) / width;
      const Index most = std::max<Index>(1, w.limits.section_entries / width);
      for (Index begin = 0; begin < count; begin += most)
      {
        const Index end = std::min(count, begin + most);
        write_elements(w, section, begin, end - 1, number, names.take(section.name), z);
        number += end - begin;
      }
    }
  }
}

bool is_consecutive(const std::vector<Index>& numbers)
{
  return std::adjacent_find(numbers.begin(), numbers.end(), [](Index a, Index b) { return b != a + 1; }) ==
         numbers.end();
}

void write_patches(const Writing& w, const Zone& zone, const Zone_numbers& z)
{
  Cgns_names names;
  for (const Patch& patch : zone.patches)
  {
    if (patch.faces.empty())
      continue;
    const std::string name = names.take(patch.name);
    const std::string what = fmt::format("{}, boundary condition '{}'", z.where, name);
    std::vector<cgsize_t> elements;
    const bool is_range = is_consecutive(patch.faces);
    if (is_range)
      elements = {static_cast<cgsize_t>(z.first_face + patch.faces.front()),
                  static_cast<cgsize_t>(z.first_face + patch.faces.back())};
    else
      for (const Index face : patch.faces)
        elements.push_back(static_cast<cgsize_t>(z.first_face + face));
    int condition = 0;
    w.output.check(cg_boco_write(w.file, w.base, z.zone, name.c_str(), condition_type(patch.kind),
                                 is_range ? PointRange : PointList, static_cast<cgsize_t>(elements.size()),
                                 elements.data(), &condition),
                   what);
    w.output.check(cg_boco_gridlocation_write(w.file, w.base, z.zone, condition, FaceCenter), what);
    if (patch.family.empty())
      continue;
    w.output.check(cg_goto(w.file, w.base, "Zone_t", z.zone, "ZoneBC_t", 1, "BC_t", condition, "end"), what);
    w.output.check(cg_famname_write(file_name(w.family_names, patch.family).c_str()), what);
  }
}

void write_periodicity(const Writing& w, const Periodicity& periodicity, const Zone_numbers& z, int connection,
                       const std::string& what)
{
  const double unit = w.mesh.linear.units[4] == "Degree" ? 180 / std::numbers::pi : 1;
  std::array<float, 3> center = {}, angle = {}, translation = {}; // the SIDS allow no doubles here
  for (std::size_t d = 0; d < 3; ++d)
  {
    center[d] = static_cast<float>(periodicity.rotation_center[d]);
    angle[d] = static_cast<float>(unit * periodicity.rotation_angle[d]);
    translation[d] = static_cast<float>(periodicity.translation[d]);
  }
  w.output.check(
    cg_conn_periodic_write(w.file, w.base, z.zone, connection, center.data(), angle.data(), translation.data()), what);
}

void write_interfaces(const Writing& w, const Zone& zone, const std::vector<Index>& first_faces, const Zone_numbers& z)
{
  const std::vector<Zone>& zones = w.mesh.linear.zones;
  Cgns_names names;
  for (const Zone_interface& interface : zone.interfaces)
  {
    if (interface.points.empty() || interface.points.size() != interface.donor_points.size())
      continue; // a name without points: CGNS has no such connection
    const std::string name = names.take(interface.name);
    const std::string what = fmt::format("{}, connection '{}'", z.where, name);
    const bool is_vertex = interface.location == Zone_interface::Location::vertex;
    const auto donor =
      std::find_if(zones.begin(), zones.end(), [&](const Zone& other) { return other.name == interface.donor_zone; });
    if (donor == zones.end())
      throw Input_error(fmt::format("{}: its donor '{}' is no zone", what, interface.donor_zone));
    const Index shift = is_vertex ? 1 : z.first_face;
    const Index donor_shift = is_vertex ? 1 : first_faces[static_cast<std::size_t>(donor - zones.begin())];
    std::vector<cgsize_t> points, donor_points;
    for (const Index point : interface.points)
      points.push_back(static_cast<cgsize_t>(point + shift));
    for (const Index point : interface.donor_points)
      donor_points.push_back(static_cast<cgsize_t>(point + donor_shift));
    int connection = 0;
    w.output.check(cg_conn_write(w.file, w.base, z.zone, name.c_str(), is_vertex ? Vertex : FaceCenter,
                                 interface.is_abutting_one_to_one ? Abutting1to1 : Abutting, PointList,
                                 static_cast<cgsize_t>(points.size()), points.data(),
                                 file_name(w.zone_names, interface.donor_zone).c_str(), Unstructured, PointListDonor,
                                 Integer, static_cast<cgsize_t>(donor_points.size()), donor_points.data(), &connection),
                   what);
    if (interface.periodicity)
      write_periodicity(w, *interface.periodicity, z, connection, what);
  }
}

void write_zone(Writing& w, std::size_t index, const std::vector<Index>& first_faces)
{
  const Zone& linear = w.mesh.linear.zones[index];
  const Curved_zone& zone = w.mesh.zones[index];
  const std::string name = file_name(w.zone_names, linear.name);
  Zone_numbers z = {.zone = 0, .first_face = 1, .where = fmt::format("zone '{}'", name)};
  const std::array<cgsize_t, 3> size = {static_cast<cgsize_t>(zone.nodes.size()),
                                        static_cast<cgsize_t>(element_count(zone.cells, w.mesh.degree)), 0};
  w.output.check(cg_zone_write(w.file, w.base, name.c_str(), size.data(), Unstructured, &z.zone), z.where);
  for (std::size_t m = 0; m < zone.nodes.size(); ++m)
    w.local_number[static_cast<std::size_t>(zone.nodes[m])] = static_cast<cgsize_t>(m + 1);

  Cgns_names names = {"GridCoordinates", "ZoneBC", "ZoneGridConnectivity", "ZoneType", "FamilyName"};
  write_coordinates(w, zone, z);
  write_sections(w, zone, names, z);
  write_patches(w, linear, z);
  write_interfaces(w, linear, first_faces, z);
  w.output.check(cg_goto(w.file, w.base, "Zone_t", z.zone, "end"), z.where);
  if (!linear.family.empty())
    w.output.check(cg_famname_write(file_name(w.family_names, linear.family).c_str()), z.where);
  for (const Descriptor& descriptor : linear.descriptors)
    w.output.check(cg_descriptor_write(names.take(descriptor.name).c_str(), descriptor.text.c_str()),
                   fmt::format("{}, descriptor '{}'", z.where, descriptor.name));
}

void write_file(const Curved_mesh& mesh, const std::filesystem::path& file, const Progress_callback& progress,
                const Cgns_write_limits& limits)
{
  const std::lock_guard<std::mutex> lock(cgns_mutex());
  Cgns_output output(file);
  Writing w = {.mesh = mesh,
               .output = output,
               .progress = progress,
               .limits = limits,
               .file = output.number(),
               .zone_names = {},
               .family_names = {},
               .local_number = std::vector<cgsize_t>(mesh.nodes.size()),
               .entries_total = entry_count(mesh)};
  write_base(w);
  std::vector<Index> first_faces; // of every zone, since a connection names faces of its donor
  for (const Curved_zone& zone : mesh.zones)
    first_faces.push_back(1 + element_count(zone.cells, mesh.degree));
  for (std::size_t z = 0; z < mesh.zones.size(); ++z)
    write_zone(w, z, first_faces);
  output.finish();
}

} // namespace

void write_cgns_within(const Curved_mesh& mesh, const std::filesystem::path& file, const Progress_callback& progress,
                       const Cgns_write_limits& limits)
{
  check_writable(mesh);
  report_progress(progress, "write", 0);
  reserve_disk_space(file, largest_file_size(mesh));
  try
  {
    write_file(mesh, file, progress, limits);
    check_written(mesh, file);
  }
  catch (...)
  {
    std::error_code ignored;
    std::filesystem::remove(file, ignored);
    throw;
  }
  report_progress(progress, "write", 1);
}

} // namespace internal::cgns

void write_cgns(const Curved_mesh& mesh, const std::filesystem::path& file, const Progress_callback& progress)
{
  internal::cgns::write_cgns_within(mesh, file, progress, {});
}

} // namespace recurve
