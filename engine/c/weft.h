/* Weft for C, and for every language that calls C: the simulation of engine/simulation.h behind functions and plain structs.
 *
 *     weft_device* device;  weft_simulation* cloth;  weft_error error;
 *     if (weft_device_create(NULL, &device, &error)) return puts(error.sentence), 1;
 *     if (weft_simulation_load(device, "curtain.json", &cloth, &error)) return puts(error.sentence), 1;
 *     weft_advance(cloth, 1.0 / 60, NULL, &error);
 *     weft_view positions = weft_positions(cloth);      // a VkBuffer: bind it as a vertex buffer
 *
 * Stability: libweft_c.so of one soname keeps these functions and structs as they are. What is added comes as new functions, and in
 * weft_options, which says its size. A program asks weft_abi() whether it is WEFT_ABI of the header that it was compiled with.
 *
 * Errors: functions that can fail return a status, WEFT_OK (0) or what a program can do about it, and write a sentence for people into
 * `error`, which may be null. What was to change is then as it was. Nothing throws, and nothing is printed. A null pointer where one must
 * not be is an error too.
 *
 * Ownership: what a *_create or *_load makes belongs to the caller and goes with its *_destroy, which takes null. A device outlives its
 * simulations, and a simulation its caches. Pointers that go in are read during the call alone.
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

/* ---- Meshes made in code */

/* A scene's "mesh" and "render_mesh" may name it in place of a file (weft_options). Transforms, scales and maps apply to it as to files. */
typedef struct weft_mesh weft_mesh;
/* Three floats a vertex (m), at rest; three vertices a triangle; two texture coordinates a vertex, or null. It is welded and repaired as a
 * file is (engine/mesh.h): vertices at one place are one particle, and those of no triangle are dropped, so that those behind them move up
 * in what is drawn. A scene's anchors count vertices as they are given here. */
WEFT_API weft_status weft_mesh_create(const float* xyz, size_t vertices, const uint32_t* corners, size_t triangles, const float* uv,
                                      weft_mesh** mesh, weft_error* error);
/* What a scene's maps may name ("COLOR_0.r", "_NAME"): 1 ... 4 floats a vertex, for all vertices that were given. Of vertices that became
 * one particle the first counts. */
WEFT_API weft_status weft_mesh_set_attribute(weft_mesh* mesh, const char* name, const float* values, uint32_t channels, size_t vertices,
                                             weft_error* error);
WEFT_API void weft_mesh_destroy(weft_mesh* mesh);

typedef struct weft_named_mesh {
  const char* name;
  const weft_mesh* mesh;          /* is copied: it may go afterwards */
} weft_named_mesh;

/* ---- Simulations */

/* `scene`: JSON text; `folder`: what its paths are relative to, or null for the current one. */
WEFT_API weft_status weft_simulation_create(weft_device* device, const char* scene, const char* folder, weft_simulation** simulation,
                                            weft_error* error);
WEFT_API weft_status weft_simulation_load(weft_device* device, const char* file, weft_simulation** simulation, weft_error* error);
WEFT_API void weft_simulation_destroy(weft_simulation* simulation);

/* How it is made, besides. Begin with all of it 0, and `size`. */
typedef struct weft_options {
  size_t size;                    /* sizeof(weft_options) */
  const weft_named_mesh* meshes;  /* that the scene may name: each of them once or more */
  size_t mesh_count;
  const char* pipeline_cache;     /* a file in which compiled pipelines are kept between runs; null: none */
  uint64_t reader_stages;         /* VkPipelineStageFlags2 and VkAccessFlags2 of who reads positions and normals in the host's commands */
  uint64_t reader_accesses;       /* (compute/readers.h); both 0: vertex input, vertex and compute shaders, and copies */
  uint32_t vertex_usage;          /* VkBufferUsageFlags of positions and normals, besides */
  uint32_t timings;               /* 1: weft_gpu_milliseconds tells; it costs time */
} weft_options;
/* `options` may be null. */
WEFT_API weft_status weft_simulation_create_with(weft_device* device, const char* scene, const char* folder, const weft_options* options,
                                                 weft_simulation** simulation, weft_error* error);

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
/* What it waits for on the GPU first: binary semaphores (value 0), or timelines. */
typedef struct weft_wait {
  uint64_t semaphore;    /* VkSemaphore */
  uint64_t value;
  uint64_t stages;       /* VkPipelineStageFlags2: one of them that a frame begins by waiting for */
} weft_wait;
WEFT_API weft_status weft_submit_after(weft_simulation* simulation, double seconds, const weft_wait* waits, uint32_t count,
                                       weft_advanced* done, weft_error* error);
