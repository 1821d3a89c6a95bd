import {
  BufferAttribute, BufferGeometry, DataTexture, DoubleSide, GLSL3, LinearFilter, Matrix3, Mesh, Points, Ray,
  ShaderMaterial, Vector3, Vector4,
} from "three";

import { colour_table } from "../maths/colour_maps";
import type { Place, Pose } from "../maths/motion";

const vertex_program = `
  in vec3 place_after;
  in vec3 normal_after;
  in float value;
  uniform float fraction;
  uniform mat3 turn;
  uniform vec3 shift;
  uniform float point_size;
  out vec3 v_normal;
  out vec3 v_world;
  out float v_value;
  void main() {
    vec3 world = turn * mix(position, place_after, fraction) + shift;
    v_world = world;
    v_normal = mat3(viewMatrix) * (turn * mix(normal, normal_after, fraction));
    v_value = value;
    gl_Position = projectionMatrix * viewMatrix * vec4(world, 1.0);
    gl_PointSize = point_size;
  }`;

const fragment_program = `
  in vec3 v_normal;
  in vec3 v_world;
  in float v_value;
  uniform vec3 plain;
  uniform vec3 unknown;
  uniform float opacity;
  uniform bool coloured;
  uniform vec2 range;
  uniform sampler2D colours;
  uniform bool clipped;
  uniform vec4 clip;
  out vec4 fragment;
  void main() {
    if (clipped && dot(clip.xyz, v_world) > clip.w) discard;
    vec3 colour = plain;
    if (coloured)
      colour = v_value < -1e37 ? unknown
             : texture(colours, vec2(clamp((v_value - range.x) / (range.y - range.x), 0.0, 1.0), 0.5)).rgb;
    // A lamp at the camera; the back is drawn darker, so that a look through a hole is told from the outside.
    float length_of_normal = length(v_normal);
    float facing = length_of_normal > 0.0 ? abs(v_normal.z) / length_of_normal : 1.0;
    float light = 0.38 + 0.62 * facing;
    if (!gl_FrontFacing) light *= 0.72;
    fragment = vec4(colour * light, opacity);
  }`;

const unknown_value = -3e38; // a float that no value reaches; NaN does not survive every driver

function table_texture(is_diverging: boolean): DataTexture {
  const texture = new DataTexture(colour_table(is_diverging), 256, 1);
  texture.minFilter = texture.magFilter = LinearFilter;
  texture.needsUpdate = true;
  return texture;
}

let textures: { magnitude: DataTexture; diverging: DataTexture } | null = null;

function colour_textures(): { magnitude: DataTexture; diverging: DataTexture } {
  textures ??= { magnitude: table_texture(false), diverging: table_texture(true) };
  return textures;
}

/** Angle-weighted enough for shading: areas weigh the faces around a vertex. */
function normals_of(places: Float32Array, faces: Uint32Array): Float32Array {
  const normals = new Float32Array(places.length);
  for (let f = 0; f < faces.length; f += 3) {
    const a = 3 * faces[f], b = 3 * faces[f + 1], c = 3 * faces[f + 2];
    const ux = places[b] - places[a], uy = places[b + 1] - places[a + 1], uz = places[b + 2] - places[a + 2];
    const vx = places[c] - places[a], vy = places[c + 1] - places[a + 1], vz = places[c + 2] - places[a + 2];
    const nx = uy * vz - uz * vy, ny = uz * vx - ux * vz, nz = ux * vy - uy * vx;
    for (const corner of [a, b, c]) {
      normals[corner] += nx;
      normals[corner + 1] += ny;
      normals[corner + 2] += nz;
    }
  }
  for (let i = 0; i < normals.length; i += 3) {
    const length = Math.hypot(normals[i], normals[i + 1], normals[i + 2]) || 1;
    for (let axis = 0; axis < 3; ++axis) normals[i + axis] /= length;
  }
  return normals;
}

export interface Hit {
  vertex: number;
  distance: number;
  point: Vector3;
  face: number;
}

/** A mesh, or points, moved by the graphics card: straight between two knots, then rigidly. */
export class Surface {
  readonly object: Mesh | Points;
  readonly material: ShaderMaterial;
  private readonly geometry = new BufferGeometry();
  private readonly position_attributes: BufferAttribute[];
  private readonly normal_attributes: BufferAttribute[];
  private place: Place = { knot: 0, fraction: 0 };
  private world: Float32Array | null = null;

  /** knots: x, y, z of every vertex at each; faces: three vertices each, none for a set of points. */
  constructor(readonly knots: Float32Array[], readonly faces: Uint32Array, colour: string) {
    this.position_attributes = knots.map((places) => new BufferAttribute(places, 3));
    this.normal_attributes = knots.map((places) => new BufferAttribute(normals_of(places, faces), 3));
    if (faces.length > 0) this.geometry.setIndex(new BufferAttribute(faces, 1));
    this.geometry.setAttribute("value", new BufferAttribute(new Float32Array(knots[0].length / 3), 1));
    this.material = new ShaderMaterial({
      glslVersion: GLSL3,
      vertexShader: vertex_program,
      fragmentShader: fragment_program,
      side: DoubleSide,
      uniforms: {
        fraction: { value: 0 },
        turn: { value: new Matrix3() },
        shift: { value: new Vector3() },
        point_size: { value: 3 },
        plain: { value: new Vector3() },
        unknown: { value: new Vector3(0.6, 0.6, 0.6) },
        opacity: { value: 1 },
        coloured: { value: false },
        range: { value: [0, 1] },
        colours: { value: colour_textures().magnitude },
        clipped: { value: false },
        clip: { value: new Vector4() },
      },
    });
    this.object = faces.length > 0 ? new Mesh(this.geometry, this.material) : new Points(this.geometry, this.material);
    this.object.frustumCulled = false;
    this.set_colour(colour);
    this.attach();
  }

