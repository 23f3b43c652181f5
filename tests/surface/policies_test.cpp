#include "surface/test_surfaces.h"

#include <recurve/surface/policies.h>
#include <recurve/surface/reconstruct_surface.h>

#include <Eigen/Dense>
#include <boost/property_map/property_map.hpp>
#include <catch2/catch.hpp>

#include <cmath>

using namespace recurve;
using namespace test_surfaces;

namespace {

/// A user's solver: column-pivoted QR of the weighted rows, without any early stop.
struct Qr_solver
{
  void operator()(const Weighted_points& points, int degree, std::span<double> coefficients) const
  {
    const auto rows = static_cast<Eigen::Index>(points.size());
    Eigen::MatrixXd a(rows, coefficient_count(degree));
    Eigen::VectorXd b(rows);
    for (Eigen::Index i = 0; i < rows; ++i)
    {
      const auto r = static_cast<std::size_t>(i);
      const double root = std::sqrt(points.weight[r]);
      for (int p = 0; p <= degree; ++p)
        for (int k = 0; k <= p; ++k)
          a(i, coefficient_number(p - k, k)) = root * std::pow(points.u[r], p - k) * std::pow(points.v[r], k);
      b[i] = root * points.height[r];
    }
    const Eigen::VectorXd x = a.colPivHouseholderQr().solve(b);
    std::copy(x.begin(), x.end(), coefficients.begin());
  }
};

/// A user's weighting.
struct Gaussian
{
  double width = 2;
  double operator()(const Stencil_point& point, int /*degree*/) const
  {
    return point.cosine > 0 ? std::exp(-point.distance * point.distance / (width * width)) : 0;
  }
};

/// A user's stencil: rings until there are twice as many vertices as coefficients.
struct Growing_stencil
{
  void operator()(Stencil_builder& builder, int degree) const
  {
    for (Index before = 0; before < builder.size() && builder.size() < 2 * coefficient_count(degree);)
    {
      before = builder.size();
      builder.add_ring();
    }
  }
};

static_assert(Stencil<Paper_stencil> && Stencil<Growing_stencil> && !Stencil<Gaussian>);
static_assert(Weighting<Paper_weighting> && Weighting<Gaussian> && !Weighting<Qr_solver>);
static_assert(Least_squares_solver<Conjugate_residual> && Least_squares_solver<Qr_solver>);

template <class Policies>
std::vector<Local_fit> fits_of(const Mesh& mesh, int degree, const Policies& policies, Reconstruction_report& report)
{
  std::vector<Local_fit> fits(mesh.number_of_faces());
  const auto map = boost::make_iterator_property_map(fits.begin(), get(boost::face_index, mesh));
  report = reconstruct_surface(mesh, map, {.degree = degree}, no_parameters, policies);
  return fits;
}

double largest_error_at_centroids(const std::vector<Local_fit>& fits)
{
  double error = 0;
  for (const Local_fit& fit : fits)
    error = std::max(error, distance_to_sphere(fit.point(0, 0)));
  return error;
}

} // namespace

TEST_CASE("the rings of the paper and of WALF", "[policies]")
{
  for (int d = 1; d <= 6; ++d)
  {
    CHECK(Paper_rings()(d) == d + 0.5);
    CHECK(Walf_compact_rings()(d) == (d + 1) / 2.0);
    CHECK(Walf_wide_rings()(d) == d / 2.0 + 1);
  }
}

TEST_CASE("formula (3) of the paper", "[policies]")
{
  const Paper_weighting weighting;
  CHECK(weighting({.distance = 2, .cosine = 0.5}, 3) == Approx(0.5 / 16));
  CHECK(weighting({.distance = 2, .cosine = 0.5, .is_corner = true}, 3) == Approx(0.5 / 16 + 1.0 / 32));
  CHECK(weighting({.distance = 2, .cosine = 1e-7}, 3) == 0);
  CHECK(weighting({.distance = 2, .cosine = -1}, 3) == 0);
  CHECK(weighting({.distance = 2, .cosine = -1, .is_corner = true}, 3) == Approx(1.0 / 32));
}

TEST_CASE("conjugate residuals agree with a direct solution where points determine the fit", "[policies]")
{
  Polygons sphere = icosphere(3);
  perturb_sphere(sphere, 0.02, 5);
  const Mesh mesh = make_mesh(sphere);
  const int degree = GENERATE(1, 2, 3, 4, 5, 6);
  CAPTURE(degree);
  Reconstruction_report report;
  const auto iterated = fits_of(mesh, degree, Paper_policies(), report);
  const auto direct =
    fits_of(mesh, degree, Reconstruction_policies<Paper_stencil, Paper_weighting, Qr_solver>(), report);
  double difference = 0, size = 0;
  for (std::size_t f = 0; f < direct.size(); ++f)
  {
    size = std::max(size, std::abs(direct[f].height(0, 0)));
    difference = std::max(difference, std::abs(direct[f].height(0, 0) - iterated[f].height(0, 0)));
  }
  CHECK(difference < 1e-6 * size); // the bound on the residual is 1e-8; conditioning takes the rest
}

