#ifndef RECURVE_RUN_CERTIFICATION_H
#define RECURVE_RUN_CERTIFICATION_H

#include <recurve/run/validity_check.h>
#include <recurve/volume/restoration_report.h>

#include <string>
#include <vector>

namespace recurve {

/// A curved face of the boundary that has lost curvature.
struct Reduced_face
{
  std::string zone, patch;
  Index face = no_index; ///< of the zone
  Point center = {};
  double factor = 0; ///< smallest share of their displacement that its nodes have kept
};

/// What is proven about a curved mesh, and what it took.
struct Certification
{
  bool is_checked = false;
  Restoration_report restoration;
  std::vector<Cell_verdict> excluded;    ///< wrong before curving: the promise leaves them out
  std::vector<Cell_verdict> uncertified; ///< promised, and not certified valid
  std::vector<Cell_verdict> worst;       ///< the cells with the smallest certified scaled Jacobian, worst first
  Cell_bounds bounds;                    ///< of the mesh as it is now
  std::vector<double> factors; ///< per cell, smallest share of its displacement that one of its nodes has kept

  Index curved_faces = 0;                  ///< faces on curved boundaries, of which a node was displaced
  double curved_area = 0;                  ///< of their straight-sided selves
  double full_area = 0;                    ///< of those that kept all of their displacement
  std::vector<Reduced_face> reduced_faces; ///< the others, in the order of zones and faces

  /// share of the curved boundary that kept all of its curvature; 1 if nothing is curved.
  double full_share() const { return curved_area > 0 ? full_area / curved_area : 1; }

  /// whether every promised cell is certified valid.
  bool is_certified() const { return is_checked && uncertified.empty(); }
};

/// those of the bounds, and "curving_factor", to be written beside the mesh; none if it was not checked.
std::vector<Cell_field> cell_fields(const Certification& certification);

} // namespace recurve

#endif
