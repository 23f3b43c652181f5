#include "cgns_reading.h"

#include <fmt/format.h>

#include <algorithm>
#include <unordered_set>

namespace recurve::internal::cgns {

namespace {

/// Counts of what a boundary condition named besides faces, for one note per condition.
struct Leftovers
{
  Index not_faces = 0; ///< cells, bars, nodes
  Index taken = 0;     ///< faces that an earlier condition has
};

/// The boundary conditions of one zone while they become patches.
struct Patch_reading
{
  Cgns_reading& reading;
  Zone_reading& zone;
  std::vector<Patch> patches = {};       ///< one per BC_t, faces empty until the end
  std::vector<Index> patch_of_face = {}; ///< per face of the zone, no_index: none yet
  std::vector<Vertex_patch> by_points = {};
  std::vector<std::string> where = {};             ///< per patch, for messages
  std::vector<bool> is_left_out = {};              ///< per patch: a note already says why it has no faces
  std::unordered_set<Index> structured_faces = {}; ///< the faces of a structured zone that have a patch

  void note(std::size_t patch, std::string_view text)
  {
    reading.notes.push_back(fmt::format("{}: {}", where[patch], text));
  }
};

std::string condition_kind(const std::string& text)
{
  if (text.empty() || text == "Null")
    return "BCTypeNull";
  return text == "UserDefined" ? "BCTypeUserDefined" : text;
}

void take_face(Patch_reading& r, std::size_t patch, Index face, Leftovers& leftovers)
{
  Index& owner = r.patch_of_face[static_cast<std::size_t>(face)];
  if (owner == no_index)
    owner = static_cast<Index>(patch);
  else if (owner != static_cast<Index>(patch))
    ++leftovers.taken;
}

void note_leftovers(Patch_reading& r, std::size_t patch, const Leftovers& leftovers)
{
  if (leftovers.not_faces > 0)
    r.note(patch, fmt::format("elements that are no faces, left out: {}", leftovers.not_faces));
  if (leftovers.taken > 0)
    r.note(patch, fmt::format("faces that an earlier boundary condition has already: {}", leftovers.taken));
}

/// a condition whose set names elements.
void add_elements(Patch_reading& r, std::size_t patch, const Point_set& set)
{
  const Cgns_tree& tree = r.reading.tree;
  if (set.is_range && set.values.size() != 2)
    tree.fail(fmt::format("{}: an element range of {} numbers", r.where[patch], set.values.size()));
  Leftovers leftovers;
  const auto add = [&](Index element) {
    const Index face = face_of_element(tree, r.zone, element, r.where[patch]);
    if (face == no_index)
      ++leftovers.not_faces;
    else
      take_face(r, patch, face, leftovers);
  };
  if (!set.is_range)
    std::for_each(set.values.begin(), set.values.end(), add);
  else
    for (Index element = set.values[0]; element <= set.values[1]; ++element)
      add(element); // ends at the first element that is not there
  note_leftovers(r, patch, leftovers);
  r.is_left_out[patch] = leftovers.not_faces + leftovers.taken > 0;
}

/// Whether a set that claims to name points can only mean elements: a frequent mistake is a missing GridLocation.
bool means_elements(const Zone_reading& zone, const Point_set& set)
{
  if (zone.is_structured || set.values.empty() || zone.blocks.empty())
    return false;
  const auto [low, high] = std::minmax_element(set.values.begin(), set.values.end());
  return *high > zone.point_count() && *low >= zone.blocks.front().first && *high <= zone.blocks.back().last;
}

void add_structured_faces(Patch_reading& r, std::size_t patch, const std::vector<std::array<Index, 4>>& faces)
{
  Zone& zone = r.zone.zone;
  Section section = {
    .name = section_names(zone).take(r.patches[patch].name), .type = Element_type::quadrangle, .nodes = {}};
  Leftovers leftovers;
  for (const std::array<Index, 4>& face : faces)
  {
    // No two faces of the zone share their smallest and their largest corner.
    const auto [low, high] = std::minmax_element(face.begin(), face.end());
    if (r.structured_faces.insert(*low * r.zone.point_count() + *high).second)
      section.nodes.insert(section.nodes.end(), face.begin(), face.end());
    else
      ++leftovers.taken;
  }
  r.patch_of_face.resize(r.patch_of_face.size() + static_cast<std::size_t>(section.size()), static_cast<Index>(patch));
  if (section.size() > 0)
    zone.faces.push_back(std::move(section));
  note_leftovers(r, patch, leftovers);
  r.is_left_out[patch] = leftovers.taken > 0;
}

void add_condition(Patch_reading& r, const Cgns_node& node)
{
  const Cgns_tree& tree = r.reading.tree;
  const std::size_t patch = r.patches.size();
  r.patches.push_back({.name = node.name(),
                       .kind = condition_kind(tree.read_text(node)),
                       .family = text_of(tree, node, "FamilyName_t"),
                       .faces = {}});
  r.where.push_back(fmt::format("zone '{}', boundary condition '{}'", r.zone.zone.name, node.name()));
  r.is_left_out.push_back(false);
  const auto set = read_point_set(tree, node, {"PointList", "PointRange", "ElementList", "ElementRange"});
  const std::string location = text_of(tree, node, "GridLocation_t");
  if (!set || set->values.empty())
  {
    r.note(patch, "names no points or elements: left out");
    r.is_left_out[patch] = true;
    return;
  }
  if (location == "EdgeCenter")
  {
    r.note(patch, "is on edges: left out");
    r.is_left_out[patch] = true;
    return;
  }
  const bool is_vertex = !set->is_element && (location.empty() || location == "Vertex");
  if (r.zone.is_structured && set->is_range)
  {
    add_structured_faces(r, patch, structured_faces(tree, r.zone, *set, location, r.where[patch]));
    return;
  }
  if (is_vertex && !means_elements(r.zone, *set))
  {
    r.by_points.push_back({.patch = static_cast<Index>(patch),
                           .name = r.patches[patch].name,
                           .family = r.patches[patch].family,
                           .points = points_of(tree, r.zone, *set, r.where[patch])});
    return;
  }
  if (r.zone.is_structured)
  {
    r.note(patch, fmt::format("a list at {} in a structured zone is not understood: left out",
                              set->is_element ? "elements" : location));
    r.is_left_out[patch] = true;
    return;
  }
  if (is_vertex)
    r.note(patch, "names points that do not exist but elements do: read as elements");
  if (location == "CellCenter")
    r.note(patch, "is on cells (CellCenter): read as element numbers, of which the faces count");
  add_elements(r, patch, *set);
}

} // namespace

std::optional<Point_set> read_point_set(const Cgns_tree& tree, const Cgns_node& node,
                                        std::initializer_list<std::string_view> names)
{
  for (const Cgns_node& child : tree.children(node))
  {
    if (std::find(names.begin(), names.end(), child.name()) == names.end())
      continue;
    Point_set set;
    set.is_range = child.name().find("Range") != std::string::npos;
    set.is_element = child.name().starts_with("Element");
    set.values = tree.read_integers(child);
    return set;
  }
  return std::nullopt;
}

std::vector<Index> points_of(const Cgns_tree& tree, const Zone_reading& zone, const Point_set& set,
                             std::string_view what)
{
  const auto check = [&](Index number, Index count) {
    if (number < 1 || number > count)
      tree.fail(fmt::format("{} names point {}, outside 1..{}", what, number, count));
  };
  std::vector<Index> points;
  if (zone.is_structured && set.is_range)
  {
    if (set.values.size() != 6)
      tree.fail(fmt::format("{}: a range of {} numbers in a structured zone", what, set.values.size()));
    for (std::size_t m = 0; m < 6; ++m)
      check(set.values[m], zone.size[m % 3]);
    for (Index k = set.values[2]; k <= set.values[5]; ++k)
      for (Index j = set.values[1]; j <= set.values[4]; ++j)
        for (Index i = set.values[0]; i <= set.values[3]; ++i)
          points.push_back(zone.point_at(i - 1, j - 1, k - 1));
    return points;
  }
  if (zone.is_structured)
  {
    if (set.values.size() % 3 != 0)
      tree.fail(fmt::format("{}: {} numbers are no list of (i, j, k)", what, set.values.size()));
    for (std::size_t m = 0; m < set.values.size(); m += 3)
    {
      for (std::size_t d = 0; d < 3; ++d)
        check(set.values[m + d], zone.size[d]);
      points.push_back(zone.point_at(set.values[m] - 1, set.values[m + 1] - 1, set.values[m + 2] - 1));
    }
    return points;
  }
  for (const Index number : set.values)
    check(number, zone.point_count());
  if (!set.is_range)
    for (const Index number : set.values)
      points.push_back(number - 1);
  else if (set.values.size() == 2)
    for (Index number = set.values[0]; number <= set.values[1]; ++number)
      points.push_back(number - 1);
  else
    tree.fail(fmt::format("{}: a point range of {} numbers", what, set.values.size()));
  return points;
}

void read_patches(Cgns_reading& reading, Zone_reading& zone)
{
  const Cgns_tree& tree = reading.tree;
  const auto conditions = tree.child_with_label(zone.node, "ZoneBC_t");
  if (!conditions)
    return;
  Patch_reading r = {.reading = reading, .zone = zone};
  r.patch_of_face.assign(static_cast<std::size_t>(zone.zone.face_count()), no_index);
  for (const Cgns_node& node : tree.children(*conditions, "BC_t"))
    add_condition(r, node);
  for (Vertex_patch& patch : r.by_points)
  {
    std::sort(patch.points.begin(), patch.points.end());
    patch.points.erase(std::unique(patch.points.begin(), patch.points.end()), patch.points.end());
  }
  match_vertex_patches(zone.zone, r.by_points, r.patch_of_face, reading.notes);

  for (std::size_t face = 0; face < r.patch_of_face.size(); ++face)
    if (const Index patch = r.patch_of_face[face]; patch != no_index)
      r.patches[static_cast<std::size_t>(patch)].faces.push_back(static_cast<Index>(face));
  for (std::size_t p = 0; p < r.patches.size(); ++p)
    if (!r.patches[p].faces.empty())
      zone.zone.patches.push_back(std::move(r.patches[p]));
    else if (!r.is_left_out[p])
      r.note(p, "has no face of the zone: left out");
}

} // namespace recurve::internal::cgns
