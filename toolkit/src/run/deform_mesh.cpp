#include "deform_mesh.h"

#include "periodic_motion.h"
#include "planar_regions.h"

#include <recurve/elements/node_layout.h>
#include <recurve/volume/blend_interior.h>
#include <recurve/volume/boundary_sources.h>
#include <recurve/volume/deform_interior.h>

#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <limits>
#include <span>
#include <utility>

namespace recurve {

namespace {

constexpr std::string_view stage = "deform interior";
constexpr Point zero = {0, 0, 0};

Point difference(const Point& a, const Point& b)
{
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}

double length(const Point& a)
{
  return std::hypot(a[0], a[1], a[2]);
}

/// The steps of the deformation; they share the field.
class Mesh_deformation
{
public:
  Mesh_deformation(Curved_mesh& mesh, std::vector<Node_state>& states, const Face_selection& is_source,
                   const Curving_options& options, const Progress_callback& progress)
    : mesh_(mesh), states_(states), options_(options), progress_(progress)
  {
    list_faces(is_source);
  }

  Deformation_summary run()
  {
    find_length();
    if (summary_.length == 0)
      return summary_;
    field_.assign(mesh_.nodes.size(), zero);
    list_sources();
    take_displacements(sources_);
    list_periodic_nodes();
    copy_periodic_nodes();
    move_planar_patches();
    blend_other_faces();
    copy_periodic_nodes();
    move_interior();
    find_local_lengths();
    apply();
    copy_periodic_nodes();
    return summary_;
  }

private:
  void list_faces(const Face_selection& is_source)
  {
    for (std::size_t z = 0; z < mesh_.zones.size(); ++z)
    {
      std::size_t number = 0;
      for (const Curved_section& section : mesh_.zones[z].faces)
      {
        const auto n = static_cast<std::size_t>(node_count(section.type, mesh_.degree));
        for (std::size_t first = 0; first < section.nodes.size(); first += n, ++number)
          if (is_source[z][number])
            faces_.push_back({section.type, std::span<const Index>(section.nodes).subspan(first, n)});
      }
    }
  }

  bool is_placed(Index node) const { return states_[static_cast<std::size_t>(node)] == Node_state::placed; }
  const Point& position(Index node) const { return mesh_.nodes[static_cast<std::size_t>(node)]; }
  Point& field(Index node) { return field_[static_cast<std::size_t>(node)]; }

  /// L: the mean edge length of the faces that are curved.
  void find_length()
  {
    std::vector<Element_block> active;
    for (const Boundary_element& face : faces_)
      if (std::ranges::any_of(face.nodes, [&](Index n) { return is_placed(n); }))
        active.push_back({face.type, face.nodes});
    const double mean = mean_edge_length(mesh_.nodes, active, mesh_.degree);
    summary_.length = mean > 0 && options_.deformation.length > 0 ? options_.deformation.length : mean;
  }

  /// the sources and where the straight-sided mesh has them.
  void list_sources()
  {
    for (const Boundary_element& face : faces_)
      sources_.insert(sources_.end(), face.nodes.begin(), face.nodes.end());
    std::ranges::sort(sources_);
    sources_.erase(std::unique(sources_.begin(), sources_.end()), sources_.end());
    straight_.resize(sources_.size());
    std::array<Point, node_count(Element_type::quadrangle, max_degree)> positions;
    for (const Boundary_element& face : faces_)
    {
      straight_nodes(face.type, mesh_.degree, face.nodes, mesh_.nodes, std::span(positions).first(face.nodes.size()));
      for (std::size_t m = 0; m < face.nodes.size(); ++m)
        straight_[source_number(face.nodes[m])] = positions[m];
    }
  }

  std::size_t source_number(Index node) const
  {
    return static_cast<std::size_t>(std::ranges::lower_bound(sources_, node) - sources_.begin());
  }

  /// sets the field to the way that the nodes have gone.
  void take_displacements(std::span<const Index> nodes)
  {
    for (const Index node : nodes)
      if (is_displaced(states_[static_cast<std::size_t>(node)]))
        field(node) = difference(position(node), straight_[source_number(node)]);
  }

  // Uncurved patches. -------------------------------------------------------------------------------------------------

