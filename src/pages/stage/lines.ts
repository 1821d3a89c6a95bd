import { BufferAttribute, BufferGeometry, GLSL3, GreaterDepth, Group, LessEqualDepth, Mesh, ShaderMaterial, Vector4, type WebGLRenderer } from "three";

import type { Triple } from "../scene/scene";

export interface Line {
  points: Triple[];
  /** #rrggbb. */
  colour: string;
  /** CSS pixels. */
  width: number;
}

// Each piece is a rectangle of the screen between its two ends, a little nearer to the eye than the surface that it lies on.
const vertex_program = `
  in vec3 other_end;
  in vec4 tint;
  in float offset;
  uniform vec4 viewport;
  uniform float nearer;
  out vec3 v_tint;
  vec4 placed(vec3 point) {
    vec4 seen = viewMatrix * vec4(point, 1.0);
    vec4 clip = projectionMatrix * seen;
    vec4 before = projectionMatrix * (seen + vec4(0.0, 0.0, nearer, 0.0));
    clip.z = before.z / before.w * clip.w;
    return clip;
  }
  void main() {
    v_tint = tint.rgb;
    vec4 here = placed(position), there = placed(other_end);
    vec2 way = (there.xy / there.w - here.xy / here.w) * viewport.zw;
    vec2 along = length(way) > 0.0 ? normalize(way) : vec2(1.0, 0.0);
    // Half a width beyond the end as well, so that pieces that turn leave no gap.
    vec2 aside = vec2(-along.y, along.x) * offset - along * abs(offset);
    gl_Position = here;
    gl_Position.xy += aside * tint.a / viewport.zw * here.w;
  }`;

const fragment_program = `
  in vec3 v_tint;
  uniform float opacity;
  out vec4 fragment;
  void main() { fragment = vec4(v_tint, opacity); }`;

/** Lines of a few pixels' width on a surface; faint where it hides them. */
export class Lines {
  readonly object = new Group();
  private readonly geometry = new BufferGeometry();

  /** nearer: how far in front of the surface they are drawn, mesh units. */
  constructor(nearer: number) {
    for (const [depth, opacity] of [[LessEqualDepth, 1], [GreaterDepth, 0.16]] as const) {
      const viewport = new Vector4(0, 0, 1, 1);
      const material = new ShaderMaterial({
        glslVersion: GLSL3, vertexShader: vertex_program, fragmentShader: fragment_program,
        uniforms: { viewport: { value: viewport }, nearer: { value: nearer }, opacity: { value: opacity } },
        depthFunc: depth, depthWrite: false, transparent: true,
      });
      const mesh = new Mesh(this.geometry, material);
      mesh.frustumCulled = false;
      mesh.renderOrder = 2;
      mesh.onBeforeRender = (renderer: WebGLRenderer) => {
        renderer.getCurrentViewport(viewport).divideScalar(renderer.getPixelRatio());
      };
      this.object.add(mesh);
    }
    this.set([]);
  }

  set(lines: Line[]): void {
    const pieces = lines.reduce((sum, line) => sum + Math.max(0, line.points.length - 1), 0);
    const places = new Float32Array(12 * pieces), others = new Float32Array(12 * pieces), tints = new Float32Array(16 * pieces), offsets = new Float32Array(4 * pieces);
    const corners = new Uint32Array(6 * pieces);
    let piece = 0;
    for (const { points, colour, width } of lines) {
      const number = parseInt(colour.slice(1), 16);
      const tint = [(number >> 16) / 255, ((number >> 8) & 255) / 255, (number & 255) / 255, width];
      for (let i = 1; i < points.length; ++i, ++piece) {
        // Seen from either end the other's left is its right, so that equal offsets lie at opposite sides.
        for (let corner = 0; corner < 4; ++corner) {
          places.set(points[corner < 2 ? i - 1 : i], 12 * piece + 3 * corner);
          others.set(points[corner < 2 ? i : i - 1], 12 * piece + 3 * corner);
          tints.set(tint, 16 * piece + 4 * corner);
          offsets[4 * piece + corner] = corner % 2 === 0 ? 1 : -1;
        }
        corners.set([0, 1, 2, 0, 2, 3].map((corner) => 4 * piece + corner), 6 * piece);
      }
    }
    this.geometry.setAttribute("position", new BufferAttribute(places, 3));
    this.geometry.setAttribute("other_end", new BufferAttribute(others, 3));
    this.geometry.setAttribute("tint", new BufferAttribute(tints, 4));
    this.geometry.setAttribute("offset", new BufferAttribute(offsets, 1));
    this.geometry.setIndex(new BufferAttribute(corners, 1));
    this.object.visible = pieces > 0;
  }
}
