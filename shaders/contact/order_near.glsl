// order_near: which of the clusters near it a cluster may meet, now that it is known which are smooth. Needs contact/near_list.glsl,
// contact/outline_box.glsl, contact/rare.glsl, near_clusters, near_boxes, cluster_boxes and smooth_clusters.

// In place (near_list.glsl).
void put_in_order(uint cluster) {
  const uint row = row_of(cluster), listed = near_clusters[row];
  if (listed > WEFT_NEAR_CLUSTERS) {
    near_clusters[row] = WEFT_NEAR_CLUSTERS + 1;
    ask_for_rare();
    return;
  }
  const bool is_smooth = LATEST_UINT(smooth_clusters, cluster) != 0;
  uint count = 0, later = 0;
  for (uint k = 0; k < listed; ++k) {
    const uint entry = near_clusters[row + 1 + k], other = entry & ~WEFT_TOUCHING;
    if (other != entry && (is_smooth || LATEST_UINT(smooth_clusters, other) != 0)) continue;
    uint place = count++;
    if (other >= cluster) {   // in place of the first that does not, which goes to the end
      near_clusters[row + 1 + place] = near_clusters[row + 1 + later];
      place = later++;
    }
    near_clusters[row + 1 + place] = other;
  }
  near_clusters[row] = head_of(count, later);
  const Box own = box_at(cluster);
  for (uint k = 0; k < count; ++k) {
    const uvec2 packed = pack_box(own, box_at(near_clusters[row + 1 + k]));
    if (k % 2 == 0) near_boxes[boxes_of(cluster) + k / 2].xy = packed;
    else near_boxes[boxes_of(cluster) + k / 2].zw = packed;
  }
}
