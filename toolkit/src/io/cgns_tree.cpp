#include "cgns_tree.h"

#include "hdf5_file.h"

#include <cgns_io.h>
#include <cgnslib.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <dlfcn.h>
#include <fstream>
#include <numeric>

namespace recurve::internal::cgns {

namespace {

// Entries of a large array that are in memory at a time: 8 MiB of doubles, far above the cost of a call.
constexpr Index piece_length = Index(1) << 20;

// deflate cannot shrink data by more than a factor of 1032 (zlib's technical notes), so a file cannot hold more than
// that many times its own size; the next round figure.
constexpr double largest_compression = 1100;

std::string trimmed(std::string text)
{
  const auto end = text.find_last_not_of(std::string(" \t\n\0", 4));
  text.erase(end == std::string::npos ? 0 : end + 1);
  return text;
}

/// copies the native entries of a file into the type that the caller wants.
template <class Stored, class T>
void widen(const std::vector<char>& bytes, std::span<T> piece)
{
  for (std::size_t m = 0; m < piece.size(); ++m)
  {
    Stored value;
    std::memcpy(&value, bytes.data() + m * sizeof(Stored), sizeof(Stored));
    piece[m] = static_cast<T>(value); // NOLINT(bugprone-signed-char-misuse): texts go to char only
  }
}

bool is_integer(const std::string& type)
{
  return type == "I4" || type == "I8";
}

bool is_real(const std::string& type)
{
  return type == "R4" || type == "R8";
}

void check_readable(const std::filesystem::path& file)
{
  std::error_code error;
  if (std::filesystem::is_directory(file, error))
    throw Format_error(fmt::format("{}: is a directory", file.string()));
  errno = 0;
  const std::ifstream stream(file);
  if (!stream)
    throw Format_error(
      fmt::format("{}: cannot be opened: {}", file.string(), std::strerror(errno != 0 ? errno : ENOENT)));
}

} // namespace

std::mutex& cgns_mutex()
{
  static std::mutex mutex;
  // HDF5 1.10 crashes in its clean-up at exit after a file could not be closed (a full disk). All our files are closed
  // by then, so it may do without. The function comes with libcgns; its absence only means that nothing is to be done.
  [[maybe_unused]] static const int is_prepared = [] {
    const auto dont_atexit = reinterpret_cast<int (*)()>(dlsym(RTLD_DEFAULT, "H5dont_atexit"));
    return dont_atexit != nullptr ? dont_atexit() : 0;
  }();
  return mutex;
}

Index Cgns_array_shape::size() const
{
  return dimensions.empty() ? 0
                            : std::accumulate(dimensions.begin(), dimensions.end(), Index(1), std::multiplies<Index>());
}

Cgns_tree::Cgns_tree(const std::filesystem::path& file) : file_(file), lock_(cgns_mutex())
{
  check_readable(file);
  std::error_code error;
  const auto bytes = std::filesystem::file_size(file, error);
  file_size_ = error ? 0 : static_cast<double>(bytes);
  int type = CGIO_FILE_NONE;
  if (cgio_check_file(file.c_str(), &type) != CGIO_ERR_NONE || type == CGIO_FILE_NONE)
    fail("is no CGNS file (neither HDF5 nor ADF)");
  is_hdf5_ = type == CGIO_FILE_HDF5;
  if (is_hdf5_ && !has_sound_links(file))
    fail("cannot be opened as CGNS: the HDF5 file is damaged or cut short");
  check(cgio_open_file(file.c_str(), CGIO_MODE_READ, CGIO_FILE_NONE, &handle_), "cannot be opened as CGNS");
  if (cgio_get_root_id(handle_, &root_id_) != CGIO_ERR_NONE)
  {
    cgio_close_file(handle_);
    fail("has no root node");
  }
}

Cgns_tree::~Cgns_tree()
{
  cgio_close_file(handle_);
}

void Cgns_tree::fail(std::string_view message) const
{
  throw Format_error(fmt::format("{}: {}", file_.string(), message));
}

void Cgns_tree::check(int status, std::string_view what) const
{
  if (status == CGIO_ERR_NONE)
    return;
  std::array<char, CGIO_MAX_ERROR_LENGTH + 1> message = {};
  cgio_error_message(message.data());
  fail(fmt::format("{}: {}; the file is damaged or cut short", what, message.data()));
}

Cgns_node Cgns_tree::make_node(double id) const
{
  Cgns_node node;
  node.id_ = std::shared_ptr<const double>(new double(id), [handle = handle_](const double* p) {
    cgio_release_id(handle, *p);
    delete p;
  });
  // libcgns fills at most 32 characters and a terminator; the rest is for files that break that rule.
  std::array<char, 256> text = {};
  check(cgio_get_name(handle_, id, text.data()), "a node has no name");
  node.name_ = trimmed(text.data());
  text = {};
  check(cgio_get_label(handle_, id, text.data()), fmt::format("node '{}' has no label", node.name_));
  node.label_ = trimmed(text.data());
  int link_length = 0;
  if (cgio_is_link(handle_, id, &link_length) == CGIO_ERR_NONE && link_length > 0)
    has_links_ = true;
  return node;
}

Cgns_node Cgns_tree::root() const
{
  Cgns_node node;
  node.id_ = std::make_shared<const double>(root_id_);
  return node;
}

std::vector<Cgns_node> Cgns_tree::children(const Cgns_node& parent) const
{
  const std::string what = fmt::format("the nodes below '{}' cannot be listed", parent.name());
  int count = 0;
  check(cgio_number_children(handle_, *parent.id_, &count), what);
  std::vector<double> ids(static_cast<std::size_t>(std::max(count, 0)));
  int found = 0;
  if (count > 0)
    check(cgio_children_ids(handle_, *parent.id_, 1, count, &found, ids.data()), what);
  ids.resize(static_cast<std::size_t>(std::clamp(found, 0, std::max(count, 0))));
  std::vector<Cgns_node> result;
  result.reserve(ids.size());
  for (const double id : ids)
    result.push_back(make_node(id));
  return result;
}

std::vector<Cgns_node> Cgns_tree::children(const Cgns_node& parent, std::string_view label) const
{
  std::vector<Cgns_node> result = children(parent);
  std::erase_if(result, [&](const Cgns_node& node) { return node.label() != label; });
  return result;
}

std::unique_ptr<Cgns_node> Cgns_tree::child(const Cgns_node& parent, std::string_view name) const
{
  for (const Cgns_node& node : children(parent))
    if (node.name() == name)
      return std::make_unique<Cgns_node>(node);
  return nullptr;
}

std::unique_ptr<Cgns_node> Cgns_tree::child_with_label(const Cgns_node& parent, std::string_view label) const
{
  for (const Cgns_node& node : children(parent))
    if (node.label() == label)
      return std::make_unique<Cgns_node>(node);
  return nullptr;
}

Cgns_array_shape Cgns_tree::shape(const Cgns_node& node) const
{
  Cgns_array_shape result;
  std::array<char, 256> type = {};
  check(cgio_get_data_type(handle_, *node.id_, type.data()), fmt::format("node '{}' has no type", node.name()));
  result.type = trimmed(type.data());
  if (result.type == "MT" || result.type == "LK")
    return result;
  int count = 0;
  const std::string what = fmt::format("the array of node '{}' cannot be read", node.name());
  check(cgio_get_dimensions(handle_, *node.id_, &count, nullptr), what);
  if (count < 0 || count > CGIO_MAX_DIMENSIONS)
    fail(fmt::format("the array of node '{}' has {} dimensions", node.name(), count));
  std::array<cgsize_t, CGIO_MAX_DIMENSIONS> dimensions = {};
  if (count > 0)
    check(cgio_get_dimensions(handle_, *node.id_, &count, dimensions.data()), what);
  double size = 1;
  for (int m = 0; m < count; ++m)
  {
    const cgsize_t extent = dimensions[static_cast<std::size_t>(m)];
    if (extent < 0)
      fail(fmt::format("the array of node '{}' has a negative dimension, {}", node.name(), extent));
    result.dimensions.push_back(extent);
    size *= static_cast<double>(extent);
  }
  check_plausible_size(size, fmt::format("the array of node '{}'", node.name()));
  return result;
}

void Cgns_tree::check_plausible_size(double bytes, std::string_view what) const
{
  if (!has_links_ && bytes > largest_compression * file_size_)
    fail(fmt::format("{} would take {:.3g} bytes, the file has {:.3g}", what, bytes, file_size_));
}

template <class T>
void Cgns_tree::read_piece(const Cgns_node& node, const Cgns_array_shape& stored, Index begin, std::span<T> piece) const
{
  // Whole arrays of several dimensions are read in one go; pieces are of one dimension.
  const bool is_whole = static_cast<Index>(piece.size()) == stored.size();
  const cgsize_t start = static_cast<cgsize_t>(begin + 1), one = 1;
  const cgsize_t length = static_cast<cgsize_t>(piece.size()), end = static_cast<cgsize_t>(start + length - 1);
  const std::string what = fmt::format("the array of node '{}' cannot be read", node.name());
  if (is_hdf5_)
  {
    // HDF5 converts while reading. That also protects from arrays that are not of the type that their node states.
    const char* const type = std::is_same_v<T, double> ? "R8" : std::is_same_v<T, char> ? "C1" : "I8";
    check(is_whole ? cgio_read_all_data_type(handle_, *node.id_, type, piece.data())
                   : cgio_read_data_type(handle_, *node.id_, &start, &end, &one, type, 1, &length, &one, &length, &one,
                                         piece.data()),
          what);
    return;
  }
  const std::size_t entry = stored.type == "C1" ? 1 : stored.type.back() == '4' ? 4 : 8;
  std::vector<char> bytes(piece.size() * entry);
  check(is_whole
          ? cgio_read_all_data(handle_, *node.id_, bytes.data())
          : cgio_read_data(handle_, *node.id_, &start, &end, &one, 1, &length, &one, &length, &one, bytes.data()),
        what);
  if (stored.type == "C1")
    widen<char>(bytes, piece);
  else if (stored.type == "I4")
    widen<std::int32_t>(bytes, piece);
  else if (stored.type == "I8")
    widen<std::int64_t>(bytes, piece);
  else if (stored.type == "R4")
    widen<float>(bytes, piece);
  else
    widen<double>(bytes, piece);
}

template <class T>
void Cgns_tree::visit(const Cgns_node& node, bool integers,
                      const std::function<void(Index, std::span<const T>)>& f) const
{
  const Cgns_array_shape stored = shape(node);
  if (integers ? !is_integer(stored.type) : !is_real(stored.type))
    fail(fmt::format("the array of node '{}' has type {} instead of {}", node.name(), stored.type,
                     integers ? "I4 or I8" : "R4 or R8"));
  const Index size = stored.size();
  const Index step = stored.dimensions.size() == 1 ? piece_length : size;
  std::vector<T> piece;
  for (Index begin = 0; begin < size; begin += step)
  {
    piece.resize(static_cast<std::size_t>(std::min(step, size - begin)));
    read_piece<T>(node, stored, begin, piece);
    f(begin, piece);
  }
}

void Cgns_tree::visit_integers(const Cgns_node& node,
                               const std::function<void(Index, std::span<const std::int64_t>)>& f) const
{
  visit<std::int64_t>(node, true, f);
}

void Cgns_tree::visit_reals(const Cgns_node& node, const std::function<void(Index, std::span<const double>)>& f) const
{
  visit<double>(node, false, f);
}

std::vector<std::int64_t> Cgns_tree::read_integers(const Cgns_node& node) const
{
  std::vector<std::int64_t> result;
  visit_integers(
    node, [&](Index, std::span<const std::int64_t> piece) { result.insert(result.end(), piece.begin(), piece.end()); });
  return result;
}

std::vector<double> Cgns_tree::read_reals(const Cgns_node& node) const
{
  std::vector<double> result;
  visit_reals(node,
              [&](Index, std::span<const double> piece) { result.insert(result.end(), piece.begin(), piece.end()); });
  return result;
}

std::string Cgns_tree::read_text(const Cgns_node& node) const
{
  const Cgns_array_shape stored = shape(node);
  if (stored.type == "MT" || stored.size() == 0)
    return {};
  if (stored.type != "C1")
    fail(fmt::format("node '{}' has type {} instead of a text", node.name(), stored.type));
  std::string text(static_cast<std::size_t>(stored.size()), '\0');
  read_piece<char>(node, stored, 0, std::span<char>(text.data(), text.size()));
  return trimmed(text);
}

} // namespace recurve::internal::cgns
