import { Vector3 } from "three";

import { command_text } from "../controls/command_text";
import { button_group, checkbox, element, save_text, tabs, theme_button } from "../controls/elements";
import { mirrored, symmetry_plane, type Plane } from "../maths/mirror";
import { shown } from "../maths/numbers";
import { distance } from "../maths/warp";
import type { PickRecord, Triple } from "../scene/scene";
import { Surface } from "../stage/surface";
import { Model } from "../view/models";
import { check_pairs, next_place, type PairChecks } from "./checks";
import { curve_name } from "./curve_checks";
import { CurveEditor } from "./curve_editor";
import { CurvePanel, kept_patches } from "./curve_panel";
import { is_patch, type Side, sides } from "./curves";
import { ExportPanel } from "./export_panel";
import { ModelsOfFiles } from "./file_models";
import { anchors_json, parse_json, parse_kept } from "./formats";
import { History, type PickedPair, type Work } from "./history";
import { ImportPanel } from "./import_panel";
import { type DragMode, ModelSide, type SideListener, type SideMarker } from "./model_side";
import { Tracer } from "./tracer";

const colours = ["#1d6fd1", "#c2410c", "#0f766e", "#7e22ce", "#a16207", "#be185d", "#4d7c0f", "#334155"];
const mirror_names: [RegExp, string][] = [[/left/i, "right"], [/right/i, "left"], [/_l$/i, "_r"], [/_r$/i, "_l"], [/\bl\b/i, "r"], [/\br\b/i, "l"]];
const curves_title = "Curves and patches";

/** The page for picking anchors. */
export function pick_page(root: HTMLElement, record: PickRecord, bytes: Uint8Array): void {
  new PickPage(root, record, bytes);
}

class PickPage {
  private readonly history: History;
  private readonly sides: Record<Side, ModelSide>;
  private readonly list = element("tbody", {});
  private readonly warnings = element("ul", { class: "plain", role: "status", "aria-label": "Warnings" });
  private readonly undo_button = element("button", { type: "button", onclick: () => this.history.undo() }, "Undo");
  private readonly redo_button = element("button", { type: "button", onclick: () => this.history.redo() }, "Redo");
  private readonly command = element("pre", {});
  private readonly message = element("p", { class: "soft", role: "status" });
  private readonly curve_message = element("p", { class: "warn", role: "status" });
  private readonly file_message = element("p", { role: "status", "aria-label": "What was read" });
  private readonly editor: CurveEditor;
  private readonly curve_panel: CurvePanel;
  private readonly export_panel: ExportPanel;
  private readonly import_panel: ImportPanel;
  /** What a click on a model sets. */
  private mode: "pairs" | "curves" = "pairs";
  private has_planes = false;
  private readonly plane_box = checkbox("Show the planes of symmetry that mirroring uses", false, (on) => this.show_planes(on));
  private planes: Record<Side, Plane> | null = null;
  private chosen = -1;
  private linked = true;
  private has_preview = false;
  private has_hint = false;
  private drag_mode: DragMode = "surface";
  private drag_group = element("div", {});
  private active: Side = "a";
  private checks: PairChecks;

  constructor(root: HTMLElement, private readonly record: PickRecord, bytes: Uint8Array) {
    const given = record.anchors === null ? { pairs: [], curves: [], patches: [] } : parse_json(record.anchors);
    this.history = new History(`bespoke-pick-${record.key}`, given, parse_kept, () => this.refresh());
    const models = record.meshes.map((mesh) => new Model(mesh, bytes));
    const tracers = models.map((model) => new Tracer(model.knots[0], model.faces));
    this.editor = new CurveEditor(this.history, { a: tracers[0], b: tracers[1] }, (text) => (this.curve_message.textContent = text));
    this.sides = { a: this.side("a", models[0]), b: this.side("b", models[1]) };
    const stages = { refresh: () => this.refresh(), draw: () => this.draw() };
    const mirror = element("button", { type: "button", onclick: () => this.mirror_curve() }, "Mirror chosen");
    this.curve_panel = new CurvePanel(this.history, this.editor, stages, this.curve_message, mirror);
    const stage = element("main", { class: "stage pick" }, this.sides.a.box, this.sides.b.box);
    const files = new ModelsOfFiles(bytes, record.unit, { a: models[0], b: models[1] }, this.editor.tracers);
    this.export_panel = new ExportPanel(() => this.history.work, record.unit, files, save_text);
    this.import_panel = new ImportPanel(files, this.file_message, {
      read: (work, names) => this.take(work, names),
      refused: (reason) => this.say_of_files(`Nothing was imported: ${reason}.`, "warn"),
      asked: (question) => this.say_of_files(question, ""),
    });
    this.checks = check_pairs(this.history.pairs);
    root.classList.add("pick");
    root.append(this.head(), stage, this.panel());
    document.addEventListener("keydown", (event) => this.history.shortcut(event));
    this.refresh();
    Object.assign(window, {
      bespoke: {
        pairs: () => structuredClone(this.history.pairs),
        curves: () => structuredClone(this.history.curves),
        inside: (side: Side) => this.editor.fills(side).map((fill) => fill.faces.length),
        pixel: (side: Side, point: Triple) => this.pixel(side, point),
        draw: () => [this.sides.a, this.sides.b].forEach((each) => each.stage.draw()),
      },
    });
  }

