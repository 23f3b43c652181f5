#ifndef RECURVE_IO_CGNS_TREE_H
#define RECURVE_IO_CGNS_TREE_H

#include <recurve/core/exceptions.h>
#include <recurve/core/types.h>

#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace recurve::internal::cgns {

/// libcgns and HDF5 keep their state in global variables: one caller at a time.
std::mutex& cgns_mutex();

/// A node of the tree that every CGNS file is (HDF5 group or ADF node): name, label, and maybe an array. It belongs to
/// its `Cgns_tree` and must not outlive it.
class Cgns_node
{
public:
  const std::string& name() const { return name_; }
  const std::string& label() const { return label_; }

private:
  friend class Cgns_tree;
  std::shared_ptr<const double> id_;
  std::string name_;
  std::string label_;
};

/// Type and shape of the array of a node; the first dimension runs fastest.
struct Cgns_array_shape
{
  std::string type; ///< "I4", "I8", "R4", "R8", "C1", ...; "MT": no array
  std::vector<Index> dimensions;

  Index size() const; ///< product of the dimensions, 0 without array
};

/// A CGNS file opened for reading, at the level of nodes: HDF5 and ADF alike, links followed, and of any version, since
/// the version that libcgns objects to is checked by its higher level only. Nothing that the file states about its
/// own sizes is believed before it is compared with the arrays that are there.
///
/// Every function throws `Format_error`, whose message begins with the file.
class Cgns_tree
{
public:
  explicit Cgns_tree(const std::filesystem::path& file);
  ~Cgns_tree();
  Cgns_tree(const Cgns_tree&) = delete;
  Cgns_tree& operator=(const Cgns_tree&) = delete;

  const std::filesystem::path& file() const { return file_; }
  Cgns_node root() const;

  /// in the order of the file.
  std::vector<Cgns_node> children(const Cgns_node& parent) const;
  std::vector<Cgns_node> children(const Cgns_node& parent, std::string_view label) const;

  /// null where there is none.
  std::unique_ptr<Cgns_node> child(const Cgns_node& parent, std::string_view name) const;
  std::unique_ptr<Cgns_node> child_with_label(const Cgns_node& parent, std::string_view label) const;

  Cgns_array_shape shape(const Cgns_node& node) const;

  /// whole arrays, for small ones; an integer array may have 4 or 8 bytes, a real one too.
  std::string read_text(const Cgns_node& node) const;
  std::vector<std::int64_t> read_integers(const Cgns_node& node) const;
  std::vector<double> read_reals(const Cgns_node& node) const;

  /// hands an array over piece by piece, so that no second copy of a large one is ever in memory; `visit` gets the
  /// position of the first entry of the piece and the piece.
  void visit_integers(const Cgns_node& node,
                      const std::function<void(Index, std::span<const std::int64_t>)>& visit) const;
  void visit_reals(const Cgns_node& node, const std::function<void(Index, std::span<const double>)>& visit) const;

  /// \throws Format_error if the file cannot possibly hold `bytes` bytes: a count that is not to be believed.
  void check_plausible_size(double bytes, std::string_view what) const;

  [[noreturn]] void fail(std::string_view message) const;

private:
  Cgns_node make_node(double id) const;
  void check(int status, std::string_view what) const;
  template <class T>
  void visit(const Cgns_node& node, bool integers, const std::function<void(Index, std::span<const T>)>& f) const;
  template <class T>
  void read_piece(const Cgns_node& node, const Cgns_array_shape& shape, Index begin, std::span<T> piece) const;

  std::filesystem::path file_;
  std::unique_lock<std::mutex> lock_;
  int handle_ = 0;
  bool is_hdf5_ = false;
  double root_id_ = 0;
  double file_size_ = 0;
  mutable bool has_links_ = false;
};

} // namespace recurve::internal::cgns

#endif
