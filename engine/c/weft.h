/* Weft for C, and for every language that calls C: the simulation of engine/simulation.h behind functions and plain structs.
 *
 *     weft_device* device;  weft_simulation* cloth;  weft_error error;
 *     if (weft_device_create(NULL, &device, &error)) return puts(error.sentence), 1;
 *     if (weft_simulation_load(device, "curtain.json", &cloth, &error)) return puts(error.sentence), 1;
 *     weft_advance(cloth, 1.0 / 60, NULL, &error);
 *     weft_view positions = weft_positions(cloth);      // a VkBuffer: bind it as a vertex buffer
 *
 * Stability: libweft_c.so of one soname keeps these functions and structs as they are. What is added comes as new functions. A program asks
 * weft_abi() whether it is WEFT_ABI of the header that it was compiled with.
 *
 * Errors: functions that can fail return a status, WEFT_OK (0) or what a program can do about it, and write a sentence for people into
 * `error`, which may be null. What was to change is then as it was. Nothing throws, and nothing is printed. A null pointer where one must not
 * be is an error too.
 *
 * Ownership: what a *_create or *_load makes belongs to the caller and goes with its *_destroy, which takes null. A device outlives its
 * simulations. Pointers that go in are read during the call alone.
 *
 * Threads: as in simulation.h: a simulation is used by one thread at a time; several may share a device.
 *
 * Vulkan's handles are pointers (void*) where Vulkan's are, and uint64_t for the others, so that this header needs no other. Lengths are in
 * metres, times in seconds. Scenes are JSON, with the keys of assets/scene.schema.json.
 */
#ifndef WEFT_H
#define WEFT_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#if defined(__GNUC__)
#define WEFT_API __attribute__((visibility("default")))
#else
#define WEFT_API
#endif

#define WEFT_ABI 1u

typedef enum weft_status {
  WEFT_OK = 0,
  WEFT_INPUT = 1,        /* what was given cannot be used: change it */
  WEFT_MEMORY = 2,       /* memory has run out: ask for less, or again later */
  WEFT_DEVICE_LOST = 3,  /* everything on this device is gone: make it anew */
  WEFT_OTHER = 4         /* a driver, a file system or a device that has not what it takes */
} weft_status;

typedef struct weft_error {
  char sentence[1024];   /* UTF-8, ended by a zero; a longer one is cut */
} weft_error;

typedef struct weft_device weft_device;
typedef struct weft_simulation weft_simulation;

WEFT_API uint32_t weft_abi(void);

/* ---- Devices */

/* `name`: null or "" takes the best device, a number one of `weft info`, anything else the best whose name contains it. */
WEFT_API weft_status weft_device_create(const char* name, weft_device** device, weft_error* error);

/* What a host lends: compute/device.h says what it must have, and for how long. */
typedef struct weft_borrowed {
  void* get_instance_proc_addr;   /* PFN_vkGetInstanceProcAddr */
  void* instance;                 /* VkInstance */
  void* physical;                 /* VkPhysicalDevice */
  void* device;                   /* VkDevice */
  void* queue;                    /* VkQueue */
  const void* created_with;       /* VkDeviceCreateInfo, or null */
  uint32_t queue_family;
} weft_borrowed;
WEFT_API weft_status weft_device_borrow(const weft_borrowed* lent, weft_device** device, weft_error* error);
WEFT_API void weft_device_destroy(weft_device* device);
/* Valid as long as the device. */
WEFT_API const char* weft_device_name(const weft_device* device);

/* ---- Simulations */

/* `scene`: JSON text; `folder`: what its paths are relative to, or null for the current one. */
WEFT_API weft_status weft_simulation_create(weft_device* device, const char* scene, const char* folder, weft_simulation** simulation,
                                            weft_error* error);
WEFT_API weft_status weft_simulation_load(weft_device* device, const char* file, weft_simulation** simulation, weft_error* error);
WEFT_API void weft_simulation_destroy(weft_simulation* simulation);

/* What a frame did with the seconds it was given. */
typedef struct weft_advanced {
  double simulated;      /* s */
  double clamped;        /* s, not simulated, now or later */
  uint32_t substeps;
  uint32_t pairs_lost;   /* contacts without room: their particles were held still */
} weft_advanced;

/* Simulates and waits. `done` may be null. */
WEFT_API weft_status weft_advance(weft_simulation* simulation, double seconds, weft_advanced* done, weft_error* error);
/* Submits and returns: the frame is done when the timeline semaphore has reached the value. Without timelines on the device it is 0. */
WEFT_API weft_status weft_submit(weft_simulation* simulation, double seconds, weft_advanced* done, weft_error* error);
WEFT_API uint64_t weft_ready_semaphore(const weft_simulation* simulation);   /* VkSemaphore */
WEFT_API uint64_t weft_ready_value(const weft_simulation* simulation);
/* Records into the host's VkCommandBuffer. */
WEFT_API weft_status weft_record(weft_simulation* simulation, void* commands, double seconds, weft_advanced* done, weft_error* error);

WEFT_API double weft_time(const weft_simulation* simulation);

/* ---- What is drawn */

