#include "cgns_reading.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace recurve::internal::cgns {

namespace {

/// The connection that is being read, and where it stands for messages.
struct Interface_reading
{
  Cgns_reading& reading;
  const Zone_reading& zone;
  const Cgns_node& node;
  std::string where;

  void note(std::string_view text) const { reading.notes.push_back(fmt::format("{}: {}", where, text)); }
};

/// The donor is "zone" or "base/zone".
const Zone_reading* find_donor(const Cgns_reading& reading, std::string name, const std::string& base)
{
  if (name.starts_with(base + "/"))
    name.erase(0, base.size() + 1);
  for (const Zone_reading& zone : reading.zones)
    if (zone.zone.name == name)
      return &zone;
  return nullptr;
}

Point read_vector(const Interface_reading& r, const Cgns_node& parent, std::string_view name)
{
  const auto node = r.reading.tree.child(parent, name);
  Point result = {};
  if (!node)
    return result;
  const std::vector<double> values = r.reading.tree.read_reals(*node);
  if (values.size() != 3)
    r.reading.tree.fail(fmt::format("{}: {} has {} components", r.where, name, values.size()));
  std::copy(values.begin(), values.end(), result.begin());
  return result;
}

std::optional<Periodicity> read_periodicity(const Interface_reading& r)
{
  const Cgns_tree& tree = r.reading.tree;
  const auto property = tree.child_with_label(r.node, "GridConnectivityProperty_t");
  const auto periodic = property ? tree.child_with_label(*property, "Periodic_t") : nullptr;
  if (!periodic)
    return std::nullopt;
  Periodicity result;
  result.rotation_center = read_vector(r, *periodic, "RotationCenter");
  result.rotation_angle = read_vector(r, *periodic, "RotationAngle");
  result.translation = read_vector(r, *periodic, "Translation");
  bool in_degrees = r.reading.angles_in_degrees;
  if (const auto angle = tree.child(*periodic, "RotationAngle"))
    for (const Cgns_node* node : {&*periodic, &*angle})
      if (const auto units = tree.child_with_label(*node, "DimensionalUnits_t"))
        in_degrees = tree.read_text(*units).find("Degree") != std::string::npos;
  if (in_degrees)
    for (double& angle : result.rotation_angle)
      angle *= std::numbers::pi / 180;
  return result;
}

/// the faces that an element list names; empty if one of them is no face.
std::vector<Index> faces_in(const Interface_reading& r, const Zone_reading& zone, const Point_set& set)
{
  std::vector<Index> faces;
  const auto add = [&](Index element) { faces.push_back(face_of_element(r.reading.tree, zone, element, r.where)); };
  if (!set.is_range)
    std::for_each(set.values.begin(), set.values.end(), add);
  else if (set.values.size() == 2)
    for (Index element = set.values[0]; element <= set.values[1]; ++element)
      add(element);
  if (std::find(faces.begin(), faces.end(), no_index) != faces.end())
    faces.clear();
  return faces;
}

/// pairs the points of two index boxes of structured zones; `transform` says which donor direction each direction of
/// the zone runs along, with its sign (SIDS 8.2).
void pair_structured(const Interface_reading& r, const Zone_reading& donor, const std::vector<std::int64_t>& range,
                     const std::vector<std::int64_t>& donor_range, const std::vector<std::int64_t>& transform,
                     Zone_interface& result)
{
  const Cgns_tree& tree = r.reading.tree;
  const auto refuse = [&]() { tree.fail(fmt::format("{}: ranges and transform do not fit together", r.where)); };
  std::array<bool, 3> is_used = {};
  std::array<Index, 3> step = {}, count = {};
  for (std::size_t d = 0; d < 3; ++d)
  {
    const auto target = static_cast<std::size_t>(std::abs(transform[d])) - 1;
    if (target > 2 || is_used[target])
      refuse();
    is_used[target] = true;
    step[d] = range[d + 3] >= range[d] ? 1 : -1;
    count[d] = std::abs(range[d + 3] - range[d]) + 1;
    if (std::min(range[d], range[d + 3]) < 1 || std::max(range[d], range[d + 3]) > r.zone.size[d])
      refuse();
  }
  for (Index k = 0; k < count[2]; ++k)
    for (Index j = 0; j < count[1]; ++j)
      for (Index i = 0; i < count[0]; ++i)
      {
        const std::array<Index, 3> along = {i * step[0], j * step[1], k * step[2]};
        std::array<Index, 3> here = {}, there = {donor_range[0], donor_range[1], donor_range[2]};
        for (std::size_t d = 0; d < 3; ++d)
        {
          here[d] = range[d] + along[d];
          const auto target = static_cast<std::size_t>(std::abs(transform[d])) - 1;
          there[target] += transform[d] > 0 ? along[d] : -along[d];
        }
        for (std::size_t d = 0; d < 3; ++d)
          if (there[d] < 1 || there[d] > donor.size[d])
            refuse();
        result.points.push_back(r.zone.point_at(here[0] - 1, here[1] - 1, here[2] - 1));
        result.donor_points.push_back(donor.point_at(there[0] - 1, there[1] - 1, there[2] - 1));
      }
}

/// GridConnectivity1to1_t
void read_one_to_one(const Interface_reading& r, const Zone_reading& donor, Zone_interface& result)
{
  const Cgns_tree& tree = r.reading.tree;
  const auto range = read_point_set(tree, r.node, {"PointRange"});
  const auto donor_range = read_point_set(tree, r.node, {"PointRangeDonor"});
  std::vector<std::int64_t> transform = {1, 2, 3}; // the SIDS' default
  if (const auto node = tree.child(r.node, "Transform"))
    transform = tree.read_integers(*node);
  if (!range || !donor_range)
    tree.fail(fmt::format("{} has no PointRange or no PointRangeDonor", r.where));
  if (r.zone.is_structured && donor.is_structured)
  {
    if (range->values.size() != 6 || donor_range->values.size() != 6 || transform.size() != 3)
      tree.fail(fmt::format("{}: ranges and transform are not those of 3D zones", r.where));
    pair_structured(r, donor, range->values, donor_range->values, transform, result);
    return;
  }
  if (r.zone.is_structured || donor.is_structured)
    tree.fail(fmt::format("{}: a 1to1 range between a structured and an unstructured zone", r.where));
  result.points = points_of(tree, r.zone, *range, r.where);
  result.donor_points = points_of(tree, donor, *donor_range, r.where);
}

/// GridConnectivity_t. Leaves the points empty, with a note, where the two sides are not paired one to one.
void read_general(const Interface_reading& r, const Zone_reading& donor, Zone_interface& result)
{
  const Cgns_tree& tree = r.reading.tree;
  const std::string type = text_of(tree, r.node, "GridConnectivityType_t");
  result.is_abutting_one_to_one = type == "Abutting1to1";
  if (!result.is_abutting_one_to_one)
  {
    r.note(fmt::format("is of type {}, kept as a name only", type.empty() ? "Overset" : type));
    return;
  }
  const auto set = read_point_set(tree, r.node, {"PointList", "PointRange"});
  const auto donor_set = read_point_set(tree, r.node, {"PointListDonor", "PointRangeDonor"});
  const std::string location = text_of(tree, r.node, "GridLocation_t");
  if (set && donor_set && (location.empty() || location == "Vertex"))
  {
    result.points = points_of(tree, r.zone, *set, r.where);
    result.donor_points = points_of(tree, donor, *donor_set, r.where);
  }
  else if (set && donor_set && location == "FaceCenter" && !r.zone.is_structured && !donor.is_structured)
  {
    result.location = Zone_interface::Location::face;
    result.points = faces_in(r, r.zone, *set);
    result.donor_points = faces_in(r, donor, *donor_set);
  }
  if (result.points.empty() || result.points.size() != result.donor_points.size())
  {
    r.note(fmt::format("names {} points or faces and {} of the donor, which cannot be paired: kept as a name only",
                       set ? set->values.size() : 0, donor_set ? donor_set->values.size() : 0));
    result.is_abutting_one_to_one = false;
    result.points.clear();
    result.donor_points.clear();
  }
}

} // namespace

