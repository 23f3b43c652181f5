#ifndef RECURVE_SRC_RUN_MESH_CELLS_H
#define RECURVE_SRC_RUN_MESH_CELLS_H

#include <recurve/core/exceptions.h>
#include <recurve/core/progress.h>
#include <recurve/mesh/curved_mesh.h>
#include <recurve/volume/element_block.h>

#include <atomic>
#include <mutex>
#include <string_view>
#include <vector>

namespace recurve {

/// The cells of all zones as blocks for the passes, and their numbers through the whole mesh.
struct Mesh_cells
{
  struct Place
  {
    std::size_t zone, section;
    Index first_of_zone; ///< number in the zone of the block's first cell
    Index first;         ///< number in the mesh
  };

  std::vector<Element_block> blocks;
  std::vector<Place> places; ///< one per block
  Index count = 0;

  explicit Mesh_cells(const Curved_mesh& mesh)
  {
    for (std::size_t z = 0; z < mesh.zones.size(); ++z)
    {
      Index in_zone = 0;
      for (std::size_t s = 0; s < mesh.zones[z].cells.size(); ++s)
      {
        const Curved_section& section = mesh.zones[z].cells[s];
        const Index size = static_cast<Index>(section.nodes.size()) / node_count(section.type, mesh.degree);
        blocks.push_back({section.type, section.nodes});
        places.push_back({z, s, in_zone, count});
        in_zone += size;
        count += size;
      }
    }
  }

  Index number(Index block, Index element) const { return places[static_cast<std::size_t>(block)].first + element; }
};

/// Progress of work that many threads do in small steps.
class Step_counter
{
public:
  Step_counter(const Progress_callback& progress, std::string_view stage, Index steps)
    : progress_(progress), stage_(stage), steps_(steps)
  {}

  /// tells of one step more. \throws Cancelled
  void count()
  {
    const Index done = ++done_;
    if (!progress_ || done % ((steps_ + 99) / 100) != 0)
      return;
    const std::lock_guard lock(mutex_);
    report_progress(progress_, stage_, std::min(1.0, static_cast<double>(done) / static_cast<double>(steps_)));
  }

private:
  const Progress_callback& progress_;
  std::string_view stage_;
  Index steps_;
  std::atomic<Index> done_ = 0;
  std::mutex mutex_;
};

} // namespace recurve

#endif
