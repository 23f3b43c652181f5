#ifndef RECURVE_IO_CGNS_H
#define RECURVE_IO_CGNS_H

#include <recurve/core/progress.h>
#include <recurve/io/zonal_mesh.h>
#include <recurve/mesh/curved_mesh.h>
#include <recurve/mesh/volume_mesh.h>

#include <filesystem>

namespace recurve {

/// reads the first 3D base of a linear CGNS file: HDF5 or ADF, of any version, with links to other files.
///
/// - Mixed sections become one section per element type; NODE elements are left out.
/// - Structured zones become hexahedra; their boundary conditions quadrangles, their 1to1 connections pairs of points.
/// - Boundary conditions may name elements or points. Points stand for the faces, all of whose corners are among them:
///   faces of sections, else boundary faces of cells. Conditions on cells, edges or nothing are left out.
/// - A face that several conditions name stays with the first.
/// - Connections that pair nothing one to one (Overset, Abutting) are kept by name.
/// - Solutions and all else are not read.
///
/// Cells and faces come as the file has them: not oriented, zones not joined, boundary faces without condition not
/// added. A file with faces but without cells is read, with a note.
///
/// \throws Format_error, in one line that names file, zone, section, element and node as far as they are known: for
/// files that are unreadable, cut short or contradict themselves, for NaN and infinite coordinates, polyhedra, elements
/// of high order, meshes that are empty or not 3D. Cancelled if `progress` says so. \par Complexity  linear in the
/// file; the mesh and a few MiB.
Volume_mesh read_cgns(const std::filesystem::path& file, Read_report* report = nullptr,
                      const Progress_callback& progress = {});

/// the same for meshes of degree 1 to 4: of high order the complete element families, and one degree for all elements
/// of the mesh, faces and bars too.
Zonal_mesh read_curved_cgns(const std::filesystem::path& file, Read_report* report = nullptr,
                            const Progress_callback& progress = {});

/// writes a mesh of degree 1 to 4 as CGNS/HDF5 with the stamp 3.4, which libraries from 3.0 on read: complete element
/// families, one section per type, never mixed; double precision; 32-bit numbers.
///
/// Names, families, boundary conditions (on faces), connections (of points or faces, as in `mesh.linear`), descriptors
/// and units are those of `mesh.linear`; names are cut to CGNS's 32 bytes and told apart by a number. The rotation and
/// translation of periodic connections are in single precision, as CGNS has them. Connections without points are left
/// out: CGNS has none. Sections of more than 2^31 - 1 node numbers are split.
///
/// \throws Input_error for other degrees, and for zones of more than 2^31 - 1 nodes or elements; Format_error if
/// writing fails, for example on a full disk; Cancelled if `progress` says so. No file is left then, nor one that was
/// there. \par Complexity  linear in the mesh; beside it, 4 bytes per node and a few MiB.
void write_cgns(const Curved_mesh& mesh, const std::filesystem::path& file, const Progress_callback& progress = {});

} // namespace recurve

#endif