  void move_planar_patches()
  {
    is_planar_face_.assign(faces_.size(), 0);
    for (const Planar_region& region : find_planar_regions(faces_, mesh_.nodes))
    {
      const Region_nodes nodes = nodes_of(region, faces_, mesh_.degree);
      if (!moves_within(region, nodes))
        continue;
      for (const Index f : region.faces)
        is_planar_face_[static_cast<std::size_t>(f)] = 1;
      move_planar_patch(region, nodes);
    }
  }

  /// whether `region` moves, and within its plane: a facet of a curved surface leaves it.
  bool moves_within(const Planar_region& region, const Region_nodes& nodes)
  {
    // What rounding leaves of a displacement out of the plane is less: of its length, and of L, as the corners of a
    // plane are rounded too.
    constexpr double tolerance = 1e-6, rounding = 1e-9;

    // A few nodes at a corner of the rim, where a wall of a single face has no say in its edge, do not make a symmetry
    // plane a facet; all nodes of a facet's rim leave its plane.
    constexpr double least_share = 0.9;

    Index moving = 0, within = 0;
    for (const std::vector<Index>* list : {&nodes.rim, &nodes.inside})
      for (const Index node : *list)
        if (const double way = length(field(node)); way > 0)
        {
          ++moving;
          within += length(difference(field(node), along_plane(region, field(node)))) <=
                    std::max(tolerance * way, rounding * summary_.length);
        }
    return moving > 0 && static_cast<double>(within) >= least_share * static_cast<double>(moving);
  }

  /// takes a node of the rim back to the plane, if it has left it.
  void put_into_plane(const Planar_region& region, Index node)
  {
    const Point within = along_plane(region, field(node));
    if (within == field(node))
      return;
    field(node) = within;
    const Point& straight = straight_[source_number(node)];
    mesh_.nodes[static_cast<std::size_t>(node)] = {straight[0] + within[0], straight[1] + within[1],
                                                   straight[2] + within[2]};
  }

  void move_planar_patch(const Planar_region& region, const Region_nodes& nodes)
  {
    const auto at = [&](Index node) { return straight_[source_number(node)]; };
    std::vector<Point> positions, given, targets, result(nodes.inside.size());
    for (const Index node : nodes.rim)
    {
      put_into_plane(region, node);
      positions.push_back(at(node));
      given.push_back(field(node));
    }
    for (const Index node : nodes.inside)
      targets.push_back(at(node));
    interior_displacements(positions, given, targets, result, formula({}));
    for (std::size_t m = 0; m < nodes.inside.size(); ++m)
    {
      const Index node = nodes.inside[m];
      field(node) = along_plane(region, result[m]);
      // What the surface pass has blended into faces at the rim is done anew, with all others.
      mesh_.nodes[static_cast<std::size_t>(node)] = targets[m];
      states_[static_cast<std::size_t>(node)] = Node_state::straight;
      planar_nodes_.push_back(node);
    }
    ++summary_.planar_patches;
  }

  /// the nodes inside other faces that are not curved, next to displaced edges; all other nodes of such faces rest.
  void blend_other_faces()
  {
    std::vector<Element_block> blocks;
    for (std::size_t f = 0; f < faces_.size(); ++f)
      if (!is_planar_face_[f])
        blocks.push_back({faces_[f].type, faces_[f].nodes});
    summary_.blended_face_nodes = blend_interior(mesh_.nodes, states_, blocks, mesh_.degree).blended_nodes;
    for (const Element_block& block : blocks)
      take_displacements(block.nodes);
  }

  void list_periodic_nodes()
  {
    periodic_ = find_periodic_nodes(mesh_, options_.periodic);
    for (Periodic_nodes& periodic : periodic_)
    {
      std::erase_if(periodic.pairs, [&](const auto& pair) {
        return !std::ranges::binary_search(sources_, pair[0]) || !std::ranges::binary_search(sources_, pair[1]);
      });
      summary_.periodic_pairs += static_cast<Index>(periodic.pairs.size());
    }
  }

  /// gives the image of each node of a periodic patch the image of the node's displacement.
  void copy_periodic_nodes()
  {
    for (const Periodic_nodes& periodic : periodic_)
      for (const auto& [node, image] : periodic.pairs)
      {
        const Point& straight = straight_[source_number(node)];
        const Point& straight_image = straight_[source_number(image)];
        field(image) = periodic.period.image_of_displacement(field(node));
        states_[static_cast<std::size_t>(image)] = states_[static_cast<std::size_t>(node)];
        Point& place = mesh_.nodes[static_cast<std::size_t>(image)];
        place = straight_image;
        if (is_displaced(states_[static_cast<std::size_t>(node)]))
          place = periodic_position(periodic.period, straight, straight_image, position(node));
      }
  }

