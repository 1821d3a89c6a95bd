import { enclosed_faces, type EnclosedFaces } from "../maths/enclosed_faces";
import { geodesic } from "../maths/geodesic";
import { SurfaceGraph } from "../maths/surface_graph";
import type { Triple } from "../scene/scene";
import { polyline, type PickedLine } from "./curves";

/** Lines along one model. What they need to know of its faces is found out when the first is drawn. */
export class Tracer {
  private known: SurfaceGraph | null = null;
  private readonly enclosed_by = new WeakMap<PickedLine, EnclosedFaces>();

  constructor(private readonly places: Float32Array, private readonly faces: Uint32Array) {}

  /** The nearest place of the surface. */
  nearest(point: Triple): Triple {
    return this.graph.nearest(point).point;
  }

  /** The locally shortest way between two places of the surface; null between separate pieces. */
  join(from: Triple, to: Triple): Triple[] | null {
    const way = geodesic(this.graph, this.graph.nearest(from), this.graph.nearest(to));
    // The ends as they were given: rounding of the nearest places would make them others.
    return way === null ? null : [from, ...way.slice(1, -1), to];
  }

  /** What a closed line encloses, found once for each. */
  enclosed(line: PickedLine): EnclosedFaces {
    const known = this.enclosed_by.get(line) ?? enclosed_faces(this.graph, polyline(line, true).points);
    this.enclosed_by.set(line, known);
    return known;
  }

  get graph(): SurfaceGraph {
    this.known ??= new SurfaceGraph(this.places, this.faces);
    return this.known;
  }
}
