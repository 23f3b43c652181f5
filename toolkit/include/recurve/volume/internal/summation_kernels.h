#ifndef RECURVE_VOLUME_INTERNAL_SUMMATION_KERNELS_H
#define RECURVE_VOLUME_INTERNAL_SUMMATION_KERNELS_H

#include <recurve/volume/influence.h>
#include <recurve/volume/internal/simd_kernels.h>

#include <algorithm>
#include <array>
#include <span>
#include <string_view>
#include <type_traits>

namespace recurve::internal {

/// The inner loops for an influence. This one takes any influence, through its own functions, one pair at a time.
template <class I>
class Summation_kernels
{
public:
  static constexpr bool has_floats = false;

  explicit Summation_kernels(const I& influence) : influence_(influence), common_(kernels<3, 5>()) {}

  std::string_view instruction_set() const { return "none"; }

  void add_direct(const Charges<double>& s, Index source_count, const Coordinates<double>& targets, Index target_count,
                  const Sums& sums) const
  {
    constexpr double closest_squared = 1e-60; // as in simd_kernels.ipp
    for (Index t = 0; t < target_count; ++t)
    {
      std::array<double, 4> sum = {};
      for (Index m = 0; m < source_count; ++m)
      {
        const double x = targets.x[t] - s.x[m], y = targets.y[t] - s.y[m], z = targets.z[t] - s.z[m];
        const double w = influence_(std::max(x * x + y * y + z * z, closest_squared));
        sum[0] += s.weight[m] * w;
        sum[1] += s.weighted_x[m] * w;
        sum[2] += s.weighted_y[m] * w;
        sum[3] += s.weighted_z[m] * w;
      }
      sums.weight[t] += sum[0];
      sums.x[t] += sum[1];
      sums.y[t] += sum[2];
      sums.z[t] += sum[3];
    }
  }

  /// radial[m][lane] = (2 d/dq)^m of the weight at offsets[.][lane], where lengths are in units of units[lane], up to
  /// the factor scales[lane] * scale(reference).
  void radial_derivatives(const Pack<double>* offsets, const Pack<double>& units, double, int degree,
                          Pack<double>* radial, Pack<double>& scales) const
  {
    std::array<double, max_expansion_degree + 1> values;
    for (int lane = 0; lane < lanes<double>; ++lane)
    {
      const double x = offsets[0][lane], y = offsets[1][lane], z = offsets[2][lane];
      const double unit_squared = units[lane] * units[lane];
      influence_.derivatives((x * x + y * y + z * z) * unit_squared,
                             std::span(values).first(static_cast<std::size_t>(degree) + 1));
      double factor = 1;
      for (int m = 0; m <= degree; ++m, factor *= unit_squared)
        radial[m][lane] = values[static_cast<std::size_t>(m)] * factor;
      scales[lane] = 1;
    }
  }

  double scale(double) const { return 1; }

  template <class Real>
  const Expansion<Real>& expansion() const
  {
    return common_.doubles;
  }

  const Kernels& common() const { return common_; }

private:
  const I& influence_;
  const Kernels& common_;
};

/// For the paper's formula: vector instructions.
template <int A, int B>
class Summation_kernels<Inverse_distance<A, B>>
{
public:
  static constexpr bool has_floats = true;

  explicit Summation_kernels(const Inverse_distance<A, B>& influence)
    : near_factor_(influence.near_factor()), common_(kernels<A, B>())
  {}

  std::string_view instruction_set() const { return common_.name; }

  void add_direct(const Charges<double>& s, Index source_count, const Coordinates<double>& targets, Index target_count,
                  const Sums& sums) const
  {
    common_.add_direct(s, source_count, targets, target_count, near_factor_, sums);
  }

  void add_direct(const Charges<float>& s, Index source_count, const Coordinates<float>& targets, Index target_count,
                  const Sums& sums) const
  {
    common_.add_direct_float(s, source_count, targets, target_count, static_cast<float>(near_factor_), sums);
  }

  double scale(double reference) const { return integer_power(1 / reference, A); }

  template <class Real>
  void radial_derivatives(const Pack<Real>* offsets, const Pack<Real>& units, Real reference, int degree,
                          Pack<Real>* radial, Pack<Real>& scales) const
  {
    // (unit r)^-A + c (unit r)^-B = unit^-A (r^-A + c unit^(A-B) r^-B)
    alignas(64) Pack<Real> near_factors;
    for (int lane = 0; lane < lanes<Real>; ++lane)
    {
      scales[lane] = integer_power(reference / units[lane], A);
      near_factors[lane] = static_cast<Real>(near_factor_) *
                           (A < B ? integer_power(1 / units[lane], B - A) : integer_power(units[lane], A - B));
    }
    expansion<Real>().radial_derivatives(offsets, near_factors, degree, radial);
  }

  template <class Real>
  const Expansion<Real>& expansion() const
  {
    if constexpr (std::is_same_v<Real, float>)
      return common_.floats;
    else
      return common_.doubles;
  }

  const Kernels& common() const { return common_; }

private:
  template <class Real>
  static Real integer_power(Real x, int n)
  {
    Real result = 1;
    for (; n > 0; --n)
      result *= x;
    return result;
  }

  double near_factor_;
  const Kernels& common_;
};

} // namespace recurve::internal

#endif
