#ifndef RECURVE_RUN_DEFORMATION_SUMMARY_H
#define RECURVE_RUN_DEFORMATION_SUMMARY_H

#include <recurve/volume/deformation_options.h>

namespace recurve {

/// What followed the curved surface.
struct Deformation_summary
{
  double length = 0;               ///< L of the formula, in the unit of the mesh; 0: nothing was curved
  Index planar_patches = 0;        ///< planar parts of the boundary that followed their rim
  Index planar_nodes = 0;          ///< nodes in them that moved
  Index periodic_pairs = 0;        ///< nodes of periodic patches that move as another one does
  Index blended_face_nodes = 0;    ///< nodes inside other faces that follow a displaced edge
  Deformation_report field;        ///< the motion that the formula gives to all nodes inside the volume
  Index moved_nodes = 0;           ///< nodes of the interior that moved, planar patches included
  Index negligible_nodes = 0;      ///< nodes whose motion was dropped as it would bend nothing
  double largest_displacement = 0; ///< of a node that was moved, in the unit of the mesh
};

} // namespace recurve

#endif
