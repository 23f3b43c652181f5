#include "msh_reading.h"

#include <recurve/core/exceptions.h>
#include <recurve/io/gmsh.h>

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <new>

namespace recurve {

namespace internal::msh {

Index Msh_reading::get_size(std::string_view what)
{
  const std::uint64_t value = !is_binary         ? in.parse<std::uint64_t>(what)
                              : has_32_bit_sizes ? in.read<std::uint32_t>()
                                                 : in.read<std::uint64_t>();
  if (value > static_cast<std::uint64_t>(std::numeric_limits<Index>::max()))
    in.fail(fmt::format("{} is {}: no such number", what, value));
  return static_cast<Index>(value);
}

Index Msh_reading::get_count(std::uint64_t entries, std::string_view what)
{
  const Index count = get_size(fmt::format("the number of {}", what));
  // A number takes two bytes of text, or at least four in binary.
  in.check_count(static_cast<std::uint64_t>(count), entries * (is_binary ? 4 : 2), what);
  return count;
}

namespace {

std::string trimmed(std::string line)
{
  line.erase(line.find_last_not_of(" \t\r") + 1);
  line.erase(0, line.find_first_not_of(" \t"));
  return line;
}

/// the next line that is not blank; empty at the end of the file.
std::string next_line(Input_file& in)
{
  std::string line;
  while (in.read_line(line))
    if (line = trimmed(line); !line.empty())
      return line;
  return {};
}

void expect_end(Input_file& in, const std::string& section)
{
  if (const std::string line = next_line(in); line != "$End" + section)
    in.fail_in_text(fmt::format("$End{} is expected after the last entry of ${}", section, section));
}

void read_format(Msh_reading& reading)
{
  Input_file& in = reading.in;
  const double version = in.parse<double>("the version");
  const int type = in.parse<int>("the file type");
  const int size = in.parse<int>("the size of numbers");
  if (version >= 2 && version < 3)
    reading.version = 22;
  else if (std::abs(version - 4.1) < 0.01)
    reading.version = 41;
  else
    in.fail_in_text(fmt::format("MSH version {} is not read, only 2.0 to 2.2 and 4.1; gmsh -save -format msh41 "
                                "converts",
                                version));
  reading.is_binary = type != 0;
  reading.has_32_bit_sizes = reading.version == 41 && size == 4;
  if (size != 8 && !reading.has_32_bit_sizes)
    in.fail_in_text(fmt::format("numbers of {} bytes are not read", size));
  if (!reading.is_binary)
    return;
  std::string rest;
  in.read_line(rest);
  in.set_binary(false);
  const auto one = in.read<std::int32_t>();
  if (one != 1 && one != 0x01000000)
    in.fail("the mark of the byte order is neither way a 1");
  in.set_binary(one != 1);
}

void read_names(Msh_reading& reading)
{
  Input_file& in = reading.in;
  const auto count = in.parse<Index>("the number of physical names");
  if (count < 0)
    in.fail_in_text(fmt::format("{} physical names", count));
  for (Index m = 0; m < count; ++m)
  {
    const int dimension = in.parse<int>("the dimension of a physical name");
    const int number = in.parse<int>("the number of a physical name");
    std::string line;
    in.read_line(line);
    const std::size_t first = line.find('"'), last = line.rfind('"');
    if (first == std::string::npos || last == first)
      in.fail_in_text(fmt::format("the name of physical group {} is not in quotation marks", number));
    reading.names[{dimension, number}] = line.substr(first + 1, last - first - 1);
  }
}

void skip_section(Input_file& in, const std::string& section)
{
  if (!in.skip_behind("$End" + section))
    in.fail(fmt::format("ends inside ${}", section));
}

void read_section(Msh_reading& reading, const std::string& section)
{
  if (section == "PhysicalNames")
    read_names(reading);
  else if (section == "Entities" && reading.version == 41)
    read_entities(reading, false);
  else if (section == "PartitionedEntities" && reading.version == 41)
    read_entities(reading, true);
  else if (section == "Nodes")
    read_nodes(reading);
  else if (section == "Elements")
    read_elements(reading);
  else if (section == "Periodic")
    read_periodic(reading);
  else
  {
    skip_section(reading.in, section);
    return;
  }
  expect_end(reading.in, section);
}

Zonal_mesh read_file(const std::filesystem::path& file, Read_report* report, const Progress_callback& progress)
{
  Msh_reading reading(file, progress);
  Input_file& in = reading.in;
  bool has_format = false;
  for (std::string line = next_line(in); !line.empty(); line = next_line(in))
  {
    if (line[0] != '$')
      in.fail_in_text("a section, $..., is expected: this is no MSH file or it is damaged here");
    const std::string section = line.substr(1);
    if (section == "NOD")
      in.fail_in_text("MSH version 1 is not read, only 2.0 to 2.2 and 4.1; gmsh -save -format msh41 converts");
    if (section == "MeshFormat")
    {
      read_format(reading);
      has_format = true;
      expect_end(in, section);
    }
    else if (has_format || section == "Comments")
      read_section(reading, section);
    else
      in.fail_in_text(fmt::format("${} before $MeshFormat", section));
  }
  if (!has_format)
    in.fail("has no $MeshFormat");
  if (!reading.has_nodes || !reading.has_elements)
    in.fail(fmt::format("has no ${}: the mesh is empty", reading.has_nodes ? "Elements" : "Nodes"));
  Grouped_mesh mesh = make_groups(reading);
  if (mesh.cells.empty())
    in.fail("has no cells of dimension 3: only 3D meshes can be read");
  Zonal_mesh result = to_zonal_mesh(std::move(mesh), reading.notes);
  if (report != nullptr)
    report->notes.insert(report->notes.end(), reading.notes.begin(), reading.notes.end());
  return result;
}

} // namespace

} // namespace internal::msh

Zonal_mesh read_msh(const std::filesystem::path& file, Read_report* report, const Progress_callback& progress)
try
{
  return internal::msh::read_file(file, report, progress);
}
catch (const std::bad_alloc&)
{
  throw Format_error(fmt::format("{}: takes more memory than there is", file.string()));
}

} // namespace recurve