  // The interior. -----------------------------------------------------------------------------------------------------

  /// the caller's formula, with L and another summation.
  Deformation_options formula(Progress_callback progress) const
  {
    Deformation_options options = options_.deformation;
    options.length = summary_.length;
    options.summation.progress = std::move(progress);
    return options;
  }

  void move_interior()
  {
    std::vector<Index> targets;
    for (Index node = 0, s = 0; node < static_cast<Index>(mesh_.nodes.size()); ++node)
      if (s < static_cast<Index>(sources_.size()) && sources_[static_cast<std::size_t>(s)] == node)
        ++s;
      else
        targets.push_back(node);
    std::vector<Point> given;
    given.reserve(sources_.size());
    for (const Index node : sources_)
      given.push_back(field(node));
    std::vector<double> weights;
    if (options_.area_weights)
      weights = source_areas();
    const auto progress = [&](std::string_view, double fraction) { return !progress_ || progress_(stage, fraction); };
    std::vector<Point> positions, result(targets.size());
    positions.reserve(targets.size());
    for (const Index node : targets)
      positions.push_back(position(node));
    summary_.field = interior_displacements(straight_, given, positions, result, formula(progress), weights);
    for (std::size_t m = 0; m < targets.size(); ++m)
      field(targets[m]) = result[m];
  }

  std::vector<double> source_areas() const
  {
    std::vector<Element_block> blocks;
    for (const Boundary_element& face : faces_)
      blocks.push_back({face.type, face.nodes});
    const std::vector<double> areas = node_areas(mesh_.nodes, blocks, mesh_.degree);
    std::vector<double> weights;
    for (const Index node : sources_)
      weights.push_back(areas[static_cast<std::size_t>(node)]);
    return weights;
  }

  /// per corner, the length of the shortest edge that ends there.
  void find_local_lengths()
  {
    local_length_.assign(mesh_.nodes.size(), std::numeric_limits<double>::infinity());
    for (const Curved_zone& zone : mesh_.zones)
      for (const Curved_section& section : zone.cells)
      {
        const Reference_element& reference = reference_element(section.type);
        const auto n = static_cast<std::size_t>(node_count(section.type, mesh_.degree));
        for (std::size_t first = 0; first < section.nodes.size(); first += n)
          for (int e = 0; e < reference.edge_count; ++e)
          {
            const auto& ends = reference.edges[static_cast<std::size_t>(e)];
            const Index a = section.nodes[first + static_cast<std::size_t>(ends[0])],
                        b = section.nodes[first + static_cast<std::size_t>(ends[1])];
            const double l = length(difference(position(a), position(b)));
            if (l == 0)
              continue; // a collapsed edge has no length to compare with
            for (const Index end : {a, b})
              local_length_[static_cast<std::size_t>(end)] = std::min(local_length_[static_cast<std::size_t>(end)], l);
          }
      }
  }

  struct Tally
  {
    Index moved = 0, negligible = 0;
    double largest = 0;
  };

  /// bends edges, faces and cells: each node goes the way of the field less what the field at the corners,
  /// interpolated, would have moved it.
  void apply()
  {
    is_done_.assign(mesh_.nodes.size(), 0);
    tbb::enumerable_thread_specific<Tally> tallies;
    for (const Curved_zone& zone : mesh_.zones)
      for (const Curved_section& section : zone.cells)
      {
        const auto n = static_cast<std::size_t>(node_count(section.type, mesh_.degree));
        const tbb::blocked_range<std::size_t> all(0, section.nodes.size() / n);
        tbb::parallel_for(all, [&](const tbb::blocked_range<std::size_t>& range) {
          Tally& tally = tallies.local();
          for (std::size_t e = range.begin(); e < range.end(); ++e)
            bend(section.type, std::span<const Index>(section.nodes).subspan(e * n, n), tally);
        });
      }
    for (const Tally& tally : tallies)
    {
      summary_.moved_nodes += tally.moved;
      summary_.negligible_nodes += tally.negligible;
      summary_.largest_displacement = std::max(summary_.largest_displacement, tally.largest);
    }
    for (const Index node : planar_nodes_)
      summary_.planar_nodes += is_displaced(states_[static_cast<std::size_t>(node)]);
  }

