#ifndef RECURVE_VOLUME_INTERNAL_BERNSTEIN_BISECTION_H
#define RECURVE_VOLUME_INTERNAL_BERNSTEIN_BISECTION_H

#include <recurve/volume/internal/bernstein_space.h>

#include <array>
#include <cstddef>
#include <vector>

namespace recurve::internal {

/// One way to halve the domain: a simplex of it is cut through the midpoint of one of its edges. The coefficients then
/// fall into lines along the edge, to each of which de Casteljau's algorithm is applied.
struct Bisection
{
  int degree = 0;                ///< of the simplex: no line has more than degree + 1 coefficients
  std::vector<int> line_starts;  ///< of each line in `coefficients`, and the end of the last
  std::vector<int> coefficients; ///< numbers, line by line, from the edge's first to its second end

  int line_count() const { return static_cast<int>(line_starts.size()) - 1; }
};

/// What subdivision needs to know of a space.
struct Bisection_table
{
  int size = 0;             ///< number of coefficients
  std::vector<int> corners; ///< numbers of the coefficients that are values at the domain's corners
  std::vector<Bisection> bisections;
};

/// Largest number of coefficients on a line: det J of a hexahedron of degree 6 has degree 17 along each direction.
inline constexpr int longest_line = 18;

/// Builds the table of one space.
class Bisection_table_builder
{
public:
  explicit Bisection_table_builder(const Bernstein_space& space) : space_(space)
  {
    const std::array<int, 3> degrees = space.axis_degrees();
    const std::size_t n0 = static_cast<std::size_t>(degrees[0]) + 1, n1 = static_cast<std::size_t>(degrees[1]) + 1,
                      n2 = static_cast<std::size_t>(degrees[2]) + 1;
    strides_ = {1, n0, n0 * n1};
    numbers_.assign(n0 * n1 * n2, -1);
    for (int m = 0; m < space.size(); ++m)
      numbers_[at(space.indices[static_cast<std::size_t>(m)])] = m;
  }

  Bisection_table table() const
  {
    Bisection_table result;
    result.size = space_.size();
    std::size_t first_axis = 0;
    for (std::size_t s = 0; s < space_.dimensions.size(); ++s)
    {
      const int corner_count = space_.dimensions[s] + 1;
      for (int first = 0; first < corner_count; ++first)
        for (int second = first + 1; second < corner_count; ++second)
          result.bisections.push_back(bisection(s, first_axis, first, second));
      first_axis += static_cast<std::size_t>(space_.dimensions[s]);
    }
    for (int m = 0; m < space_.size(); ++m)
      if (is_corner(space_.indices[static_cast<std::size_t>(m)]))
        result.corners.push_back(m);
    return result;
  }

private:
  std::size_t at(const Lattice_point& i) const
  {
    return static_cast<std::size_t>(i[0]) + strides_[1] * static_cast<std::size_t>(i[1]) +
           strides_[2] * static_cast<std::size_t>(i[2]);
  }

  /// index of `i` that belongs to corner `corner` of simplex `s`; corner 0 has what remains of the degree.
  int& own_index(Lattice_point& i, std::size_t first_axis, int corner) const
  {
    return i[first_axis + static_cast<std::size_t>(corner) - 1];
  }

  int remaining(const Lattice_point& i, std::size_t s, std::size_t first_axis) const
  {
    int rest = space_.degrees[s];
    for (int d = 0; d < space_.dimensions[s]; ++d)
      rest -= i[first_axis + static_cast<std::size_t>(d)];
    return rest;
  }

  /// The lines start where the index of the edge's second corner is 0; along them it grows at the cost of the first's.
  Bisection bisection(std::size_t s, std::size_t first_axis, int first, int second) const
  {
    Bisection result;
    result.degree = space_.degrees[s];
    result.line_starts.push_back(0);
    for (Lattice_point i : space_.indices)
    {
      if (own_index(i, first_axis, second) != 0)
        continue;
      const int length = first == 0 ? remaining(i, s, first_axis) : own_index(i, first_axis, first);
      for (int step = 0; step <= length; ++step)
      {
        result.coefficients.push_back(numbers_[at(i)]);
        ++own_index(i, first_axis, second);
        if (first != 0)
          --own_index(i, first_axis, first);
      }
      result.line_starts.push_back(static_cast<int>(result.coefficients.size()));
    }
    return result;
  }

  bool is_corner(const Lattice_point& i) const
  {
    std::size_t first_axis = 0;
    for (std::size_t s = 0; s < space_.dimensions.size(); ++s)
    {
      bool is_at_corner = remaining(i, s, first_axis) == space_.degrees[s];
      for (int d = 0; d < space_.dimensions[s]; ++d)
        is_at_corner = is_at_corner || i[first_axis + static_cast<std::size_t>(d)] == space_.degrees[s];
      if (!is_at_corner)
        return false;
      first_axis += static_cast<std::size_t>(space_.dimensions[s]);
    }
    return true;
  }

  const Bernstein_space& space_;
  std::array<std::size_t, 3> strides_;
  std::vector<int> numbers_;
};

/// replaces the coefficients `whole` by those of both halves. `mean(a, b)` and `raise(x, n)` are the arithmetic: halves
/// are computed as mean of two numbers, or as their sum, and then what has been summed n times too few is raised by
/// 2^n.
template <class Number, class Mean, class Raise>
void bisect(const Bisection& bisection, const Number* whole, Number* first_half, Number* second_half, Mean mean,
            Raise raise)
{
  std::array<Number, longest_line> line;
  for (int l = 0; l < bisection.line_count(); ++l)
  {
    const int* const numbers = bisection.coefficients.data() + bisection.line_starts[static_cast<std::size_t>(l)];
    const int last =
      bisection.line_starts[static_cast<std::size_t>(l) + 1] - bisection.line_starts[static_cast<std::size_t>(l)] - 1;
    for (int m = 0; m <= last; ++m)
      line[static_cast<std::size_t>(m)] = whole[numbers[m]];
    for (int step = 0; step <= last; ++step)
    {
      first_half[numbers[step]] = raise(line[0], bisection.degree - step);
      second_half[numbers[last - step]] = raise(line[static_cast<std::size_t>(last - step)], bisection.degree - step);
      for (int m = 0; m < last - step; ++m)
        line[static_cast<std::size_t>(m)] =
          mean(line[static_cast<std::size_t>(m)], line[static_cast<std::size_t>(m) + 1]);
    }
  }
}

/// the bisection in whose direction second differences are largest, and with them the distance between coefficients
/// and values; -1 if all are zero, so that the bounds are exact.
inline int strongest_bisection(const Bisection_table& table, const double* coefficients)
{
  int best = -1;
  double largest = 0;
  for (std::size_t b = 0; b < table.bisections.size(); ++b)
  {
    const Bisection& bisection = table.bisections[b];
    for (int l = 0; l < bisection.line_count(); ++l)
      for (int m = bisection.line_starts[static_cast<std::size_t>(l)] + 2;
           m < bisection.line_starts[static_cast<std::size_t>(l) + 1]; ++m)
      {
        const int* const n = bisection.coefficients.data() + m;
        const double difference =
          (coefficients[n[0]] - coefficients[n[-1]]) - (coefficients[n[-1]] - coefficients[n[-2]]);
        if (difference > largest || -difference > largest)
        {
          largest = difference < 0 ? -difference : difference;
          best = static_cast<int>(b);
        }
      }
  }
  return best;
}

} // namespace recurve::internal

#endif
