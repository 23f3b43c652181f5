#include <recurve/core/exceptions.h>
#include <recurve/elements/node_layout.h>
#include <recurve/mesh/curved_mesh.h>
#include <recurve/mesh/internal/buckets.h>
#include <recurve/mesh/internal/element_blocks.h>
#include <recurve/mesh/internal/sort_few.h>
#include <recurve/mesh/internal/straight_element.h>

#include <fmt/format.h>

#include <tuple>
#include <utility>

namespace recurve {

namespace {

using internal::Buckets;
using internal::Canonical_face;
using internal::Element_block;

/// An edge or face of an element, with the vertices beyond the smallest that name it.
template <std::size_t N>
struct Keyed_item
{
  std::array<Index, N> key;
  Index item;

  friend bool operator<(const Keyed_item& a, const Keyed_item& b)
  {
    return std::tie(a.key, a.item) < std::tie(b.key, b.item);
  }
};

class Elevation
{
public:
  Elevation(Volume_mesh&& linear, const Joined_zones& joined, int degree) : joined_(joined), degree_(degree)
  {
    mesh_.degree = degree;
    mesh_.nodes = joined_points(linear, joined);
    mesh_.linear = std::move(linear);
  }

  Curved_mesh elevate()
  {
    make_sections();
    for (std::size_t b = 0; b < elements_.blocks().size(); ++b)
      set_corners(b);
    if (degree_ > 1)
    {
      add_edge_nodes();
      add_face_nodes();
      for (std::size_t b = 0; b < elements_.blocks().size(); ++b)
        add_interior_nodes(b);
    }
    for (std::size_t z = 0; z < mesh_.zones.size(); ++z)
      list_nodes_of_zones(static_cast<Index>(z));
    return std::move(mesh_);
  }

private:
  // Elements: cells, faces and bars of all zones under one number. ---------------------------------------------------

  void make_sections()
  {
    mesh_.zones.resize(mesh_.linear.zones.size());
    for (std::size_t z = 0; z < mesh_.zones.size(); ++z)
    {
      const Zone& linear = mesh_.linear.zones[z];
      Curved_zone& zone = mesh_.zones[z];
      add_sections(static_cast<Index>(z), linear.cells, zone.cells);
      add_sections(static_cast<Index>(z), linear.faces, zone.faces);
      add_sections(static_cast<Index>(z), linear.bars, zone.bars);
      zone.is_straight.assign(static_cast<std::size_t>(linear.cell_count()), 1);
    }
  }

  void add_sections(Index zone, const std::vector<Section>& linear, std::vector<Curved_section>& curved)
  {
    curved.resize(linear.size());
    for (std::size_t s = 0; s < linear.size(); ++s)
    {
      curved[s].name = linear[s].name;
      curved[s].type = linear[s].type;
      curved[s].nodes.resize(static_cast<std::size_t>(linear[s].size() * node_count(linear[s].type, degree_)));
      nodes_of_block_.push_back(curved[s].nodes.data());
    }
    elements_.add(zone, linear);
  }

  Index* nodes_of(std::size_t block, Index element) const
  {
    const Element_block& b = elements_.blocks()[block];
    return nodes_of_block_[block] + (element - b.first) * node_count(b.section->type, degree_);
  }

  /// The corners stand in the connectivity from the start, so that edges and faces read joined vertices there.
  void set_corners(std::size_t block)
  {
    const Element_block& b = elements_.blocks()[block];
    const Reference_element& reference = reference_element(b.section->type);
    const std::vector<Index>& vertex_of_point = joined_.vertex_of_point[b.zone];
    tbb::parallel_for(b.first, b.first + b.section->size(), [&](Index element) {
      const Index* const points = internal::corner_points(b, element);
      Index* const nodes = nodes_of(block, element);
      for (int c = 0; c < reference.corner_count; ++c)
        nodes[c] = vertex_of_point[points[c]];
      set_collapsed_edges(reference, nodes);
    });
  }

