#!/usr/bin/env python3
"""Makes the meshes and textures that Weft's scenes use.

    curtain.glb      two panels, 2.4 m x 2.0 m, 97 x 73 places, sewn along a UV seam; upright, its hem on y = 0
    tablecloth.glb   one square sheet, 2 m x 2 m, 65 x 65 places, 32-bit indices; flat, on y = 0
    pleats.glb       a skirt of 24 pleats, 0.55 m long, sewn along a UV seam; its waist up, its hem on y = 0
    table.glb        a table, 0.9 m x 0.9 m, 0.72 m high, on y = 0: one closed surface with hard edges
    balloon.glb      a closed ball, 0.5 m across, of a cube's six sides with 16 x 16 cells each; its middle at the origin
    cushion.glb      two square sheets, 0.5 m x 0.5 m, 33 x 33 places, sewn together all around and 2 cm apart in the middle; upright
    disc.glb         a disc, 30 cm across, in cells of 5 mm; flat, on y = 0; its colour is 1 within 9 cm, which a drape meter's plate holds
    table_linen.glb  two panels, 1.5 m x 1.5 m, 61 x 61 places, sewn along a UV seam; flat, on y = 0
    quilt.glb        a padded quilt, 1.2 m x 1.2 m, closed, 2 x 97 x 97 places; flat, its middle on y = 0
    sleeper.glb      a sleeper under a blanket as a mound, 0.9 m x 1.3 m; morph targets that breathe and turn, and an animation of their weights
    body.glb, skirt.glb, cape.glb
                     a character that walks on the spot, and what it wears: a skin over one skeleton, a walk cycle (character.py)
    plain_weave_*.png, twill_*.png
                     a woven fabric that tiles: albedo (sRGB), normal (tangent space, green up), roughness, occlusion
    banner.png       a picture, to show that any picture can be put on a cloth

Texture coordinates of the meshes are metres, so a `repeat` of 4 puts a tile on every 25 cm whatever the mesh's size.
Needs Python's standard library only. Two runs write the same bytes; a file appears under its name only when it is whole.
"""

import argparse
import json
import math
import os
import random
import struct
import zlib
from pathlib import Path

import character

TILE = 512          # texels a side
YARNS = 32          # of each kind a tile: a multiple of 4, so that a twill of four tiles
PITCH = TILE // YARNS


def save(path, content):
    """Writes under a temporary name first: whoever reads `path` meanwhile sees the old file or the new one, never half."""
    part = path.with_name(f"{path.name}.{os.getpid()}.part")
    part.write_bytes(content)
    os.replace(part, path)


# ---- PNG: ISO/IEC 15948

def png(width, height, channels, samples):
    """8-bit grey (1 channel) or RGB (3); `samples` is row after row, top first."""
    def chunk(kind, content):
        return struct.pack(">I", len(content)) + kind + content + struct.pack(">I", zlib.crc32(kind + content))

    stride = width * channels
    rows = b"".join(b"\0" + samples[y * stride:(y + 1) * stride] for y in range(height))
    header = struct.pack(">IIBBBBB", width, height, 8, {1: 0, 3: 2}[channels], 0, 0, 0)
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"sRGB", b"\0") * (channels == 3)
            + chunk(b"IDAT", zlib.compress(rows, 6)) + chunk(b"IEND", b""))


# ---- GLB: the Khronos glTF 2.0 specification, sections 3.6 and 4

FLOAT, UINT16, UINT32 = 5126, 5123, 5125
ARRAY_BUFFER, ELEMENT_ARRAY_BUFFER = 34962, 34963


