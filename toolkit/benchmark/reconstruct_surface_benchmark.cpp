// Times the reconstruction and curving of a surface.
//
//   reconstruct_surface_benchmark [faces = 200000] [threads = 1] [triangles | quads]
//
// The surface is a torus of jittered faces. The first table is that of the paper's method, the second that of the
// default, fit_vertices(): one line per degree d of the fits with the mean stencil, faces per second (of the clock and
// of the processor) with all set-up, and nodes per second of curve_surface() for elements of degree 3. The second also
// has the fits per second and, on the same number of points and with the same degree of the polynomial, those of CGAL's
// Monge_via_jet_fitting, whose stencils are gathered before the clock starts.

#include <recurve/surface/curve_surface.h>
#include <recurve/surface/fit_vertices.h>
#include <recurve/surface/reconstruct_surface.h>

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Monge_via_jet_fitting.h>
#include <CGAL/Surface_mesh.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <numbers>
#include <optional>
#include <random>
#include <string_view>
#include <vector>

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Mesh = CGAL::Surface_mesh<Kernel::Point_3>;

/// a torus of 2 n^2 quads or 4 n^2 triangles, jittered by a fixed seed.
Mesh torus(int n, bool has_quads)
{
  std::mt19937 random(1);
  std::uniform_real_distribution<double> jitter(-0.15, 0.15);
  Mesh mesh;
  std::vector<Mesh::Vertex_index> vertices;
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < 2 * n; ++i)
    {
      const double a = std::numbers::pi * (i + jitter(random)) / n;
      const double b = 2 * std::numbers::pi * (j + jitter(random)) / n;
      const double r = 2 + std::cos(b);
      vertices.push_back(mesh.add_vertex({r * std::cos(a), r * std::sin(a), std::sin(b)}));
    }
  const auto at = [&](int i, int j) { return vertices[static_cast<std::size_t>(i % (2 * n) + j % n * 2 * n)]; };
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < 2 * n; ++i)
      if (has_quads)
        mesh.add_face(at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
      else
      {
        mesh.add_face(at(i, j), at(i + 1, j), at(i + 1, j + 1));
        mesh.add_face(at(i, j), at(i + 1, j + 1), at(i, j + 1));
      }
  return mesh;
}

struct Seconds
{
  double wall = 0;
  double processor = 0; ///< of all threads; what counts on a machine that does other things as well
};

template <class Work>
Seconds time(const Work& work)
{
  const auto start = std::chrono::steady_clock::now();
  const std::clock_t processor_start = std::clock();
  work();
  return {std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(),
          static_cast<double>(std::clock() - processor_start) / CLOCKS_PER_SEC};
}

double nodes_per_second(const recurve::Curving_surface_report& report, const Seconds& seconds)
{
  return static_cast<double>(report.moved_edge_nodes + report.moved_face_nodes) / seconds.wall;
}

void time_paper(Mesh& mesh)
{
  using namespace recurve;
  const auto fits = mesh.add_property_map<Mesh::Face_index, Local_fit>("f:fit").first;
  std::printf("paper\n d  stencil  faces/s  faces/processor-s  nodes/s\n");
  for (int d = 1; d <= max_fit_degree; ++d)
  {
    Reconstruction_report fitted;
    const Seconds fit = time([&] { fitted = reconstruct_surface(mesh, fits, {.degree = d}); });
    Surface_nodes<Mesh> nodes(mesh, 3);
    Curving_surface_report curved;
    const Seconds curve = time([&] {
      curved = curve_surface(mesh, fits, std::vector<Feature_curve<Mesh>>(), nodes.edge_map(), nodes.face_map(),
                             {.degree = 3});
    });
    const double count = static_cast<double>(fitted.faces);
    std::printf(" %d   %6.1f  %8.0f  %8.0f           %8.0f\n", d, static_cast<double>(fitted.stencil_vertices) / count,
                count / fit.wall, count / fit.processor, nodes_per_second(curved, curve));
  }
}

/// `count` points around `vertex`, itself first, by growing rings.
std::vector<Kernel::Point_3> points_around(const Mesh& mesh, Mesh::Vertex_index vertex, std::size_t count)
{
  std::vector<Mesh::Vertex_index> vertices = {vertex};
  for (std::size_t i = 0; vertices.size() < count; ++i)
    for (const auto v : mesh.vertices_around_target(mesh.halfedge(vertices[i])))
      if (vertices.size() < count && std::find(vertices.begin(), vertices.end(), v) == vertices.end())
        vertices.push_back(v);
  std::vector<Kernel::Point_3> points;
  points.reserve(vertices.size());
  for (const auto v : vertices)
    points.push_back(mesh.point(v));
  return points;
}

/// fits per second of CGAL's jets.
double time_jets(const Mesh& mesh, int degree, std::size_t points)
{
  std::vector<std::vector<Kernel::Point_3>> stencils;
  for (const auto v : mesh.vertices())
    if (stencils.size() < 5000)
      stencils.push_back(points_around(mesh, v, points));
  const Seconds seconds = time([&] {
    for (const auto& stencil : stencils)
    {
      CGAL::Monge_via_jet_fitting<Kernel> jet;
      jet(stencil.begin(), stencil.end(), static_cast<std::size_t>(degree), 2);
    }
  });
  return static_cast<double>(stencils.size()) / seconds.processor;
}

void time_default(const Mesh& mesh)
{
  using namespace recurve;
  std::printf(
    "default\n d  degree  stencil  faces/s  faces/processor-s  fits/processor-s  jets/processor-s  nodes/s\n");
  for (int d = 1; d <= max_fit_degree; ++d)
  {
    Reconstruction_report fitted;
    std::optional<Vertex_fits<Mesh>> fits;
    const Seconds fit =
      time([&] { fits = fit_vertices(mesh, {.degree = d}, no_parameters, Compact_policies{}, &fitted); });
    Surface_nodes<Mesh> nodes(mesh, 3);
    Curving_surface_report curved;
    const Seconds curve = time([&] {
      curved = curve_surface(mesh, fits->face_map(), std::vector<Feature_curve<Mesh>>(), nodes.edge_map(),
                             nodes.face_map(), {.degree = 3});
    });
    const double faces = static_cast<double>(fitted.faces), count = static_cast<double>(fitted.fits);
    const double stencil = static_cast<double>(fitted.stencil_vertices) / count;
    std::printf(" %d  %d       %6.1f  %8.0f  %8.0f           %8.0f          %8.0f          %8.0f\n", d,
                vertex_fit_degree(d), stencil, faces / fit.wall, faces / fit.processor, count / fit.processor,
                time_jets(mesh, vertex_fit_degree(d), static_cast<std::size_t>(std::lround(stencil))),
                nodes_per_second(curved, curve));
  }
}

} // namespace

int main(int argc, char** argv)
{
  const double faces = argc > 1 ? std::atof(argv[1]) : 200000;
  const std::size_t threads = argc > 2 ? static_cast<std::size_t>(std::atoi(argv[2])) : 1;
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
  const bool has_quads = argc > 3 && std::string_view(argv[3]) == "quads";
  Mesh mesh = torus(std::max(3, static_cast<int>(std::sqrt(faces / (has_quads ? 2 : 4)))), has_quads);
  std::printf("%zu %s, %zu thread(s)\n", std::size_t(mesh.number_of_faces()), has_quads ? "quads" : "triangles",
              threads);
  time_paper(mesh);
  time_default(mesh);
  return 0;
}
