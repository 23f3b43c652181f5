#include "hopr_sides.h"

#include "hilbert_order.h"

#include <recurve/core/exceptions.h>
#include <recurve/elements/node_layout.h>

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <limits>
#include <map>
#include <unordered_map>

namespace recurve::internal::hopr {

// Elements along the curve.
// --------------------------------------------------------------------------------------------

Ordered_cells::Ordered_cells(const Curved_mesh& mesh) : degree_(mesh.degree)
{
  for (std::size_t z = 0; z < mesh.zones.size(); ++z)
    for (const Curved_section& section : mesh.zones[z].cells)
    {
      blocks_.push_back({static_cast<Index>(barycentres_.size()), z, &section});
      const auto width = static_cast<std::size_t>(node_count(section.type, degree_));
      for (std::size_t first = 0; first < section.nodes.size(); first += width)
      {
        Point sum = {};
        const auto corners = static_cast<std::size_t>(corner_count(section.type));
        for (std::size_t m = first; m < first + corners; ++m)
          for (std::size_t axis = 0; axis < 3; ++axis)
            sum[axis] += mesh.nodes[static_cast<std::size_t>(section.nodes[m])][axis];
        for (double& coordinate : sum)
          coordinate /= static_cast<double>(corners);
        barycentres_.push_back(sum);
      }
    }
  order_ = hilbert_order(barycentres_);
}

std::size_t Ordered_cells::block_of(Index element) const
{
  const Index cell = order_[static_cast<std::size_t>(element)];
  const auto after = std::upper_bound(blocks_.begin(), blocks_.end(), cell,
                                      [](Index number, const Block& block) { return number < block.first; });
  return static_cast<std::size_t>(after - blocks_.begin()) - 1;
}

std::span<const Index> Ordered_cells::nodes(Index element) const
{
  const Block& block = blocks_[block_of(element)];
  const auto width = static_cast<std::size_t>(node_count(block.section->type, degree_));
  const auto cell = static_cast<std::size_t>(order_[static_cast<std::size_t>(element)] - block.first);
  return std::span(block.section->nodes).subspan(cell * width, width);
}

// Sides.
// ---------------------------------------------------------------------------------------------------------------

namespace {

/// The corners of a side, outward; a triangle's fourth is no_index.
struct Corners
{
  std::array<Index, 4> nodes = {no_index, no_index, no_index, no_index};
  int count = 3;

  std::array<Index, 4> key() const
  {
    std::array<Index, 4> sorted = nodes;
    std::sort(sorted.begin(), sorted.end());
    return sorted;
  }
};

struct Key_hash
{
  std::size_t operator()(const std::array<Index, 4>& key) const
  {
    std::uint64_t hash = 0;
    for (const Index node : key)
      hash = (hash ^ static_cast<std::uint64_t>(node)) * 0x9E3779B97F4A7C15U;
    return static_cast<std::size_t>(hash ^ (hash >> 32));
  }
};

template <class Value>
using Face_map = std::unordered_map<std::array<Index, 4>, Value, Key_hash>;

/// An element and its side as one number.
using Entry = Index;
constexpr Entry entry_of(Index element, int side)
{
  return 8 * element + side;
}

class Side_connector
{
public:
  Side_connector(const Curved_mesh& mesh, const Ordered_cells& cells) : mesh_(mesh), cells_(cells) {}

  Side_table connect()
  {
    count_sides();
    connect_inside();
    name_conditions();
    connect_periodic();
    number_sides();
    return std::move(table_);
  }

private:
  static int side_count(Element_type type) { return reference_element(type).face_count; }

  Corners corners(Entry entry) const
  {
    const Reference_face& face = reference_element(cells_.type(entry / 8)).faces[static_cast<std::size_t>(entry % 8)];
    const std::span<const Index> nodes = cells_.nodes(entry / 8);
    Corners result;
    result.count = face.corner_count;
    for (std::size_t c = 0; c < static_cast<std::size_t>(face.corner_count); ++c)
      result.nodes[c] = nodes[static_cast<std::size_t>(face.corners[c])];
    return result;
  }

  Side& side(Entry entry)
  {
    return table_.sides[static_cast<std::size_t>(table_.first_side[static_cast<std::size_t>(entry / 8)] + entry % 8)];
  }

