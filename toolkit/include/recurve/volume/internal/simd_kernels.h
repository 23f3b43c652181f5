#ifndef RECURVE_VOLUME_INTERNAL_SIMD_KERNELS_H
#define RECURVE_VOLUME_INTERNAL_SIMD_KERNELS_H

#include <recurve/core/types.h>
#include <recurve/volume/internal/expansion_table.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <string_view>
#include <utility>

#if defined(__x86_64__)
  #include <immintrin.h>
#endif

namespace recurve::internal {

/// Source cells are expanded this many at a time, whatever the instruction set: 64 bytes of numbers.
template <class Real>
inline constexpr int lanes = 64 / static_cast<int>(sizeof(Real));

/// One number for each of them.
template <class Real>
using Pack = Real[lanes<Real>];

/// Arrays of coordinates.
template <class Real>
struct Coordinates
{
  const Real *x, *y, *z;
};

/// Arrays of positions, weights and weighted displacements of sources.
template <class Real>
struct Charges
{
  const Real *x, *y, *z, *weight, *weighted_x, *weighted_y, *weighted_z;
};

/// Arrays of the four sums of each target: of the weights, and of the weighted displacements.
struct Sums
{
  double *weight, *x, *y, *z;
};

/// 1/n; a plain array, for the kernels must not call functions of std.
inline constexpr double inverse_integers[max_expansion_degree + 2] = {
  0, 1, 1.0 / 2, 1.0 / 3, 1.0 / 4, 1.0 / 5, 1.0 / 6, 1.0 / 7, 1.0 / 8, 1.0 / 9, 1.0 / 10, 1.0 / 11};

/// the square roots of the elements of a vector, where there is no instruction for it.
template <class Vector>
Vector root_by_element(Vector v)
{
  for (std::size_t m = 0; m < sizeof(v) / sizeof(v[0]); ++m)
    v[m] = std::sqrt(v[m]);
  return v;
}

namespace summation_baseline {
#define RECURVE_SIMD_WIDTH 2
#if defined(__SSE2__)
  #define RECURVE_SIMD_ROOT(kind, q) _mm_sqrt_##kind(q)
#else
  #define RECURVE_SIMD_ROOT(kind, q) root_by_element(q)
#endif
#include <recurve/volume/internal/simd_kernels.ipp>
#undef RECURVE_SIMD_ROOT
#undef RECURVE_SIMD_WIDTH
} // namespace summation_baseline

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__)
  #define RECURVE_HAS_SIMD_DISPATCH

  #pragma GCC push_options
  #pragma GCC target("avx2")
namespace summation_avx2 {
  #define RECURVE_SIMD_WIDTH 4
  #define RECURVE_SIMD_ROOT(kind, q) _mm256_sqrt_##kind(q)
  #include <recurve/volume/internal/simd_kernels.ipp>
  #undef RECURVE_SIMD_ROOT
  #undef RECURVE_SIMD_WIDTH
} // namespace summation_avx2
  #pragma GCC pop_options

  #pragma GCC push_options
  #pragma GCC target("avx512f,avx512dq,avx512vl,avx512bw,prefer-vector-width=512")
namespace summation_avx512 {
  #define RECURVE_SIMD_WIDTH 8
  #define RECURVE_SIMD_ROOT(kind, q) _mm512_maskz_sqrt_##kind(-1, q) // unlike _mm512_sqrt, it warns of nothing
  #include <recurve/volume/internal/simd_kernels.ipp>
  #undef RECURVE_SIMD_ROOT
  #undef RECURVE_SIMD_WIDTH
} // namespace summation_avx512
  #pragma GCC pop_options
#endif

/// The steps of an expansion, about a cell of targets or at each of them, in one precision.
template <class Real>
struct Expansion
{
  void (*to_relative)(const double*, Index, double, double, Real*);
  void (*radial_derivatives)(const Pack<Real>*, const Pack<Real>&, int, Pack<Real>*);
  void (*derivative_tensor)(int, const Pack<Real>*, const Pack<Real>*, Pack<Real>*);
  void (*translate)(const Expansion_table&, int, const Pack<Real>*, const Real* const*, const Pack<Real>*,
                    const Pack<Real>*, Pack<Real>*, Pack<Real>*);
  void (*add_expansion)(int, const Pack<Real>*, const Real*, double, const Sums&);
};

/// The kernels of one instruction set, for one formula.
struct Kernels
{
  std::string_view name;
  void (*add_direct)(const Charges<double>&, Index, const Coordinates<double>&, Index, double, const Sums&);
  void (*add_direct_float)(const Charges<float>&, Index, const Coordinates<float>&, Index, float, const Sums&);
  void (*add_moments)(const Expansion_table&, int, const Charges<double>&, Index, Pack<double>*, double*);
  void (*add_local)(const Expansion_table&, int, const double*, const Coordinates<double>&, Index, const Sums&);
  Expansion<double> doubles;
  Expansion<float> floats;
};

// clang-format off
#define RECURVE_EXPANSION(set, Real)                                                                                   \
  {&set::to_relative, &set::radial_derivatives<A, B, Real>, &set::derivative_tensor<Real>, &set::translate<Real>,       \
   &set::add_expansion<Real>}
#define RECURVE_KERNELS(set)                                                                                           \
  {#set, &set::add_direct<A, B>, &set::add_direct<A, B>, &set::add_moments, &set::add_local,                            \
   RECURVE_EXPANSION(set, double), RECURVE_EXPANSION(set, float)}
// clang-format on

/// the kernels for the influence u^A + c u^B with at most the instructions of `widest` (baseline, avx2, avx512) that
/// this processor has.
template <int A, int B>
Kernels select_kernels([[maybe_unused]] std::string_view widest)
{
#ifdef RECURVE_HAS_SIMD_DISPATCH
  if (widest == "avx512" && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
      __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512bw"))
    return RECURVE_KERNELS(summation_avx512);
  if (widest != "baseline" && __builtin_cpu_supports("avx2"))
    return RECURVE_KERNELS(summation_avx2);
#endif
  return RECURVE_KERNELS(summation_baseline);
}

#undef RECURVE_KERNELS
#undef RECURVE_EXPANSION

/// the widest kernels that this processor runs. The environment variable RECURVE_SIMD (baseline, avx2) asks for
/// narrower ones, for comparisons.
template <int A, int B>
const Kernels& kernels()
{
  static const Kernels chosen = [] {
    const char* const variable = std::getenv("RECURVE_SIMD");
    return select_kernels<A, B>(variable ? variable : "avx512");
  }();
  return chosen;
}

} // namespace recurve::internal

#endif
