#include "cgns_element_codes.h"
#include "cgns_names.h"
#include "cgns_reading.h"

#include <recurve/elements/node_layout.h>

#include <cgnslib.h>
#include <fmt/format.h>

#include <algorithm>
#include <limits>

namespace recurve::internal::cgns {

namespace {

/// A CGNS element type that is read.
struct Known_type
{
  int code;
  Element_type type;
  int degree;

  int width() const { return node_count(type, degree); }
};

/// What the parts of a split mixed section are called; as `Element_type`.
constexpr std::array<const char*, 7> suffixes = {"bar", "tri", "quad", "tetra", "pyra", "penta", "hexa"};

constexpr std::array<Known_type, 28> known_types = [] {
  std::array<Known_type, 28> types = {};
  std::size_t row = 0;
  for (const Element_type type : all_element_types)
    for (int degree = 1; degree <= largest_cgns_degree; ++degree)
      types[row++] = {element_code(type, degree), type, degree};
  return types;
}();

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
      fmt::format("{}: element type {}: of elements of high order only complete families are read", where, name));
  tree.fail(fmt::format("{}: unknown element type {}", where, name));
}

/// the row of `known_types`, or null for NODE. All elements of a mesh have the degree of the first.
const Known_type* find_type(Cgns_reading& reading, const std::string& where, std::int64_t code)
{
  if (code == NODE)
    return nullptr;
  const auto type = std::find_if(known_types.begin(), known_types.end(),
                                 [code](const Known_type& known) { return known.code == code; });
  if (type == known_types.end())
    refuse_type(reading.tree, where, code);
  if (type->degree > reading.largest_degree)
    reading.tree.fail(fmt::format(
      "{}: element type {}: the mesh is of high order already, only linear ones can be read", where, code_name(code)));
  if (reading.degree != 0 && type->degree != reading.degree)
    reading.tree.fail(
      fmt::format("{}: element type {}, of degree {}, in a mesh of degree {}: only meshes of one degree "
                  "can be read",
                  where, code_name(code), type->degree, reading.degree));
  reading.degree = type->degree;
  return &*type;
}

template <class Zone>
auto& sections_for(Zone& zone, Element_type type)
{
  const int dimension = reference_element(type).dimension;
  return dimension == 3 ? zone.cells : dimension == 2 ? zone.faces : zone.bars;
}

/// Elements of one type while they are read: corners, and of high order also all nodes, in canonical order.
class Section_builder
{
public:
  Section_builder(const Known_type& type, Index count) : type_(&type)
  {
    linear_.type = type.type;
    linear_.nodes.reserve(static_cast<std::size_t>(count * corner_count(type.type)));
    if (type.degree == 1)
      return;
    curved_.type = type.type;
    curved_.nodes.reserve(static_cast<std::size_t>(count * type.width()));
    order_ = foreign_of_canonical(Node_order::cgns, type.type, type.degree);
  }

  /// \param nodes  of one element as the file has them, counted from 1
  void add(std::span<const std::int64_t> nodes)
  {
    for (std::size_t c = 0; c < static_cast<std::size_t>(corner_count(type_->type)); ++c)
      linear_.nodes.push_back(nodes[c] - 1);
    for (const int foreign : order_)
      curved_.nodes.push_back(nodes[static_cast<std::size_t>(foreign)] - 1);
  }

  void finish(const std::string& name, Zone_reading& zone)
  {
    linear_.name = curved_.name = name;
    sections_for(zone.zone, type_->type).push_back(std::move(linear_));
    if (type_->degree > 1)
      sections_for(zone.elements, type_->type).push_back(std::move(curved_));
  }

private:
  const Known_type* type_;
  std::span<const int> order_; ///< empty for linear elements
  Section linear_;
  Curved_section curved_;
};

bool is_face(Element_type type)
{
  return reference_element(type).dimension == 2;
}

