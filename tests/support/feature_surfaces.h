#ifndef RECURVE_TESTS_SUPPORT_FEATURE_SURFACES_H
#define RECURVE_TESTS_SUPPORT_FEATURE_SURFACES_H

#include <recurve/core/types.h>

#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <numbers>
#include <random>
#include <string>
#include <utility>
#include <vector>

/// Surfaces whose feature curves are known, as points and faces.
namespace recurve::test {

inline constexpr double pi = std::numbers::pi;

/// How the quadrangles of a surface are handed out.
enum class Split
{
  quads,      ///< not split
  same,       ///< every quadrangle along the same diagonal
  alternating ///< diagonals in turn
};

/// Points and faces, and which of its inner edges (by their end points) are features.
struct Surface
{
  std::vector<Point> points;
  std::vector<std::vector<std::size_t>> faces;
  std::function<bool(const Point&, const Point&)> is_feature = [](const Point&, const Point&) { return false; };
};

/// Collects faces; equal points (to 1e-9) become one.
class Surface_builder
{
public:
  explicit Surface_builder(Split split) : split_(split) {}

  std::size_t vertex(const Point& p)
  {
    std::array<long long, 3> key{};
    for (int i = 0; i < 3; ++i)
      key[i] = std::llround(p[i] * 1e9);
    const auto [place, is_new] = vertices_.try_emplace(key, surface_.points.size());
    if (is_new)
      surface_.points.push_back(p);
    return place->second;
  }

  /// adds a face; corners that coincide are one, and a face with less than three is left out.
  void face(const std::vector<Point>& corners)
  {
    std::vector<std::size_t> ids;
    for (const Point& p : corners)
      if (const std::size_t v = vertex(p); ids.empty() || (ids.back() != v && ids.front() != v))
        ids.push_back(v);
    if (ids.size() < 3)
      return;
    const bool other = split_ == Split::alternating && (count_++ % 2) != 0;
    if (ids.size() == 3 || split_ == Split::quads)
      surface_.faces.push_back(ids);
    else if (other)
      surface_.faces.insert(surface_.faces.end(), {{ids[0], ids[1], ids[3]}, {ids[1], ids[2], ids[3]}});
    else
      surface_.faces.insert(surface_.faces.end(), {{ids[0], ids[1], ids[2]}, {ids[0], ids[2], ids[3]}});
  }

  /// adds nu x nv quadrangles of the patch `at`(u, v), u and v in [0, 1]; its normal is d/du x d/dv.
  void patch(int nu, int nv, const std::function<Point(double, double)>& at)
  {
    for (int i = 0; i < nu; ++i)
      for (int j = 0; j < nv; ++j)
      {
        const double u0 = i / double(nu), u1 = (i + 1) / double(nu), v0 = j / double(nv), v1 = (j + 1) / double(nv);
        count_ = i + j;
        face({at(u0, v0), at(u1, v0), at(u1, v1), at(u0, v1)});
      }
  }

  /// adds a flat nu x nv patch.
  void plane(int nu, int nv, const Point& origin, const Point& along_u, const Point& along_v)
  {
    patch(nu, nv, [&](double u, double v) {
      Point p{};
      for (int i = 0; i < 3; ++i)
        p[i] = origin[i] + u * along_u[i] + v * along_v[i];
      return p;
    });
  }

