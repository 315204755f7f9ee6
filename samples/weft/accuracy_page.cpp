// The plot's panels, and the page's sentences, table and pictures.
#include "samples/weft/accuracy_page.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <sstream>

#include "compute/text.h"

namespace weft::command {

namespace {

std::string number(double value, const char* format = "%.3g") {
  if (!std::isfinite(value)) return "";
  char text[32];
  std::snprintf(text, sizeof text, format, value);
  return text;
}

std::string size_words(const std::vector<CurvePoint>& points) {
  if (points.empty()) return "";
  if (points[0].cells == 0) return std::to_string(points[0].particles) + " particles";
  return std::to_string(points[0].cells + 1) + " vertices a side";
}

Panel panel_of(const std::vector<CurvePoint>& points, CurveError error, CurveError cost, std::string title, std::string label) {
  Panel panel{std::move(title), cost == &CurvePoint::dispatches ? "dispatches a frame" : "ms a frame", std::move(label), {}, {}};
  std::size_t row_index = 0;
  for (const SolverRow& row : kSolverRows) {
    Series series{std::string(row.name), series_colour(row_index++), {}};
    for (const CurvePoint& point : points)
      if (point.row == row.name && counts(point, error) && point.*error > 0 && point.*cost > 0)
        series.points.push_back({point.*cost, point.*error});
    if (!series.points.empty()) panel.series.push_back(std::move(series));
  }
  for (const std::size_t i : front(points, error, cost))
    if (points[i].*error > 0 && points[i].*cost > 0) panel.front.push_back({points[i].*cost, points[i].*error});
  return panel;
}

std::string base64(const std::vector<char>& bytes) {
  constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 3; ++k) group = group << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0u);
    for (std::size_t k = 0; k < 4; ++k) text += i + k > bytes.size() ? '=' : kDigits[group >> (18 - 6 * k) & 63];
  }
  return text;
}

std::string escaped(const std::string& text) {
  std::string safe;
  for (const char c : text) safe += c == '<' ? "&lt;" : c == '>' ? "&gt;" : c == '&' ? "&amp;" : std::string(1, c);
  return safe;
}

// Rows of one resolution by milliseconds; the front's are bold.
void add_table(const std::vector<CurvePoint>& points, std::ostream& html) {
  std::vector<std::size_t> order(points.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return points[a].ms_median < points[b].ms_median; });
  const std::vector<std::size_t> best = front(points, &CurvePoint::strain_rms);
  html << "<table><tr><th>solver<th>substeps<th>iterations<th>ms, median<th>ms, 95 %<th>ms on the GPU<th>dispatches"
          "<th>strain, mean<th>rms<th>largest<th>solver error<th>time error<th>both<th>passes, ms</tr>\n";
  for (const std::size_t i : order) {
    const CurvePoint& p = points[i];
    const bool in_front = std::find(best.begin(), best.end(), i) != best.end();
    html << (in_front ? "<tr class=\"front\">" : "<tr>") << "<td>" << escaped(p.row) << "<td>" << p.substeps << "<td>" << p.iterations
         << "<td>" << number(p.ms_median) << "<td>" << number(p.ms_p95) << "<td>" << number(p.ms_gpu) << "<td>" << number(p.dispatches)
         << "<td>" << percent(p.strain_mean) << "<td>" << percent(p.strain_rms) << "<td>" << percent(p.strain_max) << "<td>" << number(p.solver_error) << "<td>"
         << number(p.time_error) << "<td>" << number(p.total_error) << "<td class=\"passes\">" << escaped(p.passes)
         << (p.non_finite > 0 ? "; not finite" : "") << "</tr>\n";
  }
  html << "</table>\n";
}

constexpr const char* kStyle =
    "body{font:15px/1.5 system-ui,sans-serif;max-width:1400px;margin:2em auto;padding:0 1em;color:#222}h1,h2,h3{line-height:1.2}"
    "svg{max-width:100%;height:auto}table{border-collapse:collapse;font-variant-numeric:tabular-nums;font-size:13px}"
    "th,td{padding:2px 10px;text-align:right;border-bottom:1px solid #ddd}th:first-child,td:first-child{text-align:left}"
    ".front{font-weight:bold}.passes{font-size:11px;font-weight:normal;text-align:left}"
    ".shots{display:flex;flex-wrap:wrap;gap:12px}figure{margin:0;flex:1 1 280px}img{width:100%}details{margin:.5em 0}";

}  // namespace

std::string percent(double fraction) { return std::isfinite(fraction) ? number(100 * fraction) + " %" : ""; }

std::string setting_words(const CurvePoint& point) {
  return point.row + ", " + std::to_string(point.substeps) + (point.substeps == 1 ? " substep x " : " substeps x ") +
         std::to_string(point.iterations) + (point.iterations == 1 ? " iteration" : " iterations");
}

