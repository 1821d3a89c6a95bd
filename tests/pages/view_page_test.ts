// Opens a page of `bespoke view` from the disk in Debian's Chromium and uses it as a person would.
import assert from "node:assert/strict";
import { statSync } from "node:fs";
import { join } from "node:path";
import { after, before, test } from "node:test";

import type { Browser } from "playwright-core";

import { bespoke, drawn_pixels, launch, obj_vertices, open_page, require_browser, scratch_directory, until, type Opened } from "./browser";

require_browser();

const directory = scratch_directory();
const file = join(directory, "shoe.html");
const product_mesh = 2; // source, target, then the products in their order
let browser: Browser;
let opened: Opened;

interface Exposed {
  bespoke: {
    place(mesh: number, vertex: number): number[];
    view(): { yaw: number; pitch: number; half_height: number; centre: number[]; orthographic: boolean };
  };
}

before(async () => {
  bespoke(directory, "samples", ".", "shoe", "--quiet");
  bespoke(directory, "fit", "shoe/source.obj", "shoe/target.obj", "--anchors", "shoe/anchors.json", "-o", "shoe.vdb", "--quiet");
  bespoke(directory, "view", "shoe.vdb", "--source", "shoe/source.obj", "--target", "shoe/target.obj", "--product", "shoe/upper.obj", "--product", "shoe/sole.obj", "-o", file, "--quiet");
  browser = await launch();
  opened = await open_page(browser, file);
});

after(async () => {
  assert.deepEqual(opened.trouble, [], "no errors, no requests");
  await browser.close();
});

const view = () => opened.page.evaluate(() => (window as unknown as Exposed).bespoke.view());

async function set_time(t: number): Promise<void> {
  await opened.page.getByLabel("Time t along the motion").evaluate((slider, value) => {
    (slider as HTMLInputElement).value = String(value);
    slider.dispatchEvent(new Event("input"));
  }, t);
}

test("opens from a file URL, small, and draws the models", async () => {
  assert.equal(await opened.page.evaluate(() => document.documentElement.dataset.ready), "yes");
  assert.ok(statSync(file).size < 15e6, `${statSync(file).size} bytes`);
  const { drawn } = await drawn_pixels(opened.page);
  assert.ok(drawn > 320 * 200 * 0.05, `${drawn} of 64,000 pixels are drawn`);
});

test("all products carry colours in one range, or one of them alone; each says its value", async () => {
  const { page } = opened;
  const model = page.getByLabel("Model that is coloured"), both = "2,3";
  assert.equal(await model.inputValue(), both);
  const box = (await page.locator("canvas.drawing").boundingBox())!;
  const said = async (x: number, y: number): Promise<string> => {
    await page.mouse.move(box.x + x * box.width, box.y + y * box.height);
    await until(async () => page.locator(".readout").isVisible());
    await page.evaluate(() => new Promise(requestAnimationFrame));
    return page.locator(".readout").innerText();
  };
  const toe = [0.17, 0.655] as const, heel = [0.33, 0.624] as const; // of the canvas, in the left picture
  assert.match(await said(...toe), /upper\.obj.*\n.*\nchange of clearance/);
  assert.match(await said(...heel), /sole\.obj.*\n.*\nchange of clearance/);
  const seen = new Set<string>();
  for (const value of ["2", "3", both]) {
    await model.selectOption(value);
    seen.add((await drawn_pixels(page)).mean.map((channel) => channel.toFixed(1)).join());
  }
  assert.equal(seen.size, 3);
  await model.selectOption("3");
  assert.doesNotMatch(await said(...toe), /clearance/);
  await model.selectOption(both);
});

test("the slider takes every vertex of the product to where apply takes it", async () => {
  for (const t of [0, 0.37, 1]) {
    bespoke(directory, "apply", "shoe.vdb", "shoe/upper.obj", "--t", String(t), "-o", "carried.obj", "--quiet");
    const carried = obj_vertices(join(directory, "carried.obj"));
    await set_time(t);
    const numbers = carried.map((_, i) => i).filter((i) => i % 97 === 0);
    const places = await opened.page.evaluate(
      ([mesh, all]) => (all as number[]).map((i) => (window as unknown as Exposed).bespoke.place(mesh as number, i)),
      [product_mesh, numbers] as const,
    );
    const low = [0, 1, 2].map((axis) => Math.min(...carried.map((x) => x[axis])));
    const high = [0, 1, 2].map((axis) => Math.max(...carried.map((x) => x[axis])));
    const diagonal = Math.hypot(...high.map((value, axis) => value - low[axis]));
    const errors = numbers.map((i, k) => Math.hypot(...places[k].map((value, axis) => value - carried[i][axis])));
    assert.ok(Math.max(...errors) < 1e-4 * diagonal, `t = ${t}: off by ${Math.max(...errors) / diagonal} of the diagonal`);
  }
});

