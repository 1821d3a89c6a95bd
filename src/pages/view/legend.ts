import { element } from "../controls/elements";
import { colour_at, colour_table } from "../maths/colour_maps";
import { histogram, shown } from "../maths/numbers";
import type { Field } from "./models";

const bins = 72;

/** The colours with their range in units, and how many vertices have which value above them. */
export class Legend {
  readonly element = element("div", { class: "legend", role: "img" });
  private readonly title = element("div", {});
  private readonly canvas = element("canvas", {});
  private readonly ends = element("div", { class: "ends" });

  constructor() {
    this.element.append(this.title, this.canvas, this.ends);
  }

  show(field: Field | null, low: number, high: number): void {
    this.element.hidden = field === null;
    if (field === null) return;
    const { label, unit, middle } = field.record;
    this.title.textContent = unit === "" ? label : `${label}, ${unit}`;
    this.ends.replaceChildren(element("span", {}, shown(low)), element("span", {}, shown((low + high) / 2)), element("span", {}, shown(high)));
    this.element.setAttribute("aria-label", `${label}: colours from ${shown(low, unit)} to ${shown(high, unit)}`);
    this.draw(histogram(field.sorted, low, high, bins), colour_table(middle !== null));
  }

  private draw(counts: number[], table: Uint8Array): void {
    const scale = Math.min(2, window.devicePixelRatio);
    const width = (this.canvas.width = Math.round((this.canvas.clientWidth || 218) * scale));
    const height = (this.canvas.height = Math.round((this.canvas.clientHeight || 46) * scale));
    const context = this.canvas.getContext("2d") as CanvasRenderingContext2D;
    const bar = Math.round(height * 0.26), most = Math.max(1, ...counts);
    for (let i = 0; i < bins; ++i) {
      const left = Math.floor((i * width) / bins), right = Math.floor(((i + 1) * width) / bins);
      context.fillStyle = colour_at(table, (i + 0.5) / bins);
      context.fillRect(left, height - bar, right - left, bar);
      // Roots, so that rare values are seen beside frequent ones.
      const tall = Math.sqrt(counts[i] / most) * (height - bar - 3 * scale);
      context.fillStyle = getComputedStyle(this.element).color;
      context.globalAlpha = 0.55;
      context.fillRect(left, height - bar - scale - tall, Math.max(1, right - left - 1), tall);
      context.globalAlpha = 1;
    }
  }
}
