#ifndef RECURVE_MESH_OPENMESH_H
#define RECURVE_MESH_OPENMESH_H

// OpenMesh's headers must come before CGAL's wrapper of them.
#include <OpenMesh/Core/Mesh/PolyMesh_ArrayKernelT.hh>
#include <OpenMesh/Core/Mesh/Traits.hh>

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/boost/graph/graph_traits_PolyMesh_ArrayKernelT.h>
#include <CGAL/boost/graph/graph_traits_TriMesh_ArrayKernelT.h>

#include <boost/property_map/property_map.hpp>

#include <type_traits>

namespace recurve {

/// OpenMesh's double traits with the status flags that CGAL's wrapper needs to remove elements.
struct Openmesh_traits : OpenMesh::DefaultTraitsDouble
{
  VertexAttributes(OpenMesh::Attributes::Status);
  EdgeAttributes(OpenMesh::Attributes::Status);
  HalfedgeAttributes(OpenMesh::Attributes::Status | OpenMesh::Attributes::PrevHalfedge);
  FaceAttributes(OpenMesh::Attributes::Status);
};

/// A mesh of polygons on which the passes run with results equal to those on a Surface_mesh.
using Openmesh_polygons = OpenMesh::PolyMesh_ArrayKernelT<Openmesh_traits>;

/// Vertex positions of an OpenMesh in double precision. CGAL 5.5's own map rounds what it writes to `float`: give this
/// one as `vertex_point_map` wherever positions are written. Model of `ReadWritePropertyMap`: vertex_descriptor ->
/// Point_3. \tparam Mesh  PolyMesh_ArrayKernelT or TriMesh_ArrayKernelT whose scalar is `double`.
template <class Mesh>
class Openmesh_point_map
{
public:
  static_assert(std::is_same_v<typename Mesh::Scalar, double>,
                "an OpenMesh of floats cannot hold positions exactly; use traits derived from DefaultTraitsDouble");

  using key_type = typename Mesh::VertexHandle;
  using value_type = CGAL::Exact_predicates_inexact_constructions_kernel::Point_3;
  using reference = value_type;
  using category = boost::read_write_property_map_tag;

  Openmesh_point_map() = default;
  explicit Openmesh_point_map(Mesh& mesh) : mesh_(&mesh) {}

  friend value_type get(const Openmesh_point_map& map, key_type vertex)
  {
    const auto& x = map.mesh_->point(vertex);
    return {x[0], x[1], x[2]};
  }

  friend void put(const Openmesh_point_map& map, key_type vertex, const value_type& point)
  {
    map.mesh_->set_point(vertex, typename Mesh::Point(point.x(), point.y(), point.z()));
  }

  value_type operator[](key_type vertex) const { return get(*this, vertex); }

private:
  Mesh* mesh_ = nullptr;
};

/// the exact position map of `mesh`.
template <class Mesh>
Openmesh_point_map<Mesh> openmesh_point_map(Mesh& mesh)
{
  return Openmesh_point_map<Mesh>(mesh);
}

} // namespace recurve

#endif
