#include <recurve/run/feature_file.h>

#include <recurve/core/exceptions.h>
#include <recurve/io/pending_file.h>

#include <fmt/format.h>

#include <toml++/toml.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <utility>

namespace recurve {

namespace {

using Kind = Feature_edit_kind;

constexpr std::array<std::pair<std::string_view, Kind>, 7> kinds = {{{"edges", Kind::edges},
                                                                     {"path", Kind::shortest_path},
                                                                     {"crease", Kind::crease_path},
                                                                     {"chain", Kind::chain},
                                                                     {"box", Kind::box},
                                                                     {"patches", Kind::patches},
                                                                     {"vertices", Kind::vertices}}};

constexpr const char* kind_names = "edges, path, crease, chain, box, patches, vertices";

/// One file on its way from TOML.
class Reader
{
public:
  explicit Reader(std::string name) : name_(std::move(name)) {}

  Feature_file read(const toml::table& table) const
  {
    Feature_file file;
    for (const auto& [key, value] : table)
    {
      if (key == "start")
        file.starts_from_detection = one_of(value, "auto", "none");
      else if (key == "turning_angle")
        file.options.turning_angle = number(value, "turning_angle");
      else if (key == "chain_angle")
        file.options.chain_angle = number(value, "chain_angle");
      else if (key == "corner_defect")
        file.options.corner_defect = number(value, "corner_defect");
      else if (key == "tolerance")
        file.options.tolerance = number(value, "tolerance");
      else if (key == "edit")
        for (const toml::node& edit : array(value, "edits are written as [[edit]]"))
          file.edits.push_back(read_edit(edit));
      else
        fail(value, fmt::format("unknown key \"{}\"; keys are start, turning_angle, chain_angle, corner_defect, "
                                "tolerance and [[edit]]",
                                key.str()));
    }
    check_options(file.options);
    return file;
  }

private:
  [[noreturn]] void fail(const toml::node& at, const std::string& message) const
  {
    throw Format_error(fmt::format("{}, line {}: {}", name_, at.source().begin.line, message));
  }

  void check_options(const Feature_edit_options& options) const
  {
    try
    {
      check(options);
    }
    catch (const Input_error& error)
    {
      throw Format_error(fmt::format("{}: {}", name_, error.what()));
    }
  }

  const toml::array& array(const toml::node& node, const std::string& expected) const
  {
    if (!node.is_array())
      fail(node, "expected an array: " + expected);
    return *node.as_array();
  }

  double number(const toml::node& node, const std::string& what) const
  {
    const auto value = node.is_number() ? node.value<double>() : std::nullopt;
    if (!value || !std::isfinite(*value))
      fail(node, what + " must be a finite number");
    return *value;
  }

  Index whole_number(const toml::node& node, const std::string& what) const
  {
    const auto value = node.is_integer() ? node.value<std::int64_t>() : std::nullopt;
    if (!value || *value < 0)
      fail(node, what + " must be a whole number, counted from 0");
    return *value;
  }

  std::string text(const toml::node& node, const std::string& what) const
  {
    if (!node.is_string())
      fail(node, what + " must be a string");
    return *node.value<std::string>();
  }

  /// true for the first word, false for the second.
  bool one_of(const toml::node& node, const std::string& first, const std::string& second) const
  {
    const auto word = node.value<std::string>();
    if (!word || (*word != first && *word != second))
      fail(node, fmt::format("expected \"{}\" or \"{}\", found {}", first, second,
                             word ? '"' + *word + '"' : std::string("no text")));
    return *word == first;
  }

  Point point(const toml::node& node) const
  {
    const toml::array& numbers = array(node, "a point is written as [x, y, z]");
    if (numbers.size() != 3)
      fail(node, fmt::format("a point has three coordinates, found {}", numbers.size()));
    return {number(numbers[0], "a coordinate"), number(numbers[1], "a coordinate"), number(numbers[2], "a coordinate")};
  }

  Feature_file_edit read_edit(const toml::node& node) const
  {
    if (!node.is_table())
      fail(node, "edits are written as [[edit]]");
    const toml::table& table = *node.as_table();
    Feature_file_edit result;
    result.edit.origin = fmt::format("{}, line {}", name_, node.source().begin.line);
    const toml::node* subject = nullptr;
    const toml::node* action = table.get("action");
    for (const auto& [key, value] : table)
    {
      const auto kind =
        std::find_if(kinds.begin(), kinds.end(), [&k = key](const auto& known) { return k == known.first; });
      if (kind != kinds.end())
      {
        if (subject)
          fail(value, fmt::format("an edit changes one thing: only one of {}", kind_names));
        result.edit.kind = kind->second;
        subject = &value;
      }
      else if (key == "angle")
        result.edit.angle = number(value, "angle");
      else if (key != "action")
        fail(value, fmt::format("unknown key \"{}\"; an edit has action, one of {}, and angle", key.str(), kind_names));
    }
    if (!subject)
      fail(node, fmt::format("the edit does not say what it changes: one of {}", kind_names));
    if (!action)
      fail(node, "the edit has no action");
    read_action(*action, result.edit);
    read_subject(*subject, result);
    check_edit(node, result.edit);
    return result;
  }

