import type { Triple } from "../scene/scene";
import { FaceTree } from "./face_tree";

/** A point of a surface and the face that it lies in. */
export interface SurfacePoint {
  point: Triple;
  face: number;
}

export const minus = (a: Triple, b: Triple): Triple => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
export const dot = (a: Triple, b: Triple): number => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
export const between = (a: Triple, b: Triple, share: number): Triple => [
  a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1]), a[2] + share * (b[2] - a[2]),
];

/** Number of each vertex, with those at one place as one: files repeat vertices along seams, where a surface still goes on. */
function welded(places: Float64Array): Uint32Array {
  const count = places.length / 3;
  const order = Uint32Array.from({ length: count }, (_, i) => i);
  const difference = (i: number, j: number): number =>
    places[3 * i] - places[3 * j] || places[3 * i + 1] - places[3 * j + 1] || places[3 * i + 2] - places[3 * j + 2];
  order.sort(difference);
  const number = new Uint32Array(count);
  for (let k = 0; k < count; ++k) number[order[k]] = k > 0 && difference(order[k - 1], order[k]) === 0 ? number[order[k - 1]] : order[k];
  return number;
}

/** Which faces meet at which edges. Edge k of a face joins its corners k and k + 1. */
export class SurfaceGraph {
  readonly faces: Uint32Array;
  /** Three a face. */
  readonly edges_of: Uint32Array;
  /** Two vertices an edge. */
  readonly ends: Uint32Array;
  /** The faces at edge e are faces_at[first_at[e]] to faces_at[first_at[e + 1] − 1]. */
  readonly first_at: Uint32Array;
  readonly faces_at: Uint32Array;
  /** Sum of the angles of its faces at every vertex, radians. */
  readonly angle_at: Float64Array;

  /** x, y, z of every vertex. */
  readonly places: Float64Array;

  private known_tree: FaceTree | null = null;
  private known_areas: Float64Array | null = null;

  constructor(vertices: Float32Array | Float64Array, faces: Uint32Array) {
    this.places = Float64Array.from(vertices);
    const number = welded(this.places);
    this.faces = faces.map((vertex) => number[vertex]);
    this.edges_of = new Uint32Array(faces.length);
    const known = new Map<number, number>();
    const ends: number[] = [];
    for (let k = 0; k < faces.length; ++k) {
      const u = this.faces[k], w = this.faces[k % 3 === 2 ? k - 2 : k + 1];
      const key = Math.min(u, w) * vertices.length + Math.max(u, w);
      let edge = known.get(key);
      if (edge === undefined) {
        edge = known.size;
        known.set(key, edge);
        ends.push(u, w);
      }
      this.edges_of[k] = edge;
    }
    this.ends = Uint32Array.from(ends);
    this.first_at = new Uint32Array(known.size + 1);
    for (const edge of this.edges_of) this.first_at[edge + 1] += 1;
    for (let edge = 0; edge < known.size; ++edge) this.first_at[edge + 1] += this.first_at[edge];
    this.faces_at = new Uint32Array(faces.length);
    const filled = this.first_at.slice();
    this.edges_of.forEach((edge, k) => (this.faces_at[filled[edge]++] = Math.floor(k / 3)));
    this.angle_at = this.angles();
  }

  get edge_count(): number {
    return this.ends.length / 2;
  }

  place(vertex: number): Triple {
    return [this.places[3 * vertex], this.places[3 * vertex + 1], this.places[3 * vertex + 2]];
  }

  /** Whether an edge, or a corner, belongs to a face or edge. */
  has_end(edge: number, vertex: number): boolean {
    return this.ends[2 * edge] === vertex || this.ends[2 * edge + 1] === vertex;
  }

  edges_at(face: number): Uint32Array {
    return this.edges_of.subarray(3 * face, 3 * face + 3);
  }

  faces_of(edge: number): Uint32Array {
    return this.faces_at.subarray(this.first_at[edge], this.first_at[edge + 1]);
  }

  /** All faces that have a corner in common with a face. */
  faces_around(face: number): number[] {
    const around = new Set<number>();
    for (const vertex of this.faces.subarray(3 * face, 3 * face + 3)) {
      const open = [face];
      const is_met = new Set(open);
      for (let next = open.pop(); next !== undefined; next = open.pop()) {
        around.add(next);
        for (const edge of this.edges_at(next))
          for (const other of this.has_end(edge, vertex) ? this.faces_of(edge) : []) {
            if (is_met.has(other)) continue;
            is_met.add(other);
            open.push(other);
          }
      }
    }
    return [...around];
  }

