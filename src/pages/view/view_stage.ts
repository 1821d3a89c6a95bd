import { Box3, Matrix3, Ray, Scene, Vector3, Vector4 } from "three";

import { at_rest, inverse_pose, Motion, type Place, type Pose } from "../maths/motion";
import { unpacked_points } from "../scene/decode";
import type { ViewRecord } from "../scene/scene";
import { Markers } from "../stage/markers";
import { type Pane, scene_of, Stage } from "../stage/stage";
import { type Hit, Surface } from "../stage/surface";
import { Model } from "./models";
import {
  box_lines, carried_slice, grid_faces, grid_line_indices, line_object, set_pose, slice_points, SpaceSamples,
} from "./slices";
import type { ViewState } from "./view_state";

const level_colours = ["#30678d", "#2a9d8f", "#8ab17d", "#e9c46a", "#f4a261", "#c8553d", "#8d3b72", "#5b4b8a"];
const anchor_colour = "#1d6fd1", suspicious_colour = "#d1491d";
const highlight_colour = "#1d6fd1";
const marker_lift = 0.005; // of the diagonal: in front of the surface, which would else cut them where it leans
const start: Place = { knot: 0, fraction: 0 };

/** A model in a pane. */
export interface Shown {
  model: Model;
  index: number;
  surface: Surface;
  /** Moves with t; else it stays as it was designed, or is the target. */
  moves: boolean;
}

export interface PaneContent {
  pane: Pane;
  shown: Shown[];
  /** What belongs to the pane as a whole: "source" lies at time 0, "target" at t. */
  side: "source" | "target" | "both";
  markers: Markers;
  /** Slices and boxes, made anew at every change. */
  extras: Scene;
}

export interface Found {
  content: PaneContent;
  shown: Shown;
  hit: Hit;
}

/** The models in their panes, moved, coloured and cut as the state says. */
export class ViewStage {
  readonly models: Model[];
  readonly motion: Motion;
  readonly samples: SpaceSamples;
  contents: PaneContent[] = [];
  private readonly highlighted: { surface: Surface; shown: Shown }[] = [];
  private highlighted_faces: number[] = [];

  constructor(readonly stage: Stage, readonly record: ViewRecord, readonly bytes: Uint8Array, readonly state: ViewState) {
    this.models = record.meshes.map((mesh) => new Model(mesh, bytes));
    this.motion = new Motion(record.motion);
    this.samples = new SpaceSamples(record.lattice, bytes);
    this.lay_out();
  }

  /** Panes anew: after another layout, or another way to show the rigid part. */
  lay_out(): void {
    this.highlighted.splice(0).forEach(({ surface }) => surface.dispose());
    for (const content of this.contents) for (const shown of content.shown) shown.surface.dispose();
    const narrow = this.stage.canvas.clientWidth < 560;
    const whole = { left: 0, width: 1, top: 0, height: 1 };
    const first = narrow ? { ...whole, height: 0.5 } : { ...whole, width: 0.5 };
    const second = narrow ? { ...whole, top: 0.5, height: 0.5 } : { ...whole, left: 0.5, width: 0.5 };
    const linked = this.state.rigid ? this.motion.pose(1) : at_rest;
    this.contents =
      this.state.layout === "side"
        ? [this.content("source", "Source, as designed", first, at_rest), this.content("target", "Target, carried", second, linked)]
        : [this.content("both", "Source carried, and target", whole, at_rest)];
    this.stage.panes = this.contents.map((content) => content.pane);
    this.update();
    this.frame();
  }

  private content(side: PaneContent["side"], label: string, place: object, pose: Pose): PaneContent {
    const shown: Shown[] = [];
    this.models.forEach((model, index) => {
      const role = model.record.role;
      if (side === "source" ? role === "target" : side === "target" && role === "source") return;
      shown.push({ model, index, surface: model.surface(), moves: side !== "source" && role !== "target" });
    });
    const markers = new Markers(marker_lift * this.record.diagonal, 7);
    const extras = new Scene();
    const scene = scene_of([...shown.map((each) => each.surface.object), extras, markers.object]);
    return { pane: { label, scene, pose, ...place } as Pane, shown, side, markers, extras };
  }

