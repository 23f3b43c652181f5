#ifndef RECURVE_MESH_BOUNDARY_FACES_H
#define RECURVE_MESH_BOUNDARY_FACES_H

#include <recurve/mesh/join_zones.h>
#include <recurve/mesh/volume_mesh.h>

#include <cstdint>
#include <string>
#include <tuple>
#include <vector>

namespace recurve {

/// A face of a cell: zone, cell of the zone, face of `Reference_element::faces`.
struct Cell_face
{
  Index zone = no_index;
  Index cell = no_index;
  int face = -1;

  friend bool operator==(const Cell_face&, const Cell_face&) = default;
  friend bool operator<(const Cell_face& a, const Cell_face& b)
  {
    return std::tie(a.zone, a.cell, a.face) < std::tie(b.zone, b.cell, b.face);
  }
};

/// What stands on the two sides of a face of a zone (`Zone::faces`).
struct Face_owners
{
  Cell_face first;  ///< the cell whose outward normal the surface takes; no_index: no cell has this face
  Cell_face second; ///< no_index on the boundary; set for faces inside the volume (patches inside, zone interfaces)
};

/// Where a face stands.
enum class Face_place : std::uint8_t
{
  boundary,       ///< side of one cell
  inside,         ///< between two cells of one zone: a patch with two sides
  zone_interface, ///< between cells of two zones; never a wall
  nowhere         ///< side of no cell
};

Face_place place_of(const Face_owners& owners);

/// What `find_boundary_faces()` found, and the faults in the description of the boundary.
struct Boundary_report
{
  Index boundary_faces = 0;     ///< faces of exactly one cell, after joining the zones
  Index interface_faces = 0;    ///< pairs of faces of cells of different zones
  Index unassigned_faces = 0;   ///< boundary faces that no face of a section covered; now in the patch "unassigned" of
                                ///< their zone
  Index faces_without_cell = 0; ///< faces of sections that no cell has
  Index duplicate_faces = 0;    ///< faces listed again by their own patch, or oftener than they have sides
  Index crowded_faces = 0;      ///< faces of more than two cells: cells overlap
  std::vector<std::string> internal_patches;  ///< "zone/patch" with faces between two cells of one zone
  std::vector<std::string> interface_patches; ///< "zone/patch" with faces between two zones

  Boundary_report& operator+=(const Boundary_report& other);
};

/// Cells behind the faces of a mesh.
struct Boundary_faces
{
  std::vector<std::vector<Face_owners>> owners; ///< per zone and face of the zone
  Boundary_report report;
};

/// finds the cells behind every face of every zone, orients each face as its first cell does (outward), and adds a face
/// (in sections "unassigned_triangle", "unassigned_quadrangle" and the patch "unassigned") for every boundary face of a
/// cell that no face covers. Faces in a section but in no patch become a patch named like their section. Existing faces
/// keep their numbers; their corners are reversed where needed, from the first corner on. Two faces of cells match when
/// their joined vertices do.
///
/// The first cell is one of the face's own zone if there is one, the smallest by number. A face inside the volume that
/// two patches of one zone list (a baffle named from both sides) gives its second side to the second patch. \par
/// Complexity  linear in the cells but for sorting the few faces at each vertex; 8 bytes per face of a cell.
Boundary_faces find_boundary_faces(Volume_mesh& mesh, const Joined_zones& joined);

} // namespace recurve

#endif
