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
  Named_vertices(const Flat_surface& surface, double tolerance)
    : s_(surface), tolerance_(tolerance), sorted_(surface.points.size())
  {
    std::iota(sorted_.begin(), sorted_.end(), Index{0});
    std::stable_sort(sorted_.begin(), sorted_.end(), [&](Index a, Index b) { return s_.points[a] < s_.points[b]; });
  }

  /// the vertices that `name` means, ascending: at its position, or the one position within the tolerance of it.
  /// \throws Input_error that begins with `origin` and names the nearest vertices if there is none.
  std::vector<Index> find(const Vertex_name& name, const std::string& origin) const
  {
    if (!name.numbers.empty())
      return checked_numbers(name, origin);
    std::vector<Index> found = at(name.position);
    if (found.empty() && tolerance_ > 0)
      found = near(name.position, origin);
    if (found.empty())
      fail(origin + ": there is no vertex at " + written(name.position) + "; the nearest are at " +
           nearest(name.position, sorted_));
    if (name.copy == no_index)
      return found;
    if (name.copy < 0 || name.copy >= std::ssize(found))
      fail(origin + ": there are only " + std::to_string(found.size()) + " vertices at " + written(name.position) +
           ", counted from 0, but copy " + std::to_string(name.copy) + " is named");
    return {found[static_cast<std::size_t>(name.copy)]};
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

  /// the vertices at exactly `p`, ascending.
  std::vector<Index> at(const Point& p) const
  {
    const auto before = [&](Index v, const Point& q) { return s_.points[v] < q; };
    const auto first = std::lower_bound(sorted_.begin(), sorted_.end(), p, before);
    auto last = first;
    while (last != sorted_.end() && s_.points[*last] == p)
      ++last;
    return {first, last};
  }

  /// the vertices at the one position within the tolerance of `p`; none if there is none.
  std::vector<Index> near(const Point& p, const std::string& origin) const
  {
    std::vector<Index> found;
    for (const Index v : sorted_)
      if (norm(s_.points[v] - p) <= tolerance_)
        found.push_back(v);
    if (!found.empty() && s_.points[found.front()] != s_.points[found.back()])
      fail(origin + ": several vertices are within the tolerance of " + written(p) + ": " + nearest(p, found));
    return found;
  }

  const Flat_surface& s_;
  double tolerance_;
  std::vector<Index> sorted_; ///< by position, then by number
};

} // namespace recurve::internal::features

#endif
