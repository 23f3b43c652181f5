#ifndef RECURVE_SURFACE_INTERNAL_FIT_ALL_VERTICES_H
#define RECURVE_SURFACE_INTERNAL_FIT_ALL_VERTICES_H

#include <recurve/core/progress.h>
#include <recurve/surface/internal/edge_displacement.h>
#include <recurve/surface/internal/surface_arrays.h>
#include <recurve/surface/internal/vertex_fitter.h>
#include <recurve/surface/vertex_fit.h>

#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <span>
#include <string_view>
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
      fits_(surface.points.size()), stencil_sizes_(surface.points.size(), 0),
      reasons_(surface.points.size(), Lowering_reason::undetermined), displacements_(surface.neighbors.size(), 0.0)
  {}

  void run(const Progress_callback& progress, std::string_view stage)
  {
    std::vector<Index> all(surface_.points.size());
    std::iota(all.begin(), all.end(), Index(0));
    degrees_.assign(surface_.points.size(), static_cast<std::int8_t>(bounds_.degree_at_rim));
    for (std::size_t first = 0; first < all.size(); first += vertices_per_block)
    {
      report_progress(progress, stage, 0.9 * static_cast<double>(first) / static_cast<double>(all.size()));
      fit({all.data() + first, std::min(vertices_per_block, all.size() - first)});
    }
    for (std::vector<Index> poor = find_poor_fits(all); !poor.empty(); poor = find_poor_fits(neighborhood(poor)))
    {
      report_progress(progress, stage, 0.95);
      fit(poor);
    }
    report_progress(progress, stage, 1);
  }

  std::vector<Vertex_fit>& fits() { return fits_; }
  const std::vector<Lowering_reason>& reasons() const { return reasons_; }
  const std::vector<std::int32_t>& stencil_sizes() const { return stencil_sizes_; }

private:
  static constexpr std::size_t vertices_per_block = 65536; ///< between two reports of progress

  template <class Work>
  static void for_each(std::span<const Index> vertices, const Work& work)
  {
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, vertices.size(), 64),
                      [&](const tbb::blocked_range<std::size_t>& range) {
                        for (std::size_t i = range.begin(); i < range.end(); ++i)
                          work(vertices[i], i);
                      });
  }

  void fit(std::span<const Index> vertices)
  {
    for_each(vertices, [this](Index v, std::size_t) {
      const Vertex_result result = fitters_.local().fit(v, degrees_[v], fits_[v]);
      stencil_sizes_[v] = static_cast<std::int32_t>(result.stencil_size);
      if (degrees_[v] >= bounds_.degree && result.reason)
        reasons_[v] = *result.reason; // the reason of the first lowering stands
      set_displacements(v);
    });
  }

  /// how far the fit of `v` alone moves the middle of each edge at `v`, when it is corrected linearly so as to go
  /// through the other end.
  void set_displacements(Index v)
  {
    const Vertex_fit& fit = fits_[v];
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
    return displacements_[place - surface_.neighbors.begin()];
  }

  /// lowers the wanted degree of the vertices of `candidates` whose fits are poor. \return them.
  std::vector<Index> find_poor_fits(std::span<const Index> candidates)
  {
    std::vector<std::int8_t> degrees(candidates.size());
    for_each(candidates, [&](Index v, std::size_t i) { degrees[i] = degree_wanted(v); });
    std::vector<Index> poor;
    for (std::size_t i = 0; i < candidates.size(); ++i)
      if (degrees[i] < degrees_[candidates[i]])
      {
        degrees_[candidates[i]] = degrees[i];
        poor.push_back(candidates[i]);
      }
    return poor;
  }

  /// a lower degree where the fit of a neighbour displaces the edge between them otherwise and is nearer to what the
  /// normals tell.
  std::int8_t degree_wanted(Index v)
  {
    const Vertex_fit& fit = fits_[v];
    if (fit.state != Vertex_fit_state::curved || fit.degree <= 2)
      return degrees_[v]; // a parabola is as harmless as fits are
    Estimated_bend bend;
    for (Index i = surface_.neighbor_first[v]; i < surface_.neighbor_first[v + 1]; ++i)
    {
      const Index neighbor = surface_.neighbors[i];
      if (fits_[neighbor].state != Vertex_fit_state::curved)
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
  std::vector<Vertex_fit> fits_;
  std::vector<std::int32_t> stencil_sizes_;
  std::vector<Lowering_reason> reasons_;
  std::vector<std::int8_t> degrees_;  ///< asked for
  std::vector<double> displacements_; ///< per entry of Surface_arrays::neighbors
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

/// what the fits of vertices mean for the faces: the lowest of its corners makes a face.
inline Reconstruction_report report_on_faces(const Surface_arrays& surface, const std::vector<Vertex_fit>& fits,
                                             const std::vector<Lowering_reason>& reasons,
                                             const std::vector<std::int32_t>& stencil_sizes, int degree,
                                             int polynomial_degree)
{
  Reconstruction_report report;
  report.faces = surface.face_count();
  const auto counts = [](const Vertex_fit& fit) {
    return fit.state == Vertex_fit_state::curved || fit.state == Vertex_fit_state::flat;
  };
  for (std::size_t v = 0; v < fits.size(); ++v)
  {
    report.fits += fits[v].state == Vertex_fit_state::curved ? 1 : 0;
    report.reduced_fits += counts(fits[v]) && fits[v].degree < polynomial_degree ? 1 : 0;
    report.stencil_vertices += fits[v].state == Vertex_fit_state::curved ? stencil_sizes[v] : 0;
  }
  for (Index face = 0; face < surface.face_count(); ++face)
  {
    const auto corners = surface.corners_of_face(face);
    const auto lower = [&](Index a, Index b) {
      return counts(fits[a]) != counts(fits[b]) ? counts(fits[a]) : fits[a].degree < fits[b].degree;
    };
    const Index lowest = *std::min_element(corners.begin(), corners.end(), lower);
    const bool is_planar = std::all_of(corners.begin(), corners.end(), [&](Index v) {
      return fits[v].state == Vertex_fit_state::planar || fits[v].state == Vertex_fit_state::none;
    });
    const bool has_normal = surface.face_normals[face] != Point{0, 0, 0};
    const int found = std::min(degree, counts(fits[lowest]) ? static_cast<int>(fits[lowest].degree) : 0);
    ++report.faces_of_degree[static_cast<std::size_t>(found)];
    if (is_planar && has_normal)
      ++report.planar_faces;
    else if (found < degree && counts(fits[lowest]))
    {
      ++report.lowered_faces;
      report.lowerings.push_back({face, found, reasons[lowest]});
    }
    else if (is_planar)
    {
      ++report.lowered_faces;
      report.lowerings.push_back({face, 0, Lowering_reason::no_normal});
    }
  }
  return report;
}

} // namespace recurve::internal::surface

#endif