  private side(name: Side, model: Model): ModelSide {
    const draws_curves = (): boolean => this.mode === "curves";
    const listener: SideListener = {
      clicked: (point, reach) => {
        if (draws_curves()) this.editor.clicked(name, point, reach);
        else this.set_point(name, point);
      },
      chosen: (number) => {
        if (draws_curves()) this.editor.point_clicked(name, number);
        else this.chosen = number;
        this.refresh();
      },
      drag_started: (number) => {
        if (draws_curves()) return this.editor.drag_started(name, number);
        this.chosen = number;
        this.history.change(() => undefined);
      },
      dragged: (number, point) => {
        if (draws_curves()) this.editor.dragged(name, number, point);
        else this.history.change_again(({ pairs }) => (pairs[number][name] = point));
      },
      drag_ended: () => {
        this.editor.drag_ended();
        this.refresh();
      },
      turned: () => this.follow(name),
      key: (event) => {
        if (event.key !== "Delete" && event.key !== "Backspace") return;
        if (draws_curves()) this.editor.remove_point(name);
        else this.remove(this.chosen);
      },
    };
    const side = new ModelSide(model, `${name === "a" ? "Source" : "Target"}: ${model.record.name}`, listener);
    side.box.addEventListener("pointerenter", () => (this.active = name));
    side.box.addEventListener("focusin", () => (this.active = name));
    return side;
  }

  private head(): HTMLElement {
    const plain = (label: string, action: () => void): HTMLElement => element("button", { type: "button", onclick: action }, label);
    const views = element("div", { class: "group", role: "group", "aria-label": "Views" },
      ...(["front", "side", "top"] as const).map((side) => plain(side[0].toUpperCase() + side.slice(1), () => this.both((each) => each.stage.look_from(side)))),
      plain("Reset", () => this.both((each) => each.stage.reset())));
    this.drag_group = button_group("Dragging a point moves it", [{ value: "surface", label: "On surface" }, { value: "normal", label: "Along normal" }, { value: "view", label: "In view plane" }], "surface",
      (mode) => { this.drag_mode = mode as DragMode; this.set_drag_mode(); });
    return element("header", {}, element("h1", {}, this.record.title), element("span", { class: "space" }), element("div", { class: "group" }, this.undo_button, this.redo_button), this.drag_group, views, theme_button(() => this.both((each) => each.stage.draw_soon())));
  }