  get vertex_count(): number {
    return this.knots[0].length / 3;
  }

  set_colour(colour: string): void {
    const number = parseInt(colour.slice(1), 16);
    this.uniform<Vector3>("plain").set((number >> 16) / 255, ((number >> 8) & 255) / 255, (number & 255) / 255);
  }

  set_opacity(opacity: number): void {
    this.material.uniforms.opacity.value = opacity;
    this.material.transparent = opacity < 1;
    this.material.depthWrite = opacity >= 1;
    this.object.renderOrder = opacity < 1 ? 1 : 0;
  }

  /** Values by vertex, NaN where unknown; null for the plain colour. */
  set_values(values: Float32Array | null): void {
    this.material.uniforms.coloured.value = values !== null;
    if (values === null) return;
    const attribute = this.geometry.getAttribute("value") as BufferAttribute;
    for (let i = 0; i < values.length; ++i) attribute.array[i] = Number.isNaN(values[i]) ? unknown_value : values[i];
    attribute.needsUpdate = true;
  }

  set_range(low: number, high: number, is_diverging: boolean): void {
    this.material.uniforms.range.value = [low, high > low ? high : low + 1e-30];
    this.material.uniforms.colours.value = is_diverging ? colour_textures().diverging : colour_textures().magnitude;
  }

  set_clip(clip: Vector4 | null): void {
    this.material.uniforms.clipped.value = clip !== null;
    if (clip !== null) this.uniform<Vector4>("clip").copy(clip);
  }

  set_motion(place: Place, pose: Pose): void {
    this.place = this.knots.length > 1 ? place : { knot: 0, fraction: 0 };
    this.material.uniforms.fraction.value = this.place.fraction;
    this.uniform<Matrix3>("turn").copy(pose.turn);
    this.uniform<Vector3>("shift").copy(pose.shift);
    this.attach();
    this.world = null;
  }

  /** Where a vertex is now. */
  at(vertex: number): Vector3 {
    const before = this.knots[this.place.knot];
    const after = this.knots[Math.min(this.place.knot + 1, this.knots.length - 1)];
    const point = new Vector3();
    for (let axis = 0; axis < 3; ++axis) {
      const i = 3 * vertex + axis;
      point.setComponent(axis, before[i] + this.place.fraction * (after[i] - before[i]));
    }
    return point.applyMatrix3(this.uniform<Matrix3>("turn")).add(this.uniform<Vector3>("shift"));
  }

  /** x, y, z of all vertices now. */
  places(): Float32Array {
    if (this.world !== null) return this.world;
    const world = new Float32Array(this.knots[0].length);
    const point = new Vector3();
    for (let v = 0; v < this.vertex_count; ++v) point.copy(this.at(v)).toArray(world, 3 * v);
    this.world = world;
    return world;
  }

  /** Where a ray first meets what is drawn (not what is clipped away). */
  first_hit(ray: Ray): Hit | null {
    const places = this.places();
    const clip = this.material.uniforms.clipped.value ? this.uniform<Vector4>("clip") : null;
    const a = new Vector3(), b = new Vector3(), c = new Vector3(), point = new Vector3();
    let best: Hit | null = null;
    for (let f = 0; f < this.faces.length; f += 3) {
      a.fromArray(places, 3 * this.faces[f]);
      b.fromArray(places, 3 * this.faces[f + 1]);
      c.fromArray(places, 3 * this.faces[f + 2]);
      if (ray.intersectTriangle(a, b, c, false, point) === null) continue;
      if (clip !== null && clip.x * point.x + clip.y * point.y + clip.z * point.z > clip.w) continue;
      const distance = point.distanceTo(ray.origin);
      if (best !== null && distance >= best.distance) continue;
      const corners = [a.distanceToSquared(point), b.distanceToSquared(point), c.distanceToSquared(point)];
      const nearest = corners.indexOf(Math.min(...corners));
      best = { vertex: this.faces[f + nearest], distance, point: point.clone(), face: f / 3 };
    }
    return best;
  }

  /** The vertex nearest to the eye among those within `reach` of a ray. */
  first_point(ray: Ray, reach: number): Hit | null {
    const places = this.places(), point = new Vector3();
    let best: Hit | null = null;
    for (let vertex = 0; vertex < this.vertex_count; ++vertex) {
      point.fromArray(places, 3 * vertex);
      if (ray.distanceSqToPoint(point) > reach * reach) continue;
      const distance = point.distanceTo(ray.origin);
      if (best === null || distance < best.distance) best = { vertex, distance, point: point.clone(), face: -1 };
    }
    return best;
  }

  normal_at(vertex: number): Vector3 {
    const normals = this.normal_attributes[this.place.knot].array;
    return new Vector3().fromArray(normals, 3 * vertex).applyMatrix3(this.uniform<Matrix3>("turn")).normalize();
  }

  dispose(): void {
    this.geometry.dispose();
    this.material.dispose();
  }

  private attach(): void {
    const next = Math.min(this.place.knot + 1, this.knots.length - 1);
    this.geometry.setAttribute("position", this.position_attributes[this.place.knot]);
    this.geometry.setAttribute("normal", this.normal_attributes[this.place.knot]);
    this.geometry.setAttribute("place_after", this.position_attributes[next]);
    this.geometry.setAttribute("normal_after", this.normal_attributes[next]);
  }

  private uniform<T>(name: string): T {
    return this.material.uniforms[name].value as T;
  }
}
