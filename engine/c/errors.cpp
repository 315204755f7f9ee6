// See engine/c/weft.h: errors, lists and bytes.
#include "engine/c/inside.h"

#include <algorithm>
#include <cstdlib>
#include <cstring>

namespace weft::c {

static_assert(static_cast<int>(ErrorKind::input) + 1 == WEFT_INPUT && static_cast<int>(ErrorKind::memory) + 1 == WEFT_MEMORY &&
              static_cast<int>(ErrorKind::device_lost) + 1 == WEFT_DEVICE_LOST && static_cast<int>(ErrorKind::other) + 1 == WEFT_OTHER);

weft_status told(const Error& why, weft_error* error) {
  if (error != nullptr) {
    std::size_t size = std::min(why.message.size(), sizeof error->sentence - 1);
    // A letter of several bytes is not cut in two.
    if (size < why.message.size())
      while (size > 0 && (static_cast<unsigned char>(why.message[size]) & 0xc0) == 0x80) --size;
    std::memcpy(error->sentence, why.message.data(), size);
    error->sentence[size] = '\0';
  }
  return static_cast<weft_status>(static_cast<int>(why.kind) + 1);
}

Result<void> given(const void* pointer, const char* name) {
  if (pointer == nullptr) return fail(name, " is null");
  return {};
}

Result<void> list(const void* pointer, std::size_t count, const char* name) { return count == 0 ? Result<void>() : given(pointer, name); }

Result<void> room(std::size_t given, std::size_t there, const char* what) {
  if (given != there) return fail("there is room for ", given, " ", what, ", and there are ", there);
  return {};
}

Result<void*> handed_out(std::span<const std::byte> bytes) {
  void* copied = std::malloc(std::max<std::size_t>(bytes.size(), 1));
  if (copied == nullptr) return fail(ErrorKind::memory, "there is not enough memory for ", bytes.size(), " bytes");
  std::memcpy(copied, bytes.data(), bytes.size());
  return copied;
}

std::vector<Vec3> vectors(const float* xyz, std::size_t count) {
  std::vector<Vec3> all(count);
  for (std::size_t k = 0; k < count; ++k) all[k] = vector(xyz + 3 * k);
  return all;
}

}  // namespace weft::c

uint32_t weft_abi(void) { return WEFT_ABI; }

void weft_free(void* bytes) { std::free(bytes); }
