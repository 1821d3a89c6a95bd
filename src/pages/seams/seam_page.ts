import { Vector3 } from "three";

import { command_text } from "../controls/command_text";
import { button_group, element, save_text, tabs, theme_button } from "../controls/elements";
import { border_vertices } from "../maths/edge_paths";
import { shown } from "../maths/numbers";
import { SurfaceGraph } from "../maths/surface_graph";
import { ModelSide, type SideMarker } from "../pick/model_side";
import { UndoLog } from "../pick/undo_log";
import { unpacked_exact_points } from "../scene/decode";
import type { ExactPointsReference, SeamsRecord, Triple } from "../scene/scene";
import { Model } from "../view/models";
import { parse_kept, parse_seams, seams_json } from "./seam_file";
import { copy_of, type NamedVertex, new_seam, type PickedSeam, SeamRoutes, type SeamWork } from "./seam_work";

const colours = ["#be185d", "#0f766e", "#7e22ce", "#c2410c", "#1d6fd1", "#4d7c0f", "#a16207", "#334155"];
const colour_of = (index: number): string => colours[index % colours.length];
const snap_radius = 9, snap_step = 3; // pixels
const separate = "No way along the surface joins these vertices: they lie on separate parts of the garment.";

type Tool = "edges" | "line" | "dart" | "piece" | "width";
const tools: { value: Tool; label: string; help: string }[] = [
  { value: "edges", label: "Along edges", help: "Each click leads the seam on along the edges of the mesh." },
  { value: "line", label: "Straight", help: "Each click leads the seam on by the straightest way, through faces." },
  { value: "dart", label: "Dart", help: "Click at the border or on a seam, then at the tip." },
  { value: "piece", label: "Name a piece", help: "Click into a piece and type its name." },
  { value: "width", label: "Width", help: "Click where the width across the grain is to be in the table of sizes." },
];

const reason = (error: unknown): string => (error instanceof Error ? error.message : String(error));

/** The page for picking where a garment is cut. */
export function seam_page(root: HTMLElement, record: SeamsRecord, bytes: Uint8Array): void {
  new SeamPage(root, record, bytes);
}

class SeamPage {
  private readonly side: ModelSide;
  private readonly routes: SeamRoutes;
  private readonly log: UndoLog<SeamWork>;
  private readonly border: Set<number>;
  private readonly list = element("tbody", {});
  private readonly names = element("tbody", {});
  private readonly message = element("p", { class: "warn", role: "status" });
  private readonly file_message = element("p", { class: "warn", role: "status", "aria-label": "Saving and importing" });
  private readonly help = element("p", { class: "soft" });
  private readonly undo = element("button", { type: "button", onclick: () => this.log.undo() }, "Undo");
  private readonly redo = element("button", { type: "button", onclick: () => this.log.redo() }, "Redo");
  private tool: Tool = "edges";
  /** The seam that clicks lead on, −1 where the next one begins another. */
  private chosen = -1;

  constructor(root: HTMLElement, private readonly record: SeamsRecord, bytes: Uint8Array) {
    const model = new Model(record.meshes[0], bytes);
    const exact = record.meshes[0].exact;
    this.routes = new SeamRoutes(new SurfaceGraph(exact ? unpacked_exact_points(bytes, exact as ExactPointsReference) : model.knots[0], model.faces));
    this.border = border_vertices(this.routes.graph);
    const given = record.seams === null ? { seams: [], pieces: [], widths: [] } : this.parsed(record.seams);
    this.log = new UndoLog(`bespoke-seams-${record.key}`, given, parse_kept, copy_of, () => this.changed());
    this.side = new ModelSide(model, model.record.name, {
      clicked: (point) => this.clicked(this.vertex_at(point)),
      missed: (x, y) => this.clicked_beside(x, y),
      chosen: (number) => this.clicked(this.handles()[number]?.vertex ?? 0),
      drag_started: () => this.log.change(() => undefined),
      dragged: (number, point) => this.drag(number, this.vertex_at(point)),
      drag_ended: () => this.refresh(),
      turned: () => undefined,
      key: (event) => this.key(event),
    });
    root.classList.add("pick");
    root.append(this.head(), element("main", { class: "stage pick single" }, this.side.box), this.panel());
    document.addEventListener("keydown", (event) => this.log.shortcut(event));
    this.choose_tool("edges");
    Object.assign(window, {
      bespoke: {
        work: () => structuredClone(this.log.work),
        saved: () => seams_json(this.log.work, this.routes),
        pixel: (vertex: number) => this.pixel(vertex),
        draw: () => this.side.stage.draw(),
      },
    });
  }

