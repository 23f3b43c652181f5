#include "grouped_mesh.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <numeric>
#include <span>
#include <unordered_map>

namespace recurve::internal {

namespace {

using Face_corners_key = std::array<Index, 4>;

struct Key_hash
{
  std::size_t operator()(const Face_corners_key& key) const
  {
    std::uint64_t hash = 0;
    for (const Index vertex : key)
      hash = (hash ^ static_cast<std::uint64_t>(vertex)) * 0x9E3779B97F4A7C15U;
    return static_cast<std::size_t>(hash ^ (hash >> 32));
  }
};

/// Zone of each face, by its corners; no_index: no cell with that face was found yet.
using Face_zones = std::unordered_map<Face_corners_key, Index, Key_hash>;

Face_corners_key face_key(std::span<const Index> corners)
{
  Face_corners_key key = {no_index, no_index, no_index, no_index};
  std::copy(corners.begin(), corners.end(), key.begin());
  std::sort(key.begin(), key.end());
  return key;
}

std::span<const Index> element_nodes(const Element_group& group, Index element, int degree)
{
  const auto width = static_cast<std::size_t>(node_count(group.type, degree));
  return std::span(group.nodes).subspan(static_cast<std::size_t>(element) * width, width);
}

Index element_count(const Element_group& group, int degree)
{
  return static_cast<Index>(group.nodes.size()) / node_count(group.type, degree);
}

Face_corners_key key_of_face(const Element_group& group, Index face, int degree)
{
  return face_key(element_nodes(group, face, degree).first(static_cast<std::size_t>(corner_count(group.type))));
}

/// the zone of every face of `mesh.faces`: the first that has a cell with it.
Face_zones find_zones_of_faces(const Grouped_mesh& mesh)
{
  Face_zones zones;
  for (const Element_group& group : mesh.faces)
    for (Index face = 0; face < element_count(group, mesh.degree); ++face)
      zones.emplace(key_of_face(group, face, mesh.degree), no_index);
  for (const Element_group& group : mesh.cells)
  {
    const Reference_element& reference = reference_element(group.type);
    for (Index cell = 0; cell < element_count(group, mesh.degree); ++cell)
    {
      const std::span<const Index> nodes = element_nodes(group, cell, mesh.degree);
      for (int f = 0; f < reference.face_count; ++f)
      {
        const Reference_face& face = reference.faces[static_cast<std::size_t>(f)];
        std::array<Index, 4> corners = {};
        for (std::size_t c = 0; c < static_cast<std::size_t>(face.corner_count); ++c)
          corners[c] = nodes[static_cast<std::size_t>(face.corners[c])];
        const auto found = zones.find(face_key(std::span(corners).first(static_cast<std::size_t>(face.corner_count))));
        if (found != zones.end() && (found->second == no_index || found->second > group.owner))
          found->second = group.owner;
      }
    }
  }
  return zones;
}

/// The conversion while it goes on.
class Zonal_builder
{
public:
  Zonal_builder(Grouped_mesh mesh, std::vector<std::string>& notes) : mesh_(std::move(mesh)), notes_(notes)
  {
    result_.degree = mesh_.degree;
    result_.linear.families = std::move(mesh_.families);
    result_.linear.zones.resize(mesh_.zone_names.size());
    for (std::size_t z = 0; z < mesh_.zone_names.size(); ++z)
      result_.linear.zones[z].name = mesh_.zone_names[z];
    if (mesh_.degree > 1)
      result_.zones.resize(mesh_.zone_names.size());
  }

  Zonal_mesh build()
  {
    if (mesh_.zone_names.size() > 1)
      split_faces();
    else
      for (Element_group& group : mesh_.faces)
        faces_.push_back({0, std::move(group)});
    for (std::size_t z = 0; z < mesh_.zone_names.size(); ++z)
      fill_zone(static_cast<Index>(z));
    if (mesh_.zone_names.size() > 1)
      connect_zones();
    note_empty_patches();
    return std::move(result_);
  }

private:
  struct Zone_faces
  {
    Index zone;
    Element_group group;
  };

  /// hands the faces of each group to the zones of their cells.
  void split_faces()
  {
    const Face_zones zones = find_zones_of_faces(mesh_);
    Index lost = 0;
    for (Element_group& group : mesh_.faces)
    {
      std::map<Index, Element_group> parts;
      for (Index face = 0; face < element_count(group, mesh_.degree); ++face)
      {
        const Index zone = zones.at(key_of_face(group, face, mesh_.degree));
        if (zone == no_index)
        {
          ++lost;
          continue;
        }
        Element_group& part =
          parts.try_emplace(zone, Element_group{group.owner, group.name, group.type, {}}).first->second;
        const std::span<const Index> nodes = element_nodes(group, face, mesh_.degree);
        part.nodes.insert(part.nodes.end(), nodes.begin(), nodes.end());
      }
      group.nodes = {};
      for (auto& [zone, part] : parts)
        faces_.push_back({zone, std::move(part)});
    }
    if (lost > 0)
      notes_.push_back(fmt::format("faces that are the side of no cell, left out: {}", lost));
  }