  template <class Visit>
  void visit_sides(const Visit& visit) const
  {
    for (Index element = 0; element < cells_.count(); ++element)
      for (int s = 0; s < side_count(cells_.type(element)); ++s)
        visit(entry_of(element, s));
  }

  void count_sides()
  {
    table_.first_side.push_back(0);
    Index nodes = 0;
    for (Index element = 0; element < cells_.count(); ++element)
    {
      table_.first_side.push_back(table_.first_side.back() + side_count(cells_.type(element)));
      nodes += node_count(cells_.type(element), mesh_.degree);
    }
    check_counts(nodes, table_.first_side.back());
    table_.sides.resize(static_cast<std::size_t>(table_.first_side.back()));
  }

  /// matches the sides of each bucket, which have their smallest corner in common.
  void connect_inside()
  {
    std::vector<Index> begin(mesh_.nodes.size() + 1, 0);
    const auto bucket_of = [this](Entry entry) {
      const Corners own = corners(entry);
      return static_cast<std::size_t>(*std::min_element(own.nodes.begin(), own.nodes.begin() + own.count));
    };
    visit_sides([&](Entry entry) { ++begin[bucket_of(entry) + 1]; });
    for (std::size_t b = 1; b < begin.size(); ++b)
      begin[b] += begin[b - 1];
    std::vector<Entry> entries(static_cast<std::size_t>(begin.back()));
    {
      std::vector<Index> next(begin.begin(), begin.end() - 1);
      visit_sides([&](Entry entry) { entries[static_cast<std::size_t>(next[bucket_of(entry)]++)] = entry; });
    }
    std::vector<std::pair<std::array<Index, 4>, Entry>> bucket;
    for (std::size_t b = 0; b + 1 < begin.size(); ++b)
    {
      bucket.clear();
      for (Index m = begin[b]; m < begin[b + 1]; ++m)
        bucket.push_back({corners(entries[static_cast<std::size_t>(m)]).key(), entries[static_cast<std::size_t>(m)]});
      std::sort(bucket.begin(), bucket.end());
      for (std::size_t first = 0; first < bucket.size();)
      {
        std::size_t last = first + 1;
        while (last < bucket.size() && bucket[last].first == bucket[first].first)
          ++last;
        if (last - first > 2)
          throw Input_error(fmt::format("cells overlap: {} cells have the side with corners {}", last - first,
                                        corner_text(bucket[first].second)));
        if (last - first == 2)
          pair(bucket[first].second, bucket[first + 1].second, corners(bucket[first].second));
        first = last;
      }
    }
  }

  std::string corner_text(Entry entry) const
  {
    const Corners own = corners(entry);
    std::string text;
    for (int c = 0; c < own.count; ++c)
      text += fmt::format("{}{}", c == 0 ? "" : ", ", own.nodes[static_cast<std::size_t>(c)] + 1);
    return text;
  }

  /// connects side `a` with `b`, whose corners are those of `images`: the corners of `a`, or where a periodic map takes
  /// them. Seen from outside, one goes round the other way.
  void pair(Entry a, Entry b, const Corners& images)
  {
    const Corners other = corners(b);
    const auto place = [&](Index node) {
      return static_cast<int>(std::find(other.nodes.begin(), other.nodes.begin() + other.count, node) -
                              other.nodes.begin());
    };
    const int first = place(images.nodes[0]);
    if (place(images.nodes[1]) != (first + other.count - 1) % other.count)
      throw Input_error(fmt::format("two cells are on the same side of their common face with corners {}: they overlap or one "
                                    "of them is inside out",
                                    corner_text(a)));
    const auto set = [](Side& own, Entry neighbor, int flip) {
      own.neighbor = static_cast<std::int32_t>(neighbor / 8 + 1);
      own.neighbor_side = static_cast<std::int8_t>(neighbor % 8 + 1);
      own.flip = static_cast<std::int8_t>(flip);
    };
    // The flip is the same from both sides: corner m of one is corner first - m of the other.
    set(side(a), b, first + 1);
    set(side(b), a, first + 1);
  }

  // Boundary conditions.
  // -----------------------------------------------------------------------------------------------

