#ifndef RECURVE_VOLUME_INTERNAL_EXPANSION_TABLE_H
#define RECURVE_VOLUME_INTERNAL_EXPANSION_TABLE_H

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace recurve::internal {

/// Largest degree of an expansion, and its number of terms.
inline constexpr int max_expansion_degree = 10;

/// number of monomials x^i y^j z^k of degree <= `degree`.
constexpr int term_count(int degree)
{
  return (degree + 1) * (degree + 2) * (degree + 3) / 6;
}

inline constexpr int max_term_count = term_count(max_expansion_degree);

/// The monomials of total degree <= max_expansion_degree, by degree, so that those of a lower degree come first, and
/// how they multiply.
class Expansion_table
{
public:
  /// How monomial g follows from monomials of lower degree: g = parent * x[axis]; `grandparent` = parent / x[axis] or
  /// -1, and `power` the power of x[axis] in parent.
  struct Recurrence
  {
    std::int16_t axis, parent, grandparent, power;
  };

  const std::array<std::int8_t, 3>& powers(int term) const { return powers_[static_cast<std::size_t>(term)]; }
  /// also of the three numbers after the last monomial, which kernels touch when they work in blocks of four.
  int degree(int term) const { return degrees_[static_cast<std::size_t>(term)]; }
  const Recurrence& recurrence(int term) const { return recurrences_[static_cast<std::size_t>(term)]; }

  /// products(b)[a] is the number of the monomial a * b, for a < term_count(max_expansion_degree - degree(b)).
  const std::int16_t* products(int term) const
  {
    return products_.data() + static_cast<std::size_t>(term) * static_cast<std::size_t>(max_term_count);
  }

  static const Expansion_table& instance()
  {
    static const Expansion_table table;
    return table;
  }

private:
  Expansion_table();
  int find(int i, int j, int k) const { return numbers_[static_cast<std::size_t>((i * side + j) * side + k)]; }

  static constexpr int side = max_expansion_degree + 1;
  std::vector<std::array<std::int8_t, 3>> powers_;
  std::vector<int> degrees_;
  std::vector<Recurrence> recurrences_;
  std::vector<std::int16_t> numbers_;
  std::vector<std::int16_t> products_;
};

inline Expansion_table::Expansion_table()
  : numbers_(static_cast<std::size_t>(side * side * side), -1),
    products_(static_cast<std::size_t>(max_term_count) * static_cast<std::size_t>(max_term_count), -1)
{
  for (int degree = 0; degree <= max_expansion_degree; ++degree)
    for (int i = degree; i >= 0; --i)
      for (int j = degree - i; j >= 0; --j)
      {
        const int k = degree - i - j;
        numbers_[static_cast<std::size_t>((i * side + j) * side + k)] = static_cast<std::int16_t>(powers_.size());
        powers_.push_back({static_cast<std::int8_t>(i), static_cast<std::int8_t>(j), static_cast<std::int8_t>(k)});
        degrees_.push_back(degree);
      }
  degrees_.resize(degrees_.size() + 3, max_expansion_degree);
  for (const auto& p : powers_)
  {
    Recurrence r = {0, -1, -1, 0};
    if (p[0] + p[1] + p[2] > 0)
    {
      std::array<int, 3> q = {p[0], p[1], p[2]};
      while (q[static_cast<std::size_t>(r.axis)] == 0)
        ++r.axis;
      int& power = q[static_cast<std::size_t>(r.axis)];
      --power;
      r.power = static_cast<std::int16_t>(power);
      r.parent = static_cast<std::int16_t>(find(q[0], q[1], q[2]));
      if (power > 0)
      {
        --power;
        r.grandparent = static_cast<std::int16_t>(find(q[0], q[1], q[2]));
      }
    }
    recurrences_.push_back(r);
  }
  for (int b = 0; b < max_term_count; ++b)
    for (int a = 0; a < term_count(max_expansion_degree - degree(b)); ++a)
    {
      const auto &p = powers(a), &q = powers(b);
      products_[static_cast<std::size_t>(b * max_term_count + a)] =
        static_cast<std::int16_t>(find(p[0] + q[0], p[1] + q[1], p[2] + q[2]));
    }
}

} // namespace recurve::internal

#endif