  void fill_zone(Index z)
  {
    const bool is_only = mesh_.zone_names.size() == 1;
    std::vector<Element_group*> cells, faces;
    for (Element_group& group : mesh_.cells)
      if (group.owner == z && !group.nodes.empty())
        cells.push_back(&group);
    for (Zone_faces& part : faces_)
      if (part.zone == z && !part.group.nodes.empty())
        faces.push_back(&part.group);
    Zone& zone = result_.linear.zones[static_cast<std::size_t>(z)];
    if (is_only)
      zone.points = std::move(mesh_.nodes);
    else
      number_nodes(zone, cells, faces);
    for (Element_group* group : cells)
      add_section(
        *group, z, zone.cells, [](Zonal_elements & elements) -> auto& { return elements.cells; });
    add_patches(zone, faces);
    for (Element_group* group : faces)
      add_section(
        *group, z, zone.faces, [](Zonal_elements & elements) -> auto& { return elements.faces; });
    if (is_only)
      add_periodicity_of_one_zone(zone);
  }

  /// renumbers the elements of a zone by the nodes that it uses, which keep their order.
  void number_nodes(Zone& zone, const std::vector<Element_group*>& cells, const std::vector<Element_group*>& faces)
  {
    local_.assign(mesh_.nodes.size(), no_index);
    for (const auto* groups : {&cells, &faces})
      for (const Element_group* group : *groups)
        for (const Index node : group->nodes)
          local_[static_cast<std::size_t>(node)] = 0;
    std::vector<Index> used;
    for (std::size_t node = 0; node < local_.size(); ++node)
      if (local_[node] == 0)
      {
        local_[node] = static_cast<Index>(used.size());
        used.push_back(static_cast<Index>(node));
        zone.points.push_back(mesh_.nodes[node]);
      }
    nodes_of_zone_.push_back(std::move(used));
    for (const auto* groups : {&cells, &faces})
      for (Element_group* group : *groups)
        for (Index& node : group->nodes)
          node = local_[static_cast<std::size_t>(node)];
  }

  template <class Choose>
  void add_section(Element_group& group, Index z, std::vector<Section>& linear, Choose choose)
  {
    if (mesh_.degree == 1)
    {
      linear.push_back({group.name, group.type, std::move(group.nodes)});
      return;
    }
    Section section = {group.name, group.type, {}};
    const auto corners = static_cast<std::size_t>(corner_count(group.type));
    const Index count = element_count(group, mesh_.degree);
    section.nodes.reserve(static_cast<std::size_t>(count) * corners);
    for (Index element = 0; element < count; ++element)
    {
      const std::span<const Index> nodes = element_nodes(group, element, mesh_.degree).first(corners);
      section.nodes.insert(section.nodes.end(), nodes.begin(), nodes.end());
    }
    linear.push_back(std::move(section));
    choose(result_.zones[static_cast<std::size_t>(z)]).push_back({group.name, group.type, std::move(group.nodes)});
  }

  void add_patches(Zone& zone, const std::vector<Element_group*>& faces)
  {
    std::map<Index, Patch> patches;
    Index first = 0;
    for (const Element_group* group : faces)
    {
      const Index count = element_count(*group, mesh_.degree);
      if (group->owner != no_index)
      {
        Patch& patch =
          patches.try_emplace(group->owner, mesh_.patches[static_cast<std::size_t>(group->owner)]).first->second;
        for (Index face = first; face < first + count; ++face)
          patch.faces.push_back(face);
        is_used_.resize(mesh_.patches.size());
        is_used_[static_cast<std::size_t>(group->owner)] = true;
      }
      first += count;
    }
    for (auto& [number, patch] : patches)
      zone.patches.push_back(std::move(patch));
  }

  void add_periodicity_of_one_zone(Zone& zone) const
  {
    for (const Periodic_nodes& periodic : mesh_.periodic)
    {
      Zone_interface interface = make_interface(fmt::format("periodic_{}", zone.interfaces.size() + 1), zone.name);
      interface.periodicity = periodic.map;
      for (const auto& [a, b] : periodic.pairs)
      {
        interface.points.push_back(a);
        interface.donor_points.push_back(b);
      }
      zone.interfaces.push_back(std::move(interface));
    }
  }

