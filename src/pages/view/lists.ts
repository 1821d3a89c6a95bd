import { element } from "../controls/elements";
import { shown } from "../maths/numbers";
import type { AnchorRecord, PlaceRecord, ViewRecord } from "../scene/scene";

interface Column {
  title: string;
  text(anchor: AnchorRecord): string;
  compare(a: AnchorRecord, b: AnchorRecord): number;
}

const columns: Column[] = [
  { title: "name", text: (anchor) => anchor.name || "–", compare: (a, b) => a.name.localeCompare(b.name) },
  { title: "residual", text: (anchor) => shown(anchor.residual), compare: (a, b) => b.residual - a.residual },
  {
    title: "σ",
    text: (anchor) => (anchor.weight !== null ? `weight ${shown(anchor.weight)}` : anchor.sigma ? shown(anchor.sigma) : "exact"),
    compare: (a, b) => (b.sigma ?? 0) - (a.sigma ?? 0),
  },
];

/** The pairs, sorted by any column; a click flies there. */
export function anchor_panel(record: ViewRecord, chosen: (index: number) => void): HTMLElement {
  if (record.anchors.length === 0) return element("p", {}, "The map was fitted without anchors.");
  const body = element("tbody", {});
  let sorted_by = 1;
  const fill = (): void => {
    const order = [...record.anchors.keys()].sort((i, j) => columns[sorted_by].compare(record.anchors[i], record.anchors[j]));
    body.replaceChildren(...order.map((index) => anchor_row(record.anchors[index], index, body, chosen)));
  };
  const heads = columns.map((column, i) =>
    element("th", { scope: "col" }, element("button", { type: "button", title: `Sort by ${column.title}`, onclick: () => { sorted_by = i; fill(); } }, column.title)),
  );
  fill();
  const suspicious = record.anchors.filter((anchor) => anchor.suspicion !== null).length;
  return element(
    "div", {},
    element("p", {}, `${record.anchors.length} pairs; residuals in ${record.unit}.`, suspicious > 0 ? ` ${suspicious} look suspicious.` : ""),
    element("table", {}, element("thead", {}, element("tr", {}, ...heads)), body),
  );
}

function anchor_row(anchor: AnchorRecord, index: number, body: HTMLElement, chosen: (index: number) => void): HTMLElement {
  const choose = (): void => {
    for (const other of body.children) other.classList.toggle("chosen", other === line);
    chosen(index);
  };
  const cells = columns.map((column, i) =>
    i === 0
      ? element("td", {}, element("button", { type: "button", class: "link" }, column.text(anchor)), anchor.suspicion === null ? null : element("div", { class: "warn" }, anchor.suspicion))
      : element("td", {}, column.text(anchor)),
  );
  const line = element("tr", { class: "go", onclick: choose }, ...cells);
  return line;
}

/** Folds, repaired cells, contacts, unmet vertices: by kind, the largest first; a click flies there. */
export function place_panel(record: ViewRecord, chosen: (place: PlaceRecord) => void): HTMLElement {
  const parts: HTMLElement[] = [];
  if (record.places.length === 0) parts.push(element("p", {}, "Nothing to inspect: no folds, no regions that miss the tolerance, no vertices unmet, in cavities or stretched too far."));
  for (const kind of new Set(record.places.map((place) => place.kind))) {
    const places = record.places.filter((place) => place.kind === kind);
    parts.push(
      element("h2", {}, `${kind} (${places.length})`),
      element("ul", { class: "plain" }, ...places.map((place) => element("li", {}, element("button", { type: "button", class: "link", onclick: () => chosen(place) }, place.text)))),
    );
  }
  return element("div", {}, ...parts, counted(record.info));
}

/** What a map's record only counts: its stage, its key, and in words. */
const counts: [string, string, string][] = [
  ["surface-fit", "unmatched_vertices", "vertices without counterpart"],
  ["surface-fit", "mended_vertices", "repaired vertices"],
  ["contact", "touching_vertices", "vertices in contact, separated"],
  ["contact", "left", "of them still touching"],
  ["bake", "repaired_cells", "repaired cells"],
];

function counted(info: Record<string, unknown>): HTMLElement {
  const stages = Array.isArray(info.stages) ? (info.stages as Record<string, unknown>[]) : [];
  const known = counts.flatMap(([name, key, label]) => {
    const value = stages.find((stage) => stage.name === name)?.[key];
    return typeof value === "number" ? [element("dt", {}, label), element("dd", {}, shown(value))] : [];
  });
  return known.length === 0 ? element("div", {}) : element("div", {}, element("h2", {}, "Counted by the fit"), element("dl", {}, ...known));
}
