#include <generate/naca_wing.h>

#include <generate/tetrahedra.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace recurve::generate {

namespace {

enum Wing_patch
{
  wing_upper,
  wing_lower,
  wing_tip,
  symmetry,
  farfield
};

/// chord fractions from the leading edge (0) to the trailing edge (1), `segments` + 1 of them. Half of the segments go
/// by arc length, half by turning of the tangent.
std::vector<double> chord_fractions(int segments)
{
  constexpr int sample_count = 20000; // far below the shortest segment
  const auto sample = [](int k) { return std::pow(static_cast<double>(k) / sample_count, 2); };
  std::vector<double> arc(sample_count + 1), turn(sample_count + 1);
  double last_angle = 0.5 * std::numbers::pi; // the tangent at the leading edge points up
  for (int k = 1; k <= sample_count; ++k)
  {
    const double dx = sample(k) - sample(k - 1);
    const double dz = naca0012_half_thickness(sample(k)) - naca0012_half_thickness(sample(k - 1));
    const double angle = std::atan2(dz, dx);
    arc[k] = arc[k - 1] + std::hypot(dx, dz);
    turn[k] = turn[k - 1] + std::abs(angle - last_angle);
    last_angle = angle;
  }

  std::vector<double> fractions = {0};
  int k = 0;
  for (int segment = 1; segment < segments; ++segment)
  {
    const double wanted = static_cast<double>(segment) / segments;
    while (0.5 * (arc[k] / arc.back() + turn[k] / turn.back()) < wanted)
      ++k;
    fractions.push_back(sample(k));
  }
  fractions.push_back(1);
  return fractions;
}

/// Builds the closed triangulated boundary around the wing, patch by patch.
class Wing_boundary
{
public:
  explicit Wing_boundary(const Wing_mesh_options& options)
    : options_(options), geometry_(options.geometry), fractions_(chord_fractions(options.chord_segments)),
      contour_size_(2 * options.chord_segments)
  {
    boundary_.patches = {{"wing_upper", "BCWall"},
                         {"wing_lower", "BCWall"},
                         {"wing_tip", "BCWall"},
                         {"symmetry", "BCSymmetryPlane"},
                         {"farfield", "BCFarfield"}};
    boundary_.holes.push_back({0.3 * geometry_.chord(0.5) + geometry_.leading_edge(0.5), 0.5, 0});
    add_wing();
    add_tip();
    add_symmetry_plane();
    add_far_field();
  }

  const Triangulated_boundary& boundary() const { return boundary_; }

private:
  /// Points run around a section from the trailing edge over the upper side to the leading edge and back below.
  Point contour_point(int around, double y) const
  {
    const int k = options_.chord_segments - around;
    return geometry_.point(fractions_[std::abs(k)], y, k >= 0 ? 1 : -1);
  }

  Index add_point(const Point& point)
  {
    boundary_.points.push_back(point);
    return static_cast<Index>(boundary_.points.size()) - 1;
  }

  Index wrapped(Index ring, int around) const { return ring + around % contour_size_; }

  void add_wing()
  {
    for (int row = 0; row <= options_.span_segments; ++row)
      for (int around = 0; around < contour_size_; ++around)
        add_point(contour_point(around, geometry_.span * row / options_.span_segments));
    for (int row = 0; row < options_.span_segments; ++row)
    {
      const Index inner = static_cast<Index>(row) * contour_size_;
      for (int around = 0; around < contour_size_; ++around)
        boundary_.add_quadrangle(around < options_.chord_segments ? wing_upper : wing_lower, wrapped(inner, around),
                                 wrapped(inner + contour_size_, around), wrapped(inner + contour_size_, around + 1),
                                 wrapped(inner, around + 1));
    }
  }

