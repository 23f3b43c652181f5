#ifndef RECURVE_IO_SU2_H
#define RECURVE_IO_SU2_H

#include <recurve/core/progress.h>
#include <recurve/io/zonal_mesh.h>

#include <filesystem>

namespace recurve {

/// reads a 3D mesh in SU2's text format, of one zone or several (NZONE): linear, or of one degree up to 6 with the
/// element codes of SU2's discontinuous Galerkin solver (100 (degree - 1) + VTK type, nodes row by row).
///
/// Each marker is a patch. Markers of SEND_RECEIVE, periodic data and free-form deformation boxes are left out.
/// \throws Format_error that names the line. \par Complexity  linear.
Zonal_mesh read_su2(const std::filesystem::path& file, Read_report* report = nullptr,
                    const Progress_callback& progress = {});

} // namespace recurve

#endif
