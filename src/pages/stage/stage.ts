import {
  Camera, Matrix4, Object3D, OrthographicCamera, PerspectiveCamera, Quaternion, Ray, Raycaster, Scene, Vector2,
  Vector3, WebGLRenderer,
} from "three";

import type { Pose } from "../maths/motion";

/** From where the models are seen, in the frame of the source. */
export interface ViewPoint {
  centre: Vector3;
  /** Turn about the upright axis, and above the horizon, radians. */
  yaw: number;
  pitch: number;
  /** Half of what is seen of the height at the centre, mesh units. */
  half_height: number;
  orthographic: boolean;
}

/** One picture beside others: what it shows, and how its camera lies to that of the source. */
export interface Pane {
  label: string;
  scene: Scene;
  pose: Pose;
  /** Where in the stage, as fractions of its size. */
  left: number;
  width: number;
  top: number;
  height: number;
}

const field_of_view = 30; // degrees, upright: little perspective, as in technical pictures
const first_pitch = 0.25; // radians above the horizon
const pitch_limit = Math.PI / 2 - 1e-3;

export type Side = "front" | "side" | "top";

/** The drawing area: panes with linked cameras, drawn only when something changed. */
export class Stage {
  readonly renderer: WebGLRenderer;
  readonly view: ViewPoint = { centre: new Vector3(), yaw: 0.5, pitch: first_pitch, half_height: 1, orthographic: false };
  panes: Pane[] = [];
  upright: "y" | "z" = "y";
  frames_drawn = 0;
  private reset_view = { centre: new Vector3(), half_height: 1 };
  private extent = 1; // of what is shown, mesh units
  private widest = 1; // how wide it is at most, of its height
  private scheduled = false;
  private readonly after_draw: (() => void)[] = [];

  constructor(readonly canvas: HTMLCanvasElement) {
    this.renderer = new WebGLRenderer({ canvas, antialias: true, alpha: true, preserveDrawingBuffer: true });
    this.renderer.setClearColor(0, 0);
    this.renderer.autoClear = false;
    new ResizeObserver(() => this.draw_soon()).observe(canvas);
  }

  on_draw(listener: () => void): void {
    this.after_draw.push(listener);
  }

  draw_soon(): void {
    if (this.scheduled) return;
    this.scheduled = true;
    requestAnimationFrame(() => {
      this.scheduled = false;
      this.draw();
    });
  }

  draw(): void {
    const width = this.canvas.clientWidth, height = this.canvas.clientHeight;
    if (width === 0 || height === 0) return;
    this.renderer.setPixelRatio(Math.min(window.devicePixelRatio, 2));
    this.renderer.setSize(width, height, false);
    this.renderer.setScissorTest(false);
    this.renderer.clear();
    this.renderer.setScissorTest(true);
    for (const pane of this.panes) {
      const [x, y, w, h] = this.rectangle(pane);
      this.renderer.setViewport(x, height - y - h, w, h);
      this.renderer.setScissor(x, height - y - h, w, h);
      this.renderer.render(pane.scene, this.camera(pane));
    }
    this.frames_drawn += 1;
    for (const listener of this.after_draw) listener();
  }

  /** Makes everything within the box (source frame) fit. */
  frame(low: Vector3, high: Vector3): void {
    const size = high.clone().sub(low);
    const tall = this.upright === "y" ? size.y : size.z;
    const wide = Math.hypot(size.x, this.upright === "y" ? size.z : size.y);
    // Seen from a little above, depth adds to the height; from the top a flat thing is as high as it is deep.
    const height = Math.max(tall * Math.cos(first_pitch) + wide * Math.sin(first_pitch), 0.75 * wide);
    const margin = 1.14;
    this.extent = size.length();
    this.widest = wide / height;
    this.reset_view = { centre: low.clone().add(high).multiplyScalar(0.5), half_height: 0.5 * margin * height };
    this.reset();
  }

  reset(): void {
    this.view.yaw = 0.5;
    this.view.pitch = first_pitch;
    this.show_all();
  }

  look_from(side: Side): void {
    this.view.yaw = side === "side" ? Math.PI / 2 : 0;
    this.view.pitch = side === "top" ? pitch_limit : 0;
    this.view.orthographic = true;
    this.show_all();
  }

  fly_to(point_in_source: Vector3, half_height: number): void {
    const from = this.view.centre.clone(), from_height = this.view.half_height;
    const set = (share: number): void => {
      this.view.centre.lerpVectors(from, point_in_source, share);
      this.view.half_height = from_height * (half_height / from_height) ** share;
      this.draw_soon();
    };
    if (window.matchMedia("(prefers-reduced-motion: reduce)").matches) return set(1);
    const start = performance.now(), duration = 350; // ms
    const step = (now: number): void => {
      const share = Math.min(1, (now - start) / duration);
      set(share * share * (3 - 2 * share));
      if (share < 1) requestAnimationFrame(step);
    };
    requestAnimationFrame(step);
  }

