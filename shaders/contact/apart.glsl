// apart: how the passes of a detection get at what passes before them have written. detect_alone.comp is the other way.

#define LATEST(name, i) FETCH(name, i)
#define LATEST_UINT(name, i) FETCH_UINT(name, i)
