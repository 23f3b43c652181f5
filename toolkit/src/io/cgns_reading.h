#ifndef RECURVE_IO_CGNS_READING_H
#define RECURVE_IO_CGNS_READING_H

#include "cgns_names.h"
#include "cgns_tree.h"

#include <recurve/core/progress.h>
#include <recurve/io/zonal_mesh.h>
#include <recurve/mesh/volume_mesh.h>

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace recurve::internal::cgns {

/// Where the elements of one Elements_t node went. CGNS counts elements from 1 through all sections of a zone.
struct Element_block
{
  std::string name;
  Index first = 1, last = 0;
  Index first_face = no_index; ///< number in the zone of the face `first`, if all elements are faces of one type
  std::vector<Index> face_of;  ///< per element its face or no_index, where types are mixed
};

/// A zone while it is being read.
struct Zone_reading
{
  Cgns_node node;
  Zone zone;
  Zonal_elements elements; ///< of high order; empty for linear meshes
  bool is_structured = false;
  std::array<Index, 3> size = {}; ///< points in each direction, if structured
  std::vector<Element_block> blocks;
  bool has_overlapping_blocks = false;

  Index point_count() const { return static_cast<Index>(zone.points.size()); }
  /// number of the point at (i, j, k), counted from 0, in a structured zone.
  Index point_at(Index i, Index j, Index k) const { return i + size[0] * (j + size[1] * k); }
};

/// Everything that the steps of reading share.
struct Cgns_reading
{
  const Cgns_tree& tree;
  int version = 0;        ///< 3400 for 3.4
  int largest_degree = 1; ///< that the caller takes
  int degree = 0;         ///< of the elements seen so far; 0: none yet
  bool angles_in_degrees = false;
  std::vector<Zone_reading> zones;
  std::vector<std::string> notes;
};

/// PointList, PointRange, ElementList, ElementRange or a donor list, as numbers of the file (counted from 1).
struct Point_set
{
  bool is_range = false;   ///< `values` holds the first and the last index
  bool is_element = false; ///< ElementList or ElementRange
  std::vector<std::int64_t> values;
};

/// the point set below `node` that has one of `names`; none if there is none.
std::optional<Point_set> read_point_set(const Cgns_tree& tree, const Cgns_node& node,
                                        std::initializer_list<std::string_view> names);

/// text of the child with the label; empty without it.
std::string text_of(const Cgns_tree& tree, const Cgns_node& node, std::string_view label);

/// Descriptor_t children.
std::vector<Descriptor> read_descriptors(const Cgns_tree& tree, const Cgns_node& node);

/// reads Zone_t's size, the coordinates and the elements of one zone.
Zone_reading read_zone(Cgns_reading& reading, const Cgns_node& node);

/// reads the coordinates into `zone.zone.points`, `point_count` as the zone states.
void read_coordinates(Cgns_reading& reading, Zone_reading& zone, Index point_count);

/// reads the sections of an unstructured zone.
void read_sections(Cgns_reading& reading, Zone_reading& zone);

/// the names of the sections of a zone, taken.
Cgns_names section_names(const Zone& zone);

/// makes the hexahedra of a structured zone.
void make_structured_cells(Zone_reading& zone);

/// reads ZoneBC_t into patches.
void read_patches(Cgns_reading& reading, Zone_reading& zone);

/// the points that a vertex-located set names, counted from 0. `what` names zone and condition in messages.
std::vector<Index> points_of(const Cgns_tree& tree, const Zone_reading& zone, const Point_set& set,
                             std::string_view what);

/// the face of the zone with number `element` in the file; no_index if that element is no face.
/// \throws Format_error if no section has it.
Index face_of_element(const Cgns_tree& tree, const Zone_reading& zone, Index element, std::string_view what);

/// the quadrangles of a structured zone that a point range of a boundary condition stands for; empty if it is no
/// surface. `location` is the text of its GridLocation_t.
std::vector<std::array<Index, 4>> structured_faces(const Cgns_tree& tree, const Zone_reading& zone,
                                                   const Point_set& set, std::string_view location,
                                                   std::string_view what);

/// A boundary condition given by points, and the patch that it fills.
struct Vertex_patch
{
  Index patch = no_index;
  std::string name;
  std::string family;
  std::vector<Index> points; ///< ascending
};

/// assigns faces to patches that are given by points: faces of sections and boundary faces of cells, all of whose
/// corners are in the list. `patch_of_face` grows with the faces that are made.
void match_vertex_patches(Zone& zone, const std::vector<Vertex_patch>& patches, std::vector<Index>& patch_of_face,
                          std::vector<std::string>& notes);

/// reads the connections of all zones.
void read_interfaces(Cgns_reading& reading, const std::string& base_name);

} // namespace recurve::internal::cgns

#endif
