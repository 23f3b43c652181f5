#ifndef RECURVE_SURFACE_INTERNAL_CONJUGATE_RESIDUAL_H
#define RECURVE_SURFACE_INTERNAL_CONJUGATE_RESIDUAL_H

#include <recurve/surface/local_fit.h>
#include <recurve/surface/vertex_fit.h>
#include <recurve/surface/weighted_points.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>

namespace recurve::internal::surface {

/// Iterations per unknown at most. Exact arithmetic needs one; round-off on ill-conditioned equations a few more. The
/// bound only keeps a hopeless face from stalling the run: what it has then is as good as it gets.
inline constexpr int conjugate_residual_rounds = 8;

/// Scaled normal equations (4) of a polynomial of degree D: matrix * (S^-1 c) = rhs, c = scaling * solution.
template <int D>
struct Normal_equations
{
  static constexpr int size = coefficient_count(D);
  using Vector = std::array<double, size>;

  alignas(64) std::array<Vector, size> matrix;
  alignas(64) Vector rhs;
  Vector scaling;

  explicit Normal_equations(const Weighted_points& points);

  /// adds the equations of the slopes to the matrix and the right-hand side, before these are scaled.
  void add_slopes(const Weighted_slopes& slopes);

  Vector times(const Vector& x) const
  {
    Vector result = {}; // the matrix is symmetric: summing its columns lets the inner loop run over neighbours
    for (int j = 0; j < size; ++j)
      for (int i = 0; i < size; ++i)
        result[i] += matrix[j][i] * x[j];
    return result;
  }
};

/// Powers of u and v in a term of the polynomial.
struct Term_powers
{
  int u = 0, v = 0;
};

template <int D>
constexpr std::array<Term_powers, coefficient_count(D)> powers_of_terms()
{
  std::array<Term_powers, coefficient_count(D)> result;
  for (int p = 0; p <= D; ++p)
    for (int k = 0; k <= p; ++k)
      result[coefficient_number(p - k, k)] = {p - k, k};
  return result;
}

/// Every entry of U^T Omega U is a moment, the sum of w u^a v^b over the points with a + b <= 2D, and most moments
/// stand in several entries: they are summed once.
template <int D>
Normal_equations<D>::Normal_equations(const Weighted_points& points)
{
  constexpr int powers = 2 * D + 1;
  std::array<std::array<double, powers>, powers> moments = {};
  std::array<std::array<double, D + 1>, D + 1> height_moments = {};
  for (std::size_t i = 0; i < points.size(); ++i)
  {
    std::array<double, powers> v_power;
    v_power[0] = 1;
    for (int b = 1; b < powers; ++b)
      v_power[b] = v_power[b - 1] * points.v[i];
    double factor = points.weight[i];
    for (int a = 0; a < powers; ++a)
    {
      for (int b = 0; b < powers - a; ++b)
        moments[a][b] += factor * v_power[b];
      if (a <= D)
      {
        const double with_height = factor * points.height[i];
        for (int b = 0; b <= D - a; ++b)
          height_moments[a][b] += with_height * v_power[b];
      }
      factor *= points.u[i];
    }
  }

  constexpr auto powers_of = powers_of_terms<D>();
  for (int i = 0; i < size; ++i)
  {
    rhs[i] = height_moments[powers_of[i].u][powers_of[i].v];
    for (int j = 0; j < size; ++j)
      matrix[i][j] = moments[powers_of[i].u + powers_of[j].u][powers_of[i].v + powers_of[j].v];
  }
  if (points.slopes.size() > 0)
    add_slopes(points.slopes);
  for (int i = 0; i < size; ++i)
  {
    const double square = matrix[i][i];
    scaling[i] = square > 0 ? 1 / std::sqrt(square) : 0; // 0: all points lie on an axis, which says nothing of u^j v^k
    if (i == 0 && points.is_through_origin)
      scaling[i] = 0;
  }
  for (int i = 0; i < size; ++i)
  {
    rhs[i] *= scaling[i];
    for (int j = 0; j < size; ++j)
      matrix[i][j] *= scaling[i] * scaling[j];
  }
}

template <int D>
void Normal_equations<D>::add_slopes(const Weighted_slopes& slopes)
{
  constexpr auto powers_of = powers_of_terms<D>();
  for (std::size_t s = 0; s < slopes.size(); ++s)
  {
    std::array<double, D + 1> u_power, v_power;
    u_power[0] = v_power[0] = 1;
    for (int a = 1; a <= D; ++a)
    {
      u_power[a] = u_power[a - 1] * slopes.u[s];
      v_power[a] = v_power[a - 1] * slopes.v[s];
    }
    Vector by_u, by_v;
    for (int i = 0; i < size; ++i)
    {
      const auto [j, k] = powers_of[i];
      by_u[i] = j > 0 ? j * u_power[j - 1] * v_power[k] : 0;
      by_v[i] = k > 0 ? k * u_power[j] * v_power[k - 1] : 0;
    }
    for (int i = 0; i < size; ++i)
    {
      rhs[i] += slopes.weight[s] * (by_u[i] * slopes.by_u[s] + by_v[i] * slopes.by_v[s]);
      for (int j = 0; j < size; ++j)
        matrix[i][j] += slopes.weight[s] * (by_u[i] * by_u[j] + by_v[i] * by_v[j]);
    }
  }
}

template <std::size_t N>
double inner_product(const std::array<double, N>& a, const std::array<double, N>& b)
{
  double sum = 0;
  for (std::size_t i = 0; i < N; ++i)
    sum += a[i] * b[i];
  return sum;
}

/// x with |rhs - matrix x| <= relative_bound |rhs|, by conjugate residuals from zero.
template <int D>
typename Normal_equations<D>::Vector conjugate_residual(const Normal_equations<D>& equations, double relative_bound)
{
  using Vector = typename Normal_equations<D>::Vector;
  constexpr int size = Normal_equations<D>::size;
  Vector x = {};
  Vector residual = equations.rhs;
  Vector direction = residual;
  Vector matrix_residual = equations.times(residual);
  Vector matrix_direction = matrix_residual;
  double energy = inner_product(residual, matrix_residual);
  const double goal = relative_bound * relative_bound * inner_product(residual, residual);
  if (!std::isfinite(goal))
    x.fill(std::numeric_limits<double>::quiet_NaN());
  for (int round = 0; round < conjugate_residual_rounds * size && inner_product(residual, residual) > goal; ++round)
  {
    const double square = inner_product(matrix_direction, matrix_direction);
    if (!(square > 0) || !(energy > 0)) // nothing left that the points determine
      break;
    const double step = energy / square;
    for (int i = 0; i < size; ++i)
    {
      x[i] += step * direction[i];
      residual[i] -= step * matrix_direction[i];
    }
    matrix_residual = equations.times(residual);
    const double new_energy = inner_product(residual, matrix_residual);
    const double turn = new_energy / energy;
    energy = new_energy;
    for (int i = 0; i < size; ++i)
    {
      direction[i] = residual[i] + turn * direction[i];
      matrix_direction[i] = matrix_residual[i] + turn * matrix_direction[i];
    }
  }
  return x;
}

template <int D>
void solve_degree(const Weighted_points& points, double relative_bound, std::span<double> coefficients)
{
  const Normal_equations<D> equations(points);
  const auto x = conjugate_residual(equations, relative_bound);
  for (int i = 0; i < Normal_equations<D>::size; ++i)
    coefficients[i] = equations.scaling[i] * x[i];
}

inline void solve_by_conjugate_residual(const Weighted_points& points, int degree, double relative_bound,
                                        std::span<double> coefficients)
{
  static_assert(max_vertex_fit_degree == 12);
  switch (degree)
  {
  case 1: return solve_degree<1>(points, relative_bound, coefficients);
  case 2: return solve_degree<2>(points, relative_bound, coefficients);
  case 3: return solve_degree<3>(points, relative_bound, coefficients);
  case 4: return solve_degree<4>(points, relative_bound, coefficients);
  case 5: return solve_degree<5>(points, relative_bound, coefficients);
  case 6: return solve_degree<6>(points, relative_bound, coefficients);
  case 7: return solve_degree<7>(points, relative_bound, coefficients);
  case 8: return solve_degree<8>(points, relative_bound, coefficients);
  case 9: return solve_degree<9>(points, relative_bound, coefficients);
  case 10: return solve_degree<10>(points, relative_bound, coefficients);
  case 11: return solve_degree<11>(points, relative_bound, coefficients);
  case 12: return solve_degree<12>(points, relative_bound, coefficients);
  default: std::fill(coefficients.begin(), coefficients.end(), std::numeric_limits<double>::quiet_NaN());
  }
}

} // namespace recurve::internal::surface

#endif
