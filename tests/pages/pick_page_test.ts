// Picks pairs by real clicks on a page of `bespoke pick`, and fits with what the page saves.
import assert from "node:assert/strict";
import { copyFileSync, mkdirSync, readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { after, before, test } from "node:test";

import type { Browser, Page } from "playwright-core";

import { bespoke, drawn_pixels, open_feet, open_page, require_browser, scratch_directory, until, type Opened } from "./browser";

require_browser();

type Triple = [number, number, number];
interface Pair {
  name: string;
  a: Triple | null;
  b: Triple | null;
  sigma?: number | null;
}
interface Exposed {
  bespoke: { pairs(): Pair[]; pixel(side: "a" | "b", point: Triple): [number, number]; draw(): void };
}

const directory = scratch_directory();
const page_file = join(directory, "pick.html");
let browser: Browser;
let opened: Opened;
let given: Pair[];

before(async () => {
  ({ browser, opened, given } = await open_feet(directory));
});

after(async () => {
  assert.deepEqual(opened.trouble, [], "no errors, no requests");
  await browser.close();
});

const pairs = (page: Page = opened.page): Promise<Pair[]> => page.evaluate(() => (window as unknown as Exposed).bespoke.pairs());
const pixel = (side: "a" | "b", point: Triple): Promise<[number, number]> =>
  opened.page.evaluate(([where, at]) => (window as unknown as Exposed).bespoke.pixel(where as "a" | "b", at as Triple), [side, point] as const);
const distance = (x: Triple, y: Triple): number => Math.hypot(...x.map((value, axis) => value - y[axis]));

/** Clicks where a point is drawn; whether the model was met there, and not something in front of it. */
async function click(side: "a" | "b", point: Triple): Promise<boolean> {
  const count = (await pairs()).filter((pair) => pair[side] !== null).length;
  const [x, y] = await pixel(side, point);
  await opened.page.mouse.click(x, y);
  const now = await pairs();
  const met = now.filter((pair) => pair[side] !== null).length > count;
  const last = now.at(-1)?.[side];
  if (met && last !== null && last !== undefined && distance(last, point) < 0.3) return true; // cm, of a foot of 25: a pixel
  if (met) await opened.page.getByRole("button", { name: "Undo" }).click();
  return false;
}

test("a click on each model makes a pair at the places that were clicked", async () => {
  // Of the sample's own pairs those whose ends are seen from this side.
  for (const pair of given) {
    if (pair.a === null || pair.b === null || !(await click("a", pair.a))) continue;
    if (!(await click("b", pair.b))) await opened.page.getByRole("button", { name: "Undo" }).click();
  }
  const picked = await pairs();
  assert.ok(picked.length >= 8, `${picked.length} pairs`);
  for (const pair of picked) assert.ok(pair.a !== null && pair.b !== null, `${pair.name} has both ends`);
  const wrong = picked.filter((pair) => !given.some((other) => distance(pair.a!, other.a!) < 0.3 && distance(pair.b!, other.b!) < 0.3));
  assert.deepEqual(wrong, []);
});

test("undo takes back, redo brings back, by buttons and by keys", async () => {
  const all = await pairs();
  await opened.page.getByRole("button", { name: "Delete p2" }).click();
  assert.equal((await pairs()).length, all.length - 1);
  await opened.page.getByRole("button", { name: "Undo" }).click();
  assert.deepEqual(await pairs(), all);
  await opened.page.getByRole("button", { name: "Redo" }).click();
  assert.equal((await pairs()).length, all.length - 1);
  await opened.page.keyboard.press("Control+z");
  assert.deepEqual(await pairs(), all);
});

test("a point is dragged along the surface, and off it along the normal", async () => {
  const first = (await pairs())[0];
  const [x, y] = await pixel("a", first.a!);
  const drag = async (from_x: number, from_y: number, to_x: number, to_y: number): Promise<Triple> => {
    await opened.page.mouse.move(from_x, from_y);
    await opened.page.mouse.down();
    await opened.page.mouse.move(to_x, to_y, { steps: 4 });
    await opened.page.mouse.up();
    return (await pairs())[0].a!;
  };
  const moved = await drag(x, y, x + 12, y - 12);
  assert.ok(distance(moved, first.a!) > 0.1, "it moved");
  assert.deepEqual((await pairs())[0].b, first.b);
  await opened.page.getByRole("button", { name: "Along normal" }).click();
  const [now_x, now_y] = await pixel("a", moved);
  const off = await drag(now_x, now_y, now_x - 25, now_y - 25);
  assert.ok(distance(off, moved) > 0.1, "it left the surface");
  await opened.page.getByRole("button", { name: "Undo" }).click();
  await opened.page.getByRole("button", { name: "Undo" }).click();
  assert.deepEqual((await pairs())[0], first);
  await opened.page.getByRole("button", { name: "On surface" }).click();
});

test("names and accuracies are typed", async () => {
  const { page } = opened;
  await page.getByLabel("Name of pair 1", { exact: true }).fill("toe");
  await page.getByLabel("Name of pair 1", { exact: true }).press("Enter");
  await page.getByLabel("Sigma of toe").fill("0.25");
  await page.getByLabel("Sigma of toe").press("Enter");
  assert.deepEqual([(await pairs())[0].name, (await pairs())[0].sigma], ["toe", 0.25]);
});

test("a reload keeps the work", async () => {
  const before_reload = await pairs();
  await opened.page.reload();
  await opened.page.locator("html[data-ready=yes]").waitFor();
  assert.deepEqual(await pairs(), before_reload);
});

test("what it saves is what fit takes", async () => {
  const { page } = opened;
  await page.getByRole("tab", { name: "Save and import" }).click();
  assert.match(await page.getByRole("tabpanel").innerText(), /bespoke fit shoe\/source\.obj shoe\/target\.obj --anchors anchors\.json/);
  const [download] = await Promise.all([page.waitForEvent("download"), page.getByRole("button", { name: "Save anchors.json" }).click()]);
  copyFileSync(await download.path(), join(directory, "anchors.json"));
  const saved: Pair[] = JSON.parse(readFileSync(join(directory, "anchors.json"), "utf8")).pairs;
  assert.deepEqual(saved.map((pair) => [pair.a, pair.b]), (await pairs()).map((pair) => [pair.a, pair.b]));
  bespoke(directory, "fit", "shoe/source.obj", "shoe/target.obj", "--anchors", "anchors.json", "-o", "picked.vdb", "--quiet");
  const info = JSON.parse(bespoke(directory, "info", "picked.vdb", "--json"));
  assert.equal(info.anchors.length, saved.length);
});

test("preview, hint and mirror change what is shown; opening a file replaces the pairs", async () => {
  const { page } = opened;
  await page.getByRole("tab", { name: "Pairs" }).click();
  await page.getByLabel("Preview: the source").check();
  await page.getByLabel("Show where the next pair").check();
  const count = (await pairs()).length;
  const planes = page.getByLabel("Show the planes of symmetry");
  const picture = async (): Promise<string> => (await drawn_pixels(page)).mean.join();
  const without_plane = await picture();
  assert.equal(await planes.isChecked(), false);
  await page.getByRole("button", { name: "Mirror all" }).click();
  assert.ok((await pairs()).length >= count);
  assert.ok(await planes.isChecked(), "mirroring shows by which planes");
  await page.getByRole("button", { name: "Undo" }).click();
  const with_plane = await picture();
  assert.notEqual(with_plane, without_plane);
  await planes.uncheck();
  assert.equal(await picture(), without_plane);
  await page.locator("input[type=file]").setInputFiles(join(directory, "shoe/anchors.json"));
  await until(async () => (await pairs()).length === given.length);
  assert.deepEqual((await pairs()).map((pair) => pair.a), given.map((pair) => pair.a));
});

test("the command quotes the models' paths for a shell", async () => {
  const path = "my models/ann's foot.obj";
  mkdirSync(join(directory, "my models"));
  copyFileSync(join(directory, "shoe/source.obj"), join(directory, path));
  bespoke(directory, "pick", path, "shoe/target.obj", "-o", "quoted.html");
  const quoted = await open_page(browser, join(directory, "quoted.html"));
  await quoted.page.getByRole("tab", { name: "Save and import" }).click();
  const text = await quoted.page.getByRole("tabpanel").innerText();
  assert.ok(text.includes("bespoke fit 'my models/ann'\\''s foot.obj' shoe/target.obj --anchors anchors.json"), text);
  assert.deepEqual(quoted.trouble, []);
  await quoted.page.context().close();
});

test("two pairs of one name, which fit refuses, are warned of", async () => {
  const { page } = opened;
  const name = page.getByLabel("Name of pair 2", { exact: true }), first = given[0].name;
  await name.fill(first);
  await name.press("Enter");
  const warnings = page.getByRole("status", { name: "Warnings" });
  await until(async () => (await warnings.innerText()).includes(`Two pairs are named “${first}”`));
  await page.getByRole("button", { name: "Undo" }).click();
  assert.equal(await warnings.innerText(), "");
});

test("swapped targets are warned of, sound pairs are not", async () => {
  const warnings = opened.page.getByRole("status", { name: "Warnings" });
  assert.equal(await warnings.innerText(), "");
  const swapped = structuredClone(given);
  [swapped[0].b, swapped[9].b] = [swapped[9].b, swapped[0].b];
  writeFileSync(join(directory, "swapped.json"), JSON.stringify({ pairs: swapped }));
  await opened.page.locator("input[type=file]").setInputFiles(join(directory, "swapped.json"));
  await until(async () => (await warnings.innerText()).includes("perhaps swapped with"));
});
