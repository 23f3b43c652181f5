// The passes run on any CGAL face graph: here on OpenMesh, whose points CGAL's own wrapper would round to float.

#include <recurve/mesh/openmesh.h>
#include <recurve/surface/curve_surface.h>
#include <recurve/surface/fit_vertices.h>

#include <cmath>
#include <iostream>
#include <vector>

using Mesh = recurve::Openmesh_polygons;

int main()
{
  // z = x y over a grid of quads.
  constexpr int n = 16;
  Mesh mesh;
  std::vector<Mesh::VertexHandle> vertices;
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i)
    {
      const double x = static_cast<double>(i) / n, y = static_cast<double>(j) / n;
      vertices.push_back(mesh.add_vertex(Mesh::Point(x, y, x * y)));
    }
  const auto at = [&](int i, int j) { return vertices[static_cast<std::size_t>(i + j * (n + 1))]; };
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i)
      mesh.add_face(std::vector<Mesh::VertexHandle>{at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)});

  const auto points = recurve::openmesh_point_map(mesh);
  const auto params = CGAL::parameters::vertex_point_map(points);
  const auto fits = recurve::fit_vertices(mesh, {.degree = 4}, params);
  using Point_3 = boost::property_traits<decltype(points)>::value_type;
  recurve::Surface_nodes<Mesh, Point_3> nodes(mesh, 3, points);
  recurve::curve_surface(mesh, fits.face_map(), {}, nodes.edge_map(), nodes.face_map(), {.degree = 3}, params);

  double error = 0;
  for (const Point_3& x : nodes.edge_nodes())
    error = std::max(error, std::abs(x.z() - x.x() * x.y()));
  std::cout << "the saddle is met " << (error < 1e-5 ? "to five digits" : "badly") << ": " << error << '\n';
}
