#include "surface_passes.h"

#include <recurve/features/feature_curves.h>
#include <recurve/surface/curve_surface.h>
#include <recurve/surface/reconstruct_surface.h>

#include <boost/property_map/property_map.hpp>

#include <utility>

namespace recurve {

namespace {

using Mesh = Boundary_surface::Mesh;
using Mesh_point = Mesh::Point;
using Face_fits = Mesh::Property_map<Boundary_surface::Face, Local_fit>;

Index number(Boundary_surface::Face face)
{
  return static_cast<Index>(std::size_t(face));
}

/// the corner of its face at which `halfedge` starts.
int corner_of(const Mesh& mesh, Boundary_surface::Halfedge halfedge)
{
  int corner = 0;
  for (auto h = mesh.halfedge(mesh.face(halfedge)); h != halfedge; h = mesh.next(h))
    ++corner;
  return corner;
}

Point coordinates(const Mesh_point& point)
{
  return {point.x(), point.y(), point.z()};
}

/// Where curve_surface() writes the nodes on edges.
struct Edge_nodes
{
  using key_type = Edge_node<Mesh>;
  using value_type = Mesh_point;
  using reference = void;
  using category = boost::writable_property_map_tag;

  const Mesh* mesh = nullptr;
  Node_placement* placement = nullptr;
  int degree = 2;

  friend void put(const Edge_nodes& map, const key_type& key, const Mesh_point& point)
  {
    auto halfedge = key.halfedge;
    int k = key.k;
    if (map.mesh->is_border(halfedge))
    {
      halfedge = map.mesh->opposite(halfedge);
      k = map.degree - k;
    }
    map.placement->put_edge_node(number(map.mesh->face(halfedge)), corner_of(*map.mesh, halfedge), k,
                                 coordinates(point));
  }
};

/// Where curve_surface() writes the nodes inside faces.
struct Face_nodes
{
  using key_type = Face_node<Mesh>;
  using value_type = Mesh_point;
  using reference = void;
  using category = boost::writable_property_map_tag;

  Node_placement* placement = nullptr;

  friend void put(const Face_nodes& map, const key_type& key, const Mesh_point& point)
  {
    map.placement->put_face_node(number(key.face), key.m, coordinates(point));
  }
};

void count_edges(const Mesh& mesh, Node_placement& placement)
{
  for (Boundary_surface::Edge edge : mesh.edges())
  {
    auto halfedge = mesh.halfedge(edge);
    if (mesh.is_border(halfedge))
      halfedge = mesh.opposite(halfedge);
    placement.count_edge(number(mesh.face(halfedge)), corner_of(mesh, halfedge));
  }
}

} // namespace

void place_surface_nodes(const Boundary_surface& surface, const Curving_options& options, Node_placement& placement,
                         Curving_report& report, const Progress_callback& progress)
{
  const Mesh& mesh = surface.mesh;
  std::vector<Local_fit> fit_values(mesh.number_of_faces());
  const auto fits = boost::make_iterator_property_map(fit_values.begin(), get(boost::face_index, mesh), Local_fit());
  report.fits = run_stage("reconstruct surface", report.stages, progress, [&] {
    return reconstruct_surface(mesh, fits,
                               {.degree = options.effective_fit_degree(),
                                .largest_displacement = options.largest_displacement,
                                .progress = progress},
                               CGAL::parameters::edge_is_constrained_map(surface.edge_is_critical)
                                 .vertex_is_constrained_map(surface.vertex_is_sharp));
  });
  run_stage("curve surface", report.stages, progress, [&] {
    count_edges(mesh, placement);
    const auto curves = trace_feature_curves(mesh, surface.edge_is_critical, surface.vertex_is_sharp);
    curve_surface(mesh, fits, curves, Edge_nodes{&mesh, &placement, options.degree}, Face_nodes{&placement},
                  {.degree = options.degree,
                   .curve_fit = {.method = Curve_method::automatic, .degree = options.effective_fit_degree()},
                   .progress = progress});
    placement.finish();
  });
}

} // namespace recurve
