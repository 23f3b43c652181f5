// Changes one thing of the method without touching the library: a weighting of one's own.
//
// The paper weighs a vertex by the power d + 1 of its distance. Here all vertices near the face weigh the same and fade
// to nothing at a given number of face sizes.

#include <recurve/surface/reconstruct_surface.h>

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/boost/graph/generators.h>

#include <algorithm>
#include <cmath>
#include <iostream>

using Point_3 = CGAL::Exact_predicates_inexact_constructions_kernel::Point_3;
using Mesh = CGAL::Surface_mesh<Point_3>;

/// Model of `recurve::Weighting`.
struct Fading_weighting
{
  double radius = 6; ///< where the weight ends, in sizes of the face

  double operator()(const recurve::Stencil_point& point, int) const
  {
    const double rest = std::max(0.0, 1 - std::pow(point.distance / radius, 2));
    return point.cosine > 0 ? rest * rest : 0;
  }
};

int main()
{
  // A saddle over a grid of 20 x 20 quads: a polynomial of degree 2.
  const auto saddle = [](std::size_t i, std::size_t j) {
    const double x = 0.1 * static_cast<double>(i) - 1, y = 0.1 * static_cast<double>(j) - 1;
    return Point_3(x, y, 0.5 * x * y);
  };
  Mesh mesh;
  CGAL::make_grid(20, 20, mesh, saddle, /* triangulated = */ false);

  auto fits = mesh.add_property_map<Mesh::Face_index, recurve::Local_fit>("f:fit").first;
  const recurve::Reconstruction_policies<recurve::Paper_stencil, Fading_weighting> policies{.weighting = {.radius = 8}};
  recurve::reconstruct_surface(mesh, fits, {.degree = 4}, recurve::no_parameters, policies);

  double error = 0;
  for (const auto face : mesh.faces())
  {
    const recurve::Point center = fits[face].point(0, 0);
    error = std::max(error, std::abs(center[2] - 0.5 * center[0] * center[1]));
  }
  std::cout << "the saddle is " << (error < 1e-4 ? "found again" : "lost") << "; largest error " << error << '\n';
}
