#ifndef RECURVE_MESH_CHECK_MESH_H
#define RECURVE_MESH_CHECK_MESH_H

#include <recurve/mesh/volume_mesh.h>

namespace recurve {

/// checks everything that the functions on a `Volume_mesh` rely on: there are zones, each of its own name and with
/// points and cells; sections of cells, faces and bars hold elements of their dimension and whole elements; node
/// numbers name points of their zone; coordinates are finite; patches and interfaces name faces and points that exist,
/// a patch in ascending order, and no face is in two patches; the ends of an interface are equally many.
///
/// Whoever fills a `Volume_mesh` from outside calls this once; the caller adds the name of the file.
/// \throws Input_error that names zone, section, element and node of the first fault. Elements (inside their section)
/// and nodes are counted from 1 in the message, as most formats do.
/// \par Complexity  linear.
void check_mesh(const Volume_mesh& mesh);

} // namespace recurve

#endif
