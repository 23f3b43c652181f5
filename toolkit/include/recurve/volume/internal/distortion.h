#ifndef RECURVE_VOLUME_INTERNAL_DISTORTION_H
#define RECURVE_VOLUME_INTERNAL_DISTORTION_H

#include <recurve/core/types.h>
#include <recurve/elements/basis.h>
#include <recurve/elements/element.h>
#include <recurve/volume/internal/distortion_kernels.h>
#include <recurve/volume/internal/jacobian_table.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

namespace recurve::internal {

/// Derivatives of the Lagrange functions at the points of a cell where its distortion is measured: a closed lattice
/// that is finer than the nodes. (That a cell is valid between them is for the certificate to say.)
class Distortion_points
{
public:
  Distortion_points(Element_type type, int degree) : nodes_(node_count(type, degree))
  {
    const int n = degree + 1;
    std::vector<std::array<double, 3>> derivatives(static_cast<std::size_t>(nodes_));
    for (int k = 0; k <= n; ++k)
      for (int j = 0; j <= n; ++j)
        for (int i = 0; i <= n; ++i)
        {
          Reference_point p = {double(i) / n, double(j) / n, double(k) / n};
          if ((type == Element_type::tetrahedron && i + j + k > n) || (type == Element_type::prism && i + j > n))
            continue;
          if (type == Element_type::pyramid)
          {
            if (k == n && i + j > 0)
              continue; // the apex, once
            p[0] *= 1 - p[2];
            p[1] *= 1 - p[2];
          }
          lagrange_derivatives(type, degree, p, derivatives);
          for (const auto& derivative : derivatives)
            derivatives_.insert(derivatives_.end(), derivative.begin(), derivative.end());
        }
  }

  int count() const { return static_cast<int>(derivatives_.size()) / (3 * nodes_); }
  int nodes() const { return nodes_; }
  Distortion_view view() const { return {count(), nodes_, derivatives_.data()}; }

private:
  int nodes_;
  std::vector<double> derivatives_;
};

/// made once for each type and degree.
inline const Distortion_points& distortion_points(Element_type type, int degree)
{
  static Table_store<Distortion_points> store;
  return store.get(type, degree, [](Element_type t, int p) { return Distortion_points(t, p); });
}

/// How far a map with the gradient F is from a rotation: |F|^2 / det F^(2/3) (shape) + (det F + 1 / det F) / 2
/// (volume), which grow beyond all bounds as det F tends to 0. So that it is finite and points the way out where
/// det F <= 0, det F in the denominators is replaced by chi = (det F + sqrt(det F^2 + epsilon^2)) / 2 > 0.
/// \par Source  Garanzha, Kaporin, Kudryavtseva, Protais, Ray & Sokolov 2021, ACM Trans. Graph. 40.
struct Distortion
{
  double value;
  double by_square; ///< derivative with respect to |F|^2
  double by_det;    ///< derivative with respect to det F
  double inflating; ///< second derivative with respect to det F, without negative parts

  Distortion(double square, double det, double epsilon)
  {
    const double root = std::sqrt(epsilon * epsilon + det * det);
    const double chi = det > 0 ? (det + root) / 2 : epsilon * epsilon / (2 * (root - det));
    const double slope = chi / root; // of chi
    const double third = std::cbrt(chi), shape = 1 / (third * third);
    value = square * shape + (det * det + 1) / (2 * chi);
    by_square = shape;
    by_det = -2.0 / 3 * square * shape / chi * slope + det / chi - (det * det + 1) * slope / (2 * chi * chi);
    inflating = (10.0 / 9 * square * shape / chi + (det * det + 1) / (chi * chi)) * slope * slope / chi;
  }
};

} // namespace recurve::internal

#endif
