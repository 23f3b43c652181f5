// Normals and curvatures at the vertices, from the fits and, to compare, from CGAL's jets on the same points: two
// rings, degree 4. (CGAL 5.5 does not have the corrected curvatures of its later Polygon Mesh Processing.)

#include <recurve/surface/fit_vertices.h>

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Monge_via_jet_fitting.h>
#include <CGAL/Surface_mesh.h>

#include <cmath>
#include <iostream>
#include <numbers>
#include <set>
#include <vector>

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Mesh = CGAL::Surface_mesh<Kernel::Point_3>;

int main()
{
  // A torus of radii 2 and 1; its curvatures are 1 and cos b / (2 + cos b).
  constexpr int n = 48;
  Mesh torus;
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < 2 * n; ++i)
    {
      const double a = std::numbers::pi * i / n, b = 2 * std::numbers::pi * j / n;
      torus.add_vertex({(2 + std::cos(b)) * std::cos(a), (2 + std::cos(b)) * std::sin(a), std::sin(b)});
    }
  const auto at = [](int i, int j) { return Mesh::Vertex_index(i % (2 * n) + j % n * 2 * n); };
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < 2 * n; ++i)
    {
      torus.add_face(at(i, j), at(i + 1, j), at(i + 1, j + 1));
      torus.add_face(at(i, j), at(i + 1, j + 1), at(i, j + 1));
    }

  const auto fits = recurve::fit_vertices(torus, {.degree = 2}); // polynomials of degree 4
  double error = 0, jet_error = 0;
  for (const auto v : torus.vertices())
  {
    const Kernel::Point_3& x = torus.point(v);
    const double b = std::atan2(x.z(), std::hypot(x.x(), x.y()) - 2);
    const double exact = std::cos(b) / (2 + std::cos(b));
    const auto [largest, smallest] = fits.fit_at_source(torus.opposite(torus.halfedge(v))).principal_curvatures();
    error = std::max({error, std::abs(largest - 1), std::abs(smallest - exact)});

    std::set<Mesh::Vertex_index> rings;
    for (const auto w : torus.vertices_around_target(torus.halfedge(v)))
      for (const auto far : torus.vertices_around_target(torus.halfedge(w)))
        rings.insert(far); // among them the first ring
    rings.erase(v);
    std::vector<Kernel::Point_3> points = {x};
    for (const auto w : rings)
      points.push_back(torus.point(w));
    CGAL::Monge_via_jet_fitting<Kernel> jet;
    auto monge = jet(points.begin(), points.end(), 4, 2);
    const double k1 = std::abs(monge.principal_curvatures(0)), k2 = std::abs(monge.principal_curvatures(1));
    jet_error = std::max({jet_error, std::abs(std::max(k1, k2) - 1), std::abs(std::min(k1, k2) - std::abs(exact))});
  }
  std::cout << "largest error of a principal curvature: " << error << "; of CGAL's jets: " << jet_error << '\n'
            << (error <= jet_error ? "the fits are as good as the jets\n" : "the jets are better\n");
}
