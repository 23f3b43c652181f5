#include "hdf5_file.h"

#include "cgns_tree.h"

#include <recurve/core/exceptions.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace recurve::internal {

namespace {

/// Numbers that are made and written at a time.
constexpr Index piece = Index(1) << 17;

/// Deflate packs at most this many bytes into one; an array that claims more is not to be believed.
constexpr double largest_compression = 1032;

hid_t open_or_create(const std::filesystem::path& file, Hdf5_file::Mode mode)
{
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr); // HDF5 prints its errors otherwise
  return mode == Hdf5_file::Mode::read ? H5Fopen(file.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT)
                                       : H5Fcreate(file.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
}

herr_t go_on(hid_t, const char*, const H5O_info_t*, void*)
{
  return 0;
}

template <class Number>
hid_t memory_type()
{
  if constexpr (std::is_same_v<Number, double>)
    return H5T_NATIVE_DOUBLE;
  else
    return H5T_NATIVE_INT32;
}

template <class Number>
hid_t file_type()
{
  if constexpr (std::is_same_v<Number, double>)
    return H5T_IEEE_F64LE;
  else
    return H5T_STD_I32LE;
}

} // namespace

bool has_sound_links(const std::filesystem::path& file)
{
  const Hdf5_handle handle(open_or_create(file, Hdf5_file::Mode::read), H5Fclose);
  return handle >= 0 && H5Ovisit2(handle, H5_INDEX_NAME, H5_ITER_NATIVE, go_on, nullptr, H5O_INFO_BASIC) >= 0;
}

Hdf5_file::Hdf5_file(const std::filesystem::path& file, Mode mode)
  : path_(file), lock_(cgns::cgns_mutex()), file_(open_or_create(file, mode), H5Fclose)
{
  if (file_ < 0)
    fail(mode == Mode::read ? "is no HDF5 file, or a damaged one" : "cannot be created as an HDF5 file");
  std::error_code error;
  const auto bytes = std::filesystem::file_size(file, error);
  size_ = error ? 0 : static_cast<double>(bytes);
}

void Hdf5_file::fail(std::string_view message) const
{
  throw Format_error(fmt::format("{}: {}", path_.string(), message));
}

void Hdf5_file::check(bool is_good, const std::string& what) const
{
  if (!is_good)
    fail(what);
}

// Writing.
// -------------------------------------------------------------------------------------------------------------

