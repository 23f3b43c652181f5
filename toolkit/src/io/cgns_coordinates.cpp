#include "cgns_reading.h"

#include <fmt/format.h>

#include <cmath>

namespace recurve::internal::cgns {

namespace {

/// planes of points outside the zone proper, two numbers per direction; all 0 where the file has none.
std::array<Index, 6> read_rind(const Cgns_tree& tree, const Cgns_node& grid, std::string_view where)
{
  std::array<Index, 6> rind = {};
  if (const auto node = tree.child_with_label(grid, "Rind_t"))
  {
    const std::vector<std::int64_t> values = tree.read_integers(*node);
    for (std::size_t m = 0; m < std::min(values.size(), rind.size()); ++m)
      if ((rind[m] = values[m]) < 0)
        tree.fail(fmt::format("{}: negative number of rind planes", where));
  }
  return rind;
}

Cgns_node find_component(const Cgns_tree& tree, const std::vector<Cgns_node>& arrays, std::string_view name,
                         std::string_view where)
{
  std::string others;
  for (const Cgns_node& array : arrays)
  {
    if (array.name() == name)
      return array;
    others += (others.empty() ? "" : ", ") + array.name();
  }
  tree.fail(fmt::format("{} has no {} (it has: {})", where, name, others.empty() ? "no coordinates" : others));
}

/// Says which entries of a coordinate array belong to the zone proper.
class Core_points
{
public:
  Core_points(const Zone_reading& zone, Index count, const std::array<Index, 6>& rind)
  {
    extent_ = zone.is_structured ? zone.size : std::array<Index, 3>{count, 1, 1};
    for (std::size_t d = 0; d < 3; ++d)
    {
      before_[d] = rind[2 * d];
      stored_[d] = extent_[d] + rind[2 * d] + rind[2 * d + 1];
    }
    has_rind_ = rind != std::array<Index, 6>{};
  }

  Index stored_count() const { return stored_[0] * stored_[1] * stored_[2]; }

  /// number of the point that entry `m` belongs to, or no_index.
  Index point_of(Index m) const
  {
    if (!has_rind_)
      return m;
    const std::array<Index, 3> at = {m % stored_[0] - before_[0], m / stored_[0] % stored_[1] - before_[1],
                                     m / (stored_[0] * stored_[1]) - before_[2]};
    for (std::size_t d = 0; d < 3; ++d)
      if (at[d] < 0 || at[d] >= extent_[d])
        return no_index;
    return at[0] + extent_[0] * (at[1] + extent_[1] * at[2]);
  }

private:
  std::array<Index, 3> extent_ = {}, before_ = {}, stored_ = {};
  bool has_rind_ = false;
};

} // namespace

void read_coordinates(Cgns_reading& reading, Zone_reading& zone, Index point_count)
{
  const Cgns_tree& tree = reading.tree;
  const std::string where = fmt::format("zone '{}'", zone.zone.name);
  const std::vector<Cgns_node> grids = tree.children(zone.node, "GridCoordinates_t");
  if (grids.empty())
    tree.fail(fmt::format("{} has no GridCoordinates_t", where));
  const Cgns_node* grid = grids.data();
  for (const Cgns_node& candidate : grids)
    if (candidate.name() == "GridCoordinates") // the name of the initial grid, where the zone moves
      grid = &candidate;
  if (grids.size() > 1)
    reading.notes.push_back(fmt::format("{}: {} grids, read '{}'", where, grids.size(), grid->name()));

  const std::vector<Cgns_node> arrays = tree.children(*grid, "DataArray_t");
  const Core_points core(zone, point_count, read_rind(tree, *grid, where));
  static constexpr std::array<const char*, 3> names = {"CoordinateX", "CoordinateY", "CoordinateZ"};
  for (std::size_t d = 0; d < 3; ++d)
  {
    const Cgns_node array = find_component(tree, arrays, names[d], where);
    const Index stored = tree.shape(array).size();
    if (stored != core.stored_count())
      tree.fail(fmt::format("{} states {} points, but {} has {}", where, core.stored_count(), names[d], stored));
    if (d == 0)
      zone.zone.points.resize(static_cast<std::size_t>(point_count));
    const auto store = [&](Index begin, std::span<const double> piece) {
      for (std::size_t m = 0; m < piece.size(); ++m)
      {
        const Index point = core.point_of(begin + static_cast<Index>(m));
        if (point == no_index)
          continue;
        if (!std::isfinite(piece[m]))
          tree.fail(fmt::format("{}, node {}: {} is {}", where, point + 1, names[d], piece[m]));
        zone.zone.points[static_cast<std::size_t>(point)][d] = piece[m];
      }
    };
    tree.visit_reals(array, store);
  }
}

} // namespace recurve::internal::cgns
