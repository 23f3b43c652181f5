#ifndef RECURVE_SURFACE_ROW_CIRCLES_H
#define RECURVE_SURFACE_ROW_CIRCLES_H

#include <recurve/core/types.h>

#include <cmath>

namespace recurve {

/// Coordinates around a `Vertex_fit` for long faces that stand in rows which bend within the surface, such as rings
/// round a torus, a nacelle's lip or a pole: along the circle of the row through the vertex, and as they lie when they
/// are turned back about its axis.
///
/// The surface is likely to be nearly one of revolution about that axis: turned back, its height is then a function of
/// one coordinate, the one across the rows. Over the straight coordinates s and t it is a bent valley much narrower
/// than a face is long, for which polynomials of low degree are no match.
///
/// Points and directions are given by their components in the axes of the fit: s and t in units of the axes, the height
/// over the plane as a length.
struct Row_circles
{
  double bend_in_plane = 0;  ///< curvature of the row at the vertex, one over a length, towards t > 0; 0: not bent
  double bend_off_plane = 0; ///< the same towards greater heights
  double s_unit = 1;         ///< length
  double t_unit = 1;         ///< length

  /// About the axis from the vertex to a point.
  struct Turn
  {
    double cosine = 1, sine = 0;
    double distance = 1; ///< of the point from the axis, in radii
  };

  bool are_straight() const { return bend_in_plane == 0; }

  /// whether a point is clearly on the vertex's side of the axis.
  bool is_on_near_side(const Point& local) const { return 1 - inwards(local) > 0.1; }

  /// coordinates along and across the rows and height, turned back to the vertex; in the units of s, t and the height.
  /// (0, 0, 0) at the vertex, where they are s, t and the height to first order.
  Point place(const Point& local) const;

  Turn turn(const Point& local) const;

  /// a direction, turned back.
  Point turned_back(const Turn& turn, const Point& way) const;

  /// what place() changes by on a way from a point.
  Point change(const Point& local, const Point& way) const;

private:
  double square() const { return bend_in_plane * bend_in_plane + bend_off_plane * bend_off_plane; }

  /// components towards the axis, and along it, in radii.
  double inwards(const Point& local) const { return bend_in_plane * t_unit * local[1] + bend_off_plane * local[2]; }
  double sidewards(const Point& local) const { return bend_in_plane * local[2] - bend_off_plane * t_unit * local[1]; }

  /// from those and s to coordinates.
  Point joined(double s, double inwards, double sidewards) const
  {
    return {s, (bend_in_plane * inwards - bend_off_plane * sidewards) / (square() * t_unit),
            (bend_off_plane * inwards + bend_in_plane * sidewards) / square()};
  }
};

inline Point Row_circles::place(const Point& local) const
{
  if (are_straight())
    return local;
  const double bend = std::sqrt(square()), unit = bend * s_unit; // of s, in radii
  const double along = unit * local[0], inward = inwards(local);
  const double less_one = along * along + inward * (inward - 2); // of the square of the distance from the axis
  return joined(std::atan2(along, 1 - inward) / unit, -less_one / (1 + std::sqrt(1 + less_one)), sidewards(local));
}

inline Row_circles::Turn Row_circles::turn(const Point& local) const
{
  if (are_straight())
    return {};
  const double along = std::sqrt(square()) * s_unit * local[0], outward = 1 - inwards(local);
  const double distance = std::sqrt(along * along + outward * outward);
  return {outward / distance, along / distance, distance};
}

inline Point Row_circles::turned_back(const Turn& turn, const Point& way) const
{
  if (are_straight())
    return way;
  const double unit = std::sqrt(square()) * s_unit;
  const double along = unit * way[0], inward = inwards(way);
  return joined((turn.cosine * along + turn.sine * inward) / unit, turn.cosine * inward - turn.sine * along,
                sidewards(way));
}

inline Point Row_circles::change(const Point& local, const Point& way) const
{
  const Turn there = turn(local);
  Point result = turned_back(there, way);
  result[0] /= there.distance;
  return result;
}

} // namespace recurve

#endif
