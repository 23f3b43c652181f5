#ifndef RECURVE_DATA_GENERATE_NACA_WING_H
#define RECURVE_DATA_GENERATE_NACA_WING_H

#include <recurve/mesh/volume_mesh.h>

namespace recurve::generate {

/// half the thickness of the NACA 0012 section with a closed, sharp trailing edge, in chords:
/// t(s) = 0.6 (0.2969 sqrt(s) - 0.1260 s - 0.3516 s^2 + 0.2843 s^3 - 0.1036 s^4), 0 <= s <= 1, t(0) = t(1) = 0.
double naca0012_half_thickness(double s);

/// Swept, tapered half wing at the plane of symmetry y = 0. x points downstream, y to the tip, z up; lengths in root
/// chords. At span y the section has the chord c(y) and its leading edge at x_le(y), both linear in y; its surface is
/// (x_le + c s, y, +- c t(s)). The tip is the plane y = span; the far field is a half sphere around the root's
/// mid-chord.
struct Wing_geometry
{
  double span = 1.5;
  double tip_chord = 0.6;
  double tip_leading_edge = 0.5; ///< x of the leading edge at the tip
  double far_radius = 5;

  double chord(double y) const { return 1 + (tip_chord - 1) * y / span; }
  double leading_edge(double y) const { return tip_leading_edge * y / span; }
  Point far_center() const { return {0.5, 0, 0}; }

  /// the point of the surface at chord fraction `s` and span `y`; `side` is 1 for the upper and -1 for the lower side.
  Point point(double s, double y, int side) const;

  /// |z| - c t(s) at the chord fraction of `p`: zero on the surface, and to first order its distance where the surface
  /// is level. Chord fractions outside [0, 1] count as their nearest.
  double residual(const Point& p) const;
};

struct Wing_mesh_options
{
  Wing_geometry geometry;
  int chord_segments = 16; ///< on each side; half by arc length, half by turning, so that the leading edge is resolved
  int span_segments = 32;
  int symmetry_rings = 9;         ///< rings of triangles between root section and far field
  double radius_edge_ratio = 1.6; ///< of the tetrahedra; see fill_with_tetrahedra()
};

/// the space around the wing as tetrahedra; patches wing_upper, wing_lower, wing_tip, symmetry, farfield. Every point
/// of a patch lies on its exact surface; trailing edge, tip edge and the intersection with y = 0 are sharp, the leading
/// edge is round.
Volume_mesh naca_wing(const Wing_mesh_options& options = {});

} // namespace recurve::generate

#endif
