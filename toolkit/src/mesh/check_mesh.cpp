#include <recurve/core/exceptions.h>
#include <recurve/mesh/check_mesh.h>

#include <fmt/format.h>

#include <cmath>
#include <set>
#include <string_view>

namespace recurve {

namespace {

void check_points(const Zone& zone)
{
  if (zone.points.empty())
    throw Input_error(fmt::format("zone '{}' has no points", zone.name));
  for (std::size_t n = 0; n < zone.points.size(); ++n)
    for (int axis = 0; axis < 3; ++axis)
      if (!std::isfinite(zone.points[n][axis]))
        throw Input_error(
          fmt::format("zone '{}': coordinate {} of node {} is not a finite number", zone.name, "XYZ"[axis], n + 1));
}

void check_section(const Zone& zone, const Section& section, int dimension)
{
  const Reference_element& reference = reference_element(section.type);
  if (reference.dimension != dimension)
    throw Input_error(fmt::format("zone '{}', section '{}': elements of type {} have dimension {}, expected {}",
                                  zone.name, section.name, element_name(section.type), reference.dimension, dimension));
  if (section.nodes.size() % static_cast<std::size_t>(reference.corner_count) != 0)
    throw Input_error(
      fmt::format("zone '{}', section '{}': {} node numbers are not a multiple of {}, the corners of a {}", zone.name,
                  section.name, section.nodes.size(), reference.corner_count, element_name(section.type)));
  const Index point_count = static_cast<Index>(zone.points.size());
  for (std::size_t i = 0; i < section.nodes.size(); ++i)
    if (section.nodes[i] < 0 || section.nodes[i] >= point_count)
      throw Input_error(fmt::format("zone '{}', section '{}', element {}: node {} does not exist (nodes are 1 to {})",
                                    zone.name, section.name, i / static_cast<std::size_t>(reference.corner_count) + 1,
                                    section.nodes[i] + 1, point_count));
}

void check_sections(const Zone& zone)
{
  for (const Section& section : zone.cells)
    check_section(zone, section, 3);
  for (const Section& section : zone.faces)
    check_section(zone, section, 2);
  for (const Section& section : zone.bars)
    check_section(zone, section, 1);
  if (zone.cell_count() == 0)
    throw Input_error(fmt::format("zone '{}' has no cells", zone.name));
}

void check_patches(const Zone& zone)
{
  const Index face_count = zone.face_count();
  std::vector<Index> patch_of_face(static_cast<std::size_t>(face_count), no_index);
  for (std::size_t p = 0; p < zone.patches.size(); ++p)
  {
    const Patch& patch = zone.patches[p];
    Index previous = -1;
    for (const Index face : patch.faces)
    {
      if (face < 0 || face >= face_count)
        throw Input_error(fmt::format("zone '{}', patch '{}': face {} does not exist (faces are 1 to {})", zone.name,
                                      patch.name, face + 1, face_count));
      if (patch_of_face[face] != no_index && patch_of_face[face] != static_cast<Index>(p))
        throw Input_error(fmt::format("zone '{}': face {} is in patch '{}' and in patch '{}'", zone.name, face + 1,
                                      zone.patches[patch_of_face[face]].name, patch.name));
      if (face <= previous)
        throw Input_error(fmt::format("zone '{}', patch '{}': face {} is listed twice or out of order", zone.name,
                                      patch.name, face + 1));
      previous = face;
      patch_of_face[face] = static_cast<Index>(p);
    }
  }
}

void check_numbers(const Zone& zone, const Zone_interface& interface, const std::vector<Index>& numbers,
                   const Zone& owner)
{
  const bool is_vertex = interface.location == Zone_interface::Location::vertex;
  const Index count = is_vertex ? static_cast<Index>(owner.points.size()) : owner.face_count();
  for (const Index number : numbers)
    if (number < 0 || number >= count)
      throw Input_error(fmt::format("zone '{}', interface '{}': {} {} of zone '{}' does not exist (they are 1 to {})",
                                    zone.name, interface.name, is_vertex ? "node" : "face", number + 1, owner.name,
                                    count));
}

void check_interfaces(const Volume_mesh& mesh, const Zone& zone)
{
  for (const Zone_interface& interface : zone.interfaces)
  {
    if (!interface.is_abutting_one_to_one)
      continue;
    const Zone* const donor = find_zone(mesh, interface.donor_zone);
    if (donor == nullptr)
      throw Input_error(fmt::format("zone '{}', interface '{}': there is no zone '{}'", zone.name, interface.name,
                                    interface.donor_zone));
    if (interface.points.size() != interface.donor_points.size())
      throw Input_error(fmt::format("zone '{}', interface '{}': {} points meet {} points of zone '{}'", zone.name,
                                    interface.name, interface.points.size(), interface.donor_points.size(),
                                    interface.donor_zone));
    check_numbers(zone, interface, interface.points, zone);
    check_numbers(zone, interface, interface.donor_points, *donor);
  }
}

} // namespace

void check_mesh(const Volume_mesh& mesh)
{
  if (mesh.zones.empty())
    throw Input_error("the mesh has no zones");
  std::set<std::string_view> names;
  for (const Zone& zone : mesh.zones)
  {
    if (!names.insert(zone.name).second)
      throw Input_error(fmt::format("two zones are named '{}'", zone.name));
    check_points(zone);
    check_sections(zone);
    check_patches(zone);
  }
  for (const Zone& zone : mesh.zones)
    check_interfaces(mesh, zone);
}

} // namespace recurve
