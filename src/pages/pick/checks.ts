import type { Triple } from "../scene/scene";
import { box_diagonal, coarse_warp, distance, flatness, left_out_predictions, rigid_warp, type Warp } from "../maths/warp";
import { shown } from "../maths/numbers";
import { model_of } from "./curves";
import { is_complete, type CompletePair, type PickedPair } from "./history";

/** What the pairs say about each other, by the rules of `bespoke fit` (anchors/anchor_audit.h). */
export interface PairChecks {
  complete: CompletePair[];
  /** By complete pair; null where too few. */
  rigid: (number | null)[];
  left_out: (number | null)[];
  warp: Warp | null;
  /** About the pairs as a whole, then about single ones. */
  warnings: string[];
  /** By complete pair, empty without. */
  suspicions: string[];
}

const typical_factor = 4, min_share = 0.04; // as in anchor_audit.cpp
const same_place = 0.002; // of the diagonal: two points so near each other are one
const flat = 0.02; // least spread over the largest, below which a plane holds the points

const name_of = (pair: PickedPair, i: number): string => (pair.name === "" ? `pair ${i + 1}` : `“${pair.name}”`);

export function check_pairs(pairs: PickedPair[]): PairChecks {
  const complete = pairs.filter(is_complete);
  const a = complete.map((pair) => pair.a), b = complete.map((pair) => pair.b);
  const sigmas = complete.map((pair) => pair.sigma ?? 0);
  const checks: PairChecks = {
    complete,
    rigid: complete.map(() => null),
    left_out: complete.map(() => null),
    warp: coarse_warp(a, b, sigmas),
    warnings: [],
    suspicions: complete.map(() => ""),
  };
  const missing = pairs.length - complete.length;
  if (missing > 0) checks.warnings.push(`${missing} ${missing === 1 ? "pair lacks" : "pairs lack"} one end; saved are complete pairs only.`);
  if (complete.length < 4) checks.warnings.push(`${complete.length} complete ${complete.length === 1 ? "pair" : "pairs"}: a fit needs four, a dozen do better.`);
  if (complete.length >= 3) {
    const rigid = rigid_warp(a, b);
    checks.rigid = a.map((point, i) => distance(rigid(point), b[i]));
  }
  const twins = new Set(complete.filter((pair, i) => pair.name !== "" && complete.findIndex((other) => other.name === pair.name) < i).map((pair) => pair.name));
  for (const name of twins) checks.warnings.push(`Two pairs are named “${name}”: fit takes only names that differ.`);
  warn_of_places(complete, checks);
  if (complete.length >= 4) warn_of_shape(a, b, checks);
  if (complete.length >= 5) warn_of_outliers(complete, a, b, sigmas, checks);
  return checks;
}

function warn_of_places(complete: CompletePair[], checks: PairChecks): void {
  for (const side of ["a", "b"] as const) {
    const points = complete.map((pair) => pair[side]);
    const reach = same_place * box_diagonal(points);
    for (let i = 0; i < points.length; ++i)
      for (let j = 0; j < i; ++j)
        if (points.length > 2 && distance(points[i], points[j]) <= reach)
          checks.warnings.push(`${name_of(complete[j], j)} and ${name_of(complete[i], i)} lie at one place of the ${model_of[side]}.`);
  }
}

function warn_of_shape(a: Triple[], b: Triple[], checks: PairChecks): void {
  for (const [side, points] of [["source", a], ["target", b]] as const) {
    const { line, plane } = flatness(points);
    if (line < flat) checks.warnings.push(`The points of the ${side} lie in a line: add one beside it.`);
    else if (plane < flat) checks.warnings.push(`The points of the ${side} lie in a plane: add one off it.`);
  }
}

function warn_of_outliers(complete: CompletePair[], a: Triple[], b: Triple[], sigmas: number[], checks: PairChecks): void {
  const predicted = left_out_predictions(a, b, sigmas);
  checks.left_out = predicted.map((point, i) => (point === null ? null : distance(point, b[i])));
  const known = checks.left_out.filter((value) => value !== null).sort((x, y) => x - y);
  if (known.length < 6) return; // fewer say nothing about what is usual
  const limit = Math.max(min_share * box_diagonal(b), typical_factor * known[Math.floor(known.length / 2)]);
  complete.forEach((pair, i) => {
    const off = checks.left_out[i], place = predicted[i];
    if (off === null || place === null || off <= limit) return;
    const other = complete.findIndex((_, j) => {
      const theirs = predicted[j];
      return j !== i && theirs !== null && distance(place, b[j]) < 0.5 * off && distance(theirs, b[i]) < 0.5 * distance(theirs, b[j]);
    });
    checks.suspicions[i] = other >= 0 ? `perhaps swapped with ${name_of(complete[other], other)}` : `${shown(off)} from where the others put it`;
    checks.warnings.push(`${name_of(pair, i)}: ${checks.suspicions[i]}.`);
  });
}

/** The point of the source that lies farthest from all pairs: where no pair is near. */
export function next_place(vertices: Float32Array, taken: Triple[]): Triple | null {
  if (taken.length === 0) return null;
  let best: Triple | null = null, farthest = -1;
  const step = 3 * Math.max(1, Math.floor(vertices.length / 3 / 5000)); // a sample of the vertices finds the place as well
  for (let i = 0; i < vertices.length; i += step) {
    const point: Triple = [vertices[i], vertices[i + 1], vertices[i + 2]];
    const least = Math.min(...taken.map((other) => distance(point, other)));
    if (least > farthest) [best, farthest] = [point, least];
  }
  return best;
}
