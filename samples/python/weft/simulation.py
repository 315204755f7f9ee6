"""Cloth that is simulated."""
from __future__ import annotations

import ctypes
import json
import os
from ctypes import byref, c_size_t, c_uint32, c_uint64, c_void_p
from typing import Any, Mapping, Optional, Sequence, Union

import numpy as np
import numpy.typing as npt

from . import library
from .handles import Cache, Device, Mesh, Owned, Path
from .library import Error, ask, call
from .values import (Advanced, Counts, Floats, Frame, Grabbed, Integers, Part, Pose, Quality, Reactions, Size, floats, frame, integers,
                     maps, numbers, pointer, pose)


class Simulation(Owned):
    """Cloth that is simulated: of a scene as a dict, with the keys of assets/scene.schema.json, or as JSON text.

    `meshes`: made in code, by the names that the scene's "mesh" and "render_mesh" have in place of files'. `pipeline_cache`: a file in
    which compiled pipelines are kept between runs. `timings`: gpu_milliseconds tells, which costs time.
    """
    _destroy = "simulation_destroy"

    def __init__(self, device: Device, scene: Union[str, dict[str, Any]], folder: Path = "", meshes: Optional[Mapping[str, Mesh]] = None,
                 pipeline_cache: Optional[Path] = None, timings: bool = False) -> None:
        super().__init__(device)
        text = scene if isinstance(scene, str) else json.dumps(scene)
        named = [library.NamedMesh(name.encode(), mesh._handle) for name, mesh in (meshes or {}).items()]
        options = library.Options(size=ctypes.sizeof(library.Options), meshes=(library.NamedMesh * len(named))(*named),
                                  mesh_count=len(named), timings=int(timings),
                                  pipeline_cache=None if pipeline_cache is None else os.fsencode(pipeline_cache))
        call("simulation_create_with", device._handle, text.encode(), os.fsencode(folder), byref(options), byref(self._handle))

    @classmethod
    def load(cls, device: Device, file: Path) -> Simulation:
        """Of a scene's file."""
        made = cls.__new__(cls)
        Owned.__init__(made, device)
        call("simulation_load", device._handle, os.fsencode(file), byref(made._handle))
        return made

    def advance(self, seconds: float) -> Advanced:
        """Simulates, and waits."""
        done = library.Advanced()
        call("advance", self._handle, seconds, byref(done))
        return Advanced(done.simulated, done.clamped, done.substeps, done.pairs_lost)

    def reserve_contacts(self, pairs: int) -> None:
        """Room for so many candidate pairs, where the first frames have more at once (Counts.contacts_room of a run before)."""
        call("reserve_contacts", self._handle, pairs)

    @property
    def time(self) -> float:
        """Seconds simulated so far."""
        return ask("time", self._handle)

    @property
    def gpu_milliseconds(self) -> float:
        """Of the last frame; 0 without `timings`."""
        return ask("gpu_milliseconds", self._handle)

    # What is drawn

    @property
    def vertices(self) -> int:
        return ask("positions", self._handle).count

    def _read(self, function: str, shape: tuple[int, int], out: Optional[Floats]) -> Floats:
        if out is None:
            out = np.empty(shape, np.float32)
        elif out.shape != shape or out.dtype != np.float32 or not out.flags.c_contiguous or not out.flags.writeable:
            raise Error(f"`out` must be writeable and contiguous, of float32 and of shape {shape}", 1)
        call(function, self._handle, pointer(out), shape[0])
        return out

    def _read_numbers(self, function: str, count: int) -> Integers:
        out = np.empty(count, np.uint32)
        call(function, self._handle, pointer(out), count)
        return out

    def positions(self, out: Optional[Floats] = None) -> Floats:
        """(vertices, 3), metres: of cloths, mesh colliders and render meshes."""
        return self._read("read_positions", (self.vertices, 3), out)

    def normals(self, out: Optional[Floats] = None) -> Floats:
        """(vertices, 3), unit."""
        return self._read("read_normals", (self.vertices, 3), out)

    def uvs(self) -> Floats:
        """(vertices, 2)."""
        return self._read("read_uvs", (self.vertices, 2), None)

    def triangles(self) -> Integers:
        """(triangles, 3), vertices."""
        out = np.empty((ask("triangle_count", self._handle), 3), np.uint32)
        call("triangles", self._handle, pointer(out), out.shape[0])
        return out

    def cloths(self) -> list[slice]:
        """Each cloth's vertices among all."""
        first, count = c_uint32(), c_uint32()
        slices = []
        for cloth in range(ask("cloth_count", self._handle)):
            call("cloth_vertices", self._handle, cloth, byref(first), byref(count))
            slices.append(slice(first.value, first.value + count.value))
        return slices

    def parts(self) -> list[Part]:
        """All that is drawn: cloths, mesh colliders, render meshes."""
        about, parts = library.Part(), []
        for k in range(ask("part_count", self._handle)):
            call("get_part", self._handle, k, byref(about))
            parts.append(Part(("cloth", "mesh collider", "render mesh")[about.kind], about.of,
                              slice(about.first_vertex, about.first_vertex + about.vertices),
                              slice(about.first_triangle, about.first_triangle + about.triangles),
                              [ask("joint_name", self._handle, k, joint).decode() for joint in range(about.joints)],
                              [ask("morph_name", self._handle, k, morph).decode() for morph in range(about.morphs)]))
        return parts

    def cache(self, file: Path, frames: int, rate: float = 60) -> Cache:
        """A file for other programs, by its ending (.pc2 .mdd .glb .usda .ply .obj), to which so many frames are added."""
        made = Cache(self)
        call("cache_create", self._handle, os.fsencode(file), frames, rate, byref(made._handle))
        return made

    # What a host moves, from the next frame on

    def set_gravity(self, gravity: npt.ArrayLike) -> None:
        """m/s^2."""
        call("set_gravity", self._handle, numbers(gravity, 3))

    def set_wind(self, wind: npt.ArrayLike) -> None:
        """m/s; of scenes with air."""
        call("set_wind", self._handle, numbers(wind, 3))

    def move_air_field(self, field: int, centre: npt.ArrayLike, velocity: npt.ArrayLike) -> None:
        """m, m/s; of scenes with fields of air."""
        call("move_air_field", self._handle, field, numbers(centre, 3), numbers(velocity, 3))

    @property
    def anchors(self) -> int:
        return ask("anchor_count", self._handle)

    def anchor_vertices(self) -> Integers:
        """The vertex of each."""
        return self._read_numbers("anchor_vertices", self.anchors)

    def move_anchors(self, targets: npt.ArrayLike, first: int = 0) -> None:
        """(n, 3), metres: for the next frame's end, of anchors from `first` on."""
        array = np.atleast_2d(floats(targets, 3))
        call("move_anchors", self._handle, first, pointer(array), array.shape[0])

    def pin(self, vertices: npt.ArrayLike) -> None:
        """Of scenes with `pins`."""
        array = integers(vertices)
        call("pin", self._handle, pointer(array), array.size)

    def release(self, vertices: npt.ArrayLike) -> None:
        array = integers(vertices)
        call("release", self._handle, pointer(array), array.size)

    def move_pins(self, vertices: npt.ArrayLike, targets: npt.ArrayLike) -> None:
        """Targets: (n, 3), metres."""
        array, places = integers(vertices), np.atleast_2d(floats(targets, 3))
        if places.shape[0] != array.size:
            raise Error(f"there are {places.shape[0]} targets for {array.size} vertices", 1)
        call("move_pins", self._handle, pointer(array), pointer(places), array.size)

    def grab(self, origin: npt.ArrayLike, direction: npt.ArrayLike, stiffness: float = 200, damping: float = 2,
             force: float = 20) -> Optional[Grabbed]:
        """Takes hold of cloth where a ray first meets it; None where it meets none. N/m, N s/m, N. Of scenes with `grabs`."""
        held, grip = library.Grabbed(), library.Grip(stiffness, damping, force)
        call("grab", self._handle, numbers(origin, 3), numbers(direction, 3), byref(grip), byref(held))
        if held.grab == library.NOTHING:
            return None
        return Grabbed(held.grab, held.cloth, np.array(held.point, np.float32), held.distance)

    def grab_near(self, point: npt.ArrayLike, stiffness: float = 200, damping: float = 2, force: float = 20) -> Grabbed:
        """The same where cloth is nearest to a point."""
        held, grip = library.Grabbed(), library.Grip(stiffness, damping, force)
        call("grab_near", self._handle, numbers(point, 3), byref(grip), byref(held))
        return Grabbed(held.grab, held.cloth, np.array(held.point, np.float32), held.distance)

    def cut(self, origin: npt.ArrayLike, a: npt.ArrayLike, b: npt.ArrayLike) -> int:
        """Cuts cloth that tears along a blade between two rays; how many vertices have become two. Read triangles anew then."""
        count = c_uint32()
        call("cut", self._handle, numbers(origin, 3), numbers(a, 3), numbers(b, 3), byref(count))
        return count.value

    @property
    def splits(self) -> int:
        """How many vertices have become two so far, by tearing and cutting."""
        return ask("splits", self._handle)

    def move_grab(self, grab: int, target: npt.ArrayLike) -> None:
        call("move_grab", self._handle, grab, numbers(target, 3))

    def let_go(self, grab: int) -> None:
        call("let_go", self._handle, grab)

    @property
    def colliders(self) -> int:
        return ask("collider_count", self._handle)

    def move_collider(self, collider: int, to: Pose) -> None:
        """To there until the next frame's end."""
        call("move_collider", self._handle, collider, byref(pose(to)))

    def move_colliders(self, poses: Sequence[Pose], first: int = 0) -> None:
        """Of several: all of them or, with an error, none."""
        call("move_colliders", self._handle, first, (library.Pose * len(poses))(*map(pose, poses)), len(poses))

    def place_collider(self, collider: int, at: Pose) -> None:
        """There at once, meeting no cloth on the way."""
        call("place_collider", self._handle, collider, byref(pose(at)))

    def collider(self, collider: int) -> Pose:
        now = library.Pose()
        call("collider_pose", self._handle, collider, byref(now))
        return Pose(tuple(now.centre), tuple(now.rotation), tuple(now.normal))

    def resize_collider(self, collider: int, to: Size) -> None:
        """Of colliders that the scene lets (`resizes`)."""
        given = library.Size(to.radius, to.radius_end, to.length, numbers(to.sides, 3))
        call("resize_collider", self._handle, collider, byref(given))

    def collider_size(self, collider: int) -> Size:
        now = library.Size()
        call("collider_size", self._handle, collider, byref(now))
        return Size(now.radius, now.radius_end, now.length, tuple(now.sides))

    def _take(self, function: str, count: int) -> Reactions:
        both = np.zeros((count, 6), np.float32)
        call(function, self._handle, pointer(both), count)
        return Reactions(both[:, :3], both[:, 3:])

    def take_reactions(self) -> Reactions:
        """Of each collider, about its centre; of scenes with `reactions`. Nothing is told twice."""
        return self._take("take_reactions", self.colliders)

    def take_pulls(self) -> Reactions:
        """Of each hand, about its target."""
        return self._take("take_pulls", ask("grab_count", self._handle))

    def inflate(self, cloth: int, amount: float) -> None:
        """How much gas it holds, as a multiple of the scene's `pressure`."""
        call("inflate", self._handle, cloth, amount)

    # Characters

    def set_pose(self, cloth: int, joints: npt.ArrayLike) -> None:
        """(joints, 4, 4) or (joints, 3, 4): of each the matrix from the cloth at rest to where the joint takes it, world space."""
        array = maps(joints)
        call("set_pose", self._handle, cloth, pointer(array), array.shape[0])

    def set_body_pose(self, collider: int, joints: npt.ArrayLike) -> None:
        """The same of a mesh collider, in its own axes."""
        array = maps(joints)
        call("set_body_pose", self._handle, collider, pointer(array), array.shape[0])

    def set_morphs(self, cloth: int, weights: npt.ArrayLike) -> None:
        """(morphs,): the weights of its morph targets."""
        array = numbers(weights)
        call("set_morphs", self._handle, cloth, array, len(array))

    def set_body_morphs(self, collider: int, weights: npt.ArrayLike) -> None:
        array = numbers(weights)
        call("set_body_morphs", self._handle, collider, array, len(array))

    def limit_motion(self, cloth: int, scale: float = 1, stiffness: float = 1) -> None:
        """What its max distances are multiplied by, and the stiffness of its motion constraints (0 ... 1)."""
        call("limit_motion", self._handle, cloth, scale, stiffness)

    def move_frame(self, cloth: int, to: Frame) -> None:
        """Where the frame of a cloth with `inertia` is at the next frame's end."""
        call("move_frame", self._handle, cloth, byref(frame(to)))

    def teleport(self, cloth: int, before: Frame, after: Frame) -> None:
        """From one frame to another at once, without a trace."""
        call("teleport", self._handle, cloth, byref(frame(before)), byref(frame(after)))

    # State

    @property
    def origin(self) -> Floats:
        """(3,), metres: what particles are relative to."""
        out = np.empty(3, np.float32)
        call("origin", self._handle, pointer(out))
        return out

    def particles(self, out: Optional[Floats] = None) -> Floats:
        """(particles, 4): positions, metres, relative to `origin`, and inverse masses, 1/kg."""
        return self._read("read_particles", (ask("particle_count", self._handle), 4), out)

    def velocities(self, out: Optional[Floats] = None) -> Floats:
        """(particles, 4), m/s; the fourth tells nothing."""
        return self._read("read_velocities", (ask("particle_count", self._handle), 4), out)

    def write_particles(self, positions: npt.ArrayLike) -> None:
        """(particles, 4); the fourth is not read."""
        array = np.atleast_2d(floats(positions, 4))
        call("write_particles", self._handle, pointer(array), array.shape[0])

    def write_velocities(self, velocities: npt.ArrayLike) -> None:
        array = np.atleast_2d(floats(velocities, 4))
        call("write_velocities", self._handle, pointer(array), array.shape[0])

    def vertex_particles(self) -> Integers:
        """(vertices,): the particle of each; 2^32 - 1: of a render mesh."""
        return self._read_numbers("vertex_particles", self.vertices)

    def counts(self) -> Counts:
        counts = ask("get_counts", self._handle)
        return Counts(*(getattr(counts, name) for name in Counts._fields))

    def quality(self) -> Quality:
        quality = ask("get_quality", self._handle)
        return Quality(*(getattr(quality, name) for name in Quality._fields))

    def _text(self, function: str) -> str:
        text = c_void_p()
        call(function, self._handle, byref(text))
        try:
            return ctypes.string_at(text).decode()
        finally:
            ask("free", text)

    def scene(self) -> dict[str, Any]:
        """With every key, and with what was chosen for "auto"."""
        return json.loads(self._text("scene_text"))

    def notes(self) -> list[str]:
        """What was repaired, left out or clamped when it was made: sentences."""
        return self._text("notes").splitlines()

    def hash(self) -> int:
        """64 bits over the bits of all particles' positions."""
        value = c_uint64()
        call("hash", self._handle, byref(value))
        return value.value

    def save(self) -> bytes:
        """The whole state; restoring it continues bitwise."""
        data, size = c_void_p(), c_size_t()
        call("save", self._handle, byref(data), byref(size))
        try:
            return ctypes.string_at(data, size.value)
        finally:
            ask("free", data)

    def restore(self, state: bytes) -> None:
        call("restore", self._handle, state, len(state))

    def check_fits(self, state: bytes) -> None:
        """Refuses what restore would."""
        call("fits", self._handle, state, len(state))
