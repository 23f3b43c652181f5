#include "cgns_reading.h"

#include <fmt/format.h>

#include <algorithm>

namespace recurve::internal::cgns {

namespace {

/// A rectangle of faces: all faces normal to one index direction, at one index, with cells first .. last (from 0).
struct Face_rectangle
{
  std::size_t direction = 0;
  Index plane = 0;
  std::array<Index, 3> first = {}, last = {};
};

std::vector<std::array<Index, 4>> faces_of(const Zone_reading& zone, const Face_rectangle& rectangle)
{
  const std::size_t a = (rectangle.direction + 1) % 3, b = (rectangle.direction + 2) % 3;
  const auto point = [&](Index ia, Index ib) {
    std::array<Index, 3> at = {};
    at[rectangle.direction] = rectangle.plane;
    at[a] = ia;
    at[b] = ib;
    return zone.point_at(at[0], at[1], at[2]);
  };
  std::vector<std::array<Index, 4>> faces;
  for (Index ib = rectangle.first[b]; ib <= rectangle.last[b]; ++ib)
    for (Index ia = rectangle.first[a]; ia <= rectangle.last[a]; ++ia)
    {
      // (direction, a, b) is a cyclic order, so this face looks along its direction; the low side looks back.
      std::array<Index, 4> face = {point(ia, ib), point(ia + 1, ib), point(ia + 1, ib + 1), point(ia, ib + 1)};
      if (rectangle.plane == 0)
        std::swap(face[1], face[3]);
      faces.push_back(face);
    }
  return faces;
}

/// the direction that a location names: IFaceCenter, JFaceCenter, KFaceCenter; 3 for any other.
std::size_t named_direction(std::string_view location)
{
  static constexpr std::array<std::string_view, 3> names = {"IFaceCenter", "JFaceCenter", "KFaceCenter"};
  return static_cast<std::size_t>(std::find(names.begin(), names.end(), location) - names.begin());
}

} // namespace

void make_structured_cells(Zone_reading& zone)
{
  const auto [ni, nj, nk] = zone.size;
  Section section = {.name = "HEXA_8", .type = Element_type::hexahedron, .nodes = {}};
  section.nodes.reserve(static_cast<std::size_t>(8 * (ni - 1) * (nj - 1) * (nk - 1)));
  for (Index k = 0; k + 1 < nk; ++k)
    for (Index j = 0; j + 1 < nj; ++j)
      for (Index i = 0; i + 1 < ni; ++i)
        for (const Index layer : {k, k + 1})
          for (const Index node : {zone.point_at(i, j, layer), zone.point_at(i + 1, j, layer),
                                   zone.point_at(i + 1, j + 1, layer), zone.point_at(i, j + 1, layer)})
            section.nodes.push_back(node);
  zone.zone.cells.push_back(std::move(section));
}

std::vector<std::array<Index, 4>> structured_faces(const Cgns_tree& tree, const Zone_reading& zone,
                                                   const Point_set& set, std::string_view location,
                                                   std::string_view what)
{
  if (set.values.size() != 6)
    tree.fail(fmt::format("{}: a range of {} numbers in a structured zone", what, set.values.size()));
  std::array<Index, 3> low = {}, high = {};
  for (std::size_t d = 0; d < 3; ++d)
  {
    low[d] = std::min(set.values[d], set.values[d + 3]);
    high[d] = std::max(set.values[d], set.values[d + 3]);
    if (low[d] < 1 || high[d] > zone.size[d])
      tree.fail(
        fmt::format("{}: range {}..{} in direction {} is outside 1..{}", what, low[d], high[d], d + 1, zone.size[d]));
  }
  const bool is_vertex = location.empty() || location == "Vertex";
  std::size_t direction = named_direction(location);
  for (std::size_t d = 0; d < 3 && direction == 3; ++d)
    if (low[d] == high[d])
      direction = d;
  if (direction == 3 || low[direction] != high[direction])
    return {};

  Face_rectangle rectangle = {.direction = direction, .plane = low[direction] - 1};
  for (std::size_t d = 0; d < 3; ++d)
  {
    rectangle.first[d] = low[d] - 1;
    rectangle.last[d] = high[d] - (is_vertex ? 2 : 1); // points first .. last bound one face less
    if (d != direction && rectangle.last[d] > zone.size[d] - 2)
      tree.fail(fmt::format("{}: range {}..{} in direction {} is outside the {} faces", what, low[d], high[d], d + 1,
                            zone.size[d] - 1));
  }
  return faces_of(zone, rectangle);
}

} // namespace recurve::internal::cgns