std::string setting_flags(const CurvePoint& point) {
  std::string flags;
  std::istringstream words(point.assignments);
  for (std::string word; words >> word;) flags += "--set " + word + ' ';
  return flags + "--set solver.substeps=" + std::to_string(point.substeps) + " --set solver.iterations=" + std::to_string(point.iterations);
}

std::uint32_t largest(const Curve& curve) {
  std::uint32_t most = 0;
  for (const CurvePoint& point : curve.points) most = std::max(most, point.cells);
  return most;
}

std::uint32_t largest_referenced(const Curve& curve) {
  std::uint32_t most = 0;
  for (const CurvePoint& point : curve.points)
    if (std::isfinite(point.total_error)) most = std::max(most, point.cells);
  return most;
}

Drawing accuracy_plot(const Curve& curve) {
  std::vector<Panel> panels;
  for (const bool tethers : {true, false}) {
    const std::string with = tethers ? ", with tethers" : ", without tethers";
    const auto large = points_of(curve, largest(curve), tethers), small = points_of(curve, largest_referenced(curve), tethers);
    const auto add = [&](const std::vector<CurvePoint>& points, CurveError error, const char* label,
                         CurveCost cost = &CurvePoint::ms_median) {
      Panel panel = panel_of(points, error, cost, size_words(points) + with, label);
      if (!panel.series.empty()) panels.push_back(std::move(panel));
    };
    add(large, &CurvePoint::strain_rms, "rms strain");
    add(large, &CurvePoint::strain_rms, "rms strain", &CurvePoint::dispatches);
    add(small, &CurvePoint::solver_error, "rms distance to the reference, same h");
    add(small, &CurvePoint::total_error, "rms distance to the reference at h/16");
  }
  return plot(panels, largest_referenced(curve) > 0 ? 4 : 2);
}

std::string accuracy_page(const Page& page) {
  const Curve& curve = page.curve;
  TextStream html;
  html << "<!doctype html>\n<html lang=\"en\"><meta charset=\"utf-8\"><title>Accuracy of " << escaped(curve.scene) << "</title>\n<style>"
       << kStyle << "</style>\n<h1>Accuracy of " << escaped(curve.scene) << "</h1>\n<p>" << escaped(curve.device) << ", "
       << escaped(curve.date) << ". Each of " << curve.points.size() << " settings was run for " << curve.frames
       << " frames; milliseconds (whole frames on the wall clock after " << page.plan.warm_up
       << " frames to warm up) and errors are of the same run, milliseconds on the GPU of a second one with timestamps. Strain is "
          "|length / rest - 1| over all edges and the frames of the second half, at full resolution. Distances are rms over all "
          "particles and frames, over the sheet's size, to references in double precision (Newton's method on every step): the "
          "solver's error at the same step h, the time step's between references at h and h / 16, and both together to the one at "
          "h / 16.";
  const std::uint32_t referenced = largest_referenced(curve);
  if (referenced > 0)
    html << " References are costly: they were made up to " << referenced << " cells a side, and with at most " << page.plan.most_steps
         << " steps a frame, which replaces h / 16 where that would be more.";
  html << "</p>\n";
  if (page.interrupted) html << "<p><b>The sweep was interrupted: this is what had been measured.</b></p>\n";
  if (!page.notes.empty()) {
    html << "<details><summary>Left out</summary><ul>\n";
    for (const std::string& note : page.notes) html << "<li>" << escaped(note) << "\n";
    html << "</ul></details>\n";
  }
  html << svg(accuracy_plot(curve));
  if (!page.shots.empty()) {
    html << "<h2>Three budgets</h2>\n<div class=\"shots\">\n";
    for (const Shot& shot : page.shots)
      html << "<figure><img alt=\"\" src=\"data:image/png;base64," << base64(shot.png) << "\"><figcaption>" << escaped(shot.caption)
           << "</figcaption></figure>\n";
    html << "</div>\n";
  }
  html << "<h2>All settings</h2>\n<p>Bold: no other is both faster and strained less.</p>\n";
  std::map<std::pair<std::uint32_t, bool>, bool> parts;
  for (const CurvePoint& point : curve.points) parts[{point.cells, !point.tethers}] = true;
  for (const auto& [part, there] : parts) {
    const auto points = points_of(curve, part.first, !part.second);
    html << "<details" << (part.first == largest(curve) ? " open" : "") << "><summary>" << size_words(points) << ", "
         << (part.second ? "without" : "with") << " tethers</summary>\n";
    add_table(points, html);
    html << "</details>\n";
  }
  html << "</html>\n";
  return html.str();
}

}  // namespace weft::command
