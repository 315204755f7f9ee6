"""Weft for Python: cloth on the GPU, with numpy arrays in and out.

    import weft
    with weft.Device() as device, weft.Simulation.load(device, "curtain.json") as cloth:
        for frame in range(120):
            cloth.advance(1 / 60)
        positions = cloth.positions()   # (vertices, 3), float32, metres

It calls libweft_c.so (engine/c/weft.h), which it looks for where WEFT_LIBRARY says, beside itself, in the installation that it is part
of, and then where the system does. It needs numpy and nothing that is compiled: one file for every Python from 3.9 on.

Errors are exceptions, weft.Error, with the library's sentence; what was to change is then as it was. Arrays that go in may be of any type and
layout that numpy turns into float32; those that come out are new, or the `out` that was given, which then is written to without a further copy.
"""
from __future__ import annotations

import ctypes
import ctypes.util
import json
import os
import pathlib
from ctypes import POINTER, byref, c_char, c_char_p, c_double, c_float, c_size_t, c_uint32, c_uint64, c_void_p
from typing import Any, NamedTuple, Optional, Sequence, Union

import numpy as np
import numpy.typing as npt

__all__ = ["Advanced", "Counts", "Device", "Error", "Grabbed", "Pose", "Simulation"]

Floats = npt.NDArray[np.float32]
Integers = npt.NDArray[np.uint32]
_ABI = 1
_NOTHING = 0xFFFFFFFF


class Error(Exception):
    """What the library says. `status`: 1 input, 2 memory, 3 the device is lost, 4 other (weft_status)."""

    def __init__(self, sentence: str, status: int) -> None:
        super().__init__(sentence)
        self.status = status


class Advanced(NamedTuple):
    """What a frame did with the seconds it was given."""
    simulated: float   # s
    clamped: float     # s, not simulated, now or later
    substeps: int
    pairs_lost: int    # contacts without room


class Grabbed(NamedTuple):
    """What a hand has got hold of."""
    grab: int
    cloth: int
    point: Floats      # m
    distance: float    # m, along the ray


class Pose(NamedTuple):
    """Of a collider."""
    centre: Sequence[float]                               # m
    rotation: Sequence[float] = (0.0, 0.0, 0.0, 1.0)      # a quaternion: x, y, z, w
    normal: Sequence[float] = (0.0, 1.0, 0.0)             # planes only


class Counts(NamedTuple):
    """Since the simulation was made (engine/counts.h). The first three are 0 in a healthy run."""
    non_finite: int
    coincident: int
    contacts_overflowed: int
    crossings: int
    contacts_most: int
    contacts_room: int
    truncated: int
    detections: int


class _Sentence(ctypes.Structure):
    _fields_ = [("sentence", c_char * 1024)]


class _Advanced(ctypes.Structure):
    _fields_ = [("simulated", c_double), ("clamped", c_double), ("substeps", c_uint32), ("pairs_lost", c_uint32)]


class _View(ctypes.Structure):
    _fields_ = [("buffer", c_uint64), ("offset", c_uint64), ("stride", c_uint32), ("count", c_uint32)]


class _Grip(ctypes.Structure):
    _fields_ = [("stiffness", c_double), ("damping", c_double), ("force", c_double)]


class _Grabbed(ctypes.Structure):
    _fields_ = [("distance", c_double), ("grab", c_uint32), ("cloth", c_uint32), ("point", c_float * 3)]


class _Pose(ctypes.Structure):
    _fields_ = [("centre", c_float * 3), ("normal", c_float * 3), ("rotation", c_float * 4)]


class _Counts(ctypes.Structure):
    _fields_ = [(name, c_uint32) for name in Counts._fields]


