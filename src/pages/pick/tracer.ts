import { enclosed_faces, type EnclosedFaces } from "../maths/enclosed_faces";
import { geodesic } from "../maths/geodesic";
import { StripSearch } from "../maths/strip_search";
import { SurfaceGraph } from "../maths/surface_graph";
import type { Triple } from "../scene/scene";
import { polyline, type PickedLine } from "./curves";

/** Lines along one model. What they need to know of its faces is found out when the first is drawn. */
export class Tracer {
  private known: SurfaceGraph | null = null;
  private held: { end: Triple; search: StripSearch }[] = [];
  private readonly enclosed_by = new WeakMap<PickedLine, EnclosedFaces>();

  constructor(private readonly places: Float32Array, private readonly faces: Uint32Array) {}

  /** The nearest place of the surface. */
  nearest(point: Triple): Triple {
    return this.graph.nearest(point).point;
  }

  /** While a point is dragged: the places that it is joined with, from which the search goes on and does not begin anew. */
  hold(ends: Triple[]): void {
    this.held = ends.map((end) => ({ end, search: new StripSearch(this.graph, this.graph.nearest(end)) }));
  }

  /** The locally shortest way between two places of the surface; null between separate pieces. */
  join(from: Triple, to: Triple): Triple[] | null {
    const held = (end: Triple): StripSearch | undefined => this.held.find((each) => each.end === end)?.search;
    const search = held(from), backwards = search === undefined ? held(to) : undefined;
    const way = backwards === undefined ? this.way(from, to, search) : (this.way(to, from, backwards)?.reverse() ?? null);
    // The ends as they were given: rounding of the nearest places would make them others.
    return way === null ? null : [from, ...way.slice(1, -1), to];
  }

  private way(from: Triple, to: Triple, search?: StripSearch): Triple[] | null {
    return geodesic(this.graph, search?.from ?? this.graph.nearest(from), this.graph.nearest(to), search);
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
