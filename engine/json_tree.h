// JSON values that go away without asking for memory. nlohmann's destructor makes a list of a value's children first; where there is no
// memory for that list the program would end. Internal.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <utility>

namespace weft {

/// Empties lists and objects from the innermost on. It calls itself: what is read nests at most 64 deep.
inline void take_apart(nlohmann::json& value) noexcept {
  if (auto* list = value.get_ptr<nlohmann::json::array_t*>()) {
    for (nlohmann::json& entry : *list) take_apart(entry);
    list->clear();
  } else if (auto* object = value.get_ptr<nlohmann::json::object_t*>()) {
    for (auto& [key, member] : *object) take_apart(member);
    object->clear();
  }
}

/// Whether the value is this text. (`value == "text"` makes a value of the text, and promises not to throw.)
inline bool is_text(const nlohmann::json& value, std::string_view text) {
  const auto* held = value.get_ptr<const std::string*>();
  return held != nullptr && *held == text;
}

/// Owns a value that may have children.
struct JsonTree {
  nlohmann::json root;

  JsonTree() = default;
  JsonTree(nlohmann::json&& value) noexcept : root(std::move(value)) {}
  JsonTree(JsonTree&& other) noexcept = default;
  JsonTree& operator=(JsonTree&& other) noexcept {
    root.swap(other.root);
    return *this;
  }
  ~JsonTree() { take_apart(root); }
};

/// The value of a text; discarded if it is not JSON.
inline JsonTree parsed_json(std::string_view text) {
  JsonTree tree;
  nlohmann::detail::json_sax_dom_parser<nlohmann::json> parser(tree.root, false);
  if (!nlohmann::json::sax_parse(text, &parser)) {
    take_apart(tree.root);
    tree.root = nlohmann::json(nlohmann::json::value_t::discarded);
  }
  return tree;
}

/// Sets a member, making room for it before it is copied or moved.
template <class V>
void put(JsonTree& object, const std::string& key, V&& value) {
  nlohmann::json& place = object.root[key];
  if constexpr (requires { value.root; }) place = std::move(value.root);
  else place = std::forward<V>(value);
}

/// `object_of("buffer", 0, "byteLength", 12)`: of keys and values or trees. An object in braces would make lists of its members, and drop
/// them; a null that becomes an object by its first key is broken where there is no memory for that.
template <class... Members>
JsonTree object_of(Members&&... members) {
  JsonTree tree(nlohmann::json::object());
  const auto add = [&](auto& self, const char* key, auto&& value, auto&&... rest) -> void {
    put(tree, key, std::forward<decltype(value)>(value));
    if constexpr (sizeof...(rest) > 0) self(self, std::forward<decltype(rest)>(rest)...);
  };
  add(add, std::forward<Members>(members)...);
  return tree;
}

/// A list of one value.
inline JsonTree list_of(JsonTree value) {
  JsonTree tree(nlohmann::json::array());
  tree.root.push_back(std::move(value.root));
  return tree;
}

}  // namespace weft
