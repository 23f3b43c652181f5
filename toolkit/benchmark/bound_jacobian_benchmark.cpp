// Cells certified per second, by type and degree, straight and curved, and what a second thread brings.
//
//   bound_jacobian_benchmark              random curved cells, 0.2 s or more per line
//   bound_jacobian_benchmark 2 0.08       seconds per line; random displacement of nodes relative to their distance
//
// The environment variable RECURVE_SIMD (baseline, avx2) asks for narrower vector instructions than the processor has.
#include <recurve/elements/node_layout.h>
#include <recurve/volume/bound_jacobian.h>

#include <tbb/global_control.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <random>
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

/// cells that share no nodes: the reference cell stretched, each node displaced at random.
Cells random_cells(Element_type type, int degree, int count, double displacement)
{
  std::mt19937 random(7);
  std::uniform_real_distribution<double> uniform(-1, 1);
  Cells cells;
  for (int c = 0; c < count; ++c)
    for (const Lattice_point& l : canonical_nodes(type, degree))
    {
      Point p;
      for (std::size_t d = 0; d < 3; ++d)
        p[d] = (l[d] + displacement * uniform(random)) / degree + c;
      cells.numbers.push_back(static_cast<Index>(cells.nodes.size()));
      cells.nodes.push_back(p);
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

void measure(Element_type type, int degree, bool is_straight, double displacement, double duration)
{
  const int count = std::clamp(40000000 / (node_count(type, degree) * node_count(type, degree)), 256, 200000);
  const Cells cells = random_cells(type, degree, count, displacement);
  Jacobian_report report;
  const double one = best_seconds(cells, type, degree, is_straight, 1, duration, report);
  const double two = best_seconds(cells, type, degree, is_straight, 2, duration, report);
  std::printf("%-12s p=%d %-8s %10.0f cells/s  %9.2f us  2 threads: %4.2f times  valid %5.1f %%, subdivided %5.1f %%, exact %.1f %%\n",
              std::string(element_name(type)).c_str(), degree, is_straight ? "straight" : "curved", count / one,
              1e6 * one / count, one / two, 100.0 * static_cast<double>(report.total().valid) / count,
              100.0 * static_cast<double>(report.subdivided_elements) / count,
              100.0 * static_cast<double>(report.exact_elements) / count);
}

} // namespace

int main(int argc, char** argv)
{
  const double duration = argc > 1 ? std::atof(argv[1]) : 0.2;
  const double displacement = argc > 2 ? std::atof(argv[2]) : 0.05;
  std::setvbuf(stdout, nullptr, _IOLBF, BUFSIZ); // a line at once, also into a file
  std::printf("%u hardware threads; nodes displaced by up to %g of their distance\n",
              std::thread::hardware_concurrency(), displacement);
  constexpr Element_type cells[] = {Element_type::tetrahedron, Element_type::pyramid, Element_type::prism,
                                    Element_type::hexahedron};
  for (const Element_type type : cells)
  {
    measure(type, 2, true, displacement, duration);
    for (int degree = 1; degree <= max_degree; ++degree)
      measure(type, degree, false, displacement, duration);
  }
}
