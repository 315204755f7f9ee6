/* Weft from C99, as a stranger uses it: the header alone, and libweft_c.so. Ends with 0, or tells what did not hold. */
#include <weft.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int failures = 0;

#define EXPECT(holds)                                                    \
  do {                                                                   \
    if (!(holds)) {                                                      \
      printf("%s:%d: does not hold: %s\n", __FILE__, __LINE__, #holds);  \
      ++failures;                                                        \
    }                                                                    \
  } while (0)
#define MUST(call)                                                       \
  do {                                                                   \
    if ((call) != WEFT_OK) {                                             \
      printf("%s:%d: %s: %s\n", __FILE__, __LINE__, #call, error.sentence); \
      return 1;                                                          \
    }                                                                    \
  } while (0)

static const char* const kScene =
    "{\"pins\":2,\"grabs\":1,\"air\":{},\"cloths\":[{\"grid\":{\"size\":[1,1],\"cells\":[8,8]},\"anchors\":[{\"vertices\":[0,8]}]}],"
    "\"colliders\":[{\"shape\":\"sphere\",\"radius\":0.1,\"centre\":[0,-5,0]}]}";

static int simulates(weft_device* device) {
  weft_error error;
  weft_simulation *cloth = NULL, *again = NULL;
  MUST(weft_simulation_create(device, kScene, NULL, &cloth, &error));
  const weft_view positions = weft_positions(cloth), normals = weft_normals(cloth);
  EXPECT(positions.count == 81 && positions.stride == 16 && positions.buffer != 0 && normals.count == 81);
  EXPECT(weft_cloth_count(cloth) == 1 && weft_triangle_count(cloth) == 128);
  EXPECT(weft_anchor_count(cloth) == 2 && weft_collider_count(cloth) == 1);
  uint32_t first = 1, count = 0, corners[3 * 128];
  MUST(weft_cloth_vertices(cloth, 0, &first, &count, &error));
  EXPECT(first == 0 && count == 81);
  MUST(weft_triangles(cloth, corners, 128, &error));
  for (int k = 0; k < 3 * 128; ++k) EXPECT(corners[k] < 81);

  float at[81][3], uv[81][2], n[81][3];
  weft_advanced done;
  MUST(weft_advance(cloth, 1.0 / 60, &done, &error));
  EXPECT(done.substeps == 10 && fabs(done.simulated - 1.0 / 60) < 1e-9 && done.clamped == 0 && done.pairs_lost == 0);
  for (int k = 0; k < 29; ++k) MUST(weft_advance(cloth, 1.0 / 60, NULL, NULL));
  EXPECT(fabs(weft_time(cloth) - 0.5) < 1e-6);
  MUST(weft_read_positions(cloth, at[0], 81, &error));
  MUST(weft_read_normals(cloth, n[0], 81, &error));
  MUST(weft_read_uvs(cloth, uv[0], 81, &error));
  EXPECT(at[80][1] < -0.2f);   /* it has fallen */
  EXPECT(fabsf(n[40][0] * n[40][0] + n[40][1] * n[40][1] + n[40][2] * n[40][2] - 1) < 1e-4f);
  EXPECT(uv[0][0] == 0 && uv[8][0] == 1);
  const weft_counts counts = weft_get_counts(cloth);
  EXPECT(counts.non_finite == 0 && counts.contacts_overflowed == 0);

  /* The same bits in another simulation, from a state of the first. */
  void* state = NULL;
  size_t size = 0;
  uint64_t hash = 0, other = 1;
  MUST(weft_save(cloth, &state, &size, &error));
  MUST(weft_simulation_create(device, kScene, NULL, &again, &error));
  MUST(weft_restore(again, state, size, &error));
  for (int k = 0; k < 5; ++k) {
    MUST(weft_advance(cloth, 1.0 / 60, NULL, &error));
    MUST(weft_submit(again, 1.0 / 60, NULL, &error));
  }
  MUST(weft_hash(cloth, &hash, &error));
  MUST(weft_hash(again, &other, &error));
  EXPECT(hash == other && weft_ready_semaphore(again) != 0 && weft_ready_value(again) > 0);
  ((char*)state)[size / 2] ^= 1;
  EXPECT(weft_restore(again, state, size, &error) == WEFT_INPUT);
  weft_free(state);

  /* What a host moves. */
  const float up[3] = {0, 9.81f, 0}, wind[3] = {3, 0, 0}, targets[2][3] = {{-0.5f, 1, -0.5f}, {0.5f, 1, -0.5f}};
  const uint32_t one[1] = {80};
  const float place[1][3] = {{0, 2, 0}};
  MUST(weft_set_gravity(cloth, up, &error));
  MUST(weft_set_wind(cloth, wind, &error));
  MUST(weft_move_anchors(cloth, 0, targets[0], 2, &error));
  MUST(weft_pin(cloth, one, 1, &error));
  MUST(weft_advance(cloth, 1.0 / 60, NULL, &error));
  MUST(weft_move_pins(cloth, one, place[0], 1, &error));
  const weft_pose pose = {{1, 2, 3}, {0, 1, 0}, {0, 0, 0, 1}};
  MUST(weft_move_collider(cloth, 0, &pose, &error));
  MUST(weft_advance(cloth, 1.0 / 60, NULL, &error));
  MUST(weft_read_positions(cloth, at[0], 81, &error));
  EXPECT(at[80][1] == 2);
  weft_pose now;
  MUST(weft_collider_pose(cloth, 0, &now, &error));
  EXPECT(now.centre[0] == 1 && now.centre[1] == 2 && now.centre[2] == 3);
  MUST(weft_release(cloth, one, 1, &error));

  /* Hands. */
  const float above[3] = {at[40][0], at[40][1] + 1, at[40][2]}, down[3] = {0, -1, 0}, away[3] = {0, 1, 0};
  weft_grabbed held;
  MUST(weft_grab(cloth, above, away, NULL, &held, &error));
  EXPECT(held.grab == WEFT_NOTHING);
  const weft_grip grip = {100, 1, 5};
  MUST(weft_grab(cloth, above, down, &grip, &held, &error));
  EXPECT(held.grab == 0 && held.cloth == 0 && held.distance > 0);
  MUST(weft_move_grab(cloth, held.grab, above, &error));
  MUST(weft_let_go(cloth, held.grab, &error));
  weft_simulation_destroy(again);
  weft_simulation_destroy(cloth);
  return 0;
}

/* A square of two triangles, by hand. */
static int makes_meshes(weft_device* device) {
  weft_error error;
  weft_mesh *square = NULL, *none = NULL;
  weft_simulation* cloth = NULL;
  const float xyz[4][3] = {{0, 0, 0}, {1, 0, 0}, {1, 0, 1}, {0, 0, 1}}, uv[4][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  const float heavy[4] = {1, 1, 2, 2};
  const uint32_t corners[2][3] = {{0, 2, 1}, {0, 3, 2}}, beyond[1][3] = {{0, 1, 4}};
  MUST(weft_mesh_create(xyz[0], 4, corners[0], 2, uv[0], &square, &error));
  MUST(weft_mesh_set_attribute(square, "_HEAVY", heavy, 1, 4, &error));
  const char* scene = "{\"cloths\":[{\"mesh\":\"square\",\"maps\":{\"mass\":\"_HEAVY\"},\"anchors\":[{\"vertices\":[0]}]}]}";
  weft_named_mesh named[2] = {{"square", square}, {"square", square}};
  weft_options options;
  memset(&options, 0, sizeof options);
  options.size = sizeof options;
  options.meshes = named;
  options.mesh_count = 1;
  options.timings = 1;
  options.pipeline_cache = "c_test.cache";
  MUST(weft_simulation_create_with(device, scene, NULL, &options, &cloth, &error));
  weft_mesh_destroy(square);
  EXPECT(remove("c_test.cache") == 0);   /* it is there */
  options.pipeline_cache = NULL;
  MUST(weft_advance(cloth, 1.0 / 60, NULL, &error));
  float at[4][3], back[4][2], particles[4][4];
  MUST(weft_read_positions(cloth, at[0], 4, &error));
  MUST(weft_read_uvs(cloth, back[0], 4, &error));
  MUST(weft_read_particles(cloth, particles[0], 4, &error));
  EXPECT(at[0][1] == 0 && at[2][1] < 0 && memcmp(back, uv, sizeof uv) == 0 && weft_gpu_milliseconds(cloth) > 0);
  uint32_t particle_of[4];
  MUST(weft_vertex_particles(cloth, particle_of, 4, &error));
  EXPECT(particles[particle_of[0]][3] == 0 && particles[particle_of[1]][3] > particles[particle_of[2]][3]);

  /* What cannot be. */
  weft_simulation* refused = NULL;
  const char* scenes = "{\"cloths\":[{\"grid\":{\"size\":[1,1],\"cells\":[2,2]}}]}";
  EXPECT(weft_mesh_create(xyz[0], 4, beyond[0], 1, NULL, &none, &error) == WEFT_INPUT && strstr(error.sentence, "4 vertices") != NULL);
  EXPECT(weft_mesh_create(NULL, 4, corners[0], 2, NULL, &none, &error) == WEFT_INPUT && strstr(error.sentence, "xyz is null") != NULL);
  EXPECT(weft_mesh_create(xyz[0], 0, corners[0], 0, NULL, &none, &error) == WEFT_INPUT && none == NULL);
  EXPECT(weft_mesh_create(xyz[0], (size_t)-1, corners[0], 2, NULL, &none, &error) == WEFT_INPUT);
  MUST(weft_mesh_create(xyz[0], 4, corners[0], 2, NULL, &square, &error));
  EXPECT(weft_mesh_set_attribute(square, "_A", heavy, 5, 4, &error) == WEFT_INPUT && strstr(error.sentence, "5 channels") != NULL);
  EXPECT(weft_mesh_set_attribute(square, "_A", heavy, 1, 3, &error) == WEFT_INPUT && strstr(error.sentence, "3 vertices") != NULL);
  EXPECT(weft_mesh_set_attribute(square, "", heavy, 1, 4, &error) == WEFT_INPUT);
  named[0].mesh = named[1].mesh = square;
  EXPECT(weft_simulation_create_with(device, scenes, NULL, &options, &refused, &error) == WEFT_INPUT);
  EXPECT(strstr(error.sentence, "no cloth and no collider of the scene has the mesh \"square\"") != NULL);
  EXPECT(weft_simulation_create_with(device, scene, NULL, &options, &refused, &error) == WEFT_INPUT);   /* without its attribute */
  EXPECT(strstr(error.sentence, "_HEAVY") != NULL);
  options.mesh_count = 2;
  EXPECT(weft_simulation_create_with(device, scene, NULL, &options, &refused, &error) == WEFT_INPUT);
  EXPECT(strstr(error.sentence, "called \"square\"") != NULL);
  options.mesh_count = 0;
  options.reader_stages = 1;   /* VK_PIPELINE_STAGE_2_TOP_OF_PIPE_BIT */
  options.reader_accesses = 1;
  EXPECT(weft_simulation_create_with(device, scenes, NULL, &options, &refused, &error) == WEFT_INPUT);
  EXPECT(strstr(error.sentence, "the stages 0x1 are none") != NULL);
  options.reader_stages = options.reader_accesses = 0;
  options.vertex_usage = 0x100;   /* VK_BUFFER_USAGE_INDIRECT_BUFFER_BIT */
  EXPECT(weft_simulation_create_with(device, scenes, NULL, &options, &refused, &error) == WEFT_INPUT);
  EXPECT(strstr(error.sentence, "vertex_usage") != NULL);
  options.vertex_usage = 0;
  options.mesh_count = 1;
  named[0].mesh = NULL;
  EXPECT(weft_simulation_create_with(device, scene, NULL, &options, &refused, &error) == WEFT_INPUT);
  options.size = 8;
  EXPECT(weft_simulation_create_with(device, scene, NULL, &options, &refused, &error) == WEFT_INPUT);
  EXPECT(strstr(error.sentence, "options.size is 8") != NULL);
  struct { weft_options known; char more[8]; } later;   /* of a header to come */
  memset(&later, 0, sizeof later);
  later.known.size = sizeof later;
  later.more[0] = 1;
  EXPECT(weft_simulation_create_with(device, scenes, NULL, &later.known, &refused, &error) == WEFT_INPUT);
  EXPECT(strstr(error.sentence, "older") != NULL);
  EXPECT(weft_simulation_create(device, scene, NULL, &refused, &error) == WEFT_INPUT && refused == NULL);   /* "square" is no file */
  weft_mesh_destroy(square);
  weft_mesh_destroy(NULL);
  weft_simulation_destroy(cloth);
  return 0;
}

/* What the sheet moves in a file that another program opens. */
static int caches(weft_device* device) {
  weft_error error;
  weft_simulation* cloth = NULL;
  weft_cache* cache = NULL;
  MUST(weft_simulation_create(device, kScene, NULL, &cloth, &error));
  EXPECT(weft_cache_create(cloth, "c_test.txt", 2, 60, &cache, &error) == WEFT_INPUT && strstr(error.sentence, "pc2") != NULL);
  MUST(weft_cache_create(cloth, "c_test.pc2", 2, 60, &cache, &error));
  MUST(weft_cache_add(cache, &error));
  EXPECT(weft_cache_finish(cache, &error) == WEFT_INPUT);
  MUST(weft_advance(cloth, 1.0 / 60, NULL, &error));
  MUST(weft_cache_add(cache, &error));
  EXPECT(weft_cache_add(cache, &error) == WEFT_INPUT);
  MUST(weft_cache_finish(cache, &error));
  weft_cache_destroy(cache);
  weft_cache_destroy(NULL);
  FILE* file = fopen("c_test.pc2", "rb");
  char start[32];
  float frames[2][81][3], at[81][3];
  EXPECT(file != NULL && fread(start, 32, 1, file) == 1 && memcmp(start, "POINTCACHE2", 12) == 0 &&
         fread(frames, sizeof frames, 1, file) == 1);
  if (file != NULL) fclose(file);
  remove("c_test.pc2");
  MUST(weft_read_positions(cloth, at[0], 81, &error));
  EXPECT(memcmp(at, frames[1], sizeof at) == 0 && memcmp(at, frames[0], sizeof at) != 0);
  weft_simulation_destroy(cloth);
  return 0;
}

static void refuses(weft_device* device) {
  weft_error error;
  weft_simulation* cloth = NULL;
  weft_device* none = NULL;
  float xyz[3] = {0, 0, 0};
  EXPECT(weft_device_create("a GPU that nobody has", &none, &error) == WEFT_OTHER || strlen(error.sentence) > 0);
  EXPECT(none == NULL && strstr(error.sentence, "a GPU that nobody has") != NULL);
  EXPECT(weft_device_create(NULL, NULL, &error) == WEFT_INPUT && strstr(error.sentence, "device is null") != NULL);
  EXPECT(weft_simulation_create(device, "{\"cloths\":[{\"grid\":{\"size\":[1,1],\"cells\":[0,1]}}]}", NULL, &cloth, &error) == WEFT_INPUT);
  EXPECT(cloth == NULL && strstr(error.sentence, "cells") != NULL);
  EXPECT(weft_simulation_create(device, "no scene", NULL, &cloth, NULL) == WEFT_INPUT);
  EXPECT(weft_simulation_load(device, "there/is/none.json", &cloth, &error) == WEFT_INPUT);
  EXPECT(weft_simulation_create(NULL, kScene, NULL, &cloth, &error) == WEFT_INPUT);
  EXPECT(weft_advance(NULL, 1, NULL, &error) == WEFT_INPUT && strstr(error.sentence, "simulation is null") != NULL);
  EXPECT(weft_simulation_create(device, kScene, NULL, &cloth, &error) == WEFT_OK);
  EXPECT(error.sentence[0] == '\0');
  EXPECT(weft_advance(cloth, NAN, NULL, &error) == WEFT_INPUT);
  EXPECT(weft_record(cloth, NULL, 0.1, NULL, &error) == WEFT_INPUT);
  EXPECT(weft_read_positions(cloth, xyz, 1, &error) == WEFT_INPUT && strstr(error.sentence, "81") != NULL);
  EXPECT(weft_move_anchors(cloth, 2, xyz, 1, &error) == WEFT_INPUT);
  EXPECT(weft_move_anchors(cloth, 0, NULL, 1, &error) == WEFT_INPUT);
  EXPECT(weft_cloth_vertices(cloth, 1, NULL, NULL, &error) == WEFT_INPUT);
  EXPECT(weft_restore(cloth, "no snapshot", 11, &error) == WEFT_INPUT);
  EXPECT(weft_let_go(cloth, 0, &error) == WEFT_INPUT);

  /* What this scene has not, said by the library's own sentences. */
  const weft_affine still = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, 0}};
  const weft_frame frame = {{0, 0, 0}, {0, 0, 0, 1}};
  const weft_pose pose = {{0, 0, NAN}, {0, 1, 0}, {0, 0, 0, 1}};
  const weft_size size = {1, 1, 1, {1, 1, 1}};
  const weft_target_buffer targets = {0, 0, 0, 0, 81};
  const weft_wait wait = {0, 0, 0};
  weft_reaction reaction;
  weft_part part;
  weft_grabbed held;
  uint32_t number = 0;
  float four[4] = {0, 0, 0, 0};
  EXPECT(weft_set_pose(cloth, 0, &still, 1, &error) == WEFT_INPUT && strstr(error.sentence, "skin") != NULL);
  EXPECT(weft_set_body_pose(cloth, 0, &still, 1, &error) == WEFT_INPUT && strstr(error.sentence, "skin") != NULL);
  EXPECT(weft_set_pose(cloth, 0, NULL, 1, &error) == WEFT_INPUT && strstr(error.sentence, "joints is null") != NULL);
  EXPECT(weft_set_morphs(cloth, 0, xyz, 1, &error) == WEFT_INPUT && weft_set_body_morphs(cloth, 0, xyz, 1, &error) == WEFT_INPUT);
  EXPECT(weft_set_targets(cloth, 0, &targets, &error) == WEFT_INPUT && weft_set_body_targets(cloth, 0, &targets, &error) == WEFT_INPUT);
  EXPECT(weft_set_targets(cloth, 0, NULL, &error) == WEFT_INPUT);
  EXPECT(weft_move_frame(cloth, 0, &frame, &error) == WEFT_INPUT && strstr(error.sentence, "inertia") != NULL);
  EXPECT(weft_teleport(cloth, 1, &frame, &frame, &error) == WEFT_INPUT && weft_teleport(cloth, 0, NULL, &frame, &error) == WEFT_INPUT);
  EXPECT(weft_limit_motion(cloth, 0, 1, 1, &error) == WEFT_INPUT && strstr(error.sentence, "motion constraints") != NULL);
  EXPECT(weft_inflate(cloth, 0, 1, &error) == WEFT_INPUT && strstr(error.sentence, "gas") != NULL);
  EXPECT(weft_move_air_field(cloth, 0, xyz, xyz, &error) == WEFT_INPUT && strstr(error.sentence, "field") != NULL);
  EXPECT(weft_place_collider(cloth, 0, &pose, &error) == WEFT_INPUT && weft_move_colliders(cloth, 0, &pose, 1, &error) == WEFT_INPUT);
  EXPECT(weft_resize_collider(cloth, 0, &size, &error) == WEFT_INPUT && strstr(error.sentence, "resize") != NULL);
  EXPECT(weft_collider_size(cloth, 1, NULL, &error) == WEFT_INPUT);
  EXPECT(weft_take_reactions(cloth, &reaction, 1, &error) == WEFT_INPUT && strstr(error.sentence, "does not ask for reactions") != NULL);
  EXPECT(weft_take_pulls(cloth, &reaction, 1, &error) == WEFT_INPUT);
  EXPECT(weft_grab_near(cloth, NULL, NULL, &held, &error) == WEFT_INPUT && weft_grab_count(cloth) == 1);
  EXPECT(weft_anchor_vertices(cloth, &number, 1, &error) == WEFT_INPUT && strstr(error.sentence, "there are 2") != NULL);
  EXPECT(weft_get_part(cloth, 1, &part, &error) == WEFT_INPUT && weft_part_count(cloth) == 1);
  EXPECT(weft_get_part(cloth, 0, &part, &error) == WEFT_OK && part.kind == WEFT_CLOTH && part.triangles == 128 && part.joints == 0);
  EXPECT(strcmp(weft_joint_name(cloth, 7, 0), "") == 0 && strcmp(weft_morph_name(cloth, 0, 0), "") == 0);
  EXPECT(weft_read_particles(cloth, four, 1, &error) == WEFT_INPUT && weft_write_particles(cloth, four, 1, &error) == WEFT_INPUT);
  EXPECT(weft_vertex_particles(cloth, &number, 1, &error) == WEFT_INPUT);
  EXPECT(weft_submit_after(cloth, 0.1, &wait, 1, NULL, &error) == WEFT_INPUT && strstr(error.sentence, "semaphore") != NULL);
  EXPECT(weft_reserve_contacts(cloth, 0xffffffffu, &error) == WEFT_INPUT && weft_reserve_contacts(cloth, 8, &error) == WEFT_OK);
  EXPECT(weft_fits(cloth, "no snapshot", 11, &error) == WEFT_INPUT);
  EXPECT(weft_origin(cloth, four, &error) == WEFT_OK && four[0] == 0);
  weft_simulation_destroy(cloth);
  weft_simulation_destroy(NULL);
  weft_device_destroy(NULL);
  weft_free(NULL);
  EXPECT(weft_positions(NULL).count == 0 && weft_time(NULL) == 0 && strcmp(weft_device_name(NULL), "") == 0);
  /* A sentence that is longer than its room is cut, and ends. */
  char* name = malloc(5001);
  memset(name, 'x', 5000);
  name[5000] = '\0';
  EXPECT(weft_device_create(name, &none, &error) != WEFT_OK && strlen(error.sentence) <= 1023);
  free(name);
}

int main(void) {
  weft_error error;
  weft_device* device = NULL;
  EXPECT(weft_abi() == WEFT_ABI);
  MUST(weft_device_create(NULL, &device, &error));
  EXPECT(strlen(weft_device_name(device)) > 0);
  if (simulates(device) != 0) ++failures;
  if (makes_meshes(device) != 0) ++failures;
  if (caches(device) != 0) ++failures;
  refuses(device);
  weft_device_destroy(device);
  printf(failures == 0 ? "all holds\n" : "%d do not hold\n", failures);
  return failures != 0;
}
