/** Work with everything that can be undone; every change is kept in the browser's storage. */
export class UndoLog<Work> {
  private past: Work[] = [];
  private future: Work[] = [];

  /** copy_of: shares what is replaced and never changed in place. */
  constructor(private readonly key: string, public work: Work, read: (kept: string) => Work, private readonly copy_of: (work: Work) => Work, private readonly changed: () => void) {
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

  /** Changes the work; what `edit` leaves is the new state, and what was there before can be had back. */
  change(edit: (work: Work) => void): void {
    this.past.push(this.copy_of(this.work));
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

  /** Ctrl+Z, Ctrl+Y and Ctrl+Shift+Z, except while something is typed. */
  shortcut(event: KeyboardEvent): void {
    const is_typing = event.target instanceof HTMLInputElement && event.target.type !== "checkbox";
    if (is_typing || !(event.ctrlKey || event.metaKey)) return;
    const key = event.key.toLowerCase();
    if (key === "z" && !event.shiftKey) this.undo();
    else if (key === "y" || (key === "z" && event.shiftKey)) this.redo();
    else return;
    event.preventDefault();
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