  void read_action(const toml::node& node, Feature_edit& edit) const
  {
    edit.is_added = edit.kind == Kind::vertices ? one_of(node, "mark", "unmark") : one_of(node, "add", "remove");
  }

  void check_edit(const toml::node& node, const Feature_edit& edit) const
  {
    const bool takes_angle = edit.kind == Kind::chain || edit.kind == Kind::box || edit.kind == Kind::patches;
    if (edit.angle && !takes_angle)
      fail(node, "angle belongs to chain, box and patches");
    if (edit.angle && !(*edit.angle >= 0 && *edit.angle <= 180))
      fail(node, fmt::format("angle must be between 0 and 180 degrees, found {}", *edit.angle));
  }

  void read_subject(const toml::node& node, Feature_file_edit& result) const
  {
    switch (result.edit.kind)
    {
    case Kind::edges:
      for (const toml::node& edge : array(node, "edges are written as [[end, end], ...]"))
        read_vertices(edge, 2, 2, "an edge is written as [end, end]", result);
      if (result.edit.vertices.empty())
        fail(node, "no edge is named");
      break;
    case Kind::shortest_path:
    case Kind::crease_path: read_vertices(node, 2, no_index, "a path has two or more way points", result); break;
    case Kind::chain: read_vertices(node, 2, 2, "a chain grows from one edge, written as [end, end]", result); break;
    case Kind::vertices: read_vertices(node, 1, no_index, "vertices are written as [vertex, ...]", result); break;
    case Kind::box: read_box(node, result.edit); break;
    case Kind::patches: read_patches(node, result); break;
    }
  }

  void read_vertices(const toml::node& node, Index least, Index most, const std::string& expected,
                     Feature_file_edit& result) const
  {
    const toml::array& list = array(node, expected);
    const auto size = static_cast<Index>(list.size());
    if (size < least || (most != no_index && size > most))
      fail(node, fmt::format("{}, but {} found", expected, size == 1 ? "1 is" : fmt::format("{} are", size)));
    for (const toml::node& vertex : list)
      read_vertex(vertex, result);
  }

  void read_vertex(const toml::node& node, Feature_file_edit& result) const
  {
    Vertex_name& name = result.edit.vertices.emplace_back();
    Zone_node& zone_node = result.nodes.emplace_back();
    if (!node.is_table())
    {
      name.position = point(node);
      return;
    }
    const toml::table& table = *node.as_table();
    for (const auto& [key, value] : table)
      if (key == "at")
        name.position = point(value);
      else if (key == "copy")
        name.copy = whole_number(value, "copy");
      else if (key == "zone")
        zone_node.zone = text(value, "zone");
      else if (key == "node")
        zone_node.node = whole_number(value, "node");
      else
        fail(value, fmt::format("unknown key \"{}\" of a vertex", key.str()));
    const bool by_node = zone_node.node != no_index && !zone_node.zone.empty() && table.size() == 2;
    const bool by_position = table.contains("at") && !table.contains("zone") && !table.contains("node");
    if (!by_node && !by_position)
      fail(node, "a vertex is written as [x, y, z], {at = [x, y, z], copy = 0} or {zone = \"name\", node = 0}");
  }

  void read_box(const toml::node& node, Feature_edit& edit) const
  {
    const toml::array& corners = array(node, "a box is written as [[x, y, z], [x, y, z]]");
    if (corners.size() != 2)
      fail(node, fmt::format("a box has two corners, found {}", corners.size()));
    edit.smallest = point(corners[0]);
    edit.largest = point(corners[1]);
    for (int i = 0; i < 3; ++i)
      if (edit.smallest[i] > edit.largest[i])
        fail(node, "the first corner of a box has the smaller coordinates");
  }

  void read_patches(const toml::node& node, Feature_file_edit& result) const
  {
    const toml::array& names = array(node, "patches are written as [\"one\", \"other\"]");
    if (names.empty() || names.size() > 2)
      fail(node, fmt::format("one or two patches are named, found {}", names.size()));
    for (std::size_t i = 0; i < names.size(); ++i)
    {
      result.patches[i] = text(names[i], "the name of a patch");
      if (result.patches[i].empty())
        fail(node, "the name of a patch is empty");
    }
  }

