// See samples/godot/classes.h.
#include "samples/godot/classes.h"

#include <algorithm>
#include <map>
#include <memory>
#include <mutex>

namespace godot {
namespace {

// What Godot hands back with each call.
struct Registered {
  const Class* described;
  std::vector<const Property*> properties;        // by index, all groups together
  std::vector<std::unique_ptr<Method>> methods;   // with those that properties are read and written by
};

std::vector<std::unique_ptr<Registered>>& classes() {
  static std::vector<std::unique_ptr<Registered>> all;
  return all;
}

// Objects by their ids: Godot does not tell a plug-in what it has behind an object of another's.
struct Alive {
  std::mutex mutex;
  std::map<Object, Instance*> instances;
};
Alive& alive() {
  static Alive all;
  return all;
}

// A GDExtensionPropertyInfo with what it points to.
struct Info {
  Info(Type type, std::string_view name, Hint hint = Hint::none, std::string_view hint_text = "", std::uint32_t usage = kStored | kEdited,
       std::string_view type_name = "")
      : name_(name), class_(type_name), hint_(hint_text) {
    hint_.into(GDEXTENSION_VARIANT_TYPE_STRING, &hint_string_);
    info = {type, name_.data(), class_.data(), static_cast<std::uint32_t>(hint), &hint_string_, usage};
  }
  ~Info() {
    const auto destructor = reinterpret_cast<GDExtensionInterfaceVariantGetPtrDestructor>(function("variant_get_ptr_destructor"));
    destructor(GDEXTENSION_VARIANT_TYPE_STRING)(&hint_string_);
  }
  Info(const Info&) = delete;
  Info& operator=(const Info&) = delete;
  GDExtensionPropertyInfo info{};

