import { distance } from "../maths/warp";
import type { Triple } from "../scene/scene";

export type Side = "a" | "b";
export const sides = ["a", "b"] as const;
export const model_of: Record<Side, string> = { a: "source", b: "target" };

/** A line on one model. */
export interface PickedLine {
  /** As they were clicked. */
  points: Triple[];
  /** The way from each point to the next, both included; of a closed line also from the last to the first. */
  pieces: Triple[][];
}

/** What belongs together on two models: the lines, or what they enclose; or what they enclose attracts nothing. */
export type Meaning = "line" | "patch" | "exclude";

export interface Kind {
  label: string;
  meaning: Meaning;
  closed: boolean;
}

/** What a line can be. */
export const kinds: Kind[] = [
  { label: "open", meaning: "line", closed: false },
  { label: "closed", meaning: "line", closed: true },
  { label: "patch", meaning: "patch", closed: true },
  { label: "excluded", meaning: "exclude", closed: true },
];

/** A curve, or the border of a patch, as it is being picked: either line may still be missing. */
export interface PickedCurve {
  name: string;
  meaning: Meaning;
  /** Always, where it borders a patch. */
  closed: boolean;
  a: PickedLine;
  b: PickedLine;
  /** Points of a and of b, by their numbers, that belong together; none of a patch. */
  fixed: [number, number][];
}

/** The way along a surface from one of its points to another; null between separate pieces. */
export type Join = (from: Triple, to: Triple) => Triple[] | null;

export function new_curve(name: string, meaning: Meaning = "line"): PickedCurve {
  return { name, meaning, closed: meaning !== "line", a: { points: [], pieces: [] }, b: { points: [], pieces: [] }, fixed: [] };
}

export function kind_of(curve: PickedCurve): Kind {
  return kinds.find((kind) => kind.meaning === curve.meaning && kind.closed === curve.closed) as Kind;
}

export function is_patch(curve: PickedCurve): boolean {
  return curve.meaning !== "line";
}

export function min_points(curve: PickedCurve): number {
  return curve.closed ? 3 : 2;
}

export function is_whole(curve: PickedCurve, side: Side): boolean {
  return curve[side].points.length >= min_points(curve);
}

/** Where it needs a line: what is excluded may be on one model alone. */
export function needed_sides(curve: PickedCurve): Side[] {
  const begun = sides.filter((side) => curve[side].points.length > 0);
  return curve.meaning === "exclude" && begun.length > 0 ? begun : [...sides];
}

export function is_complete_curve(curve: PickedCurve): boolean {
  return needed_sides(curve).every((side) => is_whole(curve, side));
}

/** A line through other points, which keeps the pieces that it can; null where no way joins two of them. */
export function rejoined(line: PickedLine, points: Triple[], closed: boolean, join: Join): PickedLine | null {
  const ends = (from: Triple, to: Triple): string => `${from.join()} ${to.join()}`;
  const known = new Map(line.pieces.map((piece) => [ends(piece[0], piece[piece.length - 1]), piece]));
  const pieces: Triple[][] = [];
  for (let i = closed && points.length > 1 ? 0 : 1; i < points.length; ++i) {
    const from = points[(i + points.length - 1) % points.length], to = points[i];
    const piece = known.get(ends(from, to)) ?? join(from, to);
    if (piece === null) return null;
    pieces.push(piece);
  }
  // The way that closes the line comes last.
  if (closed && pieces.length > 1) pieces.push(pieces.shift() as Triple[]);
  return { points, pieces };
}

/** After a point came in at `at` (by 1) or left it (by −1): the numbers of those behind it change. */
export function renumbered(fixed: [number, number][], side: Side, at: number, by: 1 | -1): [number, number][] {
  const mine = side === "a" ? 0 : 1;
  const shifted = fixed.filter((pair) => by === 1 || pair[mine] !== at).map((pair): [number, number] => [...pair]);
  for (const pair of shifted) if (pair[mine] >= at) pair[mine] += by;
  return shifted;
}

