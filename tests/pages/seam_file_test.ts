// Seam files: what is read and written back, and what is refused, by the page and by the command alike.
import assert from "node:assert/strict";
import { writeFileSync } from "node:fs";
import { join } from "node:path";
import { before, test } from "node:test";

import { SurfaceGraph } from "../../src/pages/maths/surface_graph";
import { parse_kept, parse_seams, seams_json } from "../../src/pages/seams/seam_file";
import { new_seam, type SeamWork, SeamRoutes } from "../../src/pages/seams/seam_work";
import { bespoke, scratch_directory } from "./browser";

/** 5 × 5 vertices, numbered along rows. */
function grid(): SurfaceGraph {
  const places: number[] = [], faces: number[] = [];
  for (let row = 0; row < 5; ++row) for (let column = 0; column < 5; ++column) places.push(column, row, 0);
  for (let row = 0; row < 4; ++row)
    for (let column = 0; column < 4; ++column) {
      const a = 5 * row + column;
      faces.push(a, a + 1, a + 6, a, a + 6, a + 5);
    }
  return new SurfaceGraph(Float64Array.from(places), Uint32Array.from(faces));
}

const graph = grid(), routes = new SeamRoutes(graph);
const parsed = (document: unknown): SeamWork => parse_seams(document, { count: 25, of_file: (number) => number - 1 }, graph);
const read = (text: string): SeamWork => parsed(JSON.parse(text));
const directory = scratch_directory();
/** As the library's reader, which `pick` calls first. */
function read_by_command(text: string): void {
  writeFileSync(join(directory, "seams.json"), text);
  bespoke(directory, "pick", "grid.obj", "--seams", "seams.json", "-o", "page.html");
}

before(() => {
  const line = (key: string, numbers: number[]): string => `${key} ${numbers.join(" ")}\n`;
  const threes = (all: ArrayLike<number>): number[][] => Array.from({ length: all.length / 3 }, (_, i) => [all[3 * i], all[3 * i + 1], all[3 * i + 2]]);
  const vertices = threes(graph.places).map((place) => line("v", place)), faces = threes(graph.faces).map((face) => line("f", face.map((v) => v + 1)));
  writeFileSync(join(directory, "grid.obj"), [...vertices, ...faces].join(""));
});

const written = (work: SeamWork): unknown => JSON.parse(seams_json(work, routes));

test("edges, lines, ease and names come back as they were", () => {
  const file = {
    seams: [
      { name: "side", edges: [[1, 2], [2, 3]], ease: 8, longer: "front" },
      { line: [1, [2, 7, 0.25], [2, 7, 0], [2, 7, 1], 12], ease: 0, longer: "front" },
    ],
    pieces: [{ name: "front", vertex: 7 }],
    widths: [{ name: "waist", vertex: 3 }],
  };
  assert.deepEqual(written(parsed(file)), file);
  read_by_command(JSON.stringify(file));
});

const apart = { Y: [[1, 7], [7, 13], [7, 8]], ring: [[1, 2], [2, 7], [7, 1]], "two ways": [[1, 2], [11, 12]], "edges against each other": [[2, 1], [2, 3]], "one edge twice": [[1, 2], [2, 1], [1, 2]] };
for (const [name, edges] of Object.entries(apart))
  test(`a seam of edges stays one seam of these edges: ${name}`, () => {
    const work = parsed({ seams: [{ name, edges, ease: 2, longer: "a" }], pieces: [], widths: [] });
    assert.deepEqual(written(work), { seams: [{ name, edges, ease: 2, longer: "a" }], pieces: [], widths: [] });
    read_by_command(seams_json(work, routes));
    const length = edges.reduce((sum, [a, b]) => sum + Math.hypot((a - b) % 5, Math.trunc((a - b) / 5)), 0);
    assert.ok(Math.abs(routes.length(work.seams[0]) - length) < 1e-12, "and as long as they are");
  });

test("a path is the shortest way over edges", () => {
  assert.deepEqual((written(parsed({ seams: [{ path: [1, 3, 13] }] })) as { seams: unknown }).seams, [{ edges: [[1, 2], [2, 3], [3, 8], [8, 13]] }]);
});