/* One attribute of every vertex: four floats, of which three count, `stride` bytes apart. */
typedef struct weft_view {
  uint64_t buffer;       /* VkBuffer */
  uint64_t offset;       /* bytes */
  uint32_t stride;       /* bytes */
  uint32_t count;        /* vertices: of cloths, then of mesh colliders, then of render meshes */
} weft_view;
WEFT_API weft_view weft_positions(const weft_simulation* simulation);
WEFT_API weft_view weft_normals(const weft_simulation* simulation);

/* Copied back, three floats a vertex; `vertices` is how many there is room for, and must be all. Wait. */
WEFT_API weft_status weft_read_positions(const weft_simulation* simulation, float* xyz, size_t vertices, weft_error* error);
WEFT_API weft_status weft_read_normals(const weft_simulation* simulation, float* xyz, size_t vertices, weft_error* error);

/* Corners of triangles, three vertices each, of cloths, mesh colliders and render meshes. */
WEFT_API size_t weft_triangle_count(const weft_simulation* simulation);
WEFT_API weft_status weft_triangles(const weft_simulation* simulation, uint32_t* corners, size_t triangles, weft_error* error);
/* Texture coordinates, two floats a vertex. */
WEFT_API weft_status weft_read_uvs(const weft_simulation* simulation, float* uv, size_t vertices, weft_error* error);

WEFT_API uint32_t weft_cloth_count(const weft_simulation* simulation);
/* A cloth's vertices among all. */
WEFT_API weft_status weft_cloth_vertices(const weft_simulation* simulation, uint32_t cloth, uint32_t* first, uint32_t* count,
                                         weft_error* error);

/* ---- What a host moves, from the next frame on */

WEFT_API weft_status weft_set_gravity(weft_simulation* simulation, const float metres_per_second_squared[3], weft_error* error);
WEFT_API weft_status weft_set_wind(weft_simulation* simulation, const float metres_per_second[3], weft_error* error);

WEFT_API uint32_t weft_anchor_count(const weft_simulation* simulation);
/* Targets of anchors from `first` on, three floats each. */
WEFT_API weft_status weft_move_anchors(weft_simulation* simulation, uint32_t first, const float* xyz, uint32_t count, weft_error* error);

/* Of scenes with `pins`. */
WEFT_API weft_status weft_pin(weft_simulation* simulation, const uint32_t* vertices, uint32_t count, weft_error* error);
WEFT_API weft_status weft_release(weft_simulation* simulation, const uint32_t* vertices, uint32_t count, weft_error* error);
WEFT_API weft_status weft_move_pins(weft_simulation* simulation, const uint32_t* vertices, const float* xyz, uint32_t count, weft_error* error);

typedef struct weft_grip {
  double stiffness;      /* N/m */
  double damping;        /* N s/m */
  double force;          /* N, at most */
} weft_grip;
typedef struct weft_grabbed {
  double distance;       /* m, along the ray */
  uint32_t grab;         /* its number; WEFT_NOTHING: the ray meets no cloth */
  uint32_t cloth;
  float point[3];        /* m */
} weft_grabbed;
#define WEFT_NOTHING 0xffffffffu
/* Of scenes with `grabs`. `grip` may be null for a usual one. */
WEFT_API weft_status weft_grab(weft_simulation* simulation, const float origin[3], const float direction[3], const weft_grip* grip,
                               weft_grabbed* grabbed, weft_error* error);
WEFT_API weft_status weft_move_grab(weft_simulation* simulation, uint32_t grab, const float target[3], weft_error* error);
WEFT_API weft_status weft_let_go(weft_simulation* simulation, uint32_t grab, weft_error* error);

typedef struct weft_pose {
  float centre[3];       /* m */
  float normal[3];       /* planes only */
  float rotation[4];     /* a quaternion: x, y, z, w */
} weft_pose;
WEFT_API uint32_t weft_collider_count(const weft_simulation* simulation);
WEFT_API weft_status weft_move_collider(weft_simulation* simulation, uint32_t collider, const weft_pose* pose, weft_error* error);
WEFT_API weft_status weft_collider_pose(weft_simulation* simulation, uint32_t collider, weft_pose* pose, weft_error* error);

/* ---- State */

/* Since the simulation was made; engine/counts.h says what they mean. The first four are 0 in a healthy run. */
typedef struct weft_counts {
  uint32_t non_finite, coincident, contacts_overflowed, crossings;
  uint32_t contacts_most, contacts_room, truncated, detections;
} weft_counts;
WEFT_API weft_counts weft_get_counts(const weft_simulation* simulation);

/* 64 bits over the bits of all particles' positions: equal hashes, equal results. Waits. */
WEFT_API weft_status weft_hash(const weft_simulation* simulation, uint64_t* hash, weft_error* error);

/* The whole state as bytes, which go with weft_free; restoring them continues bitwise. Wait. */
WEFT_API weft_status weft_save(const weft_simulation* simulation, void** bytes, size_t* size, weft_error* error);
WEFT_API weft_status weft_restore(weft_simulation* simulation, const void* bytes, size_t size, weft_error* error);
WEFT_API void weft_free(void* bytes);

#ifdef __cplusplus
}
#endif
#endif
