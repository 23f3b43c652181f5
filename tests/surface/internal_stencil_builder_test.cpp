#include "surface/test_surfaces.h"

#include <recurve/surface/internal/gather_surface.h>
#include <recurve/surface/stencil_builder.h>

#include <catch2/catch.hpp>

#include <set>

using namespace recurve;
using namespace test_surfaces;

namespace {

constexpr int grid_size = 12;

int vertex_at(int i, int j)
{
  return i + j * (grid_size + 1);
}

/// a grid whose quads are all cut along the same diagonal: every vertex inside has six neighbours.
Polygons regular_triangles()
{
  const Polygons quads = grid(grid_size, grid_size, 1, 1, [](double, double) { return 0.0; });
  Polygons triangles{quads.points, {}};
  for (const auto& f : quads.faces)
    triangles.faces.insert(triangles.faces.end(), {{f[0], f[1], f[2]}, {f[0], f[2], f[3]}});
  return triangles;
}

/// A mesh with marked edges and vertices, and its arrays.
struct Marked_mesh
{
  Mesh mesh;
  Mesh::Property_map<Mesh::Edge_index, bool> is_critical;
  Mesh::Property_map<Mesh::Vertex_index, bool> is_sharp;

  explicit Marked_mesh(const Polygons& polygons)
    : mesh(make_mesh(polygons)), is_critical(mesh.add_property_map<Mesh::Edge_index, bool>("e:critical", false).first),
      is_sharp(mesh.add_property_map<Mesh::Vertex_index, bool>("v:sharp", false).first)
  {}

  void mark(int a, int b)
  {
    const auto h =
      mesh.halfedge(Mesh::Vertex_index(static_cast<unsigned>(a)), Mesh::Vertex_index(static_cast<unsigned>(b)));
    REQUIRE(h != Mesh::null_halfedge());
    is_critical[mesh.edge(h)] = true;
  }

  /// marks the vertical line i = column from j = first to j = last.
  void mark_line(int column, int first, int last)
  {
    for (int j = first; j < last; ++j)
      mark(vertex_at(column, j), vertex_at(column, j + 1));
  }

  internal::surface::Surface_arrays gather() const
  {
    return internal::surface::gather_surface(
      mesh, CGAL::parameters::edge_is_constrained_map(is_critical).vertex_is_constrained_map(is_sharp));
  }
};

/// the stencil of `face` as vertices of the mesh. (Round the end of a curve it may hold both sides of a vertex.)
std::set<int> stencil(const internal::surface::Surface_arrays& surface, Index face, int rings, bool has_half_ring)
{
  Stencil_builder builder(surface);
  builder.start(face);
  for (int i = 0; i < rings; ++i)
    builder.add_ring();
  if (has_half_ring)
    builder.add_half_ring();
  std::set<int> result;
  for (const Index v : builder.vertices())
    result.insert(static_cast<int>(surface.original_vertices[static_cast<std::size_t>(v)]));
  return result;
}

/// number of the face below (0) or above (1) the diagonal of quad (i, j).
Index face_at(int i, int j, int which)
{
  return 2 * (i + j * grid_size) + which;
}

} // namespace

TEST_CASE("rings and half rings on a regular triangulation have the sizes of geometry", "[stencil_builder]")
{
  const auto surface = Marked_mesh(regular_triangles()).gather();
  for (int rings = 0; rings <= 3; ++rings)
  {
    CAPTURE(rings);
    CHECK(stencil(surface, face_at(6, 6, 0), rings, false).size() == 3U * (rings + 1) * (rings + 1));
    CHECK(stencil(surface, face_at(6, 6, 0), rings, true).size() == 3U * (rings + 1) * (rings + 1) + 6 * rings + 3);
  }
}

TEST_CASE("rings on quads follow edges, half rings fill the corners", "[stencil_builder]")
{
  const auto surface = Marked_mesh(grid(grid_size, grid_size, 1, 1, [](double, double) { return 0.0; })).gather();
  const Index face = 6 + 6 * grid_size;
  CHECK(stencil(surface, face, 0, false).size() == 4);
  CHECK(stencil(surface, face, 1, false).size() == 12); // two more per side
  CHECK(stencil(surface, face, 0, true).size() == 12);
  CHECK(stencil(surface, face, 1, true).size() == 24);
}