TEST_CASE("corrected fits go through the corners of their faces", "[policies]")
{
  const bool has_quads = GENERATE(false, true);
  Polygons sphere = has_quads ? cubed_sphere(8) : icosphere(3);
  perturb_sphere(sphere, 0.02, 5);
  const Mesh mesh = make_mesh(sphere);
  const auto map_of = [&](std::vector<Local_fit>& fits) {
    fits.resize(mesh.number_of_faces());
    return boost::make_iterator_property_map(fits.begin(), get(boost::face_index, mesh));
  };
  for (int degree = has_quads ? 2 : 1; degree <= 6; ++degree)
  {
    CAPTURE(has_quads, degree);
    std::vector<Local_fit> plain, corrected;
    reconstruct_surface(mesh, map_of(plain), {.degree = degree});
    reconstruct_surface(mesh, map_of(corrected), {.degree = degree, .interpolates_corners = true});
    double residual = 0, plain_residual = 0, change = 0;
    for (const auto f : mesh.faces())
      for (const auto v : mesh.vertices_around_face(mesh.halfedge(f)))
      {
        const Point x = to_point(mesh.point(v));
        residual = std::max(residual, norm(corrected[f].displacement(x)));
        plain_residual = std::max(plain_residual, norm(plain[f].displacement(x)));
      }
    for (std::size_t f = 0; f < plain.size(); ++f)
      change = std::max(change, std::abs(plain[f].height(0, 0) - corrected[f].height(0, 0)));
    CHECK(residual < 1e-14);
    CHECK(plain_residual > 1e-9);         // there is something to correct,
    CHECK(change < 1.5 * plain_residual); // and the correction is as large as the residuals, no larger
  }
}

TEST_CASE("the corner correction gains at d = 2", "[policies]")
{
  Polygons ellipsoid = icosphere(4);
  perturb_sphere(ellipsoid, 0.01, 5);
  for (Point& x : ellipsoid.points)
    x = {2 * x[0], 1.3 * x[1], x[2]};
  const Mesh mesh = make_mesh(ellipsoid);
  const auto error_with = [&](bool interpolates_corners) {
    std::vector<Local_fit> fits(mesh.number_of_faces());
    reconstruct_surface(mesh, boost::make_iterator_property_map(fits.begin(), get(boost::face_index, mesh)),
                        {.degree = 2, .interpolates_corners = interpolates_corners});
    double error = 0;
    for (const Local_fit& fit : fits)
    {
      const Point x = fit.point(0, 0);
      const Point scaled = {x[0] / 2, x[1] / 1.3, x[2]};
      const Point gradient = {scaled[0] / 2, scaled[1] / 1.3, scaled[2]};
      error = std::max(error, std::abs(norm(scaled) - 1) / norm(gradient));
    }
    return error;
  };
  CHECK(error_with(true) < 0.6 * error_with(false));
}

TEST_CASE("stencils, weightings and solvers are exchanged one by one", "[policies]")
{
  const Mesh mesh = make_mesh(icosphere(3));
  Reconstruction_report paper, compact, wide, growing, gaussian;
  const double paper_error = largest_error_at_centroids(fits_of(mesh, 4, Paper_policies(), paper));
  const double compact_error =
    largest_error_at_centroids(fits_of(mesh, 4, Reconstruction_policies<Ring_stencil<Walf_compact_rings>>(), compact));
  fits_of(mesh, 4, Reconstruction_policies<Ring_stencil<Walf_wide_rings>>(), wide);
  const double growing_error =
    largest_error_at_centroids(fits_of(mesh, 4, Reconstruction_policies<Growing_stencil>(), growing));
  const double gaussian_error = largest_error_at_centroids(
    fits_of(mesh, 4, Reconstruction_policies<Paper_stencil, Gaussian>{.weighting = {.width = 1.5}}, gaussian));
  CHECK(compact.stencil_vertices < wide.stencil_vertices);
  CHECK(wide.stencil_vertices < paper.stencil_vertices);
  CHECK(growing.stencil_vertices >= growing.faces * 2 * coefficient_count(4));
  CHECK(compact_error < paper_error);
  CHECK(growing_error < 1e-4);
  CHECK(gaussian_error < 1e-4);
}
