// Fits polynomials to a triangulated unit sphere and asks how far the middles of its edges are from the sphere,
// straight and curved.

#include <recurve/surface/curve_surface.h>
#include <recurve/surface/reconstruct_surface.h>

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/boost/graph/generators.h>
#include <CGAL/subdivision_method_3.h>

#include <algorithm>
#include <cmath>
#include <iostream>

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Mesh = CGAL::Surface_mesh<Kernel::Point_3>;

static double largest_distance(const recurve::Surface_nodes<Mesh>& nodes)
{
  double largest = 0;
  for (const Kernel::Point_3& node : nodes.edge_nodes())
    largest = std::max(largest, std::abs(std::sqrt((node - CGAL::ORIGIN).squared_length()) - 1));
  return largest;
}

int main()
{
  Mesh sphere;
  CGAL::make_icosahedron(sphere, Kernel::Point_3(0, 0, 0), 1.);
  CGAL::Subdivision_method_3::Loop_subdivision(sphere, CGAL::parameters::number_of_iterations(3));
  for (const auto v : sphere.vertices())
  {
    const Kernel::Vector_3 x = sphere.point(v) - CGAL::ORIGIN;
    sphere.point(v) = CGAL::ORIGIN + x / std::sqrt(x.squared_length());
  }

  recurve::Surface_nodes<Mesh> nodes(sphere, 2); // quadratic elements: one node in the middle of each edge
  std::cout << std::scientific << "straight edges: " << largest_distance(nodes) << '\n';

  auto fits = sphere.add_property_map<Mesh::Face_index, recurve::Local_fit>("f:fit").first;
  for (const int degree : {2, 4, 6})
  {
    recurve::reconstruct_surface(sphere, fits, {.degree = degree});
    recurve::curve_surface(sphere, fits, {}, nodes.edge_map(), nodes.face_map(), {.degree = 2});
    std::cout << "fits of degree " << degree << ": " << largest_distance(nodes) << '\n';
  }
}
