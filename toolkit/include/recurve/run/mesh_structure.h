#ifndef RECURVE_RUN_MESH_STRUCTURE_H
#define RECURVE_RUN_MESH_STRUCTURE_H

#include <recurve/core/progress.h>
#include <recurve/mesh/boundary_faces.h>
#include <recurve/mesh/join_zones.h>
#include <recurve/mesh/orient_cells.h>
#include <recurve/mesh/volume_mesh.h>
#include <recurve/run/stages.h>

#include <vector>

namespace recurve {

/// What a mesh says only implicitly: how its cells stand, where its zones touch, which cells its faces belong to.
struct Mesh_structure
{
  Orientation_report orientation;
  Joined_zones joined;
  Boundary_faces boundary;
};

/// checks `mesh`, turns its inverted cells, joins its zones, and finds the cells behind its faces, which completes and
/// orients them: the part of a conversion that comes before any curving.
/// \throws Input_error as check_mesh() and join_zones(); Cancelled.
Mesh_structure find_structure(Volume_mesh& mesh, const Join_options& options, std::vector<Stage_time>& times,
                              const Progress_callback& progress = {});

} // namespace recurve

#endif
