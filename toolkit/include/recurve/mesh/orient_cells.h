#ifndef RECURVE_MESH_ORIENT_CELLS_H
#define RECURVE_MESH_ORIENT_CELLS_H

#include <recurve/mesh/volume_mesh.h>

#include <vector>

namespace recurve {

/// A cell by its zone and its number in the zone.
struct Cell_number
{
  Index zone = no_index;
  Index cell = no_index;

  friend bool operator==(const Cell_number&, const Cell_number&) = default;
};

/// What `orient_cells()` found; lists are ascending.
struct Orientation_report
{
  Index mirrored_cells = 0;                 ///< cells that were inside out and are not any more
  std::vector<Cell_number> invalid_cells;   ///< with corner Jacobians of both signs: folded, and left as they are
  std::vector<Cell_number> collapsed_cells; ///< with corner Jacobians that are zero to round-off, and none of the other
                                            ///< sign: flat, or with corners that coincide
};

/// turns cells that are inside out: a cell all of whose corner Jacobians are negative (or zero, but not all) gets its
/// corners renumbered as its mirror image does. The corner Jacobian is det of the three edges that leave a corner, as
/// the reference element orders them; the apex of a pyramid has none. Cells whose corners disagree are listed, not
/// touched; the report says what the input already has wrong.
/// \par Complexity  linear in the cells.
Orientation_report orient_cells(Volume_mesh& mesh);

} // namespace recurve

#endif
