#ifndef RECURVE_DATA_GENERATE_MESH_BUILDER_H
#define RECURVE_DATA_GENERATE_MESH_BUILDER_H

#include <recurve/mesh/volume_mesh.h>

#include <map>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace recurve::generate {

/// Collects points, cells and named boundary faces of a small mesh of one zone, in any order.
class Mesh_builder
{
public:
  explicit Mesh_builder(std::string zone_name) : zone_name_(std::move(zone_name)) {}

  /// \returns the number of the point.
  Index add_point(const Point& point);

  /// number of points so far.
  Index point_count() const { return static_cast<Index>(points_.size()); }

  void add_cell(Element_type type, std::span<const Index> corners);

  /// says what a patch is, by the name of a CGNS BCType; without this it is "BCTypeUserDefined".
  void set_patch_kind(const std::string& patch, const std::string& kind) { kind_of_patch_[patch] = kind; }

  /// adds a face to patch `patch`; 3 or 4 corners, in either orientation.
  void add_face(const std::string& patch, std::span<const Index> corners);

  /// the mesh: one section per type of cell, one per patch and type of face, faces oriented outward.
  /// \throws Input_error if the faces are not exactly the faces that belong to one cell only.
  Volume_mesh build() const;

private:
  std::string kind_of(const std::string& patch) const;

  std::string zone_name_;
  std::vector<Point> points_;
  std::map<Element_type, std::vector<Index>> cells_;
  std::map<std::pair<std::string, Element_type>, std::vector<Index>> faces_;
  std::map<std::string, std::string> kind_of_patch_;
};

/// the volume of a cell whose edges are straight and whose quadrangles are the bilinear surfaces of their corners;
/// positive if the corners are numbered as in `Reference_element`.
double cell_volume(Element_type type, std::span<const Index> corners, const std::vector<Point>& points);

} // namespace recurve::generate

#endif
