import type { EnclosedFaces } from "../maths/enclosed_faces";
import type { SurfaceGraph } from "../maths/surface_graph";
import { distance } from "../maths/warp";
import type { Triple } from "../scene/scene";
import { is_complete_curve, is_patch, model_of, type PickedCurve, type Side, sides } from "./curves";
import { curve_name } from "./curve_checks";
import type { CompletePair, Work } from "./history";

/** A model with what borders on it enclose. */
export interface PatchedModel {
  graph: SurfaceGraph;
  /** Null without a whole border there. */
  enclosed(patch: PickedCurve): EnclosedFaces | null;
}

interface Patch {
  name: string;
  curve: PickedCurve;
}

const none = -1, excluded = -2, between_patches = -3; // beside numbers of patches
const on_surface = 0.02; // of the diagonal: farther points are points of space (fit_patches.cpp)

/** What `bespoke fit` would say against patches (anchors/patch_faces.h, pipeline/fit_patches.h), a line each. */
export function check_patches({ curves, patches: kept }: Work, pairs: CompletePair[], models: Record<Side, PatchedModel>): string[] {
  const patches = curves.map((curve, i) => ({ name: curve_name(curve, i), curve })).filter(({ curve }) => is_patch(curve) && is_complete_curve(curve));
  const warnings = names_given_twice([...patches.map(({ curve }) => curve.name), ...kept.map((patch) => String(patch.name ?? ""))]);
  const has_places = pairs.length > 0 || curves.some((curve) => !is_patch(curve) && is_complete_curve(curve));
  if (patches.length + kept.length > 0 && !has_places) warnings.push("Patches pair parts but fix no positions: fit requires pairs or a curve beside them.");
  for (const { name, curve } of patches)
    for (const side of sides) {
      const trouble = models[side].enclosed(curve)?.trouble ?? null;
      if (trouble !== null) warnings.push(`${name} on the ${model_of[side]}: ${trouble}. Fit refuses it.`);
    }
  if (patches.length > 0) warnings.push(...check_places(patches, pairs, models));
  return warnings;
}

function names_given_twice(names: string[]): string[] {
  const twins = new Set(names.filter((name, i) => name !== "" && names.indexOf(name) < i));
  return [...twins].map((name) => `Two patches are named “${name}”: fit takes only names that differ.`);
}

function check_places(patches: Patch[], pairs: CompletePair[], models: Record<Side, PatchedModel>): string[] {
  const warnings: string[] = [];
  const find = (side: Side): ((point: Triple) => number) => {
    const { of_face, overlaps } = patches_of_faces(models[side], patches);
    for (const [i, j] of overlaps) warnings.push(`${patches[i].name} and ${patches[j].name} overlap on the ${model_of[side]}: a face can be in one patch only.`);
    return (point) => patch_at(models[side].graph, of_face, point);
  };
  const at = { a: find("a"), b: find("b") };
  const together = patches.map(() => 0), apart = patches.map(() => 0);
  for (const pair of pairs) {
    const a = at.a(pair.a), b = at.b(pair.b);
    if (a === between_patches || b === between_patches) continue;
    if (a === b && a >= 0) together[a] += 1;
    if (a !== b) for (const patch of [a, b]) if (patch >= 0) apart[patch] += 1;
  }
  patches.forEach(({ name }, k) => {
    if (apart[k] > together[k])
      warnings.push(`${name}: ${apart[k]} ${apart[k] === 1 ? "pair lies" : "pairs lie"} inside it on one model and outside on the other, ${together[k]} inside on both. Fit refuses it; the inside is the side with less area.`);
  });
  return warnings;
}

/** The patch of every face; where borders run, of the first. Patches that share other faces are listed. */
function patches_of_faces(model: PatchedModel, patches: Patch[]): { of_face: Int32Array; overlaps: [number, number][] } {
  const of_face = new Int32Array(model.graph.faces.length / 3).fill(none);
  const on_border = new Set<number>(), overlaps = new Map<string, [number, number]>(), outside: number[] = [];
  patches.forEach(({ curve }, k) => {
    const enclosed = model.enclosed(curve);
    if (enclosed === null) return;
    for (const face of enclosed.crossed) on_border.add(face);
    for (const face of enclosed.inside) {
      const owner = of_face[face];
      if (curve.meaning === "exclude") outside.push(face);
      else if (owner === none) of_face[face] = k;
      else if (!on_border.has(face)) overlaps.set(`${owner} ${k}`, [owner, k]);
    }
  });
  for (const face of outside) of_face[face] = excluded;
  return { of_face, overlaps: [...overlaps.values()] };
}

/** The patch that a point lies well inside; `between_patches` near a border and off the surface. */
function patch_at(graph: SurfaceGraph, of_face: Int32Array, point: Triple): number {
  const foot = graph.nearest(point);
  if (!(distance(foot.point, point) <= on_surface * graph.diagonal)) return between_patches;
  const own = of_face[foot.face];
  const is_inner = graph.faces_around(foot.face).every((face) => of_face[face] === own);
  return is_inner ? own : between_patches;
}