  void set_collapsed_edges(const Reference_element& reference, Index* nodes) const
  {
    for (int e = 0; e < reference.edge_count; ++e)
      if (const Index vertex = nodes[reference.edges[e][0]]; vertex == nodes[reference.edges[e][1]])
        std::fill_n(nodes + first_edge_node(reference.type, degree_, e), degree_ - 1, vertex);
  }

  // What elements share. ---------------------------------------------------------------------------------------------

  template <std::size_t N, class KeyOf>
  static void read_bucket(const Buckets& buckets, Index bucket, const KeyOf& key_of, std::vector<Keyed_item<N>>& items)
  {
    items.clear();
    for (Index i = buckets.begin[bucket]; i < buckets.begin[bucket + 1]; ++i)
      items.push_back({key_of(buckets.items[i]), buckets.items[i]});
  }

  template <std::size_t N, class Visit>
  static void visit_groups(const std::vector<Keyed_item<N>>& items, const Visit& visit)
  {
    for (auto first = items.begin(); first != items.end();)
    {
      const auto last =
        std::find_if(first, items.end(), [&](const Keyed_item<N>& item) { return item.key != first->key; });
      visit(std::span<const Keyed_item<N>>(first, last));
      first = last;
    }
  }

  /// numbers the nodes of groups of equal items, in the order of their vertices, and hands each group its first node.
  template <std::size_t N, class KeyOf, class CountOf, class Place>
  void add_shared_nodes(Buckets buckets, const KeyOf& key_of, const CountOf& count_of, const Place& place)
  {
    std::vector<Index> counts =
      internal::for_each_run<Index>(buckets.bucket_count(), [&](Index first, Index last, Index& count) {
        std::vector<Keyed_item<N>> items;
        for (Index b = first; b < last; ++b)
        {
          read_bucket<N>(buckets, b, key_of, items);
          std::sort(items.begin(), items.end());
          for (std::size_t i = 0; i < items.size(); ++i)
            buckets.items[buckets.begin[b] + static_cast<Index>(i)] = items[i].item;
          visit_groups(items, [&](const auto& group) { count += count_of(group.front().item); });
        }
      });
    Index next = static_cast<Index>(mesh_.nodes.size());
    for (Index& count : counts)
      count = std::exchange(next, next + count); // now the first node of the run
    mesh_.nodes.resize(static_cast<std::size_t>(next));
    internal::for_each_run<char>(buckets.bucket_count(), [&](Index first, Index last, char&) {
      std::vector<Keyed_item<N>> items;
      Index node = counts[first / internal::buckets_per_run];
      for (Index b = first; b < last; ++b)
      {
        read_bucket<N>(buckets, b, key_of, items);
        visit_groups(items, [&](const auto& group) {
          place(group, node);
          node += count_of(group.front().item);
        });
      }
    });
  }

  // Edges: an item is 16 * element + edge. ---------------------------------------------------------------------------

  std::array<Index, 2> edge_vertices(Index item) const
  {
    const std::size_t block = elements_.block_index(item / 16);
    const Index* const nodes = nodes_of(block, item / 16);
    const auto& corners = reference_element(elements_.blocks()[block].section->type).edges[item % 16];
    return {nodes[corners[0]], nodes[corners[1]]};
  }

  void add_edge_nodes()
  {
    Buckets buckets = internal::make_buckets(joined_.vertex_count, [this](const auto& put) {
      for (std::size_t b = 0; b < elements_.blocks().size(); ++b)
      {
        const Element_block& block = elements_.blocks()[b];
        const Reference_element& reference = reference_element(block.section->type);
        tbb::parallel_for(block.first, block.first + block.section->size(), [&](Index element) {
          const Index* const nodes = nodes_of(b, element);
          for (int e = 0; e < reference.edge_count; ++e)
            if (const auto [low, high] = std::minmax(nodes[reference.edges[e][0]], nodes[reference.edges[e][1]]);
                low != high)
              put(low, 16 * element + e);
        });
      }
    });
    const auto key_of = [this](Index item) {
      const auto [a, b] = edge_vertices(item);
      return std::array{std::max(a, b)};
    };
    add_shared_nodes<1>(
      std::move(buckets), key_of, [this](Index) { return Index(degree_ - 1); },
      [this](const auto& group, Index first_node) { place_edge(group, first_node); });
  }

