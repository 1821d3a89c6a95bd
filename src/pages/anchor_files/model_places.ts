import { dot, minus, SurfaceGraph } from "../maths/surface_graph";
import type { CompletePair } from "../pick/history";
import { model_of, type Side } from "../pick/curves";
import type { Triple } from "../scene/scene";
import { is_finite, numbered_lines, parsed_json, words_of } from "./file_text";
import type { NamedPoint } from "./side";

/** A model's own vertices and triangles, in their order and to the last bit. */
export class ExactModel {
  private graph: SurfaceGraph | null = null;

  /** vertices: x, y, z of one after the other. */
  constructor(readonly vertices: Float64Array, readonly faces: Uint32Array) {}

  get vertex_count(): number {
    return this.vertices.length / 3;
  }
  get face_count(): number {
    return this.faces.length / 3;
  }

  vertex(number: number): Triple {
    return [this.vertices[3 * number], this.vertices[3 * number + 1], this.vertices[3 * number + 2]];
  }

  corner(face: number, k: number): Triple {
    return this.vertex(this.faces[3 * face + k]);
  }

  nearest_vertex(point: Triple): number {
    let best = 0, least = Infinity;
    for (let i = 0; i < this.vertex_count; ++i) {
      const away = minus(this.vertex(i), point), squared = dot(away, away);
      if (squared < least) [best, least] = [i, squared];
    }
    return best;
  }

  /** [triangle, u, v] of the nearest place of the surface. */
  nearest_place(point: Triple): [number, number, number] {
    this.graph ??= new SurfaceGraph(this.vertices, this.faces);
    const near = this.graph.nearest(point);
    const a = this.corner(near.face, 0), b = minus(this.corner(near.face, 1), a), c = minus(this.corner(near.face, 2), a), x = minus(near.point, a);
    const bb = dot(b, b), cc = dot(c, c), bc = dot(b, c), determinant = bb * cc - bc * bc;
    // A triangle without area is as good as its longer edge.
    if (!(determinant > 0)) return bb >= cc ? [near.face, bb > 0 ? dot(b, x) / bb : 0, 0] : [near.face, 0, dot(c, x) / cc];
    return [near.face, (cc * dot(b, x) - bc * dot(c, x)) / determinant, (bb * dot(c, x) - bc * dot(b, x)) / determinant];
  }
}

// ---- [triangle, u, v] lists

function point_of(entry: unknown, model: ExactModel, where: string): Triple {
  if (!Array.isArray(entry) || entry.length < 3 || !entry.every(is_finite) || !Number.isInteger(entry[0])) throw new Error(`${where} is not [triangle, u, v]`);
  const [face, u, v] = entry as number[];
  if (face < 0 || face >= model.face_count) throw new Error(`${where}: triangle ${face} of ${model.face_count}`);
  const corners = [0, 1, 2].map((k) => model.corner(face, k));
  return [0, 1, 2].map((axis) => (1 - u - v) * corners[0][axis] + u * corners[1][axis] + v * corners[2][axis]) as Triple;
}

export function parse_wrap(text: string, file: string, model: ExactModel): NamedPoint[] {
  const document = parsed_json(text, file);
  if (!Array.isArray(document)) throw new Error(`${file}: is no list of [triangle, u, v]`);
  return document.map((entry, i) => ({ name: "", x: point_of(entry, model, `${file}: point ${i}`) }));
}

export function wrap_text(points: NamedPoint[], model: ExactModel): string {
  return `${JSON.stringify(points.map(({ x }) => model.nearest_place(x)))}\n`;
}

// ---- vertex numbers

export function parse_indices(text: string, file: string, models: Record<Side, ExactModel>): CompletePair[] {
  const vertex = (word: string, side: Side, where: string): Triple => {
    const number = Number(word), model = models[side];
    if (number < 0 || number >= model.vertex_count) throw new Error(`${where}: vertex ${number} of the ${model_of[side]}'s ${model.vertex_count}`);
    return model.vertex(number);
  };
  return numbered_lines(text, file).flatMap(({ line, where }) => {
    const words = words_of(line.replaceAll(",", " "));
    if (line.startsWith("#") || words.length === 0) return [];
    if (words.length !== 2 || !words.every((word) => /^[-+]?\d+$/.test(word))) throw new Error(`${where}: a line is two vertex numbers`);
    return [{ name: "", a: vertex(words[0], "a", where), b: vertex(words[1], "b", where), sigma: null, weight: null }];
  });
}

export function indices_text(pairs: CompletePair[], models: Record<Side, ExactModel>): string {
  return pairs.map((pair) => `${models.a.nearest_vertex(pair.a)} ${models.b.nearest_vertex(pair.b)}\n`).join("");
}
