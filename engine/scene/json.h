// Scene text to JSON values, and JSON values to words. Internal.
#pragma once

#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <string_view>

#include "compute/result.h"
#include "engine/json_tree.h"
#include "engine/scene.h"

namespace weft {

inline constexpr std::size_t kLargestSceneBytes = std::size_t{64} << 20;
inline constexpr std::size_t kDeepestNesting = 64;

/// Strict JSON (no comments, no key twice in one object) of at most kLargestSceneBytes, nested at most kDeepestNesting deep.
/// An error is one sentence that starts with the line and the column.
Result<JsonTree> parse_json(std::string_view text);

/// A value as a sentence shows it: `"ten" is text`, `-3`, `a list`. Never longer than about 60 bytes.
std::string shown(const nlohmann::json& value);

/// What kind of value it is: "text", "a list", "null" ...
std::string_view kind_of(const nlohmann::json& value);

/// Puts `assignment` into `scene`, making objects on the way where there are none. An error is a sentence.
Result<void> assign(nlohmann::json& scene, const Assignment& assignment);

}  // namespace weft
