// A value, or a sentence that says what is wrong.
//
// Everything that can fail at create, load or submit returns a Result. The sentence names the thing, the value it had
// and the limit it broke, so that it can be shown to a user as it is. No exception crosses Weft's API.
#pragma once

#include <cassert>
#include <optional>
#include <sstream>
#include <string>
#include <utility>
#include <variant>

namespace weft {

struct Error {
  std::string message;
};

/// Joins its arguments into one sentence: `return fail("sphere radius ", r, " m is not above 0");`
template <class... Parts>
[[nodiscard]] Error fail(const Parts&... parts) {
  std::ostringstream text;
  (text << ... << parts);
  return Error{text.str()};
}

template <class T>
class [[nodiscard]] Result {
 public:
  Result(T value) : held_(std::in_place_index<0>, std::move(value)) {}
  Result(Error error) : held_(std::in_place_index<1>, std::move(error)) {}

  explicit operator bool() const { return held_.index() == 0; }
  T& operator*() { return value(); }
  const T& operator*() const { return value(); }
  T* operator->() { return &value(); }
  const T* operator->() const { return &value(); }

  T& value() {
    assert(held_.index() == 0);
    return *std::get_if<0>(&held_);
  }
  const T& value() const {
    assert(held_.index() == 0);
    return *std::get_if<0>(&held_);
  }
  /// The sentence; only when there is no value.
  const std::string& error() const {
    assert(held_.index() == 1);
    return std::get_if<1>(&held_)->message;
  }
  Error take_error() { return std::move(*std::get_if<1>(&held_)); }

 private:
  std::variant<T, Error> held_;
};

template <>
class [[nodiscard]] Result<void> {
 public:
  Result() = default;
  Result(Error error) : error_(std::move(error.message)) {}

  explicit operator bool() const { return !error_; }
  const std::string& error() const {
    assert(error_);
    return *error_;
  }
  Error take_error() { return Error{std::move(*error_)}; }

 private:
  std::optional<std::string> error_;
};

}  // namespace weft
