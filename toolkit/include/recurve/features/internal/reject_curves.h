#ifndef RECURVE_FEATURES_INTERNAL_REJECT_CURVES_H
#define RECURVE_FEATURES_INTERNAL_REJECT_CURVES_H

#include <recurve/features/feature_report.h>
#include <recurve/features/internal/classify_edges.h>
#include <recurve/features/internal/smooth_contrast.h>

#include <algorithm>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace recurve::internal::features {

/// How a candidate curve stands at one end.
enum class End_type : std::uint8_t
{
  none,     ///< the curve goes on
  dangling, ///< the only candidate at its vertex
  doubtful, ///< at a turn or a junction that it does not support itself
  supported ///< at a corner or a junction that it has a right to, or at a border that it meets as the ridge or sharp
};

/// Assembles the candidate edges into curves and rejects unlikely ones, until none is rejected any more. All curves of
/// a sweep are judged before any is removed, so that the order of the edges does not matter.
class Curve_rejector
{
public:
  Curve_rejector(const Flat_surface& s, const Surface_angles& a, const Edge_classes& c, const Feature_options& options)
    : s_(s), a_(a), c_(c), options_(options), contrast_(s, a, options.sharp_angle), is_kept_(c.is_candidate)
  {}

  /// returns which edges are left; counts and rejected curves go into `report`.
  std::vector<char> run(Feature_report& report)
  {
    contrast_of_.assign(s_.number_of_edges(), -1);
    bool has_changed = true;
    while (has_changed)
    {
      gather();
      rejected_.clear();
      for_each_curve([&](std::vector<Index>& curve, bool is_closed) { judge(curve, is_closed, report); });
      if (rejected_.empty() && options_.reject_smooth)
        reject_noses(report);
      if (rejected_.empty() && options_.reject_smooth)
        reject_rough_networks(report);
      for (const Index e : rejected_)
        is_kept_[e] = false;
      has_changed = !rejected_.empty();
      ++report.sweeps;
    }
    return std::move(is_kept_);
  }

private:
  /// prepares a sweep: lists the half-edges of kept candidates, and finds out how each stands at its source.
  void gather()
  {
    out_.emplace(s_, [&](Index e) { return is_kept_[e] != 0; });
    end_.assign(2 * s_.number_of_edges(), End_type::none);
    continuation_.assign(2 * s_.number_of_edges(), no_index);
    is_walked_.assign(s_.number_of_edges(), 0);
    is_touched_.assign(s_.number_of_vertices(), 0);
    for (Index v = 0; v < s_.number_of_vertices(); ++v)
    {
      for (const Index h : (*out_)[v])
        end_[h] = end_type(v, h);
      pair_half_edges(v);
    }
  }

  /// joins the two half-edges at `v` that are one curve: both, where there are only two and no turn; at a junction the
  /// two that have no right to end there, where there are just two of them, they go straight on, and what else meets
  /// there is stronger and only touches them.
  void pair_half_edges(Index v)
  {
    const auto around = (*out_)[v];
    const bool is_junction = around.size() > 2;
    Index open[2] = {no_index, no_index};
    int count = 0;
    for (const Index h : around)
      if (end_[h] == End_type::none || (is_junction && end_[h] == End_type::doubtful))
        if (count++ < 2)
          open[count - 1] = h;
    if (count != 2 || (is_junction && !is_touched_there(open[0], open[1])))
      return;
    is_touched_[v] = is_junction;
    for (const int i : {0, 1})
    {
      continuation_[open[i]] = open[1 - i];
      end_[open[i]] = End_type::none;
    }
  }

  /// whether the curve through the half-edges `h` and `g` goes straight on at their source, and has all the other
  /// candidates there, at least two and stronger, on one side.
  bool is_touched_there(Index h, Index g) const
  {
    if ((*out_)[s_.source_of(h)].size() < 4 || turning(h, g) > options_.turning_angle + angle_tie)
      return false;
    const double strongest = std::max(a_.dihedral[h / 2], a_.dihedral[g / 2]);
    for (const Index k : (*out_)[s_.source_of(h)])
      if (k != h && k != g && a_.dihedral[k / 2] < strongest)
        return false;
    const auto is_side_free = [&](Index from, Index to) {
      for (Index k = from ^ 1; k != no_index;)
      {
        k = s_.next[k]; // the next half-edge out of the vertex
        if (k == no_index || k == to)
          return k == to;
        if (is_kept_[k / 2])
          return false;
        k ^= 1;
      }
      return false;
    };
    return is_side_free(h, g) || is_side_free(g, h);
  }

