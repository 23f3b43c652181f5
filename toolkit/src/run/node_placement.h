#ifndef RECURVE_SRC_RUN_NODE_PLACEMENT_H
#define RECURVE_SRC_RUN_NODE_PLACEMENT_H

#include <recurve/mesh/boundary_faces.h>
#include <recurve/mesh/curved_mesh.h>
#include <recurve/volume/node_state.h>

#include <array>
#include <cstdint>
#include <map>
#include <vector>

namespace recurve {

/// How far a node was moved.
struct Way
{
  double length = 0;
  double relative = 0;   ///< over the length of its edge, or of the longest edge of its face
  Point at = {};         ///< where it was
  Index face = no_index; ///< of the surface
};

/// Puts the nodes of a curved surface into the mesh. A node on an edge is named by a face, the corner at which the edge
/// starts in that face, and its number from there on.
///
/// An edge that occurs several times in the surface (of more than two faces) takes the mean of all its occurrences.
class Node_placement
{
public:
  /// \param mesh      elevated mesh, every node at its straight-sided position.
  /// \param owners    per face of the surface the cell whose Reference_face corners are the face's, in their order.
  /// \pre mesh.degree >= 2
  Node_placement(Curved_mesh& mesh, std::vector<Cell_face> owners);

  /// tells of an edge of the surface, each once, before nodes are put.
  void count_edge(Index face, int corner);

  /// node `k` of 1 .. degree - 1 on the edge that starts at `corner` of `face`.
  void put_edge_node(Index face, int corner, int k, const Point& position);

  /// node `m` of those inside `face`.
  void put_face_node(Index face, int m, const Point& position);

  /// moves the nodes of edges that occur several times. \post all nodes of the surface are in place
  void finish();

  std::vector<Node_state>& states() { return states_; }
  Index shared_edges() const { return shared_edges_; }
  Index moved_edge_nodes() const { return moved_edge_nodes_; }
  Index moved_face_nodes() const { return moved_face_nodes_; }
  const Way& longest_way() const { return longest_way_; }
  const Way& longest_relative_way() const { return longest_relative_way_; }

private:
  /// An edge of a face of a reference cell.
  struct Face_edge
  {
    int first_node = 0; ///< canonical number of the node after the corner at which the edge starts in the face
    int step = 1;       ///< to the next one
  };
  using Cell_edges = std::array<std::array<Face_edge, 4>, 6>; ///< by face and corner

  void tabulate_edges();
  const Face_edge& face_edge(Index face, int corner) const;
  Index edge_node(Index face, int corner, int k) const;
  Index corner_node(Index face, int corner) const;
  int corner_count(Index face) const;
  double edge_length(Index face, int corner) const;
  void move(Index node, const Point& position, Index face, double length);

  Curved_mesh& mesh_;
  std::vector<Cell_face> owners_;        ///< per face of the surface
  std::vector<const Index*> cell_nodes_; ///< of the cell behind each face of the surface
  std::vector<Element_type> cell_types_;
  std::array<Cell_edges, all_element_types.size()> edges_ = {};
  std::vector<Node_state> states_;
  std::vector<std::uint8_t> occurrences_; ///< per node, where it is the first of an edge of the surface
  struct Shared_node
  {
    Point sum = {}; ///< of displacements
    int occurrences = 1;
    Index face = no_index;
    double length = 0; ///< of the edge
  };
  std::map<Index, Shared_node> shared_nodes_;
  Index shared_edges_ = 0, moved_edge_nodes_ = 0, moved_face_nodes_ = 0;
  Way longest_way_, longest_relative_way_;
};

} // namespace recurve

#endif
