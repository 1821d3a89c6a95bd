import { Queue } from "./strip_search";
import { minus, type SurfaceGraph } from "./surface_graph";

/** The vertices of the shortest way along edges, both ends included; null between separate pieces (Dijkstra 1959). */
export function edge_path(graph: SurfaceGraph, from: number, to: number): number[] | null {
  const edges = edges_of_vertices(graph);
  const distance = new Map([[from, 0]]), before = new Map<number, number>();
  const queue = new Queue();
  queue.push(0, from);
  const done = new Set<number>();
  for (let at = queue.pop(); at !== null; at = queue.pop()) {
    if (at === to) break;
    if (done.has(at)) continue;
    done.add(at);
    for (const edge of edges.get(at) ?? []) {
      const other = graph.ends[2 * edge] === at ? graph.ends[2 * edge + 1] : graph.ends[2 * edge];
      const length = (distance.get(at) as number) + Math.hypot(...minus(graph.place(at), graph.place(other)));
      if (length >= (distance.get(other) ?? Infinity)) continue;
      distance.set(other, length);
      before.set(other, at);
      queue.push(length, other);
    }
  }
  if (!distance.has(to)) return null;
  const path = [to];
  while (path[0] !== from) path.unshift(before.get(path[0]) as number);
  return path;
}

/** The vertices at edges of one face. */
export function border_vertices(graph: SurfaceGraph): Set<number> {
  const border = new Set<number>();
  for (let edge = 0; edge < graph.edge_count; ++edge)
    if (graph.faces_of(edge).length === 1) border.add(graph.ends[2 * edge]).add(graph.ends[2 * edge + 1]);
  return border;
}

const known = new WeakMap<SurfaceGraph, Map<number, number[]>>();

function edges_of_vertices(graph: SurfaceGraph): Map<number, number[]> {
  const made = known.get(graph) ?? new Map<number, number[]>();
  if (made.size === 0)
    for (let k = 0; k < graph.ends.length; ++k) {
      const all = made.get(graph.ends[k]);
      if (all === undefined) made.set(graph.ends[k], [k >> 1]);
      else all.push(k >> 1);
    }
  known.set(graph, made);
  return made;
}
