// Fronts, and curves as text. Numbers are written as briefly as they can be read back to the same bits.
#include "engine/reference/curve.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <numeric>
#include <type_traits>

namespace weft {
namespace {

// Columns from here on came later: a curve may end before it.
constexpr const char* kLater = "dispatches";

// One list of columns, name and member, for the writer and the reader.
template <class Visitor, class Point>
void columns(Visitor&& v, Point& p) {
  v("row", p.row);
  v("assignments", p.assignments);
  v("cells", p.cells);
  v("particles", p.particles);
  v("tethers", p.tethers);
  v("substeps", p.substeps);
  v("iterations", p.iterations);
  v("ms_median", p.ms_median);
  v("ms_p95", p.ms_p95);
  v("ms_gpu", p.ms_gpu);
  v("strain_mean", p.strain_mean);
  v("strain_rms", p.strain_rms);
  v("strain_max", p.strain_max);
  v("solver_error", p.solver_error);
  v("time_error", p.time_error);
  v("total_error", p.total_error);
  v("non_finite", p.non_finite);
  v("passes", p.passes);
  v(kLater, p.dispatches);
}

// Without commas and control characters, which separate columns and lines.
std::string plain(std::string text) {
  std::replace_if(text.begin(), text.end(), [](unsigned char c) { return c == ',' || c < 0x20; }, ' ');
  return text;
}

std::string text_of(const std::string& value) { return plain(value); }
std::string text_of(bool value) { return std::string(1, value ? '1' : '0'); }
template <class Number>
std::string text_of(Number value) {
  if constexpr (std::is_floating_point_v<Number>)
    if (std::isnan(value)) return "";
  std::array<char, 32> digits;
  const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr;
  return {digits.data(), end};
}

bool read(std::string_view text, std::string& value) { return value = text, true; }
bool read(std::string_view text, bool& value) { return value = text == "1", text == "0" || text == "1"; }
template <class Number>
bool read(std::string_view text, Number& value) {
  if constexpr (std::is_floating_point_v<Number>)
    if (text.empty()) return value = CurvePoint::kUnknown, true;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size();
}

std::string header() {
  std::string line;
  const CurvePoint any;
  columns([&](const char* name, const auto&) {
    if (!line.empty()) line += ',';
    line += name;
  }, any);
  return line;
}

// Cuts off and returns what stands before the next `mark`.
std::string_view next(std::string_view& text, char mark) {
  const std::size_t end = std::min(text.find(mark), text.size());
  const std::string_view part = text.substr(0, end);
  text.remove_prefix(std::min(end + 1, text.size()));
  return part;
}

constexpr std::string_view kFirstLine = "# weft accuracy curve 1";

Result<void> read_fact(std::string_view line, std::size_t number, Curve& curve) {
  line.remove_prefix(1);
  std::string_view key = next(line, ':'), value = line;
  for (std::string_view* part : {&key, &value}) part->remove_prefix(std::min(part->find_first_not_of(' '), part->size()));
  if (key == "device") curve.device = value;
  else if (key == "scene") curve.scene = value;
  else if (key == "date") curve.date = value;
  else if (key == "key") curve.key = value;
  else if (key == "frames" && !read(value, curve.frames)) return fail("line ", number, ": frames: ", value, " is not a whole number");
  return {};
}

std::ptrdiff_t columns_in(std::string_view line) { return 1 + std::count(line.begin(), line.end(), ','); }

// How many of the columns there are, by the line that names them; none where it names others.
std::ptrdiff_t columns_named(std::string_view line) {
  const std::string all = header();
  return line == all || line == std::string_view(all).substr(0, all.find(kLater) - 1) ? columns_in(line) : 0;
}

Result<CurvePoint> read_point(std::string_view line, std::size_t number, std::ptrdiff_t wanted) {
  CurvePoint point;
  std::string fault;
  if (columns_in(line) != wanted) return fail("line ", number, ": has ", columns_in(line), " columns, not ", wanted);
  columns([&](const char* name, auto& value) {
    if (wanted-- <= 0) return;
    const std::string_view text = next(line, ',');
    if (!read(text, value) && fault.empty()) fault = std::string(name) + ": \"" + std::string(text.substr(0, 60)) + "\" cannot be read";
  }, point);
  if (!fault.empty()) return fail("line ", number, ": ", fault);
  return point;
}

}  // namespace

bool counts(const CurvePoint& point, CurveError error) {
  return point.non_finite == 0 && std::isfinite(point.*error) && std::isfinite(point.ms_median);
}

std::vector<std::size_t> front(std::span<const CurvePoint> points, CurveError error, CurveCost cost) {
  std::vector<std::size_t> order(points.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::erase_if(order, [&](std::size_t i) { return !counts(points[i], error) || !std::isfinite(points[i].*cost); });
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return std::pair(points[a].*cost, points[a].*error) < std::pair(points[b].*cost, points[b].*error);
  });
  std::vector<std::size_t> kept;
  for (const std::size_t i : order)
    if (kept.empty() || points[i].*error < points[kept.back()].*error) kept.push_back(i);
  return kept;
}

std::optional<std::size_t> best(std::span<const CurvePoint> points, CurveError error, double budget_ms) {
  std::optional<std::size_t> found;
  for (const std::size_t i : front(points, error))
    if (points[i].ms_median <= budget_ms) found = i;
  return found;
}

std::vector<CurvePoint> points_of(const Curve& curve, std::uint32_t cells, bool tethers) {
  std::vector<CurvePoint> points;
  for (const CurvePoint& point : curve.points)
    if (point.cells == cells && point.tethers == tethers) points.push_back(point);
  return points;
}

std::string curve_csv(const Curve& curve) {
  std::string text = std::string(kFirstLine) + "\n# device: " + plain(curve.device) + "\n# scene: " + plain(curve.scene) +
                     "\n# date: " + plain(curve.date) + "\n# frames: " + text_of(curve.frames) + "\n# key: " + plain(curve.key) + '\n' +
                     header() + '\n';
  for (const CurvePoint& point : curve.points) {
    std::string line;
    columns([&](const char*, const auto& value) { line += text_of(value) + ','; }, point);
    line.back() = '\n';
    text += line;
  }
  return text;
}

Result<Curve> parse_curve(std::string_view text) try {
  Curve curve;
  std::ptrdiff_t wanted = 0;   // columns
  if (next(text, '\n') != kFirstLine) return fail("line 1: is not \"", kFirstLine, "\"");
  for (std::size_t number = 2; !text.empty(); ++number) {
    const std::string_view line = next(text, '\n');
    if (line.empty()) continue;
    if (line[0] == '#') {
      if (auto done = read_fact(line, number, curve); !done) return done.take_error();
    } else if (wanted == 0) {
      wanted = columns_named(line);
      if (wanted == 0) return fail("line ", number, ": is not the header of such a curve");
    } else {
      auto point = read_point(line, number, wanted);
      if (!point) return point.take_error();
      curve.points.push_back(std::move(*point));
    }
  }
  return curve;
} catch (...) {
  return caught("the curve");
}

}  // namespace weft
