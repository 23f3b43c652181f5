#include "binary_output.h"
#include "msh_layout.h"
#include "msh_types.h"

#include <recurve/core/exceptions.h>
#include <recurve/elements/node_layout.h>
#include <recurve/io/gmsh.h>

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <span>
#include <utility>

namespace recurve {

namespace internal::msh {

namespace {

/// Numbers of the file, as text or binary.
class Msh_output
{
public:
  Msh_output(const std::filesystem::path& file, bool is_ascii) : out_(file), is_ascii_(is_ascii) {}

  Binary_output& file() { return out_; }
  bool is_ascii() const { return is_ascii_; }
  void put_text(std::string_view text) { out_.put_text(text); }

  template <class Number>
  void put(Number value)
  {
    if (!is_ascii_)
    {
      out_.put(value);
      return;
    }
    buffer_.clear();
    fmt::format_to(std::back_inserter(buffer_), "{} ", value);
    out_.put_text({buffer_.data(), buffer_.size()});
  }
  void put_int(Index value) { put(static_cast<std::int32_t>(value)); }
  void put_size(Index value) { put(static_cast<std::uint64_t>(value)); }

  void put_point(const Point& point)
  {
    for (const double coordinate : point)
      put(coordinate);
  }

  /// ends a line of text; means nothing in binary.
  void end_line()
  {
    if (is_ascii_)
      out_.put_text("\n");
  }

private:
  Binary_output out_;
  bool is_ascii_;
  fmt::memory_buffer buffer_;
};

void put_format(Msh_output& out, Msh_version version)
{
  out.put_text(
    fmt::format("$MeshFormat\n{} {} 8\n", version == Msh_version::v4_1 ? "4.1" : "2.2", out.is_ascii() ? 0 : 1));
  if (!out.is_ascii())
  {
    out.put_int(1); // by which a reader knows the byte order
    out.put_text("\n");
  }
  out.put_text("$EndMeshFormat\n");
}

void put_groups(Msh_output& out, const Msh_layout& layout)
{
  out.put_text(fmt::format("$PhysicalNames\n{}\n", layout.groups.size()));
  for (const Physical_group& group : layout.groups)
    out.put_text(fmt::format("{} {} \"{}\"\n", group.dimension, group.number, group.name));
  out.put_text("$EndPhysicalNames\n");
}

/// calls visit(nodes of an element) for each element of a block.
template <class Visit>
void visit_elements(const Block& block, int degree, const Visit& visit)
{
  const auto width = static_cast<std::size_t>(node_count(block.section->type, degree));
  for (Index m = 0; m < block.count; ++m)
  {
    const Index element = block.faces.empty() ? m : block.faces[static_cast<std::size_t>(m)];
    visit(std::span(block.section->nodes).subspan(static_cast<std::size_t>(element) * width, width));
  }
}

// Version 4.1.
// ---------------------------------------------------------------------------------------------------------

void put_bounding_box(Msh_output& out, const Curved_mesh& mesh, const Entity& entity)
{
  constexpr double infinity = std::numeric_limits<double>::infinity();
  Point low = {infinity, infinity, infinity}, high = {-infinity, -infinity, -infinity};
  for (const Block& block : entity.blocks)
    visit_elements(block, mesh.degree, [&](std::span<const Index> nodes) {
      for (const Index node : nodes)
        for (std::size_t axis = 0; axis < 3; ++axis)
        {
          low[axis] = std::min(low[axis], mesh.nodes[static_cast<std::size_t>(node)][axis]);
          high[axis] = std::max(high[axis], mesh.nodes[static_cast<std::size_t>(node)][axis]);
        }
    });
  if (low[0] > high[0])
    low = high = {};
  out.put_point(low);
  out.put_point(high);
}

void put_entities(Msh_output& out, const Curved_mesh& mesh, const Msh_layout& layout)
{
  const auto surfaces = std::count_if(layout.entities.begin(), layout.entities.end(),
                                      [](const Entity& entity) { return entity.dimension == 2; });
  out.put_text("$Entities\n");
  for (const Index count : {Index(0), Index(0), Index(surfaces), static_cast<Index>(layout.entities.size()) - surfaces})
    out.put_size(count);
  out.end_line();
  for (const Entity& entity : layout.entities)
  {
    out.put_int(entity.tag);
    put_bounding_box(out, mesh, entity);
    out.put_size(1);
    out.put_int(entity.physical);
    std::vector<int> boundary; // of volumes their surfaces; of surfaces the curves, of which there are none
    for (const Entity& other : layout.entities)
      if (entity.dimension == 3 && other.dimension == 2 && other.zone == entity.zone)
        boundary.push_back(other.tag);
    out.put_size(static_cast<Index>(boundary.size()));
    for (const int tag : boundary)
      out.put_int(tag);
    out.end_line();
  }
  out.put_text(out.is_ascii() ? "$EndEntities\n" : "\n$EndEntities\n");
}

/// The nodes that each entity has for itself: a node on a patch belongs to its surface, any other to its volume.
struct Node_owners
{
  std::vector<Index> begin; ///< per entity, in `nodes`
  std::vector<Index> nodes; ///< by entity, ascending
};

Node_owners find_owners(const Curved_mesh& mesh, const Msh_layout& layout)
{
  std::vector<std::int32_t> owner(mesh.nodes.size(), -1);
  const auto take = [&owner](Index node, std::size_t entity) {
    if (owner[static_cast<std::size_t>(node)] < 0)
      owner[static_cast<std::size_t>(node)] = static_cast<std::int32_t>(entity);
  };
  for (std::size_t e = 0; e < layout.entities.size(); ++e)
  {
    const Entity& entity = layout.entities[e];
    if (entity.dimension == 3)
      for (const Index node : mesh.zones[entity.zone].nodes)
        take(node, e);
    else
      for (const Block& block : entity.blocks)
        visit_elements(block, mesh.degree, [&](std::span<const Index> nodes) {
          for (const Index node : nodes)
            take(node, e);
        });
  }
  for (std::int32_t& entity : owner)
    if (entity < 0)
      entity = static_cast<std::int32_t>(layout.entities.size()) - 1;

  Node_owners result = {std::vector<Index>(layout.entities.size() + 1, 0), std::vector<Index>(mesh.nodes.size())};
  for (const std::int32_t entity : owner)
    ++result.begin[static_cast<std::size_t>(entity) + 1];
  for (std::size_t e = 0; e < layout.entities.size(); ++e)
    result.begin[e + 1] += result.begin[e];
  std::vector<Index> next = result.begin;
  for (std::size_t node = 0; node < owner.size(); ++node)
    result.nodes[static_cast<std::size_t>(next[static_cast<std::size_t>(owner[node])]++)] = static_cast<Index>(node);
  return result;
}

void put_nodes_4(Msh_output& out, const Curved_mesh& mesh, const Msh_layout& layout)
{
  const Node_owners owners = find_owners(mesh, layout);
  Index blocks = 0;
  for (std::size_t e = 0; e < layout.entities.size(); ++e)
    blocks += owners.begin[e + 1] > owners.begin[e];
  const Index count = static_cast<Index>(mesh.nodes.size());
  out.put_text("$Nodes\n");
  for (const Index value : {blocks, count, std::min<Index>(count, 1), count})
    out.put_size(value);
  out.end_line();
  for (std::size_t e = 0; e < layout.entities.size(); ++e)
  {
    const std::span<const Index> nodes(owners.nodes.data() + owners.begin[e],
                                       owners.nodes.data() + owners.begin[e + 1]);
    if (nodes.empty())
      continue;
    out.put_int(layout.entities[e].dimension);
    out.put_int(layout.entities[e].tag);
    out.put_int(0); // no parameters on a geometry
    out.put_size(static_cast<Index>(nodes.size()));
    out.end_line();
    for (const Index node : nodes)
    {
      out.put_size(node + 1);
      out.end_line();
    }
    for (const Index node : nodes)
    {
      out.put_point(mesh.nodes[static_cast<std::size_t>(node)]);
      out.end_line();
    }
  }
  out.put_text(out.is_ascii() ? "$EndNodes\n" : "\n$EndNodes\n");
}

void put_elements_4(Msh_output& out, const Curved_mesh& mesh, const Msh_layout& layout)
{
  Index blocks = 0;
  for (const Entity& entity : layout.entities)
    blocks += static_cast<Index>(entity.blocks.size());
  const Index count = layout.element_count();
  out.put_text("$Elements\n");
  for (const Index value : {blocks, count, std::min<Index>(count, 1), count})
    out.put_size(value);
  out.end_line();
  Index number = 1;
  for (const Entity& entity : layout.entities)
    for (const Block& block : entity.blocks)
    {
      out.put_int(entity.dimension);
      out.put_int(entity.tag);
      out.put_int(type_number(block.section->type, mesh.degree));
      out.put_size(block.count);
      out.end_line();
      const std::span<const int> order = canonical_of_foreign(Node_order::gmsh, block.section->type, mesh.degree);
      visit_elements(block, mesh.degree, [&](std::span<const Index> nodes) {
        out.put_size(number++);
        for (const int node : order)
          out.put_size(nodes[static_cast<std::size_t>(node)] + 1);
        out.end_line();
      });
    }
  out.put_text(out.is_ascii() ? "$EndElements\n" : "\n$EndElements\n");
}

void put_links_4(Msh_output& out, const Msh_layout& layout)
{
  if (layout.links.empty())
    return;
  out.put_text("$Periodic\n");
  out.put_size(static_cast<Index>(layout.links.size()));
  out.end_line();
  for (const Periodic_link& link : layout.links)
  {
    for (const int value : {2, link.tag, link.master_tag})
      out.put_int(value);
    out.end_line();
    out.put_size(16);
    for (const double value : link.map)
      out.put(value);
    out.end_line();
    out.put_size(static_cast<Index>(link.nodes.size()));
    out.end_line();
    for (const auto& [node, master] : link.nodes)
    {
      out.put_size(node + 1);
      out.put_size(master + 1);
      out.end_line();
    }
  }
  out.put_text(out.is_ascii() ? "$EndPeriodic\n" : "\n$EndPeriodic\n");
}

// Version 2.2.
// ---------------------------------------------------------------------------------------------------------

void put_nodes_2(Msh_output& out, const Curved_mesh& mesh)
{
  out.put_text(fmt::format("$Nodes\n{}\n", mesh.nodes.size()));
  for (std::size_t node = 0; node < mesh.nodes.size(); ++node)
  {
    out.put_int(static_cast<Index>(node) + 1);
    out.put_point(mesh.nodes[node]);
    out.end_line();
  }
  out.put_text(out.is_ascii() ? "$EndNodes\n" : "\n$EndNodes\n");
}

void put_elements_2(Msh_output& out, const Curved_mesh& mesh, const Msh_layout& layout)
{
  out.put_text(fmt::format("$Elements\n{}\n", layout.element_count()));
  Index number = 1;
  for (const Entity& entity : layout.entities)
    for (const Block& block : entity.blocks)
    {
      const int type = type_number(block.section->type, mesh.degree);
      if (!out.is_ascii())
        for (const Index value : {Index(type), block.count, Index(2)})
          out.put_int(value);
      const std::span<const int> order = canonical_of_foreign(Node_order::gmsh, block.section->type, mesh.degree);
      visit_elements(block, mesh.degree, [&](std::span<const Index> nodes) {
        out.put_int(number++);
        if (out.is_ascii())
        {
          out.put_int(type);
          out.put_int(2);
        }
        out.put_int(entity.physical);
        out.put_int(entity.tag);
        for (const int node : order)
          out.put_int(nodes[static_cast<std::size_t>(node)] + 1);
        out.end_line();
      });
    }
  out.put_text(out.is_ascii() ? "$EndElements\n" : "\n$EndElements\n");
}

/// text also in binary files, as Gmsh does.
void put_links_2(Msh_output& out, const Msh_layout& layout)
{
  if (layout.links.empty())
    return;
  out.put_text(fmt::format("$Periodic\n{}\n", layout.links.size()));
  for (const Periodic_link& link : layout.links)
  {
    out.put_text(fmt::format("2 {} {}\nAffine", link.tag, link.master_tag));
    for (const double value : link.map)
      out.put_text(fmt::format(" {}", value));
    out.put_text(fmt::format("\n{}\n", link.nodes.size()));
    for (const auto& [node, master] : link.nodes)
      out.put_text(fmt::format("{} {}\n", node + 1, master + 1));
  }
  out.put_text("$EndPeriodic\n");
}

/// about the bytes of the file, for the progress.
std::uint64_t expected_bytes(const Curved_mesh& mesh, const Msh_layout& layout, const Msh_options& options)
{
  std::uint64_t entries = 0;
  for (const Entity& entity : layout.entities)
    for (const Block& block : entity.blocks)
      entries += static_cast<std::uint64_t>(block.count * (3 + node_count(block.section->type, mesh.degree)));
  return 32 * mesh.nodes.size() + (options.version == Msh_version::v4_1 ? 8 : 4) * entries;
}

} // namespace

void check_counts_of_2(Index nodes, Index elements)
{
  constexpr Index most = std::numeric_limits<std::int32_t>::max();
  if (nodes > most || elements > most)
    throw Input_error(fmt::format("MSH 2.2 counts with 32 bits: {} nodes and {} elements are more than it can hold; "
                                  "version 4.1 holds them",
                                  nodes, elements));
}

} // namespace internal::msh

void write_msh(const Curved_mesh& mesh, const std::filesystem::path& file, const Msh_options& options,
               const Progress_callback& progress)
{
  using namespace internal::msh;
  const Msh_layout layout = make_layout(mesh);
  if (options.version == Msh_version::v2_2)
    check_counts_of_2(static_cast<Index>(mesh.nodes.size()), layout.element_count());
  report_progress(progress, "write", 0);
  Msh_output out(file, options.is_ascii);
  const std::uint64_t total = std::max<std::uint64_t>(1, expected_bytes(mesh, layout, options));
  out.file().call_after_writes([&, shown = std::uint64_t{0}]() mutable {
    // In text the file is longer than expected.
    const std::uint64_t percent = std::min<std::uint64_t>(100, 100 * out.file().size() / total);
    if (percent > std::exchange(shown, percent))
      report_progress(progress, "write", static_cast<double>(percent) / 100);
  });
  put_format(out, options.version);
  put_groups(out, layout);
  if (options.version == Msh_version::v4_1)
  {
    put_entities(out, mesh, layout);
    put_nodes_4(out, mesh, layout);
    put_elements_4(out, mesh, layout);
    put_links_4(out, layout);
  }
  else
  {
    put_nodes_2(out, mesh);
    put_elements_2(out, mesh, layout);
    put_links_2(out, layout);
  }
  out.file().close();
}

} // namespace recurve
