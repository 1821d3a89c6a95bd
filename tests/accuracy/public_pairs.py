#!/usr/bin/python3
"""Scores `bespoke fit` and `bespoke apply` on pairs with exact truth that everybody can get.

    tests/accuracy/public_pairs.py BESPOKE --report --clones DIR     # pairs that choose no constant
    tests/accuracy/public_pairs.py BESPOKE --choose --clones DIR     # pairs that constants are chosen by
    tests/accuracy/public_pairs.py BESPOKE --generated               # pairs that need no download

DIR holds clones, ordinary or bare, of the repositories in DATA_SETS. Prints a Markdown table; --json writes the rows.
Errors are distances from the true place in per cent of the source's bounding-box diagonal, anchors left out.
Rows of tosca-across also score the maps that its repository records, of programs that take no anchors, on the same
points; of a map and its mirror image the better one counts.
"""
import argparse
import io
import itertools
import json
import re
import resource
import subprocess
import sys
import tempfile
import time
import zipfile
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

import tables

DATA_SETS = {
    "faust": ("yiqun-wang/LPS-data", "FAUST, bodies between persons and between poses"),
    "tosca": ("llorz/SGA18_orientation_BCICP_dataset", "TOSCA, animals and persons in different poses"),
    "garmentcode": ("maria-korosteleva/GarmentCode", "bodies of different persons"),
    "mouse": ("SlicerMorph/Mouse_Models", "mouse skulls with landmarks"),
}
SETS = {"faust-persons": "faust", "faust-poses": "faust", "tosca": "tosca", "tosca-across": "tosca",
        "garmentcode": "garmentcode", "mouse": "mouse"}
CHOOSING_SETS = ("faust-persons", "faust-poses", "tosca")
FAUST_EXACT = 6890  # vertices that correspond; those after them were added by the remeshing of LPS-data
RECORDED = {"BIM": 0, "PMF_hk": 1, "WKSini_direct_BCICP": 1, "SEGini_direct_BCICP": 1}  # and their first number
TOSCA_CHOOSE = ("cat", "dog", "wolf", "michael")
GENERATED = {"dress": "body", "glasses": "head", "glove": "hand", "shoe": "foot"}
SEED = 55  # which pairs, and the noise of anchors


@dataclass
class Pair:
    name: str
    source: tuple  # vertices (n, 3), faces (m, 3)
    target: tuple
    points: np.ndarray  # (k, 3), on the source
    places: np.ndarray  # (k, 3), where they belong on the target
    vertices: object = None  # (k,) vertices of the source that are the points; None where places are rounded
    mirrored: object = None  # (k, 3), where the points' mirror images belong
    recorded: dict = field(default_factory=dict)  # other program: (k, 3), where its map takes the points; NaN: nowhere


class Missing(Exception):
    """A clone, a file or a program is not there."""


class Clone:
    """Files of the commit HEAD of a clone; HEAD's files are read, not those of the work tree."""

    def __init__(self, folder, data_set):
        repository, purpose = DATA_SETS[data_set]
        owner, name = repository.split("/")
        both = f"{owner}+{name}"
        places = (f"{both}/repo", both, f"{owner}/{name}", f"{owner}/{name}.git", name, f"{name}.git")
        paths = [path for place in places for path in (folder / place / ".git", folder / place)]
        git = [path for path in paths if (path / "HEAD").is_file()]
        if not git:
            raise Missing(f"{folder}: no clone of {repository} ({purpose}). Clone github.com/{repository} to "
                          f"{folder / name}, or leave its pairs out with --sets")
        self.repository, self.directory = repository, git[0]

    def git(self, *arguments):
        run = subprocess.run(["git", f"--git-dir={self.directory}", *arguments], capture_output=True, check=False)
        if run.returncode:
            message = run.stderr.decode(errors="replace").strip()
            raise Missing(f"{self.repository}: git {' '.join(arguments)}: {message}")
        return run.stdout

    def read(self, path):
        return self.git("show", f"HEAD:{path}")

    def commit(self):
        return self.git("rev-parse", "HEAD").decode().strip()

    def files(self):
        return self.git("ls-tree", "-r", "--name-only", "HEAD").decode().splitlines()


def parse_off(data):
    words = data.split()
    vertices, faces = int(words[1]), int(words[2])
    end = 4 + 3 * vertices
    return (np.array(words[4:end], float).reshape(-1, 3),
            np.array(words[end:end + 4 * faces], int).reshape(-1, 4)[:, 1:])


