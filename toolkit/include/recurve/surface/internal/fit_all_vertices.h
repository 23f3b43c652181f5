#ifndef RECURVE_SURFACE_INTERNAL_FIT_ALL_VERTICES_H
#define RECURVE_SURFACE_INTERNAL_FIT_ALL_VERTICES_H

#include <recurve/core/progress.h>
#include <recurve/surface/internal/edge_displacement.h>
#include <recurve/surface/internal/surface_arrays.h>
#include <recurve/surface/internal/vertex_fit_store.h>
#include <recurve/surface/internal/vertex_fitter.h>
#include <recurve/surface/vertex_fit.h>

#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

namespace recurve::internal::surface {

/// All vertex fits of a surface: fits them, compares the two fits at the ends of each edge and fits again, with a lower
/// degree, where they disagree.
template <class Policies>
class All_vertex_fits
{
public:
  All_vertex_fits(const Surface_arrays& surface, const Policies& policies, const Vertex_fit_bounds& bounds)
    : surface_(surface), bounds_(bounds),
      fitters_([&surface, &policies, bounds] { return Vertex_fitter<Policies>(surface, policies, bounds); }),
      fits_(std::make_shared<Vertex_fit_store>(surface.points.size())), stencil_sizes_(surface.points.size(), 0),
      reasons_(surface.points.size(), Lowering_reason::undetermined),
      degrees_(surface.points.size(), static_cast<std::int8_t>(bounds.degree_at_rim)),
      displacements_(std::make_unique_for_overwrite<double[]>(surface.neighbors.size()))
  {}

  void run(const Progress_callback& progress, std::string_view stage)
  {
    const Index count = surface_.vertex_count();
    for (Index first = 0; first < count; first += vertices_per_block)
    {
      report_progress(progress, stage, 0.9 * static_cast<double>(first) / static_cast<double>(count));
      fit(Consecutive_vertices{first, std::min(vertices_per_block, count - first)});
    }
    for (std::vector<Index> poor = find_poor_fits(Consecutive_vertices{0, count}); !poor.empty();
         poor = find_poor_fits(Listed_vertices{neighborhood(poor)}))
    {
      report_progress(progress, stage, 0.95);
      fit(Listed_vertices{poor});
    }
    report_progress(progress, stage, 1);
  }

  /// shared with those who keep the fits.
  std::shared_ptr<const Vertex_fit_store> fits() const { return fits_; }
  const std::vector<Lowering_reason>& reasons() const { return reasons_; }
  const std::vector<std::int32_t>& stencil_sizes() const { return stencil_sizes_; }

private:
  static constexpr Index vertices_per_block = 65536; ///< between two reports of progress

  struct Consecutive_vertices
  {
    Index first = 0, count = 0;
    Index size() const { return count; }
    Index operator[](Index i) const { return first + i; }
  };

  struct Listed_vertices
  {
    std::vector<Index> list;
    Index size() const { return static_cast<Index>(list.size()); }
    Index operator[](Index i) const { return list[static_cast<std::size_t>(i)]; }
  };

  template <class Vertices, class Work>
  static void for_each(const Vertices& vertices, const Work& work)
  {
    tbb::parallel_for(tbb::blocked_range<Index>(0, vertices.size(), 64), [&](const tbb::blocked_range<Index>& range) {
      for (Index i = range.begin(); i < range.end(); ++i)
        work(vertices[i], i);
    });
  }

  template <class Vertices>
  void fit(const Vertices& vertices)
  {
    for_each(vertices, [this](Index v, Index) {
      Vertex_fitter<Policies>& fitter = fitters_.local();
      const Vertex_result result = fitter.fit(v, degrees_[v]);
      fits_->set(v, fitter.draft());
      stencil_sizes_[v] = static_cast<std::int32_t>(result.stencil_size);
      if (degrees_[v] >= bounds_.degree && result.reason)
        reasons_[v] = *result.reason; // the reason of the first lowering stands
      set_displacements(v, fitter.draft());
    });
  }

