#include <recurve/io/mesh_io.h>

#include <recurve/core/exceptions.h>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>

namespace recurve {

namespace {

namespace fs = std::filesystem;

std::string lower_case(std::string text)
{
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char character) { return static_cast<char>(std::tolower(character)); });
  return text;
}

/// "CGNS (.cgns), VTU (.vtu)", of the formats that `is_wanted` picks.
template <class Predicate>
std::string list_of_formats(Predicate is_wanted)
{
  std::vector<std::string> texts;
  for (const Mesh_format& format : mesh_formats())
    if (is_wanted(format))
      texts.push_back(fmt::format("{} ({})", format.name, fmt::join(format.extensions, ", ")));
  return fmt::format("{}", fmt::join(texts, ", "));
}

/// tells "no such file" from "not a CGNS file" in the same words for every format.
void check_readable(const fs::path& file)
{
  std::error_code ignored;
  if (fs::is_directory(file, ignored))
    throw Format_error(fmt::format("{}: is a directory, not a mesh file", file.string()));
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> stream(std::fopen(file.c_str(), "rb"), std::fclose);
  if (!stream)
    throw Format_error(fmt::format("{}: cannot be opened: {}", file.string(), std::strerror(errno)));
  if (std::fgetc(stream.get()) == EOF)
    throw Format_error(fmt::format("{}: is empty", file.string()));
}

std::string replaced(std::string text, const std::string& from, const std::string& to)
{
  for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size()))
    text.replace(at, from.size(), to);
  return text;
}

} // namespace

const Mesh_format& mesh_format_of(const fs::path& file)
{
  const std::string extension = lower_case(file.extension().string());
  for (const Mesh_format& format : mesh_formats())
    if (std::find(format.extensions.begin(), format.extensions.end(), extension) != format.extensions.end())
      return format;
  throw Input_error(fmt::format("{}: {} is not the extension of a known format; known are {}", file.string(),
                                extension.empty() ? "none" : "\"" + extension + "\"",
                                list_of_formats([](const Mesh_format&) { return true; })));
}

namespace {

Zonal_mesh read_zonal_mesh(const fs::path& file, Read_report* report, const Progress_callback& progress)
{
  const Mesh_format& format = mesh_format_of(file);
  if (!format.read)
    throw Input_error(fmt::format("{}: {} is written but not read; formats that are read: {}", file.string(),
                                  format.name, list_of_formats([](const Mesh_format& f) { return bool(f.read); })));
  check_readable(file);
  return format.read(file, report, progress);
}

} // namespace

Volume_mesh read_mesh(const fs::path& file, Read_report* report, const Progress_callback& progress)
{
  Zonal_mesh mesh = read_zonal_mesh(file, report, progress);
  if (mesh.degree > 1)
    throw Format_error(fmt::format("{}: the mesh is of high order already (degree {}), only linear ones can be curved",
                                   file.string(), mesh.degree));
  return std::move(mesh.linear);
}

Curved_mesh read_curved_mesh(const fs::path& file, Read_report* report, const Progress_callback& progress)
{
  Zonal_mesh mesh = read_zonal_mesh(file, report, progress);
  try
  {
    return to_curved_mesh(std::move(mesh), report);
  }
  catch (const Input_error& error)
  {
    throw Format_error(fmt::format("{}: {}", file.string(), error.what()));
  }
}

void check_writable(const fs::path& file, int degree)
{
  const Mesh_format& format = mesh_format_of(file);
  if (degree <= format.largest_degree_written)
    return;
  throw Input_error(
    fmt::format("{}: {} has no elements of degree {}, only up to {}; formats that have: {}", file.string(), format.name,
                degree, format.largest_degree_written,
                list_of_formats([degree](const Mesh_format& f) { return f.largest_degree_written >= degree; })));
}

void write_mesh(const Curved_mesh& mesh, Pending_file& file, const std::vector<Cell_field>& fields,
                const Progress_callback& progress, const Write_options& options)
{
  check_writable(file.target(), mesh.degree);
  try
  {
    mesh_format_of(file.target()).write(mesh, file.path(), fields, options, progress);
  }
  catch (const Format_error& error)
  {
    // The user knows the file by its final name.
    throw Format_error(replaced(error.what(), file.path().string(), file.target().string()));
  }
}

void write_mesh(const Curved_mesh& mesh, const fs::path& file, const std::vector<Cell_field>& fields,
                const Progress_callback& progress, const Write_options& options)
{
  check_writable(file, mesh.degree);
  Pending_file pending(file);
  write_mesh(mesh, pending, fields, progress, options);
  pending.commit();
}

} // namespace recurve
