"""A character that walks: a skeleton with a walk cycle, a body on it, and a skirt and a cape that go with it. See make_assets.py.

The skeleton stands upright and looks along +z; x is to its left. The walk goes on the spot: thighs swing to and fro by the sine of the
time, shins bend while their leg comes forward, hips rise twice a stride, and arms swing against the legs. All of it repeats every 1.1 s.
"""

import math

SECONDS, KEYS = 1.1, 16

# name, parent, place at rest (m)
JOINTS = [("hips", None, (0, 0.98, 0)), ("chest", 0, (0, 1.25, 0)), ("head", 1, (0, 1.52, 0)),
          ("left thigh", 0, (0.09, 0.92, 0)), ("left shin", 3, (0.09, 0.5, 0)),
          ("right thigh", 0, (-0.09, 0.92, 0)), ("right shin", 5, (-0.09, 0.5, 0)),
          ("left arm", 1, (0.2, 1.42, 0)), ("right arm", 1, (-0.2, 1.42, 0))]
HIPS, CHEST, HEAD, LEFT_THIGH, LEFT_SHIN, RIGHT_THIGH, RIGHT_SHIN, LEFT_ARM, RIGHT_ARM = range(len(JOINTS))


def about_x(angle):
    return (math.sin(angle / 2), 0.0, 0.0, math.cos(angle / 2))


def about_y(angle):
    return (0.0, math.sin(angle / 2), 0.0, math.cos(angle / 2))


def walk():
    """Channels: joint, what it moves, values at the times. The last key is the first again."""
    times = [SECONDS * k / KEYS for k in range(KEYS + 1)]
    turn = [2 * math.pi * k / KEYS for k in range(KEYS + 1)]
    channels = []
    for thigh, shin, arm, phase in ((LEFT_THIGH, LEFT_SHIN, RIGHT_ARM, 0), (RIGHT_THIGH, RIGHT_SHIN, LEFT_ARM, math.pi)):
        channels.append((thigh, "rotation", [about_x(-0.1 - 0.42 * math.sin(t + phase)) for t in turn]))
        channels.append((shin, "rotation", [about_x(0.1 + 0.75 * max(0.0, math.cos(t + phase)) ** 2) for t in turn]))
        channels.append((arm, "rotation", [about_x(-0.25 * math.sin(t + phase)) for t in turn]))
    hips = JOINTS[HIPS][2]
    channels.append((HIPS, "translation", [(hips[0], hips[1] + 0.02 * math.cos(2 * t), hips[2]) for t in turn]))
    channels.append((HIPS, "rotation", [about_y(0.12 * math.sin(t)) for t in turn]))
    channels.append((CHEST, "rotation", [about_y(-0.2 * math.sin(t)) for t in turn]))
    return times, channels


class Surface:
    """Vertices with normals, texture coordinates and influences (joint, weight), and triangles over them."""

    def __init__(self):
        self.positions, self.normals, self.uvs, self.influences, self.colours, self.triangles = [], [], [], [], [], []

    def add(self, position, normal, uv, influences, colour=(1.0, 1.0, 1.0)):
        size = math.hypot(*normal) or 1.0
        self.positions.append(position)
        self.normals.append(tuple(n / size for n in normal))
        self.uvs.append(uv)
        self.influences.append(influences)
        self.colours.append(colour)
        return len(self.positions) - 1

    def tube(self, rings, around, influences_at):
        """A closed surface through rings (centre, half width along x, half depth along z), lowest first, with a cap at either end."""
        first = len(self.positions)
        for centre, a, b in rings:
            for k in range(around):
                t = 2 * math.pi * k / around
                at = (centre[0] + a * math.sin(t), centre[1], centre[2] + b * math.cos(t))
                self.add(at, (math.sin(t) / a, 0.0, math.cos(t) / b), (0.0, 0.0), influences_at(at))
        for j in range(len(rings) - 1):
            for k in range(around):
                p, q = first + j * around + k, first + j * around + (k + 1) % around
                self.triangles += [(p, q, q + around), (p, q + around, p + around)]
        for j, up in ((0, -1.0), (len(rings) - 1, 1.0)):
            centre, a, b = rings[j]
            at = (centre[0], centre[1] + up * 0.4 * min(a, b), centre[2])
            pole = self.add(at, (0.0, up, 0.0), (0.0, 0.0), influences_at(at))
            for k in range(around):
                p, q = first + j * around + k, first + j * around + (k + 1) % around
                self.triangles.append((p, q, pole) if up > 0 else (q, p, pole))


def blend(height, low, high, below, above):
    """Influences of two joints: `below` under `low`, `above` over `high`, evenly between."""
    t = min(max((height - low) / (high - low), 0.0), 1.0)
    t = t * t * (3 - 2 * t)
    return [(above, t), (below, 1 - t)]


def limb(places):
    """Rings of a limb that hangs down: (x, height, radius), lowest first, with rings between them."""
    rings = []
    for low, high in zip(places, places[1:]):
        for k in range(4):
            x, y, r = (a + k / 4 * (b - a) for a, b in zip(low, high))
            rings.append(((x, y, 0.0), r, r))
    x, y, r = places[-1]
    return rings + [((x, y, 0.0), r, r)]


