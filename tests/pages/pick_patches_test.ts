// Picks patches by real clicks on a page of `bespoke pick`; fit takes what the page saves, and both mean the same part of a model.
import assert from "node:assert/strict";
import { copyFileSync, readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { after, before, test } from "node:test";

import type { Browser, Page } from "playwright-core";

import { bespoke, drawn_pixels, open_feet, require_browser, scratch_directory, until, type Opened } from "./browser";

require_browser();

type Triple = [number, number, number];
type Side = "a" | "b";
interface Curve extends Record<Side, { points: Triple[]; pieces: Triple[][] }> {
  name: string;
  meaning: string;
  closed: boolean;
  fixed: [number, number][];
}
interface Exposed {
  bespoke: { curves(): Curve[]; inside(side: Side): number[]; pixel(side: Side, point: Triple): [number, number] };
}
interface SavedPatch {
  name?: string;
  a?: { border?: Triple[]; faces?: number[] };
  b?: { border?: Triple[]; faces?: number[] };
  exclude?: true;
}
interface Saved {
  pairs: object[];
  curves?: object[];
  patches?: SavedPatch[];
}

const directory = scratch_directory();
const diagonal = 30; // cm, about that of either foot
const sides = ["a", "b"] as const;
const around = ["shin_front", "shin_outside", "ankle_outside", "ankle_front"]; // seen from this side, in their order round a patch
let browser: Browser;
let opened: Opened;
let given: (Record<Side, Triple> & { name: string })[];

before(async () => {
  ({ browser, opened, given } = await open_feet(directory));
  await show_curves();
});

after(async () => {
  assert.deepEqual(opened.trouble, [], "no errors, no requests");
  await browser.close();
});

const show_curves = (page: Page = opened.page): Promise<void> => page.getByRole("tab", { name: "Curves" }).click();
const curves = (page: Page = opened.page): Promise<Curve[]> => page.evaluate(() => (window as unknown as Exposed).bespoke.curves());
const inside = (side: Side, page: Page = opened.page): Promise<number[]> => page.evaluate((where) => (window as unknown as Exposed).bespoke.inside(where as Side), side);
const pixel = (side: Side, point: Triple): Promise<[number, number]> =>
  opened.page.evaluate(([where, at]) => (window as unknown as Exposed).bespoke.pixel(where as Side, at as Triple), [side, point] as const);
const button = (name: string) => opened.page.getByRole("button", { name, exact: true });
const kind = (name: string) => opened.page.getByLabel(`Kind of “${name}”`);
const warnings = (): Promise<string> => opened.page.getByRole("status", { name: "Warnings about curves" }).innerText();
const distance = (x: Triple, y: Triple): number => Math.hypot(...x.map((value, axis) => value - y[axis]));
const of_pair = (name: string): Record<Side, Triple> => given.find((each) => each.name === name)!;

/** Clicks where a point is drawn; whether the model was met there, and not something in front of it. */
async function lay(side: Side, point: Triple): Promise<boolean> {
  const count = (await curves()).at(-1)?.[side].points.length ?? 0;
  await opened.page.mouse.click(...(await pixel(side, point)));
  const now = (await curves()).at(-1)?.[side].points ?? [];
  if (now.length === count) return false;
  if (now.some((placed) => distance(placed, point) < 0.01 * diagonal)) return true;
  await button("Undo").click();
  return false;
}

async function saved(page: Page = opened.page): Promise<Saved> {
  await page.getByRole("tab", { name: "Save and import" }).click();
  const [download] = await Promise.all([page.waitForEvent("download"), page.getByRole("button", { name: "Save anchors.json" }).click()]);
  const text = readFileSync(await download.path(), "utf8");
  copyFileSync(await download.path(), join(directory, "anchors.json"));
  await show_curves(page);
  return JSON.parse(text) as Saved;
}

/** What the page says of a file that is opened. */
async function read(document: object): Promise<string> {
  writeFileSync(join(directory, "given.json"), JSON.stringify(document));
  await opened.page.getByRole("tab", { name: "Save and import" }).click();
  const said = opened.page.getByRole("status", { name: "What was read" });
  await said.evaluate((element) => (element.textContent = ""));
  await opened.page.locator("input[type=file]").setInputFiles(join(directory, "given.json"));
  await until(async () => (await said.innerText()) !== "");
  const text = await said.innerText();
  await show_curves();
  return text;
}

test("a line through clicked places on both models becomes a patch: closed, tinted, without fixed points", async () => {
  for (const name of around) for (const side of sides) assert.ok(await lay(side, of_pair(name)[side]), `${name} on ${side}`);
  await kind("c1").selectOption("closed");
  const [line] = await curves();
  assert.deepEqual([line.meaning, line.closed, await inside("a")], ["line", true, []]);
  const before_fill = await drawn_pixels(opened.page);
  await kind("c1").focus();
  await kind("c1").selectOption("patch");
  assert.equal(await opened.page.evaluate(() => document.activeElement?.getAttribute("aria-label")), "Kind of “c1”", "the list is made anew under the keyboard's focus");
  const [patch] = await curves();
  assert.deepEqual([patch.meaning, patch.closed, patch.a.pieces.length, patch.b.pieces.length], ["patch", true, 4, 4]);
  for (const side of sides) assert.ok((await inside(side))[0] > 20, `${await inside(side)} faces`);
  const after_fill = await drawn_pixels(opened.page);
  assert.equal(after_fill.drawn, before_fill.drawn);
  assert.notDeepEqual(after_fill.mean, before_fill.mean);
  await button("Choose “c1”").click();
  for (const side of sides) await opened.page.mouse.click(...(await pixel(side, patch[side].points[0])));
  assert.ok(await button("Fix the two together").isDisabled());
});

test("undo and redo change what a line means, and a reload keeps it", async () => {
  const all = await curves(), tinted = await inside("a");
  await button("Undo").click();
  assert.equal((await curves())[0].meaning, "line");
  assert.deepEqual(await inside("a"), []);
  await button("Undo").click();
  assert.equal((await curves())[0].closed, false);
  await button("Redo").click();
  await button("Redo").click();
  assert.deepEqual(await curves(), all);
  await opened.page.reload();
  await opened.page.locator("html[data-ready=yes]").waitFor();
  await show_curves();
  assert.deepEqual([await curves(), await inside("a")], [all, tinted]);
});

test("what it encloses is found anew when a point was dragged", async () => {
  const [was] = await inside("a"), [patch] = await curves();
  await button("Choose “c1”").click();
  const [x, y] = await pixel("a", patch.a.points[2]);
  await opened.page.mouse.move(x, y);
  await opened.page.mouse.down();
  await opened.page.mouse.move(x - 25, y + 5, { steps: 3 });
  assert.deepEqual(await inside("a"), [was], "not while it moves");
  await opened.page.mouse.up();
  assert.notDeepEqual(await inside("a"), [was]);
  await button("Undo").click();
  assert.deepEqual([await curves(), await inside("a")], [[patch], [was]]);
});

test("the saved border runs through the clicked places; fit takes it and finds the same faces inside", async () => {
  const [patch] = await curves();
  assert.match(await warnings(), /fit requires pairs or a curve beside them/);
  const { patches, curves: lines } = await saved();
  assert.equal(lines, undefined);
  assert.equal(patches?.length, 1);
  for (const side of sides) for (const point of patch[side].points) assert.ok(patches![0][side]!.border!.some((other) => distance(other, point) < 1e-12));
  assert.match(await read({ units: "cm", pairs: given, patches }), /\d pairs and 1 patch from/);
  assert.equal(await warnings(), "");
  assert.deepEqual((await saved()).patches, patches, "it comes back as it was");
  bespoke(directory, "fit", "shoe/source.obj", "shoe/target.obj", "--anchors", "anchors.json", "-o", "patch.vdb", "--report", "report.json", "--quiet");
  const [found] = JSON.parse(readFileSync(join(directory, "report.json"), "utf8")).stages.find((stage: { name: string }) => stage.name === "patches").patches;
  const counts = [(await inside("a"))[0], (await inside("b"))[0]];
  // The page has 16 bits a coordinate: a vertex on the line may change sides.
  [found.source_faces, found.target_faces].forEach((count, i) => assert.ok(Math.abs(count - counts[i]) <= 0.02 * count, `${count} and ${counts[i]}`));
});

test("an excluded part of the source alone is saved without a line on the target", async () => {
  await button("New patch").click();
  await kind("patch1").selectOption("excluded");
  assert.match(await warnings(), /“patch1” lacks 3 points on the source or 3 points on the target; saved are complete patches only/);
  const placed: Triple[] = [];
  for (const pair of given.filter(({ name }) => !around.includes(name))) if (placed.length < 3 && (await lay("a", pair.a))) placed.push(pair.a);
  assert.equal(await warnings(), "");
  const patch = (await saved()).patches?.[1];
  assert.deepEqual([patch?.name, patch?.exclude, patch?.b], ["patch1", true, undefined]);
  for (const point of placed) assert.ok(patch!.a!.border!.some((other) => distance(other, point) < 0.01 * diagonal));
  bespoke(directory, "fit", "shoe/source.obj", "shoe/target.obj", "--anchors", "anchors.json", "-o", "excluded.vdb", "--quiet");
});

test("a file's borders can be edited, its patches by face numbers are kept; saving gives all back", async () => {
  const { patches } = await saved();
  const sole: SavedPatch = { name: "sole", a: { faces: [0, 1, 2] }, b: { border: patches![0].b!.border } };
  const document = { pairs: given, patches: [sole, ...patches!] };
  assert.match(await read(document), /\d pairs and 2 patches from .* 1 patch given by face numbers is kept/);
  assert.deepEqual((await saved()).patches, [...patches!, sole]);
  await button("Choose “c1”").click();
  await opened.page.mouse.click(...(await pixel("a", (await curves())[0].a.points[0])));
  await button("Delete on source").click();
  const changed = (await saved()).patches!;
  assert.notDeepEqual(changed[0].a, patches![0].a);
  assert.deepEqual([changed[0].b, changed[1], changed[2]], [patches![0].b, patches![1], sole]);
});

test("an excluded part on one model is mirrored as such; turned round, a border encloses the same; deleted, neither is drawn", async () => {
  const all = await curves(), tinted = await inside("b");
  await button("Choose “patch1”").click();
  await button("Mirror chosen").click();
  const image = (await curves()).at(-1)!;
  assert.deepEqual([image.name, image.meaning, image.closed, image.a.points.length, image.b.points.length], ["patch1_mirrored", "exclude", true, all[1].a.points.length, 0]);
  await button("Choose “c1”").click();
  await button("Turn round on target").click();
  assert.notDeepEqual((await curves())[0].b, all[0].b);
  assert.deepEqual(await inside("b"), tinted);
  for (const name of ["c1", "patch1", "patch1_mirrored"]) await button(`Delete “${name}”`).click();
  assert.deepEqual([await curves(), await inside("a"), await inside("b")], [[], [], []]);
  for (let steps = 0; steps < 5; ++steps) await button("Undo").click();
  assert.deepEqual(await curves(), all);
});

test("work that an older page kept is taken up: lines without a meaning, patches unseen", async () => {
  const { patches } = await saved(), [line] = await curves();
  const { meaning: _, ...older } = { ...line, name: "old", closed: false };
  const reload_with = async (work: object): Promise<void> => {
    await opened.page.evaluate((kept) => {
      const key = Object.keys(localStorage).find((each) => each.startsWith("bespoke-pick-")) as string;
      localStorage.setItem(key, JSON.stringify(kept));
    }, work);
    await opened.page.reload();
    await opened.page.locator("html[data-ready=yes]").waitFor();
    await show_curves();
  };
  const wrong = [{ name: "half", a: patches![0].a }];
  await reload_with({ pairs: [], curves: [older], patches: wrong });
  assert.deepEqual((await curves()).map(({ name }) => name), ["old"]);
  assert.deepEqual((await saved()).patches, wrong, "a patch that cannot be read is kept, and the work with it");
  await reload_with({ pairs: [], curves: [older], patches });
  assert.deepEqual((await curves()).map(({ name, meaning }) => [name, meaning]), [["old", "line"], ["c1", "patch"], ["patch1", "exclude"]]);
  assert.deepEqual((await saved()).patches, patches);
});

test("what fit would refuse is warned of, or not read", async () => {
  const patches = (await saved()).patches!.slice(0, 1), [{ a, b }] = patches;
  const speck = b!.border![0].map((value, axis) => value + 1e-4 * (axis + 1)) as Triple;
  const tiny = { border: [b!.border![0], speck, [speck[0], speck[1], b!.border![0][2]]] };
  await read({ pairs: given, patches: [{ name: "shin", a, b: tiny }, { name: "shin", a, b }] });
  const said = await warnings();
  assert.match(said, /Two patches are named “shin”/);
  assert.match(said, /“shin” on the target: the border encloses no face; it is smaller than the triangles there\. Fit refuses it/);
  assert.match(said, /“shin” and “shin” overlap on the source/);
  assert.doesNotMatch(said, /on one model and outside/);
  const elsewhere = [...given].sort((x, y) => distance(y.b, b!.border![0]) - distance(x.b, b!.border![0]));
  await read({ pairs: [0.3, 0.5, 0.7].map((share, i) => ({ name: `p${i}`, a: between_borders(a!.border!, share), b: elsewhere[i].b })), patches });
  assert.match(await warnings(), /inside it on one model and outside on the other/);
  assert.match(await read({ pairs: given, patches: [{ name: "shin", a }] }), /patch 0 \(“shin”\): "b" is missing; only a patch with "exclude": true/);
  assert.match(await read({ pairs: given, patches: [{ a: { border: a!.border!.slice(0, 2) }, b }] }), /patch 0: the border of "a" has 2 points; a line around a patch has three/);
});

/** A point between two that lie opposite each other on a border. */
function between_borders(border: Triple[], share: number): Triple {
  const opposite = border[Math.floor(border.length / 2)];
  return border[0].map((value, axis) => value + share * (opposite[axis] - value)) as Triple;
}