  private parsed(document: unknown): SeamWork {
    const count = this.routes.graph.places.length / 3;
    return parse_seams(document, { count, of_file: (number) => number - 1 }, this.routes.graph);
  }

  private head(): HTMLElement {
    const plain = (label: string, action: () => void): HTMLElement => element("button", { type: "button", onclick: action }, label);
    const views = element("div", { class: "group", role: "group", "aria-label": "Views" },
      ...(["front", "side", "top"] as const).map((side) => plain(side[0].toUpperCase() + side.slice(1), () => this.side.stage.look_from(side))),
      plain("Reset", () => this.side.stage.reset()));
    return element("header", {}, element("h1", {}, this.record.title), element("span", { class: "space" }),
      element("div", { class: "group" }, this.undo, this.redo), views, theme_button(() => this.side.stage.draw_soon()));
  }

  private panel(): HTMLElement {
    const heading = (...heads: string[]): HTMLElement => element("thead", {}, element("tr", {}, ...heads.map((head) => element("th", { scope: "col" }, head))));
    const open = element("input", { type: "file", accept: ".json", "aria-label": "Seam file" });
    open.addEventListener("change", () => void this.read(open));
    const seams = element("section", {},
      button_group("What a click does", tools, "edges", (value) => this.choose_tool(value as Tool)),
      this.help, this.message,
      element("table", { class: "seams" }, heading("", "seam", "length", "ease, mm", "longer", ""), this.list),
      element("p", { class: "actions" }, element("button", { type: "button", onclick: () => this.choose(-1) }, "Begin another seam")),
      element("h2", {}, "Pieces and widths"),
      element("table", {}, heading("", "name", ""), this.names));
    const saving = element("section", {},
      element("p", {}, element("button", { type: "button", class: "main", onclick: () => this.save() }, "Save seams.json")), this.file_message,
      element("h2", {}, "Then flatten"), ...this.flatten_command(),
      element("h2", {}, "Import"), open,
      element("p", { class: "soft" }, "Work is kept in this browser until it is deleted."));
    return element("aside", { class: "panel" }, ...tabs([{ title: "Seams", body: seams }, { title: "Save and import", body: saving }]));
  }

  private flatten_command(): HTMLElement[] {
    const { garment_path, unit } = this.record;
    const words = ["bespoke", "flatten", garment_path, ...(unit === "" ? ["--unit", "UNIT"] : []), "--seams", "seams.json", "-o", "pieces.pdf"];
    const command = element("pre", {}, command_text(words));
    return unit === "" ? [command, element("p", { class: "soft" }, "UNIT is the length unit that the file’s numbers are in: mm, cm, m or in.")] : [command];
  }

  private save(): void {
    try {
      save_text("seams.json", seams_json(this.log.work, this.routes));
      this.file_message.textContent = "";
    } catch (error) {
      this.file_message.textContent = `Nothing was saved: ${reason(error)}.`;
    }
  }

  private async read(input: HTMLInputElement): Promise<void> {
    const file = input.files?.[0];
    if (file === undefined) return;
    try {
      const work = this.parsed(JSON.parse(await file.text()));
      this.choose(-1);
      this.log.change((all) => Object.assign(all, work));
      this.say("");
    } catch (error) {
      this.file_message.textContent = `Nothing was imported: ${reason(error)}.`;
    }
  }

  // ---- clicks

  private vertex_at(point: Triple): number {
    const { places } = this.routes.graph;
    let best = 0, least = Infinity;
    for (const vertex of this.routes.graph.faces) {
      const away = (places[3 * vertex] - point[0]) ** 2 + (places[3 * vertex + 1] - point[1]) ** 2 + (places[3 * vertex + 2] - point[2]) ** 2;
      if (away < least) [best, least] = [vertex, away];
    }
    return best;
  }

