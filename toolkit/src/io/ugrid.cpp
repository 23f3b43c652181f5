#include <recurve/io/ugrid.h>

#include "grouped_mesh.h"
#include "input_file.h"

#include <recurve/core/exceptions.h>

#include <fmt/format.h>

#include <array>
#include <bit>
#include <cmath>
#include <fstream>
#include <map>
#include <new>
#include <sstream>

namespace recurve {

namespace {

namespace fs = std::filesystem;
using internal::Grouped_mesh;
using internal::Input_file;

/// How the numbers of a file stand there.
struct Encoding
{
  bool is_binary = false;
  bool is_little = false;
  bool is_single = false; ///< coordinates of 4 bytes
};

Encoding encoding_of(const fs::path& file)
{
  const std::string suffix = file.stem().extension().string();
  if (suffix == ".b8" || suffix == ".b4" || suffix == ".lb8" || suffix == ".lb4")
    return {true, suffix[1] == 'l', suffix.back() == '4'};
  if (suffix == ".r8" || suffix == ".r4" || suffix == ".lr8" || suffix == ".lr4")
    throw Format_error(fmt::format("{}: Fortran records ({}) are not read, only {}", file.string(), suffix,
                                   ".b8.ugrid, .b4.ugrid, .lb8.ugrid, .lb4.ugrid and text (.ugrid)"));
  return {};
}

/// A kind of element in the order of the file, and where each of its corners stands there.
struct Ugrid_type
{
  Element_type type;
  std::array<int, 8> place;
};

constexpr std::array<Ugrid_type, 6> types = {{{Element_type::triangle, {0, 1, 2}},
                                              {Element_type::quadrangle, {0, 1, 2, 3}},
                                              {Element_type::tetrahedron, {0, 1, 2, 3}},
                                              // The apex is the third node: base 1 0 3 4.
                                              {Element_type::pyramid, {1, 0, 3, 4, 2}},
                                              {Element_type::prism, {0, 1, 2, 3, 4, 5}},
                                              {Element_type::hexahedron, {0, 1, 2, 3, 4, 5, 6, 7}}}};

/// What FUN3D's .mapbc file says of a surface.
struct Surface_name
{
  std::string name, kind;
};

/// the kind of boundary condition of FUN3D's number, as far as it is plain.
std::string kind_of(int number)
{
  switch (number / 1000)
  {
  case 3: return "BCWallInviscid";
  case 4: return "BCWallViscous";
  case 5: return "BCFarfield";
  case 6: return number >= 6660 && number <= 6669 ? "BCSymmetryPlane" : "BCTypeUserDefined";
  default: return "BCTypeUserDefined";
  }
}

/// reads name.mapbc: the number of surfaces, then per surface its number, its boundary condition and maybe a name.
std::map<Index, Surface_name> read_mapbc(const fs::path& ugrid)
{
  fs::path file = ugrid.stem();
  if (encoding_of(ugrid).is_binary)
    file = file.stem();
  file = ugrid.parent_path() / (file.string() + ".mapbc");
  std::map<Index, Surface_name> names;
  std::ifstream stream(file);
  std::string line;
  std::getline(stream, line);
  while (std::getline(stream, line))
  {
    std::istringstream words(line);
    Index surface = 0;
    int condition = 0;
    std::string name;
    if (words >> surface >> condition)
    {
      words >> name;
      names[surface] = {name, kind_of(condition)};
    }
  }
  return names;
}

class Ugrid_reader
{
public:
  Ugrid_reader(const fs::path& file, const Progress_callback& progress)
    : path_(file), encoding_(encoding_of(file)), in_(file, progress)
  {
    if (encoding_.is_binary)
      in_.set_binary(encoding_.is_little != (std::endian::native == std::endian::little));
  }

  Zonal_mesh read(Read_report* report)
  {
    read_counts();
    read_points();
    std::array<std::vector<Index>, 6> elements;
    for (std::size_t t = 0; t < 2; ++t)
      elements[t] = read_elements(t);
    const std::vector<Index> tags = read_tags();
    for (std::size_t t = 2; t < types.size(); ++t)
      elements[t] = read_elements(t);
    add_faces(elements, tags);
    for (std::size_t t = 2; t < types.size(); ++t)
      if (!elements[t].empty())
        mesh_.cells.push_back({0, std::string(element_name(types[t].type)), types[t].type, std::move(elements[t])});
    if (mesh_.cells.empty())
      in_.fail("has no cells: a surface, not a volume mesh");
    mesh_.zone_names = {"zone"};
    std::vector<std::string> notes;
    Zonal_mesh result = to_zonal_mesh(std::move(mesh_), notes);
    if (report != nullptr)
      report->notes.insert(report->notes.end(), notes.begin(), notes.end());
    return result;
  }

private:
  Index get_integer(std::string_view what)
  {
    return encoding_.is_binary ? in_.read<std::int32_t>() : in_.parse<Index>(what);
  }

  double get_real(std::string_view what)
  {
    if (!encoding_.is_binary)
      return in_.parse<double>(what);
    return encoding_.is_single ? in_.read<float>() : in_.read<double>();
  }

