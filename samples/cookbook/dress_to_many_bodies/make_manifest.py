#!/usr/bin/env python3
"""Writes the jobs that carry one design to many bodies, and the anchors of each.

usage: make_manifest.py BODY BODY_LANDMARKS PRODUCT OUT NAME=TARGET,LANDMARKS ... > season.jsonl

A landmark file is one of anchors; on the design's own body its points `a` count, on a customer's its points `b`. Two of
one name make a pair, so that nobody has to pick points twice: once on the design's body, once on each customer.
"""
import json
import pathlib
import sys

body, body_landmarks, product, out, *customers = sys.argv[1:]
design = {pair["name"]: pair["a"] for pair in json.load(open(body_landmarks))["pairs"]}
for customer in customers:
    name, files = customer.split("=")
    target, landmarks = files.split(",")
    theirs = json.load(open(landmarks))
    pairs = [{"name": pair["name"], "a": design[pair["name"]], "b": pair["b"]}
             for pair in theirs["pairs"] if pair["name"] in design]
    folder = pathlib.Path(out) / name
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "anchors.json").write_text(json.dumps({"units": theirs["units"], "pairs": pairs}))
    print(json.dumps({"command": "fit", "source": body, "target": target, "anchors": f"{folder}/anchors.json",
                      "tolerance": "0.1%", "require-certified": True, "output": f"{folder}/map.vdb"}))
    print(json.dumps({"command": "apply", "map": f"{folder}/map.vdb", "product": [product], "out-dir": f"{folder}"}))
