import type { Triple } from "../scene/scene";
import { eigen_of, solved } from "./linear";

/**
 * What the page needs of `rigid` and `rbf`: a port of some hundred lines, for the library as WebAssembly would bring a compiler of
 * half a gigabyte into the set-up and megabytes into every page. One truth for both: the vectors of tests/vectors.
 */

export type Warp = (point: Triple) => Triple;

export function distance(a: Triple, b: Triple): number {
  return Math.hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
}

export function mean_of(points: Triple[]): Triple {
  const sum = [0, 0, 0];
  for (const point of points) for (let axis = 0; axis < 3; ++axis) sum[axis] += point[axis] / points.length;
  return sum as Triple;
}

export function box_diagonal(points: Triple[]): number {
  return Math.hypot(...[0, 1, 2].map((axis) => Math.max(...points.map((x) => x[axis])) - Math.min(...points.map((x) => x[axis]))));
}

/** The sum of products of coordinates of a (rows) and b (columns), each from its mean. */
function cross_covariance(a: Triple[], b: Triple[]): number[][] {
  const mean_a = mean_of(a), mean_b = mean_of(b);
  const axes = [0, 1, 2];
  return axes.map((i) => axes.map((j) => a.reduce((sum, point, k) => sum + (point[i] - mean_a[i]) * (b[k][j] - mean_b[j]), 0)));
}

/** How far points are from lying in a line or a plane: the middle and the least of three spreads over the largest. */
export function flatness(points: Triple[]): { line: number; plane: number } {
  const { values } = eigen_of(cross_covariance(points, points));
  const largest = Math.sqrt(Math.max(values[2], 1e-300));
  return { line: Math.sqrt(Math.max(0, values[1])) / largest, plane: Math.sqrt(Math.max(0, values[0])) / largest };
}

/** Least-squares rotation and translation of a onto b (Horn, 1987: the largest eigenvector is the rotation's quaternion). */
export function rigid_warp(a: Triple[], b: Triple[]): Warp {
  const s = cross_covariance(a, b);
  const { vectors } = eigen_of([
    [s[0][0] + s[1][1] + s[2][2], s[1][2] - s[2][1], s[2][0] - s[0][2], s[0][1] - s[1][0]],
    [s[1][2] - s[2][1], s[0][0] - s[1][1] - s[2][2], s[0][1] + s[1][0], s[2][0] + s[0][2]],
    [s[2][0] - s[0][2], s[0][1] + s[1][0], s[1][1] - s[0][0] - s[2][2], s[1][2] + s[2][1]],
    [s[0][1] - s[1][0], s[2][0] + s[0][2], s[1][2] + s[2][1], s[2][2] - s[0][0] - s[1][1]],
  ]);
  const [w, x, y, z] = vectors[3];
  const rotation = [
    [w * w + x * x - y * y - z * z, 2 * (x * y - w * z), 2 * (x * z + w * y)],
    [2 * (x * y + w * z), w * w - x * x + y * y - z * z, 2 * (y * z - w * x)],
    [2 * (x * z - w * y), 2 * (y * z + w * x), w * w - x * x - y * y + z * z],
  ];
  const from = mean_of(a), to = mean_of(b);
  return (point) => rotation.map((row, i) => to[i] + row.reduce((sum, r, j) => sum + r * (point[j] - from[j]), 0)) as Triple;
}

/**
 * Σ cᵢ |x − aᵢ|³ with an affine tail, through the pairs (the paper's coarse warp, Eq. 7–10); a σ above 0 lets the warp pass beside a pair as the
 * library does. Null where fewer than four pairs, equal ones or coplanar ones leave it undetermined.
 */
export function coarse_warp(a: Triple[], b: Triple[], sigmas: number[]): Warp | null {
  const n = a.length;
  if (n < 4) return null;
  // Lengths in units of the sources' diagonal, so that cubes and coordinates are of one size.
  const scale = box_diagonal(a) || 1, middle = mean_of(a), target_size = box_diagonal(b) || 1;
  const unit = (point: Triple): Triple => point.map((value, axis) => (value - middle[axis]) / scale) as Triple;
  const centres = a.map(unit);
  const matrix = Array.from({ length: n + 4 }, () => new Array<number>(n + 4).fill(0));
  for (let i = 0; i < n; ++i) {
    for (let j = 0; j < n; ++j) matrix[i][j] = distance(centres[i], centres[j]) ** 3;
    matrix[i][i] = (sigmas[i] / (0.1 * target_size)) ** 2; // 1 / weight, as anchors.h has it
    [1, ...centres[i]].forEach((value, k) => (matrix[i][n + k] = matrix[n + k][i] = value));
  }
  const right = [...b.map((point) => [...point]), ...Array.from({ length: 4 }, () => [0, 0, 0])];
  const coefficients = solved(matrix, right);
  if (coefficients === null) return null;
  return (point) => {
    const x = unit(point);
    const moved: Triple = [0, 0, 0];
    for (let axis = 0; axis < 3; ++axis) {
      for (let i = 0; i < n; ++i) moved[axis] += coefficients[i][axis] * distance(x, centres[i]) ** 3;
      moved[axis] += coefficients[n][axis] + x.reduce((sum, value, k) => sum + coefficients[n + 1 + k][axis] * value, 0);
    }
    return moved;
  };
}

/** Where the others put each pair's target: what the warp without it makes of its source; null where they do not suffice. */
export function left_out_predictions(a: Triple[], b: Triple[], sigmas: number[]): (Triple | null)[] {
  return a.map((point, i) => {
    const others = a.map((_, j) => j).filter((j) => j !== i);
    const warp = coarse_warp(others.map((j) => a[j]), others.map((j) => b[j]), others.map((j) => sigmas[j]));
    return warp === null ? null : warp(point);
  });
}
