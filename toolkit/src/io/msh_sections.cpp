// The sections of an MSH file: entities, nodes, elements, periodic links.
#include "msh_reading.h"
#include "msh_types.h"

#include <recurve/elements/node_layout.h>

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <span>

namespace recurve::internal::msh {

namespace {

void read_entity(Msh_reading& r, int dimension, bool is_partitioned)
{
  const int tag = r.get_int("the number of an entity");
  if (is_partitioned)
  {
    const int parent_dimension = r.get_int("the dimension of a parent");
    r.get_int("the number of a parent");
    if (parent_dimension != dimension)
      r.between_partitions.insert({dimension, tag});
    const Index partitions = r.get_count(1, "partitions");
    for (Index m = 0; m < partitions; ++m)
      r.get_int("a partition");
  }
  for (int m = 0; m < (dimension == 0 ? 3 : 6); ++m)
    r.get<double>("a coordinate of an entity");
  const Index groups = r.get_count(1, "physical groups");
  int& physical = r.physical_of[{dimension, tag}];
  for (Index m = 0; m < groups; ++m)
  {
    const int number = r.get_int("the number of a physical group"); // negative: the orientation is reversed
    if (m == 0)
      physical = number == std::numeric_limits<int>::min() ? 0 : std::abs(number);
  }
  r.in_several_groups += groups > 1 && dimension >= 2;
  if (dimension == 0)
    return;
  const Index boundary = r.get_count(1, "bounding entities");
  for (Index m = 0; m < boundary; ++m)
    r.get_int("the number of a bounding entity");
}

} // namespace

void read_entities(Msh_reading& r, bool is_partitioned)
{
  if (is_partitioned)
  {
    r.get_size("the number of partitions");
    const Index ghosts = r.get_count(2, "ghost entities");
    for (Index m = 0; m < 2 * ghosts; ++m)
      r.get_int("a ghost entity");
  }
  std::array<Index, 4> counts = {};
  for (Index& count : counts)
    count = r.get_count(5, "entities");
  for (int dimension = 0; dimension < 4; ++dimension)
    for (Index m = 0; m < counts[static_cast<std::size_t>(dimension)]; ++m)
      read_entity(r, dimension, is_partitioned);
}

// Nodes.
// ---------------------------------------------------------------------------------------------------------------

namespace {

Point read_point(Msh_reading& r, Index number)
{
  Point point;
  for (std::size_t axis = 0; axis < 3; ++axis)
  {
    point[axis] = r.get<double>("a coordinate");
    if (!std::isfinite(point[axis]))
      r.in.fail(fmt::format("node {}: coordinate {} is {}", number, "XYZ"[axis], point[axis]));
  }
  return point;
}

void read_nodes_4(Msh_reading& r, std::vector<Index>& numbers)
{
  const Index blocks = r.get_count(4, "blocks of nodes");
  const Index count = r.get_count(r.is_binary ? 6 : 4, "nodes");
  r.get_size("the smallest number of a node");
  r.get_size("the largest number of a node");
  numbers.reserve(static_cast<std::size_t>(count));
  r.nodes.reserve(static_cast<std::size_t>(count));
  for (Index b = 0; b < blocks; ++b)
  {
    const int dimension = r.get_int("the dimension of an entity");
    r.get_int("the number of an entity");
    const int is_parametric = r.get_int("whether nodes are parametric");
    const Index size = r.get_count(4, "nodes of a block");
    if (size > count - static_cast<Index>(numbers.size()))
      r.in.fail(fmt::format("blocks have more nodes than the {} that $Nodes states", count));
    for (Index m = 0; m < size; ++m)
      numbers.push_back(r.get_size("the number of a node"));
    for (Index m = 0; m < size; ++m)
    {
      r.nodes.push_back(read_point(r, numbers[r.nodes.size()]));
      for (int p = 0; p < std::min(dimension, 3) && is_parametric != 0; ++p)
        r.get<double>("a parameter of a node");
    }
  }
  if (static_cast<Index>(numbers.size()) != count)
    r.in.fail(fmt::format("blocks have {} nodes, $Nodes states {}", numbers.size(), count));
}

/// a count that version 2 writes as text even into binary files.
Index read_count_2(Msh_reading& r, std::uint64_t bytes, std::string_view what)
{
  const auto count = r.in.parse<Index>(fmt::format("the number of {}", what));
  if (count < 0)
    r.in.fail_in_text(fmt::format("{} {}", count, what));
  r.in.check_count(static_cast<std::uint64_t>(count), bytes, what);
  std::string rest;
  if (r.is_binary)
    r.in.read_line(rest);
  return count;
}

void read_nodes_2(Msh_reading& r, std::vector<Index>& numbers)
{
  const Index count = read_count_2(r, r.is_binary ? 28 : 8, "nodes");
  numbers.reserve(static_cast<std::size_t>(count));
  r.nodes.reserve(static_cast<std::size_t>(count));
  for (Index m = 0; m < count; ++m)
  {
    numbers.push_back(r.is_binary ? r.in.read<std::int32_t>() : r.in.parse<Index>("the number of a node"));
    r.nodes.push_back(read_point(r, numbers.back()));
  }
}

} // namespace

void read_nodes(Msh_reading& r)
{
  if (r.has_nodes)
    r.in.fail("has $Nodes twice");
  r.has_nodes = true;
  std::vector<Index> numbers;
  if (r.version == 41)
    read_nodes_4(r, numbers);
  else
    read_nodes_2(r, numbers);
  r.numbers = Node_numbers(std::move(numbers), r.nodes);
  if (r.numbers.first_duplicate() != no_index)
    r.in.fail(fmt::format("has two nodes of number {}", r.numbers.first_duplicate()));
}

// Elements.
// ------------------------------------------------------------------------------------------------------------

namespace {

int width_of_left_out(Msh_reading& r, int number)
{
  if (number == point_number)
    return 1;
  if (const auto type = find_type(number); type && reference_element(type->type).dimension == 1)
    return node_count(type->type, type->degree);
  r.in.fail(fmt::format("elements of type {} are not read: of lines, triangles, quadrangles, tetrahedra, pyramids, "
                        "prisms and hexahedra only complete ones up to degree {}",
                        number, max_degree));
}

/// Elements of one block: their type and where they go.
class Element_sink
{
public:
  Element_sink(Msh_reading& r, int number, int physical, int entity) : r_(r), number_(number)
  {
    type_ = find_type(number);
    if (!type_ || reference_element(type_->type).dimension < 2)
    {
      width_ = width_of_left_out(r, number);
      type_.reset();
      return;
    }
    width_ = node_count(type_->type, type_->degree);
    check_degree();
    const int dimension = reference_element(type_->type).dimension;
    is_between_partitions_ = r.between_partitions.count({dimension, entity}) > 0 && physical == 0;
    const Group_key key = {dimension, physical, physical != 0 ? 0 : dimension == 3 ? 0 : entity, type_->type};
    const auto [entry, is_new] = r.group_numbers.try_emplace(key, r.groups.size());
    if (is_new)
      r.groups.push_back({key, {}});
    group_ = entry->second;
    order_ = foreign_of_canonical(Node_order::gmsh, type_->type, type_->degree);
  }

