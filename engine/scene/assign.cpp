// `path.to.value=X` on a scene's JSON, before it is checked: what an assignment gets wrong is found by the same rules and
// told in the same sentences as what a file gets wrong.
#include <charconv>
#include <vector>

#include "engine/scene/faults.h"
#include "engine/scene/json.h"

namespace weft {

namespace {

using nlohmann::json;

constexpr std::size_t kLongestPath = 1000;
constexpr std::size_t kLongestValue = 1 << 20;

// "cloths[0].grid.cells" and "cloths.0.grid.cells" are the same four steps. Nothing when a step is empty or a bracket open.
std::optional<std::vector<std::string>> steps_of(std::string_view path) {
  std::vector<std::string> steps;
  std::size_t at = 0;
  while (at < path.size()) {
    const bool bracket = path[at] == '[';
    if (bracket || (!steps.empty() && path[at] == '.')) ++at;
    const std::size_t end = bracket ? path.find(']', at) : path.find_first_of(".[]", at);
    if (bracket && end == std::string_view::npos) return std::nullopt;
    const std::string_view step = path.substr(at, end == std::string_view::npos ? end : end - at);
    if (step.empty()) return std::nullopt;
    steps.emplace_back(step);
    at += step.size() + (bracket ? 1 : 0);
    if (at < path.size() && path[at] != '.' && path[at] != '[') return std::nullopt;
    if (at + 1 == path.size()) return std::nullopt;  // a separator and nothing behind it
  }
  if (steps.empty() || steps.size() > kDeepestNesting) return std::nullopt;
  return steps;
}

std::optional<std::size_t> index_of(std::string_view step) {
  std::size_t index = 0;
  const auto [end, error] = std::from_chars(step.data(), step.data() + step.size(), index);
  if (error != std::errc() || end != step.data() + step.size()) return std::nullopt;
  return index;
}

// Short forms grow into the objects they stand for, so that `fabric.bend` can be set where the file says "denim".
void lengthen(json& value, std::string_view key) {
  if (key == "fabric" && value.is_string())
    value = std::move(object_of("preset", value).root);
  else if (key == "tethers" && value.is_boolean() && value.get<bool>())
    value = json::object();
  else if (key == "contacts" && value.is_boolean())
    value = std::move(object_of("enabled", value).root);
  else if (value.is_null())
    value = json::object();
}

}  // namespace

Result<void> assign(json& scene, const Assignment& assignment) {
  const std::string whole = "--set " + printable(assignment.path, 120);
  if (assignment.path.size() > kLongestPath)
    return fail(whole, ": a path of ", assignment.path.size(), " bytes is longer than ", kLongestPath);
  if (assignment.value.size() > kLongestValue)
    return fail(whole, ": a value of ", assignment.value.size(), " bytes is longer than ", kLongestValue);
  const auto steps = steps_of(assignment.path);
  if (!steps) return fail(whole, ": is not a path such as solver.substeps or cloths[0].fabric");

  json* target = &scene;
  std::string walked;
  for (const std::string& step : *steps) {
    if (target->is_array()) {
      const auto index = index_of(step);
      if (!index) return fail(walked, ": is a list, and \"", printable(step), "\" is no index into it (", whole, ")");
      if (*index >= target->size())
        return fail(walked, "[", *index, "]: is not there, the length of the list is ", target->size(), " (", whole, ")");
      target = &(*target)[*index];
      walked.append("[").append(step).append("]");
    } else if (target->is_object()) {
      target = &(*target)[step];
      walked.append(walked.empty() ? "" : ".").append(printable(step, 120));
    } else {
      return fail(walked.empty() ? "scene" : walked, ": is ", kind_of(*target), " and holds no \"", printable(step), "\" (", whole, ")");
    }
    if (&step != &steps->back()) lengthen(*target, step);
  }

  // What is not JSON is text; so is what the scene's own parser would refuse, such as brackets without end.
  Result<JsonTree> value = parse_json(assignment.value);
  JsonTree put(value ? std::move(value->root) : json(assignment.value));
  target->swap(put.root);
  return {};
}

}  // namespace weft
