#ifndef RECURVE_VOLUME_INTERNAL_WALL_RELIEF_H
#define RECURVE_VOLUME_INTERNAL_WALL_RELIEF_H

#include <recurve/core/types.h>
#include <recurve/elements/element.h>
#include <recurve/elements/node_layout.h>
#include <recurve/volume/internal/lone_cell.h>
#include <recurve/volume/internal/restoration_cells.h>
#include <recurve/volume/internal/wall_parts.h>
#include <recurve/volume/restoration_report.h>

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <map>
#include <set>
#include <span>
#include <unordered_map>
#include <utility>
#include <vector>

namespace recurve::internal {

/// Lowers as little as possible of a curved boundary for cells that no motion of nodes inside the volume makes valid:
/// for each of them the edges and insides of faces on the wall are found that cost the fewest faces their curvature,
/// and the mildest step, such that the cell could be valid with its inner nodes anywhere. That its neighbours allow it
/// is not asked here: the repair of the interior, which has to follow, finds out.
///
/// \tparam Levels  `Curving_levels`. \tparam IsValid  callable (cell, position of a node) -> bool.
template <class Levels, class IsValid>
class Wall_relief
{
public:
  Wall_relief(const Restoration_cells& cells, Levels& levels, std::span<const Node_role> roles, const IsValid& is_valid)
    : cells_(cells), levels_(levels), roles_(roles), is_valid_(is_valid)
  {}

  /// lets failing cells ask for relief, all of them from the same state, and grants it; a cell that has asked before
  /// and could be valid by now asks for one step more. Returns whether one has asked.
  bool grant(std::span<const Block_element> failing)
  {
    std::vector<Relief> reliefs(failing.size());
    tbb::parallel_for(std::size_t(0), failing.size(), [&](std::size_t f) { reliefs[f] = next_relief(failing[f]); });
    bool has_asked = false;
    for (std::size_t f = 0; f < failing.size(); ++f)
      if (!reliefs[f].nodes.empty())
      {
        has_asked = true;
        lower(reliefs[f]);
        asked_[failing[f]].push_back(std::move(reliefs[f]));
      }
    if (has_asked)
      apply();
    return has_asked;
  }

  /// undoes what cells have been granted that fail all the same. Returns whether there is one.
  bool take_back()
  {
    const auto is_failing = [this](const auto& asked) { return cells_.has(Restoration_cells::failing, asked.first); };
    if (std::ranges::none_of(asked_, is_failing))
      return false;
    levels_.forget_fades(); // nothing else has used them yet
    for (const auto& asked : asked_)
      if (!is_failing(asked))
        std::ranges::for_each(asked.second, [this](const Relief& relief) { lower(relief); });
    apply();
    return true;
  }

private:
  /// What nodes of the wall keep, step by step: the first ones are small, since a wall that bends less than the
  /// straight-sided one would has no kink to show for it.
  static constexpr std::array shares = {31.0 / 32, 15.0 / 16, 7.0 / 8, 13.0 / 16, 3.0 / 4,
                                        1.0 / 2,   1.0 / 4,   1.0 / 8, 0.0};
  static constexpr std::size_t last_step = shares.size() - 1;

  /// Smallest determinant, relative to that of the straight cell, with which a cell has some room to live.
  static constexpr double room = 0.05;

  /// Nodes, and the step they take.
  struct Relief
  {
    std::vector<Index> nodes;
    std::size_t step = 0;
  };

  /// An edge or the inside of a face on the wall: its nodes by their numbers in the cell, the faces of the cell that it
  /// bends, and how many beside them.
  struct Part
  {
    std::vector<int> nodes;
    std::vector<int> faces;
    int other_faces = 0;
  };

  /// Some parts of a cell, and how many faces they cost.
  struct Choice
  {
    std::vector<std::size_t> parts;
    int cost = 0;
  };

  Index node_of(Block_element cell, int number) const { return cells_.nodes(cell)[static_cast<std::size_t>(number)]; }
  Node_role role(Index node) const { return roles_[static_cast<std::size_t>(node)]; }

  Wall_parts walls(Block_element cell) const
  {
    return Wall_parts(cells_.type(cell), cells_.degree(),
                      [&](int m) { return role(node_of(cell, m)) == Node_role::surface; });
  }

  void lower(const Relief& relief)
  {
    for (const Index node : relief.nodes)
      levels_.fade(node, shares[relief.step]);
  }