  private panel(): HTMLElement {
    const button = (label: string, action: () => void, name = ""): HTMLElement => element("button", { type: "button", class: name, onclick: action }, label);
    const heads = ["", "name", "σ", "left out", ""].map((head) => element("th", { scope: "col" }, head));
    const pairs = element("section", {},
      element("p", { class: "soft" }, "Click a point on the source, then its counterpart on the target. Drag points to move them."),
      this.warnings,
      element("table", {}, element("thead", {}, element("tr", {}, ...heads)), this.list),
      element("p", { class: "actions" }, button("Mirror chosen", () => this.mirror(false)), button("Mirror all", () => this.mirror(true)), button("Delete all", () => this.history.change(({ pairs: all }) => all.splice(0)))),
      this.message,
      this.plane_box,
      checkbox("Cameras linked", true, (on) => (this.linked = on)),
      checkbox("Preview: the source, warped by the pairs, over the target", false, (on) => { this.has_preview = on; this.refresh(); }),
      checkbox("Show where the next pair would help most", false, (on) => { this.has_hint = on; this.refresh(); }));
    const saving = element("section", {},
      element("h2", {}, "Save"),
      element("p", {}, button("Save anchors.json", () => save_text("anchors.json", anchors_json(this.history.work, this.record.unit)), "main")),
      this.export_panel.body,
      element("h2", {}, "Then fit"), this.command,
      element("h2", {}, "Import"),
      element("p", { class: "soft" }, "JSON and CSV, and files of MeshLab, 3D Slicer, Landmark Editor and Wrap: two, where each model has its own."),
      this.import_panel.body,
      element("p", { class: "soft" }, "Work is kept in this browser until it is deleted."));
    return element("aside", { class: "panel" }, ...tabs([{ title: "Pairs", body: pairs }, { title: curves_title, body: this.curve_panel.body }, { title: "Save and import", body: saving }], (title) => this.set_mode(title)));
  }

  // ---- pairs

  private set_point(side: Side, point: Triple): void {
    const pairs = this.history.pairs;
    // The chosen pair if it lacks this end, else any that does, else a new one.
    const lacking = (i: number): boolean => pairs[i] !== undefined && pairs[i][side] === null;
    const index = lacking(this.chosen) ? this.chosen : pairs.findIndex((_, i) => lacking(i));
    this.chosen = index >= 0 ? index : pairs.length;
    this.history.change(({ pairs: all }) => {
      if (index >= 0) all[index][side] = point;
      else all.push({ name: this.free_name(), a: side === "a" ? point : null, b: side === "b" ? point : null, sigma: null, weight: null });
    });
  }

  private free_name(): string {
    const taken = new Set(this.history.pairs.map((pair) => pair.name));
    let number = 1;
    while (taken.has(`p${number}`)) ++number;
    return `p${number}`;
  }

  private remove(index: number): void {
    if (this.history.pairs[index] === undefined) return;
    this.chosen = -1;
    this.history.change(({ pairs }) => pairs.splice(index, 1));
  }

  private choose(index: number): void {
    this.chosen = index;
    this.refresh();
  }

  private set_mode(title: string): void {
    if (title === "Pairs") this.mode = "pairs";
    if (title === curves_title) this.mode = "curves";
    if (this.sides === undefined) return;
    this.set_drag_mode();
    this.draw();
  }

  /** Points of curves stay on the surface; those of pairs may leave it. */
  private set_drag_mode(): void {
    const draws_curves = this.mode === "curves";
    this.both((each) => (each.drag_mode = draws_curves ? "surface" : this.drag_mode));
    for (const button of this.drag_group.querySelectorAll("button")) button.disabled = draws_curves;
  }

  // ---- the other side

  private mirror(all: boolean): void {
    const planes = this.found_planes();
    const added: PickedPair[] = [];
    const pairs = this.history.pairs;
    const reach = 0.02; // of the size: what lies nearer to the plane has no other side
    for (const [i, pair] of pairs.entries()) {
      if (pair.a === null || pair.b === null || (!all && i !== this.chosen)) continue;
      const a = this.editor.tracers.a.nearest(mirrored(pair.a, planes.a));
      const b = this.editor.tracers.b.nearest(mirrored(pair.b, planes.b));
      const is_there = [...pairs, ...added].some((other) => other.a !== null && distance(other.a, a) < reach * this.sides.a.size);
      if (!is_there) added.push({ ...pair, name: this.mirror_name(pair.name, [...pairs, ...added]), a, b });
    }
    this.message.textContent = !all && this.chosen < 0 ? "No pair is chosen." : `${added.length} mirrored. ${this.symmetry(planes)}`;
    if (added.length > 0) this.history.change(({ pairs: every }) => every.push(...added));
  }

  private mirror_curve(): void {
    const planes = this.found_planes();
    const images = { a: (point: Triple) => mirrored(point, planes.a), b: (point: Triple) => mirrored(point, planes.b) };
    const done = this.editor.mirror(images, (name) => this.mirror_name(name, this.history.curves));
    this.curve_message.textContent = done ? this.symmetry(planes) : "Choose a curve or a patch that is complete.";
  }

