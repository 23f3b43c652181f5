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

/// cells of two stages in three bins, ten of them not valid.
Jacobian_history two_stages()
{
  Jacobian_stage straight, curved;
  straight.name = "straight";
  straight.bounds.histogram[19] = 1000;
  curved.name = "curved";
  curved.bounds.histogram[3] = 1;
  curved.bounds.histogram[19] = 989;
  curved.inverted = 10;
  return {{straight, curved}};
}

} // namespace

TEST_CASE("a histogram is drawn with a bar for each bin that is not empty")
{
  const std::string svg = draw_histogram(two_stages(), Picture_format::svg);
  CHECK(svg.starts_with("<svg"));
  CHECK(svg.ends_with("</svg>\n"));
  CHECK(count(svg, "#b0b0b0") == 1 + 1); // legend and bars
  CHECK(count(svg, "#d95f02") == 1 + 3);
  CHECK(svg.find("curved: 10 not valid") != std::string::npos);
  CHECK(svg.find("nan") == std::string::npos);
  CHECK_THROWS_AS(draw_histogram({}, Picture_format::svg), Input_error);
}

TEST_CASE("a histogram as PNG is a file of that format, 900 by 420")
{
  const std::string png = draw_histogram(two_stages(), Picture_format::png);
  CHECK(png.starts_with("\x89PNG\r\n\x1a\n"));
  CHECK(png.substr(12, 12) == std::string("IHDR\0\0\x03\x84\0\0\x01\xa4", 12));
  CHECK(png.substr(png.size() - 8, 4) == "IEND");
  CHECK_THROWS_AS(draw_histogram({}, Picture_format::png), Input_error);
}
