#include <recurve/features/detect_features.h>
#include <recurve/mesh/volume_mesh.h>

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/boost/graph/generators.h>

#include <iostream>

int main()
{
  using Point_3 = CGAL::Exact_predicates_inexact_constructions_kernel::Point_3;
  using Mesh = CGAL::Surface_mesh<Point_3>;
  Mesh mesh;
  CGAL::make_hexahedron(Point_3(0, 0, 0), Point_3(1, 0, 0), Point_3(1, 1, 0), Point_3(0, 1, 0), Point_3(0, 1, 1),
                        Point_3(0, 0, 1), Point_3(1, 0, 1), Point_3(1, 1, 1), mesh);
  const auto is_critical = mesh.add_property_map<Mesh::Edge_index, bool>("e:is_critical", false).first;
  const auto is_sharp = mesh.add_property_map<Mesh::Vertex_index, bool>("v:is_sharp", false).first;
  recurve::detect_features(mesh, is_critical, is_sharp);

  int critical_edges = 0;
  for (const Mesh::Edge_index edge : mesh.edges())
    critical_edges += is_critical[edge] ? 1 : 0;
  std::cout << "critical edges of a cube: " << critical_edges << '\n';

  // A function that is compiled, of the floor below.
  const std::vector<recurve::Section> sections = {
    {"cells", recurve::Element_type::hexahedron, {0, 1, 2, 3, 4, 5, 6, 7}}};
  return recurve::find_element(sections, 0).element == 0 ? 0 : 1;
}
