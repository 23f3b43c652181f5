#include "cgns_names.h"
#include "cgns_reading.h"

#include <cgnslib.h>
#include <fmt/format.h>

#include <algorithm>
#include <limits>

namespace recurve::internal::cgns {

namespace {

/// A CGNS element type that is read, and what a split mixed section is called.
struct Linear_type
{
  int code;
  Element_type type;
  const char* suffix;
};

constexpr std::array<Linear_type, 7> linear_types = {{{BAR_2, Element_type::line, "bar"},
                                                      {TRI_3, Element_type::triangle, "tri"},
                                                      {QUAD_4, Element_type::quadrangle, "quad"},
                                                      {TETRA_4, Element_type::tetrahedron, "tetra"},
                                                      {PYRA_5, Element_type::pyramid, "pyra"},
                                                      {PENTA_6, Element_type::prism, "penta"},
                                                      {HEXA_8, Element_type::hexahedron, "hexa"}}};

/// An Elements_t node before its connectivity is read.
struct Section_node
{
  Cgns_node node;
  Cgns_node connectivity;
  std::string where; ///< "zone 'Z', section 'S'"
  int code = 0;
  Index first = 1, last = 0;

  Index count() const { return last - first + 1; }
};

/// CGNS 3.0 had PYRA_13 between PYRA_5 and PYRA_14; all later types stood one higher.
int current_code(int code, int version)
{
  if (version < 3000 || version >= 3100 || code <= PYRA_5 || code >= NGON_n)
    return code;
  return code == PYRA_14 ? static_cast<int>(PYRA_13) : code - 1;
}

std::string code_name(std::int64_t code)
{
  return code >= 0 && code < NofValidElementTypes ? std::string(ElementTypeName[code]) : fmt::format("number {}", code);
}

[[noreturn]] void refuse_type(const Cgns_tree& tree, const std::string& where, std::int64_t code)
{
  const std::string name = code_name(code);
  if (code == NGON_n || code == NFACE_n)
    tree.fail(fmt::format(
      "{}: element type {}: polyhedra cannot be read, only tetrahedra, pyramids, prisms and hexahedra", where, name));
  if (code > NODE && code < NofValidElementTypes && code != MIXED)
    tree.fail(
      fmt::format("{}: element type {}: the mesh is of high order already, only linear ones can be read", where, name));
  tree.fail(fmt::format("{}: unknown element type {}", where, name));
}

/// the row of `linear_types`, or null for NODE.
const Linear_type* find_type(const Cgns_tree& tree, const std::string& where, std::int64_t code)
{
  if (code == NODE)
    return nullptr;
  for (const Linear_type& type : linear_types)
    if (type.code == code)
      return &type;
  refuse_type(tree, where, code);
}

std::vector<Section>& sections_for(Zone& zone, Element_type type)
{
  const int dimension = reference_element(type).dimension;
  return dimension == 3 ? zone.cells : dimension == 2 ? zone.faces : zone.bars;
}

bool is_face(Element_type type)
{
  return reference_element(type).dimension == 2;
}

Section_node open_section(const Cgns_reading& reading, const Zone_reading& zone, const Cgns_node& node)
{
  const Cgns_tree& tree = reading.tree;
  Section_node section;
  section.node = node;
  section.where = fmt::format("zone '{}', section '{}'", zone.zone.name, node.name());
  const std::vector<std::int64_t> data = tree.read_integers(node);
  if (data.empty())
    tree.fail(fmt::format("{} states no element type", section.where));
  if (data[0] < 0 || data[0] > std::numeric_limits<int>::max())
    refuse_type(tree, section.where, data[0]);
  section.code = current_code(static_cast<int>(data[0]), reading.version);
  if (section.code != MIXED)
    find_type(tree, section.where, section.code);

  const auto range_node = tree.child(node, "ElementRange");
  const std::vector<std::int64_t> range = range_node ? tree.read_integers(*range_node) : std::vector<std::int64_t>();
  if (range.size() != 2)
    tree.fail(fmt::format("{} has no ElementRange", section.where));
  section.first = range[0];
  section.last = range[1];
  if (section.first < 1 || section.last < section.first - 1)
    tree.fail(fmt::format("{}: ElementRange {}..{} is none", section.where, section.first, section.last));
  const auto connectivity = tree.child(node, "ElementConnectivity");
  if (!connectivity)
    tree.fail(fmt::format("{} has no ElementConnectivity", section.where));
  section.connectivity = *connectivity;
  return section;
}

void check_node(const Cgns_tree& tree, const Section_node& section, Index element, int corner, std::int64_t node,
                Index point_count)
{
  if (node < 1 || node > point_count)
    tree.fail(fmt::format("{}, element {}: node {} is number {}, outside 1..{}", section.where, section.first + element,
                          corner + 1, node, point_count));
}

/// reads a section of one type.
void read_plain(const Cgns_tree& tree, const Section_node& section, Zone_reading& zone)
{
  Element_block block = {
    .name = section.node.name(), .first = section.first, .last = section.last, .first_face = no_index, .face_of = {}};
  const Linear_type* type = find_type(tree, section.where, section.code);
  if (type != nullptr)
  {
    const int corners = corner_count(type->type);
    const Index stored = tree.shape(section.connectivity).size();
    if (section.count() > stored || stored != section.count() * corners)
      tree.fail(fmt::format("{}: {} elements {} take {} node numbers, but the file has {}", section.where,
                            section.count(), code_name(section.code), section.count() * corners, stored));
    if (is_face(type->type))
      block.first_face = zone.zone.face_count();
    Section result = {.name = section.node.name(), .type = type->type, .nodes = {}};
    result.nodes.reserve(static_cast<std::size_t>(stored));
    tree.visit_integers(section.connectivity, [&](Index begin, std::span<const std::int64_t> piece) {
      for (std::size_t m = 0; m < piece.size(); ++m)
      {
        const Index entry = begin + static_cast<Index>(m);
        check_node(tree, section, entry / corners, static_cast<int>(entry % corners), piece[m], zone.point_count());
        result.nodes.push_back(piece[m] - 1);
      }
    });
    if (section.count() > 0)
      sections_for(zone.zone, type->type).push_back(std::move(result));
  }
  zone.blocks.push_back(std::move(block));
}

/// calls f(number of the element in the section, type or null for NODE, nodes) for each element of a mixed section.
template <class Function>
void visit_mixed(const Cgns_reading& reading, const Section_node& section, const Function& f)
{
  const Cgns_tree& tree = reading.tree;
  Index element = 0;
  const Linear_type* type = nullptr;
  std::array<std::int64_t, 8> nodes = {};
  std::size_t wanted = 0, have = 0; // nodes of the running element; 0 wanted: its type comes next
  const auto visit = [&](Index, std::span<const std::int64_t> piece) {
    for (const std::int64_t value : piece)
    {
      if (wanted == 0)
      {
        if (element == section.count())
          tree.fail(fmt::format("{}: its connectivity goes on after its {} elements", section.where, section.count()));
        const std::string where = fmt::format("{}, element {}", section.where, section.first + element);
        const std::int64_t code =
          value < 0 || value > NofValidElementTypes ? value : current_code(static_cast<int>(value), reading.version);
        if (code == MIXED)
          tree.fail(fmt::format("{}: type MIXED inside a mixed section", where));
        type = find_type(tree, where, code);
        wanted = type == nullptr ? 1 : static_cast<std::size_t>(corner_count(type->type));
        have = 0;
        continue;
      }
      nodes[have++] = value;
      if (have < wanted)
        continue;
      f(element, type, std::span<const std::int64_t>(nodes.data(), have));
      ++element;
      wanted = 0;
    }
  };
  tree.visit_integers(section.connectivity, visit);
  if (wanted != 0 || element != section.count())
    tree.fail(fmt::format("{}: its connectivity ends in element {}, but its range ends with {}", section.where,
                          section.first + element, section.last));
}

/// splits a mixed section into one section per type, in the order of their first elements' types in `linear_types`.
void read_mixed(const Cgns_reading& reading, const Section_node& section, Zone_reading& zone)
{
  const Cgns_tree& tree = reading.tree;
  if (section.count() > tree.shape(section.connectivity).size())
    tree.fail(fmt::format("{}: {} elements, but the connectivity has {} entries", section.where, section.count(),
                          tree.shape(section.connectivity).size()));
  // The first pass counts, so that each array is allocated once.
  std::array<Index, linear_types.size()> counts = {};
  visit_mixed(reading, section, [&](Index, const Linear_type* type, std::span<const std::int64_t>) {
    if (type != nullptr)
      ++counts[static_cast<std::size_t>(type - linear_types.data())];
  });

  std::array<Section, linear_types.size()> parts;
  std::array<Index, linear_types.size()> next_face = {};
  Index face_count = zone.zone.face_count();
  bool has_faces = false;
  for (std::size_t t = 0; t < parts.size(); ++t)
  {
    parts[t].type = linear_types[t].type;
    parts[t].nodes.reserve(static_cast<std::size_t>(counts[t] * corner_count(parts[t].type)));
    next_face[t] = face_count;
    if (is_face(parts[t].type) && counts[t] > 0)
    {
      has_faces = true;
      face_count += counts[t];
    }
  }
  Element_block block = {
    .name = section.node.name(), .first = section.first, .last = section.last, .first_face = no_index, .face_of = {}};
  if (has_faces)
    block.face_of.assign(static_cast<std::size_t>(section.count()), no_index);
  visit_mixed(reading, section, [&](Index element, const Linear_type* type, std::span<const std::int64_t> nodes) {
    for (std::size_t m = 0; m < nodes.size(); ++m)
      check_node(tree, section, element, static_cast<int>(m), nodes[m], zone.point_count());
    if (type == nullptr)
      return;
    const auto t = static_cast<std::size_t>(type - linear_types.data());
    for (const std::int64_t node : nodes)
      parts[t].nodes.push_back(node - 1);
    if (is_face(type->type))
      block.face_of[static_cast<std::size_t>(element)] = next_face[t]++;
  });

  const auto kinds = std::count_if(counts.begin(), counts.end(), [](Index count) { return count > 0; });
  for (std::size_t t = 0; t < parts.size(); ++t)
  {
    if (counts[t] == 0)
      continue;
    const std::string suffix = fmt::format("_{}", linear_types[t].suffix);
    const std::string name = section.node.name();
    parts[t].name =
      kinds == 1 ? name : section_names(zone.zone).take(cut_name(name, longest_cgns_name - suffix.size()) + suffix);
    sections_for(zone.zone, parts[t].type).push_back(std::move(parts[t]));
  }
  zone.blocks.push_back(std::move(block));
}

} // namespace

Cgns_names section_names(const Zone& zone)
{
  Cgns_names names;
  for (const auto* sections : {&zone.cells, &zone.faces, &zone.bars})
    for (const Section& section : *sections)
      names.reserve(section.name);
  return names;
}

void read_sections(Cgns_reading& reading, Zone_reading& zone)
{
  std::vector<Section_node> sections;
  for (const Cgns_node& node : reading.tree.children(zone.node, "Elements_t"))
    sections.push_back(open_section(reading, zone, node));
  // The numbers of the elements are the order that the file means; the nodes of the tree may stand in any.
  std::stable_sort(sections.begin(), sections.end(),
                   [](const Section_node& a, const Section_node& b) { return a.first < b.first; });
  for (std::size_t s = 0; s < sections.size(); ++s)
  {
    if (s > 0 && sections[s].first <= sections[s - 1].last)
      zone.has_overlapping_blocks = true;
    if (sections[s].code == NODE)
      reading.notes.push_back(fmt::format("{}: {} NODE elements are left out", sections[s].where, sections[s].count()));
    if (sections[s].code == MIXED)
      read_mixed(reading, sections[s], zone);
    else
      read_plain(reading.tree, sections[s], zone);
  }
}

Index face_of_element(const Cgns_tree& tree, const Zone_reading& zone, Index element, std::string_view what)
{
  const auto after = std::upper_bound(zone.blocks.begin(), zone.blocks.end(), element,
                                      [](Index number, const Element_block& block) { return number < block.first; });
  if (after == zone.blocks.begin() || element > std::prev(after)->last)
    tree.fail(fmt::format("{} names element {}, which no section has", what, element));
  if (zone.has_overlapping_blocks)
    tree.fail(fmt::format("{} names element {}, but element numbers of several sections overlap", what, element));
  const Element_block& block = *std::prev(after);
  if (!block.face_of.empty())
    return block.face_of[static_cast<std::size_t>(element - block.first)];
  return block.first_face == no_index ? no_index : block.first_face + element - block.first;
}

} // namespace recurve::internal::cgns
