#!/usr/bin/python3
"""What each rule and each constant of the registration is worth on the choosing set.

    tests/accuracy/ablate.py --build build/release --clones DIR --work DIR [--only REGEX] [--without RULE[,RULE…]] [--vary FACTOR]

Copies the registration's sources to --work, lets the copy read its constants from the environment, and links it with the
library of --build: the library itself has no such door. Then it switches off each rule, and rounds each constant to one
significant digit, one at a time, and registers the pairs anew. --without leaves rules out of all runs, for backward
elimination. --vary changes each constant by a factor either way instead, on the first pairs alone. Runs are kept in --work
and not repeated while sources and pairs stay the same. Prints a Markdown table.

A factor is the geometric mean, over the pairs of a group, of the error over that of the registration as it is, of mean and
95th percentile. All variants are first run on the pair of median error of each group; then those that cost less than 1 % there on all.
"""
import argparse
import hashlib
import json
import os
import re
import shlex
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass, field, replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import dijkstra

import public_pairs

ROOT = Path(__file__).resolve().parents[2]
MODULES = ("alignment", "anchor_checks", "anchors", "pipeline", "registration", "surface_fit")
SETTINGS = "surface_fit/deformation_graph_settings.h"
CANDIDATE = 1.01  # of the errors on the first pairs: what costs more stays
NUMBER = r"-?\d[\d.']*(?:e-?\d+)?"
# What is no number of the method: work shared out, texts, sizes of types, and the printed method.
NO_CONSTANTS = re.compile(r"grain|max_named|max_names|few_names|features|^none$|nobody|fixed$|tiny|infinity|median_of_normal")
NO_FILES = re.compile(r"laplacian|displacement_smoother|derive_map|bake_|fit_steps|fit_map|divided_map|whole_fit|unusable_fit|"
                      r"anchor_suggestions|elastic_|enclosed_faces|anchor_files|unmet_vertices|/meshlab|slicer|summary|"
                      r"point_files|anchor_curves|anchor_scale|anchor_placement|make_map|anchor_json")


@dataclass
class Rule:
    """Off: the constants take these values, or the text `old` of a file becomes `new`."""
    name: str
    group: str
    values: dict = field(default_factory=dict)
    file: str = ""
    old: str = ""
    new: str = ""


def by_value(name, group, **values):
    return Rule(name, group, {key.replace("__", "."): value for key, value in values.items()})


