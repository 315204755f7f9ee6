// latest_box: the box of a cluster, where a pass of the detection reads it. Needs contact/cluster.glsl and cluster_boxes.

Box box_at(uint cluster) { return Box(LATEST(cluster_boxes, 2 * cluster).xyz, LATEST(cluster_boxes, 2 * cluster + 1).xyz); }
