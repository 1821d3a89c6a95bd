import type { Triple } from "../scene/scene";

export interface NamedPoint {
  /** "" without. */
  name: string;
  x: Triple;
}

export interface NamedLine {
  /** "" without. */
  name: string;
  points: Triple[];
  closed: boolean;
}

/** What a file with one side holds. */
export interface FileSide {
  points: NamedPoint[];
  /** 3D Slicer's markups alone have a place for them. */
  lines: NamedLine[];
}
