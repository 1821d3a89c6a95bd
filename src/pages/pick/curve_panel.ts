import { choice, element } from "../controls/elements";
import { shown } from "../maths/numbers";
import { check_curves, curve_name } from "./curve_checks";
import { colour_of, type CurveEditor } from "./curve_editor";
import { is_patch, kind_of, kinds, line_length, model_of, type PickedCurve, type Side, sides } from "./curves";
import type { CompletePair, History } from "./history";
import { check_patches } from "./patch_checks";

/** What is said about patches that the page has nothing to edit with; empty without. */
export function kept_patches(count: number): string {
  if (count === 0) return "";
  return `${count} ${count === 1 ? "patch" : "patches"} given by face numbers ${count === 1 ? "is" : "are"} kept for saving, unseen and unchanged.`;
}

const meanings: Record<PickedCurve["meaning"], string> = {
  line: "A line is registered to its counterpart; the fit finds the positions along it, except at paired points.",
  patch: "What lies inside goes inside, border onto border. The inside is tinted: the side with less area. Single points of a border are not fixed together.",
  exclude: "The hatched inside, the side with less area, attracts nothing and is drawn nowhere. It may be on one model alone.",
};

/** The list of curves and patches beside that of pairs, and what can be done to the chosen one. */
export class CurvePanel {
  readonly body: HTMLElement;
  private readonly list = element("tbody", {});
  private readonly warnings = element("ul", { class: "plain", role: "status", "aria-label": "Warnings about curves" });
  private patch_warnings: string[] = [];
  private readonly kept = element("p", { class: "soft" });
  private readonly detail = element("div", { role: "group", "aria-label": "Chosen curve" });

  constructor(private readonly history: History, private readonly editor: CurveEditor, private readonly stages: { refresh(): void; draw(): void }, message: HTMLElement, mirror: HTMLElement) {
    const heads = ["", "name", "kind", "source", "target", ""].map((head) => element("th", { scope: "col" }, head));
    const button = (label: string, onclick: () => void): HTMLElement => element("button", { type: "button", onclick }, label);
    this.body = element("section", {},
      element("p", { class: "soft" }, "Click points along a line of the source, then along its counterpart on the target: they are joined along the surface. A click on the first point closes the line, one on the line adds a point, Delete takes the chosen point away. Drag points to move them. What a closed line encloses can be a patch."),
      this.warnings,
      element("table", { class: "curves" }, element("thead", {}, element("tr", {}, ...heads)), this.list),
      this.kept,
      element("p", { class: "actions" }, button("New curve", () => this.editor.begin()), button("New patch", () => this.editor.begin("patch")), mirror),
      message,
      this.detail);
  }

  show(pairs: CompletePair[]): void {
    const { curves, work } = this.history;
    // What borders enclose is found when a drag ends.
    if (!this.editor.is_dragging) this.patch_warnings = check_patches(work, pairs, { a: this.editor.patched("a"), b: this.editor.patched("b") });
    this.warnings.replaceChildren(...[...check_curves(curves, pairs), ...this.patch_warnings].map((text) => element("li", { class: "warn" }, text)));
    this.keeping_focus(() => this.list.replaceChildren(...curves.map((curve, i) => this.row(curve, i))));
    this.kept.textContent = kept_patches(work.patches.length);
    this.kept.hidden = work.patches.length === 0;
    this.detail.replaceChildren(...this.details());
  }

  /** The rows are made anew: what has the focus is the control at the same place of the new ones. */
  private keeping_focus(make: () => void): void {
    const controls = (): HTMLElement[] => [...this.list.querySelectorAll<HTMLElement>("button, input, select")];
    const at = controls().indexOf(document.activeElement as HTMLElement);
    make();
    if (at >= 0) controls()[at]?.focus();
  }

  private row(curve: PickedCurve, index: number): HTMLElement {
    const label = curve_name(curve, index);
    const choose = (): void => {
      this.editor.choose(index);
      this.stages.refresh();
    };
    const name = element("input", { type: "text", value: curve.name, "aria-label": `Name of curve ${index + 1}`, class: "name", onfocus: () => this.mark(index) });
    name.addEventListener("change", () => this.history.change(({ curves }) => (curves[index].name = name.value.trim())));
    const options = kinds.map((kind, i) => ({ value: String(i), label: kind.label }));
    const kind = choice(options, String(kinds.indexOf(kind_of(curve))), (chosen) => this.editor.set_kind(kinds[Number(chosen)], index), `Kind of ${label}`);
    const swatch = element("button", { type: "button", class: "swatch", title: "Choose this one", "aria-label": `Choose ${label}`, "aria-pressed": String(index === this.editor.chosen), onclick: choose });
    swatch.style.background = colour_of(index);
    const extent = (side: Side): string => {
      const count = curve[side].points.length;
      return count === 0 ? "–" : count === 1 ? "1 point" : shown(line_length(curve[side]));
    };
    return element("tr", { class: index === this.editor.chosen ? "chosen" : "" },
      element("td", {}, swatch), element("td", {}, name), element("td", {}, kind),
      ...sides.map((side) => element("td", { title: `Length on the ${model_of[side]}` }, extent(side))),
      element("td", {}, element("button", { type: "button", "aria-label": `Delete ${label}`, onclick: () => this.editor.remove(index) }, "×")));
  }

  /** Chooses without making the list anew, which would take the focus from what is being typed. */
  private mark(index: number): void {
    if (index === this.editor.chosen) return;
    this.editor.choose(index);
    [...this.list.children].forEach((row, i) => row.classList.toggle("chosen", i === index));
    this.detail.replaceChildren(...this.details());
    this.stages.draw();
  }

  private details(): HTMLElement[] {
    const curve = this.editor.curve;
    if (curve === null) return this.history.curves.length === 0 ? [] : [element("p", { class: "soft" }, "Nothing is chosen: the next click begins a new curve.")];
    const { point } = this.editor;
    const button = (label: string, disabled: boolean, onclick: () => void): HTMLElement => element("button", { type: "button", disabled, onclick }, label);
    const places = sides.map((side) => (point[side] < 0 ? `none of the ${model_of[side]}` : `${point[side] + 1} of ${curve[side].points.length} of the ${model_of[side]}`));
    const fixed = curve.fixed.map(([i, j]) => `${i + 1} – ${j + 1}`).join(", ");
    return [
      element("h2", {}, `Points of ${curve_name(curve, this.editor.chosen)}`),
      element("p", {}, `Chosen: ${places.join(", ")}.${fixed === "" ? "" : ` Belonging together: ${fixed}.`}${this.inside(curve)}`),
      element("p", { class: "actions" },
        button(this.editor.is_fixed ? "Let the two slide" : "Fix the two together", is_patch(curve) || point.a < 0 || point.b < 0, () => this.editor.fix()),
        ...sides.map((side) => button(`Delete on ${model_of[side]}`, point[side] < 0, () => this.editor.remove_point(side))),
        button("Turn round on target", curve.b.points.length < 2, () => this.editor.turn_target())),
      element("p", { class: "soft" }, meanings[curve.meaning]),
    ];
  }

  /** How much a patch encloses. */
  private inside(curve: PickedCurve): string {
    const shares = sides.flatMap((side) => {
      const enclosed = this.editor.enclosed(curve, side);
      return enclosed === null || enclosed.trouble !== null ? [] : [`${Number((100 * enclosed.share).toPrecision(2))} % of the ${model_of[side]}`];
    });
    return shares.length === 0 ? "" : ` Inside: ${shares.join(", ")}.`;
  }
}