WEFT_API uint64_t weft_ready_semaphore(const weft_simulation* simulation);   /* VkSemaphore */
WEFT_API uint64_t weft_ready_value(const weft_simulation* simulation);
/* Records into the host's VkCommandBuffer. */
WEFT_API weft_status weft_record(weft_simulation* simulation, void* commands, double seconds, weft_advanced* done, weft_error* error);

/* Room for so many candidate pairs of contacts, where the first frames may have more at once (contacts_room of weft_get_counts). */
WEFT_API weft_status weft_reserve_contacts(weft_simulation* simulation, uint32_t pairs, weft_error* error);

WEFT_API double weft_time(const weft_simulation* simulation);
/* Of the last weft_advance or weft_submit, from its first command to its last; 0 without weft_options::timings. */
WEFT_API double weft_gpu_milliseconds(const weft_simulation* simulation);

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

/* A cloth, a mesh collider or a render mesh among all that is drawn, in this order. */
typedef enum weft_part_kind { WEFT_CLOTH = 0, WEFT_MESH_COLLIDER = 1, WEFT_RENDER_MESH = 2 } weft_part_kind;
typedef struct weft_part {
  uint32_t kind;         /* weft_part_kind */
  uint32_t of;           /* the cloth's number, or the collider's; a render mesh's: the cloth that carries it */
  uint32_t first_vertex, vertices;
  uint32_t first_triangle, triangles;
  uint32_t joints;       /* that weft_set_pose takes, and weights for weft_set_morphs; 0 where the scene asks for no `skin` */
  uint32_t morphs;
} weft_part;
WEFT_API uint32_t weft_part_count(const weft_simulation* simulation);
WEFT_API weft_status weft_get_part(const weft_simulation* simulation, uint32_t part, weft_part* about, weft_error* error);
/* Their names in the file, "" where there are none; valid as long as the simulation. */
WEFT_API const char* weft_joint_name(const weft_simulation* simulation, uint32_t part, uint32_t joint);
WEFT_API const char* weft_morph_name(const weft_simulation* simulation, uint32_t part, uint32_t morph);

/* ---- What a host moves, from the next frame on */

WEFT_API weft_status weft_set_gravity(weft_simulation* simulation, const float metres_per_second_squared[3], weft_error* error);
WEFT_API weft_status weft_set_wind(weft_simulation* simulation, const float metres_per_second[3], weft_error* error);

/* Of a field of the scene's air (m, m/s). */
WEFT_API weft_status weft_move_air_field(weft_simulation* simulation, uint32_t field, const float centre[3], const float velocity[3],
                                         weft_error* error);

WEFT_API uint32_t weft_anchor_count(const weft_simulation* simulation);
/* The vertex of each; there must be room for all. */
WEFT_API weft_status weft_anchor_vertices(const weft_simulation* simulation, uint32_t* vertices, size_t anchors, weft_error* error);
/* Targets of anchors from `first` on, three floats each. */
WEFT_API weft_status weft_move_anchors(weft_simulation* simulation, uint32_t first, const float* xyz, uint32_t count, weft_error* error);

/* Of scenes with `pins`. */
WEFT_API weft_status weft_pin(weft_simulation* simulation, const uint32_t* vertices, uint32_t count, weft_error* error);
WEFT_API weft_status weft_release(weft_simulation* simulation, const uint32_t* vertices, uint32_t count, weft_error* error);
WEFT_API weft_status weft_move_pins(weft_simulation* simulation, const uint32_t* vertices, const float* xyz, uint32_t count,
                                    weft_error* error);

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
/* Cuts cloth that tears along a blade between two rays from `origin` (world space): how many vertices have become two. Triangles have other
 * vertices then, and after every frame in which weft_splits has changed: read them anew. Waits. */
WEFT_API weft_status weft_cut(weft_simulation* simulation, const float origin[3], const float a[3], const float b[3], uint32_t* count,
                              weft_error* error);
/* How many vertices have become two so far, by tearing and cutting. */
WEFT_API uint32_t weft_splits(const weft_simulation* simulation);
/* Of scenes with `grabs`. `grip` may be null for a usual one. */
WEFT_API weft_status weft_grab(weft_simulation* simulation, const float origin[3], const float direction[3], const weft_grip* grip,
                               weft_grabbed* grabbed, weft_error* error);
/* The same where cloth is nearest to a point; `distance` is from there. */
WEFT_API weft_status weft_grab_near(weft_simulation* simulation, const float point[3], const weft_grip* grip, weft_grabbed* grabbed,
                                    weft_error* error);
WEFT_API uint32_t weft_grab_count(const weft_simulation* simulation);   /* the scene's `grabs` */
WEFT_API weft_status weft_move_grab(weft_simulation* simulation, uint32_t grab, const float target[3], weft_error* error);
WEFT_API weft_status weft_let_go(weft_simulation* simulation, uint32_t grab, weft_error* error);

