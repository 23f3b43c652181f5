#ifndef RECURVE_TESTS_SURFACE_CURVED_SURFACES_H
#define RECURVE_TESTS_SURFACE_CURVED_SURFACES_H

#include "surface/test_surfaces.h"

#include <recurve/surface/reconstruction_report.h>
#include <recurve/surface/surface_nodes.h>
#include <recurve/surface/vertex_fits.h>

#include <functional>
#include <string>
#include <vector>

/// Surfaces curved with the fits of `fit_vertices()`, and how far they are from the exact ones. What is declared here
/// is compiled once: each file that instantiates the passes itself takes twice as long.
namespace test_surfaces {

using Distance = std::function<double(const Point&)>;

struct Shape
{
  std::string name;
  Polygons mesh;
  Distance distance; ///< to the exact surface
};

/// the default fits of degree `fit_degree`.
recurve::Vertex_fits<Mesh> fitted(const Mesh& mesh, int fit_degree, recurve::Reconstruction_report* report = nullptr);

/// all nodes of degree `degree` with `fits`.
recurve::Surface_nodes<Mesh> curved(const Mesh& mesh, const recurve::Vertex_fits<Mesh>& fits, int degree);

/// the same with the default fits.
recurve::Surface_nodes<Mesh> curved(const Mesh& mesh, int fit_degree, int degree,
                                    recurve::Reconstruction_report* report = nullptr);

double largest_error(const recurve::Surface_nodes<Mesh>& nodes, const Distance& distance);

/// the largest error of the nodes of each face.
std::vector<double> errors_of_faces(const Mesh& mesh, const recurve::Surface_nodes<Mesh>& nodes,
                                    const Distance& distance);

} // namespace test_surfaces

#endif
