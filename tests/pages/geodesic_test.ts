// Lines along a surface: on it, and as short as geometry says.
import assert from "node:assert/strict";
import { test } from "node:test";

import { geodesic } from "../../src/pages/maths/geodesic";
import { StripSearch } from "../../src/pages/maths/strip_search";
import { SurfaceGraph, type SurfacePoint } from "../../src/pages/maths/surface_graph";
import { distance } from "../../src/pages/maths/warp";

type Triple = [number, number, number];

/** A grid of n × n squares over [0, 1]², bent by a function, each cut in two; `keep` leaves squares out. */
function sheet(n: number, bend: (u: number, v: number) => Triple, keep: (i: number, j: number) => boolean = () => true): SurfaceGraph {
  const places: number[] = [], faces: number[] = [];
  for (let i = 0; i <= n; ++i) for (let j = 0; j <= n; ++j) places.push(...bend(i / n, j / n));
  for (let i = 0; i < n; ++i)
    for (let j = 0; j < n; ++j) {
      const a = i * (n + 1) + j;
      if (keep(i, j)) faces.push(a, a + n + 1, a + 1, a + 1, a + n + 1, a + n + 2);
    }
  return new SurfaceGraph(new Float32Array(places), new Uint32Array(faces));
}

/** The surface of [−1, 1]³, its sides as separate grids that share no vertices, as files with seams have them. */
function cube(n: number): SurfaceGraph {
  const places: number[] = [], faces: number[] = [];
  for (let axis = 0; axis < 3; ++axis)
    for (const sign of [-1, 1]) {
      const first = places.length / 3;
      for (let i = 0; i <= n; ++i)
        for (let j = 0; j <= n; ++j) {
          const point = [0, 0, 0];
          [point[axis], point[(axis + 1) % 3], point[(axis + 2) % 3]] = [sign, (2 * i) / n - 1, (2 * j) / n - 1];
          places.push(...point);
        }
      for (let i = 0; i < n; ++i)
        for (let j = 0; j < n; ++j) {
          const a = first + i * (n + 1) + j;
          faces.push(a, a + n + 1, a + 1, a + 1, a + n + 1, a + n + 2);
        }
    }
  return new SurfaceGraph(new Float32Array(places), new Uint32Array(faces));
}

function sphere(n: number): SurfaceGraph {
  const round = cube(n);
  const places = round.places.map((_, i) => round.places[i] / Math.hypot(...round.place(Math.floor(i / 3))));
  return new SurfaceGraph(places, round.faces);
}

const length_of = (line: Triple[]): number => line.slice(1).reduce((sum, point, i) => sum + distance(line[i], point), 0);
const near = (graph: SurfaceGraph, x: Triple): SurfacePoint => graph.nearest(x);
const between = (graph: SurfaceGraph, a: Triple, b: Triple): Triple[] => geodesic(graph, near(graph, a), near(graph, b))!;

/** Largest distance of a line from the surface, between its points too. */
function off_surface(graph: SurfaceGraph, line: Triple[]): number {
  const middles = line.slice(1).map((point, i) => point.map((value, axis) => (value + line[i][axis]) / 2) as Triple);
  return Math.max(...[...line, ...middles].map((point) => distance(point, graph.nearest(point).point)));
}

test("in a plane it is the straight line", () => {
  const graph = sheet(20, (u, v) => [u, v, 0]);
  for (const [a, b] of [[[0.03, 0.11, 0], [0.93, 0.57, 0]], [[0.5, 0, 0], [0.5, 1, 0]], [[0, 0, 0], [1, 1, 0]], [[0.51, 0.52, 0], [0.512, 0.521, 0]]] as Triple[][])
    assert.ok(Math.abs(length_of(between(graph, a, b)) - distance(a, b)) < 1e-6);
});

test("over the edges of a cube it is the straight line of the unfolded sides", () => {
  for (const n of [1, 2, 7, 16]) {
    const graph = cube(n);
    // From the top over one edge: 0.7 on either side of it, 0.5 along.
    const line = between(graph, [0.3, 0, 1], [1, 0.5, 0.3]);
    assert.ok(Math.abs(length_of(line) - Math.hypot(1.4, 0.5)) < 1e-6, `${n}: ${length_of(line)}`);
    assert.ok(off_surface(graph, line) < 1e-6);
    // From the middle of a side to that of the opposite one: straight down.
    assert.ok(Math.abs(length_of(between(graph, [0, 0, 1], [0, 0, -1])) - 4) < 1e-6);
  }
});

