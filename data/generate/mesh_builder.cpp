#include <generate/mesh_builder.h>

#include <recurve/core/exceptions.h>

#include <algorithm>
#include <array>

namespace recurve::generate {

namespace {

using Face_key = std::array<Index, 4>;

Face_key face_key(std::span<const Index> corners)
{
  Face_key key = {no_index, no_index, no_index, no_index};
  std::ranges::copy(corners, key.begin());
  std::ranges::sort(key);
  return key;
}

/// Faces of cells that were met once, with their corners as seen from outside.
using Boundary = std::map<Face_key, std::vector<Index>>;

void toggle_faces(Element_type type, std::span<const Index> corners, Boundary& boundary)
{
  const Reference_element& element = reference_element(type);
  for (int f = 0; f < element.face_count; ++f)
  {
    const Reference_face& face = element.faces[f];
    std::vector<Index> face_corners;
    face_corners.reserve(face.corner_count);
    for (int c = 0; c < face.corner_count; ++c)
      face_corners.push_back(corners[face.corners[c]]);
    const Face_key key = face_key(face_corners);
    if (boundary.erase(key) == 0)
      boundary.emplace(key, std::move(face_corners));
  }
}

Boundary boundary_of(const std::map<Element_type, std::vector<Index>>& cells)
{
  Boundary boundary;
  for (const auto& [type, nodes] : cells)
    for (std::size_t first = 0; first < nodes.size(); first += corner_count(type))
      toggle_faces(type, std::span(nodes).subspan(first, corner_count(type)), boundary);
  return boundary;
}

/// six times the signed volume of the tetrahedron of the origin `o` and a triangle.
double six_volumes(const Point& o, const Point& a, const Point& b, const Point& c)
{
  std::array<Point, 3> e;
  for (int i = 0; i < 3; ++i)
    e[0][i] = a[i] - o[i], e[1][i] = b[i] - o[i], e[2][i] = c[i] - o[i];
  return e[0][0] * (e[1][1] * e[2][2] - e[1][2] * e[2][1]) - e[0][1] * (e[1][0] * e[2][2] - e[1][2] * e[2][0]) +
         e[0][2] * (e[1][0] * e[2][1] - e[1][1] * e[2][0]);
}

} // namespace

Index Mesh_builder::add_point(const Point& point)
{
  points_.push_back(point);
  return point_count() - 1;
}

void Mesh_builder::add_cell(Element_type type, std::span<const Index> corners)
{
  std::vector<Index>& nodes = cells_[type];
  nodes.insert(nodes.end(), corners.begin(), corners.end());
}

void Mesh_builder::add_face(const std::string& patch, std::span<const Index> corners)
{
  const Element_type type = corners.size() == 3 ? Element_type::triangle : Element_type::quadrangle;
  std::vector<Index>& nodes = faces_[{patch, type}];
  nodes.insert(nodes.end(), corners.begin(), corners.end());
}

std::string Mesh_builder::kind_of(const std::string& patch) const
{
  const auto found = kind_of_patch_.find(patch);
  return found == kind_of_patch_.end() ? "BCTypeUserDefined" : found->second;
}

Volume_mesh Mesh_builder::build() const
{
  Zone zone;
  zone.name = zone_name_;
  zone.points = points_;
  for (const auto& [type, nodes] : cells_)
    zone.cells.push_back({std::string(element_name(type)), type, nodes});

  Boundary boundary = boundary_of(cells_);
  Index face_number = 0;
  for (const auto& [key, nodes] : faces_)
  {
    const auto& [patch_name, type] = key;
    if (zone.patches.empty() || zone.patches.back().name != patch_name)
      zone.patches.push_back({patch_name, kind_of(patch_name), "", {}});
    Section section{patch_name + "_" + std::string(element_name(type)), type, {}};
    for (std::size_t first = 0; first < nodes.size(); first += corner_count(type))
    {
      const auto found = boundary.find(face_key(std::span(nodes).subspan(first, corner_count(type))));
      if (found == boundary.end())
        throw Input_error("patch " + patch_name + " has a face that is no boundary face of a cell, or has it twice");
      section.nodes.insert(section.nodes.end(), found->second.begin(), found->second.end());
      boundary.erase(found);
      zone.patches.back().faces.push_back(face_number++);
    }
    zone.faces.push_back(std::move(section));
  }
  if (!boundary.empty())
    throw Input_error(std::to_string(boundary.size()) + " boundary faces of zone " + zone_name_ + " are in no patch");

  Volume_mesh mesh;
  mesh.zones.push_back(std::move(zone));
  return mesh;
}

double cell_volume(Element_type type, std::span<const Index> corners, const std::vector<Point>& points)
{
  // Divergence theorem over the faces. The two ways to split a quadrangle enclose the bilinear surface half and half.
  const Reference_element& element = reference_element(type);
  const Point& o = points[corners[0]];
  double sum = 0;
  for (int f = 0; f < element.face_count; ++f)
  {
    std::array<Point, 4> p;
    for (int c = 0; c < element.faces[f].corner_count; ++c)
      p[c] = points[corners[element.faces[f].corners[c]]];
    if (element.faces[f].corner_count == 3)
      sum += six_volumes(o, p[0], p[1], p[2]);
    else
      sum += 0.5 * (six_volumes(o, p[0], p[1], p[2]) + six_volumes(o, p[0], p[2], p[3]) +
                    six_volumes(o, p[0], p[1], p[3]) + six_volumes(o, p[1], p[2], p[3]));
  }
  return sum / 6;
}

} // namespace recurve::generate
