#include <recurve/run/curve_surface_mesh.h>

#include <recurve/core/exceptions.h>
#include <recurve/elements/node_layout.h>
#include <recurve/features/detect_features.h>
#include <recurve/features/feature_curves.h>
#include <recurve/mesh/join_zones.h>
#include <recurve/run/curve_mesh.h>
#include <recurve/surface/curve_surface.h>
#include <recurve/surface/fit_vertices.h>
#include <recurve/surface/reconstruct_surface.h>

#include <CGAL/boost/graph/IO/polygon_mesh_io.h>
#include <boost/property_map/property_map.hpp>
#include <tbb/global_control.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace recurve {

namespace {

using Mesh = Boundary_surface::Mesh;
using Nodes = Surface_nodes<Mesh>;

constexpr std::array<Element_type, 2> face_types = {Element_type::triangle, Element_type::quadrangle};

std::string lower_extension(const std::filesystem::path& file)
{
  std::string extension = file.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension;
}

Element_type type_of(const Mesh& mesh, Mesh::Face_index face)
{
  return mesh.degree(face) == 3 ? Element_type::triangle : Element_type::quadrangle;
}

/// the surface as a mesh of one zone that has faces alone.
Volume_mesh linear_mesh(const Mesh& mesh)
{
  Zone zone;
  zone.name = "surface";
  for (const auto v : mesh.vertices())
    zone.points.push_back({mesh.point(v).x(), mesh.point(v).y(), mesh.point(v).z()});
  Patch patch;
  patch.name = "surface";
  for (const Element_type type : face_types)
  {
    Section section;
    section.name = element_name(type);
    section.type = type;
    for (const auto f : mesh.faces())
      if (type_of(mesh, f) == type)
      {
        for (const auto h : mesh.halfedges_around_face(mesh.halfedge(f)))
          section.nodes.push_back(static_cast<Index>(mesh.source(h).idx()));
        patch.faces.push_back(static_cast<Index>(patch.faces.size()));
      }
    if (!section.nodes.empty())
      zone.faces.push_back(std::move(section));
  }
  zone.patches.push_back(std::move(patch));
  Volume_mesh linear;
  linear.zones.push_back(std::move(zone));
  return linear;
}

Point coordinates(const Mesh::Point& x)
{
  return {x.x(), x.y(), x.z()};
}

/// puts the nodes of one face where `nodes` has them. \param numbers  its nodes in the curved mesh, canonical order
void take_nodes(const Mesh& mesh, const Nodes& nodes, Mesh::Face_index face, std::span<const Index> numbers,
                Curved_mesh& curved)
{
  const Element_type type = type_of(mesh, face);
  const auto put_node = [&](int canonical, const Mesh::Point& x) {
    curved.nodes[static_cast<std::size_t>(numbers[static_cast<std::size_t>(canonical)])] = coordinates(x);
  };
  int side = 0;
  for (const auto h : mesh.halfedges_around_face(mesh.halfedge(face)))
  {
    for (int k = 1; k < curved.degree; ++k)
      put_node(first_edge_node(type, curved.degree, side) + k - 1, nodes.edge_node(h, k));
    ++side;
  }
  for (int m = 0; m < nodes.face_node_count(face); ++m)
    put_node(first_interior_node(type, curved.degree) + m, nodes.face_node(face, m));
}

Curved_mesh make_curved_mesh(const Mesh& mesh, const Nodes& nodes)
{
  Volume_mesh linear = linear_mesh(mesh);
  const Joined_zones joined = join_zones(linear);
  Curved_mesh curved = elevate(std::move(linear), joined, nodes.degree());
  for (const Curved_section& section : curved.zones[0].faces)
  {
    const std::size_t count = static_cast<std::size_t>(node_count(section.type, curved.degree));
    std::size_t first = 0;
    for (const auto f : mesh.faces())
      if (type_of(mesh, f) == section.type)
      {
        take_nodes(mesh, nodes, f, std::span(section.nodes).subspan(first, count), curved);
        first += count;
      }
  }
  return curved;
}

} // namespace

bool is_surface_file(const std::filesystem::path& file)
{
  const std::string extension = lower_extension(file);
  return extension == ".off" || extension == ".obj" || extension == ".ply" || extension == ".stl";
}

Boundary_surface::Mesh read_surface_mesh(const std::filesystem::path& file)
{
  Mesh mesh;
  bool is_read = false;
  try
  {
    is_read = CGAL::IO::read_polygon_mesh(file.string(), mesh);
  }
  catch (const std::exception& error)
  {
    throw Format_error(file.string() + ": " + error.what());
  }
  if (!is_read)
    throw Format_error(file.string() + ": cannot be read as a manifold surface mesh (OFF, OBJ, PLY, STL)");
  return mesh;
}

Curved_mesh curve_surface_mesh(const Boundary_surface::Mesh& mesh, const Curving_options& options,
                               Surface_mesh_report* report, const Progress_callback& progress)
{
  check(options);
  if (mesh.has_garbage())
    throw Input_error("the surface has removed elements: collect its garbage first");
  std::optional<tbb::global_control> threads;
  if (options.threads > 0)
    threads.emplace(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(options.threads));

  std::vector<char> edge_flags(mesh.number_of_edges()), vertex_flags(mesh.number_of_vertices());
  const auto is_critical = boost::make_iterator_property_map(edge_flags.begin(), get(boost::edge_index, mesh));
  const auto is_sharp = boost::make_iterator_property_map(vertex_flags.begin(), get(boost::vertex_index, mesh));
  Surface_mesh_report done;
  done.features = detect_features(mesh, is_critical, is_sharp, options.features);
  const auto constraints = CGAL::parameters::edge_is_constrained_map(is_critical).vertex_is_constrained_map(is_sharp);
  const auto curves = trace_feature_curves(mesh, is_critical, is_sharp);
  Nodes nodes(mesh, options.degree);
  const int degree = options.effective_fit_degree();
  const auto place = [&](auto fits, const Curve_fit_options& curve_fit) {
    done.curving = curve_surface(mesh, fits, curves, nodes.edge_map(), nodes.face_map(),
                                 {.degree = options.degree, .curve_fit = curve_fit, .progress = progress});
  };
  if (options.fit_preset == Fit_preset::paper)
  {
    std::vector<Local_fit> values(mesh.number_of_faces());
    const auto fits = boost::make_iterator_property_map(values.begin(), get(boost::face_index, mesh), Local_fit());
    done.fits = reconstruct_surface(
      mesh, fits, {.degree = degree, .largest_displacement = options.largest_displacement, .progress = progress},
      constraints);
    place(fits, {.method = Curve_method::cubic_spline});
  }
  else
  {
    const Vertex_fits<Mesh> fits =
      fit_vertices(mesh,
                   {.degree = degree,
                    .largest_displacement = options.largest_displacement / std::sqrt(3.0), // sizes of a face in edges
                    .progress = progress},
                   constraints, Compact_policies{}, &done.fits);
    place(fits.face_map(),
          {.method = Curve_method::automatic, .degree = std::min(vertex_fit_degree(degree), max_fit_degree)});
  }
  if (report)
    *report = std::move(done);
  return make_curved_mesh(mesh, nodes);
}

} // namespace recurve
