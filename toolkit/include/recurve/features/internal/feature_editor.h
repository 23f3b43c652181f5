#ifndef RECURVE_FEATURES_INTERNAL_FEATURE_EDITOR_H
#define RECURVE_FEATURES_INTERNAL_FEATURE_EDITOR_H

#include <recurve/features/feature_edit.h>
#include <recurve/features/internal/detect.h>
#include <recurve/features/internal/edge_paths.h>
#include <recurve/features/internal/named_vertices.h>
#include <recurve/features/internal/surface_angles.h>

#include <cmath>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace recurve::internal::features {

/// The flags of a surface while edits are applied to them.
class Feature_editor
{
public:
  /// `patch_of_face` may be empty: then edits between patches are refused.
  Feature_editor(const Flat_surface& surface, const std::vector<char>& constrained, std::vector<Index> patch_of_face,
                 const Feature_edit_options& options, std::vector<char> edge_is_critical,
                 std::vector<char> vertex_is_sharp)
    : s_(surface), angles_(measure_angles(surface, constrained)), patch_(std::move(patch_of_face)), options_(options),
      critical_(std::move(edge_is_critical)), sharp_(std::move(vertex_is_sharp)), names_(surface, options.tolerance),
      out_(sorted_out_halfedges(surface))
  {}

  Feature_edit_report run(std::span<const Feature_edit> edits)
  {
    Feature_edit_report report;
    for (std::size_t i = 0; i < edits.size(); ++i)
    {
      origin_ = edits[i].origin.empty() ? "edit " + std::to_string(i + 1) : edits[i].origin;
      check_angle(edits[i]);
      report.edits.push_back(apply(edits[i]));
    }
    // Vertices that are named have the last word, whatever curves did to them later.
    for (const auto& [v, named] : named_vertices_)
      sharp_[v] = named.is_added;
    Detected now{critical_, sharp_, {}};
    summarize(s_, angles_, now);
    report.features = std::move(now.report);
    return report;
  }

  const std::vector<char>& edge_is_critical() const { return critical_; }
  const std::vector<char>& vertex_is_sharp() const { return sharp_; }

private:
  /// What an edit asked of an edge or a vertex that it names.
  struct Named
  {
    bool is_added;
    std::string origin;
  };

  [[noreturn]] void fail(const std::string& message) const { throw Input_error(origin_ + ": " + message); }

  void check_angle(const Feature_edit& edit) const
  {
    if (edit.angle && !(*edit.angle >= 0 && *edit.angle <= 180))
      fail("the angle must be between 0 and 180 degrees, but is " + std::to_string(*edit.angle));
  }

  Feature_edit_result apply(const Feature_edit& edit)
  {
    switch (edit.kind)
    {
    case Feature_edit_kind::vertices: return mark_vertices(edit);
    case Feature_edit_kind::edges: return change(single_edges(edit), edit.is_added);
    case Feature_edit_kind::shortest_path:
    case Feature_edit_kind::crease_path: return change(path(edit), edit.is_added);
    case Feature_edit_kind::chain: return change(chain(edit), edit.is_added);
    case Feature_edit_kind::box: return change(edges_in_box(edit), edit.is_added);
    case Feature_edit_kind::patches: return change(edges_between_patches(edit), edit.is_added);
    }
    fail("unknown kind");
  }

  // Which edges an edit names.

  std::string describe(const Vertex_name& name) const { return written(s_.points[names_.find(name, origin_).front()]); }

  /// the edges between the vertices that two names mean. Several only where vertices have one position.
  std::vector<Index> edges_between(const Vertex_name& a, const Vertex_name& b) const
  {
    const std::vector<Index> from = names_.find(a, origin_), to = names_.find(b, origin_);
    std::vector<Index> found, ends;
    for (const Index v : from)
      for (const Index h : out_[v])
      {
        ends.push_back(s_.target[h]);
        if (std::find(to.begin(), to.end(), s_.target[h]) != to.end())
          found.push_back(h / 2);
      }
    if (found.empty())
      fail("there is no edge between " + describe(a) + " and " + describe(b) + "; from the first one edges lead to " +
           names_.nearest(s_.points[to.front()], ends));
    return found;
  }

  std::vector<Index> single_edges(const Feature_edit& edit)
  {
    if (edit.vertices.empty() || edit.vertices.size() % 2 != 0)
      fail("edges are named by two ends each, but " + std::to_string(edit.vertices.size()) + " vertices are given");
    std::vector<Index> edges;
    for (std::size_t i = 0; i < edit.vertices.size(); i += 2)
      for (const Index e : edges_between(edit.vertices[i], edit.vertices[i + 1]))
      {
        const std::string text =
          "the edge between " + describe(edit.vertices[i]) + " and " + describe(edit.vertices[i + 1]);
        require_agreement(named_edges_, e, edit.is_added, text, "added", "removed");
        if (!edit.is_added && angles_.is_pinned[e])
          fail(text + " cannot be removed: it is on the border of the surface or constrained");
        edges.push_back(e);
      }
    return edges;
  }

