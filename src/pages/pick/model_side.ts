import { Box3, Plane, Vector3 } from "three";

import { element } from "../controls/elements";
import type { Plane as MirrorPlane } from "../maths/mirror";
import { at_rest } from "../maths/motion";
import type { Triple } from "../scene/scene";
import { add_controls } from "../stage/controls";
import { type Fill, Fills } from "../stage/fills";
import { type Line, Lines } from "../stage/lines";
import { type MarkerSize, Markers } from "../stage/markers";
import { MirrorSheet } from "../stage/mirror_sheet";
import { scene_of, Stage } from "../stage/stage";
import type { Surface } from "../stage/surface";
import type { Model } from "../view/models";

export type DragMode = "surface" | "normal" | "view";

export interface SideListener {
  /** reach: what a finger or a mouse means by "there", mesh units. */
  clicked(point: Triple, reach: number): void;
  /** Beside the model, in pixels of the canvas. */
  missed?(x: number, y: number): void;
  chosen(number: number): void;
  drag_started(number: number): void;
  dragged(number: number, point: Triple): void;
  drag_ended(): void;
  turned(): void;
  key(event: KeyboardEvent): void;
}

export interface SideMarker {
  /** For the listener; null for a point that is only to be seen. */
  number: number | null;
  point: Triple;
  colour: string;
  size: MarkerSize;
}

const grab_radius = 9; // pixels
const min_lift = 0.004; // of the size: nearer to the surface, lines and faces contend for pixels
const marker_lift = 0.02; // discs are wide, and a surface that leans would cut them

type HeldMarker = SideMarker & { number: number };
const is_held = (marker: SideMarker): marker is HeldMarker => marker.number !== null;

/** One model with its points: its own stage, so that it can be turned alone. */
export class ModelSide {
  readonly box: HTMLElement;
  readonly stage: Stage;
  readonly surface: Surface;
  readonly size: number;
  readonly centre: Vector3;
  drag_mode: DragMode = "surface";
  private readonly markers: Markers;
  private readonly hint: Markers;
  private readonly lines: Lines;
  private readonly fills: Fills;
  private readonly sheet: MirrorSheet;
  private readonly task = element("span", { class: "task" });
  private shown_markers: SideMarker[] = [];
  private readonly ghost: Surface[] = [];

  constructor(readonly model: Model, label: string, private readonly listener: SideListener) {
    const canvas = element("canvas", { class: "drawing", tabIndex: 0, role: "application", "aria-label": `${label}. Click to set a point; drag a point to move it; drag elsewhere or arrow keys turn, Home resets.` });
    this.box = element("div", { class: "pick-side" }, canvas, element("div", { class: "pane-label" }, label, this.task));
    this.stage = new Stage(canvas);
    this.surface = model.surface();
    const box = new Box3();
    const places = model.knots[0];
    for (let i = 0; i < places.length; i += 3) box.expandByPoint(new Vector3().fromArray(places, i));
    this.size = box.min.distanceTo(box.max);
    this.centre = box.getCenter(new Vector3());
    const lift = min_lift * this.size;
    this.markers = new Markers(marker_lift * this.size, 12);
    this.hint = new Markers(marker_lift * this.size, 16);
    this.lines = new Lines(lift);
    this.fills = new Fills(places, model.faces);
    this.sheet = new MirrorSheet(box, lift);
    const scene = scene_of([this.surface.object, this.fills.object, this.sheet.object, this.lines.object, this.markers.object, this.hint.object]);
    this.stage.panes = [{ label, scene, pose: at_rest, left: 0, top: 0, width: 1, height: 1 }];
    this.stage.frame(box.min, box.max);
    this.stage.on_draw(() => this.listener.turned());
    add_controls(this.stage, {
      click: (x, y) => this.click(x, y),
      hover: () => undefined,
      leave: () => undefined,
      grab: (x, y) => this.grab(x, y),
    });
    canvas.addEventListener("keydown", (event) => this.listener.key(event));
  }

  /** What a click here does, for the label. */
  show_task(task: string): void {
    this.task.textContent = task === "" ? "" : ` · ${task}`;
  }

  show(markers: SideMarker[], lines: Line[], fills: Fill[]): void {
    this.shown_markers = markers;
    this.markers.set(markers.map((marker) => new Vector3(...marker.point)), markers.map((marker) => marker.colour), markers.map((marker) => marker.size));
    this.lines.set(lines);
    this.fills.set(fills);
    this.stage.draw_soon();
  }

