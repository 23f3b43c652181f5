// The regions between the sharp edges of a can, numbered by recurve and by CGAL's own connected_components().

#include <recurve/features/detect_features.h>
#include <recurve/features/feature_curves.h>

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/connected_components.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/boost/graph/generators.h>

#include <iostream>
#include <set>
#include <utility>

int main()
{
  using Point_3 = CGAL::Exact_predicates_inexact_constructions_kernel::Point_3;
  using Mesh = CGAL::Surface_mesh<Point_3>;
  namespace PMP = CGAL::Polygon_mesh_processing;

  Mesh can;
  const int sides = 24;
  CGAL::make_regular_prism(sides, can, Point_3(0, 0, 0), /* height = */ 2., /* radius = */ 1., /* is_closed = */ true);

  auto is_critical = can.add_property_map<Mesh::Edge_index, bool>("e:is_critical", false).first;
  auto is_sharp = can.add_property_map<Mesh::Vertex_index, bool>("v:is_sharp", false).first;
  recurve::detect_features(can, is_critical, is_sharp);

  auto region = can.add_property_map<Mesh::Face_index, recurve::Index>("f:region").first;
  const recurve::Index regions = recurve::number_surface_regions(can, is_critical, region);
  auto component = can.add_property_map<Mesh::Face_index, std::size_t>("f:component").first;
  const std::size_t components =
    PMP::connected_components(can, component, PMP::parameters::edge_is_constrained_map(is_critical));

  std::set<std::pair<recurve::Index, std::size_t>> pairs; // as many as regions if both are the same partition
  for (const auto f : can.faces())
    pairs.emplace(region[f], component[f]);
  const bool are_same = pairs.size() == components && std::cmp_equal(components, regions);
  std::cout << regions << " regions, " << (are_same ? "the same" : "not the same") << " as CGAL's\n";
}
