#ifndef RECURVE_APPS_OUTPUT_OPTIONS_H
#define RECURVE_APPS_OUTPUT_OPTIONS_H

#include <recurve/io/mesh_io.h>

#include <CLI/CLI.hpp>

#include <filesystem>

namespace recurve {

/// adds what a user may choose about the file that is written.
void add_output_options(CLI::App& command, Write_options& options);

/// says on standard error, in one line, what the format of `output` does not hold of `mesh`; nothing if it holds all.
void tell_loss(const std::filesystem::path& output, const Curved_mesh& mesh);

} // namespace recurve

#endif
