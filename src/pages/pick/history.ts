import type { Triple } from "../scene/scene";
import type { PickedCurve } from "./curves";

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

/** The work with everything that can be undone; every change is kept in the browser's storage. */
export class History {
  private past: Work[] = [];
  private future: Work[] = [];

  constructor(private readonly key: string, public work: Work, read: (kept: string) => Work, private readonly changed: () => void) {
    try {
      const kept = localStorage.getItem(key);
      if (kept !== null) this.work = read(kept);
    } catch {
      // A browser that keeps nothing for files: the page works, a reload begins anew.
    }
  }

  get can_undo(): boolean {
    return this.past.length > 0;
  }
  get can_redo(): boolean {
    return this.future.length > 0;
  }

  get pairs(): PickedPair[] {
    return this.work.pairs;
  }
  get curves(): PickedCurve[] {
    return this.work.curves;
  }

  /** Changes the work; what `edit` leaves is the new state, and what was there before can be had back. */
  change(edit: (work: Work) => void): void {
    this.past.push(copy_of(this.work));
    this.future = [];
    edit(this.work);
    this.keep();
  }

  /** While a point is dragged: the same step, again and again. */
  change_again(edit: (work: Work) => void): void {
    edit(this.work);
    this.keep();
  }

  undo(): void {
    this.step(this.past, this.future);
  }
  redo(): void {
    this.step(this.future, this.past);
  }

  private step(from: Work[], to: Work[]): void {
    const next = from.pop();
    if (next === undefined) return;
    to.push(this.work);
    this.work = next;
    this.keep();
  }

  private keep(): void {
    try {
      localStorage.setItem(this.key, JSON.stringify(this.work));
    } catch {
      // As above.
    }
    this.changed();
  }
}
