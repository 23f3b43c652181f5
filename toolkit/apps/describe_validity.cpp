#include "describe_validity.h"

#include "wording.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

namespace recurve {

namespace {

std::string describe_types(const Jacobian_report& report)
{
  std::vector<std::vector<std::string>> rows = {{"", "valid", "invalid", "undecided"}};
  for (const Element_type type : all_element_types)
    if (const auto& v = report.of(type); v.valid + v.invalid + v.undecided > 0)
      rows.push_back({std::string(plural_name(type)), grouped(v.valid), grouped(v.invalid), grouped(v.undecided)});
  return table(rows);
}

std::string describe_cells(const std::vector<Cell_verdict>& cells)
{
  std::vector<std::vector<std::string>> rows = {{"scaled Jacobian", "verdict", "cell", "zone", "near", "patches"}};
  for (const Cell_verdict& cell : cells)
    rows.push_back({fmt::format("{:.4g}", cell.scaled), std::string(to_string(cell.verdict)),
                    fmt::format("{} {}", element_name(cell.type), cell.cell), cell.zone, at_point(cell.position),
                    cell.patches.empty() ? "inside" : fmt::format("{}", fmt::join(cell.patches, ", "))});
  return table(rows);
}

std::string describe_histogram(const Jacobian_report& report)
{
  constexpr double longest_bar = 40;
  const Index most = *std::max_element(report.histogram.begin(), report.histogram.end());
  std::vector<std::vector<std::string>> rows;
  for (std::size_t b = 0; b < report.histogram.size(); ++b)
  {
    const double width = 1.0 / static_cast<double>(report.histogram.size());
    const auto bar = most == 0 ? 0 : longest_bar * static_cast<double>(report.histogram[b]) / static_cast<double>(most);
    rows.push_back({fmt::format("{:.2f} to {:.2f}", width * static_cast<double>(b), width * static_cast<double>(b + 1)),
                    grouped(report.histogram[b]), std::string(static_cast<std::size_t>(bar + 0.999), '#')});
  }
  return table(rows);
}

/// \param whose  "", or which cells are meant
std::string smallest(const Jacobian_report& report, std::string_view whose = "")
{
  return report.least_valid.element == no_index
           ? "no cell is valid"
           : fmt::format("smallest certified scaled Jacobian{} {:.4g}", whose, report.least_valid.scaled);
}

std::string named(const std::vector<Cell_verdict>& cells)
{
  constexpr std::size_t most = 5;
  std::string text = describe_cells({cells.begin(), cells.begin() + std::ptrdiff_t(std::min(most, cells.size()))});
  if (cells.size() > most)
    text += fmt::format("  ... and {} more\n", grouped(static_cast<Index>(cells.size() - most)));
  return text;
}

} // namespace

std::string describe(const Certification& certification)
{
  if (!certification.is_checked)
    return "validity was not checked\n";
  const Restoration_report& report = certification.restoration;
  const auto excluded = static_cast<Index>(certification.excluded.size());
  const auto bad = static_cast<Index>(certification.uncertified.size());
  const auto promised = static_cast<Index>(certification.bounds.verdicts.size()) - excluded;
  std::string text;
  if (excluded > 0)
    text += fmt::format("{} already wrong before curving, and not promised:\n{}",
                        counted(excluded, "cell was", "cells were"), named(certification.excluded));
  if (report.failing_cells > 0)
    text += fmt::format("{} failed after deformation; {} by moving inner nodes, {} lost curvature\n",
                        counted(report.failing_cells, "cell", "cells"),
                        counted(report.repaired_cells, "was repaired", "were repaired"),
                        counted(report.reduced_cells, "cell", "cells"));
  if (certification.curved_faces > 0)
    text +=
      fmt::format("{:.2f} % of the curved area has full curvature; {} of {} have less\n",
                  100 * certification.full_share(), grouped(static_cast<Index>(certification.reduced_faces.size())),
                  counted(certification.curved_faces, "curved face", "curved faces"));
  if (bad > 0)
    text += fmt::format("NOT CERTIFIED: {} of {} promised cells\n{}", grouped(bad), grouped(promised),
                        named(certification.uncertified));
  else
    text += fmt::format("certified valid: all {}{}; {}\n", excluded > 0 ? "other " : "",
                        counted(promised, "cell", "cells"), smallest(report.restored));
  return text;
}

std::string describe(const Validity_check& check, const std::string& file)
{
  std::string text = fmt::format("{}: degree {}, {}", file, check.degree, counted(check.cells, "cell", "cells"));
  if (check.degree > 1)
    text += fmt::format(", {} exactly straight", grouped(check.jacobians.straight_elements));
  text += "\n";
  text += describe_types(check.jacobians);
  if (!check.worst.empty())
    text += "worst cells\n" + describe_cells(check.worst);
  text += "scaled Jacobian (certified lower bound over upper bound) of the valid cells\n";
  text += describe_histogram(check.jacobians);
  const auto total = check.jacobians.total();
  text += check.is_valid() ? fmt::format("every cell is certified valid; {}\n", smallest(check.jacobians))
                           : fmt::format("NOT VALID: {} and {}; {}\n", counted(total.invalid, "invalid", "invalid"),
                                         counted(total.undecided, "undecided cell", "undecided cells"),
                                         smallest(check.jacobians, " of the valid cells"));
  return text;
}

} // namespace recurve
