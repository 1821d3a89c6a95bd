import { BufferAttribute, BufferGeometry, LineBasicMaterial, LineSegments, Object3D, Vector3 } from "three";

import type { Place, Pose } from "../maths/motion";
import { unpacked_points, unpacked_values } from "../scene/decode";
import type { LatticeRecord } from "../scene/scene";

/** Where the elastic part takes space, sampled on a lattice and trilinear between its nodes. */
export class SpaceSamples {
  readonly knots: Float32Array[];
  readonly determinant: Float32Array;

  constructor(readonly record: LatticeRecord, bytes: Uint8Array) {
    const nodes = record.size[0] * record.size[1] * record.size[2];
    const rest = new Float32Array(3 * nodes);
    for (let n = 0; n < nodes; ++n) this.node_place(n).toArray(rest, 3 * n);
    this.knots = [rest, ...record.places.map((places) => unpacked_points(bytes, places))];
    this.determinant = unpacked_values(bytes, record.determinant);
  }

  private node_place(n: number): Vector3 {
    const [, ny, nz] = this.record.size;
    const index = [Math.floor(n / (ny * nz)), Math.floor(n / nz) % ny, n % nz];
    return new Vector3(...this.record.origin).add(new Vector3(...index).multiplyScalar(this.record.spacing));
  }

  /** F at a point of the source frame. */
  place_of(point: Vector3, place: Place): Vector3 {
    const moved = new Vector3();
    this.for_corners(point, (node, weight) => {
      const before = this.knots[place.knot], after = this.knots[place.knot + 1];
      for (let axis = 0; axis < 3; ++axis) {
        const at = before[3 * node + axis];
        const here = at + place.fraction * (after[3 * node + axis] - at);
        moved.setComponent(axis, moved.getComponent(axis) + weight * here);
      }
    });
    return moved;
  }

  determinant_at(point: Vector3): number {
    let value = 0;
    this.for_corners(point, (node, weight) => {
      if (weight > 0) value += weight * this.determinant[node];
    });
    return value;
  }

  private for_corners(point: Vector3, visit: (node: number, weight: number) => void): void {
    const { origin, spacing, size } = this.record;
    const cell = [0, 0, 0], rest = [0, 0, 0];
    for (let axis = 0; axis < 3; ++axis) {
      const at = Math.min(size[axis] - 1, Math.max(0, (point.getComponent(axis) - origin[axis]) / spacing));
      cell[axis] = Math.min(Math.floor(at), size[axis] - 2);
      rest[axis] = at - cell[axis];
    }
    for (let corner = 0; corner < 8; ++corner) {
      const step = [corner >> 2, (corner >> 1) & 1, corner & 1];
      const weight = step.reduce((product, one, axis) => product * (one === 1 ? rest[axis] : 1 - rest[axis]), 1);
      const node = ((cell[0] + step[0]) * size[1] + cell[1] + step[1]) * size[2] + cell[2] + step[2];
      visit(node, weight);
    }
  }
}

export interface SliceSettings {
  axis: 0 | 1 | 2;
  /** From one side of the lattice to the other, 0 to 1. */
  position: number;
  lines: number;
}

const pieces_between_lines = 4;

/** Points of a plane through the source's space: rows × columns of them. */
export interface SlicePoints {
  rows: number;
  columns: number;
  points: Vector3[];
}

export function slice_points(samples: SpaceSamples, settings: SliceSettings): SlicePoints {
  const { origin, spacing, size } = samples.record;
  const extent = size.map((count) => (count - 1) * spacing);
  const [u, v] = [0, 1, 2].filter((axis) => axis !== settings.axis);
  const step = Math.max(extent[u], extent[v]) / (settings.lines * pieces_between_lines);
  const columns = Math.floor(extent[u] / step) + 1, rows = Math.floor(extent[v] / step) + 1;
  const points: Vector3[] = [];
  for (let i = 0; i < rows; ++i)
    for (let j = 0; j < columns; ++j) {
      const point = new Vector3(...origin);
      point.setComponent(settings.axis, origin[settings.axis] + settings.position * extent[settings.axis]);
      point.setComponent(u, origin[u] + j * step);
      point.setComponent(v, origin[v] + i * step);
      points.push(point);
    }
  return { rows, columns, points };
}

/** Pairs of neighbours along the lines of the grid. */
export function grid_line_indices({ rows, columns }: SlicePoints): number[] {
  const indices: number[] = [];
  for (let i = 0; i < rows; ++i)
    for (let j = 0; j < columns; ++j) {
      if (i % pieces_between_lines === 0 && j + 1 < columns) indices.push(i * columns + j, i * columns + j + 1);
      if (j % pieces_between_lines === 0 && i + 1 < rows) indices.push(i * columns + j, (i + 1) * columns + j);
    }
  return indices;
}

export function grid_faces({ rows, columns }: SlicePoints): Uint32Array {
  const faces: number[] = [];
  for (let i = 0; i + 1 < rows; ++i)
    for (let j = 0; j + 1 < columns; ++j) {
      const a = i * columns + j;
      faces.push(a, a + 1, a + columns, a + 1, a + columns + 1, a + columns);
    }
  return new Uint32Array(faces);
}

/** The slice's points, carried to a time: x, y, z of one after the other. */
export function carried_slice(samples: SpaceSamples, slice: SlicePoints, place: Place): Float32Array {
  const places = new Float32Array(3 * slice.points.length);
  slice.points.forEach((point, i) => samples.place_of(point, place).toArray(places, 3 * i));
  return places;
}

export function line_object(places: Float32Array, indices: number[], colour: string): LineSegments {
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(places, 3));
  geometry.setIndex(indices);
  const object = new LineSegments(geometry, new LineBasicMaterial({ color: colour }));
  object.frustumCulled = false;
  object.matrixAutoUpdate = false;
  return object;
}

/** Poses an object as Ψ(t)'s rigid part does. */
export function set_pose(object: Object3D, pose: Pose): void {
  object.matrix.setFromMatrix3(pose.turn).setPosition(pose.shift);
}

const box_edges = [0, 1, 2, 3, 4, 5, 6, 7, 0, 2, 1, 3, 4, 6, 5, 7, 0, 4, 1, 5, 2, 6, 3, 7];

/** Outlines of boxes of one size, by their least corners. */
export function box_lines(corners: Float32Array, size: number, colour: string): LineSegments {
  const boxes = corners.length / 3;
  const places = new Float32Array(24 * boxes);
  const indices: number[] = [];
  for (let box = 0; box < boxes; ++box) {
    for (let corner = 0; corner < 8; ++corner)
      for (let axis = 0; axis < 3; ++axis)
        places[24 * box + 3 * corner + axis] = corners[3 * box + axis] + size * ((corner >> (2 - axis)) & 1);
    for (const vertex of box_edges) indices.push(8 * box + vertex);
  }
  return line_object(places, indices, colour);
}