  // Faces follow their edges. ----------------------------------------------------------------------------------------

  /// moves the nodes of edges, also those linked with them, and then those inside faces.
  void apply()
  {
    levels_.apply();
    std::vector<std::pair<Index, double>> kept;
    for (const Block_element cell : cells_.touching(levels_.changed()))
      for (const int face : walls(cell).faces)
        for_each_follower(
          cell, face, [this](Index node) { return levels_.factor(node); },
          [&](Index node, double share) { kept.emplace_back(node, share); });
    for (const auto& [node, share] : kept)
      if (share < 1)
        levels_.fade(node, share);
    levels_.apply();
  }

  template <class Share, class Visit>
  void for_each_follower(Block_element cell, int face, const Share& share, const Visit& visit) const
  {
    const Element_type type = cells_.type(cell);
    const auto numbers = face_nodes(type, cells_.degree(), face);
    const auto node = [&](int m) { return node_of(cell, numbers[static_cast<std::size_t>(m)]); };
    follow_edges(
      reference_element(type).faces[static_cast<std::size_t>(face)].type, cells_.degree(),
      [&](int m) {
        return Kept_displacement{share(node(m)), displacement(node(m))};
      },
      [&](int m, double kept) { visit(node(m), kept); });
  }

  double displacement(Index node) const
  {
    const Point from = levels_.straight(node), to = levels_.full(node);
    return std::hypot(to[0] - from[0], to[1] - from[1], to[2] - from[2]);
  }

  // What a cell asks for. --------------------------------------------------------------------------------------------

  Relief next_relief(Block_element cell) const
  {
    const Wall_parts own = walls(cell);
    if (own.edges.empty() && own.faces.empty())
      return {};
    Lone_cell alone = without_neighbours(cell);
    const auto room_with = [&](const Relief& relief, double least, double enough) {
      return alone.room(positions_with(cell, own, relief), least, enough,
                        [&](std::span<const Point> positions) { return is_valid_at(cell, positions); });
    };
    if (room_with({}, 0, 0) > 0)
    {
      const auto before = asked_.find(cell);
      if (before == asked_.end() || before->second.back().step == last_step)
        return {};
      Relief more = before->second.back();
      ++more.step;
      return more;
    }
    return least_relief(cell, parts_of(cell, own), room_with);
  }

  Lone_cell without_neighbours(Block_element cell) const
  {
    const auto nodes = cells_.nodes(cell);
    const auto corners = static_cast<std::size_t>(corner_count(cells_.type(cell)));
    std::vector<Point> straight;
    for (const Index node : nodes)
      straight.push_back(levels_.straight(node));
    return Lone_cell(cells_.type(cell), cells_.degree(), std::move(straight), [&](std::size_t m) {
      return m >= corners && role(nodes[m]) == Node_role::inside && levels_.factor(nodes[m]) == 1;
    });
  }

  bool is_valid_at(Block_element cell, std::span<const Point> positions) const
  {
    const auto nodes = cells_.nodes(cell);
    return is_valid_(cell, [&](Index node) {
      return positions[static_cast<std::size_t>(std::ranges::find(nodes, node) - nodes.begin())];
    });
  }

  /// of those that cost the fewest faces the one of the mildest step; the first of several.
  template <class RoomWith>
  Relief least_relief(Block_element cell, const std::vector<Part>& parts, const RoomWith& room_with) const
  {
    Relief best;
    int best_cost = 0;
    for (const Choice& choice : choices(cell, parts))
    {
      if (!best.nodes.empty() && (choice.cost > best_cost || best.step == 0))
        break;
      Relief relief{{}, last_step};
      for (const std::size_t part : choice.parts)
        for (const int m : parts[part].nodes)
          relief.nodes.push_back(node_of(cell, m));
      const double enough = std::min(room, room_with(relief, 0, 2 * room) / 2);
      if (!(enough > 0))
        continue;
      const bool is_first = best.nodes.empty();
      if (const std::size_t step = mildest_step(relief, enough, is_first ? last_step : best.step - 1, room_with);
          is_first || step < best.step)
      {
        best = std::move(relief);
        best.step = step;
        best_cost = choice.cost;
      }
    }
    return best;
  }

