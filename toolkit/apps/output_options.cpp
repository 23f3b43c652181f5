#include "output_options.h"

#include <fmt/format.h>

#include <cstdio>
#include <map>
#include <string>

namespace recurve {

void add_output_options(CLI::App& command, Write_options& options)
{
  constexpr const char* group = "Output";
  const std::map<std::string, Msh_version> versions = {{"2.2", Msh_version::v2_2}, {"4.1", Msh_version::v4_1}};
  command.add_option("--msh-version", options.msh.version, "of a .msh file: 4.1 (default), or 2.2, which MFEM reads")
    ->transform(CLI::Transformer(versions).description(""))
    ->check(CLI::IsMember({Msh_version::v2_2, Msh_version::v4_1}).description(""))
    ->type_name("2.2|4.1")
    ->group(group);
  command.add_flag("--ascii", options.msh.is_ascii, "write a .msh file as text")->group(group);
}

void tell_loss(const std::filesystem::path& output, const Curved_mesh& mesh)
{
  if (const std::string loss = describe_loss(mesh_format_of(output), mesh); !loss.empty())
    fmt::print(stderr, "recurve: {}: {}\n", output.string(), loss);
}

} // namespace recurve