  void bend(Element_type type, std::span<const Index> cell, Tally& tally)
  {
    if (std::ranges::all_of(cell, [&](Index node) { return field(node) == zero; }))
      return;
    std::array<Point, node_count(Element_type::hexahedron, max_degree)> bends;
    straight_nodes(type, mesh_.degree, cell, field_, std::span(bends).first(cell.size()));
    for (std::size_t m = 0; m < cell.size(); ++m)
      bends[m] = difference(field(cell[m]), bends[m]);
    const Reference_element& reference = reference_element(type);
    const auto bend_part = [&](int first, int count, std::span<const int> corners) {
      bend_entity(cell, bends, first, count, corners, tally);
    };
    for (int e = 0; e < reference.edge_count; ++e)
      bend_part(first_edge_node(type, mesh_.degree, e), mesh_.degree - 1, reference.edges[static_cast<std::size_t>(e)]);
    for (int f = 0; f < reference.face_count; ++f)
    {
      const Reference_face& face = reference.faces[static_cast<std::size_t>(f)];
      bend_part(first_face_node(type, mesh_.degree, f), interior_node_count(face.type, mesh_.degree),
                std::span(face.corners).first(static_cast<std::size_t>(face.corner_count)));
    }
    constexpr std::array<int, 8> all_corners = {0, 1, 2, 3, 4, 5, 6, 7};
    bend_part(first_interior_node(type, mesh_.degree), interior_node_count(type, mesh_.degree),
              std::span(all_corners).first(static_cast<std::size_t>(reference.corner_count)));
  }

  /// moves the nodes `first`, ... inside an edge, face or cell, unless that bends nothing. Whichever cell it is seen
  /// from, the outcome is the same, to the bit; the first one to come does it.
  void bend_entity(std::span<const Index> cell, std::span<const Point> bends, int first, int count,
                   std::span<const int> corners, Tally& tally)
  {
    // Part of the shortest edge at the corners: no cell can tell such an edge from a straight one, and a solver is
    // faster in a cell that is exactly straight.
    constexpr double negligible_bend = 1e-3;

    double local = std::numeric_limits<double>::infinity(), largest = 0;
    for (const int c : corners)
      local = std::min(local, local_length_[static_cast<std::size_t>(cell[static_cast<std::size_t>(c)])]);
    for (int m = first; m < first + count; ++m)
      largest = std::max(largest, length(bends[static_cast<std::size_t>(m)]));
    const bool is_negligible = largest <= negligible_bend * local;
    for (int m = first; m < first + count; ++m)
    {
      const Index node = cell[static_cast<std::size_t>(m)];
      const auto n = static_cast<std::size_t>(node);
      if (std::atomic_ref(is_done_[n]).exchange(1) != 0 || states_[n] != Node_state::straight)
        continue;
      const Point& bend = bends[static_cast<std::size_t>(m)];
      if (is_negligible)
      {
        tally.negligible += bend != zero;
        continue;
      }
      for (std::size_t d = 0; d < 3; ++d)
        mesh_.nodes[n][d] += bend[d];
      states_[n] = Node_state::blended;
      ++tally.moved;
      tally.largest = std::max(tally.largest, length(bend));
    }
  }

  Curved_mesh& mesh_;
  std::vector<Node_state>& states_;
  const Curving_options& options_;
  const Progress_callback& progress_;
  Deformation_summary summary_;
  std::vector<Boundary_element> faces_; ///< whose nodes are sources
  std::vector<char> is_planar_face_;    ///< whether the face is in a planar patch that follows its rim
  std::vector<Index> sources_;          ///< nodes, ascending
  std::vector<Point> straight_;         ///< per source, where the straight-sided mesh has it
  std::vector<Periodic_nodes> periodic_;
  std::vector<Index> planar_nodes_;   ///< those inside planar patches that follow their rim
  std::vector<Point> field_;          ///< per node
  std::vector<double> local_length_;  ///< per node, set for corners
  std::vector<std::uint8_t> is_done_; ///< per node
};

} // namespace

Deformation_summary deform_mesh(Curved_mesh& mesh, std::vector<Node_state>& states, const Face_selection& is_source,
                                const Curving_options& options, const Progress_callback& progress)
{
  return Mesh_deformation(mesh, states, is_source, options, progress).run();
}

} // namespace recurve