/** All points of a line in their order, without the repeats where pieces meet, and which of them were clicked. */
export function polyline(line: PickedLine, closed: boolean): { points: Triple[]; clicked: number[] } {
  const points: Triple[] = line.points.slice(0, 1);
  const clicked = points.map(() => 0);
  for (const piece of line.pieces) {
    points.push(...piece.slice(1));
    clicked.push(points.length - 1);
  }
  if (closed && points.length > 1) {
    points.pop();
    clicked.pop();
  }
  return { points, clicked };
}

export function line_length(line: PickedLine): number {
  return line.pieces.reduce((sum, piece) => sum + piece.slice(1).reduce((length, point, i) => length + distance(piece[i], point), 0), 0);
}

export function turned_round(line: PickedLine, closed: boolean): PickedLine {
  const pieces = line.pieces.map((piece) => [...piece].reverse()).reverse();
  // A closed line still begins where it did.
  if (closed) return { points: [...line.points.slice(0, 1), ...line.points.slice(1).reverse()], pieces };
  return { points: [...line.points].reverse(), pieces };
}

/** The same curve with its line on the target run the other way. */
export function with_target_turned(curve: PickedCurve): PickedCurve {
  const count = curve.b.points.length;
  const number = (i: number): number => (curve.closed ? (count - i) % count : count - 1 - i);
  return { ...curve, b: turned_round(curve.b, curve.closed), fixed: curve.fixed.map(([i, j]) => [i, number(j)]) };
}

function rolled<T>(list: T[], by: number): T[] {
  return [...list.slice(by), ...list.slice(0, by)];
}

/** A closed line that begins at another of its points. */
function begun_at(line: PickedLine, point: number): PickedLine {
  return { points: rolled(line.points, point), pieces: rolled(line.pieces, point) };
}

const is_rising = (numbers: number[]): boolean => numbers.every((value, i) => i === 0 || value > numbers[i - 1]);

/** The same curve, its fixed points rising on both sides as files have them; null where they come in different orders. */
export function in_order(curve: PickedCurve): PickedCurve | null {
  const sorted = { ...curve, fixed: [...curve.fixed].sort((p, q) => p[0] - q[0]) };
  if (sorted.fixed.length === 0) return sorted;
  const candidates = [sorted, with_target_turned(sorted)].map((each) => {
    if (!each.closed) return each;
    const [i, j] = each.fixed[0], a = each.a.points.length, b = each.b.points.length;
    const fixed = each.fixed.map(([k, l]): [number, number] => [(k - i + a) % a, (l - j + b) % b]);
    return { ...each, a: begun_at(each.a, i), b: begun_at(each.b, j), fixed };
  });
  return candidates.find((each) => is_rising(each.fixed.map(([i]) => i)) && is_rising(each.fixed.map(([, j]) => j))) ?? null;
}

const handles = 8; // points to take hold of along a line that comes from a file: some three a quarter of a waist

/** A line from a file: its points as they are, some of them (ends, fixed ones, each eighth of the length) to be moved. */
export function line_of(points: Triple[], closed: boolean, fixed: number[]): { line: PickedLine; number_of: Map<number, number> } {
  const way = closed ? [...points, points[0]] : points;
  const lengths = [0];
  for (let i = 1; i < way.length; ++i) lengths.push(lengths[i - 1] + distance(way[i - 1], way[i]));
  const chosen = new Set<number>([0, ...fixed, ...(closed ? [] : [points.length - 1])]);
  for (let k = 1; k < handles; ++k) {
    const at = lengths.findIndex((length) => length >= (k / handles) * lengths[lengths.length - 1]);
    if (at < points.length) chosen.add(at);
  }
  const numbers = [...chosen].sort((i, j) => i - j);
  const ends = closed ? [...numbers.slice(1), points.length] : numbers.slice(1);
  return {
    line: { points: numbers.map((i) => points[i]), pieces: ends.map((end, k) => way.slice(numbers[k], end + 1)) },
    number_of: new Map(numbers.map((i, k) => [i, k])),
  };
}
