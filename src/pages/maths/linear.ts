/** Small dense linear algebra: no more than a warp through a hundred pairs needs. */

/** Solves A X = B by elimination with row pivots; null where A is singular to working precision. */
export function solved(matrix: number[][], right: number[][]): number[][] | null {
  const n = matrix.length;
  const a = matrix.map((row, i) => [...row, ...right[i]]);
  const largest = Math.max(...matrix.flat().map(Math.abs));
  for (let column = 0; column < n; ++column) {
    let pivot = column;
    for (let i = column + 1; i < n; ++i) if (Math.abs(a[i][column]) > Math.abs(a[pivot][column])) pivot = i;
    if (!(Math.abs(a[pivot][column]) > 1e-13 * largest)) return null; // some hundred roundings of a double
    [a[column], a[pivot]] = [a[pivot], a[column]];
    for (let i = column + 1; i < n; ++i) {
      const factor = a[i][column] / a[column][column];
      if (factor !== 0) for (let j = column; j < a[i].length; ++j) a[i][j] -= factor * a[column][j];
    }
  }
  for (let i = n - 1; i >= 0; --i)
    for (let j = n; j < a[i].length; ++j) {
      for (let k = i + 1; k < n; ++k) a[i][j] -= a[i][k] * a[k][j];
      a[i][j] /= a[i][i];
    }
  return a.map((row) => row.slice(n));
}

export interface Eigen {
  /** Ascending. */
  values: number[];
  /** vectors[k] belongs to values[k]. */
  vectors: number[][];
}

/** Of a symmetric matrix, by Jacobi rotations. */
export function eigen_of(symmetric: number[][]): Eigen {
  const n = symmetric.length;
  const a = symmetric.map((row) => [...row]);
  const v = a.map((_, i) => a.map((__, j) => Number(i === j)));
  const sweeps = 50; // a few suffice; each squares what is left off the diagonal
  for (let sweep = 0; sweep < sweeps; ++sweep)
    for (let p = 0; p < n; ++p)
      for (let q = p + 1; q < n; ++q) {
        if (a[p][q] === 0) continue;
        const theta = (a[q][q] - a[p][p]) / (2 * a[p][q]);
        const tangent = Math.sign(theta || 1) / (Math.abs(theta) + Math.hypot(theta, 1));
        const cosine = 1 / Math.hypot(tangent, 1), sine = tangent * cosine;
        for (let k = 0; k < n; ++k) [a[k][p], a[k][q]] = [cosine * a[k][p] - sine * a[k][q], sine * a[k][p] + cosine * a[k][q]];
        for (let k = 0; k < n; ++k) [a[p][k], a[q][k]] = [cosine * a[p][k] - sine * a[q][k], sine * a[p][k] + cosine * a[q][k]];
        for (let k = 0; k < n; ++k) [v[k][p], v[k][q]] = [cosine * v[k][p] - sine * v[k][q], sine * v[k][p] + cosine * v[k][q]];
      }
  const order = a.map((_, i) => i).sort((i, j) => a[i][i] - a[j][j]);
  return { values: order.map((i) => a[i][i]), vectors: order.map((i) => v.map((row) => row[i])) };
}
