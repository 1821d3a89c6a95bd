import type { Triple } from "../scene/scene";
import type { Plane } from "./mirror";

/** Where a plane cuts a mesh: a straight piece in every face that has corners on both sides. */
export function section(places: Float32Array, faces: Uint32Array, { normal, offset }: Plane): [Triple, Triple][] {
  const height = new Float64Array(places.length / 3);
  for (let v = 0; v < height.length; ++v) height[v] = normal[0] * places[3 * v] + normal[1] * places[3 * v + 1] + normal[2] * places[3 * v + 2] - offset;
  const pieces: [Triple, Triple][] = [];
  for (let f = 0; f < faces.length; f += 3) {
    const cuts: Triple[] = [];
    for (let k = 0; k < 3; ++k) {
      const u = faces[f + k], w = faces[f + ((k + 1) % 3)];
      // What lies in the plane counts as above it, so that a face has two cuts or none.
      if (height[u] >= 0 === height[w] >= 0) continue;
      const share = height[u] / (height[u] - height[w]);
      cuts.push([0, 1, 2].map((axis) => places[3 * u + axis] + share * (places[3 * w + axis] - places[3 * u + axis])) as Triple);
    }
    if (cuts.length === 2) pieces.push([cuts[0], cuts[1]]);
  }
  return pieces;
}
