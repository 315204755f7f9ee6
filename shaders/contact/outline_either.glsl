// outline_either: what detect_outline does for one of its elements. Needs contact/grid.glsl, contact/predicted_track.glsl,
// contact/outline.glsl, contact/cluster.glsl, contact/outline_box.glsl, contact/near_list.glsl and the buffers.

#include "contact/final_track.glsl"
#include "contact/outline_particle.glsl"
#include "contact/order_near.glsl"
#include "contact/put_outline.glsl"
#include "contact/outline_face.glsl"
#include "contact/outline_edge.glsl"

// i: of particles, triangles, edges and clusters, in this order.
void outline_either(uint i) {
  const uint particles = contact_settings.particles, faces = particles + contact_settings.triangles, edges = faces + contact_settings.edges;
  if (i < particles) outline_particle(i);
  else if (i < faces) outline_face(i - particles);
  else if (i < edges) outline_edge(i - faces);
  else put_in_order(i - edges);
}
