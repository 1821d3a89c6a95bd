import { BufferAttribute, BufferGeometry, GLSL3, Points, ShaderMaterial, Vector3 } from "three";

/** Discs of a few pixels that always lie in front a little, so that a surface does not hide those on it. */
export class Markers {
  readonly object: Points;
  private readonly geometry = new BufferGeometry();

  constructor(private readonly size = 11) {
    const material = new ShaderMaterial({
      glslVersion: GLSL3,
      transparent: true,
      vertexShader: `
        in vec4 tint;
        out vec4 v_tint;
        void main() {
          v_tint = tint;
          gl_Position = projectionMatrix * viewMatrix * vec4(position, 1.0);
          gl_Position.z -= 0.004 * gl_Position.w;
          gl_PointSize = float(${this.size}) * tint.a * 2.0;
        }`,
      fragmentShader: `
        in vec4 v_tint;
        out vec4 fragment;
        void main() {
          float from_middle = length(gl_PointCoord - 0.5) * 2.0;
          if (from_middle > 1.0) discard;
          fragment = vec4(from_middle > 0.72 ? vec3(1.0) : v_tint.rgb, 1.0);
        }`,
    });
    this.object = new Points(this.geometry, material);
    this.object.frustumCulled = false;
    this.object.renderOrder = 3;
    this.set([], []);
  }

  /** Colours as #rrggbb; those that `large` names are drawn larger. */
  set(points: Vector3[], colours: string[], large: ReadonlySet<number> = new Set()): void {
    const places = new Float32Array(3 * points.length);
    const tints = new Float32Array(4 * points.length);
    points.forEach((point, i) => {
      point.toArray(places, 3 * i);
      const colour = parseInt(colours[i].slice(1), 16);
      tints.set([(colour >> 16) / 255, ((colour >> 8) & 255) / 255, (colour & 255) / 255, large.has(i) ? 0.75 : 0.5], 4 * i);
    });
    this.geometry.setAttribute("position", new BufferAttribute(places, 3));
    this.geometry.setAttribute("tint", new BufferAttribute(tints, 4));
    this.object.visible = points.length > 0;
  }
}
