import { finite_number, finite_triple, numbered_lines, words_of } from "./file_text";
import type { NamedPoint } from "./side";

/** Landmark Editor's points: their number, then a word and three numbers each. */
export function parse_landmarks(text: string, file: string): NamedPoint[] {
  const points: NamedPoint[] = [];
  let promised = 0;
  for (const { line, where } of numbered_lines(text, file)) {
    const words = words_of(line);
    if (words.length === 0 || words[0] === "Version") continue;
    if (words.length === 1 && points.length === 0) {
      promised = finite_number(words[0], where);
      continue;
    }
    if (words.length !== 4) throw new Error(`${where}: a point is a name and three numbers`);
    points.push({ name: words[0], x: finite_triple(words.slice(1), where) });
  }
  if (points.length !== promised) throw new Error(`${file}: ${points.length} points, but it says ${promised}`);
  return points;
}

export function landmarks_text(points: NamedPoint[]): string {
  const lines = points.map(({ name, x }, i) => `${name === "" ? `S${i}` : name.replace(/[ \t\r\n\v\f]+/g, "_")} ${x.join(" ")}\n`);
  return `Version 1.0\n${points.length}\n${lines.join("")}`;
}