  double turning(Index h, Index g) const { return 180 - angle_between(direction(s_, h), direction(s_, g)); }

  bool is_sharp(Index h) const { return a_.dihedral[h / 2] > options_.sharp_angle; }

  bool has(Index h, std::uint8_t strength) const { return (c_.strength[h] & strength) == strength; }

  End_type end_type(Index v, Index h) const
  {
    const auto around = (*out_)[v];
    if (around.size() == 1)
      return single_end_type(v, h);
    if (around.size() > 2)
      return junction_end_type(v, h);
    const Index first = *around.begin(), second = *(around.begin() + 1);
    const bool is_turn = c_.is_sharp_corner[v] || turning(first, second) > options_.turning_angle + angle_tie;
    return is_turn && !(is_sharp(first) && is_sharp(second)) ? End_type::doubtful : End_type::none;
  }

  End_type single_end_type(Index v, Index h) const
  {
    const bool is_at_border = options_.border_ends && a_.is_pinned_vertex[v];
    const bool is_supported =
      is_sharp(h) ? c_.is_sharp_corner[v] || is_at_border : is_at_border && has(h, largest_dihedral | along_ridge);
    return is_supported ? End_type::supported : End_type::dangling;
  }

  End_type junction_end_type(Index v, Index h) const
  {
    const double dihedral = a_.dihedral[h / 2];
    const bool is_ridge = c_.shape[v] == Vertex_shape::ridge;
    const bool is_weak = dihedral < options_.end_angle, is_not_sharp = dihedral <= options_.sharp_angle;
    const bool is_doubtful = (is_weak && c_.has_sharp_edge[v]) ||
                             (is_weak && is_ridge && !has(h, largest_dihedral | along_ridge)) ||
                             (is_not_sharp && c_.has_acute_edge[v]) ||
                             (is_not_sharp && is_ridge && !has(h, largest_dihedral) && !has(h, along_ridge));
    return is_doubtful ? End_type::doubtful : End_type::supported;
  }

  /// the half-edge that continues a curve after `h`, or no_index where the curve ends.
  Index following(Index h) const { return continuation_[h ^ 1]; }

  /// calls `visit(half-edges, is closed)` once for each curve of kept candidates: the open ones first.
  template <class Visitor>
  void for_each_curve(Visitor visit)
  {
    for (const bool is_closed : {false, true})
      for (const Index h : out_->halfedges)
        if (!is_walked_[h / 2] && (is_closed || end_[h] != End_type::none))
        {
          walk(h);
          visit(curve_, is_closed);
        }
  }

  void walk(Index first)
  {
    curve_.clear();
    for (Index h = first; h != no_index && !is_walked_[h / 2]; h = following(h))
    {
      curve_.push_back(h);
      is_walked_[h / 2] = 1;
    }
  }

  void judge(std::vector<Index>& curve, bool is_closed, Feature_report& report)
  {
    if (const auto reason = is_closed ? std::nullopt : reason_by_ends(curve))
      reject(curve, is_closed, *reason, report);
    else if (options_.reject_smooth && !is_closed && is_between_round_rims(curve))
      reject(curve, false, Rejection::smooth, report);
    else if (options_.reject_smooth)
      reject_smooth_parts(curve, is_closed, report);
  }

  /// whether `curve` is the fold of a wall with few facets, such as that of a bore, from rim to rim. However steep it
  /// is, the rims show that the wall is round there.
  bool is_between_round_rims(const std::vector<Index>& curve) const
  {
    return is_at_round_rim(curve.front()) && is_at_round_rim(curve.back() ^ 1);
  }

  /// whether the half-edge `h` starts at a rim, a closed chain of sharp edges, that turns there, but turns as much at
  /// most of its vertices, where no other sharp edge leaves it.
  bool is_at_round_rim(Index h) const
  {
    constexpr double alike = 0.9;        // of the turning angle; those of a regular rim are equal
    constexpr Index most_rim_edges = 36; // of more edges it does not turn much at each
    const Index v = s_.source_of(h);
    if ((*out_)[v].size() != 3)
      return false;
    Index rim[2], count = 0;
    for (const Index g : (*out_)[v])
      if (g != h)
        rim[count++] = g;
    const double here = turning(rim[0], rim[1]);
    if (here <= options_.turning_angle || !is_sharp(rim[0]))
      return false;
    Index g = rim[0], edges = 1, round_vertices = 0;
    for (; s_.target[g] != v; ++edges)
    {
      const Index following = straightest(g);
      const bool is_clear =
        following != no_index && straightest(following ^ 1) == (g ^ 1); // also in the other direction
      if (!is_clear || !is_sharp(following) || edges == most_rim_edges)
        return false;
      round_vertices += number_of_sharp_edges(g) == 2 && turning(g ^ 1, following) >= alike * here;
      g = following;
    }
    return (g ^ 1) == rim[1] && 2 * round_vertices > edges;
  }