typedef struct weft_pose {
  float centre[3];       /* m */
  float normal[3];       /* planes only */
  float rotation[4];     /* a quaternion: x, y, z, w */
} weft_pose;
WEFT_API uint32_t weft_collider_count(const weft_simulation* simulation);
WEFT_API weft_status weft_move_collider(weft_simulation* simulation, uint32_t collider, const weft_pose* pose, weft_error* error);
/* Of several from `first` on: all of them or, with an error, none. */
WEFT_API weft_status weft_move_colliders(weft_simulation* simulation, uint32_t first, const weft_pose* poses, uint32_t count,
                                         weft_error* error);
/* There at once, meeting no cloth on the way. */
WEFT_API weft_status weft_place_collider(weft_simulation* simulation, uint32_t collider, const weft_pose* pose, weft_error* error);
WEFT_API weft_status weft_collider_pose(weft_simulation* simulation, uint32_t collider, weft_pose* pose, weft_error* error);

/* What a collider's shape does not have is ignored, and comes back as it was given. */
typedef struct weft_size {
  double radius;         /* m: spheres and capsules */
  double radius_end;     /* m: capsules, at the end to which the axis points */
  double length;         /* m: capsules, from one end's centre to the other's */
  float sides[3];        /* m: boxes */
} weft_size;
/* Of colliders that the scene lets (`resizes`). */
WEFT_API weft_status weft_resize_collider(weft_simulation* simulation, uint32_t collider, const weft_size* size, weft_error* error);
WEFT_API weft_status weft_collider_size(weft_simulation* simulation, uint32_t collider, weft_size* size, weft_error* error);

/* What cloth has done since the last call, in frames that are done: to each collider, about its centre; and by which it pulls each grab,
 * about its target. Of scenes with `reactions`; there must be room for all. Nothing is lost or told twice. */
typedef struct weft_reaction {
  float impulse[3];            /* N s */
  float angular_impulse[3];    /* N m s */
} weft_reaction;
WEFT_API weft_status weft_take_reactions(weft_simulation* simulation, weft_reaction* reactions, size_t colliders, weft_error* error);
WEFT_API weft_status weft_take_pulls(weft_simulation* simulation, weft_reaction* pulls, size_t grabs, weft_error* error);

/* How much gas a cloth holds, as a multiple of the scene's (`pressure`). */
WEFT_API weft_status weft_inflate(weft_simulation* simulation, uint32_t cloth, double amount, weft_error* error);

/* ---- Characters: skins, and the frames that cloth goes with */

/* p goes to p.x x + p.y y + p.z z + origin (m). */
typedef struct weft_affine {
  float x[3], y[3], z[3], origin[3];
} weft_affine;
/* Of each joint of a cloth's skin the map from the cloth at rest to where the joint takes it: its matrix times its inverse bind matrix, in
 * world space. For the next frame's end; the host drives the skin from now on. Of a collider: in its own axes. */
WEFT_API weft_status weft_set_pose(weft_simulation* simulation, uint32_t cloth, const weft_affine* joints, uint32_t count,
                                   weft_error* error);
WEFT_API weft_status weft_set_body_pose(weft_simulation* simulation, uint32_t collider, const weft_affine* joints, uint32_t count,
                                        weft_error* error);
/* The weights of its morph targets. */
WEFT_API weft_status weft_set_morphs(weft_simulation* simulation, uint32_t cloth, const float* weights, uint32_t count,
                                     weft_error* error);
WEFT_API weft_status weft_set_body_morphs(weft_simulation* simulation, uint32_t collider, const float* weights, uint32_t count,
                                          weft_error* error);
/* The host's own skinning on the GPU: buffers of 16 bytes a vertex, as engine/target_buffer.h says. Of skins with `takes_targets`. */
typedef struct weft_target_buffer {
  uint64_t positions;          /* VkBuffer */
  uint64_t positions_offset;   /* bytes */
  uint64_t normals;            /* VkBuffer, or 0 */
  uint64_t normals_offset;
  uint32_t vertices;           /* of the mesh: for comparison */
} weft_target_buffer;
WEFT_API weft_status weft_set_targets(weft_simulation* simulation, uint32_t cloth, const weft_target_buffer* targets, weft_error* error);
WEFT_API weft_status weft_set_body_targets(weft_simulation* simulation, uint32_t collider, const weft_target_buffer* targets,
                                           weft_error* error);
/* What a cloth's max distances are multiplied by, and the stiffness of its motion constraints (0 ... 1). */
WEFT_API weft_status weft_limit_motion(weft_simulation* simulation, uint32_t cloth, double scale, double stiffness, weft_error* error);

