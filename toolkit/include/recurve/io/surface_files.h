#ifndef RECURVE_IO_SURFACE_FILES_H
#define RECURVE_IO_SURFACE_FILES_H

#include <recurve/core/progress.h>
#include <recurve/mesh/curved_mesh.h>

#include <filesystem>

namespace recurve {

/// write the faces of all patches as a surface of triangles and quadrangles, for programs that look at surfaces or work
/// on them. A face of degree p becomes p^2 straight pieces between its nodes, which zones and neighbours share; nodes
/// of no patch are left out, the others keep their order and their coordinates to the bit.
///
/// - OFF: text.
/// - PLY: binary, little endian, double precision, with the number of the patch as face property `patch`; the names of
///   patches, counted from 0, are comments.
/// - VTP: VTK XML, with cell data `patch` and field data `patch_names`.
///
/// \throws Input_error for a mesh without patches, or PLY of more than 2^31 - 1 nodes; Format_error if writing fails.
/// No file is left then. \par Complexity  linear; 8 bytes per node of the mesh.
void write_off(const Curved_mesh& mesh, const std::filesystem::path& file, const Progress_callback& progress = {});
void write_ply(const Curved_mesh& mesh, const std::filesystem::path& file, const Progress_callback& progress = {});
void write_vtp(const Curved_mesh& mesh, const std::filesystem::path& file, const Progress_callback& progress = {});

} // namespace recurve

#endif
