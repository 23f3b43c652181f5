#ifndef RECURVE_SURFACE_RECONSTRUCTION_REPORT_H
#define RECURVE_SURFACE_RECONSTRUCTION_REPORT_H

#include <recurve/core/types.h>
#include <recurve/surface/local_fit.h>

#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

namespace recurve {

/// Why a face was fitted again with a lower degree.
enum class Lowering_reason : std::uint8_t
{
  not_finite,   ///< a coefficient was infinite or not a number
  displacement, ///< the fit moved the face or an edge farther than `largest_displacement` of the options
  no_normal,    ///< the face has no area, hence no tangent plane: straight at once
  undetermined, ///< the points around do not tell the terms of the degree apart
  disagreement  ///< of a fit of a vertex with that of two degrees less, with what the normals tell or with the fit or
                ///< its degree at the other end of an edge
};

/// "not finite", ... in lower case, as in reports.
constexpr std::string_view lowering_reason_name(Lowering_reason reason)
{
  switch (reason)
  {
  case Lowering_reason::not_finite: return "not finite";
  case Lowering_reason::displacement: return "displacement";
  case Lowering_reason::no_normal: return "no normal";
  case Lowering_reason::undetermined: return "undetermined";
  case Lowering_reason::disagreement: return "disagreement";
  }
  return "";
}

/// A face whose fit has not the degree that was asked for.
struct Lowering
{
  Index face = no_index;                                ///< position in `faces(g)`
  int degree = 0;                                       ///< of the fit it got
  Lowering_reason reason = Lowering_reason::not_finite; ///< of the last lowering; of fits of vertices, the first
};

/// What a call to `reconstruct_surface()` did. Reports of disjoint parts of a surface add up.
struct Reconstruction_report
{
  Index faces = 0;
  std::array<Index, max_fit_degree + 1> faces_of_degree = {}; ///< by degree of their fit; planar ones are in [0]
  Index planar_faces = 0;          ///< surface around them planar to round-off: flat fit, not lowered
  Index lowered_faces = 0;         ///< faces with an entry in `lowerings`
  Index poor_stencils = 0;         ///< curved fits from fewer points than coefficients: the solver's early stop decided
  Index stencil_vertices = 0;      ///< sum of the stencil sizes of the fits kept; over `fits` it is the mean
  Index fits = 0;                  ///< polynomials that are not flat: of faces, or of vertices
  Index reduced_fits = 0;          ///< fits of vertices with a lower degree than was asked for. Where that is still the
                                   ///< degree of the rate, `lowerings` does not list their faces
  std::vector<Lowering> lowerings; ///< ascending by face

  /// \param other  report of further faces; its face numbers are kept as they are.
  Reconstruction_report& operator+=(const Reconstruction_report& other)
  {
    faces += other.faces;
    for (std::size_t d = 0; d < faces_of_degree.size(); ++d)
      faces_of_degree[d] += other.faces_of_degree[d];
    planar_faces += other.planar_faces;
    lowered_faces += other.lowered_faces;
    poor_stencils += other.poor_stencils;
    stencil_vertices += other.stencil_vertices;
    fits += other.fits;
    reduced_fits += other.reduced_fits;
    lowerings.insert(lowerings.end(), other.lowerings.begin(), other.lowerings.end());
    return *this;
  }
};

} // namespace recurve

#endif
