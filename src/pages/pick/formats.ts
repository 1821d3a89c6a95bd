import type { Triple } from "../scene/scene";
import { in_order, is_complete_curve, is_patch, line_of, model_of, needed_sides, new_curve, polyline, type PickedCurve, type PickedLine, type Side, sides } from "./curves";
import { is_complete, type PickedPair, type Work } from "./history";

function triple(value: unknown, where: string): Triple {
  if (!Array.isArray(value) || value.length !== 3 || !value.every((x) => typeof x === "number" && Number.isFinite(x)))
    throw new Error(`${where} is not three numbers`);
  return value as Triple;
}

function list(document: object, key: string): Record<string, unknown>[] {
  const value = (document as Record<string, unknown>)[key] ?? [];
  if (!Array.isArray(value)) throw new Error(`"${key}" is not a list`);
  const strange = value.findIndex((each) => typeof each !== "object" || each === null);
  if (strange >= 0) throw new Error(`"${key}": entry ${strange} is not an object`);
  return value as Record<string, unknown>[];
}

export function parse_json(document: { pairs?: unknown; curves?: unknown; patches?: unknown }): Work {
  if (document.pairs === undefined && document.curves === undefined && document.patches === undefined) throw new Error('the key "pairs" is missing');
  const pairs = list(document, "pairs").map((pair, i) => ({
    name: String(pair.name ?? ""),
    a: triple(pair.a, `"a" of pair ${i}`),
    b: triple(pair.b, `"b" of pair ${i}`),
    sigma: typeof pair.sigma === "number" ? pair.sigma : null,
    weight: typeof pair.weight === "number" ? pair.weight : null,
  }));
  const { borders, kept } = parse_patches(list(document, "patches"));
  return { pairs, curves: [...list(document, "curves").map(parse_curve), ...borders], patches: kept };
}

/** What this page, or an older one, kept in the browser: first there were pairs alone, then curves without a meaning and all patches unseen. */
export function parse_kept(text: string): Work {
  const parsed = JSON.parse(text) as { pairs: PickedPair[]; curves: PickedCurve[]; patches?: Record<string, unknown>[] } | PickedPair[];
  if (Array.isArray(parsed)) return { pairs: parsed, curves: [], patches: [] };
  const { borders, kept } = unseen_patches(parsed.patches ?? []);
  return { pairs: parsed.pairs, curves: [...parsed.curves.map((curve) => ({ ...curve, meaning: curve.meaning ?? "line" })), ...borders], patches: kept };
}

/** What an older page kept unseen may be wrong; then it is kept as it is, and the rest of the work with it. */
function unseen_patches(patches: Record<string, unknown>[]): { borders: PickedCurve[]; kept: Record<string, unknown>[] } {
  try {
    return parse_patches(patches);
  } catch {
    return { borders: [], kept: patches };
  }
}

function parse_curve(curve: Record<string, unknown>, number: number): PickedCurve {
  const name = String(curve.name ?? "");
  const where = `curve ${number}${name === "" ? "" : ` (“${name}”)`}`;
  const points = (key: "a" | "b"): Triple[] => {
    const model = model_of[key], value = curve[key];
    if (value === undefined) throw new Error(`${where} has no line on the ${model}: the key "${key}" is missing`);
    if (!Array.isArray(value) || value.length < 2)
      throw new Error(`${where}: its line on the ${model}, "${key}", has ${Array.isArray(value) ? value.length : "no list of"} points; two at least make a line`);
    const all = value.map((point, i) => triple(point, `${where}: point ${i} of "${key}"`));
    if (all.every((point) => point.join() === all[0].join())) throw new Error(`${where}: "${key}" has all its points at one place`);
    return all;
  };
  const a = points("a"), b = points("b");
  if (curve.closed !== undefined && typeof curve.closed !== "boolean") throw new Error(`${where}: "closed" is neither true nor false`);
  const closed = curve.closed === true, fixed = parse_fixed(curve.fixed ?? [], [a.length, b.length], where);
  const on_a = line_of(a, closed, fixed.map(([i]) => i)), on_b = line_of(b, closed, fixed.map(([, j]) => j));
  const numbers = fixed.map(([i, j]): [number, number] => [on_a.number_of.get(i) as number, on_b.number_of.get(j) as number]);
  return { name, meaning: "line", closed, a: on_a.line, b: on_b.line, fixed: numbers };
}

/** Patches by their borders are lines to be edited; those by numbers of faces are kept as they are. */
function parse_patches(patches: Record<string, unknown>[]): { borders: PickedCurve[]; kept: Record<string, unknown>[] } {
  const has_faces = (value: unknown): boolean => typeof value === "object" && value !== null && "faces" in value;
  const is_kept = patches.map((patch) => sides.some((side) => has_faces(patch[side])));
  return {
    borders: patches.flatMap((patch, i) => (is_kept[i] ? [] : [parse_patch(patch, i)])),
    kept: patches.filter((_, i) => is_kept[i]),
  };
}