  /// the kept half-edge out of the target of `h` that turns least, or no_index if there is none or it is not the only
  /// one.
  Index straightest(Index h) const
  {
    Index best = no_index;
    double least = 180 + 2 * angle_tie;
    for (const Index g : (*out_)[s_.target[h]])
    {
      if (g == (h ^ 1))
        continue;
      const double turn = turning(h ^ 1, g);
      if (turn < least - angle_tie)
        best = g;
      else if (turn <= least + angle_tie)
        best = no_index;
      least = std::min(least, turn);
    }
    return best;
  }

  /// how many sharp edges, kept or not, there are at the target of `h`; 0 if it is on a border.
  int number_of_sharp_edges(Index h) const
  {
    int count = 0;
    Index g = h;
    do
    {
      g = s_.next[g]; // out of the vertex
      if (g == no_index)
        return 0;
      count += is_sharp(g);
      g ^= 1;
    } while (g != h);
    return count;
  }

  void reject(std::span<const Index> curve, bool is_closed, Rejection reason, Feature_report& report)
  {
    Rejected_curve r;
    r.reason = reason;
    r.is_closed = is_closed;
    r.first_vertex = s_.source_of(curve.front());
    r.last_vertex = s_.target[curve.back()];
    r.first_point = s_.points[r.first_vertex];
    r.last_point = s_.points[r.last_vertex];
    r.edges = static_cast<Index>(curve.size());
    for (const Index h : curve)
    {
      r.length += norm(s_.points[s_.target[h]] - s_.points[s_.source_of(h)]);
      r.max_dihedral = std::max(r.max_dihedral, a_.dihedral[h / 2]);
      rejected_.push_back(h / 2);
    }
    report.rejected_edges[static_cast<int>(r.reason)] += r.edges;
    report.rejected.push_back(r);
  }

  /// rejects the maximal parts of `curve` without an edge above the angle that is safe, where the surface bends beside
  /// them as along them: the whole curve, or a long part of it (the leading edge of a wing that goes over into the
  /// sharp edge of its tip).
  void reject_smooth_parts(std::vector<Index>& curve, bool is_closed, Feature_report& report)
  {
    // stronger curves that touch it again and again know that it is there
    if (std::count_if(curve.begin(), curve.end(), [&](Index h) { return is_touched_[s_.source_of(h)] != 0; }) > 1)
      return;
    const double safe_angle = std::min(options_.smooth_angle, options_.sharp_angle);
    reject_parts(curve, is_closed, safe_angle, report, [&](std::span<const Index> part) { return is_smooth(part); });
  }

  /// rejects long curves, or long parts of them, that are the nose of a profile with few points: it can be steep, but
  /// the surface bends on both sides of it, and not at another crease.
  void reject_noses(Feature_report& report)
  {
    std::fill(is_walked_.begin(), is_walked_.end(), 0);
    for_each_curve([&](std::vector<Index>& curve, bool is_closed) {
      // where a surface is rough, short ones are like that by chance
      if (!is_closed && std::ssize(curve) > options_.strong_edges)
        reject_parts(curve, false, options_.sharp_angle, report, [&](std::span<const Index> part) {
          return median_of(part, [&](Index e) { return contrast_.on_flatter_side(e, is_kept_); }) <
                 options_.crease_contrast;
        });
    });
  }

