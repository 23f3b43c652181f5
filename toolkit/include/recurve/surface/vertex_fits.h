#ifndef RECURVE_SURFACE_VERTEX_FITS_H
#define RECURVE_SURFACE_VERTEX_FITS_H

#include <recurve/surface/internal/blended_fit.h>
#include <recurve/surface/internal/surface_arrays.h>
#include <recurve/surface/internal/vertex_fit_store.h>
#include <recurve/surface/vertex_fit.h>

#include <CGAL/boost/graph/iterator.h>
#include <CGAL/boost/graph/properties.h>
#include <boost/graph/graph_traits.hpp>
#include <boost/property_map/property_map.hpp>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <memory>
#include <span>
#include <utility>
#include <vector>

namespace recurve {

/// The fits of all vertices of a graph, as `fit_vertices()` makes them. A vertex has one fit for each surface region
/// around it.
///
/// Between the vertices the surface is the blend of their fits: a node at the (bi)linear shape functions N_i of a face
/// goes to the mean, weighted with N_i, of where the fits of the corners take it, each fit being corrected by its
/// residuals at the other corners. Adjacent faces of a region agree on their edge.
///
/// Copies share the fits, which nothing changes any more: a fit, or a blend of fits, is there as long as any copy of
/// the object that it comes from. One that was moved from may only be assigned to or destroyed.
template <class Graph>
class Vertex_fits
{
  using Traits = boost::graph_traits<Graph>;
  using Face_numbers = typename boost::property_map<Graph, CGAL::dynamic_face_property_t<Index>>::const_type;

public:
  using halfedge_descriptor = typename Traits::halfedge_descriptor;
  using face_descriptor = typename Traits::face_descriptor;

  /// Readable map face -> fit, for `curve_surface()`.
  struct Face_map
  {
    using key_type = face_descriptor;
    using value_type = internal::surface::Blended_fit;
    using reference = value_type;
    using category = boost::readable_property_map_tag;

    const Vertex_fits* fits = nullptr;

    friend value_type get(const Face_map& map, face_descriptor face) { return map.fits->face_fit(face); }

    /// the blend of the two ends of an edge on the side of the half-edge's face, first source, then target.
    value_type edge_fit(halfedge_descriptor halfedge) const { return fits->edge_fit(halfedge); }
  };

  /// \param fits  one per vertex of `surface`.
  Vertex_fits(const Graph& g, internal::surface::Surface_arrays&& surface,
              std::shared_ptr<const internal::surface::Vertex_fit_store> fits);

  Face_map face_map() const { return {this}; }

  /// the fit at corner `corner` of `face`, counted from source(halfedge(face, g)).
  const Vertex_fit& fit_at_corner(face_descriptor face, int corner) const
  {
    return (*fits_)[vertices_[face_first_[get(face_numbers_, face)] + corner]];
  }

  /// the fit at source(`halfedge`), in the region of the half-edge's face.
  const Vertex_fit& fit_at_source(halfedge_descriptor h) const
  {
    int corner = 0;
    for (auto other = halfedge(face(h, *graph_), *graph_); other != h; other = next(other, *graph_))
      ++corner;
    return fit_at_corner(face(h, *graph_), corner);
  }

  /// all fits, those of one vertex one after the other.
  std::span<const Vertex_fit> all() const { return fits_->all(); }

  /// the blend over a face.
  internal::surface::Blended_fit face_fit(face_descriptor face) const
  {
    const Index number = get(face_numbers_, face);
    std::array<const Vertex_fit*, 4> corners = {};
    const std::size_t count = static_cast<std::size_t>(face_first_[number + 1] - face_first_[number]);
    for (std::size_t i = 0; i < count; ++i)
      corners[i] = &(*fits_)[vertices_[face_first_[number] + static_cast<Index>(i)]];
    return internal::surface::Blended_fit(std::span<const Vertex_fit* const>(corners.data(), count));
  }

  /// the blend of the two ends of an edge on the side of the half-edge's face, first source, then target.
  internal::surface::Blended_fit edge_fit(halfedge_descriptor h) const
  {
    const std::array<const Vertex_fit*, 2> ends = {&fit_at_source(h), &fit_at_source(next(h, *graph_))};
    return internal::surface::Blended_fit(ends);
  }

private:
  const Graph* graph_;
  Face_numbers face_numbers_;
  std::vector<Index> face_first_;
  std::vector<Index> vertices_; ///< of the corners of each face from source(halfedge(f, g)) on: positions in fits_
  std::shared_ptr<const internal::surface::Vertex_fit_store> fits_;
};

template <class Graph>
Vertex_fits<Graph>::Vertex_fits(const Graph& g, internal::surface::Surface_arrays&& surface,
                                std::shared_ptr<const internal::surface::Vertex_fit_store> fits)
  : graph_(&g), face_numbers_(get(CGAL::dynamic_face_property_t<Index>(), g)),
    face_first_(std::move(surface.face_first)), vertices_(std::move(surface.corner_vertices)), fits_(std::move(fits))
{
  Index number = 0;
  for (const auto f : faces(g))
    put(face_numbers_, f, number++);
  tbb::parallel_for(tbb::blocked_range<Index>(0, number, 1024), [&](const tbb::blocked_range<Index>& range) {
    for (Index f = range.begin(); f < range.end(); ++f)
    {
      const auto first = vertices_.begin() + face_first_[f];
      std::rotate(first, first + surface.graph_corners[f], vertices_.begin() + face_first_[f + 1]);
    }
  });
}

} // namespace recurve

#endif