  /** The border is a line: who clicks at it is as often off the garment as on it. */
  private clicked_beside(x: number, y: number): void {
    const { stage } = this.side, eye = stage.ray_at(x, y)?.ray.origin;
    if (eye === undefined) return;
    let best = -1, least = Infinity;
    for (const vertex of this.border) {
      const place = new Vector3(...this.routes.graph.place(vertex)), at = stage.pixel_of(stage.panes[0], place);
      const away = Math.hypot(at.x - x, at.y - y);
      // Of those about as near, the one in front.
      const rank = Math.ceil(away / snap_step) + place.distanceTo(eye) / (place.distanceTo(eye) + this.side.size);
      if (away < snap_radius && rank < least) [best, least] = [vertex, rank];
    }
    if (best >= 0) this.clicked(best);
  }

  private clicked(vertex: number): void {
    this.say("");
    if (this.tool === "piece" || this.tool === "width") return this.name(this.tool === "piece" ? "pieces" : "widths", vertex);
    const seams = this.log.work.seams, seam = seams[this.chosen], kind = this.tool === "edges" ? "edges" : "line";
    const leads_on = seam !== undefined && seam.fixed_ways === null && seam.kind === kind;
    if (!leads_on) {
      if (this.tool === "dart" && !this.is_open_at(vertex)) return this.say("A dart begins at the border of the garment or on a seam.");
      this.chosen = seams.length;
      return this.log.change((work) => work.seams.push(new_seam(this.free_name(this.tool === "dart" ? "dart" : "seam"), kind, [vertex])));
    }
    if (seam.vertices[seam.vertices.length - 1] === vertex) return;
    const longer = { ...seam, vertices: [...seam.vertices, vertex] };
    if (this.routes.ways(longer) === null) return this.say(separate);
    const index = this.chosen;
    if (this.tool === "dart") this.chosen = -1;
    this.log.change((work) => (work.seams[index] = longer));
  }

  /** At the border, or on a seam. */
  private is_open_at(vertex: number): boolean {
    return this.border.has(vertex) || this.log.work.seams.some((seam) => (this.routes.ways(seam) ?? []).flat().includes(vertex));
  }

  private free_name(stem: string): string {
    const taken = new Set(this.log.work.seams.map((seam) => seam.name));
    let number = 1;
    while (taken.has(`${stem} ${number}`)) ++number;
    return `${stem} ${number}`;
  }

  private name(list: "pieces" | "widths", vertex: number): void {
    const stem = list === "pieces" ? "piece" : "width";
    this.log.change((work) => work[list].push({ name: `${stem} ${work[list].length + 1}`, vertex }));
    const inputs = this.names.querySelectorAll<HTMLInputElement>(`input[data-list="${list}"]`);
    inputs[inputs.length - 1]?.select();
  }

  private drag(number: number, vertex: number): void {
    const index = this.chosen;
    this.log.change_again((work) => {
      const seam = work.seams[index];
      if (seam === undefined || seam.fixed_ways !== null) return;
      const moved = { ...seam, vertices: seam.vertices.map((own, i) => (i === number ? vertex : own)) };
      if (this.routes.ways(moved) !== null) work.seams[index] = moved;
    });
  }

  private key(event: KeyboardEvent): void {
    if (event.key === "Enter" || event.key === "Escape") this.choose(-1);
    if (event.key !== "Delete" && event.key !== "Backspace") return;
    const seam = this.log.work.seams[this.chosen];
    if (seam === undefined || seam.fixed_ways !== null) return;
    const index = this.chosen;
    if (seam.vertices.length <= 1) return this.remove(index);
    this.log.change((work) => (work.seams[index] = { ...seam, vertices: seam.vertices.slice(0, -1) }));
  }

  private remove(index: number): void {
    this.chosen = -1;
    this.log.change((work) => work.seams.splice(index, 1));
  }

  private choose(index: number): void {
    this.chosen = index;
    this.refresh();
  }

  private choose_tool(tool: Tool): void {
    this.tool = tool;
    this.help.textContent = tools.find((each) => each.value === tool)?.help ?? "";
    this.choose(-1);
  }

  private say(text: string): void {
    this.message.textContent = text;
  }

  // ---- what is shown

  /** The vertices of the chosen seam, which can be dragged. */
  private handles(): { vertex: number }[] {
    return (this.log.work.seams[this.chosen]?.vertices ?? []).map((vertex) => ({ vertex }));
  }

