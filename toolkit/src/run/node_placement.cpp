#include "node_placement.h"

#include <recurve/elements/node_layout.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace recurve {

namespace {

double distance(const Point& a, const Point& b)
{
  return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
}

/// the nodes of each cell of a zone, by number: where they start and the type.
struct Cell_table
{
  explicit Cell_table(const Curved_zone& zone, int degree)
  {
    for (const Curved_section& section : zone.cells)
    {
      firsts.push_back(count);
      sections.push_back(&section);
      count += static_cast<Index>(section.nodes.size()) / node_count(section.type, degree);
    }
  }

  std::pair<const Curved_section*, Index> find(Index cell) const
  {
    const auto after = std::upper_bound(firsts.begin(), firsts.end(), cell);
    const auto number = static_cast<std::size_t>(after - firsts.begin()) - 1;
    return {sections[number], cell - firsts[number]};
  }

  std::vector<Index> firsts;
  std::vector<const Curved_section*> sections;
  Index count = 0;
};

} // namespace

Node_placement::Node_placement(Curved_mesh& mesh, std::vector<Cell_face> owners)
  : mesh_(mesh), owners_(std::move(owners)), states_(mesh.nodes.size(), Node_state::straight),
    occurrences_(mesh.nodes.size(), 0)
{
  std::vector<Cell_table> tables;
  for (const Curved_zone& zone : mesh.zones)
    tables.emplace_back(zone, mesh.degree);
  cell_nodes_.reserve(owners_.size());
  cell_types_.reserve(owners_.size());
  for (const Cell_face& owner : owners_)
  {
    const auto [section, element] = tables[static_cast<std::size_t>(owner.zone)].find(owner.cell);
    cell_nodes_.push_back(section->nodes.data() + element * node_count(section->type, mesh.degree));
    cell_types_.push_back(section->type);
  }
  tabulate_edges();
}

void Node_placement::tabulate_edges()
{
  for (Element_type type : all_element_types)
  {
    const Reference_element& element = reference_element(type);
    for (int f = 0; f < element.face_count; ++f)
    {
      const Reference_face& face = element.faces[static_cast<std::size_t>(f)];
      for (int c = 0; c < face.corner_count; ++c)
      {
        const int from = face.corners[static_cast<std::size_t>(c)];
        const int to = face.corners[static_cast<std::size_t>((c + 1) % face.corner_count)];
        Face_edge& entry =
          edges_[static_cast<std::size_t>(type)][static_cast<std::size_t>(f)][static_cast<std::size_t>(c)];
        for (int e = 0; e < element.edge_count; ++e)
        {
          const auto& ends = element.edges[static_cast<std::size_t>(e)];
          const int first = first_edge_node(type, mesh_.degree, e);
          if (ends[0] == from && ends[1] == to)
            entry = {first, 1};
          else if (ends[0] == to && ends[1] == from)
            entry = {first + mesh_.degree - 2, -1};
        }
      }
    }
  }
}

const Node_placement::Face_edge& Node_placement::face_edge(Index face, int corner) const
{
  const auto f = static_cast<std::size_t>(face);
  return edges_[static_cast<std::size_t>(cell_types_[f])][static_cast<std::size_t>(owners_[f].face)]
               [static_cast<std::size_t>(corner)];
}

Index Node_placement::edge_node(Index face, int corner, int k) const
{
  const Face_edge& edge = face_edge(face, corner);
  return cell_nodes_[static_cast<std::size_t>(face)][edge.first_node + (k - 1) * edge.step];
}

int Node_placement::corner_count(Index face) const
{
  const auto f = static_cast<std::size_t>(face);
  return reference_element(cell_types_[f]).faces[static_cast<std::size_t>(owners_[f].face)].corner_count;
}

Index Node_placement::corner_node(Index face, int corner) const
{
  const auto f = static_cast<std::size_t>(face);
  const auto& corners = reference_element(cell_types_[f]).faces[static_cast<std::size_t>(owners_[f].face)].corners;
  return cell_nodes_[f][corners[static_cast<std::size_t>(corner)]];
}

double Node_placement::edge_length(Index face, int corner) const
{
  const Index from = corner_node(face, corner);
  const Index to = corner_node(face, (corner + 1) % corner_count(face));
  return distance(mesh_.nodes[static_cast<std::size_t>(from)], mesh_.nodes[static_cast<std::size_t>(to)]);
}

void Node_placement::count_edge(Index face, int corner)
{
  // An edge is known by the smaller of its outermost nodes, from whichever end it is seen.
  const Index node = std::min(edge_node(face, corner, 1), edge_node(face, corner, mesh_.degree - 1));
  const auto n = static_cast<std::size_t>(node);
  if (occurrences_[n] < std::numeric_limits<std::uint8_t>::max())
    ++occurrences_[n];
  if (occurrences_[n] < 2)
    return;
  shared_edges_ += occurrences_[n] == 2;
  for (int k = 1; k < mesh_.degree; ++k)
  {
    Shared_node& shared = shared_nodes_[edge_node(face, corner, k)];
    ++shared.occurrences;
    shared.face = face;
    shared.length = edge_length(face, corner);
  }
}

void Node_placement::put_edge_node(Index face, int corner, int k, const Point& position)
{
  const Index node = edge_node(face, corner, k);
  const auto shared = shared_nodes_.find(node);
  if (shared == shared_nodes_.end())
  {
    ++moved_edge_nodes_;
    move(node, position, face, edge_length(face, corner));
    return;
  }
  for (std::size_t c = 0; c < 3; ++c)
    shared->second.sum[c] += position[c] - mesh_.nodes[static_cast<std::size_t>(node)][c];
}

void Node_placement::put_face_node(Index face, int m, const Point& position)
{
  const auto f = static_cast<std::size_t>(face);
  double longest_edge = 0;
  for (int corner = 0; corner < corner_count(face); ++corner)
    longest_edge = std::max(longest_edge, edge_length(face, corner));
  ++moved_face_nodes_;
  const int first = first_face_node(cell_types_[f], mesh_.degree, owners_[f].face);
  move(cell_nodes_[f][first + m], position, face, longest_edge);
}

void Node_placement::finish()
{
  // Ascending by node, so that the report does not depend on anything else.
  for (const auto& [node, shared] : shared_nodes_)
  {
    if (shared.sum == Point{})
      continue;
    Point position = mesh_.nodes[static_cast<std::size_t>(node)];
    for (std::size_t c = 0; c < 3; ++c)
      position[c] += shared.sum[c] / shared.occurrences;
    ++moved_edge_nodes_;
    move(node, position, shared.face, shared.length);
  }
  shared_nodes_.clear();
}

void Node_placement::move(Index node, const Point& position, Index face, double length)
{
  Point& place = mesh_.nodes[static_cast<std::size_t>(node)];
  const double moved = distance(position, place);
  const Way way{moved, length > 0 ? moved / length : 0, place, face};
  if (way.length > longest_way_.length)
    longest_way_ = way;
  if (way.relative > longest_relative_way_.relative)
    longest_relative_way_ = way;
  place = position;
  states_[static_cast<std::size_t>(node)] = Node_state::placed;
}

} // namespace recurve
