#ifndef RECURVE_VOLUME_INTERNAL_DISTORTION_KERNELS_H
#define RECURVE_VOLUME_INTERNAL_DISTORTION_KERNELS_H

#include <recurve/volume/internal/jacobian_kernels.h>

#include <cstddef>

namespace recurve::internal {

/// Points of a cell type as the kernels see them: the derivatives of all nodes' functions, point by point.
struct Distortion_view
{
  int count;                 ///< of points
  int nodes;                 ///< of a cell
  const double* derivatives; ///< [3 (nodes point + node) + direction]
};

namespace distortion_baseline {
#define RECURVE_SIMD_WIDTH 2
#include <recurve/volume/internal/distortion_kernels.ipp>
#undef RECURVE_SIMD_WIDTH
} // namespace distortion_baseline

#ifdef RECURVE_HAS_JACOBIAN_DISPATCH
  #pragma GCC push_options
  #pragma GCC target("avx2")
namespace distortion_avx2 {
  #define RECURVE_SIMD_WIDTH 4
  #include <recurve/volume/internal/distortion_kernels.ipp>
  #undef RECURVE_SIMD_WIDTH
} // namespace distortion_avx2
  #pragma GCC pop_options

  #pragma GCC push_options
  #pragma GCC target("avx512f,avx512dq,avx512vl,avx512bw,prefer-vector-width=512")
namespace distortion_avx512 {
  #define RECURVE_SIMD_WIDTH 8
  #include <recurve/volume/internal/distortion_kernels.ipp>
  #undef RECURVE_SIMD_WIDTH
} // namespace distortion_avx512
  #pragma GCC pop_options
#endif

/// Works on `batch` cells at a time. Everything is [number * batch + lane], where the number of a matrix entry is
/// 9 point + 3 row + column, that of a component of a node 3 node + component, and that of an entry of its block
/// 6 node + entry.
struct Distortion_kernel
{
  int batch;
  void (*find_reference_gradients)(const Distortion_view& points, const double* vectors, double* gradients);
  void (*find_map_gradients)(const Distortion_view& points, const double* inverses, double* gradients, double* squares,
                             double* determinants);
  void (*find_slopes)(const Distortion_view& points, const double* inverses, const double* gradients,
                      const double* by_square, const double* by_det, double* slopes);
  void (*find_blocks)(const Distortion_view& points, const double* inverses, const double* gradients,
                      const double* by_square, const double* inflating, double* blocks);
};

/// as wide as that for Jacobians.
inline const Distortion_kernel& distortion_kernel()
{
  static const Distortion_kernel chosen = [] {
#ifdef RECURVE_HAS_JACOBIAN_DISPATCH
    if (wide_kernel().batch == distortion_avx512::width)
    {
      using namespace distortion_avx512;
      return Distortion_kernel{width, &find_reference_gradients, &find_map_gradients, &find_slopes, &find_blocks};
    }
    if (wide_kernel().batch == distortion_avx2::width)
    {
      using namespace distortion_avx2;
      return Distortion_kernel{width, &find_reference_gradients, &find_map_gradients, &find_slopes, &find_blocks};
    }
#endif
    using namespace distortion_baseline;
    return Distortion_kernel{width, &find_reference_gradients, &find_map_gradients, &find_slopes, &find_blocks};
  }();
  return chosen;
}

} // namespace recurve::internal

#endif
