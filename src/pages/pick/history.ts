import type { Triple } from "../scene/scene";

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

/** The pairs with everything that can be undone; every change is kept in the browser's storage. */
export class History {
  private past: PickedPair[][] = [];
  private future: PickedPair[][] = [];
  pairs: PickedPair[] = [];

  constructor(private readonly key: string, first: PickedPair[], private readonly changed: () => void) {
    this.pairs = first;
    try {
      const kept = localStorage.getItem(key);
      if (kept !== null) this.pairs = JSON.parse(kept) as PickedPair[];
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

  /** Changes a copy of the pairs; what `edit` leaves is the new state. */
  change(edit: (pairs: PickedPair[]) => void): void {
    this.past.push(structuredClone(this.pairs));
    this.future = [];
    edit(this.pairs);
    this.keep();
  }

  /** While a point is dragged: the same step, again and again. */
  change_again(edit: (pairs: PickedPair[]) => void): void {
    edit(this.pairs);
    this.keep();
  }

  undo(): void {
    this.step(this.past, this.future);
  }
  redo(): void {
    this.step(this.future, this.past);
  }

  private step(from: PickedPair[][], to: PickedPair[][]): void {
    const next = from.pop();
    if (next === undefined) return;
    to.push(this.pairs);
    this.pairs = next;
    this.keep();
  }

  private keep(): void {
    try {
      localStorage.setItem(this.key, JSON.stringify(this.pairs));
    } catch {
      // As above.
    }
    this.changed();
  }
}
