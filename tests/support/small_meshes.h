#ifndef RECURVE_TESTS_SUPPORT_SMALL_MESHES_H
#define RECURVE_TESTS_SUPPORT_SMALL_MESHES_H

#include <recurve/elements/element.h>
#include <recurve/mesh/volume_mesh.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <random>
#include <string>
#include <utility>
#include <vector>

/// Meshes small enough to know everything about them. Everything here is written without the library's own algorithms
/// (only its types and reference elements), so that tests may hold one against the other.
namespace recurve::test {

inline const std::array<Element_type, 4> cell_types = {Element_type::tetrahedron, Element_type::pyramid,
                                                       Element_type::prism, Element_type::hexahedron};

/// appends cells to the section of their type, which is made where it is absent.
inline void add_cell(Zone& zone, Element_type type, const std::vector<Index>& points)
{
  auto section = std::find_if(zone.cells.begin(), zone.cells.end(), [&](const Section& s) { return s.type == type; });
  if (section == zone.cells.end())
    section = zone.cells.insert(zone.cells.end(), Section{std::string(element_name(type)), type, {}});
  section->nodes.insert(section->nodes.end(), points.begin(), points.end());
}

/// appends a patch with a section of its own name that holds the given faces, all of one type.
inline void add_patch(Zone& zone, const std::string& name, Element_type type,
                      const std::vector<std::vector<Index>>& faces)
{
  Section section{name, type, {}};
  Patch patch;
  patch.name = name;
  Index number = zone.face_count();
  for (const std::vector<Index>& face : faces)
  {
    section.nodes.insert(section.nodes.end(), face.begin(), face.end());
    patch.faces.push_back(number++);
  }
  zone.faces.push_back(std::move(section));
  zone.patches.push_back(std::move(patch));
}

/// the reference element itself as a mesh of one cell, without faces.
inline Volume_mesh one_cell(Element_type type)
{
  Volume_mesh mesh;
  Zone& zone = mesh.zones.emplace_back();
  zone.name = "zone";
  const Reference_element& reference = reference_element(type);
  std::vector<Index> points;
  for (int c = 0; c < reference.corner_count; ++c)
  {
    const auto& x = reference.corners[c];
    zone.points.push_back({double(x[0]), double(x[1]), double(x[2])});
    points.push_back(c);
  }
  add_cell(zone, type, points);
  return mesh;
}

/// Faces of cells as sorted vertices -> how many cells of the zone have them, with the points of the last one seen.
struct Counted_face
{
  int cells = 0;
  std::vector<Index> points;
};

inline std::map<std::vector<Index>, Counted_face> faces_of_cells(const Zone& zone)
{
  std::map<std::vector<Index>, Counted_face> faces;
  for (const Section& section : zone.cells)
  {
    const Reference_element& reference = reference_element(section.type);
    for (Index e = 0; e < section.size(); ++e)
      for (int f = 0; f < reference.face_count; ++f)
      {
        std::vector<Index> points(static_cast<std::size_t>(reference.faces[f].corner_count));
        for (std::size_t c = 0; c < points.size(); ++c)
          points[c] = section.nodes[e * reference.corner_count + reference.faces[f].corners[c]];
        std::vector<Index> key = points;
        std::sort(key.begin(), key.end());
        Counted_face& face = faces[key];
        ++face.cells;
        face.points = points;
      }
  }
  return faces;
}

/// number of faces of exactly one cell of the zone.
inline Index hull_face_count(const Zone& zone)
{
  Index count = 0;
  for (const auto& [key, face] : faces_of_cells(zone))
    count += face.cells == 1;
  return count;
}

/// gives the hull faces of a zone patches: `name_of(centre of the face)` is the patch's name, "" leaves the face out.
template <class NameOf>
void add_hull_patches(Zone& zone, const NameOf& name_of)
{
  std::map<std::pair<std::string, int>, std::vector<std::vector<Index>>> faces;
  for (const auto& [key, face] : faces_of_cells(zone))
  {
    Point centre = {};
    for (const Index point : face.points)
      for (int axis = 0; axis < 3; ++axis)
        centre[axis] += zone.points[point][axis] / double(face.points.size());
    if (const std::string name = name_of(centre); face.cells == 1 && !name.empty())
      faces[{name, int(face.points.size())}].push_back(face.points);
  }
  for (const auto& [name, list] : faces)
    add_patch(zone,
              faces.contains({name.first, 7 - name.second}) ? name.first + std::to_string(name.second) : name.first,
              name.second == 3 ? Element_type::triangle : Element_type::quadrangle, list);
}

/// splits the cube with the given corners (numbered like a hexahedron's) into cells of one type. Tetrahedra and prisms
/// split along diagonals that run the same way in every cube, so that cubes side by side fit; pyramids meet in a new
/// point at the centre.
inline void add_cube(Zone& zone, Element_type type, const std::array<Index, 8>& v)
{
  switch (type)
  {
  case Element_type::hexahedron: add_cell(zone, type, {v.begin(), v.end()}); break;
  case Element_type::prism:
    add_cell(zone, type, {v[0], v[1], v[2], v[4], v[5], v[6]});
    add_cell(zone, type, {v[0], v[2], v[3], v[4], v[6], v[7]});
    break;
  case Element_type::tetrahedron: // Kuhn: one for each way of going from corner 0 to corner 6 along the axes
    for (const std::array<int, 2>& middle :
         {std::array{1, 2}, std::array{2, 3}, std::array{3, 7}, std::array{7, 4}, std::array{4, 5}, std::array{5, 1}})
      add_cell(zone, type, {v[0], v[middle[0]], v[middle[1]], v[6]});
    break;
  case Element_type::pyramid:
  {
    Point centre = {};
    for (const Index point : v)
      for (int axis = 0; axis < 3; ++axis)
        centre[axis] += zone.points[point][axis] / 8;
    const Index apex = static_cast<Index>(zone.points.size());
    zone.points.push_back(centre);
    for (const Reference_face& face : reference_element(Element_type::hexahedron).faces)
      add_cell(zone, type, {v[face.corners[0]], v[face.corners[3]], v[face.corners[2]], v[face.corners[1]], apex});
    break;
  }
  default: break;
  }
}

/// A box of cubes as one zone.
struct Box_options
{
  std::array<int, 3> cubes = {2, 2, 2};
  Point origin = {0, 0, 0};
  Point size = {1, 1, 1}; ///< of the whole box
};

inline Zone box_zone(Element_type type, const Box_options& options = {}, const std::string& name = "zone")
{
  Zone zone;
  zone.name = name;
  const auto& n = options.cubes;
  for (int k = 0; k <= n[2]; ++k)
    for (int j = 0; j <= n[1]; ++j)
      for (int i = 0; i <= n[0]; ++i)
        zone.points.push_back({options.origin[0] + options.size[0] * i / n[0],
                               options.origin[1] + options.size[1] * j / n[1],
                               options.origin[2] + options.size[2] * k / n[2]});
  const auto at = [&](Index i, Index j, Index k) { return i + (n[0] + 1) * (j + (n[1] + 1) * k); };
  for (int k = 0; k < n[2]; ++k)
    for (int j = 0; j < n[1]; ++j)
      for (int i = 0; i < n[0]; ++i)
        add_cube(zone, type,
                 {at(i, j, k), at(i + 1, j, k), at(i + 1, j + 1, k), at(i, j + 1, k), at(i, j, k + 1),
                  at(i + 1, j, k + 1), at(i + 1, j + 1, k + 1), at(i, j + 1, k + 1)});
  return zone;
}

/// names the six sides of the box [origin, origin + size]: "x_min", ..., "z_max"; "" elsewhere.
inline auto box_side(const Point& origin = {0, 0, 0}, const Point& size = {1, 1, 1})
{
  return [=](const Point& x) -> std::string {
    static const char* const names[3][2] = {{"x_min", "x_max"}, {"y_min", "y_max"}, {"z_min", "z_max"}};
    for (int axis = 0; axis < 3; ++axis)
      for (int end = 0; end < 2; ++end)
        if (std::abs(x[axis] - (origin[axis] + end * size[axis])) < 1e-3 * size[axis])
          return names[axis][end];
    return "";
  };
}

/// the unit box of cells of one type, with six patches.
inline Volume_mesh box(Element_type type, const Box_options& options = {})
{
  Volume_mesh mesh;
  mesh.zones.push_back(box_zone(type, options));
  add_hull_patches(mesh.zones[0], box_side(options.origin, options.size));
  return mesh;
}

/// three unit cubes along x with all four types of cell: a hexahedron, pyramids (the one at y_max split in two
/// tetrahedra), prisms. No patches.
inline Volume_mesh mixed_box()
{
  Volume_mesh mesh;
  Zone& zone = mesh.zones.emplace_back();
  zone.name = "mixed";
  for (int k = 0; k <= 1; ++k)
    for (int j = 0; j <= 1; ++j)
      for (int i = 0; i <= 3; ++i)
        zone.points.push_back({double(i), double(j), double(k)});
  const auto cube = [](Index i) { return std::array<Index, 8>{i, i + 1, i + 5, i + 4, i + 8, i + 9, i + 13, i + 12}; };
  add_cube(zone, Element_type::hexahedron, cube(0));
  add_cube(zone, Element_type::prism, cube(2));
  const Index apex = static_cast<Index>(zone.points.size());
  zone.points.push_back({1.5, 0.5, 0.5});
  const std::array<Index, 8> v = cube(1);
  for (const Reference_face& face : reference_element(Element_type::hexahedron).faces)
  {
    const std::array<Index, 4> base = {v[face.corners[0]], v[face.corners[3]], v[face.corners[2]], v[face.corners[1]]};
    const bool is_at_y_max = std::all_of(base.begin(), base.end(), [&](Index p) { return zone.points[p][1] == 1; });
    if (is_at_y_max)
    {
      add_cell(zone, Element_type::tetrahedron, {base[0], base[1], base[2], apex});
      add_cell(zone, Element_type::tetrahedron, {base[0], base[2], base[3], apex});
    }
    else
      add_cell(zone, Element_type::pyramid, {base[0], base[1], base[2], base[3], apex});
  }
  return mesh;
}

/// two zones that meet at x = 1 with points of their own: [0,1] and [1,2] x [0,1] x [0,1], n cubes along each side,
/// with patches on the outer sides only and nothing said about the interface.
inline Volume_mesh two_zone_box(Element_type type_a, Element_type type_b, int n = 2)
{
  Volume_mesh mesh;
  mesh.zones.push_back(box_zone(type_a, {.cubes = {n, n, n}}, "left"));
  mesh.zones.push_back(box_zone(type_b, {.cubes = {n, n, n}, .origin = {1, 0, 0}}, "right"));
  for (Zone& zone : mesh.zones)
    add_hull_patches(zone, box_side({0, 0, 0}, {2, 1, 1}));
  return mesh;
}

/// the same mesh with points and, inside each section, cells and faces in another order; patches follow.
inline Volume_mesh relabelled(Volume_mesh mesh, unsigned seed)
{
  std::mt19937 random(seed);
  for (Zone& zone : mesh.zones)
  {
    std::vector<Index> new_point(zone.points.size());
    std::iota(new_point.begin(), new_point.end(), Index(0));
    std::shuffle(new_point.begin(), new_point.end(), random);
    const std::vector<Point> old_points = zone.points;
    for (std::size_t n = 0; n < old_points.size(); ++n)
      zone.points[new_point[n]] = old_points[n];
    std::vector<Index> new_face;
    for (auto* sections : {&zone.cells, &zone.faces})
      for (Section& section : *sections)
      {
        std::vector<Index> order(static_cast<std::size_t>(section.size())); // old number of each new element
        std::iota(order.begin(), order.end(), Index(0));
        std::shuffle(order.begin(), order.end(), random);
        const int count = corner_count(section.type);
        const std::vector<Index> old_nodes = section.nodes;
        const Index first = static_cast<Index>(new_face.size());
        if (sections == &zone.faces)
          new_face.resize(new_face.size() + order.size());
        for (std::size_t e = 0; e < order.size(); ++e)
        {
          for (int c = 0; c < count; ++c)
            section.nodes[e * count + c] = new_point[old_nodes[order[e] * count + c]];
          if (sections == &zone.faces)
            new_face[first + order[e]] = first + static_cast<Index>(e);
        }
      }
    for (Patch& patch : zone.patches)
    {
      for (Index& face : patch.faces)
        face = new_face[face];
      std::sort(patch.faces.begin(), patch.faces.end());
    }
  }
  return mesh;
}

/// applies `map` to every point.
template <class Map>
void move_points(Volume_mesh& mesh, const Map& map)
{
  for (Zone& zone : mesh.zones)
    for (Point& point : zone.points)
      point = map(point);
}

} // namespace recurve::test

#endif
