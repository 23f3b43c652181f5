#ifndef RECURVE_IO_HDF5_FILE_H
#define RECURVE_IO_HDF5_FILE_H

#include <recurve/core/types.h>

#include <hdf5.h>

#include <filesystem>
#include <functional>
#include <mutex>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace recurve::internal {

/// Something of HDF5 that has to be closed.
class Hdf5_handle
{
public:
  Hdf5_handle(hid_t id, herr_t (*close_function)(hid_t)) : id_(id), close_(close_function) {}
  ~Hdf5_handle() { close(); }
  Hdf5_handle(const Hdf5_handle&) = delete;
  Hdf5_handle& operator=(const Hdf5_handle&) = delete;

  operator hid_t() const { return id_; }

  /// whether it could be closed.
  bool close()
  {
    const bool is_closed = id_ < 0 || close_(id_) >= 0;
    id_ = H5I_INVALID_HID;
    return is_closed;
  }

private:
  hid_t id_;
  herr_t (*close_)(hid_t);
};

/// whether every object that the file's own links lead to can be opened. HDF5 1.10 crashes when it lists a damaged
/// group in the order of names, as libcgns has it do; in the order of the file, as here, it reports an error.
bool has_sound_links(const std::filesystem::path& file);

/// An HDF5 file of flat arrays and attributes, open for reading or for writing. Other uses of HDF5 in this process wait
/// meanwhile. Every function throws `Format_error`, whose message begins with the file.
class Hdf5_file
{
public:
  enum class Mode
  {
    read,
    write
  };

  Hdf5_file(const std::filesystem::path& file, Mode mode);

  [[noreturn]] void fail(std::string_view message) const;

  // Writing.
  // -----------------------------------------------------------------------------------------------------------

  void write_attribute(const std::string& name, std::int32_t value);
  void write_attribute(const std::string& name, double value);
  void write_attribute(const std::string& name, const std::string& value);

  /// writes an array of `rows` rows of `columns` numbers (0: an array of one dimension), piece by piece:
  /// `fill(row, values)` makes the rows from `row` on, as many as `values` holds.
  template <class Number>
  void write_array(const std::string& name, Index rows, Index columns,
                   const std::function<void(Index row, std::span<Number> values)>& fill);

  /// writes texts of `width` bytes, filled up with blanks as in Fortran.
  void write_texts(const std::string& name, const std::vector<std::string>& texts, std::size_t width);

  /// brings everything to the disk.
  void finish();

  // Reading.
  // -----------------------------------------------------------------------------------------------------------

  bool has(const std::string& name) const;
  std::int64_t read_integer_attribute(const std::string& name) const;

  /// lengths of the array in each dimension.
  std::vector<Index> shape(const std::string& name) const;

  /// reads rows [first, first + values.size() / columns) of an array of integers or reals of any width. \pre the shape
  /// says that they are there; check_size() was called.
  void read_rows(const std::string& name, Index first, Index columns, std::span<std::int64_t> values) const;
  void read_rows(const std::string& name, Index first, Index columns, std::span<double> values) const;

  /// without blanks at their ends.
  std::vector<std::string> read_texts(const std::string& name) const;

  /// \throws Format_error if the file cannot hold what the array states, or the array was never written.
  void check_size(const std::string& name) const;

private:
  void check(bool is_good, const std::string& what) const;
  Hdf5_handle open_array(const std::string& name) const;
  template <class Number>
  void read_numbers(const std::string& name, Index first, Index columns, std::span<Number> values, hid_t memory_type,
                    bool is_integer) const;

  std::filesystem::path path_;
  std::unique_lock<std::mutex> lock_;
  Hdf5_handle file_;
  double size_ = 0; ///< of the file, in bytes
};

} // namespace recurve::internal

#endif
