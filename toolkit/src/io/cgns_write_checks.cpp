#include "cgns_tree.h"
#include "cgns_writing.h"

#include <recurve/core/exceptions.h>

#include <cgnslib.h>
#include <fmt/format.h>

#include <limits>

namespace recurve::internal::cgns {

namespace {

/// calls f(section) for all sections of a zone.
template <class Function>
void for_each_section(const Curved_zone& zone, const Function& f)
{
  for (const std::vector<Curved_section>* sections : {&zone.cells, &zone.faces, &zone.bars})
    for (const Curved_section& section : *sections)
      f(section);
}

Index connectivity_count(const Curved_mesh& mesh)
{
  Index count = 0;
  for (const Curved_zone& zone : mesh.zones)
    for_each_section(zone, [&](const Curved_section& section) { count += static_cast<Index>(section.nodes.size()); });
  return count;
}

Index node_count_of_zones(const Curved_mesh& mesh)
{
  Index count = 0;
  for (const Curved_zone& zone : mesh.zones)
    count += static_cast<Index>(zone.nodes.size());
  return count;
}

Index text_size(const std::vector<Descriptor>& descriptors)
{
  Index size = 0;
  for (const Descriptor& descriptor : descriptors)
    size += static_cast<Index>(descriptor.text.size());
  return size;
}

} // namespace

Index element_count(const std::vector<Curved_section>& sections, int degree)
{
  Index count = 0;
  for (const Curved_section& section : sections)
    count += static_cast<Index>(section.nodes.size()) / node_count(section.type, degree);
  return count;
}

Index entry_count(const Curved_mesh& mesh)
{
  return 3 * node_count_of_zones(mesh) + connectivity_count(mesh);
}

void check_writable(const Curved_mesh& mesh)
{
  if (mesh.degree < 1 || mesh.degree > largest_cgns_degree)
    throw Input_error(fmt::format("CGNS holds elements of degree 1 to {}, not {}: write VTU, or choose a degree of at "
                                  "most {}",
                                  largest_cgns_degree, mesh.degree, largest_cgns_degree));
  if (mesh.zones.size() != mesh.linear.zones.size() || mesh.zones.empty())
    throw Input_error(fmt::format("a curved mesh of {} zones over a linear mesh of {} cannot be written",
                                  mesh.zones.size(), mesh.linear.zones.size()));
  constexpr Index largest = std::numeric_limits<cgsize_t>::max();
  for (std::size_t z = 0; z < mesh.zones.size(); ++z)
  {
    const Curved_zone& zone = mesh.zones[z];
    const auto nodes = static_cast<Index>(zone.nodes.size());
    const Index elements = element_count(zone.cells, mesh.degree) + element_count(zone.faces, mesh.degree) +
                           element_count(zone.bars, mesh.degree);
    if (nodes > largest || elements > largest)
      throw Input_error(fmt::format("zone '{}' has {} nodes and {} elements, CGNS with 32-bit numbers holds {}: write "
                                    "VTU, or split the zone",
                                    mesh.linear.zones[z].name, nodes, elements, largest));
  }
}

Index largest_file_size(const Curved_mesh& mesh)
{
  constexpr Index bytes_per_node = 8192; // of the tree, in HDF5; measured: about 1000
  constexpr Index fixed_nodes = 16;      // of a base or a zone
  const Volume_mesh& linear = mesh.linear;
  Index nodes = fixed_nodes + static_cast<Index>(4 * linear.families.size() + linear.descriptors.size());
  Index numbers = connectivity_count(mesh), texts = text_size(linear.descriptors);
  for (std::size_t z = 0; z < mesh.zones.size(); ++z)
  {
    const Zone& zone = linear.zones[z];
    texts += text_size(zone.descriptors);
    for (const Patch& patch : zone.patches)
      numbers += static_cast<Index>(patch.faces.size());
    for (const Zone_interface& interface : zone.interfaces)
      numbers += static_cast<Index>(2 * interface.points.size());
    nodes +=
      fixed_nodes + static_cast<Index>(5 * zone.patches.size() + 12 * zone.interfaces.size() + zone.descriptors.size());
    for_each_section(mesh.zones[z], [&](const Curved_section& section) {
      // a section that is split has the nodes of a section per part
      nodes += 4 * (1 + static_cast<Index>(section.nodes.size()) / std::numeric_limits<cgsize_t>::max());
    });
  }
  return static_cast<Index>(3 * sizeof(double)) * node_count_of_zones(mesh) +
         static_cast<Index>(sizeof(cgsize_t)) * numbers + texts + bytes_per_node * nodes;
}

void check_written(const Curved_mesh& mesh, const std::filesystem::path& file)
{
  const Cgns_tree tree(file);
  const auto base = tree.child_with_label(tree.root(), "CGNSBase_t");
  const std::vector<Cgns_node> zones = base ? tree.children(*base, "Zone_t") : std::vector<Cgns_node>();
  if (zones.size() != mesh.zones.size())
    tree.fail(fmt::format("only {} of {} zones were written", zones.size(), mesh.zones.size()));
  Index numbers = 0;
  for (const Cgns_node& zone : zones)
    for (const Cgns_node& section : tree.children(zone, "Elements_t"))
      if (const auto nodes = tree.child(section, "ElementConnectivity"))
        numbers += tree.shape(*nodes).size();
  if (numbers != connectivity_count(mesh))
    tree.fail(fmt::format("only {} of {} node numbers were written", numbers, connectivity_count(mesh)));
}

} // namespace recurve::internal::cgns