  frame(): void {
    const box = new Box3();
    const back = inverse_pose(this.motion.pose(1));
    const in_world = this.state.layout === "over" && this.state.rigid;
    for (const model of this.models) {
      const is_target = model.record.role === "target";
      for (const places of model.knots)
        for (let i = 0; i < places.length; i += 3 * Math.ceil(places.length / 60000)) {
          const point = new Vector3().fromArray(places, i);
          if (is_target && !in_world) point.applyMatrix3(back.turn).add(back.shift);
          box.expandByPoint(point);
        }
    }
    this.stage.frame(box.min, box.max);
  }

  update(): void {
    for (const content of this.contents) {
      for (const shown of content.shown) this.update_shown(content, shown);
      this.update_extras(content);
      this.update_markers(content);
    }
    this.move_highlighted();
    this.stage.draw_soon();
  }

  /** How what moves lies at t, and where what stands at the target does. */
  private moving_pose(): Pose {
    return this.state.rigid ? this.motion.pose(this.state.t) : at_rest;
  }
  private standing_pose(): Pose {
    return this.state.rigid ? at_rest : inverse_pose(this.motion.pose(1));
  }

  private update_shown(content: PaneContent, shown: Shown): void {
    const { surface, model, index } = shown;
    const role = model.record.role;
    surface.object.visible = !this.state.hidden.has(index);
    if (shown.moves) surface.set_motion(this.motion.place(this.state.t), this.moving_pose());
    else surface.set_motion(start, role === "target" ? this.standing_pose() : at_rest);
    const field = this.state.coloured.includes(index) ? model.field(this.state.field) : null;
    surface.set_values(field?.values ?? null);
    surface.set_range(...this.state.range, field?.record.middle !== null);
    const is_veil = content.side === "both" && role === "target";
    surface.set_opacity(is_veil ? this.state.opacity : 1);
    surface.set_clip(this.clip(content, shown));
  }

  /** The cutting plane of the source's frame, as it lies at the target. */
  private clip(content: PaneContent, shown: Shown): Vector4 | null {
    const { on, axis, position, flipped } = this.state.clip;
    if (!on) return null;
    const { origin, spacing, size } = this.record.lattice;
    const at = origin[axis] + position * (size[axis] - 1) * spacing;
    const normal = new Vector3().setComponent(axis, flipped ? -1 : 1);
    const plane = new Vector4(normal.x, normal.y, normal.z, flipped ? -at : at);
    if (content.side === "source" || !this.state.rigid) return plane;
    const pose = shown.moves ? this.moving_pose() : this.motion.pose(1);
    const turned = normal.applyMatrix3(pose.turn);
    return new Vector4(turned.x, turned.y, turned.z, plane.w + turned.dot(pose.shift));
  }

  private update_extras(content: PaneContent): void {
    content.extras.clear();
    const moves = content.side !== "source";
    const place = moves ? this.motion.place(this.state.t) : start;
    const pose = moves ? this.moving_pose() : at_rest;
    if (this.state.slice.on) {
      const slice = slice_points(this.samples, this.state.slice);
      const places = carried_slice(this.samples, slice, place);
      if (this.state.slice.determinant) {
        const plane = new Surface([places], grid_faces(slice), "#888888");
        plane.set_motion(start, pose);
        plane.set_values(Float32Array.from(slice.points, (point) => this.samples.determinant_at(point)));
        plane.set_range(0, 2, true);
        // Behind the lines that lie in it.
        Object.assign(plane.material, { polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1 });
        content.extras.add(plane.object);
      }
      const lines = line_object(places, grid_line_indices(slice), this.state.slice.determinant ? "#333333" : "#3d7ab8");
      set_pose(lines, pose);
      content.extras.add(lines);
    }
    if (content.side !== "target")
      for (const index of this.state.levels) {
        const level = this.record.levels[index];
        content.extras.add(
          box_lines(unpacked_points(this.bytes, level.leaves), level.leaf_size, level_colours[level.level % level_colours.length]),
        );
      }
  }

  private update_markers(content: PaneContent): void {
    if (!this.state.anchors) return content.markers.set([], []);
    const standing = this.standing_pose();
    const at_source = content.side === "source";
    const points = this.record.anchors.map((anchor) =>
      at_source ? new Vector3(...anchor.a) : moved(new Vector3(...anchor.b), standing),
    );
    const colours = this.record.anchors.map((anchor) => (anchor.suspicion === null ? anchor_colour : suspicious_colour));
    content.markers.set(points, colours, points.map((_, i) => (i === this.state.chosen_anchor ? "large" : "plain")));
    if (at_source) return;
    // From where the map takes it to where it should be.
    const ends = new Float32Array(6 * points.length);
    this.record.anchors.forEach((anchor, i) => {
      points[i].toArray(ends, 6 * i);
      moved(new Vector3(...anchor.image), standing).toArray(ends, 6 * i + 3);
    });
    content.extras.add(line_object(ends, [...Array(2 * points.length).keys()], "#d1491d"));
  }

