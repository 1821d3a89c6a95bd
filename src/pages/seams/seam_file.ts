import { edge_path } from "../maths/edge_paths";
import type { SurfaceGraph } from "../maths/surface_graph";
import { type EdgePoint, type NamedVertex, type PickedSeam, type SeamRoutes, type SeamWork } from "./seam_work";

/** Numbers of the vertices in the file, from 1, and back. */
export interface VertexNumbers {
  count: number;
  of_file(number: number): number;
}

type Entry = Record<string, unknown>;
type Ease = Pick<PickedSeam, "ease" | "longer">;
const shapes = ["edges", "path", "line"] as const;

/** What `flatten --seams` reads; refuses what it refuses (src/bespoke/pattern/seam_file.cpp). Ways of a file stay as they are. */
export function parse_seams(document: unknown, numbers: VertexNumbers, graph: SurfaceGraph): SeamWork {
  return new SeamReader(numbers, graph).run(document);
}

class SeamReader {
  constructor(private readonly numbers: VertexNumbers, private readonly graph: SurfaceGraph) {}

  run(document: unknown): SeamWork {
    if (!is_entry(document) || !("seams" in document)) throw new Error('the key "seams" is missing');
    require_keys(document, ["seams", "pieces", "widths"], "the file");
    const seams = list(document, "seams").map((seam, i) => this.seam(seam, `seam ${i + 1}`));
    return { seams, pieces: this.named(document, "pieces", "piece"), widths: this.named(document, "widths", "width") };
  }

  private seam(seam: unknown, where: string): PickedSeam {
    if (!is_entry(seam)) throw new Error(`${where} must be an object with "edges", "path" or "line"`);
    require_keys(seam, [...shapes, "name", "ease", "longer"], where);
    const [shape, second] = shapes.filter((each) => each in seam);
    if (shape === undefined || second !== undefined) throw new Error(`${where} needs one of "edges", "path" and "line"`);
    const points = seam[shape];
    if (!Array.isArray(points) || points.length === 0) throw new Error(`${where}: "${shape}" must be a list that is not empty`);
    if (shape !== "edges" && points.length < 2) throw new Error(`${where}: a ${shape} has two vertices or more`);
    const kind = shape === "line" ? "line" : "edges";
    return { name: String(seam.name ?? ""), kind, vertices: [], fixed_ways: this.ways(shape, points, where), ...ease_of(seam, where) };
  }

  private ways(shape: (typeof shapes)[number], points: unknown[], where: string): EdgePoint[][] {
    if (shape === "line") return [points.map((each) => this.point(each, where))];
    if (shape === "edges") return ways_along(points.map((each) => this.edge(each, where)));
    return [whole_path(points.map((each) => this.vertex(each, where)), this.graph, where)];
  }

  private vertex(value: unknown, where: string): number {
    const { count } = this.numbers;
    if (!Number.isInteger(value) || (value as number) < 1 || (value as number) > count) throw new Error(`${where}: ${JSON.stringify(value)} is no vertex of 1 … ${count}`);
    return this.numbers.of_file(value as number);
  }

  private edge(value: unknown, where: string): [number, number] {
    if (!Array.isArray(value) || value.length !== 2) throw new Error(`${where}: ${JSON.stringify(value)} is no edge, which is a pair of vertices`);
    return [this.vertex(value[0], where), this.vertex(value[1], where)];
  }

  private point(value: unknown, where: string): EdgePoint {
    if (!Array.isArray(value)) return this.vertex(value, where);
    const [a, b, share] = value as unknown[];
    if (value.length !== 3 || typeof share !== "number") throw new Error(`${where}: a point of a line is a vertex, or two and a share`);
    if (!(share >= 0 && share <= 1)) throw new Error(`${where}: share ${share} is not in 0 … 1`);
    return [this.vertex(a, where), this.vertex(b, where), share];
  }

