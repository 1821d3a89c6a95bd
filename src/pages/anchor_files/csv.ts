import type { CompletePair } from "../pick/history";
import { finite_number, finite_triple, numbered_lines } from "./file_text";

const columns = ["name", "ax", "ay", "az", "bx", "by", "bz"];
const accuracies = ["weight", "sigma"];

/** Fields between separators, without surrounding blanks; one that begins with a double quote may hold separators and "" for ". */
export function fields_of(line: string, separator: string): string[] {
  const fields = [""];
  let quoted = false;
  for (let i = 0; i < line.length; ++i) {
    const last = fields.length - 1;
    if (line[i] === '"' && quoted && line[i + 1] === '"') fields[last] += line[i++];
    else if (line[i] === '"' && (quoted || fields[last].trim() === "")) quoted = !quoted;
    else if (line[i] === separator && !quoted) fields.push("");
    else fields[last] += line[i];
  }
  return fields.map((field) => field.replace(/^[ \t]+|[ \t]+$/g, ""));
}

/** A name as a field. */
export function quoted(name: string): string {
  return /[,;\t"]/.test(name) ? `"${name.replaceAll('"', '""')}"` : name;
}

/** Whether a line's fields are those of the header, or a name and numbers, which may have decimal commas. */
function is_table(fields: string[]): boolean {
  return is_header(fields) || (fields.length >= columns.length && fields.slice(1, columns.length).every((field) => /^[-+0-9.,eE]+$/.test(field)));
}

/** The fields of all lines, as spreadsheets save them: between commas, semicolons or tabs, with decimal commas where no comma separates. */
function rows_of(lines: { line: string; where: string }[]): { fields: string[]; where: string }[] {
  const filled = lines.filter(({ line }) => line.trim() !== "" && !/^sep=[,;\t]$/.test(line));
  if (filled.length === 0) return [];
  const separator = [",", ";", "\t"].find((each) => is_table(fields_of(filled[0].line, each))) ?? ",";
  const rows = filled.map(({ line, where }) => ({ fields: fields_of(line, separator), where }));
  const comma = /^[-+]?\d+,\d+([eE][-+]?\d+)?$/;
  if (separator === "," || !rows.some(({ fields }) => fields.slice(1).some((field) => comma.test(field)))) return rows;
  return rows.map(({ fields, where }) => ({
    where,
    fields: fields.map((field, k) => {
      if (k > 0 && field.includes(".")) throw new Error(`${where}: "${field}" has a decimal point, but the table has decimal commas`);
      return k > 0 && comma.test(field) ? field.replace(",", ".") : field;
    }),
  }));
}

function is_header(fields: string[]): boolean {
  const more = fields.slice(columns.length);
  return columns.every((name, i) => fields[i] === name) && more.length <= accuracies.length
    && more.every((name, i) => accuracies.includes(name) && more.indexOf(name) === i);
}

function accuracy(text: string, column: string, where: string): number {
  const value = finite_number(text, `${where}: ${column}`);
  const is_right = column === "weight" ? value > 0 : value >= 0;
  if (!is_right) throw new Error(`${where}: ${column} is ${text}, but must be ${column === "weight" ? "> 0" : ">= 0"}`);
  return value;
}

function pair_of(fields: string[], more: string[], where: string): CompletePair {
  if (fields.length < columns.length || fields.length > columns.length + more.length)
    throw new Error(`${where}: ${fields.length} columns, but a row is name,ax,ay,az,bx,by,bz[,weight[,sigma]]`);
  const pair: CompletePair = { name: fields[0], a: finite_triple(fields.slice(1, 4), where), b: finite_triple(fields.slice(4, 7), where), sigma: null, weight: null };
  fields.slice(columns.length).forEach((text, k) => {
    if (text !== "") pair[more[k] as "weight" | "sigma"] = accuracy(text, more[k], where);
  });
  if (pair.sigma !== null && pair.weight !== null) throw new Error(`${where}: has both a weight and a sigma; give one of them`);
  return pair;
}

export function parse_csv(text: string, file: string): CompletePair[] {
  const rows = rows_of(numbered_lines(text, file));
  if (rows.length === 0) throw new Error(`${file}: no rows`);
  const has_header = is_header(rows[0].fields);
  const more = has_header ? rows[0].fields.slice(columns.length) : accuracies;
  return rows.slice(has_header ? 1 : 0).map(({ fields, where }) => pair_of(fields, more, where));
}

export function csv_text(pairs: CompletePair[]): string {
  const rows = pairs.map((pair) => [quoted(pair.name), ...pair.a, ...pair.b, pair.weight ?? "", pair.weight === null ? (pair.sigma ?? "") : ""].join(","));
  return ["name,ax,ay,az,bx,by,bz,weight,sigma", ...rows].join("\n") + "\n";
}
