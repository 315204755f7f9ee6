// A snapshot's bytes. One list of members is walked both ways, so that what is written is what is read.
#include "engine/snapshot.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <fstream>
#include <system_error>
#include <type_traits>

#include "compute/file.h"
#include "compute/digest.h"
#include "engine/effects/effect.h"
#include "engine/effects/skin/skin.h"

namespace weft {
namespace {

static_assert(std::endian::native == std::endian::little, "numbers are written as they lie in memory");

constexpr std::string_view kMagic = "WEFTSNAP";
constexpr std::uint32_t kVersion = 22;   // 22: links have shifts
constexpr std::size_t kHead = kMagic.size() + sizeof kVersion + sizeof(std::uint64_t);
constexpr std::size_t kEnd = sizeof(std::uint64_t);
constexpr std::uint64_t kLongest = std::uint64_t(1) << 32;   // of a file: more than the most particles and candidates take

template <class T, class U>
concept Is = std::is_same_v<std::remove_const_t<T>, U>;

// The members, for a writer, to which they are constant, or a reader.
template <class Walk, Is<Vec3> T>
void fields(Walk& walk, T& v) {
  walk(v.x), walk(v.y), walk(v.z);
}

template <class Walk, Is<ColliderPose> T>
void fields(Walk& walk, T& pose) {
  walk(pose.centre), walk(pose.normal), walk(pose.rotation.x), walk(pose.rotation.y), walk(pose.rotation.z), walk(pose.rotation.w);
}

template <class Walk, Is<ColliderSize> T>
void fields(Walk& walk, T& size) {
  walk(size.radius), walk(size.radius_end), walk(size.length), walk(size.size);
}

template <class Walk, Is<Snapshot::AnchorTargetState> T>
void fields(Walk& walk, T& state) {
  walk(state.anchor), walk(state.is_pending), walk(state.target);
}

template <class Walk, Is<Snapshot::ColliderState> T>
void fields(Walk& walk, T& state) {
  walk(state.is_host_driven), walk(state.is_pending), walk(state.pose), walk(state.pending);
  walk(state.is_resized), walk(state.size), walk(state.pending_size);
}

template <class Walk, Is<Affine> T>
void fields(Walk& walk, T& m) {
  walk(m.x), walk(m.y), walk(m.z), walk(m.origin);
}

template <class Walk, Is<Snapshot::SkinState> T>
void fields(Walk& walk, T& state) {
  walk(state.is_host_driven), walk(state.pose), walk(state.pending);
  walk(state.has_host_weights), walk(state.weights), walk(state.pending_weights), walk(state.is_kept);
}

template <class Walk, Is<MovingFrame> T>
void fields(Walk& walk, T& frame) {
  walk(frame.place), walk(frame.rotation.x), walk(frame.rotation.y), walk(frame.rotation.z), walk(frame.rotation.w);
}

template <class Walk, Is<Snapshot::FrameState> T>
void fields(Walk& walk, T& s) {
  walk(s.is_host_driven), walk(s.is_pending), walk(s.at), walk(s.pending);
  walk(s.velocity[0]), walk(s.velocity[1]), walk(s.velocity[2]);
  walk(s.turn.x), walk(s.turn.y), walk(s.turn.z), walk(s.turn.w), walk(s.seconds);
}

template <class Walk, Is<Snapshot::MotionLimitsState> T>
void fields(Walk& walk, T& limits) {
  walk(limits.scale), walk(limits.stiffness);
}

template <class Walk, Is<Snapshot::AirFieldState> T>
void fields(Walk& walk, T& state) {
  walk(state.centre), walk(state.velocity);
}

template <class Walk, Is<Snapshot::GrabState> T>
void fields(Walk& walk, T& s) {
  walk(s.grab), walk(s.is_pending), walk(s.place), walk(s.pending), walk(s.stiffness), walk(s.damping), walk(s.force);
  for (int k = 0; k < 3; ++k) walk(s.particles[k]), walk(s.weights[k]), walk(s.offsets[k]);
}

template <class Walk, Is<Snapshot::SplitState> T>
void fields(Walk& walk, T& state) {
  walk(state.cloth), walk(state.is_found), walk(state.point), walk(state.corners);
}

template <class Walk, Is<Snapshot::Content> T>
void fields(Walk& walk, T& content) {
  walk(content.name), walk(content.bytes);
}

template <class Walk, Is<Snapshot> T>
void fields(Walk& walk, T& s) {
  walk(s.digest), walk(s.substeps), walk(s.left_over), walk(s.gravity), walk(s.haste);
  walk(s.wind), walk(s.air_fields), walk(s.wind_travelled[0]), walk(s.wind_travelled[1]), walk(s.wind_travelled[2]);
  walk(s.skins), walk(s.motion_limits), walk(s.frames), walk(s.gas_amounts);
  walk(s.phase), walk(s.capacity);
  walk(s.anchors), walk(s.grabs), walk(s.colliders), walk(s.splits), walk(s.tear_frames), walk(s.splits_refused), walk(s.contents), walk(s.note);
}

template <class T>
constexpr bool kIsList = false;
template <class T>
constexpr bool kIsList<std::vector<T>> = true;
template <>
constexpr bool kIsList<std::string> = true;

struct Writer {
  std::vector<std::byte> bytes;

