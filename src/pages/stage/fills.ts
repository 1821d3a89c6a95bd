import { BufferAttribute, BufferGeometry, DoubleSide, GLSL3, Mesh, ShaderMaterial, type WebGLRenderer } from "three";

/** A part of a surface, tinted. */
export interface Fill {
  /** By their numbers. */
  faces: Uint32Array;
  /** #rrggbb. */
  colour: string;
  opacity: number;
  is_hatched: boolean;
}

const vertex_program = `
  in vec4 tint;
  in float hatched;
  out vec4 v_tint;
  out float v_hatched;
  void main() {
    v_tint = tint;
    v_hatched = hatched;
    gl_Position = projectionMatrix * viewMatrix * vec4(position, 1.0);
  }`;

// Hatching keeps its width on the screen: half of every eight pixels.
const fragment_program = `
  in vec4 v_tint;
  in float v_hatched;
  uniform float pixel_ratio;
  out vec4 fragment;
  void main() {
    if (v_hatched > 0.5 && mod((gl_FragCoord.x + gl_FragCoord.y) / pixel_ratio, 8.0) > 4.0) discard;
    fragment = v_tint;
  }`;

const is_same = (a: Fill, b: Fill): boolean => a.faces === b.faces && a.colour === b.colour && a.opacity === b.opacity && a.is_hatched === b.is_hatched;

/** Parts of a surface in colours of their own, over it. */
export class Fills {
  readonly object: Mesh;
  private readonly geometry = new BufferGeometry();
  private shown: Fill[] = [];

  /** x, y, z of the vertices; three vertices a face. */
  constructor(private readonly places: Float32Array, private readonly corners: Uint32Array) {
    const material = new ShaderMaterial({
      glslVersion: GLSL3, vertexShader: vertex_program, fragmentShader: fragment_program, side: DoubleSide,
      uniforms: { pixel_ratio: { value: 1 } },
      transparent: true, depthWrite: false, polygonOffset: true, polygonOffsetFactor: -1, polygonOffsetUnits: -2,
    });
    this.object = new Mesh(this.geometry, material);
    this.object.frustumCulled = false;
    this.object.renderOrder = 1;
    this.object.visible = false;
    this.object.onBeforeRender = (renderer: WebGLRenderer) => (material.uniforms.pixel_ratio.value = renderer.getPixelRatio());
  }

  set(fills: Fill[]): void {
    // Requested whenever a point moves, and seldom changed by it.
    if (fills.length === this.shown.length && fills.every((fill, i) => is_same(fill, this.shown[i]))) return;
    this.shown = fills;
    const count = 3 * fills.reduce((sum, fill) => sum + fill.faces.length, 0);
    const places = new Float32Array(3 * count), tints = new Float32Array(4 * count), hatched = new Float32Array(count);
    let at = 0;
    for (const { faces, colour, opacity, is_hatched } of fills) {
      const number = parseInt(colour.slice(1), 16);
      const tint = [(number >> 16) / 255, ((number >> 8) & 255) / 255, (number & 255) / 255, opacity];
      for (const face of faces)
        for (let k = 3 * face; k < 3 * face + 3; ++k, ++at) {
          places.set(this.places.subarray(3 * this.corners[k], 3 * this.corners[k] + 3), 3 * at);
          tints.set(tint, 4 * at);
          hatched[at] = is_hatched ? 1 : 0;
        }
    }
    this.geometry.setAttribute("position", new BufferAttribute(places, 3));
    this.geometry.setAttribute("tint", new BufferAttribute(tints, 4));
    this.geometry.setAttribute("hatched", new BufferAttribute(hatched, 1));
    this.object.visible = count > 0;
  }
}