test("another quantity, another range, plain: the colours change", async () => {
  const colours = async (): Promise<string> => (await drawn_pixels(opened.page)).mean.map(Math.round).join(" ");
  const seen = new Set([await colours()]);
  await opened.page.getByLabel("Quantity").selectOption("displacement");
  seen.add(await colours());
  await opened.page.getByLabel("Upper end").fill("1000");
  await opened.page.getByLabel("Upper end").press("Enter");
  seen.add(await colours());
  await opened.page.getByLabel("Quantity").selectOption("");
  seen.add(await colours());
  assert.equal(seen.size, 4);
  await opened.page.getByLabel("Quantity").selectOption("clearance_change");
  assert.match(await opened.page.locator(".legend").innerText(), /change of clearance, cm/);
});

test("keys turn, move, zoom, look from the front, play and reset", async () => {
  const { page } = opened;
  const first = await view();
  await page.locator("canvas.drawing").focus();
  await page.keyboard.press("ArrowLeft");
  assert.notEqual((await view()).yaw, first.yaw);
  await page.keyboard.press("+");
  assert.ok((await view()).half_height < first.half_height);
  await page.keyboard.press("Shift+ArrowUp");
  assert.notDeepEqual((await view()).centre, first.centre);
  await page.keyboard.press("1");
  const front = await view();
  assert.deepEqual([front.yaw, front.pitch, front.orthographic], [0, 0, true]);
  await page.keyboard.press("Home");
  assert.deepEqual((await view()).centre, first.centre);
  await page.keyboard.press("[");
  assert.equal(await page.locator(".time output").innerText(), "t = 0.95");
  await page.keyboard.press("Space");
  await page.locator(".time output", { hasText: /^t = 1$/ }).waitFor();
});

test("a drag turns, the wheel zooms, a click pins the value that hovering shows", async () => {
  const { page } = opened;
  const box = (await page.locator("canvas.drawing").boundingBox())!;
  const middle = { x: box.x + box.width / 4, y: box.y + box.height / 2 };
  const first = await view();
  await page.mouse.move(middle.x, middle.y);
  await page.mouse.down();
  await page.mouse.move(middle.x + 60, middle.y + 10, { steps: 3 });
  await page.mouse.up();
  assert.notEqual((await view()).yaw, first.yaw);
  await page.mouse.wheel(0, -300);
  await until(async () => (await view()).half_height < first.half_height);
  await page.mouse.move(middle.x + 2, middle.y + 2);
  await page.locator(".readout").waitFor({ state: "visible" });
  assert.match(await page.locator(".readout").innerText(), /vertex \d+/);
  await page.mouse.click(middle.x + 2, middle.y + 2);
  assert.equal(await page.locator(".pin").count(), 1);
});

test("layouts, slices, boxes and the cut change the picture; tables are filled", async () => {
  const { page } = opened;
  const count = async (): Promise<number> => (await drawn_pixels(page)).drawn;
  await page.getByRole("button", { name: "Overlaid" }).click();
  const overlaid = await count();
  assert.ok(overlaid > 0);
  await page.getByLabel("Cut the models at a plane").check();
  const cut = await count();
  assert.ok(cut < overlaid, `${cut} of ${overlaid} pixels are left`);
  await page.getByRole("tab", { name: "Slices" }).click();
  await page.getByLabel("Grid, straight before").check();
  const sliced = await count();
  assert.ok(sliced > cut);
  await page.getByRole("tab", { name: "Anchors" }).click();
  const before = (await view()).half_height;
  await page.locator("tbody tr").first().click();
  await until(async () => (await view()).half_height < before);
  await page.getByRole("tab", { name: "Numbers" }).click();
  assert.match(await page.getByRole("tabpanel").innerText(), /hausdorff/);
  await page.getByRole("tab", { name: "About" }).click();
  assert.match(await page.getByRole("tabpanel").innerText(), /bespoke view shoe\.vdb --source/);
});

test("fits a narrow screen, by touch, in the dark", async () => {
  const narrow = await open_page(browser, file, { viewport: { width: 390, height: 800 }, hasTouch: true, colorScheme: "dark", reducedMotion: "reduce" });
  const { drawn } = await drawn_pixels(narrow.page);
  assert.ok(drawn > 1000);
  const overflow = await narrow.page.evaluate(() => document.documentElement.scrollWidth - window.innerWidth);
  assert.ok(overflow <= 0, `${overflow} pixels stand out to the right`);
  assert.deepEqual(narrow.trouble, []);
  await narrow.page.context().close();
});