 private:
  Name name_, class_;
  Variant hint_;
  void* hint_string_ = nullptr;
};

Info info_of(const Argument& argument) {
  const bool any = argument.type == GDEXTENSION_VARIANT_TYPE_NIL;   // PROPERTY_USAGE_NIL_IS_VARIANT
  return Info(argument.type, argument.name, Hint::none, "", kStored | kEdited | (any ? 1u << 17 : 0));
}

GDExtensionObjectPtr create(void* held, GDExtensionBool notify) {
  const Registered& registered = *static_cast<const Registered*>(held);
  static const auto construct = reinterpret_cast<GDExtensionInterfaceClassdbConstructObject2>(function("classdb_construct_object2"));
  static const auto set_instance = reinterpret_cast<GDExtensionInterfaceObjectSetInstance>(function("object_set_instance"));
  const Object object = construct(name(registered.described->parent).data());
  Instance* instance = registered.described->create(object);
  {
    const std::lock_guard lock(alive().mutex);
    alive().instances[object] = instance;
  }
  set_instance(object, name(registered.described->name).data(), instance);
  if (notify) {   // without a Variant: it would count references of what has none yet
    static const auto bind = reinterpret_cast<GDExtensionInterfaceClassdbGetMethodBind>(function("classdb_get_method_bind"));
    static const auto call = reinterpret_cast<GDExtensionInterfaceObjectMethodBindPtrcall>(function("object_method_bind_ptrcall"));
    if (const auto notification = bind(name("Object").data(), name("notification").data(), 4023243586)) {
      const std::int64_t post_initialise = 0;
      const GDExtensionBool reversed = 0;
      const GDExtensionConstTypePtr arguments[] = {&post_initialise, &reversed};
      call(notification, object, arguments, nullptr);
    }
  }
  return object;
}

void free_instance(void*, GDExtensionClassInstancePtr held) {
  Instance* instance = static_cast<Instance*>(held);
  {
    const std::lock_guard lock(alive().mutex);
    alive().instances.erase(instance->self());
  }
  delete instance;
}

void warn(GDExtensionClassInstancePtr held, const GDExtensionConstTypePtr*, GDExtensionTypePtr result) {
  const std::vector<std::string> sentences = static_cast<Instance*>(held)->warnings();
  Variant::packed(std::span(sentences)).into(GDEXTENSION_VARIANT_TYPE_PACKED_STRING_ARRAY, result);
}

GDExtensionClassCallVirtual virtual_of(void*, GDExtensionConstStringNamePtr wanted, std::uint32_t) {
  return name("_get_configuration_warnings").is(wanted) ? warn : nullptr;
}

GDExtensionBool validate(GDExtensionClassInstancePtr held, GDExtensionPropertyInfo* property) {
  Variant asked = Variant::of(GDEXTENSION_VARIANT_TYPE_STRING_NAME, property->name);
  if (!static_cast<Instance*>(held)->shows(asked.to_string())) property->usage &= ~kEdited;
  if (!static_cast<Instance*>(held)->saves(asked.to_string())) property->usage &= ~kStored;
  return true;
}

bool gives(const Method& method) { return method.gives_any || method.result != GDEXTENSION_VARIANT_TYPE_NIL; }

void call_method(void* held, GDExtensionClassInstancePtr instance, const GDExtensionConstVariantPtr* arguments, GDExtensionInt count,
                 GDExtensionVariantPtr result, GDExtensionCallError* error) {
  const Method& method = *static_cast<const Method*>(held);
  const auto wanted = static_cast<GDExtensionInt>(method.arguments.size());
  if (count != wanted) {
    error->error = count < wanted ? GDEXTENSION_CALL_ERROR_TOO_FEW_ARGUMENTS : GDEXTENSION_CALL_ERROR_TOO_MANY_ARGUMENTS;
    error->expected = static_cast<std::int32_t>(wanted);
    return;
  }
  std::vector<Variant> values;
  for (GDExtensionInt k = 0; k < count; ++k) {
    const Type type = method.arguments[static_cast<std::size_t>(k)].type;
    values.push_back(Variant(arguments[k]).as(type));   // a script may give an Array of numbers
    if (type == GDEXTENSION_VARIANT_TYPE_NIL || values.back().type() == type) continue;
    error->error = GDEXTENSION_CALL_ERROR_INVALID_ARGUMENT;
    error->argument = static_cast<std::int32_t>(k);
    error->expected = static_cast<std::int32_t>(type);
    return;
  }
  Variant given = method.run(*static_cast<Instance*>(instance), values);
  static const auto copy = reinterpret_cast<GDExtensionInterfaceVariantNewCopy>(function("variant_new_copy"));
  copy(result, given.data());
  error->error = GDEXTENSION_CALL_OK;
}

void call_typed(void* held, GDExtensionClassInstancePtr instance, const GDExtensionConstTypePtr* arguments, GDExtensionTypePtr result) {
  const Method& method = *static_cast<const Method*>(held);
  std::vector<Variant> values;
  for (std::size_t k = 0; k < method.arguments.size(); ++k)
    values.push_back(Variant::of(method.arguments[k].type, const_cast<GDExtensionTypePtr>(arguments[k])));
  const Variant given = method.run(*static_cast<Instance*>(instance), values);
  if (gives(method) && result != nullptr) given.into(method.result, result);
}

void register_method(const Registered& registered, const Method& method) {
  static const auto add =
      reinterpret_cast<GDExtensionInterfaceClassdbRegisterExtensionClassMethod>(function("classdb_register_extension_class_method"));
  std::vector<std::unique_ptr<Info>> held;
  std::vector<GDExtensionPropertyInfo> arguments;
  for (const Argument& argument : method.arguments) {
    held.push_back(std::unique_ptr<Info>(new Info(info_of(argument))));
    arguments.push_back(held.back()->info);
  }
  std::vector<GDExtensionClassMethodArgumentMetadata> metadata(arguments.size(), GDEXTENSION_METHOD_ARGUMENT_METADATA_NONE);
  Info result = info_of({"", method.result});
  const Name called(method.name);
  GDExtensionClassMethodInfo info{};
  info.name = called.data();
  info.method_userdata = const_cast<Method*>(&method);
  info.call_func = call_method;
  info.ptrcall_func = call_typed;
  info.method_flags = GDEXTENSION_METHOD_FLAGS_DEFAULT;
  info.has_return_value = gives(method);
  info.return_value_info = gives(method) ? &result.info : nullptr;
  info.argument_count = static_cast<std::uint32_t>(arguments.size());
  info.arguments_info = arguments.data();
  info.arguments_metadata = metadata.data();
  add(library(), name(registered.described->name).data(), &info);
}

// All properties are read and written by two methods, which are told their number.
void register_properties(Registered& registered) {
  const Class& described = *registered.described;
  for (const Group& group : described.groups)
    for (const Property& property : group.properties) registered.properties.push_back(&property);
  const auto all = &registered.properties;
  registered.methods.push_back(std::make_unique<Method>(Method{"get_value",
                                                               {{"index", GDEXTENSION_VARIANT_TYPE_INT}},
                                                               GDEXTENSION_VARIANT_TYPE_NIL,
                                                               "Used by the properties.",
                                                               [all](Instance& instance, std::span<const Variant> given) -> Variant {
                                                                 const std::int64_t k = given[0].to_int();
                                                                 return k >= 0 && k < std::int64_t(all->size())
                                                                            ? (*all)[std::size_t(k)]->get(instance)
                                                                            : Variant();
                                                               },
                                                               true}));
  register_method(registered, *registered.methods.back());
  registered.methods.push_back(
      std::make_unique<Method>(Method{"set_value",
                                      {{"index", GDEXTENSION_VARIANT_TYPE_INT}, {"value", GDEXTENSION_VARIANT_TYPE_NIL}},
                                      GDEXTENSION_VARIANT_TYPE_NIL,
                                      "Used by the properties.",
                                      [all](Instance& instance, std::span<const Variant> given) -> Variant {
                                        const std::int64_t k = given[0].to_int();
                                        if (k >= 0 && k < std::int64_t(all->size())) (*all)[std::size_t(k)]->set(instance, given[1]);
                                        return {};
                                      }}));
  register_method(registered, *registered.methods.back());

  static const auto add = reinterpret_cast<GDExtensionInterfaceClassdbRegisterExtensionClassPropertyIndexed>(
      function("classdb_register_extension_class_property_indexed"));
  static const auto head = reinterpret_cast<GDExtensionInterfaceClassdbRegisterExtensionClassPropertyGroup>(
      function("classdb_register_extension_class_property_group"));
  GDExtensionInt index = 0;
  for (const Group& group : described.groups) {
    const Variant title(group.name), prefix(group.prefix);
    void *title_text = nullptr, *prefix_text = nullptr;
    title.into(GDEXTENSION_VARIANT_TYPE_STRING, &title_text);
    prefix.into(GDEXTENSION_VARIANT_TYPE_STRING, &prefix_text);
    head(library(), name(described.name).data(), &title_text, &prefix_text);
    const auto destructor = reinterpret_cast<GDExtensionInterfaceVariantGetPtrDestructor>(function("variant_get_ptr_destructor"));
    destructor(GDEXTENSION_VARIANT_TYPE_STRING)(&title_text);
    destructor(GDEXTENSION_VARIANT_TYPE_STRING)(&prefix_text);
    for (const Property& property : group.properties) {
      const std::uint32_t usage = (property.stored ? kStored : 0) | kEdited | (property.updates_all ? kUpdatesAll : 0);
      const Info info(property.type, property.name, property.hint, property.hint_text, usage, property.type_name);
      add(library(), name(described.name).data(), &info.info, name("set_value").data(), name("get_value").data(), index++);
    }
  }
}

std::string escaped(std::string_view text) {
  std::string out;
  for (const char c : text) {
    if (c == '&') out += "&amp;";
    else if (c == '<') out += "&lt;";
    else if (c == '>') out += "&gt;";
    else if (c == '"') out += "&quot;";
    else if (c == '[') out += "[lb]";   // the help has BBCode in it
    else if (c == ']') out += "[rb]";
    else out += c;
  }
  return out;
}

const char* type_name(Type type) {
  switch (type) {
    case GDEXTENSION_VARIANT_TYPE_BOOL:
      return "bool";
    case GDEXTENSION_VARIANT_TYPE_INT:
      return "int";
    case GDEXTENSION_VARIANT_TYPE_FLOAT:
      return "float";
    case GDEXTENSION_VARIANT_TYPE_STRING:
      return "String";
    case GDEXTENSION_VARIANT_TYPE_VECTOR3:
      return "Vector3";
    case GDEXTENSION_VARIANT_TYPE_NODE_PATH:
      return "NodePath";
    case GDEXTENSION_VARIANT_TYPE_OBJECT:
      return "Object";
    case GDEXTENSION_VARIANT_TYPE_DICTIONARY:
      return "Dictionary";
    case GDEXTENSION_VARIANT_TYPE_ARRAY:
      return "Array";
    case GDEXTENSION_VARIANT_TYPE_PACKED_INT32_ARRAY:
      return "PackedInt32Array";
    case GDEXTENSION_VARIANT_TYPE_PACKED_VECTOR3_ARRAY:
      return "PackedVector3Array";
    default:
      return "Variant";
  }
}

std::string parameters(const std::vector<Argument>& arguments) {
  std::string out;
  for (std::size_t k = 0; k < arguments.size(); ++k)
    out += "<param index=\"" + std::to_string(k) + "\" name=\"" + arguments[k].name + "\" type=\"" + type_name(arguments[k].type) + "\" />";
  return out;
}

}  // namespace

void register_class(const Class& described) {
  Registered& registered = *classes().emplace_back(std::make_unique<Registered>(Registered{&described, {}, {}}));
  GDExtensionClassCreationInfo4 info{};
  info.is_exposed = true;
  info.create_instance_func = create;
  info.free_instance_func = free_instance;
  info.notification_func = [](GDExtensionClassInstancePtr held, std::int32_t what, GDExtensionBool) {
    static_cast<Instance*>(held)->notified(what);
  };
  info.get_virtual_func = virtual_of;
  info.validate_property_func = validate;
  info.class_userdata = &registered;
  static const auto add =
      reinterpret_cast<GDExtensionInterfaceClassdbRegisterExtensionClass4>(function("classdb_register_extension_class4"));
  add(library(), name(described.name).data(), name(described.parent).data(), &info);
  register_properties(registered);
  for (const Method& method : described.methods) register_method(registered, method);
  static const auto signal =
      reinterpret_cast<GDExtensionInterfaceClassdbRegisterExtensionClassSignal>(function("classdb_register_extension_class_signal"));
  for (const Signal& told : described.signals) {
    std::vector<std::unique_ptr<Info>> held;
    std::vector<GDExtensionPropertyInfo> arguments;
    for (const Argument& argument : told.arguments) {
      held.push_back(std::unique_ptr<Info>(new Info(info_of(argument))));
      arguments.push_back(held.back()->info);
    }
    signal(library(), name(described.name).data(), name(told.name).data(), arguments.data(), static_cast<GDExtensionInt>(arguments.size()));
  }
}

void unregister_classes() {
  const auto remove = reinterpret_cast<GDExtensionInterfaceClassdbUnregisterExtensionClass>(function("classdb_unregister_extension_class"));
  for (auto& registered : classes()) remove(library(), name(registered->described->name).data());
  classes().clear();
}

Instance* instance_of(Object object) {
  const std::lock_guard lock(alive().mutex);
  const auto found = alive().instances.find(object);
  return found == alive().instances.end() ? nullptr : found->second;
}

std::string help_of_classes() {
  std::string out = "<?xml version=\"1.0\" encoding=\"UTF-8\" ?>\n";
  for (const auto& registered : classes()) {
    const Class& described = *registered->described;
    out += "<class name=\"" + described.name + "\" inherits=\"" + described.parent + "\" version=\"4.6\">\n<brief_description>" +
           escaped(described.brief) + "</brief_description>\n<description>" + escaped(described.description) +
           "</description>\n<tutorials></tutorials>\n<methods>\n";
    for (const Method& method : described.methods)
      out += "<method name=\"" + method.name + "\"><return type=\"" +
             (method.result == GDEXTENSION_VARIANT_TYPE_NIL ? "void" : type_name(method.result)) + "\" />" + parameters(method.arguments) +
             "<description>" + escaped(method.help) + "</description></method>\n";
    out += "</methods>\n<members>\n";
    for (const Property* property : registered->properties)
      out += "<member name=\"" + property->name + "\" type=\"" +
             (property->type_name.empty() ? type_name(property->type) : property->type_name.c_str()) +
             "\" setter=\"set_value\" getter=\"get_value\">" + escaped(property->help) + "</member>\n";
    out += "</members>\n<signals>\n";
    for (const Signal& signal : described.signals)
      out += "<signal name=\"" + signal.name + "\">" + parameters(signal.arguments) + "<description>" + escaped(signal.help) +
             "</description></signal>\n";
    out += "</signals>\n</class>\n";
  }
  return out;
}

}  // namespace godot
