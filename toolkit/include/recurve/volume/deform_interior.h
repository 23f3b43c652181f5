#ifndef RECURVE_VOLUME_DEFORM_INTERIOR_H
#define RECURVE_VOLUME_DEFORM_INTERIOR_H

#include <recurve/core/exceptions.h>
#include <recurve/core/types.h>
#include <recurve/volume/deformation_options.h>
#include <recurve/volume/influence.h>
#include <recurve/volume/internal/deformation_field.h>
#include <recurve/volume/internal/point_access.h>

#include <ranges>
#include <span>
#include <string>
#include <utility>

namespace recurve {

/// Sources, sorted once, whose displacements may be set and whose field may be evaluated repeatedly:
/// s(r) = sum w(|r - r_i|) s_i / sum w(|r - r_i|), the weighted mean of the sources' displacements.
///
/// The mean reproduces a constant displacement, stays in the convex hull of those given, and takes that of a source at
/// the source. Whole meshes are moved by giving *all* high-order nodes of the boundary as sources, those at rest with
/// displacement zero: they are what makes the motion fade.
///
/// The fast sum groups targets into cells, so that its error (not its bound) at a point depends on the other targets of
/// the call. Neither it nor the plain sum depends on the number of threads, to the bit.
///
/// \tparam I  model of `Influence`; of `Expandable_influence` for the fast sum. A type that is not is summed plainly.
/// \par Source  Luke, Collins & Blades 2012, J. Comput. Phys. 231; Greengard & Rokhlin 1987, J. Comput. Phys. 73.
template <Influence I = Inverse_distance<>>
class Interior_deformer
{
public:
  /// \param positions  one per source, model of `Point_range`.
  /// \param weights    factor of each source's influence, not negative, for example the area that its node stands for;
  ///                   empty: all 1.
  /// \throws Input_error if an argument is not finite or out of range, or the numbers of positions and weights differ.
  /// \par Complexity   O(n log n); up to 200 bytes per source at the default error bound.
  template <Point_range Positions>
  Interior_deformer(const Positions& positions, I influence, const Summation_options& options = {},
                    std::span<const double> weights = {});

  /// \param displacements  one per source. \throws Input_error if their number differs or one is not finite.
  template <Point_range Displacements>
  void set_displacements(const Displacements& displacements);

  /// computes the displacement at each of `points`. \param result  as many, writable.
  template <Point_range Points, Point_range Result>
  Deformation_report evaluate(const Points& points, Result&& result) const;

  /// moves `points`. Those whose displacement is exactly zero keep their bits.
  template <Point_range Points>
  Deformation_report deform(Points&& points) const;

