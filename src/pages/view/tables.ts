import { element } from "../controls/elements";
import { shown } from "../maths/numbers";

type Json = unknown;
type JsonObject = Record<string, Json>;

function is_object(value: Json): value is JsonObject {
  return typeof value === "object" && value !== null && !Array.isArray(value);
}

const spread_keys = ["min", "p1", "median", "p95", "p99", "max"];

function is_spread(value: Json): value is JsonObject {
  return is_object(value) && "median" in value && "max" in value && "min" in value;
}

/** The words of a key. */
function words(key: string): string {
  return key.replaceAll("_", " ");
}

/** From the least to the largest a line, from the lower to the upper percentile a box, the median a mark. */
function plot(spread: JsonObject): SVGSVGElement {
  const value = (key: string): number => Number(spread[key]);
  const low = value("min"), high = value("max");
  const x = (at: number): number => (high > low ? 4 + (292 * (at - low)) / (high - low) : 150);
  const from = x("p1" in spread ? value("p1") : low), to = x("p99" in spread ? value("p99") : value("p95"));
  const svg = document.createElementNS("http://www.w3.org/2000/svg", "svg");
  svg.setAttribute("class", "plot");
  svg.setAttribute("viewBox", "0 0 300 34");
  svg.setAttribute("preserveAspectRatio", "none");
  svg.setAttribute("role", "img");
  svg.setAttribute("aria-label", `from ${shown(low)} to ${shown(high)}, median ${shown(value("median"))}`);
  svg.innerHTML =
    `<line class="range" x1="${x(low)}" x2="${x(high)}" y1="17" y2="17"/>` +
    `<rect class="box" x="${from}" y="8" width="${Math.max(1, to - from)}" height="18"/>` +
    `<line class="median" x1="${x(value("median"))}" x2="${x(value("median"))}" y1="5" y2="29"/>`;
  return svg;
}

function spread_table(title: string, spread: JsonObject, unit: string): HTMLElement {
  const keys = spread_keys.filter((key) => key in spread);
  return element(
    "div", {},
    element("h2", {}, unit === "" ? words(title) : `${words(title)}, ${unit}`),
    plot(spread) as unknown as HTMLElement,
    element(
      "table", {},
      element("thead", {}, element("tr", {}, ...keys.map((key) => element("th", { scope: "col" }, key)))),
      element("tbody", {}, element("tr", {}, ...keys.map((key) => element("td", {}, shown(Number(spread[key])))))),
    ),
  );
}

function text_of(value: Json): string {
  if (typeof value === "number") return shown(value);
  if (typeof value === "boolean") return value ? "yes" : "no";
  if (value === null) return "–";
  if (typeof value === "string") return value;
  if (Array.isArray(value)) return value.every(is_object) ? `${value.length}` : value.map(text_of).join(", ");
  return JSON.stringify(value);
}

const lengths = new Set([
  "anchor_residuals", "source_to_target", "target_to_source", "hausdorff", "bake_error", "clearance_before",
  "clearance_after", "clearance_change", "deepest",
]);

/** An object as lines, its distributions as plots with tables, objects in it under their names. */
export function object_view(object: JsonObject, unit: string, skipped: string[] = []): HTMLElement {
  const lines = element("dl", {});
  const parts: HTMLElement[] = [];
  for (const [key, value] of Object.entries(object)) {
    if (skipped.includes(key)) continue;
    if (is_spread(value)) parts.push(spread_table(key, value, lengths.has(key) ? unit : ""));
    else if (is_object(value)) parts.push(element("h2", {}, words(key)), object_view(value, unit));
    else if (Array.isArray(value) && value.length > 0 && value.every(is_object))
      for (const [i, item] of value.entries())
        parts.push(element("h2", {}, `${words(key)}: ${String((item as JsonObject).name ?? i)}`), object_view(item as JsonObject, unit));
    else lines.append(element("dt", {}, words(key)), element("dd", {}, text_of(value)));
  }
  return element("div", {}, lines.children.length > 0 ? lines : null, ...parts);
}
