// near_list: the row of near_clusters of a cluster. grid_search fills it. Then those are dropped that it touches and cannot meet
// (smooth.glsl), and those are put first that come after it, itself included (order_near.glsl).

struct NearList {
  uint first;        // in near_clusters
  uint count;        // of its entries
  uint later;        // of those, how many come first: clusters from its own number on
  bool every_one;    // the row had no room: entries are all clusters
};

// Of near_boxes: of each entry the box, in grains of the cluster's own (outline_box.glsl), two an element.
uint boxes_of(uint cluster) { return (WEFT_NEAR_CLUSTERS + 1) / 2 * cluster; }

uint row_of(uint cluster) { return (WEFT_NEAR_CLUSTERS + 1) * cluster; }

// The row's head. With no room the count is one more than there is room for.
uint head_of(uint count, uint later) { return count | later << 8; }

NearList near_list(uint cluster, uint head) {
  const uint count = head & 0xff;
  if (count > WEFT_NEAR_CLUSTERS) return NearList(0, contact_settings.clusters, contact_settings.clusters, true);
  return NearList(row_of(cluster) + 1, count, head >> 8, false);
}
