import type { EnclosedFaces } from "../maths/enclosed_faces";
import { between, dot, minus } from "../maths/surface_graph";
import { distance } from "../maths/warp";
import type { Triple } from "../scene/scene";
import type { Fill } from "../stage/fills";
import type { Line } from "../stage/lines";
import { is_complete_curve, in_order, is_patch, is_whole, type Kind, kind_of, type Meaning, new_curve, type PickedCurve, type PickedLine, rejoined, renumbered, type Side, with_target_turned } from "./curves";
import type { History } from "./history";
import type { SideMarker } from "./model_side";
import type { PatchedModel } from "./patch_checks";
import type { Tracer } from "./tracer";

const curve_colours = ["#be185d", "#0f766e", "#7e22ce", "#c2410c", "#1d6fd1", "#4d7c0f", "#a16207", "#334155"];
const fixed_colour = "#111827";
const fill_opacity = 0.34, chosen_fill_opacity = 0.5;
export const colour_of = (index: number): string => curve_colours[index % curve_colours.length];
export const separate_pieces = "No line along the surface joins these points: they lie on separate pieces of the model.";

/** What clicks and keys do to curves and borders of patches, and how these are drawn. */
export class CurveEditor {
  chosen = -1;
  /** The chosen point of the chosen curve on each model, −1 without. */
  point: Record<Side, number> = { a: -1, b: -1 };
  /** The last point was just drawn: a click on the first one closes the curve. */
  private is_drawing: Side | null = null;
  /** The line of the chosen curve that is being dragged, as it was before: what it encloses is found again at the end. */
  private held: { side: Side; line: PickedLine } | null = null;

  constructor(private readonly history: History, readonly tracers: Record<Side, Tracer>, private readonly say: (text: string) => void) {}

  get curve(): PickedCurve | null {
    return this.history.curves[this.chosen] ?? null;
  }

  get is_dragging(): boolean {
    return this.held !== null;
  }

  choose(index: number): void {
    this.chosen = index;
    this.point = { a: -1, b: -1 };
    this.is_drawing = null;
    this.drag_ended();
  }

  /** After a step back or forth: what is no longer there is not chosen. */
  settle(): void {
    for (const side of ["a", "b"] as const) if (this.point[side] >= (this.curve?.[side].points.length ?? 0)) this.point[side] = -1;
  }

  begin(meaning: Meaning = "line"): void {
    const taken = new Set([...this.history.curves, ...this.history.work.patches].map((other) => other.name));
    const stem = meaning === "line" ? "c" : "patch";
    let number = 1;
    while (taken.has(`${stem}${number}`)) ++number;
    this.choose(this.history.curves.length);
    this.history.change(({ curves }) => curves.push(new_curve(`${stem}${number}`, meaning)));
  }

  /** A click on a model: on the chosen curve's line, within reach, a point between; else one behind the last. */
  clicked(side: Side, place: Triple, reach: number): void {
    const curve = this.curve ?? new_curve("");
    const piece = nearest_piece(curve[side].pieces, place, reach);
    const at = piece >= 0 ? piece + 1 : curve[side].points.length;
    const line = rejoined(curve[side], [...curve[side].points.slice(0, at), place, ...curve[side].points.slice(at)], curve.closed, this.join(side));
    if (line === null) return this.say(separate_pieces);
    this.say("");
    const is_first = this.curve === null;
    if (is_first) this.begin();
    this.point[side] = at;
    this.is_drawing = piece >= 0 ? null : side;
    // To begin a curve and to lay its first point is one step of undoing.
    this.change((now) => ({ ...now, [side]: line, fixed: renumbered(now.fixed, side, at, 1) }), is_first);
  }

  /** A click on a point of the chosen curve. */
  point_clicked(side: Side, number: number): void {
    const curve = this.curve;
    const closes = this.is_drawing === side && number === 0 && curve !== null && !curve.closed && curve[side].points.length >= 3;
    this.point[side] = number;
    this.is_drawing = null;
    if (closes) this.set_kind({ ...kind_of(curve), closed: true });
  }

  /** A patch has no points that are fixed together. */
  set_kind({ meaning, closed }: Kind, index = this.chosen): void {
    const curve = this.history.curves[index];
    if (curve === undefined) return;
    const a = rejoined(curve.a, curve.a.points, closed, this.join("a")), b = rejoined(curve.b, curve.b.points, closed, this.join("b"));
    if (a === null || b === null) return this.say(separate_pieces);
    this.say("");
    this.history.change(({ curves }) => (curves[index] = { ...curve, meaning, closed, a, b, fixed: meaning === "line" ? curve.fixed : [] }));
  }

  drag_started(side: Side, number: number): void {
    this.point[side] = number;
    this.is_drawing = null;
    this.hold(side, number);
    this.history.change(() => undefined);
  }

  drag_ended(): void {
    if (this.held !== null) this.tracers[this.held.side].hold([]);
    this.held = null;
  }

  dragged(side: Side, number: number, place: Triple): void {
    const curve = this.curve;
    if (curve === null) return;
    const line = rejoined(curve[side], curve[side].points.map((point, i) => (i === number ? place : point)), curve.closed, this.join(side));
    if (line !== null) this.change((now) => ({ ...now, [side]: line }), true);
  }

