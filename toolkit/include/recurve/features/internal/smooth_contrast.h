#ifndef RECURVE_FEATURES_INTERNAL_SMOOTH_CONTRAST_H
#define RECURVE_FEATURES_INTERNAL_SMOOTH_CONTRAST_H

#include <recurve/features/internal/surface_angles.h>

#include <algorithm>
#include <limits>
#include <vector>

namespace recurve::internal::features {

/// Compares how much the surface bends at an edge with how much it bends beside it, per length across the edge. On a
/// sampled smooth surface neighbouring parallel edges bend at the same rate: the contrast is about 1. At a crease the
/// bending is concentrated in one edge.
class Smooth_contrast
{
public:
  /// does not look beyond pinned edges and edges with a dihedral angle above `sharp_angle`.
  Smooth_contrast(const Flat_surface& s, const Surface_angles& a, double sharp_angle)
    : s_(s), a_(a), sharp_angle_(sharp_angle)
  {}

  /// bending per length at the edge `e` over the largest beside it; infinite where the surface beside it is flat.
  double operator()(Index e)
  {
    const auto all = [](Index, double) { return true; };
    const double beside = std::max(rate_beside(2 * e, all), rate_beside(2 * e + 1, all));
    return beside > 0 ? rate(e) / beside : std::numeric_limits<double>::infinity();
  }

  /// bending per length at the edge `e` over that on its flatter side, of edges parallel to it and not in `left_out`:
  /// of a crease between a flat and a round side it is infinite, at the round nose between two sides of a profile
  /// small.
  double on_flatter_side(Index e, const std::vector<char>& left_out)
  {
    constexpr double parallel = 0.8; // cosine; in a regular triangulation the other edges have 0.5
    const auto is_taken = [&](Index other, double cosine) { return cosine >= parallel && !left_out[other]; };
    const double beside = std::min(rate_beside(2 * e, is_taken), rate_beside(2 * e + 1, is_taken));
    return beside > 0 ? rate(e) / beside : std::numeric_limits<double>::infinity();
  }

  /// bending per length at the edge `e` over the largest beside it, of edges not in `left_out`, also beyond sharp ones.
  double to_others(Index e, const std::vector<char>& left_out)
  {
    double beside = 0;
    for (const Index h : {2 * e, 2 * e + 1})
    {
      const Rates rates = rates_of_others(h, left_out);
      beside = std::max({beside, rates.most, -rates.least});
    }
    return beside > 0 ? rate(e) / beside : std::numeric_limits<double>::infinity();
  }

  /// How the surface bends beside an edge.
  struct Sides
  {
    int count = 0;        ///< sides with edges to look at
    double bent_back = 0; ///< their sum: bending the other way, per length, as a part of that at the edge
  };

  /// looks at the edges beside `e` that are not in `left_out`. Noise bends back, and waves do; beside a crease of a
  /// smooth surface it goes on. No side counts for more than `most`.
  Sides look_aside(Index e, double most, const std::vector<char>& left_out)
  {
    Sides sides;
    for (const Index h : {2 * e, 2 * e + 1})
      if (const Rates rates = rates_of_others(h, left_out); !rates.is_empty())
      {
        ++sides.count;
        sides.bent_back += std::clamp((is_convex(e) ? -rates.least : rates.most) / rate(e), 0., most);
      }
    return sides;
  }

private:
  /// The range of rates of some edges: positive where the surface is convex, negative where it is concave.
  struct Rates
  {
    double least = std::numeric_limits<double>::infinity(), most = -std::numeric_limits<double>::infinity();
    bool is_empty() const { return least > most; }
  };

  bool is_convex(Index e) const
  {
    return dot(cross(a_.normal[s_.face[2 * e]], a_.normal[s_.face[2 * e + 1]]), direction(s_, 2 * e)) > 0;
  }

  /// the rates of those edges beside `h`, within two faces on its side, that are neither pinned nor in `left_out`, each
  /// as far as it runs along `h`.
  Rates rates_of_others(Index h, const std::vector<char>& left_out)
  {
    const auto is_out = [&](Index e) { return a_.is_pinned[e] || left_out[e]; };
    gather_faces(h, is_out);
    const Vector along = direction(s_, h);
    Rates rates;
    for (const Index f : faces_)
    {
      Index g = s_.face_halfedge[f];
      do
      {
        if (g / 2 != h / 2 && !is_out(g / 2))
        {
          const double r = rate(g / 2) * std::abs(dot(direction(s_, g), along));
          rates.least = std::min(rates.least, is_convex(g / 2) ? r : -r);
          rates.most = std::max(rates.most, is_convex(g / 2) ? r : -r);
        }
        g = s_.next[g];
      } while (g != s_.face_halfedge[f]);
    }
    return rates;
  }