  /// how far the fit of `v` alone moves the middle of each edge at `v`, when it is corrected linearly so as to go
  /// through the other end.
  void set_displacements(Index v, const Vertex_fit& fit)
  {
    for (Index i = surface_.neighbor_first[v]; i < surface_.neighbor_first[v + 1]; ++i)
    {
      displacements_[i] = 0;
      if (fit.state == Vertex_fit_state::curved)
        displacements_[i] = middle_displacement(fit, surface_.points[surface_.neighbors[i]]);
    }
  }

  /// the displacement of the same edge from its other end; not a number if that has no fit.
  double opposite_displacement(Index v, Index neighbor) const
  {
    const auto first = surface_.neighbors.begin() + surface_.neighbor_first[neighbor];
    const auto last = surface_.neighbors.begin() + surface_.neighbor_first[neighbor + 1];
    const auto place = std::lower_bound(first, last, v);
    if (place == last || *place != v)
      return std::numeric_limits<double>::quiet_NaN();
    return displacements_[static_cast<std::size_t>(place - surface_.neighbors.begin())];
  }

  /// lowers the wanted degree of the vertices of `candidates` whose fits are poor. \return them.
  template <class Vertices>
  std::vector<Index> find_poor_fits(const Vertices& candidates)
  {
    std::vector<std::int8_t> degrees(static_cast<std::size_t>(candidates.size()));
    for_each(candidates, [&](Index v, Index i) { degrees[static_cast<std::size_t>(i)] = degree_wanted(v); });
    std::vector<Index> poor;
    for (Index i = 0; i < candidates.size(); ++i)
      if (degrees[static_cast<std::size_t>(i)] < degrees_[candidates[i]])
      {
        degrees_[candidates[i]] = degrees[static_cast<std::size_t>(i)];
        poor.push_back(candidates[i]);
      }
    return poor;
  }

  /// a lower degree where the fit of a neighbour displaces the edge between them otherwise and is nearer to what the
  /// normals tell.
  std::int8_t degree_wanted(Index v)
  {
    const Vertex_fit& fit = (*fits_)[v];
    if (fit.state != Vertex_fit_state::curved || fit.degree <= 2)
      return degrees_[v]; // a parabola is as harmless as fits are
    Estimated_bend bend;
    for (Index i = surface_.neighbor_first[v]; i < surface_.neighbor_first[v + 1]; ++i)
    {
      const Index neighbor = surface_.neighbors[i];
      if ((*fits_)[neighbor].state != Vertex_fit_state::curved)
        continue;
      const double own = displacements_[i];
      const double others = opposite_displacement(v, neighbor);
      const double difference = std::abs(own - others);
      if (!(difference > bounds_.largest_disagreement * std::max(std::abs(own), std::abs(others))))
        continue;
      const double edge_length = length(subtract(surface_.points[neighbor], fit.origin));
      if (bend.longest_edge == 0) // not known yet
        bend = estimated_bend(surface_, v);
      const double estimate = estimated_displacement(surface_, v, neighbor);
      if (difference > bend.negligible_displacement(edge_length) &&
          std::abs(own - estimate) >= std::abs(others - estimate))
      {
        if (degrees_[v] >= bounds_.degree)
          reasons_[v] = Lowering_reason::disagreement;
        return static_cast<std::int8_t>((fit.degree - 1) / 2 * 2);
      }
    }
    return degrees_[v];
  }

  /// `vertices` and their neighbours, ascending.
  std::vector<Index> neighborhood(const std::vector<Index>& vertices) const
  {
    std::vector<Index> all = vertices;
    for (const Index v : vertices)
    {
      const auto neighbors = surface_.neighbors_of(v);
      all.insert(all.end(), neighbors.begin(), neighbors.end());
    }
    std::sort(all.begin(), all.end());
    all.erase(std::unique(all.begin(), all.end()), all.end());
    return all;
  }

