import { in_order, is_complete_curve, is_patch, type PickedCurve, polyline, type Side } from "../pick/curves";
import { is_complete, type Work } from "../pick/history";
import { csv_text, parse_csv } from "./csv";
import { anchor_formats, type AnchorFormat } from "./format";
import { landmarks_text, parse_landmarks } from "./landmarks";
import { meshlab_text, parse_meshlab } from "./meshlab";
import { type ExactModel, indices_text, parse_indices, parse_wrap, wrap_text } from "./model_places";
import type { FileSide } from "./side";
import { fiducials_text, markups_text, parse_fiducials, parse_markups, type PatientSystem } from "./slicer";

/** What a format may need to know of the two models. */
export interface FileModels {
  /** Throws where the page has a thinned model alone. */
  exact(side: Side): ExactModel;
  system: PatientSystem;
}

/** A text file with the pairs of both sides, `csv` or `indices`. */
export function parse_both_sides(text: string, format: AnchorFormat, file: string, models: FileModels): Pick<Work, "pairs"> {
  return { pairs: format === "csv" ? parse_csv(text, file) : parse_indices(text, file, { a: models.exact("a"), b: models.exact("b") }) };
}

/** One side of a format that has a file a side. */
export function parse_side(text: string, format: AnchorFormat, file: string, side: Side, models: FileModels): FileSide {
  if (format === "markups") return parse_markups(text, file, models.system);
  const points = {
    meshlab: () => parse_meshlab(text, file),
    fiducials: () => parse_fiducials(text, file, models.system),
    landmarks: () => parse_landmarks(text, file),
    wrap: () => parse_wrap(text, file, models.exact(side)),
  }[format as "meshlab" | "fiducials" | "landmarks" | "wrap"]();
  return { points, lines: [] };
}

function complete_lines(work: Work): PickedCurve[] {
  return work.curves.filter((curve) => is_complete_curve(curve) && !is_patch(curve));
}

function side_of(work: Work, side: Side): FileSide {
  const lines = complete_lines(work).map((curve) => {
    const { name, closed, ...both } = in_order(curve) ?? curve; // the page has said so (curve_checks.ts)
    return { name, closed, points: polyline(both[side], closed).points };
  });
  return { points: work.pairs.filter(is_complete).map((pair) => ({ name: pair.name, x: pair[side] })), lines };
}

function side_text(work: Work, format: AnchorFormat, side: Side, models: FileModels): string {
  const content = side_of(work, side);
  if (format === "markups") return markups_text(content, models.system);
  if (format === "fiducials") return fiducials_text(content.points, models.system);
  if (format === "meshlab") return meshlab_text(content.points);
  if (format === "landmarks") return landmarks_text(content.points);
  return wrap_text(content.points, models.exact(side));
}

export function file_names(format: AnchorFormat): string[] {
  const { per_side, ending } = anchor_formats[format];
  return per_side ? [`anchors_a${ending}`, `anchors_b${ending}`] : [`anchors${ending}`];
}

/** The texts of file_names: complete pairs, and complete curves where the format has a place for them. */
export function file_texts(work: Work, format: AnchorFormat, models: FileModels): string[] {
  const pairs = work.pairs.filter(is_complete);
  if (format === "csv") return [csv_text(pairs)];
  if (format === "indices") return [indices_text(pairs, { a: models.exact("a"), b: models.exact("b") })];
  return [side_text(work, format, "a", models), side_text(work, format, "b", models)];
}

/** What of the work a format has no place for, as `bespoke anchors convert` says it; empty for nothing. */
export function left_out(work: Work, unit: string, format: AnchorFormat): string[] {
  const record = anchor_formats[format];
  const pairs = work.pairs.filter(is_complete), curves = complete_lines(work);
  const borders = work.curves.filter((curve) => is_complete_curve(curve) && is_patch(curve)).length;
  const counted = (what: string, count: number, one: string, more: string): string => (count === 0 ? "" : `${what}${count} ${count === 1 ? one : more}`);
  const parts = [
    unit === "" ? "" : `the unit (${unit})`,
    record.names ? "" : counted("the names of ", pairs.filter((pair) => pair.name !== "").length, "pair", "pairs"),
    record.accuracies ? "" : counted("the accuracies of ", pairs.filter((pair) => pair.sigma !== null || pair.weight !== null).length, "pair", "pairs"),
    record.curves ? counted("the fixed points of ", curves.filter((curve) => curve.fixed.length > 0).length, "curve", "curves") : counted("", curves.length, "curve", "curves"),
    counted("", borders + work.patches.length, "patch", "patches"),
  ];
  return parts.filter((part) => part !== "");
}

/** What becomes of points and names that a format keeps in its own way; empty for nothing. */
export function changed(work: Work, format: AnchorFormat): string {
  const has_name_with = (letters: RegExp): boolean => work.pairs.some((pair) => letters.test(pair.name));
  if (format === "wrap") return "Points off the surface become the nearest ones on it.";
  if (format === "indices") return "Each point becomes the nearest vertex.";
  if (format === "landmarks" && has_name_with(/\s/)) return "Blanks in names become underscores.";
  if (format === "fiducials" && has_name_with(/,/)) return "Commas in names become blanks.";
  if (format === "markups" && complete_lines(work).length > 0) return "3D Slicer draws a spline through the points of a curve.";
  return "";
}