  bool is_barrier(Index e) const { return a_.is_pinned[e] || a_.dihedral[e] > sharp_angle_; }

  double distance_to_line(const Point& p, Index h, const Vector& along) const
  {
    return norm(cross(p - s_.points[s_.target[h]], along));
  }

  /// how far the face of the half-edge `h` reaches from the line of `h`.
  double height(Index h) const
  {
    const Vector along = direction(s_, h);
    double most = 0;
    for (Index g = s_.next[h]; g != h; g = s_.next[g])
      most = std::max(most, distance_to_line(s_.points[s_.target[g]], h, along));
    return most;
  }

  /// dihedral angle per length across the edge, which is not on a border.
  double rate(Index e) const
  {
    const double width = (height(2 * e) + height(2 * e + 1)) / 2;
    return width > 0 ? a_.dihedral[e] / width : 0;
  }

  /// the largest rate of those edges beside `h`, within two faces on its side, that `is_taken`(edge, cosine of its
  /// angle with `h`), each as far as it runs along `h`: by that cosine.
  template <class Predicate>
  double rate_beside(Index h, Predicate is_taken)
  {
    gather_faces(h, [&](Index e) { return is_barrier(e); });
    const Vector along = direction(s_, h);
    const double least_distance = height(h) / 2;
    double most = 0;
    for (const Index f : faces_)
    {
      Index g = s_.face_halfedge[f];
      do
      {
        const double cosine = std::abs(dot(direction(s_, g), along));
        if (is_taken(g / 2, cosine) && !is_barrier(g / 2) && is_beside(g, h, along, least_distance))
          most = std::max(most, rate(g / 2) * cosine);
        g = s_.next[g];
      } while (g != s_.face_halfedge[f]);
    }
    return most;
  }

  /// whether `g` is away from the line of `h` and next to `h` at least for a part of its length. What continues `h` is
  /// not beside it, even where the curve turns.
  bool is_beside(Index g, Index h, const Vector& along, double least_distance) const
  {
    constexpr double least_overlap = 0.25; // in a regular triangulation neighbouring rows overlap by 1/2
    const Point &first = s_.points[s_.source_of(h)], &a = s_.points[s_.source_of(g)], &b = s_.points[s_.target[g]];
    const double length = dot(s_.points[s_.target[h]] - first, along);
    const auto [low, high] = std::minmax({dot(a - first, along), dot(b - first, along)});
    const double overlap = std::min(high, length) - std::max(low, 0.);
    return overlap >= least_overlap * std::min(length, high - low) &&
           distance_to_line(0.5 * (a + b), h, along) >= least_distance;
  }

  /// the face of `h`, and if it is a triangle, those at most two steps from it that can be reached over triangles
  /// without crossing `h` or an edge that `is_end`. So the next row of faces is seen whether quadrangles are split or
  /// not, and what lies beyond it is not.
  template <class Predicate>
  void gather_faces(Index h, Predicate is_end)
  {
    faces_.assign(1, s_.face[h]);
    std::size_t done = 0;
    for (int step = 0; step < 2; ++step)
    {
      const std::size_t end = faces_.size();
      for (; done < end; ++done)
      {
        const Index first = s_.face_halfedge[faces_[done]];
        if (s_.next[s_.next[s_.next[first]]] != first)
          continue;
        Index g = first;
        do
        {
          const bool is_open = g / 2 != h / 2 && !is_end(g / 2);
          if (is_open && std::find(faces_.begin(), faces_.end(), s_.face[g ^ 1]) == faces_.end())
            faces_.push_back(s_.face[g ^ 1]);
          g = s_.next[g];
        } while (g != first);
      }
    }
  }

  const Flat_surface& s_;
  const Surface_angles& a_;
  double sharp_angle_;
  std::vector<Index> faces_;
};

} // namespace recurve::internal::features

#endif
