#ifndef RECURVE_MESH_INTERNAL_ELEMENT_BLOCKS_H
#define RECURVE_MESH_INTERNAL_ELEMENT_BLOCKS_H

#include <recurve/mesh/volume_mesh.h>

#include <algorithm>
#include <vector>

namespace recurve::internal {

/// One section of one zone in a numbering of elements across zones.
struct Element_block
{
  const Section* section = nullptr;
  Index zone = no_index;
  Index first = 0;         ///< number of its first element across the zones
  Index first_in_zone = 0; ///< number of its first element in the zone, counted as `Zone::cells` or `Zone::faces` do
};

/// Numbers elements of many sections consecutively, so that one 64-bit number names an element of the mesh.
/// The sections must outlive the numbering.
class Element_blocks
{
public:
  /// appends all elements of `sections`, one kind (cells, faces or bars) of one zone.
  void add(Index zone, const std::vector<Section>& sections)
  {
    Index first_in_zone = 0;
    for (const Section& section : sections)
    {
      firsts_.push_back(size_);
      blocks_.push_back({&section, zone, size_, first_in_zone});
      size_ += section.size();
      first_in_zone += section.size();
    }
  }

  Index size() const { return size_; }
  const std::vector<Element_block>& blocks() const { return blocks_; }

  /// number of the block that holds `element`; logarithmic in the sections.
  std::size_t block_index(Index element) const
  {
    // Empty sections share their first number with the next one; upper_bound lands behind them all.
    return static_cast<std::size_t>(std::upper_bound(firsts_.begin(), firsts_.end(), element) - firsts_.begin()) - 1;
  }

  const Element_block& block_of(Index element) const { return blocks_[block_index(element)]; }

private:
  std::vector<Element_block> blocks_;
  std::vector<Index> firsts_;
  Index size_ = 0;
};

/// points of the zone at the corners of element `element` (numbered across the zones) of its block.
inline const Index* corner_points(const Element_block& block, Index element)
{
  return block.section->nodes.data() + (element - block.first) * corner_count(block.section->type);
}

/// all cells of a mesh, zone by zone.
inline Element_blocks cell_blocks(const Volume_mesh& mesh)
{
  Element_blocks blocks;
  for (std::size_t z = 0; z < mesh.zones.size(); ++z)
    blocks.add(static_cast<Index>(z), mesh.zones[z].cells);
  return blocks;
}

/// all faces of sections of a mesh, zone by zone.
inline Element_blocks face_blocks(const Volume_mesh& mesh)
{
  Element_blocks blocks;
  for (std::size_t z = 0; z < mesh.zones.size(); ++z)
    blocks.add(static_cast<Index>(z), mesh.zones[z].faces);
  return blocks;
}

} // namespace recurve::internal

#endif
