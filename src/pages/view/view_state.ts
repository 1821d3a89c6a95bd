/** What the controls of the view page have set. */
export interface ViewState {
  t: number;
  layout: "side" | "over";
  /** Whether the rigid part is shown; without it everything lies in the source's frame. */
  rigid: boolean;
  hidden: Set<number>;
  opacity: number;
  /** The models that carry the colours, by their numbers in the scene. */
  coloured: number[];
  field: string;
  range: [number, number];
  clip: { on: boolean; axis: 0 | 1 | 2; position: number; flipped: boolean };
  slice: { on: boolean; axis: 0 | 1 | 2; position: number; lines: number; determinant: boolean };
  levels: Set<number>;
  anchors: boolean;
  chosen_anchor: number;
}

export function first_state(): ViewState {
  return {
    t: 1,
    layout: "side",
    rigid: true,
    hidden: new Set(),
    opacity: 0.35,
    coloured: [0],
    field: "",
    range: [0, 1],
    clip: { on: false, axis: 0, position: 0.5, flipped: false },
    slice: { on: false, axis: 2, position: 0.5, lines: 24, determinant: false },
    levels: new Set(),
    anchors: true,
    chosen_anchor: -1,
  };
}
