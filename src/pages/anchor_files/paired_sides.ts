import { line_of, type PickedCurve } from "../pick/curves";
import type { CompletePair } from "../pick/history";
import type { FileSide } from "./side";

interface Named {
  name: string;
}

/** Whether both sides have the same names in perhaps another order, each once. */
export function are_named_alike(a: Named[], b: Named[]): boolean {
  const first = new Set(a.map((each) => each.name)), second = new Set(b.map((each) => each.name));
  return first.size === a.length && second.size === b.length && !first.has("") && first.size === second.size && [...first].every((name) => second.has(name));
}

/** What of b belongs to a[0], a[1] and so on. */
function counterparts<T extends Named>(a: T[], b: T[], what: string, files: [string, string]): T[] {
  if (a.length !== b.length) throw new Error(`${files[0]} has ${a.length} ${what}, ${files[1]} has ${b.length}`);
  return are_named_alike(a, b) ? a.map((each) => b.find((other) => other.name === each.name) as T) : b;
}

/** Points, and lines likewise, of one name belong together where all names are given and the same on both sides, else the first and the first and so on. */
export function paired(a: FileSide, b: FileSide, files: [string, string]): { pairs: CompletePair[]; curves: PickedCurve[] } {
  const points = counterparts(a.points, b.points, "points", files), lines = counterparts(a.lines, b.lines, "curves", files);
  // Where the names of the sides differ the first one's stand, but no name twice.
  const pairs = a.points.map(({ name, x }, i) => {
    const is_free = a.points.findIndex((other) => other.name === name) === i;
    return { name: is_free ? name : "", a: x, b: points[i].x, sigma: null, weight: null };
  });
  const curves = a.lines.map(({ name, points: on_a, closed }, i): PickedCurve => {
    if (closed !== lines[i].closed) throw new Error(`curve ${i} ("${name}") is closed in ${files[closed ? 0 : 1]} and open in ${files[closed ? 1 : 0]}`);
    return { name, meaning: "line", closed, a: line_of(on_a, closed, []).line, b: line_of(lines[i].points, closed, []).line, fixed: [] };
  });
  return { pairs, curves };
}
