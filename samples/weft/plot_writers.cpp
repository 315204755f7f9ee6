// A drawing as SVG, and as a picture: strokes are drawn by the distance of each pixel to them, letters are stb_easy_font's.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "compute/text.h"
#include "samples/weft/plot.h"

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#pragma GCC diagnostic ignored "-Wsign-compare"
#include <stb/stb_easy_font.h>
#pragma GCC diagnostic pop

namespace weft::command {

namespace {

constexpr double kPixels = 2;   // a unit: sharp on today's screens

class Canvas {
 public:
  explicit Canvas(const Drawing& drawing) {
    image_.width = static_cast<std::uint32_t>(std::ceil(drawing.width * kPixels));
    image_.height = static_cast<std::uint32_t>(std::ceil(drawing.height * kPixels));
    image_.rgba.assign(std::size_t{4} * image_.width * image_.height, 255);
  }

  Image take() { return std::move(image_); }

  // All that is nearer than `radius` to the segment, in units.
  void segment(double x0, double y0, double x1, double y1, double radius, Colour colour) {
    for (double* value : {&x0, &y0, &x1, &y1, &radius}) *value *= kPixels;
    const double dx = x1 - x0, dy = y1 - y0, squared = dx * dx + dy * dy;
    cover(std::min(x0, x1) - radius, std::min(y0, y1) - radius, std::max(x0, x1) + radius, std::max(y0, y1) + radius, colour,
          [&](double x, double y) {
            const double t = squared > 0 ? std::clamp(((x - x0) * dx + (y - y0) * dy) / squared, 0.0, 1.0) : 0;
            return radius - std::hypot(x - x0 - t * dx, y - y0 - t * dy);
          });
  }

  // In pixels.
  void box(double x0, double y0, double x1, double y1, Colour colour) {
    cover(x0, y0, x1, y1, colour, [&](double x, double y) { return std::min({x - x0, x1 - x, y - y0, y1 - y}); });
  }

  void letters(const Stroke& stroke) {
    const double scale = stroke.size * kPixels / 12;   // the font's lines are 12 high
    std::string words = stroke.text;
    std::vector<float> quads(words.size() * 300 + 64);   // at most 270 bytes a letter
    const int count = stb_easy_font_print(0, 0, words.data(), nullptr, quads.data(), static_cast<int>(quads.size() * sizeof(float)));
    const double width = stb_easy_font_width(words.data()) * scale;
    const double before = stroke.anchor == Stroke::Anchor::start ? 0 : stroke.anchor == Stroke::Anchor::middle ? width / 2 : width;
    const double x = stroke.x * kPixels, y = stroke.y * kPixels;
    constexpr int kFloats = 4;   // of a vertex; the first and the third of a quad are opposite corners
    constexpr double kBase = 7;
    for (int q = 0; q < count; ++q) {
      const float* first = quads.data() + static_cast<std::ptrdiff_t>(4 * kFloats * q);
      const float* third = first + 2 * kFloats;
      const double left = first[0] * scale - before, right = third[0] * scale - before;
      const double top = (first[1] - kBase) * scale, bottom = (third[1] - kBase) * scale;
      if (stroke.upwards) box(x + top, y - right, x + bottom, y - left, stroke.colour);
      else box(x + left, y + top, x + right, y + bottom, stroke.colour);
    }
  }

 private:
  // Blends pixels by how deep inside their middles are: half covered at the edge.
  template <class Depth>
  void cover(double x0, double y0, double x1, double y1, Colour colour, Depth&& depth) {
    const auto clamped = [](double value, std::uint32_t most) { return static_cast<std::uint32_t>(std::clamp(value, 0.0, double(most))); };
    for (std::uint32_t y = clamped(y0 - 1, image_.height); y < clamped(y1 + 2, image_.height); ++y)
      for (std::uint32_t x = clamped(x0 - 1, image_.width); x < clamped(x1 + 2, image_.width); ++x) {
        const double part = std::clamp(depth(x + 0.5, y + 0.5) + 0.5, 0.0, 1.0);
        if (part <= 0) continue;
        std::uint8_t* pixel = &image_.rgba[4 * (std::size_t{y} * image_.width + x)];
        for (std::size_t c = 0; c < 3; ++c)
          pixel[c] = static_cast<std::uint8_t>(std::lround(pixel[c] + part * (double(colour[c]) - pixel[c])));
      }
  }

  Image image_;
};

std::string hex(Colour colour) {
  char text[8];
  std::snprintf(text, sizeof text, "#%02x%02x%02x", colour[0], colour[1], colour[2]);
  return text;
}

std::string escaped(const std::string& text) {
  std::string safe;
  for (const char c : text) {
    if (c == '&') safe += "&amp;";
    else if (c == '<') safe += "&lt;";
    else if (c == '>') safe += "&gt;";
    else safe += c;
  }
  return safe;
}

}  // namespace

std::string svg(const Drawing& drawing) {
  constexpr const char* kAnchors[] = {"start", "middle", "end"};
  TextStream text;
  text.precision(5);
  text << "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 " << drawing.width << ' ' << drawing.height << "\" width=\""
       << drawing.width << "\" height=\"" << drawing.height
       << "\" font-family=\"system-ui, sans-serif\">\n<rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n";
  for (const Stroke& s : drawing.strokes) switch (s.kind) {
      case Stroke::Kind::line:
        text << "<line x1=\"" << s.x << "\" y1=\"" << s.y << "\" x2=\"" << s.to_x << "\" y2=\"" << s.to_y << "\" stroke=\"" << hex(s.colour)
             << "\" stroke-width=\"" << s.size << "\"/>\n";
        break;
      case Stroke::Kind::disc:
        text << "<circle cx=\"" << s.x << "\" cy=\"" << s.y << "\" r=\"" << s.size << "\" fill=\"" << hex(s.colour) << "\"/>\n";
        break;
      case Stroke::Kind::text:
        text << "<text x=\"" << s.x << "\" y=\"" << s.y << "\" font-size=\"" << s.size << "\" fill=\"" << hex(s.colour)
             << "\" text-anchor=\"" << kAnchors[static_cast<int>(s.anchor)] << '"';
        if (s.upwards) text << " transform=\"rotate(-90 " << s.x << ' ' << s.y << ")\"";
        text << '>' << escaped(s.text) << "</text>\n";
        break;
    }
  text << "</svg>\n";
  return text.str();
}

Image picture(const Drawing& drawing) {
  Canvas canvas(drawing);
  for (const Stroke& s : drawing.strokes) switch (s.kind) {
      case Stroke::Kind::line: canvas.segment(s.x, s.y, s.to_x, s.to_y, s.size / 2, s.colour); break;
      case Stroke::Kind::disc: canvas.segment(s.x, s.y, s.x, s.y, s.size, s.colour); break;
      case Stroke::Kind::text: canvas.letters(s); break;
    }
  return canvas.take();
}

}  // namespace weft::command
