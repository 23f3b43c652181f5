#ifndef RECURVE_SURFACE_INTERNAL_FIT_ALL_VERTICES_H
#define RECURVE_SURFACE_INTERNAL_FIT_ALL_VERTICES_H

#include <recurve/core/progress.h>
#include <recurve/surface/internal/edge_displacement.h>
#include <recurve/surface/internal/surface_arrays.h>
#include <recurve/surface/internal/vector_3.h>
#include <recurve/surface/internal/vertex_fit_judge.h>
#include <recurve/surface/internal/vertex_fit_store.h>
#include <recurve/surface/internal/vertex_fitter.h>
#include <recurve/surface/reconstruction_report.h>
#include <recurve/surface/vertex_fit.h>

#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

namespace recurve::internal::surface {

/// What became of one vertex in the end, for the report.
struct Vertex_outcome
{
  std::int32_t stencil_size = 0;
  std::int8_t degree = 0;
  Vertex_fit_state state = Vertex_fit_state::none;
  Lowering_reason reason = Lowering_reason::undetermined;

  bool counts() const { return state == Vertex_fit_state::curved || state == Vertex_fit_state::flat; }
};

/// All vertex fits of a surface: fits them, compares the two fits at the ends of each edge and fits again, with a lower
/// degree, where they disagree.
template <class Policies>
class All_vertex_fits
{
public:
  All_vertex_fits(const Surface_arrays& surface, const Policies& policies, const Vertex_fit_bounds& bounds)
    : surface_(surface), bounds_(bounds),
      fitters_([&surface, &policies, bounds] { return Vertex_fitter<Policies>(surface, policies, bounds); }),
      fits_(std::make_shared<Vertex_fit_store>(surface.points.size())), outcomes_(surface.points.size()),
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
  std::span<const Vertex_outcome> outcomes() const { return outcomes_; }

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

  /// calls `work` with the first and the end of each range of numbers up to `count`.
  template <class Work>
  static void for_ranges(Index count, const Work& work)
  {
    tbb::parallel_for(tbb::blocked_range<Index>(0, count, 64),
                      [&](const tbb::blocked_range<Index>& range) { work(range.begin(), range.end()); });
  }

  template <class Vertices>
  void fit(const Vertices& vertices)
  {
    for_ranges(vertices.size(), [&](Index first, Index end) {
      Vertex_fitter<Policies>& fitter = fitters_.local();
      Coefficient_room& room = fits_->room();
      for (Index i = first; i < end; ++i)
        fit(vertices[i], fitter, room);
    });
  }

  void fit(Index v, Vertex_fitter<Policies>& fitter, Coefficient_room& room)
  {
    const Vertex_result result = fitter.fit(v, degrees_[v]);
    fits_->set(v, fitter.draft(), room);
    Vertex_outcome& outcome = outcomes_[static_cast<std::size_t>(v)];
    outcome.stencil_size = static_cast<std::int32_t>(result.stencil_size);
    outcome.degree = static_cast<std::int8_t>(fitter.draft().degree);
    outcome.state = fitter.draft().state;
    if (degrees_[v] >= bounds_.degree && result.reason)
      outcome.reason = *result.reason; // that of the first lowering stands
    double* const displacements = displacements_.get() + surface_.neighbor_first[v];
    if (fitter.draft().state == Vertex_fit_state::curved)
      std::copy(fitter.displacements().begin(), fitter.displacements().end(), displacements);
    else
      std::fill_n(displacements, surface_.neighbors_of(v).size(), std::numeric_limits<double>::quiet_NaN());
  }

  /// the displacement of the same edge from its other end; not a number if that has no curved fit.
  double opposite_displacement(Index v, Index neighbor) const
  {
    const std::span<const Index> neighbors = surface_.neighbors_of(neighbor);
    const auto place = std::find(neighbors.begin(), neighbors.end(), v);
    if (place == neighbors.end())
      return std::numeric_limits<double>::quiet_NaN();
    return displacements_[static_cast<std::size_t>(surface_.neighbor_first[neighbor] + (place - neighbors.begin()))];
  }

  /// lowers the wanted degree of the vertices of `candidates` whose fits are poor. \return them.
  template <class Vertices>
  std::vector<Index> find_poor_fits(const Vertices& candidates)
  {
    std::vector<std::int8_t> degrees(static_cast<std::size_t>(candidates.size()));
    for_ranges(candidates.size(), [&](Index first, Index end) {
      for (Index i = first; i < end; ++i)
        degrees[static_cast<std::size_t>(i)] = degree_wanted(candidates[i]);
    });
    std::vector<Index> poor;
    for (Index i = 0; i < candidates.size(); ++i)
      if (degrees[static_cast<std::size_t>(i)] < degrees_[candidates[i]])
      {
        degrees_[candidates[i]] = degrees[static_cast<std::size_t>(i)];
        poor.push_back(candidates[i]);
      }
    return poor;
  }

