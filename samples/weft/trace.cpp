// Dispatches to trace events.
#include "samples/weft/trace.h"

#include <algorithm>
#include <nlohmann/json.hpp>

namespace weft::command {

std::string trace_json(const std::string& device, const std::vector<PassUse>& passes, const std::vector<TracedFrame>& frames) {
  using Json = nlohmann::ordered_json;
  constexpr double kMicroseconds = 1000;  // per millisecond: the format's unit
  Json events = Json::array();
  const auto name_row = [&](const char* what, std::size_t row, const std::string& name) {
    events.push_back({{"ph", "M"}, {"name", what}, {"pid", 1}, {"tid", row}, {"args", {{"name", name}}}});
  };
  const auto add = [&](const std::string& name, std::size_t row, double begin_ms, double end_ms) {
    events.push_back({{"ph", "X"}, {"name", name}, {"pid", 1}, {"tid", row}, {"ts", begin_ms * kMicroseconds},
                      {"dur", std::max(0.0, end_ms - begin_ms) * kMicroseconds}});
  };
  name_row("process_name", 0, device);
  name_row("thread_name", 0, "frame");
  for (std::size_t i = 0; i < passes.size(); ++i) name_row("thread_name", i + 1, passes[i].name);

  double start = 0;
  for (std::size_t number = 0; number < frames.size(); ++number) {
    const TracedFrame& frame = frames[number];
    double length = frame.milliseconds;
    for (const DispatchTime& dispatch : frame.dispatches) {
      length = std::max(length, dispatch.end_ms);
      const auto pass = std::find_if(passes.begin(), passes.end(), [&](const PassUse& use) { return use.name == dispatch.name; });
      add(dispatch.name, static_cast<std::size_t>(pass - passes.begin()) + 1, start + dispatch.begin_ms, start + dispatch.end_ms);
    }
    add("frame " + std::to_string(number), 0, start, start + length);
    start += length;
  }
  return Json{{"displayTimeUnit", "ms"}, {"traceEvents", std::move(events)}}.dump(-1, ' ', false, Json::error_handler_t::replace) + '\n';
}

}  // namespace weft::command
