"""Blender, without a window, with what Weft writes. Run by tests/run.sh --interop:

    blender --background --factory-startup --python-exit-code 1 --python tests/interop/blender_test.py -- PROGRAM ADD-ON FOLDER

Every vertex of every frame that Blender shows is compared with the cache, bit by bit.
"""

import json
import math
import os
import random
import struct
import subprocess
import sys

import bpy
import numpy

PROGRAM, ADD_ON, FOLDER = sys.argv[sys.argv.index("--") + 1:][:3]
FRAMES = 20
numpy.bool = bool   # Debian 12's importer of glTF asks for a name that its numpy no longer has


def check(holds, sentence):
    if not holds:
        raise AssertionError(sentence)


def floats(data, offset, count, order="<"):
    return struct.unpack_from("%s%df" % (order, count), data, offset)


def read_pc2(file):
    with open(file, "rb") as stream:
        data = stream.read()
    magic, version, points, start, rate, samples = struct.unpack_from("<12siiffi", data)
    check((magic, version, start, rate) == (b"POINTCACHE2\0", 1, 1.0, 1.0), "the header of %s" % file)
    check(len(data) == 32 + 12 * points * samples, "the length of %s" % file)
    return [data[32 + 12 * points * k: 32 + 12 * points * (k + 1)] for k in range(samples)]


def shown(obj, frame):
    """The bytes of the vertices that Blender shows."""
    bpy.context.scene.frame_set(frame)
    mesh = obj.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
    numbers = [0.0] * (3 * len(mesh.vertices))
    mesh.vertices.foreach_get("co", numbers)
    return struct.pack("<%df" % len(numbers), *numbers)


def expect_played(obj, samples, first):
    check(len(samples) == FRAMES, "%d frames" % len(samples))
    for k, sample in enumerate(samples):
        check(shown(obj, first + k) == sample, "frame %d of %s is not the cache's, bit by bit" % (k + 1, obj.name))
    check(samples[0] != samples[-1], "%s does not move" % obj.name)


def sheet(name, cells=12):
    """A sheet of 1 m whose vertices are in no order at all, one of them of no face."""
    order = list(range((cells + 1) ** 2 + 1))
    random.Random(7).shuffle(order)
    places = [None] * len(order)
    for n, v in enumerate(order):
        i, j = n % (cells + 1), n // (cells + 1)
        places[v] = (i / cells - 0.5, j / cells - 0.5, 0.001 * math.sin(n)) if j <= cells else (3, 3, 3)
    at = lambda i, j: order[j * (cells + 1) + i]
    faces = [(at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)) for j in range(cells) for i in range(cells)]
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(places, [], faces)
    obj = bpy.data.objects.new(name, mesh)
    bpy.context.collection.objects.link(obj)
    pins = obj.vertex_groups.new(name="pins")
    pins.add([at(0, 0), at(cells, 0)], 1.0, "REPLACE")
    return obj


def choose(active, *others):
    bpy.ops.object.select_all(action="DESELECT")
    for obj in (active,) + others:
        obj.select_set(True)
    bpy.context.view_layer.objects.active = active


def test_add_on():
    scene = bpy.context.scene
    scene.frame_start, scene.render.fps = 11, 30
    cloth = sheet("a sheet")
    cloth.location, cloth.rotation_euler = (4, 5, 6), (0.3, 0.2, 1.1)
    bpy.ops.mesh.primitive_cube_add(size=0.4, location=(4, 5, 5.7), rotation=(0.1, 0.2, 0.3))
    cube = bpy.context.active_object
    for frame, height in ((scene.frame_start, 5.7), (scene.frame_start + FRAMES, 5.8)):
        cube.location.z = height
        cube.keyframe_insert("location", frame=frame)
    cloth.modifiers.new("finer", "SUBSURF")   # which comes after the cache, and is not simulated
    settings = scene.weft
    settings.program, settings.folder, settings.frames, settings.pins = PROGRAM, FOLDER, FRAMES, "pins"
    choose(cloth, cube)
    check(bpy.ops.weft.simulate() == {"FINISHED"}, "weft.simulate did not finish")
    check([m.name for m in cloth.modifiers] == ["Weft", "finer"], "the order of its modifiers")
    cloth.modifiers.remove(cloth.modifiers["finer"])
    modifier = cloth.modifiers["Weft"]
    check(modifier.type == "MESH_CACHE" and modifier.frame_start == 12, "its modifier")
    samples = read_pc2(modifier.filepath)
    check(len(samples[0]) == 12 * len(cloth.data.vertices), "the cache has the mesh's vertices")
    expect_played(cloth, samples, 12)

    # The simulation was of this mesh, in this order: what is held, and what has no face, has stayed where it is.
    rest = [tuple(v.co) for v in cloth.data.vertices]
    last = floats(samples[-1], 0, 3 * len(rest))
    held = [v.index for v in cloth.data.vertices if v.groups]
    loose = rest.index((3.0, 3.0, 3.0))
    for v in held + [loose]:
        check(last[3 * v: 3 * v + 3] == rest[v], "vertex %d has moved" % v)
    # Down is down in the world, though the cloth is turned.
    world = [cloth.matrix_world @ type(cloth.location)(last[3 * v: 3 * v + 3]) for v in range(len(rest)) if v != loose]
    check(sum(p.z for p in world) / len(world) < 6 - 0.05, "it has not sunk")
    # And nothing is inside of the cube.
    scene.frame_set(scene.frame_start + FRAMES)
    inside = [cube.matrix_world.inverted() @ p for p in world]
    check(max(min(0.2 - abs(p.x), 0.2 - abs(p.y), 0.2 - abs(p.z)) for p in inside) < 0.002, "it is inside of the cube")
    check(min(max(abs(p.x), abs(p.y), abs(p.z)) for p in inside) < 0.25, "and it lies on it")

    # Done again it has one modifier, and the same bits.
    check(bpy.ops.weft.simulate() == {"FINISHED"}, "weft.simulate did not finish again")
    check(len(cloth.modifiers) == 1 and read_pc2(modifier.filepath) == samples, "the same again")


