// Times the detection of feature curves, which runs on one core.
//
//   detect_features_benchmark [largest number of triangles in millions = 4]
//
// Three surfaces, each with a quarter, a half and all of the triangles: a can with waves on its side, whose rims are
// the features; a sheet with a ridge every 16 cells; and a sheet so rough that half of its edges are candidates, the
// worst that there is. A line tells the triangles, the seconds of the processor (which count on a machine that does
// other things as well), these per million triangles, the critical edges and the rounds of rejection. The share of
// reading the graph is in it.

#include <recurve/features/detect_features.h>

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Surface_mesh.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <functional>
#include <numbers>
#include <random>
#include <vector>

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Mesh = CGAL::Surface_mesh<Kernel::Point_3>;

/// an nu x nv grid of split quadrangles; its first and its last column are one if `is_closed`.
Mesh grid(int nu, int nv, bool is_closed, const std::function<Kernel::Point_3(int, int)>& at)
{
  Mesh mesh;
  const int columns = is_closed ? nu : nu + 1;
  std::vector<Mesh::Vertex_index> vertices;
  for (int j = 0; j <= nv; ++j)
    for (int i = 0; i < columns; ++i)
      vertices.push_back(mesh.add_vertex(at(i, j)));
  const auto vertex = [&](int i, int j) { return vertices[static_cast<std::size_t>(i % columns + j * columns)]; };
  for (int j = 0; j < nv; ++j)
    for (int i = 0; i < nu; ++i)
    {
      mesh.add_face(vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1));
      mesh.add_face(vertex(i, j), vertex(i + 1, j + 1), vertex(i, j + 1));
    }
  return mesh;
}

/// a can of 2 n^2 triangles: its caps are the first and the last quarter of the rows.
Mesh can(int n)
{
  return grid(n, n, true, [n](int i, int j) {
    const double a = 2 * std::numbers::pi * i / n, s = 4. * j / n;
    const double wave = 1 + 0.02 * std::sin(12 * a) * std::sin(std::numbers::pi * (s - 1));
    const double r = s < 1 ? 0.01 + 0.99 * s : s > 3 ? 0.01 + 0.99 * (4 - s) : wave;
    return Kernel::Point_3(r * std::cos(a), r * std::sin(a), s < 1 ? -1 : s > 3 ? 1 : s - 2);
  });
}

/// a sheet of 2 n^2 triangles with a ridge of 53 degrees every 16 cells.
Mesh ridges(int n)
{
  return grid(n, n, false, [](int i, int j) {
    const int phase = i % 32;
    return Kernel::Point_3(i, j, 0.5 * (phase < 16 ? phase : 32 - phase));
  });
}

/// a sheet of 2 n^2 triangles, rough by 0.4 of a cell.
Mesh rough(int n)
{
  std::mt19937 random(1);
  std::uniform_real_distribution<double> noise(-0.4, 0.4);
  return grid(n, n, false, [&](int i, int j) { return Kernel::Point_3(i, j, noise(random)); });
}

void measure(const char* name, Mesh mesh)
{
  auto is_critical = mesh.add_property_map<Mesh::Edge_index, char>("e:is_critical", 0).first;
  auto is_sharp = mesh.add_property_map<Mesh::Vertex_index, char>("v:is_sharp", 0).first;
  const std::clock_t start = std::clock();
  const recurve::Feature_report report = recurve::detect_features(mesh, is_critical, is_sharp);
  const double seconds = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
  const double millions = static_cast<double>(mesh.number_of_faces()) / 1e6;
  std::printf("%-7s %6.3f   %7.3f   %7.3f   %9lld   %5lld\n", name, millions, seconds, seconds / millions,
              static_cast<long long>(report.critical_edges), static_cast<long long>(report.sweeps));
  std::fflush(stdout);
}

} // namespace

int main(int argc, char** argv)
{
  const double largest = argc > 1 ? std::atof(argv[1]) : 4;
  std::printf("surface millions seconds seconds/million critical edges rounds\n");
  for (const double part : {0.25, 0.5, 1.})
  {
    const int n = 4 * static_cast<int>(std::sqrt(part * largest * 1e6 / 2) / 4);
    measure("can", can(n));
    measure("ridges", ridges(n));
    measure("rough", rough(n));
  }
  return 0;
}