  void read_counts()
  {
    point_count_ = get_integer("the number of nodes");
    for (Index& count : counts_)
      count = get_integer("a number of elements");
    for (const Index count : {point_count_, counts_[0], counts_[1], counts_[2], counts_[3], counts_[4], counts_[5]})
      if (count < 0 || count > (Index(1) << 40)) // no file is that long; what follows does not overflow
        in_.fail(fmt::format("states {} nodes or elements: no UGRID file, or of another byte order", count));
    // A number takes two bytes of text at least.
    const Index bytes = encoding_.is_binary ? 4 : 2;
    Index numbers = 3 * point_count_ * (encoding_.is_binary && !encoding_.is_single ? 2 : 1) + counts_[0] + counts_[1];
    for (std::size_t t = 0; t < types.size(); ++t)
      numbers += counts_[t] * corner_count(types[t].type);
    // The blank after the last number may be missing.
    in_.check_count(static_cast<std::uint64_t>(std::max<Index>(0, numbers * bytes - 1)), 1,
                    "bytes of the nodes and elements that the file states");
  }

  void read_points()
  {
    mesh_.nodes.resize(static_cast<std::size_t>(point_count_));
    for (std::size_t m = 0; m < mesh_.nodes.size(); ++m)
      for (std::size_t axis = 0; axis < 3; ++axis)
      {
        const double x = mesh_.nodes[m][axis] = get_real("a coordinate");
        if (!std::isfinite(x))
          in_.fail(fmt::format("node {}: coordinate {} is {}", m + 1, "XYZ"[axis], x));
      }
  }

  std::vector<Index> read_elements(std::size_t t)
  {
    const auto corners = static_cast<std::size_t>(corner_count(types[t].type));
    std::vector<Index> nodes;
    nodes.reserve(static_cast<std::size_t>(counts_[t]) * corners);
    std::array<Index, 8> own = {};
    for (Index element = 0; element < counts_[t]; ++element)
    {
      for (std::size_t c = 0; c < corners; ++c)
      {
        own[c] = get_integer("the number of a node") - 1;
        if (own[c] < 0 || own[c] >= point_count_)
          in_.fail(fmt::format("{} {}: node {} is number {}, outside 1..{}", element_name(types[t].type), element + 1,
                               c + 1, own[c] + 1, point_count_));
      }
      for (std::size_t c = 0; c < corners; ++c)
        nodes.push_back(own[static_cast<std::size_t>(types[t].place[c])]);
    }
    return nodes;
  }

  std::vector<Index> read_tags()
  {
    std::vector<Index> tags;
    tags.reserve(static_cast<std::size_t>(counts_[0] + counts_[1]));
    for (Index face = 0; face < counts_[0] + counts_[1]; ++face)
      tags.push_back(get_integer("the number of a surface"));
    return tags;
  }

  /// makes one section and patch of the triangles and one section of the quadrangles of each surface.
  void add_faces(const std::array<std::vector<Index>, 6>& elements, const std::vector<Index>& tags)
  {
    std::map<Index, std::array<std::vector<Index>, 2>> surfaces;
    std::size_t face = 0;
    for (std::size_t t = 0; t < 2; ++t)
      for (std::size_t first = 0; first < elements[t].size(); ++face)
      {
        std::vector<Index>& nodes = surfaces[tags[face]][t];
        const auto corners = static_cast<std::size_t>(corner_count(types[t].type));
        nodes.insert(nodes.end(), elements[t].begin() + static_cast<std::ptrdiff_t>(first),
                     elements[t].begin() + static_cast<std::ptrdiff_t>(first + corners));
        first += corners;
      }
    const std::map<Index, Surface_name> names = read_mapbc(path_);
    std::map<std::string, int> uses;
    for (const auto& [tag, nodes] : surfaces)
      if (const auto found = names.find(tag); found != names.end())
        ++uses[found->second.name];
    for (auto& [tag, nodes] : surfaces)
    {
      Patch patch = {.name = fmt::format("surface_{}", tag), .kind = "BCTypeUserDefined", .family = {}, .faces = {}};
      if (const auto found = names.find(tag); found != names.end())
      {
        patch.kind = found->second.kind;
        if (const std::string& name = found->second.name; !name.empty())
          patch.name = uses[name] == 1 ? name : fmt::format("{}_{}", name, tag);
      }
      const bool has_both = !nodes[0].empty() && !nodes[1].empty();
      for (std::size_t t = 0; t < 2; ++t)
        if (!nodes[t].empty())
          mesh_.faces.push_back({static_cast<Index>(mesh_.patches.size()),
                                 has_both ? fmt::format("{}_{}", patch.name, element_name(types[t].type)) : patch.name,
                                 types[t].type, std::move(nodes[t])});
      mesh_.patches.push_back(std::move(patch));
    }
  }

  fs::path path_;
  Encoding encoding_;
  Input_file in_;
  Grouped_mesh mesh_;
  Index point_count_ = 0;
  std::array<Index, 6> counts_ = {};
};

} // namespace

Zonal_mesh read_ugrid(const fs::path& file, Read_report* report, const Progress_callback& progress)
try
{
  return Ugrid_reader(file, progress).read(report);
}
catch (const std::bad_alloc&)
{
  throw Format_error(fmt::format("{}: takes more memory than there is", file.string()));
}

} // namespace recurve
