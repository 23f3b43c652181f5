#include <recurve/run/validity_check.h>

#include "mesh_cells.h"
#include "validity_json.h"

#include <recurve/volume/bound_jacobian.h>

#include <algorithm>
#include <numeric>
#include <span>
#include <unordered_map>

namespace recurve {

namespace {

/// the names of the patches at certain nodes.
class Patches_at
{
public:
  Patches_at(const Curved_mesh& mesh, const std::vector<std::span<const Index>>& cells)
  {
    for (std::size_t c = 0; c < cells.size(); ++c)
      for (const Index node : cells[c])
        cells_of_node_[node].push_back(c);
    names_.resize(cells.size());
    for (std::size_t z = 0; z < mesh.zones.size(); ++z)
      look_at(mesh, z);
    for (auto& names : names_)
    {
      std::sort(names.begin(), names.end());
      names.erase(std::unique(names.begin(), names.end()), names.end());
    }
  }

  std::vector<std::string>& of(std::size_t cell) { return names_[cell]; }

private:
  void look_at(const Curved_mesh& mesh, std::size_t z)
  {
    const Zone& zone = mesh.linear.zones[z];
    for (const Patch& patch : zone.patches)
      for (const Index face : patch.faces)
      {
        const Section_entry at = find_element(zone.faces, face);
        if (at.section == no_index)
          continue;
        const Curved_section& section = mesh.zones[z].faces[static_cast<std::size_t>(at.section)];
        const Index* const nodes = section.nodes.data() + at.element * node_count(section.type, mesh.degree);
        for (int c = 0; c < corner_count(section.type); ++c)
          if (const auto found = cells_of_node_.find(nodes[c]); found != cells_of_node_.end())
            for (const std::size_t cell : found->second)
              add(cell, patch.name);
      }
  }

  void add(std::size_t cell, const std::string& name)
  {
    if (names_[cell].empty() || names_[cell].back() != name)
      names_[cell].push_back(name);
  }

  std::unordered_map<Index, std::vector<std::size_t>> cells_of_node_;
  std::vector<std::vector<std::string>> names_;
};

} // namespace

std::string_view to_string(Validity verdict)
{
  constexpr std::string_view names[] = {"valid", "invalid", "undecided"};
  return names[static_cast<int>(verdict)];
}

std::vector<Index> worst_cells(const Cell_bounds& bounds, std::size_t count)
{
  std::vector<Index> cells(bounds.scaled.size());
  std::iota(cells.begin(), cells.end(), Index(0));
  const auto last = cells.begin() + static_cast<std::ptrdiff_t>(std::min(count, cells.size()));
  std::partial_sort(cells.begin(), last, cells.end(), [&](Index a, Index b) {
    const double x = bounds.scaled[static_cast<std::size_t>(a)], y = bounds.scaled[static_cast<std::size_t>(b)];
    return x != y ? x < y : a < b;
  });
  cells.erase(last, cells.end());
  return cells;
}

std::vector<Cell_verdict> describe_cells(const Curved_mesh& mesh, const Cell_bounds& bounds,
                                         const std::vector<Index>& cells)
{
  const Mesh_cells all(mesh);
  std::vector<Cell_verdict> result;
  std::vector<std::span<const Index>> corners;
  for (const Index number : cells)
  {
    std::size_t b = 0;
    while (b + 1 < all.places.size() && all.places[b + 1].first <= number)
      ++b;
    const Mesh_cells::Place& place = all.places[b];
    const Element_block& block = all.blocks[b];
    const Index element = number - place.first;
    Cell_verdict cell{mesh.linear.zones[place.zone].name, place.first_of_zone + element, block.type, {}, {}, {}, {}};
    cell.verdict = bounds.verdicts[static_cast<std::size_t>(number)];
    cell.scaled = bounds.scaled[static_cast<std::size_t>(number)];
    corners.push_back(block.nodes.subspan(static_cast<std::size_t>(element * node_count(block.type, mesh.degree)),
                                          static_cast<std::size_t>(corner_count(block.type))));
    for (const Index node : corners.back())
      for (std::size_t d = 0; d < 3; ++d)
        cell.position[d] += mesh.nodes[static_cast<std::size_t>(node)][d] / static_cast<double>(corners.back().size());
    result.push_back(std::move(cell));
  }
  Patches_at patches(mesh, corners);
  for (std::size_t c = 0; c < result.size(); ++c)
    result[c].patches = std::move(patches.of(c));
  return result;
}

Validity_check check_validity(const Curved_mesh& mesh, std::size_t worst, const Jacobian_options& options,
                              const Progress_callback& progress)
{
  const Mesh_cells cells(mesh);
  Validity_check result{mesh.degree, cells.count, {}, {}, Cell_bounds(cells.count)};
  Step_counter steps(progress, "certify", cells.count);
  const auto is_straight = [&](Index block, Index element) {
    const auto& place = cells.places[static_cast<std::size_t>(block)];
    return mesh.zones[place.zone].is_straight[static_cast<std::size_t>(place.first_of_zone + element)] != 0;
  };
  result.jacobians = bound_jacobians(mesh.nodes, cells.blocks, mesh.degree, options, is_straight,
                                     [&](Index block, Index element, const Jacobian_bounds& bounds) {
                                       const auto n = static_cast<std::size_t>(cells.number(block, element));
                                       result.bounds.scaled[n] = bounds.scaled;
                                       result.bounds.verdicts[n] = bounds.verdict;
                                       steps.count();
                                     });
  result.worst = describe_cells(mesh, result.bounds, worst_cells(result.bounds, worst));
  return result;
}

std::vector<Cell_field> cell_fields(const Cell_bounds& bounds)
{
  Cell_field verdicts{"verdict", {}};
  for (const Validity verdict : bounds.verdicts)
    verdicts.values.push_back(static_cast<double>(verdict));
  return {{"scaled_jacobian", bounds.scaled}, std::move(verdicts)};
}

Json json_of(const Jacobian_report& report)
{
  Json json = Json::object();
  for (const Element_type type : all_element_types)
    if (const auto& v = report.of(type); reference_element(type).dimension == 3)
      json[std::string(element_name(type))] = {{"valid", v.valid}, {"invalid", v.invalid}, {"undecided", v.undecided}};
  const auto total = report.total();
  const bool has_valid = report.least_valid.element != no_index;
  return {{"valid", total.valid},
          {"invalid", total.invalid},
          {"undecided", total.undecided},
          {"by_type", std::move(json)},
          {"straight_cells", report.straight_elements},
          {"subdivided_cells", report.subdivided_elements},
          {"exact_cells", report.exact_elements},
          {"smallest_scaled_jacobian", has_valid ? Json(report.least_valid.scaled) : Json()},
          {"histogram", report.histogram}};
}

Json json_of(const std::vector<Cell_verdict>& cells)
{
  Json json = Json::array();
  for (const Cell_verdict& cell : cells)
    json.push_back({{"zone", cell.zone},
                    {"cell", cell.cell},
                    {"type", element_name(cell.type)},
                    {"verdict", to_string(cell.verdict)},
                    {"scaled_jacobian", cell.scaled},
                    {"position", cell.position},
                    {"patches", cell.patches}});
  return json;
}

std::string to_json(const Validity_check& check)
{
  const Json json = {{"program", "recurve"},
                     {"version", RECURVE_VERSION},
                     {"degree", check.degree},
                     {"cells", check.cells},
                     {"is_valid", check.is_valid()},
                     {"jacobians", json_of(check.jacobians)},
                     {"worst_cells", json_of(check.worst)}};
  return json_text(json);
}

} // namespace recurve
