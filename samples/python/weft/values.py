"""What goes in and out: tuples with names, and arrays as the library reads them."""
from __future__ import annotations

from ctypes import c_float
from typing import Any, NamedTuple, Optional, Sequence

import numpy as np
import numpy.typing as npt

from . import library
from .library import Error

Floats = npt.NDArray[np.float32]
Integers = npt.NDArray[np.uint32]


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
    distance: float    # m, along the ray, or from the point


class Pose(NamedTuple):
    """Of a collider."""
    centre: Sequence[float]                               # m
    rotation: Sequence[float] = (0.0, 0.0, 0.0, 1.0)      # a quaternion: x, y, z, w
    normal: Sequence[float] = (0.0, 1.0, 0.0)             # planes only


class Size(NamedTuple):
    """Of a collider; what its shape does not have is ignored."""
    radius: float = 0.5                                   # m: spheres and capsules
    radius_end: float = 0.5                               # m: capsules, at the end to which the axis points
    length: float = 0.5                                   # m: capsules
    sides: Sequence[float] = (1.0, 1.0, 1.0)              # m: boxes


class Frame(NamedTuple):
    """That cloth with `inertia` goes with."""
    place: Sequence[float]                                # m
    rotation: Sequence[float] = (0.0, 0.0, 0.0, 1.0)      # a quaternion: x, y, z, w


class Reactions(NamedTuple):
    """What cloth has done to each collider or hand since they were taken last."""
    impulse: Floats            # (n, 3), N s
    angular_impulse: Floats    # (n, 3), N m s


class Part(NamedTuple):
    """A cloth, a mesh collider or a render mesh, among all that is drawn."""
    kind: str                  # "cloth", "mesh collider", "render mesh"
    of: int                    # the cloth's number, or the collider's
    vertices: slice
    triangles: slice
    joints: list[str]          # names, of a skin that the scene asks for
    morphs: list[str]


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


class Quality(NamedTuple):
    """More of the same."""
    crossings_most: int
    unconverged: int
    stopped: int
    unaccelerated: int
    splits_refused: int        # times that cloth could not tear
    tracking_error: float      # m
    residual: float


def floats(values: npt.ArrayLike, width: int) -> Floats:
    array = np.ascontiguousarray(values, dtype=np.float32)
    if array.ndim == 0 or array.shape[-1] != width or array.ndim > 2:
        raise Error(f"an array of shape {array.shape} has not {width} numbers an entry", 1)
    return array


def integers(values: npt.ArrayLike) -> Integers:
    array = np.asarray(values)
    if array.ndim != 1 or (array.size > 0 and (array.dtype.kind not in "iu" or array.min() < 0 or array.max() > library.NOTHING)):
        raise Error("numbers of vertices must be a list of whole numbers from 0 on", 1)
    return np.ascontiguousarray(array, dtype=np.uint32)


def maps(matrices: npt.ArrayLike) -> Floats:
    """(joints, 3 or 4, 4), which take columns, as (joints, 12): where x, y, z and the origin go."""
    array = np.asarray(matrices, dtype=np.float32)
    if array.ndim != 3 or array.shape[1] not in (3, 4) or array.shape[2] != 4:
        raise Error(f"an array of shape {array.shape} is not of matrices: (joints, 4, 4), or (joints, 3, 4)", 1)
    return np.ascontiguousarray(array[:, :3].transpose(0, 2, 1)).reshape(-1, 12)


def pointer(array: Any) -> Any:
    return array.ctypes.data_as(library.FLOATS if array.dtype == np.float32 else library.INTEGERS)


def numbers(values: npt.ArrayLike, width: Optional[int] = None) -> Any:
    """A single vector, or a list of numbers."""
    array = np.asarray(values, dtype=np.float32)
    if array.ndim != 1 or (width is not None and array.size != width):
        raise Error(f"an array of shape {array.shape} is not {width if width is not None else 'a list of'} numbers", 1)
    return (c_float * array.size)(*array)


def pose(pose: Pose) -> library.Pose:
    return library.Pose(numbers(pose.centre, 3), numbers(pose.normal, 3), numbers(pose.rotation, 4))


def frame(frame: Frame) -> library.Frame:
    return library.Frame(numbers(frame.place, 3), numbers(frame.rotation, 4))
