#ifndef RECURVE_FEATURES_INTERNAL_NUMBERING_H
#define RECURVE_FEATURES_INTERNAL_NUMBERING_H

#include <recurve/core/types.h>

#include <CGAL/boost/graph/named_params_helper.h>
#include <CGAL/boost/graph/properties.h>
#include <CGAL/property_map.h>

#include <boost/graph/graph_traits.hpp>

#include <vector>

namespace recurve::internal::features {

/// the index map of `g` for `Tag` (`boost::vertex_index_t`, `boost::halfedge_index_t`). Maps computed from descriptors
/// (`Surface_mesh`, OpenMesh) are taken as they are, with the gaps that removed elements leave; maps that can be
/// written (`Polyhedron_3`) may not be initialised yet, and CGAL sees to that.
template <class Tag, class Graph>
auto index_map(const Graph& g)
{
  constexpr bool of_vertices = std::is_same_v<Tag, boost::vertex_index_t>;
  if constexpr (CGAL::graph_has_property<Graph, Tag>::value)
  {
    using Map = typename boost::property_map<Graph, Tag>::const_type;
    if constexpr (!CGAL::internal::Is_writable_property_map<Map>::value)
      return get(Tag(), g);
    else if constexpr (of_vertices)
      return CGAL::get_initialized_vertex_index_map(g);
    else
      return CGAL::get_initialized_halfedge_index_map(g);
  }
  else if constexpr (of_vertices)
    return CGAL::get_initialized_vertex_index_map(g);
  else
    return CGAL::get_initialized_halfedge_index_map(g);
}

/// Numbers 0, 1, ... for the descriptors of one kind, in the order in which they are added.
template <class IndexMap>
class Numbering
{
public:
  using Descriptor = typename boost::property_traits<IndexMap>::key_type;

  explicit Numbering(IndexMap map) : map_(map) {}

  void reserve(std::size_t size) { number_.reserve(size); }

  void add(const Descriptor& d, Index number)
  {
    const auto i = static_cast<std::size_t>(get(map_, d));
    if (i >= number_.size())
      number_.resize(i + 1, no_index);
    number_[i] = number;
    ++size_;
  }

  Index size() const { return size_; }

  Index operator()(const Descriptor& d) const { return number_[static_cast<std::size_t>(get(map_, d))]; }

private:
  IndexMap map_;
  std::vector<Index> number_;
  Index size_ = 0;
};

/// the number of each vertex of `g` in the order of `vertices(g)`.
template <class Graph>
auto number_vertices(const Graph& g)
{
  Numbering numbering(index_map<boost::vertex_index_t>(g));
  numbering.reserve(num_vertices(g));
  Index n = 0;
  for (const auto v : CGAL::make_range(vertices(g)))
    numbering.add(v, n++);
  return numbering;
}

} // namespace recurve::internal::features

#endif
