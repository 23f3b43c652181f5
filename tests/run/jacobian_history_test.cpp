#include <recurve/run/jacobian_history.h>

#include <recurve/core/exceptions.h>

#include <catch2/catch.hpp>

#include <string>

using namespace recurve;

namespace {

std::size_t count(const std::string& text, const std::string& part)
{
  std::size_t found = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1))
    ++found;
  return found;
}

} // namespace

TEST_CASE("a histogram is drawn with a bar for each bin that is not empty")
{
  Jacobian_history history;
  Jacobian_stage straight, curved;
  straight.name = "straight";
  straight.bounds.histogram[19] = 1000;
  curved.name = "curved";
  curved.bounds.histogram[3] = 1;
  curved.bounds.histogram[19] = 989;
  curved.inverted = 10;
  history.stages = {straight, curved};
  const std::string svg = histogram_svg(history);
  CHECK(svg.starts_with("<svg"));
  CHECK(svg.ends_with("</svg>\n"));
  CHECK(count(svg, "<rect") == 1 + 2 + 4); // the ground, the legend, the bars
  CHECK(svg.find("curved: 10 not valid") != std::string::npos);
  CHECK(svg.find("nan") == std::string::npos);
  CHECK_THROWS_AS(histogram_svg({}), Input_error);
}
