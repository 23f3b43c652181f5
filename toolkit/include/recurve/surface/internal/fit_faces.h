#ifndef RECURVE_SURFACE_INTERNAL_FIT_FACES_H
#define RECURVE_SURFACE_INTERNAL_FIT_FACES_H

#include <recurve/core/progress.h>
#include <recurve/surface/internal/face_fitter.h>
#include <recurve/surface/internal/surface_arrays.h>
#include <recurve/surface/reconstruction_report.h>

#include <CGAL/boost/graph/iterator.h>
#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <vector>

namespace recurve::internal::surface {

/// Faces that are fitted in parallel before their fits are handed over one by one: many enough to keep all threads
/// busy, few enough to stay in the cache (about 6 MB of fits).
inline constexpr Index faces_per_block = 16384;

struct Fit_bounds
{
  int degree = 2;
  double largest_displacement = 100; ///< in sizes of the face
  bool interpolates_corners = false;
};

inline void add_to_report(const Face_result& result, Index face, Reconstruction_report& report)
{
  ++report.faces;
  ++report.faces_of_degree[result.fit.degree];
  report.planar_faces += result.is_planar ? 1 : 0;
  report.stencil_vertices += result.stencil_size;
  report.fits += result.fit.is_flat() ? 0 : 1;
  report.poor_stencils += result.has_poor_stencil ? 1 : 0;
  if (result.is_lowered)
  {
    ++report.lowered_faces;
    report.lowerings.push_back({face, result.fit.degree, result.reason});
  }
}

/// fits all faces in parallel and writes the fits in the order of `faces(g)`.
template <class Graph, class FaceFitMap, class Policies>
Reconstruction_report fit_faces(const Graph& g, const Surface_arrays& surface, FaceFitMap fits,
                                const Fit_bounds& bounds, const Policies& policies, const Progress_callback& progress)
{
  constexpr auto stage = "reconstruct surface";
  using Fitter = Face_fitter<Policies>;
  tbb::enumerable_thread_specific<Fitter> fitters(
    [&] { return Fitter(surface, policies, bounds.largest_displacement, bounds.interpolates_corners); });
  std::vector<Face_result> block(static_cast<std::size_t>(std::min(faces_per_block, surface.face_count())));
  Reconstruction_report report;
  auto face = faces(g).begin();
  report_progress(progress, stage, 0);
  for (Index first = 0; first < surface.face_count(); first += faces_per_block)
  {
    const Index last = std::min(first + faces_per_block, surface.face_count());
    tbb::parallel_for(tbb::blocked_range<Index>(first, last), [&](const tbb::blocked_range<Index>& range) {
      Fitter& fitter = fitters.local();
      for (Index f = range.begin(); f < range.end(); ++f)
        block[f - first] = fitter.fit(f, bounds.degree);
    });
    for (Index f = first; f < last; ++f, ++face)
    {
      put(fits, *face, block[f - first].fit);
      add_to_report(block[f - first], f, report);
    }
    report_progress(progress, stage, static_cast<double>(last) / surface.face_count());
  }
  return report;
}

} // namespace recurve::internal::surface

#endif