def parse_obj(data):
    vertices, faces = [], []
    for line in data.decode(errors="replace").splitlines():
        key, *words = line.split() or [""]
        if key == "v":
            vertices.append([float(word) for word in words[:3]])
        elif key == "f":
            corners = [int(word.split("/")[0]) - 1 for word in words]
            faces += [[corners[0], a, b] for a, b in zip(corners[1:], corners[2:])]
    return np.array(vertices), np.array(faces)


def parse_ply(data):
    """PLY of triangles, ASCII or little-endian binary, whose faces have no property but their vertices."""
    types = {"float": "<f4", "float32": "<f4", "double": "<f8", "uchar": "u1", "uint8": "u1", "int": "<i4",
             "int32": "<i4"}
    head, body = re.split(rb"(?<=end_header)\r?\n", data, maxsplit=1)
    lines, counts, properties, element = head.decode().splitlines(), {}, [], ""
    for words in (line.split() for line in lines):
        if words[0] == "element":
            element = words[1]
            counts[element] = int(words[2])
        elif words[0] == "property" and element == "vertex":
            properties.append((words[2], types[words[1]]))
    n, m = counts["vertex"], counts["face"]
    if any(line.startswith("format ascii") for line in lines):
        words, width = body.split(), len(properties)
        return (np.array(words[:n * width], float).reshape(n, width)[:, :3],
                np.array(words[n * width:n * width + 4 * m], int).reshape(m, 4)[:, 1:])
    vertices = np.frombuffer(body, np.dtype(properties), n)
    faces = np.frombuffer(body, np.dtype([("count", "u1"), ("corners", "<i4", 3)]), m, vertices.nbytes)
    if (faces["count"] != 3).any():
        raise Missing("a PLY file has faces that are no triangles, which this script does not read")
    return np.stack([vertices[axis] for axis in "xyz"], 1).astype(float), faces["corners"].astype(int)


def write_obj(path, mesh):
    with open(path, "w", encoding="ascii") as file:
        np.savetxt(file, mesh[0], fmt="v %.9g %.9g %.9g")
        np.savetxt(file, mesh[1] + 1, fmt="f %d %d %d")


def farthest(points, count):
    """Indices of points, each the farthest from those before it (farthest-point sampling)."""
    distance, chosen = np.linalg.norm(points - points.mean(0), axis=1), []
    for step in range(min(count, len(points))):
        chosen.append(int(distance.argmax()))
        new = np.linalg.norm(points - points[chosen[-1]], axis=1)
        distance = np.minimum(distance, new) if step else new
    return chosen


def remeshed(vertices, faces):
    """The same surface in another connectivity: an eighth of the faces is split, all are renumbered."""
    random = np.random.default_rng(SEED)
    split = random.random(len(faces)) < 1 / 8
    a, b, c = faces[split].T
    middle = len(vertices) + np.arange(split.sum())
    parts = [faces[~split], *(np.stack(corners, 1) for corners in ((a, b, middle), (b, c, middle), (c, a, middle)))]
    all_vertices = np.concatenate([vertices, vertices[faces[split]].mean(1)])
    order = random.permutation(len(all_vertices))
    return all_vertices[order], random.permutation(np.argsort(order)[np.concatenate(parts)])


def other_size(points):
    """A known one-to-one map to another size and posture: widths change along the height, then the height is bent.

    Bending about a radius of four heights does not fold what is less than four heights thick."""
    low, high = points.min(0), points.max(0)
    height = high[1] - low[1]
    along = (points[:, 1] - low[1]) / height
    offset = points - (low + high) / 2
    wide = offset[:, 0] * (1.1 + 0.1 * np.sin(2 * np.pi * along))
    deep = offset[:, 2] * (1.05 - 0.1 * np.cos(2 * np.pi * along))
    radius, angle = 4 * height, along / 4 * 1.08
    return np.stack([wide, (radius + deep) * np.sin(angle), (radius + deep) * np.cos(angle) - radius], 1)


def random_pairs(items, count):
    order = np.random.default_rng(SEED).permutation(len(items))[:count]
    return [items[index] for index in sorted(order)]


