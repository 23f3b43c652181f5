#include <recurve/run/select_patches.h>

#include <recurve/core/exceptions.h>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <fnmatch.h>

#include <algorithm>
#include <numeric>
#include <set>
#include <utility>

namespace recurve {

namespace {

/// number of letters to insert, remove or replace to turn one word into the other.
std::size_t edit_distance(std::string_view a, std::string_view b)
{
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i)
  {
    std::size_t diagonal = row[0];
    row[0] = i + 1;
    for (std::size_t j = 0; j < b.size(); ++j)
      diagonal = std::exchange(row[j + 1], std::min({row[j] + 1, row[j + 1] + 1, diagonal + (a[i] != b[j])}));
  }
  return row.back();
}

enum class Match
{
  none,
  wildcard,
  exact
};

Match match(const std::string& entry, const std::string& name)
{
  if (entry == name)
    return Match::exact;
  return fnmatch(entry.c_str(), name.c_str(), 0) == 0 ? Match::wildcard : Match::none;
}

Match match(const std::string& entry, const Zone& zone, const Patch& patch)
{
  // A name in CGNS holds no slash, so that an entry with one can only mean zone and patch.
  if (entry.find('/') != std::string::npos)
    return std::max(match(entry, zone.name + "/" + patch.name), match(entry, patch.name));
  return std::max(match(entry, patch.name), patch.family.empty() ? Match::none : match(entry, patch.family));
}

std::set<std::string> known_names(const Volume_mesh& mesh)
{
  std::set<std::string> names;
  for (const Zone& zone : mesh.zones)
    for (const Patch& patch : zone.patches)
    {
      names.insert(patch.name);
      if (!patch.family.empty())
        names.insert(patch.family);
    }
  return names;
}

[[noreturn]] void fail_unknown(const Volume_mesh& mesh, const std::string& entry)
{
  const std::set<std::string> names = known_names(mesh);
  if (names.empty())
    throw Input_error(fmt::format("no patch matches \"{}\": the mesh has no patches", entry));
  const auto nearest = std::min_element(names.begin(), names.end(), [&](const auto& a, const auto& b) {
    return edit_distance(entry, a) < edit_distance(entry, b);
  });
  // A suggestion that shares less than half of the letters would only puzzle.
  const bool is_near = 2 * edit_distance(entry, *nearest) <= std::max(entry.size(), nearest->size());
  throw Input_error(fmt::format("no patch matches \"{}\"{}; patches and families are: {}", entry,
                                is_near ? fmt::format(" (did you mean \"{}\"?)", *nearest) : "",
                                fmt::join(names, ", ")));
}

/// per zone and patch, whether any of `entries` matches.
std::vector<std::vector<bool>> find_matches(const Volume_mesh& mesh, const std::vector<std::string>& entries)
{
  std::vector<std::vector<bool>> result;
  for (const Zone& zone : mesh.zones)
    result.emplace_back(zone.patches.size(), false);
  for (const std::string& entry : entries)
  {
    Match best = Match::none;
    for (const Zone& zone : mesh.zones)
      for (const Patch& patch : zone.patches)
        best = std::max(best, match(entry, zone, patch));
    if (best == Match::none)
      fail_unknown(mesh, entry);
    for (std::size_t z = 0; z < mesh.zones.size(); ++z)
      for (std::size_t p = 0; p < mesh.zones[z].patches.size(); ++p)
        if (match(entry, mesh.zones[z], mesh.zones[z].patches[p]) == best)
          result[z][p] = true;
  }
  return result;
}

} // namespace

Face_selection select_patches(const Volume_mesh& mesh, const Boundary_faces& faces,
                              const std::vector<std::string>& curve, const std::vector<std::string>& keep)
{
  const auto is_named = find_matches(mesh, curve);
  const auto is_kept = find_matches(mesh, keep);
  Face_selection selection;
  for (std::size_t z = 0; z < mesh.zones.size(); ++z)
  {
    const auto& owners = faces.owners[z];
    selection.emplace_back(owners.size(), std::uint8_t{0});
    for (std::size_t p = 0; p < mesh.zones[z].patches.size(); ++p)
    {
      if (is_kept[z][p] || (!curve.empty() && !is_named[z][p]))
        continue;
      for (Index face : mesh.zones[z].patches[p].faces)
      {
        const Face_place place = place_of(owners[static_cast<std::size_t>(face)]);
        if (place == Face_place::boundary || (place != Face_place::nowhere && is_named[z][p]))
          selection[z][static_cast<std::size_t>(face)] = 1;
      }
    }
  }
  return selection;
}

} // namespace recurve
