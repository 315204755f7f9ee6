"""Weft for Python: cloth on the GPU, with numpy arrays in and out.

    import weft
    with weft.Device() as device, weft.Simulation.load(device, "curtain.json") as cloth:
        for frame in range(120):
            cloth.advance(1 / 60)
        positions = cloth.positions()   # (vertices, 3), float32, metres

It calls libweft_c.so (engine/c/weft.h) by ctypes, and looks for it where WEFT_LIBRARY says, beside itself, in the installation that it
is part of, and then where the system does. It needs numpy and nothing that is compiled, on every Python from 3.9 on.

Errors are exceptions, weft.Error, with the library's sentence; what was to change is then as it was. Arrays that go in may be of any type
and layout that numpy turns into float32; those that come out are new, or the `out` that was given, which then is written to without a
further copy. What a call takes and when it is refused simulation.h says, under the same name.
"""
from .handles import Cache, Device, Mesh
from .library import Error
from .simulation import Simulation
from .values import Advanced, Counts, Frame, Grabbed, Part, Pose, Quality, Reactions, Size

__all__ = ["Advanced", "Cache", "Counts", "Device", "Error", "Frame", "Grabbed", "Mesh", "Part", "Pose", "Quality", "Reactions",
           "Simulation", "Size"]
