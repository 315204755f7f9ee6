// Anchors: which vertices they hold, and how these move. Internal.
#pragma once

#include "engine/effects/key_fields.h"

namespace weft::scene_fields {

constexpr std::size_t kMostAnchors = 1024;
inline constexpr std::array<std::string_view, 4> kCorners = {"low_low", "high_low", "low_high", "high_high"};

template <class V>
void fields(V& v, Anchor::Box& box) {
  v.vector3("low", box.low, kPlace);
  v.vector3("high", box.high, kPlace);
}

template <class V>
void fields(V& v, Anchor& anchor) {
  v.whole_list("vertices", anchor.vertices, between(0, kMostVertices - 1), kMostVertices);
  v.choices("corners", anchor.corners, kCorners);
  v.optional_number("top", anchor.top, between(0, kFarthest, "m"));
  v.optional_object("box", anchor.box);
  v.text("map", anchor.map);
  v.whole("every", anchor.every, between(1, kMostVertices));
  v.list("keys", anchor.keys, 0, kMostKeys);
}

template <class V>
void keys_of_anchor(V& v, Cloth& cloth) {
  v.list("anchors", cloth.anchors, 0, kMostAnchors);
}

template <class V>
void keys_of_anchor(V& v, Scene& scene) {
  v.whole("pins", scene.pins, between(0, kMostPins));
}

}  // namespace weft::scene_fields
