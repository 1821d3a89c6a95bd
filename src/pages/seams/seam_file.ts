import { edge_path } from "../maths/edge_paths";
import type { SurfaceGraph } from "../maths/surface_graph";
import { type EdgePoint, type NamedVertex, type PickedSeam, type SeamRoutes, type SeamWork } from "./seam_work";

/** Numbers of the vertices in the file, from 1, and back. */
export interface VertexNumbers {
  count: number;
  of_file(number: number): number;
}

type Entry = Record<string, unknown>;

function entries(document: Entry, key: string): Entry[] {
  const value = document[key] ?? [];
  if (!Array.isArray(value) || !value.every((each) => typeof each === "object" && each !== null)) throw new Error(`"${key}" is not a list of objects`);
  return value as Entry[];
}

/** What `flatten --seams` reads. Ways of a file stay as they are. */
export function parse_seams(document: unknown, numbers: VertexNumbers, graph: SurfaceGraph): SeamWork {
  if (typeof document !== "object" || document === null || !("seams" in document)) throw new Error('the key "seams" is missing');
  const vertex = (value: unknown, where: string): number => {
    if (!Number.isInteger(value) || (value as number) < 1 || (value as number) > numbers.count) throw new Error(`${where}: ${JSON.stringify(value)} is no vertex of 1 … ${numbers.count}`);
    return numbers.of_file(value as number);
  };
  const point = (value: unknown, where: string): EdgePoint => {
    if (!Array.isArray(value)) return vertex(value, where);
    if (value.length !== 3 || typeof value[2] !== "number") throw new Error(`${where}: a point of a line is a vertex, or two and a share`);
    return [vertex(value[0], where), vertex(value[1], where), value[2]];
  };
  const list = (value: unknown, where: string): unknown[] => {
    if (!Array.isArray(value) || value.length === 0) throw new Error(`${where} is no list that holds something`);
    return value;
  };
  const seams = entries(document as Entry, "seams").flatMap((seam, i): PickedSeam[] => {
    const where = `seam ${i + 1}`, common = { name: String(seam.name ?? ""), ease: typeof seam.ease === "number" ? seam.ease : null, longer: String(seam.longer ?? "") };
    if ("line" in seam) return [{ ...common, kind: "line", vertices: [], fixed: list(seam.line, where).map((each) => point(each, where)) }];
    if ("path" in seam) return [{ ...common, kind: "edges", vertices: [], fixed: whole_path(list(seam.path, where).map((each) => vertex(each, where)), graph, where) }];
    const edges = list(seam.edges, where).map((each) => list(each, where).map((end) => vertex(end, where)));
    return chains(edges).map((fixed) => ({ ...common, kind: "edges", vertices: [], fixed }));
  });
  const named = (key: string): NamedVertex[] => entries(document as Entry, key).map((each, i) => ({ name: String(each.name ?? ""), vertex: vertex(each.vertex, `"${key}" ${i + 1}`) }));
  return { seams, pieces: named("pieces"), widths: named("widths") };
}

function whole_path(vertices: number[], graph: SurfaceGraph, where: string): number[] {
  const way = vertices.slice(0, 1);
  for (let i = 1; i < vertices.length; ++i) {
    const part = edge_path(graph, vertices[i - 1], vertices[i]);
    if (part === null) throw new Error(`${where}: no way over edges leads from its point ${i} to the next`);
    way.push(...part.slice(1));
  }
  return way;
}

/** Edges one behind the other, where they are. */
function chains(edges: number[][]): number[][] {
  const ways: number[][] = [];
  for (const [a, b] of edges) {
    const last = ways[ways.length - 1];
    if (last !== undefined && last[last.length - 1] === a) last.push(b);
    else ways.push([a, b]);
  }
  return ways;
}

/** Seams of one vertex are left out. */
export function seams_json(work: SeamWork, routes: SeamRoutes): string {
  const number = (point: EdgePoint): unknown => (typeof point === "number" ? point + 1 : [point[0] + 1, point[1] + 1, point[2]]);
  const seams = work.seams.flatMap((seam) => {
    const way = routes.way(seam);
    if (way === null || way.length < 2) return [];
    const points = way.map(number);
    return [{
      ...(seam.name === "" ? {} : { name: seam.name }),
      ...(seam.kind === "edges" ? { edges: points.slice(1).map((point, i) => [points[i], point]) } : { line: points }),
      ...(seam.ease === null || seam.longer === "" ? {} : { ease: seam.ease, longer: seam.longer }),
    }];
  });
  const lines = (all: object[]): string => `[\n${all.map((each) => `  ${JSON.stringify(each)}`).join(",\n")}\n]`;
  const named = (all: NamedVertex[]): object[] => all.map(({ name, vertex }) => ({ name, vertex: vertex + 1 }));
  return `{"seams": ${lines(seams)},\n"pieces": ${lines(named(work.pieces))},\n"widths": ${lines(named(work.widths))}}\n`;
}
