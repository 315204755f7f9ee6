#include "tests/support/scarce_memory.h"

#include <dlfcn.h>
#include <execinfo.h>

#include <cstdlib>
#include <new>
#include <string_view>

#include "tests/support/elsewhere.h"

namespace weft::test {
namespace {

struct Scarcity {
  bool is_active = false;
  long left = 0;        // allocations until the one that fails; below 1: none does
  long count = 0;
  bool is_for_good = false, has_failed = false;
};
thread_local Scarcity scarcity;

// Whether a Vulkan driver, a layer or the loader asks for memory.
bool is_asked_by_a_driver() {
  void* frames[64];
  const int depth = backtrace(frames, 64);
  for (int k = 0; k < depth; ++k) {
    Dl_info info{};
    if (dladdr(frames[k], &info) == 0 || info.dli_fname == nullptr) continue;
    const std::string_view file = info.dli_fname;
    for (const std::string_view part : {"libvulkan", "libVkLayer", "libLLVM", "libGLX", "libdrm"})
      if (file.find(part) != file.npos) return true;
  }
  return false;
}

bool must_fail() {
  Scarcity& s = scarcity;
  if (!s.is_active || Elsewhere::depth > 0) return false;
  s.is_active = false;   // backtrace allocates
  ++s.count;
  const bool due = s.left > 0 && (s.count == s.left || (s.is_for_good && s.count > s.left));
  const bool fails = due && !is_asked_by_a_driver();
  s.has_failed |= fails;
  s.is_active = true;
  return fails;
}

void* allocate(std::size_t bytes, std::size_t alignment) noexcept {
  if (must_fail()) return nullptr;
  if (bytes == 0) bytes = 1;
  if (alignment <= alignof(std::max_align_t)) return std::malloc(bytes);
  return std::aligned_alloc(alignment, (bytes + alignment - 1) / alignment * alignment);
}

void* allocate_or_throw(std::size_t bytes, std::size_t alignment) {
  if (void* memory = allocate(bytes, alignment)) return memory;
  throw std::bad_alloc();
}

}  // namespace

ScarceMemory::ScarceMemory(long at, Lasts lasts) { scarcity = {true, at, 0, lasts == Lasts::for_good, false}; }
ScarceMemory::~ScarceMemory() { scarcity.is_active = false; }
long ScarceMemory::allocations() const { return scarcity.count; }
bool ScarceMemory::failed() const { return scarcity.has_failed; }

}  // namespace weft::test

// All of them, so that no sanitizer's own meets one of these.
using weft::test::allocate;
using weft::test::allocate_or_throw;
constexpr std::size_t kPlain = alignof(std::max_align_t);
void* operator new(std::size_t bytes) { return allocate_or_throw(bytes, kPlain); }
void* operator new[](std::size_t bytes) { return allocate_or_throw(bytes, kPlain); }
void* operator new(std::size_t bytes, const std::nothrow_t&) noexcept { return allocate(bytes, kPlain); }
void* operator new[](std::size_t bytes, const std::nothrow_t&) noexcept { return allocate(bytes, kPlain); }
void* operator new(std::size_t bytes, std::align_val_t to) { return allocate_or_throw(bytes, std::size_t(to)); }
void* operator new[](std::size_t bytes, std::align_val_t to) { return allocate_or_throw(bytes, std::size_t(to)); }
void* operator new(std::size_t bytes, std::align_val_t to, const std::nothrow_t&) noexcept { return allocate(bytes, std::size_t(to)); }
void* operator new[](std::size_t bytes, std::align_val_t to, const std::nothrow_t&) noexcept { return allocate(bytes, std::size_t(to)); }
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete[](void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
void operator delete[](void* memory, std::size_t) noexcept { std::free(memory); }
void operator delete(void* memory, const std::nothrow_t&) noexcept { std::free(memory); }
void operator delete[](void* memory, const std::nothrow_t&) noexcept { std::free(memory); }
void operator delete(void* memory, std::align_val_t) noexcept { std::free(memory); }
void operator delete[](void* memory, std::align_val_t) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept { std::free(memory); }
void operator delete[](void* memory, std::size_t, std::align_val_t) noexcept { std::free(memory); }
void operator delete(void* memory, std::align_val_t, const std::nothrow_t&) noexcept { std::free(memory); }
void operator delete[](void* memory, std::align_val_t, const std::nothrow_t&) noexcept { std::free(memory); }
