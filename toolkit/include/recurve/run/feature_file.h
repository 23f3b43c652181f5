#ifndef RECURVE_RUN_FEATURE_FILE_H
#define RECURVE_RUN_FEATURE_FILE_H

#include <recurve/features/feature_edit.h>

#include <array>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace recurve {

/// A point of a zone of a mesh.
struct Zone_node
{
  std::string zone;      ///< name; empty: none
  Index node = no_index; ///< number in the zone, from 0
};

/// One change of a feature file: a `Feature_edit` that may name vertices and patches as the mesh does.
struct Feature_file_edit
{
  Feature_edit edit{};
  std::vector<Zone_node> nodes{}; ///< as long as `edit.vertices`, or empty; where a zone is named, it counts
  std::array<std::string, 2>
    patches{}; ///< names for `edit.patches`; the second one empty: any other patch, and the border
};

/// Changes to the features of a mesh, to be kept beside it.
struct Feature_file
{
  bool starts_from_detection = true; ///< else from the borders alone
  Feature_edit_options options = {};
  std::vector<Feature_file_edit> edits = {};
};

/// reads a TOML file of changes:
///
/// ```toml
/// start = "auto"          # or "none": only borders, then the edits
/// turning_angle = 40      # a curve that turns by more has a sharp vertex there; degrees
/// chain_angle = 10        # a chain ends where the dihedral angle is smaller
/// corner_defect = 60      # see Feature_edit_options
/// tolerance = 0           # distance within which a position means the one vertex there, for positions that were typed
///
/// [[edit]]
/// action = "add"                                      # or "remove"
/// edges = [[[0, 0, 0], [1, 0, 0]],                    # end points, to the last bit (17 digits)
///          [{zone = "wing", node = 17}, {zone = "wing", node = 18}]]  # nodes of a zone, from 0
///
/// [[edit]]
/// action = "add"
/// path = [[0, 0, 0], [5, 0, 0]]                       # shortest way along edges; more way points may follow
///
/// [[edit]]
/// action = "add"
/// crease = [[0, 0, 0], [5, 0, 0]]                     # way that keeps to creases and turns least
///
/// [[edit]]
/// action = "add"
/// chain = [[0, 0, 0], [1, 0, 0]]                      # from this edge on, while the dihedral angle is large enough
/// angle = 20                                          # optional, also for box and patches
///
/// [[edit]]
/// action = "remove"
/// box = [[0, 0, 0], [1, 1, 1]]
///
/// [[edit]]
/// action = "add"
/// patches = ["upper", "lower"]                        # or ["upper"]: against all others; ["upper", "upper"]: inside
///
/// [[edit]]
/// action = "mark"                                     # as sharp; or "unmark"
/// vertices = [[0, 0, 0], {at = [1, 0, 0], copy = 1}]  # the second of several vertices at one position
/// ```
/// \throws Format_error with file and line for what is no TOML, an unknown key, or a value of the wrong kind.
Feature_file read_feature_file(const std::filesystem::path& file);

/// the same from a text; `name` stands for the file in messages.
Feature_file parse_feature_file(std::string_view text, const std::string& name);

/// the text of a file that reads as `file`, numbers with 17 digits.
std::string to_toml(const Feature_file& file);

/// writes to_toml(). \throws Format_error if the file cannot be written; an older one then stays as it was.
void write_feature_file(const Feature_file& features, const std::filesystem::path& file);

} // namespace recurve

#endif
