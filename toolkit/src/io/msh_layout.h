#ifndef RECURVE_IO_MSH_LAYOUT_H
#define RECURVE_IO_MSH_LAYOUT_H

#include <recurve/mesh/curved_mesh.h>

#include <array>
#include <string>
#include <utility>
#include <vector>

namespace recurve::internal::msh {

/// Elements of one section that go to the file as one block.
struct Block
{
  const Curved_section* section = nullptr;
  std::vector<Index> faces; ///< numbers in the section; of cells empty: all of them
  Index count = 0;
};

/// A surface or volume of the file: a patch of a zone, or a zone.
struct Entity
{
  int dimension = 3;
  int tag = 0;      ///< counted from 1 in its dimension
  int physical = 0; ///< number of the physical group
  std::size_t zone = 0;
  std::vector<Block> blocks;
};

struct Physical_group
{
  int dimension = 3;
  int number = 0;
  std::string name;
};

/// Nodes of a surface and where a rigid map takes them.
struct Periodic_link
{
  int tag = 0, master_tag = 0; ///< of surfaces; the map takes the master to the other
  std::array<double, 16> map = {};
  std::vector<std::pair<Index, Index>> nodes; ///< of the surface, of its master
};

/// What goes to an MSH file, and in which order.
struct Msh_layout
{
  std::vector<Physical_group> groups;
  std::vector<Entity> entities; ///< surfaces first, as Gmsh itself writes them, then volumes
  std::vector<Periodic_link> links;

  Index element_count() const;
};

Msh_layout make_layout(const Curved_mesh& mesh);

/// \throws Input_error if version 2.2, which counts with 32 bits, cannot hold so many.
void check_counts_of_2(Index nodes, Index elements);

/// the rigid map as a 4 x 4 matrix, row by row.
std::array<double, 16> affine_matrix(const Periodicity& map);

} // namespace recurve::internal::msh

#endif