  void place_edge(std::span<const Keyed_item<1>> group, Index first_node)
  {
    const auto ends = edge_vertices(group.front().item);
    const auto [low, high] = std::minmax(ends[0], ends[1]);
    for (int k = 1; k < degree_; ++k)
      mesh_.nodes[first_node + k - 1] = internal::straight_edge_node(mesh_.nodes[low], mesh_.nodes[high], k, degree_);
    for (const Keyed_item<1>& edge : group)
    {
      const std::size_t block = elements_.block_index(edge.item / 16);
      const Element_type type = elements_.blocks()[block].section->type;
      Index* const target =
        nodes_of(block, edge.item / 16) + first_edge_node(type, degree_, static_cast<int>(edge.item % 16));
      const bool is_forward = edge_vertices(edge.item)[0] == low;
      for (int k = 0; k < degree_ - 1; ++k)
        target[k] = first_node + (is_forward ? k : degree_ - 2 - k);
    }
  }

  // Faces: an item is 8 * element + face, or + whole if the element is the face. --------------------------------------

  static constexpr int whole = 7;

  struct Element_face
  {
    Element_type type;
    int count;
    std::array<Index, 4> vertices;
    Index* nodes;                 ///< of the element
    std::span<const int> numbers; ///< of the face's nodes in the element; empty: the element is the face
  };

  Element_face element_face(Index item) const
  {
    const std::size_t block = elements_.block_index(item / 8);
    const Element_type element_type = elements_.blocks()[block].section->type;
    const int face = static_cast<int>(item % 8);
    Element_face result{element_type, 0, {no_index, no_index, no_index, no_index}, nodes_of(block, item / 8), {}};
    if (face != whole)
    {
      result.type = reference_element(element_type).faces[face].type;
      result.numbers = face_nodes(element_type, degree_, face);
    }
    result.count = corner_count(result.type);
    for (int c = 0; c < result.count; ++c)
      result.vertices[c] = result.nodes[face == whole ? c : result.numbers[c]];
    return result;
  }

  static std::array<Index, 4> sorted_vertices(const Element_face& face)
  {
    // The missing fourth vertex of a triangle stays behind the others and marks it as one.
    std::array<Index, 4> vertices = face.vertices;
    internal::sort_few(vertices, face.count);
    return vertices;
  }

  Index node_count_inside(Element_type face_type) const { return interior_node_count(face_type, degree_); }

  void add_face_nodes()
  {
    Buckets buckets = internal::make_buckets(joined_.vertex_count, [this](const auto& put) {
      for (const Element_block& block : elements_.blocks())
        tbb::parallel_for(block.first, block.first + block.section->size(),
                          [&](Index element) { put_faces(reference_element(block.section->type), element, put); });
    });
    const auto key_of = [this](Index item) {
      const std::array<Index, 4> vertices = sorted_vertices(element_face(item));
      return std::array{vertices[1], vertices[2], vertices[3]};
    };
    add_shared_nodes<3>(
      std::move(buckets), key_of, [this](Index item) { return node_count_inside(element_face(item).type); },
      [this](const auto& group, Index first_node) { place_face(group, first_node); });
  }

  template <class Put>
  void put_faces(const Reference_element& reference, Index element, const Put& put) const
  {
    const auto put_face = [&](int face) {
      put(sorted_vertices(element_face(8 * element + face))[0], 8 * element + face);
    };
    if (reference.dimension == 2 && node_count_inside(reference.type) > 0)
      put_face(whole);
    for (int f = 0; f < reference.face_count; ++f)
      if (node_count_inside(reference.faces[f].type) > 0)
        put_face(f);
  }