def faust_pairs(clone, name, options):
    subjects = range(5) if options.choose else range(5, 10)
    if name == "faust-persons":
        two = [(10 * s + p, 10 * t + p) for s, t in itertools.permutations(subjects, 2) for p in range(10)]
    else:
        two = [(10 * s + p, 10 * s + q) for s in subjects for p, q in itertools.permutations(range(10), 2)]
    for a, b in random_pairs(two, options.pairs):
        source, target = (parse_off(clone.read(f"faust_all_10000/tr_reg_{each:03d}.off")) for each in (a, b))
        yield Pair(f"{name} {a:03d} {b:03d}", source, target, source[0][:FAUST_EXACT], target[0][:FAUST_EXACT],
                   np.arange(FAUST_EXACT))


def tosca_pairs(clone, name, options):
    folder = "Dataset/TOSCA_Isometric"
    text = clone.read(f"{folder}/test_pairs.txt").decode()
    lines = [re.split(r"[,\s]+", line.strip()) for line in text.splitlines()]
    two = [line[:2] for line in lines if len(line) >= 2 and line[0].startswith(TOSCA_CHOOSE) == options.choose]
    for a, b in random_pairs(two, options.pairs):
        source, target = (parse_off(clone.read(f"{folder}/vtx_5k/{each}.off")) for each in (a, b))
        known = [np.array(clone.read(f"{folder}/vtx_5k/corres/{each}.vts").split(), int) - 1 for each in (a, b)]
        count = min(map(len, known))
        ids = np.stack([each[:count] for each in known])
        ids = ids[:, (ids >= 0).all(0)]
        yield Pair(f"{name} {a} {b}", source, target, source[0][ids[0]], target[0][ids[1]])


def recorded_places(archive, name, first, ids, target):
    """Where a recorded map, a number of the target's vertices a line, takes these vertices; NaN where it says none."""
    numbers = np.array(archive.read(name).split(), float)[ids] - first
    places = np.full((len(ids), 3), np.nan)
    known = np.isfinite(numbers)
    places[known] = target[numbers[known].astype(int)]
    return places


def tosca_across_pairs(clone, name, options):
    """A gorilla onto persons, with the maps that the repository records of them."""
    folder = "Dataset/TOSCA_nonIsometric"
    archives = {method: zipfile.ZipFile(io.BytesIO(clone.read(f"{folder}/vtx_5k/maps/{method}.zip")))
                for method in RECORDED}
    two = [line.split() for line in clone.read(f"{folder}/test_pairs.txt").decode().splitlines() if line.strip()]
    for a, b in random_pairs(two, options.pairs):
        source, target = (parse_off(clone.read(f"{folder}/vtx_5k/{each}.off")) for each in (a, b))
        of_a, of_b, mirrored = (np.array(clone.read(f"{folder}/vtx_5k/corres/{each}.vts").split(), int) - 1
                                for each in (a, b, f"{b}.sym"))
        maps = {method: recorded_places(archives[method], f"{method}/{a}_{b}.map", first, of_a, target[0])
                for method, first in RECORDED.items() if f"{method}/{a}_{b}.map" in archives[method].namelist()}
        yield Pair(f"{name} {a} {b}", source, target, source[0][of_a], target[0][of_b], None, target[0][mirrored], maps)


def garmentcode_pairs(clone, name, options):
    two = [("mean_all", "mean_female"), ("mean_female", "mean_male"), ("mean_male", "mean_female")]
    for a, b in two[:options.pairs]:
        source, target = (parse_obj(clone.read(f"assets/bodies/{each}.obj")) for each in (a, b))
        yield Pair(f"{name} {a} {b}", source, remeshed(*target), source[0], target[0], np.arange(len(source[0])))


def mouse_pairs(clone, name, options):
    files = clone.files()
    models = {Path(file).name.split(".")[0].upper(): file for file in files if file.lower().endswith(".ply")}
    marked = [file for file in files if file.startswith("LMs/") and file.endswith(".mrk.json")]
    marked = [file for file in marked if Path(file).name.split(".")[0].upper() in models]
    for files in random_pairs(list(zip(marked, marked[1:])), options.mouse_pairs):
        ids = [Path(file).name.split(".")[0] for file in files]
        source, target = (parse_ply(clone.read(models[each.upper()])) for each in ids)
        landmarks = [json.loads(clone.read(file))["markups"][0]["controlPoints"] for file in files]
        points, places = (np.array([landmark["position"] for landmark in each], float) for each in landmarks)
        yield Pair(f"{name} {' '.join(ids)}", source, target, points, places)


