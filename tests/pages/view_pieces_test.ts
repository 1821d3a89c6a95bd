// A page of `bespoke view` with the flat pieces of a product: what is pointed at in one is shown in the other.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { join } from "node:path";
import { after, before, test } from "node:test";

import type { Browser } from "playwright-core";

import { bespoke, launch, open_page, require_browser, scratch_directory, type Opened } from "./browser";

require_browser();

interface Exposed {
  bespoke: {
    pixel(mesh: number, face: number): [number, number];
    piece_pixel(mesh: number, face: number): [number, number] | null;
    highlighted_pieces(): { piece: string; product_face: number }[];
    highlighted_faces(): { faces: number[]; panes: number };
  };
}

const directory = scratch_directory();
const upper_mesh = 2; // source, target, then the product
let browser: Browser;
let opened: Opened;
let pieces: { name: string; product_faces: number[] }[];

before(async () => {
  bespoke(directory, "samples", ".", "shoe", "--quiet");
  bespoke(directory, "fit", "shoe/source.obj", "shoe/target.obj", "--anchors", "shoe/anchors.json", "-o", "shoe.vdb", "--quiet");
  bespoke(directory, "apply", "shoe.vdb", "shoe/upper.obj", "-o", "upper.obj", "--quiet");
  bespoke(directory, "flatten", "upper.obj", "--unit", "cm", "--seams", "shoe/upper_seams.json", "-o", "upper.json", "--quiet");
  pieces = JSON.parse(readFileSync(join(directory, "upper.json"), "utf8")).pieces;
  bespoke(directory, "view", "shoe.vdb", "--source", "shoe/source.obj", "--target", "shoe/target.obj", "--product", "shoe/upper.obj", "--pattern", "upper.json", "-o", "shoe.html", "--quiet");
  browser = await launch();
  opened = await open_page(browser, join(directory, "shoe.html"));
  await opened.page.getByRole("tab", { name: "Pieces" }).click();
});

after(async () => {
  assert.deepEqual(opened.trouble, [], "no errors, no requests");
  await browser.close();
});

const pieces_of = (face: number): string[] => pieces.filter((piece) => piece.product_faces.includes(face)).map((piece) => piece.name);
const sampled_faces = (): number[] => {
  const count = 1 + Math.max(...pieces.flatMap((piece) => piece.product_faces));
  return Array.from({ length: 24 }, (_, i) => Math.floor(((i + 0.5) / 24) * count));
};

test("a piece is pointed at: its face is shown on the product, before and after", async () => {
  const { page } = opened;
  const canvas = page.locator("canvas.pieces");
  const box = (await canvas.boundingBox())!;
  for (const face of sampled_faces()) {
    const [x, y] = (await page.evaluate(([mesh, number]) => (window as unknown as Exposed).bespoke.piece_pixel(mesh, number), [upper_mesh, face] as const))!;
    await page.mouse.move(box.x + x, box.y + y);
    const { faces, panes } = await page.evaluate(() => (window as unknown as Exposed).bespoke.highlighted_faces());
    assert.deepEqual([faces[0], panes], [face, 2]);
    for (const other of faces) assert.ok(pieces_of(other).some((piece) => pieces_of(face).includes(piece)), `face ${other} beside ${face}`);
    const [highlighted] = await page.evaluate(() => (window as unknown as Exposed).bespoke.highlighted_pieces());
    assert.ok(pieces_of(face).includes(highlighted.piece), `face ${face}: ${highlighted.piece}`);
    assert.match(await page.getByRole("status", { name: "Piece" }).innerText(), new RegExp(`^${highlighted.piece}: strain .* %$`));
  }
  await page.mouse.move(5, 5);
  assert.deepEqual((await page.evaluate(() => (window as unknown as Exposed).bespoke.highlighted_faces())).faces, []);
});

test("the product is pointed at: its face is shown in its piece", async () => {
  const { page } = opened;
  let met = 0;
  for (const face of sampled_faces()) {
    const [x, y] = await page.evaluate(([mesh, number]) => (window as unknown as Exposed).bespoke.pixel(mesh, number), [upper_mesh, face] as const);
    await page.mouse.move(x, y);
    await page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));
    const highlighted = await page.evaluate(() => (window as unknown as Exposed).bespoke.highlighted_pieces());
    for (const { piece, product_face } of highlighted) assert.ok(pieces_of(product_face).includes(piece));
    met += highlighted.some((each) => each.product_face === face) ? 1 : 0; // others lie behind what is seen
  }
  assert.ok(met >= 6, `${met} of 24 faces`);
});