  void raw(std::span<const std::byte> more) { bytes.insert(bytes.end(), more.begin(), more.end()); }

  template <class T>
  void operator()(const T& value) {
    if constexpr (std::is_same_v<T, bool>) {
      bytes.push_back(std::byte{value});
    } else if constexpr (std::is_arithmetic_v<T>) {
      raw(std::as_bytes(std::span(&value, 1)));
    } else if constexpr (kIsList<T>) {
      (*this)(std::uint64_t(value.size()));
      if constexpr (sizeof(typename T::value_type) == 1) raw(std::as_bytes(std::span(value)));
      else for (const auto& element : value) (*this)(element);
    } else {
      fields(*this, value);
    }
  }
};

// Stops at the first thing that cannot be; what it has read until then is thrown away.
struct Reader {
  std::span<const std::byte> left;
  bool sound = true;

  std::span<const std::byte> take(std::uint64_t size) {
    sound = sound && size <= left.size();
    if (!sound) return {};
    const auto taken = left.first(static_cast<std::size_t>(size));
    left = left.subspan(taken.size());
    return taken;
  }

  template <class T>
  void operator()(T& value) {
    if constexpr (std::is_same_v<T, bool>) {
      const auto taken = take(1);
      value = sound && taken[0] == std::byte{1};
      sound = sound && taken[0] <= std::byte{1};
    } else if constexpr (std::is_arithmetic_v<T>) {
      const auto taken = take(sizeof value);
      if (sound) std::memcpy(&value, taken.data(), sizeof value);
    } else if constexpr (kIsList<T>) {
      list(value);
    } else {
      fields(*this, value);
    }
  }