_ERROR = POINTER(_Sentence)
_FLOATS = POINTER(c_float)
_INTEGERS = POINTER(c_uint32)
# Of each function what it gives, and what it takes; None gives a status, and takes an error at the end besides.
_FUNCTIONS: dict[str, tuple[Any, list[Any]]] = {
    "weft_abi": (c_uint32, []),
    "weft_device_create": (None, [c_char_p, POINTER(c_void_p)]),
    "weft_device_destroy": (c_void_p, [c_void_p]),
    "weft_device_name": (c_char_p, [c_void_p]),
    "weft_simulation_create": (None, [c_void_p, c_char_p, c_char_p, POINTER(c_void_p)]),
    "weft_simulation_load": (None, [c_void_p, c_char_p, POINTER(c_void_p)]),
    "weft_simulation_destroy": (c_void_p, [c_void_p]),
    "weft_advance": (None, [c_void_p, c_double, POINTER(_Advanced)]),
    "weft_time": (c_double, [c_void_p]),
    "weft_positions": (_View, [c_void_p]),
    "weft_read_positions": (None, [c_void_p, _FLOATS, c_size_t]),
    "weft_read_normals": (None, [c_void_p, _FLOATS, c_size_t]),
    "weft_read_uvs": (None, [c_void_p, _FLOATS, c_size_t]),
    "weft_triangle_count": (c_size_t, [c_void_p]),
    "weft_triangles": (None, [c_void_p, _INTEGERS, c_size_t]),
    "weft_cloth_count": (c_uint32, [c_void_p]),
    "weft_cloth_vertices": (None, [c_void_p, c_uint32, _INTEGERS, _INTEGERS]),
    "weft_set_gravity": (None, [c_void_p, _FLOATS]),
    "weft_set_wind": (None, [c_void_p, _FLOATS]),
    "weft_anchor_count": (c_uint32, [c_void_p]),
    "weft_move_anchors": (None, [c_void_p, c_uint32, _FLOATS, c_uint32]),
    "weft_pin": (None, [c_void_p, _INTEGERS, c_uint32]),
    "weft_release": (None, [c_void_p, _INTEGERS, c_uint32]),
    "weft_move_pins": (None, [c_void_p, _INTEGERS, _FLOATS, c_uint32]),
    "weft_grab": (None, [c_void_p, _FLOATS, _FLOATS, POINTER(_Grip), POINTER(_Grabbed)]),
    "weft_move_grab": (None, [c_void_p, c_uint32, _FLOATS]),
    "weft_let_go": (None, [c_void_p, c_uint32]),
    "weft_collider_count": (c_uint32, [c_void_p]),
    "weft_move_collider": (None, [c_void_p, c_uint32, POINTER(_Pose)]),
    "weft_collider_pose": (None, [c_void_p, c_uint32, POINTER(_Pose)]),
    "weft_get_counts": (_Counts, [c_void_p]),
    "weft_hash": (None, [c_void_p, POINTER(c_uint64)]),
    "weft_save": (None, [c_void_p, POINTER(c_void_p), POINTER(c_size_t)]),
    "weft_restore": (None, [c_void_p, c_char_p, c_size_t]),
    "weft_free": (c_void_p, [c_void_p]),
}


def _load() -> ctypes.CDLL:
    here = pathlib.Path(__file__).resolve().parent
    name = "libweft_c.so.1"
    # Installed it lies in <lib>/python3/dist-packages.
    places = [os.environ.get("WEFT_LIBRARY"), here / name, here.parent.parent / name, ctypes.util.find_library("weft_c"), name]
    tried = []
    for place in places:
        if place is None:
            continue
        try:
            library = ctypes.CDLL(str(place))
        except OSError as why:
            tried.append(str(why))
            continue
        for function, (gives, takes) in _FUNCTIONS.items():
            entry = getattr(library, function)
            entry.restype = ctypes.c_int if gives is None else gives
            entry.argtypes = takes + ([_ERROR] if gives is None else [])
        if library.weft_abi() != _ABI:
            raise ImportError(f"{place} has ABI {library.weft_abi()}, and weft.py was made for {_ABI}")
        return library
    raise ImportError("libweft_c.so.1 was not found; WEFT_LIBRARY may name it: " + "; ".join(tried))


_library = _load()


def _call(function: str, *arguments: Any) -> None:
    error = _Sentence()
    status = getattr(_library, function)(*arguments, byref(error))
    if status != 0:
        raise Error(error.sentence.decode("utf-8", "replace"), status)


def _floats(values: npt.ArrayLike, width: int) -> Floats:
    array = np.ascontiguousarray(values, dtype=np.float32)
    if array.ndim == 0 or array.shape[-1] != width or array.ndim > 2:
        raise Error(f"an array of shape {array.shape} has not {width} numbers an entry", 1)
    return array


