#include "surface/curved_surfaces.h"

#include <recurve/surface/curve_surface.h>
#include <recurve/surface/fit_vertices.h>

#include <algorithm>

using namespace recurve;

namespace test_surfaces {

Vertex_fits<Mesh> fitted(const Mesh& mesh, int fit_degree, Reconstruction_report* report)
{
  return fit_vertices(mesh, {.degree = fit_degree}, no_parameters, Compact_policies{}, report);
}

Surface_nodes<Mesh> curved(const Mesh& mesh, const Vertex_fits<Mesh>& fits, int degree)
{
  Surface_nodes<Mesh> nodes(mesh, degree);
  curve_surface(mesh, fits.face_map(), {}, nodes.edge_map(), nodes.face_map(), {.degree = degree});
  return nodes;
}

Surface_nodes<Mesh> curved(const Mesh& mesh, int fit_degree, int degree, Reconstruction_report* report)
{
  return curved(mesh, fitted(mesh, fit_degree, report), degree);
}

double largest_error(const Surface_nodes<Mesh>& nodes, const Distance& distance)
{
  double largest = 0;
  for (const Point_3& x : nodes.edge_nodes())
    largest = std::max(largest, distance(to_point(x)));
  for (const Point_3& x : nodes.face_nodes())
    largest = std::max(largest, distance(to_point(x)));
  return largest;
}

std::vector<double> errors_of_faces(const Mesh& mesh, const Surface_nodes<Mesh>& nodes, const Distance& distance)
{
  std::vector<double> errors;
  for (const auto f : mesh.faces())
  {
    double largest = 0;
    for (const auto h : mesh.halfedges_around_face(mesh.halfedge(f)))
      for (int k = 1; k < nodes.degree(); ++k)
        largest = std::max(largest, distance(to_point(nodes.edge_node(h, k))));
    for (int m = 0; m < nodes.face_node_count(f); ++m)
      largest = std::max(largest, distance(to_point(nodes.face_node(f, m))));
    errors.push_back(largest);
  }
  return errors;
}

} // namespace test_surfaces
