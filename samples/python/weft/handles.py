"""What a handle of the library stands for: devices, meshes and caches."""
from __future__ import annotations

import os
from ctypes import byref, c_void_p
from typing import Any, Mapping, Optional, Union

import numpy as np
import numpy.typing as npt

from .library import Error, ask, call
from .values import floats, integers, pointer

Path = Union[str, "os.PathLike[str]"]


class Owned:
    """What a handle stands for: gone with close, with the end of a `with`, or with the last reference."""
    _destroy = ""

    def __init__(self, needs: Optional[Owned] = None) -> None:
        if needs is not None and not needs._handle:
            raise Error(f"the {type(needs).__name__.lower()} is closed", 1)
        self._needs = needs   # which must not go before
        self._handle = c_void_p()

    def close(self) -> None:
        if self._handle and self._alive():
            ask(self._destroy, self._handle)
        self._handle = c_void_p()

    def _alive(self) -> bool:
        return self._needs is None or (bool(self._needs._handle) and self._needs._alive())

    def __enter__(self) -> Any:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def __del__(self) -> None:
        if getattr(self, "_handle", None):
            self.close()


class Device(Owned):
    """A GPU, or the software driver. Without a name the best; a number, or a part of a name, is one of `weft info`.
    Simulations on it must be closed before it is."""
    _destroy = "device_destroy"

    def __init__(self, name: Optional[str] = None) -> None:
        super().__init__()
        call("device_create", None if name is None else name.encode(), byref(self._handle))

    @property
    def name(self) -> str:
        return ask("device_name", self._handle).decode()


class Mesh(Owned):
    """A mesh made in code, which a scene names in place of a file: Simulation(..., meshes={"flag": mesh}) and "mesh": "flag".

    Positions (n, 3), metres; triangles (m, 3), vertices; uvs (n, 2); attributes (n,) or (n, 1 ... 4), which the scene's maps name.
    """
    _destroy = "mesh_destroy"

    def __init__(self, positions: npt.ArrayLike, triangles: npt.ArrayLike, uvs: Optional[npt.ArrayLike] = None,
                 attributes: Optional[Mapping[str, npt.ArrayLike]] = None) -> None:
        super().__init__()
        at = np.atleast_2d(floats(positions, 3))
        corners = np.asarray(triangles)
        if corners.ndim != 2 or corners.shape[1] != 3:
            raise Error(f"triangles of shape {corners.shape} are not three vertices each", 1)
        corners = integers(corners.reshape(-1))
        uv = None if uvs is None else np.atleast_2d(floats(uvs, 2))
        if uv is not None and uv.shape[0] != at.shape[0]:
            raise Error(f"there are {uv.shape[0]} texture coordinates for {at.shape[0]} vertices", 1)
        call("mesh_create", pointer(at), at.shape[0], pointer(corners), corners.size // 3, None if uv is None else pointer(uv),
             byref(self._handle))
        for name, values in (attributes or {}).items():
            array = np.ascontiguousarray(values, dtype=np.float32)
            array = array.reshape(-1, 1) if array.ndim == 1 else array
            if array.ndim != 2:
                raise Error(f"attribute \"{name}\" of shape {array.shape} is not a list of numbers a vertex", 1)
            call("mesh_set_attribute", self._handle, name.encode(), pointer(array), array.shape[1], array.shape[0])


class Cache(Owned):
    """What cloth did as a file for other programs, by its ending: Simulation.cache."""
    _destroy = "cache_destroy"

    def add(self) -> None:
        """The cloths as they are now: the next frame."""
        if not super()._alive():
            raise Error("the simulation is closed", 1)
        call("cache_add", self._handle)

    def finish(self) -> None:
        """All frames are there: the file takes its name. Without, nothing of it is left."""
        call("cache_finish", self._handle)

    def _alive(self) -> bool:
        return True   # it can go after its simulation
