#ifndef RECURVE_IO_HOPR_H
#define RECURVE_IO_HOPR_H

#include <recurve/core/progress.h>
#include <recurve/io/zonal_mesh.h>
#include <recurve/mesh/curved_mesh.h>

#include <filesystem>

namespace recurve {

/// writes a mesh of any degree in the HDF5 format of HOPR, version 1.0, which FLEXI and PyHOPE read; FLEXI takes
/// hexahedra only.
///
/// - Elements stand along a Hilbert curve through their barycentres, with neighbours, flips and boundary conditions of
///   all sides and unique numbers of sides and nodes.
/// - Each name of a patch is a boundary condition. Its type is 1 if it is periodic, 100 if it lies inside the mesh, 3
/// for
///   viscous walls, 9 for inviscid walls and symmetry planes, 2 for all else; solvers let users overrule it by name.
///   Sides on the boundary that are in no patch get the condition "unassigned".
/// - Periodic connections of points become connected sides.
/// - Zones are numbered; an extra array ZoneNames, which other programs ignore, keeps their names.
///
/// \throws Input_error for more than 2^31 - 1 nodes or sides, counted per element, and for cells that overlap, are
/// inside out or have a side in two patches; Format_error if writing fails. No file is left then. \par Complexity  O(n
/// log n) in the cells; memory: 32 bytes per cell and 16 per side of a cell.
void write_hopr(const Curved_mesh& mesh, const std::filesystem::path& file, const Progress_callback& progress = {});

/// reads a mesh in the HDF5 format of HOPR of degree 1 to 6, without hanging nodes.
///
/// Boundary conditions become patches, those of type 1 with a periodic connection if its sides are translated; zones
/// are named by ZoneNames or "zone_N". Elements keep the order of the file, type by type. \throws Format_error that
/// names array, element and node: for files that are damaged or contradict themselves. \par Complexity  linear.
Zonal_mesh read_hopr(const std::filesystem::path& file, Read_report* report = nullptr,
                     const Progress_callback& progress = {});

} // namespace recurve

#endif