  remove_point(side: Side): void {
    const curve = this.curve, number = this.point[side];
    if (curve === null || curve[side].points[number] === undefined) return;
    const line = rejoined(curve[side], curve[side].points.filter((_, i) => i !== number), curve.closed, this.join(side));
    if (line === null) return this.say(separate_pieces);
    this.point[side] = -1;
    this.is_drawing = null;
    this.change((now) => ({ ...now, [side]: line, fixed: renumbered(now.fixed, side, number, -1) }));
  }

  remove(index: number): void {
    this.choose(-1);
    this.history.change(({ curves }) => curves.splice(index, 1));
  }

  turn_target(): void {
    this.point.b = -1;
    this.change(with_target_turned);
  }

  /** Whether the chosen points belong together already. */
  get is_fixed(): boolean {
    return this.curve?.fixed.some(([i, j]) => i === this.point.a && j === this.point.b) ?? false;
  }

  /** Joins the chosen points, or parts them. */
  fix(): void {
    const curve = this.curve, { a, b } = this.point;
    if (curve === null || is_patch(curve) || a < 0 || b < 0) return;
    const others = curve.fixed.filter(([i, j]) => i !== a && j !== b);
    const fixed: [number, number][] = this.is_fixed ? others : [...others, [a, b]];
    if (in_order({ ...curve, fixed }) === null) return this.say("Fixed points must come in one order on both models; these would not.");
    this.say("");
    this.change((now) => ({ ...now, fixed }));
  }

  /** The chosen curve on the other side of both models. */
  mirror(images: Record<Side, (point: Triple) => Triple>, name: (old: string) => string): boolean {
    const curve = this.curve;
    if (curve === null || !is_complete_curve(curve)) return false;
    const line = (side: Side) => rejoined({ points: [], pieces: [] }, curve[side].points.map((point) => this.tracers[side].nearest(images[side](point))), curve.closed, this.join(side));
    const a = line("a"), b = line("b");
    if (a === null || b === null) return false;
    this.choose(this.history.curves.length);
    this.history.change(({ curves }) => curves.push({ ...structuredClone(curve), name: name(curve.name), a, b }));
    return true;
  }

  // ---- what borders enclose

  /** Null for a curve, and without a whole border there. */
  enclosed(curve: PickedCurve, side: Side): EnclosedFaces | null {
    if (!is_patch(curve) || !is_whole(curve, side)) return null;
    const held = this.held?.side === side && curve === this.curve ? this.held.line : null;
    return this.tracers[side].enclosed(held ?? curve[side]);
  }

  patched(side: Side): PatchedModel {
    const tracer = this.tracers[side];
    return { get graph() { return tracer.graph; }, enclosed: (curve) => this.enclosed(curve, side) };
  }

  // ---- what is drawn

  fills(side: Side): Fill[] {
    return this.history.curves.flatMap((curve, i) => {
      const faces = this.enclosed(curve, side)?.inside;
      return faces === undefined ? [] : [{ faces, colour: colour_of(i), opacity: i === this.chosen ? chosen_fill_opacity : fill_opacity, is_hatched: curve.meaning === "exclude" }];
    });
  }

  lines(side: Side): Line[] {
    return this.history.curves.flatMap((curve, i) =>
      curve[side].pieces.map((points) => ({ points, colour: colour_of(i), width: i === this.chosen ? 4 : 2.5 })),
    );
  }

  markers(side: Side): SideMarker[] {
    const curve = this.curve;
    if (curve === null) return [];
    const fixed = new Set(curve.fixed.map((pair) => pair[side === "a" ? 0 : 1]));
    return curve[side].points.map((point, number) => ({
      number, point, colour: fixed.has(number) ? fixed_colour : colour_of(this.chosen), size: number === this.point[side] ? "large" : "plain",
    }));
  }

  private hold(side: Side, number: number): void {
    if (this.curve === null) return;
    const line = this.curve[side], count = line.points.length;
    this.held = { side, line };
    const neighbours = this.curve.closed ? [(number + count - 1) % count, (number + 1) % count] : [number - 1, number + 1];
    this.tracers[side].hold([...new Set(neighbours)].filter((i) => i !== number && i >= 0 && i < count).map((i) => line.points[i]));
  }

  private join(side: Side): (from: Triple, to: Triple) => Triple[] | null {
    return (from, to) => this.tracers[side].join(from, to);
  }

  private change(edit: (curve: PickedCurve) => PickedCurve, is_same_step = false): void {
    const index = this.chosen;
    const on_work = ({ curves }: { curves: PickedCurve[] }): void => {
      if (curves[index] !== undefined) curves[index] = edit(curves[index]);
    };
    if (is_same_step) this.history.change_again(on_work);
    else this.history.change(on_work);
  }
}

/** The piece nearest to a place and not farther than `reach`, −1 without. */
function nearest_piece(pieces: Triple[][], place: Triple, reach: number): number {
  let best = -1, least = reach;
  pieces.forEach((piece, number) => {
    for (let i = 1; i < piece.length; ++i) {
      const way = minus(piece[i], piece[i - 1]), squared = dot(way, way);
      const share = squared > 0 ? Math.min(1, Math.max(0, dot(minus(place, piece[i - 1]), way) / squared)) : 0;
      const away = distance(place, between(piece[i - 1], piece[i], share));
      if (away < least) [best, least] = [number, away];
    }
  });
  return best;
}
