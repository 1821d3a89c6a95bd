import type { Triple } from "../scene/scene";
import { between, minus, type SurfaceGraph } from "./surface_graph";

/** Faces, each sharing an edge with the next: faces has one more than edges. */
export interface Strip {
  faces: number[];
  edges: number[];
}

/** Where the shortest path of a strip bends: at a vertex, an end of the edges first … last of the strip. */
export interface Bend {
  vertex: number;
  first: number;
  last: number;
  /** By how much it turns, radians, above 0. */
  turn: number;
}

export interface StripPath {
  points: Triple[];
  length: number;
  bends: Bend[];
}

/** A strip's edges, unfolded into a plane one after the other (which way round does not matter), and the ends of a path through it. */
class Unfolded {
  readonly count: number;
  /** By edge: the vertices at either side of the way. */
  readonly left: Uint32Array;
  readonly right: Uint32Array;
  /** x, y of both ends of every edge, left first; then of the path's two ends. */
  readonly flat: Float64Array;

  constructor(private readonly graph: SurfaceGraph, edges: number[], from: Triple, to: Triple) {
    const { ends, places } = graph, n = edges.length;
    this.count = n;
    this.left = new Uint32Array(n);
    this.right = new Uint32Array(n);
    this.flat = new Float64Array(4 * n + 4);
    this.left[0] = ends[2 * edges[0]];
    this.right[0] = ends[2 * edges[0] + 1];
    this.flat[2] = Math.hypot(...minus(graph.place(this.right[0]), graph.place(this.left[0])));
    for (let i = 1; i < n; ++i) {
      const u = ends[2 * edges[i]], w = ends[2 * edges[i] + 1];
      const keeps_left = u === this.left[i - 1] || w === this.left[i - 1];
      const kept = keeps_left ? this.left[i - 1] : this.right[i - 1];
      const next = u === kept ? w : u;
      this.left[i] = keeps_left ? kept : next;
      this.right[i] = keeps_left ? next : kept;
      this.flat.copyWithin(4 * i, 4 * i - 4, 4 * i);
      this.lay(i - 1, places[3 * next], places[3 * next + 1], places[3 * next + 2], 1, 4 * i + (keeps_left ? 2 : 0));
    }
    this.lay(0, ...from, -1, 4 * n);
    this.lay(n - 1, ...to, 1, 4 * n + 2);
  }

  /** Unfolds a point beside an edge: beyond it (side 1) or before it (−1). Unfolding keeps height and foot over the edge. */
  private lay(edge: number, x: number, y: number, z: number, side: 1 | -1, out: number): void {
    const { places } = this.graph, { flat } = this;
    const l = 3 * this.left[edge], r = 3 * this.right[edge], at = 4 * edge;
    const ex = places[r] - places[l], ey = places[r + 1] - places[l + 1], ez = places[r + 2] - places[l + 2];
    const wx = x - places[l], wy = y - places[l + 1], wz = z - places[l + 2];
    const squared = ex * ex + ey * ey + ez * ez;
    const share = squared > 0 ? (wx * ex + wy * ey + wz * ez) / squared : 0;
    const hx = wx - share * ex, hy = wy - share * ey, hz = wz - share * ez;
    const up = squared > 0 ? side * Math.sqrt((hx * hx + hy * hy + hz * hz) / squared) : 0;
    const fx = flat[at + 2] - flat[at], fy = flat[at + 3] - flat[at + 1];
    const lx = flat[at], ly = flat[at + 1];
    flat[out] = lx + share * fx - up * fy;
    flat[out + 1] = ly + share * fy + up * fx;
  }
}

/** A place where the shortest path may bend: end `at` in `flat`, of an edge; −1 and the number of edges for the path's ends. */
interface Corner {
  at: number;
  edge: number;
}

