// Picks seams of a tube by real clicks on a page of `bespoke pick --seams`, and flattens with what the page saves.
import assert from "node:assert/strict";
import { copyFileSync, mkdirSync, readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { after, before, test } from "node:test";

import type { Browser, Page } from "playwright-core";

import { bespoke, launch, open_page, require_browser, scratch_directory, until, type Opened } from "./browser";

require_browser();

interface Seam {
  name: string;
  kind: "edges" | "line";
  vertices: number[];
}
interface Work {
  seams: Seam[];
  pieces: { name: string; vertex: number }[];
  widths: { name: string; vertex: number }[];
}
interface Exposed {
  bespoke: { work(): Work; saved(): string; pixel(vertex: number): [number, number] };
}

const sides = 24, rows = 7, radius = 10, height = 30; // centimetres, open at both ends
const vertex = (row: number, side: number): number => row * sides + ((side + sides) % sides);

/** Quadrilaterals, so that edges run along and around, and none across but those of their fans. */
function tube(): string {
  const lines: string[] = [];
  for (let row = 0; row < rows; ++row)
    for (let side = 0; side < sides; ++side) {
      const angle = (2 * Math.PI * side) / sides;
      lines.push(`v ${radius * Math.sin(angle)} ${(height * row) / (rows - 1)} ${radius * Math.cos(angle)}`);
    }
  for (let row = 0; row + 1 < rows; ++row)
    for (let side = 0; side < sides; ++side)
      lines.push(`f ${[vertex(row, side), vertex(row, side + 1), vertex(row + 1, side + 1), vertex(row + 1, side)].map((v) => v + 1).join(" ")}`);
  return `${lines.join("\n")}\n`;
}

const directory = scratch_directory();
let browser: Browser;
let opened: Opened;

before(async () => {
  writeFileSync(join(directory, "tube.obj"), tube());
  bespoke(directory, "pick", "tube.obj", "--seams", "-o", "seams.html");
  browser = await launch();
  opened = await open_page(browser, join(directory, "seams.html"));
  await opened.page.getByRole("button", { name: "Front" }).click();
});

after(async () => {
  assert.deepEqual(opened.trouble, [], "no errors, no requests");
  await browser.close();
});

const work = (page: Page = opened.page): Promise<Work> => page.evaluate(() => (window as unknown as Exposed).bespoke.work());
const tool = (name: string): Promise<void> => opened.page.getByRole("button", { name, exact: true }).click();
async function click(number: number): Promise<void> {
  const [x, y] = await opened.page.evaluate((v) => (window as unknown as Exposed).bespoke.pixel(v), number);
  await opened.page.mouse.click(x, y);
}

/** Of every seam the vertices of its way, from 0. */
const saved_edges = async (): Promise<number[][]> => {
  const text = await opened.page.evaluate(() => (window as unknown as Exposed).bespoke.saved());
  return (JSON.parse(text) as { seams: { edges: number[][] }[] }).seams.map(({ edges }) => [edges[0][0], ...edges.map((edge) => edge[1])].map((v) => v - 1));
};

test("clicks lead a seam along the edges of the mesh", async () => {
  await click(vertex(0, -4));
  await click(vertex(rows - 1, -4));
  await opened.page.getByRole("button", { name: "Begin another seam" }).click();
  await click(vertex(0, 4));
  await click(vertex(3, 4));
  await click(vertex(rows - 1, 4));
  assert.deepEqual((await work()).seams.map((seam) => [seam.name, seam.vertices]), [
    ["seam 1", [vertex(0, -4), vertex(rows - 1, -4)]],
    ["seam 2", [vertex(0, 4), vertex(3, 4), vertex(rows - 1, 4)]],
  ]);
  const column = (side: number): number[] => Array.from({ length: rows }, (_, row) => vertex(row, side));
  assert.deepEqual(await saved_edges(), [column(-4), column(4)]);
});

test("undo takes back, redo brings back", async () => {
  const all = await work();
  await opened.page.keyboard.press("Control+z");
  assert.equal((await work()).seams[1].vertices.length, 2);
  await opened.page.getByRole("button", { name: "Redo" }).click();
  assert.deepEqual(await work(), all);
});

test("a dart begins at the border or a seam, and nowhere else", async () => {
  await tool("Dart");
  await click(vertex(3, 0));
  assert.equal((await work()).seams.length, 2);
  assert.match(await opened.page.getByRole("status").first().innerText(), /A dart begins at the border/);
  await click(vertex(rows - 1, 0));
  await click(vertex(3, 0));
  const dart = (await work()).seams[2];
  assert.deepEqual([dart.name, dart.kind, dart.vertices], ["dart 1", "line", [vertex(rows - 1, 0), vertex(3, 0)]]);
});

test("pieces and widths are named where they are clicked", async () => {
  const { page } = opened;
  await tool("Name a piece");
  await click(vertex(2, 1));
  await page.keyboard.type("front");
  await page.keyboard.press("Enter");
  await tool("Width");
  await click(vertex(2, 2));
  await page.keyboard.type("waist");
  await page.keyboard.press("Enter");
  const { pieces, widths } = await work();
  assert.deepEqual([pieces, widths], [[{ name: "front", vertex: vertex(2, 1) }], [{ name: "waist", vertex: vertex(2, 2) }]]);
});

test("a reload keeps the work", async () => {
  const before_reload = await work();
  await opened.page.reload();
  await opened.page.locator("html[data-ready=yes]").waitFor();
  assert.deepEqual(await work(), before_reload);
});

test("what it saves is what flatten takes", async () => {
  const { page } = opened;
  await page.getByRole("tab", { name: "Save and import" }).click();
  assert.match(await page.getByRole("tabpanel").innerText(), /bespoke flatten tube\.obj --unit UNIT --seams seams\.json/);
  assert.match(await page.getByRole("tabpanel").innerText(), /UNIT is the length unit that the file’s numbers are in: mm, cm, m or in\./);
  const [download] = await Promise.all([page.waitForEvent("download"), page.getByRole("button", { name: "Save seams.json" }).click()]);
  copyFileSync(await download.path(), join(directory, "seams.json"));
  bespoke(directory, "flatten", "tube.obj", "--unit", "cm", "--seams", "seams.json", "-o", "pieces.json", "--quiet");
  const flat = JSON.parse(readFileSync(join(directory, "pieces.json"), "utf8"));
  const names = (flat.pieces as { name: string }[]).map((piece) => piece.name);
  assert.equal(names.length, 2);
  assert.ok(names.includes("front"));
  // Eight sides wide; two lengths of a dart of three rows more than a rectangle has.
  const front = flat.pieces.find((piece: { name: string }) => piece.name === "front");
  assert.equal(front.outline.length, 2 * 8 + 2 * (rows - 1) + 2 * 3);
  const width = 10 * 8 * 2 * radius * Math.sin(Math.PI / sides); // millimetres
  assert.ok(Math.abs(flat.widths[0].width - width) < 0.1, `${flat.widths[0].width} for ${width}`);
  for (const seam of flat.seams) assert.equal(seam.differs, false);
});

test("a file is where another page begins, and what a page imports", async () => {
  bespoke(directory, "pick", "tube.obj", "--seams", "seams.json", "-o", "again.html");
  const again = await open_page(browser, join(directory, "again.html"));
  const names = async (): Promise<string[]> => (await work(again.page)).seams.map((seam) => seam.name);
  assert.deepEqual(await names(), ["seam 1", "seam 2", "dart 1"]);
  const saved = await again.page.evaluate(() => (window as unknown as Exposed).bespoke.saved());
  assert.deepEqual(JSON.parse(saved), JSON.parse(readFileSync(join(directory, "seams.json"), "utf8")));
  writeFileSync(join(directory, "path.json"), JSON.stringify({ seams: [{ name: "centre", path: [vertex(0, 0) + 1, vertex(rows - 1, 0) + 1] }] }));
  await again.page.getByRole("tab", { name: "Save and import" }).click();
  await again.page.locator("input[type=file]").setInputFiles(join(directory, "path.json"));
  await until(async () => (await names()).join() === "centre");
  writeFileSync(join(directory, "bad.json"), '{"seams":[{"path":[1,999]}]}');
  await again.page.locator("input[type=file]").setInputFiles(join(directory, "bad.json"));
  await until(async () => (await again.page.locator("[role=status]").allInnerTexts()).join().includes("999 is no vertex of 1 … 168"));
  assert.deepEqual(await names(), ["centre"]);
  assert.deepEqual(again.trouble, []);
  await again.page.context().close();
});

/** One triangle, whose positions are in metres, as of every glTF file. */
function gltf(): string {
  const data = Buffer.from(Float32Array.of(0, 0, 0, 1, 0, 0, 0, 1, 0).buffer);
  return JSON.stringify({
    asset: { version: "2.0" },
    scene: 0,
    scenes: [{ nodes: [0] }],
    nodes: [{ mesh: 0 }],
    meshes: [{ primitives: [{ attributes: { POSITION: 0 } }] }],
    accessors: [{ bufferView: 0, componentType: 5126, count: 3, type: "VEC3", min: [0, 0, 0], max: [1, 1, 0] }],
    bufferViews: [{ buffer: 0, byteLength: data.length }],
    buffers: [{ byteLength: data.length, uri: `data:application/octet-stream;base64,${data.toString("base64")}` }],
  });
}

/** Of another page of this garment its tab for files, which is shown. */
async function files_tab(garment: string, ...seams: string[]): Promise<Opened> {
  bespoke(directory, "pick", garment, "--seams", ...seams, "-o", "other.html");
  const other = await open_page(browser, join(directory, "other.html"));
  await other.page.getByRole("tab", { name: "Save and import" }).click();
  return other;
}

async function close({ page, trouble }: Opened): Promise<void> {
  assert.deepEqual(trouble, []);
  await page.context().close();
}

test("the command quotes the garment's path for a shell", async () => {
  mkdirSync(join(directory, "my garments"));
  copyFileSync(join(directory, "tube.obj"), join(directory, "my garments", "ann's $1.obj"));
  const other = await files_tab("my garments/ann's $1.obj");
  assert.ok((await other.page.getByRole("tabpanel").innerText()).includes("bespoke flatten 'my garments/ann'\\''s $1.obj' --unit UNIT --seams"));
  await close(other);
});

test("a format with a unit of its own needs none in the command", async () => {
  writeFileSync(join(directory, "triangle.gltf"), gltf());
  const other = await files_tab("triangle.gltf"), text = await other.page.getByRole("tabpanel").innerText();
  assert.match(text, /bespoke flatten triangle\.gltf --seams seams\.json/);
  assert.doesNotMatch(text, /UNIT/i);
  await close(other);
});

test("an ease without its longer side is said and not saved, nor the reverse", async () => {
  writeFileSync(join(directory, "plain.json"), JSON.stringify({ seams: [{ name: "side", path: [1, vertex(2, 0) + 1] }] }));
  const other = await files_tab("tube.obj", "plain.json"), { page } = other;
  const downloads: string[] = [];
  page.on("download", (download) => downloads.push(download.suggestedFilename()));
  const fill = async (label: string, text: string): Promise<void> => {
    await page.getByRole("tab", { name: "Seams" }).click();
    await page.getByLabel(label).fill(text);
    await page.getByLabel(label).blur();
    await page.getByRole("tab", { name: "Save and import" }).click();
  };
  const save = (): Promise<void> => page.getByRole("button", { name: "Save seams.json" }).click();
  const status = page.getByRole("status", { name: "Saving and importing" });

  await fill("Ease of side", "5");
  await save();
  assert.equal(await status.innerText(), 'Nothing was saved: seam 1 (“side”) has an ease, but "longer" names no piece.');
  await fill("Ease of side", "");
  assert.equal(await status.innerText(), "", "what was said is gone once something changed");
  await fill("Longer side of side", "front");
  await save();
  assert.equal(await status.innerText(), "Nothing was saved: seam 1 (“side”) has a longer side, but no ease.");
  await fill("Ease of side", "5");
  assert.deepEqual(downloads, []);
  const [download] = await Promise.all([page.waitForEvent("download"), save()]);
  const [seam] = JSON.parse(readFileSync(await download.path(), "utf8")).seams;
  assert.deepEqual([seam.ease, seam.longer, downloads], [5, "front", ["seams.json"]]);
  await close(other);
});

test("a seam of edges that branch is one row, and is saved as it came", async () => {
  const at = (row: number, side: number): number => vertex(row, side) + 1;
  const file = { seams: [{ name: "fork", edges: [[at(0, 0), at(1, 0)], [at(1, 0), at(2, 0)], [at(1, 0), at(1, 1)]] }], pieces: [], widths: [] };
  writeFileSync(join(directory, "fork.json"), JSON.stringify(file));
  const other = await files_tab("tube.obj", "fork.json"), { page } = other;
  assert.deepEqual(JSON.parse(await page.evaluate(() => (window as unknown as Exposed).bespoke.saved())), file);
  await page.getByRole("tab", { name: "Seams" }).click();
  assert.equal(await page.locator("table.seams tbody tr").count(), 1);
  await close(other);
});

test("what a file has wrong is said where it was chosen", async () => {
  writeFileSync(join(directory, "strange.json"), '{"seams":[{"path":[1,2],"eases":3}]}');
  const other = await files_tab("tube.obj");
  await other.page.locator("input[type=file]").setInputFiles(join(directory, "strange.json"));
  const status = other.page.getByRole("status", { name: "Saving and importing" });
  await until(async () => (await status.innerText()) === 'Nothing was imported: seam 1 has the key "eases", which means nothing here.');
  await close(other);
});
