#ifndef RECURVE_IO_MSH_READING_H
#define RECURVE_IO_MSH_READING_H

#include "grouped_mesh.h"
#include "input_file.h"
#include "node_numbers.h"

#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace recurve::internal::msh {

/// What an element belongs to: a physical group, or where it is in none (0) an entity.
struct Group_key
{
  int dimension = 3;
  int physical = 0;
  int entity = 0;
  Element_type type = Element_type::tetrahedron;

  friend auto operator<=>(const Group_key&, const Group_key&) = default; // NOLINT(modernize-use-nullptr): false alarm
};

/// A $Periodic link as it stands in the file.
struct Link_data
{
  std::vector<double> affine;
  std::vector<std::pair<Index, Index>> nodes; ///< of the entity, of its master
};

/// Everything that the sections of a file share while it is read.
struct Msh_reading
{
  Msh_reading(const std::filesystem::path& file, const Progress_callback& progress) : in(file, progress) {}

  Input_file in;
  int version = 41; ///< 22 or 41
  bool is_binary = false;
  bool has_32_bit_sizes = false; ///< size_t of 4 bytes, in version 4.1

  std::map<std::pair<int, int>, std::string> names; ///< dimension and number of physical groups
  std::map<std::pair<int, int>, int> physical_of;   ///< dimension and tag of entities; 0: none
  std::set<std::pair<int, int>> between_partitions; ///< entities that only partitioning made
  Node_numbers numbers;
  std::vector<Point> nodes; ///< ascending by number in the file
  bool has_nodes = false, has_elements = false;
  int degree = 0;                                               ///< 0: no element yet
  std::vector<std::pair<Group_key, std::vector<Index>>> groups; ///< in the order of the file
  std::map<Group_key, std::size_t> group_numbers;
  std::vector<Link_data> links;
  Index lower_elements = 0, partition_faces = 0;
  Index in_several_groups = 0; ///< entities
  std::vector<std::string> notes;

  /// a number of the file: `what` in messages.
  template <class Number>
  Number get(std::string_view what)
  {
    return is_binary ? in.read<Number>() : in.parse<Number>(what);
  }
  int get_int(std::string_view what) { return get<std::int32_t>(what); }
  Index get_size(std::string_view what);

  /// a count of things of at least `entries` numbers each, not more than the file can hold.
  Index get_count(std::uint64_t entries, std::string_view what);
};

/// reads $Entities or, with `is_partitioned`, $PartitionedEntities.
void read_entities(Msh_reading& reading, bool is_partitioned);

void read_nodes(Msh_reading& reading);
void read_elements(Msh_reading& reading);
void read_periodic(Msh_reading& reading);

/// what has been read, as zones and patches.
Grouped_mesh make_groups(Msh_reading& reading);

} // namespace recurve::internal::msh

#endif
