// Changes one thing of the method without touching the library: a stencil of one's own, for fits of vertices.
//
// The compact stencil takes points until there are 1.2 per coefficient. Here it is always two whole rings: more points
// than degree 4 needs, which evens out noise.

#include <recurve/surface/curve_surface.h>
#include <recurve/surface/fit_vertices.h>

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/boost/graph/generators.h>
#include <CGAL/subdivision_method_3.h>

#include <cmath>
#include <iostream>

using Point_3 = CGAL::Exact_predicates_inexact_constructions_kernel::Point_3;
using Mesh = CGAL::Surface_mesh<Point_3>;

/// Model of `recurve::Stencil`.
struct Two_rings
{
  void operator()(recurve::Stencil_builder& builder, int) const
  {
    builder.add_ring();
    builder.add_ring();
  }
};

int main()
{
  Mesh sphere;
  CGAL::make_icosahedron(sphere, Point_3(0, 0, 0), 1.);
  CGAL::Subdivision_method_3::Loop_subdivision(sphere, CGAL::parameters::number_of_iterations(3));
  for (const auto v : sphere.vertices())
    sphere.point(v) =
      CGAL::ORIGIN + (sphere.point(v) - CGAL::ORIGIN) / std::sqrt((sphere.point(v) - CGAL::ORIGIN).squared_length());

  const recurve::Reconstruction_policies<Two_rings, recurve::Steep_weighting, recurve::Graded_qr> policies;
  recurve::Reconstruction_report report;
  const auto fits = recurve::fit_vertices(sphere, {.degree = 2}, recurve::no_parameters, policies, &report);

  recurve::Surface_nodes<Mesh> nodes(sphere, 2);
  recurve::curve_surface(sphere, fits.face_map(), {}, nodes.edge_map(), nodes.face_map(), {.degree = 2});
  double error = 0;
  for (const Point_3& x : nodes.edge_nodes())
    error = std::max(error, std::abs(std::sqrt((x - CGAL::ORIGIN).squared_length()) - 1));
  std::cout << "stencils of " << static_cast<double>(report.stencil_vertices) / static_cast<double>(report.fits)
            << " vertices, largest error " << std::scientific << error << '\n';
}
