#!/usr/bin/python3
"""Carries real garments to other bodies with `bespoke apply --clearance`, and counts what passes into them.

    tests/accuracy/dressed.py BESPOKE --makehuman --clones DIR    # 20 garments and 10 heads of hair onto other bodies
    tests/accuracy/dressed.py BESPOKE --cloth-fit --clones DIR    # three garments onto three avatars, 15 anchors each
    tests/accuracy/dressed.py BESPOKE --cases DIR                 # the products of the reference pairs

DIR holds clones of makehumancommunity/makehuman, makehumancommunity/makehuman-assets and Huangzizhou/cloth-fit, or folders
of reference_a.obj, reference_b.obj, anchors.json and product_*.obj. Prints a Markdown table; --json writes the rows.
Counts are of places at vertices, edges and 16 a face that were outside of the source and are inside of the target:
before the correction, and after it. The change of clearance is measured here, at the garment's vertices within 2 % of
the source, in per cent of the target's diagonal. --second-layer adds the garment once more, farther out by 1 %.
"""
import argparse
import json
import re
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
from scipy.spatial import cKDTree

import public_pairs
from public_pairs import Clone, Missing, farthest, fit, parse_obj, write_obj

public_pairs.DATA_SETS.update({
    "makehuman": ("makehumancommunity/makehuman", "the body"),
    "makehuman-assets": ("makehumancommunity/makehuman-assets", "garments"),
    "cloth-fit": ("Huangzizhou/cloth-fit", "garments and avatars"),
})
BODY_VERTICES = 13380  # of the base mesh; those after them are helpers that no one sees
MACRO = "makehuman/data/targets/macrodetails"
# Source, then target, as targets of the base mesh that are added with weight 1.
PERSONS = {
    "female": (("caucasian-female-young", "universal-female-young-averagemuscle-averageweight"),
               ("asian-female-old", "universal-female-old-averagemuscle-maxweight")),
    "male": (("caucasian-male-young", "universal-male-young-averagemuscle-averageweight"),
             ("african-male-old", "universal-male-old-maxmuscle-minweight")),
}
GARMENTS = {"jacket": "Puffer_dense", "skirt": "LCL_Skirt_DressEvening_003", "jumpsuit": "jumpsuit_dense"}
AVATARS = ("FoxGirl", "Goblin", "T-rex")
HEAD, CHEST, HIP = 2, 1, 0  # joints of cloth-fit's skeletons; left and right shoulders are 3 and 6


def body(clone, targets):
    """Vertices of the whole base mesh with the targets added, and the triangles of the body."""
    vertices, faces = parse_obj(clone.read("makehuman/data/3dobjs/base.obj"))
    for name in targets:
        for line in clone.read(f"{MACRO}/{name}.target").decode().splitlines():
            words = line.split()
            if len(words) == 4 and not line.startswith("#"):
                vertices[int(words[0])] += [float(word) for word in words[1:]]
    return vertices, faces[(faces < BODY_VERTICES).all(1)]


def worn(clone, path, base):
    """A garment of a .mhclo file on the base mesh: three of its vertices, their weights and a scaled offset each."""
    scale, rows, reading = np.ones(3), [], False
    obj = None
    for line in clone.read(path).decode(errors="replace").splitlines():
        words = line.split()
        if not words or words[0].startswith("#"):
            continue
        if words[0] == "obj_file":
            obj = words[1]
        elif re.fullmatch("[xyz]_scale", words[0]):
            axis = "xyz".index(words[0][0])
            scale[axis] = abs(base[int(words[1]), axis] - base[int(words[2]), axis]) / float(words[3])
        elif words[0] == "verts":
            reading = True
        elif reading and re.fullmatch(r"\d+", words[0]):
            rows.append([float(word) for word in words])
        elif words[0] == "delete_verts":
            break
    points = []
    for row in rows:
        if len(row) == 1:
            points.append(base[int(row[0])])
        else:
            corners = base[[int(index) for index in row[:3]]]
            points.append(np.array(row[3:6]) @ corners + np.array(row[6:9]) * scale)
    _, faces = parse_obj(clone.read(f"{Path(path).parent}/{obj}"))
    return np.array(points), faces


def makehuman_cases(clones):
    base, assets = Clone(clones, "makehuman"), Clone(clones, "makehuman-assets")
    paths = [path for path in assets.files() if re.match(r"base/(clothes|hair)/.*\.mhclo$", path)]
    for person, (own, other) in PERSONS.items():
        (source, faces), (target, _) = body(base, own), body(base, other)
        names = [path for path in paths if ("female" in path or "hair" in path) == (person == "female")]
        garments = {Path(path).stem: worn(assets, path, source) for path in names}
        chosen = farthest(source[:BODY_VERTICES], 30)
        yield {"name": f"MakeHuman {person}", "source": (source[:BODY_VERTICES], faces),
               "target": (target[:BODY_VERTICES], faces), "garments": garments,
               "anchors": [(source[index], target[index]) for index in chosen]}