def glb(name, positions, normals, uvs, triangles, wide_indices, influences=None, colours=None, morphs=None, breath=None):
    """`influences`: of each vertex up to four (joint, weight) of the character's skeleton. `morphs`: for each target its name and how far it
    moves every vertex, and turns its normal. `breath`: times, and for each the weights of all of them, between which they go smoothly."""
    binary, views, accessors = b"", [], []

    def store(rows, code, target=None):
        nonlocal binary
        packed = b"".join(struct.pack(f"<{len(row)}{code}", *row) for row in rows)
        views.append({"buffer": 0, "byteOffset": len(binary), "byteLength": len(packed)})
        if target is not None:
            views[-1]["target"] = target
        binary += packed + b"\0" * (-len(packed) % 4)
        return len(views) - 1

    def bounds(rows):   # in the precision they are stored in
        stored = [struct.unpack(f"<{len(row)}f", struct.pack(f"<{len(row)}f", *row)) for row in rows]
        return {"min": [min(axis) for axis in zip(*stored)], "max": [max(axis) for axis in zip(*stored)]}

    def add(rows, kind, code, component, target=None):
        count = len(rows) * (len(rows[0]) if kind == "SCALAR" else 1)
        accessor = {"bufferView": store(rows, code, target), "componentType": component, "count": count, "type": kind}
        if not accessors:   # positions come first, and they must state their bounds
            accessor.update(bounds(rows))
        accessors.append(accessor)
        return len(accessors) - 1

    def add_sparse(rows):   # what is not zero
        places = [k for k, row in enumerate(rows) if any(row)]
        accessors.append({"componentType": FLOAT, "count": len(rows), "type": "VEC3", **bounds(rows),
                          "sparse": {"count": len(places),
                                     "indices": {"bufferView": store([(k,) for k in places], "H"), "componentType": UINT16},
                                     "values": {"bufferView": store([rows[k] for k in places], "f")}}})
        return len(accessors) - 1

    attributes = {"POSITION": add(positions, "VEC3", "f", FLOAT, ARRAY_BUFFER),
                  "NORMAL": add(normals, "VEC3", "f", FLOAT, ARRAY_BUFFER),
                  "TEXCOORD_0": add(uvs, "VEC2", "f", FLOAT, ARRAY_BUFFER)}
    nodes, more = [{"name": name, "mesh": 0}], {}
    if colours:
        attributes["COLOR_0"] = add(colours, "VEC3", "f", FLOAT, ARRAY_BUFFER)
    if influences:
        four = [(list(some) + [(0, 0.0)] * 4)[:4] for some in influences]
        attributes["JOINTS_0"] = add([tuple(joint for joint, _ in some) for some in four], "VEC4", "H", UINT16, ARRAY_BUFFER)
        attributes["WEIGHTS_0"] = add([tuple(weight for _, weight in some) for some in four], "VEC4", "f", FLOAT, ARRAY_BUFFER)
        joints, skin, animation = character.skeleton(lambda rows, kind: add(rows, kind, "f", FLOAT), accessors)
        nodes[0]["skin"] = 0
        nodes += joints
        more = {"skins": [skin], "animations": [animation]}
    primitive, mesh = {"attributes": attributes}, {"name": name}
    if morphs:
        primitive["targets"] = [{"POSITION": add_sparse(moves), "NORMAL": add_sparse(turns)} for _, moves, turns in morphs]
        mesh.update(weights=breath[1][0], extras={"targetNames": [target for target, _, _ in morphs]})
        stamps = add([(t,) for t in breath[0]], "SCALAR", "f", FLOAT)
        accessors[stamps].update(min=[breath[0][0]], max=[breath[0][-1]])
        still = [(0.0,)] * len(morphs)   # no tangents
        weights = add([row for values in breath[1] for row in still + [(w,) for w in values] + still], "SCALAR", "f", FLOAT)
        more = {"animations": [{"name": "breath",
                                "samplers": [{"input": stamps, "output": weights, "interpolation": "CUBICSPLINE"}],
                                "channels": [{"sampler": 0, "target": {"node": 0, "path": "weights"}}]}]}
    indices = add(triangles, "SCALAR", "I" if wide_indices else "H", UINT32 if wide_indices else UINT16, ELEMENT_ARRAY_BUFFER)
    document = {
        "asset": {"version": "2.0", "generator": "Weft assets/make_assets.py"},
        "scene": 0, "scenes": [{"nodes": [0, 1] if influences else [0]}], "nodes": nodes, **more,
        "meshes": [{**mesh, "primitives": [{**primitive, "indices": indices, "material": 0}]}],
        "materials": [{"name": "cloth", "doubleSided": True,
                       "pbrMetallicRoughness": {"metallicFactor": 0, "roughnessFactor": 0.9}}],
        "accessors": accessors, "bufferViews": views, "buffers": [{"byteLength": len(binary)}]}
    text = json.dumps(document, separators=(",", ":")).encode()
    text += b" " * (-len(text) % 4)
    return (struct.pack("<4sII", b"glTF", 2, 28 + len(text) + len(binary))
            + struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(binary), b"BIN\0") + binary)


