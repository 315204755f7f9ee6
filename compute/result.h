// A value, or a sentence that says what is wrong.
//
// Everything that can fail at create, load or submit returns a Result. The sentence names the thing, the value it had
// and the limit it broke, so that it can be shown to a user as it is. No exception crosses Weft's API.
#pragma once

#include <cassert>
#include <exception>
#include <new>
#include <optional>
#include <ostream>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <variant>

#include "compute/text.h"

namespace weft {

/// What a program can do about it; the sentence is for people.
enum class ErrorKind {
  input,         // what was given cannot be used: change it
  memory,        // the host's or the device's memory has run out: ask for less, or again later
  device_lost,   // everything on this device is gone: make it anew
  other          // a driver, a file system or a device that has not what it takes
};

struct Error {
  std::string message;
  ErrorKind kind = ErrorKind::input;
};
inline std::ostream& operator<<(std::ostream& out, const Error& error) { return out << error.message; }

namespace detail {
inline void add_part(TextStream&, Error& error, ErrorKind kind) { error.kind = kind; }
inline void add_part(TextStream& text, Error& error, const Error& cause) {
  text << cause.message;
  error.kind = cause.kind;
}
template <class Part>
void add_part(TextStream& text, Error& error, const Part& part) {
  if constexpr (requires { part.error_kind(); }) error.kind = part.error_kind();
  text << part;
}
}  // namespace detail

/// Joins its arguments into one sentence: `return fail("sphere radius ", r, " m is not above 0");` Its kind is that of the
/// error, of the Vulkan result or of the ErrorKind among them; without one, input.
template <class... Parts>
[[nodiscard]] Error fail(const Parts&... parts) {
  TextStream text;
  Error error;
  (detail::add_part(text, error, parts), ...);
  error.message = text.str();
  return error;
}

/// In a catch (...) block: what was thrown, as an error about `what`. Public functions end in one. Where there is no memory for a
/// sentence, it is one that needs none.
inline Error caught(std::string_view what) noexcept try {
  try {
    throw;
  } catch (const std::bad_alloc&) {
    return fail(ErrorKind::memory, what, ": there is not enough memory");
  } catch (const std::length_error&) {
    return fail(ErrorKind::memory, what, ": has more elements than any memory holds");
  } catch (const std::exception& problem) {
    return fail(ErrorKind::other, what, ": ", problem.what());
  }
} catch (...) {
  return {"out of memory", ErrorKind::memory};
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
  /// The sentence and its kind, to be part of another: `fail("cloth ", k, ": ", mesh.why())`.
  const Error& why() const {
    assert(held_.index() == 1);
    return *std::get_if<1>(&held_);
  }
  ErrorKind kind() const { return why().kind; }
  Error take_error() { return std::move(*std::get_if<1>(&held_)); }

 private:
  std::variant<T, Error> held_;
};

template <>
class [[nodiscard]] Result<void> {
 public:
  Result() = default;
  Result(Error error) : error_(std::move(error)) {}

  explicit operator bool() const { return !error_; }
  const std::string& error() const {
    return why().message;
  }
  const Error& why() const {
    assert(error_);
    return *error_;
  }
  ErrorKind kind() const { return why().kind; }
  Error take_error() { return std::move(*error_); }

 private:
  std::optional<Error> error_;
};

}  // namespace weft