def generated_pairs(bespoke, folder):
    """Models of `bespoke samples`, and their images under a known map, remeshed.

    Sources and targets of the samples are meshed separately: only their anchors correspond."""
    subprocess.run([bespoke, "samples", str(folder), *GENERATED, "--quiet"], check=True, stdout=subprocess.DEVNULL)
    for directory, what in GENERATED.items():
        source = parse_obj((folder / directory / "source.obj").read_bytes())
        places = other_size(source[0])
        target = remeshed(places, source[1])
        yield Pair(f"generated {what}", source, target, source[0], places, np.arange(len(places)))


def pairs_by_turns(sets):
    """One pair of each set, then the second of each, so that a run that is stopped early has rows of all sets."""
    for turn in itertools.zip_longest(*sets):
        yield from (pair for pair in turn if pair is not None)


def flipped_faces(pair, carried):
    """Faces whose normal opposes that of the true face; None where the truth is no mesh of the source's vertices."""
    if pair.vertices is None:
        return None
    place = np.full(len(pair.source[0]), -1)
    place[pair.vertices] = np.arange(len(pair.vertices))
    faces = place[pair.source[1]]
    faces = faces[(faces >= 0).all(1)]

    def normals(points):
        a, b, c = points[faces].transpose(1, 0, 2)
        return np.cross(b - a, c - a)

    return int(((normals(carried) * normals(pair.places)).sum(1) < 0).sum())


def errors(pair, carried, left_out):
    """Mean, 95th percentile and largest distance from the true places, % of the source's bounding-box diagonal."""
    distance = np.linalg.norm(carried - pair.places, axis=1) / np.linalg.norm(np.ptp(pair.source[0], axis=0)) * 100
    distance = np.delete(distance, left_out)
    return {"mean": round(float(distance.mean()), 3), "p95": round(float(np.percentile(distance, 95)), 3),
            "max": round(float(distance.max()), 2)}


def recorded_rows(pair, left_out):
    """A row for each recorded map, of the points that it takes somewhere; the others are counted."""
    rows = []
    for method, carried in pair.recorded.items():
        direct, mirrored = (np.linalg.norm(carried - places, axis=1) for places in (pair.places, pair.mirrored))
        is_direct = np.nanmean(direct) <= np.nanmean(mirrored)
        truth = Pair(pair.name, pair.source, pair.target, pair.points, pair.places if is_direct else pair.mirrored)
        nowhere = np.flatnonzero(~np.isfinite(carried).all(1))
        rows.append({"pair": pair.name, "method": method, "mirrored": bool(not is_direct), "nowhere": len(nowhere),
                     **errors(truth, carried, np.union1d(nowhere, left_out).astype(int))})
    return rows


def write_anchors(path, pair, chosen, noise):
    diagonal = np.linalg.norm(np.ptp(pair.source[0], axis=0))
    shift = np.random.default_rng(SEED).normal(size=(len(chosen), 3)) * noise * diagonal
    path.write_text(json.dumps({"pairs": [
        {"name": f"p{index}", "a": pair.points[index].tolist(), "b": (pair.places[index] + moved).tolist()}
        for index, moved in zip(chosen, shift)]}), encoding="ascii")


def children_seconds():
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


def fit(command, timeout):
    """CPU seconds, and what went wrong ("" when nothing did)."""
    before = children_seconds()
    try:
        run = subprocess.run(command, capture_output=True, text=True, errors="replace", timeout=timeout, check=False)
        said = (run.stderr.strip().splitlines() or [""])[-1]
        failure = f"exit code {run.returncode}: {said}" if run.returncode else ""
    except subprocess.TimeoutExpired:
        failure = f"stopped after {timeout:g} s"
    return round(children_seconds() - before, 1), failure