  /** Shows faces of a model wherever it stands; none takes the last ones away. */
  highlight(index: number, faces: number[]): void {
    for (const { surface } of this.highlighted.splice(0)) {
      surface.object.removeFromParent();
      surface.dispose();
    }
    this.highlighted_faces = faces;
    const model = this.models[index];
    const vertices = faces.flatMap((face) => [...model.faces.subarray(3 * face, 3 * face + 3)]);
    const knots = model.knots.map((places) => Float32Array.from(vertices.flatMap((vertex) => [...places.subarray(3 * vertex, 3 * vertex + 3)])));
    for (const content of faces.length === 0 ? [] : this.contents)
      for (const shown of content.shown) {
        if (shown.index !== index) continue;
        const surface = new Surface(knots, Uint32Array.from(vertices.keys()), highlight_colour);
        Object.assign(surface.material, { polygonOffset: true, polygonOffsetFactor: -2, polygonOffsetUnits: -4 });
        content.pane.scene.add(surface.object);
        this.highlighted.push({ surface, shown });
      }
    this.move_highlighted();
    this.stage.draw_soon();
  }

  /** For tests: of the model, and in how many panes. */
  get highlights(): { faces: number[]; panes: number } {
    return { faces: this.highlighted_faces, panes: this.highlighted.length };
  }

  /** For tests: where the middle of a face is drawn first, pixels of the window. */
  pixel_of_face(index: number, face: number): [number, number] {
    const content = this.contents.find((each) => each.shown.some((shown) => shown.index === index)) as PaneContent;
    const { surface } = content.shown.find((shown) => shown.index === index) as Shown;
    const middle = new Vector3();
    for (const vertex of surface.faces.subarray(3 * face, 3 * face + 3)) middle.addScaledVector(surface.at(vertex), 1 / 3);
    const at = this.stage.pixel_of(content.pane, middle), box = this.stage.canvas.getBoundingClientRect();
    return [box.left + at.x, box.top + at.y];
  }

  private move_highlighted(): void {
    for (const { surface, shown } of this.highlighted)
      if (shown.moves) surface.set_motion(this.motion.place(this.state.t), this.moving_pose());
      else surface.set_motion(start, at_rest);
  }

  /** What a place of the canvas shows. */
  find(x: number, y: number): Found | null {
    const at = this.stage.ray_at(x, y);
    const content = this.contents.find((candidate) => candidate.pane === at?.pane);
    if (at === null || content === undefined) return null;
    let best: Found | null = null;
    for (const shown of content.shown) {
      if (!shown.surface.object.visible) continue;
      const hit = this.hit(shown, at.ray, at.pane);
      if (hit !== null && (best === null || hit.distance < best.hit.distance)) best = { content, shown, hit };
    }
    return best;
  }

  /** Of what has no faces, the point nearest to the eye within a few pixels of the ray. */
  private hit(shown: Shown, ray: Ray, pane: Pane): Hit | null {
    const few = 6;
    return shown.surface.faces.length > 0 ? shown.surface.first_hit(ray) : shown.surface.first_point(ray, few * this.stage.pixel_length(pane));
  }

  fly_to(source_point: Vector3 | null, target_point: Vector3): void {
    const in_world = this.state.layout === "over" && this.state.rigid;
    const back = inverse_pose(this.motion.pose(1));
    const centre = in_world ? target_point : (source_point ?? moved(target_point.clone(), back));
    const near = 0.06; // of the source's diagonal: a thumb on a hand, an eye on a head
    this.stage.fly_to(centre, near * this.record.diagonal);
  }

  /** Where a vertex of a mesh's file is at t, as `apply --t` writes it. */
  carried_place(index: number, number_in_file: number): Vector3 {
    const model = this.models[index];
    const surface = model.surface();
    surface.set_motion(this.motion.place(this.state.t), this.motion.pose(this.state.t));
    const place = surface.at(model.vertex_of_number(number_in_file));
    surface.dispose();
    return place;
  }
}

export function moved(point: Vector3, pose: { turn: Matrix3; shift: Vector3 }): Vector3 {
  return point.applyMatrix3(pose.turn).add(pose.shift);
}