  template <class List>
  void list(List& value) {
    std::uint64_t size = 0;
    (*this)(size);
    if constexpr (sizeof(typename List::value_type) == 1) {
      const auto taken = take(size);
      const auto* first = reinterpret_cast<const typename List::value_type*>(taken.data());
      if (sound) value.assign(first, first + taken.size());
    } else {
      // It grows with what is read: a length alone allocates nothing.
      for (; sound && size > 0; --size) (*this)(value.emplace_back());
    }
  }
};

std::uint64_t digest_of_bytes(std::span<const std::byte> bytes) {
  Digest digest;
  digest.add(bytes);
  return digest.value();
}

template <class T>
T number_at(std::span<const std::byte> bytes, std::size_t at) {
  T value;
  std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;
}

// `head`: the first kHead bytes, or fewer if there are no more; `size`: of all.
Result<void> check_head(std::span<const std::byte> head, std::uint64_t size) {
  const std::size_t known = std::min(head.size(), kMagic.size());
  if (known == 0 || std::memcmp(head.data(), kMagic.data(), known) != 0)
    return fail("this is no snapshot: it does not begin with ", kMagic);
  if (head.size() < kHead) return fail("the snapshot is cut: it has ", size, " bytes, and its head alone takes ", kHead);
  const auto version = number_at<std::uint32_t>(head, kMagic.size());
  if (version != kVersion) return fail("the snapshot is of version ", version, "; this Weft reads version ", kVersion);
  const auto length = number_at<std::uint64_t>(head, kMagic.size() + sizeof version);
  if (size < length) return fail("the snapshot is cut: it has ", size, " of its ", length, " bytes");
  if (size > length || length < kHead + kEnd) return fail("the snapshot has ", size, " bytes and says that it has ", length);
  if (size > kLongest) return fail("the snapshot has ", size, " bytes; none has more than ", kLongest);
  return {};
}

}  // namespace

std::vector<std::byte> snapshot_bytes(const Snapshot& snapshot) {
  Writer writer;
  writer.raw(std::as_bytes(std::span(kMagic)));
  std::uint64_t length = 0;
  writer(kVersion), writer(length);
  fields(writer, snapshot);
  length = writer.bytes.size() + kEnd;
  std::memcpy(writer.bytes.data() + kHead - sizeof length, &length, sizeof length);
  writer(digest_of_bytes(writer.bytes));
  return std::move(writer.bytes);
}

Result<Snapshot> parse_snapshot(std::span<const std::byte> bytes) try {
  if (auto good = check_head(bytes.first(std::min(bytes.size(), kHead)), bytes.size()); !good) return good.take_error();
  const auto body = bytes.first(bytes.size() - kEnd);
  if (digest_of_bytes(body) != number_at<std::uint64_t>(bytes, body.size()))
    return fail("the snapshot is damaged: its bytes are not those that were written");
  Reader reader{body.subspan(kHead)};
  Snapshot snapshot;
  fields(reader, snapshot);
  if (!reader.sound || !reader.left.empty())
    return fail("the snapshot is damaged: its members do not add up to its ", bytes.size(), " bytes");
  return snapshot;
} catch (...) {
  return caught("the snapshot");
}

Result<void> save_snapshot(const std::filesystem::path& file, const Snapshot& snapshot) try {
  return write_file(file, snapshot_bytes(snapshot));
} catch (...) {
  return caught("the snapshot");
}

Result<Snapshot> load_snapshot(const std::filesystem::path& file) try {
  const auto refused = [&](const auto& why) { return fail(file.string(), ": ", why); };
  std::error_code code;
  const std::uintmax_t size = std::filesystem::file_size(file, code);
  if (code) return refused("cannot be read: " + code.message());
  std::ifstream stream(file, std::ios::binary);
  std::vector<std::byte> bytes(static_cast<std::size_t>(std::min<std::uintmax_t>(size, kHead)));
  const auto read = [&](std::size_t from) {
    stream.read(reinterpret_cast<char*>(bytes.data() + from), static_cast<std::streamsize>(bytes.size() - from));
    return stream && static_cast<std::size_t>(stream.gcount()) == bytes.size() - from;
  };
  if (!read(0)) return refused("cannot be read");
  if (auto good = check_head(bytes, size); !good) return refused(good.why());
  const std::size_t head = bytes.size();
  bytes.resize(static_cast<std::size_t>(size));
  if (!read(head)) return refused("cannot be read");
  auto snapshot = parse_snapshot(bytes);
  if (!snapshot) return refused(snapshot.why());
  return snapshot;
} catch (...) {
  return caught("the snapshot");
}

std::uint64_t digest_of(const Scene& described, const CookedFabric& fabric) {
  Scene scene = described;
  scene.name.clear();
  scene.description.clear();
  scene.frames = 0;
  scene.camera = {};
  scene.light = {};
  for (Cloth& cloth : scene.cloths) {
    cloth.name.clear();
    cloth.mesh.clear();   // what was made of it tells more than where it was
    cloth.render_mesh.clear();
    cloth.appearance = {};
  }
  for (Collider& collider : scene.colliders) {
    collider.mesh.clear();
    collider.colour = {};
  }
  Digest digest;
  digest.add(scene_text(scene));
  const Cooked subject = cooked_of(described, fabric);
  for (const Effect* effect : all_effects()) {
    if (!effect->called_for(described, fabric) || effect == &effects::render_mesh) continue;   // that follows, and nothing follows it
    for (const Buffer* row : effect->buffers) {
      if (row->contents == nullptr) continue;
      const Contents contents = row->contents(subject);
      const std::uint64_t size = contents.bytes().size();
      digest.add(row->name);
      digest.add(std::as_bytes(std::span(&size, 1)));
      digest.add(contents.bytes());
    }
  }
  digest.add(std::as_bytes(std::span(fabric.own.of<SkinLists>().bones)));   // by names, which are cleared
  digest.add(std::as_bytes(std::span(&fabric.h, 1)));
  return digest.value();
}

}  // namespace weft
