// Plots of error over milliseconds: one description, written as SVG and as a picture.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "engine/image.h"

namespace weft::command {

using Colour = std::array<std::uint8_t, 3>;

/// What is drawn, first to last. Lengths are SVG units; y grows downwards.
struct Stroke {
  enum class Kind { line, disc, text } kind = Kind::line;
  double x = 0, y = 0;       // a line's start, a disc's middle, where a text is anchored on its base line
  double to_x = 0, to_y = 0; // a line's end
  double size = 1;           // width, radius, or height of letters
  Colour colour{};
  std::string text;
  enum class Anchor { start, middle, end } anchor = Anchor::start;
  bool upwards = false;      // a text that is turned a quarter to the left
};
struct Drawing {
  double width = 0, height = 0;
  std::vector<Stroke> strokes;
};

/// Points of one colour.
struct Series {
  std::string name;
  Colour colour{};
  std::vector<std::array<double, 2>> points;   // x, y, both above 0
};

/// A panel with logarithmic axes over whole decades.
struct Panel {
  std::string title, x_label, y_label;
  std::vector<Series> series;
  std::vector<std::array<double, 2>> front;    // joined by steps: what a budget buys
};

/// Panels side by side, `across` in a row, over one legend. Errors above a hundred are drawn at the edge: something blew up.
Drawing plot(const std::vector<Panel>& panels, std::size_t across);

/// A colour for the k-th series, apart for eyes of every kind (Okabe and Ito 2008).
Colour series_colour(std::size_t k);

std::string svg(const Drawing& drawing);
Image picture(const Drawing& drawing);

}  // namespace weft::command
