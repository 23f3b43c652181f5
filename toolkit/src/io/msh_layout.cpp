#include "msh_layout.h"

#include "cgns_names.h"

#include <recurve/elements/node_layout.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <span>

namespace recurve::internal::msh {

namespace {

// Gmsh reads names into 128 bytes.
constexpr std::size_t longest_name = 127;

/// Gives physical groups their numbers and names.
class Group_list
{
public:
  /// the group of the dimension and name, new or known.
  int number_of(int dimension, const std::string& name)
  {
    const auto [entry, is_new] = numbers_.try_emplace({dimension, name}, static_cast<int>(groups_.size()) + 1);
    if (is_new)
      groups_.push_back({dimension, entry->second, free_name(dimension, name)});
    return entry->second;
  }

  std::vector<Physical_group> take() { return std::move(groups_); }

private:
  /// a name as the file can hold it. Surfaces and volumes may have the same one.
  std::string free_name(int dimension, std::string name)
  {
    for (char& character : name)
      if (character == '"')
        character = '\'';
      else if (static_cast<unsigned char>(character) < 32)
        character = ' ';
    if (name.empty())
      name = "unnamed";
    name = cgns::cut_name(name, longest_name);
    std::string candidate = name;
    for (int number = 2; !taken_.insert({dimension, candidate}).second; ++number)
    {
      const std::string suffix = fmt::format("_{}", number);
      candidate = cgns::cut_name(name, longest_name - suffix.size()) + suffix;
    }
    return candidate;
  }

