#ifndef RECURVE_TESTS_DATA_EXACT_GEOMETRY_H
#define RECURVE_TESTS_DATA_EXACT_GEOMETRY_H

#include <generate/cylinder_layer.h>
#include <generate/mesh_builder.h>
#include <generate/naca_wing.h>
#include <generate/sphere_in_box.h>
#include <recurve/mesh/volume_mesh.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <span>
#include <string>

namespace recurve::test {

/// Patch -> function that is zero on its exact surface, in the unit of the mesh.
using Exact_geometry = std::map<std::string, std::function<double(const Point&)>>;

inline Exact_geometry sphere_geometry(const generate::Sphere_mesh_options& options = {})
{
  return {{"sphere", [=](const Point& p) { return std::hypot(p[0], p[1], p[2]) - options.radius; }},
          {"box", [=](const Point& p) {
             return std::max({std::abs(p[0]), std::abs(p[1]), std::abs(p[2])}) - options.half_side;
           }}};
}

inline Exact_geometry cylinder_geometry(const generate::Cylinder_mesh_options& options = {})
{
  return {{"cylinder", [=](const Point& p) { return std::hypot(p[0], p[1]) - options.radius; }},
          {"farfield", [=](const Point& p) { return std::hypot(p[0], p[1]) - options.far_radius; }},
          {"z_low", [](const Point& p) { return p[2]; }},
          {"z_high", [=](const Point& p) { return p[2] - options.length; }}};
}

inline Exact_geometry wing_geometry(const generate::Wing_geometry& wing = {})
{
  const auto side = [=](double sign) {
    // A point on the wrong side of the chord is off by its way back.
    return [=](const Point& p) { return wing.residual(p) + std::max(0.0, -sign * p[2]); };
  };
  return {{"wing_upper", side(1)},
          {"wing_lower", side(-1)},
          {"wing_tip", [=](const Point& p) { return p[1] - wing.span; }},
          {"symmetry", [](const Point& p) { return p[1]; }},
          {"farfield", [=](const Point& p) {
             const Point c = wing.far_center();
             return std::hypot(p[0] - c[0], p[1] - c[1], p[2] - c[2]) - wing.far_radius;
           }}};
}

/// corners of face `number` of a zone.
inline std::span<const Index> face_corners(const Zone& zone, Index number)
{
  const Section_entry entry = find_element(zone.faces, number);
  const Section& section = zone.faces[entry.section];
  const int corners = corner_count(section.type);
  return std::span(section.nodes).subspan(entry.element * corners, corners);
}

/// largest distance of a corner of the patch from its exact surface.
inline double largest_residual(const Zone& zone, const Patch& patch, const Exact_geometry& geometry)
{
  double largest = 0;
  for (const Index face : patch.faces)
    for (const Index corner : face_corners(zone, face))
      largest = std::max(largest, std::abs(geometry.at(patch.name)(zone.points[corner])));
  return largest;
}

/// sum of the volumes of the cells, and the smallest of them.
inline std::array<double, 2> volumes(const Zone& zone)
{
  double sum = 0, smallest = 1e300;
  for (const Section& section : zone.cells)
  {
    const int corners = corner_count(section.type);
    for (Index cell = 0; cell < section.size(); ++cell)
    {
      const double volume =
        generate::cell_volume(section.type, std::span(section.nodes).subspan(cell * corners, corners), zone.points);
      sum += volume;
      smallest = std::min(smallest, volume);
    }
  }
  return {sum, smallest};
}

/// vector area of the faces of a patch, out of the mesh.
inline Point vector_area(const Zone& zone, const Patch& patch)
{
  Point sum = {};
  for (const Index face : patch.faces)
  {
    const std::span<const Index> c = face_corners(zone, face);
    const Point &a = zone.points[c[0]], &b = zone.points[c[1]], &d = zone.points[c[c.size() - 2]],
                &e = zone.points[c[c.size() - 1]];
    // Half the cross product of the diagonals of a quadrangle, of two edges of a triangle.
    const bool is_triangle = c.size() == 3;
    Point s, t;
    for (int i = 0; i < 3; ++i)
    {
      s[i] = (is_triangle ? b[i] : d[i]) - a[i];
      t[i] = e[i] - (is_triangle ? a[i] : b[i]);
    }
    for (int i = 0; i < 3; ++i)
      sum[i] += 0.5 * (s[(i + 1) % 3] * t[(i + 2) % 3] - s[(i + 2) % 3] * t[(i + 1) % 3]);
  }
  return sum;
}

} // namespace recurve::test

#endif
