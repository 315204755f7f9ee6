// See samples/godot/godot.h.
#include "samples/godot/godot.h"

#include <cstring>
#include <map>
#include <memory>
#include <mutex>

namespace godot {
namespace {

GDExtensionInterfaceGetProcAddress fetch = nullptr;
GDExtensionClassLibraryPtr own_library = nullptr;

// Those that every call needs.
struct {
  GDExtensionInterfaceStringNameNewWithUtf8CharsAndLen new_name;
  GDExtensionInterfaceStringNewWithUtf8CharsAndLen new_string;
  GDExtensionInterfaceStringToUtf8Chars string_to_utf8;
  GDExtensionInterfaceVariantCall call;
  GDExtensionInterfaceVariantConstruct construct;
  GDExtensionInterfaceVariantDestroy destroy;
  GDExtensionInterfaceVariantNewCopy copy;
  GDExtensionInterfaceVariantNewNil nil;
  GDExtensionInterfaceVariantGetType type;
  GDExtensionInterfaceGetVariantFromTypeConstructor from_type;
  GDExtensionInterfaceGetVariantToTypeConstructor to_type;
  GDExtensionInterfaceGetVariantGetInternalPtrFunc inside;
  GDExtensionInterfaceVariantGetPtrDestructor destructor;
  GDExtensionInterfaceGlobalGetSingleton singleton;
  GDExtensionInterfaceObjectGetInstanceId id_of;
  GDExtensionInterfaceObjectGetInstanceFromId object_of;
  GDExtensionInterfaceVariantGetObjectInstanceId object_id;
  GDExtensionInterfaceCallableCustomCreate2 new_callable;
  GDExtensionInterfacePrintWarningWithMessage warn;
  GDExtensionInterfacePrintErrorWithMessage err;
} api;

// By any thread: Godot may draw on one of its own.
struct Names {
  std::mutex mutex;
  std::map<std::string, std::unique_ptr<Name>, std::less<>> made;
};
Names& names() {
  static Names kept;
  return kept;
}

template <class T>
Variant held(Type type, const T& value) {
  T copy = value;
  return Variant::of(type, &copy);
}

template <class T>
T taken(const Variant& variant, Type type) {
  T value{};
  if (variant.type() == type) variant.into(type, &value);
  return value;
}

using Function = std::function<void(std::span<const Variant>)>;

void call_function(void* held, const GDExtensionConstVariantPtr* arguments, GDExtensionInt count, GDExtensionVariantPtr result,
                   GDExtensionCallError* error) {
  std::vector<Variant> values;
  for (GDExtensionInt k = 0; k < count; ++k) values.emplace_back(arguments[k]);
  (*static_cast<Function*>(held))(values);
  api.nil(result);
  error->error = GDEXTENSION_CALL_OK;
}

}  // namespace

bool load(GDExtensionInterfaceGetProcAddress get, GDExtensionClassLibraryPtr library) {
  fetch = get;
  own_library = library;
  bool whole = true;
  const auto take = [&whole](auto& function, const char* name) {
    function = reinterpret_cast<std::remove_reference_t<decltype(function)>>(fetch(name));
    whole &= function != nullptr;
  };
  take(api.new_name, "string_name_new_with_utf8_chars_and_len");
  take(api.new_string, "string_new_with_utf8_chars_and_len");
  take(api.string_to_utf8, "string_to_utf8_chars");
  take(api.call, "variant_call");
  take(api.construct, "variant_construct");
  take(api.destroy, "variant_destroy");
  take(api.copy, "variant_new_copy");
  take(api.nil, "variant_new_nil");
  take(api.type, "variant_get_type");
  take(api.from_type, "get_variant_from_type_constructor");
  take(api.to_type, "get_variant_to_type_constructor");
  take(api.inside, "variant_get_ptr_internal_getter");
  take(api.destructor, "variant_get_ptr_destructor");
  take(api.singleton, "global_get_singleton");
  take(api.id_of, "object_get_instance_id");
  take(api.object_of, "object_get_instance_from_id");
  take(api.object_id, "variant_get_object_instance_id");
  take(api.new_callable, "callable_custom_create2");
  take(api.warn, "print_warning_with_message");
  take(api.err, "print_error_with_message");
  return whole;
}

GDExtensionClassLibraryPtr library() { return own_library; }
GDExtensionInterfaceFunctionPtr function(const char* name) { return fetch(name); }

Name::Name(std::string_view text) { api.new_name(&held_, text.data(), static_cast<GDExtensionInt>(text.size())); }
Name::~Name() { api.destructor(GDEXTENSION_VARIANT_TYPE_STRING_NAME)(&held_); }

const Name& name(std::string_view text) {
  const std::lock_guard lock(names().mutex);
  const auto found = names().made.find(text);
  if (found != names().made.end()) return *found->second;
  return *names().made.emplace(text, std::make_unique<Name>(text)).first->second;
}

void forget_names() { names().made.clear(); }

Variant::Variant() { api.nil(held_); }
Variant::~Variant() { api.destroy(held_); }
Variant::Variant(const Variant& other) { api.copy(held_, other.held_); }
Variant& Variant::operator=(const Variant& other) {
  if (this != &other) api.destroy(held_), api.copy(held_, other.held_);
  return *this;
}
// A Variant may be moved as its bytes are.
Variant::Variant(Variant&& other) noexcept {
  std::memcpy(held_, other.held_, sizeof held_);
  api.nil(other.held_);
}
Variant& Variant::operator=(Variant&& other) noexcept {
  if (this == &other) return *this;
  api.destroy(held_);
  std::memcpy(held_, other.held_, sizeof held_);
  api.nil(other.held_);
  return *this;
}
Variant::Variant(GDExtensionConstVariantPtr other) { api.copy(held_, other); }

Variant::Variant(bool value) : Variant(held(GDEXTENSION_VARIANT_TYPE_BOOL, GDExtensionBool(value))) {}
Variant::Variant(std::int64_t value) : Variant(held(GDEXTENSION_VARIANT_TYPE_INT, value)) {}
Variant::Variant(double value) : Variant(held(GDEXTENSION_VARIANT_TYPE_FLOAT, value)) {}
Variant::Variant(std::string_view text) {
  void* string = nullptr;
  api.new_string(&string, text.data(), static_cast<GDExtensionInt>(text.size()));
  api.from_type(GDEXTENSION_VARIANT_TYPE_STRING)(held_, &string);
  api.destructor(GDEXTENSION_VARIANT_TYPE_STRING)(&string);
}
Variant::Variant(const Name& value) { api.from_type(GDEXTENSION_VARIANT_TYPE_STRING_NAME)(held_, value.data()); }
Variant::Variant(weft::Vec3 value) : Variant(held(GDEXTENSION_VARIANT_TYPE_VECTOR3, value)) {}
Variant::Variant(const Transform& value) : Variant(held(GDEXTENSION_VARIANT_TYPE_TRANSFORM3D, value)) {}
Variant::Variant(const Box& value) : Variant(held(GDEXTENSION_VARIANT_TYPE_AABB, value)) {}
Variant::Variant(const Colour& value) : Variant(held(GDEXTENSION_VARIANT_TYPE_COLOR, value)) {}
Variant::Variant(Rid value) : Variant(held(GDEXTENSION_VARIANT_TYPE_RID, value)) {}
Variant::Variant(Object value) : Variant(held(GDEXTENSION_VARIANT_TYPE_OBJECT, value)) {}

Variant Variant::of(Type type, GDExtensionTypePtr value) {
  Variant made;
  if (type == GDEXTENSION_VARIANT_TYPE_NIL) api.copy(made.held_, value);   // a Variant is its own type
  else api.from_type(type)(made.held_, value);
  return made;
}
void Variant::into(Type type, GDExtensionUninitializedTypePtr value) const {
  if (type == GDEXTENSION_VARIANT_TYPE_NIL) api.copy(value, held_);
  else api.to_type(type)(value, data());
}
Variant Variant::empty(Type type) {
  Variant made;
  GDExtensionCallError error;
  api.construct(type, made.held_, nullptr, 0, &error);
  return made;
}

template <class T>
Variant Variant::filled(Type type, const char* at, std::span<const T> values) {
  Variant made = empty(type);
  made.call("resize", std::int64_t(values.size()));
  using At =
      GDExtensionTypePtr (*)(GDExtensionTypePtr, GDExtensionInt);   // those of numbers return pointers to them, which are passed alike
  if (values.empty()) return made;
  void* to = reinterpret_cast<At>(fetch(at))(api.inside(type)(made.held_), 0);
  std::memcpy(to, values.data(), values.size_bytes());
  return made;
}

Variant Variant::packed(std::span<const std::int32_t> values) {
  return filled(GDEXTENSION_VARIANT_TYPE_PACKED_INT32_ARRAY, "packed_int32_array_operator_index", values);
}
Variant Variant::packed(std::span<const float> values) {
  return filled(GDEXTENSION_VARIANT_TYPE_PACKED_FLOAT32_ARRAY, "packed_float32_array_operator_index", values);
}
Variant Variant::packed(std::span<const weft::Vec2> values) {
  return filled(GDEXTENSION_VARIANT_TYPE_PACKED_VECTOR2_ARRAY, "packed_vector2_array_operator_index", values);
}
Variant Variant::packed(std::span<const weft::Vec3> values) {
  return filled(GDEXTENSION_VARIANT_TYPE_PACKED_VECTOR3_ARRAY, "packed_vector3_array_operator_index", values);
}
Variant Variant::packed(std::span<const Colour> values) {
  return filled(GDEXTENSION_VARIANT_TYPE_PACKED_COLOR_ARRAY, "packed_color_array_operator_index", values);
}
Variant Variant::packed(std::span<const std::string> values) {
  Variant made = empty(GDEXTENSION_VARIANT_TYPE_PACKED_STRING_ARRAY);
  for (const std::string& value : values) made.call("append", value);
  return made;
}

Type Variant::type() const { return api.type(held_); }
Variant Variant::as(Type wanted) const {
  if (wanted == GDEXTENSION_VARIANT_TYPE_NIL || wanted == type()) return *this;
  Variant made;
  const void* from[] = {held_};
  GDExtensionCallError error{};
  api.construct(wanted, made.held_, from, 1, &error);
  return error.error == GDEXTENSION_CALL_OK ? made : Variant();
}
bool Variant::to_bool() const {
  GDExtensionBool value = 0;
  into(GDEXTENSION_VARIANT_TYPE_BOOL, &value);
  return value != 0;
}
std::int64_t Variant::to_int() const {
  std::int64_t value = 0;
  into(GDEXTENSION_VARIANT_TYPE_INT, &value);
  return value;
}
double Variant::to_double() const {
  double value = 0;
  into(GDEXTENSION_VARIANT_TYPE_FLOAT, &value);
  return value;
}
std::string Variant::to_string() const {
  void* string = nullptr;
  into(GDEXTENSION_VARIANT_TYPE_STRING, &string);
  std::string text(static_cast<std::size_t>(api.string_to_utf8(&string, nullptr, 0)), '\0');
  api.string_to_utf8(&string, text.data(), static_cast<GDExtensionInt>(text.size()));
  api.destructor(GDEXTENSION_VARIANT_TYPE_STRING)(&string);
  return text;
}
weft::Vec3 Variant::to_vector3() const { return taken<weft::Vec3>(*this, GDEXTENSION_VARIANT_TYPE_VECTOR3); }
Transform Variant::to_transform() const { return taken<Transform>(*this, GDEXTENSION_VARIANT_TYPE_TRANSFORM3D); }
Colour Variant::to_colour() const { return taken<Colour>(*this, GDEXTENSION_VARIANT_TYPE_COLOR); }
Plane Variant::to_plane() const { return taken<Plane>(*this, GDEXTENSION_VARIANT_TYPE_PLANE); }
Rid Variant::to_rid() const { return taken<Rid>(*this, GDEXTENSION_VARIANT_TYPE_RID); }
Object Variant::to_object() const {
  if (type() != GDEXTENSION_VARIANT_TYPE_OBJECT) return nullptr;
  const GDObjectInstanceID id = api.object_id(held_);
  return id != 0 ? api.object_of(id) : nullptr;
}

template <class T>
std::vector<T> Variant::elements(Type type, const char* at) const {
  if (this->type() != type) return {};
  std::vector<T> values(static_cast<std::size_t>(call("size").to_int()));
  if (values.empty()) return values;
  using At = GDExtensionTypePtr (*)(GDExtensionConstTypePtr, GDExtensionInt);
  std::memcpy(values.data(), reinterpret_cast<At>(fetch(at))(api.inside(type)(data()), 0), values.size() * sizeof(T));
  return values;
}

std::vector<std::int32_t> Variant::to_ints() const {
  return elements<std::int32_t>(GDEXTENSION_VARIANT_TYPE_PACKED_INT32_ARRAY, "packed_int32_array_operator_index_const");
}
std::vector<float> Variant::to_floats() const {
  return elements<float>(GDEXTENSION_VARIANT_TYPE_PACKED_FLOAT32_ARRAY, "packed_float32_array_operator_index_const");
}
std::vector<weft::Vec2> Variant::to_vectors2() const {
  return elements<weft::Vec2>(GDEXTENSION_VARIANT_TYPE_PACKED_VECTOR2_ARRAY, "packed_vector2_array_operator_index_const");
}
std::vector<weft::Vec3> Variant::to_vectors3() const {
  return elements<weft::Vec3>(GDEXTENSION_VARIANT_TYPE_PACKED_VECTOR3_ARRAY, "packed_vector3_array_operator_index_const");
}
std::vector<Colour> Variant::to_colours() const {
  return elements<Colour>(GDEXTENSION_VARIANT_TYPE_PACKED_COLOR_ARRAY, "packed_color_array_operator_index_const");
}

Variant Variant::call_with(std::string_view method, std::span<const void* const> arguments) const {
  Variant result;
  GDExtensionCallError error{};
  api.call(data(), name(method).data(), arguments.data(), static_cast<GDExtensionInt>(arguments.size()), result.data(), &error);
  if (error.error != GDEXTENSION_CALL_OK) {
    print_error("Weft cannot call the method " + std::string(method) + " of Godot (error " + std::to_string(error.error) + ")");
    return {};
  }
  return result;
}

Variant singleton(std::string_view which) { return Variant(Object(api.singleton(name(which).data()))); }
Variant make(std::string_view type) { return singleton("ClassDB").call("instantiate", name(type)); }
bool is(Object object, std::string_view type) { return object != nullptr && Variant(object).call("is_class", type).to_bool(); }
std::uint64_t id_of(Object object) { return object != nullptr ? api.id_of(object) : 0; }
Object object_of(std::uint64_t id) { return id != 0 ? api.object_of(id) : nullptr; }

Variant callable(Function function) {
  GDExtensionCallableCustomInfo2 info{};
  info.callable_userdata = new Function(std::move(function));
  info.token = own_library;
  info.call_func = call_function;
  info.free_func = [](void* held) { delete static_cast<Function*>(held); };
  std::array<std::uint64_t, 2> made{};
  api.new_callable(made.data(), &info);
  Variant result = Variant::of(GDEXTENSION_VARIANT_TYPE_CALLABLE, made.data());
  api.destructor(GDEXTENSION_VARIANT_TYPE_CALLABLE)(made.data());
  return result;
}

void print_warning(const std::string& sentence) { api.warn(sentence.c_str(), sentence.c_str(), "weft", "weft", 0, true); }
void print_error(const std::string& sentence) { api.err(sentence.c_str(), sentence.c_str(), "weft", "weft", 0, true); }

}  // namespace godot
