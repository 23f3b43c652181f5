#ifndef RECURVE_VOLUME_INTERNAL_SUMMATION_KERNELS_H
#define RECURVE_VOLUME_INTERNAL_SUMMATION_KERNELS_H

#include <recurve/volume/influence.h>
#include <recurve/volume/internal/simd_kernels.h>

#include <algorithm>
#include <array>
#include <span>
#include <string_view>

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

  void radial_derivatives(const double (*offsets)[lanes], int degree, double (*radial)[lanes]) const
  {
    std::array<double, max_expansion_degree + 1> values;
    for (int lane = 0; lane < lanes; ++lane)
    {
      const double x = offsets[0][lane], y = offsets[1][lane], z = offsets[2][lane];
      influence_.derivatives(x * x + y * y + z * z, std::span(values).first(static_cast<std::size_t>(degree) + 1));
      for (int m = 0; m <= degree; ++m)
        radial[m][lane] = values[static_cast<std::size_t>(m)];
    }
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
  {
  }

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

  void radial_derivatives(const double (*offsets)[lanes], int degree, double (*radial)[lanes]) const
  {
    common_.radial_derivatives(offsets, near_factor_, degree, radial);
  }

  const Kernels& common() const { return common_; }

private:
  double near_factor_;
  const Kernels& common_;
};

} // namespace recurve::internal

#endif
