// Godot as this plug-in sees it: the few dozen functions of its C interface that are needed, a Variant, and calls of methods by name.
//
// The C header is what Godot itself writes (--dump-gdextension-interface), at build time. Methods are called by their names, as a script
// calls them, so that there is no list of hashes that belongs to one version. A call costs about a microsecond: there are some tens a
// frame.
#pragma once

#include <gdextension_interface.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/vector.h"

namespace godot {

using Object = GDExtensionObjectPtr;
using Type = GDExtensionVariantType;

/// Fetches what is used of the interface. False where the Godot that loads the plug-in is too old.
bool load(GDExtensionInterfaceGetProcAddress get, GDExtensionClassLibraryPtr library);
GDExtensionClassLibraryPtr library();
/// A function of the interface, by its name in the header; null where this Godot has none.
GDExtensionInterfaceFunctionPtr function(const char* name);

/// A StringName. Those of literals are made once: name("get_mesh").
class Name {
 public:
  explicit Name(std::string_view text);
  ~Name();
  Name(const Name&) = delete;
  Name& operator=(const Name&) = delete;
  void* data() const { return const_cast<void**>(&held_); }
  bool is(GDExtensionConstStringNamePtr other) const { return *static_cast<void* const*>(other) == held_; }   // equal ones share their text

 private:
  void* held_ = nullptr;
};
const Name& name(std::string_view text);
/// Lets go of all of them; after that nothing of Godot may be called.
void forget_names();

// Values as Godot lays them out, in a build of single precision.
struct Transform {
  float rows[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  weft::Vec3 origin;
  bool operator==(const Transform&) const = default;
};
struct Box {
  weft::Vec3 low, size;
};
struct Colour {
  float r = 1, g = 1, b = 1, a = 1;
};
struct Rid {
  std::uint64_t id = 0;
};
struct Plane {
  weft::Vec3 normal;
  float d = 0;
};

class Variant {
 public:
  Variant();
  ~Variant();
  Variant(const Variant& other);
  Variant& operator=(const Variant& other);
  Variant(Variant&& other) noexcept;
  Variant& operator=(Variant&& other) noexcept;
  explicit Variant(GDExtensionConstVariantPtr other);   // a copy

  Variant(bool value);
  Variant(int value) : Variant(std::int64_t(value)) {}
  Variant(unsigned value) : Variant(std::int64_t(value)) {}
  Variant(std::int64_t value);
  Variant(double value);
  Variant(float value) : Variant(double(value)) {}
  Variant(std::string_view text);
  Variant(const char* text) : Variant(std::string_view(text)) {}
  Variant(const std::string& text) : Variant(std::string_view(text)) {}
  Variant(const Name& value);
  Variant(weft::Vec3 value);
  Variant(const Transform& value);
  Variant(const Box& value);
  Variant(const Colour& value);
  Variant(Rid value);
  /// Holds a reference where it is counted.
  Variant(Object value);
  /// What a type of the interface holds, and back into one that is not initialised.
  static Variant of(Type type, GDExtensionTypePtr value);
  void into(Type type, GDExtensionUninitializedTypePtr value) const;
  /// An empty array, dictionary or the like.
  static Variant empty(Type type);
  /// Packed arrays of so many elements, filled by what follows.
  static Variant packed(std::span<const std::int32_t> values);
  static Variant packed(std::span<const float> values);
  static Variant packed(std::span<const weft::Vec2> values);
  static Variant packed(std::span<const weft::Vec3> values);
  static Variant packed(std::span<const Colour> values);
  static Variant packed(std::span<const std::string> values);

  Type type() const;
  /// As Godot converts it to another type; nil where it does not. Itself where it is of that type, or the type is nil.
  Variant as(Type wanted) const;
  explicit operator bool() const { return to_bool(); }
  bool to_bool() const;
  std::int64_t to_int() const;
  double to_double() const;
  std::string to_string() const;
  weft::Vec3 to_vector3() const;
  Transform to_transform() const;
  Colour to_colour() const;
  Plane to_plane() const;
  Rid to_rid() const;
  /// Null where it is none, or was freed.
  Object to_object() const;
  std::vector<std::int32_t> to_ints() const;
  std::vector<float> to_floats() const;
  std::vector<weft::Vec2> to_vectors2() const;
  std::vector<weft::Vec3> to_vectors3() const;
  std::vector<Colour> to_colours() const;

  /// Calls a method; nil, with a line in Godot's output, where that fails.
  template <class... Arguments>
  Variant call(std::string_view method, const Arguments&... arguments) const {
    const std::array<Variant, sizeof...(Arguments)> values{Variant(arguments)...};
    std::array<const void*, sizeof...(Arguments) + 1> pointers{};
    for (std::size_t k = 0; k < values.size(); ++k) pointers[k] = values[k].data();
    return call_with(method, {pointers.data(), values.size()});
  }
  Variant call_with(std::string_view method, std::span<const void* const> arguments) const;

  void* data() const { return const_cast<std::byte*>(held_); }

 private:
  template <class T>
  static Variant filled(Type type, const char* at, std::span<const T> values);
  template <class T>
  std::vector<T> elements(Type type, const char* at) const;
  alignas(8) std::byte held_[40]{};   // 24 are used in single precision
};

Variant singleton(std::string_view name);
/// An object of a class of Godot's.
Variant make(std::string_view type);
/// Whether an object is of a class, or of one that inherits it.
bool is(Object object, std::string_view type);
std::uint64_t id_of(Object object);
/// Null where it was freed.
Object object_of(std::uint64_t id);
/// A Callable.
Variant callable(std::function<void(std::span<const Variant>)> function);

void print_warning(const std::string& sentence);
void print_error(const std::string& sentence);

}  // namespace godot
