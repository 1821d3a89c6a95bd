import { rigid_warp, distance, type Warp } from "../maths/warp";
import type { Triple } from "../scene/scene";
import { in_order, is_complete_curve, is_patch, is_whole, min_points, line_length, model_of, needed_sides, polyline, type PickedCurve, type PickedLine } from "./curves";
import type { CompletePair } from "./history";

export const curve_name = (curve: PickedCurve, i: number): string => (curve.name === "" ? `${is_patch(curve) ? "patch" : "curve"} ${i + 1}` : `“${curve.name}”`);

const pairs_that_fix_a_turn = 3; // as in anchor_curves.cpp
const samples = 24;

/** What is wrong or unclear about curves, and what patches lack, a line each. */
export function check_curves(curves: PickedCurve[], pairs: CompletePair[]): string[] {
  const warnings: string[] = [];
  const rigid = pairs.length < pairs_that_fix_a_turn ? null : rigid_warp(pairs.map((pair) => pair.a), pairs.map((pair) => pair.b));
  curves.forEach((curve, i) => {
    const name = curve_name(curve, i);
    if (!is_complete_curve(curve)) warnings.push(`${name} lacks ${lacking(curve)}; saved are complete ${is_patch(curve) ? "patches" : "curves"} only.`);
    if (is_patch(curve)) return; // more of them in patch_checks.ts
    const twin = curve.name === "" ? -1 : curves.findIndex((other) => !is_patch(other) && other.name === curve.name);
    if (twin >= 0 && twin < i) warnings.push(`Two curves are named ${name}: reports could not tell them apart.`);
    if (is_complete_curve(curve)) warn_of_way(curve, name, rigid, warnings);
  });
  return warnings;
}

function lacking(curve: PickedCurve): string {
  const missing = needed_sides(curve).filter((side) => !is_whole(curve, side));
  const points = missing.map((side) => {
    const count = min_points(curve) - curve[side].points.length;
    return `${count} ${count === 1 ? "point" : "points"} on the ${model_of[side]}`;
  });
  const one_is_enough = curve.meaning === "exclude" && missing.length === 2 && missing.every((side) => curve[side].points.length === 0);
  return points.join(one_is_enough ? " or " : " and ");
}

function warn_of_way(curve: PickedCurve, name: string, rigid: Warp | null, warnings: string[]): void {
  if (in_order(curve) === null) warnings.push(`${name}: its fixed points come in different orders on the two models; it is saved without them.`);
  // Where a closed curve begins, and two fixed points or more, decide the way round; else it is as clicked.
  const is_free = curve.closed && curve.fixed.length === 0;
  if (is_free && rigid === null) warnings.push(`${name} is closed: where it begins on the target follows from three pairs, or from points of it that are fixed together; without, fit refuses it.`);
  const decides = curve.closed ? 3 : 2;
  if (is_free || rigid === null || curve.fixed.length >= decides) return;
  const start = curve.closed && curve.fixed.length > 0 ? curve.fixed[0] : [0, 0];
  const a = evenly(curve.a, curve.closed, start[0]).map(rigid), b = evenly(curve.b, curve.closed, start[1]);
  const off = (other: Triple[]): number => a.reduce((sum, point, i) => sum + distance(point, other[i]) ** 2, 0);
  const reversed = curve.closed ? [b[0], ...b.slice(1).reverse()] : [...b].reverse();
  if (off(reversed) < 0.5 * off(b)) warnings.push(`${name} seems to run the other way on the target: turn it round there, if that is so.`);
}

/** Points at equal shares of a line's length; of a closed one from the given clicked point on. */
function evenly(line: PickedLine, closed: boolean, first: number): Triple[] {
  const { points, clicked } = polyline(line, closed);
  const way = closed ? [...points.slice(clicked[first]), ...points.slice(0, clicked[first] + 1)] : points;
  const step = line_length(line) / (closed ? samples : samples - 1);
  const even: Triple[] = [way[0]];
  let run = 0;
  for (let i = 1; i < way.length && even.length < samples; ++i) {
    const piece = distance(way[i - 1], way[i]);
    for (; even.length < samples && even.length * step <= run + piece; ) {
      const share = (even.length * step - run) / piece;
      even.push(way[i].map((value, axis) => way[i - 1][axis] + share * (value - way[i - 1][axis])) as Triple);
    }
    run += piece;
  }
  while (even.length < samples) even.push(way[way.length - 1]); // what rounding left over
  return even;
}