const refused: [string, RegExp][] = [
  ["[]", /"seams" is missing/],
  ["{}", /"seams" is missing/],
  ['{"seams":{}}', /"seams" must be a list/],
  ['{"seams":null}', /"seams" must be a list/],
  ['{"seams":[],"darts":[]}', /the file has the key "darts"/],
  ['{"seams":[],"__proto__":[]}', /the file has the key "__proto__"/],
  ['{"seams":[7]}', /seam 1 must be an object/],
  ['{"seams":[[1,2]]}', /seam 1 must be an object/],
  ['{"seams":[{"path":[1,2]},{"path":[1,2],"eases":3}]}', /seam 2 has the key "eases"/],
  ['{"seams":[{"way":[1,2]}]}', /seam 1 has the key "way"/],
  ['{"seams":[{"name":"a"}]}', /seam 1 needs one of/],
  ['{"seams":[{"path":[1,2],"line":[1,2]}]}', /seam 1 needs one of/],
  ['{"seams":[{"edges":[]}]}', /seam 1: "edges" must be a list that is not empty/],
  ['{"seams":[{"path":{}}]}', /seam 1: "path" must be a list that is not empty/],
  ['{"seams":[{"path":[1]}]}', /a path has two vertices or more/],
  ['{"seams":[{"line":[1]}]}', /a line has two vertices or more/],
  ['{"seams":[{"edges":[[1,2,3]]}]}', /seam 1: \[1,2,3\] is no edge, which is a pair of vertices/],
  ['{"seams":[{"edges":[[1]]}]}', /pair of vertices/],
  ['{"seams":[{"edges":[1,2]}]}', /pair of vertices/],
  ['{"seams":[{"edges":[[1,2.5]]}]}', /2\.5 is no vertex of 1 … 25/],
  ['{"seams":[{"edges":[[0,1]]}]}', /0 is no vertex/],
  ['{"seams":[{"edges":[[-1,1]]}]}', /-1 is no vertex/],
  ['{"seams":[{"edges":[["1",2]]}]}', /"1" is no vertex/],
  ['{"seams":[{"edges":[[null,2]]}]}', /null is no vertex/],
  ['{"seams":[{"path":[1,26]}]}', /seam 1: 26 is no vertex of 1 … 25/],
  ['{"seams":[{"line":[1,[1,2]]}]}', /two and a share/],
  ['{"seams":[{"line":[1,[1,2,"0.5"]]}]}', /two and a share/],
  ['{"seams":[{"line":[1,[1,2,1.5]]}]}', /share 1\.5 is not in 0 … 1/],
  ['{"seams":[{"line":[1,[1,2,-0.1]]}]}', /share -0\.1 is not in 0 … 1/],
  ['{"seams":[{"path":[1,2],"ease":3}]}', /seam 1 needs "ease" and "longer" both/],
  ['{"seams":[{"path":[1,2],"longer":"a"}]}', /seam 1 needs "ease" and "longer" both/],
  ['{"seams":[{"path":[1,2],"ease":-1,"longer":"a"}]}', /"ease" must be millimetres, 0 or more/],
  ['{"seams":[{"path":[1,2],"ease":"1","longer":"a"}]}', /"ease" must be millimetres/],
  ['{"seams":[{"path":[1,2],"ease":1e999,"longer":"a"}]}', /"ease" must be millimetres/],
  ['{"seams":[{"path":[1,2],"ease":1,"longer":2}]}', /"longer" must name a piece/],
  ['{"seams":[],"pieces":null}', /"pieces" must be a list/],
  ['{"seams":[],"pieces":[{"vertex":2}]}', /piece 1 needs a "name" and a "vertex"/],
  ['{"seams":[],"widths":[{"name":3,"vertex":2}]}', /width 1 needs a "name" and a "vertex"/],
  ['{"seams":[],"widths":[{"name":"a"}]}', /width 1 needs a "name" and a "vertex"/],
  ['{"seams":[],"widths":[{"name":"a","vertex":2,"length":3}]}', /width 1 has the key "length"/],
  ['{"seams":[],"pieces":[{"name":"a","vertex":26}]}', /piece 1: 26 is no vertex/],
];
for (const [text, reason] of refused)
  test(`refused: ${text}`, () => {
    assert.throws(() => read(text), reason);
    assert.throws(() => read_by_command(text), /^bespoke: seams\.json: /m);
  });

test("an ease without its longer side is not written, nor the reverse", () => {
  const work = (change: object): SeamWork => ({ seams: [new_seam("a", "edges", [0, 1]), { ...new_seam("side", "edges", [0, 4]), ...change }], pieces: [], widths: [] });
  assert.throws(() => written(work({ ease: 0 })), /seam 2 \(“side”\) has an ease, but "longer" names no piece/);
  assert.throws(() => written(work({ longer: "front" })), /seam 2 \(“side”\) has a longer side, but no ease/);
  assert.doesNotThrow(() => written(work({ ease: 0, longer: "front" })));
});

test("what an older page kept, with one way for a seam of a file, is read", () => {
  const { fixed_ways: _, ...kept } = new_seam("old", "line", []);
  const old = { seams: [{ ...kept, fixed: [0, [1, 6, 0.5], 11] }, { ...kept, vertices: [0, 4], fixed: null }], pieces: [], widths: [] };
  assert.deepEqual(parse_kept(JSON.stringify(old)).seams.map((seam) => seam.fixed_ways), [[[0, [1, 6, 0.5], 11]], null]);
  const now = parsed({ seams: [{ edges: apart.Y }] });
  assert.deepEqual(parse_kept(JSON.stringify(now)), now);
});
