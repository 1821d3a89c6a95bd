import { distance } from "./warp";
import type { Triple } from "../scene/scene";
import { between, type SurfaceGraph, type SurfacePoint } from "./surface_graph";

/** What a closed line on a surface encloses: of its two sides, on the connected piece that it runs on, the one with less area. */
export interface EnclosedFaces {
  /** By their numbers, rising; none where there is trouble. */
  inside: Uint32Array;
  /** Those that the line runs through; some are inside, some are not. */
  crossed: Set<number>;
  /** Area inside, of that of the piece. */
  share: number;
  /** Why fit refuses the line. */
  trouble: string | null;
}

/** All by the rules of `bespoke fit` (anchors/detail/enclosed_faces.cpp), lengths in parts of the diagonal. */
const farthest = 0.02, nearest = 1e-6, detour = 0.05;
const clearly_smaller = 0.45; // of the area of both sides

class Trouble extends Error {}

/** Projects a line onto a surface, face by face, and notes which edges it crosses an odd number of times. */
class SurfaceWalk {
  readonly is_odd: Uint8Array;
  readonly faces: number[] = [];
  private readonly size: number;

  constructor(private readonly graph: SurfaceGraph) {
    this.is_odd = new Uint8Array(graph.edge_count);
    this.size = graph.diagonal;
  }

  around(border: Triple[]): void {
    const places = border.map((point) => this.place(point));
    places.forEach((here, i) => this.go(here, places[(i + 1) % places.length]));
  }

  private place(point: Triple): SurfacePoint {
    const foot = this.graph.nearest(point);
    if (!(distance(foot.point, point) <= farthest * this.size)) throw new Trouble("the border leaves the surface; give it more points");
    this.faces.push(foot.face);
    return { point, face: foot.face };
  }

  /** Halves the way until neighbouring points are on one face or on two with a common edge. */
  private go(from: SurfacePoint, to: SurfacePoint): void {
    if (from.face === to.face) return;
    const common = this.graph.edges_at(from.face).find((edge) => this.graph.faces_of(edge).includes(to.face));
    if (common !== undefined) return this.cross(common);
    if (!(distance(from.point, to.point) > nearest * this.size)) return this.go_around(from, to);
    const middle = this.place(between(from.point, to.point, 0.5));
    this.go(from, middle);
    this.go(middle, to);
  }

  /** The way over the fewest edges: around a corner, or through a groove that the line spans. */
  private go_around(from: SurfacePoint, to: SurfacePoint): void {
    const came = new Map<number, { face: number; edge: number }>([[from.face, { face: -1, edge: -1 }]]);
    const reached = [from.face];
    for (let next = 0; next < reached.length && !came.has(to.face); ++next)
      for (const edge of this.graph.edges_at(reached[next]))
        for (const face of this.graph.faces_of(edge)) {
          if (came.has(face) || !this.is_near(face, to.point)) continue;
          came.set(face, { face: reached[next], edge });
          reached.push(face);
        }
    if (!came.has(to.face)) throw new Trouble("the border jumps to a part of the surface that is not connected there; give it more points");
    for (let face = to.face; face !== from.face; ) {
      const step = came.get(face) as { face: number; edge: number };
      this.cross(step.edge);
      this.faces.push(face);
      face = step.face;
    }
  }

  private cross(edge: number): void {
    this.is_odd[edge] ^= 1;
  }

  private is_near(face: number, point: Triple): boolean {
    return [0, 1, 2].some((k) => distance(this.graph.corner(face, k), point) <= detour * this.size);
  }
}

const unknown = 2;

/** The side of every vertex of the piece that the line runs on, 0 or 1: the ends of an edge that it crosses lie on different ones. */
function sides_of_vertices(graph: SurfaceGraph, walk: SurfaceWalk): Uint8Array {
  const { faces, edges_of, first_at, faces_at } = graph;
  const sides = new Uint8Array(graph.places.length / 3).fill(unknown), is_seen = new Uint8Array(faces.length / 3);
  const open = [walk.faces[0]];
  sides[faces[3 * open[0]]] = 0;
  is_seen[open[0]] = 1;
  for (let face = open.pop(); face !== undefined; face = open.pop()) {
    // Three corners in turn, twice: the first that is known may be the last.
    for (let step = 0; step < 6; ++step) {
      const k = 3 * face + (step % 3), to = faces[3 * face + ((step + 1) % 3)];
      if (sides[faces[k]] === unknown) continue;
      const side = sides[faces[k]] ^ walk.is_odd[edges_of[k]];
      if (sides[to] === unknown) sides[to] = side;
      if (sides[to] !== side) throw new Trouble("the border does not separate an inside from an outside; let it go round the patch once");
    }
    for (let k = 3 * face; k < 3 * face + 3; ++k)
      for (let i = first_at[edges_of[k]]; i < first_at[edges_of[k] + 1]; ++i) {
        if (is_seen[faces_at[i]] === 1) continue;
        is_seen[faces_at[i]] = 1;
        open.push(faces_at[i]);
      }
  }
  return sides;
}

function smaller_side(graph: SurfaceGraph, walk: SurfaceWalk): EnclosedFaces {
  const { faces, face_areas } = graph, sides = sides_of_vertices(graph, walk);
  const parts: [number[], number[]] = [[], []], areas: [number, number] = [0, 0];
  for (let face = 0; 3 * face < faces.length; ++face) {
    if (sides[faces[3 * face]] === unknown) continue; // then the other corners are
    const own = sides[faces[3 * face]] + sides[faces[3 * face + 1]] + sides[faces[3 * face + 2]] >= 2 ? 1 : 0;
    parts[own].push(face);
    areas[own] += face_areas[face];
  }
  const smaller = areas[0] < areas[1] ? 0 : 1, share = areas[smaller] / (areas[0] + areas[1]);
  if (parts[smaller].length === 0) throw new Trouble("the border encloses no face; it is smaller than the triangles there");
  if (!(share <= clearly_smaller)) throw new Trouble("the border cuts the surface in two about equal parts, and the smaller one is taken for its inside");
  return { inside: Uint32Array.from(parts[smaller]), crossed: new Set(walk.faces), share, trouble: null };
}

/** border: a closed line on the surface or near it, without a repeat of its first point. */
export function enclosed_faces(graph: SurfaceGraph, border: Triple[]): EnclosedFaces {
  const walk = new SurfaceWalk(graph);
  try {
    walk.around(border);
    return smaller_side(graph, walk);
  } catch (error) {
    if (!(error instanceof Trouble)) throw error;
    return { inside: new Uint32Array(), crossed: new Set(walk.faces), share: 0, trouble: error.message };
  }
}
