import { pick_page } from "./pick/pick_page";
import { decode_scene } from "./scene/decode";
import { seam_page } from "./seams/seam_page";
import { view_page } from "./view/view_page";

async function start(): Promise<void> {
  const root = document.getElementById("page") as HTMLElement;
  const { record, bytes } = await decode_scene(document.getElementById("scene")?.textContent ?? "");
  document.title = `${record.title} – bespoke`;
  root.replaceChildren();
  if (record.page === "view") view_page(root, record, bytes);
  else if (record.page === "seams") seam_page(root, record, bytes);
  else pick_page(root, record, bytes);
  document.documentElement.dataset.ready = "yes";
}

start().catch((error: unknown) => {
  const message = error instanceof Error ? error.message : String(error);
  const root = document.getElementById("page") as HTMLElement;
  root.textContent = `This page cannot be shown: ${message}. It needs a browser with WebGL 2 and DecompressionStream (2023 or later).`;
  document.documentElement.dataset.ready = "failed";
});
