import type { Triple } from "../scene/scene";
import { between, minus, type SurfaceGraph, type SurfacePoint } from "./surface_graph";
import { type Bend, path_in_strip, type Strip, type StripPath } from "./unfolded_strip";

/**
 * Locally shortest paths on a mesh, in two steps. A* over a few points of every edge finds a strip of faces that a nearly shortest path
 * takes. In the unfolded strip the shortest path is exact; where it bends at a vertex that it would be shorter to pass on the other side, the
 * strip is led round there, until none is left (Xin and Wang, "Efficiently determining a locally exact shortest path on polyhedral
 * surfaces", 2007). All faces of the model need not be visited, as windows of exact methods from all edges must.
 */

const points_per_edge = 2;
const flat_enough = 1e-9; // radians: bends below are rounding

const length_of = (a: Triple): number => Math.hypot(a[0], a[1], a[2]);

/** Numbers by priority, the least first: a binary heap. */
class Queue {
  private readonly keys: number[] = [];
  private readonly values: number[] = [];

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

/** The strip that a nearly shortest path takes; null where no faces join the two. */
function first_strip(graph: SurfaceGraph, from: SurfacePoint, to: SurfacePoint): Strip | null {
  if (from.face === to.face) return { faces: [from.face], edges: [] };
  const nodes = nodes_of(graph), count = nodes.length / 3;
  const cost = new Float64Array(count).fill(Infinity);
  const before = new Int32Array(count).fill(-1), through = new Int32Array(count).fill(-1), is_done = new Uint8Array(count);
  const queue = new Queue();
  const away = (node: number, [x, y, z]: Triple): number => {
    const dx = nodes[3 * node] - x, dy = nodes[3 * node + 1] - y, dz = nodes[3 * node + 2] - z;
    return Math.sqrt(dx * dx + dy * dy + dz * dz);
  };
  const reach = (face: number, at: Triple, so_far: number, node: number, entered: number): void => {
    for (let k = 3 * face; k < 3 * face + 3; ++k) {
      const edge = graph.edges_of[k];
      if (edge === entered) continue;
      for (let next = points_per_edge * edge; next < points_per_edge * (edge + 1); ++next) {
        if (is_done[next] === 1) continue;
        const total = so_far + away(next, at);
        if (total >= cost[next]) continue;
        cost[next] = total;
        before[next] = node;
        through[next] = face;
        queue.push(total + away(next, to.point), next);
      }
    }
  };
  reach(from.face, from.point, 0, -1, -1);
  for (let node = queue.pop(); node !== null; node = queue.pop()) {
    if (is_done[node] === 1) continue;
    is_done[node] = 1;
    const edge = Math.floor(node / points_per_edge);
    const at: Triple = [nodes[3 * node], nodes[3 * node + 1], nodes[3 * node + 2]];
    for (let i = graph.first_at[edge]; i < graph.first_at[edge + 1]; ++i) {
      const face = graph.faces_at[i];
      if (face === through[node]) continue;
      // Its place in the queue counted the rest as a straight line, which it is within the last face: none is shorter.
      if (face === to.face) return traced(node, to.face, before, through);
      reach(face, at, cost[node], node, edge);
    }
  }
  return null;
}

function traced(last: number, last_face: number, before: Int32Array, through: Int32Array): Strip {
  const strip: Strip = { faces: [last_face], edges: [] };
  for (let node = last; node >= 0; node = before[node]) {
    strip.edges.unshift(Math.floor(node / points_per_edge));
    strip.faces.unshift(through[node]);
  }
  return strip;
}

/** The strip led round the other side of a bend's vertex; null at a boundary, and where more than two faces meet. */
function led_round(graph: SurfaceGraph, strip: Strip, bend: Bend): Strip | null {
  const faces = strip.faces.slice(0, bend.first + 1), edges = strip.edges.slice(0, bend.first);
  const goal = strip.faces[bend.last + 1];
  let entered = strip.edges[bend.first];
  for (let face = faces[faces.length - 1]; face !== goal; face = faces[faces.length - 1]) {
    entered = graph.other_edge_at(face, bend.vertex, entered);
    const next = graph.across(entered, face);
    if (next === null || next === strip.faces[bend.first]) return null;
    faces.push(next);
    edges.push(entered);
  }
  return { faces: [...faces, ...strip.faces.slice(bend.last + 2)], edges: [...edges, ...strip.edges.slice(bend.last + 1)] };
}

/** Within a face the straight way is shorter than any round trip. */
function without_loops(strip: Strip): Strip {
  const last_at = new Map(strip.faces.map((face, i) => [face, i]));
  const short: Strip = { faces: [], edges: [] };
  for (let i = 0; i < strip.faces.length; ++i) {
    const at = last_at.get(strip.faces[i]) as number;
    short.faces.push(strip.faces[i]);
    if (at < strip.edges.length) short.edges.push(strip.edges[at]);
    i = at;
  }
  return short;
}

/** Consecutive points at one place as one; the ends stay. */
function without_repeats(points: Triple[], length: number): Triple[] {
  const least = 1e-9 * length;
  const last = points[points.length - 1];
  const kept = points.filter((point, i) => i === 0 || length_of(minus(point, points[i - 1])) > least);
  while (kept.length > 1 && length_of(minus(kept[kept.length - 1], last)) <= least) kept.pop();
  return [...kept, last];
}

/** All that can be led round at once; from the end, so that the places of earlier bends stay true. */
function all_led_round(graph: SurfaceGraph, strip: Strip, bends: Bend[]): Strip {
  let changed = strip, limit = strip.edges.length;
  for (const bend of [...bends].reverse()) {
    const next = bend.last < limit ? led_round(graph, changed, bend) : null;
    if (next !== null) [changed, limit] = [next, bend.first];
  }
  return without_loops(changed);
}

/** A locally shortest path: a point on every edge that it crosses, so that it lies on the surface. Null between separate pieces. */
export function geodesic(graph: SurfaceGraph, from: SurfacePoint, to: SurfacePoint): Triple[] | null {
  let strip = first_strip(graph, from, to);
  if (strip === null) return null;
  let path: StripPath = path_in_strip(graph, strip, from.point, to.point);
  const kept = new Set<number>(); // vertices at which another side was found no better
  const shorten = (bends: Bend[]): boolean => {
    const other = all_led_round(graph, strip as Strip, bends);
    const tried = path_in_strip(graph, other, from.point, to.point);
    if (!(tried.length < path.length * (1 - 1e-12))) return false;
    [strip, path] = [other, tried];
    kept.clear();
    return true;
  };
  for (;;) {
    // A path may bend only where both sides have π or more: what the other side lacks of that is to be gained.
    const bends = path.bends.filter((bend) => !kept.has(bend.vertex) && 2 * Math.PI + bend.turn - graph.angle_at[bend.vertex] > flat_enough);
    if (bends.length === 0) return without_repeats(path.points, path.length);
    if (!shorten(bends) && !shorten(bends.slice(0, 1))) kept.add(bends[0].vertex);
  }
}
