import { spawnSync } from "node:child_process";
import { existsSync, mkdtempSync, readFileSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { pathToFileURL } from "node:url";

import { type Browser, type BrowserContextOptions, chromium, type Page } from "playwright-core";

const chromium_path = process.env.BESPOKE_CHROMIUM ?? "/usr/bin/chromium";
const skipped = 77; // what CTest takes for "not run"

/** Ends the test as skipped where there is no browser. */
export function require_browser(): void {
  if (existsSync(chromium_path)) return;
  console.log(`skipped: ${chromium_path} is missing; tools/setup installs it on Debian`);
  process.exit(skipped);
}

/** Runs the built command in a directory; its standard output, or an error with what it said. */
export function bespoke(directory: string, ...words: string[]): string {
  const result = spawnSync(process.env.BESPOKE_COMMAND as string, words, { cwd: directory, encoding: "utf8" });
  if (result.status !== 0) throw new Error(`bespoke ${words.join(" ")}: exit code ${result.status}\n${result.stderr}`);
  return result.stdout;
}

/** A directory of its own, removed when the process ends. */
export function scratch_directory(): string {
  const directory = mkdtempSync(join(tmpdir(), "bespoke_pages_"));
  process.on("exit", () => rmSync(directory, { recursive: true, force: true }));
  return directory;
}

/** `v` lines of an OBJ file. */
export function obj_vertices(path: string): number[][] {
  return readFileSync(path, "utf8")
    .split("\n")
    .filter((line) => line.startsWith("v "))
    .map((line) => line.split(/\s+/).slice(1, 4).map(Number));
}

export function launch(): Promise<Browser> {
  // WebGL by software; no connections of the browser's own.
  const flags = ["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--disable-quic", "--disable-background-networking", "--disable-component-update", "--disable-sync", "--no-first-run"];
  return chromium.launch({ executablePath: chromium_path, args: flags });
}

/** A page from the disk, and everything that it should not do. */
export interface Opened {
  page: Page;
  /** Errors of the console, uncaught ones, and requests for anything but the file itself. */
  trouble: string[];
}

export async function open_page(browser: Browser, path: string, options: BrowserContextOptions = {}): Promise<Opened> {
  const context = await browser.newContext({ viewport: { width: 1280, height: 800 }, ...options });
  const page = await context.newPage();
  const trouble: string[] = [];
  const url = pathToFileURL(path).href;
  page.on("console", (message) => {
    // What a driver says about its own speed is no matter of the page.
    if (["error", "warning"].includes(message.type()) && !message.text().includes("GL Driver Message")) trouble.push(message.text());
  });
  page.on("pageerror", (error) => trouble.push(String(error)));
  page.on("request", (request) => {
    if (request.url() !== url && !/^(data|blob):/.test(request.url())) trouble.push(`request for ${request.url()}`);
  });
  await page.goto(url);
  await page.locator("html[data-ready]").waitFor({ timeout: 120_000 });
  return { page, trouble };
}

type Triple = [number, number, number];

/** Two sample feet in a directory, their anchors, and the page of `bespoke pick` for them (pick.html), opened with free cameras. */
export async function open_feet(directory: string): Promise<{ browser: Browser; opened: Opened; given: { name: string; a: Triple; b: Triple }[] }> {
  bespoke(directory, "samples", ".", "shoe", "--quiet");
  bespoke(directory, "pick", "shoe/source.obj", "shoe/target.obj", "-o", "pick.html");
  const browser = await launch();
  const opened = await open_page(browser, join(directory, "pick.html"));
  await opened.page.getByLabel("Cameras linked").uncheck();
  return { browser, opened, given: JSON.parse(readFileSync(join(directory, "shoe/anchors.json"), "utf8")).pairs };
}

/** Waits, at most ten seconds, for what the page does by and by. (Playwright's own waiting is a string of JavaScript, which the page's policy forbids.) */
export async function until(condition: () => Promise<boolean>): Promise<void> {
  for (let waited = 0; waited < 100; ++waited) {
    if (await condition()) return;
    await new Promise((resolve) => setTimeout(resolve, 100));
  }
  throw new Error("it did not happen within ten seconds");
}

/** Colours of the drawing area's pixels that are not its background, counted coarsely. */
export function drawn_pixels(page: Page): Promise<{ drawn: number; mean: number[] }> {
  return page.evaluate(() => {
    (window as unknown as { bespoke: { draw(): void } }).bespoke.draw();
    const drawing = document.querySelector("canvas.drawing") as HTMLCanvasElement;
    const copy = document.createElement("canvas");
    copy.width = 320;
    copy.height = 200;
    const context = copy.getContext("2d") as CanvasRenderingContext2D;
    context.drawImage(drawing, 0, 0, copy.width, copy.height);
    const { data } = context.getImageData(0, 0, copy.width, copy.height);
    let drawn = 0;
    const sum = [0, 0, 0];
    for (let i = 0; i < data.length; i += 4)
      if (data[i + 3] > 128) {
        drawn += 1;
        for (let channel = 0; channel < 3; ++channel) sum[channel] += data[i + channel];
      }
    return { drawn, mean: sum.map((value) => value / Math.max(1, drawn)) };
  });
}
