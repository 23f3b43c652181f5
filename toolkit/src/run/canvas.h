#ifndef RECURVE_SRC_RUN_CANVAS_H
#define RECURVE_SRC_RUN_CANVAS_H

#include <cstdint>
#include <memory>
#include <string>

namespace recurve {

enum class Anchor : std::uint8_t
{
  start,
  middle,
  end
};

/// A colour as 0xRRGGBB.
using Color = std::uint32_t;

/// A white sheet to draw on, in pixels from its upper left corner.
class Canvas
{
public:
  virtual ~Canvas() = default;
  virtual void fill_rectangle(double x, double y, double width, double height, Color color) = 0;

  /// writes black words on a base line; `x` is where they start, have their middle or end. \param is_upwards  from the
  /// bottom to the top instead of from left to right.
  virtual void write(double x, double y, Anchor anchor, const std::string& words, bool is_upwards = false) = 0;

  /// ends the picture and gives the bytes of its file.
  virtual std::string take() = 0;
};

std::unique_ptr<Canvas> make_svg_canvas(int width, int height);

/// \throws std::runtime_error if there is no memory for the picture.
std::unique_ptr<Canvas> make_png_canvas(int width, int height);

} // namespace recurve

#endif