def body():
    surface = Surface()
    torso = [((0.0, y, z), a, b) for y, a, b, z in (
        (0.84, 0.10, 0.08, 0.0), (0.88, 0.15, 0.11, 0.0), (0.94, 0.165, 0.12, 0.0), (1.0, 0.155, 0.11, 0.0), (1.06, 0.135, 0.10, 0.0),
        (1.12, 0.13, 0.095, 0.0), (1.18, 0.14, 0.10, 0.0), (1.24, 0.15, 0.105, 0.0), (1.3, 0.16, 0.105, 0.0), (1.36, 0.16, 0.095, 0.0),
        (1.41, 0.14, 0.08, 0.0), (1.45, 0.09, 0.06, 0.0))]
    surface.tube(torso, 24, lambda p: blend(p[1], 1.0, 1.25, HIPS, CHEST))
    head = [((0.0, 1.6 + 0.13 * math.sin(t), 0.0), 0.09 * math.cos(t), 0.1 * math.cos(t)) for t in (-1.3, -0.9, -0.45, 0.0, 0.45, 0.9, 1.3)]
    surface.tube(head, 16, lambda p: [(HEAD, 1.0)])
    for x, thigh, shin in ((0.09, LEFT_THIGH, LEFT_SHIN), (-0.09, RIGHT_THIGH, RIGHT_SHIN)):
        def leg(p, thigh=thigh, shin=shin):
            return blend(p[1], 0.42, 0.58, shin, thigh) if p[1] < 0.7 else blend(p[1], 0.84, 0.96, thigh, HIPS)
        surface.tube(limb([(x, 0.06, 0.04), (x, 0.3, 0.05), (x, 0.5, 0.055), (x, 0.7, 0.07), (x, 0.88, 0.082)]), 14, leg)
    for side, arm in ((1, LEFT_ARM), (-1, RIGHT_ARM)):
        surface.tube(limb([(side * 0.37, 0.92, 0.028), (side * 0.29, 1.14, 0.034), (side * 0.205, 1.36, 0.042)]), 12,
                     lambda p, arm=arm: blend(p[1], 1.34, 1.42, arm, CHEST))
    return surface


def skirt():
    """A circular skirt from the waist to the knees, without a seam. Red says how far a vertex may go: nowhere at the waist."""
    around, rows, top, length = 72, 24, 1.03, 0.5
    surface = Surface()
    for j in range(rows + 1):
        down = j / rows
        for k in range(around):
            t = 2 * math.pi * k / around
            a, b = 0.155 + 0.2 * down, 0.115 + 0.225 * down
            at = (a * math.sin(t), top - length * down, b * math.cos(t))
            side = 0.5 + 0.5 * math.tanh(at[0] / 0.12)
            share = 0.6 * down * down
            influences = [(HIPS, 1 - share), (LEFT_THIGH, share * side), (RIGHT_THIGH, share * (1 - side))]
            reach = min(1.0, down * 1.6)
            surface.add(at, (math.sin(t) / a, 0.45, math.cos(t) / b), (1.4 * k / around, length * down), influences, (reach, reach, reach))
    for j in range(rows):
        for k in range(around):
            p, q = j * around + k, j * around + (k + 1) % around
            below_p, below_q = p + around, q + around
            surface.triangles += [(p, below_p, q), (q, below_p, below_q)] if (j + k) % 2 else [(p, below_p, below_q), (p, below_q, q)]
    return surface


def cape():
    """A sheet that hangs from the shoulders down the back, round them like a horseshoe."""
    columns, rows, top, length = 36, 40, 1.4, 0.85
    surface = Surface()
    for j in range(rows + 1):
        down = j / rows
        for k in range(columns + 1):
            t = math.pi * (k / columns - 0.5) * 0.7
            a, b = 0.19 + 0.22 * down, 0.115 + 0.28 * down   # outside of the skirt
            at = (a * math.sin(t), top - length * down, -b * math.cos(t))
            reach = min(1.0, down * 1.5)
            surface.add(at, (math.sin(t) / a, 0.1, -math.cos(t) / b), (0.6 * k / columns, length * down), [(CHEST, 1.0)],
                        (reach, reach, reach))
    for j in range(rows):
        for k in range(columns):
            p = j * (columns + 1) + k
            q, below_p, below_q = p + 1, p + columns + 1, p + columns + 2
            surface.triangles += [(p, q, below_p), (q, below_q, below_p)] if (j + k) % 2 else [(p, q, below_q), (p, below_q, below_p)]
    return surface


def skeleton(add, accessors):
    """The nodes, the skin and the animation of a glTF whose node 0 shows the mesh. `add` stores rows and returns their accessor."""
    nodes = []
    for number, (name, parent, place) in enumerate(JOINTS):
        base = JOINTS[parent][2] if parent is not None else (0.0, 0.0, 0.0)
        node = {"name": name, "translation": [a - b for a, b in zip(place, base)]}
        children = [k + 1 for k, joint in enumerate(JOINTS) if joint[1] == number]
        if children:
            node["children"] = children
        nodes.append(node)
    inverse = add([(1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, -x, -y, -z, 1) for _, _, (x, y, z) in JOINTS], "MAT4")
    skin = {"joints": [k + 1 for k in range(len(JOINTS))], "inverseBindMatrices": inverse, "skeleton": 1}
    times, channels = walk()
    stamps = add([(t,) for t in times], "SCALAR")
    accessors[stamps].update(min=[times[0]], max=[times[-1]])
    animation = {"name": "walk", "samplers": [], "channels": []}
    for joint, path, values in channels:
        animation["channels"].append({"sampler": len(animation["samplers"]), "target": {"node": joint + 1, "path": path}})
        animation["samplers"].append({"input": stamps, "output": add(values, "VEC4" if path == "rotation" else "VEC3"), "interpolation": "LINEAR"})
    return nodes, skin, animation