  void add_tip()
  {
    const Index tip = static_cast<Index>(options_.span_segments) * contour_size_;
    for (int k = 0; k < options_.chord_segments; ++k)
    {
      const Index above = tip + k, below = wrapped(tip, contour_size_ - k);
      const Index next_above = tip + k + 1, next_below = tip + contour_size_ - k - 1;
      if (k == 0)
        boundary_.add_triangle(wing_tip, above, next_above, next_below);
      else if (k == options_.chord_segments - 1)
        boundary_.add_triangle(wing_tip, above, next_above, below);
      else
        boundary_.add_quadrangle(wing_tip, above, next_above, next_below, below);
    }
  }

  Point far_point(int around, double latitude) const
  {
    const double longitude = 2 * std::numbers::pi * around / contour_size_;
    const double across = geometry_.far_radius * std::cos(latitude);
    return {geometry_.far_center()[0] + across * std::cos(longitude), geometry_.far_radius * std::sin(latitude),
            across * std::sin(longitude)};
  }

  /// Rings grow geometrically from the root section (already there) to the circle of the far field.
  void add_symmetry_plane()
  {
    constexpr double growth = 1.7;
    Index inner = 0;
    for (int ring = 1; ring <= options_.symmetry_rings; ++ring)
    {
      const double way = (std::pow(growth, ring) - 1) / (std::pow(growth, options_.symmetry_rings) - 1);
      const Index outer = static_cast<Index>(boundary_.points.size());
      for (int around = 0; around < contour_size_; ++around)
      {
        const Point from = contour_point(around, 0), to = far_point(around, 0);
        add_point(ring == options_.symmetry_rings
                    ? to
                    : Point{from[0] + way * (to[0] - from[0]), 0, from[2] + way * (to[2] - from[2])});
      }
      for (int around = 0; around < contour_size_; ++around)
        boundary_.add_quadrangle(symmetry, wrapped(inner, around), wrapped(inner, around + 1),
                                 wrapped(outer, around + 1), wrapped(outer, around));
      inner = outer;
    }
    far_circle_ = inner;
  }

  /// Rings of equal latitude from the circle at y = 0 to the pole.
  void add_far_field()
  {
    const int rings = std::max(2, contour_size_ / 4);
    Index lower = far_circle_;
    for (int ring = 1; ring < rings; ++ring)
    {
      const Index upper = static_cast<Index>(boundary_.points.size());
      for (int around = 0; around < contour_size_; ++around)
        add_point(far_point(around, 0.5 * std::numbers::pi * ring / rings));
      for (int around = 0; around < contour_size_; ++around)
        boundary_.add_quadrangle(farfield, wrapped(lower, around), wrapped(lower, around + 1),
                                 wrapped(upper, around + 1), wrapped(upper, around));
      lower = upper;
    }
    const Index pole = add_point({geometry_.far_center()[0], geometry_.far_radius, 0});
    for (int around = 0; around < contour_size_; ++around)
      boundary_.add_triangle(farfield, wrapped(lower, around), wrapped(lower, around + 1), pole);
  }

  const Wing_mesh_options& options_;
  const Wing_geometry& geometry_;
  std::vector<double> fractions_;
  int contour_size_;
  Index far_circle_ = 0;
  Triangulated_boundary boundary_;
};

} // namespace

double naca0012_half_thickness(double s)
{
  return 0.6 * (0.2969 * std::sqrt(s) + s * (-0.1260 + s * (-0.3516 + s * (0.2843 - 0.1036 * s))));
}

Point Wing_geometry::point(double s, double y, int side) const
{
  // The polynomial is zero at s = 1 in exact arithmetic only.
  const double t = s < 1 ? naca0012_half_thickness(s) : 0;
  return {leading_edge(y) + chord(y) * s, y, side * chord(y) * t};
}

double Wing_geometry::residual(const Point& p) const
{
  const double s = std::clamp((p[0] - leading_edge(p[1])) / chord(p[1]), 0.0, 1.0);
  return std::abs(p[2]) - chord(p[1]) * naca0012_half_thickness(s);
}

Volume_mesh naca_wing(const Wing_mesh_options& options)
{
  return fill_with_tetrahedra(Wing_boundary(options).boundary(), "wing", options.radius_edge_ratio);
}

} // namespace recurve::generate
