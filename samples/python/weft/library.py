"""libweft_c.so: its functions and structs (engine/c/weft.h) as ctypes sees them."""
from __future__ import annotations

import ctypes
import ctypes.util
import os
import pathlib
from ctypes import POINTER, Structure, byref, c_char, c_char_p, c_double, c_float, c_int, c_size_t, c_uint32, c_uint64, c_void_p
from typing import Any

ABI = 1
NOTHING = 0xFFFFFFFF


class Error(Exception):
    """What the library says. `status`: 1 input, 2 memory, 3 the device is lost, 4 other (weft_status)."""

    def __init__(self, sentence: str, status: int) -> None:
        super().__init__(sentence)
        self.status = status


class Sentence(Structure):
    _fields_ = [("sentence", c_char * 1024)]


class Advanced(Structure):
    _fields_ = [("simulated", c_double), ("clamped", c_double), ("substeps", c_uint32), ("pairs_lost", c_uint32)]


class View(Structure):
    _fields_ = [("buffer", c_uint64), ("offset", c_uint64), ("stride", c_uint32), ("count", c_uint32)]


class Part(Structure):
    _fields_ = [(name, c_uint32) for name in ("kind", "of", "first_vertex", "vertices", "first_triangle", "triangles", "joints", "morphs")]


class NamedMesh(Structure):
    _fields_ = [("name", c_char_p), ("mesh", c_void_p)]


class Options(Structure):
    _fields_ = [("size", c_size_t), ("meshes", POINTER(NamedMesh)), ("mesh_count", c_size_t), ("pipeline_cache", c_char_p),
                ("reader_stages", c_uint64), ("reader_accesses", c_uint64), ("vertex_usage", c_uint32), ("timings", c_uint32)]


class Grip(Structure):
    _fields_ = [("stiffness", c_double), ("damping", c_double), ("force", c_double)]


class Grabbed(Structure):
    _fields_ = [("distance", c_double), ("grab", c_uint32), ("cloth", c_uint32), ("point", c_float * 3)]


class Pose(Structure):
    _fields_ = [("centre", c_float * 3), ("normal", c_float * 3), ("rotation", c_float * 4)]


class Size(Structure):
    _fields_ = [("radius", c_double), ("radius_end", c_double), ("length", c_double), ("sides", c_float * 3)]


class Frame(Structure):
    _fields_ = [("place", c_float * 3), ("rotation", c_float * 4)]


class Counts(Structure):
    _fields_ = [(name, c_uint32) for name in ("non_finite", "coincident", "contacts_overflowed", "crossings", "contacts_most",
                                              "contacts_room", "truncated", "detections")]


class Quality(Structure):
    _fields_ = [("crossings_most", c_uint32), ("unconverged", c_uint32), ("stopped", c_uint32), ("unaccelerated", c_uint32),
                ("splits_refused", c_uint32), ("tracking_error", c_float), ("residual", c_float)]


