// From what an MSH file says to zones and patches.
#include "msh_reading.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

namespace recurve::internal::msh {

namespace {

/// A stated transformation is taken as rigid if its matrix is that much off a rotation: files have 16 digits, users
/// type fewer.
constexpr double rotation_tolerance = 1e-6;

/// Without a stated transformation, partners that differ by one vector up to this part of its length are translated.
constexpr double translation_tolerance = 1e-6;

std::string group_name(const Msh_reading& r, const Group_key& key)
{
  if (const auto name = r.names.find({key.dimension, key.physical}); key.physical != 0 && name != r.names.end())
    return name->second;
  if (key.physical != 0)
    return fmt::format("physical_{}", key.physical);
  return key.dimension == 3 ? "volume" : fmt::format("surface_{}", key.entity);
}

/// names that are all different: two physical groups may have the same one.
class Owner_names
{
public:
  explicit Owner_names(const Msh_reading& r, int dimension)
  {
    std::map<std::pair<int, int>, std::string> sorted; // physical groups by number, the others last
    for (const auto& [key, nodes] : r.groups)
      if (key.dimension == dimension && (dimension == 3 || key.physical != 0))
        sorted[{key.physical == 0, key.physical}] = group_name(r, key);
    for (const auto& [order, name] : sorted)
    {
      numbers_[order.second] = static_cast<Index>(names_.size());
      const bool is_taken = std::find(names_.begin(), names_.end(), name) != names_.end();
      names_.push_back(is_taken ? fmt::format("{}_{}", name, order.second) : name);
    }
  }

  Index number_of(int physical) const { return numbers_.at(physical); }
  const std::vector<std::string>& names() const { return names_; }

private:
  std::map<int, Index> numbers_;
  std::vector<std::string> names_;
};

bool has_two_types(const Msh_reading& r, const Group_key& key)
{
  return std::count_if(r.groups.begin(), r.groups.end(), [&](const auto& other) {
           return other.first.dimension == key.dimension && other.first.physical == key.physical &&
                  other.first.entity == key.entity;
         }) > 1;
}

/// the rigid map of a matrix; none if it is not rigid.
std::optional<Periodicity> rigid_map(const std::vector<double>& m)
{
  const auto at = [&m](std::size_t row, std::size_t column) { return m[4 * row + column]; };
  for (std::size_t a = 0; a < 3; ++a)
    for (std::size_t b = 0; b < 3; ++b)
    {
      double product = a == b ? -1 : 0;
      for (std::size_t c = 0; c < 3; ++c)
        product += at(a, c) * at(b, c);
      if (!(std::abs(product) < rotation_tolerance))
        return std::nullopt;
    }
  const double determinant = at(0, 0) * (at(1, 1) * at(2, 2) - at(1, 2) * at(2, 1)) -
                             at(0, 1) * (at(1, 0) * at(2, 2) - at(1, 2) * at(2, 0)) +
                             at(0, 2) * (at(1, 0) * at(2, 1) - at(1, 1) * at(2, 0));
  if (determinant < 0)
    return std::nullopt;
  Periodicity map;
  map.rotation_angle = {std::atan2(at(2, 1), at(2, 2)), std::asin(std::clamp(-at(2, 0), -1.0, 1.0)),
                        std::atan2(at(1, 0), at(0, 0))};
  map.translation = {at(0, 3), at(1, 3), at(2, 3)};
  return map;
}

/// the translation that takes every master to its partner; none if there is none.
std::optional<Periodicity> translation_of(const Msh_reading& r, const std::vector<std::pair<Index, Index>>& pairs)
{
  if (pairs.empty())
    return std::nullopt;
  Periodicity map;
  for (std::size_t p = 0; p < pairs.size(); ++p)
  {
    const Point& from = r.nodes[static_cast<std::size_t>(pairs[p].first)];
    const Point& to = r.nodes[static_cast<std::size_t>(pairs[p].second)];
    const Point step = {to[0] - from[0], to[1] - from[1], to[2] - from[2]};
    if (p == 0)
      map.translation = step;
    const double length = std::hypot(map.translation[0], map.translation[1], map.translation[2]);
    for (std::size_t axis = 0; axis < 3; ++axis)
      if (!(std::abs(step[axis] - map.translation[axis]) <= translation_tolerance * length))
        return std::nullopt;
  }
  return map;
}

void add_periodic(Msh_reading& r, Grouped_mesh& mesh)
{
  for (const Link_data& link : r.links)
  {
    Periodic_nodes periodic;
    for (const auto& [slave, master] : link.nodes)
    {
      const Index from = r.numbers.find(master), to = r.numbers.find(slave);
      if (from == no_index || to == no_index)
        r.in.fail(
          fmt::format("$Periodic names node {}, which $Nodes does not have", from == no_index ? master : slave));
      periodic.pairs.push_back({from, to});
    }
    const auto map = link.affine.size() == 16 ? rigid_map(link.affine) : translation_of(r, periodic.pairs);
    if (!map)
    {
      r.notes.push_back("a periodic link without a rigid transformation is left out");
      continue;
    }
    periodic.map = *map;
    mesh.periodic.push_back(std::move(periodic));
  }
}

void note_left_out(Msh_reading& r)
{
  if (r.lower_elements > 0)
    r.notes.push_back(fmt::format("points and lines, left out: {}", r.lower_elements));
  if (r.partition_faces > 0)
    r.notes.push_back(fmt::format("faces between partitions, left out: {}", r.partition_faces));
  if (r.in_several_groups > 0)
    r.notes.push_back(
      fmt::format("surfaces and volumes in several physical groups, read into the first: {}", r.in_several_groups));
}

} // namespace

Grouped_mesh make_groups(Msh_reading& r)
{
  note_left_out(r);
  Grouped_mesh mesh;
  mesh.degree = std::max(1, r.degree);
  const Owner_names zones(r, 3), patches(r, 2);
  mesh.zone_names = zones.names();
  for (const std::string& name : patches.names())
    mesh.patches.push_back({.name = name, .kind = "BCTypeUserDefined", .family = {}, .faces = {}});
  add_periodic(r, mesh);
  mesh.nodes = std::move(r.nodes);
  for (auto& [key, nodes] : r.groups)
  {
    if (nodes.empty())
      continue;
    const std::string type(element_name(key.type));
    if (key.dimension == 3)
      mesh.cells.push_back({zones.number_of(key.physical), type, key.type, std::move(nodes)});
    else
      mesh.faces.push_back({key.physical == 0 ? no_index : patches.number_of(key.physical),
                            has_two_types(r, key) ? fmt::format("{}_{}", group_name(r, key), type) : group_name(r, key),
                            key.type, std::move(nodes)});
  }
  return mesh;
}

} // namespace recurve::internal::msh
