#include <recurve/run/list_features.h>

#include "json.h"
#include "surface_passes.h"

#include <recurve/core/exceptions.h>
#include <recurve/io/pending_file.h>
#include <recurve/run/curve_mesh.h>
#include <recurve/run/mesh_structure.h>
#include <recurve/run/select_patches.h>

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <set>
#include <utility>

namespace recurve {

namespace {

/// the ends of the edges of a curve, in their order.
std::vector<std::pair<Point, Point>> edges_of(const Listed_curve& curve)
{
  std::vector<std::pair<Point, Point>> edges;
  for (std::size_t i = 0; i + 1 < curve.points.size(); ++i)
    edges.emplace_back(curve.points[i], curve.points[i + 1]);
  if (curve.is_closed)
    edges.emplace_back(curve.points.back(), curve.points.front());
  return edges;
}

/// An element of VTK's XML: an array of 64-bit integers.
std::string integers(std::string_view name, const std::vector<Index>& values)
{
  std::string text = fmt::format("        <DataArray type=\"Int64\" Name=\"{}\" format=\"ascii\">\n", name);
  for (const Index value : values)
    fmt::format_to(std::back_inserter(text), "{}\n", value);
  return text + "        </DataArray>\n";
}

} // namespace

Feature_listing list_features(Volume_mesh mesh, const Curving_options& options, const Progress_callback& progress)
{
  check(options);
  Curving_report report;
  Mesh_structure structure = find_structure(mesh, options.join, report.stages, progress);
  Boundary_surface surface = run_stage("make surface", report.stages, progress, [&] {
    const Face_selection selection = select_patches(mesh, structure.boundary, options.curve, options.keep);
    return make_boundary_surface(mesh, structure.joined, structure.boundary, selection);
  });
  find_features(surface, mesh, structure.joined, options, report, progress);
  Feature_listing listing;
  run_stage("list curves", report.stages, progress, [&] {
    list_curves(surface, mesh, options.feature_edits ? options.feature_edits->options : Feature_edit_options{},
                listing);
  });
  listing.report = std::move(report.features);
  return listing;
}

std::string to_csv(const Feature_listing& listing)
{
  std::string text = "x1,y1,z1,x2,y2,z2,curve\n";
  std::set<std::pair<Point, Point>> listed;
  for (std::size_t i = 0; i < listing.curves.size(); ++i)
    for (const auto& [a, b] : edges_of(listing.curves[i]))
      if (listed.insert(std::minmax(a, b)).second)
        fmt::format_to(std::back_inserter(text), "{:.17g},{:.17g},{:.17g},{:.17g},{:.17g},{:.17g},{}\n", a[0], a[1],
                       a[2], b[0], b[1], b[2], i);
  return text;
}

std::string to_json(const Feature_listing& listing)
{
  Json json = json_of(listing.report);
  for (std::size_t i = 0; i < listing.curves.size(); ++i)
    json["curves"][i]["patches"] = listing.curves[i].patches;
  return json_text(json);
}

std::string to_vtp(const Feature_listing& listing)
{
  std::vector<Point> points = listing.sharp_points;
  std::vector<Index> vertices, vertex_ends, line_points, line_ends, curve, is_closed;
  for (std::size_t i = 0; i < listing.sharp_points.size(); ++i)
  {
    vertices.push_back(static_cast<Index>(i));
    vertex_ends.push_back(static_cast<Index>(i) + 1);
    curve.push_back(-1);
    is_closed.push_back(0);
  }
  for (std::size_t i = 0; i < listing.curves.size(); ++i)
  {
    const Listed_curve& listed = listing.curves[i];
    const auto first = static_cast<Index>(points.size());
    for (std::size_t j = 0; j < listed.points.size(); ++j)
      line_points.push_back(first + static_cast<Index>(j));
    if (listed.is_closed)
      line_points.push_back(first);
    points.insert(points.end(), listed.points.begin(), listed.points.end());
    line_ends.push_back(static_cast<Index>(line_points.size()));
    curve.push_back(static_cast<Index>(i));
    is_closed.push_back(listed.is_closed);
  }
  std::string text = fmt::format(
    "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\" "
    "header_type=\"UInt64\">\n  <PolyData>\n    <Piece NumberOfPoints=\"{}\" NumberOfVerts=\"{}\" NumberOfLines=\"{}\" "
    "NumberOfStrips=\"0\" NumberOfPolys=\"0\">\n      <Points>\n        <DataArray type=\"Float64\" "
    "NumberOfComponents=\"3\" format=\"ascii\">\n",
    points.size(), vertices.size(), line_ends.size());
  for (const Point& p : points)
    fmt::format_to(std::back_inserter(text), "{:.17g} {:.17g} {:.17g}\n", p[0], p[1], p[2]);
  text += "        </DataArray>\n      </Points>\n      <Verts>\n" + integers("connectivity", vertices) +
          integers("offsets", vertex_ends) + "      </Verts>\n      <Lines>\n" + integers("connectivity", line_points) +
          integers("offsets", line_ends) + "      </Lines>\n      <CellData Scalars=\"curve\">\n" +
          integers("curve", curve) + integers("is_closed", is_closed) +
          "      </CellData>\n    </Piece>\n  </PolyData>\n</VTKFile>\n";
  return text;
}

void check_feature_extension(const std::filesystem::path& file)
{
  const std::string extension = file.extension().string();
  if (extension != ".toml" && extension != ".csv" && extension != ".vtp")
    throw Input_error(fmt::format("{}: features are written as .toml, .csv or .vtp", file.string()));
}

void write_features(const Feature_listing& listing, const std::filesystem::path& file)
{
  check_feature_extension(file);
  const std::string extension = file.extension().string();
  Pending_file pending(file);
  std::ofstream stream(pending.path(), std::ios::binary);
  stream << (extension == ".toml" ? to_toml(listing.file) : extension == ".csv" ? to_csv(listing) : to_vtp(listing));
  stream.close();
  if (!stream)
    throw Format_error(fmt::format("{}: cannot be written", file.string()));
  pending.commit();
}

} // namespace recurve
