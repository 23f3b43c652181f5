#ifndef RECURVE_TESTS_IO_JACOBIAN_SIGNS_H
#define RECURVE_TESTS_IO_JACOBIAN_SIGNS_H

#include <recurve/elements/basis.h>
#include <recurve/mesh/curved_mesh.h>

#include <array>

namespace recurve::test {

/// smallest determinant of the Jacobian at the middle of a cell, over all cells: positive only if nodes stand in the
/// order that is claimed.
inline double smallest_middle_jacobian(const Curved_mesh& mesh)
{
  double smallest = 1e300;
  for (const Curved_zone& zone : mesh.zones)
    for (const Curved_section& section : zone.cells)
    {
      const Reference_point middle = section.type == Element_type::tetrahedron ? Reference_point{0.25, 0.25, 0.25}
                                     : section.type == Element_type::pyramid   ? Reference_point{0.4, 0.4, 0.2}
                                     : section.type == Element_type::prism     ? Reference_point{0.3, 0.3, 0.5}
                                                                               : Reference_point{0.5, 0.5, 0.5};
      const auto width = static_cast<std::size_t>(node_count(section.type, mesh.degree));
      std::vector<std::array<double, 3>> derivatives(width);
      lagrange_derivatives(section.type, mesh.degree, middle, derivatives);
      for (std::size_t first = 0; first < section.nodes.size(); first += width)
      {
        std::array<std::array<double, 3>, 3> j = {};
        for (std::size_t m = 0; m < width; ++m)
          for (std::size_t a = 0; a < 3; ++a)
            for (std::size_t b = 0; b < 3; ++b)
              j[a][b] += mesh.nodes[static_cast<std::size_t>(section.nodes[first + m])][a] * derivatives[m][b];
        const double determinant = j[0][0] * (j[1][1] * j[2][2] - j[1][2] * j[2][1]) -
                                   j[0][1] * (j[1][0] * j[2][2] - j[1][2] * j[2][0]) +
                                   j[0][2] * (j[1][0] * j[2][1] - j[1][1] * j[2][0]);
        smallest = std::min(smallest, determinant);
      }
    }
  return smallest;
}

} // namespace recurve::test

#endif
