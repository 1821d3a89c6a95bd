// Picks curves by real clicks on a page of `bespoke pick`; what the page saves lies on the models, and fit takes it.
import assert from "node:assert/strict";
import { copyFileSync, readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { after, before, test } from "node:test";

import type { Browser } from "playwright-core";

import { SurfaceGraph } from "../../src/pages/maths/surface_graph";
import { bespoke, obj_vertices, open_feet, open_page, require_browser, scratch_directory, until, type Opened } from "./browser";

require_browser();

type Triple = [number, number, number];
type Side = "a" | "b";
interface Line {
  points: Triple[];
  pieces: Triple[][];
}
interface Curve extends Record<Side, Line> {
  name: string;
  closed: boolean;
  fixed: [number, number][];
}
interface Exposed {
  bespoke: { curves(): Curve[]; pairs(): unknown[]; pixel(side: Side, point: Triple): [number, number] };
}
interface Saved {
  pairs: unknown[];
  curves: { name: string; a: Triple[]; b: Triple[]; closed?: boolean; fixed?: [number, number][] }[];
}

const directory = scratch_directory();
const diagonal = 30; // cm, about that of either foot
let browser: Browser;
let opened: Opened;
let given: (Record<Side, Triple> & { name: string })[];
const clicked = ["shin_front", "shin_outside", "ankle_outside", "ankle_front"]; // seen from this side, in their order round a patch

before(async () => {
  ({ browser, opened, given } = await open_feet(directory));
  await opened.page.getByRole("tab", { name: "Curves" }).click();
});

after(async () => {
  assert.deepEqual(opened.trouble, [], "no errors, no requests");
  await browser.close();
});

const curves = (): Promise<Curve[]> => opened.page.evaluate(() => (window as unknown as Exposed).bespoke.curves());
const pixel = (side: Side, point: Triple): Promise<[number, number]> =>
  opened.page.evaluate(([where, at]) => (window as unknown as Exposed).bespoke.pixel(where as Side, at as Triple), [side, point] as const);
const button = (name: string) => opened.page.getByRole("button", { name, exact: true });
const distance = (x: Triple, y: Triple): number => Math.hypot(...x.map((value, axis) => value - y[axis]));
const click = async (side: Side, point: Triple): Promise<void> => opened.page.mouse.click(...(await pixel(side, point)));

/** Clicks where a point is drawn; whether the model was met there, and not something in front of it. */
async function lay(side: Side, point: Triple): Promise<boolean> {
  const count = (await curves()).at(-1)?.[side].points.length ?? 0;
  await click(side, point);
  const now = (await curves()).at(-1)?.[side].points ?? [];
  if (now.length === count) return false;
  if (distance(now[now.length - 1], point) < 0.01 * diagonal) return true;
  await button("Undo").click();
  return false;
}

async function saved(): Promise<Saved> {
  await opened.page.getByRole("tab", { name: "Save and import" }).click();
  const [download] = await Promise.all([opened.page.waitForEvent("download"), button("Save anchors.json").click()]);
  copyFileSync(await download.path(), join(directory, "anchors.json"));
  await opened.page.getByRole("tab", { name: "Curves" }).click();
  return JSON.parse(readFileSync(join(directory, "anchors.json"), "utf8")) as Saved;
}

function model(path: string): SurfaceGraph {
  const lines = readFileSync(join(directory, path), "utf8").split("\n").filter((line) => line.startsWith("f "));
  const corners = lines.flatMap((line) => line.trim().split(/\s+/).slice(1, 4).map((word) => parseInt(word, 10) - 1));
  return new SurfaceGraph(new Float32Array(obj_vertices(join(directory, path)).flat()), new Uint32Array(corners));
}

test("clicks on both models, the last one on the first point, make a closed curve through the clicked places", async () => {
  const placed: Record<Side, Triple[]> = { a: [], b: [] };
  for (const name of clicked) {
    const pair = given.find((each) => each.name === name)!;
    for (const side of ["b", "a"] as const) {
      assert.ok(await lay(side, pair[side]), `${name} on ${side}`);
      placed[side].push(pair[side]);
    }
  }
  assert.equal((await curves())[0].closed, false);
  await click("a", (await curves())[0].a.points[0]);
  await opened.page.getByRole("tab", { name: "Pairs" }).click();
  await opened.page.getByRole("tab", { name: "Curves" }).click();
  const [curve] = await curves();
  assert.deepEqual([curve.closed, curve.a.pieces.length, curve.b.pieces.length], [true, 4, 4]);
  for (const side of ["a", "b"] as const)
    curve[side].points.forEach((point, i) => {
      assert.ok(distance(point, placed[side][i]) < 0.01 * diagonal, "where it was clicked");
      assert.deepEqual(curve[side].pieces[i][0], point);
      assert.deepEqual(curve[side].pieces[i].at(-1), curve[side].points[(i + 1) % 4]);
    });
});

test("undo takes points back, redo brings them again", async () => {
  const all = await curves();
  await button("Undo").click();
  assert.equal((await curves())[0].closed, false);
  await opened.page.keyboard.press("Control+z");
  assert.equal((await curves())[0].a.points.length, 3);
  await button("Redo").click();
  await button("Redo").click();
  assert.deepEqual(await curves(), all);
});

test("a point is dragged along the surface, one is added on the line, and Delete takes it away", async () => {
  const [first] = await curves();
  const [x, y] = await pixel("a", first.a.points[2]);
  await opened.page.mouse.move(x, y);
  await opened.page.mouse.down();
  await opened.page.mouse.move(x - 10, y - 8, { steps: 3 });
  await opened.page.mouse.up();
  const [moved] = await curves();
  assert.ok(distance(moved.a.points[2], first.a.points[2]) > 0.1);
  assert.deepEqual([moved.a.pieces[0], moved.a.pieces[3], moved.b], [first.a.pieces[0], first.a.pieces[3], first.b]);
  const piece = moved.b.pieces[1];
  await click("b", piece[Math.floor(piece.length / 2)]);
  const [more] = await curves();
  assert.equal(more.b.points.length, 5);
  assert.deepEqual([more.b.points[1], more.b.points[3]], [moved.b.points[1], moved.b.points[2]]);
  await opened.page.keyboard.press("Delete");
  assert.equal((await curves())[0].b.points.length, 4);
  for (let steps = 0; steps < 3; ++steps) await button("Undo").click();
  assert.deepEqual(await curves(), [first]);
});

test("it is named; two points of it are fixed together; a reload keeps it", async () => {
  const { page } = opened;
  await page.getByLabel("Name of curve 1").fill("ankle");
  await page.getByLabel("Name of curve 1").press("Enter");
  const [curve] = await curves();
  await button("Choose “ankle”").click();
  assert.ok(await button("Fix the two together").isDisabled());
  await click("a", curve.a.points[1]);
  await click("b", curve.b.points[2]);
  await button("Fix the two together").click();
  assert.deepEqual((await curves())[0].fixed, [[1, 2]]);
  const before_reload = await curves();
  await page.reload();
  await page.locator("html[data-ready=yes]").waitFor();
  await page.getByRole("tab", { name: "Curves" }).click();
  assert.deepEqual(await curves(), before_reload);
});

test("what it saves lies on the models, passes through the clicked places, and comes back as it was", async () => {
  const [curve] = await curves();
  const [written] = (await saved()).curves;
  assert.deepEqual([written.name, written.closed, written.fixed], ["ankle", true, [[0, 0]]]);
  assert.deepEqual([written.a[0], written.b[0]], [curve.a.points[1], curve.b.points[2]], "fixed points come first");
  for (const side of ["a", "b"] as const) {
    const surface = model(side === "a" ? "shoe/source.obj" : "shoe/target.obj");
    const line = written[side];
    for (const point of curve[side].points) assert.ok(line.some((other) => distance(other, point) < 1e-12));
    const off = line.map((point, i) => {
      const next = line[(i + 1) % line.length], middle = point.map((value, axis) => (value + next[axis]) / 2) as Triple;
      return Math.max(...[point, middle].map((x) => distance(x, surface.nearest(x).point)));
    });
    assert.ok(Math.max(...off) < 1e-4 * diagonal, `off by ${Math.max(...off)} cm`);
  }
  await opened.page.locator("input[type=file]").setInputFiles(join(directory, "anchors.json"));
  await until(async () => (await curves())[0].a.points.length > 4);
  assert.deepEqual((await saved()).curves, [written]);
});

test("audit and fit take it, beside pairs", async () => {
  const { curves: picked } = await saved();
  // The page has nothing to edit patches by face numbers with; what a file has of them it keeps.
  const patches = [{ name: "sole", a: { faces: [0, 1, 2] }, exclude: true }];
  writeFileSync(join(directory, "both.json"), JSON.stringify({ patches, units: "cm", pairs: given.filter((pair) => !clicked.includes(pair.name)), curves: picked.map(({ name, a, b, closed }) => ({ name, a, b, closed })) }));
  bespoke(directory, "pick", "shoe/source.obj", "shoe/target.obj", "--anchors", "both.json", "-o", "again.html");
  const again = await open_page(browser, join(directory, "again.html"));
  await again.page.getByRole("tab", { name: "Save and import" }).click();
  const [download] = await Promise.all([again.page.waitForEvent("download"), again.page.getByRole("button", { name: "Save anchors.json" }).click()]);
  copyFileSync(await download.path(), join(directory, "saved.json"));
  assert.deepEqual(again.trouble, []);
  await again.page.context().close();
  const read = JSON.parse(readFileSync(join(directory, "saved.json"), "utf8"));
  assert.deepEqual(read.curves, JSON.parse(readFileSync(join(directory, "both.json"), "utf8")).curves);
  assert.deepEqual(read.patches, patches);
  bespoke(directory, "anchors", "audit", "saved.json", "--source", "shoe/source.obj", "--target", "shoe/target.obj");
  bespoke(directory, "fit", "shoe/source.obj", "shoe/target.obj", "--anchors", "saved.json", "-o", "curve.vdb", "--quiet");
});

test("files with odd curves are refused with what is wrong, or warned of", async () => {
  const { page } = opened;
  const line = given.slice(0, 4).map((pair) => pair.a), other = given.slice(0, 4).map((pair) => pair.b);
  const read = async (list: object[]): Promise<string> => {
    await page.getByRole("tab", { name: "Save and import" }).click();
    writeFileSync(join(directory, "odd.json"), JSON.stringify({ pairs: given, curves: list }));
    const said = page.getByRole("status", { name: "What was read" });
    await said.evaluate((element) => (element.textContent = ""));
    await page.locator("input[type=file]").setInputFiles(join(directory, "odd.json"));
    await until(async () => (await said.innerText()) !== "");
    return said.innerText();
  };
  const kept = await curves();
  assert.match(await read([{ name: "waist", a: line.slice(0, 1), b: other }]), /curve 0 \(“waist”\): its line on the source, "a", has 1 points?; two/);
  assert.match(await read([{ name: "waist", a: line }]), /curve 0 \(“waist”\) has no line on the target/);
  assert.match(await read([{ name: "waist", a: line, b: other, fixed: [[0, 9]] }]), /"fixed" is not a list/);
  assert.match(await read([{ a: [...line, "x"], b: other }]), /curve 0: point 4 of "a" is not three numbers/);
  assert.deepEqual(await curves(), kept, "a refused file changes nothing");
  assert.match(await read([{ name: "waist", a: line, b: other }, { name: "waist", a: line, b: [...other].reverse() }]), /22 pairs and 2 curves|pairs and 2 curves/);
  await page.getByRole("tab", { name: "Curves" }).click();
  const warnings = await page.getByRole("status", { name: "Warnings about curves" }).innerText();
  assert.match(warnings, /Two curves are named “waist”/);
  assert.match(warnings, /“waist” seems to run the other way on the target/);
  await button("Choose “waist”").nth(1).click();
  await button("Turn round on target").click();
  await until(async () => !(await page.getByRole("status", { name: "Warnings about curves" }).innerText()).includes("other way"));
});
