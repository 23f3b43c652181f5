#ifndef RECURVE_IO_UGRID_H
#define RECURVE_IO_UGRID_H

#include <recurve/core/progress.h>
#include <recurve/io/zonal_mesh.h>

#include <filesystem>

namespace recurve {

/// reads a linear mesh in the UGRID format of AFLR3 and FUN3D: binary (name.b8.ugrid and .b4.ugrid big endian,
/// .lb8.ugrid and .lb4.ugrid little endian, with 8 or 4 bytes per coordinate) or text (name.ugrid).
///
/// Each surface number is a patch. Its name and kind come from the file name.mapbc beside it where there is one, else it
/// is "surface_N". What may follow the elements (volume numbers, reconnection flags, ...) is not read.
/// \throws Format_error naming element and node; for Fortran records (.r8, .lr8) and meshes without cells.
/// \par Complexity  linear.
Zonal_mesh read_ugrid(const std::filesystem::path& file, Read_report* report = nullptr,
                      const Progress_callback& progress = {});

} // namespace recurve

#endif
