// grid_fill: puts every cluster into its bucket, in one workgroup: clusters are few. Counts the clusters of every bucket, adds the counts up
// to where its entries start, and finds the longest box on each level. The place after the last bucket holds the number of all entries.
//
// A bucket's count falls back to zero in the end, ready for the next detection. The order of entries within a bucket depends on the order
// of threads; nothing else does.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared.h"

GATHER(cluster_boxes)
READ_WRITE(Detection, detection)
SHARE(uint, grid_counts)
SHARE(uint, grid_starts)
WRITE(vec4, grid_entries)

#include "contact/apart.glsl"
#include "contact/grid.glsl"
#include "contact/cluster.glsl"
#include "contact/scan.glsl"

#include "wait.glsl"

#include "contact/fill.glsl"

// push.count: clusters.
void main() { fill(gl_LocalInvocationID.x, push.count); }
