// The vectors of tests/vectors, which the library passes too (tests/anchors/shared_vectors_test.cpp). MeshLab's files need a
// browser's reader of XML: pick_formats_test.ts has those.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { join } from "node:path";
import { test } from "node:test";

import { anchor_formats, format_of } from "../../src/pages/anchor_files/format";
import { parse_both_sides, parse_side, type FileModels } from "../../src/pages/anchor_files/anchor_files";
import { ExactModel } from "../../src/pages/anchor_files/model_places";
import { paired } from "../../src/pages/anchor_files/paired_sides";
import { enclosed_faces } from "../../src/pages/maths/enclosed_faces";
import { SurfaceGraph } from "../../src/pages/maths/surface_graph";
import { coarse_warp, distance } from "../../src/pages/maths/warp";
import type { Triple } from "../../src/pages/scene/scene";

interface FileVector {
  name: string;
  files: [string, string][];
  models?: "LPS" | "RAS";
  pairs?: [string, Triple, Triple][];
  fault?: string[];
}
interface FaceVectors {
  meshes: Record<string, { vertices: Triple[]; faces: Triple[] }>;
  cases: { name: string; mesh: string; border: Triple[]; inside?: number[]; trouble?: string }[];
}
interface WarpVector {
  name: string;
  a: Triple[];
  b: Triple[];
  sigmas: number[];
  points: Triple[];
  images: Triple[];
}

const vectors = <T>(name: string): T => JSON.parse(readFileSync(join(process.env.BESPOKE_VECTORS as string, name), "utf8")) as T;

/** Whose vertices and triangles files of `wrap` and `indices` name. */
const corner = new ExactModel(Float64Array.of(0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1), Uint32Array.of(0, 1, 2, 1, 2, 3));

function pairs_of({ files, models: system = "LPS" }: FileVector): [string, Triple, Triple][] {
  const models: FileModels = { exact: () => corner, system };
  const [[name, text]] = files, format = format_of(name, text);
  const read = anchor_formats[format].per_side
    ? paired(parse_side(text, format, name, "a", models), parse_side(files[1][1], format, files[1][0], "b", models), [name, files[1][0]])
    : parse_both_sides(text, format, name, models);
  return read.pairs.map((pair) => [pair.name, pair.a as Triple, pair.b as Triple]);
}

for (const each of vectors<FileVector[]>("anchor_files.json").filter(({ files }) => !files[0][0].endsWith(".pp")))
  test(`anchor files: ${each.name}`, () => {
    if (each.fault === undefined) return assert.deepEqual(pairs_of(each), each.pairs);
    assert.throws(() => pairs_of(each), (error: Error) => each.fault!.every((words) => error.message.includes(words)) || assert.fail(error.message));
  });

const { meshes, cases } = vectors<FaceVectors>("enclosed_faces.json");
for (const { name, mesh, border, inside, trouble } of cases)
  test(`enclosed faces: ${name}`, () => {
    const graph = new SurfaceGraph(Float64Array.from(meshes[mesh].vertices.flat()), Uint32Array.from(meshes[mesh].faces.flat()));
    const found = enclosed_faces(graph, border);
    if (trouble === undefined) assert.equal(found.trouble, null);
    else assert.ok(found.trouble?.startsWith(trouble), found.trouble ?? "accepted");
    assert.deepEqual([...found.inside], inside ?? []);
  });

// Of lengths like those of the images; the system's condition costs some of the 16 digits.
const precision = 1e-10;
for (const { name, a, b, sigmas, points, images } of vectors<WarpVector[]>("warp.json"))
  test(`coarse warp: ${name}`, () => {
    const warp = coarse_warp(a, b, sigmas)!, size = Math.max(...images.map((x) => Math.hypot(...x)));
    points.forEach((x, i) => assert.ok(distance(warp(x), images[i]) < precision * size, `${warp(x)} ${images[i]}`));
  });
