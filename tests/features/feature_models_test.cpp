// The same calls on every face graph that CGAL knows, with equal results.
#include "support/feature_check.h"

#include <CGAL/boost/graph/graph_traits_PolyMesh_ArrayKernelT.h>
#include <CGAL/boost/graph/graph_traits_TriMesh_ArrayKernelT.h>
#include <OpenMesh/Core/Mesh/PolyMesh_ArrayKernelT.hh>
#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>

#include <CGAL/Polyhedron_3.h>
#include <CGAL/Polyhedron_items_with_id_3.h>
#include <CGAL/boost/graph/copy_face_graph.h>

#include <catch2/catch.hpp>

using namespace recurve;
using namespace recurve::test;

namespace {

struct Double_traits : OpenMesh::DefaultTraits
{
  using Point = OpenMesh::Vec3d;
  using Normal = OpenMesh::Vec3d;
};
using Open_poly_mesh = OpenMesh::PolyMesh_ArrayKernelT<Double_traits>;
using Open_tri_mesh = OpenMesh::TriMesh_ArrayKernelT<Double_traits>;
using Polyhedron = CGAL::Polyhedron_3<Kernel>;
using Polyhedron_with_ids = CGAL::Polyhedron_3<Kernel, CGAL::Polyhedron_items_with_id_3>;

/// Everything found on one model in terms that do not depend on it nor on its order: positions, sorted.
struct Findings
{
  std::vector<std::array<double, 6>> critical_edges;
  std::vector<std::array<double, 3>> sharp_vertices, critical_vertices;
  std::vector<std::vector<std::array<double, 3>>> curves;
  std::vector<Index> region_sizes, curve_sizes;
  bool operator==(const Findings&) const = default;
};

template <class Graph>
Findings find(const Graph& g)
{
  using Traits = boost::graph_traits<Graph>;
  const auto point_map = get(CGAL::vertex_point, g);
  const auto point = [&](auto v) {
    const auto p = get(point_map, v);
    return std::array<double, 3>{CGAL::to_double(p[0]), CGAL::to_double(p[1]), CGAL::to_double(p[2])};
  };
  std::map<typename Traits::edge_descriptor, char> edge_flags;
  std::map<typename Traits::vertex_descriptor, bool> vertex_flags, critical_flags;
  std::map<typename Traits::face_descriptor, int> regions;
  const boost::associative_property_map critical(edge_flags);
  const boost::associative_property_map sharp(vertex_flags), vertex_is_critical(critical_flags);
  const boost::associative_property_map region(regions);
  detect_features(g, critical, sharp);
  mark_critical_vertices(g, critical, sharp, vertex_is_critical);

  Findings f;
  for (const auto e : CGAL::make_range(edges(g)))
    if (get(critical, e))
    {
      auto a = point(source(e, g)), b = point(target(e, g));
      if (b < a)
        std::swap(a, b);
      f.critical_edges.push_back({a[0], a[1], a[2], b[0], b[1], b[2]});
    }
  std::sort(f.critical_edges.begin(), f.critical_edges.end());
  for (const auto v : CGAL::make_range(vertices(g)))
  {
    if (get(sharp, v))
      f.sharp_vertices.push_back(point(v));
    if (get(vertex_is_critical, v))
      f.critical_vertices.push_back(point(v));
  }
  const auto curves = trace_feature_curves(g, critical, sharp);
  std::map<typename Traits::edge_descriptor, int> curve_numbers;
  const boost::associative_property_map edge_curve(curve_numbers);
  number_feature_curves(g, curves, edge_curve);
  f.curve_sizes.assign(curves.size(), 0);
  for (const auto e : CGAL::make_range(edges(g)))
    if (get(edge_curve, e) >= 0)
      ++f.curve_sizes[static_cast<std::size_t>(get(edge_curve, e))];
  std::sort(f.curve_sizes.begin(), f.curve_sizes.end());
  for (const auto& curve : curves)
  {
    auto& points = f.curves.emplace_back();
    for (const auto h : curve.halfedges)
      points.push_back(point(source(h, g)));
    points.push_back(point(target(curve.halfedges.back(), g)));
    std::sort(points.begin() + curve.is_closed, points.end());
    points.erase(points.begin(), points.begin() + curve.is_closed);
  }
  std::sort(f.curves.begin(), f.curves.end());
  std::sort(f.sharp_vertices.begin(), f.sharp_vertices.end());
  std::sort(f.critical_vertices.begin(), f.critical_vertices.end());
  f.region_sizes.assign(static_cast<std::size_t>(number_surface_regions(g, critical, region)), 0);
  for (const auto face : CGAL::make_range(faces(g)))
    ++f.region_sizes[static_cast<std::size_t>(get(region, face))];
  std::sort(f.region_sizes.begin(), f.region_sizes.end());
  return f;
}

template <class Graph>
Findings find_on_copy(const Mesh& mesh)
{
  Graph g;
  CGAL::copy_face_graph(mesh, g);
  return find(g);
}

/// CGAL's point map for OpenMesh writes through float, so the points are given to OpenMesh itself.
template <class OpenMeshType>
Findings find_on_open_mesh(const Surface& s)
{
  OpenMeshType g;
  std::vector<typename OpenMeshType::VertexHandle> handles, corners;
  for (const Point& p : s.points)
    handles.push_back(g.add_vertex({p[0], p[1], p[2]}));
  for (const auto& face : s.faces)
  {
    corners.clear();
    for (const std::size_t v : face)
      corners.push_back(handles[v]);
    g.add_face(corners);
  }
  return find(g);
}

} // namespace

TEST_CASE("features: every model of FaceListGraph gives the same")
{
  const Surface surfaces[] = {cube(3, Split::same),
                              cone(24, 1.7, Split::same),
                              wing(16, false, Split::same),
                              roughen(icosphere(2), 0.03, 3),
                              cylinder(24, 4, true, Split::quads),
                              crease([](double) { return 20.; }, Split::quads)};
  for (const Surface& s : surfaces)
  {
    const Mesh mesh = to_mesh(s);
    const Findings expected = find(mesh);
    CHECK(find_on_copy<Polyhedron>(mesh) == expected);
    CHECK(find_on_copy<Polyhedron_with_ids>(mesh) == expected);
    CHECK(find_on_open_mesh<Open_poly_mesh>(s) == expected);
    if (CGAL::is_triangle_mesh(mesh))
      CHECK(find_on_open_mesh<Open_tri_mesh>(s) == expected);
  }
}

TEST_CASE("features: a mesh with removed elements gives the same as without them")
{
  Mesh mesh = to_mesh(cube(3, Split::quads));
  Mesh with_garbage;
  std::vector<Mesh::Vertex_index> spare;
  spare.reserve(4);
  for (int i = 0; i < 4; ++i)
    spare.push_back(with_garbage.add_vertex({100. + i, i * i * 1., 0}));
  const auto face = with_garbage.add_face(spare);
  CGAL::copy_face_graph(mesh, with_garbage);
  CGAL::Euler::remove_face(with_garbage.halfedge(face), with_garbage);
  REQUIRE(with_garbage.has_garbage());
  CHECK(find(with_garbage) == find(mesh));
}
