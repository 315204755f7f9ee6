// Planes, spheres, capsules and boxes without a vertex buffer: the corners of a unit shape follow from the vertex's number.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "sky.glsl"

layout(push_constant) uniform Push { Solid solid; };

layout(location = 0) out vec3 out_position;
layout(location = 1) out vec3 out_normal;
layout(location = 2) out vec2 out_plane;

invariant gl_Position;

const uvec2 kCorners[6] = {uvec2(0, 0), uvec2(1, 0), uvec2(1, 1), uvec2(0, 0), uvec2(1, 1), uvec2(0, 1)};

// A quad of two triangles a cell: slices by stacks cells over longitude and latitude.
uvec2 lattice_of(uint vertex) {
  uint cell = vertex / 6;
  return uvec2(cell % WEFT_SPHERE_SLICES, cell / WEFT_SPHERE_SLICES) + kCorners[vertex % 6];
}

float latitude_of(uvec2 lattice) { return kPi * (float(lattice.y) / float(WEFT_SPHERE_STACKS) - 0.5); }

vec3 sphere_point(uvec2 lattice, float latitude) {
  float longitude = -2.0 * kPi * float(lattice.x % WEFT_SPHERE_SLICES) / float(WEFT_SPHERE_SLICES);
  return vec3(cos(latitude) * cos(longitude), sin(latitude), cos(latitude) * sin(longitude));
}

// Where the ends have two radii the sphere is cut where its normals are the side's, and its rows lie between that latitude and the poles.
float cut_latitude(float latitude, bool upper) {
  const float cut = asin(clamp((1.0 - solid.end_radius) / (2.0 * solid.end), -1.0, 1.0)), half_turn = 0.5 * kPi;
  return upper ? cut + (half_turn - cut) * latitude / half_turn : (half_turn + cut) * (latitude / half_turn + 1.0) - half_turn;
}

// A face a sixth: the axis that it is square to, then its side. The corner's other two axes follow in cyclic order.
void box_point(uint vertex, out vec3 local, out vec3 normal) {
  const uint axis = vertex / 12;
  const float side = (vertex / 6) % 2 == 0 ? -1.0 : 1.0;
  const vec2 corner = 2.0 * vec2(kCorners[vertex % 6]) - 1.0;
  local[axis] = side;
  local[(axis + 1) % 3] = corner.x;
  local[(axis + 2) % 3] = side * corner.y;
  normal = vec3(0);
  normal[axis] = side;
}

void main() {
  vec3 local, normal;
  if (solid.shape == WEFT_SHAPE_SPHERE) {
    const uvec2 lattice = lattice_of(gl_VertexIndex);
    local = sphere_point(lattice, latitude_of(lattice));
    normal = local;
  } else if (solid.shape == WEFT_SHAPE_CAPSULE) {
    // A sphere cut at its equator, the halves moved apart: the row of cells that is cut becomes the cylinder.
    const uvec2 lattice = lattice_of(gl_VertexIndex);
    const bool upper = 2 * lattice.y > WEFT_SPHERE_STACKS, tapered = solid.end_radius != 1.0;
    normal = sphere_point(lattice, tapered ? cut_latitude(latitude_of(lattice), upper) : latitude_of(lattice));
    local = (upper ? solid.end_radius : 1.0) * normal + vec3(0, upper ? solid.end : -solid.end, 0);
  } else if (solid.shape == WEFT_SHAPE_BOX) {
    box_point(gl_VertexIndex, local, normal);
  } else {
    // x and z span the plane, y is its normal: seen from above, counter-clockwise.
    vec2 corner = 2.0 * vec2(kCorners[gl_VertexIndex % 6]) - 1.0;
    local = vec3(corner.x, 0.0, -corner.y);
    normal = vec3(0, 1, 0);
  }
  mat3 axes = mat3(solid.axis_x.xyz, solid.axis_y.xyz, solid.axis_z.xyz);
  vec3 sizes = vec3(dot(axes[0], axes[0]), dot(axes[1], axes[1]), dot(axes[2], axes[2]));
  out_position = solid.centre.xyz + axes * local;
  out_normal = normalize(axes * (normal / sizes));
  out_plane = local.xz * sqrt(sizes.xz);
  mat4 clip_of = solid.view == WEFT_VIEW_SUN ? frame.sun : frame.camera;
  gl_Position = clip_of * vec4(out_position, 1.0);
}