  /// rejects those maximal parts of `curve` without an edge above `safe_angle` that `is_to_go` says.
  template <class Predicate>
  void reject_parts(std::vector<Index>& curve, bool is_closed, double safe_angle, Feature_report& report,
                    Predicate is_to_go)
  {
    const auto is_safe = [&](Index h) { return a_.dihedral[h / 2] > safe_angle; };
    if (is_closed)
      std::rotate(curve.begin(), std::find_if(curve.begin(), curve.end(), is_safe), curve.end());
    for (auto first = curve.begin(); first != curve.end();)
    {
      first = std::find_if_not(first, curve.end(), is_safe);
      const auto last = std::find_if(first, curve.end(), is_safe);
      const std::span<const Index> part(first, last);
      const bool is_whole = part.size() == curve.size();
      if (!part.empty() && (is_whole || std::ssize(part) > options_.strong_edges) && is_to_go(part))
        reject(part, is_closed && is_whole, Rejection::smooth, report);
      first = last;
    }
  }

  /// rejects networks of curves that a rough surface gives: each curve is supported by the others.
  void reject_rough_networks(Feature_report& report)
  {
    std::vector<char> is_reached(s_.number_of_vertices(), 0);
    for (const Index first : out_->halfedges)
    {
      if (is_reached[s_.source_of(first)])
        continue;
      const std::vector<Index> network = gather_network(s_.source_of(first), is_reached);
      if (is_rough(network))
        for (const Index& h : network)
          reject({&h, 1}, false, Rejection::rough, report);
    }
  }

  /// whether `network`, one half-edge of each of its edges, is small or made of short curves, and no better than
  /// chance: as bent as the surface beside it, or the surface bends back beside it.
  bool is_rough(std::span<const Index> network)
  {
    const auto size = std::ssize(network);
    const auto is_end = [&](Index h) { return end_[h] != End_type::none; };
    const auto ends = std::count_if(network.begin(), network.end(), is_end) +
                      std::count_if(network.begin(), network.end(), [&](Index h) { return is_end(h ^ 1); });
    const bool is_of_short_curves = size <= ends; // on average two edges a curve, which has two ends
    const bool is_small = size <= options_.strong_edges;
    if (is_short(network) && !stands_alone(network))
      return true;
    const auto to_others = [&](Index e) { return contrast_.to_others(e, is_kept_); };
    if (is_small && median_of(network, to_others) < options_.smooth_contrast)
      return true;
    const double least = is_small ? options_.crease_contrast : options_.smooth_contrast;
    if (is_of_short_curves && median_of(network, [&](Index e) { return contrast(2 * e); }) < least)
      return true;
    if (is_of_short_curves || size <= 2 * options_.strong_edges)
      return is_wavy(network, wavy_share);
    return size <= 4 * options_.strong_edges && is_wavy(network, 2 * wavy_share);
  }

  /// How much the surface bends back beside small networks of noise: 19 of 20 do by more than 0.23 in sheets rough by
  /// 0.4 of an edge, half of them by more than 0.55. So it does by up to 0.3 beside long creases of 45 degrees whose
  /// points are off by a twelfth of an edge: a larger network, which is less often chance, must do twice as much.
  static constexpr double wavy_share = 0.2;

  /// whether an edge or two, connected to no others, can be a crease: the surface is far less bent beside them, and
  /// there is something of it on both sides. The corner of a rough sheet, one triangle, is bent like that by chance.
  bool stands_alone(std::span<const Index> edges)
  {
    const auto is_seen = [&](Index h) { return is_sharp(h) || contrast_.look_aside(h / 2, 1, is_kept_).count == 2; };
    return std::all_of(edges.begin(), edges.end(), [&](Index h) { return contrast(h) > flat_contrast; }) &&
           std::any_of(edges.begin(), edges.end(), is_seen);
  }

  /// whether the surface bends back beside `network` by more than a `share` of what it bends there, on average of all
  /// sides. What is mostly sharp is safe.
  bool is_wavy(std::span<const Index> network, double share)
  {
    const auto sharp = std::count_if(network.begin(), network.end(), [&](Index h) { return is_sharp(h); });
    if (sharp > options_.strong_edges && 2 * sharp > std::ssize(network))
      return false;
    Smooth_contrast::Sides all;
    for (const Index h : network)
    {
      // no more than twice the share, so that it takes both sides: a crease may have a round surface on one
      const Smooth_contrast::Sides sides = contrast_.look_aside(h / 2, 2 * share, is_kept_);
      all.count += sides.count;
      all.bent_back += sides.bent_back;
    }
    return all.bent_back > share * all.count;
  }

