import type { FileModels } from "../anchor_files/anchor_files";
import { ExactModel } from "../anchor_files/model_places";
import type { PatientSystem } from "../anchor_files/slicer";
import { choice, row } from "../controls/elements";
import { shown } from "../maths/numbers";
import { distance } from "../maths/warp";
import { unpacked_exact_points } from "../scene/decode";
import type { MeshRecord, Triple } from "../scene/scene";
import type { Model } from "../view/models";
import type { Side } from "./curves";
import type { Tracer } from "./tracer";

const measured_points = 50; // of a file, at most: enough for a median
const shown_within = 1e-5; // of the diagonal: by so much the page rounds the places of vertices (pick_scene.h)

/** The two models as files of other programs mean them. */
export class ModelsOfFiles implements FileModels {
  system: PatientSystem = "LPS";
  private readonly known: Partial<Record<Side, ExactModel>> = {};

  constructor(private readonly bytes: Uint8Array, private readonly unit: string, private readonly models: Record<Side, Model>, private readonly tracers: Record<Side, Tracer>) {}

  exact(side: Side): ExactModel {
    return (this.known[side] ??= this.unpacked(side));
  }

  /** The median distance of points from the model as it is shown, mesh units; null without points. */
  distance(side: Side, points: Triple[]): number | null {
    const step = Math.max(1, Math.ceil(points.length / measured_points));
    const distances = points.filter((_, i) => i % step === 0).map((point) => distance(point, this.tracers[side].nearest(point))).sort((x, y) => x - y);
    return distances.length === 0 ? null : distances[Math.floor((distances.length - 1) / 2)];
  }

  /** Such a distance in words. */
  place(side: Side, median: number): string {
    const { min, max } = this.models[side].record.places[0];
    return median <= shown_within * distance(min, max) ? "on the model" : `${shown(median, this.unit)} off the model (median)`;
  }

  /** What is wrong where a format names vertices or triangles of models that are shown thinned; empty without. */
  get thinned(): string {
    return (["a", "b"] as const).map((side) => this.models[side].record).filter((record) => !record.exact).map(thinned).join("; ");
  }

  system_row(changed: () => void): HTMLElement {
    const systems = [{ value: "LPS", label: "LPS (left, posterior, superior)" }, { value: "RAS", label: "RAS (right, anterior, superior)" }];
    return row("Models are in", choice(systems, this.system, (system) => { this.system = system as PatientSystem; changed(); }, "Patient coordinates of the models"));
  }

  private unpacked(side: Side): ExactModel {
    const { record, faces } = this.models[side];
    if (!record.exact) throw new Error(thinned(record));
    return new ExactModel(unpacked_exact_points(this.bytes, record.exact), faces);
  }
}

function thinned(record: MeshRecord): string {
  const model = record.role === "source" ? "--source" : "--target";
  return `the format names vertices or triangles, and this page has ${record.name} thinned to be drawn: bespoke anchors convert knows them all, with ${model}`;
}
