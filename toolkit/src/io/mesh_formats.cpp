// The registry of formats: what each holds and who reads it. The table in the README is made from it.
#include <recurve/io/mesh_io.h>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <utility>

namespace recurve {

namespace {

namespace fs = std::filesystem;

Mesh_format cgns_format()
{
  return {.name = "CGNS",
          .extensions = {".cgns"},
          .largest_degree_read = 4,
          .largest_degree_written = 4,
          .content = {all_mesh_content.begin(), all_mesh_content.end()},
          .longest_name = 32,
          .not_in_names = "/",
          .shortened = "digits of periodic maps beyond 7",
          .versions = "read up to 4.x, HDF5 and ADF; written 3.4, HDF5",
          .readers = "HOPR, PETSc, Gmsh, Tecplot; ParaView in part",
          .read = read_curved_cgns,
          .write = [](const Curved_mesh& mesh, const fs::path& file, const std::vector<Cell_field>&,
                      const Write_options&, const Progress_callback& progress) { write_cgns(mesh, file, progress); }};
}

Mesh_format msh_format()
{
  return {.name = "MSH",
          .extensions = {".msh"},
          .largest_degree_read = max_degree,
          .largest_degree_written = max_degree,
          .content = {Mesh_content::cells, Mesh_content::zones, Mesh_content::patches, Mesh_content::periodicity},
          .longest_name = 127,
          .not_in_names = "\"",
          .shortened = "",
          .versions = "2.2 and 4.1, binary and ASCII",
          .readers = "Gmsh, PyHOPE (4.1), PyFR (4.1 in ASCII, the zone named fluid), MFEM (2.2), Nektar++",
          .read = read_msh,
          .write = [](const Curved_mesh& mesh, const fs::path& file, const std::vector<Cell_field>&,
                      const Write_options& options,
                      const Progress_callback& progress) { write_msh(mesh, file, options.msh, progress); }};
}

Mesh_format vtu_format()
{
  return {.name = "VTU",
          .extensions = {".vtu"},
          .largest_degree_read = max_degree,
          .largest_degree_written = max_degree,
          .content = {Mesh_content::cells, Mesh_content::zones, Mesh_content::patches},
          .longest_name = 0,
          .not_in_names = "",
          .shortened = "",
          .versions = "2.2, Lagrange cells of VTK 9.1; only our own are read",
          .readers = "ParaView, VisIt, PyVista",
          .read = read_vtu,
          .write = [](const Curved_mesh& mesh, const fs::path& file, const std::vector<Cell_field>& fields,
                      const Write_options&,
                      const Progress_callback& progress) { write_vtu(mesh, file, fields, progress); }};
}

Mesh_format su2_format()
{
  return {.name = "SU2",
          .extensions = {".su2"},
          .largest_degree_read = max_degree,
          .largest_degree_written = 0,
          .content = {},
          .longest_name = 0,
          .not_in_names = "",
          .shortened = "",
          .versions = "native text, linear and high order",
          .readers = "",
          .read = read_su2,
          .write = {}};
}

Mesh_format ugrid_format()
{
  return {.name = "UGRID",
          .extensions = {".ugrid"},
          .largest_degree_read = 1,
          .largest_degree_written = 0,
          .content = {},
          .longest_name = 0,
          .not_in_names = "",
          .shortened = "",
          .versions = ".b8, .b4, .lb8, .lb4 and text; .mapbc",
          .readers = "",
          .read = read_ugrid,
          .write = {}};
}

Mesh_format hopr_format()
{
  return {.name = "HOPR",
          .extensions = {".h5"},
          .largest_degree_read = max_degree,
          .largest_degree_written = max_degree,
          .content = {Mesh_content::cells, Mesh_content::zones, Mesh_content::patches, Mesh_content::periodicity},
          .longest_name = 255,
          .not_in_names = "",
          .shortened = "",
          .versions = "HDF5, 1.0",
          .readers = "PyHOPE; FLEXI (hexahedra)",
          .read = read_hopr,
          .write = [](const Curved_mesh& mesh, const fs::path& file, const std::vector<Cell_field>&,
                      const Write_options&, const Progress_callback& progress) { write_hopr(mesh, file, progress); }};
}

using Surface_writer = void (*)(const Curved_mesh&, const fs::path&, const Progress_callback&);

Mesh_format surface_format(const char* name, const char* extension, std::vector<Mesh_content> content,
                           const char* versions, const char* readers, Surface_writer writer)
{
  return {.name = name,
          .extensions = {extension},
          .largest_degree_read = 0,
          .largest_degree_written = max_degree,
          .content = std::move(content),
          .longest_name = 0,
          .not_in_names = "",
          .shortened = "curves of faces: each is p^2 straight pieces",
          .versions = versions,
          .readers = readers,
          .read = {},
          .write = [writer](const Curved_mesh& mesh, const fs::path& file, const std::vector<Cell_field>&,
                            const Write_options&, const Progress_callback& progress) { writer(mesh, file, progress); }};
}

template <class Items, class Predicate>
bool any_of(const Items& items, const Predicate& predicate)
{
  return std::any_of(items.begin(), items.end(), predicate);
}

/// whether the predicate holds for the name of a zone, a patch or, where the format has them, a family.
template <class Predicate>
bool any_name(const Mesh_format& format, const Volume_mesh& mesh, const Predicate& predicate)
{
  const bool has_families =
    std::find(format.content.begin(), format.content.end(), Mesh_content::families) != format.content.end();
  const auto named = [&](const auto& item) { return predicate(item.name); };
  return any_of(mesh.zones, [&](const Zone& zone) { return predicate(zone.name) || any_of(zone.patches, named); }) ||
         (has_families && any_of(mesh.families, named));
}

std::string long_names_text(const Mesh_format& format)
{
  return fmt::format("names beyond {} bytes", format.longest_name);
}

std::string changed_names_text(const Mesh_format& format)
{
  return fmt::format("{} in names", format.not_in_names);
}

bool is_said(const std::string& kind)
{
  return !kind.empty() && kind != "BCTypeNull" && kind != "BCTypeUserDefined" && kind != "FamilySpecified";
}

} // namespace

const std::vector<Mesh_format>& mesh_formats()
{
  static const std::vector<Mesh_format> formats = {
    cgns_format(),
    msh_format(),
    hopr_format(),
    vtu_format(),
    su2_format(),
    ugrid_format(),
    surface_format("VTP", ".vtp", {Mesh_content::patches}, "2.2", "ParaView, VisIt, PyVista", write_vtp),
    surface_format("PLY", ".ply", {Mesh_content::patches}, "1.0, binary", "MeshLab, CGAL", write_ply),
    surface_format("OFF", ".off", {}, "text", "Geomview, CGAL", write_off)};
  return formats;
}

std::string_view content_name(Mesh_content content)
{
  switch (content)
  {
  case Mesh_content::cells: return "cells";
  case Mesh_content::zones: return "zones";
  case Mesh_content::patches: return "patches";
  case Mesh_content::bars: return "bars";
  case Mesh_content::families: return "families";
  case Mesh_content::kinds: return "kinds of boundary conditions";
  case Mesh_content::connections: return "connections that are not one to one";
  case Mesh_content::periodicity: return "periodic connections";
  case Mesh_content::units: return "units";
  case Mesh_content::descriptors: return "descriptors";
  }
  return "";
}

bool has_content(const Curved_mesh& mesh, Mesh_content content)
{
  const Volume_mesh& linear = mesh.linear;
  switch (content)
  {
  case Mesh_content::cells: return mesh.cell_count() > 0;
  case Mesh_content::zones: return linear.zones.size() > 1;
  case Mesh_content::patches: return any_of(linear.zones, [](const Zone& zone) { return !zone.patches.empty(); });
  case Mesh_content::bars: return any_of(linear.zones, [](const Zone& zone) { return !zone.bars.empty(); });
  case Mesh_content::families: return !linear.families.empty();
  case Mesh_content::kinds:
    return any_of(linear.zones, [](const Zone& zone) {
      return any_of(zone.patches, [](const Patch& patch) { return is_said(patch.kind); });
    });
  case Mesh_content::connections:
    return any_of(linear.zones, [](const Zone& zone) {
      return any_of(zone.interfaces, [](const Zone_interface& interface) { return !interface.is_abutting_one_to_one; });
    });
  case Mesh_content::periodicity:
    return any_of(linear.zones, [](const Zone& zone) {
      return any_of(zone.interfaces, [](const Zone_interface& interface) { return interface.periodicity.has_value(); });
    });
  case Mesh_content::units: return any_of(linear.units, [](const std::string& unit) { return !unit.empty(); });
  case Mesh_content::descriptors:
    return !linear.descriptors.empty() ||
           any_of(linear.zones, [](const Zone& zone) { return !zone.descriptors.empty(); });
  }
  return false;
}

std::string describe_loss(const Mesh_format& format, const Curved_mesh& mesh)
{
  std::vector<std::string> lost;
  for (const Mesh_content content : all_mesh_content)
    if (std::find(format.content.begin(), format.content.end(), content) == format.content.end() &&
        has_content(mesh, content))
      lost.emplace_back(content_name(content));
  if (format.longest_name > 0 &&
      any_name(format, mesh.linear, [&format](const std::string& name) { return name.size() > format.longest_name; }))
    lost.push_back(long_names_text(format));
  if (!format.not_in_names.empty() && any_name(format, mesh.linear, [&format](const std::string& name) {
        return name.find(format.not_in_names) != std::string::npos;
      }))
    lost.push_back(changed_names_text(format));
  return lost.empty() ? "" : fmt::format("{} does not hold, and this mesh has: {}", format.name, fmt::join(lost, ", "));
}

namespace {

std::string degree_text(int largest)
{
  if (largest == 0)
    return "no";
  return largest == 1 ? std::string("linear") : fmt::format("degree 1 to {}", largest);
}

std::string lost_text(const Mesh_format& format)
{
  if (format.largest_degree_written == 0)
    return "";
  std::vector<std::string> lost;
  for (const Mesh_content content : all_mesh_content)
    if (std::find(format.content.begin(), format.content.end(), content) == format.content.end())
      lost.emplace_back(content_name(content));
  if (format.longest_name > 0)
    lost.push_back(long_names_text(format));
  if (!format.not_in_names.empty())
    lost.push_back(changed_names_text(format));
  if (!format.shortened.empty())
    lost.push_back(format.shortened);
  return lost.empty() ? "nothing" : fmt::format("{}", fmt::join(lost, ", "));
}

} // namespace

std::string format_table()
{
  std::string text = "| format | extension | read | written | versions | lost when written | read by |\n"
                     "|---|---|---|---|---|---|---|\n";
  for (const Mesh_format& format : mesh_formats())
    text += fmt::format("| {} | `{}` | {} | {} | {} | {} | {} |\n", format.name, fmt::join(format.extensions, "`, `"),
                        degree_text(format.largest_degree_read), degree_text(format.largest_degree_written),
                        format.versions, lost_text(format), format.readers);
  return text;
}

} // namespace recurve