def _integers(values: npt.ArrayLike) -> Integers:
    array = np.asarray(values)
    if array.ndim != 1 or (array.size > 0 and (array.dtype.kind not in "iu" or array.min() < 0 or array.max() > _NOTHING)):
        raise Error("numbers of vertices must be a list of whole numbers from 0 on", 1)
    return np.ascontiguousarray(array, dtype=np.uint32)


def _pointer(array: Any) -> Any:
    return array.ctypes.data_as(_FLOATS if array.dtype == np.float32 else _INTEGERS)


class Device:
    """A GPU, or the software driver. Without a name the best; a number, or a part of a name, is one of `weft info`."""

    def __init__(self, name: Optional[str] = None) -> None:
        self._handle = c_void_p()
        _call("weft_device_create", None if name is None else name.encode(), byref(self._handle))

    @property
    def name(self) -> str:
        return _library.weft_device_name(self._handle).decode()

    def close(self) -> None:
        """Simulations on it must be closed before."""
        if self._handle:
            _library.weft_device_destroy(self._handle)
            self._handle = c_void_p()

    def __enter__(self) -> Device:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def __del__(self) -> None:
        if getattr(self, "_handle", None):
            self.close()


class Simulation:
    """Cloth that is simulated: of a scene as a dict, with the keys of assets/scene.schema.json, or as JSON text."""

    def __init__(self, device: Device, scene: Union[str, dict[str, Any]], folder: Union[str, os.PathLike[str]] = "") -> None:
        text = scene if isinstance(scene, str) else json.dumps(scene)
        self._begin(device)
        _call("weft_simulation_create", device._handle, text.encode(), os.fsencode(folder), byref(self._handle))

    @classmethod
    def load(cls, device: Device, file: Union[str, os.PathLike[str]]) -> Simulation:
        """Of a scene's file."""
        made = cls.__new__(cls)
        made._begin(device)
        _call("weft_simulation_load", device._handle, os.fsencode(file), byref(made._handle))
        return made

    def _begin(self, device: Device) -> None:
        if not device._handle:
            raise Error("the device is closed", 1)
        self._device = device   # which must not go before
        self._handle = c_void_p()

    def close(self) -> None:
        if self._handle:
            _library.weft_simulation_destroy(self._handle)
            self._handle = c_void_p()

    def __enter__(self) -> Simulation:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def __del__(self) -> None:
        if getattr(self, "_handle", None) and self._device._handle:
            self.close()

    def advance(self, seconds: float) -> Advanced:
        """Simulates, and waits."""
        done = _Advanced()
        _call("weft_advance", self._handle, seconds, byref(done))
        return Advanced(done.simulated, done.clamped, done.substeps, done.pairs_lost)

    @property
    def time(self) -> float:
        """Seconds simulated so far."""
        return _library.weft_time(self._handle)

    @property
    def vertices(self) -> int:
        return _library.weft_positions(self._handle).count

    def _read(self, function: str, width: int, out: Optional[Floats]) -> Floats:
        shape = (self.vertices, width)
        if out is None:
            out = np.empty(shape, np.float32)
        elif out.shape != shape or out.dtype != np.float32 or not out.flags.c_contiguous or not out.flags.writeable:
            raise Error(f"`out` must be writeable and contiguous, of float32 and of shape {shape}", 1)
        _call(function, self._handle, _pointer(out), shape[0])
        return out

    def positions(self, out: Optional[Floats] = None) -> Floats:
        """(vertices, 3), metres: of cloths, mesh colliders and render meshes."""
        return self._read("weft_read_positions", 3, out)

    def normals(self, out: Optional[Floats] = None) -> Floats:
        """(vertices, 3), unit."""
        return self._read("weft_read_normals", 3, out)

    def uvs(self) -> Floats:
        """(vertices, 2)."""
        return self._read("weft_read_uvs", 2, None)

    def triangles(self) -> Integers:
        """(triangles, 3), vertices."""
        out = np.empty((_library.weft_triangle_count(self._handle), 3), np.uint32)
        _call("weft_triangles", self._handle, _pointer(out), out.shape[0])
        return out

    def cloths(self) -> list[slice]:
        """Each cloth's vertices among all."""
        first, count = c_uint32(), c_uint32()
        slices = []
        for cloth in range(_library.weft_cloth_count(self._handle)):
            _call("weft_cloth_vertices", self._handle, cloth, byref(first), byref(count))
            slices.append(slice(first.value, first.value + count.value))
        return slices

    def set_gravity(self, gravity: npt.ArrayLike) -> None:
        """m/s^2."""
        _call("weft_set_gravity", self._handle, _pointer(_floats(gravity, 3)))

    def set_wind(self, wind: npt.ArrayLike) -> None:
        """m/s; of scenes with air."""
        _call("weft_set_wind", self._handle, _pointer(_floats(wind, 3)))

    @property
    def anchors(self) -> int:
        return _library.weft_anchor_count(self._handle)

    def move_anchors(self, targets: npt.ArrayLike, first: int = 0) -> None:
        """(n, 3), metres: for the next frame's end, of anchors from `first` on."""
        array = np.atleast_2d(_floats(targets, 3))
        _call("weft_move_anchors", self._handle, first, _pointer(array), array.shape[0])

    def pin(self, vertices: npt.ArrayLike) -> None:
        """Of scenes with `pins`."""
        array = _integers(vertices)
        _call("weft_pin", self._handle, _pointer(array), array.size)

    def release(self, vertices: npt.ArrayLike) -> None:
        array = _integers(vertices)
        _call("weft_release", self._handle, _pointer(array), array.size)

    def move_pins(self, vertices: npt.ArrayLike, targets: npt.ArrayLike) -> None:
        """Targets: (n, 3), metres."""
        array, places = _integers(vertices), np.atleast_2d(_floats(targets, 3))
        if places.shape[0] != array.size:
            raise Error(f"there are {places.shape[0]} targets for {array.size} vertices", 1)
        _call("weft_move_pins", self._handle, _pointer(array), _pointer(places), array.size)

    def grab(self, origin: npt.ArrayLike, direction: npt.ArrayLike, stiffness: float = 200, damping: float = 2,
             force: float = 20) -> Optional[Grabbed]:
        """Takes hold of cloth where a ray first meets it; None where it meets none. N/m, N s/m, N. Of scenes with `grabs`."""
        held, grip = _Grabbed(), _Grip(stiffness, damping, force)
        _call("weft_grab", self._handle, _pointer(_floats(origin, 3)), _pointer(_floats(direction, 3)), byref(grip), byref(held))
        if held.grab == _NOTHING:
            return None
        return Grabbed(held.grab, held.cloth, np.array(held.point, np.float32), held.distance)

    def move_grab(self, grab: int, target: npt.ArrayLike) -> None:
        _call("weft_move_grab", self._handle, grab, _pointer(_floats(target, 3)))

    def let_go(self, grab: int) -> None:
        _call("weft_let_go", self._handle, grab)

    @property
    def colliders(self) -> int:
        return _library.weft_collider_count(self._handle)

    def move_collider(self, collider: int, pose: Pose) -> None:
        """To there until the next frame's end."""
        given = _Pose((c_float * 3)(*pose.centre), (c_float * 3)(*pose.normal), (c_float * 4)(*pose.rotation))
        _call("weft_move_collider", self._handle, collider, byref(given))

    def collider(self, collider: int) -> Pose:
        pose = _Pose()
        _call("weft_collider_pose", self._handle, collider, byref(pose))
        return Pose(tuple(pose.centre), tuple(pose.rotation), tuple(pose.normal))

    def counts(self) -> Counts:
        counts = _library.weft_get_counts(self._handle)
        return Counts(*(getattr(counts, name) for name in Counts._fields))

    def hash(self) -> int:
        """64 bits over the bits of all particles' positions."""
        value = c_uint64()
        _call("weft_hash", self._handle, byref(value))
        return value.value

    def save(self) -> bytes:
        """The whole state; restoring it continues bitwise."""
        data, size = c_void_p(), c_size_t()
        _call("weft_save", self._handle, byref(data), byref(size))
        try:
            return ctypes.string_at(data, size.value)
        finally:
            _library.weft_free(data)

    def restore(self, state: bytes) -> None:
        _call("weft_restore", self._handle, state, len(state))
