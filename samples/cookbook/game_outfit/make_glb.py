#!/usr/bin/env python3
"""Writes what is in centimetres as a game holds it, in metres: an OBJ as a GLB with a material, or anchors.

usage: make_glb.py IN.obj OUT.glb
       make_glb.py IN.json OUT.json
"""
import json
import pathlib
import struct
import sys

source, output = sys.argv[1:]
if source.endswith(".json"):
    anchors = json.load(open(source))
    for pair in anchors["pairs"]:
        pair.update({side: [x / 100 for x in pair[side]] for side in "ab"})
    pathlib.Path(output).write_text(json.dumps(anchors | {"units": "m"}))
    sys.exit()

lines = [line.split() for line in open(source)]
points = [[float(x) / 100 for x in words[1:4]] for words in lines if words[:1] == ["v"]]
corners = []
for words in lines:
    if words[:1] == ["f"]:
        face = [int(corner.split("/")[0]) - 1 for corner in words[1:]]
        corners += [i for k in range(1, len(face) - 1) for i in (face[0], face[k], face[k + 1])]

normals = [[0.0, 0.0, 0.0] for _ in points]
for a, b, c in zip(*[iter(corners)] * 3):
    u, v = ([q - p for p, q in zip(points[a], points[end])] for end in (b, c))
    cross = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]]
    for i in (a, b, c):
        normals[i] = [n + x for n, x in zip(normals[i], cross)]
normals = [[x / (sum(y * y for y in n) ** 0.5 or 1) for x in n] for n in normals]

flat = [x for point in points for x in point]
data = struct.pack(f"<{len(flat)}f", *flat) + struct.pack(f"<{len(flat)}f", *(x for n in normals for x in n))
data += struct.pack(f"<{len(corners)}I", *corners)
single = [struct.unpack("<f", struct.pack("<f", x))[0] for x in flat]
vectors, name = 4 * len(flat), pathlib.Path(source).stem
text = json.dumps({
    "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"name": name, "mesh": 0}],
    "meshes": [{"name": name, "primitives": [{"attributes": {"POSITION": 0, "NORMAL": 1}, "indices": 2, "material": 0}]}],
    "materials": [{"name": name, "doubleSided": True,
                   "pbrMetallicRoughness": {"baseColorFactor": [0.6, 0.1, 0.2, 1], "metallicFactor": 0}}],
    "buffers": [{"byteLength": len(data)}],
    "bufferViews": [{"buffer": 0, "byteLength": vectors}, {"buffer": 0, "byteOffset": vectors, "byteLength": vectors},
                    {"buffer": 0, "byteOffset": 2 * vectors, "byteLength": 4 * len(corners)}],
    "accessors": [{"bufferView": 0, "componentType": 5126, "count": len(points), "type": "VEC3",
                   "min": [min(single[k::3]) for k in range(3)], "max": [max(single[k::3]) for k in range(3)]},
                  {"bufferView": 1, "componentType": 5126, "count": len(points), "type": "VEC3"},
                  {"bufferView": 2, "componentType": 5125, "count": len(corners), "type": "SCALAR"}],
}).encode()
text += b" " * (-len(text) % 4)
chunks = struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(data), b"BIN\0") + data
pathlib.Path(output).write_bytes(struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks)