RULES = [
    by_value("weights by curvature", "pairs", AreaSettings__max_weight=0),
    by_value("one similarity may suffice", "similarity", SimilaritySettings__tolerance=0),
    by_value("residuals may be noise", "similarity", SimilaritySettings__noise_correlation=-2),
    by_value("normals in the distance", "pairs", NodeFitSettings__normal_length=0),
    by_value("target-to-source pairs", "pairs", NodeFitSettings__back_share=0),
    by_value("reciprocity, nodes", "pairs", NodeLevel__reciprocity=0),
    Rule("reciprocity, layers", "pairs", file="surface_fit/detail/detail_layers.cpp",
         old="step.areas[i] * found->agreement * found->agreement * reciprocity(back, settings)",
         new="step.areas[i] * found->agreement * found->agreement"),
    Rule("larger scale in creases", "pairs", file="surface_fit/matching/plane_pairs.cpp",
         old="fading * std::max(crease(pair, back), off)", new="fading * off"),
    by_value("larger scale outside the target", "pairs", NodeLevel__outside_residuals=0),
    Rule("weights by agreement of normals", "pairs", file="surface_fit/matching/plane_pairs.cpp",
         old="match->agreement *\n                        match->agreement *", new="1 *"),
    by_value("open boundaries that are the same cut", "pairs", NodeFitSettings__boundary_start=1000),
    by_value("walls that face each other have no counterpart", "cavities", CavitySettings__reach=0),
    by_value("unmatched cavities move with the space around", "cavities", UnmatchedCavitySettings__min_matched=0),
    by_value("shape term", "shape", ShapeSettings__share=0),
    by_value("parts of their own scale", "shape", ShapeSettings__scale_freedom=0),
    by_value("rigidity of the pair", "shape", ShapeSettings__max_rigid=1),
    by_value("nodes weigh by the area as it is now", "shape", BendingSettings__max_growth=1),
    by_value("long edges halved", "shape", DeformationGraphSettings__edges_per_area=1e-9),
    by_value("uncertainty along the surfaces", "anchors", AnchorSettings__along_surface=0),
    by_value("inaccurate anchors reinforced", "anchors", AnchorSettings__max_reinforced=1),
    Rule("exact anchors weigh more with every iteration", "anchors", file="surface_fit/graph/node_fit.cpp",
         old="settings_.anchor_growth * (iteration + 1)", new="settings_.anchor_growth"),
    Rule("targets of inaccurate anchors brought to the surface", "anchors",
         file="surface_fit/detail/deformation_graph_fit.cpp",
         old="if (!(anchors.sigmas.array() > 0).any()) return;", new="if (anchors.sigmas.size() >= 0) return;"),
    by_value("posed by anchors", "pose", PoseSettings__anchor_reach=1e9, PoseSettings__min_rigid_turn=1e9),
    by_value("posed where nearly rigid", "pose", PoseSettings__min_rigid_turn=1e9),
    Rule("fine nodes of the pose", "pose", file="surface_fit/graph/anchor_pose.cpp",
         old="iteration < settings_.iterations[1]", new="iteration < 0"),
    by_value("layers of space", "layers", DetailSettings__scales=0),
    by_value("point to point beside point to plane", "layers", DetailSettings__slide=0),
    by_value("weight of staying", "layers", DetailSettings__stay=1e-6),
    by_value("bounded moves of a layer", "layers", DetailSettings__max_move=1e9),
    by_value("bounded gradient of a layer", "layers", DetailSettings__max_gradient=1e9),
    by_value("further layers for exact anchors", "layers", DetailSettings__max_anchor_passes=1),
    Rule("anchors that overstretch are not met", "layers", {"anchor_meeting.max_doublings": 0}),
    by_value("face repair", "repair", FaceRepairSettings__max_released=0, FaceRepairSettings__released_at_least=0),
    by_value("misoriented faces reset", "repair", FaceRepairSettings__max_degrees=180),
    Rule("faces at new folds reset", "repair", file="surface_fit/detail/misoriented_faces.cpp",
         old="else if (is_folded[face])", new="else if (false && is_folded[face])"),
    Rule("σ estimated from the surfaces", "σ", file="anchors/anchor_accuracy.cpp",
         old="accuracy.sigma = deviation < least ? 0 : deviation;", new="accuracy.sigma = 0;"),
    Rule("swapped anchors dropped", "σ", file="anchors/anchor_accuracy.cpp",
         old="accuracy.swapped = swapped_anchors(anchors);", new="accuracy.swapped = {};"),
    Rule("contradicting anchors share their difference", "σ", file="registration/detail/register_by_anchors.cpp",
         old="best = with_shared_contradictions(task, std::move(best), progress);", new="best = best;"),
    by_value("pairs by distances along the surfaces", "pose", GeodesicSettings__min_anchors=1000000),
    by_value("outliers among anchors", "outliers", OutlierAnchorSettings__min_tested=1000000),
    Rule("fitted by all pairs where the result is suspect", "outliers", file="registration/detail/register_by_anchors.cpp",
         old="if (!is_suspect(figures)) return fit;", new="if (is_suspect(figures) || true) return fit;"),
    Rule("counterparts along the surfaces", "outliers", file="registration/detail/register_by_anchors.cpp",
         old="if (counterparts.sources.cols() == 0) return by_anchors;",
         new="if (counterparts.sources.cols() >= 0) return by_anchors;"),
    Rule("contacts separated", "contact", file="registration/registration.cpp",
         old="if (apart.summary.touching == 0) return registration;",
         new="if (apart.summary.touching + 1 > 0) return registration;"),
]


