import type { FileModels } from "../anchor_files/anchor_files";
import { ExactModel } from "../anchor_files/model_places";
import type { PatientSystem } from "../anchor_files/slicer";
import { choice, row } from "../controls/elements";
import { unpacked_exact_points } from "../scene/decode";
import type { MeshRecord, Triple } from "../scene/scene";
import type { Model } from "../view/models";
import type { Side } from "./curves";
import type { Tracer } from "./tracer";

/** The two models as files of other programs mean them. */
export class ModelsOfFiles implements FileModels {
  system: PatientSystem = "LPS";
  private readonly known: Partial<Record<Side, ExactModel>> = {};

  constructor(private readonly bytes: Uint8Array, private readonly models: Record<Side, Model>, private readonly tracers: Record<Side, Tracer>) {}

  exact(side: Side): ExactModel {
    return (this.known[side] ??= this.unpacked(side));
  }

  /** From the model as it is shown, mesh units. */
  distance(side: Side, point: Triple): number {
    const near = this.tracers[side].nearest(point);
    return Math.hypot(near[0] - point[0], near[1] - point[1], near[2] - point[2]);
  }

  /** What is wrong where a format names vertices or triangles of models that are shown thinned; empty without. */
  get thinned(): string {
    return (["a", "b"] as const).map((side) => this.models[side].record).filter((record) => !record.exact).map(thinned).join("; ");
  }

  system_row(changed: () => void): HTMLElement {
    const systems = [{ value: "LPS", label: "LPS" }, { value: "RAS", label: "RAS" }];
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