test("on a sphere it is a great circle, but for the facets", () => {
  const graph = sphere(40);
  const a: Triple = [0.6, 0, 0.8], b: Triple = [-0.48, 0.8, 0.36];
  const line = between(graph, a, b);
  const angle = Math.acos(a.reduce((sum, value, axis) => sum + value * b[axis], 0));
  assert.ok(Math.abs(length_of(line) - angle) < 1e-3 * angle, `${length_of(line)} for ${angle}`);
  const normal: Triple = [-0.64, -0.6, 0.48]; // a × b over its length
  for (const x of line) assert.ok(Math.abs(x.reduce((sum, value, axis) => sum + value * normal[axis], 0)) < 0.02);
  assert.ok(off_surface(graph, line) < 1e-6);
});

test("round a hole it bends at the hole's corner", () => {
  // An L of two squares' width: what lies beyond (0.5, 0.5) is missing.
  const graph = sheet(10, (u, v) => [u, v, 0], (i, j) => i < 5 || j < 5);
  const a: Triple = [0.3, 0.9, 0], b: Triple = [0.9, 0.3, 0];
  const line = between(graph, a, b);
  const corner: Triple = [0.5, 0.5, 0];
  assert.ok(Math.abs(length_of(line) - distance(a, corner) - distance(corner, b)) < 1e-6);
});

test("on a bumpy sheet no vertex that it bends at could be passed on a shorter side", () => {
  const graph = sheet(60, (u, v) => [u, v, 0.12 * Math.sin(9 * u) * Math.sin(8 * v)]);
  const line = between(graph, [0.05, 0.07, 0], [0.95, 0.9, 0]);
  assert.ok(off_surface(graph, line) < 1e-6);
  // Of the unfolded strip nothing is left to shorten: nearby waypoints make every path longer.
  for (const i of [Math.floor(line.length / 3), Math.floor(line.length / 2)])
    for (const by of [0.02, -0.02]) {
      const way: Triple = [line[i][0] + by, line[i][1] - by, line[i][2]];
      assert.ok(length_of(between(graph, line[0], way)) + length_of(between(graph, way, line.at(-1)!)) > length_of(line));
    }
});

test("begins and ends where it was asked to, also within one face and at one place", () => {
  const graph = sheet(3, (u, v) => [u, v, u * v]);
  const [a, b] = [near(graph, [0.1, 0.05, 0]), near(graph, [0.12, 0.06, 0])];
  assert.deepEqual(geodesic(graph, a, b), [a.point, b.point]);
  assert.deepEqual(geodesic(graph, a, a), [a.point, a.point]);
  const far = near(graph, [0.9, 0.95, 1]);
  const line = geodesic(graph, a, far)!;
  assert.deepEqual([line[0], line.at(-1)], [a.point, far.point]);
});

test("between separate pieces there is none", () => {
  const graph = sheet(10, (u, v) => [u, v, 0], (i) => i !== 4);
  assert.equal(geodesic(graph, near(graph, [0.1, 0.1, 0]), near(graph, [0.9, 0.1, 0])), null);
});

test("on a mesh of 50,000 triangles a line over a third of it takes less than 100 ms", () => {
  const graph = sheet(160, (u, v) => [u, v, 0.1 * Math.sin(9 * u) * Math.sin(8 * v)]);
  const [from, to] = [near(graph, [0.3, 0.33, 0]), near(graph, [0.6, 0.62, 0])];
  const times = Array.from({ length: 9 }, () => {
    const start = process.cpuUsage();
    geodesic(graph, from, to);
    return process.cpuUsage(start).user / 1000;
  }).sort((x, y) => x - y);
  assert.ok(times[4] < 100, `${times[4]} ms`);
});

test("a search that serves for many ends finds the same ways as one for each, near and far, in any order", () => {
  const graph = sphere(16), from = near(graph, [0.2, 0.9, 0.3]), search = new StripSearch(graph, from);
  for (let k = 0; k < 60; ++k) {
    const to = near(graph, [Math.cos(7 * k), Math.sin(5 * k), Math.cos(3 * k)]);
    assert.deepEqual(geodesic(graph, from, to, search), geodesic(graph, from, to));
  }
});

test("between separate pieces there is no way, for a search that serves for many ends too", () => {
  const one = cube(3), apart = one.places.map((x, i) => x + (i % 3 === 0 ? 5 : 0));
  const both = new SurfaceGraph(new Float32Array([...one.places, ...apart]), new Uint32Array([...one.faces, ...one.faces.map((vertex) => vertex + one.places.length / 3)]));
  const from = near(both, [0, 0, 1]), search = new StripSearch(both, from);
  assert.equal(geodesic(both, from, near(both, [5, 0, 1]), search), null);
  assert.notEqual(geodesic(both, from, near(both, [0, 0, -1]), search), null);
});