def main():
    options = parse_options()
    rules = {rule.name: rule for rule in RULES}
    without = [name for name in options.without.split(",") if name]
    if unknown := [name for name in without if name not in rules]:
        sys.exit(f"ablate.py: no rule is named {', '.join(unknown)}")
    constants = instrument(options.work / "sources")
    program = build(options.work, options.build)
    cases = write_cases(options)
    runner = Runner(program, cases, options.work / "runs.json", source_key(options.work / "sources"))

    base_values = values_of([rules[name] for name in without])
    everything = [str(k) for k in range(len(cases))]
    as_it_is, base = runner.run({}, everything), runner.run(base_values, everything)
    variants = [(f"no {rule.name}", values_of([rule])) for rule in RULES if rule.name not in without]
    changed = varied(constants, options.vary) if options.vary else rounded(constants)
    variants += [(f"{name} {number(old)} → {number(new)}", {name: new}) for name, old, new in changed]
    variants = [(name, {**base_values, **values}) for name, values in variants if re.search(options.only, name)]
    groups = options.groups.split(",") if options.groups else list(dict.fromkeys(case.group for case in cases))
    first = [middle(as_it_is, [str(k) for k, case in enumerate(cases) if case.group == group]) for group in groups]
    end = time.monotonic() + 60 * options.minutes
    found = {}
    for name, values in variants:
        if time.monotonic() < end or runner.has(values, first):
            found[name] = runner.run(values, first)
    for name, values in sorted(variants, key=lambda each: factor(found.get(each[0], {}), base, first)):
        if not options.vary and time.monotonic() < end and factor(found.get(name, {}), base, first) < CANDIDATE:
            found[name] = runner.run(values, everything)
    rows = [("as it is", as_it_is, as_it_is)]
    if without:
        rows.append((f"without {', '.join(without)}", base, as_it_is))
    rows += [(name, found[name], base) for name, _ in variants if name in found]
    print(table(rows, cases))


