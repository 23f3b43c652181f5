#ifndef RECURVE_APPS_OUTPUT_OPTIONS_H
#define RECURVE_APPS_OUTPUT_OPTIONS_H

#include <recurve/io/mesh_io.h>

#include <CLI/CLI.hpp>

namespace recurve {

/// adds what a user may choose about the file that is written.
void add_output_options(CLI::App& command, Write_options& options);

} // namespace recurve

#endif
