import { parse_both_sides, parse_side } from "../anchor_files/anchor_files";
import { is_object, parsed_json } from "../anchor_files/file_text";
import { anchor_formats, type AnchorFormat, format_of } from "../anchor_files/format";
import { are_named_alike, paired } from "../anchor_files/paired_sides";
import type { FileSide } from "../anchor_files/side";
import { element } from "../controls/elements";
import type { Triple } from "../scene/scene";
import { type Side, sides } from "./curves";
import type { ModelsOfFiles } from "./file_models";
import { parse_json } from "./formats";
import type { Work } from "./history";

interface OpenedFile {
  name: string;
  text: string;
  format: AnchorFormat;
}

export interface ImportListener {
  /** What the files hold; lists that they have no place for are missing. */
  read(work: Partial<Work>, files: string): void;
  refused(reason: string): void;
  /** Of files with one side each the other is needed, or the user's consent. */
  asked(question: string): void;
}

const endings = [".json", ".csv", ".pp", ".fcsv", ".pts", ".txt"];
const models_of: Record<Side, string> = { a: "Source", b: "Target" };

/** Opens anchors files; where each side has its own, shows which belongs to which model before it takes them. */
export class ImportPanel {
  readonly body: HTMLElement;
  private readonly input = element("input", { type: "file", accept: endings.join(), multiple: true, hidden: true, onchange: () => void this.open() });
  private readonly form = element("div", { role: "group", "aria-label": "Files with one side each", class: "form", hidden: true });
  /** The source's, then the target's; a single one may be either's. */
  private waiting: OpenedFile[] = [];

  constructor(private readonly models: ModelsOfFiles, message: HTMLElement, private readonly listener: ImportListener) {
    this.body = element("div", {}, element("p", {}, element("button", { type: "button", onclick: () => this.input.click() }, "Open files"), this.input), message, this.form);
  }

  private async open(): Promise<void> {
    const chosen = [...(this.input.files ?? [])];
    this.input.value = "";
    if (chosen.length === 0) return;
    await this.attempt(async () => this.add(await Promise.all(chosen.map(opened))));
  }

  /** A refused file changes nothing. */
  private async attempt(action: () => Promise<void> | void): Promise<void> {
    try {
      await action();
    } catch (error) {
      this.listener.refused(error instanceof Error ? error.message : String(error));
    }
  }

  private add(files: OpenedFile[]): void {
    const completes = this.waiting.length === 1 && files.length === 1 && files[0].format === this.waiting[0].format;
    const all = completes ? [...this.waiting, ...files] : files;
    require_sides(all);
    if (!anchor_formats[all[0].format].per_side) {
      this.listener.read(this.whole(all[0]), all[0].name);
      return this.close();
    }
    this.waiting = this.arranged(all);
    this.listener.asked(all.length === 1 ? `${all[0].name} holds one side of the pairs.` : "Each file holds one side of the pairs. Is each with its model?");
    this.show_form();
  }

  private whole(file: OpenedFile): Partial<Work> {
    if (file.format !== "json") return parse_both_sides(file.text, file.format, file.name, this.models);
    const document = parsed_json(file.text, file.name);
    try {
      if (!is_object(document)) throw new Error('must be an object with a key "pairs"');
      return parse_json(document);
    } catch (error) {
      throw new Error(`${file.name}: ${error instanceof Error ? error.message : String(error)}`);
    }
  }

  // ---- files with one side each

  private side(file: OpenedFile, side: Side): FileSide {
    return parse_side(file.text, file.format, file.name, side, this.models);
  }

  /** Both sides as they are arranged. */
  private both(files: OpenedFile[]): { pairs: Work["pairs"]; curves: Work["curves"] } {
    return paired(this.side(files[0], "a"), this.side(files[1], "b"), [files[0].name, files[1].name]);
  }

  /** Of a file that may be either side's; triangles of the one need not be there on the other. */
  private either_side(file: OpenedFile): FileSide {
    try {
      return this.side(file, "a");
    } catch (error) {
      try {
        return this.side(file, "b");
      } catch {
        throw error;
      }
    }
  }