  std::int16_t condition_named(const std::string& name, std::int32_t type)
  {
    for (std::size_t c = 0; c < table_.conditions.size(); ++c)
      if (table_.conditions[c].name == name && (table_.conditions[c].type[0] == 100) == (type == 100))
        return static_cast<std::int16_t>(c + 1);
    if (table_.conditions.size() >= static_cast<std::size_t>(std::numeric_limits<std::int16_t>::max()))
      throw Input_error("more than 32767 boundary conditions");
    const bool is_taken = std::any_of(table_.conditions.begin(), table_.conditions.end(),
                                      [&](const Condition& condition) { return condition.name == name; });
    table_.conditions.push_back({is_taken ? name + "_inner" : name, {type, mesh_.degree > 1 ? 1 : 0, 0, 0}});
    return static_cast<std::int16_t>(table_.conditions.size());
  }

  static std::int32_t type_of(const std::string& kind)
  {
    if (kind == "BCWall" || kind.starts_with("BCWallViscous"))
      return 3;
    return kind == "BCWallInviscid" || kind.starts_with("BCSymmetry") ? 9 : 2;
  }

  void name_conditions()
  {
    struct Listed
    {
      const Patch* patch;
      bool is_found = false;
    };
    Face_map<Listed> listed;
    for (std::size_t z = 0; z < mesh_.zones.size(); ++z)
      list_faces(z,
                 [&](const std::array<Index, 4>& key, const Patch& patch) { listed.try_emplace(key, Listed{&patch}); });
    visit_sides([&](Entry entry) {
      if (side(entry).neighbor != 0)
        return;
      const auto found = listed.find(corners(entry).key());
      if (found == listed.end())
      {
        unassigned_.push_back(entry);
        return;
      }
      found->second.is_found = true;
      side(entry).condition = condition_named(found->second.patch->name, type_of(found->second.patch->kind));
      boundary_.push_back(entry);
    });
    const bool has_inner =
      std::any_of(listed.begin(), listed.end(), [](const auto& entry) { return !entry.second.is_found; });
    if (has_inner)
      visit_sides([&](Entry entry) {
        if (side(entry).neighbor == 0)
          return;
        if (const auto found = listed.find(corners(entry).key()); found != listed.end())
          side(entry).condition = condition_named(found->second.patch->name, 100);
      });
  }

  template <class Visit>
  void list_faces(std::size_t z, const Visit& visit) const
  {
    const Zone& linear = mesh_.linear.zones[z];
    std::vector<const Patch*> patch_of(static_cast<std::size_t>(linear.face_count()), nullptr);
    for (const Patch& patch : linear.patches)
      for (const Index face : patch.faces)
        patch_of[static_cast<std::size_t>(face)] = &patch;
    std::size_t number = 0;
    for (const Curved_section& section : mesh_.zones[z].faces)
    {
      const auto width = static_cast<std::size_t>(node_count(section.type, mesh_.degree));
      Corners own;
      own.count = corner_count(section.type);
      for (std::size_t first = 0; first < section.nodes.size(); first += width, ++number)
      {
        if (patch_of[number] == nullptr)
          continue;
        std::copy_n(section.nodes.begin() + static_cast<std::ptrdiff_t>(first), own.count, own.nodes.begin());
        visit(own.key(), *patch_of[number]);
      }
    }
  }

  // Periodic sides.
  // ----------------------------------------------------------------------------------------------------

  void connect_periodic()
  {
    Face_map<Entry> sides;
    std::int32_t number = 0;
    for (std::size_t z = 0; z < mesh_.zones.size(); ++z)
      for (const Zone_interface& interface : mesh_.linear.zones[z].interfaces)
      {
        const auto donor = std::find_if(mesh_.linear.zones.begin(), mesh_.linear.zones.end(),
                                        [&](const Zone& zone) { return zone.name == interface.donor_zone; });
        if (!interface.periodicity || interface.location != Zone_interface::Location::vertex ||
            donor == mesh_.linear.zones.end())
          continue;
        if (sides.empty())
          for (const auto* group : {&boundary_, &unassigned_})
            for (const Entry entry : *group)
              sides.emplace(corners(entry).key(), entry);
        const auto d = static_cast<std::size_t>(donor - mesh_.linear.zones.begin());
        std::unordered_map<Index, Index> image;
        for (std::size_t m = 0; m < std::min(interface.points.size(), interface.donor_points.size()); ++m)
          image.emplace(mesh_.zones[z].nodes[static_cast<std::size_t>(interface.points[m])],
                        mesh_.zones[d].nodes[static_cast<std::size_t>(interface.donor_points[m])]);
        if (connect_periodic(sides, image, number + 1))
          ++number;
      }
    for (const Entry entry : unassigned_)
      side(entry).condition = condition_named("unassigned", 2);
    name_periodic();
  }

