#include "surface_passes.h"

#include <recurve/features/feature_curves.h>
#include <recurve/surface/curve_surface.h>
#include <recurve/surface/fit_vertices.h>
#include <recurve/surface/reconstruct_surface.h>

#include <boost/property_map/property_map.hpp>

#include <algorithm>
#include <cmath>
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

/// The steps of place_surface_nodes(), the same for every kind of fits.
class Surface_placement
{
  auto constraints() const
  {
    return CGAL::parameters::edge_is_constrained_map(surface_.edge_is_critical)
      .vertex_is_constrained_map(surface_.vertex_is_sharp);
  }

public:
  Surface_placement(const Boundary_surface& surface, const Curving_options& options, Node_placement& placement,
                    Curving_report& report, const Progress_callback& progress)
    : surface_(surface), options_(options), placement_(placement), report_(report), progress_(progress)
  {}

  /// the paper's: polynomials of faces, and cubic splines.
  void place_by_faces()
  {
    const Mesh& mesh = surface_.mesh;
    std::vector<Local_fit> fit_values(mesh.number_of_faces());
    const auto fits = boost::make_iterator_property_map(fit_values.begin(), get(boost::face_index, mesh), Local_fit());
    report_.fits = run_stage(fit_stage, report_.stages, progress_, [&] {
      return reconstruct_surface(mesh, fits,
                                 {.degree = options_.effective_fit_degree(),
                                  .largest_displacement = options_.largest_displacement,
                                  .progress = progress_},
                                 constraints());
    });
    place(fits, {.method = Curve_method::cubic_spline});
  }

  /// polynomials of vertices, blended, and curves of their degree.
  void place_by_vertices()
  {
    // Sizes of a face with equal sides, in lengths of its edges.
    const double face_size = 1 / std::sqrt(3.0);
    const int degree = options_.effective_fit_degree();
    const Vertex_fits<Mesh> fits = run_stage(fit_stage, report_.stages, progress_, [&] {
      return fit_vertices(
        surface_.mesh,
        {.degree = degree, .largest_displacement = face_size * options_.largest_displacement, .progress = progress_},
        constraints(), Compact_policies{}, &report_.fits);
    });
    place(fits.face_map(),
          {.method = Curve_method::automatic, .degree = std::min(vertex_fit_degree(degree), max_fit_degree)});
  }

private:
  static constexpr auto fit_stage = "reconstruct surface";

  template <class FaceFitMap>
  void place(FaceFitMap fits, const Curve_fit_options& curve_fit)
  {
    run_stage("curve surface", report_.stages, progress_, [&] {
      count_edges(surface_.mesh, placement_);
      const auto curves = trace_feature_curves(surface_.mesh, surface_.edge_is_critical, surface_.vertex_is_sharp);
      curve_surface(surface_.mesh, fits, curves, Edge_nodes{&surface_.mesh, &placement_, options_.degree},
                    Face_nodes{&placement_},
                    {.degree = options_.degree, .curve_fit = curve_fit, .progress = progress_});
      placement_.finish();
    });
  }

  const Boundary_surface& surface_;
  const Curving_options& options_;
  Node_placement& placement_;
  Curving_report& report_;
  const Progress_callback& progress_;
};

} // namespace

void place_surface_nodes(const Boundary_surface& surface, const Curving_options& options, Node_placement& placement,
                         Curving_report& report, const Progress_callback& progress)
{
  Surface_placement steps(surface, options, placement, report, progress);
  if (options.fit_preset == Fit_preset::paper)
    steps.place_by_faces();
  else
    steps.place_by_vertices();
}

} // namespace recurve
