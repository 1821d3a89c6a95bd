import type { Triple } from "../scene/scene";
import { between, type SurfaceGraph, type SurfacePoint } from "./surface_graph";
import type { Strip } from "./unfolded_strip";

const points_per_edge = 2;

/** Numbers by priority, the least first: a binary heap. */
export class Queue {
  private readonly keys: number[] = [];
  private readonly values: number[] = [];

  /** The least priority; infinite where there is nothing. */
  get least(): number {
    return this.keys.length > 0 ? this.keys[0] : Infinity;
  }

  push(key: number, value: number): void {
    const { keys, values } = this;
    let at = keys.length;
    for (let above = (at - 1) >> 1; at > 0 && keys[above] > key; at = above, above = (at - 1) >> 1) {
      keys[at] = keys[above];
      values[at] = values[above];
    }
    keys[at] = key;
    values[at] = value;
  }

  pop(): number | null {
    const { keys, values } = this;
    const count = keys.length - 1;
    if (count < 0) return null;
    const first = values[0], key = keys.pop() as number, value = values.pop() as number;
    let at = 0;
    for (let below = 1; below < count; at = below, below = 2 * at + 1) {
      if (below + 1 < count && keys[below + 1] < keys[below]) ++below;
      if (keys[below] >= key) break;
      keys[at] = keys[below];
      values[at] = values[below];
    }
    if (count > 0) [keys[at], values[at]] = [key, value];
    return first;
  }
}

/** Points on all edges, at equal shares: x, y, z of one after the other. Made once for a surface. */
const nodes_of_graphs = new WeakMap<SurfaceGraph, Float64Array>();

function nodes_of(graph: SurfaceGraph): Float64Array {
  const known = nodes_of_graphs.get(graph);
  if (known !== undefined) return known;
  const nodes = new Float64Array(3 * points_per_edge * graph.edge_count);
  for (let node = 0; 3 * node < nodes.length; ++node) {
    const edge = Math.floor(node / points_per_edge), share = ((node % points_per_edge) + 1) / (points_per_edge + 1);
    nodes.set(between(graph.place(graph.ends[2 * edge]), graph.place(graph.ends[2 * edge + 1]), share), 3 * node);
  }
  nodes_of_graphs.set(graph, nodes);
  return nodes;
}

/**
 * Strips of faces that nearly shortest paths from one point take: the shortest over a few points of every edge. Towards a single point A* looks
 * at little else; without such a goal, Dijkstra's search goes as far out as a strip requires, and on from there for the next one.
 */
export class StripSearch {
  private readonly nodes: Float64Array;
  private readonly cost: Float64Array;
  private readonly before: Int32Array;
  private readonly through: Int32Array;
  private readonly is_done: Uint8Array;
  private readonly queue = new Queue();

  constructor(private readonly graph: SurfaceGraph, readonly from: SurfacePoint, private readonly goal: Triple | null = null) {
    this.nodes = nodes_of(graph);
    const count = this.nodes.length / 3;
    this.cost = new Float64Array(count).fill(Infinity);
    this.before = new Int32Array(count).fill(-1);
    this.through = new Int32Array(count).fill(-1);
    this.is_done = new Uint8Array(count);
    this.reach(from.face, from.point, 0, -1, -1);
  }

  /** Null where no faces join the two. */
  strip_to(to: SurfacePoint): Strip | null {
    if (to.face === this.from.face) return { faces: [to.face], edges: [] };
    const { graph, queue } = this;
    let best = -1, least = Infinity;
    const consider = (node: number): void => {
      if (this.is_done[node] === 0 || this.through[node] === to.face) return;
      const total = this.cost[node] + this.away(node, to.point);
      if (total < least) [best, least] = [node, total];
    };
    const entries = Array.from(graph.edges_at(to.face), (edge) => Array.from({ length: points_per_edge }, (_, i) => points_per_edge * edge + i)).flat();
    entries.forEach(consider);
    while (queue.least < least) {
      const node = queue.pop() as number;
      if (this.is_done[node] === 1) continue;
      this.settle(node);
      if (entries.includes(node)) consider(node);
    }
    return best < 0 ? null : this.traced(best, to.face);
  }

  private settle(node: number): void {
    const { graph, nodes } = this;
    this.is_done[node] = 1;
    const edge = Math.floor(node / points_per_edge);
    const at: Triple = [nodes[3 * node], nodes[3 * node + 1], nodes[3 * node + 2]];
    for (let i = graph.first_at[edge]; i < graph.first_at[edge + 1]; ++i)
      if (graph.faces_at[i] !== this.through[node]) this.reach(graph.faces_at[i], at, this.cost[node], node, edge);
  }

  private reach(face: number, at: Triple, so_far: number, node: number, entered: number): void {
    for (let k = 3 * face; k < 3 * face + 3; ++k) {
      const edge = this.graph.edges_of[k];
      if (edge === entered) continue;
      for (let next = points_per_edge * edge; next < points_per_edge * (edge + 1); ++next) {
        if (this.is_done[next] === 1) continue;
        const total = so_far + this.away(next, at);
        if (total >= this.cost[next]) continue;
        this.cost[next] = total;
        this.before[next] = node;
        this.through[next] = face;
        // What is left is counted as a straight line, which it is within the last face: none is shorter.
        this.queue.push(this.goal === null ? total : total + this.away(next, this.goal), next);
      }
    }
  }

  private away(node: number, point: Triple): number {
    const { nodes } = this;
    const dx = nodes[3 * node] - point[0], dy = nodes[3 * node + 1] - point[1], dz = nodes[3 * node + 2] - point[2];
    return Math.sqrt(dx * dx + dy * dy + dz * dz);
  }

  private traced(last: number, last_face: number): Strip {
    const strip: Strip = { faces: [last_face], edges: [] };
    for (let node = last; node >= 0; node = this.before[node]) {
      strip.edges.push(Math.floor(node / points_per_edge));
      strip.faces.push(this.through[node]);
    }
    return { faces: strip.faces.reverse(), edges: strip.edges.reverse() };
  }
}
