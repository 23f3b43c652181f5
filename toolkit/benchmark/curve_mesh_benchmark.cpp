// Seconds per stage and peak memory of a whole conversion, from CGNS to CGNS: tetrahedra between two spheres.
//
//   curve_mesh_benchmark                     1,036,800 tetrahedra, degree 2
//   curve_mesh_benchmark 129 17 2            36 n^2 layers tetrahedra (here 10 million) for n, layers, degree
#include "support/sphere_shell.h"

#include <recurve/io/mesh_io.h>
#include <recurve/run/curve_mesh.h>

#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>

namespace {

using namespace recurve;
namespace fs = std::filesystem;

void write_straight_mesh(int cells_per_side, int layers, const fs::path& file)
{
  Volume_mesh mesh = test::sphere_shell({cells_per_side, layers, Element_type::tetrahedron, test::Outer_shape::sphere});
  const Joined_zones joined = join_zones(mesh);
  write_mesh(elevate(std::move(mesh), joined, 1), file);
}

/// makes the input in a process of its own, so that it does not count as memory of the conversion.
bool write_straight_mesh_aside(int cells_per_side, int layers, const fs::path& file)
{
  const pid_t child = fork();
  if (child == 0)
  {
    write_straight_mesh(cells_per_side, layers, file);
    std::_Exit(0);
  }
  int status = 1;
  return child > 0 && waitpid(child, &status, 0) == child && status == 0;
}

Curving_report convert(const fs::path& input, const fs::path& output, int degree)
{
  std::vector<Stage_time> read_time;
  Volume_mesh linear = run_stage("read", read_time, {}, [&] { return read_mesh(input); });
  Curving_report report;
  const Curved_mesh curved = curve_mesh(std::move(linear), {.degree = degree}, &report);
  run_stage("write", report.stages, {}, [&] { write_mesh(curved, output); });
  report.stages.insert(report.stages.begin(), read_time.begin(), read_time.end());
  report.peak_memory_bytes = peak_memory_bytes();
  return report;
}

} // namespace

int main(int argc, char** argv)
try
{
  const int cells_per_side = argc > 1 ? std::atoi(argv[1]) : 60;
  const int layers = argc > 2 ? std::atoi(argv[2]) : 8;
  const int degree = argc > 3 ? std::atoi(argv[3]) : 2;
  const fs::path folder = fs::temp_directory_path() / ("recurve_benchmark_" + std::to_string(getpid()));
  fs::create_directories(folder);
  if (!write_straight_mesh_aside(cells_per_side, layers, folder / "straight.cgns"))
    return 1;

  const Curving_report report = convert(folder / "straight.cgns", folder / "curved.cgns", degree);
  const auto cells = static_cast<double>(report.cells);
  std::printf("%lld tetrahedra, degree %d, %lld surface faces\n", static_cast<long long>(report.cells), degree,
              static_cast<long long>(report.surface.faces));
  double total = 0;
  for (const Stage_time& stage : report.stages)
  {
    total += stage.seconds;
    std::printf("  %-22s %8.2f s  %7.0f ns/cell\n", stage.stage.c_str(), stage.seconds, 1e9 * stage.seconds / cells);
  }
  std::printf("  %-22s %8.2f s  %7.0f ns/cell\n", "all", total, 1e9 * total / cells);
  std::printf("  peak memory %.0f MiB, %.0f bytes/cell\n", static_cast<double>(report.peak_memory_bytes) / 1048576,
              static_cast<double>(report.peak_memory_bytes) / cells);
  fs::remove_all(folder);
}
catch (const std::exception& error)
{
  std::fprintf(stderr, "curve_mesh_benchmark: %s\n", error.what());
  return 1;
}
