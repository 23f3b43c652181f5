#ifndef RECURVE_VOLUME_INTERNAL_JACOBIAN_KERNELS_H
#define RECURVE_VOLUME_INTERNAL_JACOBIAN_KERNELS_H

#include <recurve/volume/internal/jacobian_table.h>

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>
#include <utility>

#if defined(__FAST_MATH__)
  #error "bounds of rounding errors need IEEE arithmetic: do not compile bound_jacobian.h with -ffast-math"
#endif

namespace recurve::internal {

/// Largest number of elements in a batch.
inline constexpr int max_batch = 8;

/// The proof needs half of the error bound; the other half also covers the rounding of the bound itself and of what is
/// added to it.
inline constexpr double error_margin = 2;

/// What underflow may add to a coefficient of an element scaled to unit size: at most 2^-1075 per operation, carried on
/// by factors that stay far below 1e70.
inline constexpr double underflow_allowance = 1e-250;

/// Bounds of det J times 2^(-3 exponent), one to a lane. If a node is not finite they are NaN, which fails every
/// comparison.
struct Batch_bounds
{
  alignas(64) double lower[max_batch];
  alignas(64) double upper[max_batch];
  alignas(64) double reached[max_batch]; ///< upper bound of the smallest value at a corner
  alignas(64) double error[max_batch];   ///< of each coefficient
  int exponent[max_batch];
  const double* coefficients = nullptr; ///< of det J, in the workspace: position * batch + lane
};

/// the power of two that brings a largest coordinate difference `extent` into [1/2, 4), and the exponent of its
/// inverse. The product of a difference with it is exact unless it underflows.
inline double inverse_unit(double extent, int& exponent)
{
  constexpr int bias = 1023, fraction_bits = 52;
  const auto biased = static_cast<int>(std::bit_cast<std::uint64_t>(extent) >> fraction_bits & 0x7ff);
  const int chosen = std::clamp(2 * bias - biased, 1, 2 * bias);
  exponent = bias - chosen;
  return std::bit_cast<double>(static_cast<std::uint64_t>(chosen) << fraction_bits);
}

namespace jacobian_baseline {
#define RECURVE_SIMD_WIDTH 2
#include <recurve/volume/internal/jacobian_kernels.ipp>
#undef RECURVE_SIMD_WIDTH
} // namespace jacobian_baseline

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__)
  #define RECURVE_HAS_JACOBIAN_DISPATCH

  #pragma GCC push_options
  #pragma GCC target("avx2")
namespace jacobian_avx2 {
  #define RECURVE_SIMD_WIDTH 4
  #include <recurve/volume/internal/jacobian_kernels.ipp>
  #undef RECURVE_SIMD_WIDTH
} // namespace jacobian_avx2
  #pragma GCC pop_options

  #pragma GCC push_options
  #pragma GCC target("avx512f,avx512dq,avx512vl,avx512bw,prefer-vector-width=512")
namespace jacobian_avx512 {
  #define RECURVE_SIMD_WIDTH 8
  #include <recurve/volume/internal/jacobian_kernels.ipp>
  #undef RECURVE_SIMD_WIDTH
} // namespace jacobian_avx512
  #pragma GCC pop_options
#endif

/// Bounds det J of `batch` elements from their nodes: nodes[(3 node + component) * batch + lane].
struct Jacobian_kernel
{
  std::string_view instruction_set;
  int batch;
  void (*bound)(const Jacobian_table& table, const double* nodes, double* work, Batch_bounds& result);
};

/// numbers of workspace that a kernel needs.
inline std::size_t workspace_size(const Jacobian_table& table, int batch)
{
  const int fields = table.fields[0].size() + table.fields[1].size() + table.fields[2].size();
  return static_cast<std::size_t>(batch) *
         static_cast<std::size_t>(12 * table.buffer_size + 3 * fields + 4 * table.position_count);
}

inline constexpr Jacobian_kernel narrow_kernel = {"baseline", jacobian_baseline::width,
                                                  &jacobian_baseline::bound_batch};

/// the widest kernel that this processor runs. The environment variable RECURVE_SIMD (baseline, avx2) asks for a
/// narrower one, for tests and comparisons.
inline const Jacobian_kernel& wide_kernel()
{
  static const Jacobian_kernel chosen = [] {
#ifdef RECURVE_HAS_JACOBIAN_DISPATCH
    const char* const variable = std::getenv("RECURVE_SIMD");
    const std::string_view wish = variable ? variable : "";
    if (wish != "baseline" && wish != "avx2" && __builtin_cpu_supports("avx512f") &&
        __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512bw"))
      return Jacobian_kernel{"avx512", jacobian_avx512::width, &jacobian_avx512::bound_batch};
    if (wish != "baseline" && __builtin_cpu_supports("avx2"))
      return Jacobian_kernel{"avx2", jacobian_avx2::width, &jacobian_avx2::bound_batch};
#endif
    return narrow_kernel;
  }();
  return chosen;
}

} // namespace recurve::internal

#endif