def along_ray(mesh, origin, direction):
    """Where a ray from inside a mesh first leaves it; the nearest vertex where it hits nothing."""
    a, b, c = mesh[0][mesh[1]].transpose(1, 0, 2)
    p = np.cross(direction, c - a)
    det = ((b - a) * p).sum(1)
    with np.errstate(divide="ignore", invalid="ignore"):
        s = origin - a
        u = (s * p).sum(1) / det
        q = np.cross(s, b - a)
        v, t = (q * direction).sum(1) / det, ((c - a) * q).sum(1) / det
        hits = t[(u >= 0) & (v >= 0) & (u + v <= 1) & (t > 0)]
    if len(hits):
        return origin + hits.min() * direction
    return mesh[0][np.linalg.norm(mesh[0] - origin, axis=1).argmin()]


def joint_anchors(mesh, joints, bones):
    """A place of the surface for each joint: in front of it, across its bone; of the head its top."""
    across = joints[3] - joints[6]
    up = joints[CHEST] - joints[HIP]
    front = np.cross(across, up)
    places = []
    for joint, position in enumerate(joints):
        ends = [bone for bone in bones if joint in bone]
        along = joints[ends[-1][1]] - joints[ends[-1][0]] if joint not in (HIP, CHEST) else up
        direction = joints[HEAD] - joints[CHEST] if joint == HEAD else front - along * (front @ along) / (along @ along)
        places.append(along_ray(mesh, position, direction / np.linalg.norm(direction)))
    return places


def skeleton(data):
    lines = [line.split() for line in data.decode().splitlines()]
    return (np.array([line[1:4] for line in lines if line[:1] == ["v"]], float),
            [(int(line[1]) - 1, int(line[2]) - 1) for line in lines if line[:1] == ["l"]])


def cloth_fit_cases(clones):
    clone = Clone(clones, "cloth-fit")
    folder = "garment-data/assets"
    for avatar in AVATARS:
        target = parse_obj(clone.read(f"{folder}/avatars/{avatar}/avatar.obj"))
        target_joints, _ = skeleton(clone.read(f"{folder}/avatars/{avatar}/skeleton.obj"))
        for name, garment in GARMENTS.items():
            source = parse_obj(clone.read(f"{folder}/garments/{garment}/cage.obj"))
            # Bones run from hip to end in the garments' files alone.
            joints, bones = skeleton(clone.read(f"{folder}/garments/{garment}/skeleton.obj"))
            anchors = zip(joint_anchors(source, joints, bones), joint_anchors(target, target_joints, bones))
            yield {"name": f"cloth-fit {avatar}", "source": source, "target": target, "anchors": list(anchors),
                   "garments": {name: parse_obj(clone.read(f"{folder}/garments/{garment}/garment.obj"))}}


def case_folders(cases):
    for folder in sorted(path for path in cases.iterdir() if (path / "anchors.json").is_file()):
        pairs = json.loads((folder / "anchors.json").read_text())["pairs"]
        yield {"name": folder.name.split("_")[0], "source": parse_obj((folder / "reference_a.obj").read_bytes()),
               "target": parse_obj((folder / "reference_b.obj").read_bytes()),
               "anchors": [(pair["a"], pair["b"]) for pair in pairs],
               "garments": {path.stem.removeprefix("product_"): parse_obj(path.read_bytes())
                            for path in sorted(folder.glob("product_*.obj"))}}


# ---- clearance, by code of this file's own

CANDIDATES = 24  # triangles whose middles are nearest


def on_triangles(points, a, b, c):
    """The nearest places of triangles, row by row: the foot in the plane where that is inside, or the nearest of the edges."""
    best = np.full(len(points), np.inf)
    places = np.empty_like(points)

    def take(candidate, chosen):
        away = np.where(chosen, np.linalg.norm(candidate - points, axis=1), np.inf)
        nearer = away < best
        best[nearer], places[nearer] = away[nearer], candidate[nearer]

    for start, end in ((a, b), (b, c), (c, a)):
        along = end - start
        square = np.maximum((along * along).sum(1), 1e-300)
        share = np.clip(((points - start) * along).sum(1) / square, 0, 1)
        take(start + share[:, None] * along, True)
    normal = np.cross(b - a, c - a)
    square = np.maximum((normal * normal).sum(1), 1e-300)
    foot = points - (((points - a) * normal).sum(1) / square)[:, None] * normal
    sides = [(np.cross(end - start, foot - start) * normal).sum(1) for start, end in ((a, b), (b, c), (c, a))]
    take(foot, np.logical_and.reduce([side >= 0 for side in sides]))
    return places, best


