#ifndef RECURVE_TESTS_SUPPORT_SPHERE_SHELL_H
#define RECURVE_TESTS_SUPPORT_SPHERE_SHELL_H

#include <recurve/mesh/volume_mesh.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string>
#include <vector>

namespace recurve::test {

enum class Outer_shape
{
  box,
  sphere
};

/// What a shell around the unit sphere is made of.
struct Shell_options
{
  int cells_per_side = 8; ///< of each of the six sides of the cube that is blown up into a sphere
  int layers = 3;
  Element_type type = Element_type::hexahedron; ///< hexahedron, prism or tetrahedron
  Outer_shape outer = Outer_shape::box;         ///< box [-2, 2]^3 or sphere of radius 2
};

/// The mesh between the unit sphere and a box or sphere around it: layers over a cubed sphere, whose quadrangles stay
/// (hexahedra) or are halved (prisms), each prism cut into three (tetrahedra). Patches "sphere" and "outer".
class Sphere_shell
{
public:
  explicit Sphere_shell(const Shell_options& options) : options_(options)
  {
    for (int axis = 0; axis < 3; ++axis)
      for (int side : {0, options_.cells_per_side})
        add_side(axis, side);
  }

  Volume_mesh mesh() const
  {
    const Element_type face_type =
      options_.type == Element_type::hexahedron ? Element_type::quadrangle : Element_type::triangle;
    Zone zone;
    zone.name = "shell";
    zone.cells = {{"cells", options_.type, {}}};
    zone.faces = {{"sphere", face_type, {}}, {"outer", face_type, {}}};
    for (int layer = 0; layer <= options_.layers; ++layer)
      for (const auto& lattice : lattice_)
        zone.points.push_back(point(lattice, layer));
    for (const auto& quad : quads_)
      add_column(quad, zone);
    const Index inner = zone.faces[0].size(), outer = zone.faces[1].size();
    zone.patches = {{"sphere", "BCWall", "", {}}, {"outer", "BCFarfield", "", {}}};
    for (Index face = 0; face < inner; ++face)
      zone.patches[0].faces.push_back(face);
    for (Index face = 0; face < outer; ++face)
      zone.patches[1].faces.push_back(inner + face);
    Volume_mesh mesh;
    mesh.zones = {std::move(zone)};
    return mesh;
  }

private:
  using Lattice = std::array<int, 3>;

  /// quadrangles of one side of the cube, counter-clockwise seen from outside.
  void add_side(int axis, int side)
  {
    const auto a = static_cast<std::size_t>(axis), b = (a + 1) % 3, c = (a + 2) % 3;
    for (int i = 0; i < options_.cells_per_side; ++i)
      for (int j = 0; j < options_.cells_per_side; ++j)
      {
        std::array<Index, 4> quad = {};
        constexpr std::array<std::array<int, 2>, 4> corners = {{{0, 0}, {1, 0}, {1, 1}, {0, 1}}};
        for (std::size_t corner = 0; corner < 4; ++corner)
        {
          Lattice lattice = {};
          lattice[a] = side;
          lattice[b] = i + corners[corner][0];
          lattice[c] = j + corners[corner][1];
          const auto [entry, is_new] = number_.emplace(lattice, static_cast<Index>(lattice_.size()));
          if (is_new)
            lattice_.push_back(lattice);
          quad[corner] = entry->second;
        }
        if (side == 0)
          std::swap(quad[1], quad[3]);
        quads_.push_back(quad);
      }
  }

  Point point(const Lattice& lattice, int layer) const
  {
    Point cube = {};
    for (std::size_t c = 0; c < 3; ++c)
      cube[c] = std::tan(0.25 * M_PI * (2.0 * lattice[c] / options_.cells_per_side - 1));
    const double length = std::hypot(cube[0], cube[1], cube[2]);
    const double t = static_cast<double>(layer) / options_.layers;
    Point result = {};
    for (std::size_t c = 0; c < 3; ++c)
    {
      const double inner = cube[c] / length;
      const double outer = 2 * (options_.outer == Outer_shape::box ? cube[c] : inner);
      result[c] = (1 - t) * inner + t * outer;
    }
    return result;
  }

  void add_column(const std::array<Index, 4>& quad, Zone& zone) const
  {
    if (options_.type == Element_type::hexahedron)
    {
      add_layers(quad, zone);
      return;
    }
    // Prisms are cut alike on both sides of a wall if the cut follows the numbers of the vertices.
    add_layers(std::array<Index, 3>{quad[0], quad[1], quad[2]}, zone);
    add_layers(std::array<Index, 3>{quad[0], quad[2], quad[3]}, zone);
  }

  template <std::size_t n>
  void add_layers(const std::array<Index, n>& base, Zone& zone) const
  {
    const auto stride = static_cast<Index>(lattice_.size());
    for (int layer = 0; layer < options_.layers; ++layer)
      if (options_.type == Element_type::tetrahedron)
        add_tetrahedra(base, layer * stride, stride, zone.cells[0].nodes);
      else
        for (Index level : {layer, layer + 1})
          for (Index vertex : base)
            zone.cells[0].nodes.push_back(vertex + level * stride);
    for (std::size_t c = 0; c < n; ++c)
    {
      zone.faces[0].nodes.push_back(base[n - 1 - c]);
      zone.faces[1].nodes.push_back(base[c] + options_.layers * stride);
    }
  }

  template <std::size_t n>
  static void add_tetrahedra(const std::array<Index, n>& base, Index level, Index stride, std::vector<Index>& nodes)
  {
    std::array<std::size_t, 3> order = {0, 1, 2};
    std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return base[a] < base[b]; });
    const bool is_even = (order[1] + 3 - order[0]) % 3 == 1;
    std::array<Index, 6> corner = {};
    for (std::size_t c = 0; c < 3; ++c)
    {
      corner[c] = base[order[c]] + level;
      corner[3 + c] = base[order[c]] + level + stride;
    }
    constexpr std::array<std::array<std::size_t, 4>, 3> cut = {{{0, 1, 2, 5}, {0, 1, 5, 4}, {0, 4, 5, 3}}};
    for (auto tetrahedron : cut)
    {
      if (!is_even)
        std::swap(tetrahedron[0], tetrahedron[1]);
      for (std::size_t c : tetrahedron)
        nodes.push_back(corner[c]);
    }
  }

  Shell_options options_;
  std::map<Lattice, Index> number_;
  std::vector<Lattice> lattice_;
  std::vector<std::array<Index, 4>> quads_;
};

inline Volume_mesh sphere_shell(const Shell_options& options)
{
  return Sphere_shell(options).mesh();
}

} // namespace recurve::test

#endif
