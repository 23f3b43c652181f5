// Finds the feature curves of a CGAL surface: a can, whose two rims are sharp and whose side is round.

#include <recurve/features/detect_features.h>
#include <recurve/features/feature_curves.h>

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/boost/graph/generators.h>

#include <iostream>

int main()
{
  using Point_3 = CGAL::Exact_predicates_inexact_constructions_kernel::Point_3;
  using Mesh = CGAL::Surface_mesh<Point_3>;

  Mesh can;
  const int sides = 24; // 15 degrees from one to the next
  CGAL::make_regular_prism(sides, can, Point_3(0, 0, 0), /* height = */ 2., /* radius = */ 1., /* is_closed = */ true);

  auto is_critical = can.add_property_map<Mesh::Edge_index, bool>("e:is_critical", false).first;
  auto is_sharp = can.add_property_map<Mesh::Vertex_index, bool>("v:is_sharp", false).first;
  const recurve::Feature_report report = recurve::detect_features(can, is_critical, is_sharp);

  const auto curves = recurve::trace_feature_curves(can, is_critical, is_sharp);
  std::cout << report.critical_edges << " critical edges in " << curves.size() << " curves\n";
  for (const auto& curve : curves)
    std::cout << (curve.is_closed ? "closed" : "open") << " curve of " << curve.halfedges.size() << " edges\n";
}