def middle(found, numbers):
    """The one of median error, the smaller of two."""
    return sorted(numbers, key=lambda k: found[k].get("mean", 1e9))[(len(numbers) - 1) // 2]


def parse_options():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", type=Path, default=ROOT / "build/release", help="configured, its library built")
    parser.add_argument("--clones", type=Path, required=True, metavar="DIR", help="as public_pairs.py takes them")
    parser.add_argument("--work", type=Path, required=True, metavar="DIR")
    parser.add_argument("--only", default="", metavar="REGEX", help="variants whose names match")
    parser.add_argument("--vary", type=float, default=0, metavar="FACTOR",
                        help="instead of rounding, change each constant by this factor either way, on the first pairs alone")
    parser.add_argument("--without", default="", metavar="RULE[,RULE…]", help="rules left out of all runs")
    parser.add_argument("--groups", default="", metavar="GROUP[,GROUP…]", help="whose pairs are run first (default: all)")
    parser.add_argument("--minutes", type=float, default=1e9, metavar="N", help="then no further run begins")
    return parser.parse_args()


# The copy of the registration ---------------------------------------------------------------------------------------------

TUNED = """#pragma once
#include <cstdlib>
#include <map>
#include <string>

namespace bespoke {

/// What the environment says of a constant: TUNED="name=value;name=value".
inline double tuned_value(const char* name, double value) {
  static const std::map<std::string, double> all = [] {
    std::map<std::string, double> read;
    const char* const text = std::getenv("TUNED");
    std::string left = text ? text : "";
    while (!left.empty()) {
      const std::string entry = left.substr(0, left.find(';'));
      left = entry.size() < left.size() ? left.substr(entry.size() + 1) : "";
      read[entry.substr(0, entry.find('='))] = std::stod(entry.substr(entry.find('=') + 1));
    }
    return read;
  }();
  const auto found = all.find(name);
  return found == all.end() ? value : found->second;
}

template <class T>
T tuned(const char* name, T value) { return static_cast<T>(tuned_value(name, static_cast<double>(value))); }

}  // namespace bespoke
"""


def instrument(folder):
    """Writes the copy; returns the constants found, by name."""
    constants = {}
    for path in sorted((ROOT / "src/bespoke").rglob("*")):
        relative = path.relative_to(ROOT / "src/bespoke").as_posix()
        if path.suffix not in (".h", ".cpp") or not relative.startswith(MODULES):
            continue
        text = path.read_text(encoding="utf-8")
        for rule in (rule for rule in RULES if rule.file == relative):
            if text.count(rule.old) != 1:
                sys.exit(f"ablate.py: {relative} says {text.count(rule.old)} times \"{rule.old}\", for \"{rule.name}\"")
            text = switched(text, rule)
        if not NO_FILES.search(relative):
            text = with_tuned_constants(relative, text, constants)
        write_if_new(folder / "bespoke" / relative, '#include "tuned.h"\n' + text)
    write_if_new(folder / "tuned.h", TUNED)
    return constants


def switched(text, rule):
    """Both texts, and the environment chooses. A rule's `old` is a whole expression, condition or statement."""
    key = json.dumps(f"rule:{rule.name}", ensure_ascii=False)
    off = f"tuned({key}, 1) == 0"
    if rule.old.endswith(";"):
        if rule.new.startswith("if"):
            return text.replace(rule.old, f"if ({off}) {{ {rule.new} }} else {{ {rule.old} }}")
        return text.replace(rule.old, f"if ({off}) {rule.new} else {rule.old}")
    if rule.old.startswith(("if (", "else if (")):
        return text.replace(rule.old, with_condition(rule, off))
    if rule.new == "1 *":
        return text.replace(rule.old, f"(({off}) ? 1.0 : {rule.old.rstrip(' *')}) *")
    return text.replace(rule.old, f"(({off}) ? ({rule.new}) : ({rule.old}))")


def with_condition(rule, off):
    """`if (old)` with both conditions; what follows the closing parenthesis stays."""
    def parts(text):
        begin = text.index("(")
        depth, end = 0, begin
        for end in range(begin, len(text)):
            depth += {"(": 1, ")": -1}.get(text[end], 0)
            if depth == 0:
                break
        return text[:begin], text[begin:end + 1], text[end + 1:]
    head, old, rest = parts(rule.old)
    _, new, _ = parts(rule.new)
    return f"{head}(({off}) ? {new} : {old}){rest}"


def with_tuned_constants(relative, text, constants):
    stem = Path(relative).stem
    lines, struct = [], ""
    for line in text.splitlines():
        if found := re.match(r"(?:struct|class) (\w+)", line):
            struct = found.group(1)
        elif line.startswith("}"):
            struct = ""
        scope = struct if struct and struct != "Settings" else f"{stem}"
        is_field = re.match(r"  (?:double|int|std::size_t|bool) \w+ = ", line) and re.search("(Settings|Options|NodeLevel)$",
                                                                                             struct)
        is_constant = re.match(r"\s*(?:inline )?constexpr (?:double|int|std::size_t|Eigen::Index) ", line)
        if is_field or is_constant:
            code, comment = re.match(r"(.*?;)(.*)$", line).groups() if ";" in line else (line, "")
            kind = re.search(r"(double|int|std::size_t|bool|Eigen::Index) ", code).group(1)
            names = []

            def replace(match, kind=kind, scope=scope, names=names):
                name, value = match.groups()
                names.append(name)
                if NO_CONSTANTS.search(name):
                    return match.group(0)
                key = f"{scope}.{name}"
                constants[key] = float(value.replace("'", "")) if value[0] != "t" and value[0] != "f" else value == "true"
                return f'{name} = tuned<{kind}>("{key}", {value})'
            changed = re.sub(rf"(\w+) = ({NUMBER}|true|false)(?=[,;])", replace, code)
            if is_constant and not any(NO_CONSTANTS.search(name) for name in names):
                in_function = line.startswith("  ")
                changed = re.sub(r"constexpr ", "static const " if in_function else "const ", changed, count=1)
            line = changed + comment
        line = re.sub(r"^constexpr (Settings|\w*Settings) (\w+);", r"const \1 \2;", line)
        lines.append(line)
    text = "\n".join(lines) + "\n"
    if relative == SETTINGS:
        text = with_tuned_levels(text, constants)
    return text


def with_tuned_levels(text, constants):
    def level(match):
        names = ("nodes", "iterations", "samples", "back_samples")
        which = "coarse" if "400" in match.group(0) else "fine"
        values = match.group(1).split(", ")
        for name, value in zip(names, values):
            if re.fullmatch(NUMBER, value):
                constants[f"{which}.{name}"] = float(value)
        return "NodeLevel{" + ", ".join([
            f'tuned<{"int" if k < 2 else "std::size_t"}>("{which}.{name}", {value})'
            for k, (name, value) in enumerate(zip(names, values))] + values[4:]) + "}"

    def pair(match):
        values = match.group(2).split(", ")
        for k, value in enumerate(values):
            constants[f"PoseSettings.{match.group(1)}_{k}"] = float(value)
        return f"{match.group(1)} = {{" + ", ".join(
            f'tuned<int>("PoseSettings.{match.group(1)}_{k}", {value})' for k, value in enumerate(values)) + "}"
    text = re.sub(r"NodeLevel\{([^}]*)\}", level, text)
    return re.sub(r"(nodes|iterations) = \{(\d+, \d+)\}", pair, text)


def write_if_new(path, text):
    path.parent.mkdir(parents=True, exist_ok=True)
    if not path.exists() or path.read_text(encoding="utf-8") != text:
        path.write_text(text, encoding="utf-8")


def source_key(folder):
    digest = hashlib.sha256()
    for path in sorted(folder.rglob("*")):
        if path.is_file():
            digest.update(path.read_bytes())
    return digest.hexdigest()[:16]


def build(work, build_folder):
    """The copy, one unit a folder, linked before the library, whose own objects of these folders stay out."""
    program, objects = work / "register_pairs", []
    flags = compile_flags(build_folder)
    include = f"-I{work / 'sources'}"
    for folder in sorted({path.parent for path in (work / "sources").rglob("*.cpp")}):
        sources = sorted(folder.glob("*.cpp"))
        name = folder.relative_to(work / "sources").as_posix().replace("/", "_")
        unit = work / "units" / f"{name}.cpp"
        write_if_new(unit, "".join(f'#include "{path}"\n' for path in sources))
        objects.append(compiled(unit, [include, *flags], max(path.stat().st_mtime for path in folder.parent.rglob("*.*"))))
    runner = Path(__file__).with_name("register_pairs.cpp")
    objects.append(compiled(runner, [include, *flags], 0, work / "units/register_pairs.o"))
    if not program.exists() or any(each.stat().st_mtime > program.stat().st_mtime for each in objects):
        run(["c++", "-o", program, *objects, *libraries(build_folder)], cwd=build_folder)
    return program


def compiled(source, flags, newest, target=None):
    target = target or source.with_suffix(".o")
    newest = max(newest, source.stat().st_mtime, (source.parents[1] / "sources/tuned.h").stat().st_mtime
                 if (source.parents[1] / "sources/tuned.h").exists() else 0)
    if not target.exists() or target.stat().st_mtime < newest:
        print(f"compiling {source.stem}", file=sys.stderr, flush=True)
        run(["c++", *flags, "-c", source, "-o", target])
    return target


def compile_flags(build_folder):
    """Of the library, without warnings and precompiled headers."""
    commands = json.loads((build_folder / "compile_commands.json").read_text(encoding="utf-8"))
    command = next(each["command"] for each in commands if "surface_fit" in each["file"] or "surface_fit" in each["command"])
    words = shlex.split(command)
    kept = [word for word in words if re.match(r"-(O|D|I|f|std)", word) and not re.match(r"-fpch|-I.*\.dir", word)]
    return kept + [word for place, own in enumerate(words) if own == "-isystem" for word in words[place:place + 2]]


def libraries(build_folder):
    """As a test of the pipeline links them."""
    text = subprocess.run(["ninja", "-C", build_folder, "-t", "commands", "bin/pipeline_test"], capture_output=True,
                          text=True, check=True).stdout.strip().splitlines()[-1]
    words = shlex.split(text)
    return [word for word in words if re.search(r"\.(a|so[\d.]*)$|^-l|^-Wl,-rpath", word) and "gtest" not in word
            and "gmock" not in word]


def run(command, **options):
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True, check=False, **options)
    if done.returncode:
        sys.exit(f"ablate.py: {command[0]} failed:\n{done.stderr[-3000:]}")
    return done.stdout