  /** Found once; from then on they are shown until the user hides them. */
  private found_planes(): Record<Side, Plane> {
    if (this.planes === null) this.planes = { a: this.plane("a"), b: this.plane("b") };
    if (!this.has_planes) (this.plane_box.firstChild as HTMLInputElement).click();
    return this.planes;
  }

  private show_planes(on: boolean): void {
    this.has_planes = on;
    const planes = on ? (this.planes ??= { a: this.plane("a"), b: this.plane("b") }) : null;
    for (const side of sides) this.sides[side].show_plane(planes === null ? null : planes[side]);
  }

  private symmetry(planes: Record<Side, Plane>): string {
    const quality = (plane: Plane): string => `${shown(100 * plane.misfit)} %`;
    return `Symmetric to ${quality(planes.a)} of the size (source) and ${quality(planes.b)} (target): check what was mirrored.`;
  }

  private plane(side: Side): Plane {
    const places = this.sides[side].surface.places();
    const points: Triple[] = [];
    for (let i = 0; i < places.length; i += 3) points.push([places[i], places[i + 1], places[i + 2]]);
    return symmetry_plane(points);
  }

  private mirror_name(name: string, taken: { name: string }[]): string {
    const rule = mirror_names.find(([pattern]) => pattern.test(name));
    const wanted = rule === undefined ? `${name}_mirrored` : name.replace(rule[0], rule[1]);
    let unique = wanted;
    for (let k = 2; taken.some((other) => other.name === unique); ++k) unique = `${wanted}_${k}`;
    return unique;
  }

  // ---- what is shown

  private refresh(): void {
    if (this.sides === undefined) return;
    const pairs = this.history.pairs;
    this.checks = check_pairs(pairs);
    this.editor.settle();
    this.curve_panel.show(this.checks.complete);
    this.export_panel.show();
    this.draw();
    this.undo_button.disabled = !this.history.can_undo;
    this.redo_button.disabled = !this.history.can_redo;
    this.list.replaceChildren(...pairs.map((pair, i) => this.pair_row(pair, i)));
    this.warnings.replaceChildren(...this.checks.warnings.map((text) => element("li", { class: "warn" }, text)));
    this.command.textContent = command_text(["bespoke", "fit", this.record.source_path, this.record.target_path, "--anchors", "anchors.json", "-o", "map.vdb"]);
    this.sides.a.show_hint(this.has_hint ? next_place(this.sides.a.surface.places(), pairs.flatMap((pair) => (pair.a === null ? [] : [pair.a]))) : null);
    this.show_preview();
  }

  private draw(): void {
    const draws_curves = this.mode === "curves";
    const curve = this.editor.curve;
    const task = !draws_curves ? "" : curve === null ? "a click begins a curve" : `a click adds to ${curve_name(curve, this.editor.chosen)}`;
    for (const side of sides) {
      const pairs = this.history.pairs.flatMap((pair, i): SideMarker[] =>
        pair[side] === null ? [] : [{ number: draws_curves ? null : i, point: pair[side], colour: colours[i % colours.length], size: draws_curves ? "small" : i === this.chosen ? "large" : "plain" }],
      );
      this.sides[side].show([...pairs, ...(draws_curves ? this.editor.markers(side) : [])], this.editor.lines(side), this.editor.fills(side));
      this.sides[side].show_task(task);
    }
  }

  private show_preview(): void {
    const { warp } = this.checks;
    if (!this.has_preview || warp === null) return this.sides.b.show_ghost(null);
    const model = this.sides.a.model;
    const places = new Float32Array(model.knots[0].length);
    for (let i = 0; i < places.length; i += 3) places.set(warp([model.knots[0][i], model.knots[0][i + 1], model.knots[0][i + 2]]), i);
    this.sides.b.show_ghost(new Surface([places], model.faces, "#c9824f"));
  }

