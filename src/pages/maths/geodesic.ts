import type { Triple } from "../scene/scene";
import { StripSearch } from "./strip_search";
import { minus, type SurfaceGraph, type SurfacePoint } from "./surface_graph";
import { type Bend, path_in_strip, type Strip, type StripPath } from "./unfolded_strip";

/**
 * Locally shortest paths on a mesh, in two steps. A search over a few points of every edge finds a strip of faces that a nearly shortest
 * path takes (strip_search.ts). In the unfolded strip the shortest path is exact; where it bends at a vertex that it would be shorter to pass on the other side, the
 * strip is led round there, until none is left (Xin and Wang, "Efficiently determining a locally exact shortest path on polyhedral
 * surfaces", 2007). All faces of the model need not be visited, as windows of exact methods from all edges must.
 */

const flat_enough = 1e-9; // radians: bends below are rounding

const length_of = (a: Triple): number => Math.hypot(a[0], a[1], a[2]);

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

/**
 * A locally shortest path: a point on every edge that it crosses, so that it lies on the surface. Null between separate pieces. A search from
 * the same point, without a goal, serves for many paths.
 */
export function geodesic(graph: SurfaceGraph, from: SurfacePoint, to: SurfacePoint, search = new StripSearch(graph, from, to.point)): Triple[] | null {
  let strip = search.strip_to(to);
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