  /** What was said of files may no longer be true. */
  private changed(): void {
    this.file_message.textContent = "";
    this.refresh();
  }

  private refresh(): void {
    if (this.side === undefined) return;
    const { seams, pieces, widths } = this.log.work;
    if (seams[this.chosen] === undefined) this.chosen = -1;
    this.undo.disabled = !this.log.can_undo;
    this.redo.disabled = !this.log.can_redo;
    this.list.replaceChildren(...seams.map((seam, i) => this.seam_row(seam, i)));
    this.names.replaceChildren(...pieces.map((piece, i) => this.name_row("pieces", piece, i)), ...widths.map((width, i) => this.name_row("widths", width, i)));
    const lines = seams.flatMap((seam, i) => this.routes.lines(seam).map((points) => ({ points, colour: colour_of(i), width: i === this.chosen ? 4 : 2.5 })));
    const marker = ({ vertex }: { vertex: number }, colour: string, number: number | null, size: SideMarker["size"]): SideMarker => ({ number, point: this.routes.graph.place(vertex), colour, size });
    this.side.show([
      ...this.handles().map((handle, i) => marker(handle, colour_of(this.chosen), i, "plain")),
      ...pieces.map((piece) => marker(piece, "#111827", null, "large")),
      ...widths.map((width) => marker(width, "#c2410c", null, "small")),
    ], lines, []);
    const seam = seams[this.chosen];
    this.side.show_task(this.tool === "piece" || this.tool === "width" ? "" : seam === undefined || seam.fixed_ways !== null ? "a click begins a seam" : `a click leads ${seam.name} on`);
  }

  private seam_row(seam: PickedSeam, index: number): HTMLElement {
    const edit = (change: Partial<PickedSeam>): void => this.log.change((work) => (work.seams[index] = { ...work.seams[index], ...change }));
    const name = element("input", { type: "text", class: "name", value: seam.name, "aria-label": `Name of seam ${index + 1}` });
    name.addEventListener("change", () => edit({ name: name.value.trim() }));
    const ease = element("input", { type: "number", min: "0", step: "any", value: seam.ease === null ? "" : String(seam.ease), "aria-label": `Ease of ${seam.name}` });
    ease.addEventListener("change", () => edit({ ease: ease.value === "" || !(ease.valueAsNumber >= 0) ? null : ease.valueAsNumber }));
    const longer = element("input", { type: "text", class: "name", value: seam.longer, "aria-label": `Longer side of ${seam.name}`, placeholder: "piece" });
    longer.addEventListener("change", () => edit({ longer: longer.value.trim() }));
    const swatch = element("button", { type: "button", class: "swatch", title: "Choose this seam", "aria-label": `Choose ${seam.name}`, onclick: () => this.choose(index) });
    swatch.style.background = colour_of(index);
    return element("tr", { class: index === this.chosen ? "chosen" : "" },
      element("td", {}, swatch), element("td", {}, name),
      element("td", { title: seam.kind === "edges" ? "along edges" : "straight" }, shown(this.routes.length(seam))), element("td", {}, ease), element("td", {}, longer),
      element("td", {}, element("button", { type: "button", "aria-label": `Delete ${seam.name}`, onclick: () => this.remove(index) }, "×")));
  }

  private name_row(list: "pieces" | "widths", named: NamedVertex, index: number): HTMLElement {
    const input = element("input", { type: "text", class: "name", value: named.name, "data-list": list, "aria-label": `Name of ${list === "pieces" ? "piece" : "width"} ${index + 1}` });
    input.addEventListener("change", () => this.log.change((work) => (work[list][index] = { ...named, name: input.value.trim() })));
    return element("tr", {}, element("td", {}, list === "pieces" ? "piece" : "width"), element("td", {}, input),
      element("td", {}, element("button", { type: "button", "aria-label": `Delete ${named.name}`, onclick: () => this.log.change((work) => work[list].splice(index, 1)) }, "×")));
  }

  private pixel(vertex: number): number[] {
    const { stage } = this.side;
    const box = stage.canvas.getBoundingClientRect();
    const at = stage.pixel_of(stage.panes[0], new Vector3(...this.routes.graph.place(vertex)));
    return [box.left + at.x, box.top + at.y];
  }
}
