#ifndef RECURVE_SRC_RUN_CERTIFY_H
#define RECURVE_SRC_RUN_CERTIFY_H

#include "periodic_motion.h"

#include <recurve/core/progress.h>
#include <recurve/mesh/curved_mesh.h>
#include <recurve/run/certification.h>
#include <recurve/run/select_patches.h>
#include <recurve/volume/node_state.h>
#include <recurve/volume/restoration_report.h>

#include <span>

namespace recurve {

/// certifies a curved mesh and gives up curvature where that fails, so that each cell whose straight-sided self is
/// valid is certified valid: see restore_validity().
///
/// \pre the corners of `mesh` are where its straight-sided cells have them.
/// \param states       per node; one that was `placed` is on a curved surface.
/// \param is_boundary  per zone and face of the zone: whether it bounds the mesh, or is curved.
/// \param periodic     nodes on the two sides of periodic patches: they give up curvature together, and stay congruent.
/// \throws Input_error if an option is out of range; Cancelled.
Certification certify_and_restore(Curved_mesh& mesh, std::span<const Node_state> states,
                                  const Face_selection& is_boundary, std::span<const Periodic_nodes> periodic,
                                  const Restoration_options& options, const Progress_callback& progress);

} // namespace recurve

#endif