FLOATS = POINTER(c_float)
INTEGERS = POINTER(c_uint32)
# Of each function what it gives, and what it takes; None gives a status, and takes an error at the end besides.
FUNCTIONS: dict[str, tuple[Any, list[Any]]] = {
    "abi": (c_uint32, []),
    "device_create": (None, [c_char_p, POINTER(c_void_p)]),
    "device_destroy": (c_void_p, [c_void_p]),
    "device_name": (c_char_p, [c_void_p]),
    "mesh_create": (None, [FLOATS, c_size_t, INTEGERS, c_size_t, FLOATS, POINTER(c_void_p)]),
    "mesh_set_attribute": (None, [c_void_p, c_char_p, FLOATS, c_uint32, c_size_t]),
    "mesh_destroy": (c_void_p, [c_void_p]),
    "simulation_create_with": (None, [c_void_p, c_char_p, c_char_p, POINTER(Options), POINTER(c_void_p)]),
    "simulation_load": (None, [c_void_p, c_char_p, POINTER(c_void_p)]),
    "simulation_destroy": (c_void_p, [c_void_p]),
    "advance": (None, [c_void_p, c_double, POINTER(Advanced)]),
    "reserve_contacts": (None, [c_void_p, c_uint32]),
    "time": (c_double, [c_void_p]),
    "gpu_milliseconds": (c_double, [c_void_p]),
    "positions": (View, [c_void_p]),
    "read_positions": (None, [c_void_p, FLOATS, c_size_t]),
    "read_normals": (None, [c_void_p, FLOATS, c_size_t]),
    "read_uvs": (None, [c_void_p, FLOATS, c_size_t]),
    "triangle_count": (c_size_t, [c_void_p]),
    "triangles": (None, [c_void_p, INTEGERS, c_size_t]),
    "cloth_count": (c_uint32, [c_void_p]),
    "cloth_vertices": (None, [c_void_p, c_uint32, INTEGERS, INTEGERS]),
    "part_count": (c_uint32, [c_void_p]),
    "get_part": (None, [c_void_p, c_uint32, POINTER(Part)]),
    "joint_name": (c_char_p, [c_void_p, c_uint32, c_uint32]),
    "morph_name": (c_char_p, [c_void_p, c_uint32, c_uint32]),
    "set_gravity": (None, [c_void_p, FLOATS]),
    "set_wind": (None, [c_void_p, FLOATS]),
    "move_air_field": (None, [c_void_p, c_uint32, FLOATS, FLOATS]),
    "anchor_count": (c_uint32, [c_void_p]),
    "anchor_vertices": (None, [c_void_p, INTEGERS, c_size_t]),
    "move_anchors": (None, [c_void_p, c_uint32, FLOATS, c_uint32]),
    "pin": (None, [c_void_p, INTEGERS, c_uint32]),
    "release": (None, [c_void_p, INTEGERS, c_uint32]),
    "move_pins": (None, [c_void_p, INTEGERS, FLOATS, c_uint32]),
    "grab": (None, [c_void_p, FLOATS, FLOATS, POINTER(Grip), POINTER(Grabbed)]),
    "grab_near": (None, [c_void_p, FLOATS, POINTER(Grip), POINTER(Grabbed)]),
    "grab_count": (c_uint32, [c_void_p]),
    "cut": (None, [c_void_p, FLOATS, FLOATS, FLOATS, INTEGERS]),
    "splits": (c_uint32, [c_void_p]),
    "move_grab": (None, [c_void_p, c_uint32, FLOATS]),
    "let_go": (None, [c_void_p, c_uint32]),
    "collider_count": (c_uint32, [c_void_p]),
    "move_collider": (None, [c_void_p, c_uint32, POINTER(Pose)]),
    "move_colliders": (None, [c_void_p, c_uint32, POINTER(Pose), c_uint32]),
    "place_collider": (None, [c_void_p, c_uint32, POINTER(Pose)]),
    "collider_pose": (None, [c_void_p, c_uint32, POINTER(Pose)]),
    "resize_collider": (None, [c_void_p, c_uint32, POINTER(Size)]),
    "collider_size": (None, [c_void_p, c_uint32, POINTER(Size)]),
    "take_reactions": (None, [c_void_p, FLOATS, c_size_t]),
    "take_pulls": (None, [c_void_p, FLOATS, c_size_t]),
    "inflate": (None, [c_void_p, c_uint32, c_double]),
    "set_pose": (None, [c_void_p, c_uint32, FLOATS, c_uint32]),
    "set_body_pose": (None, [c_void_p, c_uint32, FLOATS, c_uint32]),
    "set_morphs": (None, [c_void_p, c_uint32, FLOATS, c_uint32]),
    "set_body_morphs": (None, [c_void_p, c_uint32, FLOATS, c_uint32]),
    "limit_motion": (None, [c_void_p, c_uint32, c_double, c_double]),
    "move_frame": (None, [c_void_p, c_uint32, POINTER(Frame)]),
    "teleport": (None, [c_void_p, c_uint32, POINTER(Frame), POINTER(Frame)]),
    "get_counts": (Counts, [c_void_p]),
    "get_quality": (Quality, [c_void_p]),
    "scene_text": (None, [c_void_p, POINTER(c_void_p)]),
    "notes": (None, [c_void_p, POINTER(c_void_p)]),
    "particle_count": (c_uint32, [c_void_p]),
    "origin": (None, [c_void_p, FLOATS]),
    "read_particles": (None, [c_void_p, FLOATS, c_size_t]),
    "read_velocities": (None, [c_void_p, FLOATS, c_size_t]),
    "write_particles": (None, [c_void_p, FLOATS, c_size_t]),
    "write_velocities": (None, [c_void_p, FLOATS, c_size_t]),
    "vertex_particles": (None, [c_void_p, INTEGERS, c_size_t]),
    "hash": (None, [c_void_p, POINTER(c_uint64)]),
    "save": (None, [c_void_p, POINTER(c_void_p), POINTER(c_size_t)]),
    "restore": (None, [c_void_p, c_char_p, c_size_t]),
    "fits": (None, [c_void_p, c_char_p, c_size_t]),
    "free": (c_void_p, [c_void_p]),
    "cache_create": (None, [c_void_p, c_char_p, c_uint32, c_double, POINTER(c_void_p)]),
    "cache_add": (None, [c_void_p]),
    "cache_finish": (None, [c_void_p]),
    "cache_destroy": (c_void_p, [c_void_p]),
}


def _load() -> ctypes.CDLL:
    here = pathlib.Path(__file__).resolve().parent
    name = "libweft_c.so.1"
    # Installed it lies in <lib>/python3/dist-packages/weft.
    places = [os.environ.get("WEFT_LIBRARY"), here / name, here.parents[2] / name, ctypes.util.find_library("weft_c"), name]
    tried = []
    for place in places:
        if place is None:
            continue
        try:
            library = ctypes.CDLL(str(place))
        except OSError as why:
            tried.append(str(why))
            continue
        for function, (gives, takes) in FUNCTIONS.items():
            entry = getattr(library, "weft_" + function)
            entry.restype = c_int if gives is None else gives
            entry.argtypes = takes + ([POINTER(Sentence)] if gives is None else [])
        if library.weft_abi() != ABI:
            raise ImportError(f"{place} has ABI {library.weft_abi()}, and this module was made for {ABI}")
        return library
    raise ImportError("libweft_c.so.1 was not found; WEFT_LIBRARY may name it: " + "; ".join(tried))


_library = _load()


def call(function: str, *arguments: Any) -> None:
    """One that gives a status."""
    error = Sentence()
    status = getattr(_library, "weft_" + function)(*arguments, byref(error))
    if status != 0:
        raise Error(error.sentence.decode("utf-8", "replace"), status)


def ask(function: str, *arguments: Any) -> Any:
    """One that cannot fail."""
    return getattr(_library, "weft_" + function)(*arguments)
