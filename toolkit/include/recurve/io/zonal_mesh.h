#ifndef RECURVE_IO_ZONAL_MESH_H
#define RECURVE_IO_ZONAL_MESH_H

#include <recurve/mesh/curved_mesh.h>
#include <recurve/mesh/volume_mesh.h>

#include <string>
#include <vector>

namespace recurve {

/// What reading a file had to decide or leave out, one sentence each, with zone and section.
struct Read_report
{
  std::vector<std::string> notes;
};

/// The elements of one zone with all their nodes, by points of the zone; sections as in the linear zone.
struct Zonal_elements
{
  std::vector<Curved_section> cells, faces, bars;
};

/// A mesh of one degree as files have it: the nodes of each zone by themselves. What every reader makes, and what
/// becomes a `Volume_mesh` (of degree 1) or a `Curved_mesh`.
struct Zonal_mesh
{
  int degree = 1;
  Volume_mesh linear; ///< the points of its zones are all nodes, its sections hold the corners
  std::vector<Zonal_elements>
    zones; ///< empty for degree 1. Sections of faces may be missing at the end: their nodes are those of their cells
};

/// makes the nodes unique across zones: those of corners where `join_zones()` joins the zones, the others where they
/// are the same node of the same edge or face and lie within that function's tolerance; then the position in the first
/// zone counts, and `report` says if the other one differed. Nodes that are no corner leave `linear`, as do interfaces
/// of them. Every other coordinate is kept to the bit. \throws Input_error if a face without nodes belongs to no cell.
/// \par Complexity  linear in the mesh, O(n log n) in the nodes that zones share.
Curved_mesh to_curved_mesh(Zonal_mesh mesh, Read_report* report = nullptr);

} // namespace recurve

#endif
