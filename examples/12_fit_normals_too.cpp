// Normals as data: where a shape is known (here an ellipsoid), its normals are worth as much as many more points.

#include <recurve/surface/curve_surface.h>
#include <recurve/surface/fit_vertices.h>

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/boost/graph/generators.h>
#include <CGAL/subdivision_method_3.h>

#include <algorithm>
#include <cmath>
#include <iostream>

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Mesh = CGAL::Surface_mesh<Kernel::Point_3>;

/// Across the ellipsoid x^2 / 4 + y^2 + z^2 = 1.
static Kernel::Vector_3 gradient(const Kernel::Point_3& x)
{
  return {x.x() / 2, 2 * x.y(), 2 * x.z()};
}

/// Largest distance of the mid-edge nodes from the ellipsoid.
static double largest_error(const Mesh& mesh, const recurve::Vertex_fits<Mesh>& fits)
{
  recurve::Surface_nodes<Mesh> nodes(mesh, 2);
  recurve::curve_surface(mesh, fits.face_map(), {}, nodes.edge_map(), nodes.face_map(), {.degree = 2});
  double error = 0;
  for (const Kernel::Point_3& x : nodes.edge_nodes())
  {
    const double value = x.x() * x.x() / 4 + x.y() * x.y() + x.z() * x.z() - 1;
    error = std::max(error, std::abs(value) / std::sqrt(gradient(x).squared_length()));
  }
  return error;
}

int main()
{
  Mesh mesh;
  CGAL::make_icosahedron(mesh, Kernel::Point_3(0, 0, 0), 1.);
  CGAL::Subdivision_method_3::Loop_subdivision(mesh, CGAL::parameters::number_of_iterations(3));
  auto normals = mesh.add_property_map<Mesh::Vertex_index, Kernel::Vector_3>("v:normal").first;
  for (const auto v : mesh.vertices())
  {
    const Kernel::Vector_3 x = mesh.point(v) - CGAL::ORIGIN;
    const double r = std::sqrt(x.squared_length());
    mesh.point(v) = Kernel::Point_3(2 * x.x() / r, x.y() / r, x.z() / r);
    normals[v] = gradient(mesh.point(v)) / std::sqrt(gradient(mesh.point(v)).squared_length());
  }

  const auto points_alone = recurve::fit_vertices(mesh, {.degree = 4});
  const auto normals_too =
    recurve::fit_vertices(mesh, {.degree = 4, .data = recurve::Vertex_fit_data::points_and_normals},
                          CGAL::parameters::vertex_normal_map(normals));
  const double before = largest_error(mesh, points_alone), after = largest_error(mesh, normals_too);
  std::cout << "largest error " << before << " from points, " << after
            << " from points and normals: " << (after < before / 2 ? "normals pay" : "normals do not pay") << '\n';
}
