// What is behind the handles of engine/c/weft.h, and how what goes wrong leaves. Internal.
#pragma once

#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "engine/c/weft.h"
#include "engine/simulation.h"

struct weft_device {
  std::unique_ptr<weft::compute::Device> device;
};

struct weft_mesh {
  weft::Mesh mesh;
  std::size_t vertices = 0;   // that were given
};

struct weft_simulation {
  std::unique_ptr<weft::Simulation> simulation;
};

// Of the files in this folder.
namespace weft::c {

/// Writes the sentence, cut where it is too long, and gives the status of its kind.
weft_status told(const Error& why, weft_error* error);

/// What `work`, which gives a Result<void>, has to say. Nothing of C++'s leaves it.
template <class Work>
weft_status done(weft_error* error, const Work& work) noexcept try {
  const Result<void> result = work();
  if (!result) return told({result.error(), result.kind()}, error);
  if (error != nullptr) error->sentence[0] = '\0';
  return WEFT_OK;
} catch (...) {
  return told(caught("weft"), error);
}

Result<void> given(const void* pointer, const char* name);
/// A list that may be null where it is empty.
Result<void> list(const void* pointer, std::size_t count, const char* name);
/// Room for `there` entries must be room for all of them.
Result<void> room(std::size_t given, std::size_t there, const char* what);

/// Bytes for a program that gives them back to weft_free. Errors: no memory.
Result<void*> handed_out(std::span<const std::byte> bytes);

inline Vec3 vector(const float* xyz) { return {xyz[0], xyz[1], xyz[2]}; }
inline void put(Vec3 v, float* xyz) {
  xyz[0] = v.x;
  xyz[1] = v.y;
  xyz[2] = v.z;
}
std::vector<Vec3> vectors(const float* xyz, std::size_t count);

}  // namespace weft::c

// A sentence where a pointer is null, and out.
#define WEFT_GIVEN(pointer) \
  if (auto good = weft::c::given(pointer, #pointer); !good) return good
#define WEFT_LIST(pointer, count) \
  if (auto good = weft::c::list(pointer, count, #pointer); !good) return good
