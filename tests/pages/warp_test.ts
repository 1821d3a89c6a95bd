// The laws of the page's own mathematics: those of rigid/rigid_alignment and rbf/global_rbf.
import assert from "node:assert/strict";
import { test } from "node:test";

import { eigen_of, solved } from "../../src/pages/maths/linear";
import { mirrored, symmetry_plane } from "../../src/pages/maths/mirror";
import { Motion } from "../../src/pages/maths/motion";
import { coarse_warp, distance, flatness, left_out_predictions, rigid_warp } from "../../src/pages/maths/warp";

type Triple = [number, number, number];

/** Numbers in [−1, 1], the same every time. */
function numbers(count: number, seed = 7): number[] {
  let state = seed;
  return Array.from({ length: count }, () => {
    state = (state * 48271) % 2147483647;
    return (2 * state) / 2147483647 - 1;
  });
}

function points(count: number, seed?: number): Triple[] {
  const all = numbers(3 * count, seed);
  return Array.from({ length: count }, (_, i) => all.slice(3 * i, 3 * i + 3) as Triple);
}

const turn = (x: Triple): Triple => [0.6 * x[0] - 0.8 * x[1] + 3, 0.8 * x[0] + 0.6 * x[1] - 1, x[2] + 2];
const bend = (x: Triple): Triple => [1.2 * x[0] + 0.3 * x[1] * x[1], 0.9 * x[1], x[2] + 0.2 * Math.sin(x[0])];

test("elimination solves, and says when it cannot", () => {
  const matrix = [[2, 1, 0], [1, 3, 1], [0, 1, 4]];
  const found = solved(matrix, [[3], [5], [5]])!.flat();
  found.forEach((value) => assert.ok(Math.abs(value - 1) < 1e-14));
  assert.equal(solved([[1, 2], [2, 4]], [[1], [2]]), null);
});

test("eigenvectors are met and ascend", () => {
  const matrix = [[4, 1, 2], [1, 3, 0], [2, 0, 1]];
  const { values, vectors } = eigen_of(matrix);
  assert.ok(values[0] < values[1] && values[1] < values[2]);
  vectors.forEach((v, k) => matrix.forEach((row, i) => assert.ok(Math.abs(row.reduce((s, m, j) => s + m * v[j], 0) - values[k] * v[i]) < 1e-12)));
});

test("a rigid motion is found exactly", () => {
  const a = points(5);
  const warp = rigid_warp(a, a.map(turn));
  for (const x of points(20, 3)) assert.ok(distance(warp(x), turn(x)) < 1e-12);
});

test("the coarse warp meets its pairs, and reproduces affine maps everywhere", () => {
  const a = points(12), zero = a.map(() => 0);
  const through = coarse_warp(a, a.map(bend), zero)!;
  for (const x of a) assert.ok(distance(through(x), bend(x)) < 1e-10);
  const affine = (x: Triple): Triple => [2 * x[0] + x[1] + 5, 0.5 * x[1] - x[2], x[0] + x[2] - 1];
  const warp = coarse_warp(a, a.map(affine), zero)!;
  for (const x of points(20, 3)) assert.ok(distance(warp(x), affine(x)) < 1e-10);
});

test("a large sigma lets the warp pass beside a pair", () => {
  const a = points(12), b = a.map(turn);
  b[4] = [b[4][0] + 0.5, b[4][1], b[4][2]];
  const off = (sigma: number): number => distance(coarse_warp(a, b, a.map((_, i) => (i === 4 ? sigma : 0)))!(a[4]), b[4]);
  assert.ok(off(0) < 1e-10 && off(1) > 0.1 && off(1e3) > off(1));
});

test("without four pairs that span space there is no warp", () => {
  const flat = points(6).map((x): Triple => [x[0], x[1], 0]);
  assert.equal(coarse_warp(flat, flat, flat.map(() => 0)), null);
  assert.equal(coarse_warp(flat.slice(0, 3), flat.slice(0, 3), [0, 0, 0]), null);
  assert.ok(flatness(flat).plane < 1e-12 && flatness(flat).line > 0.01);
});

test("the pair that was moved is the one that the others contradict most", () => {
  const a = points(14), b = a.map(turn);
  b[6] = [b[6][0] + 1, b[6][1], b[6][2]];
  const off = left_out_predictions(a, b, a.map(() => 0)).map((x, i) => distance(x!, b[i]));
  assert.equal(off.indexOf(Math.max(...off)), 6);
});

test("the plane of a symmetric model is found, also when it stands askew", () => {
  const half = points(400).map((x): Triple => [0.3 + Math.abs(x[0]), 2 * x[1] + 0.4 * x[0] * x[0], 3 * x[2] + x[1]]);
  const model = [...half, ...half.map((x): Triple => [-x[0], x[1], x[2]])].map(turn);
  const plane = symmetry_plane(model);
  assert.ok(plane.misfit < 1e-3, `misfit ${plane.misfit}`);
  const x = half[3];
  assert.ok(distance(mirrored(turn(x), plane), turn([-x[0], x[1], x[2]])) < 1e-2);
});

test("the rigid part begins at rest, ends at R, and keeps lengths between", () => {
  for (const path of ["geodesic", "euler", "flow"] as const) {
    const motion = new Motion({ rotation: [[0.6, -0.8, 0], [0.8, 0.6, 0], [0, 0, 1]], translation: [3, -1, 2], path, knots: [0, 0.5, 1] });
    assert.deepEqual(motion.pose(0).turn.toArray().map((v) => Math.round(v * 1e12) / 1e12 + 0), [1, 0, 0, 0, 1, 0, 0, 0, 1]);
    assert.deepEqual(motion.pose(1).turn.toArray(), [0.6, 0.8, 0, -0.8, 0.6, 0, 0, 0, 1]);
    assert.ok(Math.abs(motion.pose(0.3).turn.determinant() - 1) < 1e-12);
    assert.deepEqual(motion.place(0.75), { knot: 1, fraction: 0.5 });
    assert.deepEqual(motion.place(1), { knot: 1, fraction: 1 });
  }
});
