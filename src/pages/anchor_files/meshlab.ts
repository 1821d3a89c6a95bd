import { finite_triple } from "./file_text";
import type { NamedPoint } from "./side";

/** MeshLab's picked points, but those that are switched off. */
export function parse_meshlab(text: string, file: string): NamedPoint[] {
  const document = new DOMParser().parseFromString(text, "application/xml");
  const [fault] = document.getElementsByTagName("parsererror");
  if (fault !== undefined) throw new Error(`${file}: is no XML: ${reason(fault)}`);
  if (document.getElementsByTagName("PickedPoints").length === 0) throw new Error(`${file}: no <PickedPoints>: not a file of picked points`);
  const elements = [...document.getElementsByTagName("point")];
  const points = elements.map((point, i) => {
    const where = `${file}: point ${i}`;
    const coordinates = ["x", "y", "z"].map((axis) => point.getAttribute(axis));
    if (coordinates.includes(null)) throw new Error(`${where} has not all of x, y and z`);
    return { name: point.getAttribute("name") ?? "", x: finite_triple(coordinates as string[], where) };
  });
  return points.filter((_, i) => elements[i].getAttribute("active") !== "0");
}

/** The sentence of a browser's report that says where and what: Chromium's "error on line 2 at column 28: …", Firefox's "… Line Number 2, …". */
function reason(fault: Element): string {
  const text = (fault.textContent ?? "").replace(/Below is a rendering of the page[^]*/, "");
  return /line (number )?\d[^\n]*/i.exec(text)?.[0].trim().slice(0, 200) ?? "the browser does not say where";
}

const entities: Record<string, string> = { "<": "&lt;", '"': "&quot;", "&": "&amp;" };

export function meshlab_text(points: NamedPoint[]): string {
  const lines = points.map(({ name, x }) => ` <point x="${x[0]}" y="${x[1]}" z="${x[2]}" active="1" name="${name.replace(/[<"&]/g, (letter) => entities[letter])}"/>\n`);
  return `<!DOCTYPE PickedPoints>\n<PickedPoints>\n${lines.join("")}</PickedPoints>\n`;
}
