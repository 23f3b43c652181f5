#ifndef RECURVE_IO_CGNS_H
#define RECURVE_IO_CGNS_H

#include <recurve/core/progress.h>
#include <recurve/mesh/curved_mesh.h>
#include <recurve/mesh/volume_mesh.h>

#include <filesystem>
#include <string>
#include <vector>

namespace recurve {

/// What reading a file had to decide or leave out, one sentence each, with zone and section.
struct Read_report
{
  std::vector<std::string> notes;
};

/// reads a linear CGNS file (HDF5 or ADF, any version that libcgns or a link to its bases can open).
/// \throws Format_error naming file, zone, section, element and node.
Volume_mesh read_cgns(const std::filesystem::path& file, Read_report* report = nullptr,
                      const Progress_callback& progress = {});

/// writes degree 1 to 4 as CGNS/HDF5.
/// \throws Input_error for degree 5 and 6, Format_error if writing fails; no file is left then.
void write_cgns(const Curved_mesh& mesh, const std::filesystem::path& file, const Progress_callback& progress = {});

} // namespace recurve

#endif
