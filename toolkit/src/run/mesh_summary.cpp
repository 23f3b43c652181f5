#include <recurve/run/mesh_summary.h>

#include "json.h"

#include <algorithm>
#include <limits>

namespace recurve {

namespace {

Zone_summary summarize_zone(const Zone& zone)
{
  Zone_summary result;
  result.name = zone.name;
  result.family = zone.family;
  result.points = static_cast<Index>(zone.points.size());
  for (const Section& section : zone.cells)
    result.cells[static_cast<std::size_t>(section.type)] += section.size();
  return result;
}

/// the types of all faces of a zone, by number.
std::vector<Element_type> face_types(const Zone& zone)
{
  std::vector<Element_type> types;
  types.reserve(static_cast<std::size_t>(zone.face_count()));
  for (const Section& section : zone.faces)
    types.insert(types.end(), static_cast<std::size_t>(section.size()), section.type);
  return types;
}

Patch_place patch_place(Face_place place)
{
  switch (place)
  {
  case Face_place::boundary: return Patch_place::boundary;
  case Face_place::inside: return Patch_place::internal;
  case Face_place::zone_interface: return Patch_place::interface;
  case Face_place::nowhere: break;
  }
  return Patch_place::nowhere;
}

Patch_place patch_place(const Patch& patch, const std::vector<Face_owners>& owners)
{
  Patch_place result = Patch_place::nowhere;
  for (Index face : patch.faces)
  {
    const Patch_place place = patch_place(place_of(owners[static_cast<std::size_t>(face)]));
    if (place == Patch_place::nowhere || place == result)
      continue;
    if (result != Patch_place::nowhere)
      return Patch_place::mixed;
    result = place;
  }
  return result;
}

Patch_summary summarize_patch(const Zone& zone, const Patch& patch, const std::vector<Element_type>& types,
                              const std::vector<Face_owners>& owners)
{
  Patch_summary result{zone.name, patch.name, patch.kind, patch.family, 0, 0, patch_place(patch, owners)};
  for (Index face : patch.faces)
    ++(types[static_cast<std::size_t>(face)] == Element_type::triangle ? result.triangles : result.quadrangles);
  return result;
}

void find_bounding_box(const Volume_mesh& mesh, Mesh_summary& summary)
{
  constexpr double infinity = std::numeric_limits<double>::infinity();
  Point smallest = {infinity, infinity, infinity}, largest = {-infinity, -infinity, -infinity};
  for (const Zone& zone : mesh.zones)
    for (const Point& point : zone.points)
      for (std::size_t c = 0; c < 3; ++c)
      {
        smallest[c] = std::min(smallest[c], point[c]);
        largest[c] = std::max(largest[c], point[c]);
      }
  if (summary.point_count() > 0)
  {
    summary.smallest = smallest;
    summary.largest = largest;
  }
}

Json json_of_cells(const std::array<Index, all_element_types.size()>& cells)
{
  Json json = Json::object();
  for (Element_type type : all_element_types)
    if (reference_element(type).dimension == 3)
      json[std::string(element_name(type))] = cells[static_cast<std::size_t>(type)];
  return json;
}

Json json_of(const Zone_summary& zone)
{
  return {{"name", zone.name}, {"family", zone.family}, {"points", zone.points}, {"cells", json_of_cells(zone.cells)}};
}

Json json_of(const Patch_summary& patch)
{
  return {{"zone", patch.zone},
          {"name", patch.name},
          {"kind", patch.kind},
          {"family", patch.family},
          {"triangles", patch.triangles},
          {"quadrangles", patch.quadrangles},
          {"place", to_string(patch.place)}};
}

Json json_of(const Interface_summary& interface)
{
  return {{"zone", interface.zone},
          {"name", interface.name},
          {"donor_zone", interface.donor_zone},
          {"pairs", interface.points},
          {"one_to_one", interface.is_abutting_one_to_one},
          {"periodic", interface.is_periodic}};
}

Json json_of(const Joined_pair& pair)
{
  return {{"zones", {pair.zone_a, pair.zone_b}},
          {"points_by_connectivity", pair.points_by_connectivity},
          {"points_by_geometry", pair.points_by_geometry},
          {"largest_gap", pair.largest_gap}};
}

Json json_of(const Boundary_report& boundary)
{
  return {{"boundary_faces", boundary.boundary_faces},      {"interface_faces", boundary.interface_faces},
          {"unassigned_faces", boundary.unassigned_faces},  {"faces_without_cell", boundary.faces_without_cell},
          {"duplicate_faces", boundary.duplicate_faces},    {"internal_patches", boundary.internal_patches},
          {"interface_patches", boundary.interface_patches}};
}

/// the first of `cells`, as numbers counted from 0.
Json json_of(const std::vector<Cell_number>& cells, const Mesh_summary& summary)
{
  // Enough to find the place; a mesh can have millions of them.
  constexpr std::size_t listed_cells = 100;
  Json json = Json::array();
  for (std::size_t c = 0; c < std::min(cells.size(), listed_cells); ++c)
    json.push_back({{"zone", summary.zones[static_cast<std::size_t>(cells[c].zone)].name}, {"cell", cells[c].cell}});
  return json;
}

Json json_of_orientation(const Mesh_summary& summary)
{
  const Orientation_report& orientation = summary.orientation;
  return {{"mirrored", orientation.mirrored_cells},
          {"invalid", orientation.invalid_cells.size()},
          {"collapsed", orientation.collapsed_cells.size()},
          {"first_invalid", json_of(orientation.invalid_cells, summary)},
          {"first_collapsed", json_of(orientation.collapsed_cells, summary)}};
}

template <class Items>
Json json_list(const Items& items)
{
  Json json = Json::array();
  for (const auto& item : items)
    json.push_back(json_of(item));
  return json;
}

} // namespace

std::string_view to_string(Patch_place place)
{
  constexpr std::string_view words[] = {"boundary", "internal", "interface", "mixed", "nowhere"};
  return words[static_cast<std::size_t>(place)];
}

Index Mesh_summary::point_count() const
{
  Index count = 0;
  for (const Zone_summary& zone : zones)
    count += zone.points;
  return count;
}

Index Mesh_summary::cell_count() const
{
  Index count = 0;
  for (Element_type type : all_element_types)
    count += cell_count(type);
  return count;
}

Index Mesh_summary::cell_count(Element_type type) const
{
  Index count = 0;
  for (const Zone_summary& zone : zones)
    count += zone.cells[static_cast<std::size_t>(type)];
  return count;
}

Mesh_summary summarize(const Volume_mesh& mesh, const Mesh_structure& structure)
{
  Mesh_summary summary;
  summary.name = mesh.name;
  summary.joined_zones = structure.joined.pairs;
  summary.orientation = structure.orientation;
  summary.boundary = structure.boundary.report;
  for (std::size_t z = 0; z < mesh.zones.size(); ++z)
  {
    const Zone& zone = mesh.zones[z];
    const std::vector<Element_type> types = face_types(zone);
    summary.zones.push_back(summarize_zone(zone));
    for (const Patch& patch : zone.patches)
      summary.patches.push_back(summarize_patch(zone, patch, types, structure.boundary.owners[z]));
    for (const Zone_interface& interface : zone.interfaces)
      summary.interfaces.push_back({zone.name, interface.name, interface.donor_zone,
                                    static_cast<Index>(interface.points.size()), interface.is_abutting_one_to_one,
                                    interface.periodicity.has_value()});
  }
  find_bounding_box(mesh, summary);
  return summary;
}

Json json_of(const Mesh_summary& summary)
{
  std::array<Index, all_element_types.size()> cells = {};
  for (Element_type type : all_element_types)
    cells[static_cast<std::size_t>(type)] = summary.cell_count(type);
  return {{"name", summary.name},
          {"points", summary.point_count()},
          {"cells", summary.cell_count()},
          {"cells_by_type", json_of_cells(cells)},
          {"bounding_box", {{"smallest", summary.smallest}, {"largest", summary.largest}}},
          {"zones", json_list(summary.zones)},
          {"patches", json_list(summary.patches)},
          {"interfaces", json_list(summary.interfaces)},
          {"joined_zones", json_list(summary.joined_zones)},
          {"boundary", json_of(summary.boundary)},
          {"orientation", json_of_orientation(summary)}};
}

std::string to_json(const Mesh_summary& summary)
{
  return json_text(json_of(summary));
}

} // namespace recurve
