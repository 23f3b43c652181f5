#ifndef RECURVE_VOLUME_INTERNAL_WALL_RELIEF_H
#define RECURVE_VOLUME_INTERNAL_WALL_RELIEF_H

#include <recurve/core/types.h>
#include <recurve/elements/element.h>
#include <recurve/elements/node_layout.h>
#include <recurve/volume/internal/restoration_cells.h>
#include <recurve/volume/internal/untangle.h>
#include <recurve/volume/internal/wall_parts.h>
#include <recurve/volume/restoration_report.h>

#include <Eigen/Core>
#include <Eigen/LU>

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <numeric>
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

  /// lets failing cells ask for relief, all of them from the same state; a cell that has asked before and could be
  /// valid by now asks for one step more. Returns whether one has asked. Takes effect with `Levels::apply()`.
  bool request(std::span<const Block_element> failing)
  {
    std::vector<Relief> reliefs(failing.size());
    tbb::parallel_for(std::size_t(0), failing.size(), [&](std::size_t f) { reliefs[f] = next_relief(failing[f]); });
    bool has_asked = false;
    for (std::size_t f = 0; f < failing.size(); ++f)
      if (!reliefs[f].nodes.empty())
      {
        has_asked = true;
        for (const Index node : reliefs[f].nodes)
          lower(node, shares[reliefs[f].step]);
        asked_[failing[f]] = std::move(reliefs[f]);
      }
    if (has_asked)
      follow();
    return has_asked;
  }

  /// undoes what cells have asked for that fail all the same. Takes effect with `Levels::apply()`.
  void take_back()
  {
    std::set<Index> useful;
    for (const auto& [cell, relief] : asked_)
      if (!cells_.has(Restoration_cells::failing, cell))
        useful.insert(relief.nodes.begin(), relief.nodes.end());
    for (const auto& [cell, relief] : asked_)
      if (cells_.has(Restoration_cells::failing, cell))
        for (const Index node : relief.nodes)
          if (!useful.contains(node))
            levels_.put_back(node, before_.at(node));
    for_each_changed_face([&](Block_element cell, int face) {
      for (const int m : inside_face(cells_.type(cell), cells_.degree(), face))
        if (const Index node = node_of(cell, m); !useful.contains(node) && before_.contains(node))
          levels_.put_back(node, before_.at(node));
    });
    follow();
  }