void read_interfaces(Cgns_reading& reading, const std::string& base_name)
{
  const Cgns_tree& tree = reading.tree;
  for (Zone_reading& zone : reading.zones)
    for (const Cgns_node& group : tree.children(zone.node, "ZoneGridConnectivity_t"))
      for (const Cgns_node& node : tree.children(group))
      {
        const bool is_one_to_one = node.label() == "GridConnectivity1to1_t";
        if (!is_one_to_one && node.label() != "GridConnectivity_t")
          continue;
        const Interface_reading r = {reading, zone, node,
                                     fmt::format("zone '{}', connection '{}'", zone.zone.name, node.name())};
        const std::string donor_name = tree.read_text(node);
        const Zone_reading* donor = find_donor(reading, donor_name, base_name);
        if (donor == nullptr)
        {
          r.note(fmt::format("its donor '{}' is no zone: left out", donor_name));
          continue;
        }
        Zone_interface result = {.name = node.name(),
                                 .donor_zone = donor->zone.name,
                                 .location = Zone_interface::Location::vertex,
                                 .is_abutting_one_to_one = true,
                                 .points = {},
                                 .donor_points = {},
                                 .periodicity = read_periodicity(r)};
        if (is_one_to_one)
          read_one_to_one(r, *donor, result);
        else
          read_general(r, *donor, result);
        zone.zone.interfaces.push_back(std::move(result));
      }
}

} // namespace recurve::internal::cgns