def score(pair, options, folder):
    row = {"pair": pair.name, "vertices": [len(pair.source[0]), len(pair.target[0])]}
    write_obj(folder / "source.obj", pair.source)
    write_obj(folder / "target.obj", pair.target)
    np.savetxt(folder / "points.xyz", pair.points, fmt="%.9g")
    anchors = [] if options.without_anchors else farthest(pair.points, options.anchors)
    map_file, carried_file = folder / "map.vdb", folder / "carried.xyz"
    command = [options.bespoke, "fit", folder / "source.obj", folder / "target.obj", "-o", map_file, "--quiet",
               "--threads", str(options.threads)]
    if anchors:
        write_anchors(folder / "anchors.json", pair, anchors, options.noise)
        command += ["--anchors", folder / "anchors.json"]
    row["cpu_seconds"], failure = fit([*map(str, command), *options.fit_options], options.timeout)
    if failure:
        return {**row, "failure": failure.replace(str(folder) + "/", "")}
    row["megabytes"] = round(map_file.stat().st_size / 1e6, 1)
    subprocess.run([options.bespoke, "apply", map_file, folder / "points.xyz", "-o", carried_file, "--quiet"],
                   check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    carried = np.loadtxt(carried_file)
    info = subprocess.run([options.bespoke, "info", map_file, "--json"], check=True, capture_output=True)
    return {**row, **errors(pair, carried, anchors), "flipped": flipped_faces(pair, carried),
            "proved": bool((json.loads(info.stdout).get("certificate") or {}).get("bijection"))}


def parse_options(arguments):
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("bespoke", help="the program to score")
    group = parser.add_mutually_exclusive_group(required=True)
    group.add_argument("--choose", action="store_true", help="FAUST subjects 0-4; TOSCA's cat, dog, wolf, michael")
    group.add_argument("--report", action="store_true", help="FAUST 5-9, TOSCA's others, bodies, skulls")
    group.add_argument("--generated", action="store_true", help="pairs of `bespoke samples`; no download")
    parser.add_argument("--clones", type=Path, help="folder of the clones")
    parser.add_argument("--sets", default=",".join(SETS), help="which of %(default)s")
    parser.add_argument("--pairs", type=int, default=3, help="of each set (default: %(default)s)")
    parser.add_argument("--mouse-pairs", type=int, default=1, help="of skulls, large models (default: %(default)s)")
    parser.add_argument("--anchors", type=int, default=20, metavar="N", help="a pair (default: %(default)s)")
    parser.add_argument("--without-anchors", action="store_true")
    parser.add_argument("--noise", type=float, default=0, metavar="FRACTION",
                        help="standard deviation of anchors' b, of the diagonal")
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--timeout", type=float, default=600, metavar="SECONDS", help="a fit (default: %(default)s)")
    parser.add_argument("--json", type=Path, metavar="FILE", help="rows so far, rewritten after each pair")
    parser.add_argument("--fit-options", nargs=argparse.REMAINDER, default=[],
                        help="all that follows goes to `bespoke fit`")
    options = parser.parse_args(arguments)
    options.sets = options.sets.split(",")
    if unknown := [name for name in options.sets if name not in SETS]:
        parser.error(f"--sets: {', '.join(unknown)} is none of {', '.join(SETS)}")
    if not options.generated and options.clones is None:
        parser.error("--choose and --report need --clones; --generated needs no download")
    if min(options.pairs, options.mouse_pairs, options.anchors, options.threads) < 1:
        parser.error("--pairs, --mouse-pairs, --anchors and --threads must be at least 1")
    return options


def chosen_pairs(options, commits, folder):
    if options.generated:
        return generated_pairs(options.bespoke, folder)
    makers = {"faust-persons": faust_pairs, "faust-poses": faust_pairs, "tosca": tosca_pairs,
              "tosca-across": tosca_across_pairs, "garmentcode": garmentcode_pairs, "mouse": mouse_pairs}
    names = [name for name in options.sets if options.report or name in CHOOSING_SETS]
    clones = {SETS[name]: Clone(options.clones, SETS[name]) for name in names}
    commits.update({clone.repository: clone.commit() for clone in clones.values()})
    return pairs_by_turns([makers[name](clones[SETS[name]], name, options) for name in names])


def main():
    options = parse_options(sys.argv[1:])
    rows, recorded, commits = [], [], {}
    with tempfile.TemporaryDirectory() as folder:
        for pair in chosen_pairs(options, commits, Path(folder)):
            begin = time.monotonic()
            rows.append(score(pair, options, Path(folder)))
            recorded += recorded_rows(pair, farthest(pair.points, options.anchors))
            print(f"{pair.name}: {time.monotonic() - begin:.0f} s", file=sys.stderr, flush=True)
            if options.json:
                found = {"commits": commits, "rows": rows, "recorded": recorded}
                options.json.write_text(json.dumps(found, indent=1) + "\n")
    print(tables.public_table(rows), end="")
    if recorded:
        print("\n" + tables.recorded_maps_table(recorded), end="")
    for repository, commit in commits.items():
        print(f"- {repository} at {commit}")


if __name__ == "__main__":
    try:
        main()
    except (Missing, OSError, subprocess.CalledProcessError) as error:
        sys.exit(f"public_pairs.py: {error}")
