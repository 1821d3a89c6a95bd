import { edge_path } from "../maths/edge_paths";
import { geodesic } from "../maths/geodesic";
import { between, dot, minus, type SurfaceGraph } from "../maths/surface_graph";
import type { Triple } from "../scene/scene";

/** A vertex, or two of them and the share of the way between. */
export type EdgePoint = number | [number, number, number];

/** A seam as it is being picked: vertices that were clicked, or the ways of a file, which stay as they are. */
export interface PickedSeam {
  name: string;
  /** Along edges from vertex to vertex, or straight over the faces. */
  kind: "edges" | "line";
  vertices: number[];
  /** Of a file: all points of each way; several only along edges, where these branch or lie apart. */
  fixed_ways: EdgePoint[][] | null;
  /** Millimetres that the side of the piece `longer` is longer by. */
  ease: number | null;
  longer: string;
}

export interface NamedVertex {
  name: string;
  vertex: number;
}

export interface SeamWork {
  seams: PickedSeam[];
  pieces: NamedVertex[];
  widths: NamedVertex[];
}

export function copy_of({ seams, pieces, widths }: SeamWork): SeamWork {
  return { seams: seams.map((seam) => ({ ...seam })), pieces: pieces.map((piece) => ({ ...piece })), widths: widths.map((width) => ({ ...width })) };
}

export function new_seam(name: string, kind: PickedSeam["kind"], vertices: number[]): PickedSeam {
  return { name, kind, vertices, fixed_ways: null, ease: null, longer: "" };
}

/** Of an edge: a way that passes a vertex nearer than this goes through it, so that no faces become slivers. */
const near_vertex = 0.02;

export class SeamRoutes {
  private readonly known = new WeakMap<number[], Map<string, EdgePoint[][] | null>>();

  constructor(readonly graph: SurfaceGraph) {}

  /** All points of a seam: of one that was clicked a single way; null where no way joins two of its vertices. */
  ways(seam: PickedSeam): EdgePoint[][] | null {
    if (seam.fixed_ways !== null) return seam.fixed_ways;
    const of_kind = this.known.get(seam.vertices) ?? new Map<string, EdgePoint[][] | null>();
    this.known.set(seam.vertices, of_kind);
    let ways = of_kind.get(seam.kind);
    if (ways === undefined) of_kind.set(seam.kind, (ways = this.found(seam)));
    return ways;
  }

  place(point: EdgePoint): Triple {
    return typeof point === "number" ? this.graph.place(point) : between(this.graph.place(point[0]), this.graph.place(point[1]), point[2]);
  }

  lines(seam: PickedSeam): Triple[][] {
    return (this.ways(seam) ?? []).map((way) => way.map((point) => this.place(point)));
  }

  length(seam: PickedSeam): number {
    const lengths = this.lines(seam).flatMap((line) => line.slice(1).map((point, i) => Math.hypot(...minus(point, line[i]))));
    return lengths.reduce((sum, length) => sum + length, 0);
  }

  private found(seam: PickedSeam): EdgePoint[][] | null {
    const way: EdgePoint[] = seam.vertices.slice(0, 1);
    for (let i = 1; i < seam.vertices.length; ++i) {
      const from = seam.vertices[i - 1], to = seam.vertices[i];
      const part = seam.kind === "edges" ? edge_path(this.graph, from, to) : this.straight(from, to);
      if (part === null) return null;
      way.push(...part.slice(1));
    }
    return [way];
  }

  private straight(from: number, to: number): EdgePoint[] | null {
    const at = (vertex: number) => this.graph.nearest(this.graph.place(vertex));
    const points = geodesic(this.graph, at(from), at(to));
    if (points === null) return null;
    const way: EdgePoint[] = [from];
    for (const point of [...points.slice(1, -1).map((inner) => this.edge_point(inner)), to])
      if (String(way[way.length - 1]) !== String(point)) way.push(point);
    return way;
  }

  /** The point of an edge that lies there. */
  private edge_point(point: Triple): EdgePoint {
    const { face } = this.graph.nearest(point);
    let best: EdgePoint = 0, least = Infinity;
    for (const edge of this.graph.edges_at(face)) {
      const u = this.graph.ends[2 * edge], w = this.graph.ends[2 * edge + 1], a = this.graph.place(u), way = minus(this.graph.place(w), a);
      const share = Math.min(1, Math.max(0, dot(minus(point, a), way) / dot(way, way)));
      const away = minus(point, between(a, this.graph.place(w), share));
      if (dot(away, away) >= least) continue;
      least = dot(away, away);
      best = share < near_vertex ? u : share > 1 - near_vertex ? w : [u, w, Math.round(1e6 * share) / 1e6];
    }
    return best;
  }
}
