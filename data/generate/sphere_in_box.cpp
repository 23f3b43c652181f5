#include <generate/sphere_in_box.h>

#include <generate/layers.h>
#include <generate/mesh_builder.h>
#include <generate/tetrahedra.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>

namespace recurve::generate {

namespace {

using Lattice = std::array<int, 3>;

/// A quadrangle of the surface of the cube: lattice points, counter-clockwise seen from outside, and the axis of its
/// block.
struct Cube_quad
{
  std::array<Lattice, 4> corners;
  int axis;
};

/// the quadrangles of the surface of a cube of `n` segments, block by block.
std::vector<Cube_quad> cube_quads(int n)
{
  std::vector<Cube_quad> quads;
  for (int axis = 0; axis < 3; ++axis)
    for (const int side : {0, n})
      for (int j = 0; j < n; ++j)
        for (int i = 0; i < n; ++i)
        {
          const auto at = [&](int du, int dv) {
            Lattice point;
            point[axis] = side;
            point[(axis + 1) % 3] = i + du;
            point[(axis + 2) % 3] = j + dv;
            return point;
          };
          if (side == 0)
            quads.push_back({{at(0, 0), at(0, 1), at(1, 1), at(1, 0)}, axis});
          else
            quads.push_back({{at(0, 0), at(1, 0), at(1, 1), at(0, 1)}, axis});
        }
  return quads;
}

/// lattice point on the surface of the cube [-1, 1]^3, at equal angles as seen from the centre.
Point cube_point(const Lattice& lattice, int n)
{
  Point point;
  for (int i = 0; i < 3; ++i)
  {
    const int twice = 2 * lattice[i] - n;
    point[i] = std::abs(twice) == n ? std::copysign(1.0, twice) : std::tan(0.25 * std::numbers::pi * twice / n);
  }
  return point;
}

Point on_sphere(const Point& direction, double radius)
{
  const double scale = radius / std::hypot(direction[0], direction[1], direction[2]);
  return {scale * direction[0], scale * direction[1], scale * direction[2]};
}

/// Shells of cells between the sphere (layer 0) and the box (the last layer).
class Shells
{
public:
  explicit Shells(const Sphere_mesh_options& options) : options_(options), growth_(options.growth)
  {
    if (options.first_layer > 0)
      growth_ = layer_growth(options.first_layer, options.half_side - options.radius, options.layers);
    builder_.set_patch_kind("sphere", "BCWall");
    builder_.set_patch_kind("box", "BCFarfield");
    for (const Cube_quad& quad : cube_quads(options.segments))
      for (int layer = 0; layer < options.layers; ++layer)
        add_block(quad, layer);
  }

  Volume_mesh build() const { return builder_.build(); }

private:
  Index point_number(const Lattice& lattice, int layer)
  {
    const auto [entry, is_new] = number_.try_emplace({lattice, layer}, builder_.point_count());
    if (is_new)
      add_point(lattice, layer);
    return entry->second;
  }

  void add_point(const Lattice& lattice, int layer)
  {
    const Point outer = cube_point(lattice, options_.segments);
    const Point inner = on_sphere(outer, options_.radius);
    const double way = (std::pow(growth_, layer) - 1) / (std::pow(growth_, options_.layers) - 1);
    Point point;
    for (int i = 0; i < 3; ++i)
    {
      const double to = options_.half_side * outer[i];
      point[i] = layer == 0 ? inner[i] : layer == options_.layers ? to : inner[i] + way * (to - inner[i]);
    }
    points_.push_back(point);
    builder_.add_point(point);
  }

  void add_block(const Cube_quad& quad, int layer)
  {
    std::array<Index, 8> corners;
    for (int c = 0; c < 4; ++c)
    {
      corners[c] = point_number(quad.corners[c], layer);
      corners[4 + c] = point_number(quad.corners[c], layer + 1);
    }
    switch (options_.cells == Sphere_cells::mixed ? by_axis(quad.axis) : options_.cells)
    {
    case Sphere_cells::prisms: add_prisms(corners, layer); break;
    case Sphere_cells::pyramids: add_pyramids(corners, layer); break;
    default: add_hexahedron(corners, layer);
    }
  }

  static Sphere_cells by_axis(int axis)
  {
    constexpr std::array kinds = {Sphere_cells::hexahedra, Sphere_cells::prisms, Sphere_cells::pyramids};
    return kinds[axis];
  }

  void add_patch_faces(int layer, std::span<const Index> lower, std::span<const Index> upper)
  {
    if (layer == 0)
      builder_.add_face("sphere", lower);
    if (layer == options_.layers - 1)
      builder_.add_face("box", upper);
  }

  void add_hexahedron(const std::array<Index, 8>& corners, int layer)
  {
    builder_.add_cell(Element_type::hexahedron, corners);
    add_patch_faces(layer, std::span(corners).first(4), std::span(corners).last(4));
  }

  void add_prisms(const std::array<Index, 8>& c, int layer)
  {
    for (const std::array<int, 3>& t : {std::array{0, 1, 2}, std::array{0, 2, 3}})
    {
      const std::array<Index, 6> prism = {c[t[0]], c[t[1]], c[t[2]], c[4 + t[0]], c[4 + t[1]], c[4 + t[2]]};
      builder_.add_cell(Element_type::prism, prism);
      add_patch_faces(layer, std::span(prism).first(3), std::span(prism).last(3));
    }
  }