def clearance(points, mesh):
    """Distances from a mesh, negative inside: behind the face that of the nearest ones is seen most squarely."""
    corners = mesh[0][mesh[1]]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.maximum(np.linalg.norm(normals, axis=1), 1e-300)[:, None]
    found = cKDTree(corners.mean(1)).query(points, k=CANDIDATES)[1]
    triangles = corners[found.ravel()]
    repeated = np.repeat(points, CANDIDATES, 0)
    places, distances = on_triangles(repeated, *triangles.transpose(1, 0, 2))
    distances = distances.reshape(found.shape)
    least = distances.min(1)
    away = (repeated - places).reshape(*found.shape, 3)
    facing = (away * normals[found]).sum(2)
    facing[distances > least[:, None] + 1e-9 * np.ptp(mesh[0])] = 0
    sides = np.take_along_axis(facing, np.abs(facing).argmax(1)[:, None], 1)[:, 0]
    return np.where(sides < 0, -least, least)


def diagonal(mesh):
    return np.linalg.norm(mesh[0].max(0) - mesh[0].min(0))


def size_scale(case):
    """The program's: in powers of two, from a twelfth before each on."""
    ratio = np.log2(diagonal(case["target"]) / diagonal(case["source"]))
    return 2.0**np.trunc(ratio + np.copysign(0.125, ratio))


def changes(case, garment, carried):
    """p95 of the change of clearance, per cent of the target's diagonal."""
    before, scale = clearance(garment[0], case["source"]), size_scale(case)
    near = np.abs(before) < 0.02 * diagonal(case["source"])
    if not near.any():
        return None
    after = clearance(carried[near], case["target"])
    return round(float(100 * np.percentile(np.abs(after - scale * before[near]), 95) / diagonal(case["target"])), 3)


SAMPLES = [(i / 6, j / 6) for i in range(7) for j in range(7 - i)]  # shares of two corners: 28 places a face, its edges with them
MARGIN = 5e-4  # of the diagonal: what comes as near to its limit counts as too near
TOLERANCE = 1e-4  # of the diagonal: smaller moves count as none


def bystanders(case, garment, plain, dressed):
    """Of vertices of no face that the map brought too near, or nearly: how far one was moved, in per cent of the target's diagonal,
    and how far the farthest one that moved is from a vertex of a face that it did, in mean lengths of edges."""
    faces = garment[1]
    scale = size_scale(case)
    too_near = np.zeros(len(garment[0]), bool)
    for i, j in SAMPLES:
        shares = np.array([i, j, 1 - i - j])
        places = [np.einsum("fkc,k->fc", points[faces], shares) for points in (garment[0], plain)]
        missing = scale * clearance(places[0], case["source"]) - clearance(places[1], case["target"])
        too_near[faces[missing > -MARGIN * diagonal(case["target"])].ravel()] = True
    moved = np.linalg.norm(dressed - plain, axis=1) / diagonal(case["target"])
    edges = np.vstack([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    edge = np.linalg.norm(plain[edges[:, 0]] - plain[edges[:, 1]], axis=1).mean()
    others = ~too_near & (moved > TOLERANCE)
    away = cKDTree(plain[too_near]).query(plain[others])[0] if too_near.any() and others.any() else np.zeros(1)
    return round(float(100 * moved[~too_near].max(initial=0)), 3), round(float(away.max() / edge), 1)


def farther_out(case, garment):
    """The garment along the normals of its vertices, by 1 % of the source's diagonal."""
    corners = garment[0][garment[1]]
    normals = np.zeros_like(garment[0])
    for k in range(3):
        np.add.at(normals, garment[1][:, k], np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]))
    normals /= np.maximum(np.linalg.norm(normals, axis=1), 1e-300)[:, None]
    return garment[0] + 0.01 * diagonal(case["source"]) * normals, garment[1]


