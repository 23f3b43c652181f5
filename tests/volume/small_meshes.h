#ifndef RECURVE_TESTS_VOLUME_SMALL_MESHES_H
#define RECURVE_TESTS_VOLUME_SMALL_MESHES_H

#include <recurve/elements/element.h>
#include <recurve/elements/node_layout.h>
#include <recurve/volume/element_block.h>

#include <array>
#include <cmath>
#include <map>
#include <span>
#include <vector>

namespace recurve::tests {

/// The functions of degree 1 of the corners of an element, written out by hand.
inline std::vector<double> corner_functions(Element_type type, const Point& xi)
{
  const double x = xi[0], y = xi[1], z = xi[2];
  switch (type)
  {
  case Element_type::line: return {1 - x, x};
  case Element_type::triangle: return {1 - x - y, x, y};
  case Element_type::quadrangle: return {(1 - x) * (1 - y), x * (1 - y), x * y, (1 - x) * y};
  case Element_type::tetrahedron: return {1 - x - y - z, x, y, z};
  case Element_type::prism: return {(1 - x - y) * (1 - z), x * (1 - z), y * (1 - z), (1 - x - y) * z, x * z, y * z};
  case Element_type::pyramid:
  {
    if (z == 1)
      return {0, 0, 0, 0, 1};
    const double r = 1 - z;
    return {(r - x) * (r - y) / r, x * (r - y) / r, x * y / r, (r - x) * y / r, z};
  }
  case Element_type::hexahedron:
    return {(1 - x) * (1 - y) * (1 - z), x * (1 - y) * (1 - z), x * y * (1 - z), (1 - x) * y * (1 - z),
            (1 - x) * (1 - y) * z,       x * (1 - y) * z,       x * y * z,       (1 - x) * y * z};
  }
  return {};
}

inline Point reference_point(Element_type type, int degree, int node)
{
  const Lattice_point l = canonical_nodes(type, degree)[static_cast<std::size_t>(node)];
  return {double(l[0]) / degree, double(l[1]) / degree, double(l[2]) / degree};
}

/// High-order mesh for tests. Nodes at one position are one node.
struct Small_mesh
{
  int degree = 1;
  std::vector<Point> nodes;
  std::map<Element_type, std::vector<Index>> elements;

  std::vector<Element_block> blocks() const
  {
    std::vector<Element_block> result;
    for (const auto& [type, list] : elements)
      result.push_back({type, list});
    return result;
  }

  Index node_at(const Point& p)
  {
    std::array<long long, 3> key;
    for (std::size_t d = 0; d < 3; ++d)
      key[d] = std::llround(p[d] * 1e7);
    const auto [it, is_new] = ids.try_emplace(key, static_cast<Index>(nodes.size()));
    if (is_new)
      nodes.push_back(p);
    return it->second;
  }

  /// adds the straight element with these corners.
  void add(Element_type type, const std::vector<Point>& corners)
  {
    for (int m = 0; m < node_count(type, degree); ++m)
    {
      const std::vector<double> n = corner_functions(type, reference_point(type, degree, m));
      Point p = {0, 0, 0};
      for (std::size_t c = 0; c < n.size(); ++c)
        for (std::size_t d = 0; d < 3; ++d)
          p[d] += n[c] * corners[c][d];
      elements[type].push_back(node_at(m < corner_count(type) ? corners[static_cast<std::size_t>(m)] : p));
    }
  }

  std::map<std::array<long long, 3>, Index> ids;
};

/// A box of counts[0] x counts[1] x counts[2] hexahedra with the corners `vertex(i, j, k)`, each cut into elements of
/// `type`.
template <class Vertex>
Small_mesh cut_box(Element_type type, int degree, const std::array<int, 3>& counts, const Vertex& vertex)
{
  Small_mesh mesh;
  mesh.degree = degree;
  for (int k = 0; k < counts[2]; ++k)
    for (int j = 0; j < counts[1]; ++j)
      for (int i = 0; i < counts[0]; ++i)
      {
        std::vector<Point> v;
        for (const auto& c : reference_element(Element_type::hexahedron).corners)
          v.push_back(vertex(i + c[0], j + c[1], k + c[2]));
        if (type == Element_type::hexahedron)
          mesh.add(type, v);
        else if (type == Element_type::prism)
        {
          mesh.add(type, {v[0], v[1], v[2], v[4], v[5], v[6]});
          mesh.add(type, {v[0], v[2], v[3], v[4], v[6], v[7]});
        }
        else if (type == Element_type::tetrahedron)
          for (const std::array<int, 2>& e : {std::array{1, 2}, std::array{2, 3}, std::array{3, 7}, std::array{7, 4},
                                              std::array{4, 5}, std::array{5, 1}})
            mesh.add(type, {v[0], v[std::size_t(e[0])], v[std::size_t(e[1])], v[6]});
        else
        {
          Point center = {0, 0, 0};
          for (const Point& p : v)
            for (std::size_t d = 0; d < 3; ++d)
              center[d] += p[d] / 8;
          for (const auto& f : {std::array{0, 1, 2, 3}, std::array{4, 7, 6, 5}, std::array{0, 4, 5, 1},
                                std::array{1, 5, 6, 2}, std::array{2, 6, 7, 3}, std::array{3, 7, 4, 0}})
            mesh.add(type,
                     {v[std::size_t(f[0])], v[std::size_t(f[1])], v[std::size_t(f[2])], v[std::size_t(f[3])], center});
        }
      }
  return mesh;
}

/// n^3 cubes of [0, 1]^3, each cut into elements of `type`; the vertices are shifted smoothly so that nothing is
/// regular.
inline Small_mesh box_of(Element_type type, int degree, int n)
{
  return cut_box(type, degree, {n, n, n}, [n](int i, int j, int k) -> Point {
    const double x = double(i) / n, y = double(j) / n, z = double(k) / n;
    return {x + 0.03 * std::sin(5 * y + 2 * z), y + 0.02 * std::sin(4 * z + x), z + 0.04 * std::cos(3 * x + 2 * y)};
  });
}

inline constexpr std::array<Element_type, 4> cell_types = {Element_type::tetrahedron, Element_type::pyramid,
                                                           Element_type::prism, Element_type::hexahedron};

} // namespace recurve::tests

#endif
