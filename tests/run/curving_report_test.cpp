#include "support/sphere_shell.h"

#include <recurve/run/curve_mesh.h>
#include <recurve/run/curving_report.h>

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

using namespace recurve;
using nlohmann::json;

namespace {

/// the keys of an object in alphabetical order.
std::vector<std::string> keys(const json& object)
{
  std::vector<std::string> result;
  for (const auto& [key, value] : object.items())
    result.push_back(key);
  return result;
}

} // namespace

TEST_CASE("the report of a conversion counts what is there")
{
  Volume_mesh mesh = test::sphere_shell({4, 2, Element_type::hexahedron, test::Outer_shape::box});
  mesh.zones[0].name = "caf\xe9"; // Latin-1, as old files have it: no UTF-8
  Curving_report report;
  curve_mesh(mesh, {.degree = 3, .keep = {"outer"}, .deform = false}, &report);
  const json found = json::parse(to_json(report));

  CHECK(found["program"] == "recurve");
  CHECK(found["options"]["degree"] == 3);
  CHECK(found["options"]["fit_degree"] == 3);
  CHECK(found["options"]["keep"] == json({"outer"}));
  CHECK(found["mesh"]["cells"] == 192);
  CHECK(found["mesh"]["cells_by_type"]["hexahedron"] == 192);
  CHECK(found["mesh"]["points"] == 3 * 98);
  for (std::size_t c = 0; c < 3; ++c)
    CHECK(found["mesh"]["bounding_box"]["largest"][c].get<double>() == Approx(2));
  CHECK(found["patches"][0]["name"] == "sphere");
  CHECK(found["patches"][0]["curved_faces"] == 96);
  CHECK(found["patches"][1]["name"] == "outer");
  CHECK(found["patches"][1]["faces"] == 96);
  CHECK(found["patches"][1]["curved_faces"] == 0);
  CHECK(found["surface"]["faces"] == 96);
  CHECK(found["surface"]["edges"] == 192);
  CHECK(found["fits"]["faces"] == 96);
  CHECK(found["cells"]["total"] == 192);
  CHECK(found["cells"]["straight"] == 96);
  CHECK(found["cells"]["curved"] == 96);
  CHECK(found["deformation"].is_null());
  CHECK(found["validity"]["is_certified"] == true);
  CHECK(found["validity"]["promised_cells"] == 192);
  CHECK(found["validity"]["after_restoration"]["by_type"]["hexahedron"]["valid"] == 192);
  CHECK(found["validity"]["share_at_full_curvature"] == 1.0);
  CHECK(found["validity"]["curved_faces"] == 96);
  CHECK(found["displacement"]["largest"]["length"] > 0.0);
  CHECK(found["peak_memory_bytes"] > 1000000);
  CHECK(found["seconds"] > 0.0);
}

TEST_CASE("the keys of the report are the documented ones")
{
  const json found = json::parse(to_json(Curving_report{}));
  CHECK(keys(found) ==
        std::vector<std::string>{
          "cells",   "deformation", "displacement", "features", "fits",     "input",   "jacobians",
          "mesh",    "nodes",       "notes",        "options",  "output",   "patches", "peak_memory_bytes",
          "program", "seconds",     "stages",       "surface",  "validity", "version"});
  CHECK(keys(found["deformation"]) ==
        std::vector<std::string>{"blended_face_nodes", "error_bound", "largest_displacement", "length", "method",
                                 "moved_nodes", "moving_sources", "negligible_nodes", "pairs", "periodic_pairs",
                                 "planar_nodes", "planar_patches", "sources", "targets", "translations"});
  CHECK(keys(found["mesh"]) == std::vector<std::string>{"boundary", "bounding_box", "cells", "cells_by_type",
                                                        "interfaces", "joined_zones", "name", "orientation", "patches",
                                                        "points", "zones"});
  CHECK(keys(found["fits"]) == std::vector<std::string>{"faces", "faces_of_degree", "first_lowered_faces", "fits",
                                                        "lowered_by_reason", "lowered_faces", "planar_faces",
                                                        "poor_stencils", "reduced_fits", "stencil_vertices"});
  CHECK(keys(found["features"]) == std::vector<std::string>{"border_edges", "candidate_edges", "critical_edges",
                                                            "curves", "isolated_corners", "longest_rejected_curves",
                                                            "rejected_curves", "rejected_edges", "sharp_edges",
                                                            "sharp_vertices", "weak_edges"});
}