# The pairs ----------------------------------------------------------------------------------------------------------------

@dataclass
class Case:
    group: str
    pair: object
    anchors: int
    noise: float
    folder: Path
    vertices: object  # of the source, whose places are known
    left_out: list


def write_cases(options):
    cases = []
    for group, pair, anchors, noise in chosen_pairs(options):
        wrong = 0
        if isinstance(pair, Mistaken):
            pair, wrong = pair.pair, pair.count
        folder = options.work / "pairs" / f"{len(cases):02d}"
        folder.mkdir(parents=True, exist_ok=True)
        public_pairs.write_obj(folder / "source.obj", pair.source)
        public_pairs.write_obj(folder / "target.obj", pair.target)
        chosen = public_pairs.farthest(pair.points, anchors) if anchors else []
        (folder / "anchors.json").unlink(missing_ok=True)
        if anchors:
            named = replace(pair, places=mistaken(pair, chosen, wrong)) if wrong else pair
            public_pairs.write_anchors(folder / "anchors.json", named, chosen, noise)
        vertices = pair.vertices
        if vertices is None:
            place = {tuple(vertex): index for index, vertex in enumerate(pair.source[0])}
            vertices = np.array([place[tuple(point)] for point in pair.points])
        cases.append(Case(group, pair, anchors, noise, folder, vertices, chosen))
    return cases


