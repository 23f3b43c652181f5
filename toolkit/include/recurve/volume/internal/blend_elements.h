#ifndef RECURVE_VOLUME_INTERNAL_BLEND_ELEMENTS_H
#define RECURVE_VOLUME_INTERNAL_BLEND_ELEMENTS_H

#include <recurve/core/exceptions.h>
#include <recurve/core/types.h>
#include <recurve/elements/blend_weights.h>
#include <recurve/elements/element.h>
#include <recurve/elements/node_layout.h>
#include <recurve/volume/element_block.h>
#include <recurve/volume/internal/point_access.h>
#include <recurve/volume/node_state.h>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <string>
#include <tuple>
#include <vector>

namespace recurve::internal {

/// The work of `blend_interior()`: find the touched elements, blend their faces, each once, then their cells.
template <class PointRange>
class Interior_blend
{
public:
  Interior_blend(PointRange& nodes, std::span<Node_state> states, std::span<const Element_block> blocks, int degree);

  void find_touched_elements();
  void blend_faces();
  void blend_cells();

  Index touched_elements() const { return static_cast<Index>(touched_.size()); }
  Index blended_nodes() const { return blended_nodes_; }
  double largest_displacement() const { return std::sqrt(largest_squared_); }

private:
  struct Element
  {
    std::size_t block;
    Index number;
  };

  /// A face of a touched element. `key` is its smallest inner node, which no other face has.
  struct Face
  {
    Index key;
    Element element;
    int face; ///< -1: the element is itself a face

    bool operator<(const Face& other) const
    {
      return std::tie(key, element.block, element.number, face) <
             std::tie(other.key, other.element.block, other.element.number, other.face);
    }
  };

  /// What one thread's share of the work adds to the report.
  struct Tally
  {
    Index nodes = 0;
    double largest_squared = 0;
  };

  using Node_list = std::array<Index, 343>; ///< node_count(hexahedron, max_degree) entries at most
  using Displacements = std::array<Point, 343>;

  std::span<const Index> nodes_of(Element element) const;
  const Blend_weights& weights_of(Element_type type) const { return weights_[static_cast<std::size_t>(type)]; }
  bool is_touched(Element element) const;
  void check(Element element) const;
  void add_faces(Element element, std::vector<Face>& faces) const;
  std::span<const Index> face_view(const Face& face, Node_list& storage, Element_type& type) const;
  Point displacement(std::span<const Index> element, const Weight_rows& straight, int node) const;
  double negligible_displacement(std::span<const Index> corners) const;
  void move_interior(Element_type type, std::span<const Index> element, Tally& tally);
  template <class Body>
  void for_each_tallied(std::size_t count, const Body& body);

  // Elements are taken in runs of this length, long enough to hide the cost of a task.
  static constexpr std::size_t run_length = 4096;