  void place_face(std::span<const Keyed_item<3>> group, Index first_node)
  {
    const Element_face first = element_face(group.front().item);
    const Canonical_face canonical = internal::canonical_face(first.vertices, first.count);
    std::array<Point, 4> corners = {};
    for (int c = 0; c < first.count; ++c)
      corners[c] = mesh_.nodes[first.vertices[canonical.corner(c, first.count)]];
    const std::span<const Lattice_point> lattice = canonical_nodes(first.type, degree_);
    const int inside = first_interior_node(first.type, degree_);
    for (int m = inside; m < static_cast<int>(lattice.size()); ++m)
      mesh_.nodes[first_node + m - inside] =
        internal::straight_face_node(corners, first.count, lattice[m][0], lattice[m][1], degree_);
    for (const Keyed_item<3>& item : group)
      set_face_nodes(element_face(item.item), inside, first_node);
  }

  void set_face_nodes(const Element_face& face, int inside, Index first_node) const
  {
    const Canonical_face canonical = internal::canonical_face(face.vertices, face.count);
    const std::span<const int> place = face_orientation(face.type, degree_, canonical.first, canonical.is_reversed);
    for (int m = inside; m < static_cast<int>(place.size()); ++m)
      face.nodes[face.numbers.empty() ? place[m] : face.numbers[place[m]]] = first_node + m - inside;
  }

  // Nodes inside cells. ----------------------------------------------------------------------------------------------

  void add_interior_nodes(std::size_t block)
  {
    const Element_block& b = elements_.blocks()[block];
    const Element_type type = b.section->type;
    if (reference_element(type).dimension < 3)
      return;
    const std::span<const std::array<double, 8>> weights = internal::interior_weights(type, degree_);
    const Index count = static_cast<Index>(weights.size());
    const Index first_node = static_cast<Index>(mesh_.nodes.size());
    mesh_.nodes.resize(static_cast<std::size_t>(first_node + count * b.section->size()));
    tbb::parallel_for(Index(0), b.section->size(), [&](Index e) {
      Index* const nodes = nodes_of(block, b.first + e);
      std::array<Point, 8> corners = {};
      for (int c = 0; c < corner_count(type); ++c)
        corners[c] = mesh_.nodes[nodes[c]];
      const std::span<const Point> used(corners.data(), static_cast<std::size_t>(corner_count(type)));
      for (Index m = 0; m < count; ++m)
      {
        const Index node = first_node + e * count + m;
        nodes[first_interior_node(type, degree_) + m] = node;
        mesh_.nodes[node] = internal::straight_interior_node(used, weights[m]);
      }
    });
  }

  void list_nodes_of_zones(Index z)
  {
    Curved_zone& zone = mesh_.zones[z];
    zone.nodes = joined_.vertex_of_point[z];
    last_zone_of_node_.resize(mesh_.nodes.size(), -1);
    const std::size_t own = zone.nodes.size();
    for (const auto* sections : {&zone.cells, &zone.faces, &zone.bars})
      for (const Curved_section& section : *sections)
        for (const Index node : section.nodes)
          if (node >= joined_.vertex_count && std::exchange(last_zone_of_node_[node], static_cast<int>(z)) != z)
            zone.nodes.push_back(node);
    std::sort(zone.nodes.begin() + static_cast<Index>(own), zone.nodes.end());
  }

  const Joined_zones& joined_;
  int degree_;
  Curved_mesh mesh_;
  internal::Element_blocks elements_;
  std::vector<Index*> nodes_of_block_;
  std::vector<int> last_zone_of_node_;
};

} // namespace

Curved_mesh elevate(Volume_mesh linear, const Joined_zones& joined, int degree)
{
  if (degree < 1 || degree > max_degree)
    throw Input_error(fmt::format("degree {} is outside 1 to {}", degree, max_degree));
  return Elevation(std::move(linear), joined, degree).elevate();
}

} // namespace recurve
