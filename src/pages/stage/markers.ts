import { BufferAttribute, BufferGeometry, GLSL3, GreaterDepth, Group, LessEqualDepth, Points, ShaderMaterial, Vector3 } from "three";

export type MarkerSize = "small" | "plain" | "large";

const shares: Record<MarkerSize, number> = { small: 0.3, plain: 0.5, large: 0.75 };

/** Discs of a few pixels that lie in front a little, so that the surface does not hide those on it; faint where something does. */
export class Markers {
  readonly object = new Group();
  private readonly geometry = new BufferGeometry();

  /** nearer: how far in front they are drawn, mesh units; size: of a plain one, pixels. */
  constructor(nearer: number, private readonly size = 11) {
    this.add(nearer, LessEqualDepth, 1);
    this.add(nearer, GreaterDepth, 0.22);
    this.set([], []);
  }

  private add(nearer: number, depthFunc: typeof LessEqualDepth | typeof GreaterDepth, opacity: number): void {
    const material = new ShaderMaterial({
      glslVersion: GLSL3,
      transparent: true,
      depthFunc,
      depthWrite: false,
      uniforms: { nearer: { value: nearer }, opacity: { value: opacity } },
      vertexShader: `
        in vec4 tint;
        uniform float nearer;
        out vec4 v_tint;
        void main() {
          v_tint = tint;
          vec4 seen = viewMatrix * vec4(position, 1.0);
          vec4 before = projectionMatrix * (seen + vec4(0.0, 0.0, nearer, 0.0));
          gl_Position = projectionMatrix * seen;
          gl_Position.z = before.z / before.w * gl_Position.w;
          gl_PointSize = float(${this.size}) * tint.a * 2.0;
        }`,
      fragmentShader: `
        in vec4 v_tint;
        uniform float opacity;
        out vec4 fragment;
        void main() {
          float from_middle = length(gl_PointCoord - 0.5) * 2.0;
          if (from_middle > 1.0) discard;
          fragment = vec4(from_middle > 0.72 ? vec3(1.0) : v_tint.rgb, opacity);
        }`,
    });
    const points = new Points(this.geometry, material);
    points.frustumCulled = false;
    points.renderOrder = 3;
    this.object.add(points);
  }

  /** Colours as #rrggbb. */
  set(points: Vector3[], colours: string[], sizes: MarkerSize[] = []): void {
    const places = new Float32Array(3 * points.length);
    const tints = new Float32Array(4 * points.length);
    points.forEach((point, i) => {
      point.toArray(places, 3 * i);
      const colour = parseInt(colours[i].slice(1), 16);
      tints.set([(colour >> 16) / 255, ((colour >> 8) & 255) / 255, (colour & 255) / 255, shares[sizes[i] ?? "plain"]], 4 * i);
    });
    this.geometry.setAttribute("position", new BufferAttribute(places, 3));
    this.geometry.setAttribute("tint", new BufferAttribute(tints, 4));
    this.object.visible = points.length > 0;
  }
}