def chosen_pairs(options):
    """(group, pair, anchors, noise). The first of a group is run first."""
    faust = public_pairs.Clone(options.clones, "faust")
    persons = list(public_pairs.faust_pairs(faust, "faust-persons", SimpleNamespace(choose=True, pairs=2)))
    poses = list(public_pairs.faust_pairs(faust, "faust-poses", SimpleNamespace(choose=True, pairs=2)))
    for pair in persons:
        yield "persons", pair, 20, 0
    for pair in poses:
        yield "poses", pair, 20, 0
    for pair in (poses[0], persons[0]):
        yield "8 anchors", pair, 8, 0
    for pair in (persons[1], poses[1]):
        yield "noisy anchors", pair, 20, 0.01
    tosca = public_pairs.Clone(options.clones, "tosca")
    seen = set()
    for pair in public_pairs.tosca_pairs(tosca, "tosca", SimpleNamespace(choose=True, pairs=40)):
        shape = re.match(r"tosca ([a-z]+)", pair.name).group(1)
        if shape not in seen:
            seen.add(shape)
            yield "TOSCA", pair, 20, 0
    with tempfile.TemporaryDirectory() as folder:
        generated = list(public_pairs.generated_pairs(str((options.build / "bin/bespoke").resolve()), Path(folder)))
    for pair in generated:
        yield "generated", pair, 12, 0
    for pair in (persons[0], generated[1], generated[2]):
        yield "scans", as_scan(pair), 20, 0
    for pair in (persons[0], poses[0]):
        yield "outliers", with_outliers(pair, 3), 20, 0
    yield "outliers", with_outliers(persons[1], 6), 40, 0
    for pair in (generated[1], persons[0]):
        yield "no anchors", pair, 0, 0
    for pair in (persons[1], poses[1]):
        yield "few vertices", with_few_vertices(pair, 1000), 20, 0
    yield "copies", remeshed_copy(persons[0]), 12, 0
    for pair in (generated[1], persons[0]):
        yield "pockets", with_pocket(pair), 12, 0


@dataclass
class Mistaken:
    """A pair whose anchors with these numbers name another place of the target."""
    pair: public_pairs.Pair
    count: int


def with_outliers(pair, count):
    return Mistaken(pair, count)


def mistaken(pair, chosen, count):
    """Places of the target, some of which are another point's, at least 6 % of the diagonal away."""
    random = np.random.default_rng(public_pairs.SEED)
    places = pair.places.copy()
    size = np.linalg.norm(np.ptp(pair.target[0], axis=0))
    for index in random.choice(chosen, count, replace=False):
        far = np.flatnonzero(np.linalg.norm(pair.places - pair.places[index], axis=1) > 0.06 * size)
        places[index] = pair.places[random.choice(far)]
    return places


