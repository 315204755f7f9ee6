"""Weft for Blender: the active mesh is simulated as cloth by the program `weft` and gets a Mesh Cache modifier with what came out.

Installed by Edit > Preferences > Add-ons > Install; then View 3D > Sidebar > Weft. Of the selected meshes the active one is the cloth, the
others are what it collides with, moving as they are animated. Nothing of the mesh is changed but for the modifier.

The simulation takes place in the cloth's own axes, with gravity and colliders turned into them: so the numbers that come back are the
mesh's own, bit by bit, whatever the object's place and rotation. A scale would make these axes' lengths no metres, and is refused.
"""

import json
import math
import os
import re
import subprocess

import bpy
from mathutils import Matrix, Vector

bl_info = {
    "name": "Weft Cloth",
    "author": "Weft",
    "version": (0, 1, 0),
    "blender": (3, 4, 0),
    "location": "View 3D > Sidebar > Weft",
    "description": "Simulates the active mesh as cloth with Weft, and plays the result by a Mesh Cache modifier",
    "category": "Physics",
}

MODIFIER = "Weft"
LARGEST_SCALE_ERROR = 1e-6   # floats


class Refusal(Exception):
    """A sentence for the user."""


def folder_of(settings):
    folder = bpy.path.abspath(settings.folder)
    if not os.path.isabs(folder):
        raise Refusal("Save the .blend first, or choose an absolute folder: \"%s\" starts at the .blend's" % settings.folder)
    return os.path.normpath(folder)


def place_of(name):
    """`name` without what a file's name cannot hold."""
    return re.sub(r"[^A-Za-z0-9_-]", "_", name) or "cloth"


def obj_text(vertices, mesh):
    """An OBJ with all vertices in their order, and the UVs, along whose axes a fabric is woven. Nine digits tell any two floats apart."""
    lines = ["v %.9g %.9g %.9g" % tuple(v) for v in vertices]
    uvs = mesh.uv_layers.active
    if uvs:
        lines += ["vt %.9g %.9g" % tuple(corner.uv) for corner in uvs.data]
    for face in mesh.polygons:
        corners = zip(face.vertices, face.loop_indices)
        lines.append("f " + " ".join("%d/%d" % (v + 1, c + 1) if uvs else "%d" % (v + 1) for v, c in corners))
    return "\n".join(lines) + "\n"


def check_scale(obj, matrix):
    if max(abs(s - 1) for s in matrix.to_scale()) > LARGEST_SCALE_ERROR or matrix.is_negative:
        raise Refusal("\"%s\" has the scale %.3g, %.3g, %.3g: apply it first (Ctrl-A, Scale)" % ((obj.name,) + tuple(matrix.to_scale())))


def pinned(obj, group_name):
    if not group_name:
        return []
    group = obj.vertex_groups.get(group_name)
    if group is None:
        raise Refusal("\"%s\" has no vertex group \"%s\"" % (obj.name, group_name))
    held = [v.index for v in obj.data.vertices if any(g.group == group.index and g.weight > 0.5 for g in v.groups)]
    if not held:
        raise Refusal("In the vertex group \"%s\" no weight is above 0.5, so that nothing is held" % group_name)
    return held


def poses_of(context, objects, frames):
    """The world matrices of the objects at the first frame and the `frames` after it."""
    scene = context.scene
    shown = scene.frame_current
    poses = {obj: [] for obj in objects}
    for k in range(frames + 1):
        scene.frame_set(scene.frame_start + k)
        depsgraph = context.evaluated_depsgraph_get()
        for obj in objects:
            poses[obj].append(obj.evaluated_get(depsgraph).matrix_world.copy())
    scene.frame_set(shown)
    return poses


def collider_of(context, obj, poses, from_world, rate, folder):
    """A mesh collider with a key a frame where the object moves. Its shape is that of the first frame."""
    scene = context.scene
    shown = scene.frame_current
    scene.frame_set(scene.frame_start)
    evaluated = obj.evaluated_get(context.evaluated_depsgraph_get())
    mesh = evaluated.to_mesh()
    in_cloth = [from_world @ pose for pose in poses]
    start = in_cloth[0]
    centre = start.to_translation()
    turned = start.to_3x3()
    text = obj_text([turned @ v.co for v in mesh.vertices], mesh) if mesh.polygons else ""
    evaluated.to_mesh_clear()
    scene.frame_set(shown)
    if not text:
        raise Refusal("\"%s\" has no face that cloth could collide with" % obj.name)
    name = "collider_" + place_of(obj.name) + ".obj"
    with open(os.path.join(folder, name), "w") as file:
        file.write(text)
    collider = {"shape": "mesh", "mesh": name, "centre": list(centre)}
    still = start.to_quaternion().inverted()
    keys = []
    for k, pose in enumerate(in_cloth):
        axis, angle = (pose.to_quaternion() @ still).to_axis_angle()
        if abs(angle) > math.pi:
            angle -= math.copysign(2 * math.pi, angle)
        keys.append({"time": k / rate, "translate": list(pose.to_translation() - centre), "axis": list(axis) if angle else [0, 0, 1],
                     "degrees": math.degrees(angle)})
    if any(pose != start for pose in in_cloth):
        collider["keys"] = keys
    return collider