  void require_agreement(std::map<Index, Named>& named, Index i, bool is_added, const std::string& text,
                         const char* added, const char* removed) const
  {
    const auto [before, is_new] = named.insert({i, {is_added, origin_}});
    if (!is_new && before->second.is_added != is_added)
      fail(text + " is " + (is_added ? added : removed) + " here, but " + before->second.origin + " says that it is " +
           (is_added ? removed : added));
  }

  /// A way that is removed leads along critical edges.
  std::vector<Index> path(const Feature_edit& edit) const
  {
    if (edit.vertices.size() < 2)
      fail("a path needs at least two way points");
    const std::vector<char> all(edit.is_added ? critical_.size() : 0, 1);
    const Path_finder finder(s_, out_, edit.is_added ? all : critical_);
    std::vector<Index> edges;
    for (std::size_t i = 0; i + 1 < edit.vertices.size(); ++i)
    {
      const auto from = names_.find(edit.vertices[i], origin_), to = names_.find(edit.vertices[i + 1], origin_);
      if (s_.points[from.front()] == s_.points[to.front()])
        fail("two consecutive way points are both at " + written(s_.points[from.front()]));
      const auto found = edit.kind == Feature_edit_kind::shortest_path
                           ? finder.shortest(from, to)
                           : finder.along_crease(from, to, angles_.dihedral);
      if (found.empty())
        fail(std::string(edit.is_added ? "no edges lead from " : "no critical edges lead from ") +
             written(s_.points[from.front()]) + " to " + written(s_.points[to.front()]));
      for (const Index h : found)
        edges.push_back(h / 2);
    }
    return edges;
  }

  std::vector<Index> chain(const Feature_edit& edit) const
  {
    if (edit.vertices.size() != 2)
      fail("a chain grows from one edge, named by its two ends");
    const double least = edit.angle.value_or(edit.is_added ? options_.chain_angle : 0);
    std::vector<Index> edges;
    for (const Index seed : edges_between(edit.vertices[0], edit.vertices[1]))
    {
      const std::string text = "the edge between " + describe(edit.vertices[0]) + " and " + describe(edit.vertices[1]);
      if (angles_.dihedral[seed] < least - angle_tie)
        fail(text + " has a dihedral angle of " + std::to_string(angles_.dihedral[seed]) +
             " degrees, less than the chain's " + std::to_string(least));
      if (!edit.is_added && !critical_[seed])
        fail(text + " is not critical");
      std::vector<char> is_taken(critical_.size(), 0);
      is_taken[seed] = 1;
      edges.push_back(seed);
      for (const Index end : {2 * seed, 2 * seed + 1})
        for (Index h = next_of_chain(end, edit.is_added, least, is_taken); h != no_index;
             h = next_of_chain(h, edit.is_added, least, is_taken))
        {
          is_taken[h / 2] = 1;
          edges.push_back(h / 2);
        }
    }
    return edges;
  }

  Index next_of_chain(Index h, bool is_added, double least, const std::vector<char>& is_taken) const
  {
    const Index v = s_.target[h];
    Index critical = 0, taken = 0, best = no_index;
    for (const Index other : out_[v])
    {
      taken += is_taken[other / 2];
      critical += critical_[other / 2] && !is_taken[other / 2];
    }
    // A chain that is added ends where it meets itself or another curve; one that is removed, where curves end.
    if (taken > 1 || critical != (is_added ? 0 : 1) || (!is_added && sharp_[v]))
      return no_index;
    for (const Index other : out_[v])
      if (!is_taken[other / 2] && (is_added || critical_[other / 2]) &&
          angles_.dihedral[other / 2] >= least - angle_tie &&
          (best == no_index || turning_angle(s_, h, other) < turning_angle(s_, h, best)))
        best = other;
    const bool continues =
      best != no_index && (!is_added || turning_angle(s_, h, best) <= options_.turning_angle + angle_tie);
    return continues ? best : no_index;
  }

  std::vector<Index> edges_in_box(const Feature_edit& edit) const
  {
    for (int i = 0; i < 3; ++i)
      if (!(edit.smallest[i] <= edit.largest[i]))
        fail("the box is empty: it reaches from " + written(edit.smallest) + " to " + written(edit.largest));
    const auto is_inside = [&](Index v) {
      for (int i = 0; i < 3; ++i)
        if (s_.points[v][i] < edit.smallest[i] || s_.points[v][i] > edit.largest[i])
          return false;
      return true;
    };
    const Point middle = 0.5 * (edit.smallest + edit.largest);
    std::vector<Index> found, vertices;
    for (Index e = 0; e < s_.number_of_edges(); ++e)
      if (is_inside(s_.target[2 * e]) && is_inside(s_.target[2 * e + 1]))
        found.push_back(e);
    if (found.empty())
    {
      for (Index v = 0; v < s_.number_of_vertices(); ++v)
        vertices.push_back(v);
      fail("no edge is inside the box; the vertices nearest to its middle are at " + names_.nearest(middle, vertices));
    }
    return by_angle(std::move(found), edit, options_.chain_angle);
  }