  PointRange& nodes_;
  std::span<Node_state> states_;
  std::span<const Element_block> blocks_;
  int degree_;
  std::array<Blend_weights, all_element_types.size()> weights_;
  std::vector<Element> touched_;
  Index blended_nodes_ = 0;
  double largest_squared_ = 0;
};

template <class PointRange>
Interior_blend<PointRange>::Interior_blend(PointRange& nodes, std::span<Node_state> states,
                                           std::span<const Element_block> blocks, int degree)
  : nodes_(nodes), states_(states), blocks_(blocks), degree_(degree)
{
  if (degree < 1 || degree > max_degree)
    throw Input_error("blend_interior: degree " + std::to_string(degree) + " is outside [1, " +
                      std::to_string(max_degree) + "]");
  if (std::ranges::size(nodes) != states.size())
    throw Input_error("blend_interior: " + std::to_string(std::ranges::size(nodes)) + " nodes, but " +
                      std::to_string(states.size()) + " states");
  for (const Element_block& block : blocks)
    if (block.nodes.size() % static_cast<std::size_t>(node_count(block.type, degree)) != 0)
      throw Input_error("blend_interior: a block of elements of type " + std::string(element_name(block.type)) +
                        " has " + std::to_string(block.nodes.size()) + " nodes, which is no multiple of " +
                        std::to_string(node_count(block.type, degree)));
}

template <class PointRange>
std::span<const Index> Interior_blend<PointRange>::nodes_of(Element element) const
{
  const Element_block& block = blocks_[element.block];
  const auto n = static_cast<std::size_t>(node_count(block.type, degree_));
  return block.nodes.subspan(static_cast<std::size_t>(element.number) * n, n);
}

template <class PointRange>
bool Interior_blend<PointRange>::is_touched(Element element) const
{
  const auto nodes = nodes_of(element).subspan(static_cast<std::size_t>(corner_count(blocks_[element.block].type)));
  return std::ranges::any_of(nodes,
                             [&](Index n) { return states_[static_cast<std::size_t>(n)] == Node_state::placed; });
}

template <class PointRange>
void Interior_blend<PointRange>::check(Element element) const
{
  for (const Index n : nodes_of(element))
    if (n < 0 || static_cast<std::size_t>(n) >= states_.size())
      throw Input_error("blend_interior: " + std::string(element_name(blocks_[element.block].type)) + " " +
                        std::to_string(element.number) + " of block " + std::to_string(element.block) + " names node " +
                        std::to_string(n) + " of " + std::to_string(states_.size()));
}

template <class PointRange>
void Interior_blend<PointRange>::find_touched_elements()
{
  for (std::size_t b = 0; b < blocks_.size(); ++b)
  {
    const Element_type type = blocks_[b].type;
    const std::size_t count = blocks_[b].nodes.size() / static_cast<std::size_t>(node_count(type, degree_));
    std::vector<std::vector<Index>> found((count + run_length - 1) / run_length);
    tbb::parallel_for(std::size_t(0), found.size(), [&](std::size_t run) {
      for (std::size_t e = run * run_length; e < std::min(count, (run + 1) * run_length); ++e)
      {
        const Element element = {b, static_cast<Index>(e)};
        check(element);
        if (reference_element(type).dimension > 1 && is_touched(element))
          found[run].push_back(element.number);
      }
    });
    for (const auto& run : found)
      for (const Index number : run)
        touched_.push_back({b, number});
    if (reference_element(type).dimension > 1 && !touched_.empty() && touched_.back().block == b)
      weights_[static_cast<std::size_t>(type)] = Blend_weights(type, degree_);
  }
}

/// lists the faces of `element` that have inner nodes to move and a placed node on an edge.
template <class PointRange>
void Interior_blend<PointRange>::add_faces(Element element, std::vector<Face>& faces) const
{
  const Element_type type = blocks_[element.block].type;
  const Reference_element& reference = reference_element(type);
  const int face_count = reference.dimension == 2 ? 1 : reference.face_count;
  for (int f = 0; f < face_count; ++f)
  {
    const Element_type own_type = reference.dimension == 2 ? type : reference.faces[static_cast<std::size_t>(f)].type;
    if (interior_node_count(own_type, degree_) == 0)
      continue;
    Face face = {no_index, element, reference.dimension == 2 ? -1 : f};
    Node_list storage;
    Element_type face_type;
    const std::span<const Index> view = face_view(face, storage, face_type);
    const auto inner = view.subspan(static_cast<std::size_t>(first_interior_node(face_type, degree_)));
    const auto edges =
      view.first(view.size() - inner.size()).subspan(static_cast<std::size_t>(corner_count(face_type)));
    const auto has = [&](std::span<const Index> list, Node_state state) {
      return std::ranges::any_of(list, [&](Index n) { return states_[static_cast<std::size_t>(n)] == state; });
    };
    if (has(inner, Node_state::straight) && has(edges, Node_state::placed))
    {
      face.key = *std::ranges::min_element(inner);
      faces.push_back(face);
    }
  }
}

/// the nodes of a face, seen such that the view depends on the numbers of its corners only: from the smallest towards
/// the smaller of its neighbours.
template <class PointRange>
std::span<const Index> Interior_blend<PointRange>::face_view(const Face& face, Node_list& storage,
                                                             Element_type& type) const
{
  const std::span<const Index> element = nodes_of(face.element);
  type = blocks_[face.element.block].type;
  std::span<const int> numbers;
  if (face.face >= 0)
  {
    numbers = face_nodes(type, degree_, face.face);
    type = reference_element(type).faces[static_cast<std::size_t>(face.face)].type;
  }
  const auto node = [&](int m) {
    return element[numbers.empty() ? static_cast<std::size_t>(m)
                                   : static_cast<std::size_t>(numbers[static_cast<std::size_t>(m)])];
  };
  const int n = corner_count(type);
  int first = 0;
  for (int c = 1; c < n; ++c)
    if (node(c) < node(first))
      first = c;
  const bool is_reversed = node((first + n - 1) % n) < node((first + 1) % n);
  const std::span<const int> order = face_orientation(type, degree_, first, is_reversed);
  for (std::size_t m = 0; m < order.size(); ++m)
    storage[m] = node(order[m]);
  return std::span<const Index>(storage).first(order.size());
}

/// from the straight position of node `node` of `element` to where it stands; zero for a node that has not moved.
template <class PointRange>
Point Interior_blend<PointRange>::displacement(std::span<const Index> element, const Weight_rows& straight,
                                               int node) const
{
  const auto at = [&](int m) {
    return coordinates(std::ranges::begin(nodes_)[static_cast<std::ptrdiff_t>(element[static_cast<std::size_t>(m)])]);
  };
  Point result = {0, 0, 0};
  if (!is_displaced(states_[static_cast<std::size_t>(element[static_cast<std::size_t>(node)])]))
    return result;
  // Differences to one corner keep the digits of a mesh far from the origin, and are zero in a coordinate in which all
  // corners agree.
  const Point origin = at(0), here = at(node);
  for (const Weight_rows::Entry& entry : straight.row(node))
    for (std::size_t d = 0; d < 3; ++d)
      result[d] -= entry.weight * (at(entry.column)[d] - origin[d]);
  for (std::size_t d = 0; d < 3; ++d)
    result[d] += here[d] - origin[d];
  return result;
}

/// the length up to which a displacement in the element with these corners is nothing but rounding.
template <class PointRange>
double Interior_blend<PointRange>::negligible_displacement(std::span<const Index> corners) const
{
  // A displacement is a difference of positions, each rounded to half a unit in the last place, weighted and summed.
  constexpr double rounding = 8 * std::numeric_limits<double>::epsilon();

  double largest = 0;
  const auto begin = std::ranges::begin(nodes_);
  const Point origin = coordinates(begin[static_cast<std::ptrdiff_t>(corners[0])]);
  for (const Index corner : corners)
  {
    const Point point = coordinates(begin[static_cast<std::ptrdiff_t>(corner)]);
    for (std::size_t d = 0; d < 3; ++d)
      largest = std::max({largest, std::abs(point[d]), std::abs(point[d] - origin[d])});
  }
  return rounding * largest;
}

/// moves the nodes inside one element, whose edges and faces are final.
template <class PointRange>
void Interior_blend<PointRange>::move_interior(Element_type type, std::span<const Index> element, Tally& tally)
{
  const Blend_weights& weights = weights_of(type);
  const int first = first_interior_node(type, degree_);
  Displacements displacements;
  for (int m = corner_count(type); m < first; ++m)
    displacements[static_cast<std::size_t>(m)] = displacement(element, weights.straight(), m);
  const double negligible = negligible_displacement(element.first(static_cast<std::size_t>(corner_count(type))));
  for (int r = 0; r < weights.blend().size(); ++r)
  {
    const auto id = static_cast<std::size_t>(element[static_cast<std::size_t>(first + r)]);
    if (states_[id] != Node_state::straight)
      continue;
    Point sum = {0, 0, 0};
    for (const Weight_rows::Entry& entry : weights.blend().row(r))
      for (std::size_t d = 0; d < 3; ++d)
        sum[d] += entry.weight * displacements[static_cast<std::size_t>(entry.column)][d];
    const double squared = sum[0] * sum[0] + sum[1] * sum[1] + sum[2] * sum[2];
    if (squared <= negligible * negligible)
      continue;
    auto&& point = std::ranges::begin(nodes_)[static_cast<std::ptrdiff_t>(id)];
    const Point old = coordinates(point);
    using Value = std::ranges::range_value_t<PointRange>;
    point = make_point<Value>({old[0] + sum[0], old[1] + sum[1], old[2] + sum[2]});
    states_[id] = Node_state::blended;
    ++tally.nodes;
    tally.largest_squared = std::max(tally.largest_squared, squared);
  }
}

/// calls `body(m, tally)` for m = 0 .. count - 1 in parallel.
template <class PointRange>
template <class Body>
void Interior_blend<PointRange>::for_each_tallied(std::size_t count, const Body& body)
{
  std::vector<Tally> tallies((count + run_length - 1) / run_length);
  tbb::parallel_for(std::size_t(0), tallies.size(), [&](std::size_t run) {
    for (std::size_t m = run * run_length; m < std::min(count, (run + 1) * run_length); ++m)
      body(m, tallies[run]);
  });
  for (const Tally& tally : tallies)
  {
    blended_nodes_ += tally.nodes;
    largest_squared_ = std::max(largest_squared_, tally.largest_squared);
  }
}

template <class PointRange>
void Interior_blend<PointRange>::blend_faces()
{
  std::vector<Face> faces;
  for (const Element element : touched_)
    add_faces(element, faces);
  tbb::parallel_sort(faces.begin(), faces.end());
  faces.erase(std::unique(faces.begin(), faces.end(), [](const Face& a, const Face& b) { return a.key == b.key; }),
              faces.end());
  for (const Element_type type : {Element_type::triangle, Element_type::quadrangle})
    weights_[static_cast<std::size_t>(type)] = Blend_weights(type, degree_);

  for_each_tallied(faces.size(), [&](std::size_t m, Tally& tally) {
    Node_list storage;
    Element_type type;
    const std::span<const Index> view = face_view(faces[m], storage, type);
    move_interior(type, view, tally);
  });
}

template <class PointRange>
void Interior_blend<PointRange>::blend_cells()
{
  for_each_tallied(touched_.size(), [&](std::size_t m, Tally& tally) {
    const Element_type type = blocks_[touched_[m].block].type;
    if (reference_element(type).dimension == 3)
      move_interior(type, nodes_of(touched_[m]), tally);
  });
}

} // namespace recurve::internal

#endif