Section_node open_section(Cgns_reading& reading, const Zone_reading& zone, const Cgns_node& node)
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
    find_type(reading, section.where, section.code);

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
void read_plain(Cgns_reading& reading, const Section_node& section, Zone_reading& zone)
{
  const Cgns_tree& tree = reading.tree;
  Element_block block = {
    .name = section.node.name(), .first = section.first, .last = section.last, .first_face = no_index, .face_of = {}};
  const Known_type* type = find_type(reading, section.where, section.code);
  if (type != nullptr)
  {
    const int width = type->width();
    const Index stored = tree.shape(section.connectivity).size();
    if (section.count() > stored || stored != section.count() * width)
      tree.fail(fmt::format("{}: {} elements {} take {} node numbers, but the file has {}", section.where,
                            section.count(), code_name(section.code), section.count() * width, stored));
    if (is_face(type->type))
      block.first_face = zone.zone.face_count();
    Section_builder result(*type, section.count());
    std::vector<std::int64_t> element; // its nodes may stand in two pieces
    tree.visit_integers(section.connectivity, [&](Index begin, std::span<const std::int64_t> piece) {
      for (std::size_t m = 0; m < piece.size(); ++m)
      {
        const Index entry = begin + static_cast<Index>(m);
        check_node(tree, section, entry / width, static_cast<int>(entry % width), piece[m], zone.point_count());
        element.push_back(piece[m]);
        if (static_cast<int>(element.size()) < width)
          continue;
        result.add(element);
        element.clear();
      }
    });
    if (section.count() > 0)
      result.finish(section.node.name(), zone);
  }
  zone.blocks.push_back(std::move(block));
}

/// calls f(number of the element in the section, type or null for NODE, nodes) for each element of a mixed section.
template <class Function>
void visit_mixed(Cgns_reading& reading, const Section_node& section, const Function& f)
{
  const Cgns_tree& tree = reading.tree;
  Index element = 0;
  const Known_type* type = nullptr;
  std::array<std::int64_t, 125> nodes = {}; // of a HEXA_125
  std::size_t wanted = 0, have = 0;         // nodes of the running element; 0 wanted: its type comes next
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
        type = find_type(reading, where, code);
        wanted = type == nullptr ? 1 : static_cast<std::size_t>(type->width());
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

/// splits a mixed section into one section per type, in the order of `known_types`.
void read_mixed(Cgns_reading& reading, const Section_node& section, Zone_reading& zone)
{
  const Cgns_tree& tree = reading.tree;
  if (section.count() > tree.shape(section.connectivity).size())
    tree.fail(fmt::format("{}: {} elements, but the connectivity has {} entries", section.where, section.count(),
                          tree.shape(section.connectivity).size()));
  // The first pass counts, so that each array is allocated once.
  std::array<Index, known_types.size()> counts = {};
  const auto row_of = [](const Known_type* type) { return static_cast<std::size_t>(type - known_types.data()); };
  visit_mixed(reading, section, [&](Index, const Known_type* type, std::span<const std::int64_t>) {
    if (type != nullptr)
      ++counts[row_of(type)];
  });

  std::vector<Section_builder> parts;
  std::array<Index, known_types.size()> next_face = {};
  Index face_count = zone.zone.face_count();
  bool has_faces = false;
  for (std::size_t t = 0; t < known_types.size(); ++t)
  {
    parts.emplace_back(known_types[t], counts[t]);
    next_face[t] = face_count;
    if (is_face(known_types[t].type) && counts[t] > 0)
    {
      has_faces = true;
      face_count += counts[t];
    }
  }
  Element_block block = {
    .name = section.node.name(), .first = section.first, .last = section.last, .first_face = no_index, .face_of = {}};
  if (has_faces)
    block.face_of.assign(static_cast<std::size_t>(section.count()), no_index);
  visit_mixed(reading, section, [&](Index element, const Known_type* type, std::span<const std::int64_t> nodes) {
    for (std::size_t m = 0; m < nodes.size(); ++m)
      check_node(tree, section, element, static_cast<int>(m), nodes[m], zone.point_count());
    if (type == nullptr)
      return;
    const std::size_t t = row_of(type);
    parts[t].add(nodes);
    if (is_face(type->type))
      block.face_of[static_cast<std::size_t>(element)] = next_face[t]++;
  });

  const auto kinds = std::count_if(counts.begin(), counts.end(), [](Index count) { return count > 0; });
  for (std::size_t t = 0; t < parts.size(); ++t)
  {
    if (counts[t] == 0)
      continue;
    const std::string suffix = fmt::format("_{}", suffixes[static_cast<std::size_t>(known_types[t].type)]);
    const std::string name = section.node.name();
    parts[t].finish(
      kinds == 1 ? name : section_names(zone.zone).take(cut_name(name, longest_cgns_name - suffix.size()) + suffix),
      zone);
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
      read_plain(reading, sections[s], zone);
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
