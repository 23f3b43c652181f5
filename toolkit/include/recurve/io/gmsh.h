#ifndef RECURVE_IO_GMSH_H
#define RECURVE_IO_GMSH_H

#include <recurve/core/progress.h>
#include <recurve/io/zonal_mesh.h>
#include <recurve/mesh/curved_mesh.h>

#include <cstdint>
#include <filesystem>

namespace recurve {

enum class Msh_version : std::uint8_t
{
  v2_2, ///< what MFEM reads
  v4_1  ///< what PyHOPE and, as text, PyFR read
};

struct Msh_options
{
  Msh_version version = Msh_version::v4_1;
  bool is_ascii = false; ///< numbers as text, with as many digits as restore them to the bit
};

/// writes a mesh of degree 1 to 6 as Gmsh MSH: complete elements, the nodes of zones that touch shared, in the order
/// and with the numbers (from 1) of the mesh.
///
/// - Each zone is a volume entity with a physical group of its name.
/// - Each patch is a surface entity; the patches of one name share a physical group. Faces in no patch form groups that
///   are named like their sections.
/// - Physical groups have numbers of their own through all dimensions, as PyFR wants it. Names are cut to Gmsh's 127
///   bytes and quotation marks become apostrophes; what is then one name gets numbers.
/// - Periodic connections of points become $Periodic links between surface entities.
///
/// Bars, families, kinds of boundary conditions, other connections, units and descriptors have no place in the format.
/// \throws Input_error for more than 2^31 - 1 nodes or elements in version 2.2; Format_error if writing fails. No file
/// is left then. \par Complexity  linear; memory for 12 bytes per node, the rest is streamed.
void write_msh(const Curved_mesh& mesh, const std::filesystem::path& file, const Msh_options& options = {},
               const Progress_callback& progress = {});

/// reads a Gmsh file of version 2.0 to 2.2 or 4.1, ASCII or binary of either byte order, also partitioned: complete
/// elements of one degree from 1 to 6.
///
/// - Each physical group of volumes is a zone; elements without one are the zone "volume". Zones that share nodes get
///   interfaces that say so.
/// - Each physical group of surfaces is a patch. Surfaces without one are sections in no patch.
/// - An element in several groups stays with the first. Points and lines, ghosts and the faces between partitions are
///   left out.
/// - $Periodic links of surfaces become periodic connections where their transformation is stated and rigid.
///
/// \throws Format_error that names line or byte: for what is cut short or contradicts itself, versions 1 and 4.0,
/// incomplete (serendipity) elements, several degrees, meshes without cells. \par Complexity  O(n log n) in the nodes
/// where their numbers have large gaps, else linear.
Zonal_mesh read_msh(const std::filesystem::path& file, Read_report* report = nullptr,
                    const Progress_callback& progress = {});

} // namespace recurve

#endif
