// Rules for several keys of one object together, which a table of single keys cannot express. Internal.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include "engine/scene.h"
#include "engine/scene/faults.h"

namespace weft {

/// An object as it was read, or as a program made it. JSON tells which keys its author wrote, since a value may be there by default.
struct Read {
  const nlohmann::json* json;   // null: made by a program
  const std::string& path;
  Faults& faults;

  /// Whether the author gave it; for a program's objects `given` says so.
  bool has(std::string_view key, bool given) const { return json != nullptr ? json->contains(key) : given; }
};

void check(const Read& read, const Anchor::Box& box);
void check(const Read& read, const Anchor& anchor);
void check(const Read& read, const Cloth& cloth);
void check(const Read& read, const Collider& collider);
void check(const Read& read, const Camera& camera);
void check(const Read& read, const Scene& scene);

/// Objects without such rules.
template <class T>
void check(const Read&, const T&) {}

/// Keys must follow one another in time.
void check_times(const std::string& path, const std::vector<Key>& keys, Faults& faults);

}  // namespace weft
