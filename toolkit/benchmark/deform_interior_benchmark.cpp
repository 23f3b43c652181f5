// Time, error and memory of the interior deformation, next to the plain sum.
//
//   deform_interior_benchmark                              the standard cases
//   deform_interior_benchmark SOURCES TARGETS [BOUND] [THREADS] [GEOMETRY]
//
// Sources are spread over the unit sphere and displaced as by curving (every other one at rest); the influence's length
// is twice their distance. GEOMETRY is where the targets are:
//   layers  in the boundary layer and around: 10^-3 to 10 times the sources' distance off the wall, evenly on a
//           logarithmic scale (as most nodes of a CFD mesh are)
//   log     0.001 to 1 radius off the wall, evenly on a logarithmic scale (default)
//   volume  0.001 to 1 radius off the wall, evenly
// The error is measured at 500 targets against the plain sum, relative to the largest displacement. Times are the
// processor's for one thread and the clock's for more. The environment variable RECURVE_SIMD (baseline, avx2) asks for
// narrower vector instructions than the processor has.
#include <recurve/volume/deform_interior.h>

#include <tbb/global_control.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <numbers>
#include <random>
#include <string>
#include <vector>

namespace {

using namespace recurve;

struct Case
{
  int sources = 100'000;
  int targets = 1'000'000;
  double bound = 1e-4;
  int threads = 1;
  std::string geometry = "log";
};

std::vector<Point> sphere(int n)
{
  std::vector<Point> points(static_cast<std::size_t>(n));
  for (int m = 0; m < n; ++m)
  {
    const double z = 1 - (2 * m + 1.0) / n, r = std::sqrt(1 - z * z);
    const double angle = m * std::numbers::pi * (3 - std::sqrt(5.0));
    points[static_cast<std::size_t>(m)] = {r * std::cos(angle), r * std::sin(angle), z};
  }
  return points;
}

std::vector<Point> curving_field(const std::vector<Point>& points)
{
  std::vector<Point> field(points.size(), Point{0, 0, 0});
  for (std::size_t m = 1; m < points.size(); m += 2)
    for (std::size_t d = 0; d < 3; ++d)
      field[m][d] = points[m][d] * (1 + 0.5 * std::sin(3 * points[m][0]));
  return field;
}

std::vector<Point> targets_off_sphere(const Case& c, double spacing)
{
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform(0, 1);
  std::vector<Point> points(static_cast<std::size_t>(c.targets));
  for (Point& p : points)
  {
    const double u = uniform(random);
    const double off = c.geometry == "layers"   ? spacing * std::pow(10.0, -3 + 4 * u)
                       : c.geometry == "volume" ? 0.001 + 0.999 * u
                                                : std::pow(10.0, -3 + 3 * u);
    const Point direction = {normal(random), normal(random), normal(random)};
    const double factor = (1 + off) / std::hypot(direction[0], direction[1], direction[2]);
    p = {factor * direction[0], factor * direction[1], factor * direction[2]};
  }
  return points;
}

/// seconds, of the processor if only one thread works, so that other programs do not count.
double seconds(bool is_single)
{
  if (is_single)
    return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

void run(const Case& c)
{
  const tbb::global_control control(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(c.threads));
  const double spacing = std::sqrt(4 * std::numbers::pi / c.sources);
  const std::vector<Point> sources = sphere(c.sources), given = curving_field(sources);
  const std::vector<Point> targets = targets_off_sphere(c, spacing);
  const Inverse_distance<> influence(2 * spacing);

  const double start = seconds(c.threads == 1);
  Interior_deformer<> fast(sources, influence, {.method = Summation::fast, .error_bound = c.bound});
  fast.set_displacements(given);
  const double built = seconds(c.threads == 1);
  std::vector<Point> moved(targets.size());
  const Deformation_report report = fast.evaluate(targets, moved);
  const double done = seconds(c.threads == 1);

  Interior_deformer<> plain(sources, influence, {.method = Summation::plain});
  plain.set_displacements(given);
  const std::size_t samples = std::min<std::size_t>(500, targets.size()), step = targets.size() / samples;
  std::vector<Point> sample, exact(samples);
  for (std::size_t m = 0; m < samples; ++m)
    sample.push_back(targets[m * step]);
  const double plain_start = seconds(c.threads == 1);
  plain.evaluate(sample, exact);
  const double plain_seconds = seconds(c.threads == 1) - plain_start;
  double error = 0;
  for (std::size_t m = 0; m < samples; ++m)
  {
    const Point &a = moved[m * step], &b = exact[m];
    error = std::max(error, std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]) / report.largest_given);
  }
  std::printf("%8d %9d  %-7s %6.0e %3d  %7.2f %8.2f %8.2f  %9.2e %10.2e  %7.0f %8.2f  %6.0f  %8.3f\n", c.sources,
              c.targets, c.geometry.c_str(), c.bound, c.threads, built - start, done - built, done - start, error,
              report.error_bound, static_cast<double>(report.pairs) / c.targets,
              static_cast<double>(report.translations) / c.targets, fast.bytes_per_source(),
              1e9 * plain_seconds / (static_cast<double>(samples) * c.sources));
  std::fflush(stdout);
}

} // namespace

int main(int argc, char** argv)
{
  std::printf("%8s %9s  %-7s %6s %3s  %7s %8s %8s  %9s %10s  %7s %8s  %6s  %8s\n", "sources", "targets", "where",
              "bound", "thr", "setup s", "eval s", "total s", "error", "guaranteed", "pairs/t", "transl/t", "B/src",
              "plain ns");
  if (argc > 2)
  {
    Case c;
    c.sources = std::atoi(argv[1]);
    c.targets = std::atoi(argv[2]);
    if (argc > 3)
      c.bound = std::atof(argv[3]);
    if (argc > 4)
      c.threads = std::atoi(argv[4]);
    if (argc > 5)
      c.geometry = argv[5];
    if (c.sources < 1 || c.targets < 1 || c.threads < 1)
    {
      std::fprintf(stderr, "numbers have to be positive\n");
      return 1;
    }
    run(c);
    return 0;
  }
  for (const char* geometry : {"layers", "log", "volume"})
    for (const int sources : {100'000, 400'000})
      run({.sources = sources, .geometry = geometry});
  for (const double bound : {1e-2, 1e-6})
    run({.bound = bound});
  // How it grows with the sources, and with a second thread; the clock tells the time of two.
  for (const int sources : {25'000, 50'000, 200'000, 1'000'000, 4'000'000})
    run({.sources = sources});
  for (const int sources : {100'000, 400'000})
    run({.sources = sources, .threads = 2});
  run({.sources = 1'000'000, .targets = 10'000'000});
  return 0;
}