  /// Six pyramids with their apex in the middle of the block.
  void add_pyramids(const std::array<Index, 8>& corners, int layer)
  {
    Point middle = {};
    for (const Index corner : corners)
      for (int i = 0; i < 3; ++i)
        middle[i] += points_[corner][i] / 8;
    points_.push_back(middle);
    const Index apex = builder_.add_point(middle);

    const Reference_element& block = reference_element(Element_type::hexahedron);
    for (int f = 0; f < 6; ++f)
    {
      const std::array<int, 4>& face = block.faces[f].corners;
      // The face looks out of the block; the base of a pyramid looks to its apex.
      const std::array<Index, 5> pyramid = {corners[face[0]], corners[face[3]], corners[face[2]], corners[face[1]],
                                            apex};
      const bool is_lower = std::ranges::all_of(face, [](int c) { return c < 4; });
      const bool is_upper = std::ranges::all_of(face, [](int c) { return c >= 4; });
      const bool is_in_patch = (is_lower && layer == 0) || (is_upper && layer == options_.layers - 1);
      add_pyramid(pyramid, is_in_patch ? (is_lower ? "sphere" : "box") : "");
    }
  }

  /// `patch`: of the base, or empty.
  void add_pyramid(const std::array<Index, 5>& p, const std::string& patch)
  {
    if (options_.cells != Sphere_cells::mixed || patch.empty())
    {
      builder_.add_cell(Element_type::pyramid, p);
      if (!patch.empty())
        builder_.add_face(patch, std::span(p).first(4));
      return;
    }
    for (const std::array<Index, 4>& half : {std::array{p[0], p[1], p[2], p[4]}, std::array{p[0], p[2], p[3], p[4]}})
    {
      builder_.add_cell(Element_type::tetrahedron, half);
      builder_.add_face(patch, std::span(half).first(3));
    }
  }

  const Sphere_mesh_options& options_;
  double growth_;
  Mesh_builder builder_{"sphere"};
  std::vector<Point> points_;
  std::map<std::pair<Lattice, int>, Index> number_;
};

/// Triangles of the unit sphere, refined from an icosahedron.
struct Icosphere
{
  std::vector<Point> points;
  std::vector<std::array<Index, 3>> triangles;
};

Icosphere icosahedron()
{
  constexpr double g = std::numbers::phi;
  Icosphere sphere;
  for (const double a : {-1.0, 1.0})
    for (const double b : {-g, g})
      for (int axis = 0; axis < 3; ++axis)
      {
        Point point = {};
        point[axis] = a;
        point[(axis + 1) % 3] = b;
        sphere.points.push_back(on_sphere(point, 1));
      }
  // A triangle is three points at the distance of an edge.
  const double edge = 2 / std::hypot(1.0, g);
  const auto is_edge = [&](int i, int j) {
    const Point &p = sphere.points[i], &q = sphere.points[j];
    return std::hypot(p[0] - q[0], p[1] - q[1], p[2] - q[2]) < 1.1 * edge;
  };
  for (int i = 0; i < 12; ++i)
    for (int j = i + 1; j < 12; ++j)
      for (int k = j + 1; k < 12; ++k)
        if (is_edge(i, j) && is_edge(j, k) && is_edge(k, i))
          sphere.triangles.push_back({i, j, k});
  return sphere;
}

Icosphere subdivide(Icosphere sphere)
{
  std::map<std::pair<Index, Index>, Index> middle;
  const auto middle_of = [&](Index a, Index b) {
    const auto [entry, is_new] = middle.try_emplace(std::minmax(a, b), static_cast<Index>(sphere.points.size()));
    if (is_new)
    {
      const Point &p = sphere.points[a], &q = sphere.points[b];
      sphere.points.push_back(on_sphere({p[0] + q[0], p[1] + q[1], p[2] + q[2]}, 1));
    }
    return entry->second;
  };
  std::vector<std::array<Index, 3>> triangles;
  for (const auto& [a, b, c] : sphere.triangles)
  {
    const Index ab = middle_of(a, b), bc = middle_of(b, c), ca = middle_of(c, a);
    triangles.insert(triangles.end(), {{a, ab, ca}, {b, bc, ab}, {c, ca, bc}, {ab, bc, ca}});
  }
  sphere.triangles = std::move(triangles);
  return sphere;
}

Volume_mesh tetrahedra_around_sphere(const Sphere_mesh_options& options)
{
  Icosphere sphere = icosahedron();
  for (int level = 0; level < options.subdivisions; ++level)
    sphere = subdivide(std::move(sphere));

  Triangulated_boundary boundary;
  boundary.patches = {{"sphere", "BCWall"}, {"box", "BCFarfield"}};
  boundary.holes = {{0, 0, 0}};
  for (const Point& point : sphere.points)
    boundary.points.push_back(on_sphere(point, options.radius));
  for (const auto& [a, b, c] : sphere.triangles)
    boundary.add_triangle(0, a, b, c);

  std::map<Lattice, Index> number;
  const auto number_of = [&](const Lattice& lattice) {
    const auto [entry, is_new] = number.try_emplace(lattice, static_cast<Index>(boundary.points.size()));
    if (is_new)
    {
      boundary.points.emplace_back();
      for (int i = 0; i < 3; ++i)
        boundary.points.back()[i] = options.half_side * (2 * lattice[i] - options.segments) / options.segments;
    }
    return entry->second;
  };
  for (const Cube_quad& quad : cube_quads(options.segments))
  {
    std::array<Index, 4> corners;
    for (int c = 0; c < 4; ++c)
      corners[c] = number_of(quad.corners[c]);
    boundary.add_quadrangle(1, corners[0], corners[1], corners[2], corners[3]);
  }
  return fill_with_tetrahedra(boundary, "sphere", options.radius_edge_ratio);
}

} // namespace

Volume_mesh sphere_in_box(const Sphere_mesh_options& options)
{
  if (options.cells == Sphere_cells::tetrahedra)
    return tetrahedra_around_sphere(options);
  return Shells(options).build();
}

} // namespace recurve::generate
