#ifndef RECURVE_RUN_SELECT_PATCHES_H
#define RECURVE_RUN_SELECT_PATCHES_H

#include <recurve/mesh/boundary_faces.h>
#include <recurve/mesh/volume_mesh.h>

#include <cstdint>
#include <string>
#include <vector>

namespace recurve {

/// The faces of a mesh that are to be curved: per zone and face of the zone, 1 or 0.
using Face_selection = std::vector<std::vector<std::uint8_t>>;

/// picks the faces of the patches that `curve` names and `keep` does not. An entry is the name of a patch (in whatever
/// zones it occurs), "zone/patch", or the name of a family, which means its patches; each may hold the wildcards of the
/// shell: `*`, `?` and `[...]`. An exact name goes before a wildcard.
///
/// If `curve` is empty, all faces on the boundary are picked, and none inside the mesh; what lies inside (two-sided
/// patches, interfaces of zones) is picked only if it is named. Faces without a cell are never picked.
///
/// \throws Input_error for an entry that matches nothing, with the names that are nearest and all that there are.
Face_selection select_patches(const Volume_mesh& mesh, const Boundary_faces& faces,
                              const std::vector<std::string>& curve, const std::vector<std::string>& keep);

} // namespace recurve

#endif