namespace {

bool write_one(hid_t file, const std::string& name, hid_t type, const void* value)
{
  const hsize_t one = 1;
  const Hdf5_handle space(H5Screate_simple(1, &one, nullptr), H5Sclose);
  const Hdf5_handle attribute(H5Acreate2(file, name.c_str(), type, space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
  return attribute >= 0 && H5Awrite(attribute, type, value) >= 0;
}

Hdf5_handle text_type(std::size_t width)
{
  const hid_t type = H5Tcopy(H5T_C_S1);
  H5Tset_size(type, width);
  H5Tset_strpad(type, H5T_STR_SPACEPAD);
  return {type, H5Tclose};
}

} // namespace

void Hdf5_file::write_attribute(const std::string& name, std::int32_t value)
{
  check(write_one(file_, name, H5T_NATIVE_INT32, &value), fmt::format("attribute {} cannot be written", name));
}

void Hdf5_file::write_attribute(const std::string& name, double value)
{
  check(write_one(file_, name, H5T_NATIVE_DOUBLE, &value), fmt::format("attribute {} cannot be written", name));
}

void Hdf5_file::write_attribute(const std::string& name, const std::string& value)
{
  const Hdf5_handle type = text_type(value.size());
  check(write_one(file_, name, type, value.data()), fmt::format("attribute {} cannot be written", name));
}

template <class Number>
void Hdf5_file::write_array(const std::string& name, Index rows, Index columns,
                            const std::function<void(Index row, std::span<Number> values)>& fill)
{
  const std::string message = fmt::format("array {} cannot be written", name);
  const int dimension = columns > 0 ? 2 : 1;
  const Index width = std::max<Index>(columns, 1);
  const std::array<hsize_t, 2> shape = {static_cast<hsize_t>(rows), static_cast<hsize_t>(width)};
  const Hdf5_handle space(H5Screate_simple(dimension, shape.data(), nullptr), H5Sclose);
  Hdf5_handle array(H5Dcreate2(file_, name.c_str(), file_type<Number>(), space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
                    H5Dclose);
  check(array >= 0, message);
  std::vector<Number> values;
  const Index step = std::max<Index>(1, piece / width);
  for (Index first = 0; first < rows; first += step)
  {
    const Index count = std::min(step, rows - first);
    values.assign(static_cast<std::size_t>(count * width), Number());
    fill(first, values);
    const std::array<hsize_t, 2> start = {static_cast<hsize_t>(first), 0};
    const std::array<hsize_t, 2> size = {static_cast<hsize_t>(count), static_cast<hsize_t>(width)};
    const Hdf5_handle memory(H5Screate_simple(dimension, size.data(), nullptr), H5Sclose);
    H5Sselect_hyperslab(space, H5S_SELECT_SET, start.data(), nullptr, size.data(), nullptr);
    check(H5Dwrite(array, memory_type<Number>(), memory, space, H5P_DEFAULT, values.data()) >= 0, message);
  }
  check(array.close(), message);
}

template void Hdf5_file::write_array<std::int32_t>(const std::string&, Index, Index,
                                                   const std::function<void(Index, std::span<std::int32_t>)>&);
template void Hdf5_file::write_array<double>(const std::string&, Index, Index,
                                             const std::function<void(Index, std::span<double>)>&);

void Hdf5_file::write_texts(const std::string& name, const std::vector<std::string>& texts, std::size_t width)
{
  std::string all;
  for (const std::string& text : texts)
    all += text.substr(0, width) + std::string(width - std::min(width, text.size()), ' ');
  const Hdf5_handle type = text_type(width);
  const auto count = static_cast<hsize_t>(texts.size());
  const Hdf5_handle space(H5Screate_simple(1, &count, nullptr), H5Sclose);
  Hdf5_handle array(H5Dcreate2(file_, name.c_str(), type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Dclose);
  const bool is_written =
    array >= 0 && (texts.empty() || H5Dwrite(array, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, all.data()) >= 0);
  check(array.close() && is_written, fmt::format("array {} cannot be written", name));
}

void Hdf5_file::finish()
{
  const bool is_flushed = H5Fflush(file_, H5F_SCOPE_GLOBAL) >= 0;
  check(file_.close() && is_flushed, "the end of the file cannot be written");
}

// Reading.
// -------------------------------------------------------------------------------------------------------------

bool Hdf5_file::has(const std::string& name) const
{
  return H5Lexists(file_, name.c_str(), H5P_DEFAULT) > 0;
}

std::int64_t Hdf5_file::read_integer_attribute(const std::string& name) const
{
  check(H5Aexists(file_, name.c_str()) > 0, fmt::format("has no attribute {}", name));
  const Hdf5_handle attribute(H5Aopen(file_, name.c_str(), H5P_DEFAULT), H5Aclose);
  const Hdf5_handle space(attribute < 0 ? H5I_INVALID_HID : H5Aget_space(attribute), H5Sclose);
  const Hdf5_handle type(attribute < 0 ? H5I_INVALID_HID : H5Aget_type(attribute), H5Tclose);
  std::int64_t value = 0;
  check(attribute >= 0 && space >= 0 && H5Sget_simple_extent_npoints(space) == 1 && H5Tget_class(type) == H5T_INTEGER &&
          H5Aread(attribute, H5T_NATIVE_INT64, &value) >= 0,
        fmt::format("attribute {} is no integer", name));
  return value;
}

Hdf5_handle Hdf5_file::open_array(const std::string& name) const
{
  check(has(name), fmt::format("has no array {}", name));
  const hid_t array = H5Dopen2(file_, name.c_str(), H5P_DEFAULT);
  check(array >= 0, fmt::format("{} is no array that can be read", name));
  return {array, H5Dclose};
}

std::vector<Index> Hdf5_file::shape(const std::string& name) const
{
  const Hdf5_handle array = open_array(name);
  const Hdf5_handle space(H5Dget_space(array), H5Sclose);
  const int dimension = space < 0 ? -1 : H5Sget_simple_extent_ndims(space);
  check(dimension >= 0 && dimension <= 8, fmt::format("array {} has no shape", name));
  std::array<hsize_t, 8> lengths = {};
  check(H5Sget_simple_extent_dims(space, lengths.data(), nullptr) >= 0, fmt::format("array {} has no shape", name));
  std::vector<Index> result;
  for (int d = 0; d < dimension; ++d)
  {
    check(lengths[static_cast<std::size_t>(d)] < (hsize_t(1) << 50), fmt::format("array {} is too long", name));
    result.push_back(static_cast<Index>(lengths[static_cast<std::size_t>(d)]));
  }
  return result;
}

void Hdf5_file::check_size(const std::string& name) const
{
  const Hdf5_handle array = open_array(name);
  const Hdf5_handle type(H5Dget_type(array), H5Tclose);
  double bytes = static_cast<double>(H5Tget_size(type));
  for (const Index length : shape(name))
    bytes *= static_cast<double>(length);
  if (bytes == 0)
    return;
  const auto stored = static_cast<double>(H5Dget_storage_size(array));
  check(stored > 0, fmt::format("array {} was never written", name));
  check(stored <= size_ && bytes <= largest_compression * stored,
        fmt::format("array {} states {:.0f} bytes, which the file cannot hold", name, bytes));
}

template <class Number>
void Hdf5_file::read_numbers(const std::string& name, Index first, Index columns, std::span<Number> values,
                             hid_t memory_type, bool is_integer) const
{
  if (values.empty())
    return;
  const std::string message = fmt::format("array {} cannot be read", name);
  const Hdf5_handle array = open_array(name);
  const Hdf5_handle type(H5Dget_type(array), H5Tclose);
  check(H5Tget_class(type) == (is_integer ? H5T_INTEGER : H5T_FLOAT),
        fmt::format("array {} does not consist of {}", name, is_integer ? "integers" : "reals"));
  const Hdf5_handle space(H5Dget_space(array), H5Sclose);
  const std::array<hsize_t, 2> start = {static_cast<hsize_t>(first), 0};
  const std::array<hsize_t, 2> size = {values.size() / static_cast<hsize_t>(columns), static_cast<hsize_t>(columns)};
  const int dimension = H5Sget_simple_extent_ndims(space);
  check((dimension == 1 && columns == 1) || dimension == 2, message);
  const Hdf5_handle memory(H5Screate_simple(dimension, size.data(), nullptr), H5Sclose);
  check(H5Sselect_hyperslab(space, H5S_SELECT_SET, start.data(), nullptr, size.data(), nullptr) >= 0, message);
  check(H5Dread(array, memory_type, memory, space, H5P_DEFAULT, values.data()) >= 0, message);
}

void Hdf5_file::read_rows(const std::string& name, Index first, Index columns, std::span<std::int64_t> values) const
{
  read_numbers(name, first, columns, values, H5T_NATIVE_INT64, true);
}

void Hdf5_file::read_rows(const std::string& name, Index first, Index columns, std::span<double> values) const
{
  read_numbers(name, first, columns, values, H5T_NATIVE_DOUBLE, false);
}

std::vector<std::string> Hdf5_file::read_texts(const std::string& name) const
{
  const std::string message = fmt::format("array {} does not consist of texts of one length", name);
  const std::vector<Index> lengths = shape(name);
  check(lengths.size() == 1, message);
  check_size(name);
  const Hdf5_handle array = open_array(name);
  const Hdf5_handle type(H5Dget_type(array), H5Tclose);
  check(H5Tget_class(type) == H5T_STRING && H5Tis_variable_str(type) == 0, message);
  const std::size_t width = H5Tget_size(type);
  std::string all(static_cast<std::size_t>(lengths[0]) * width, ' ');
  check(all.empty() || H5Dread(array, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, all.data()) >= 0, message);
  std::vector<std::string> texts;
  for (std::size_t first = 0; first < all.size(); first += width)
  {
    std::string text = all.substr(first, width);
    text.resize(std::min(text.size(), text.find('\0')));
    text.erase(text.find_last_not_of(' ') + 1);
    texts.push_back(std::move(text));
  }
  return texts;
}

} // namespace recurve::internal
