import { element } from "../controls/elements";
import { shown } from "../maths/numbers";
import { check_curves, curve_name } from "./curve_checks";
import { curve_colours, type CurveEditor } from "./curve_editor";
import { line_length, type PickedCurve, type Side, sides } from "./curves";
import type { CompletePair, History } from "./history";

const models: Record<Side, string> = { a: "source", b: "target" };

/** The list of curves beside that of pairs, and what can be done to the chosen one. */
export class CurvePanel {
  readonly body: HTMLElement;
  private readonly list = element("tbody", {});
  private readonly warnings = element("ul", { class: "plain", role: "status", "aria-label": "Warnings about curves" });
  private readonly detail = element("div", { role: "group", "aria-label": "Chosen curve" });

  constructor(private readonly history: History, private readonly editor: CurveEditor, private readonly stages: { refresh(): void; draw(): void }, message: HTMLElement, buttons: HTMLElement[]) {
    const heads = ["", "name", "closed", "source", "target", ""].map((head) => element("th", { scope: "col" }, head));
    this.body = element("section", {},
      element("p", { class: "soft" }, "Click points along a line of the source, then along its counterpart on the target: they are joined along the surface. A click on the first point closes the curve, one on its line adds a point, Delete takes the chosen point away. Drag points to move them."),
      this.warnings,
      element("table", {}, element("thead", {}, element("tr", {}, ...heads)), this.list),
      element("p", { class: "actions" }, element("button", { type: "button", onclick: () => this.editor.begin() }, "New curve"), ...buttons),
      message,
      this.detail);
  }

  show(pairs: CompletePair[]): void {
    const { curves } = this.history;
    this.warnings.replaceChildren(...check_curves(curves, pairs).map((text) => element("li", { class: "warn" }, text)));
    this.list.replaceChildren(...curves.map((curve, i) => this.row(curve, i)));
    this.detail.replaceChildren(...this.details());
  }

  private row(curve: PickedCurve, index: number): HTMLElement {
    const label = curve_name(curve, index);
    const choose = (): void => {
      this.editor.choose(index);
      this.stages.refresh();
    };
    const name = element("input", { type: "text", value: curve.name, "aria-label": `Name of curve ${index + 1}`, class: "name", onfocus: () => this.mark(index) });
    name.addEventListener("change", () => this.history.change(({ curves }) => (curves[index].name = name.value.trim())));
    const closed = element("input", { type: "checkbox", checked: curve.closed, "aria-label": `${label} is closed`, onchange: () => this.editor.set_closed(closed.checked, index) });
    const swatch = element("button", { type: "button", class: "swatch", title: "Choose this curve", "aria-label": `Choose ${label}`, "aria-pressed": String(index === this.editor.chosen), onclick: choose });
    swatch.style.background = curve_colours[index % curve_colours.length];
    const extent = (side: Side): string => {
      const count = curve[side].points.length;
      return count === 0 ? "–" : count === 1 ? "1 point" : shown(line_length(curve[side]));
    };
    return element("tr", { class: index === this.editor.chosen ? "chosen" : "" },
      element("td", {}, swatch), element("td", {}, name), element("td", { class: "middle" }, closed),
      ...sides.map((side) => element("td", { title: `Length on the ${models[side]}` }, extent(side))),
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
    if (curve === null) return this.history.curves.length === 0 ? [] : [element("p", { class: "soft" }, "No curve is chosen: the next click begins a new one.")];
    const { point } = this.editor;
    const button = (label: string, disabled: boolean, onclick: () => void): HTMLElement => element("button", { type: "button", disabled, onclick }, label);
    const places = sides.map((side) => (point[side] < 0 ? `none of the ${models[side]}` : `${point[side] + 1} of ${curve[side].points.length} of the ${models[side]}`));
    const fixed = curve.fixed.map(([i, j]) => `${i + 1} – ${j + 1}`).join(", ");
    return [
      element("h2", {}, `Points of ${curve_name(curve, this.editor.chosen)}`),
      element("p", {}, `Chosen: ${places.join(", ")}.${fixed === "" ? "" : ` Belonging together: ${fixed}.`}`),
      element("p", { class: "actions" },
        button(this.editor.is_fixed ? "Let the two slide" : "Fix the two together", point.a < 0 || point.b < 0, () => this.editor.fix()),
        ...sides.map((side) => button(`Delete on ${models[side]}`, point[side] < 0, () => this.editor.remove_point(side))),
        button("Turn round on target", curve.b.points.length < 2, () => this.editor.turn_target())),
      element("p", { class: "soft" }, "What lies on one line goes onto the other; where along it is found by the fit, but for points that belong together."),
    ];
  }
}
