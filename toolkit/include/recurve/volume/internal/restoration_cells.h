#ifndef RECURVE_VOLUME_INTERNAL_RESTORATION_CELLS_H
#define RECURVE_VOLUME_INTERNAL_RESTORATION_CELLS_H

#include <recurve/core/exceptions.h>
#include <recurve/core/types.h>
#include <recurve/elements/element.h>
#include <recurve/volume/element_block.h>
#include <recurve/volume/internal/bound_elements.h>
#include <recurve/volume/restoration_report.h>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <span>
#include <string>
#include <unordered_map>
#include <vector>

namespace recurve::internal {

/// \throws Input_error if the arguments of `restore_validity()` do not fit together.
inline void check_restoration(std::span<const Element_block> blocks, int degree, std::size_t nodes,
                              std::size_t straight, std::size_t roles, std::size_t factors,
                              std::span<const std::array<Index, 2>> linked, const Restoration_options& options)
{
  check_options(options.jacobian);
  const auto same = [&](const char* what, std::size_t count) {
    if (count != nodes)
      throw Input_error("restore_validity: " + std::to_string(nodes) + " nodes, but " + std::to_string(count) + " " +
                        what);
  };
  same("straight positions", straight);
  same("roles", roles);
  if (factors != 0)
    same("factors", factors);
  for (const Element_block& block : blocks)
  {
    check_element(block.type, degree);
    for (const Index node : block.nodes)
      if (node < 0 || node >= static_cast<Index>(nodes))
        throw Input_error("restore_validity: a " + std::string(element_name(block.type)) + " has node " +
                          std::to_string(node) + ", of " + std::to_string(nodes));
  }
  for (const auto& pair : linked)
    for (const Index node : pair)
      if (node < 0 || node >= static_cast<Index>(nodes))
        throw Input_error("restore_validity: linked node " + std::to_string(node) + ", of " + std::to_string(nodes));
  constexpr int most_layers = 100;
  if (options.repair_layers < 0 || options.repair_layers > most_layers || options.smoothing_layers < 0 ||
      options.smoothing_layers > most_layers)
    throw Input_error("restore_validity: layers have to be between 0 and " + std::to_string(most_layers));
}

/// The cells of all blocks, and a byte of flags for each.
class Restoration_cells
{
public:
  enum Flag : std::uint8_t
  {
    excluded = 1, ///< the promise leaves it out
    failing = 2,
    in_region = 4 ///< of a repair
  };

  Restoration_cells(std::span<const Element_block> blocks, int degree) : blocks_(blocks), degree_(degree)
  {
    for (const Element_block& block : blocks)
      flags_.emplace_back(block.nodes.size() / stride(block));
  }

  std::span<const Element_block> blocks() const { return blocks_; }
  int degree() const { return degree_; }
  const Element_block& block(Index number) const { return blocks_[static_cast<std::size_t>(number)]; }
  Element_type type(Block_element cell) const { return block(cell.block).type; }

  std::span<const Index> nodes(Block_element cell) const
  {
    const Element_block& b = block(cell.block);
    return b.nodes.subspan(static_cast<std::size_t>(cell.element) * stride(b), stride(b));
  }

  std::uint8_t& flags(Block_element cell)
  {
    return flags_[static_cast<std::size_t>(cell.block)][static_cast<std::size_t>(cell.element)];
  }
  bool has(Flag flag, Block_element cell) const
  {
    return (flags_[static_cast<std::size_t>(cell.block)][static_cast<std::size_t>(cell.element)] & flag) != 0;
  }

  /// the cells for which `predicate` holds, ascending. Called from several threads.
  template <class Predicate>
  std::vector<Block_element> select(const Predicate& predicate) const
  {
    std::vector<Block_element> result;
    for (Index b = 0; b < static_cast<Index>(blocks_.size()); ++b)
    {
      constexpr Index run = 1 << 14;
      const auto count = static_cast<Index>(flags_[static_cast<std::size_t>(b)].size());
      std::vector<std::vector<Block_element>> found(static_cast<std::size_t>((count + run - 1) / run));
      tbb::parallel_for(std::size_t(0), found.size(), [&](std::size_t r) {
        const Index first = static_cast<Index>(r) * run;
        for (Index e = first; e < std::min(count, first + run); ++e)
          if (predicate(Block_element{b, e}))
            found[r].push_back({b, e});
      });
      for (const auto& list : found)
        result.insert(result.end(), list.begin(), list.end());
    }
    return result;
  }

  std::vector<Block_element> with(Flag flag) const
  {
    return select([&](Block_element cell) { return has(flag, cell); });
  }

  /// which of `cells` are linked, directly or through others of them, by nodes for which `links` holds: for each the
  /// position in `cells` of one that stands for all that are linked with it.
  template <class Links>
  std::vector<std::size_t> clusters(std::span<const Block_element> cells, const Links& links) const
  {
    std::vector<std::size_t> parent(cells.size());
    std::iota(parent.begin(), parent.end(), std::size_t(0));
    const auto root = [&](std::size_t c) {
      while (parent[c] != c)
        c = parent[c] = parent[parent[c]];
      return c;
    };
    std::unordered_map<Index, std::size_t> cell_of_node;
    for (std::size_t c = 0; c < cells.size(); ++c)
      for (const Index node : nodes(cells[c]))
        if (links(node))
          if (const auto [found, is_new] = cell_of_node.try_emplace(node, c); !is_new)
            parent[root(c)] = root(found->second);
    for (std::size_t c = 0; c < cells.size(); ++c)
      parent[c] = root(c);
    return parent;
  }

  /// the cells that have a node with a mark, ascending.
  std::vector<Block_element> touching(std::span<const std::uint8_t> marks) const
  {
    return select([&](Block_element cell) {
      const auto own = nodes(cell);
      return std::any_of(own.begin(), own.end(), [&](Index n) { return marks[static_cast<std::size_t>(n)] != 0; });
    });
  }

private:
  std::size_t stride(const Element_block& b) const { return static_cast<std::size_t>(node_count(b.type, degree_)); }

  std::span<const Element_block> blocks_;
  int degree_;
  std::vector<std::vector<std::uint8_t>> flags_;
};

} // namespace recurve::internal

#endif
