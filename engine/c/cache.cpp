// See engine/c/weft.h: caches.
#include "engine/c/inside.h"

#include "engine/cache.h"
#include "engine/metrics.h"

struct weft_cache {
  const weft::Simulation* of;
  weft::CachedShape shape;
  std::unique_ptr<weft::CacheWriter> writer;
};

using weft::fail;
using weft::Result;
using namespace weft::c;

weft_status weft_cache_create(const weft_simulation* simulation, const char* file, uint32_t frames, double rate, weft_cache** cache,
                              weft_error* error) {
  return done(error, [&]() -> Result<void> {
    WEFT_GIVEN(simulation);
    WEFT_GIVEN(file);
    WEFT_GIVEN(cache);
    const weft::Simulation& of = *simulation->simulation;
    if (auto can = weft::check_cached(of.scene()); !can) return can;
    const auto format = weft::cache_format(file);
    if (!format) return format.why();
    auto made = std::make_unique<weft_cache>(weft_cache{&of, weft::cached_shape(of.fabric(), of.meshes(), of.origin(), *format), {}});
    weft::CacheOptions options;
    options.frames = frames;
    options.rate = rate;
    auto writer = weft::CacheWriter::create(file, made->shape.mesh, options);
    if (!writer) return writer.take_error();
    made->writer = std::move(*writer);
    *cache = made.release();
    return {};
  });
}

weft_status weft_cache_add(weft_cache* cache, weft_error* error) {
  return done(error, [&]() -> Result<void> {
    WEFT_GIVEN(cache);
    const auto drawn = cache->of->read_vertex_positions();
    if (!drawn) return drawn.why();
    const std::vector<weft::Vec3> positions = weft::cached_positions(cache->shape, *drawn);
    std::vector<weft::Vec3> normals;
    std::vector<float> strain;
    if (!cache->shape.mesh.normals.empty()) {
      const auto read = cache->of->read_vertex_normals();
      if (!read) return read.why();
      normals = weft::cached_normals(cache->shape, *read);
    }
    if (cache->shape.has_strain) {
      const auto particles = cache->of->read_positions();
      if (!particles) return particles.why();
      strain = weft::vertex_strain(cache->of->fabric(), *particles);
      strain.resize(positions.size());   // cloths come first
    }
    return cache->writer->add({positions, normals, strain});
  });
}

weft_status weft_cache_finish(weft_cache* cache, weft_error* error) {
  return done(error, [&]() -> Result<void> {
    WEFT_GIVEN(cache);
    return cache->writer->finish();
  });
}

void weft_cache_destroy(weft_cache* cache) { delete cache; }
