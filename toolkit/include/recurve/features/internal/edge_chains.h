#ifndef RECURVE_FEATURES_INTERNAL_EDGE_CHAINS_H
#define RECURVE_FEATURES_INTERNAL_EDGE_CHAINS_H

#include <recurve/features/internal/flat_surface.h>

#include <algorithm>
#include <vector>

namespace recurve::internal::features {

/// A chain of half-edges, each starting where the one before it ends.
struct Edge_chain
{
  std::vector<Index> halfedges;
  bool is_closed = false;
};

/// Cuts marked edges into chains that end at marked vertices and where other than two marked edges meet. Order and
/// direction depend only on the numbers of the vertices: an open chain starts at its end with the smaller number (at
/// equal ends, goes to the smaller neighbour first), a closed one at its smallest vertex towards its smaller neighbour,
/// and the chains are sorted by their first two vertices.
class Chain_tracer
{
public:
  Chain_tracer(const Flat_edges& edges, const std::vector<char>& is_marked, const std::vector<char>& is_stop)
    : edges_(edges), is_stop_(is_stop), out_(edges, [&](Index e) { return is_marked[e] != 0; }),
      is_walked_(static_cast<std::size_t>(edges.number_of_edges()), 0)
  {}

  std::vector<Edge_chain> run()
  {
    std::vector<Edge_chain> chains;
    for (const bool is_closed : {false, true})
      for (const Index h : out_.halfedges) // by source vertex, so a closed chain is met at its smallest vertex
        if (!is_walked_[h / 2] && (is_closed || is_end(edges_.source_of(h))))
        {
          chains.push_back({walk(h), is_closed});
          orient(chains.back());
        }
    std::stable_sort(chains.begin(), chains.end(), [&](const Edge_chain& a, const Edge_chain& b) {
      return key(a.halfedges.front()) < key(b.halfedges.front());
    });
    return chains;
  }

private:
  bool is_end(Index v) const { return is_stop_[v] || out_[v].size() != 2; }

  std::vector<Index> walk(Index first)
  {
    std::vector<Index> halfedges;
    for (Index h = first; !is_walked_[h / 2];)
    {
      halfedges.push_back(h);
      is_walked_[h / 2] = 1;
      const Index v = edges_.target[h];
      if (is_end(v))
        break;
      h = *out_[v].begin() == (h ^ 1) ? *(out_[v].begin() + 1) : *out_[v].begin();
    }
    return halfedges;
  }

  std::pair<Index, Index> key(Index h) const { return {edges_.source_of(h), edges_.target[h]}; }

  void orient(Edge_chain& chain) const
  {
    if (key(chain.halfedges.back() ^ 1) < key(chain.halfedges.front()))
    {
      std::reverse(chain.halfedges.begin(), chain.halfedges.end());
      for (Index& h : chain.halfedges)
        h ^= 1;
    }
  }

  const Flat_edges& edges_;
  const std::vector<char>& is_stop_;
  Out_halfedges out_;
  std::vector<char> is_walked_;
};

} // namespace recurve::internal::features

#endif
