#ifndef RECURVE_VOLUME_INTERNAL_BERNSTEIN_SPACE_H
#define RECURVE_VOLUME_INTERNAL_BERNSTEIN_SPACE_H

#include <recurve/elements/element.h>
#include <recurve/elements/node_layout.h>

#include <array>
#include <cstddef>
#include <vector>

namespace recurve::internal {

/// The domain of det J as a product of simplices, by their dimensions. That of a pyramid is the cube which collapses
/// onto it.
inline std::vector<int> simplex_dimensions(Element_type type)
{
  switch (type)
  {
  case Element_type::tetrahedron: return {3};
  case Element_type::prism: return {2, 1};
  default: return {1, 1, 1};
  }
}

/// the multi-indices i, j, k >= 0 of sum <= `degree`, those beyond `dimension` zero; i runs fastest.
inline std::vector<Lattice_point> simplex_lattice(int dimension, int degree)
{
  std::vector<Lattice_point> result;
  for (int k = 0; k <= (dimension > 2 ? degree : 0); ++k)
    for (int j = 0; j <= (dimension > 1 ? degree - k : 0); ++j)
      for (int i = 0; i <= degree - j - k; ++i)
        result.push_back({i, j, k});
  return result;
}

/// degree! / (i! j! k! (degree - i - j - k)!); at most 4^17, so that it is exact.
inline double multinomial(int degree, const Lattice_point& index)
{
  double result = 1;
  int n = 0;
  const auto choose = [&](int k) {
    for (int m = 1; m <= k; ++m)
      result = result * ++n / m;
  };
  for (int i : index)
    choose(i);
  choose(degree - n);
  return result;
}

/// Polynomials on a product of simplices, of a degree in each, in the Bernstein basis. A coefficient times the
/// multinomials of its index is called scaled: the scaled coefficients of a product of two polynomials are the sums of
/// products of their scaled coefficients whose indices add up.
struct Bernstein_space
{
  std::vector<int> dimensions; ///< of the simplices
  std::vector<int> degrees;    ///< in each
  std::vector<Lattice_point>
    indices;                        ///< one per function, axes of the first simplex first, whose functions run fastest
  std::vector<double> multinomials; ///< products over the simplices; exact

  int size() const { return static_cast<int>(indices.size()); }

  /// degree in the simplex to which each of the three axes belongs.
  std::array<int, 3> axis_degrees() const
  {
    std::array<int, 3> result = {};
    std::size_t axis = 0;
    for (std::size_t s = 0; s < dimensions.size(); ++s)
      for (int d = 0; d < dimensions[s]; ++d)
        result[axis++] = degrees[s];
    return result;
  }
};

inline Bernstein_space bernstein_space(std::vector<int> dimensions, std::vector<int> degrees)
{
  Bernstein_space space{std::move(dimensions), std::move(degrees), {{0, 0, 0}}, {1}};
  int first_axis = 0;
  for (std::size_t s = 0; s < space.dimensions.size(); ++s)
  {
    const auto lattice = simplex_lattice(space.dimensions[s], space.degrees[s]);
    std::vector<Lattice_point> indices;
    std::vector<double> multinomials;
    for (const Lattice_point& own : lattice)
      for (std::size_t m = 0; m < space.indices.size(); ++m)
      {
        Lattice_point index = space.indices[m];
        for (int d = 0; d < space.dimensions[s]; ++d)
          index[static_cast<std::size_t>(first_axis + d)] = own[static_cast<std::size_t>(d)];
        indices.push_back(index);
        multinomials.push_back(space.multinomials[m] * multinomial(space.degrees[s], own));
      }
    space.indices = std::move(indices);
    space.multinomials = std::move(multinomials);
    first_axis += space.dimensions[s];
  }
  return space;
}

/// the space of the products of functions of `a` and `b`.
inline Bernstein_space product_space(const Bernstein_space& a, const Bernstein_space& b)
{
  std::vector<int> degrees = a.degrees;
  for (std::size_t s = 0; s < degrees.size(); ++s)
    degrees[s] += b.degrees[s];
  return bernstein_space(a.dimensions, degrees);
}

} // namespace recurve::internal

#endif
