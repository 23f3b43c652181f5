#ifndef RECURVE_TESTS_SUPPORT_FEATURE_CHECK_H
#define RECURVE_TESTS_SUPPORT_FEATURE_CHECK_H

#include "support/feature_surfaces.h"

#include <recurve/core/exceptions.h>
#include <recurve/features/detect_features.h>
#include <recurve/features/feature_curves.h>

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Surface_mesh.h>

#include <vector>

namespace recurve::test {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Mesh = CGAL::Surface_mesh<Kernel::Point_3>;

/// `s` as a face graph; vertices keep their order.
inline Mesh to_mesh(const Surface& s)
{
  Mesh mesh;
  for (const Point& p : s.points)
    mesh.add_vertex({p[0], p[1], p[2]});
  for (const auto& face : s.faces)
  {
    std::vector<Mesh::Vertex_index> corners;
    corners.reserve(face.size());
    for (const std::size_t v : face)
      corners.emplace_back(static_cast<Mesh::size_type>(v));
    if (mesh.add_face(corners) == Mesh::null_face())
      throw Input_error("test surface is not manifold");
  }
  return mesh;
}

/// Detected against true feature edges of a surface; borders are not counted.
struct Score
{
  int hits = 0, truth = 0, false_edges = 0;
  int sharp_vertices = 0; ///< not on a border
  bool is_exact() const { return hits == truth && false_edges == 0; }
};

/// The flags of a surface mesh, and what they are worth.
struct Detection
{
  Mesh mesh;
  std::vector<char> edge_is_critical, vertex_is_sharp;
  Feature_report report;
  Score score;
};

inline Detection detect(const Surface& s, const Feature_options& options = {})
{
  Detection d;
  d.mesh = to_mesh(s);
  d.edge_is_critical.assign(d.mesh.num_edges(), 2);
  d.vertex_is_sharp.assign(d.mesh.num_vertices(), 2);
  auto critical = d.mesh.add_property_map<Mesh::Edge_index, bool>("e:critical").first;
  auto sharp = d.mesh.add_property_map<Mesh::Vertex_index, bool>("v:sharp").first;
  d.report = detect_features(d.mesh, critical, sharp, options);
  for (const auto e : d.mesh.edges())
  {
    d.edge_is_critical[e.idx()] = critical[e];
    if (d.mesh.is_border(e))
      continue;
    const bool truth = s.is_feature(s.points[d.mesh.vertex(e, 0).idx()], s.points[d.mesh.vertex(e, 1).idx()]);
    d.score.truth += truth;
    d.score.hits += truth && critical[e];
    d.score.false_edges += !truth && critical[e];
  }
  for (const auto v : d.mesh.vertices())
  {
    d.vertex_is_sharp[v.idx()] = sharp[v];
    d.score.sharp_vertices += sharp[v] && !d.mesh.is_border(v);
  }
  return d;
}

} // namespace recurve::test

#endif