  std::string name_;
};

/// a number that TOML reads as a float, and as the same one.
std::string written(double x)
{
  std::string text = fmt::format("{:.17g}", x);
  if (text.find_first_of(".e") == std::string::npos)
    text += ".0";
  return text;
}

std::string written(const Point& p)
{
  return fmt::format("[{}, {}, {}]", written(p[0]), written(p[1]), written(p[2]));
}

std::string written(const std::string& name)
{
  std::string text = "\"";
  for (const char c : name)
    if (c == '"' || c == '\\')
      text += {'\\', c};
    else if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f)
      text += fmt::format("\\u{:04X}", static_cast<unsigned>(c));
    else
      text += c;
  return text + '"';
}

std::string written_vertex(const Feature_file_edit& edit, std::size_t i)
{
  if (i < edit.nodes.size() && !edit.nodes[i].zone.empty())
    return fmt::format("{{zone = {}, node = {}}}", written(edit.nodes[i].zone), edit.nodes[i].node);
  const Vertex_name& name = edit.edit.vertices[i];
  if (name.copy != no_index)
    return fmt::format("{{at = {}, copy = {}}}", written(name.position), name.copy);
  return written(name.position);
}

/// the vertices of an edit, `group` of them in brackets of their own, a line each.
std::string written_vertices(const Feature_file_edit& edit, std::size_t group)
{
  std::string text = "[";
  for (std::size_t i = 0; i < edit.edit.vertices.size(); ++i)
  {
    text += i == 0 ? "" : i % group == 0 ? ",\n  " : ", ";
    text += (group > 1 && i % group == 0 ? "[" : "") + written_vertex(edit, i);
    text += group > 1 && i % group == group - 1 ? "]" : "";
  }
  return text + "]";
}

std::string written_subject(const Feature_file_edit& edit)
{
  switch (edit.edit.kind)
  {
  case Kind::edges: return written_vertices(edit, 2);
  case Kind::box: return fmt::format("[{}, {}]", written(edit.edit.smallest), written(edit.edit.largest));
  case Kind::patches:
    return edit.patches[1].empty() ? fmt::format("[{}]", written(edit.patches[0]))
                                   : fmt::format("[{}, {}]", written(edit.patches[0]), written(edit.patches[1]));
  default: return written_vertices(edit, 1);
  }
}

std::string written_edit(const Feature_file_edit& edit)
{
  const bool is_of_vertices = edit.edit.kind == Kind::vertices;
  const auto kind = std::find_if(kinds.begin(), kinds.end(), [&](const auto& k) { return k.second == edit.edit.kind; });
  std::string text =
    fmt::format("\n[[edit]]\naction = \"{}\"\n{} = {}\n",
                edit.edit.is_added ? (is_of_vertices ? "mark" : "add") : (is_of_vertices ? "unmark" : "remove"),
                kind->first, written_subject(edit));
  if (edit.edit.angle)
    text += fmt::format("angle = {}\n", written(*edit.edit.angle));
  return text;
}

} // namespace

Feature_file parse_feature_file(std::string_view text, const std::string& name)
{
  try
  {
    return Reader(name).read(toml::parse(text, name));
  }
  catch (const toml::parse_error& error)
  {
    throw Format_error(fmt::format("{}, line {}: {}", name, error.source().begin.line, error.description()));
  }
}

Feature_file read_feature_file(const std::filesystem::path& file)
{
  std::ifstream stream(file, std::ios::binary);
  std::string text((std::istreambuf_iterator<char>(stream)), std::istreambuf_iterator<char>());
  if (!stream.is_open() || stream.bad() || std::filesystem::is_directory(file))
    throw Format_error(fmt::format("{}: cannot be read", file.string()));
  return parse_feature_file(text, file.string());
}

std::string to_toml(const Feature_file& file)
{
  std::string text = fmt::format(
    "# Changes to the feature curves of a mesh, for recurve.\nstart = \"{}\"\nturning_angle = {}\n"
    "chain_angle = {}\ncorner_defect = {}\ntolerance = {}\n",
    file.starts_from_detection ? "auto" : "none", written(file.options.turning_angle),
    written(file.options.chain_angle), written(file.options.corner_defect), written(file.options.tolerance));
  for (const Feature_file_edit& edit : file.edits)
    text += written_edit(edit);
  return text;
}

void write_feature_file(const Feature_file& features, const std::filesystem::path& file)
{
  Pending_file pending(file);
  std::ofstream stream(pending.path(), std::ios::binary);
  stream << to_toml(features);
  stream.close();
  if (!stream)
    throw Format_error(fmt::format("{}: cannot be written", file.string()));
  pending.commit();
}

} // namespace recurve