  orbit(yaw: number, pitch: number): void {
    this.view.yaw += yaw;
    this.view.pitch = Math.min(pitch_limit, Math.max(-pitch_limit, this.view.pitch + pitch));
    this.draw_soon();
  }

  /** By pixels of the pane. */
  pan(right: number, down: number): void {
    const scale = this.panes.length > 0 ? this.pixel_length(this.panes[0]) : 0;
    const turn = this.turn();
    this.view.centre.add(new Vector3(-right * scale, down * scale, 0).applyQuaternion(turn));
    this.draw_soon();
  }

  zoom(factor: number): void {
    this.view.half_height *= factor;
    this.draw_soon();
  }

  /** The pane under a place of the canvas (CSS pixels), and the ray from the eye through it. */
  ray_at(x: number, y: number): { pane: Pane; ray: Ray } | null {
    for (const pane of this.panes) {
      const [left, top, width, height] = this.rectangle(pane);
      if (x < left || x >= left + width || y < top || y >= top + height) continue;
      const caster = new Raycaster();
      const place = new Vector2((2 * (x - left)) / width - 1, 1 - (2 * (y - top)) / height);
      caster.setFromCamera(place, this.camera(pane));
      return { pane, ray: caster.ray };
    }
    return null;
  }

  /** Where a point of a pane's world is drawn, CSS pixels of the canvas. */
  pixel_of(pane: Pane, point: Vector3): Vector2 {
    const [left, top, width, height] = this.rectangle(pane);
    const camera = this.camera(pane);
    camera.updateMatrixWorld();
    const place = point.clone().project(camera);
    return new Vector2(left + ((place.x + 1) / 2) * width, top + ((1 - place.y) / 2) * height);
  }

  /** How long a CSS pixel of a pane is at the middle of what is seen, mesh units. */
  pixel_length(pane: Pane): number {
    return (2 * this.half_height(pane)) / Math.max(1, this.rectangle(pane)[3]);
  }

  camera(pane: Pane): Camera {
    const [, , width, height] = this.rectangle(pane);
    const aspect = width / Math.max(1, height);
    const half = this.half_height(pane);
    const distance = half / Math.tan((field_of_view * Math.PI) / 360);
    const reach = 20 * this.extent;
    const camera = this.view.orthographic
      ? new OrthographicCamera(-half * aspect, half * aspect, half, -half, -reach, reach + distance)
      : new PerspectiveCamera(field_of_view, aspect, distance / 200, distance + reach);
    const turn = this.turn();
    const eye = this.view.centre.clone().add(new Vector3(0, 0, distance).applyQuaternion(turn));
    const rigid = new Matrix4().setFromMatrix3(pane.pose.turn).setPosition(pane.pose.shift);
    const placed = rigid.multiply(new Matrix4().compose(eye, turn, new Vector3(1, 1, 1)));
    placed.decompose(camera.position, camera.quaternion, camera.scale);
    camera.updateMatrixWorld();
    return camera;
  }

  rectangle(pane: Pane): [number, number, number, number] {
    const width = this.canvas.clientWidth, height = this.canvas.clientHeight;
    const left = Math.round(pane.left * width), top = Math.round(pane.top * height);
    return [left, top, Math.round((pane.left + pane.width) * width) - left, Math.round((pane.top + pane.height) * height) - top];
  }

  private show_all(): void {
    this.view.centre.copy(this.reset_view.centre);
    this.view.half_height = this.reset_view.half_height;
    this.draw_soon();
  }

  /** Half of what a pane shows of the height, mesh units: more than requested where its width would cut something off. */
  private half_height(pane: Pane): number {
    const [, , width, height] = this.rectangle(pane);
    return this.view.half_height * Math.max(1, (this.widest * height) / Math.max(1, width));
  }

  private turn(): Quaternion {
    const yaw = new Quaternion().setFromAxisAngle(new Vector3(0, 1, 0), this.view.yaw);
    const turned = yaw.multiply(new Quaternion().setFromAxisAngle(new Vector3(1, 0, 0), -this.view.pitch));
    if (this.upright === "y") return turned;
    return new Quaternion().setFromAxisAngle(new Vector3(1, 0, 0), Math.PI / 2).multiply(turned);
  }
}

/** A scene of the given objects; three.js objects may be in one scene only, so each pane has objects of its own. */
export function scene_of(objects: Object3D[]): Scene {
  const scene = new Scene();
  for (const object of objects) scene.add(object);
  return scene;
}
