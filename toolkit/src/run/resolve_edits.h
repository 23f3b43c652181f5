#ifndef RECURVE_SRC_RUN_RESOLVE_EDITS_H
#define RECURVE_SRC_RUN_RESOLVE_EDITS_H

#include <recurve/mesh/boundary_surface.h>
#include <recurve/mesh/join_zones.h>
#include <recurve/run/feature_file.h>

#include <vector>

namespace recurve {

/// the edits of `file` in terms of `surface.mesh`: nodes of zones become its vertices, names of patches the numbers of
/// `patch_numbers()`.
/// \throws Input_error for a zone, node or patch that is not there or not on the surface, with the edit's origin.
std::vector<Feature_edit> resolve_edits(const Feature_file& file, const Volume_mesh& mesh, const Joined_zones& joined,
                                        const Boundary_surface& surface);

/// per face of `surface.mesh` a number for the name of its patch; patches of one name share it. -2: no patch.
std::vector<Index> patch_numbers(const Volume_mesh& mesh, const Boundary_surface& surface);

} // namespace recurve

#endif
