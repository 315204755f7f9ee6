// WeftWorld: what cloths share, as a resource. Cloths that name the same one are one simulation; those that name none share another.
#pragma once

#include <optional>

#include "engine/scene.h"
#include "samples/godot/classes.h"

namespace weft_godot {

class World : public godot::Instance {
 public:
  using Instance::Instance;
  bool shows(std::string_view property) const override;

  weft::SolverSettings solver;
  weft::Contacts contacts;
  weft::Air air;
  bool has_air = true;
  double gravity_scale = 1;
  std::uint32_t pins = 0, grabs = 0;
  godot::Variant gusts;    // an array of WeftGust, or nil
  std::string recording;   // a folder; empty: none
};

/// What a cloth's `world` holds, with the defaults where it holds none.
struct Shared {
  weft::SolverSettings solver;
  weft::Contacts contacts;
  std::optional<weft::Air> air = weft::Air{};
  double gravity_scale = 1;
  std::uint32_t pins = 0, grabs = 0;
  std::string recording;
};
Shared shared_of(const godot::Variant& world);

const godot::Class& world_class();

}  // namespace weft_godot
