// What a closed line on a surface encloses: the smaller side, by area, of the piece that it lies on.
import assert from "node:assert/strict";
import { test } from "node:test";

import { enclosed_faces } from "../../src/pages/maths/enclosed_faces";
import { minus, SurfaceGraph } from "../../src/pages/maths/surface_graph";
import { distance } from "../../src/pages/maths/warp";

type Triple = [number, number, number];

/** A grid of n × m squares over [0, 1]², each cut in two, its vertices where a function puts them. */
function sheet(n: number, m: number, place: (u: number, v: number) => Triple): SurfaceGraph {
  const places: number[] = [], faces: number[] = [];
  for (let i = 0; i <= n; ++i) for (let j = 0; j <= m; ++j) places.push(...place(i / n, j / m));
  for (let i = 0; i < n; ++i)
    for (let j = 0; j < m; ++j) {
      const a = i * (m + 1) + j;
      faces.push(a, a + m + 1, a + 1, a + 1, a + m + 1, a + m + 2);
    }
  return new SurfaceGraph(new Float32Array(places), new Uint32Array(faces));
}

/** Exactly the same place at both ends of a turn: seams, and poles of many vertices, are equal positions. */
const turn = (share: number): [number, number] => (share === 1 ? [1, 0] : [Math.cos(2 * Math.PI * share), Math.sin(2 * Math.PI * share)]);
const sphere = (n: number): SurfaceGraph =>
  sheet(n, 2 * n, (u, v) => {
    const radius = u === 0 || u === 1 ? 0 : Math.sin(Math.PI * u), [x, y] = turn(v);
    return [radius * x, radius * y, Math.cos(Math.PI * u)];
  });
const torus = (n: number): SurfaceGraph =>
  sheet(3 * n, n, (u, v) => {
    const [x, y] = turn(u), [out, up] = turn(v);
    return [(3 + out) * x, (3 + out) * y, up];
  });
const parallel = (height: number, count = 60): Triple[] =>
  Array.from({ length: count }, (_, i) => [Math.sqrt(1 - height ** 2) * turn(i / count)[0], Math.sqrt(1 - height ** 2) * turn(i / count)[1], height]);

function middle(graph: SurfaceGraph, face: number): Triple {
  return [0, 1, 2].map((axis) => [0, 1, 2].reduce((sum, k) => sum + graph.corner(face, k)[axis], 0) / 3) as Triple;
}

test("a parallel of a sphere encloses the cap, with the cap's share of the area, whichever way it runs", () => {
  const graph = sphere(40), height = 0.6;
  for (const line of [parallel(height), parallel(height).reverse()]) {
    const { inside, share, trouble } = enclosed_faces(graph, line);
    assert.equal(trouble, null);
    assert.ok(Math.abs(share - (1 - height) / 2) < 0.02, `${share}`);
    const size = Math.PI / 40;
    const is_inside = new Set(inside);
    for (let face = 0; 3 * face < graph.faces.length; ++face) {
      const above = middle(graph, face)[2] - height;
      if (Math.abs(above) > size) assert.equal(is_inside.has(face), above > 0, `face ${face}`);
    }
  }
});

test("below the middle of a sphere it is the other cap", () => {
  const graph = sphere(40), { inside } = enclosed_faces(graph, parallel(-0.6));
  for (const face of inside) assert.ok(middle(graph, face)[2] < -0.5);
});

test("few points that lie beside the surface by less than 2 % of its size do as well", () => {
  const graph = sphere(40), fine = enclosed_faces(graph, parallel(0.6)), coarse = enclosed_faces(graph, parallel(0.6, 12));
  assert.equal(coarse.trouble, null);
  assert.ok(Math.abs(coarse.share - fine.share) < 0.02);
});

test("the equator is refused, and so are lines that do not separate, leave the surface or enclose no vertex", () => {
  const ring: Triple[] = Array.from({ length: 30 }, (_, i) => [3 + turn(i / 30)[0], 0, turn(i / 30)[1]]);
  const speck: Triple[] = [[0.301, 0.301, 0], [0.309, 0.301, 0], [0.301, 0.309, 0]];
  const plane = sheet(10, 10, (u, v) => [u, v, 0]);
  const said = [enclosed_faces(sphere(40), parallel(0)), enclosed_faces(torus(16), ring), enclosed_faces(sphere(40), parallel(0.6, 3)), enclosed_faces(plane, speck)];
  const expected = [/two about equal parts/, /does not separate/, /leaves the surface/, /smaller than the triangles/];
  said.forEach(({ trouble, inside }, i) => {
    assert.match(trouble ?? "none", expected[i]);
    assert.equal(inside.length, 0);
  });
});

test("only the piece that the line lies on is divided", () => {
  const one = sphere(20), count = one.places.length / 3;
  const both = new SurfaceGraph(new Float32Array([...one.places, ...one.places.map((x, i) => x + (i % 3 === 0 ? 5 : 0))]), new Uint32Array([...one.faces, ...one.faces.map((vertex) => vertex + count)]));
  const alone = enclosed_faces(one, parallel(0.6)), beside = enclosed_faces(both, parallel(0.6));
  assert.deepEqual([...beside.inside], [...alone.inside]);
  assert.equal(beside.share, alone.share);
});

test("the nearest place of a surface is no farther than that of any face", () => {
  const graph = torus(12);
  let seed = 1;
  const random = (): number => (seed = (seed * 48271) % 2147483647) / 2147483647;
  for (let i = 0; i < 200; ++i) {
    const point: Triple = [10 * random() - 5, 10 * random() - 5, 4 * random() - 2];
    const found = graph.nearest(point), away = distance(found.point, point);
    for (let face = 0; 3 * face < graph.faces.length; ++face) {
      const only = new SurfaceGraph(new Float32Array([0, 1, 2].flatMap((k) => graph.corner(face, k))), new Uint32Array([0, 1, 2]));
      assert.ok(distance(only.nearest(point).point, point) >= away - 1e-5);
    }
    assert.ok(Math.hypot(...minus(found.point, graph.nearest(found.point).point)) < 1e-12);
  }
});