def export(context, cloth, colliders, settings):
    """Writes scene.json and its meshes; returns the folder."""
    if cloth.mode == "EDIT":
        raise Refusal("Leave edit mode first")
    if not cloth.data.polygons:
        raise Refusal("\"%s\" has no face: it is no cloth" % cloth.name)
    folder = os.path.join(folder_of(settings), place_of(cloth.name))
    os.makedirs(folder, exist_ok=True)
    rate = context.scene.render.fps / context.scene.render.fps_base
    poses = poses_of(context, [cloth] + colliders, settings.frames)
    check_scale(cloth, poses[cloth][0])
    from_world = poses[cloth][0].inverted()
    gravity = from_world.to_3x3() @ (context.scene.gravity if context.scene.use_gravity else Vector((0, 0, 0)))
    with open(os.path.join(folder, "cloth.obj"), "w") as file:
        file.write(obj_text([v.co for v in cloth.data.vertices], cloth.data))
    piece = {"name": cloth.name, "mesh": "cloth.obj", "fabric": settings.fabric.lower()}
    held = pinned(cloth, settings.pins)
    if held:
        piece["anchors"] = [{"vertices": held}]
    scene = {"name": cloth.name, "frames": settings.frames, "gravity": list(gravity), "solver": {"rate": rate},
             "contacts": settings.contacts or bool(colliders), "cloths": [piece],
             "colliders": [collider_of(context, obj, poses[obj], from_world, rate, folder) for obj in colliders]}
    with open(os.path.join(folder, "scene.json"), "w") as file:
        json.dump(scene, file, indent=1)
    return folder


def run(program, folder, frames, progress):
    """Runs `weft`; its errors are sentences."""
    call = [program, "run", os.path.join(folder, "scene.json"), "--no-picture", "--out", folder, "--cache", "cloth.pc2"]
    try:
        process = subprocess.Popen(call, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, errors="replace")
    except OSError as problem:
        raise Refusal("%s cannot be run: %s" % (program, problem.strerror))
    said = []
    for line in process.stderr:
        done = re.match(r"simulating .*: (\d+) of \d+ frames", line)
        if done:
            progress(int(done.group(1)) / frames)
        elif not line.startswith("timing passes"):
            said.append(line.strip())
    if process.wait() != 0:
        raise Refusal(" ".join(said) or "%s ended with the code %d" % (program, process.returncode))
    return os.path.join(folder, "cloth.pc2")


def play(context, cloth, file):
    """Frame k of the cache is the cloth k frames after the first; before the first of them a cache shows that one."""
    modifier = cloth.modifiers.get(MODIFIER)
    if modifier is None or modifier.type != "MESH_CACHE":
        modifier = cloth.modifiers.new(MODIFIER, "MESH_CACHE")
    bpy.ops.object.modifier_move_to_index(modifier=modifier.name, index=0)   # it has the vertices of the mesh itself
    modifier.cache_format = "PC2"
    modifier.filepath = file
    modifier.frame_start = context.scene.frame_start + 1
    return modifier


class WeftSettings(bpy.types.PropertyGroup):
    program: bpy.props.StringProperty(name="Program", description="The program weft", default="weft", subtype="FILE_PATH")
    folder: bpy.props.StringProperty(name="Folder", description="Where caches go, a folder for each cloth", default="//weft", subtype="DIR_PATH")
    frames: bpy.props.IntProperty(name="Frames", description="How many frames after the scene's first are simulated", default=100, min=1,
                                  max=1000000)
    fabric: bpy.props.EnumProperty(name="Fabric", default="COTTON", items=[(name, name.capitalize(), "") for name in
                                                                           ("SILK", "COTTON", "DENIM", "LEATHER")])
    pins: bpy.props.StringProperty(name="Pins", description="The vertex group that is held where it is")
    contacts: bpy.props.BoolProperty(name="Self-collision", description="Cloth collides with itself; with colliders it always does",
                                     default=True)


class WeftSimulate(bpy.types.Operator):
    """Simulate the active mesh as cloth, with the other selected meshes as colliders"""

    bl_idname = "weft.simulate"
    bl_label = "Simulate"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        return context.active_object is not None and context.active_object.type == "MESH"

    def execute(self, context):
        cloth, settings = context.active_object, context.scene.weft
        colliders = sorted((obj for obj in context.selected_objects if obj is not cloth and obj.type == "MESH"), key=lambda obj: obj.name)
        manager = context.window_manager
        manager.progress_begin(0, 1)
        try:
            folder = export(context, cloth, colliders, settings)
            file = run(bpy.path.abspath(settings.program), folder, settings.frames, manager.progress_update)
            play(context, cloth, file)
        except Refusal as refusal:
            self.report({"ERROR"}, str(refusal))
            return {"CANCELLED"}
        except OSError as problem:
            self.report({"ERROR"}, "%s: %s" % (problem.filename, problem.strerror))
            return {"CANCELLED"}
        finally:
            manager.progress_end()
        return {"FINISHED"}


class WeftPanel(bpy.types.Panel):
    bl_idname = "VIEW3D_PT_weft"
    bl_label = "Weft"
    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "Weft"

    def draw(self, context):
        settings, layout = context.scene.weft, self.layout
        for name in ("program", "folder", "frames", "fabric"):
            layout.prop(settings, name)
        if context.active_object is not None and context.active_object.type == "MESH":
            layout.prop_search(settings, "pins", context.active_object, "vertex_groups")
        layout.prop(settings, "contacts")
        layout.operator(WeftSimulate.bl_idname)


CLASSES = (WeftSettings, WeftSimulate, WeftPanel)


def register():
    for cls in CLASSES:
        bpy.utils.register_class(cls)
    bpy.types.Scene.weft = bpy.props.PointerProperty(type=WeftSettings)


def unregister():
    del bpy.types.Scene.weft
    for cls in reversed(CLASSES):
        bpy.utils.unregister_class(cls)


if __name__ == "__main__":
    register()