def with_few_vertices(pair, count):
    """The source by some of its vertices: corners of the regions nearest to them along the edges that meet in a face."""
    vertices, faces = pair.source
    kept = public_pairs.farthest(vertices, count)
    edges = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    lengths = np.linalg.norm(vertices[edges[:, 0]] - vertices[edges[:, 1]], axis=1)
    graph = coo_matrix((lengths, edges.T), shape=(len(vertices), len(vertices))).tocsr()
    _, _, nearest = dijkstra(graph, directed=False, indices=kept, min_only=True, return_predecessors=True)
    number = np.full(len(vertices), -1)
    number[kept] = np.arange(count)
    corners = number[nearest[faces]]
    corners = corners[(corners[:, 0] != corners[:, 1]) & (corners[:, 1] != corners[:, 2]) & (corners[:, 2] != corners[:, 0])]
    _, first = np.unique(np.sort(corners, axis=1), axis=0, return_index=True)
    known = np.flatnonzero(np.isin(kept, pair.vertices))
    place = {vertex: index for index, vertex in enumerate(pair.vertices)}
    truth = np.array([place[kept[index]] for index in known])
    return public_pairs.Pair(f"{pair.name} of {count} vertices", (vertices[kept], corners[np.sort(first)]), pair.target,
                             pair.points[truth], pair.places[truth], known)


def remeshed_copy(pair):
    vertices, faces = pair.source
    return public_pairs.Pair(f"{pair.name}, a copy", pair.source, public_pairs.remeshed(vertices, faces), vertices, vertices,
                             np.arange(len(vertices)))


def with_pocket(pair):
    """The source with a pocket that the target lacks, three times as deep as wide, at the vertex nearest to the viewer."""
    vertices, faces = pair.source
    size = np.linalg.norm(np.ptp(vertices, axis=0))
    width = 0.03 * size
    middle = vertices[np.argmax(vertices[:, 2] - 0.5 * abs(vertices[:, 1] - np.quantile(vertices[:, 1], 0.8)))]
    share = np.linalg.norm(vertices - middle, axis=1) / width
    normal = vertex_normal(vertices, faces, middle)
    inside = share < 1
    moved = vertices.copy()
    moved[inside] -= 3 * width * np.outer(1 - share[inside] ** 2, normal)
    outside = np.flatnonzero(np.linalg.norm(vertices[pair.vertices] - middle, axis=1) > 1.2 * width)
    return public_pairs.Pair(f"{pair.name} with a pocket", (moved, faces), pair.target, pair.points[outside],
                             pair.places[outside], pair.vertices[outside])


def vertex_normal(vertices, faces, place):
    at = np.argmin(np.linalg.norm(vertices - place, axis=1))
    own = vertices[faces[(faces == at).any(1)]]
    normal = np.cross(own[:, 1] - own[:, 0], own[:, 2] - own[:, 0]).sum(0)
    return normal / np.linalg.norm(normal)


def as_scan(pair):
    """With noise in the target's vertices, holes and debris, as a scanner leaves them."""
    random = np.random.default_rng(public_pairs.SEED)
    vertices, faces = pair.target
    size = np.linalg.norm(np.ptp(vertices, axis=0))
    noisy = vertices + random.normal(size=vertices.shape) * 0.0008 * size
    holes = vertices[random.integers(len(vertices), size=8)]
    middles = vertices[faces].mean(1)
    kept = faces[(np.linalg.norm(middles[:, None] - holes, axis=2) > 0.0125 * size).all(1)]
    corners = np.array([[1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]]) * 0.002 * size
    low, high = vertices.min(0), vertices.max(0)
    debris = [random.uniform(low, high) + corners for _ in range(20)]
    tetrahedron = np.array([[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]])
    bits = [tetrahedron + len(vertices) + 4 * k for k in range(len(debris))]
    return public_pairs.Pair(f"{pair.name} as a scan", pair.source,
                             (np.concatenate([noisy, *debris]), np.concatenate([kept, *bits])), pair.points, pair.places,
                             pair.vertices)


# The runs -----------------------------------------------------------------------------------------------------------------

