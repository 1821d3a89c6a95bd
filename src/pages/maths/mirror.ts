import type { Triple } from "../scene/scene";
import { eigen_of } from "./linear";
import { mean_of } from "./warp";

/** The plane normal · x = offset. */
export interface Plane {
  normal: Triple;
  offset: number;
  /** Mean distance of the mirrored points from the model, of its size: 0 is perfect symmetry. */
  misfit: number;
}

function dot(a: Triple, b: Triple): number {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

export function mirrored(point: Triple, plane: Plane): Triple {
  const twice = 2 * (dot(plane.normal, point) - plane.offset);
  return point.map((value, axis) => value - twice * plane.normal[axis]) as Triple;
}

/** Nearest of a set of points, by a grid of cubes. */
class PointGrid {
  private readonly cells = new Map<string, Triple[]>();
  constructor(points: Triple[], private readonly edge: number) {
    for (const point of points) {
      const key = this.cell(point).join();
      const members = this.cells.get(key);
      if (members === undefined) this.cells.set(key, [point]);
      else members.push(point);
    }
  }
  private cell(point: Triple): number[] {
    return point.map((value) => Math.floor(value / this.edge));
  }
  /** Among the points of the cubes around; null where these are empty. */
  nearest(point: Triple): Triple | null {
    const [i, j, k] = this.cell(point);
    let best: Triple | null = null, least = Infinity;
    for (let x = i - 1; x <= i + 1; ++x)
      for (let y = j - 1; y <= j + 1; ++y)
        for (let z = k - 1; z <= k + 1; ++z)
          for (const candidate of this.cells.get(`${x},${y},${z}`) ?? []) {
            const d = (candidate[0] - point[0]) ** 2 + (candidate[1] - point[1]) ** 2 + (candidate[2] - point[2]) ** 2;
            if (d < least) [best, least] = [candidate, d];
          }
    return best;
  }
}

const max_samples = 1500, refinements = 15;

/** The plane that a model is best mirrored by: of the coordinate and principal axes the best, then refined on closest points. */
export function symmetry_plane(vertices: Triple[]): Plane {
  const step = Math.max(1, Math.floor(vertices.length / max_samples));
  const samples = vertices.filter((_, i) => i % step === 0);
  const centre = mean_of(vertices);
  const size = Math.max(...samples.map((x) => Math.hypot(...x.map((value, axis) => value - centre[axis])))) || 1;
  const reach = 0.15 * size; // farther off nothing is a counterpart
  const grid = new PointGrid(vertices, reach);
  const spread = [0, 1, 2].map((i) => [0, 1, 2].map((j) => samples.reduce((sum, x) => sum + (x[i] - centre[i]) * (x[j] - centre[j]), 0)));
  const axes: Triple[] = [[1, 0, 0], [0, 1, 0], [0, 0, 1], ...(eigen_of(spread).vectors as Triple[])];
  const rated = axes.map((normal) => with_misfit({ normal, offset: dot(normal, centre), misfit: 0 }, samples, grid, reach, size));
  let plane = rated.reduce((best, candidate) => (candidate.misfit < best.misfit ? candidate : best));
  for (let pass = 0; pass < refinements; ++pass) {
    const next = with_misfit(refined(plane, samples, grid), samples, grid, reach, size);
    if (!(next.misfit < plane.misfit)) break;
    plane = next;
  }
  return plane;
}

function with_misfit(plane: Plane, samples: Triple[], grid: PointGrid, reach: number, size: number): Plane {
  let sum = 0;
  for (const sample of samples) {
    const image = mirrored(sample, plane);
    const near = grid.nearest(image);
    sum += near === null ? reach : Math.min(reach, Math.hypot(...near.map((value, axis) => value - image[axis])));
  }
  return { ...plane, misfit: sum / samples.length / size };
}

/** Given counterparts p, q the best normal is the least eigenvector of Σ p qᵀ + q pᵀ about the mean of their middles. */
function refined(plane: Plane, samples: Triple[], grid: PointGrid): Plane {
  const pairs: [Triple, Triple][] = [];
  for (const sample of samples) {
    const near = grid.nearest(mirrored(sample, plane));
    if (near !== null) pairs.push([sample, near]);
  }
  if (pairs.length < 10) return plane;
  const centre = mean_of(pairs.flat());
  const sum = [0, 1, 2].map((i) =>
    [0, 1, 2].map((j) => pairs.reduce((all, [p, q]) => all + (p[i] - centre[i]) * (q[j] - centre[j]) + (q[i] - centre[i]) * (p[j] - centre[j]), 0)),
  );
  const normal = eigen_of(sum).vectors[0] as Triple;
  return { normal, offset: dot(normal, centre), misfit: 0 };
}
