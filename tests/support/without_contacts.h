// The scene of tests that are not about contacts, which a scene that says nothing has.
#pragma once

#include "engine/scene.h"

namespace weft {

inline Scene without_contacts() {
  Scene scene;
  scene.contacts.enabled = false;
  return scene;
}

}  // namespace weft