  private named(document: Entry, key: string, one: string): NamedVertex[] {
    if (!(key in document)) return [];
    return list(document, key).map((each, i) => {
      const where = `${one} ${i + 1}`;
      if (!is_entry(each) || typeof each.name !== "string" || !("vertex" in each)) throw new Error(`${where} needs a "name" and a "vertex"`);
      require_keys(each, ["name", "vertex"], where);
      return { name: each.name, vertex: this.vertex(each.vertex, where) };
    });
  }
}

function is_entry(value: unknown): value is Entry {
  return typeof value === "object" && value !== null && !Array.isArray(value);
}

function require_keys(entry: Entry, known: string[], where: string): void {
  const strange = Object.keys(entry).find((key) => !known.includes(key));
  if (strange !== undefined) throw new Error(`${where} has the key ${JSON.stringify(strange)}, which means nothing here`);
}

function list(document: Entry, key: string): unknown[] {
  const value = document[key];
  if (!Array.isArray(value)) throw new Error(`"${key}" must be a list`);
  return value;
}

function ease_of(seam: Entry, where: string): Ease {
  if ("ease" in seam !== "longer" in seam) throw new Error(`${where} needs "ease" and "longer" both, or neither`);
  if (!("ease" in seam)) return { ease: null, longer: "" };
  if (typeof seam.ease !== "number" || !(seam.ease >= 0 && seam.ease < Infinity)) throw new Error(`${where}: "ease" must be millimetres, 0 or more`);
  if (typeof seam.longer !== "string") throw new Error(`${where}: "longer" must name a piece`);
  return { ease: seam.ease, longer: seam.longer };
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

/** A way goes on while each edge begins where the last one ended: the ways hold the same edges in the same order. */
function ways_along(edges: [number, number][]): number[][] {
  const ways: number[][] = [];
  for (const [a, b] of edges) {
    const last = ways[ways.length - 1];
    if (last !== undefined && last[last.length - 1] === a) last.push(b);
    else ways.push([a, b]);
  }
  return ways;
}

/** What this page, or an older one, kept in the browser: in the older a seam of a file is one way, `fixed`. */
export function parse_kept(text: string): SeamWork {
  const work = JSON.parse(text) as SeamWork;
  const current = ({ fixed = null, ...seam }: PickedSeam & { fixed?: EdgePoint[] | null }): PickedSeam => ({ ...seam, fixed_ways: seam.fixed_ways ?? (fixed === null ? null : [fixed]) });
  return { ...work, seams: work.seams.map(current) };
}

/** Seams of one vertex are left out. Throws for an ease without a longer side and the reverse, which `flatten` refuses. */
export function seams_json(work: SeamWork, routes: SeamRoutes): string {
  const seams = work.seams.flatMap((seam, i) => {
    const ways = routes.ways(seam);
    if (ways === null || ways.flat().length < 2) return [];
    return [{ ...(seam.name === "" ? {} : { name: seam.name }), ...ways_json(seam.kind, ways), ...ease_json(seam, `seam ${i + 1}`) }];
  });
  const lines = (all: object[]): string => `[\n${all.map((each) => `  ${JSON.stringify(each)}`).join(",\n")}\n]`;
  const named = (all: NamedVertex[]): object[] => all.map(({ name, vertex }) => ({ name, vertex: vertex + 1 }));
  return `{"seams": ${lines(seams)},\n"pieces": ${lines(named(work.pieces))},\n"widths": ${lines(named(work.widths))}}\n`;
}

function ways_json(kind: PickedSeam["kind"], ways: EdgePoint[][]): object {
  const numbered = ways.map((way) => way.map((point) => (typeof point === "number" ? point + 1 : [point[0] + 1, point[1] + 1, point[2]])));
  return kind === "line" ? { line: numbered.flat() } : { edges: numbered.flatMap((way) => way.slice(1).map((point, i) => [way[i], point])) };
}

function ease_json({ name, ease, longer }: PickedSeam, number: string): Partial<Ease> {
  const where = name === "" ? number : `${number} (“${name}”)`;
  if (ease !== null && longer === "") throw new Error(`${where} has an ease, but "longer" names no piece`);
  if (ease === null && longer !== "") throw new Error(`${where} has a longer side, but no ease`);
  return ease === null ? {} : { ease, longer };
}
