#ifndef RECURVE_SRC_RUN_DEFORM_MESH_H
#define RECURVE_SRC_RUN_DEFORM_MESH_H

#include <recurve/core/progress.h>
#include <recurve/mesh/curved_mesh.h>
#include <recurve/run/curving_options.h>
#include <recurve/run/deformation_summary.h>
#include <recurve/run/select_patches.h>
#include <recurve/volume/node_state.h>

#include <vector>

namespace recurve {

/// moves the nodes of patches that are not curved, and of the interior, after the curved surface: see
/// doc/deform_interior.md for the order and the reasons. Corners stay where they are.
///
/// \param mesh       straight but for the nodes in state `Node_state::placed`.
/// \param states     on exit `Node_state::blended` for every node that was moved here.
/// \param is_source  per zone and face of the zone: whether its nodes are sources: all faces on the boundary, and those
///                   inside the mesh that are curved.
/// \throws Input_error if an option is out of range; Cancelled.
Deformation_summary deform_mesh(Curved_mesh& mesh, std::vector<Node_state>& states, const Face_selection& is_source,
                                const Curving_options& options, const Progress_callback& progress);

} // namespace recurve

#endif