private:
  /// What nodes of the wall keep, step by step: the first ones are small, since a wall that bends less than the
  /// straight-sided one would has no kink to show for it.
  static constexpr std::array<double, 9> shares = {31.0 / 32, 15.0 / 16, 7.0 / 8, 3.0 / 4,
                                                   1.0 / 2,   1.0 / 4,   1.0 / 8, 0};
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

  void lower(Index node, double share)
  {
    if (!(share < levels_.factor(node)))
      return;
    before_.try_emplace(node, levels_.state(node));
    levels_.fade(node, share / curving_factors[levels_.level(node)]);
  }

  // Faces follow their edges. ----------------------------------------------------------------------------------------

  template <class Visit>
  void for_each_changed_face(const Visit& visit) const
  {
    for (const Block_element cell : cells_.touching(levels_.changed()))
      for (const int face : walls(cell).faces)
        if (std::ranges::any_of(face_nodes(cells_.type(cell), cells_.degree(), face), [&](int m) {
              return levels_.changed()[static_cast<std::size_t>(node_of(cell, m))] != 0;
            }))
          visit(cell, face);
  }

  void follow()
  {
    std::vector<std::pair<Index, double>> shares;
    for_each_changed_face([&](Block_element cell, int face) {
      for_each_follower(
        cell, face, [this](Index node) { return levels_.factor(node); },
        [&](Index node, double share) { shares.emplace_back(node, share); });
    });
    for (const auto& [node, share] : shares)
      lower(node, share);
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
    if (reachable_room(cell, own, {}) > 0)
    {
      const auto before = asked_.find(cell);
      if (before == asked_.end() || before->second.step == last_step)
        return {};
      Relief more = before->second;
      ++more.step;
      return more;
    }
    return least_relief(cell, own);
  }

  /// of those that cost the fewest faces the one of the mildest step; the first of several.
  Relief least_relief(Block_element cell, const Wall_parts& own) const
  {
    const std::vector<Part> parts = parts_of(cell, own);
    Relief best;
    int best_cost = 0;
    for (const Choice& choice : choices(cell, parts))
    {
      if (!best.nodes.empty() && choice.cost > best_cost)
        break;
      Relief relief{{}, last_step};
      for (const std::size_t part : choice.parts)
        for (const int m : parts[part].nodes)
          relief.nodes.push_back(node_of(cell, m));
      const double most_room = reachable_room(cell, own, relief);
      if (!(most_room > 0))
        continue;
      relief.step = mildest_step(cell, own, relief, most_room);
      if (best.nodes.empty() || relief.step < best.step)
      {
        best = std::move(relief);
        best_cost = choice.cost;
      }
    }
    return best;
  }

  /// the mildest that leaves the cell some room, if the last one does; otherwise about half as much as that. Found by
  /// bisection: where the room does not grow from step to step, another one than the first may be taken.
  /// \pre `relief`, at the last step, makes the cell valid
  std::size_t mildest_step(Block_element cell, const Wall_parts& own, Relief relief, double most_room) const
  {
    const double enough = std::min(room, most_room / 2);
    std::size_t first = 0, last = last_step;
    while (first < last)
    {
      relief.step = (first + last) / 2;
      if (reachable_room(cell, own, relief) >= enough)
        last = relief.step;
      else
        first = relief.step + 1;
    }
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

  // A cell by itself. ------------------------------------------------------------------------------------------------

  /// the smallest determinant, relative to that of the straight cell and at the points where distortion is measured, of
  /// the cell with `relief` if its nodes inside the volume, corners apart, go where they distort it least; 0 if it is
  /// not valid there.
  double reachable_room(Block_element cell, const Wall_parts& own, const Relief& relief) const
  {
    const auto nodes = cells_.nodes(cell);
    std::vector<Point> positions = positions_with(cell, own, relief);
    if (is_folded_at_wall(cell, positions))
      return 0;
    const std::vector<std::size_t> order = movable_first(cell);
    const auto movable =
      static_cast<std::size_t>(std::ranges::count_if(order, [&](std::size_t m) { return may_move(cell, m); }));
    Distorted_cell alone{cells_.type(cell), &distortion_points(cells_.type(cell), cells_.degree()), {}, {}};
    alone.nodes.resize(nodes.size());
    for (const Index node : nodes)
      alone.straight.push_back(levels_.straight(node));
    std::vector<Point> displacements;
    for (std::size_t k = 0; k < order.size(); ++k)
    {
      alone.nodes[order[k]] = static_cast<int>(k);
      const Point &from = alone.straight[order[k]], &to = positions[order[k]];
      displacements.push_back({to[0] - from[0], to[1] - from[1], to[2] - from[2]});
    }
    Repair_component repair(std::span(&alone, 1), std::move(displacements), movable);
    const auto is_valid = [&] {
      for (std::size_t k = 0; k < movable; ++k)
        for (std::size_t d = 0; d < 3; ++d)
          positions[order[k]][d] = alone.straight[order[k]][d] + repair.displacements()[k][d];
      return is_valid_(cell, [&](Index node) {
        return positions[static_cast<std::size_t>(std::ranges::find(nodes, node) - nodes.begin())];
      });
    };
    const bool is_done = movable == 0 ? is_valid() : untangle(repair, is_valid);
    return is_done ? std::max(repair.least_determinant(), 0.0) : 0;
  }

  /// whether the determinant is not positive at a point where the nodes that may move have no say.
  bool is_folded_at_wall(Block_element cell, std::span<const Point> positions) const
  {
    constexpr double none = 1e-9; // of a derivative; they are sums of a few numbers of the size of the degree
    const Distortion_view points = distortion_points(cells_.type(cell), cells_.degree()).view();
    const auto count = static_cast<std::size_t>(points.nodes);
    for (std::size_t q = 0; q < static_cast<std::size_t>(points.count); ++q)
    {
      const double* const derivatives = points.derivatives + 3 * count * q;
      Eigen::Matrix3d jacobian = Eigen::Matrix3d::Zero();
      bool is_fixed = true;
      for (std::size_t m = 0; m < count && is_fixed; ++m)
      {
        const Eigen::Map<const Eigen::RowVector3d> slope(derivatives + 3 * m);
        const Point& p = positions[m];
        jacobian += Eigen::Vector3d(p[0] - positions[0][0], p[1] - positions[0][1], p[2] - positions[0][2]) * slope;
        is_fixed = !may_move(cell, m) || slope.cwiseAbs().maxCoeff() < none;
      }
      if (is_fixed && !(jacobian.determinant() > 0))
        return true;
    }
    return false;
  }

  bool may_move(Block_element cell, std::size_t number) const
  {
    const Index node = node_of(cell, static_cast<int>(number));
    return static_cast<int>(number) >= corner_count(cells_.type(cell)) && role(node) == Node_role::inside &&
           levels_.factor(node) == 1;
  }

  std::vector<std::size_t> movable_first(Block_element cell) const
  {
    std::vector<std::size_t> order(cells_.nodes(cell).size());
    std::iota(order.begin(), order.end(), std::size_t(0));
    std::ranges::stable_partition(order, [&](std::size_t m) { return may_move(cell, m); });
    return order;
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
  std::map<Block_element, Relief> asked_;                    ///< the last of each cell
  std::unordered_map<Index, typename Levels::State> before_; ///< of the nodes that relief has lowered
};

} // namespace recurve::internal

#endif