  int width() const { return width_; }

  void expect(Index count)
  {
    if (type_)
    {
      std::vector<Index>& nodes = r_.groups[group_].second;
      nodes.reserve(nodes.size() + static_cast<std::size_t>(count * width_));
    }
  }

  /// \param numbers  of the nodes in the file, in Gmsh's order
  void add(Index element, std::span<const Index> numbers)
  {
    if (!type_ || is_between_partitions_)
    {
      ++(type_ ? r_.partition_faces : r_.lower_elements);
      return;
    }
    std::vector<Index>& nodes = r_.groups[group_].second;
    for (const int foreign : order_)
    {
      const Index number = numbers[static_cast<std::size_t>(foreign)];
      const Index node = r_.numbers.find(number);
      if (node == no_index)
        r_.in.fail(fmt::format("element {}: node {} of the element is number {}, which $Nodes does not have", element,
                               foreign + 1, number));
      nodes.push_back(node);
    }
  }

private:
  void check_degree()
  {
    if (r_.degree != 0 && r_.degree != type_->degree)
      r_.in.fail(fmt::format("elements of type {}, of degree {}, in a mesh of degree {}: only meshes of one degree are "
                             "read",
                             number_, type_->degree, r_.degree));
    r_.degree = type_->degree;
  }

  Msh_reading& r_;
  int number_;
  std::optional<Msh_type> type_;
  int width_ = 0;
  bool is_between_partitions_ = false;
  std::size_t group_ = 0;
  std::span<const int> order_;
};

void read_elements_4(Msh_reading& r)
{
  const Index blocks = r.get_count(4, "blocks of elements");
  const Index count = r.get_count(2, "elements");
  r.get_size("the smallest number of an element");
  r.get_size("the largest number of an element");
  Index done = 0;
  std::vector<Index> numbers;
  for (Index b = 0; b < blocks; ++b)
  {
    const int dimension = r.get_int("the dimension of an entity");
    const int entity = r.get_int("the number of an entity");
    const int type = r.get_int("the type of elements");
    const auto physical = r.physical_of.find({dimension, entity});
    Element_sink sink(r, type, physical == r.physical_of.end() ? 0 : physical->second, entity);
    const Index size = r.get_count(static_cast<std::uint64_t>(1 + sink.width()), "elements of a block");
    if (size > count - done)
      r.in.fail(fmt::format("blocks have more elements than the {} that $Elements states", count));
    sink.expect(size);
    numbers.resize(static_cast<std::size_t>(sink.width()));
    for (Index m = 0; m < size; ++m)
    {
      const Index element = r.get_size("the number of an element");
      for (Index& number : numbers)
        number = r.get_size("the number of a node");
      sink.add(element, numbers);
    }
    done += size;
  }
  if (done != count)
    r.in.fail(fmt::format("blocks have {} elements, $Elements states {}", done, count));
}

int physical_of_tags(std::span<const Index> tags)
{
  return tags.empty() ? 0 : static_cast<int>(std::abs(tags[0]));
}

int entity_of_tags(std::span<const Index> tags)
{
  return tags.size() < 2 ? 0 : static_cast<int>(tags[1]);
}

/// Version 2 gives every element its own tags; neighbours mostly have the same.
class Sink_cache
{
public:
  explicit Sink_cache(Msh_reading& r) : r_(r) {}

