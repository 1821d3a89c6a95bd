import type { CompletePair } from "../pick/history";
import { finite_number, finite_triple, numbered_lines } from "./file_text";

const columns = ["name", "ax", "ay", "az", "bx", "by", "bz"];
const accuracies = ["weight", "sigma"];

/** Fields between commas, without surrounding blanks; a field in double quotes may hold commas and "" for ". */
function fields_of(line: string): string[] {
  const fields = [""];
  let quoted = false;
  for (let i = 0; i < line.length; ++i) {
    const last = fields.length - 1;
    if (line[i] === '"' && quoted && line[i + 1] === '"') fields[last] += line[i++];
    else if (line[i] === '"') quoted = !quoted;
    else if (line[i] === "," && !quoted) fields.push("");
    else fields[last] += line[i];
  }
  return fields.map((field) => field.replace(/^[ \t\r]+|[ \t\r]+$/g, ""));
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
  const rows = numbered_lines(text, file).map(({ line, where }) => ({ fields: fields_of(line), where })).filter(({ fields }) => fields.length > 1 || fields[0] !== "");
  if (rows.length === 0) throw new Error(`${file}: no rows`);
  const has_header = is_header(rows[0].fields);
  const more = has_header ? rows[0].fields.slice(columns.length) : accuracies;
  return rows.slice(has_header ? 1 : 0).map(({ fields, where }) => pair_of(fields, more, where));
}

export function csv_text(pairs: CompletePair[]): string {
  const quoted = (name: string): string => (/[",]/.test(name) ? `"${name.replaceAll('"', '""')}"` : name);
  const rows = pairs.map((pair) => [quoted(pair.name), ...pair.a, ...pair.b, pair.weight ?? "", pair.weight === null ? (pair.sigma ?? "") : ""].join(","));
  return ["name,ax,ay,az,bx,by,bz,weight,sigma", ...rows].join("\n") + "\n";
}
