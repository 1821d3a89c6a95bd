#!/usr/bin/env python3
"""Writes a manifest for trying: fits of the samples' sizes and products through every map.

usage: season.py MODELS OUT [--fits 20] [--applies 1000] > season.jsonl      (MODELS: from `bespoke samples MODELS`)
"""
import argparse
import json
import pathlib

parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
parser.add_argument("models", type=pathlib.Path)
parser.add_argument("out", type=pathlib.Path)
parser.add_argument("--fits", type=int, default=20)
parser.add_argument("--applies", type=int, default=1000)
arguments = parser.parse_args()

girths, sizes = arguments.models / "girths", (94, 100, 106, 112)
for i in range(arguments.fits):
    size, customer = sizes[i % len(sizes)], arguments.out / f"{i:05}"
    print(json.dumps({"command": "fit", "source": f"{girths}/source.obj", "target": f"{girths}/target_{size}.obj",
                      "anchors": f"{girths}/anchors_{size}.json", "tolerance": f"{0.1 + 0.01 * (i // len(sizes)):.2f}%",
                      "output": f"{customer}/map.vdb"}))
    for k in range(i, arguments.applies, arguments.fits):
        print(json.dumps({"command": "apply", "map": f"{customer}/map.vdb", "t": (k + 1) / arguments.applies,
                          "product": f"{girths}/{('top', 'skirt')[k % 2]}.obj", "output": f"{customer}/{k:06}.obj"}))
