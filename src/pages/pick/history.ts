import type { Triple } from "../scene/scene";
import type { PickedCurve } from "./curves";
import { UndoLog } from "./undo_log";

/** A pair as it is being picked: either end may still be missing. */
export interface PickedPair {
  name: string;
  a: Triple | null;
  b: Triple | null;
  /** Standard deviation of a coordinate, mesh units; null leaves it to the fit. */
  sigma: number | null;
  weight: number | null;
}

export interface CompletePair extends PickedPair {
  a: Triple;
  b: Triple;
}

export function is_complete(pair: PickedPair): pair is CompletePair {
  return pair.a !== null && pair.b !== null;
}

/** All that is picked. */
export interface Work {
  pairs: PickedPair[];
  /** Borders of patches are among them. */
  curves: PickedCurve[];
  /** Those given by numbers of faces, as the file has them: kept, with nothing to edit them. */
  patches: Record<string, unknown>[];
}

/** A copy that shares points and lines: these are replaced, never changed in place, and what is known of them stays known. */
function copy_of({ pairs, curves, patches }: Work): Work {
  return { pairs: pairs.map((pair) => ({ ...pair })), curves: curves.map((curve) => ({ ...curve })), patches };
}

/** The pairs, curves and patches, with everything that can be undone. */
export class History extends UndoLog<Work> {
  constructor(key: string, work: Work, read: (kept: string) => Work, changed: () => void) {
    super(key, work, read, copy_of, changed);
  }

  get pairs(): PickedPair[] {
    return this.work.pairs;
  }
  get curves(): PickedCurve[] {
    return this.work.curves;
  }
}
