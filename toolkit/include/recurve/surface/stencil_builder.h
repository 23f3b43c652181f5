#ifndef RECURVE_SURFACE_STENCIL_BUILDER_H
#define RECURVE_SURFACE_STENCIL_BUILDER_H

#include <recurve/surface/internal/surface_arrays.h>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace recurve {

/// Grows the stencil of one face, from the corners of the face outwards, or of one vertex; the tool of a `Stencil`
/// policy.
///
/// Growth follows the paper's neighbour rules and cannot cross a critical edge. A builder is used for one face or
/// vertex after another and allocates nothing once its list has grown to the largest stencil.
class Stencil_builder
{
public:
  /// \param equations_per_vertex  1; 3 where normals are data too.
  explicit Stencil_builder(const internal::surface::Surface_arrays& surface, int equations_per_vertex = 1)
    : surface_(&surface), equations_per_vertex_(equations_per_vertex),
      marks_(static_cast<std::size_t>(surface.vertex_count()), 0)
  {}

  /// number of vertices so far.
  Index size() const { return static_cast<Index>(vertices_.size()); }

  /// number of equations that the vertices so far give: one each, or three where their normals are data too, which they
  /// are not on rims.
  Index equations() const { return size() + (equations_per_vertex_ - 1) * (size() - rim_vertices_); }

  /// whether the stencil holds a vertex on the rim of its surface region (on a critical edge or border): it sees the
  /// surface on one side only.
  bool touches_rim() const { return rim_vertices_ > 0; }

  /// adds one ring: the neighbours of the vertices that were added last. Neighbours of a vertex that is not critical
  /// are all vertices that share an edge with it; of a critical one, those at the other end of its critical edges; a
  /// sharp vertex has none.
  void add_ring()
  {
    const std::size_t end = vertices_.size();
    for (; ring_first_ < end; ++ring_first_)
      for (const Index neighbor : surface_->neighbors_of(vertices_[ring_first_]))
        add(neighbor);
  }

  /// adds a half ring: all corners of each face that shares an edge, which is not critical, with the stencil.
  void add_half_ring()
  {
    const std::size_t end = half_ring_first_ = vertices_.size();
    for (std::size_t i = 0; i < end; ++i)
      for (const Index corner : surface_->corners_of_vertex(vertices_[i]))
        if (has_edge(corner))
          for (const Index vertex : surface_->corners_of_face(surface_->corner_faces[corner]))
            await(vertex);
    for (std::size_t i = end; i < vertices_.size(); ++i)
    {
      marks_[vertices_[i]] = epoch_;
      rim_vertices_ += surface_->is_rim[vertices_[i]];
    }
  }

  /// takes back the half ring that was added last, so that `add_ring()` can add the whole one.
  void drop_half_ring()
  {
    for (std::size_t i = half_ring_first_; i < vertices_.size(); ++i)
    {
      marks_[vertices_[i]] = 0;
      rim_vertices_ -= surface_->is_rim[vertices_[i]];
    }
    vertices_.resize(std::min(half_ring_first_, vertices_.size()));
  }

  /// takes back all but the first `count` of `vertices()`, which may have been put in another order. No ring can be
  /// added after that.
  void keep_first(Index count)
  {
    for (std::size_t i = static_cast<std::size_t>(count); i < vertices_.size(); ++i)
    {
      marks_[vertices_[i]] = 0;
      rim_vertices_ -= surface_->is_rim[vertices_[i]];
    }
    vertices_.resize(std::min(static_cast<std::size_t>(count), vertices_.size()));
  }

  /// starts anew with the corners of `face`. Called by `reconstruct_surface()` before the policy.
  void start(Index face)
  {
    forget();
    for (const Index vertex : surface_->corners_of_face(face))
      add(vertex);
  }

  /// starts anew with one vertex. From there the stencil grows over vertices whose normal is within 84 degrees of the
  /// normal of `vertex` only: never round an edge to the other side of a thin plate. Called by `fit_vertices()` before
  /// the policy.
  void start_at_vertex(Index vertex)
  {
    forget();
    normal_ = surface_->normals[vertex];
    least_cosine_ = least_facing_cosine;
    add(vertex);
  }

  /// the stencil so far, in the order of its growth.
  std::span<Index> vertices() { return vertices_; }

private:
  static constexpr double least_facing_cosine = 0.1; ///< a height function steeper than this is no use

  bool is_facing(Index vertex) const
  {
    const Point& normal = surface_->normals[vertex];
    return least_cosine_ < -1 ||
           normal[0] * normal_[0] + normal[1] * normal_[1] + normal[2] * normal_[2] >= least_cosine_;
  }

  // marks_[v] is epoch_ for a vertex of the stencil and epoch_ + 1 for one that a half ring is about to add.
  void add(Index vertex)
  {
    if (marks_[vertex] == epoch_ || !is_facing(vertex))
      return;
    marks_[vertex] = epoch_;
    vertices_.push_back(vertex);
    rim_vertices_ += surface_->is_rim[vertex];
  }

  void await(Index vertex)
  {
    if (marks_[vertex] >= epoch_ || !is_facing(vertex))
      return;
    marks_[vertex] = epoch_ + 1;
    vertices_.push_back(vertex);
  }

  bool has_edge(Index corner) const
  {
    return !surface_->is_critical_edge[corner] &&
           marks_[surface_->corner_vertices[surface_->next_corner(corner)]] == epoch_;
  }

  void forget()
  {
    vertices_.clear();
    ring_first_ = 0;
    half_ring_first_ = 0;
    rim_vertices_ = 0;
    least_cosine_ = -2;
    epoch_ += 2;
    if (epoch_ >= std::numeric_limits<std::uint32_t>::max() - 2)
    {
      std::fill(marks_.begin(), marks_.end(), 0);
      epoch_ = 2;
    }
  }

  const internal::surface::Surface_arrays* surface_;
  int equations_per_vertex_;
  std::vector<std::uint32_t> marks_;
  std::uint32_t epoch_ = 0;
  std::vector<Index> vertices_;
  std::size_t ring_first_ = 0;
  std::size_t half_ring_first_ = 0;
  int rim_vertices_ = 0;
  Point normal_ = {};
  double least_cosine_ = -2; ///< below -1: all face
};

} // namespace recurve

#endif
