// Remeshes a can with CGAL, and keeps its rims: the edges that are found to be sharp are the constraints.

#include <recurve/features/detect_features.h>

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/remesh.h>
#include <CGAL/Polygon_mesh_processing/triangulate_faces.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/boost/graph/generators.h>

#include <cmath>
#include <iostream>

using Point_3 = CGAL::Exact_predicates_inexact_constructions_kernel::Point_3;
using Mesh = CGAL::Surface_mesh<Point_3>;
namespace PMP = CGAL::Polygon_mesh_processing;

template <class EdgeIsCriticalMap>
double critical_length(const Mesh& mesh, EdgeIsCriticalMap is_critical)
{
  double length = 0;
  for (const auto e : mesh.edges())
    if (is_critical[e])
      length += PMP::edge_length(e, mesh);
  return length;
}

int main()
{
  Mesh can;
  const int sides = 24;
  CGAL::make_regular_prism(sides, can, Point_3(0, 0, 0), /* height = */ 2., /* radius = */ 1., /* is_closed = */ true);
  PMP::triangulate_faces(can);

  auto is_critical = can.add_property_map<Mesh::Edge_index, bool>("e:is_critical", false).first;
  auto is_sharp = can.add_property_map<Mesh::Vertex_index, bool>("v:is_sharp", false).first;
  recurve::detect_features(can, is_critical, is_sharp);
  const double before = critical_length(can, is_critical);

  const double edge_length = 0.2;
  PMP::isotropic_remeshing(can.faces(), edge_length, can, PMP::parameters::edge_is_constrained_map(is_critical));
  can.collect_garbage();

  const bool is_kept = std::abs(critical_length(can, is_critical) - before) < 1e-9 * before;
  std::cout << can.number_of_faces() << " triangles; the rims of length " << before << (is_kept ? " are" : " are not")
            << " as they were\n";
}
