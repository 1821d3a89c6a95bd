/** The formats of `bespoke anchors convert` (src/bespoke/anchors/anchor_files.h), recognised and described as there. */
export type AnchorFormat = "json" | "csv" | "meshlab" | "markups" | "fiducials" | "landmarks" | "wrap" | "indices";

export interface FormatRecord {
  label: string;
  ending: string;
  /** Each model has a file of its own. */
  per_side: boolean;
  /** What there is a place for, beside the points. */
  names: boolean;
  accuracies: boolean;
  curves: boolean;
  /** Points are places of the model, by its numbers. */
  of_model: boolean;
  /** Coordinates are LPS or RAS. */
  of_patient: boolean;
}

const points_alone = { per_side: true, names: true, accuracies: false, curves: false, of_model: false, of_patient: false };

export const anchor_formats: Record<AnchorFormat, FormatRecord> = {
  json: { ...points_alone, label: "bespoke, JSON", ending: ".json", per_side: false, accuracies: true, curves: true },
  csv: { ...points_alone, label: "Table, CSV", ending: ".csv", per_side: false, accuracies: true },
  meshlab: { ...points_alone, label: "MeshLab", ending: ".pp" },
  markups: { ...points_alone, label: "3D Slicer", ending: ".mrk.json", curves: true, of_patient: true },
  fiducials: { ...points_alone, label: "3D Slicer, older", ending: ".fcsv", of_patient: true },
  landmarks: { ...points_alone, label: "Landmark Editor", ending: ".pts" },
  wrap: { ...points_alone, label: "Wrap, [triangle, u, v]", ending: ".wrap.json", names: false, of_model: true },
  indices: { ...points_alone, label: "Vertex numbers", ending: ".txt", per_side: false, names: false, of_model: true },
};

const by_ending: AnchorFormat[] = ["markups", "wrap", "csv", "meshlab", "fiducials", "landmarks", "indices"];

/** By the ending of a file's name, and for .json by what stands in it. */
export function format_of(name: string, text: string): AnchorFormat {
  const lower = name.toLowerCase();
  const known = by_ending.find((format) => lower.endsWith(anchor_formats[format].ending));
  if (known !== undefined) return known;
  if (!lower.endsWith(".json")) throw new Error(`${name}: unknown ending; known are .json, .csv, .pp, .mrk.json, .fcsv, .pts, .wrap.json and .txt`);
  // Wrap's files have no ending of their own; they are arrays.
  return text.trimStart().startsWith("[") ? "wrap" : "json";
}
