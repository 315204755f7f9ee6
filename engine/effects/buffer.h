// A buffer is one row: name, element, length, first contents, lifetime. Rows stand in the headers of the effects that own them.
//
// Shaders call a buffer by the name in its row; which passes touch it, and how, is reflected from their code. A buffer that no pass
// of a scene touches does not exist there. Lengths and contents are functions of what was cooked.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <type_traits>
#include <vector>

#include "engine/fabric.h"
#include "engine/scene.h"
#include "shaders/shared.h"

namespace weft {

/// The argument of an effect's declarations.
struct Cooked {
  const Scene& scene;
  const CookedFabric& fabric;
  gpu::ContactSettings contacts;   // all 0 without contacts
};

enum class Lifetime {
  cooked,       // as it was cooked, for good
  uploaded,     // written by the host at the start of a frame
  persistent,   // what a frame leaves to the next: restored by a rollback, and part of a snapshot
  cleared,      // every word has one value between any two frames
  scratch       // made anew before it is read
};

/// What a fetch of one element through a texel buffer returns.
enum class Texel { none, float4, uint4, uint2, uint1 };

enum class Access { shaders, vertices, arguments };   // besides shaders: as vertex buffer; as arguments of dispatches

/// Bytes: made for the purpose, or lying in what was cooked.
struct Contents {
  std::vector<std::byte> made;
  std::span<const std::byte> lying;
  std::span<const std::byte> bytes() const { return made.empty() ? lying : std::span<const std::byte>(made); }
};

template <class T>
Contents lying(const std::vector<T>& values) {
  return {{}, std::as_bytes(std::span(values))};
}
template <class T>
Contents made(const std::vector<T>& values) {
  const auto bytes = std::as_bytes(std::span(values));
  return {{bytes.begin(), bytes.end()}, {}};
}

struct Buffer {
  std::string_view name;
  std::uint32_t element_bytes = 0;
  Texel texel = Texel::none;
  Lifetime lifetime = Lifetime::scratch;
  std::uint64_t (*length)(const Cooked&) = nullptr;      // elements; an empty buffer gets one
  Contents (*contents)(const Cooked&) = nullptr;         // initial; null: every word is `word`, if persistent or cleared
  std::uint32_t word = 0;
  bool grows = false;                                     // with the capacity for contacts, while running
  Access access = Access::shaders;
  std::uint64_t (*most)(const Cooked&) = nullptr;         // elements, as torn as the cloth can be; null: twice as many as it has whole
  const Buffer* lies_in = nullptr;                        // shares that buffer's memory while that buffer is not in use
};

template <class Element>
constexpr Texel texel_of() {
  return std::is_same_v<Element, gpu::vec4>    ? Texel::float4
         : std::is_same_v<Element, gpu::uvec4> ? Texel::uint4
         : std::is_same_v<Element, gpu::uvec2> ? Texel::uint2
         : std::is_same_v<Element, gpu::uint>  ? Texel::uint1
                                               : Texel::none;
}

using Length = std::uint64_t (*)(const Cooked&);

template <class Element>
constexpr Buffer buffer(std::string_view name, Lifetime lifetime, Length length, Contents (*contents)(const Cooked&) = nullptr) {
  return {.name = name,
          .element_bytes = sizeof(Element),
          .texel = texel_of<Element>(),
          .lifetime = lifetime,
          .length = length,
          .contents = contents};
}
template <class Element>
constexpr Buffer scratch(std::string_view name, Length length) {
  return buffer<Element>(name, Lifetime::scratch, length);
}
template <class Element>
constexpr Buffer cleared(std::string_view name, Length length, std::uint32_t word = 0) {
  Buffer row = buffer<Element>(name, Lifetime::cleared, length);
  row.word = word;
  return row;
}
/// Grows with the capacity for contacts.
constexpr Buffer growing(Buffer row) {
  row.grows = true;
  return row;
}

namespace detail {
template <auto Member, auto... Inner>
const auto& member_of(const auto& whole) {
  if constexpr (sizeof...(Inner) == 0)
    return whole.*Member;
  else
    return member_of<Inner...>(whole.*Member);
}

template <auto Member>
struct OwnerOf;
template <class T, class Value, Value T::*Member>
struct OwnerOf<Member> {
  using Type = T;
};
}  // namespace detail

/// A list that was cooked, as it lies: cooked<gpu::uvec4, &CookedFabric::stretch, &PairRows::pairs>("stretch_links").
template <class Element, auto... Members>
constexpr Buffer cooked(std::string_view name) {
  return buffer<Element>(
      name, Lifetime::cooked,
      [](const Cooked& s) { return std::uint64_t(std::span(detail::member_of<Members...>(s.fabric)).size_bytes() / sizeof(Element)); },
      [](const Cooked& s) { return lying(detail::member_of<Members...>(s.fabric)); });
}

/// The same of a list that an effect cooked for itself alone (CookedFabric::own):
/// own<gpu::uvec2, &DihedralLists::uses, &PairRows::rows>("hinge_use_rows").
template <class Element, auto Member, auto... Inner>
constexpr Buffer own(std::string_view name) {
  using Lists = typename detail::OwnerOf<Member>::Type;
  return buffer<Element>(
      name, Lifetime::cooked,
      [](const Cooked& s) {
        return std::uint64_t(std::span(detail::member_of<Member, Inner...>(s.fabric.own.of<Lists>())).size_bytes() / sizeof(Element));
      },
      [](const Cooked& s) { return lying(detail::member_of<Member, Inner...>(s.fabric.own.of<Lists>())); });
}

// Lengths that many buffers have.
namespace lengths {
inline std::uint64_t one(const Cooked&) { return 1; }
inline std::uint64_t particles(const Cooked& s) { return s.fabric.positions.size(); }
inline std::uint64_t vertices(const Cooked& s) { return s.fabric.surface_rows.size(); }   // without those of render meshes
inline std::uint64_t candidates(const Cooked& s) { return s.contacts.capacity; }
}  // namespace lengths

}  // namespace weft
