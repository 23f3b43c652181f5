#include <recurve/io/surface_files.h>

#include "binary_output.h"

#include <recurve/core/exceptions.h>
#include <recurve/elements/node_layout.h>

#include <fmt/format.h>

#include <array>
#include <limits>
#include <map>
#include <span>
#include <string>
#include <vector>

namespace recurve {

namespace {

/// A straight piece of a face: its corners as canonical nodes of the face; a triangle's fourth is -1.
using Piece = std::array<int, 4>;

/// the p^2 pieces of a face, each the same way round as the face.
std::vector<Piece> pieces_of(Element_type type, int degree)
{
  std::map<std::array<int, 2>, int> node_at;
  for (const Lattice_point& lattice : canonical_nodes(type, degree))
    node_at.emplace(std::array{lattice[0], lattice[1]}, static_cast<int>(node_at.size()));
  std::vector<Piece> pieces;
  for (int j = 0; j < degree; ++j)
    for (int i = 0; i < (type == Element_type::triangle ? degree - j : degree); ++i)
    {
      const int a = node_at.at({i, j}), b = node_at.at({i + 1, j}), d = node_at.at({i, j + 1});
      if (type == Element_type::quadrangle)
      {
        pieces.push_back({a, b, node_at.at({i + 1, j + 1}), d});
        continue;
      }
      pieces.push_back({a, b, d, -1});
      if (i + j + 1 < degree)
        pieces.push_back({b, node_at.at({i + 1, j + 1}), d, -1});
    }
  return pieces;
}

/// The faces of all patches, their nodes numbered anew.
class Surface
{
public:
  explicit Surface(const Curved_mesh& mesh) : mesh_(mesh), number_(mesh.nodes.size(), no_index)
  {
    name_patches();
    visit_faces([&](Element_type, std::span<const Index> nodes, std::int32_t) {
      for (const Index node : nodes)
        number_[static_cast<std::size_t>(node)] = 0;
    });
    for (Index& number : number_)
      if (number == 0)
        number = node_count_++;
    visit_pieces([&](std::span<const Index> corners, std::int32_t) {
      ++piece_count_;
      corner_count_ += static_cast<Index>(corners.size());
    });
    if (piece_count_ == 0)
      throw Input_error("the mesh has no patches with faces: there is no surface to write");
  }

  Index node_count() const { return node_count_; }
  Index piece_count() const { return piece_count_; }
  Index corner_count() const { return corner_count_; }
  const std::vector<std::string>& patch_names() const { return names_; }

  template <class Visit>
  void visit_nodes(const Visit& visit) const
  {
    for (std::size_t node = 0; node < number_.size(); ++node)
      if (number_[node] != no_index)
        visit(mesh_.nodes[node]);
  }

  /// calls visit(numbers of three or four nodes, number of the patch).
  template <class Visit>
  void visit_pieces(const Visit& visit) const
  {
    const std::array<std::vector<Piece>, 2> pieces = {pieces_of(Element_type::triangle, mesh_.degree),
                                                      pieces_of(Element_type::quadrangle, mesh_.degree)};
    visit_faces([&](Element_type type, std::span<const Index> nodes, std::int32_t patch) {
      const std::size_t corners = type == Element_type::triangle ? 3 : 4;
      for (const Piece& piece : pieces[corners - 3])
      {
        std::array<Index, 4> numbers = {};
        for (std::size_t c = 0; c < corners; ++c)
          numbers[c] = number_[static_cast<std::size_t>(nodes[static_cast<std::size_t>(piece[c])])];
        visit(std::span<const Index>(numbers).first(corners), patch);
      }
    });
  }

private:
  void name_patches()
  {
    std::map<std::string, std::int32_t> numbers;
    for (const Zone& zone : mesh_.linear.zones)
    {
      std::vector<std::int32_t>& patch_of =
        patch_of_face_.emplace_back(static_cast<std::size_t>(zone.face_count()), -1);
      for (const Patch& patch : zone.patches)
      {
        const auto [entry, is_new] = numbers.try_emplace(patch.name, static_cast<std::int32_t>(names_.size()));
        if (is_new)
          names_.push_back(patch.name);
        for (const Index face : patch.faces)
          patch_of[static_cast<std::size_t>(face)] = entry->second;
      }
    }
  }

  template <class Visit>
  void visit_faces(const Visit& visit) const
  {
    for (std::size_t z = 0; z < mesh_.zones.size(); ++z)
    {
      std::size_t face = 0;
      for (const Curved_section& section : mesh_.zones[z].faces)
      {
        const auto width = static_cast<std::size_t>(recurve::node_count(section.type, mesh_.degree));
        for (std::size_t first = 0; first < section.nodes.size(); first += width, ++face)
          if (const std::int32_t patch = patch_of_face_[z][face]; patch >= 0)
            visit(section.type, std::span(section.nodes).subspan(first, width), patch);
      }
    }
  }

