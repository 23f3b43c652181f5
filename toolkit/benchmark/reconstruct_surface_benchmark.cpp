// Times the reconstruction and curving of a surface.
//
//   reconstruct_surface_benchmark [faces = 200000] [threads = 1]
//
// The surface is a torus of jittered triangles; the report is one line per degree of the fits: mean stencil, faces per
// second (of the clock and of the processor) of reconstruct_surface() with its set-up, and nodes per second of
// curve_surface() for elements of degree 3.

#include <recurve/surface/curve_surface.h>
#include <recurve/surface/reconstruct_surface.h>

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Surface_mesh.h>
#include <tbb/global_control.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <numbers>
#include <random>
#include <vector>

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Mesh = CGAL::Surface_mesh<Kernel::Point_3>;

/// a torus of 4 n^2 triangles, jittered by a fixed seed.
Mesh torus(int n)
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

} // namespace

int main(int argc, char** argv)
{
  using namespace recurve;
  const double faces = argc > 1 ? std::atof(argv[1]) : 200000;
  const std::size_t threads = argc > 2 ? static_cast<std::size_t>(std::atoi(argv[2])) : 1;
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
  Mesh mesh = torus(std::max(3, static_cast<int>(std::sqrt(faces / 4))));
  const auto fits = mesh.add_property_map<Mesh::Face_index, Local_fit>("f:fit").first;
  std::printf("%zu faces, %zu thread(s)\n d  stencil  faces/s  faces/processor-s  nodes/s\n",
              std::size_t(mesh.number_of_faces()), threads);
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
                count / fit.wall, count / fit.processor,
                static_cast<double>(curved.moved_edge_nodes + curved.moved_face_nodes) / curve.wall);
  }
  return 0;
}