TEST_CASE("stencils grow along a feature curve but not across", "[stencil_builder]")
{
  Marked_mesh marked(regular_triangles());
  marked.mark_line(6, 0, grid_size);
  const auto surface = marked.gather();
  for (const int which : {0, 1})
    for (int rings = 0; rings <= 6; ++rings)
    {
      for (const int v : stencil(surface, face_at(5, 5, which), rings, true))
        CHECK(v % (grid_size + 1) <= 6);
      for (const int v : stencil(surface, face_at(6, 5, which), rings, true))
        CHECK(v % (grid_size + 1) >= 6);
    }
  // Face (6, 5, 1) has corners (6, 5), (7, 6), (6, 6): two on the line. One ring: the line one further on both sides
  // and the six neighbours of (7, 6).
  const std::set<int> expected = {vertex_at(6, 4), vertex_at(6, 5), vertex_at(6, 6), vertex_at(6, 7), vertex_at(7, 5),
                                  vertex_at(7, 6), vertex_at(7, 7), vertex_at(8, 6), vertex_at(8, 7)};
  CHECK(stencil(surface, face_at(6, 5, 1), 1, false) == expected);
}

TEST_CASE("sharp vertices have no neighbours", "[stencil_builder]")
{
  Marked_mesh marked(regular_triangles());
  for (const int v : {vertex_at(6, 5), vertex_at(7, 6), vertex_at(6, 6)})
    marked.is_sharp[Mesh::Vertex_index(static_cast<unsigned>(v))] = true;
  const auto surface = marked.gather();
  CHECK(stencil(surface, face_at(6, 5, 1), 3, false).size() == 3);
  CHECK(stencil(surface, face_at(6, 5, 1), 3, true).size() == 6);
}

TEST_CASE("a vertex where three critical edges meet is sharp", "[stencil_builder]")
{
  // Face (5, 5, 0) has corners (5, 5), (6, 5), (6, 6); only (6, 6) leads to (6, 7), along the curve.
  Marked_mesh marked(regular_triangles());
  marked.mark_line(6, 4, 8);
  CHECK(stencil(marked.gather(), face_at(5, 5, 0), 1, false).count(vertex_at(6, 7)) == 1);
  marked.mark(vertex_at(6, 6), vertex_at(7, 6));
  CHECK(stencil(marked.gather(), face_at(5, 5, 0), 1, false).count(vertex_at(6, 7)) == 0);
}

TEST_CASE("a critical vertex has one normal for each side", "[gather_surface]")
{
  // A roof: height falls off on both sides of the line i = 6.
  Polygons roof = regular_triangles();
  for (Point& x : roof.points)
    x[2] = -std::abs(x[0] - 0.5);
  Marked_mesh marked(roof);
  marked.mark_line(6, 0, grid_size);
  const auto surface = marked.gather();
  CHECK(surface.vertex_count() == static_cast<Index>(roof.points.size()) + grid_size + 1);
  const double s = std::sqrt(0.5);
  for (Index f = 0; f < surface.face_count(); ++f)
    for (const Index v : surface.corners_of_face(f))
    {
      const Point& normal = surface.normals[static_cast<std::size_t>(v)];
      const double side = f / 2 % grid_size < 6 ? -s : s;
      CHECK(normal[0] == Approx(side).epsilon(1e-14));
      CHECK(normal[1] == Approx(0).margin(1e-14));
      CHECK(normal[2] == Approx(s).epsilon(1e-14));
    }
}

TEST_CASE("a curve that ends within the surface does not cut it in two", "[gather_surface]")
{
  Marked_mesh marked(regular_triangles());
  marked.mark_line(6, 4, 8);
  const auto surface = marked.gather();
  CHECK(surface.vertex_count() == static_cast<Index>(marked.mesh.number_of_vertices()) + 3);
}

TEST_CASE("sheets that share only a vertex are separate", "[gather_surface]")
{
  Polygons bow_tie;
  bow_tie.points = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {-1, 0, 1}, {-1, -1, 1}};
  bow_tie.faces = {{0, 1, 2}, {0, 3, 4}};
  const auto surface = Marked_mesh(bow_tie).gather();
  CHECK(surface.vertex_count() == 6);
  CHECK(stencil(surface, 0, 3, true) == std::set<int>{0, 1, 2});
}