  const Curved_mesh& mesh_;
  std::vector<std::vector<std::int32_t>> patch_of_face_; ///< per zone
  std::vector<std::string> names_;
  std::vector<Index> number_; ///< per node of the mesh; no_index: on no patch
  Index node_count_ = 0, piece_count_ = 0, corner_count_ = 0;
};

std::string one_line(std::string text)
{
  for (char& character : text)
    if (static_cast<unsigned char>(character) < 32)
      character = ' ';
  return text;
}

} // namespace

void write_off(const Curved_mesh& mesh, const std::filesystem::path& file, const Progress_callback& progress)
{
  const Surface surface(mesh);
  report_progress(progress, "write", 0);
  Binary_output out(file);
  out.put_text(fmt::format("OFF\n{} {} 0\n", surface.node_count(), surface.piece_count()));
  surface.visit_nodes([&](const Point& x) { out.put_text(fmt::format("{} {} {}\n", x[0], x[1], x[2])); });
  surface.visit_pieces([&](std::span<const Index> corners, std::int32_t) {
    std::string line = fmt::format("{}", corners.size());
    for (const Index corner : corners)
      fmt::format_to(std::back_inserter(line), " {}", corner);
    out.put_text(line + "\n");
  });
  out.close();
  report_progress(progress, "write", 1);
}

void write_ply(const Curved_mesh& mesh, const std::filesystem::path& file, const Progress_callback& progress)
{
  const Surface surface(mesh);
  if (surface.node_count() > std::numeric_limits<std::int32_t>::max())
    throw Input_error(fmt::format("PLY counts with 32 bits: {} nodes are more than it can hold", surface.node_count()));
  report_progress(progress, "write", 0);
  Binary_output out(file);
  out.put_text("ply\nformat binary_little_endian 1.0\n");
  for (std::size_t p = 0; p < surface.patch_names().size(); ++p)
    out.put_text(fmt::format("comment patch {} {}\n", p, one_line(surface.patch_names()[p])));
  out.put_text(fmt::format("element vertex {}\nproperty double x\nproperty double y\nproperty double z\n"
                           "element face {}\nproperty list uchar int vertex_indices\nproperty int patch\nend_header\n",
                           surface.node_count(), surface.piece_count()));
  surface.visit_nodes([&](const Point& x) {
    for (const double coordinate : x)
      out.put(coordinate);
  });
  surface.visit_pieces([&](std::span<const Index> corners, std::int32_t patch) {
    out.put(static_cast<std::uint8_t>(corners.size()));
    for (const Index corner : corners)
      out.put(static_cast<std::int32_t>(corner));
    out.put(patch);
  });
  out.close();
  report_progress(progress, "write", 1);
}

void write_vtp(const Curved_mesh& mesh, const std::filesystem::path& file, const Progress_callback& progress)
{
  const Surface surface(mesh);
  report_progress(progress, "write", 0);
  std::string names;
  for (const std::string& name : surface.patch_names())
  {
    for (const char character : name)
      fmt::format_to(std::back_inserter(names), "{} ", static_cast<int>(static_cast<unsigned char>(character)));
    names += "0 ";
  }
  const std::array<std::uint64_t, 4> bytes = {
    24 * static_cast<std::uint64_t>(surface.node_count()), 8 * static_cast<std::uint64_t>(surface.corner_count()),
    8 * static_cast<std::uint64_t>(surface.piece_count()), 4 * static_cast<std::uint64_t>(surface.piece_count())};
  std::array<std::uint64_t, 4> offset = {};
  for (std::size_t m = 1; m < offset.size(); ++m)
    offset[m] = offset[m - 1] + sizeof(std::uint64_t) + bytes[m - 1];
  Binary_output out(file);
  out.put_text(fmt::format(
    "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" version=\"2.2\" byte_order=\"LittleEndian\" "
    "header_type=\"UInt64\">\n<PolyData>\n<FieldData>\n<DataArray type=\"String\" Name=\"patch_names\" "
    "NumberOfTuples=\"{}\" format=\"ascii\">{}</DataArray>\n</FieldData>\n"
    "<Piece NumberOfPoints=\"{}\" NumberOfVerts=\"0\" NumberOfLines=\"0\" NumberOfStrips=\"0\" NumberOfPolys=\"{}\">\n"
    "<Points>\n<DataArray type=\"Float64\" NumberOfComponents=\"3\" format=\"appended\" offset=\"{}\"/>\n</Points>\n"
    "<Polys>\n<DataArray type=\"Int64\" Name=\"connectivity\" format=\"appended\" offset=\"{}\"/>\n"
    "<DataArray type=\"Int64\" Name=\"offsets\" format=\"appended\" offset=\"{}\"/>\n</Polys>\n"
    "<CellData Scalars=\"patch\">\n<DataArray type=\"Int32\" Name=\"patch\" format=\"appended\" offset=\"{}\"/>\n"
    "</CellData>\n</Piece>\n</PolyData>\n<AppendedData encoding=\"raw\">\n_",
    surface.patch_names().size(), names, surface.node_count(), surface.piece_count(), offset[0], offset[1], offset[2],
    offset[3]));
  out.put(bytes[0]);
  surface.visit_nodes([&](const Point& x) {
    for (const double coordinate : x)
      out.put(coordinate);
  });
  out.put(bytes[1]);
  surface.visit_pieces([&](std::span<const Index> corners, std::int32_t) {
    for (const Index corner : corners)
      out.put(static_cast<std::int64_t>(corner));
  });
  out.put(bytes[2]);
  std::int64_t end = 0;
  surface.visit_pieces(
    [&](std::span<const Index> corners, std::int32_t) { out.put(end += static_cast<std::int64_t>(corners.size())); });
  out.put(bytes[3]);
  surface.visit_pieces([&](std::span<const Index>, std::int32_t patch) { out.put(patch); });
  out.put_text("\n</AppendedData>\n</VTKFile>\n");
  out.close();
  report_progress(progress, "write", 1);
}

} // namespace recurve