  /// a lower degree where a neighbour has one that is far lower, or where the fit of a neighbour displaces the edge
  /// between them otherwise and is nearer to what the normals tell.
  std::int8_t degree_wanted(Index v)
  {
    const Vertex_outcome& outcome = outcomes_[static_cast<std::size_t>(v)];
    if (outcome.state != Vertex_fit_state::curved || outcome.degree <= 2)
      return degrees_[v]; // a parabola is as harmless as fits are
    Estimated_bend bend;
    for (Index i = surface_.neighbor_first[v]; i < surface_.neighbor_first[v + 1]; ++i)
    {
      const Index neighbor = surface_.neighbors[i];
      if (is_far_below(neighbor, outcome))
        return lowered(v);
      const double own = displacements_[i];
      const double others = opposite_displacement(v, neighbor);
      const double difference = std::abs(own - others);
      if (!(difference > bounds_.largest_disagreement * std::max(std::abs(own), std::abs(others))))
        continue;
      const double edge_length = length(subtract(surface_.points[neighbor], surface_.points[v]));
      if (bend.longest_edge == 0) // not known yet
        bend = estimated_bend(surface_, v, (*fits_)[v]);
      const double estimate = estimate_of_edge(v, neighbor, bend);
      if (difference > bend.negligible_displacement(edge_length) &&
          std::abs(own - estimate) >= std::abs(others - estimate))
        return lowered(v);
    }
    return degrees_[v];
  }

  /// the next lower degree for a vertex that does not go with its neighbours; notes that as the reason.
  std::int8_t lowered(Index v)
  {
    Vertex_outcome& outcome = outcomes_[static_cast<std::size_t>(v)];
    if (degrees_[v] >= bounds_.degree)
      outcome.reason = Lowering_reason::disagreement;
    return static_cast<std::int8_t>((outcome.degree - 1) / 2 * 2);
  }

  /// what the normals tell of the edge, the same from both ends.
  double estimate_of_edge(Index v, Index neighbor, const Estimated_bend& bend) const
  {
    const Vertex_fit &own = (*fits_)[v], &other = (*fits_)[neighbor];
    const double estimate = bend.displacement(surface_, own, v, neighbor);
    if (own.rows.are_straight() && other.rows.are_straight())
      return estimate;
    const Estimated_bend others = estimated_bend(surface_, neighbor, other);
    return 0.5 * (estimate + others.displacement(surface_, other, neighbor, v));
  }

  /// whether the fit of `neighbor` is so much lower that the points around hardly resolve what a polynomial of the
  /// degree of `own` has to tell. (Rims apart, where higher degrees are asked for than elsewhere.)
  bool is_far_below(Index neighbor, const Vertex_outcome& own) const
  {
    constexpr int largest_step = 4; // measured on coarse aerofoils: single degrees of 6 and 8 beside 0 and 2 are wrong
    const Vertex_outcome& other = outcomes_[static_cast<std::size_t>(neighbor)];
    return other.counts() && own.degree <= bounds_.degree && own.degree > other.degree + largest_step;
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
  std::vector<Vertex_outcome> outcomes_;
  std::vector<std::int8_t> degrees_;        ///< asked for
  std::unique_ptr<double[]> displacements_; ///< per entry of Surface_arrays::neighbors; see Vertex_fitter
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
  Face_reporter(const Surface_arrays& surface, std::span<const Vertex_outcome> outcomes, int degree,
                int polynomial_degree)
    : surface_(surface), outcomes_(outcomes), degree_(degree), polynomial_degree_(polynomial_degree)
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
    const Reconstruction_report of_faces = tbb::parallel_reduce(
      Range(0, surface_.face_count(), 1024), Reconstruction_report(),
      [this](const Range& range, Reconstruction_report report) {
        for (Index face = range.begin(); face < range.end(); ++face)
          add_face(face, report);
        return report;
      },
      joined);
    return joined(std::move(of_vertices), of_faces);
  }

private:
  /// Parts are joined in the order of the vertices or faces.
  static Reconstruction_report joined(Reconstruction_report first, const Reconstruction_report& second)
  {
    first += second;
    return first;
  }

  const Vertex_outcome& at(Index v) const { return outcomes_[static_cast<std::size_t>(v)]; }

  void add_vertex(Index v, Reconstruction_report& report) const
  {
    const bool is_curved = at(v).state == Vertex_fit_state::curved;
    report.fits += is_curved ? 1 : 0;
    report.reduced_fits += at(v).counts() && at(v).degree < polynomial_degree_ ? 1 : 0;
    report.stencil_vertices += is_curved ? at(v).stencil_size : 0;
  }

  void add_face(Index face, Reconstruction_report& report) const
  {
    const auto corners = surface_.corners_of_face(face);
    const auto is_lower = [this](Index a, Index b) {
      return at(a).counts() != at(b).counts() ? at(a).counts() : at(a).degree < at(b).degree;
    };
    const Vertex_outcome& lowest = at(*std::min_element(corners.begin(), corners.end(), is_lower));
    const bool is_planar = std::all_of(corners.begin(), corners.end(), [this](Index v) { return !at(v).counts(); });
    const bool has_normal = surface_.face_normals[face] != Point{0, 0, 0};
    const int found = std::min(degree_, lowest.counts() ? static_cast<int>(lowest.degree) : 0);
    ++report.faces;
    ++report.faces_of_degree[static_cast<std::size_t>(found)];
    if (is_planar && has_normal)
      ++report.planar_faces;
    else if (found < degree_ && lowest.counts())
    {
      ++report.lowered_faces;
      report.lowerings.push_back({face, found, lowest.reason});
    }
    else if (is_planar)
    {
      ++report.lowered_faces;
      report.lowerings.push_back({face, 0, Lowering_reason::no_normal});
    }
  }

  const Surface_arrays& surface_;
  std::span<const Vertex_outcome> outcomes_;
  int degree_;
  int polynomial_degree_;
};

} // namespace recurve::internal::surface

#endif
