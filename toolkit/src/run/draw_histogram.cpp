#include "canvas.h"

#include <recurve/core/exceptions.h>
#include <recurve/run/jacobian_history.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace recurve {

namespace {

// Lengths in pixels.
constexpr int width = 900, height = 420;
constexpr double left = 70, right = 20, top = 50, bottom = 60;
constexpr double plot_width = width - left - right, plot_height = height - top - bottom;

/// Distinct also in grey and for the colour-blind.
constexpr std::array<Color, 4> colors = {0xb0b0b0, 0xd95f02, 0x1b6ca8, 0x7570b3};
constexpr Color grid_color = 0xdddddd, axis_color = 0x000000;

/// The slots along the axis: first the cells that are not valid, then the bins.
constexpr std::size_t slots = Jacobian_report::bin_count + 1;

Index count_in(const Jacobian_stage& stage, std::size_t slot)
{
  return slot == 0 ? stage.inverted + stage.wrong_before : stage.bounds.histogram[slot - 1];
}

/// One picture; `decades` is the height of the axis.
class Picture
{
public:
  Picture(const Jacobian_history& history, Canvas& canvas) : history_(history), canvas_(canvas)
  {
    Index largest = 1;
    for (const Jacobian_stage& stage : history.stages)
      for (std::size_t slot = 0; slot < slots; ++slot)
        largest = std::max(largest, count_in(stage, slot));
    decades_ = std::ceil(std::log10(static_cast<double>(largest)) + 0.01);
  }

  void draw()
  {
    draw_axes();
    for (std::size_t s = 0; s < history_.stages.size(); ++s)
      draw_stage(s);
  }

private:
  double slot_width() const { return plot_width / slots; }
  double x_of(std::size_t slot) const { return left + static_cast<double>(slot) * slot_width(); }

  /// a single cell has to be seen, so that counts begin below 1.
  double y_of(double count) const
  {
    const double t = count <= 0 ? 0 : (std::log10(count) + 0.3) / (decades_ + 0.3);
    return top + (1 - t) * plot_height;
  }

  void draw_axes()
  {
    for (int decade = 0; decade <= static_cast<int>(decades_); ++decade)
    {
      const double y = y_of(std::pow(10.0, decade));
      canvas_.fill_rectangle(left, y, plot_width, 1, grid_color);
      canvas_.write(left - 8, y + 4, Anchor::end, fmt::format("{:.0f}", std::pow(10.0, decade)));
    }
    canvas_.fill_rectangle(left, height - bottom, plot_width, 1, axis_color);
    canvas_.write(x_of(1) - 14, height - bottom + 18, Anchor::end, "not valid"); // beside the 0.0 of the first bin
    for (std::size_t bin = 0; bin <= Jacobian_report::bin_count; bin += Jacobian_report::bin_count / 10)
      canvas_.write(x_of(bin + 1), height - bottom + 18, Anchor::middle,
                    fmt::format("{:.1f}", static_cast<double>(bin) / Jacobian_report::bin_count));
    canvas_.write(left + plot_width / 2, height - 16, Anchor::middle,
                  "scaled Jacobian: certified lower bound of det J over its maximum in the cell");
    canvas_.write(18, top + plot_height / 2, Anchor::middle, "cells", true);
  }

  void draw_stage(std::size_t s)
  {
    const Jacobian_stage& stage = history_.stages[s];
    const Color color = colors[s % colors.size()];
    const auto stages = static_cast<double>(history_.stages.size());
    const double bar = 0.8 * slot_width() / stages;
    for (std::size_t slot = 0; slot < slots; ++slot)
      if (const Index count = count_in(stage, slot); count > 0)
      {
        const double y = y_of(static_cast<double>(count));
        canvas_.fill_rectangle(x_of(slot) + 0.1 * slot_width() + static_cast<double>(s) * bar, y, bar,
                               height - bottom - y, color);
      }
    const double x = left + static_cast<double>(s) * plot_width / stages;
    canvas_.fill_rectangle(x, 18, 14, 14, color);
    canvas_.write(x + 20, 30, Anchor::start,
                  fmt::format("{}: {} not valid", stage.name, stage.inverted + stage.wrong_before));
  }

  const Jacobian_history& history_;
  Canvas& canvas_;
  double decades_ = 1;
};

} // namespace

std::string draw_histogram(const Jacobian_history& history, Picture_format format)
{
  if (history.stages.empty())
    throw Input_error("histogram: no Jacobians were recorded");
  const auto canvas = format == Picture_format::png ? make_png_canvas(width, height) : make_svg_canvas(width, height);
  Picture(history, *canvas).draw();
  return canvas->take();
}

} // namespace recurve