  bool connect_periodic(const Face_map<Entry>& sides, const std::unordered_map<Index, Index>& image,
                        std::int32_t number)
  {
    bool has_sides = false;
    for (const auto* group : {&boundary_, &unassigned_})
      for (const Entry entry : *group)
      {
        Corners images = corners(entry);
        bool is_whole = true;
        for (std::size_t c = 0; c < static_cast<std::size_t>(images.count) && is_whole; ++c)
        {
          const auto found = image.find(images.nodes[c]);
          is_whole = found != image.end();
          if (is_whole)
            images.nodes[c] = found->second;
        }
        const auto other = is_whole ? sides.find(images.key()) : sides.end();
        if (other == sides.end() || side(entry).neighbor != 0 || side(other->second).neighbor != 0 ||
            other->second == entry)
          continue;
        pair(entry, other->second, images);
        periodic_.push_back({entry, number});
        periodic_.push_back({other->second, -number});
        has_sides = true;
      }
    return has_sides;
  }

  /// A condition all of whose sides are periodic in one way is so itself; else its periodic sides get one of their own.
  void name_periodic()
  {
    std::vector<Index> total(table_.conditions.size() + 1, 0);
    for (const auto* group : {&boundary_, &unassigned_})
      for (const Entry entry : *group)
        ++total[static_cast<std::size_t>(side(entry).condition)];
    std::map<std::pair<std::int16_t, std::int32_t>, Index> counts;
    for (const auto& [entry, index] : periodic_)
      ++counts[{side(entry).condition, index}];
    std::map<std::pair<std::int16_t, std::int32_t>, std::int16_t> conditions;
    for (const auto& [key, count] : counts)
    {
      auto [condition, index] = key;
      if (count < total[static_cast<std::size_t>(condition)])
      {
        const std::string& name = table_.conditions[static_cast<std::size_t>(condition - 1)].name;
        table_.conditions.push_back(
          {fmt::format("{}_periodic_{}{}", name, index < 0 ? "minus_" : "", std::abs(index)), {}});
        condition = static_cast<std::int16_t>(table_.conditions.size());
      }
      table_.conditions[static_cast<std::size_t>(condition - 1)].type = {1, mesh_.degree > 1 ? 1 : 0, 0, index};
      conditions.emplace(key, condition);
    }
    for (const auto& [entry, index] : periodic_)
      side(entry).condition = conditions.at({side(entry).condition, index});
  }

  void number_sides()
  {
    std::int32_t next = 0;
    visit_sides([&](Entry entry) {
      Side& own = side(entry);
      const Entry other = entry_of(own.neighbor - 1, own.neighbor_side - 1);
      own.global_id = own.neighbor == 0 || other > entry ? ++next : -side(other).global_id;
    });
    table_.unique_count = next;
  }

  const Curved_mesh& mesh_;
  const Ordered_cells& cells_;
  Side_table table_;
  std::vector<Entry> boundary_, unassigned_;             ///< sides of one cell, in a patch and in none
  std::vector<std::pair<Entry, std::int32_t>> periodic_; ///< sides and the index of their connection, with its sign
};

} // namespace

Side_table connect_sides(const Curved_mesh& mesh, const Ordered_cells& cells)
{
  return Side_connector(mesh, cells).connect();
}

void check_counts(Index nodes, Index sides)
{
  constexpr Index most = std::numeric_limits<std::int32_t>::max();
  if (nodes > most || sides > most)
    throw Input_error(fmt::format("HOPR's format counts with 32 bits: {} nodes and {} sides, counted per element, are "
                                  "more than it can hold",
                                  nodes, sides));
}

} // namespace recurve::internal::hopr
