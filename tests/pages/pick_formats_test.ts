// The files of other programs on a page of `bespoke pick`: the same pairs as `bespoke anchors convert` has, either way.
import assert from "node:assert/strict";
import { copyFileSync, readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { after, before, test } from "node:test";

import type { Browser, Download } from "playwright-core";

import { bespoke, launch, open_page, require_browser, scratch_directory, until, type Opened } from "./browser";

require_browser();

type Triple = [number, number, number];
interface Pair {
  name?: string;
  a: Triple;
  b: Triple;
}
interface Curve {
  name: string;
  a: Triple[];
  b: Triple[];
  closed?: boolean;
  fixed?: [number, number][];
}
interface Exposed {
  bespoke: { pairs(): Pair[]; curves(): unknown[] };
}

const directory = scratch_directory();
const file = (name: string): string => join(directory, name);
const models = ["--source", "shoe/source.obj", "--target", "shoe/target.obj"];
/** By the page's names for them. */
const formats: Record<string, { files: string[]; system?: "LPS" | "RAS" }> = {
  csv: { files: ["anchors.csv"] },
  meshlab: { files: ["anchors_a.pp", "anchors_b.pp"] },
  markups: { files: ["anchors_a.mrk.json", "anchors_b.mrk.json"], system: "RAS" },
  fiducials: { files: ["anchors_a.fcsv", "anchors_b.fcsv"], system: "RAS" },
  landmarks: { files: ["anchors_a.pts", "anchors_b.pts"] },
  wrap: { files: ["anchors_a.wrap.json", "anchors_b.wrap.json"] },
  indices: { files: ["anchors.txt"] },
};
let browser: Browser;
let opened: Opened;
let given: Pair[];
let curves: Curve[];

before(async () => {
  bespoke(directory, "samples", ".", "shoe", "--quiet");
  given = JSON.parse(readFileSync(file("shoe/anchors.json"), "utf8")).pairs.map(({ name, a, b }: Pair) => ({ name, a, b }));
  // Names that formats must quote, and numbers of all digits.
  given[0].name = 'the "tip" & <toe>, left';
  given[1].a = [Math.PI, -1 / 3, 1e-7];
  given[1].b = [0.1 + 0.2, -12345678.90123456, -3e21];
  const line = (side: "a" | "b"): Triple[] => given.slice(2, 6).map((pair) => pair[side]);
  curves = [{ name: "ankle", a: line("a"), b: line("b"), closed: true }, { name: "seam", a: line("a").slice(1), b: line("b") }];
  writeFileSync(file("given.json"), JSON.stringify({ pairs: given, curves }));
  bespoke(directory, "pick", "shoe/source.obj", "shoe/target.obj", "-o", "pick.html");
  browser = await launch();
  opened = await open_page(browser, file("pick.html"));
  await opened.page.getByRole("tab", { name: "Save and import" }).click();
});

after(async () => {
  assert.deepEqual(opened.trouble, [], "no errors, no requests");
  await browser.close();
});

const pairs = (): Promise<Pair[]> => opened.page.evaluate(() => (window as unknown as Exposed).bespoke.pairs());
const picked_curves = (): Promise<unknown[]> => opened.page.evaluate(() => (window as unknown as Exposed).bespoke.curves());
const button = (name: string) => opened.page.getByRole("button", { name, exact: true });
const said = () => opened.page.getByRole("status", { name: "What was read" });
const form = () => opened.page.getByRole("group", { name: "Files with one side each" });
const places = (list: Pair[]): Triple[][] => list.map(({ a, b }) => [a, b]);
const named = (list: Pair[]): unknown[] => list.map(({ name = "", a, b }) => ({ name, a, b }));

/** Opens files and returns what the page says of them. */
async function open_files(...names: string[]): Promise<string> {
  await said().evaluate((element) => (element.textContent = ""));
  await opened.page.locator("input[type=file]").setInputFiles(names.map(file));
  await until(async () => (await said().innerText()) !== "");
  return said().innerText();
}

/** Opens files, and takes them where there is one a side. */
async function imported(names: string[], system = "LPS"): Promise<Pair[]> {
  await open_files(...names);
  if (names.length === 2) {
    if (await form().getByLabel("Patient coordinates").isVisible()) await form().getByLabel("Patient coordinates").selectOption(system);
    await button("Import these").click();
  }
  assert.match(await said().innerText(), /in the place of what was there/);
  return pairs();
}

/** Saves for another program; the files lie in the directory then. */
async function exported(format: string): Promise<void> {
  const { files, system = "LPS" } = formats[format];
  await opened.page.getByLabel("Format of another program").selectOption(format);
  const patient = opened.page.getByRole("group", { name: "Save for another program" }).getByLabel("Patient coordinates");
  if (await patient.isVisible()) await patient.selectOption(system);
  const downloads: Download[] = [];
  const collect = (download: Download): void => void downloads.push(download);
  opened.page.on("download", collect);
  await button(`Save ${files.join(" and ")}`).click();
  await until(async () => downloads.length === files.length);
  opened.page.off("download", collect);
  for (const download of downloads) copyFileSync(await download.path(), file(download.suggestedFilename()));
}

function converted(inputs: string[], system = "LPS"): { pairs: Pair[]; curves?: Curve[] } {
  bespoke(directory, "anchors", "convert", ...inputs, "-o", "converted.json", "--coordinates", system, ...models);
  return JSON.parse(readFileSync(file("converted.json"), "utf8"));
}

for (const format of ["csv", "meshlab", "markups", "fiducials", "landmarks"])
  test(`${format}: what the page saves is what the command reads, to the last digit`, async () => {
    await imported(["given.json"]);
    await exported(format);
    const read = converted(formats[format].files, formats[format].system).pairs;
    assert.deepEqual(places(read), places(given));
    assert.equal(read[0].name, format === "landmarks" ? given[0].name!.replaceAll(" ", "_") : given[0].name);
    if (format === "markups") assert.match(readFileSync(file("anchors_a.mrk.json"), "utf8"), /"RAS"/);
  });

// Of the vectors that the library passes, too, those that need a browser (shared_vectors_test.ts has the others).
interface Vector {
  name: string;
  files: [string, string][];
  pairs?: [string, Triple, Triple][];
  fault?: string[];
}
const vectors = JSON.parse(readFileSync(join(process.env.BESPOKE_VECTORS as string, "anchor_files.json"), "utf8")) as Vector[];
for (const each of vectors.filter(({ files }) => files[0][0].endsWith(".pp")))
  test(`anchor files: ${each.name}`, async () => {
    each.files.forEach(([name, text]) => writeFileSync(file(name), text));
    const names = each.files.map(([name]) => name);
    if (each.pairs !== undefined) return assert.deepEqual((await imported(names)).map(({ name = "", a, b }) => [name, a, b]), each.pairs);
    const reply = await open_files(...names);
    each.fault!.forEach((words) => assert.ok(reply.includes(words), reply));
  });

test("vertex numbers are those of the command", async () => {
  await imported(["given.json"]);
  await exported("indices");
  bespoke(directory, "anchors", "convert", "given.json", "-o", "command.txt", ...models);
  assert.equal(readFileSync(file("anchors.txt"), "utf8"), readFileSync(file("command.txt"), "utf8"));
});

test("places of triangles are those of the command", async () => {
  const far = 2; // of the pairs only the second lies far from the models, where rounding grows with the distance
  writeFileSync(file("near.json"), JSON.stringify({ pairs: given.slice(far) }));
  await imported(["near.json"]);
  await exported("wrap");
  bespoke(directory, "anchors", "convert", "near.json", "-o", "command_a.wrap.json", "command_b.wrap.json", ...models);
  const mine = converted(formats.wrap.files).pairs, its = converted(["command_a.wrap.json", "command_b.wrap.json"]).pairs;
  assert.equal(mine.length, given.length - far);
  places(mine).flat(2).forEach((value, i) => assert.ok(Math.abs(value - places(its).flat(2)[i]) < 1e-12, "cm, of a foot of 25"));
});

for (const [format, { files, system = "LPS" }] of Object.entries(formats))
  test(`${format}: what the command writes is what the page reads, to the last digit`, async () => {
    bespoke(directory, "anchors", "convert", "given.json", "-o", ...files, "--coordinates", system, ...models);
    assert.deepEqual(named(await imported(files, system)), named(converted(files, system).pairs));
  });

test("3D Slicer's coordinates are turned into those of the models, as the command turns them", async () => {
  for (const { files } of [formats.markups, formats.fiducials])
    for (const [written, wanted] of [["RAS", "LPS"], ["LPS", "RAS"]]) {
      bespoke(directory, "anchors", "convert", "given.json", "-o", ...files, "--coordinates", written);
      const read = await imported(files, wanted);
      assert.deepEqual(read[2].a, [-given[2].a[0], -given[2].a[1], given[2].a[2]]);
      assert.deepEqual(named(read), named(converted(files, wanted).pairs));
    }
  // Files without the line that says so are RAS.
  for (const name of formats.fiducials.files) writeFileSync(file(name), "1,1,2,3\n");
  assert.deepEqual((await imported(formats.fiducials.files, "LPS"))[0].a, [-1, -2, 3]);
});

test("curves go through 3D Slicer's markups, without their fixed points", async () => {
  const fixed = [{ ...curves[0], fixed: [[0, 0], [1, 1]] }, curves[1]];
  writeFileSync(file("fixed.json"), JSON.stringify({ pairs: given, curves: fixed }));
  await imported(["fixed.json"]);
  await opened.page.getByLabel("Format of another program").selectOption("markups");
  assert.match(await opened.page.getByRole("status", { name: "What the format keeps" }).innerText(), /Left out.*the fixed points of 1 curve\./);
  await exported("markups");
  assert.deepEqual(converted(formats.markups.files, "RAS").curves, curves);
  await imported(["given.json"]);
  const kept = await picked_curves();
  await imported(formats.markups.files, "RAS");
  assert.deepEqual(await picked_curves(), kept);
});

test("files without curves leave those that are there", async () => {
  await imported(["given.json"]);
  const kept = await picked_curves();
  assert.equal(kept.length, 2);
  await imported(["anchors.csv"]);
  assert.deepEqual(await picked_curves(), kept);
  assert.match(await said().innerText(), /As before: 2 curves\./);
});

test("patches are left out of other programs' files and stay when these are opened", async () => {
  const [border, line] = curves;
  writeFileSync(file("patches.json"), JSON.stringify({ pairs: given, curves: [line], patches: [{ name: "inside", a: { border: border.a }, b: { border: border.b } }] }));
  await imported(["patches.json"]);
  const patch = (await picked_curves()).at(-1);
  await opened.page.getByLabel("Format of another program").selectOption("markups");
  assert.match(await opened.page.getByRole("status", { name: "What the format keeps" }).innerText(), /Left out.*1 patch\./);
  await exported("markups");
  assert.deepEqual(converted(formats.markups.files, "RAS").curves, [line]);
  await imported(formats.markups.files, "RAS");
  assert.equal((await picked_curves()).length, 2);
  assert.deepEqual((await picked_curves()).at(-1), patch);
  assert.match(await said().innerText(), /As before: 1 patch\./);
});

test("two files are shown with their models, by which they lie; they can be swapped, by keys alone", async () => {
  const { page } = opened;
  await open_files("anchors_b.pp", "anchors_a.pp");
  const rows = (): Promise<string[]> => form().locator("tbody tr").allInnerTexts();
  assert.match((await rows())[0], /Source\s+anchors_a\.pp\s+\d+ points/);
  assert.match((await rows())[1], /Target\s+anchors_b\.pp\s+\d+ points/);
  await page.keyboard.press("Tab");
  await page.keyboard.press("Enter");
  assert.match((await rows())[0], /Source\s+anchors_b\.pp/);
  await page.keyboard.press("Enter");
  assert.deepEqual(places(await pairs()), places(given.map((pair) => ({ a: pair.b, b: pair.a }))));
  await button("Undo").click();
  assert.deepEqual(places(await pairs()), places(given));
});

test("files may come one after the other; Cancel leaves the work", async () => {
  const before_files = await pairs();
  assert.match(await open_files("anchors_a.pts"), /anchors_a\.pts holds one side/);
  assert.ok(await button("Choose the other file").isVisible());
  await button("Cancel").click();
  assert.equal(await form().isVisible(), false);
  await open_files("anchors_b.pts");
  await open_files("anchors_a.pts");
  assert.match(await form().locator("tbody tr").first().innerText(), /Source\s+anchors_a\.pts/);
  assert.deepEqual(await pairs(), before_files, "nothing changes before somebody consents");
  await button("Import these").click();
  assert.deepEqual(places(await pairs()), places(given));
});

test("points of one name become pairs in any order; other names do not", async () => {
  writeFileSync(file("x.pts"), "Version 1.0\n2\nS000 1 2 3\nS001 4 5 6\n");
  writeFileSync(file("y.pts"), "Version 1.0\n2\nS001 40 50 60\nS000 10 20 30\n");
  writeFileSync(file("z.pts"), "Version 1.0\n2\nT001 40 50 60\nS000 10 20 30\n");
  for (const second of ["y.pts", "z.pts"]) {
    await open_files("x.pts", second);
    if (!(await form().locator("tbody tr").first().innerText()).includes("x.pts")) await button("Swap the files").click();
    assert.match(await form().innerText(), second === "y.pts" ? /Points of one name become pairs/ : /do not name the same points/);
    await button("Import these").click();
    assert.deepEqual(named(await pairs()), named(converted(["x.pts", second]).pairs));
  }
});

test("quoted names and headers of CSV are read as the command reads them", async () => {
  writeFileSync(file("odd.csv"), 'name,ax,ay,az,bx,by,bz,sigma\r\n"a, ""b""",1,2,3,4,5,6,0.5\r\n\r\n plain , 7,8,9,10,11,12\r\n');
  const read = await imported(["odd.csv"]);
  assert.deepEqual(named(read), named(converted(["odd.csv"]).pairs));
  assert.deepEqual(read.map((pair) => (pair as { sigma?: number | null }).sigma), [0.5, null]);
});

test("what a format has no place for is said before it is saved, as the command says it", async () => {
  const all = { units: "cm", pairs: given.map((pair, i) => (i < 3 ? { ...pair, sigma: 0.5 } : pair)), curves, patches: [{ name: "sole", a: { faces: [0] }, exclude: true }] };
  writeFileSync(file("all.json"), JSON.stringify(all));
  bespoke(directory, "pick", "shoe/source.obj", "shoe/target.obj", "--anchors", "all.json", "-o", "all.html");
  const { page, trouble } = await open_page(browser, file("all.html"));
  await page.getByRole("tab", { name: "Save and import" }).click();
  for (const [format, { files }] of Object.entries(formats)) {
    await page.getByLabel("Format of another program").selectOption(format);
    const note = await page.getByRole("status", { name: "What the format keeps" }).innerText();
    const line = bespoke(directory, "anchors", "convert", "all.json", "-o", ...files, ...models).trim();
    assert.equal(/format: (.*?)\./.exec(note)?.[1], line.split("in the format: ")[1], format);
  }
  assert.deepEqual(trouble, []);
  await page.context().close();
});

test("malformed files are refused by name and place, and change nothing", async () => {
  const kept = await pairs(), kept_curves = await picked_curves();
  const write = (name: string, text: string): string => {
    writeFileSync(file(name), text);
    return name;
  };
  const sound: Record<string, string> = {
    ".pp": '<PickedPoints><point x="1" y="2" z="3"/></PickedPoints>',
    ".pts": "Version 1.0\n1\nS0 1 2 3\n",
    ".fcsv": "1,1,2,3\n",
    ".mrk.json": '{"markups": [{"controlPoints": [{"position": [1, 2, 3]}]}]}',
    ".wrap.json": "[[0, 0, 0]]",
  };
  const refused = async (ending: string, text: string, reason: RegExp): Promise<void> => {
    const names = sound[ending] === undefined ? [write(`bad${ending}`, text)] : [write(`good${ending}`, sound[ending]), write(`bad${ending}`, text)];
    assert.match(await open_files(...names), reason);
    assert.deepEqual(await pairs(), kept);
    assert.deepEqual(await picked_curves(), kept_curves);
    assert.equal(await form().isVisible(), false);
  };
  await refused(".json", "{", /bad\.json: not valid JSON/);
  await refused(".json", '"pairs"', /bad\.json: must be an object/);
  await refused(".json", '{"pairs": [{"a": [1, 2], "b": [1, 2, 3]}]}', /bad\.json: "a" of pair 0 is not three numbers/);
  await refused(".csv", "p,1,2,3,4,5\n", /bad\.csv:1: 6 columns/);
  await refused(".csv", "p,1,2,3,4,5,6\nq,1,2,3,4,5,x\n", /bad\.csv:2: "x" is not a finite number/);
  await refused(".csv", "p,1,2,3,4,5,6,-1\n", /bad\.csv:1: weight is -1, but must be > 0/);
  await refused(".csv", "\n", /bad\.csv: no rows/);
  await refused(".txt", "3 4\n\n7 999999\n", /bad\.txt:3: vertex 999999 of the target's \d+/);
  await refused(".txt", "3\n", /bad\.txt:1: a line is two vertex numbers/);
  await refused(".pp", '<PickedPoints>\n<point x="4" y="5" z="6"></PickedPoints>', /bad\.pp: is no XML: line 2 at column \d+: [^.]*\.$/);
  await refused(".pp", "<Points/>", /bad\.pp: no <PickedPoints>/);
  await refused(".pp", '<PickedPoints><point x="1"/></PickedPoints>', /bad\.pp: point 0 has not all of x, y and z/);
  await refused(".pp", '<PickedPoints><point x="1" y="0x10" z=""/></PickedPoints>', /bad\.pp: point 0: "0x10" is not a finite number/);
  await refused(".pts", "Version 1.0\n2\nS0 1 2 3\n", /bad\.pts: 1 points, but it says 2/);
  await refused(".pts", "1\nS0 1 2\n", /bad\.pts:2: a point is a name and three numbers/);
  await refused(".fcsv", "# CoordinateSystem = XYZ\n", /bad\.fcsv:1: the coordinate system is "XYZ"/);
  await refused(".fcsv", "a,1,x,3\n", /bad\.fcsv:1: "x"/);
  await refused(".mrk.json", '{"markups": [{"type": "Plane", "controlPoints": []}]}', /bad\.mrk\.json: markup 0: is of type "Plane"/);
  await refused(".mrk.json", '{"markups": [{"controlPoints": [{"position": [1, 2, 1e999]}]}]}', /markup 0: control point 0: "position" is not three numbers/);
  await refused(".mrk.json", '{"markups": []}', /good\.mrk\.json has 1 points, bad\.mrk\.json has 0|bad\.mrk\.json has 0 points, good/);
  await refused(".wrap.json", "[[0, 0, 0], [0, 0]]", /bad\.wrap\.json: point 1 is not \[triangle, u, v\]/);
  await refused(".wrap.json", "[[999999, 0, 0]]", /bad\.wrap\.json: point 0: triangle 999999 of \d+/);
  await refused(".xml", "<a/>", /bad\.xml: unknown ending/);
  assert.match(await open_files("good.pp", "good.pts"), /good\.pts is of another format than good\.pp/);
  assert.match(await open_files("good.pp", "odd.csv"), /odd\.csv has both sides in one file/);
  assert.deepEqual(await pairs(), kept);
});

test("formats of vertex and triangle numbers are refused where the page has a thinned model", async () => {
  const count = 240; // a side; 2 · 239² triangles are more than the page draws of one model
  const vertices = Array.from({ length: count * count }, (_, i) => `v ${i % count} ${Math.floor(i / count)} ${Math.sin(i / 99)}\n`);
  const quads = Array.from({ length: (count - 1) * (count - 1) }, (_, i) => 1 + (i % (count - 1)) + count * Math.floor(i / (count - 1)));
  writeFileSync(file("large.obj"), vertices.join("") + quads.map((i) => `f ${i} ${i + 1} ${i + count + 1}\nf ${i} ${i + count + 1} ${i + count}\n`).join(""));
  bespoke(directory, "pick", "large.obj", "shoe/target.obj", "-o", "large.html");
  const small = opened;
  opened = await open_page(browser, file("large.html"));
  await opened.page.getByRole("tab", { name: "Save and import" }).click();
  assert.match(await open_files("anchors.txt"), /this page has large\.obj thinned to be drawn: bespoke anchors convert knows them all/);
  assert.match(await open_files("anchors_a.wrap.json", "anchors_b.wrap.json"), /bespoke anchors convert/);
  await opened.page.getByLabel("Format of another program").selectOption("indices");
  assert.match(await opened.page.getByRole("status", { name: "What the format keeps" }).innerText(), /bespoke anchors convert/);
  assert.ok(await button("Save anchors.txt").isDisabled());
  assert.deepEqual(opened.trouble, []);
  await opened.page.context().close();
  opened = small;
});
