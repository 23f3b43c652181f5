#include <recurve/core/exceptions.h>
#include <recurve/run/jacobian_history.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace recurve {

namespace {

// Lengths in pixels.
constexpr double width = 900, height = 420, left = 70, right = 20, top = 50, bottom = 60;
constexpr double plot_width = width - left - right, plot_height = height - top - bottom;

/// Distinct also in grey and for the colour-blind.
constexpr std::array<const char*, 4> colors = {"#b0b0b0", "#d95f02", "#1b6ca8", "#7570b3"};

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
  explicit Picture(const Jacobian_history& history) : history_(history)
  {
    Index largest = 1;
    for (const Jacobian_stage& stage : history.stages)
      for (std::size_t slot = 0; slot < slots; ++slot)
        largest = std::max(largest, count_in(stage, slot));
    decades_ = std::ceil(std::log10(static_cast<double>(largest)) + 0.01);
  }

  std::string svg()
  {
    text_ =
      fmt::format("<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0} {1}\" width=\"{0}\" height=\"{1}\" "
                  "font-family=\"sans-serif\" font-size=\"13\">\n"
                  "<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n",
                  width, height);
    draw_axes();
    for (std::size_t s = 0; s < history_.stages.size(); ++s)
      draw_stage(s);
    return text_ + "</svg>\n";
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

  void write(double x, double y, const char* anchor, const std::string& words)
  {
    text_ += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\">{}</text>\n", x, y, anchor, words);
  }

  void draw_axes()
  {
    for (int decade = 0; decade <= static_cast<int>(decades_); ++decade)
    {
      const double y = y_of(std::pow(10.0, decade));
      text_ += fmt::format("<path d=\"M{} {:.1f}H{}\" stroke=\"#dddddd\"/>\n", left, y, width - right);
      write(left - 8, y + 4, "end", fmt::format("{:.0f}", std::pow(10.0, decade)));
    }
    text_ += fmt::format("<path d=\"M{} {}H{}\" stroke=\"black\"/>\n", left, height - bottom, width - right);
    write(x_of(1) - 14, height - bottom + 18, "end", "not valid"); // beside the 0.0 of the first bin
    for (std::size_t bin = 0; bin <= Jacobian_report::bin_count; bin += Jacobian_report::bin_count / 10)
      write(x_of(bin + 1), height - bottom + 18, "middle",
            fmt::format("{:.1f}", static_cast<double>(bin) / Jacobian_report::bin_count));
    write(left + plot_width / 2, height - 16, "middle",
          "scaled Jacobian: certified lower bound of det J over its maximum in the cell");
    text_ += fmt::format("<text transform=\"translate(18 {}) rotate(-90)\" text-anchor=\"middle\">cells</text>\n",
                         top + plot_height / 2);
  }

  void draw_stage(std::size_t s)
  {
    const Jacobian_stage& stage = history_.stages[s];
    const char* const color = colors[s % colors.size()];
    const double bar = 0.8 * slot_width() / static_cast<double>(history_.stages.size());
    for (std::size_t slot = 0; slot < slots; ++slot)
    {
      const Index count = count_in(stage, slot);
      if (count == 0)
        continue;
      const double y = y_of(static_cast<double>(count));
      text_ +=
        fmt::format("<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\" fill=\"{}\"/>\n",
                    x_of(slot) + 0.1 * slot_width() + static_cast<double>(s) * bar, y, bar, height - bottom - y, color);
    }
    const double x = left + static_cast<double>(s) * plot_width / static_cast<double>(history_.stages.size());
    text_ += fmt::format("<rect x=\"{:.1f}\" y=\"18\" width=\"14\" height=\"14\" fill=\"{}\"/>\n", x, color);
    write(x + 20, 30, "start", fmt::format("{}: {} not valid", stage.name, stage.inverted + stage.wrong_before));
  }

  const Jacobian_history& history_;
  double decades_ = 1;
  std::string text_;
};

} // namespace

std::string histogram_svg(const Jacobian_history& history)
{
  if (history.stages.empty())
    throw Input_error("histogram: no Jacobians were recorded");
  return Picture(history).svg();
}

} // namespace recurve