typedef struct weft_frame {
  float place[3];              /* m */
  float rotation[4];           /* a quaternion: x, y, z, w */
} weft_frame;
/* Where the frame of a cloth with `inertia` is at the next frame's end. */
WEFT_API weft_status weft_move_frame(weft_simulation* simulation, uint32_t cloth, const weft_frame* frame, weft_error* error);
/* Takes a cloth from one frame to another at once, without a trace. */
WEFT_API weft_status weft_teleport(weft_simulation* simulation, uint32_t cloth, const weft_frame* from, const weft_frame* to,
                                   weft_error* error);

/* ---- State */

/* Since the simulation was made; engine/counts.h says what they mean. The first three are 0 in a healthy run. */
typedef struct weft_counts {
  uint32_t non_finite, coincident, contacts_overflowed, crossings;
  uint32_t contacts_most, contacts_room, truncated, detections;
} weft_counts;
WEFT_API weft_counts weft_get_counts(const weft_simulation* simulation);

typedef struct weft_quality {
  uint32_t crossings_most, unconverged, stopped, unaccelerated;
  uint32_t splits_refused;     /* times that cloth could not tear: no spare vertices */
  float tracking_error;        /* m */
  float residual;
} weft_quality;
WEFT_API weft_quality weft_get_quality(const weft_simulation* simulation);

/* The scene as JSON, every key written out, with what was chosen for "auto"; and what was repaired, left out or clamped when the simulation
 * was made, a sentence a line. They go with weft_free. */
WEFT_API weft_status weft_scene_text(const weft_simulation* simulation, char** text, weft_error* error);
WEFT_API weft_status weft_notes(const weft_simulation* simulation, char** text, weft_error* error);

/* Particles, of cloths and mesh colliders: four floats each, a position (m, relative to weft_origin) and the inverse mass (1/kg), or a
 * velocity (m/s) and four bytes that tell nothing. The fourth is not read by write. Written values that are not finite are counted in
 * non_finite, and mended. There must be room for all. Wait. */
WEFT_API uint32_t weft_particle_count(const weft_simulation* simulation);
WEFT_API weft_status weft_origin(const weft_simulation* simulation, float origin[3], weft_error* error);
WEFT_API weft_status weft_read_particles(const weft_simulation* simulation, float* xyzw, size_t particles, weft_error* error);
WEFT_API weft_status weft_read_velocities(const weft_simulation* simulation, float* xyzw, size_t particles, weft_error* error);
WEFT_API weft_status weft_write_particles(weft_simulation* simulation, const float* xyzw, size_t particles, weft_error* error);
WEFT_API weft_status weft_write_velocities(weft_simulation* simulation, const float* xyzw, size_t particles, weft_error* error);
/* The particle of each vertex; WEFT_NOTHING: of a render mesh. */
WEFT_API weft_status weft_vertex_particles(const weft_simulation* simulation, uint32_t* particles, size_t vertices, weft_error* error);

/* 64 bits over the bits of all particles' positions: equal hashes, equal results. Waits. */
WEFT_API weft_status weft_hash(const weft_simulation* simulation, uint64_t* hash, weft_error* error);

/* The whole state as bytes, which go with weft_free; restoring them continues bitwise. Wait. */
WEFT_API weft_status weft_save(const weft_simulation* simulation, void** bytes, size_t* size, weft_error* error);
WEFT_API weft_status weft_restore(weft_simulation* simulation, const void* bytes, size_t size, weft_error* error);
/* Whether weft_restore would take them. */
WEFT_API weft_status weft_fits(const weft_simulation* simulation, const void* bytes, size_t size, weft_error* error);
WEFT_API void weft_free(void* bytes);

/* ---- Caches: what cloth did, as a file for other programs, by its ending: .pc2 .mdd .glb .usda .ply .obj (engine/cache.h) */

typedef struct weft_cache weft_cache;
/* `frames` will be added, `rate` of them a second. */
WEFT_API weft_status weft_cache_create(const weft_simulation* simulation, const char* file, uint32_t frames, double rate,
                                       weft_cache** cache, weft_error* error);
/* The cloths as they are now. Waits. */
WEFT_API weft_status weft_cache_add(weft_cache* cache, weft_error* error);
/* All frames are there: the file takes its name. */
WEFT_API weft_status weft_cache_finish(weft_cache* cache, weft_error* error);
/* Without weft_cache_finish nothing of the file is left, but of .ply and .obj, which are a file a frame. */
WEFT_API void weft_cache_destroy(weft_cache* cache);

#ifdef __cplusplus
}
#endif
#endif
