#!/usr/bin/env python3
"""Makes of a clean head what a scanner delivers: noise, and no back of the head. make_scan.py HEAD.obj SCAN.ply

Noise is 0.2 mm in each coordinate. Faces on the back of the skull, where hair was, are missing. Lengths stay those of
the head, cm.
"""
import random
import sys

NOISE = 0.02  # cm
HAIR = 0.35  # the part of the head's depth that is missing

head, scan = sys.argv[1:]
lines = [line.split() for line in open(head)]
vertices = [[float(x) for x in words[1:4]] for words in lines if words[:1] == ["v"]]
faces = [[int(corner.split("/")[0]) - 1 for corner in words[1:]] for words in lines if words[:1] == ["f"]]

# The head looks from its middle towards the tip of the nose, the vertex farthest from its axis.
low, high = ([f(v[k] for v in vertices) for k in range(3)] for f in (min, max))
middle = [(a + b) / 2 for a, b in zip(low, high)]
above = [v for v in vertices if v[1] > middle[1]]
nose = max(above, key=lambda v: (v[0] - middle[0]) ** 2 + (v[2] - middle[2]) ** 2)
ahead = [nose[0] - middle[0], nose[2] - middle[2]]
depth = [(v[0] - middle[0]) * ahead[0] + (v[2] - middle[2]) * ahead[1] for v in vertices]
cut = min(depth) + HAIR * (max(depth) - min(depth))
kept = [f for f in faces if not all(depth[i] < cut and vertices[i][1] > middle[1] for i in f)]

used = sorted({i for face in kept for i in face})
number = {old: new for new, old in enumerate(used)}
noise = random.Random(7)
with open(scan, "w") as out:
    out.write(f"ply\nformat ascii 1.0\nelement vertex {len(used)}\n")
    out.write("".join(f"property float {axis}\n" for axis in "xyz"))
    out.write(f"element face {len(kept)}\nproperty list uchar int vertex_indices\nend_header\n")
    for i in used:
        out.write(" ".join(f"{x + noise.gauss(0, NOISE):.6g}" for x in vertices[i]) + "\n")
    for face in kept:
        out.write(" ".join(map(str, (len(face), *(number[i] for i in face)))) + "\n")
