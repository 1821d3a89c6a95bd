import type { Triple } from "../scene/scene";

const faces_per_leaf = 4;
const steps = 1024; // of the curve along each axis

/** The bits of a number, two zeros between each and the next. */
function spread(bits: number): number {
  let value = bits & 0x3ff;
  value = (value | (value << 16)) & 0x030000ff;
  value = (value | (value << 8)) & 0x0300f00f;
  value = (value | (value << 4)) & 0x030c30c3;
  return (value | (value << 2)) & 0x09249249;
}

/** A face and how far it is, squared. */
export interface NearFace {
  face: number;
  squared: number;
}

/** Boxes around faces that are near each other, around two such boxes, and so on: the nearest face without a look at most of them. */
export class FaceTree {
  /** Faces in the order of Morton's curve; each leaf has an equal share of them. */
  private readonly order: Uint32Array;
  private readonly leaves: number;
  /** Least x, y, z and largest of each box: 1 holds all, within box k are 2k and 2k + 1. */
  private readonly boxes: Float64Array;

  /** x, y, z of the vertices; three vertices a face. */
  constructor(private readonly places: Float64Array, private readonly corners: Uint32Array) {
    this.order = this.along_curve();
    this.leaves = 2 ** Math.floor(Math.log2(Math.max(1, this.order.length / faces_per_leaf)));
    this.boxes = this.fitted_boxes();
  }

  get diagonal(): number {
    return Math.hypot(...[6, 7, 8].map((at) => this.boxes[at + 3] - this.boxes[at]));
  }

  /** The face that is nearest by `squared_to`, the first of several; null without faces. */
  nearest(point: Triple, squared_to: (face: number) => number): NearFace | null {
    let best: NearFace | null = null;
    const open = [1];
    for (let box = open.pop(); box !== undefined; box = open.pop()) {
      if (best !== null && this.squared_to_box(point, box) > best.squared) continue;
      if (box < this.leaves) {
        const is_first_nearer = this.squared_to_box(point, 2 * box) <= this.squared_to_box(point, 2 * box + 1);
        open.push(is_first_nearer ? 2 * box + 1 : 2 * box, is_first_nearer ? 2 * box : 2 * box + 1);
        continue;
      }
      for (const face of this.in_leaf(box)) {
        const squared = squared_to(face);
        if (best === null || squared < best.squared || (squared === best.squared && face < best.face)) best = { face, squared };
      }
    }
    return best;
  }

  private in_leaf(box: number): Uint32Array {
    const leaf = box - this.leaves, count = this.order.length;
    return this.order.subarray(Math.floor((leaf * count) / this.leaves), Math.floor(((leaf + 1) * count) / this.leaves));
  }

  private along_curve(): Uint32Array {
    const { places, corners } = this, count = corners.length / 3;
    const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
    for (let i = 0; i < places.length; ++i) {
      low[i % 3] = Math.min(low[i % 3], places[i]);
      high[i % 3] = Math.max(high[i % 3], places[i]);
    }
    const keys = new Float64Array(count);
    for (let face = 0; face < count; ++face) {
      let code = 0;
      for (let axis = 0; axis < 3; ++axis) {
        const middle = (places[3 * corners[3 * face] + axis] + places[3 * corners[3 * face + 1] + axis] + places[3 * corners[3 * face + 2] + axis]) / 3;
        const share = high[axis] > low[axis] ? (middle - low[axis]) / (high[axis] - low[axis]) : 0;
        code += spread(Math.min(steps - 1, Math.floor(share * steps))) * 2 ** axis;
      }
      keys[face] = code * count + face;
    }
    return Uint32Array.from(keys.sort(), (key) => key % count);
  }

  private fitted_boxes(): Float64Array {
    const { places, corners, leaves } = this, boxes = new Float64Array(12 * leaves);
    for (let box = 2 * leaves - 1; box > 0; --box) {
      const at = 6 * box;
      for (let axis = 0; axis < 3; ++axis) {
        let low = Infinity, high = -Infinity;
        if (box < leaves) {
          low = Math.min(boxes[2 * at + axis], boxes[2 * at + 6 + axis]);
          high = Math.max(boxes[2 * at + 3 + axis], boxes[2 * at + 9 + axis]);
        } else {
          for (const face of this.in_leaf(box))
            for (let k = 3 * face; k < 3 * face + 3; ++k) {
              low = Math.min(low, places[3 * corners[k] + axis]);
              high = Math.max(high, places[3 * corners[k] + axis]);
            }
        }
        boxes[at + axis] = low;
        boxes[at + 3 + axis] = high;
      }
    }
    return boxes;
  }

  private squared_to_box(point: Triple, box: number): number {
    let sum = 0;
    for (let axis = 0; axis < 3; ++axis) {
      const outside = Math.max(this.boxes[6 * box + axis] - point[axis], point[axis] - this.boxes[6 * box + 3 + axis], 0);
      sum += outside * outside;
    }
    return sum;
  }
}
