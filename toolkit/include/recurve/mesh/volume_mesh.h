#ifndef RECURVE_MESH_VOLUME_MESH_H
#define RECURVE_MESH_VOLUME_MESH_H

#include <recurve/core/types.h>
#include <recurve/elements/element.h>

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace recurve {

/// Elements of one type under one name: a CGNS section, a Gmsh entity.
struct Section
{
  std::string name;
  Element_type type = Element_type::tetrahedron;
  std::vector<Index> nodes; ///< corner_count(type) per element, one after the other, numbers of points of the zone

  Index size() const { return static_cast<Index>(nodes.size()) / corner_count(type); }
};

/// A named boundary patch: a set of faces of its zone.
struct Patch
{
  std::string name;
  std::string kind = "BCTypeUserDefined"; ///< CGNS BCType name: BCWall, BCSymmetryPlane, FamilySpecified, ...
  std::string family;                     ///< name of a family of the mesh, or empty
  std::vector<Index> faces;               ///< faces of the zone, ascending; see Zone::faces
};

/// Rigid map that takes a patch or interface to its periodic partner: x -> R(angle) (x - center) + center +
/// translation.
struct Periodicity
{
  Point rotation_center = {};
  Point rotation_angle = {}; ///< about x, then y, then z; radians
  Point translation = {};
};

/// A connection of this zone with another (or with itself, when periodic), as the file states it.
struct Zone_interface
{
  enum class Location : std::uint8_t
  {
    vertex, ///< `points` and `donor_points` are points of the zones
    face    ///< they are faces of the zones; see Zone::faces
  };

  std::string name;
  std::string donor_zone; ///< name of the other zone
  Location location = Location::vertex;
  bool is_abutting_one_to_one = true; ///< else the connection is kept as a name only (CGNS Abutting, Overset)
  std::vector<Index> points;
  std::vector<Index> donor_points; ///< same length; points[m] meets donor_points[m]
  std::optional<Periodicity> periodicity;
};

/// A free text that came with the file.
struct Descriptor
{
  std::string name;
  std::string text;
};

/// Points, cells and named boundary of one zone.
struct Zone
{
  std::string name;
  std::string family;
  std::vector<Point> points;
  std::vector<Section> cells; ///< of dimension 3; the zone's cells are numbered through all sections
  std::vector<Section>
    faces; ///< triangles and quadrangles; numbered through all sections; a face belongs to at most one patch
  std::vector<Section> bars; ///< lines that came with the file
  std::vector<Patch> patches;
  std::vector<Zone_interface> interfaces;
  std::vector<Descriptor> descriptors;

  Index cell_count() const;
  Index face_count() const;
};

/// A named group that patches and zones refer to.
struct Family
{
  std::string name;
  std::string kind; ///< CGNS BCType name, or empty
};

/// Linear mesh of straight-sided cells, as it came from the file. Patches and interfaces refer to faces by their number
/// in the zone, so that the same description serves the curved mesh.
struct Volume_mesh
{
  std::string name = "Base"; ///< of the CGNS base
  std::vector<Family> families;
  std::vector<Zone> zones;
  std::vector<Descriptor> descriptors;
  std::array<std::string, 5> units; ///< CGNS mass, length, time, temperature, angle; empty strings: none given

  Index cell_count() const;
};

/// the zone named `name`, or null. \par Complexity  linear in the zones.
const Zone* find_zone(const Volume_mesh& mesh, std::string_view name);

/// Where an element of a zone stands: section and number inside it.
struct Section_entry
{
  Index section = no_index;
  Index element = no_index;
};

/// finds element `number`, counted through all of `sections`; both fields are no_index if there is none.
/// \par Complexity  linear in the sections.
Section_entry find_element(const std::vector<Section>& sections, Index number);

} // namespace recurve

#endif