def sheet_triangles(columns, rows, first, cell):
    """Two triangles a cell. The diagonal changes from cell to cell, so that the sheet shears alike both ways."""
    triangles = []
    for j in range(rows):
        for i in range(columns):
            a = first + j * (columns + 1) + i
            b, c, d = a + 1, a + columns + 1, a + columns + 2
            triangles += [(a, b, d), (a, d, c)] if (i + cell + j) % 2 == 0 else [(a, b, c), (b, d, c)]
    return triangles


def sewn_panels(name, width, height, columns, rows, place, normal):
    """Two panels of `columns` each, side by side: the vertices of the seam are there twice, at one place with two texture coordinates.
    `place` takes what is right of the middle and above the hem (m) into space."""
    positions, uvs, triangles = [], [], []
    for panel in range(2):
        triangles += sheet_triangles(columns, rows, len(positions), panel * columns)
        for j in range(rows + 1):
            for i in range(columns + 1):
                positions.append(place(width * ((panel * columns + i) / (2 * columns) - 0.5), height * j / rows))
                uvs.append((0.5 * width * i / columns, height * (1 - j / rows)))
    return glb(name, positions, [normal] * len(positions), uvs, triangles, wide_indices=False)


def on_skeleton(name, surface):
    return glb(name, surface.positions, surface.normals, surface.uvs, surface.triangles, False, surface.influences, surface.colours)


def curtain():
    return sewn_panels("curtain", 2.4, 2.0, 48, 72, lambda x, y: (x, y, 0.0), (0.0, 0.0, 1.0))


def table_linen():
    return sewn_panels("table linen", 1.5, 1.5, 30, 60, lambda x, y: (x, 0.0, 0.75 - y), (0.0, 1.0, 0.0))


def tablecloth():
    side, cells = 2.0, 64
    positions, uvs = [], []
    for j in range(cells + 1):
        for i in range(cells + 1):
            positions.append((side * (i / cells - 0.5), 0.0, side * (0.5 - j / cells)))
            uvs.append((side * i / cells, side * (1 - j / cells)))
    return glb("tablecloth", positions, [(0.0, 1.0, 0.0)] * len(positions), uvs, sheet_triangles(cells, cells, 0, 0),
               wide_indices=True)


def pleats():
    """Folds between an outer and an inner ring, four flat strips a pleat; they are deeper at the hem than at the waist."""
    count, rows, length = 24, 28, 0.55
    columns = 4 * count

    def place(i, j):
        down = 1 - j / rows
        middle, depth = 0.13 + 0.12 * down, 0.012 + 0.038 * down
        fold, between = divmod(i, 2)   # folds are the even columns, by turns outer and inner ones

        def corner(k):
            turn, radius = math.pi * k / count, middle + (0.5 if k % 2 == 0 else -0.5) * depth
            return radius * math.sin(turn), radius * math.cos(turn)

        ends = corner(fold % (2 * count)), corner((fold + between) % (2 * count))
        return (ends[0][0] + ends[1][0]) / 2, length * (1 - down), (ends[0][1] + ends[1][1]) / 2

    positions, normals, uvs = [], [], []
    for j in range(rows + 1):
        for i in range(columns + 1):
            x, y, z = place(i, j)
            positions.append((x, y, z))
            normals.append((x / math.hypot(x, z), 0.0, z / math.hypot(x, z)))
            uvs.append((0.03 * i, length * (1 - j / rows)))
    return glb("pleats", positions, normals, uvs, sheet_triangles(columns, rows, 0, 0), wide_indices=False)