  /// one half-edge of each edge that can be reached from `v` along kept candidates.
  std::vector<Index> gather_network(Index v, std::vector<char>& is_reached) const
  {
    std::vector<Index> network, front = {v};
    is_reached[v] = 1;
    while (!front.empty())
    {
      const Index from = front.back();
      front.pop_back();
      for (const Index h : (*out_)[from])
      {
        if (h % 2 == 0)
          network.push_back(h);
        if (!is_reached[s_.target[h]])
          front.push_back(s_.target[h]);
        is_reached[s_.target[h]] = 1;
      }
    }
    return network;
  }

  std::optional<Rejection> reason_by_ends(const std::vector<Index>& curve)
  {
    const Index first = curve.front(), last = curve.back() ^ 1;
    const auto has_end = [&](End_type type) { return end_[first] == type || end_[last] == type; };
    const auto is_obscure = [&](Index h) { return end_[h] == End_type::dangling || end_[h] == End_type::doubtful; };
    if (!is_obscure(first) && !is_obscure(last))
      return std::nullopt;
    const auto strong_edges =
      std::count_if(curve.begin(), curve.end(), [&](Index h) { return a_.dihedral[h / 2] > options_.strong_angle; });
    const auto is_at_feature = [&](Index h) {
      return c_.has_sharp_edge[s_.source_of(h)] || c_.is_sharp_corner[s_.source_of(h)];
    };
    const bool is_spanning = is_at_feature(first) && is_at_feature(last);
    if ((strong_edges > 0 && strong_edges > options_.strong_edges) || is_crease(curve, is_spanning))
      return std::nullopt;
    if (strong_edges <= options_.strong_edges && has_end(End_type::dangling))
      return Rejection::dangling;
    if (strong_edges <= options_.strong_edges && is_obscure(first) && is_obscure(last))
      return Rejection::doubtful;
    return strong_edges == 0 && is_spanning ? std::optional(Rejection::overshadowed) : std::nullopt;
  }

  /// A curve of an edge or two must stand out by so many times as much as a longer one, and at least by so much where
  /// it is all that there is: single edges of a noisy surface do by chance.
  static constexpr double flat_contrast = 5;

  /// whether `curve` bends so much more than the surface beside it that it is kept, whatever its ends. A short one must
  /// lead from one sharp feature to another, all along, such as the seams of a chamfered or hexagonal bar.
  bool is_crease(const std::vector<Index>& curve, bool is_spanning)
  {
    if (std::ssize(curve) > options_.strong_edges)
      return stands_out(curve);
    const double least = is_short(curve) ? flat_contrast * options_.crease_contrast : options_.crease_contrast;
    return is_spanning && std::all_of(curve.begin(), curve.end(), [&](Index h) {
             return a_.dihedral[h / 2] >= options_.end_angle && contrast(h) > least;
           });
  }

  /// whether `curve` is no more than what noise strings together by chance.
  static bool is_short(std::span<const Index> curve) { return curve.size() <= 2; }

  double contrast(Index h)
  {
    double& contrast = contrast_of_[h / 2];
    if (contrast < 0)
      contrast = contrast_(h / 2);
    return contrast;
  }

  /// whether at two thirds of its edges the surface bends much more along `curve` than beside it. In noise single
  /// edges do, but few in a row.
  bool stands_out(const std::vector<Index>& curve)
  {
    const auto count =
      std::count_if(curve.begin(), curve.end(), [&](Index h) { return contrast(h) > options_.crease_contrast; });
    return 3 * count >= 2 * std::ssize(curve);
  }

  /// whether the surface bends beside `curve` about as much as along it.
  bool is_smooth(std::span<const Index> curve)
  {
    return median_of(curve, [&](Index e) { return contrast(2 * e); }) < options_.smooth_contrast;
  }

  /// the median of `value` over the edges of `curve`, which is not empty.
  template <class Function>
  double median_of(std::span<const Index> curve, Function value)
  {
    values_.clear();
    for (const Index h : curve)
      values_.push_back(value(h / 2));
    const auto median = values_.begin() + static_cast<std::ptrdiff_t>(values_.size() / 2);
    std::nth_element(values_.begin(), median, values_.end());
    return *median;
  }

  const Flat_surface& s_;
  const Surface_angles& a_;
  const Edge_classes& c_;
  const Feature_options& options_;
  Smooth_contrast contrast_;
  std::vector<char> is_kept_;
  std::optional<Out_halfedges> out_;
  std::vector<End_type> end_;
  std::vector<char> is_walked_, is_touched_;
  std::vector<Index> continuation_, curve_, rejected_;
  std::vector<double> contrast_of_, values_;
};

} // namespace recurve::internal::features

#endif