  const Surface_arrays& surface_;
  Vertex_fit_bounds bounds_;
  tbb::enumerable_thread_specific<Vertex_fitter<Policies>> fitters_;
  std::shared_ptr<Vertex_fit_store> fits_;
  std::vector<std::int32_t> stencil_sizes_;
  std::vector<Lowering_reason> reasons_;
  std::vector<std::int8_t> degrees_;        ///< asked for
  std::unique_ptr<double[]> displacements_; ///< per entry of Surface_arrays::neighbors
};

/// the caller's normals as data. On a rim there are none: what was computed there is a mean over few faces.
inline std::vector<Point> normals_off_rims(const Surface_arrays& surface)
{
  std::vector<Point> normals = surface.normals;
  for (std::size_t v = 0; v < normals.size(); ++v)
    if (surface.is_rim[v] || surface.is_tip[v])
      normals[v] = {0, 0, 0};
  return normals;
}

/// What the fits of vertices mean for the faces: the lowest of its corners makes a face.
class Face_reporter
{
public:
  Face_reporter(const Surface_arrays& surface, const Vertex_fit_store& fits,
                const std::vector<Lowering_reason>& reasons, const std::vector<std::int32_t>& stencil_sizes, int degree,
                int polynomial_degree)
    : surface_(surface), fits_(fits), reasons_(reasons), stencil_sizes_(stencil_sizes), degree_(degree),
      polynomial_degree_(polynomial_degree)
  {}

  Reconstruction_report report() const
  {
    using Range = tbb::blocked_range<Index>;
    Reconstruction_report of_vertices = tbb::parallel_reduce(
      Range(0, surface_.vertex_count(), 1024), Reconstruction_report(),
      [this](const Range& range, Reconstruction_report report) {
        for (Index v = range.begin(); v < range.end(); ++v)
          add_vertex(v, report);
        return report;
      },
      joined);
    Reconstruction_report of_faces = tbb::parallel_reduce(
      Range(0, surface_.face_count(), 1024), Reconstruction_report(),
      [this](const Range& range, Reconstruction_report report) {
        for (Index face = range.begin(); face < range.end(); ++face)
          add_face(face, report);
        return report;
      },
      joined);
    return joined(std::move(of_vertices), std::move(of_faces));
  }

private:
  /// Parts are joined in the order of the vertices or faces.
  static Reconstruction_report joined(Reconstruction_report first, const Reconstruction_report& second)
  {
    first += second;
    return first;
  }

  static bool counts(const Vertex_fit& fit)
  {
    return fit.state == Vertex_fit_state::curved || fit.state == Vertex_fit_state::flat;
  }

  void add_vertex(Index v, Reconstruction_report& report) const
  {
    report.fits += fits_[v].state == Vertex_fit_state::curved ? 1 : 0;
    report.reduced_fits += counts(fits_[v]) && fits_[v].degree < polynomial_degree_ ? 1 : 0;
    report.stencil_vertices += fits_[v].state == Vertex_fit_state::curved ? stencil_sizes_[v] : 0;
  }

  void add_face(Index face, Reconstruction_report& report) const
  {
    const auto corners = surface_.corners_of_face(face);
    const auto lower = [&](Index a, Index b) {
      return counts(fits_[a]) != counts(fits_[b]) ? counts(fits_[a]) : fits_[a].degree < fits_[b].degree;
    };
    const Index lowest = *std::min_element(corners.begin(), corners.end(), lower);
    const bool is_planar = std::all_of(corners.begin(), corners.end(), [&](Index v) {
      return fits_[v].state == Vertex_fit_state::planar || fits_[v].state == Vertex_fit_state::none;
    });
    const bool has_normal = surface_.face_normals[face] != Point{0, 0, 0};
    const int found = std::min(degree_, counts(fits_[lowest]) ? static_cast<int>(fits_[lowest].degree) : 0);
    ++report.faces;
    ++report.faces_of_degree[static_cast<std::size_t>(found)];
    if (is_planar && has_normal)
      ++report.planar_faces;
    else if (found < degree_ && counts(fits_[lowest]))
    {
      ++report.lowered_faces;
      report.lowerings.push_back({face, found, reasons_[lowest]});
    }
    else if (is_planar)
    {
      ++report.lowered_faces;
      report.lowerings.push_back({face, 0, Lowering_reason::no_normal});
    }
  }

  const Surface_arrays& surface_;
  const Vertex_fit_store& fits_;
  const std::vector<Lowering_reason>& reasons_;
  const std::vector<std::int32_t>& stencil_sizes_;
  int degree_;
  int polynomial_degree_;
};

} // namespace recurve::internal::surface

#endif