def disc():
    """The triangles of a lattice that lie within a circle: its rim is jagged by half a cell, and so is that of what is held."""
    radius, plate, cells = 0.15, 0.09, 60
    cell = 2 * radius / cells
    places = [(cell * (i - cells / 2), cell * (cells / 2 - j)) for j in range(cells + 1) for i in range(cells + 1)]
    inside = [t for t in sheet_triangles(cells, cells, 0, 0) if math.hypot(*(sum(places[v][k] for v in t) / 3 for k in (0, 1))) < radius]
    used = sorted({v for t in inside for v in t})
    number = {v: k for k, v in enumerate(used)}
    positions = [(places[v][0], 0.0, places[v][1]) for v in used]
    held = [(float(math.hypot(*places[v]) < plate + 0.25 * cell),) * 3 for v in used]
    return glb("disc", positions, [(0.0, 1.0, 0.0)] * len(positions), [(x + radius, z + radius) for x, _, z in positions],
               [tuple(number[v] for v in t) for t in inside], wide_indices=False, colours=held)


def quilt():
    """Two layers over squares of padding, sewn together along the lines between these and at the rim."""
    side, cells, squares = 1.2, 96, 8
    step = side / cells

    def height(i, j):
        return math.sqrt(abs(math.sin(math.pi * squares * i / cells) * math.sin(math.pi * squares * j / cells)))

    positions, normals, uvs, triangles = [], [], [], []
    for up in (0.022, -0.012):
        sheet = sheet_triangles(cells, cells, len(positions), 0)
        triangles += sheet if up > 0 else [(a, c, b) for a, b, c in sheet]
        for j in range(cells + 1):
            for i in range(cells + 1):
                positions.append((side * (i / cells - 0.5), up * height(i, j), side * (0.5 - j / cells)))
                across = up * (height(min(i + 1, cells), j) - height(max(i - 1, 0), j)) / (2 * step)
                along = up * (height(i, min(j + 1, cells)) - height(i, max(j - 1, 0))) / (2 * step)
                turned, length = (1.0 if up > 0 else -1.0), math.sqrt(across * across + along * along + 1)
                normals.append((-turned * across / length, turned / length, turned * along / length))
                uvs.append((side * i / cells, side * (1 - j / cells)))
    return glb("quilt", positions, normals, uvs, triangles, wide_indices=False)


def table():
    """Blocks of a grid, and the faces between a block and nothing: so the surface is closed, whatever the blocks are."""
    blocks, storeys, side, leg, top = 12, 9, 0.9, 0.68, 0.04
    heights = [leg * k / storeys for k in range(storeys + 1)] + [leg + top]

    def filled(block):
        i, j, k = block
        if not (0 <= i < blocks and 0 <= k < blocks and 0 <= j <= storeys):
            return False
        return j == storeys or (i in (1, blocks - 2) and k in (1, blocks - 2))

    def corner(i, j, k):
        return side * (i / blocks - 0.5), heights[j], side * (k / blocks - 0.5)

    positions, normals, uvs, triangles, vertices = [], [], [], [], {}
    for j in range(storeys + 1):
        for k in range(blocks):
            for i in range(blocks):
                if not filled((i, j, k)):
                    continue
                for axis in range(3):
                    for end in (0, 1):
                        beyond = [i, j, k]
                        beyond[axis] += 2 * end - 1
                        if filled(beyond):
                            continue
                        normal = tuple(float(2 * end - 1) if n == axis else 0.0 for n in range(3))
                        u, v = (axis + 1) % 3, (axis + 2) % 3     # u, v and the axis are right-handed
                        face = []
                        for du, dv in ((0, 0), (1, 0), (1, 1), (0, 1)):
                            at = [i, j, k]
                            at[axis] += end
                            at[u] += du
                            at[v] += dv
                            # Each direction has vertices of its own: the edges of the table are hard.
                            vertex = vertices.setdefault((*at, normal), len(positions))
                            if vertex == len(positions):
                                place = corner(*at)
                                positions.append(place)
                                normals.append(normal)
                                uvs.append((place[u], place[v]))
                            face.append(vertex)
                        a, b, c, d = face if end else reversed(face)
                        triangles += [(a, b, c), (a, c, d)] if (i + j + k) % 2 == 0 else [(a, b, d), (b, c, d)]
    return glb("table", positions, normals, uvs, triangles, wide_indices=False)


