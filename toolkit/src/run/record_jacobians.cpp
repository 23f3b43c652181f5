#include "record_jacobians.h"

#include <recurve/volume/bound_jacobian.h>

#include <algorithm>
#include <utility>

namespace recurve {

template <class IsStraight>
void Jacobian_recorder::add_stage(const Curved_mesh& mesh, std::span<const Point> nodes, std::string name,
                                  const IsStraight& is_straight)
{
  std::vector<Element_block> blocks;
  std::vector<std::size_t> firsts; // number in the mesh of the first cell of each block
  std::size_t count = 0;
  for (const Curved_zone& zone : mesh.zones)
    for (const Curved_section& section : zone.cells)
    {
      blocks.push_back({section.type, section.nodes});
      firsts.push_back(count);
      count += section.nodes.size() / static_cast<std::size_t>(node_count(section.type, mesh.degree));
    }
  std::vector<std::uint8_t> is_not_valid(count, 1);
  const auto number = [&](Index block, Index element) {
    return firsts[static_cast<std::size_t>(block)] + static_cast<std::size_t>(element);
  };
  const auto nodes_of = [&](Index block, Index element) {
    const Element_block& all = blocks[static_cast<std::size_t>(block)];
    const auto n = static_cast<std::size_t>(node_count(all.type, mesh.degree));
    return all.nodes.subspan(static_cast<std::size_t>(element) * n, n);
  };
  Jacobian_stage stage;
  stage.name = std::move(name);
  stage.bounds = bound_jacobians(
    nodes, blocks, mesh.degree, {}, [&](Index block, Index element) { return is_straight(nodes_of(block, element)); },
    [&](Index block, Index element, const Jacobian_bounds& bounds) {
      is_not_valid[number(block, element)] = bounds.verdict != Validity::valid;
    });
  if (is_wrong_.empty())
    is_wrong_ = is_not_valid;
  for (std::size_t c = 0; c < count; ++c)
    if (is_not_valid[c])
      ++(is_wrong_[c] ? stage.wrong_before : stage.inverted);
  history_.stages.push_back(std::move(stage));
}

void Jacobian_recorder::record_straight(const Curved_mesh& mesh)
{
  add_stage(mesh, mesh.nodes, "straight", [](std::span<const Index>) { return true; });
}

void Jacobian_recorder::record(const Curved_mesh& mesh, std::span<const Point> nodes,
                               std::span<const Node_state> states, std::string name)
{
  add_stage(mesh, nodes, std::move(name), [&](std::span<const Index> cell) {
    return std::ranges::none_of(cell, [&](Index n) { return is_displaced(states[static_cast<std::size_t>(n)]); });
  });
}

} // namespace recurve
