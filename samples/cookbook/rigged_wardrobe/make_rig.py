#!/usr/bin/env python3
"""Gives a GLB a skeleton: joints between the anchors of one model, weights by the distance from the bones, a pose.

usage: make_rig.py IN.glb ANCHORS.json a|b OUT.glb
"""
import json
import math
import pathlib
import struct
import sys

source, anchors, side, output = sys.argv[1:]
pairs = json.load(open(anchors))["pairs"]
place = {pair["name"]: pair[side] for pair in pairs}


def between(*names):
    return [sum(place[name][k] for name in names) / len(names) for k in range(3)]


# Every joint with its parent, and where it is. A bone ends at its first child, or at the place that stands behind.
JOINTS = {
    "hips": (None, between("hip_front", "hip_back")),
    "spine": ("hips", between("waist_front", "waist_back")),
    "chest": ("spine", between("sternum", "upper_back")),
    "head": ("chest", between("neck_front", "neck_back"), between("crown")),
}
for s in ("left", "right"):
    JOINTS |= {
        f"{s}_arm": ("chest", between(f"{s}_shoulder")),
        f"{s}_forearm": (f"{s}_arm", between(f"{s}_elbow_outside")),
        f"{s}_hand": (f"{s}_forearm", between(f"{s}_wrist_outside"), between(f"{s}_fingertip")),
        f"{s}_thigh": ("hips", between(f"{s}_hip_side", f"{s}_buttock")),
        f"{s}_shin": (f"{s}_thigh", between(f"{s}_knee_front", f"{s}_knee_back")),
        f"{s}_foot": (f"{s}_shin", between(f"{s}_ankle_outside", f"{s}_ankle_inside"), between(f"{s}_toe")),
    }
names = list(JOINTS)
children = {name: [other for other in names if JOINTS[other][0] == name] for name in names}


def bone(name):
    return JOINTS[name][1], JOINTS[name][2] if len(JOINTS[name]) > 2 else JOINTS[children[name][0]][1]


def distance(x, a, b):
    along = [q - p for p, q in zip(a, b)]
    t = sum(u * (q - p) for u, p, q in zip(along, a, x)) / sum(u * u for u in along)
    return math.dist(x, [p + min(1, max(0, t)) * u for p, u in zip(a, along)])


def weights(x):
    """Of the four nearest bones, falling with the sixth power of the distance."""
    near = sorted((distance(x, *bone(name)), i) for i, name in enumerate(names))[:4]
    raw = [1 / (d + 1e-6) ** 6 for d, _ in near]
    return [i for _, i in near], [w / sum(raw) for w in raw]


glb = pathlib.Path(source).read_bytes()
size = struct.unpack_from("<I", glb, 12)[0]
file, data = json.loads(glb[20 : 20 + size]), glb[28 + size :]


def add(values, code, component, kind, count, **more):
    global data
    data += b"\0" * (-len(data) % 4)
    file["bufferViews"].append({"buffer": 0, "byteOffset": len(data), "byteLength": struct.calcsize(code) * len(values)})
    data += struct.pack(f"<{len(values)}{code}", *values)
    file["accessors"].append({"bufferView": len(file["bufferViews"]) - 1, "componentType": component, "type": kind,
                              "count": count, **more})
    return len(file["accessors"]) - 1


attributes = file["meshes"][0]["primitives"][0]["attributes"]
count = file["accessors"][attributes["POSITION"]]["count"]
x = struct.unpack_from(f"<{3 * count}f", data)
held = [weights(x[3 * i : 3 * i + 3]) for i in range(count)]
attributes["JOINTS_0"] = add([j for own in held for j in own[0]], "B", 5121, "VEC4", count)
attributes["WEIGHTS_0"] = add([w for own in held for w in own[1]], "f", 5126, "VEC4", count)
binds = [v for name in names for v in (1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, *(-c for c in JOINTS[name][1]), 1)]
file["skins"] = [{"joints": list(range(1, 1 + len(names))), "inverseBindMatrices": add(binds, "f", 5126, "MAT4", len(names))}]
for name in names:
    parent = JOINTS[name][0]
    origin = JOINTS[parent][1] if parent else (0, 0, 0)
    node = {"name": name, "translation": [a - b for a, b in zip(JOINTS[name][1], origin)]}
    if children[name]:
        node["children"] = [1 + names.index(child) for child in children[name]]
    file["nodes"].append(node)
file["nodes"][0]["skin"] = 0
file["scenes"][0]["nodes"].append(1)

# From rest into a step: the thigh forwards, the knee and both elbows bent, about the x axis of the joints.
turns = {"left_thigh": -35, "left_shin": 50, "left_forearm": -60, "right_forearm": -60}
times = add([0.0, 1.0], "f", 5126, "SCALAR", 2, min=[0], max=[1])
file["animations"] = [{"name": "step", "samplers": [], "channels": []}]
for name, degrees in turns.items():
    half = math.radians(degrees) / 2
    rotation = add([0, 0, 0, 1, math.sin(half), 0, 0, math.cos(half)], "f", 5126, "VEC4", 2)
    file["animations"][0]["samplers"].append({"input": times, "output": rotation})
    file["animations"][0]["channels"].append({"sampler": len(file["animations"][0]["samplers"]) - 1, "target": {
        "node": 1 + names.index(name), "path": "rotation"}})

data += b"\0" * (-len(data) % 4)
file["buffers"] = [{"byteLength": len(data)}]
text = json.dumps(file).encode()
text += b" " * (-len(text) % 4)
chunks = struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(data), b"BIN\0") + data
pathlib.Path(output).write_bytes(struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks)