class Runner:
    def __init__(self, program, cases, store, key):
        self.program, self.cases, self.store = program, cases, store
        pairs = hashlib.sha256()
        for case in cases:
            for name in ("source.obj", "target.obj", "anchors.json"):
                if (case.folder / name).exists():
                    pairs.update((case.folder / name).read_bytes())
        self.key = f"{key} {pairs.hexdigest()[:16]}"
        kept = json.loads(store.read_text(encoding="utf-8")) if store.exists() else {}
        self.runs = kept if kept.get("key") == self.key else {"key": self.key}

    def run(self, values, numbers):
        """Of the cases with these numbers the errors, by number."""
        text = self.text(values)
        found = self.runs.setdefault(text, {})
        if missing := [number for number in numbers if number not in found]:
            self.register(text, missing, found)
        return {number: found[number] for number in numbers}

    def has(self, values, numbers):
        return set(numbers) <= set(self.runs.get(self.text(values), {}))

    @staticmethod
    def text(values):
        return ";".join(f"{name}={value:.17g}" for name, value in sorted(values.items()))

    def register(self, text, numbers, found):
        print(f"{len(numbers)} pairs: {text or 'as it is'}", file=sys.stderr, flush=True)
        folders = [self.cases[int(number)].folder for number in numbers]
        lines = subprocess.run([self.program, *folders], env={**os.environ, "TUNED": text}, text=True, capture_output=True,
                               check=False).stdout.splitlines()
        for number, line in zip(numbers, lines):
            _, seconds, failure = line.split("\t", 2)
            errors = {"failure": failure} if failure else scored(self.cases[int(number)])
            found[number] = {"seconds": float(seconds), **errors}
        for number in numbers[len(lines):]:
            found[number] = {"seconds": 0, "failure": "the program ended early"}
        self.store.write_text(json.dumps(self.runs), encoding="utf-8")


def scored(case):
    places = np.fromfile(case.folder / "registered.f64").reshape(-1, 3)
    row = public_pairs.errors(case.pair, places[case.vertices], case.left_out)
    row["flips"] = public_pairs.flipped_faces(case.pair, places[case.vertices]) or 0
    return row


def factor(found, base, numbers, keys=("mean", "p95")):
    """Geometric mean over the pairs that neither lost."""
    both = [k for k in numbers if k in found and "mean" in found[k] and "mean" in base[k]]
    if not both:
        return float("nan")
    floor = 1e-3  # per cent of the diagonal: the digits that errors are rounded to
    return float(np.exp(np.mean([np.log(max(found[k][key], floor) / max(base[k][key], floor))
                                 for k in both for key in keys])))


def values_of(rules):
    values = {}
    for rule in rules:
        values.update(rule.values or {f"rule:{rule.name}": 0})
    return values


def rounded(constants):
    """Those of more than one significant digit: (name, value, rounded)."""
    for name, value in constants.items():
        if not isinstance(value, bool) and value and float(f"{value:.0e}") != value:
            yield name, value, float(f"{value:.0e}")


def varied(constants, by):
    """(name, value, changed), all larger ones first. What is near 1 is a share or a cosine: its distance from 1 changes."""
    def changed(value, by):
        if value == int(value):
            return round(value * by)
        return 1 - (1 - value) / by if 0.5 <= value < 1 else value * by
    numbers = {name: value for name, value in constants.items() if not isinstance(value, bool) and value}
    for factor_of_value in (by, 1 / by):
        for name, value in numbers.items():
            if (new := changed(value, factor_of_value)) != value:
                yield name, value, new


def number(value):
    return f"{value:g}"


def table(rows, cases):
    groups = list(dict.fromkeys(case.group for case in cases))
    lines = ["| variant | all: mean, p95 | " + " | ".join(groups) + " | flipped faces | failures | pairs |",
             "|---" * (len(groups) + 5) + "|"]
    for name, found, base in rows:
        cells = []
        for group in groups:
            numbers = [str(k) for k, case in enumerate(cases) if case.group == group]
            cells.append(f"{factor(found, base, numbers):.3f}")
        flips = sum(found[k].get("flips", 0) for k in found) - sum(base[k].get("flips", 0) for k in found)
        failures = sum("failure" in found[k] for k in found) - sum("failure" in base[k] for k in found)
        total = [f"{factor(found, base, list(found), [key]):.3f}" for key in ("mean", "p95")]
        lines.append(f"| {name} | {', '.join(total)} | {' | '.join(cells)} | {flips:+d} | {failures:+d} | {len(found)} |")
    return "\n".join(lines)


if __name__ == "__main__":
    try:
        main()
    except (public_pairs.Missing, OSError, subprocess.CalledProcessError) as error:
        sys.exit(f"ablate.py: {error}")