  std::vector<Index> edges_between_patches(const Feature_edit& edit) const
  {
    if (patch_.empty() && s_.number_of_faces() > 0)
      fail("edges between patches need a face_patch_map");
    const Index p = edit.patches[0], q = edit.patches[1];
    const auto is_between = [&](Index e) {
      const auto patch_at = [&](Index h) { return s_.face[h] == no_index ? no_index : patch_[s_.face[h]]; };
      const Index a = patch_at(2 * e), b = patch_at(2 * e + 1);
      if (q == no_index)
        return (a == p) != (b == p);
      return s_.face[2 * e] != no_index && s_.face[2 * e + 1] != no_index && ((a == p && b == q) || (a == q && b == p));
    };
    std::vector<Index> found;
    for (Index e = 0; e < s_.number_of_edges(); ++e)
      if (is_between(e))
        found.push_back(e);
    if (found.empty())
      fail("the two patches share no edge");
    return by_angle(std::move(found), edit, 0);
  }

  /// of the edges in an area those that are to be changed.
  std::vector<Index> by_angle(std::vector<Index> edges, const Feature_edit& edit, double least) const
  {
    std::erase_if(edges, [&](Index e) {
      return edit.is_added ? angles_.dihedral[e] < edit.angle.value_or(least) - angle_tie
                           : !critical_[e] || angles_.dihedral[e] > edit.angle.value_or(180) + angle_tie;
    });
    return edges;
  }

  // What an edit does.

  Feature_edit_result mark_vertices(const Feature_edit& edit)
  {
    if (edit.vertices.empty())
      fail("no vertex is named");
    Feature_edit_result result;
    for (const Vertex_name& name : edit.vertices)
      for (const Index v : names_.find(name, origin_))
      {
        require_agreement(named_vertices_, v, edit.is_added, "the vertex at " + written(s_.points[v]),
                          "marked as sharp", "unmarked");
        set_sharp(v, edit.is_added, result);
      }
    return result;
  }

  Feature_edit_result change(std::vector<Index> edges, bool is_added)
  {
    std::sort(edges.begin(), edges.end());
    edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
    Feature_edit_result result;
    std::vector<Index> touched;
    for (const Index e : edges)
    {
      ++result.edges;
      result.length += edge_length(s_, e);
      if (!is_added && angles_.is_pinned[e])
      {
        ++result.pinned_edges;
        continue;
      }
      result.changed_edges += (critical_[e] != 0) != is_added;
      critical_[e] = is_added;
      touched.push_back(s_.target[2 * e]);
      touched.push_back(s_.target[2 * e + 1]);
    }
    std::sort(touched.begin(), touched.end());
    touched.erase(std::unique(touched.begin(), touched.end()), touched.end());
    for (const Index v : touched)
      judge(v, is_added, result);
    return result;
  }

  /// decides whether `v`, at which edges were added or removed, is sharp.
  void judge(Index v, bool is_added, Feature_edit_result& result)
  {
    Index critical = 0;
    std::array<Index, 2> halfedges{};
    for (const Index h : out_[v])
      if (critical_[h / 2])
      {
        if (critical < 2)
          halfedges[critical] = h;
        ++critical;
      }
    const double turning = critical == 2 ? turning_angle(s_, halfedges[0] ^ 1, halfedges[1]) : 0;
    const bool is_corner_of_curves = critical > 2 || (critical == 2 && turning > options_.turning_angle + angle_tie);
    if (is_corner_of_curves)
      set_sharp(v, true, result);
    else if (!is_added && !is_isolated_corner(v))
      set_sharp(v, false, result);
    if (is_added && critical == 2)
      result.turnings.push_back({v, turning, sharp_[v] != 0});
  }

  bool is_isolated_corner(Index v) const
  {
    return !angles_.is_border_vertex[v] && angles_.defect[v] < 360 &&
           std::abs(angles_.defect[v]) >= options_.corner_defect - angle_tie;
  }

  void set_sharp(Index v, bool is_sharp, Feature_edit_result& result)
  {
    if ((sharp_[v] != 0) == is_sharp)
      return;
    ++(is_sharp ? result.sharpened : result.smoothed);
    sharp_[v] = is_sharp;
  }

  const Flat_surface& s_;
  Surface_angles angles_;
  std::vector<Index> patch_; ///< per face
  Feature_edit_options options_;
  std::vector<char> critical_, sharp_;
  Named_vertices names_;
  Out_halfedges out_;
  std::map<Index, Named> named_edges_, named_vertices_;
  std::string origin_; ///< of the edit at work
};

} // namespace recurve::internal::features

#endif
