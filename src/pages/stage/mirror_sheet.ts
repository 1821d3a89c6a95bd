import { type Box3, BufferAttribute, BufferGeometry, DoubleSide, Group, Mesh, MeshBasicMaterial, Vector3 } from "three";

import type { Plane } from "../maths/mirror";
import { section } from "../maths/section";
import { Lines } from "./lines";

const colour = "#8a5cf0";
const margin = 1.06; // of the model's extent, so that the sheet protrudes all round

/** A plane that a model is mirrored by: a sheet through it, and the line in which it cuts the model. */
export class MirrorSheet {
  readonly object = new Group();
  private readonly geometry = new BufferGeometry();
  private readonly lines: Lines;

  constructor(private readonly box: Box3, nearer: number) {
    const material = new MeshBasicMaterial({ color: colour, transparent: true, opacity: 0.16, side: DoubleSide, depthWrite: false });
    const sheet = new Mesh(this.geometry, material);
    sheet.frustumCulled = false;
    sheet.renderOrder = 1;
    this.lines = new Lines(nearer);
    this.object.add(sheet, this.lines.object);
    this.object.visible = false;
  }

  show(plane: Plane | null, places: Float32Array, faces: Uint32Array): void {
    this.object.visible = plane !== null;
    if (plane === null) return;
    const corners = this.corners(plane);
    this.geometry.setAttribute("position", new BufferAttribute(new Float32Array(corners.flatMap((corner) => corner.toArray())), 3));
    this.geometry.setIndex([0, 1, 2, 0, 2, 3]);
    const outline = [...corners, corners[0]].map((corner) => corner.toArray());
    const cuts = section(places, faces, plane).map((points) => ({ points, colour, width: 2 }));
    this.lines.set([{ points: outline, colour, width: 1.5 }, ...cuts]);
  }

  /** Of a rectangle in the plane that holds the box's outline. */
  private corners(plane: Plane): Vector3[] {
    const normal = new Vector3(...plane.normal);
    const middle = this.box.getCenter(new Vector3());
    middle.addScaledVector(normal, plane.offset - normal.dot(middle));
    const size = this.box.getSize(new Vector3());
    // Upright along the coordinate axis that leans least out of the plane.
    const axes = [new Vector3(0, 1, 0), new Vector3(0, 0, 1), new Vector3(1, 0, 0)];
    const upright = axes.reduce((best, axis) => (Math.abs(axis.dot(normal)) < Math.abs(best.dot(normal)) - 0.1 ? axis : best));
    const up = upright.clone().addScaledVector(normal, -upright.dot(normal)).normalize();
    const right = new Vector3().crossVectors(up, normal);
    const half = (way: Vector3): number => (margin / 2) * (Math.abs(way.x) * size.x + Math.abs(way.y) * size.y + Math.abs(way.z) * size.z);
    const corner = (u: number, v: number): Vector3 => middle.clone().addScaledVector(right, u * half(right)).addScaledVector(up, v * half(up));
    return [corner(-1, -1), corner(1, -1), corner(1, 1), corner(-1, 1)];
  }
}
