import type { Triple } from "../scene/scene";

const decimal = /^[-+]?(\d+\.?\d*|\.\d+)(e[-+]?\d+)?$/i;

/** All of the text as a finite number. */
export function finite_number(text: string, where: string): number {
  const value = decimal.test(text) ? Number(text) : NaN;
  if (!Number.isFinite(value)) throw new Error(`${where}: "${text.slice(0, 40)}" is not a finite number`);
  return value;
}

export function finite_triple(texts: string[], where: string): Triple {
  return [finite_number(texts[0], where), finite_number(texts[1], where), finite_number(texts[2], where)];
}

/** The lines of a text with what messages call them: "a.pts:3". */
export function numbered_lines(text: string, file: string): { line: string; where: string }[] {
  const lines = text.replace(/^\uFEFF/, "").split(/\r\n|\n|\r/);
  if (lines[lines.length - 1] === "") lines.pop();
  return lines.map((line, i) => ({ line, where: `${file}:${i + 1}` }));
}

/** What stands between blanks. */
export function words_of(line: string): string[] {
  return line.split(/[ \t\r\n\v\f]+/).filter((word) => word !== "");
}

export function parsed_json(text: string, file: string): unknown {
  try {
    return JSON.parse(text);
  } catch (error) {
    throw new Error(`${file}: not valid JSON: ${error instanceof Error ? error.message : String(error)}`);
  }
}

export function is_object(value: unknown): value is Record<string, unknown> {
  return typeof value === "object" && value !== null && !Array.isArray(value);
}

export function is_finite(value: unknown): value is number {
  return typeof value === "number" && Number.isFinite(value);
}