function parse_patch(patch: Record<string, unknown>, number: number): PickedCurve {
  const name = String(patch.name ?? "");
  const where = `patch ${number}${name === "" ? "" : ` (“${name}”)`}`;
  if (patch.exclude !== undefined && typeof patch.exclude !== "boolean") throw new Error(`${where}: "exclude" is neither true nor false`);
  const read = { ...new_curve(name, patch.exclude === true ? "exclude" : "patch"), a: parse_border(patch, "a", where), b: parse_border(patch, "b", where) };
  const missing = needed_sides(read).find((side) => read[side].points.length === 0);
  if (missing !== undefined) throw new Error(`${where}: "${missing}" is missing; only a patch with "exclude": true may lie on one model alone`);
  return read;
}

/** Empty where the patch has none; a last point at the place of the first says once more that it is closed. */
function parse_border(patch: Record<string, unknown>, side: Side, where: string): PickedLine {
  const value = patch[side];
  if (value === undefined) return { points: [], pieces: [] };
  const border = typeof value === "object" && value !== null ? (value as Record<string, unknown>).border : undefined;
  if (!Array.isArray(border)) throw new Error(`${where}: "${side}" has neither "border" nor "faces"`);
  const points = border.map((point, i) => triple(point, `${where}: point ${i} of the border of "${side}"`));
  if (points.length > 1 && points[0].join() === points[points.length - 1].join()) points.pop();
  if (points.length < 3) throw new Error(`${where}: the border of "${side}" has ${points.length} points; a line around a patch has three at least`);
  return line_of(points, true, []).line;
}

function parse_fixed(value: unknown, counts: [number, number], where: string): [number, number][] {
  const is_number = (x: unknown, side: 0 | 1): x is number => Number.isInteger(x) && (x as number) >= 0 && (x as number) < counts[side];
  const is_pair = (x: unknown): x is [number, number] => Array.isArray(x) && x.length === 2 && is_number(x[0], 0) && is_number(x[1], 1);
  const rises = (pairs: [number, number][]): boolean => pairs.every(([i, j], k) => k === 0 || (i > pairs[k - 1][0] && j > pairs[k - 1][1]));
  if (!Array.isArray(value) || !value.every(is_pair) || !rises(value))
    throw new Error(`${where}: "fixed" is not a list of [i, j], numbers from 0 of points of "a" and of "b" that rise on both sides`);
  return value;
}

function curve_json(curve: PickedCurve): object {
  const ordered = in_order(curve) ?? { ...curve, fixed: [] }; // the page has said so (curve_checks.ts)
  const a = polyline(ordered.a, ordered.closed), b = polyline(ordered.b, ordered.closed);
  return {
    ...(curve.name === "" ? {} : { name: curve.name }),
    a: a.points,
    b: b.points,
    ...(curve.closed ? { closed: true } : {}),
    ...(ordered.fixed.length === 0 ? {} : { fixed: ordered.fixed.map(([i, j]) => [a.clicked[i], b.clicked[j]]) }),
  };
}

function patch_json(patch: PickedCurve): object {
  const border = (side: Side): object => ({ [side]: { border: polyline(patch[side], true).points } });
  return { ...(patch.name === "" ? {} : { name: patch.name }), ...Object.assign({}, ...needed_sides(patch).map(border)), ...(patch.meaning === "exclude" ? { exclude: true } : {}) };
}

/** What `bespoke fit --anchors` reads; pairs with one end and incomplete lines are left out. */
export function anchors_json({ pairs, curves, patches }: Work, unit: string): string {
  const written = pairs.filter(is_complete).map((pair) => ({
    ...(pair.name === "" ? {} : { name: pair.name }),
    a: pair.a,
    b: pair.b,
    ...(pair.weight === null ? {} : { weight: pair.weight }),
    ...(pair.sigma === null || pair.weight !== null ? {} : { sigma: pair.sigma }),
  }));
  const lines = (entries: object[]): string => `[\n${entries.map((entry) => `  ${JSON.stringify(entry)}`).join(",\n")}\n]`;
  const complete = curves.filter(is_complete_curve);
  const more = (key: string, entries: object[]): string => (entries.length === 0 ? "" : `, "${key}": ${lines(entries)}`);
  const lines_json = more("curves", complete.filter((curve) => !is_patch(curve)).map(curve_json));
  const patches_json = more("patches", [...complete.filter(is_patch).map(patch_json), ...patches]);
  return `{${unit === "" ? "" : `"units": ${JSON.stringify(unit)}, `}"pairs": ${lines(written)}${lines_json}${patches_json}}\n`;
}
