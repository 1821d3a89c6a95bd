import type { Stage } from "./stage";

const radians_per_pixel = 0.008;
const wheel_rate = 0.0015; // per pixel of wheel travel: a notch of 100 zooms by 16 %
const key_turn = 0.12; // radians a key press
const key_pan = 30; // pixels a key press
const key_zoom = 1.15;

export interface ClickListener {
  /** A press and release without dragging, at CSS pixels of the canvas. */
  click(x: number, y: number): void;
  hover(x: number, y: number): void;
  leave(): void;
  /** May take over a drag that begins at a place; then gets its moves until the release. */
  grab?(x: number, y: number): { move(x: number, y: number): void; release(): void } | null;
}

interface Finger {
  x: number;
  y: number;
}

/** Mouse, touch and keyboard on the stage: orbit, pan, zoom, reset, views. */
export function add_controls(stage: Stage, listener: ClickListener): void {
  const canvas = stage.canvas;
  const fingers = new Map<number, Finger>();
  let travelled = 0;
  let is_panning = false;
  let grabbed: { move(x: number, y: number): void; release(): void } | null = null;

  const place = (event: PointerEvent | WheelEvent): Finger => {
    const box = canvas.getBoundingClientRect();
    return { x: event.clientX - box.left, y: event.clientY - box.top };
  };

  canvas.addEventListener("pointerdown", (event) => {
    canvas.focus({ preventScroll: true });
    canvas.setPointerCapture(event.pointerId);
    const at = place(event);
    fingers.set(event.pointerId, at);
    travelled = 0;
    is_panning = event.button !== 0 || event.shiftKey;
    grabbed?.release(); // a second finger ends what the first one drags
    grabbed = fingers.size === 1 && event.button === 0 ? (listener.grab?.(at.x, at.y) ?? null) : null;
  });

  canvas.addEventListener("pointermove", (event) => {
    const now = place(event);
    const before = fingers.get(event.pointerId);
    if (before === undefined) return listener.hover(now.x, now.y);
    const dx = now.x - before.x, dy = now.y - before.y;
    travelled += Math.abs(dx) + Math.abs(dy);
    if (grabbed !== null) grabbed.move(now.x, now.y);
    else if (fingers.size === 2) pinch(event.pointerId, before, now);
    else if (is_panning) stage.pan(dx, dy);
    else stage.orbit(-dx * radians_per_pixel, dy * radians_per_pixel);
    fingers.set(event.pointerId, now);
  });

  const pinch = (id: number, before: Finger, now: Finger): void => {
    const other = [...fingers].find(([key]) => key !== id)?.[1];
    if (other === undefined) return;
    const apart = (finger: Finger): number => Math.max(1, Math.hypot(finger.x - other.x, finger.y - other.y));
    stage.zoom(apart(before) / apart(now));
    stage.pan((now.x - before.x) / 2, (now.y - before.y) / 2);
  };

  const released = (event: PointerEvent): void => {
    if (!fingers.delete(event.pointerId)) return;
    const max_travel = 5; // pixels that a hand trembles
    if (grabbed !== null) grabbed.release();
    if (event.type === "pointerup" && travelled <= max_travel && event.button === 0 && fingers.size === 0) {
      const at = place(event);
      listener.click(at.x, at.y);
    }
    grabbed = null;
  };
  canvas.addEventListener("pointerup", released);
  canvas.addEventListener("pointercancel", released);
  canvas.addEventListener("pointerleave", () => listener.leave());
  canvas.addEventListener("contextmenu", (event) => event.preventDefault());
  canvas.addEventListener(
    "wheel",
    (event) => {
      event.preventDefault();
      stage.zoom(Math.exp(event.deltaY * wheel_rate));
    },
    { passive: false },
  );
  canvas.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const action = keys(stage, event.shiftKey)[event.key];
    if (action === undefined) return;
    event.preventDefault();
    action();
  });
}

function keys(stage: Stage, shift: boolean): Record<string, () => void> {
  const arrow = (right: number, up: number): (() => void) =>
    shift ? () => stage.pan(-right * key_pan, up * key_pan) : () => stage.orbit(right * key_turn, up * key_turn);
  return {
    ArrowLeft: arrow(-1, 0),
    ArrowRight: arrow(1, 0),
    ArrowUp: arrow(0, 1),
    ArrowDown: arrow(0, -1),
    "+": () => stage.zoom(1 / key_zoom),
    "=": () => stage.zoom(1 / key_zoom),
    "-": () => stage.zoom(key_zoom),
    Home: () => stage.reset(),
    "0": () => stage.reset(),
    "1": () => stage.look_from("front"),
    "2": () => stage.look_from("side"),
    "3": () => stage.look_from("top"),
  };
}
