#ifndef RECURVE_IO_HOPR_SIDES_H
#define RECURVE_IO_HOPR_SIDES_H

#include <recurve/mesh/curved_mesh.h>

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace recurve::internal::hopr {

/// A boundary condition of the file.
struct Condition
{
  std::string name;
  std::array<std::int32_t, 4> type = {2, 0, 0, 0}; ///< BoundaryType, CurveIndex, StateIndex, PeriodicIndex
};

/// Cells of all zones under one number, in the order of the file.
class Ordered_cells
{
public:
  explicit Ordered_cells(const Curved_mesh& mesh);

  Index count() const { return static_cast<Index>(order_.size()); }
  Element_type type(Index element) const { return blocks_[block_of(element)].section->type; }
  std::size_t zone(Index element) const { return blocks_[block_of(element)].zone; }

  /// nodes of the mesh, canonical order.
  std::span<const Index> nodes(Index element) const;

  const Point& barycentre(Index element) const
  {
    return barycentres_[static_cast<std::size_t>(order_[static_cast<std::size_t>(element)])];
  }

private:
  struct Block
  {
    Index first = 0;
    std::size_t zone = 0;
    const Curved_section* section = nullptr;
  };

  std::size_t block_of(Index element) const;

  int degree_;
  std::vector<Block> blocks_;
  std::vector<Point> barycentres_; ///< mean of the corners, as HOPR has it; in the order of the mesh
  std::vector<Index> order_;       ///< number in the mesh, by number in the file
};

/// What SideInfo says of a side.
struct Side
{
  std::int32_t global_id = 0;    ///< from 1; negative: the slave of two connected sides
  std::int32_t neighbor = 0;     ///< element, from 1; 0: none
  std::int8_t neighbor_side = 0; ///< from 1
  std::int8_t flip = 0;          ///< which corner of the neighbour's side is the first of this side, from 1
  std::int16_t condition = 0;    ///< from 1; 0: none
};

/// The sides of all elements, element by element.
struct Side_table
{
  std::vector<Index> first_side; ///< per element, and the count at the end
  std::vector<Side> sides;
  std::vector<Condition> conditions;
  Index unique_count = 0;
};

/// \throws Input_error for cells that overlap or are inside out.
Side_table connect_sides(const Curved_mesh& mesh, const Ordered_cells& cells);

/// \throws Input_error if 32-bit numbers do not count so many nodes or sides.
void check_counts(Index nodes, Index sides);

} // namespace recurve::internal::hopr

#endif
