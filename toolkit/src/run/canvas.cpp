#include "canvas.h"

#include <cairo.h>
#include <fmt/format.h>

#include <array>
#include <numbers>
#include <stdexcept>
#include <string_view>

namespace recurve {

namespace {

constexpr double font_size = 13; // pixels

class Svg_canvas : public Canvas
{
public:
  Svg_canvas(int width, int height)
    : text_(
        fmt::format("<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0} {1}\" width=\"{0}\" height=\"{1}\" "
                    "font-family=\"sans-serif\" font-size=\"{2}\">\n"
                    "<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n",
                    width, height, font_size))
  {}

  void fill_rectangle(double x, double y, double width, double height, Color color) override
  {
    text_ += fmt::format("<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\" fill=\"#{:06x}\"/>\n", x,
                         y, width, height, color);
  }

  void write(double x, double y, Anchor anchor, const std::string& words, bool is_upwards) override
  {
    constexpr std::array<std::string_view, 3> anchors = {"start", "middle", "end"};
    text_ += fmt::format("<text transform=\"translate({:.1f} {:.1f}){}\" text-anchor=\"{}\">{}</text>\n", x, y,
                         is_upwards ? " rotate(-90)" : "", anchors[static_cast<std::size_t>(anchor)], words);
  }

  std::string take() override { return std::move(text_) + "</svg>\n"; }

private:
  std::string text_;
};

class Png_canvas : public Canvas
{
public:
  Png_canvas(int width, int height)
    : surface_(cairo_image_surface_create(CAIRO_FORMAT_RGB24, width, height)), context_(cairo_create(surface_.get()))
  {
    check(cairo_status(context_.get()));
    cairo_set_source_rgb(context_.get(), 1, 1, 1);
    cairo_paint(context_.get());
    cairo_select_font_face(context_.get(), "sans-serif", CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_NORMAL);
    cairo_set_font_size(context_.get(), font_size);
  }

  void fill_rectangle(double x, double y, double width, double height, Color color) override
  {
    const auto part = [color](int shift) { return static_cast<double>((color >> shift) & 0xffU) / 255; };
    cairo_set_source_rgb(context_.get(), part(16), part(8), part(0));
    cairo_rectangle(context_.get(), x, y, width, height);
    cairo_fill(context_.get());
  }

  void write(double x, double y, Anchor anchor, const std::string& words, bool is_upwards) override
  {
    cairo_text_extents_t extents;
    cairo_text_extents(context_.get(), words.c_str(), &extents);
    cairo_save(context_.get());
    cairo_translate(context_.get(), x, y);
    if (is_upwards)
      cairo_rotate(context_.get(), -std::numbers::pi / 2);
    cairo_move_to(context_.get(), -extents.x_advance * static_cast<double>(anchor) / 2, 0);
    cairo_set_source_rgb(context_.get(), 0, 0, 0);
    cairo_show_text(context_.get(), words.c_str());
    cairo_restore(context_.get());
  }

  std::string take() override
  {
    std::string file;
    const auto append = [](void* to, const unsigned char* bytes, unsigned int count) {
      static_cast<std::string*>(to)->append(reinterpret_cast<const char*>(bytes), count);
      return CAIRO_STATUS_SUCCESS;
    };
    check(cairo_status(context_.get()));
    check(cairo_surface_write_to_png_stream(surface_.get(), append, &file));
    return file;
  }

private:
  static void check(cairo_status_t status)
  {
    if (status != CAIRO_STATUS_SUCCESS)
      throw std::runtime_error(fmt::format("picture: {}", cairo_status_to_string(status)));
  }

  template <auto destroy>
  struct Destroy
  {
    template <class T>
    void operator()(T* t) const
    {
      destroy(t);
    }
  };

  std::unique_ptr<cairo_surface_t, Destroy<cairo_surface_destroy>> surface_;
  std::unique_ptr<cairo_t, Destroy<cairo_destroy>> context_;
};

} // namespace

std::unique_ptr<Canvas> make_svg_canvas(int width, int height)
{
  return std::make_unique<Svg_canvas>(width, height);
}

std::unique_ptr<Canvas> make_png_canvas(int width, int height)
{
  return std::make_unique<Png_canvas>(width, height);
}

} // namespace recurve
