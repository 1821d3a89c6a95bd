/** What the command writes into a page (src/bespoke/page/README.md, "The scene"). Lengths are in mesh units. */

export type Triple = [number, number, number];

/** A packed array: `count` unsigned numbers of `bits` bits from byte `at` on. */
export interface ArrayReference {
  at: number;
  count: number;
  bits: 16 | 32;
}

/** Points, each coordinate in 65,535 steps from `min` to `max`: all x, then all y, then all z. */
export interface PointsReference {
  array: ArrayReference;
  min: Triple;
  max: Triple;
}

/** Points to the last bit: the lower and the upper 32 bits of every double; all x, then all y, then all z. */
export interface ExactPointsReference {
  low: ArrayReference;
  high: ArrayReference;
}

/** Numbers in 65,534 steps from `min` to `max`; the code 65,535 stands for "not known". */
export interface ValuesReference {
  array: ArrayReference;
  min: number;
  max: number;
}

export interface FieldRecord {
  id: string;
  label: string;
  /** "" for a ratio. */
  unit: string;
  /** What a value is compared with: 0 or 1 for diverging colours, null for magnitudes. */
  middle: number | null;
  values: ValuesReference;
}

export interface MeshRecord {
  role: "source" | "target" | "product";
  name: string;
  faces: ArrayReference;
  /** Faces of the file; more than are shown where the mesh was decimated. */
  faces_in_file: number;
  vertices_in_file: number;
  /** Numbers of the shown vertices in the file; null when all are shown in their order. */
  original: ArrayReference | null;
  /** One for every knot of the motion; a single one for what stands still. */
  places: PointsReference[];
  fields: FieldRecord[];
  /** The vertices as they are, on the page for picking; null where the mesh was thinned. */
  exact?: ExactPointsReference | null;
}

export interface MotionRecord {
  /** Rows of R. */
  rotation: [Triple, Triple, Triple];
  translation: Triple;
  path: "geodesic" | "euler" | "flow";
  /** Times between which the elastic part moves every point along a straight line. */
  knots: number[];
}

export interface AnchorRecord {
  name: string;
  a: Triple;
  b: Triple;
  image: Triple;
  residual: number;
  sigma: number | null;
  weight: number | null;
  suspicion: string | null;
}

/** Something worth a look, in the source frame at time 0, or of the target at time 1. */
export interface PlaceRecord {
  kind: string;
  text: string;
  at: Triple;
  side: "source" | "target";
  value: number | null;
}

export interface LatticeRecord {
  origin: Triple;
  spacing: number;
  size: Triple;
  /** Where the elastic part takes the nodes (x slowest), one for every knot but the first. */
  places: PointsReference[];
  determinant: ValuesReference;
}

export interface LevelRecord {
  step: number;
  level: number;
  voxel_size: number;
  leaf_size: number;
  leaves: PointsReference;
}

export interface ViewRecord {
  page: "view";
  title: string;
  unit: string;
  command: string;
  diagonal: number;
  motion: MotionRecord;
  meshes: MeshRecord[];
  anchors: AnchorRecord[];
  places: PlaceRecord[];
  lattice: LatticeRecord;
  levels: LevelRecord[];
  patterns: PatternRecord[];
  info: Record<string, unknown>;
  quality: Record<string, unknown>;
  notes: string[];
}

export interface PickRecord {
  page: "pick";
  title: string;
  unit: string;
  command: string;
  /** Of both models: names a piece of work in the browser's storage. */
  key: string;
  /** As given on the command line, for the `fit` command. */
  source_path: string;
  target_path: string;
  meshes: MeshRecord[];
  anchors: { units: string; pairs: unknown[]; curves: unknown[]; patches: unknown[] } | null;
}

/** A piece of a pattern, flat, as `flatten -o pieces.json` wrote it. */
export interface PieceRecord {
  name: string;
  /** x and y on the sheet, y up, millimetres; z is 0. */
  places: PointsReference;
  faces: ArrayReference;
  /** Vertices along the border. */
  outline: ArrayReference;
  /** For every face the product's, by its number in the file as triangles. */
  product_faces: ArrayReference;
  /** For every face the larger |stretch − 1|. */
  strain: ValuesReference;
}

/** The pieces of a product. */
export interface PatternRecord {
  /** In `meshes`. */
  mesh: number;
  pieces: PieceRecord[];
}

export interface SeamsRecord {
  page: "seams";
  title: string;
  unit: string;
  command: string;
  /** Of the garment and the given seams: names a piece of work in the browser's storage. */
  key: string;
  garment_path: string;
  meshes: MeshRecord[];
  /** A seam file to begin with. */
  seams: unknown;
}

export type SceneRecord = ViewRecord | PickRecord | SeamsRecord;