/** Shortest path through the edges: the funnel of Lee and Preparata (1984), begun anew at each corner. */
function pulled_tight({ flat, count }: Unfolded): Corner[] {
  const corners: Corner[] = [{ at: 4 * count, edge: -1 }];
  for (let apex = corners[0]; apex.edge < count; apex = corners[corners.length - 1]) {
    const x = flat[apex.at], y = flat[apex.at + 1];
    // Above 0 where, seen from the apex, the second lies to the left of the first.
    const turn = (i: number, j: number): number => (flat[i] - x) * (flat[j + 1] - y) - (flat[j] - x) * (flat[i + 1] - y);
    let left: Corner | null = null, right: Corner | null = null, next: Corner | null = null;
    for (let edge = apex.edge + 1; edge <= count && next === null; ++edge) {
      const l = edge < count ? 4 * edge : 4 * count + 2, r = edge < count ? l + 2 : l;
      if (left === null || turn(left.at, l) <= 0) {
        if (right !== null && turn(right.at, l) < 0) next = right;
        else left = { at: l, edge };
      }
      if (next === null && (right === null || turn(right.at, r) >= 0)) {
        if (left !== null && turn(left.at, r) > 0) next = left;
        else right = { at: r, edge };
      }
    }
    corners.push(next ?? { at: 4 * count + 2, edge: count });
  }
  return corners;
}

/** Where the way from one corner to the next crosses the edges between them. */
function crossings(graph: SurfaceGraph, { flat, left, right }: Unfolded, from: Corner, to: Corner): Triple[] {
  const points: Triple[] = [];
  const wx = flat[to.at] - flat[from.at], wy = flat[to.at + 1] - flat[from.at + 1];
  for (let edge = from.edge + 1; edge < to.edge; ++edge) {
    const l = 4 * edge, r = l + 2;
    const rise = (flat[r] - flat[l]) * wy - (flat[r + 1] - flat[l + 1]) * wx;
    const share = ((flat[from.at] - flat[l]) * wy - (flat[from.at + 1] - flat[l + 1]) * wx) / rise;
    // Along an edge there is no crossing: its ends are corners, or before and behind.
    if (Number.isFinite(share)) points.push(between(graph.place(left[edge]), graph.place(right[edge]), Math.min(1, Math.max(0, share))));
  }
  return points;
}

function bend_at({ flat, left, right, count }: Unfolded, before: Corner, { at, edge }: Corner, after: Corner): Bend {
  const side = at === 4 * edge ? left : right;
  let first = edge, last = edge;
  while (first > 0 && side[first - 1] === side[edge]) --first;
  while (last + 1 < count && side[last + 1] === side[edge]) ++last;
  const ux = flat[at] - flat[before.at], uy = flat[at + 1] - flat[before.at + 1];
  const wx = flat[after.at] - flat[at], wy = flat[after.at + 1] - flat[at + 1];
  return { vertex: side[edge], first, last, turn: Math.abs(Math.atan2(ux * wy - uy * wx, ux * wx + uy * wy)) };
}

/** The shortest path from a point of the first face to one of the last that stays in the strip: a point on every edge. */
export function path_in_strip(graph: SurfaceGraph, strip: Strip, from: Triple, to: Triple): StripPath {
  if (strip.edges.length === 0) return { points: [from, to], length: Math.hypot(...minus(to, from)), bends: [] };
  const unfolded = new Unfolded(graph, strip.edges, from, to), { flat } = unfolded;
  const corners = pulled_tight(unfolded);
  const path: StripPath = { points: [from], length: 0, bends: [] };
  for (let i = 1; i < corners.length; ++i) {
    const before = corners[i - 1], corner = corners[i];
    path.length += Math.hypot(flat[corner.at] - flat[before.at], flat[corner.at + 1] - flat[before.at + 1]);
    path.points.push(...crossings(graph, unfolded, before, corner));
    if (i + 1 === corners.length) path.points.push(to);
    else {
      const bend = bend_at(unfolded, before, corner, corners[i + 1]);
      path.bends.push(bend);
      path.points.push(graph.place(bend.vertex));
    }
  }
  return path;
}
