// wait: for the rest of the workgroup, and for what it has written. All of its threads must call it together.

void wait() {
  memoryBarrier();
  barrier();
}
