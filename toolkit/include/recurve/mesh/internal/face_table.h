#ifndef RECURVE_MESH_INTERNAL_FACE_TABLE_H
#define RECURVE_MESH_INTERNAL_FACE_TABLE_H

#include <recurve/mesh/internal/buckets.h>
#include <recurve/mesh/internal/element_blocks.h>
#include <recurve/mesh/internal/sort_few.h>

#include <array>
#include <span>
#include <tuple>
#include <utility>
#include <vector>

namespace recurve::internal {

/// The corners of a face, as points of its zone.
struct Face_corners
{
  Index zone = no_index;
  int count = 0;
  std::array<Index, 4> points = {};
};

/// The distinct vertices of a face, ascending, then no_index. A quadrangle with a repeated corner (side of a collapsed
/// hexahedron) has the key of the triangle that it looks like, so that it meets the triangle of its neighbour.
struct Face_key
{
  std::array<Index, 4> vertices = {no_index, no_index, no_index, no_index};
  int count = 0;
};

inline Face_key face_key(std::array<Index, 4> vertices, int corner_count)
{
  sort_few(vertices, corner_count);
  Face_key key;
  for (int c = 0; c < corner_count; ++c)
    if (c == 0 || vertices[c] != vertices[c - 1])
      key.vertices[key.count++] = vertices[c];
  return key;
}

/// All faces of cells, and optionally the faces listed in sections, gathered by equal vertices.
///
/// An entry is one number: 8 * element + face for face `face` of a cell, 8 * (cells + number) + 7 for a listed face.
/// The table stores 8 bytes per face; keys are computed again whenever a bucket (the faces of one smallest vertex) is
/// read.
///
/// \tparam VertexOf  callable (zone, point of the zone) -> vertex.
template <class VertexOf>
class Face_table
{
public:
  static constexpr int listed = 7;

  /// A face in a group of equal faces; groups are sorted, cells before listed faces, both by number.
  struct Keyed_entry
  {
    std::array<Index, 3> other_vertices;
    Index entry;

    friend bool operator<(const Keyed_entry& a, const Keyed_entry& b)
    {
      return std::tie(a.other_vertices, a.entry) < std::tie(b.other_vertices, b.entry);
    }
  };

  Face_table(const Element_blocks& cells, const Element_blocks& listed_faces, Index vertex_count, VertexOf vertex_of)
    : cells_(cells), listed_faces_(listed_faces), vertex_of_(std::move(vertex_of)),
      buckets_(make_buckets(vertex_count, [this](const auto& put) { this->emit(put); }))
  {}

  bool is_listed(Index entry) const { return entry % 8 == listed; }
  int face_of(Index entry) const { return static_cast<int>(entry % 8); }
  Index cell_of(Index entry) const { return entry / 8; }
  Index listed_number(Index entry) const { return entry / 8 - cells_.size(); }

  Face_corners corners(Index entry) const
  {
    return is_listed(entry) ? listed_corners(listed_faces_.block_of(listed_number(entry)), listed_number(entry))
                            : cell_face_corners(cells_.block_of(cell_of(entry)), cell_of(entry), face_of(entry));
  }

  std::array<Index, 4> vertices(const Face_corners& face) const
  {
    std::array<Index, 4> result = {no_index, no_index, no_index, no_index};
    for (int c = 0; c < face.count; ++c)
      result[c] = vertex_of_(face.zone, face.points[c]);
    return result;
  }

  Face_key key(Index entry) const
  {
    const Face_corners face = corners(entry);
    return face_key(vertices(face), face.count);
  }

  /// calls `visit(group, result)` for every group of entries with the same vertices, with one result per run of
  /// buckets; returns the results in an order that does not depend on the threads.
  template <class Result, class Visit>
  std::vector<Result> visit_groups(const Visit& visit) const
  {
    return for_each_run<Result>(buckets_.bucket_count(), [&](Index first, Index last, Result& result) {
      std::vector<Keyed_entry> bucket;
      for (Index b = first; b < last; ++b)
      {
        read_bucket(b, bucket);
        visit_bucket(bucket, visit, result);
      }
    });
  }

private:
  static Face_corners cell_face_corners(const Element_block& block, Index cell, int face)
  {
    const Reference_face& reference = reference_element(block.section->type).faces[face];
    const Index* const points = corner_points(block, cell);
    Face_corners result{block.zone, reference.corner_count, {}};
    for (int c = 0; c < reference.corner_count; ++c)
      result.points[c] = points[reference.corners[c]];
    return result;
  }

  static Face_corners listed_corners(const Element_block& block, Index number)
  {
    const Index* const points = corner_points(block, number);
    Face_corners result{block.zone, corner_count(block.section->type), {}};
    std::copy_n(points, result.count, result.points.begin());
    return result;
  }

  template <class Put>
  void emit(const Put& put) const
  {
    // A face that is collapsed to an edge or a point bounds nothing and stays out.
    const auto put_face = [&](const Face_corners& face, Index entry) {
      const Face_key key = face_key(vertices(face), face.count);
      if (key.count >= 3)
        put(key.vertices[0], entry);
    };
    for (const Element_block& block : cells_.blocks())
      tbb::parallel_for(Index(0), block.section->size(), [&](Index e) {
        for (int f = 0; f < reference_element(block.section->type).face_count; ++f)
          put_face(cell_face_corners(block, block.first + e, f), 8 * (block.first + e) + f);
      });
    for (const Element_block& block : listed_faces_.blocks())
      tbb::parallel_for(Index(0), block.section->size(), [&](Index e) {
        put_face(listed_corners(block, block.first + e), 8 * (cells_.size() + block.first + e) + listed);
      });
  }

  void read_bucket(Index bucket, std::vector<Keyed_entry>& entries) const
  {
    entries.clear();
    for (Index i = buckets_.begin[bucket]; i < buckets_.begin[bucket + 1]; ++i)
    {
      const Face_key k = key(buckets_.items[i]);
      entries.push_back({{k.vertices[1], k.vertices[2], k.vertices[3]}, buckets_.items[i]});
    }
    std::sort(entries.begin(), entries.end());
  }

  template <class Visit, class Result>
  static void visit_bucket(const std::vector<Keyed_entry>& bucket, const Visit& visit, Result& result)
  {
    for (auto first = bucket.begin(); first != bucket.end();)
    {
      const auto last = std::find_if(first, bucket.end(),
                                     [&](const Keyed_entry& e) { return e.other_vertices != first->other_vertices; });
      visit(std::span<const Keyed_entry>(first, last), result);
      first = last;
    }
  }

  const Element_blocks& cells_;
  const Element_blocks& listed_faces_;
  VertexOf vertex_of_;
  Buckets buckets_;
};

} // namespace recurve::internal

#endif