def dress(case, options, folder):
    """A row a garment."""
    write_obj(folder / "source.obj", case["source"])
    write_obj(folder / "target.obj", case["target"])
    (folder / "anchors.json").write_text(json.dumps({"pairs": [
        {"name": f"p{index}", "a": list(a), "b": list(b)} for index, (a, b) in enumerate(case["anchors"])]}))
    map_file = folder / "map.vdb"
    seconds, failure = fit([options.bespoke, "fit", str(folder / "source.obj"), str(folder / "target.obj"), "--anchors",
                            str(folder / "anchors.json"), "-o", str(map_file), "--quiet", "--threads",
                            str(options.threads), "--any-size", *options.fit_options], options.timeout)
    for name, garment in case["garments"].items():
        row = {"case": case["name"], "garment": name, "vertices": len(garment[0]), "fit_seconds": seconds}
        if failure:
            yield {**row, "failure": failure.replace(str(folder) + "/", "")}
            continue
        file, report = folder / f"{name}.obj", folder / "report.json"
        write_obj(file, garment)
        files = [file]
        if options.second_layer:
            files.append(folder / f"{name}_over.obj")
            write_obj(files[1], farther_out(case, garment))
        subprocess.run([options.bespoke, "apply", map_file, file, "-o", folder / "plain.obj", "--quiet"], check=True,
                       capture_output=True)
        begin = time.monotonic()
        run = subprocess.run([options.bespoke, "apply", map_file, *files, "--clearance", options.clearance,
                              "--require-clear", "--out-dir", folder / "dressed", "--report", report, "--quiet",
                              *(["--layers"] if options.second_layer else [])],
                             capture_output=True, text=True, check=False)
        row["apply_seconds"] = round(time.monotonic() - begin, 2)
        if run.returncode not in (0, 3):
            yield {**row, "failure": (run.stderr.strip().splitlines() or ["?"])[-1]}
            continue
        products = json.loads(report.read_text())["products"]
        found = products[0]["clearance"]
        read = lambda path: parse_obj(path.read_bytes())[0]
        plain, dressed = read(folder / "plain.obj"), read(folder / "dressed" / file.name)
        row["change_before"], row["change_after"] = changes(case, garment, plain), changes(case, garment, dressed)
        row["bystanders"] = bystanders(case, garment, plain, dressed)
        if options.second_layer:
            over = products[1]["clearance"]
            row["layers"] = {**over["layers"][0], "inside_before": over["missed_before"]["inside"],
                             "inside_after": over["missed_after"]["inside"],
                             "self_intersections": over["new_self_intersections"]}
        yield {**row, "samples": found["samples"], "inside_before": found["missed_before"]["inside"],
               "inside_after": found["missed_after"]["inside"], "self_intersections": found["new_self_intersections"],
               "moved_p95": found.get("moves", {}).get("p95"), "clear": found["clear"]}


def table(rows):
    yield ("| bodies | garment | vertices | places | inside: as carried, corrected | new pairs through itself | new pairs "
           "of layers | change of clearance, p95, %: as carried, corrected | bystanders: moved by, %, edges away | fit, CPU s | apply, s |")
    yield "| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |"
    for row in rows:
        start = f"| {row['case']} | {row['garment']} | {row['vertices']} "
        if "failure" in row:
            yield f"{start}| {row['failure']} | | | | | {row['fit_seconds']} | |"
        else:
            layers = row.get("layers")
            between = f"{layers['new_intersections']} ({layers['intersections_on_source']} on the source)" if layers else "–"
            yield (f"{start}| {row['samples']} | {row['inside_before']}, {row['inside_after']} | "
                   f"{row['self_intersections']} | {between} | {row['change_before']}, {row['change_after']} | "
                   f"{row['bystanders'][0]}, {row['bystanders'][1]} | "
                   f"{row['fit_seconds']} | {row['apply_seconds']} |")


def main(arguments):
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("bespoke", help="the program")
    group = parser.add_mutually_exclusive_group(required=True)
    group.add_argument("--makehuman", action="store_true")
    group.add_argument("--cloth-fit", action="store_true")
    group.add_argument("--cases", type=Path, help="folder of the cases")
    parser.add_argument("--only", help="regular expression of the cases' names")
    parser.add_argument("--clones", type=Path, help="folder of the clones")
    parser.add_argument("--second-layer", action="store_true", help="and the garment once more over itself")
    parser.add_argument("--clearance", default="keep", help="as for `bespoke apply` (default: %(default)s)")
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--timeout", type=float, default=600, help="seconds a fit (default: %(default)s)")
    parser.add_argument("--fit-options", nargs=argparse.REMAINDER, default=[], help="further options of `bespoke fit`")
    parser.add_argument("--keep", type=Path, help="folder that files are left in")
    parser.add_argument("--json", type=Path)
    options = parser.parse_args(arguments)
    if options.clones is None and options.cases is None:
        parser.error("--clones is required")
    rows = []

    def dressed(cases, parent):
        for number, case in enumerate(cases):
            folder = parent / str(number)
            folder.mkdir(parents=True, exist_ok=True)
            for row in dress(case, options, folder):
                rows.append(row)
                yield row

    with tempfile.TemporaryDirectory() as temporary:
        cases = (case_folders(options.cases) if options.cases else
                 (makehuman_cases if options.makehuman else cloth_fit_cases)(options.clones))
        cases = (case for case in cases if re.search(options.only or "", case["name"]))
        try:
            for line in table(dressed(cases, options.keep or Path(temporary))):
                print(line, flush=True)
        except Missing as error:
            print(error, file=sys.stderr)
            return 1
    if options.json:
        options.json.write_text(json.dumps(rows, indent=1) + "\n")
    return 0 if all(row.get("clear") for row in rows) else 3


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
