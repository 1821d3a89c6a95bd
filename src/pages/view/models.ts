import { unpacked, unpacked_points, unpacked_values } from "../scene/decode";
import type { FieldRecord, MeshRecord } from "../scene/scene";
import { Surface } from "../stage/surface";
import { quantile, sorted_finite } from "../maths/numbers";

export const mesh_colours = { source: "#b9a48c", target: "#9fb3c6", product: "#a79bbd" } as const;

export interface Field {
  record: FieldRecord;
  values: Float32Array;
  sorted: Float32Array;
}

/** A mesh of the scene. It is drawn by a surface of its own in every pane that shows it. */
export class Model {
  readonly knots: Float32Array[];
  readonly faces: Uint32Array;
  /** Numbers of the vertices in the file. */
  readonly original: Uint32Array | null;
  private readonly fields = new Map<string, Field>();

  constructor(readonly record: MeshRecord, private readonly bytes: Uint8Array) {
    this.knots = record.places.map((places) => unpacked_points(bytes, places));
    this.faces = unpacked(bytes, record.faces);
    this.original = record.original === null ? null : unpacked(bytes, record.original);
  }

  surface(): Surface {
    return new Surface(this.knots, this.faces, mesh_colours[this.record.role]);
  }

  field(id: string): Field | null {
    const known = this.fields.get(id);
    if (known !== undefined) return known;
    const record = this.record.fields.find((candidate) => candidate.id === id);
    if (record === undefined) return null;
    const values = unpacked_values(this.bytes, record.values);
    const field = { record, values, sorted: sorted_finite(values) };
    this.fields.set(id, field);
    return field;
  }

  /** For lists. */
  get label(): string {
    const { role, name } = this.record;
    return name === role ? role : `${role}: ${name}`;
  }

  number_in_file(vertex: number): number {
    return this.original === null ? vertex : this.original[vertex];
  }

  vertex_of_number(number: number): number {
    return this.original === null ? number : this.original.indexOf(number);
  }
}

/** One quantity of several models: one range and one histogram for all. */
export function joint_field(models: Model[], id: string): Field | null {
  const fields = models.map((model) => model.field(id)).filter((field) => field !== null);
  if (fields.length <= 1) return fields[0] ?? null;
  const values = new Float32Array(fields.reduce((count, field) => count + field.values.length, 0));
  let at = 0;
  for (const field of fields) {
    values.set(field.values, at);
    at += field.values.length;
  }
  return { record: fields[0].record, values, sorted: sorted_finite(values) };
}

/** Where colours begin and end: outliers of 1 % are left to the ends; symmetric about the middle where there is one. */
export function default_range(field: Field): [number, number] {
  const low = quantile(field.sorted, 0.01), high = quantile(field.sorted, 0.99);
  const middle = field.record.middle;
  if (Number.isNaN(low)) return [0, 1];
  if (middle === null) return [field.sorted[0] >= 0 && low < 0.25 * high ? 0 : low, high > low ? high : low + 1];
  const reach = Math.max(Math.abs(low - middle), Math.abs(high - middle)) || 1e-6;
  return [middle - reach, middle + reach];
}
