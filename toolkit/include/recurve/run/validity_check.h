#ifndef RECURVE_RUN_VALIDITY_CHECK_H
#define RECURVE_RUN_VALIDITY_CHECK_H

#include <recurve/core/progress.h>
#include <recurve/io/vtk.h>
#include <recurve/mesh/curved_mesh.h>
#include <recurve/volume/jacobian_bounds.h>

#include <cstddef>
#include <string>
#include <vector>

namespace recurve {

/// A cell, for people to find it.
struct Cell_verdict
{
  std::string zone;
  Index cell = no_index; ///< of the zone, through all its sections
  Element_type type = Element_type::tetrahedron;
  Validity verdict = Validity::undecided;
  double scaled = -1;               ///< `Jacobian_bounds::scaled`
  Point position = {};              ///< mean of its corners
  std::vector<std::string> patches; ///< that share a corner with it, sorted; of any zone
};

/// What is proven about each cell of a mesh; cells are counted zone by zone, section by section.
struct Cell_bounds
{
  std::vector<double> scaled; ///< `Jacobian_bounds::scaled`
  std::vector<Validity> verdicts;

  Cell_bounds() = default;
  explicit Cell_bounds(Index cells)
    : scaled(static_cast<std::size_t>(cells)), verdicts(static_cast<std::size_t>(cells), Validity::undecided)
  {}
};

/// What is proven about a mesh.
struct Validity_check
{
  int degree = 1;
  Index cells = 0;
  Jacobian_report jacobians;
  std::vector<Cell_verdict> worst; ///< the cells with the smallest certified scaled Jacobian, worst first
  Cell_bounds bounds;

  bool is_valid() const { return jacobians.total().valid == cells; }
};

/// certifies every cell of a mesh, straight or curved. Cells that are exactly straight take the test of their corners.
/// \param worst  how many cells to list.
/// \throws Input_error if an option is out of range; Cancelled.
/// \par Complexity  as bound_jacobians(); 9 bytes per cell.
Validity_check check_validity(const Curved_mesh& mesh, std::size_t worst = 10, const Jacobian_options& options = {},
                              const Progress_callback& progress = {});

/// describes the cells with the numbers `cells` (through the whole mesh).
std::vector<Cell_verdict> describe_cells(const Curved_mesh& mesh, const Cell_bounds& bounds,
                                         const std::vector<Index>& cells);

/// numbers of the `count` cells with the smallest scaled Jacobian, ascending by it and then by number.
std::vector<Index> worst_cells(const Cell_bounds& bounds, std::size_t count);

/// "scaled_jacobian" and "verdict" (0 valid, 1 invalid, 2 undecided) to be written beside the mesh.
std::vector<Cell_field> cell_fields(const Cell_bounds& bounds);

/// "valid", "invalid" or "undecided".
std::string_view to_string(Validity verdict);

/// the check as a JSON object; its keys are documented in doc/report.md.
std::string to_json(const Validity_check& check);

} // namespace recurve

#endif
