// Reads a linear mesh of tetrahedra from CGNS and writes it at degree 2 in each format: seconds, MB/s, how that
// compares with copying the same bytes, and the peak of memory.
//
// usage: mesh_io_benchmark FOLDER [CELLS [DEGREE [FORMAT]]]
//        FOLDER should be on the disk that counts; CELLS: 10000000; DEGREE: 2; FORMAT: CGNS, MSH, ..., else all of them
#include <recurve/io/mesh_io.h>
#include <recurve/mesh/join_zones.h>

#include <fmt/format.h>

#include <fcntl.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <cstdlib>
#include <exception>
#include <fstream>
#include <iostream>
#include <string>

namespace {

using namespace recurve;
namespace fs = std::filesystem;

double now()
{
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// a number of /proc/self/status in bytes.
double memory(const std::string& key)
{
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;)
    if (double kilobytes = 0; word == key + ":" && status >> kilobytes)
      return 1024 * kilobytes;
  return 0;
}

/// lets the peak of memory start again from what is in use now.
void reset_peak()
{
  std::ofstream("/proc/self/clear_refs") << "5";
}

/// a box of n^3 cubes of six tetrahedra each, its six sides the patches.
Volume_mesh box_of_tetrahedra(Index n)
{
  Zone zone;
  zone.name = "box";
  const auto point = [n](Index i, Index j, Index k) { return i + (n + 1) * (j + (n + 1) * k); };
  for (Index k = 0; k <= n; ++k)
    for (Index j = 0; j <= n; ++j)
      for (Index i = 0; i <= n; ++i)
        zone.points.push_back({double(i) / double(n), double(j) / double(n), double(k) / double(n)});
  Section cells{"tetrahedra", Element_type::tetrahedron, {}};
  cells.nodes.reserve(static_cast<std::size_t>(24 * n * n * n));
  // All six share the diagonal of the cube, so that neighbours match.
  constexpr int ways[6][2][3] = {{{1, 0, 0}, {1, 1, 0}}, {{0, 1, 0}, {1, 1, 0}}, {{0, 1, 0}, {0, 1, 1}},
                                 {{0, 0, 1}, {0, 1, 1}}, {{0, 0, 1}, {1, 0, 1}}, {{1, 0, 0}, {1, 0, 1}}};
  for (Index k = 0; k < n; ++k)
    for (Index j = 0; j < n; ++j)
      for (Index i = 0; i < n; ++i)
        for (int w = 0; w < 6; ++w)
        {
          const auto& [a, b] = ways[w];
          const Index first = point(i + a[0], j + a[1], k + a[2]), second = point(i + b[0], j + b[1], k + b[2]);
          const bool is_even = w % 2 == 0;
          cells.nodes.insert(cells.nodes.end(), {point(i, j, k), is_even ? first : second, is_even ? second : first,
                                                 point(i + 1, j + 1, k + 1)});
        }
  zone.cells = {std::move(cells)};
  for (int side = 0; side < 2; ++side)
  {
    Section faces{side == 0 ? "bottom" : "top", Element_type::triangle, {}};
    const Index k = side == 0 ? 0 : n;
    for (Index j = 0; j < n; ++j)
      for (Index i = 0; i < n; ++i)
        faces.nodes.insert(faces.nodes.end(), {point(i, j, k), point(i + 1, j, k), point(i + 1, j + 1, k),
                                               point(i, j, k), point(i + 1, j + 1, k), point(i, j + 1, k)});
    Patch patch{faces.name, "BCWall", "", {}};
    for (Index face = 0; face < faces.size(); ++face)
      patch.faces.push_back(zone.face_count() + face);
    zone.faces.push_back(std::move(faces));
    zone.patches.push_back(std::move(patch));
  }
  Volume_mesh mesh;
  mesh.zones.push_back(std::move(zone));
  return mesh;
}

/// copies a file as `cp` does, to the disk.
double copy_time(const fs::path& from, const fs::path& to)
{
  const double start = now();
  const int in = ::open(from.c_str(), O_RDONLY), out = ::open(to.c_str(), O_CREAT | O_TRUNC | O_WRONLY, 0666);
  std::string buffer(std::size_t{1} << 20, '\0');
  for (ssize_t count = 0; (count = ::read(in, buffer.data(), buffer.size())) > 0;)
    if (::write(out, buffer.data(), static_cast<std::size_t>(count)) != count)
      throw std::runtime_error("the copy cannot be written");
  ::fsync(out);
  ::close(in);
  ::close(out);
  const double seconds = now() - start;
  fs::remove(to);
  return seconds;
}

/// bytes of the coordinates and connectivity that are written: what the mesh cannot do without.
double array_bytes(const Curved_mesh& mesh)
{
  double bytes = 24 * static_cast<double>(mesh.nodes.size());
  for (const Curved_zone& zone : mesh.zones)
    for (const auto* sections : {&zone.cells, &zone.faces})
      for (const Curved_section& section : *sections)
        bytes += 8 * static_cast<double>(section.nodes.size());
  return bytes;
}

void tell(const std::string& what, double seconds, const fs::path& file, double copy)
{
  const double megabytes = static_cast<double>(fs::file_size(file)) / 1e6;
  fmt::print("{:24} {:8.2f} s {:9.1f} MB {:8.0f} MB/s  copy {:7.2f} s, times {:5.2f}  peak {:7.0f} MB\n", what, seconds,
             megabytes, megabytes / seconds, copy, seconds / copy, memory("VmHWM") / 1e6);
  std::cout.flush();
}

void run(const fs::path& folder, Index cells, int degree, const std::string& only)
{
  const auto n = static_cast<Index>(std::lround(std::cbrt(static_cast<double>(cells) / 6)));
  fs::create_directories(folder);
  const fs::path input = folder / "linear.cgns", copy = folder / "copy";
  {
    Volume_mesh linear = box_of_tetrahedra(n);
    const Joined_zones joined = join_zones(linear);
    write_mesh(elevate(std::move(linear), joined, 1), input);
  }
  const double input_copy = copy_time(input, copy);
  reset_peak();
  double start = now();
  Volume_mesh linear = read_mesh(input);
  tell("read CGNS, linear", now() - start, input, input_copy);
  start = now();
  const Joined_zones joined = join_zones(linear);
  const Curved_mesh mesh = elevate(std::move(linear), joined, degree);
  const double count = static_cast<double>(mesh.cell_count()), arrays = array_bytes(mesh);
  fmt::print("{} cells raised to degree {} in {:.2f} s: {} nodes, arrays of {:.0f} MB, in use {:.0f} MB\n",
             mesh.cell_count(), degree, now() - start, mesh.nodes.size(), arrays / 1e6, memory("VmRSS") / 1e6);
  double peak = memory("VmHWM");
  for (const Mesh_format& format : mesh_formats())
  {
    if (format.largest_degree_written < degree || !format.read || (!only.empty() && format.name != only))
      continue;
    const fs::path file = folder / ("curved" + format.extensions.front());
    reset_peak();
    start = now();
    write_mesh(mesh, file);
    const double seconds = now() - start;
    tell("write " + format.name, seconds, file, copy_time(file, copy));
    if (format.name != "HOPR") // which is not made for meshes of this size: it lists every node once per cell
      peak = std::max(peak, memory("VmHWM"));
    if (format.largest_degree_read < degree)
      continue;
    start = now();
    const Curved_mesh back = read_curved_mesh(file);
    const double read_seconds = now() - start;
    tell("read " + format.name, read_seconds, file, copy_time(file, copy));
    fs::remove(file);
  }
  fs::remove(input);
  const double allowed = 1.5 * arrays + 250 * count;
  fmt::print("peak of reading and writing: {:.0f} MB; 1.5 times the arrays and 250 bytes per cell: {:.0f} MB\n",
             peak / 1e6, allowed / 1e6);
}

} // namespace

int main(int argc, char** argv)
try
{
  if (argc < 2)
    return 1;
  run(argv[1], argc > 2 ? std::atoll(argv[2]) : 10000000, argc > 3 ? std::atoi(argv[3]) : 2, argc > 4 ? argv[4] : "");
}
catch (const std::exception& error)
{
  std::cerr << error.what() << '\n';
  return 2;
}