  Element_sink& find(int type, std::span<const Index> tags)
  {
    const std::array<int, 3> key = {type, physical_of_tags(tags), entity_of_tags(tags)};
    if (!sink_ || key != key_)
    {
      sink_.emplace(r_, type, key[1], key[2]);
      key_ = key;
    }
    return *sink_;
  }

private:
  Msh_reading& r_;
  std::optional<Element_sink> sink_;
  std::array<int, 3> key_ = {};
};

void check_tags(Msh_reading& r, Index count)
{
  if (count < 0)
    r.in.fail(fmt::format("an element of {} tags", count));
  r.in.check_count(static_cast<std::uint64_t>(count), 2, "tags of an element");
}

Index tag_value(Msh_reading& r, Index value)
{
  if (value <= std::numeric_limits<int>::min() || value > std::numeric_limits<int>::max())
    r.in.fail(fmt::format("an element has the tag {}", value));
  return value;
}

void read_elements_2_text(Msh_reading& r, Index count)
{
  Sink_cache sinks(r);
  std::vector<Index> tags, numbers;
  for (Index m = 0; m < count; ++m)
  {
    const auto element = r.in.parse<Index>("the number of an element");
    const int type = r.in.parse<int>("the type of an element");
    const auto tag_count = r.in.parse<Index>("the number of tags");
    check_tags(r, tag_count);
    tags.resize(static_cast<std::size_t>(tag_count));
    for (Index& tag : tags)
      tag = tag_value(r, r.in.parse<Index>("a tag"));
    Element_sink& sink = sinks.find(type, tags);
    numbers.resize(static_cast<std::size_t>(sink.width()));
    for (Index& number : numbers)
      number = r.in.parse<Index>("the number of a node");
    sink.add(element, numbers);
  }
}

void read_elements_2_binary(Msh_reading& r, Index count)
{
  Sink_cache sinks(r);
  std::vector<Index> tags, numbers;
  for (Index done = 0; done < count;)
  {
    const int type = r.in.read<std::int32_t>();
    const Index size = r.in.read<std::int32_t>();
    const Index tag_count = r.in.read<std::int32_t>();
    if (size < 1 || size > count - done)
      r.in.fail(
        fmt::format("a block of {} elements, where {} are left of those that $Elements states", size, count - done));
    check_tags(r, tag_count);
    tags.resize(static_cast<std::size_t>(tag_count));
    for (Index m = 0; m < size; ++m)
    {
      const Index element = r.in.read<std::int32_t>();
      for (Index& tag : tags)
        tag = tag_value(r, r.in.read<std::int32_t>());
      Element_sink& sink = sinks.find(type, tags);
      numbers.resize(static_cast<std::size_t>(sink.width()));
      for (Index& number : numbers)
        number = r.in.read<std::int32_t>();
      sink.add(element, numbers);
    }
    done += size;
  }
}

} // namespace

void read_elements(Msh_reading& r)
{
  if (r.has_elements)
    r.in.fail("has $Elements twice");
  if (!r.has_nodes)
    r.in.fail("has $Elements before $Nodes");
  r.has_elements = true;
  if (r.version == 41)
    return read_elements_4(r);
  const Index count = read_count_2(r, r.is_binary ? 8 : 6, "elements");
  if (r.is_binary)
    read_elements_2_binary(r, count);
  else
    read_elements_2_text(r, count);
}

// Periodic links.
// ------------------------------------------------------------------------------------------------------

namespace {

Link_data read_link_4(Msh_reading& r)
{
  Link_data link;
  link.affine.resize(static_cast<std::size_t>(r.get_count(2, "numbers of a transformation")));
  for (double& value : link.affine)
    value = r.get<double>("a number of a transformation");
  const Index count = r.get_count(2, "nodes of a periodic link");
  for (Index m = 0; m < count; ++m)
  {
    const Index node = r.get_size("the number of a node");
    link.nodes.push_back({node, r.get_size("the number of a node")});
  }
  return link;
}

Link_data read_link_2(Msh_reading& r)
{
  Link_data link;
  std::string_view word = r.in.read_word();
  if (word == "Affine")
  {
    for (int m = 0; m < 16; ++m)
      link.affine.push_back(r.in.parse<double>("a number of a transformation"));
    word = r.in.read_word();
  }
  Index count = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), count);
  if (error != std::errc() || end != word.data() + word.size() || count < 0)
    r.in.fail_in_text("the number of nodes of a periodic link is expected");
  r.in.check_count(static_cast<std::uint64_t>(count), 4, "nodes of a periodic link");
  for (Index m = 0; m < count; ++m)
  {
    const auto node = r.in.parse<Index>("the number of a node");
    link.nodes.push_back({node, r.in.parse<Index>("the number of a node")});
  }
  return link;
}

} // namespace

void read_periodic(Msh_reading& r)
{
  const bool is_4 = r.version == 41;
  const Index count = is_4 ? r.get_count(5, "periodic links") : r.in.parse<Index>("the number of periodic links");
  for (Index m = 0; m < count; ++m)
  {
    const int dimension = is_4 ? r.get_int("the dimension of a link") : r.in.parse<int>("the dimension of a link");
    for (int end = 0; end < 2; ++end)
      is_4 ? r.get_int("the number of an entity") : r.in.parse<int>("the number of an entity");
    Link_data link = is_4 ? read_link_4(r) : read_link_2(r);
    if (dimension == 2)
      r.links.push_back(std::move(link));
  }
}

} // namespace recurve::internal::msh
