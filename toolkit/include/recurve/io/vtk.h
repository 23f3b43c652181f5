#ifndef RECURVE_IO_VTK_H
#define RECURVE_IO_VTK_H

#include <recurve/core/progress.h>
#include <recurve/io/zonal_mesh.h>
#include <recurve/mesh/curved_mesh.h>

#include <filesystem>
#include <string>
#include <vector>

namespace recurve {

/// A named value per cell, written beside the mesh; cells are counted zone by zone, section by section.
struct Cell_field
{
  std::string name;
  std::vector<double> values; ///< one per cell of the mesh, all zones
};

/// writes the cells of a mesh of any degree, and the faces of its patches, as Lagrange cells: VTK XML (VTU) version
/// 2.2, 64-bit headers, appended raw data, little endian. VTK and ParaView 9.1 or later read it.
///
/// The file holds first the cells, zone by zone and section by section, then the faces of patches in the same order.
/// Points are the nodes of the mesh in their order. VTK has no Lagrange pyramid, so a pyramid is written as the
/// Lagrange hexahedron whose top face is collapsed onto the apex: the same map, exactly; those of its nodes that the
/// pyramid does not have follow the nodes of the mesh as extra points.
///
/// Cell data of the file:
/// - `zone`: number of the zone; its name is entry `zone` of the field data `zone_names`
/// - `patch`: number of the patch, -1 for cells; name in `patch_names`. Patches of one name share one number
/// - `element_type`: `Element_type`; name in `element_type_names`. Tells pyramids from hexahedra
/// - `is_straight`: 1 where `Curved_zone::is_straight` says so, else 0; -1 for faces
/// - each of `fields`: NaN for faces
///
/// The field data `pyramid_nodes` list the nodes of pyramids in canonical order, for read_vtu().
///
/// \throws Input_error if a field has not one value per cell, or a name that is taken or empty; Format_error if writing
/// fails; no file is left then. \par Complexity  linear; memory for one number per face, the rest is streamed.
void write_vtu(const Curved_mesh& mesh, const std::filesystem::path& file, const std::vector<Cell_field>& fields = {},
               const Progress_callback& progress = {});

/// reads what write_vtu() wrote: zones, patches and every node of cells and patches to the bit. The files of other
/// programs are refused, since they say nothing of zones and patches, nor which hexahedra are pyramids.
/// \throws Format_error naming point and cell. \par Complexity  linear.
Zonal_mesh read_vtu(const std::filesystem::path& file, Read_report* report = nullptr,
                    const Progress_callback& progress = {});

} // namespace recurve

#endif