  /** The face at the other side of an edge; null at a boundary, and where more than two faces meet. */
  across(edge: number, face: number): number | null {
    const first = this.first_at[edge];
    if (this.first_at[edge + 1] - first !== 2) return null;
    return this.faces_at[first] === face ? this.faces_at[first + 1] : this.faces_at[first];
  }

  /** The edge at a corner of a face that is not the given one. */
  other_edge_at(face: number, vertex: number, edge: number): number {
    for (let k = 3 * face; k < 3 * face + 3; ++k)
      if (this.edges_of[k] !== edge && this.has_end(this.edges_of[k], vertex)) return this.edges_of[k];
    return edge;
  }

  get face_areas(): Float64Array {
    return (this.known_areas ??= this.areas());
  }

  /** Of the box around all faces. */
  get diagonal(): number {
    return this.tree.diagonal;
  }

  /** The nearest point of the surface. */
  nearest(point: Triple): SurfacePoint {
    const on_face = (face: number): Triple => nearest_of_triangle(point, this.corner(face, 0), this.corner(face, 1), this.corner(face, 2));
    const found = this.tree.nearest(point, (face) => {
      if (this.is_line(face)) return Infinity;
      const away = minus(on_face(face), point);
      return dot(away, away);
    });
    return found === null ? { point, face: 0 } : { point: on_face(found.face), face: found.face };
  }

  corner(face: number, k: number): Triple {
    return this.place(this.faces[3 * face + k]);
  }

  /** Made when the first place is looked for. */
  private get tree(): FaceTree {
    return (this.known_tree ??= new FaceTree(this.places, this.faces));
  }

  /** Two corners at one place: its edges are one, with other faces at it. */
  private is_line(face: number): boolean {
    const [u, v, w] = [this.faces[3 * face], this.faces[3 * face + 1], this.faces[3 * face + 2]];
    return u === v || v === w || w === u;
  }

  private areas(): Float64Array {
    return Float64Array.from({ length: this.faces.length / 3 }, (_, face) => {
      const at = this.corner(face, 0), [ux, uy, uz] = minus(this.corner(face, 1), at), [wx, wy, wz] = minus(this.corner(face, 2), at);
      return Math.hypot(uy * wz - uz * wy, uz * wx - ux * wz, ux * wy - uy * wx) / 2;
    });
  }

  private angles(): Float64Array {
    const sums = new Float64Array(this.places.length / 3);
    for (let k = 0; k < this.faces.length; ++k) {
      const face = Math.floor(k / 3), at = this.corner(face, k % 3);
      const u = minus(this.corner(face, (k + 1) % 3), at), w = minus(this.corner(face, (k + 2) % 3), at);
      const lengths = Math.sqrt(dot(u, u) * dot(w, w));
      if (lengths > 0) sums[this.faces[k]] += Math.acos(Math.min(1, Math.max(-1, dot(u, w) / lengths)));
    }
    return sums;
  }
}

/** Ericson, Real-Time Collision Detection, 5.1.5: by the region of the triangle's plane that the point lies over. */
function nearest_of_triangle(x: Triple, a: Triple, b: Triple, c: Triple): Triple {
  const ab = minus(b, a), ac = minus(c, a), ax = minus(x, a), bx = minus(x, b), cx = minus(x, c);
  const d1 = dot(ab, ax), d2 = dot(ac, ax);
  if (d1 <= 0 && d2 <= 0) return a;
  const d3 = dot(ab, bx), d4 = dot(ac, bx);
  if (d3 >= 0 && d4 <= d3) return b;
  const d5 = dot(ab, cx), d6 = dot(ac, cx);
  if (d6 >= 0 && d5 <= d6) return c;
  const vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return between(a, b, d1 / (d1 - d3));
  const vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return between(a, c, d2 / (d2 - d6));
  const va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) return between(b, c, (d4 - d3) / (d4 - d3 + d5 - d6));
  const sum = va + vb + vc;
  return [0, 1, 2].map((axis) => a[axis] + (vb / sum) * ab[axis] + (vc / sum) * ac[axis]) as Triple;
}
