#ifndef RECURVE_FEATURES_INTERNAL_NAMED_VERTICES_H
#define RECURVE_FEATURES_INTERNAL_NAMED_VERTICES_H

#include <recurve/core/exceptions.h>
#include <recurve/features/feature_edit.h>
#include <recurve/features/internal/flat_surface.h>
#include <recurve/features/internal/vector_3.h>

#include <algorithm>
#include <cstdio>
#include <numeric>
#include <string>
#include <vector>

namespace recurve::internal::features {

/// `p` with the 17 digits that make it unique, as a file of edits has it.
inline std::string written(const Point& p)
{
  char text[96];
  std::snprintf(text, sizeof text, "[%.17g, %.17g, %.17g]", p[0], p[1], p[2]);
  return text;
}

/// The vertices of a surface by their names.
class Named_vertices
{
public:
  explicit Named_vertices(const Flat_surface& surface) : s_(surface), sorted_(surface.points.size())
  {
    std::iota(sorted_.begin(), sorted_.end(), Index{0});
    std::stable_sort(sorted_.begin(), sorted_.end(), [&](Index a, Index b) { return s_.points[a] < s_.points[b]; });
  }

  /// the vertices that `name` means, ascending.
  /// \throws Input_error that begins with `origin` and names the nearest vertices if there is none.
  std::vector<Index> find(const Vertex_name& name, const std::string& origin) const
  {
    if (!name.numbers.empty())
      return checked_numbers(name, origin);
    const auto before = [&](Index v, const Point& p) { return s_.points[v] < p; };
    const auto first = std::lower_bound(sorted_.begin(), sorted_.end(), name.position, before);
    auto last = first;
    while (last != sorted_.end() && s_.points[*last] == name.position)
      ++last;
    if (first == last)
      fail(origin + ": there is no vertex at " + written(name.position) + "; the nearest are at " +
           nearest(name.position, all_vertices()));
    if (name.copy == no_index)
      return {first, last};
    if (name.copy < 0 || name.copy >= last - first)
      fail(origin + ": there are only " + std::to_string(last - first) + " vertices at " + written(name.position) +
           ", counted from 0, but copy " + std::to_string(name.copy) + " is named");
    return {*(first + name.copy)};
  }

  /// the positions of the up to three of `candidates` that are nearest to `p`.
  std::string nearest(const Point& p, std::vector<Index> candidates) const
  {
    const auto middle = candidates.begin() + std::min<std::ptrdiff_t>(3, std::ssize(candidates));
    std::partial_sort(candidates.begin(), middle, candidates.end(), [&](Index a, Index b) {
      return std::pair(norm(s_.points[a] - p), a) < std::pair(norm(s_.points[b] - p), b);
    });
    std::string text;
    for (auto v = candidates.begin(); v != middle; ++v)
      text += (text.empty() ? "" : ", ") + written(s_.points[*v]);
    return text;
  }

private:
  [[noreturn]] static void fail(const std::string& message) { throw Input_error(message); }

  std::vector<Index> checked_numbers(const Vertex_name& name, const std::string& origin) const
  {
    for (const Index v : name.numbers)
      if (v < 0 || v >= s_.number_of_vertices())
        fail(origin + ": there is no vertex " + std::to_string(v) + "; vertices are numbered from 0 to " +
             std::to_string(s_.number_of_vertices() - 1));
    return name.numbers;
  }

  std::vector<Index> all_vertices() const { return sorted_; }

  const Flat_surface& s_;
  std::vector<Index> sorted_; ///< by position, then by number
};

} // namespace recurve::internal::features

#endif
