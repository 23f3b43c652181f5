#include <recurve/core/named_parameters.h>

#include <catch2/catch.hpp>

namespace {

namespace cgal = CGAL::parameters;

template <class NamedParameters>
constexpr bool takes_point_map_and_edge_map(const NamedParameters&)
{
  return recurve::only_names<NamedParameters, recurve::names::vertex_point_map,
                             recurve::names::edge_is_constrained_map>;
}

} // namespace

TEST_CASE("only_names accepts any chain of the allowed names and nothing else")
{
  CHECK(takes_point_map_and_edge_map(recurve::no_parameters));
  CHECK(takes_point_map_and_edge_map(cgal::vertex_point_map(1)));
  CHECK(takes_point_map_and_edge_map(cgal::edge_is_constrained_map(1).vertex_point_map(2)));
  CHECK_FALSE(takes_point_map_and_edge_map(cgal::vertex_normal_map(1)));
  CHECK_FALSE(takes_point_map_and_edge_map(cgal::vertex_point_map(1).vertex_normal_map(2)));
  CHECK_FALSE(takes_point_map_and_edge_map(cgal::vertex_normal_map(2).vertex_point_map(1)));
}

TEST_CASE("parameter_or gives the caller's value wherever it stands in the chain, else the default")
{
  const auto params = cgal::edge_is_constrained_map(3).vertex_point_map(4);
  CHECK(recurve::parameter_or<recurve::names::edge_is_constrained_map>(params, 0) == 3);
  CHECK(recurve::parameter_or<recurve::names::vertex_point_map>(params, 0) == 4);
  CHECK(recurve::parameter_or<recurve::names::vertex_normal_map>(params, 7) == 7);
  CHECK(recurve::parameter_or<recurve::names::vertex_point_map>(recurve::no_parameters, 7) == 7);
}
