import { fields_of, quoted } from "./csv";
import type { Triple } from "../scene/scene";
import { finite_triple, is_finite, is_object, numbered_lines, parsed_json } from "./file_text";
import type { FileSide, NamedLine, NamedPoint } from "./side";

/** Patient coordinates of 3D Slicer: x to the left and y to the back, or x to the right and y to the front. */
export type PatientSystem = "LPS" | "RAS";

/** LPS and RAS differ by half a turn about z; twice is none. */
function in_system(x: Triple, from: PatientSystem, to: PatientSystem): Triple {
  return from === to ? x : [-x[0], -x[1], x[2]];
}

function system_named(name: string, where: string): PatientSystem {
  if (name === "LPS" || name === "1") return "LPS";
  if (name === "RAS" || name === "0") return "RAS";
  throw new Error(`${where}: the coordinate system is "${name.slice(0, 40)}", not LPS or RAS`);
}

// ---- markups

const schema = "https://raw.githubusercontent.com/slicer/slicer/master/Modules/Loadable/Markups/Resources/Schema/markups-schema-v1.0.3.json#";

function list_of(owner: Record<string, unknown>, key: string, where: string): unknown[] {
  const list = owner[key];
  if (!Array.isArray(list)) throw new Error(`${where}: has no list "${key}"`);
  return list;
}

function text_under(owner: Record<string, unknown>, key: string, otherwise: string, where: string): string {
  const value = owner[key] ?? otherwise;
  if (typeof value !== "string") throw new Error(`${where}: "${key}" is no text`);
  return value;
}

function control_points(markup: Record<string, unknown>, where: string, models: PatientSystem): NamedPoint[] {
  const system = system_named(text_under(markup, "coordinateSystem", "LPS", where), where);
  return list_of(markup, "controlPoints", where).flatMap((control, i) => {
    const place = `${where}: control point ${i}`;
    if (!is_object(control)) throw new Error(`${place} is no object`);
    if (text_under(control, "positionStatus", "defined", place) !== "defined") return [];
    const at = control.position;
    if (!Array.isArray(at) || at.length !== 3 || !at.every(is_finite)) throw new Error(`${place}: "position" is not three numbers`);
    return [{ name: text_under(control, "label", "", place), x: in_system(at as Triple, system, models) }];
  });
}

function line_through(points: NamedPoint[], markup: Record<string, unknown>, where: string): NamedLine {
  if (!points.some((point) => point.x.join() !== points[0].x.join())) throw new Error(`${where}: a curve has two control points at different places at least`);
  return { name: text_under(markup, "name", "", where), points: points.map((point) => point.x), closed: markup.type === "ClosedCurve" };
}

/** Every list of type Fiducial holds points, every Curve and ClosedCurve a line through its control points. */
export function parse_markups(text: string, file: string, models: PatientSystem): FileSide {
  const document = parsed_json(text, file);
  if (!is_object(document)) throw new Error(`${file}: is no object with a list "markups"`);
  const side: FileSide = { points: [], lines: [] };
  list_of(document, "markups", file).forEach((markup, i) => {
    const where = `${file}: markup ${i}`;
    if (!is_object(markup)) throw new Error(`${where} is no object`);
    const type = text_under(markup, "type", "Fiducial", where);
    if (!["Fiducial", "Curve", "ClosedCurve"].includes(type))
      throw new Error(`${where}: is of type "${type.slice(0, 40)}"; only Fiducial, Curve and ClosedCurve are points and curves`);
    const points = control_points(markup, where, models);
    if (type === "Fiducial") side.points.push(...points);
    else side.lines.push(line_through(points, markup, where));
  });
  return side;
}

export function markups_text(side: FileSide, models: PatientSystem): string {
  const markup = (type: string, name: string, controls: object[]): object => ({
    type, ...(name === "" ? {} : { name }), coordinateSystem: models, coordinateUnits: "mm",
    controlPoints: controls.map((control, i) => ({ id: String(i + 1), ...control, positionStatus: "defined" })),
  });
  const markups = [
    markup("Fiducial", "", side.points.map(({ name, x }) => ({ label: name, position: x }))),
    ...side.lines.map((line) => markup(line.closed ? "ClosedCurve" : "Curve", line.name, line.points.map((position) => ({ position })))),
  ];
  return `${JSON.stringify({ "@schema": schema, markups }, null, 1)}\n`;
}

// ---- older fiducials

const system_mark = "# CoordinateSystem = ";
const label_column = 11;

export function parse_fiducials(text: string, file: string, models: PatientSystem): NamedPoint[] {
  // What files without the line mean: 3D Slicer wrote RAS before it wrote the line.
  let system: PatientSystem = "RAS";
  return numbered_lines(text, file).flatMap(({ line, where }) => {
    if (line.startsWith(system_mark)) system = system_named(line.slice(system_mark.length), where);
    if (line.trim() === "" || line.startsWith("#")) return [];
    const fields = fields_of(line, ",");
    if (fields.length < 4) throw new Error(`${where}: fewer than four columns`);
    return [{ name: fields[label_column] ?? "", x: in_system(finite_triple(fields.slice(1, 4), where), system, models) }];
  });
}

export function fiducials_text(points: NamedPoint[], models: PatientSystem): string {
  const head = `# Markups fiducial file version = 5.0\n${system_mark}${models}\n# columns = id,x,y,z,ow,ox,oy,oz,vis,sel,lock,label,desc,associatedNodeID\n`;
  // A comma ends the column except in quotes.
  const rows = points.map(({ name, x }, i) => `${i + 1},${x.join(",")},0,0,0,1,1,1,0,${quoted(name)},,\n`);
  return head + rows.join("");
}