  /** In the order in which the points lie nearer to their models; as they come where that says nothing. */
  private arranged(files: OpenedFile[]): OpenedFile[] {
    if (files.length === 1) this.either_side(files[0]);
    if (files.length === 1) return files;
    const found = [files, [...files].reverse()].map((order) => {
      try {
        this.both(order);
        return { order, off: order.reduce((sum, file, i) => sum + (this.models.distance(sides[i], points_of(this.side(file, sides[i]))) ?? 0), 0), error: null };
      } catch (error) {
        return { order, off: Infinity, error };
      }
    });
    const best = found.reduce((least, each) => (each.off < least.off ? each : least));
    if (best.error !== null) throw best.error;
    return best.order;
  }

  private show_form(): void {
    const [first, second] = this.waiting;
    const button = (label: string, action: () => void, name = ""): HTMLElement => element("button", { type: "button", class: name, onclick: action }, label);
    const main = second === undefined ? button("Choose the other file", () => this.input.click(), "main") : button("Import these", () => void this.attempt(() => this.take()), "main");
    const swap = (): void => {
      this.waiting.reverse();
      this.show_form();
    };
    const system = this.models.system_row(() => this.show_form());
    this.form.replaceChildren(
      element("table", {}, element("tbody", {}, ...(second === undefined ? [this.row(first, "")] : sides.map((side, i) => this.row(this.waiting[i], side))))),
      anchor_formats[first.format].of_patient ? system : "",
      element("p", { class: "soft" }, second === undefined ? "" : this.pairing()),
      element("p", { class: "actions" }, main, ...(second === undefined ? [] : [button("Swap the files", swap)]), button("Cancel", () => this.cancel())));
    const had_focus = document.activeElement;
    this.form.hidden = false;
    if (had_focus === document.body || had_focus === null || !this.form.contains(had_focus)) main.focus();
  }

  private row(file: OpenedFile, side: Side | ""): HTMLElement {
    return element("tr", {}, element("th", { scope: "row" }, side === "" ? "One side" : models_of[side]), element("td", { class: "text" }, file.name, element("div", { class: "soft" }, this.content(file, side))));
  }

  private content(file: OpenedFile, side: Side | ""): string {
    try {
      const read = side === "" ? this.either_side(file) : this.side(file, side);
      const counted = (count: number, one: string): string => `${count} ${one}${count === 1 ? "" : "s"}`;
      const median = side === "" || anchor_formats[file.format].of_model ? null : this.models.distance(side, points_of(read));
      return [counted(read.points.length, "point"), ...(read.lines.length === 0 ? [] : [counted(read.lines.length, "curve")]), ...(side === "" || median === null ? [] : [this.models.place(side, median)])].join(", ");
    } catch (error) {
      return error instanceof Error ? error.message : String(error);
    }
  }

  private pairing(): string {
    try {
      const [a, b] = this.waiting.map((file, i) => this.side(file, sides[i]));
      return are_named_alike(a.points, b.points) ? "Points of one name become pairs." : "The first points become a pair, then the second ones, and so on: the files do not name the same points.";
    } catch {
      return ""; // its row says what is wrong
    }
  }

  private take(): void {
    const { pairs, curves } = this.both(this.waiting);
    const files = `${this.waiting[0].name} (source) and ${this.waiting[1].name} (target)`;
    this.listener.read({ ...(pairs.length === 0 && curves.length > 0 ? {} : { pairs }), ...(curves.length === 0 ? {} : { curves }) }, files);
    this.close();
  }

  private cancel(): void {
    this.close();
    this.listener.asked("");
  }

  private close(): void {
    const had_focus = this.form.contains(document.activeElement);
    this.waiting = [];
    this.form.hidden = true;
    this.form.replaceChildren();
    if (had_focus) this.body.querySelector("button")?.focus();
  }
}

function points_of(side: FileSide): Triple[] {
  return [...side.points.map((point) => point.x), ...side.lines.flatMap((line) => line.points)];
}

async function opened(file: File): Promise<OpenedFile> {
  const text = await file.text();
  return { name: file.name, text, format: format_of(file.name, text) };
}

function require_sides(files: OpenedFile[]): void {
  const whole = files.find((file) => !anchor_formats[file.format].per_side);
  if (files.length > 1 && whole !== undefined) throw new Error(`${whole.name} has both sides in one file: choose it alone`);
  if (files.length > 2) throw new Error(`${files.length} files were chosen: choose two, one of the source and one of the target`);
  if (files.length === 2 && files[0].format !== files[1].format) throw new Error(`${files[1].name} is of another format than ${files[0].name}`);
}