  static Zone_interface make_interface(std::string name, std::string donor)
  {
    return {.name = std::move(name),
            .donor_zone = std::move(donor),
            .location = Zone_interface::Location::vertex,
            .is_abutting_one_to_one = true,
            .points = {},
            .donor_points = {},
            .periodicity = std::nullopt};
  }

  /// says which nodes zones have in common, and which are periodic partners.
  void connect_zones()
  {
    struct Use
    {
      Index zone, point;
    };
    std::vector<std::uint8_t> count(mesh_.nodes.size(), 0);
    for (const std::vector<Index>& nodes : nodes_of_zone_)
      for (const Index node : nodes)
        if (count[static_cast<std::size_t>(node)] < 2)
          ++count[static_cast<std::size_t>(node)];
    if (const auto unused = std::count(count.begin(), count.end(), 0); unused > 0)
      notes_.push_back(fmt::format("nodes of no element, left out: {}", unused));
    for (const Periodic_nodes& periodic : mesh_.periodic)
      for (const auto& [a, b] : periodic.pairs)
        count[static_cast<std::size_t>(a)] = count[static_cast<std::size_t>(b)] = 2;
    std::unordered_map<Index, std::vector<Use>> uses;
    for (std::size_t z = 0; z < nodes_of_zone_.size(); ++z)
      for (std::size_t m = 0; m < nodes_of_zone_[z].size(); ++m)
        if (count[static_cast<std::size_t>(nodes_of_zone_[z][m])] > 1)
          uses[nodes_of_zone_[z][m]].push_back({static_cast<Index>(z), static_cast<Index>(m)});

    std::map<std::pair<Index, Index>, Zone_interface> interfaces;
    for (std::size_t z = 0; z < nodes_of_zone_.size(); ++z)
      for (const Index node : nodes_of_zone_[z])
        if (const auto found = uses.find(node); found != uses.end())
          for (const Use& other : found->second)
            if (other.zone > static_cast<Index>(z))
              add_pair(interfaces, found->second, static_cast<Index>(z), other.zone, other.point);
    for (auto& [zones, interface] : interfaces)
      result_.linear.zones[static_cast<std::size_t>(zones.first)].interfaces.push_back(std::move(interface));
    for (std::size_t p = 0; p < mesh_.periodic.size(); ++p)
      add_periodicity(p, uses);
  }

  template <class Uses>
  void add_pair(std::map<std::pair<Index, Index>, Zone_interface>& interfaces, const Uses& uses, Index zone,
                Index other, Index other_point) const
  {
    const auto own = std::find_if(uses.begin(), uses.end(), [&](const auto& use) { return use.zone == zone; });
    const std::string& donor = mesh_.zone_names[static_cast<std::size_t>(other)];
    Zone_interface& interface =
      interfaces.try_emplace({zone, other}, make_interface("to_" + donor, donor)).first->second;
    interface.points.push_back(own->point);
    interface.donor_points.push_back(other_point);
  }

  template <class Uses>
  void add_periodicity(std::size_t number, const Uses& uses)
  {
    std::map<std::pair<Index, Index>, Zone_interface> parts;
    for (const auto& [a, b] : mesh_.periodic[number].pairs)
    {
      const auto first = uses.find(a), second = uses.find(b);
      if (first == uses.end() || second == uses.end())
        continue;
      const auto& own = first->second.front();
      const auto& other = second->second.front();
      Zone_interface& part =
        parts
          .try_emplace({own.zone, other.zone}, make_interface(fmt::format("periodic_{}", number + 1),
                                                              mesh_.zone_names[static_cast<std::size_t>(other.zone)]))
          .first->second;
      part.points.push_back(own.point);
      part.donor_points.push_back(other.point);
    }
    for (auto& [zones, part] : parts)
    {
      part.periodicity = mesh_.periodic[number].map;
      result_.linear.zones[static_cast<std::size_t>(zones.first)].interfaces.push_back(std::move(part));
    }
  }

  void note_empty_patches()
  {
    is_used_.resize(mesh_.patches.size());
    for (std::size_t p = 0; p < mesh_.patches.size(); ++p)
      if (!is_used_[p])
        notes_.push_back(fmt::format("patch '{}' has no faces: left out", mesh_.patches[p].name));
  }

  Grouped_mesh mesh_;
  std::vector<std::string>& notes_;
  Zonal_mesh result_;
  std::vector<Zone_faces> faces_;
  std::vector<Index> local_;
  std::vector<std::vector<Index>> nodes_of_zone_;
  std::vector<bool> is_used_;
};

} // namespace

Zonal_mesh to_zonal_mesh(Grouped_mesh mesh, std::vector<std::string>& notes)
{
  return Zonal_builder(std::move(mesh), notes).build();
}

} // namespace recurve::internal
