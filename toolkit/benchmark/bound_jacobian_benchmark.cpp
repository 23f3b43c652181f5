// Cells certified per second, by type and degree, straight and curved, and what a second thread brings.
//
//   bound_jacobian_benchmark              curved cells, 0.2 s or more per line
//   bound_jacobian_benchmark 2 0.1        seconds per line; amplitude of the curving relative to the cell
//   bound_jacobian_benchmark 2 0.1 noise  the same amplitude, relative to the distance of nodes, for each node by
//   itself
//   bound_jacobian_benchmark msh FILE tetrahedron 3 10000 0.4
//                                         writes noisy cells for compare_with_gmsh.py, and a line of verdict and lower
//                                         bound per cell on standard output
//
// The environment variable RECURVE_SIMD (baseline, avx2) asks for narrower vector instructions than the processor has.
#include <recurve/elements/node_layout.h>
#include <recurve/volume/bound_jacobian.h>

#include <tbb/global_control.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <random>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

namespace {

using namespace recurve;

struct Cells
{
  std::vector<Point> nodes;
  std::vector<Index> numbers;
};

/// How a cell differs from the reference cell.
struct Curving
{
  double amplitude = 0.05;
  bool is_noise = false;
};

/// cells that share no nodes: the reference cell under a sine wave of random phases, which is smooth as curved meshes
/// are, or with noise, which is harder the higher the degree.
Cells random_cells(Element_type type, int degree, int count, const Curving& curving)
{
  std::mt19937 random(7);
  std::uniform_real_distribution<double> uniform(-1, 1);
  Cells cells;
  for (int c = 0; c < count; ++c)
  {
    const Point phase = {3 * uniform(random), 3 * uniform(random), 3 * uniform(random)};
    for (const Lattice_point& l : canonical_nodes(type, degree))
    {
      const Point at = {double(l[0]) / degree, double(l[1]) / degree, double(l[2]) / degree};
      Point p;
      for (std::size_t d = 0; d < 3; ++d)
      {
        const double wave = std::sin(3 * at[(d + 1) % 3] + phase[d]) * std::cos(2 * at[(d + 2) % 3] - phase[d]);
        p[d] = at[d] + curving.amplitude * (curving.is_noise ? uniform(random) / degree : wave) + c;
      }
      cells.numbers.push_back(static_cast<Index>(cells.nodes.size()));
      cells.nodes.push_back(p);
    }
  }
  return cells;
}

double seconds_for(const Cells& cells, Element_type type, int degree, bool is_straight, Jacobian_report& report)
{
  const std::vector<Element_block> blocks = {{type, cells.numbers}};
  const auto start = std::chrono::steady_clock::now();
  report = bound_jacobians(cells.nodes, blocks, degree, {}, [is_straight](Index, Index) { return is_straight; });
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// the best of several runs, until `duration` is over.
double best_seconds(const Cells& cells, Element_type type, int degree, bool is_straight, int threads, double duration,
                    Jacobian_report& report)
{
  const tbb::global_control control(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads));
  double best = 1e300, total = 0;
  for (int run = 0; run < 3 || total < duration; ++run)
  {
    const double seconds = seconds_for(cells, type, degree, is_straight, report);
    best = std::min(best, seconds);
    total += seconds;
  }
  return best;
}

void measure(Element_type type, int degree, bool is_straight, const Curving& curving, double duration)
{
  const int count = std::clamp(40000000 / (node_count(type, degree) * node_count(type, degree)), 256, 200000);
  const Cells cells = random_cells(type, degree, count, curving);
  Jacobian_report report;
  const double one = best_seconds(cells, type, degree, is_straight, 1, duration, report);
  const double two = best_seconds(cells, type, degree, is_straight, 2, duration, report);
  std::printf("%-12s p=%d %-8s %10.0f cells/s  %9.2f us  2 threads: %4.2f times  valid %5.1f %%, subdivided %5.1f %%, "
              "exact %.1f %%\n",
              std::string(element_name(type)).c_str(), degree, is_straight ? "straight" : "curved", count / one,
              1e6 * one / count, one / two, 100.0 * static_cast<double>(report.total().valid) / count,
              100.0 * static_cast<double>(report.subdivided_elements) / count,
              100.0 * static_cast<double>(report.exact_elements) / count);
}

/// the number of Gmsh's element type. \pre degree <= 4
int gmsh_code(Element_type type, int degree)
{
  constexpr int tetrahedra[] = {4, 11, 29, 30}, pyramids[] = {7, 14, 118, 119}, prisms[] = {6, 13, 90, 91},
                hexahedra[] = {5, 12, 92, 93};
  switch (type)
  {
  case Element_type::tetrahedron: return tetrahedra[degree - 1];
  case Element_type::pyramid: return pyramids[degree - 1];
  case Element_type::prism: return prisms[degree - 1];
  default: return hexahedra[degree - 1];
  }
}

void write_msh(const Cells& cells, Element_type type, int degree, const char* path)
{
  std::FILE* const file = std::fopen(path, "w");
  if (!file)
    throw std::runtime_error(std::string("cannot write ") + path);
  std::fprintf(file, "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n%zu\n", cells.nodes.size());
  for (std::size_t m = 0; m < cells.nodes.size(); ++m)
    std::fprintf(file, "%zu %.17g %.17g %.17g\n", m + 1, cells.nodes[m][0], cells.nodes[m][1], cells.nodes[m][2]);
  const auto order = canonical_of_foreign(Node_order::gmsh, type, degree);
  const std::size_t count = cells.numbers.size() / order.size();
  std::fprintf(file, "$EndNodes\n$Elements\n%zu\n", count);
  for (std::size_t e = 0; e < count; ++e)
  {
    std::fprintf(file, "%zu %d 2 1 1", e + 1, gmsh_code(type, degree));
    for (const int canonical : order)
      std::fprintf(file, " %lld",
                   static_cast<long long>(cells.numbers[e * order.size() + static_cast<std::size_t>(canonical)]) + 1);
    std::fprintf(file, "\n");
  }
  std::fprintf(file, "$EndElements\n");
  std::fclose(file);
}

/// arguments: FILE type degree count amplitude
void compare(char** arguments)
{
  const auto* const type = std::find_if(all_element_types.begin(), all_element_types.end(),
                                        [&](Element_type t) { return element_name(t) == arguments[1]; });
  const int degree = std::atoi(arguments[2]);
  const Cells cells = random_cells(*type, degree, std::atoi(arguments[3]), {std::atof(arguments[4]), true});
  write_msh(cells, *type, degree, arguments[0]);
  std::vector<Jacobian_bounds> bounds(cells.numbers.size() / static_cast<std::size_t>(node_count(*type, degree)));
  const std::vector<Element_block> blocks = {{*type, cells.numbers}};
  const tbb::global_control control(tbb::global_control::max_allowed_parallelism, 1);
  const auto start = std::chrono::steady_clock::now();
  bound_jacobians(cells.nodes, blocks, degree, {}, None_straight(),
                  [&](Index, Index e, const Jacobian_bounds& b) { bounds[static_cast<std::size_t>(e)] = b; });
  std::printf("%g seconds\n", std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  for (const Jacobian_bounds& b : bounds)
    std::printf("%d %.17g %.17g\n", static_cast<int>(b.verdict), b.lower, b.reached);
}

} // namespace

int main(int argc, char** argv)
{
  if (argc == 7 && argv[1] == std::string("msh"))
  {
    compare(argv + 2);
    return 0;
  }
  const double duration = argc > 1 ? std::atof(argv[1]) : 0.2;
  const Curving curving = {argc > 2 ? std::atof(argv[2]) : 0.05, argc > 3};
  std::setvbuf(stdout, nullptr, _IOLBF, BUFSIZ); // a line at once, also into a file
  std::printf("%u hardware threads; %s of amplitude %g\n", std::thread::hardware_concurrency(),
              curving.is_noise ? "noise" : "waves", curving.amplitude);
  constexpr Element_type cells[] = {Element_type::tetrahedron, Element_type::pyramid, Element_type::prism,
                                    Element_type::hexahedron};
  for (const Element_type type : cells)
  {
    measure(type, 2, true, curving, duration);
    for (int degree = 1; degree <= max_degree; ++degree)
      measure(type, degree, false, curving, duration);
  }
}