  Surface take(std::function<bool(const Point&, const Point&)> is_feature = {})
  {
    if (is_feature)
      surface_.is_feature = std::move(is_feature);
    return std::move(surface_);
  }

private:
  Split split_;
  int count_ = 0;
  std::map<std::array<long long, 3>, std::size_t> vertices_;
  Surface surface_;
};

inline bool near(double a, double b)
{
  return std::abs(a - b) < 1e-7;
}

/// the unit cube with n x n quadrangles a side: 12 curves, 8 corners.
inline Surface cube(int n, Split split)
{
  Surface_builder b(split);
  b.plane(n, n, {0, 0, 0}, {0, 1, 0}, {1, 0, 0});
  b.plane(n, n, {0, 0, 1}, {1, 0, 0}, {0, 1, 0});
  b.plane(n, n, {0, 0, 0}, {1, 0, 0}, {0, 0, 1});
  b.plane(n, n, {0, 1, 0}, {0, 0, 1}, {1, 0, 0});
  b.plane(n, n, {0, 0, 0}, {0, 0, 1}, {0, 1, 0});
  b.plane(n, n, {1, 0, 0}, {0, 1, 0}, {0, 0, 1});
  return b.take([](const Point& p, const Point& q) {
    int planes = 0;
    for (int i = 0; i < 3; ++i)
      planes += (near(p[i], 0) && near(q[i], 0)) || (near(p[i], 1) && near(q[i], 1));
    return planes >= 2;
  });
}

/// an L of three unit squares, one unit deep, in steps of 1/2: 18 curves (one of them concave), 12 corners.
inline Surface l_bracket(Split split)
{
  Surface_builder b(split);
  for (const auto& [x, y] : {std::pair{0., 0.}, std::pair{1., 0.}, std::pair{0., 1.}})
  {
    b.plane(2, 2, {x, y, 0}, {0, 1, 0}, {1, 0, 0});
    b.plane(2, 2, {x, y, 1}, {1, 0, 0}, {0, 1, 0});
  }
  const std::array<Point, 7> outline = {{{0, 0, 0}, {2, 0, 0}, {2, 1, 0}, {1, 1, 0}, {1, 2, 0}, {0, 2, 0}, {0, 0, 0}}};
  for (int i = 0; i < 6; ++i)
  {
    const Point &p = outline[i], &q = outline[i + 1];
    const int n = near(std::abs(p[0] - q[0]) + std::abs(p[1] - q[1]), 2) ? 4 : 2;
    b.plane(n, 2, p, {q[0] - p[0], q[1] - p[1], 0}, {0, 0, 1});
  }
  const auto is_on_outline = [outline](const Point& p, const Point& q) {
    for (int i = 0; i < 6; ++i)
    {
      const int axis = near(outline[i][0], outline[i + 1][0]) ? 0 : 1;
      const double c = outline[i][axis], lo = std::min(outline[i][1 - axis], outline[i + 1][1 - axis]),
                   hi = std::max(outline[i][1 - axis], outline[i + 1][1 - axis]);
      const auto on = [&](const Point& x) {
        return near(x[axis], c) && x[1 - axis] > lo - 1e-9 && x[1 - axis] < hi + 1e-9;
      };
      if (on(p) && on(q))
        return true;
    }
    return false;
  };
  return b.take([=](const Point& p, const Point& q) {
    if (near(p[2], q[2]))
      return (near(p[2], 0) || near(p[2], 1)) && is_on_outline(p, q);
    for (int i = 0; i < 6; ++i)
      if (near(p[0], outline[i][0]) && near(p[1], outline[i][1]) && near(q[0], outline[i][0]) &&
          near(q[1], outline[i][1]))
        return true;
    return false;
  });
}

/// a quarter of a disc, extruded; the arc in steps of 90 / n degrees: 9 curves, 6 corners.
inline Surface quarter_disc_prism(int n, Split split)
{
  Surface_builder b(split);
  const auto disc = [](double r, double a, double z) {
    return Point{r * std::cos(a * pi / 2), r * std::sin(a * pi / 2), z};
  };
  b.patch(3, n, [&](double r, double a) { return disc(r, a, 1); });
  b.patch(n, 3, [&](double a, double r) { return disc(r, a, 0); });
  b.patch(n, 3, [&](double a, double z) { return disc(1, a, z); });
  b.plane(3, 3, {0, 0, 0}, {1, 0, 0}, {0, 0, 1});
  b.plane(3, 3, {0, 0, 0}, {0, 0, 1}, {0, 1, 0});
  return b.take([](const Point& p, const Point& q) {
    const auto r = [](const Point& x) { return std::hypot(x[0], x[1]); };
    const bool cap = near(p[2], q[2]) && (near(p[2], 0) || near(p[2], 1));
    const bool arc = near(r(p), 1) && near(r(q), 1), x = near(p[1], 0) && near(q[1], 0),
               y = near(p[0], 0) && near(q[0], 0);
    return (cap && (arc || x || y)) || (arc && x) || (arc && y) || (x && y);
  });
}

/// a bar of height 1 over the polygon `corners` in the plane, `cells`[i] quadrangles along its side i and `rows` rows.
/// Features are the seams between its sides and the outlines of its ends.
inline Surface bar(const std::vector<std::array<double, 2>>& corners, const std::vector<int>& cells, int rows,
                   Split split)
{
  Surface_builder b(split);
  const std::size_t n = corners.size();
  std::array<double, 2> middle{};
  for (const auto& c : corners)
    middle = {middle[0] + c[0] / double(n), middle[1] + c[1] / double(n)};
  for (std::size_t i = 0; i < n; ++i)
  {
    const auto &p = corners[i], &q = corners[(i + 1) % n];
    const auto at = [&](double along, double inwards, double z) {
      const double x = p[0] + along * (q[0] - p[0]), y = p[1] + along * (q[1] - p[1]);
      return Point{x + inwards * (middle[0] - x), y + inwards * (middle[1] - y), z};
    };
    b.patch(cells[i], rows, [&](double u, double z) { return at(u, 0, z); });
    b.patch(3, cells[i], [&](double inwards, double u) { return at(u, inwards, 0); });
    b.patch(cells[i], 3, [&](double u, double inwards) { return at(u, inwards, 1); });
  }
  return b.take([corners, n](const Point& p, const Point& q) {
    const auto is_on_side = [&](const Point& x, std::size_t i) {
      const auto &a = corners[i], &c = corners[(i + 1) % n];
      return near((c[0] - a[0]) * (x[1] - a[1]) - (c[1] - a[1]) * (x[0] - a[0]), 0);
    };
    bool is_seam = false, is_outline = false;
    for (std::size_t i = 0; i < n; ++i)
    {
      const auto& a = corners[i];
      is_seam |= near(p[0], a[0]) && near(p[1], a[1]) && near(q[0], a[0]) && near(q[1], a[1]);
      is_outline |= near(p[2], q[2]) && (near(p[2], 0) || near(p[2], 1)) && is_on_side(p, i) && is_on_side(q, i);
    }
    return is_seam || is_outline;
  });
}

/// the corners of a regular polygon.
inline std::vector<std::array<double, 2>> regular_polygon(int n)
{
  std::vector<std::array<double, 2>> corners;
  corners.reserve(static_cast<std::size_t>(n));
  for (int i = 0; i < n; ++i)
    corners.push_back({std::cos(2 * pi * i / n), std::sin(2 * pi * i / n)});
  return corners;
}

/// a cylinder of radius 1 and height 2, `n` sectors and `rows` rows, with caps (fans) or open.
inline Surface cylinder(int n, int rows, bool has_caps, Split split)
{
  Surface_builder b(split);
  const auto at = [](double a, double r, double z) {
    return Point{r * std::cos(2 * pi * a), r * std::sin(2 * pi * a), z};
  };
  b.patch(n, rows, [&](double a, double z) { return at(a, 1, 2 * z); });
  if (has_caps)
  {
    b.patch(n, 1, [&](double a, double r) { return at(a, r, 0); });
    b.patch(1, n, [&](double r, double a) { return at(a, r, 2); });
  }
  return b.take([=](const Point& p, const Point& q) {
    const auto r = [](const Point& x) { return std::hypot(x[0], x[1]); };
    return has_caps && near(p[2], q[2]) && (near(p[2], 0) || near(p[2], 2)) && near(r(p), 1) && near(r(q), 1);
  });
}

/// a can of radius 1 with seven facets, as regular as can be at its rims but not in between: there the mesh folds its
/// round side by 80 degrees along the line x = 1, y = 0. Features are the rims.
inline Surface folded_can()
{
  Surface_builder b(Split::quads);
  const auto angle = [](double u, double v) {
    const int i = static_cast<int>(std::lround(7 * u));
    const double folded[] = {0, 80, 120, 160, 200, 240, 280, 360};
    return (v == 0 || v == 1 ? 360 * u : folded[i]) * pi / 180;
  };
  const auto at = [&](double u, double v, double r) {
    return Point{r * std::cos(angle(u, v)), r * std::sin(angle(u, v)), 2 * v};
  };
  b.patch(7, 4, [&](double u, double v) { return at(u, v, 1); });
  b.patch(7, 1, [&](double u, double r) { return at(u, 0, r); });
  b.patch(1, 7, [&](double r, double u) { return at(u, 1, r); });
  return b.take([](const Point& p, const Point& q) {
    const auto r = [](const Point& x) { return std::hypot(x[0], x[1]); };
    return near(p[2], q[2]) && (near(p[2], 0) || near(p[2], 2)) && near(r(p), 1) && near(r(q), 1);
  });
}

/// a cone of base radius 1 and the height `h`, `n` sectors, four rows, with its base (a fan).
inline Surface cone(int n, double h, Split split)
{
  Surface_builder b(split);
  const auto at = [](double a, double r, double z) {
    return Point{r * std::cos(2 * pi * a), r * std::sin(2 * pi * a), z};
  };
  b.patch(n, 4, [&](double a, double z) { return at(a, 1 - z, h * z); });
  b.patch(n, 1, [&](double a, double r) { return at(a, r, 0); });
  return b.take([](const Point& p, const Point& q) {
    const auto r = [](const Point& x) { return std::hypot(x[0], x[1]); };
    return near(p[2], 0) && near(q[2], 0) && near(r(p), 1) && near(r(q), 1);
  });
}

/// the icosahedron with each face split into four `level` times, on the unit sphere.
inline Surface icosphere(int level)
{
  const double g = (1 + std::sqrt(5.)) / 2;
  Surface s;
  s.points = {{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
              {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
  s.faces = {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
             {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
             {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
  const auto project = [](Point p) {
    const double r = std::sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]);
    return Point{p[0] / r, p[1] / r, p[2] / r};
  };
  for (Point& p : s.points)
    p = project(p);
  for (int l = 0; l < level; ++l)
  {
    std::map<std::pair<std::size_t, std::size_t>, std::size_t> middle_of;
    const auto middle = [&](std::size_t i, std::size_t j) {
      const auto [place, is_new] = middle_of.try_emplace(std::minmax(i, j), s.points.size());
      if (is_new)
      {
        const Point p = s.points[i], q = s.points[j];
        s.points.push_back(project({p[0] + q[0], p[1] + q[1], p[2] + q[2]}));
      }
      return place->second;
    };
    std::vector<std::vector<std::size_t>> faces;
    for (const auto& f : s.faces)
    {
      const std::size_t a = middle(f[0], f[1]), c = middle(f[1], f[2]), d = middle(f[2], f[0]);
      faces.insert(faces.end(), {{f[0], a, d}, {a, f[1], c}, {d, c, f[2]}, {a, c, d}});
    }
    s.faces = std::move(faces);
  }
  return s;
}

/// the unit sphere by longitude and latitude.
inline Surface uv_sphere(int n, int rows, Split split)
{
  Surface_builder b(split);
  b.patch(n, rows, [](double a, double t) {
    const double r = t == 0 || t == 1 ? 0 : std::sin(pi * t);
    return Point{r * std::cos(2 * pi * a), r * std::sin(2 * pi * a), -std::cos(pi * t)};
  });
  return b.take();
}

/// a torus of radii 1 and 0.4.
inline Surface torus(int n, int m, Split split)
{
  Surface_builder b(split);
  b.patch(n, m, [](double a, double t) {
    const double r = 1 + 0.4 * std::cos(2 * pi * t);
    return Point{r * std::cos(2 * pi * a), r * std::sin(2 * pi * a), 0.4 * std::sin(2 * pi * t)};
  });
  return b.take();
}

/// a cylinder that goes over into a cone whose slope differs by `degrees`, open at both ends: one loop at z = 0.
inline Surface frustum_joint(double degrees, int n, Split split)
{
  Surface_builder b(split);
  const double slope = std::tan(degrees * pi / 180), step = 2 * std::sin(pi / n);
  b.patch(n, 8, [&](double a, double t) {
    const double z = (8 * t - 4) * step, r = z <= 0 ? 1 : 1 - slope * z;
    return Point{r * std::cos(2 * pi * a), r * std::sin(2 * pi * a), near(z, 0) ? 0 : z};
  });
  return b.take([](const Point& p, const Point& q) { return near(p[2], 0) && near(q[2], 0); });
}

/// A sheet 16 cells long in x with a crease along y = 0; its right is turned down by `degrees`(x), x in [0, 1].
inline Surface crease(const std::function<double(double)>& degrees, Split split)
{
  Surface_builder b(split);
  b.patch(16, 8, [&](double x, double t) {
    const double y = (t - 0.5) / 2, a = degrees(x) * pi / 180;
    return y > 0 ? Point{x, y * std::cos(a), -y * std::sin(a)} : Point{x, y, 0};
  });
  return b.take(
    [](const Point& p, const Point& q) { return near(p[1], 0) && near(q[1], 0) && near(p[2], 0) && near(q[2], 0); });
}

/// two planes at a right angle joined by `n` strips: a chamfer for n = 1, a rounded edge otherwise. Open at all ends.
/// Features are the two seams of the chamfer; a rounded edge has none.
inline Surface rounded_edge(int n, Split split)
{
  Surface_builder b(split);
  const int rows = 8;
  b.plane(rows, 4, {0, -1, 0}, {1, 0, 0}, {0, 1, 0});
  b.patch(rows, n, [](double x, double t) {
    return Point{x, 0.25 * std::sin(t * pi / 2), -0.25 * (1 - std::cos(t * pi / 2))};
  });
  b.plane(rows, 4, {0, 0.25, -0.25}, {1, 0, 0}, {0, 0, -1});
  return b.take([n](const Point& p, const Point& q) {
    return n == 1 && near(p[1], q[1]) && near(p[2], q[2]) && (near(p[1], 0) || (near(p[1], 0.25) && near(p[2], -0.25)));
  });
}

/// A straight wing with the profile NACA 0012, open at the root, closed by a flat tip: `nc` steps on each side,
/// clustered at both ends by a cosine. Features: the trailing edge (two lines if blunt) and the rim of the tip.
inline Surface wing(int nc, bool is_blunt, Split split)
{
  Surface_builder b(split);
  const int rows = 8;
  const double last = is_blunt ? -0.1015 : -0.1036;
  const auto thickness = [is_blunt, last](double x) {
    const double y = 0.6 * (0.2969 * std::sqrt(x) + x * (-0.1260 + x * (-0.3516 + x * (0.2843 + x * last))));
    return x == 0 || (x == 1 && !is_blunt) ? 0 : y;
  };
  const auto section = [&](double t, double z) { // t: 0 trailing edge, below, 0.5 leading edge, above, 1 trailing edge
    const double x = near(t, 0.5) ? 0 : (t == 0 || t == 1 ? 1 : (1 + std::cos(2 * pi * t)) / 2);
    return Point{x, (t < 0.5 ? -1 : 1) * thickness(x), z};
  };
  b.patch(rows, 2 * nc, [&](double z, double t) { return section(t, 2 * z); });
  if (is_blunt)
    b.patch(rows, 1, [&](double z, double t) { return Point{1, thickness(1) * (1 - 2 * t), 2 * z}; });
  for (int i = 0; i < nc; ++i)
  {
    const double t0 = i / (2. * nc), t1 = (i + 1) / (2. * nc);
    b.face({section(t0, 2), section(1 - t0, 2), section(1 - t1, 2), section(t1, 2)});
  }
  return b.take([=](const Point& p, const Point& q) {
    const bool rim = near(p[2], 2) && near(q[2], 2);
    const auto is_on_profile = [&](const Point& x) { return near(std::abs(x[1]), thickness(x[0])); };
    const bool is_one_side = p[1] * q[1] >= 0 || (near(p[0], 1) && near(q[0], 1));
    const bool profile = rim && is_on_profile(p) && is_on_profile(q) && is_one_side;
    const bool trailing = near(p[0], 1) && near(q[0], 1) && near(p[1], q[1]);
    return profile || trailing;
  });
}

/// an n x n sheet over [0, n]^2, rough by up to `height` in z.
inline Surface rough_sheet(int n, double height, Split split, unsigned seed)
{
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> noise(-height, height);
  Surface_builder b(split);
  b.plane(n, n, {0, 0, 0}, {double(n), 0, 0}, {0, double(n), 0});
  Surface s = b.take();
  for (Point& p : s.points)
    p[2] += noise(random);
  return s;
}

/// moves every point by up to `size` in each coordinate; features stay with their edges.
inline Surface roughen(Surface s, double size, unsigned seed)
{
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> noise(-size, size);
  std::map<Point, Point> before;
  for (Point& p : s.points)
  {
    const Point old = p;
    for (double& x : p)
      x += noise(random);
    before[p] = old;
  }
  s.is_feature = [before, is_feature = s.is_feature](const Point& p, const Point& q) {
    return is_feature(before.at(p), before.at(q));
  };
  return s;
}

} // namespace recurve::test

#endif