  show_plane(plane: MirrorPlane | null): void {
    this.sheet.show(plane, this.surface.places(), this.surface.faces);
    this.stage.draw_soon();
  }

  show_hint(point: Triple | null): void {
    this.hint.set(point === null ? [] : [new Vector3(...point)], point === null ? [] : ["#e0b000"]);
    this.stage.draw_soon();
  }

  /** A second surface over the model, or none. */
  show_ghost(surface: Surface | null): void {
    for (const old of this.ghost.splice(0)) {
      old.object.removeFromParent();
      old.dispose();
    }
    if (surface !== null) {
      surface.set_opacity(0.45);
      this.stage.panes[0].scene.add(surface.object);
      this.ghost.push(surface);
    }
    this.stage.draw_soon();
  }

  private click(x: number, y: number): void {
    const marker = this.marker_at(x, y);
    if (marker !== null) return this.listener.chosen(marker.number);
    const point = this.surface_point(x, y);
    if (point !== null) this.listener.clicked(point, grab_radius * this.stage.pixel_length(this.stage.panes[0]));
    else this.listener.missed?.(x, y);
  }

  private surface_point(x: number, y: number): Triple | null {
    const at = this.stage.ray_at(x, y);
    return at === null ? null : ((this.surface.first_hit(at.ray)?.point.toArray() as Triple | undefined) ?? null);
  }

  private marker_at(x: number, y: number): HeldMarker | null {
    let best: HeldMarker | null = null, least = grab_radius;
    for (const marker of this.shown_markers) {
      if (!is_held(marker)) continue;
      const pixel = this.stage.pixel_of(this.stage.panes[0], new Vector3(...marker.point));
      const away = Math.hypot(pixel.x - x, pixel.y - y);
      if (away < least && this.is_seen(marker, pixel.x, pixel.y)) [best, least] = [marker, away];
    }
    return best;
  }

  /** Whether the model does not hide it. */
  private is_seen(marker: HeldMarker, x: number, y: number): boolean {
    const at = this.stage.ray_at(x, y);
    if (at === null) return false;
    const hit = this.surface.first_hit(at.ray);
    return hit === null || hit.distance > at.ray.origin.distanceTo(new Vector3(...marker.point)) - 0.02 * this.size;
  }

  private grab(x: number, y: number): { move(x: number, y: number): void; release(): void } | null {
    const marker = this.marker_at(x, y);
    if (marker === null) return null;
    const start = new Vector3(...marker.point);
    const normal = this.normal_near(marker.point);
    let has_moved = false;
    const move = (now_x: number, now_y: number): void => {
      const point = this.dragged_point(start, normal, now_x, now_y);
      if (point === null || (!has_moved && Math.hypot(now_x - x, now_y - y) < 4)) return;
      if (!has_moved) this.listener.drag_started(marker.number);
      has_moved = true;
      this.listener.dragged(marker.number, point);
    };
    return { move, release: () => has_moved && this.listener.drag_ended() };
  }

  private dragged_point(start: Vector3, normal: Vector3, x: number, y: number): Triple | null {
    if (this.drag_mode === "surface") return this.surface_point(x, y);
    const at = this.stage.ray_at(x, y);
    if (at === null) return null;
    if (this.drag_mode === "view") {
      const plane = new Plane().setFromNormalAndCoplanarPoint(at.ray.direction, start);
      return (at.ray.intersectPlane(plane, new Vector3())?.toArray() as Triple | undefined) ?? null;
    }
    // The point of the normal's line that is nearest to the ray.
    const across = new Vector3().crossVectors(normal, at.ray.direction);
    const squared = across.lengthSq();
    if (squared < 1e-4) return null; // looking along the normal: how far cannot be told
    const along = new Vector3().subVectors(at.ray.origin, start).cross(at.ray.direction).dot(across) / squared;
    return start.clone().addScaledVector(normal, along).toArray() as Triple;
  }

  private normal_near(point: Triple): Vector3 {
    const places = this.surface.places();
    let best = 0, least = Infinity;
    for (let i = 0; i < places.length; i += 3) {
      const d = (places[i] - point[0]) ** 2 + (places[i + 1] - point[1]) ** 2 + (places[i + 2] - point[2]) ** 2;
      if (d < least) [best, least] = [i / 3, d];
    }
    return this.surface.normal_at(best);
  }
}