def balloon():
    cells, radius = 16, 0.25
    positions, normals, uvs, triangles = [], [], [], []
    for axis in range(3):
        for end in (-1.0, 1.0):
            first = len(positions)
            for j in range(cells + 1):
                for i in range(cells + 1):
                    # Even in the angle, so that cells near a cube's corner are not much smaller than others.
                    across = [math.tan(math.pi / 4 * (2 * k / cells - 1)) for k in ((i, j) if end > 0 else (j, i))]
                    place = [0.0, 0.0, 0.0]
                    place[axis], place[(axis + 1) % 3], place[(axis + 2) % 3] = end, across[0], across[1]
                    length = math.hypot(*place)
                    normals.append(tuple(x / length for x in place))
                    positions.append(tuple(radius * x / length for x in place))
                    uvs.append((math.pi / 2 * radius * i / cells, math.pi / 2 * radius * j / cells))
            # A cell's corner (i, j) is followed along i and then along j by the right hand, seen from outside.
            def cell(a, b, c, d, i, j):
                return [(a, b, d), (a, d, c)] if (i < cells // 2) == (j < cells // 2) else [(a, b, c), (b, d, c)]
            for j in range(cells):
                for i in range(cells):
                    a = first + j * (cells + 1) + i
                    triangles += cell(a, a + 1, a + cells + 1, a + cells + 2, i, j)
    return glb("balloon", positions, normals, uvs, triangles, wide_indices=False)


def cushion():
    cells, size, bulge = 32, 0.5, 0.01
    positions, normals, uvs, triangles = [], [], [], []
    for side in (1, -1):
        first = len(positions)
        for j in range(cells + 1):
            for i in range(cells + 1):
                u, v = i / cells, j / cells
                height = bulge * math.sin(math.pi * u) * math.sin(math.pi * v)
                positions.append((size * (u - 0.5), size * (v - 0.5), side * height))
                normals.append((0.0, 0.0, float(side)))
                uvs.append((size * u, size * (1 - v)))
        for j in range(cells):
            for i in range(cells):
                a = first + j * (cells + 1) + i
                b, c, d = a + 1, a + cells + 1, a + cells + 2
                # Diagonals towards the nearer corner, in which no triangle then has both of its sides sewn.
                cut = [(a, b, d), (a, d, c)] if (i < cells // 2) == (j < cells // 2) else [(a, b, c), (b, d, c)]
                triangles += cut if side > 0 else [(x, z, y) for x, y, z in cut]
    return glb("cushion", positions, normals, uvs, triangles, wide_indices=False)


def sleeper():
    columns, rows, width, length = 24, 34, 0.9, 1.3

    def hump(x, z, at, reach):   # 1 in the middle, 0 from `reach` on
        distance = math.hypot((x - at[0]) / reach[0], (z - at[1]) / reach[1])
        return 0.5 + 0.5 * math.cos(math.pi * distance) if distance < 1 else 0.0

    def lying(x, z):
        return (x, 0.19 * hump(x, z, (0, 0.05), (0.38, 0.62)), z)

    def breathing_in(x, z):   # the chest rises and widens
        _, y, _ = lying(x, z)
        part = hump(x, z, (0, -0.12), (0.3, 0.28))
        return (x + 0.1 * x * part, y + 0.05 * part, z)

    def turning(x, z):        # the knees go to the side
        _, y, _ = lying(x, z)
        return (x + 0.08 * hump(x, z, (0, 0.35), (0.3, 0.25)), y, z)

    def surface(place):
        points, normals = [], []
        for j in range(rows + 1):
            for i in range(columns + 1):
                x, z, step = width * (i / columns - 0.5), length * (j / rows - 0.5), 1e-4
                points.append(place(x, z))
                a, b = ([p - q for p, q in zip(place(x + dx, z + dz), place(x - dx, z - dz))] for dx, dz in ((step, 0), (0, step)))
                n = (b[1] * a[2] - b[2] * a[1], b[2] * a[0] - b[0] * a[2], b[0] * a[1] - b[1] * a[0])
                normals.append(tuple(c / math.hypot(*n) for c in n))
        return points, normals

    def between(rows_from, rows_to):
        return [tuple(b - a if abs(b - a) > 1e-7 else 0.0 for a, b in zip(p, q)) for p, q in zip(rows_from, rows_to)]

    positions, normals = surface(lying)
    uvs = [(x + width / 2, z + length / 2) for x, _, z in positions]
    triangles = [(a, c, b) for a, b, c in sheet_triangles(columns, rows, 0, 0)]
    morphs = []
    for name, place in (("breath", breathing_in), ("turn", turning)):
        points, turned = surface(place)
        morphs.append((name, between(positions, points), between(normals, turned)))
    times = [0.0, 1.4, 3.2, 4.6, 6.4]
    weights = [[0.0, 0.0], [1.0, 0.0], [0.0, 0.5], [1.0, 1.0], [0.0, 0.0]]
    return glb("sleeper", positions, normals, uvs, triangles, wide_indices=False, morphs=morphs, breath=(times, weights))


# ---- Fabric: a height field of yarns, and four maps taken from it

def periodic_noise(rng, count, step):
    """`count` values in -1 ... 1 that join end to start; neighbours within `step` are alike."""
    knots = [rng.uniform(-1, 1) for _ in range(count // step)]
    values = []
    for k in range(count):
        knot, fraction = divmod(k, step)
        t = fraction / step
        t = t * t * (3 - 2 * t)
        values.append(knots[knot] * (1 - t) + knots[(knot + 1) % len(knots)] * t)
    return values


class Yarns:
    """The yarns of one direction: where each runs, how it rises and falls, what it looks like along its length."""

    def __init__(self, rng, over, crimp, unevenness):
        self.rise, self.wander, self.shade, self.twist = [], [], [], []
        for yarn in range(YARNS):
            # Over or under at the middle of each crossing, a cosine in between.
            level = [1.0 if over(yarn, crossing) else -1.0 for crossing in range(YARNS)]
            rise = []
            for k in range(TILE):
                crossing, texel = divmod(k - PITCH // 2, PITCH)
                t = 0.5 - 0.5 * math.cos(math.pi * texel / PITCH)
                rise.append(crimp * (level[crossing % YARNS] * (1 - t) + level[(crossing + 1) % YARNS] * t))
            self.rise.append(rise)
            self.wander.append([0.6 * n for n in periodic_noise(rng, TILE, 64)])
            # Spun yarn is never even: each has its own tone, and thicker, paler stretches (slubs).
            tone = rng.uniform(-1, 1)
            slub = periodic_noise(rng, TILE, 128)
            fine = periodic_noise(rng, TILE, 16)
            self.shade.append([1 + unevenness * (0.6 * tone + 0.5 * slub[k] + 0.3 * fine[k]) for k in range(TILE)])
            self.twist.append(rng.randrange(1024))


def weave(seed, over, warp_colour, weft_colour, unevenness, broad, sunk):
    """Height, colour and gloss of every texel, for `over(i, j)`: warp i lies over weft j.

    Warps run along the image's columns. A yarn's cross-section is a rounded arch that reaches `broad` texels to either side
    of its middle, so neighbours overlap a little; wefts lie `sunk` texels lower. Fibres wind round a yarn, so streaks run
    askew across it. Where two yarns cross, the higher one is seen.
    """
    rng = random.Random(seed)
    crown, crimp = 5.0, 3.0        # texels: height of the arch; how far its yarn rises over a crossing and dips under the next
    arch = [crown * max(0.0, 1 - ((k - 512) / 512) ** 2) ** 0.58 for k in range(1024)]
    lean = [int(26 * math.asin(max(-1.0, min(1.0, (k - 512) / 512)))) for k in range(1024)]
    fibre = [0.6 * a + 0.4 * b for a, b in zip(periodic_noise(rng, 1024, 8), periodic_noise(rng, 1024, 2))]
    warps = Yarns(rng, over, crimp, unevenness)
    wefts = Yarns(rng, lambda j, i: not over(i, j), crimp, unevenness)
    fuzz = [rng.uniform(-1, 1) for _ in range(4096)]

    half = PITCH / 2

    def highest(yarns, yarn, offset, along):
        """The yarn of one direction that is on top `offset` texels from the middle of `yarn`: itself or, near the rim, the next."""
        best = None
        near = offset + yarns.wander[yarn][along]
        for other, distance in ((yarn, near), (yarn + 1, near - PITCH), (yarn - 1, near + PITCH)):
            if -broad < distance < broad:
                other %= YARNS
                where = int(distance * 511 / broad) + 512
                height = yarns.rise[other][along] + arch[where] - (sunk if yarns is wefts else 0)
                if best is None or height > best[0]:
                    best = height, other, where
        return best

    heights, albedo, gloss = [], bytearray(), []
    for y in range(TILE):
        across_y = y % PITCH + 0.5 - half
        noise_row = rng.randrange(4096)
        for x in range(TILE):
            warp_height, i, u = highest(warps, x // PITCH, x % PITCH + 0.5 - half, y)
            weft_height, j, v = highest(wefts, y // PITCH, across_y, x)
            if warp_height > weft_height:
                height, arched, shade, colour = warp_height, arch[u], warps.shade[i][y], warp_colour
                streak = fibre[(lean[u] + 2 * y + warps.twist[i]) & 1023]
            else:
                height, arched, shade, colour = weft_height, arch[v], wefts.shade[j][x], weft_colour
                streak = fibre[(lean[v] + 2 * x + wefts.twist[j]) & 1023]
            grain = streak + 0.35 * fuzz[(noise_row + 7 * x) & 4095]
            heights.append(height + 0.35 * grain)
            tint = shade * (1 + 0.13 * grain) * (0.80 + 0.04 * arched)
            gloss.append(0.02 * arched + 0.03 * grain)
            for channel in colour:
                value = int(channel * tint)
                albedo.append(255 if value > 255 else value)
    return heights, bytes(albedo), gloss


def blurred(field, radius):
    """Mean over a square of 2 radius + 1 texels that wraps around, by running sums, rows and then columns."""
    span = 2 * radius + 1
    for _ in range(2):
        lines = []
        for start in range(0, TILE * TILE, TILE):
            line = field[start:start + TILE]
            line = line[-radius:] + line + line[:radius]
            total = sum(line[:span])
            out = [total]
            for gone, come in zip(line, line[span:]):
                total += come - gone
                out.append(total)
            lines.append(out)
        field = [value / span for column in zip(*lines) for value in column]   # transposed, so twice gives rows again
    return field


def normal_map(heights, strength):
    out = bytearray()
    for y in range(TILE):
        row = heights[y * TILE:(y + 1) * TILE]
        above = heights[(y - 1) % TILE * TILE:][:TILE]
        below = heights[(y + 1) % TILE * TILE:][:TILE]
        for left, right, up, down in zip(row[-1:] + row[:-1], row[1:] + row[:1], above, below):
            nx = strength * (left - right)
            ny = strength * (down - up)          # rows go down, green goes up
            scale = 127 / math.sqrt(nx * nx + ny * ny + 1)
            out += bytes((int(128 + nx * scale), int(128 + ny * scale), int(128 + scale)))
    return bytes(out)


def to_bytes(values):
    return bytes(0 if v < 0 else 255 if v > 1 else int(255 * v + 0.5) for v in values)


def fabric(name, roughness, **weaving):
    heights, albedo, gloss = weave(**weaving)
    # What lies below its surroundings sees less of the sky: near yarns count more than far ones.
    near, far = blurred(heights, 3), blurred(heights, 9)
    occlusion = to_bytes(1 - 0.14 * max(0.0, n - h) - 0.08 * max(0.0, f - h) for h, n, f in zip(heights, near, far))
    return {f"{name}_albedo.png": png(TILE, TILE, 3, albedo),
            f"{name}_normal.png": png(TILE, TILE, 3, normal_map(heights, 0.30)),
            f"{name}_roughness.png": png(TILE, TILE, 1, to_bytes(roughness - g for g in gloss)),
            f"{name}_occlusion.png": png(TILE, TILE, 1, occlusion)}


def plain_weave():
    """One over, one under: undyed linen, pale enough that a base colour can dye it."""
    return fabric("plain_weave", 0.86, seed=1, over=lambda i, j: (i + j) % 2 == 0, warp_colour=(226, 217, 199),
                  weft_colour=(219, 209, 189), unevenness=0.075, broad=8.6, sunk=0)


def twill():
    """Denim, a warp-faced 3/1 twill: indigo warps over three wefts and under one, undyed wefts showing through."""
    return fabric("twill", 0.90, seed=2, over=lambda i, j: (i + j) % 4 != 0, warp_colour=(60, 77, 114),
                  weft_colour=(166, 172, 178), unevenness=0.17, broad=10, sunk=1.2)


# ---- Banner

def mix(a, b, t):
    t = 0.0 if t < 0 else 1.0 if t > 1 else t
    return tuple(p + (q - p) * t for p, q in zip(a, b))


def banner():
    """Stripes at both ends, and a roundel in which three warps and three wefts are woven. Edges are one texel soft."""
    width, height = 768, 512
    field, ivory, gold, navy = (148, 32, 40), (240, 230, 208), (214, 164, 62), (26, 38, 74)
    out = bytearray()
    for row in range(height):
        y = row + 0.5 - height / 2
        for column in range(width):
            x = column + 0.5 - width / 2
            edge = min(width / 2 - abs(x), height / 2 - abs(y))
            colour = field
            if abs(x) > 230:
                band = (abs(x) - 230) % 52
                colour = mix(field, ivory, min(band - 20, 46 - band) + 0.5)
            radius = math.hypot(x, y)
            if radius < 202:
                colour = mix(gold, colour, radius - 200)
                colour = mix(ivory, colour, radius - 190)
                colour = mix(navy, colour, radius - 178)
                if radius < 172:
                    i, j = math.floor((x + 110) / 73.34), math.floor((y + 110) / 73.34)
                    u, v = (x + 110) - 73.34 * (i + 0.5), (y + 110) - 73.34 * (j + 0.5)
                    inside = mix((0,), (1,), 168 - radius)[0]
                    warp = inside * mix((0,), (1,), 25 - abs(u))[0] if 0 <= i < 3 else 0
                    weft = inside * mix((0,), (1,), 25 - abs(v))[0] if 0 <= j < 3 else 0
                    # The yarn on top keeps a dark line along it, so that over and under can be told apart.
                    on_top = (i + j) % 2 == 0
                    if on_top:
                        weft *= mix((0,), (1,), abs(u) - 30)[0] if warp or 0 <= i < 3 else 1
                    else:
                        warp *= mix((0,), (1,), abs(v) - 30)[0] if weft or 0 <= j < 3 else 1
                    colour = mix(mix(colour, gold, warp), ivory, weft) if not on_top else mix(mix(colour, ivory, weft), gold, warp)
            colour = mix(gold, colour, edge - 14) if edge > 8 else navy if edge < 7.5 else mix(navy, gold, edge - 7.5)
            out += bytes(int(c + 0.5) for c in colour)
    return png(width, height, 3, bytes(out))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=Path, metavar="DIR", default=Path(__file__).resolve().parent / "generated",
                        help="where to write (made if it is missing; default: generated, beside this script)")
    folder = parser.parse_args().out
    try:
        folder.mkdir(parents=True, exist_ok=True)
        save(folder / "curtain.glb", curtain())
        save(folder / "tablecloth.glb", tablecloth())
        save(folder / "pleats.glb", pleats())
        save(folder / "quilt.glb", quilt())
        save(folder / "disc.glb", disc())
        save(folder / "table.glb", table())
        save(folder / "table_linen.glb", table_linen())
        save(folder / "balloon.glb", balloon())
        save(folder / "cushion.glb", cushion())
        save(folder / "sleeper.glb", sleeper())
        for part in (character.body, character.skirt, character.cape):
            save(folder / f"{part.__name__}.glb", on_skeleton(part.__name__, part()))
        save(folder / "banner.png", banner())
        for maps in (plain_weave(), twill()):
            for name, content in maps.items():
                save(folder / name, content)
    except OSError as error:
        parser.exit(1, f"{error.filename or folder} could not be written: {error.strerror}.\n")


if __name__ == "__main__":
    main()
