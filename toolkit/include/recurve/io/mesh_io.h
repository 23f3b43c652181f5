#ifndef RECURVE_IO_MESH_IO_H
#define RECURVE_IO_MESH_IO_H

#include <recurve/core/progress.h>
#include <recurve/io/cgns.h>
#include <recurve/io/gmsh.h>
#include <recurve/io/hopr.h>
#include <recurve/io/pending_file.h>
#include <recurve/io/su2.h>
#include <recurve/io/surface_files.h>
#include <recurve/io/ugrid.h>
#include <recurve/io/vtk.h>
#include <recurve/io/zonal_mesh.h>
#include <recurve/mesh/curved_mesh.h>

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace recurve {

/// What a writer may vary; each format takes its own part.
struct Write_options
{
  Msh_options msh;
};

/// What a mesh may say beyond nodes, elements, patches and their names, and what not every format holds.
enum class Mesh_content : std::uint8_t
{
  cells,       ///< the volume: surface formats hold the faces of patches only
  zones,       ///< more than one, with names
  patches,     ///< groups of faces, with names
  bars,        ///< lines
  families,    ///< groups of patches and zones
  kinds,       ///< kinds of boundary conditions
  connections, ///< other than those that sharing nodes says: overlapping or not one to one
  periodicity, ///< periodic connections
  units,
  descriptors ///< free texts
};

inline constexpr std::array<Mesh_content, 10> all_mesh_content = {
  Mesh_content::cells,    Mesh_content::zones,      Mesh_content::patches,     Mesh_content::bars,
  Mesh_content::families, Mesh_content::kinds,      Mesh_content::connections, Mesh_content::periodicity,
  Mesh_content::units,    Mesh_content::descriptors};

/// "zones", "kinds of boundary conditions", ...
std::string_view content_name(Mesh_content content);

/// whether `mesh` says anything of the kind.
bool has_content(const Curved_mesh& mesh, Mesh_content content);

/// A file format as the program knows it: one row of the registry.
struct Mesh_format
{
  std::string name;                    ///< "CGNS"
  std::vector<std::string> extensions; ///< ".cgns", in lower case
  int largest_degree_read = 0;         ///< 0: cannot be read
  int largest_degree_written = 0;      ///< 0: cannot be written
  std::vector<Mesh_content> content;   ///< what it holds when it is written
  std::size_t longest_name = 0;        ///< of zones, patches and families, in bytes; 0: any
  std::string not_in_names;            ///< a character that names cannot have, which is replaced; empty: none
  std::string shortened;               ///< what it holds in part, for the documentation
  std::string versions;                ///< of the format, for the documentation
  std::string readers;                 ///< programs that read what is written, for the documentation
  std::function<Zonal_mesh(const std::filesystem::path&, Read_report*, const Progress_callback&)>
    read; ///< empty: cannot be read
  std::function<void(const Curved_mesh&, const std::filesystem::path&, const std::vector<Cell_field>&,
                     const Write_options&, const Progress_callback&)>
    write; ///< empty: cannot be written. Formats without room for cell fields leave them out
};

/// every format, in the order in which the documentation lists them.
const std::vector<Mesh_format>& mesh_formats();

/// the format of a file by its extension (letter case does not matter).
/// \throws Input_error naming the known extensions.
const Mesh_format& mesh_format_of(const std::filesystem::path& file);

/// reads a linear mesh by its extension.
/// \throws Input_error if the extension is unknown or the format cannot be read; Format_error if the mesh is of high
/// order or the file cannot be read, naming file, zone, section, element and node as far as they are known.
Volume_mesh read_mesh(const std::filesystem::path& file, Read_report* report = nullptr,
                      const Progress_callback& progress = {});

/// reads a mesh of any degree that the format holds; a linear one comes with degree 1. Node numbers are unique across
/// zones, see to_curved_mesh(), and `linear` is what the file says beyond points and elements.
/// \throws as read_mesh(), and Format_error for elements of several degrees or of incomplete families.
Curved_mesh read_curved_mesh(const std::filesystem::path& file, Read_report* report = nullptr,
                             const Progress_callback& progress = {});

/// checks that a mesh of degree `degree` can be written to `file`, as far as its name tells, so that a program can
/// refuse before the work. \throws Input_error if the format is unknown or does not hold the degree.
void check_writable(const std::filesystem::path& file, int degree);

/// the formats as a table in Markdown: what the README shows.
std::string format_table();

/// what `mesh` says and `format` does not hold, names that it has to change among it, as one line without the name of a
/// file; empty if nothing is lost.
std::string describe_loss(const Mesh_format& format, const Curved_mesh& mesh);

/// writes a mesh by the extension of `file`, beside the target first and renamed when complete: a failed run leaves no
/// file and keeps an old one. \throws Input_error as check_writable(); Format_error if writing fails.
void write_mesh(const Curved_mesh& mesh, const std::filesystem::path& file, const std::vector<Cell_field>& fields = {},
                const Progress_callback& progress = {}, const Write_options& options = {});

/// the same, but the caller commits `file`.
void write_mesh(const Curved_mesh& mesh, Pending_file& file, const std::vector<Cell_field>& fields = {},
                const Progress_callback& progress = {}, const Write_options& options = {});

} // namespace recurve

#endif
