#include "support/feature_check.h"

#include <catch2/catch.hpp>

#include <set>

using namespace recurve;
using namespace recurve::test;

namespace {

/// A flat 4 x 4 sheet with flags to set by hand; the vertex (i, j) is at the position (i, j, 0).
struct Sheet
{
  Mesh mesh = to_mesh(rough_sheet(4, 0, Split::quads, 1));
  Mesh::Property_map<Mesh::Edge_index, char> critical = mesh.add_property_map<Mesh::Edge_index, char>("c", 0).first;
  Mesh::Property_map<Mesh::Vertex_index, bool> sharp = mesh.add_property_map<Mesh::Vertex_index, bool>("s", 0).first;

  Mesh::Vertex_index at(int i, int j) const
  {
    for (const auto v : mesh.vertices())
      if (mesh.point(v) == Kernel::Point_3(i, j, 0))
        return v;
    throw Input_error("no such vertex");
  }

  void mark(const std::vector<std::pair<int, int>>& path)
  {
    for (std::size_t i = 0; i + 1 < path.size(); ++i)
    {
      const auto h = mesh.halfedge(at(path[i].first, path[i].second), at(path[i + 1].first, path[i + 1].second));
      critical[mesh.edge(h)] = 1;
    }
  }

  auto trace() const { return trace_feature_curves(mesh, critical, sharp); }
};

template <class Curve>
void require_chain(const Mesh& mesh, const Curve& curve)
{
  for (std::size_t i = 0; i + 1 < curve.halfedges.size(); ++i)
    CHECK(mesh.target(curve.halfedges[i]) == mesh.source(curve.halfedges[i + 1]));
  if (curve.is_closed)
    CHECK(mesh.target(curve.halfedges.back()) == mesh.source(curve.halfedges.front()));
}

} // namespace

TEST_CASE("trace_feature_curves: an open chain, cut at a sharp vertex")
{
  Sheet s;
  s.mark({{0, 2}, {1, 2}, {2, 2}, {3, 2}, {4, 2}});
  REQUIRE(s.trace().size() == 1);
  CHECK(s.trace()[0].halfedges.size() == 4);
  CHECK_FALSE(s.trace()[0].is_closed);
  require_chain(s.mesh, s.trace()[0]);
  s.sharp[s.at(1, 2)] = true;
  REQUIRE(s.trace().size() == 2);
  CHECK(s.trace()[0].halfedges.size() + s.trace()[1].halfedges.size() == 4);
}

TEST_CASE("trace_feature_curves: a loop is closed unless a vertex on it is sharp")
{
  Sheet s;
  s.mark({{1, 1}, {2, 1}, {2, 2}, {1, 2}, {1, 1}});
  REQUIRE(s.trace().size() == 1);
  CHECK(s.trace()[0].is_closed);
  CHECK(s.trace()[0].halfedges.size() == 4);
  require_chain(s.mesh, s.trace()[0]);
  s.sharp[s.at(2, 2)] = true;
  REQUIRE(s.trace().size() == 1);
  CHECK_FALSE(s.trace()[0].is_closed);
  CHECK(s.mesh.source(s.trace()[0].halfedges.front()) == s.at(2, 2));
  CHECK(s.mesh.target(s.trace()[0].halfedges.back()) == s.at(2, 2));
}

TEST_CASE("trace_feature_curves: chains end where other than two critical edges meet")
{
  Sheet s;
  s.mark({{0, 2}, {1, 2}, {2, 2}, {3, 2}, {4, 2}});
  s.mark({{2, 0}, {2, 1}, {2, 2}});
  REQUIRE(s.trace().size() == 3);
  std::set<Mesh::Edge_index> seen;
  for (const auto& curve : s.trace())
  {
    CHECK(curve.halfedges.size() == 2);
    require_chain(s.mesh, curve);
    for (const auto h : curve.halfedges)
      CHECK(seen.insert(s.mesh.edge(h)).second);
  }
}

TEST_CASE("trace_feature_curves: order and direction follow the vertices")
{
  Sheet s;
  s.mark({{4, 0}, {4, 1}, {4, 2}});
  s.mark({{2, 3}, {1, 3}, {0, 3}});
  s.mark({{2, 2}, {2, 1}, {1, 1}, {1, 2}, {2, 2}});
  const auto curves = s.trace();
  REQUIRE(curves.size() == 3);
  std::vector<std::pair<Mesh::Vertex_index, Mesh::Vertex_index>> starts;
  for (const auto& curve : curves)
  {
    starts.emplace_back(s.mesh.source(curve.halfedges.front()), s.mesh.target(curve.halfedges.front()));
    if (!curve.is_closed)
      CHECK(s.mesh.source(curve.halfedges.front()) < s.mesh.target(curve.halfedges.back()));
    else
      for (const auto h : curve.halfedges)
        CHECK(s.mesh.source(curve.halfedges.front()) <= s.mesh.source(h));
  }
  CHECK(std::is_sorted(starts.begin(), starts.end()));
}

TEST_CASE("critical vertices, curve numbers and surface regions of a cube")
{
  Mesh mesh = to_mesh(cube(3, Split::same));
  auto critical = mesh.add_property_map<Mesh::Edge_index, bool>("c").first;
  auto sharp = mesh.add_property_map<Mesh::Vertex_index, bool>("s").first;
  detect_features(mesh, critical, sharp);

  auto vertex_is_critical = mesh.add_property_map<Mesh::Vertex_index, bool>("vc", true).first;
  mark_critical_vertices(mesh, critical, sharp, vertex_is_critical);
  CHECK(std::count_if(mesh.vertices().begin(), mesh.vertices().end(), [&](auto v) { return vertex_is_critical[v]; }) ==
        8 + 12 * 2);

  const auto curves = trace_feature_curves(mesh, critical, sharp);
  auto curve_of = mesh.add_property_map<Mesh::Edge_index, int>("curve").first;
  number_feature_curves(mesh, curves, curve_of);
  std::vector<int> edges(12, 0);
  for (const auto e : mesh.edges())
  {
    CHECK((curve_of[e] >= 0) == critical[e]);
    if (curve_of[e] >= 0)
      ++edges[static_cast<std::size_t>(curve_of[e])];
  }
  CHECK(edges == std::vector<int>(12, 3));

  auto region = mesh.add_property_map<Mesh::Face_index, std::size_t>("region").first;
  CHECK(number_surface_regions(mesh, critical, region) == 6);
  std::vector<int> faces(6, 0);
  for (const auto f : mesh.faces())
    ++faces[region[f]];
  CHECK(faces == std::vector<int>(6, 18));
  CHECK(region[*mesh.faces().begin()] == 0);
}
