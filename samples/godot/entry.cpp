// Where Godot begins and ends with the plug-in.
#include "samples/godot/air.h"
#include "samples/godot/anchor.h"
#include "samples/godot/cloth.h"
#include "samples/godot/queue_lock.h"
#include "samples/godot/stage.h"
#include "samples/godot/world.h"

namespace weft_godot {
namespace {

using godot::Variant;

// Once there is a tree: shapes that come and go, and each frame that is about to be drawn.
void connect() {
  forget_queue_lock();
  if (godot::singleton("Engine").call("is_editor_hint").to_bool()) return;
  godot::singleton("RenderingServer").call("connect", "frame_pre_draw", godot::callable([](std::span<const Variant>) {
                                             Stage::before_drawing();
                                           }));
  const Variant tree = godot::singleton("Engine").call("get_main_loop");
  if (!godot::is(tree.to_object(), "SceneTree")) return;
  const auto look = [](std::span<const Variant> given) {
    if (!Stage::all().empty() && !given.empty() && godot::is(given[0].to_object(), "CollisionShape3D")) Stage::shapes_changed();
  };
  tree.call("connect", "node_added", godot::callable(look));
}

void initialise(void*, GDExtensionInitializationLevel level) {
  if (level == GDEXTENSION_INITIALIZATION_SCENE) {
    godot::register_class(gust_class());
    godot::register_class(world_class());
    godot::register_class(air_field_class());
    godot::register_class(anchor_class());
    godot::register_class(cloth_class());
  }
  if (level == GDEXTENSION_INITIALIZATION_EDITOR) {
    const std::string help = godot::help_of_classes();
    if (const auto load =
            reinterpret_cast<GDExtensionsInterfaceEditorHelpLoadXmlFromUtf8Chars>(godot::function("editor_help_load_xml_from_utf8_chars")))
      load(help.c_str());
  }
}

void deinitialise(void*, GDExtensionInitializationLevel level) {
  if (level != GDEXTENSION_INITIALIZATION_SCENE) return;   // the editor's level comes before
  weft_godot::forget_queue_lock();
  godot::unregister_classes();
  godot::forget_names();
}

}  // namespace
}  // namespace weft_godot

extern "C" __attribute__((visibility("default"))) GDExtensionBool weft_godot_init(GDExtensionInterfaceGetProcAddress get,
                                                                                  GDExtensionClassLibraryPtr library,
                                                                                  GDExtensionInitialization* initialization) {
  if (!godot::load(get, library)) return false;
  weft_godot::name_queue_lock();   // before there is an instance of Vulkan
  const auto callbacks = reinterpret_cast<GDExtensionInterfaceRegisterMainLoopCallbacks>(godot::function("register_main_loop_callbacks"));
  if (callbacks == nullptr) return false;
  static const GDExtensionMainLoopCallbacks kCallbacks{weft_godot::connect, weft_godot::Stage::end_all, nullptr};
  callbacks(library, &kCallbacks);
  initialization->minimum_initialization_level = GDEXTENSION_INITIALIZATION_SCENE;
  initialization->initialize = weft_godot::initialise;
  initialization->deinitialize = weft_godot::deinitialise;
  return true;
}