  private pair_row(pair: PickedPair, index: number): HTMLElement {
    const complete = this.checks.complete.indexOf(pair as PairChecks["complete"][number]);
    const off = complete >= 0 ? this.checks.left_out[complete] : null;
    const suspicion = complete >= 0 ? this.checks.suspicions[complete] : "";
    const name = element("input", { type: "text", value: pair.name, "aria-label": `Name of pair ${index + 1}`, class: "name" });
    name.addEventListener("change", () => this.history.change(({ pairs }) => (pairs[index].name = name.value.trim())));
    const sigma = element("input", { type: "number", "aria-label": `Sigma of ${pair.name}`, value: pair.sigma === null ? "" : String(pair.sigma), placeholder: "auto", step: "any", min: "0" });
    sigma.addEventListener("change", () => this.history.change(({ pairs }) => (pairs[index].sigma = sigma.value === "" || sigma.valueAsNumber < 0 ? null : sigma.valueAsNumber)));
    const swatch = element("button", { type: "button", class: "swatch", title: "Choose this pair", "aria-label": `Choose ${pair.name}`, onclick: () => this.fly_to(index) });
    swatch.style.background = colours[index % colours.length];
    const state = pair.a === null ? "no source" : pair.b === null ? "no target" : shown(off);
    const line = element("tr", { class: index === this.chosen ? "chosen" : "" },
      element("td", {}, swatch), element("td", {}, name, suspicion === "" ? null : element("div", { class: "warn" }, suspicion)),
      element("td", {}, sigma), element("td", {}, state),
      element("td", {}, element("button", { type: "button", "aria-label": `Delete ${pair.name}`, onclick: () => this.remove(index) }, "×")));
    return line;
  }

  private fly_to(index: number): void {
    this.choose(index);
    const pair = this.history.pairs[index];
    for (const side of ["a", "b"] as const) {
      const point = pair[side];
      if (point !== null) this.sides[side].stage.fly_to(new Vector3(...point), 0.08 * this.sides[side].size);
    }
  }

  private both(action: (side: ModelSide) => void): void {
    action(this.sides.a);
    action(this.sides.b);
  }

  /** The other camera does what the active one did, in proportion. */
  private follow(side: Side): void {
    if (!this.linked || side !== this.active || this.sides === undefined) return;
    const from = this.sides[side], to = this.sides[side === "a" ? "b" : "a"];
    const scale = to.size / from.size;
    const centre = from.stage.view.centre.clone().sub(from.centre).multiplyScalar(scale).add(to.centre);
    const before = JSON.stringify(to.stage.view);
    Object.assign(to.stage.view, from.stage.view, { centre, half_height: from.stage.view.half_height * scale });
    if (JSON.stringify(to.stage.view) !== before) to.stage.draw_soon();
  }

  // ---- files

  /** Lists that a file has no place for stay as they were; so do patches, for which only JSON has one. */
  private take(work: Partial<Work>, files: string): void {
    this.chosen = -1;
    this.editor.choose(-1);
    const patches = work.patches === undefined ? this.history.curves.filter(is_patch) : [];
    const stays = counts_of(work.curves === undefined ? { curves: this.history.curves } : { curves: patches });
    const taken = work.curves === undefined ? work : { ...work, curves: [...work.curves, ...patches] };
    this.history.change((all) => Object.assign(all, taken));
    const texts = [`${counts_of(work)} from ${files}, in the place of what was there; Undo brings it back.`, kept_patches(this.history.work.patches.length), stays === "" ? "" : `As before: ${stays}.`];
    this.say_of_files(texts.filter((text) => text !== "").join(" "), "soft");
  }

  private say_of_files(text: string, kind: "soft" | "warn" | ""): void {
    this.file_message.className = kind;
    this.file_message.textContent = text;
  }

  private pixel(side: Side, point: Triple): number[] {
    const { stage } = this.sides[side];
    const box = stage.canvas.getBoundingClientRect();
    const at = stage.pixel_of(stage.panes[0], new Vector3(...point));
    return [box.left + at.x, box.top + at.y];
  }
}

function counts_of({ pairs, curves }: Partial<Work>): string {
  const borders = (curves ?? []).filter(is_patch).length, lines = (curves ?? []).length - borders;
  const counted = (count: number, one: string, more = `${one}s`): string[] => (count === 0 ? [] : [`${count} ${count === 1 ? one : more}`]);
  const all = [...(pairs === undefined ? [] : [`${pairs.length} pair${pairs.length === 1 ? "" : "s"}`]), ...counted(lines, "curve"), ...counted(borders, "patch", "patches")];
  return all.length < 2 ? all.join("") : `${all.slice(0, -1).join(", ")} and ${all[all.length - 1]}`;
}
