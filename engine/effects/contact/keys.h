// Contacts: true, false, or an object. Internal.
#pragma once

#include "engine/effects/ranges.h"

namespace weft::scene_fields {

/// The object form of `contacts`; its presence turns contacts on.
template <class V>
void fields(V& v, Contacts& contacts) {
  v.optional_flag("enabled", contacts.enabled);
  v.whole("iterations", contacts.iterations, between(1, 100));
  v.number("recover", contacts.recover, between(0, 100, "m/s"));
  v.number("kinematic_lag_limit", contacts.kinematic_lag_limit, between(0, 1e6));
  v.whole("capacity", contacts.capacity, between(0, kMostCandidates));
  v.number("cell", contacts.cell, between(0, 1e3, "m"));
  v.flag("untangle", contacts.untangle);
  v.number("detection_margin", contacts.detection_margin, between(0, 1e3, "m"));
}

template <class V>
void keys_of_contact(V& v, Scene& scene) {
  v.contacts("contacts", scene.contacts);
}

}  // namespace weft::scene_fields
