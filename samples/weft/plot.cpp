// Axes, marks and legends as strokes.
#include "samples/weft/plot.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace weft::command {

namespace {

constexpr double kWidth = 460, kHeight = 340;              // of a panel
constexpr double kLeft = 64, kRight = 14, kTop = 34, kBottom = 48;   // margins in it
constexpr double kLegendRow = 20, kLegendColumn = 210;
constexpr double kLetters = 12;
constexpr Colour kInk = {40, 40, 40}, kGrid = {228, 228, 228}, kFrame = {150, 150, 150};

Stroke line(double x, double y, double to_x, double to_y, double width, Colour colour) {
  return {.kind = Stroke::Kind::line, .x = x, .y = y, .to_x = to_x, .to_y = to_y, .size = width, .colour = colour, .text = {}};
}
Stroke disc(double x, double y, double radius, Colour colour) {
  return {.kind = Stroke::Kind::disc, .x = x, .y = y, .size = radius, .colour = colour, .text = {}};
}
Stroke text(double x, double y, std::string words, Stroke::Anchor anchor = Stroke::Anchor::start, double size = kLetters) {
  return {.kind = Stroke::Kind::text, .x = x, .y = y, .size = size, .colour = kInk, .text = std::move(words), .anchor = anchor};
}

// A logarithmic axis over whole decades, as few as hold the values.
struct Axis {
  int low = 0, high = 1;      // powers of ten
  double from = 0, to = 1;    // where they are drawn

  double at(double value) const {
    const double part = std::clamp((std::log10(value) - low) / (high - low), 0.0, 1.0);
    return from + part * (to - from);
  }
};

Axis axis_of(const Panel& panel, std::size_t dimension, double from, double to) {
  double least = INFINITY, most = 0;
  for (const Series& series : panel.series)
    for (const auto& point : series.points) {
      least = std::min(least, point[dimension]);
      most = std::max(most, point[dimension]);
    }
  // A run that diverged would squeeze all others: no more than a hundred times the sheet.
  most = std::min(most, dimension == 1 ? 100.0 : INFINITY);
  if (!(least <= most)) least = 0.1, most = 1;
  Axis axis{static_cast<int>(std::floor(std::log10(least))), static_cast<int>(std::ceil(std::log10(most))), from, to};
  if (axis.high <= axis.low) axis.high = axis.low + 1;
  return axis;
}

std::string power_of_ten(int power) {
  char text[32];
  std::snprintf(text, sizeof text, power >= -3 && power <= 4 ? "%g" : "%.0e", std::pow(10.0, power));
  return text;
}

void add_axes(const Panel& panel, const Axis& x, const Axis& y, std::vector<Stroke>& strokes) {
  for (const Axis* axis : {&x, &y})
    for (int power = axis->low; power <= axis->high; ++power)
      for (int digit = 1; digit < (power < axis->high ? 10 : 2); ++digit) {
        if (digit > 1 && axis->high - axis->low > 4) continue;
        const double place = axis->at(digit * std::pow(10.0, power));
        const double width = digit == 1 ? 1.2 : 0.6;
        if (axis == &x) strokes.push_back(line(place, y.from, place, y.to, width, kGrid));
        else strokes.push_back(line(x.from, place, x.to, place, width, kGrid));
        if (digit > 1) continue;
        if (axis == &x) strokes.push_back(text(place, y.from + 16, power_of_ten(power), Stroke::Anchor::middle));
        else strokes.push_back(text(x.from - 6, place + 4, power_of_ten(power), Stroke::Anchor::end));
      }
  strokes.push_back(line(x.from, y.from, x.to, y.from, 1, kFrame));
  strokes.push_back(line(x.from, y.from, x.from, y.to, 1, kFrame));
  strokes.push_back(text((x.from + x.to) / 2, y.to - 12, panel.title, Stroke::Anchor::middle, 13));
  strokes.push_back(text((x.from + x.to) / 2, y.from + 36, panel.x_label, Stroke::Anchor::middle));
  Stroke label = text(x.from - 48, (y.from + y.to) / 2, panel.y_label, Stroke::Anchor::middle);
  label.upwards = true;
  strokes.push_back(std::move(label));
}

void add_panel(const Panel& panel, double left, double top, std::vector<Stroke>& strokes) {
  const Axis x = axis_of(panel, 0, left + kLeft, left + kWidth - kRight), y = axis_of(panel, 1, top + kHeight - kBottom, top + kTop);
  add_axes(panel, x, y, strokes);
  for (const Series& series : panel.series)
    for (const auto& point : series.points) strokes.push_back(disc(x.at(point[0]), y.at(point[1]), 3.2, series.colour));
  // Between two points of the front a budget buys the cheaper one: across, then down.
  for (std::size_t k = 0; k < panel.front.size(); ++k) {
    const auto& point = panel.front[k];
    const double end = k + 1 < panel.front.size() ? x.at(panel.front[k + 1][0]) : x.to;
    strokes.push_back(line(x.at(point[0]), y.at(point[1]), end, y.at(point[1]), 1.5, kInk));
    if (k + 1 < panel.front.size()) strokes.push_back(line(end, y.at(point[1]), end, y.at(panel.front[k + 1][1]), 1.5, kInk));
  }
}

}  // namespace

Colour series_colour(std::size_t k) {
  constexpr Colour kColours[] = {{0, 114, 178}, {86, 180, 233}, {230, 159, 0}, {0, 158, 115},
                                 {213, 94, 0}, {204, 121, 167}, {120, 120, 120}, {240, 208, 20}};
  return kColours[k % std::size(kColours)];
}

Drawing plot(const std::vector<Panel>& panels, std::size_t across) {
  Drawing drawing;
  std::vector<const Series*> named;   // one of each name
  for (const Panel& panel : panels)
    for (const Series& series : panel.series)
      if (std::none_of(named.begin(), named.end(), [&](const Series* other) { return other->name == series.name; }))
        named.push_back(&series);
  const std::size_t rows = (panels.size() + across - 1) / across;
  drawing.width = kWidth * static_cast<double>(std::min(across, panels.size()));
  const auto columns = std::max<std::size_t>(1, static_cast<std::size_t>(drawing.width / kLegendColumn));
  const bool fronts = std::any_of(panels.begin(), panels.end(), [](const Panel& panel) { return !panel.front.empty(); });
  const std::size_t entries = named.size() + (fronts ? 1 : 0);
  drawing.height = kHeight * static_cast<double>(rows) + kLegendRow * static_cast<double>((entries + columns - 1) / columns) + 10;
  for (std::size_t k = 0; k < panels.size(); ++k)
    add_panel(panels[k], kWidth * static_cast<double>(k % across), kHeight * static_cast<double>(k / across), drawing.strokes);
  for (std::size_t k = 0; k < entries; ++k) {
    const double x = 24 + kLegendColumn * static_cast<double>(k % columns);
    const double y = kHeight * static_cast<double>(rows) + kLegendRow * static_cast<double>(k / columns) + 8;
    if (k < named.size()) drawing.strokes.push_back(disc(x, y, 3.6, named[k]->colour));
    else drawing.strokes.push_back(line(x - 6, y, x + 6, y, 1.5, kInk));
    drawing.strokes.push_back(text(x + 12, y + 4, k < named.size() ? named[k]->name : "front: the best for a budget"));
  }
  return drawing;
}

}  // namespace weft::command
