import { Matrix3, Matrix4, Quaternion, Vector3 } from "three";

import type { MotionRecord } from "../scene/scene";

/** A rigid motion: x ↦ turn x + shift. */
export interface Pose {
  turn: Matrix3;
  shift: Vector3;
}

/** Which piece between two knots a time lies in, and how far along. */
export interface Place {
  knot: number;
  fraction: number;
}

const smallest_cosine = 1e-12; // as in rigid/rigid_transform.cpp: below it Euler angles are rounding errors

/** Ψ(t) = R(t)·F(t) + t T, with F straight between knots: as `bespoke apply --t` computes it. */
export class Motion {
  private readonly rotation: Matrix3;
  private readonly translation: Vector3;

  constructor(readonly record: MotionRecord) {
    const [x, y, z] = record.rotation;
    this.rotation = new Matrix3().set(...x, ...y, ...z);
    this.translation = new Vector3(...record.translation);
  }

  pose(t: number): Pose {
    return { turn: this.turn(t), shift: this.translation.clone().multiplyScalar(t) };
  }

  place(t: number): Place {
    const knots = this.record.knots;
    let knot = 0;
    while (knot + 2 < knots.length && t >= knots[knot + 1]) ++knot;
    return { knot, fraction: (t - knots[knot]) / (knots[knot + 1] - knots[knot]) };
  }

  private turn(t: number): Matrix3 {
    if (t === 1) return this.rotation.clone();
    return this.record.path === "euler" ? this.euler(t) : this.geodesic(t);
  }

  private geodesic(t: number): Matrix3 {
    const whole = new Quaternion().setFromRotationMatrix(new Matrix4().setFromMatrix3(this.rotation));
    const turned = new Quaternion().slerp(whole, t);
    return new Matrix3().setFromMatrix4(new Matrix4().makeRotationFromQuaternion(turned));
  }

  private euler(t: number): Matrix3 {
    const [r0, r1, r2] = this.record.rotation;
    const cosine = Math.hypot(r0[0], r1[0]);
    const y = Math.atan2(-r2[0], cosine);
    const locked = cosine < smallest_cosine;
    const x = locked ? Math.atan2(-r1[2], r1[1]) : Math.atan2(r2[1], r2[2]);
    const z = locked ? 0 : Math.atan2(r1[0], r0[0]);
    const turned = new Matrix4()
      .makeRotationZ(t * z)
      .multiply(new Matrix4().makeRotationY(t * y))
      .multiply(new Matrix4().makeRotationX(t * x));
    return new Matrix3().setFromMatrix4(turned);
  }
}

export const at_rest: Pose = { turn: new Matrix3(), shift: new Vector3() };

export function inverse_pose(pose: Pose): Pose {
  const turn = pose.turn.clone().transpose();
  return { turn, shift: pose.shift.clone().applyMatrix3(turn).negate() };
}
