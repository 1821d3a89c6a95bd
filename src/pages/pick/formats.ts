import type { Triple } from "../scene/scene";
import { is_complete, type PickedPair } from "./history";

function triple(value: unknown, where: string): Triple {
  if (!Array.isArray(value) || value.length !== 3 || !value.every((x) => typeof x === "number" && Number.isFinite(x)))
    throw new Error(`${where} is not three numbers`);
  return value as Triple;
}

/** The pairs of an anchors file: JSON, or CSV by the first letter. */
export function parse_anchors(text: string): PickedPair[] {
  return text.trimStart().startsWith("{") ? parse_json(JSON.parse(text)) : parse_csv(text);
}

export function parse_json(document: { pairs?: unknown }): PickedPair[] {
  if (!Array.isArray(document.pairs)) throw new Error('the key "pairs" is missing');
  return document.pairs.map((pair: Record<string, unknown>, i) => ({
    name: String(pair.name ?? ""),
    a: triple(pair.a, `"a" of pair ${i}`),
    b: triple(pair.b, `"b" of pair ${i}`),
    sigma: typeof pair.sigma === "number" ? pair.sigma : null,
    weight: typeof pair.weight === "number" ? pair.weight : null,
  }));
}

function parse_csv(text: string): PickedPair[] {
  const rows = text.split(/\r?\n/).filter((row) => row.trim() !== "").map((row) => row.split(",").map((field) => field.trim()));
  const accuracy = rows[0]?.[1] === "ax" ? rows[0].slice(7) : ["weight", "sigma"];
  return rows.filter((row) => row[1] !== "ax").map((row, i) => {
    const numbers = row.slice(1, 7).map(Number);
    const optional = (column: string): number | null => {
      const field = row[7 + accuracy.indexOf(column)];
      return accuracy.includes(column) && field !== undefined && field !== "" ? Number(field) : null;
    };
    return { name: row[0].replace(/^"|"$/g, ""), a: triple(numbers.slice(0, 3), `row ${i + 1}`), b: triple(numbers.slice(3), `row ${i + 1}`), sigma: optional("sigma"), weight: optional("weight") };
  });
}

/** What `bespoke fit --anchors` reads; pairs with one end are left out. */
export function anchors_json(pairs: PickedPair[], unit: string): string {
  const written = pairs.filter(is_complete).map((pair) => ({
    ...(pair.name === "" ? {} : { name: pair.name }),
    a: pair.a,
    b: pair.b,
    ...(pair.weight === null ? {} : { weight: pair.weight }),
    ...(pair.sigma === null || pair.weight !== null ? {} : { sigma: pair.sigma }),
  }));
  const lines = written.map((pair) => `  ${JSON.stringify(pair)}`).join(",\n");
  return `{${unit === "" ? "" : `"units": ${JSON.stringify(unit)}, `}"pairs": [\n${lines}\n]}\n`;
}

export function anchors_csv(pairs: PickedPair[]): string {
  const quoted = (name: string): string => (/[",]/.test(name) ? `"${name.replaceAll('"', '""')}"` : name);
  const rows = pairs.filter(is_complete).map((pair) => [quoted(pair.name), ...pair.a, ...pair.b, pair.weight ?? "", pair.weight === null ? (pair.sigma ?? "") : ""].join(","));
  return ["name,ax,ay,az,bx,by,bz,weight,sigma", ...rows].join("\n") + "\n";
}