def test_refusals():
    scene, cloth = bpy.context.scene, sheet("another")
    choose(cloth)

    def refusal():
        try:
            bpy.ops.weft.simulate()
        except RuntimeError as error:
            return str(error)
        raise AssertionError("it was not refused")

    scene.weft.pins = "nonesuch"
    check("has no vertex group \"nonesuch\"" in refusal(), "a group that is not there")
    scene.weft.pins = ""
    cloth.scale.x = 2
    check("apply it first" in refusal(), "a scale")
    cloth.scale.x = 1
    scene.weft.program = "/nonesuch/weft"
    check("/nonesuch/weft cannot be run: No such file or directory" in refusal(), "no program")
    scene.weft.program = PROGRAM
    scene.weft.folder = "//weft"
    check("Save the .blend first" in refusal(), "no folder")
    scene.weft.folder = FOLDER
    cloth.data.vertices[0].co.x = math.nan
    check("cloth.obj" in refusal(), "what weft says is said on")
    check("Weft" not in cloth.modifiers, "and nothing is left")


def test_command_line():
    """An OBJ that both read, and what `weft run` writes of it: PC2, MDD and GLB."""
    scene = bpy.context.scene
    scene.frame_start, scene.render.fps = 1, 60
    made = sheet("made")
    source = os.path.join(FOLDER, "source.obj")
    faces = ["f " + " ".join(str(v + 1) for v in f.vertices) for f in made.data.polygons]
    # The loose vertex of `made` is left out: importers differ in whether they keep one.
    loose = next(v.index for v in made.data.vertices if v.co.x > 2)
    numbers = lambda line: "f " + " ".join(str(int(n) - (int(n) - 1 > loose)) for n in line.split()[1:])
    with open(source, "w") as file:
        file.write("\n".join(["v %.9g %.9g %.9g" % tuple(v.co) for v in made.data.vertices if v.index != loose] +
                             [numbers(line) for line in faces]) + "\n")
    with open(os.path.join(FOLDER, "source.json"), "w") as file:
        json.dump({"name": "source", "frames": FRAMES, "cloths": [{"mesh": "source.obj", "anchors": [{"vertices": [0]}]}]}, file)
    subprocess.run([PROGRAM, "run", os.path.join(FOLDER, "source.json"), "--no-picture", "--out", FOLDER, "--cache", "source.pc2",
                    "--cache", "source.mdd", "--cache", "source.glb"], check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    bpy.ops.wm.obj_import(filepath=source, forward_axis="Y", up_axis="Z")
    obj = bpy.context.active_object
    samples = read_pc2(os.path.join(FOLDER, "source.pc2"))
    modifier = obj.modifiers.new("cache", "MESH_CACHE")
    modifier.cache_format, modifier.filepath, modifier.frame_start = "PC2", os.path.join(FOLDER, "source.pc2"), 2
    expect_played(obj, samples, 2)
    modifier.cache_format, modifier.filepath = "MDD", os.path.join(FOLDER, "source.mdd")
    expect_played(obj, samples, 2)

    bpy.ops.import_scene.gltf(filepath=os.path.join(FOLDER, "source.glb"))
    shape = bpy.context.selected_objects[0]
    check(shape.name.startswith("source"), "its name")
    blocks = shape.data.shape_keys.key_blocks
    check(len(blocks) == FRAMES + 1, "a shape key a frame and the basis")
    for k, sample in enumerate(samples):
        # A vertex of a GLB at (x, y, z), y up, is at (x, -z, y) in Blender. Times are frames of the scene here.
        there = floats(shown(shape, k + 1), 0, len(sample) // 4)
        wanted = floats(sample, 0, len(sample) // 4)
        for v in range(0, len(wanted), 3):
            x, y, z = there[v: v + 3]
            off = max(abs(x - wanted[v]), abs(z - wanted[v + 1]), abs(-y - wanted[v + 2]))
            check(off < 1e-6, "frame %d of the GLB is %g m off at vertex %d" % (k + 1, off, v // 3))


def main():
    sys.path.insert(0, os.path.dirname(ADD_ON))
    add_on = __import__(os.path.splitext(os.path.basename(ADD_ON))[0])
    add_on.register()
    bpy.ops.object.select_all(action="SELECT")
    bpy.ops.object.delete()
    tests = [test_add_on, test_refusals, test_command_line]
    for test in tests:
        test()
        print("passed: " + test.__name__)
    add_on.unregister()
    print("%d passed, 0 failed" % len(tests))


main()