  /// the mildest that leaves the cell enough room, up to `last`; one more if none does. Found by bisection: where the
  /// room does not grow from step to step, another one than the first may be taken.
  template <class RoomWith>
  std::size_t mildest_step(Relief relief, double enough, std::size_t last, const RoomWith& room_with) const
  {
    const auto has_room = [&](std::size_t step) {
      relief.step = step;
      return room_with(relief, enough, enough) >= enough;
    };
    if (last != last_step && !has_room(last))
      return last + 1;
    for (std::size_t first = 0; first < last;)
      if (const std::size_t middle = (first + last) / 2; has_room(middle))
        last = middle;
      else
        first = middle + 1;
    return last;
  }

  std::vector<Part> parts_of(Block_element cell, const Wall_parts& own) const
  {
    const Element_type type = cells_.type(cell);
    const int degree = cells_.degree();
    std::vector<Part> parts;
    const auto add = [&](std::span<const int> nodes, std::vector<int> faces, int other_faces) {
      if (std::ranges::any_of(nodes, [&](int m) {
            const Index node = node_of(cell, m);
            return levels_.is_displaced(node) && levels_.factor(node) != 0;
          }))
        parts.push_back({{nodes.begin(), nodes.end()}, std::move(faces), other_faces});
    };
    for (const int e : own.edges)
    {
      std::vector<int> faces;
      const int first = inside_edge(type, degree, e)[0];
      for (const int f : own.faces)
        if (std::ranges::count(face_nodes(type, degree, f), first) != 0)
          faces.push_back(f);
      const bool is_reduced = levels_.factor(node_of(cell, first)) != 1; // the faces beside it have paid
      add(inside_edge(type, degree, e), faces, is_reduced ? 0 : 2 - static_cast<int>(faces.size()));
    }
    for (const int f : own.faces)
      add(inside_face(type, degree, f), {f}, 0);
    return parts;
  }

  /// up to three parts, or all; the cheapest first.
  std::vector<Choice> choices(Block_element cell, const std::vector<Part>& parts) const
  {
    constexpr std::size_t many = 8; // parts, of which only pairs are tried
    std::vector<Choice> result;
    const auto n = parts.size();
    const auto add = [&](std::vector<std::size_t> chosen) {
      const int cost = cost_of(cell, parts, chosen);
      result.push_back({std::move(chosen), cost});
    };
    for (std::size_t a = 0; a < n; ++a)
    {
      add({a});
      for (std::size_t b = a + 1; b < n; ++b)
      {
        add({a, b});
        for (std::size_t c = b + 1; c < n && n <= many; ++c)
          add({a, b, c});
      }
    }
    std::ranges::stable_sort(result, {}, &Choice::cost);
    if (n > 3)
    {
      std::vector<std::size_t> all(n);
      for (std::size_t a = 0; a < n; ++a)
        all[a] = a;
      add(std::move(all));
    }
    return result;
  }

  int cost_of(Block_element cell, const std::vector<Part>& parts, std::span<const std::size_t> chosen) const
  {
    std::set<int> faces;
    int cost = 0;
    for (const std::size_t part : chosen)
    {
      cost += parts[part].other_faces;
      for (const int f : parts[part].faces)
        if (std::ranges::all_of(face_nodes(cells_.type(cell), cells_.degree(), f),
                                [&](int m) { return levels_.factor(node_of(cell, m)) == 1; }))
          faces.insert(f);
    }
    return cost + static_cast<int>(faces.size());
  }

  /// of the nodes of the cell, if nothing is changed but what is asked for.
  std::vector<Point> positions_with(Block_element cell, const Wall_parts& own, const Relief& relief) const
  {
    std::unordered_map<Index, double> kept;
    for (const Index node : relief.nodes)
      kept[node] = std::min(levels_.factor(node), shares[relief.step]);
    const auto share = [&](Index node) {
      const auto found = kept.find(node);
      return found != kept.end() ? found->second : levels_.factor(node);
    };
    if (!relief.nodes.empty())
      for (const int face : own.faces)
        for_each_follower(cell, face, share,
                          [&](Index node, double follows) { kept[node] = std::min(share(node), follows); });
    std::vector<Point> result;
    for (const Index node : cells_.nodes(cell))
      result.push_back(kept.contains(node) ? levels_.position_keeping(node, share(node)) : levels_.current(node));
    return result;
  }

  const Restoration_cells& cells_;
  Levels& levels_;
  std::span<const Node_role> roles_;
  const IsValid& is_valid_;
  std::map<Block_element, std::vector<Relief>> asked_;
};

} // namespace recurve::internal

#endif
