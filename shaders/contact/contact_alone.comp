// contact_alone: the iterations of contacts, and after a substep's last one the slides and limits, in one workgroup that waits for itself,
// where contacts are few: it is a single dispatch instead of two dozen. What it does is to the bit what the passes do that have a thread a
// contact (wide.glsl), so that the host may choose by what it knows of earlier frames (Solver::few_contacts): sums are of integers, and
// step fractions, ways and lists do not depend on the order of threads.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared.h"

GATHER_UINT4(candidates)
GATHER(contact_normals)
GATHER(contact_weights)
GATHER_WRITE_UINT(contact_counts)
GATHER_UINT(touched_particles)
READ(vec4, ways_out)
READ_WRITE(Counters, counters)
// This dispatch has written what it reads of these.
SHARE_GATHER(predicted)
SHARE(ivec4, contact_sums)
SHARE(uint, contact_penetrations)
SHARE(uvec4, slides)
SHARE(uvec4, step_fractions)
SHARE_GATHER_UINT(contact_list)
SHARE(Detection, detection)
#define ITERATE(i) LOAD(predicted, i)
#define MOVE(i, to) STORE(predicted, i, to)
#define LISTED(kind, place) LOAD_UINT(contact_list, first_place(kind) + place)
#define PENETRATIONS(i) contact_penetrations[i]

#include "motion/update_velocity.glsl"
#include "motion/watch_bound.glsl"
#include "collide/colliders.glsl"
#include "reaction/touched_mesh.glsl"
#include "reaction/mesh.glsl"
#include "motion_constraint/motion_constraint.glsl"
#include "contact/contact.glsl"
#include "contact/proximity.glsl"
#include "contact/list_places.glsl"
#include "contact/contact_share.glsl"
#include "contact/penetration.glsl"
#include "contact/solve.glsl"
#include "contact/apply.glsl"
#include "contact/sides.glsl"
#include "contact/slide.glsl"
#include "contact/slide_apply.glsl"
#include "contact/unsafe.glsl"
#include "contact/parting.glsl"
#include "contact/limit.glsl"
#include "contact/end_substep.glsl"

#include "wait.glsl"
#include "contact/limit_rest.glsl"

void list(uint kind, uint candidate) {
  const uint place = first_place(kind) + atomicAdd(detection[0].listings[kind], 1u);
  STORE_UINT(contact_list, place, candidate);
}

void iterate(uint thread, uint contacts, uint touched) {
  for (uint k = thread; k < contacts; k += workgroup) {
    const uint i = LISTED(WEFT_ACTIVE, k);
    if (add_penetrations(i)) list(WEFT_PENETRATING, i);
  }
  wait();
  const uint penetrating = detection[0].listings[WEFT_PENETRATING];
  for (uint k = thread; k < penetrating; k += workgroup) solve_contact(LISTED(WEFT_PENETRATING, k));
  wait();
  if (thread == 0) detection[0].listings[WEFT_PENETRATING] = 0;
  for (uint k = thread; k < touched; k += workgroup) apply_corrections(FETCH_UINT(touched_particles, k));
  wait();
}

// Whether any contact may cross. Few may: they are listed, in the place of those that penetrate, so that no thread waits for another one's.
bool slide(uint thread, uint contacts, uint touched) {
  for (uint k = thread; k < contacts; k += workgroup) {
    const uint i = LISTED(WEFT_ACTIVE, k);
    if (is_unsafe(i)) list(WEFT_PENETRATING, i);
  }
  wait();
  const uint unsafe = detection[0].listings[WEFT_PENETRATING];
  if (unsafe == 0) return false;
  for (uint k = thread; k < unsafe; k += workgroup) ask_for_ways(LISTED(WEFT_PENETRATING, k));
  wait();
  if (thread == 0) detection[0].listings[WEFT_PENETRATING] = 0;
  for (uint k = thread; k < touched; k += workgroup) slide_along(FETCH_UINT(touched_particles, k));
  wait();
  return true;
}

void limit_all(uint thread) {
  const uint stored = min(detection[0].candidates, contact_settings.capacity);
  for (uint k = thread; k < stored; k += workgroup)
    if (is_unsafe(k)) list(WEFT_UNSAFE, k);
  wait();
  limit_from(thread, 0);
}

uint share(uint count) { return (count + workgroup - 1) / workgroup; }

void end_all(uint thread) {
  for (uint i = thread; i < contact_settings.particles; i += workgroup)
    if (is_paired(i)) end_substep(i);
}

// At most, of a thread's loops, those within the functions included; limit_from has as many again for itself.
uint turns(uint contacts, uint touched) {
  const uint stored = min(detection[0].candidates, contact_settings.capacity);
  const uint in_iterations = contact_settings.iterations * (10 * share(contacts) + share(touched));
  const uint in_slides = WEFT_SLIDES * (6 * share(contacts) + share(touched));
  return in_iterations + in_slides + share(stored) + share(contact_settings.particles);
}

// The host expected few contacts, and there are more than one workgroup can do: their particles wait for this substep, as those of pairs do
// that find no room, and are counted as they are. The next frames have the other passes.
void wait_all(uint thread) {
  if (thread != 0) return;
  detection[0].falls_back = WEFT_ALL_WAIT;
  detection[0].needs_detection = 1;
  counters[0].contacts_overflowed += min(detection[0].candidates, contact_settings.capacity);
}

void solve_all(uint thread, uint contacts, uint touched) {
  for (uint k = 0; contacts > 0 && k < contact_settings.iterations; ++k) iterate(thread, contacts, touched);
  if ((push.flags & WEFT_LAST_ITERATION) == 0) return;
  bool may_cross = contacts > 0;
  for (uint k = 0; may_cross && k < WEFT_SLIDES; ++k) may_cross = slide(thread, contacts, touched);
  limit_all(thread);
}

void main() {
  const uint thread = gl_LocalInvocationID.x;
  const uint contacts = detection[0].listings[WEFT_ACTIVE], touched = detection[0].touchings;
  if (2 * turns(contacts, touched) > contact_settings.most_turns) wait_all(thread);
  else solve_all(thread, contacts, touched);
  if (idle_costs || (push.flags & WEFT_ENDS_SUBSTEP) == 0) return;
  wait();
  end_all(thread);
}