  std::map<std::pair<int, std::string>, int> numbers_;
  std::set<std::pair<int, std::string>> taken_;
  std::vector<Physical_group> groups_;
};

/// splits faces of a zone, ascending, into blocks of sections.
std::vector<Block> blocks_of(const Curved_zone& zone, int degree, std::span<const Index> faces)
{
  std::vector<Block> blocks;
  std::size_t next = 0;
  Index first = 0;
  for (const Curved_section& section : zone.faces)
  {
    const Index count = static_cast<Index>(section.nodes.size()) / node_count(section.type, degree);
    Block block = {&section, {}, 0};
    for (; next < faces.size() && faces[next] < first + count; ++next)
      block.faces.push_back(faces[next] - first);
    block.count = static_cast<Index>(block.faces.size());
    if (block.count > 0)
      blocks.push_back(std::move(block));
    first += count;
  }
  return blocks;
}

void add_surfaces(const Curved_mesh& mesh, std::size_t z, Group_list& groups, std::vector<Entity>& entities)
{
  const Zone& linear = mesh.linear.zones[z];
  const Curved_zone& zone = mesh.zones[z];
  const auto add = [&](const std::string& name, std::span<const Index> faces) {
    if (!faces.empty())
      entities.push_back(
        {2, static_cast<int>(entities.size()) + 1, groups.number_of(2, name), z, blocks_of(zone, mesh.degree, faces)});
  };
  std::vector<bool> has_patch(static_cast<std::size_t>(linear.face_count()), false);
  for (const Patch& patch : linear.patches)
  {
    add(patch.name, patch.faces);
    for (const Index face : patch.faces)
      has_patch[static_cast<std::size_t>(face)] = true;
  }
  Index first = 0;
  for (const Section& section : linear.faces)
  {
    std::vector<Index> faces;
    for (Index face = first; face < first + section.size(); ++face)
      if (!has_patch[static_cast<std::size_t>(face)])
        faces.push_back(face);
    add(section.name, faces);
    first += section.size();
  }
}

void add_volume(const Curved_mesh& mesh, std::size_t z, Group_list& groups, std::vector<Entity>& entities)
{
  Entity entity = {3, static_cast<int>(z) + 1, groups.number_of(3, mesh.linear.zones[z].name), z, {}};
  for (const Curved_section& section : mesh.zones[z].cells)
    if (const Index count = static_cast<Index>(section.nodes.size()) / node_count(section.type, mesh.degree); count > 0)
      entity.blocks.push_back({&section, {}, count});
  entities.push_back(std::move(entity));
}

// Periodic links.
// ------------------------------------------------------------------------------------------------------

std::span<const Index> face_of(const Block& block, Index m, int degree)
{
  const auto width = static_cast<std::size_t>(node_count(block.section->type, degree));
  return std::span(block.section->nodes)
    .subspan(static_cast<std::size_t>(block.faces[static_cast<std::size_t>(m)]) * width, width);
}

template <class Visit>
void visit_faces(const Entity& surface, int degree, const Visit& visit)
{
  for (const Block& block : surface.blocks)
    for (Index m = 0; m < block.count; ++m)
      visit(block.section->type, face_of(block, m, degree));
}

/// The faces of all surfaces of a zone by their corners.
using Face_map = std::map<std::vector<Index>, std::pair<const Entity*, std::span<const Index>>>;

std::vector<Index> sorted_corners(std::span<const Index> nodes, Element_type type)
{
  std::vector<Index> corners(nodes.begin(), nodes.begin() + corner_count(type));
  std::sort(corners.begin(), corners.end());
  return corners;
}

Face_map faces_of_zone(const std::vector<Entity>& entities, std::size_t zone, int degree)
{
  Face_map faces;
  for (const Entity& entity : entities)
    if (entity.dimension == 2 && entity.zone == zone)
      visit_faces(entity, degree, [&](Element_type type, std::span<const Index> nodes) {
        faces.emplace(sorted_corners(nodes, type), std::pair(&entity, nodes));
      });
  return faces;
}

/// pairs the nodes of a face with those of its partner, whose corners are `images` of the face's.
void pair_nodes(Element_type type, int degree, std::span<const Index> nodes, std::span<const Index> images,
                std::span<const Index> partner, std::map<Index, Index>& pairs)
{
  const int count = corner_count(type);
  const auto at = [&](int corner) {
    return static_cast<int>(
      std::find(partner.begin(), partner.begin() + count, images[static_cast<std::size_t>(corner)]) - partner.begin());
  };
  const int first = at(0);
  const std::span<const int> order = face_orientation(type, degree, first, at(1) != (first + 1) % count);
  for (std::size_t m = 0; m < order.size(); ++m)
    pairs.emplace(partner[static_cast<std::size_t>(order[m])], nodes[m]);
}

/// the link that starts at `surface`, if the partners of all its faces are in one surface.
std::optional<Periodic_link> find_link(const Entity& surface, int degree, const std::map<Index, Index>& donor_of_vertex,
                                       const Face_map& donors, const Periodicity& map)
{
  const Entity* partner = nullptr;
  std::map<Index, Index> pairs;
  bool is_whole = true;
  visit_faces(surface, degree, [&](Element_type type, std::span<const Index> nodes) {
    std::vector<Index> images;
    for (int c = 0; c < corner_count(type) && is_whole; ++c)
      if (const auto image = donor_of_vertex.find(nodes[static_cast<std::size_t>(c)]); image != donor_of_vertex.end())
        images.push_back(image->second);
      else
        is_whole = false;
    if (!is_whole)
      return;
    std::vector<Index> key = images;
    std::sort(key.begin(), key.end());
    const auto found = donors.find(key);
    is_whole = found != donors.end() && (partner == nullptr || partner == found->second.first);
    if (!is_whole)
      return;
    partner = found->second.first;
    pair_nodes(type, degree, nodes, images, found->second.second, pairs);
  });
  if (!is_whole || partner == nullptr)
    return std::nullopt;
  return Periodic_link{partner->tag, surface.tag, affine_matrix(map), {pairs.begin(), pairs.end()}};
}

void add_links(const Curved_mesh& mesh, Msh_layout& layout)
{
  for (std::size_t z = 0; z < mesh.zones.size(); ++z)
    for (const Zone_interface& interface : mesh.linear.zones[z].interfaces)
    {
      const auto donor = std::find_if(mesh.linear.zones.begin(), mesh.linear.zones.end(),
                                      [&](const Zone& zone) { return zone.name == interface.donor_zone; });
      if (!interface.periodicity || interface.location != Zone_interface::Location::vertex ||
          donor == mesh.linear.zones.end() || interface.points.size() != interface.donor_points.size())
        continue;
      const auto d = static_cast<std::size_t>(donor - mesh.linear.zones.begin());
      std::map<Index, Index> donor_of_vertex;
      for (std::size_t m = 0; m < interface.points.size(); ++m)
        donor_of_vertex.emplace(mesh.zones[z].nodes[static_cast<std::size_t>(interface.points[m])],
                                mesh.zones[d].nodes[static_cast<std::size_t>(interface.donor_points[m])]);
      const Face_map donors = faces_of_zone(layout.entities, d, mesh.degree);
      for (const Entity& entity : layout.entities)
        if (entity.dimension == 2 && entity.zone == z)
          if (auto link = find_link(entity, mesh.degree, donor_of_vertex, donors, *interface.periodicity))
            layout.links.push_back(std::move(*link));
    }
}

} // namespace

std::array<double, 16> affine_matrix(const Periodicity& map)
{
  const auto& [ax, ay, az] = map.rotation_angle;
  const double cx = std::cos(ax), sx = std::sin(ax), cy = std::cos(ay), sy = std::sin(ay), cz = std::cos(az),
               sz = std::sin(az);
  const std::array<std::array<double, 3>, 3> rotation = {{{cz * cy, cz * sy * sx - sz * cx, cz * sy * cx + sz * sx},
                                                          {sz * cy, sz * sy * sx + cz * cx, sz * sy * cx - cz * sx},
                                                          {0 - sy, cy * sx, cy * cx}}};
  std::array<double, 16> matrix = {};
  for (std::size_t row = 0; row < 3; ++row)
  {
    double shift = map.rotation_center[row] + map.translation[row];
    for (std::size_t column = 0; column < 3; ++column)
    {
      matrix[4 * row + column] = rotation[row][column];
      shift -= rotation[row][column] * map.rotation_center[column];
    }
    matrix[4 * row + 3] = shift;
  }
  matrix[15] = 1;
  return matrix;
}

Index Msh_layout::element_count() const
{
  Index count = 0;
  for (const Entity& entity : entities)
    for (const Block& block : entity.blocks)
      count += block.count;
  return count;
}

Msh_layout make_layout(const Curved_mesh& mesh)
{
  Msh_layout layout;
  Group_list groups;
  for (const Zone& zone : mesh.linear.zones)
    groups.number_of(3, zone.name); // zones have the first numbers
  for (std::size_t z = 0; z < mesh.zones.size(); ++z)
    add_surfaces(mesh, z, groups, layout.entities);
  for (std::size_t z = 0; z < mesh.zones.size(); ++z)
    add_volume(mesh, z, groups, layout.entities);
  layout.groups = groups.take();
  add_links(mesh, layout);
  return layout;
}

} // namespace recurve::internal::msh