  /// Bytes held per source.
  double bytes_per_source() const { return field_.bytes_per_source(); }

private:
  internal::Deformation_field<I> field_;
};

/// moves `targets`, the nodes inside a mesh, after its boundary.
///
/// What a caller has to see to, in this order, since this function knows points only:
///   1. Feature curves and curved faces have their final position; no corner on a curved patch has moved.
///   2. Uncurved patches follow their rim before the interior does: call this function with the rim's nodes as sources
///      and the patch's other nodes as targets. A component of the displacement that no source has, no target gets, to
///      the bit: a patch in a coordinate plane stays in it if the rim does. In an oblique plane, first take the rim's
///      displacement along the plane, then put the targets back on it.
///   3. Of a periodic pair of patches, deform one and copy it with the period to the other. A node at an interface
///      between zones is one target.
///   4. Sources are all nodes of the boundary after that, at their positions before the motion, also those at rest,
///   each
///      once. `length` is the mean edge length of the active surface (`mean_edge_length()`), `weights` are optionally
///      the areas of the nodes (`node_areas()`).
///   5. Targets are the nodes that are not sources. Drop a displacement that is round-off relative to the local edges
///      (use `Interior_deformer::evaluate()`), so that straight cells stay straight; all beyond
///      `Summation_options::reach` is exactly zero already.
///
/// \tparam Sources, Displacements  models of `Point_range`: positions before the motion, and the motion.
/// \tparam Targets  model of `Point_range`, writable.
/// \throws Input_error as `Interior_deformer`, or if an option is out of range; `targets` are then untouched.
/// \par Complexity  plain: sources times targets; fast: O((n + m) log n) in time and O(n + m) in memory.
template <Point_range Sources, Point_range Displacements, Point_range Targets>
Deformation_report deform_interior(const Sources& sources, const Displacements& displacements, Targets&& targets,
                                   const Deformation_options& options, std::span<const double> weights = {});

/// the same with an influence of the caller's.
template <Point_range Sources, Point_range Displacements, Point_range Targets, Influence I>
Deformation_report deform_interior(const Sources& sources, const Displacements& displacements, Targets&& targets,
                                   const I& influence, const Summation_options& options,
                                   std::span<const double> weights = {});

/// computes the displacement at each of `targets`, which `deform_interior()` would add to it. \param result  as many,
/// writable. For callers who want to keep part of the motion only.
template <Point_range Sources, Point_range Displacements, Point_range Targets, Point_range Result>
Deformation_report interior_displacements(const Sources& sources, const Displacements& displacements,
                                          const Targets& targets, Result&& result, const Deformation_options& options,
                                          std::span<const double> weights = {});

namespace internal {

/// calls `work` with a deformer for `target_count` targets, its displacements set.
template <Point_range Sources, Point_range Displacements, Influence I, class Work>
Deformation_report with_deformer(const Sources& sources, const Displacements& displacements, std::size_t target_count,
                                 const I& influence, Summation_options options, std::span<const double> weights,
                                 const Work& work)
{
  if (options.method == Summation::automatic && Expandable_influence<I>)
    options.method = faster_summation(std::ranges::size(sources), target_count);
  Interior_deformer<I> deformer(sources, influence, options, weights);
  deformer.set_displacements(displacements);
  return work(deformer);
}

/// calls `work` with the influence that `options` describe.
template <class Work>
Deformation_report with_influence(const Deformation_options& options, const Work& work)
{
  if (options.a == 3 && options.b == 5)
    return work(Inverse_distance<3, 5>(options.length, options.alpha));
  return work(Inverse_distance_powers(options.length, options.alpha, options.a, options.b));
}

} // namespace internal

template <Influence I>
template <Point_range Positions>
Interior_deformer<I>::Interior_deformer(const Positions& positions, I influence, const Summation_options& options,
                                        std::span<const double> weights)
  : field_(positions, std::move(influence), options, weights)
{}

template <Influence I>
template <Point_range Displacements>
void Interior_deformer<I>::set_displacements(const Displacements& displacements)
{
  field_.set_displacements(displacements);
}

template <Influence I>
template <Point_range Points, Point_range Result>
Deformation_report Interior_deformer<I>::evaluate(const Points& points, Result&& result) const
{
  if (std::ranges::size(points) != std::ranges::size(result))
    throw Input_error("Interior_deformer: " + std::to_string(std::ranges::size(points)) + " points, but room for " +
                      std::to_string(std::ranges::size(result)) + " displacements");
  using Value = std::ranges::range_value_t<Result>;
  return field_.for_each_displacement(
    points, [&](Index m, const Point& s) { std::ranges::begin(result)[m] = internal::make_point<Value>(s); });
}

template <Influence I>
template <Point_range Points>
Deformation_report Interior_deformer<I>::deform(Points&& points) const
{
  using Value = std::ranges::range_value_t<Points>;
  return field_.for_each_displacement(points, [&](Index m, const Point& s) {
    if (s[0] == 0 && s[1] == 0 && s[2] == 0)
      return;
    auto&& point = std::ranges::begin(points)[m];
    const Point p = internal::coordinates(point);
    point = internal::make_point<Value>({p[0] + s[0], p[1] + s[1], p[2] + s[2]});
  });
}

template <Point_range Sources, Point_range Displacements, Point_range Targets, Influence I>
Deformation_report deform_interior(const Sources& sources, const Displacements& displacements, Targets&& targets,
                                   const I& influence, const Summation_options& options,
                                   std::span<const double> weights)
{
  return internal::with_deformer(sources, displacements, std::ranges::size(targets), influence, options, weights,
                                 [&](const auto& deformer) { return deformer.deform(targets); });
}

template <Point_range Sources, Point_range Displacements, Point_range Targets>
Deformation_report deform_interior(const Sources& sources, const Displacements& displacements, Targets&& targets,
                                   const Deformation_options& options, std::span<const double> weights)
{
  return internal::with_influence(options, [&](const auto& influence) {
    return deform_interior(sources, displacements, targets, influence, options.summation, weights);
  });
}

template <Point_range Sources, Point_range Displacements, Point_range Targets, Point_range Result>
Deformation_report interior_displacements(const Sources& sources, const Displacements& displacements,
                                          const Targets& targets, Result&& result, const Deformation_options& options,
                                          std::span<const double> weights)
{
  return internal::with_influence(options, [&](const auto& influence) {
    return internal::with_deformer(sources, displacements, std::ranges::size(targets), influence, options.summation,
                                   weights, [&](const auto& deformer) { return deformer.evaluate(targets, result); });
  });
}

} // namespace recurve

#endif
