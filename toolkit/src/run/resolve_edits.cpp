#include "resolve_edits.h"

#include <recurve/core/exceptions.h>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <numeric>
#include <string>
#include <utility>

namespace recurve {

namespace {

/// no_index is what an edit has for "any other patch".
constexpr Index no_patch = -2;

/// numbers of the names of patches, in alphabetical order.
std::map<std::string, Index> number_names(const Volume_mesh& mesh)
{
  std::map<std::string, Index> numbers;
  for (const Zone& zone : mesh.zones)
    for (const Patch& patch : zone.patches)
      numbers.emplace(patch.name, 0);
  for (Index n = 0; auto& [name, number] : numbers)
    number = n++;
  return numbers;
}

/// The vertices of a surface by the names of the mesh.
class Resolver
{
public:
  Resolver(const Volume_mesh& mesh, const Joined_zones& joined, const Boundary_surface& surface)
    : mesh_(mesh), joined_(joined), patches_(number_names(mesh))
  {
    for (const Boundary_surface::Vertex v : surface.mesh.vertices())
      joined_vertex_.push_back(surface.joined_vertex[v]);
  }

  Feature_edit operator()(const Feature_file_edit& named) const
  {
    Feature_edit edit = named.edit;
    for (std::size_t i = 0; i < std::min(named.nodes.size(), edit.vertices.size()); ++i)
      if (!named.nodes[i].zone.empty())
        edit.vertices[i].numbers = vertices_of(named.nodes[i], edit.origin);
    if (edit.kind == Feature_edit_kind::patches)
      for (std::size_t i = 0; i < 2; ++i)
        edit.patches[i] = i == 1 && named.patches[i].empty() ? no_index : number_of(named.patches[i], edit.origin);
    return edit;
  }

private:
  std::vector<Index> vertices_of(const Zone_node& name, const std::string& origin) const
  {
    const auto zone = std::find_if(mesh_.zones.begin(), mesh_.zones.end(),
                                   [&](const Zone& candidate) { return candidate.name == name.zone; });
    if (zone == mesh_.zones.end())
      throw Input_error(
        fmt::format("{}: there is no zone \"{}\"; zones are: {}", origin, name.zone, fmt::join(zone_names(), ", ")));
    const auto size = static_cast<Index>(zone->points.size());
    if (name.node < 0 || name.node >= size)
      throw Input_error(fmt::format("{}: zone \"{}\" has no node {}; its nodes are numbered from 0 to {}", origin,
                                    name.zone, name.node, size - 1));
    const auto z = static_cast<std::size_t>(zone - mesh_.zones.begin());
    const Index joined = joined_.vertex_of_point[z][static_cast<std::size_t>(name.node)];
    const auto [first, last] = std::equal_range(joined_vertex_.begin(), joined_vertex_.end(), joined);
    std::vector<Index> found(static_cast<std::size_t>(last - first));
    std::iota(found.begin(), found.end(), static_cast<Index>(first - joined_vertex_.begin()));
    if (found.empty())
      throw Input_error(
        fmt::format("{}: node {} of zone \"{}\" is not on the curved surface", origin, name.node, name.zone));
    return found;
  }

  std::vector<std::string> zone_names() const
  {
    std::vector<std::string> names;
    for (const Zone& zone : mesh_.zones)
      names.push_back(zone.name);
    return names;
  }

  Index number_of(const std::string& patch, const std::string& origin) const
  {
    if (const auto found = patches_.find(patch); found != patches_.end())
      return found->second;
    std::vector<std::string> names;
    for (const auto& entry : patches_)
      names.push_back(entry.first);
    throw Input_error(
      fmt::format("{}: there is no patch \"{}\"; patches are: {}", origin, patch, fmt::join(names, ", ")));
  }

  const Volume_mesh& mesh_;
  const Joined_zones& joined_;
  std::map<std::string, Index> patches_;
  std::vector<Index> joined_vertex_; ///< per vertex of the surface; ascending
};

} // namespace

std::vector<Feature_edit> resolve_edits(const Feature_file& file, const Volume_mesh& mesh, const Joined_zones& joined,
                                        const Boundary_surface& surface)
{
  const Resolver resolve(mesh, joined, surface);
  std::vector<Feature_edit> edits;
  for (std::size_t i = 0; i < file.edits.size(); ++i)
  {
    Feature_file_edit named = file.edits[i];
    if (named.edit.origin.empty())
      named.edit.origin = fmt::format("feature edit {}", i + 1);
    edits.push_back(resolve(named));
  }
  return edits;
}

std::vector<Index> patch_numbers(const Volume_mesh& mesh, const Boundary_surface& surface)
{
  const std::map<std::string, Index> numbers = number_names(mesh);
  std::vector<Index> result;
  for (const Boundary_surface::Face face : surface.mesh.faces())
  {
    const Patch_face& listed = surface.face_patch[face];
    result.push_back(
      listed.patch == no_index
        ? no_patch
        : numbers.at(
            mesh.zones[static_cast<std::size_t>(listed.zone)].patches[static_cast<std::size_t>(listed.patch)].name));
  }
  return result;
}

} // namespace recurve
