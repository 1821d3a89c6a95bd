import { Vector3 } from "three";

import { button_group, checkbox, choice, element, row, slider, tabs, theme_button } from "../controls/elements";
import { shown as number_text } from "../maths/numbers";
import type { ViewRecord } from "../scene/scene";
import { add_controls } from "../stage/controls";
import { type Side, Stage } from "../stage/stage";
import { Legend } from "./legend";
import { PiecesPanel } from "./pieces_panel";
import { default_range, type Field, joint_field, type Model } from "./models";
import { anchor_panel, place_panel } from "./lists";
import { object_view } from "./tables";
import { first_state } from "./view_state";
import { type Found, type PaneContent, type Shown, ViewStage } from "./view_stage";

const axis_names = ["x", "y", "z"];
const seconds_of_play = 3;

interface Pin {
  content: PaneContent;
  shown: Shown;
  vertex: number;
  label: HTMLElement;
}

/** The page for judging a map. */
export function view_page(root: HTMLElement, record: ViewRecord, bytes: Uint8Array): void {
  new ViewPage(root, record, bytes);
}

class ViewPage {
  private readonly state = first_state();
  private readonly stage_box = element("main", { class: "stage" });
  private readonly canvas = element("canvas", {
    class: "drawing",
    tabIndex: 0,
    role: "application",
    "aria-label":
      "The models. Drag or arrow keys turn, Shift moves, wheel or plus and minus zoom, Home resets, 1 2 3 front side top, space plays.",
  });
  private readonly readout = element("div", { class: "readout", hidden: true });
  private readonly legend = new Legend();
  private readonly stage: Stage;
  private readonly view: ViewStage;
  private readonly time = slider("Time t along the motion", 0, 1, 0.001, 1, (t) => this.set_time(t));
  private readonly time_text = element("output", {}, "t = 1");
  private readonly play = element("button", { type: "button", class: "main", onclick: () => this.toggle_play() }, "▶ Play");
  private readonly colour_controls = element("div", {});
  /** What the colours show, of all models that carry them. */
  private field: Field | null = null;
  private playing = false;
  private pins: Pin[] = [];
  private readonly pieces: PiecesPanel | null;

  constructor(root: HTMLElement, private readonly record: ViewRecord, bytes: Uint8Array) {
    this.stage_box.append(this.canvas, this.legend.element, this.readout);
    root.append(this.head(), this.stage_box, this.time_bar());
    this.stage = new Stage(this.canvas);
    this.view = new ViewStage(this.stage, record, bytes, this.state);
    const names = record.meshes.map((mesh) => mesh.name);
    this.pieces = record.patterns.length === 0 ? null : new PiecesPanel(record.patterns, bytes, names, (mesh, faces) => this.view.highlight(mesh, faces));
    this.choose_first_field();
    root.append(this.panel());
    this.stage.on_draw(() => this.draw_pins());
    this.wire();
    this.relay_out();
    this.expose();
  }

  private head(): HTMLElement {
    return element(
      "header", {},
      element("h1", {}, this.record.title),
      element("span", { class: "soft" }, `lengths in ${this.record.unit}`),
      element("span", { class: "space" }),
      button_group("Layout", [{ value: "side", label: "Side by side" }, { value: "over", label: "Overlaid" }], "side", (value) => {
        this.state.layout = value as "side" | "over";
        this.relay_out();
      }),
      button_group("Camera", [{ value: "perspective", label: "Perspective" }, { value: "parallel", label: "Parallel" }], "perspective", (value) => {
        this.stage.view.orthographic = value === "parallel";
        this.stage.draw_soon();
      }),
      this.view_buttons(),
      theme_button(() => this.recolour()),
    );
  }

  private view_buttons(): HTMLElement {
    const button = (label: string, action: () => void): HTMLElement => element("button", { type: "button", onclick: action }, label);
    const from = (side: Side): (() => void) => () => this.stage.look_from(side);
    return element(
      "div", { class: "group", role: "group", "aria-label": "Views" },
      button("Front", from("front")), button("Side", from("side")), button("Top", from("top")),
      button("Reset", () => this.stage.reset()),
    );
  }

  private time_bar(): HTMLElement {
    return element("div", { class: "time" }, this.play, this.time, this.time_text);
  }

  private panel(): HTMLElement {
    const body = (...children: HTMLElement[]): HTMLElement => element("section", {}, ...children);
    return element(
      "aside", { class: "panel" },
      ...tabs([
        { title: "Colour", body: body(this.colour_controls, this.shown_controls(), this.clip_controls()) },
        { title: "Slices", body: body(this.slice_controls(), this.level_controls()) },
        { title: "Anchors", body: body(this.anchor_switch(), anchor_panel(this.record, (index) => this.choose_anchor(index))) },
        ...(this.pieces === null ? [] : [{ title: "Pieces", body: this.pieces.body }]),
        { title: "Places", body: body(place_panel(this.record, (place) => this.view.fly_to(place.side === "source" ? new Vector3(...place.at) : null, new Vector3(...place.at)))) },
        { title: "Numbers", body: body(object_view(this.record.quality, this.record.unit, ["unit"])) },
        { title: "About", body: this.about() },
      ]),
    );
  }

  // ---- colours

  private choose_first_field(): void {
    const candidates = ["clearance_change", "target_distance", "displacement"];
    const models = this.view.models;
    const order = [...models.keys()].sort((a, b) => Number(models[b].record.role === "product") - Number(models[a].record.role === "product")).map((index) => [index]);
    if (this.products.length > 1) order.unshift(this.products);
    for (const id of candidates)
      for (const indices of order)
        if (indices.some((index) => models[index].field(id) !== null)) return this.colour_by(indices, id);
  }

  private get products(): number[] {
    return [...this.view.models.keys()].filter((index) => this.view.models[index].record.role === "product");
  }

  private get coloured_models(): Model[] {
    return this.state.coloured.map((index) => this.view.models[index]);
  }

  private colour_by(indices: number[], id: string): void {
    this.state.coloured = indices;
    this.state.field = id;
    this.field = joint_field(this.coloured_models, id);
    if (this.field !== null) this.state.range = default_range(this.field);
    this.recolour();
  }

  private recolour(): void {
    this.legend.show(this.field, ...this.state.range);
    this.view.update();
    this.fill_colour_controls(this.coloured_models[0]);
    for (const pin of this.pins) this.label_pin(pin);
  }

  private fill_colour_controls(model: Model): void {
    const models = this.view.models.map((each, i) => ({ value: String(i), label: each.label }));
    const fields = [{ value: "", label: "plain" }, ...model.record.fields.map((field) => ({ value: field.id, label: field.label }))];
    if (this.products.length > 1) models.push({ value: this.products.join(), label: "all products" });
    const choose_model = (value: string): void => {
      const indices = value.split(",").map(Number), next = this.view.models[indices[0]];
      const id = next.field(this.state.field) !== null ? this.state.field : (next.record.fields[0]?.id ?? "");
      this.colour_by(indices, id);
    };
    const number = (end: 0 | 1, name: string): HTMLElement => {
      const input = element("input", { type: "number", "aria-label": name, step: "any", value: String(Number(this.state.range[end].toPrecision(4))) });
      input.addEventListener("change", () => {
        if (Number.isFinite(input.valueAsNumber)) this.state.range[end] = input.valueAsNumber;
        this.recolour();
      });
      return input;
    };
    this.colour_controls.replaceChildren(
      element("h2", {}, "Colours"),
      row("Model", choice(models, this.state.coloured.join(), choose_model, "Model that is coloured")),
      row("Quantity", choice(fields, this.state.field, (id) => this.colour_by(this.state.coloured, id), "Quantity")),
      element("div", { class: "row" }, element("label", { class: "row" }, element("span", {}, "Range"), number(0, "Lower end"), " to ", number(1, "Upper end"))),
      element(
        "p", {},
        element("button", { type: "button", onclick: () => this.colour_by(this.state.coloured, this.state.field) }, "Reset range"), " ",
        element("button", { type: "button", onclick: () => this.clear_pins() }, "Remove pins"),
      ),
      element("p", { class: "soft" }, "Point at a model to read its value; click to pin it."),
    );
  }

  private shown_controls(): HTMLElement {
    const boxes = this.view.models.map((model, index) =>
      checkbox(model.label, true, (on) => {
        if (on) this.state.hidden.delete(index);
        else this.state.hidden.add(index);
        this.view.update();
      }),
    );
    const opacity = slider("Opacity of the target when overlaid", 0.05, 1, 0.05, this.state.opacity, (value) => {
      this.state.opacity = value;
      this.view.update();
    });
    const rigid = checkbox("With the rigid motion, as apply writes it", true, (on) => {
      this.state.rigid = on;
      this.relay_out();
    });
    const upright = choice([{ value: "y", label: "y" }, { value: "z", label: "z" }], "y", (value) => {
      this.stage.upright = value as "y" | "z";
      this.stage.draw_soon();
    }, "Upright axis");
    return element("div", {}, element("h2", {}, "Shown"), ...boxes, row("Target", opacity), row("Upright", upright), rigid);
  }

  private axis_choice(axis: number, changed: (axis: 0 | 1 | 2) => void, name: string): HTMLSelectElement {
    const options = axis_names.map((label, i) => ({ value: String(i), label }));
    return choice(options, String(axis), (value) => changed(Number(value) as 0 | 1 | 2), name);
  }

  private clip_controls(): HTMLElement {
    const clip = this.state.clip;
    const update = (): void => this.view.update();
    return element(
      "div", {},
      element("h2", {}, "Cut"),
      checkbox("Cut the models at a plane", false, (on) => { clip.on = on; update(); }),
      row("Across", this.axis_choice(0, (axis) => { clip.axis = axis; update(); }, "Axis of the cut")),
      row("Position", slider("Position of the cut", 0, 1, 0.005, 0.5, (at) => { clip.position = at; update(); })),
      checkbox("Keep the other half", false, (on) => { clip.flipped = on; update(); }),
    );
  }

  // ---- slices

  private slice_controls(): HTMLElement {
    const slice = this.state.slice;
    const update = (): void => this.view.update();
    const { size, spacing } = this.record.lattice;
    return element(
      "div", {},
      element("h2", {}, "Space"),
      checkbox("Grid, straight before and bent by the map", false, (on) => { slice.on = on; update(); }),
      checkbox("Coloured by det of the gradient, 0 to 2", false, (on) => { slice.determinant = on; update(); }),
      row("Across", this.axis_choice(2, (axis) => { slice.axis = axis; update(); }, "Axis of the slice")),
      row("Position", slider("Position of the slice", 0, 1, 0.005, 0.5, (at) => { slice.position = at; update(); })),
      row("Lines", slider("Lines of the grid", 8, 64, 1, 24, (lines) => { slice.lines = lines; update(); })),
      element("p", { class: "soft" }, `Drawn from ${size.join(" × ")} samples of the map, ${number_text(spacing, this.record.unit)} apart; finer detail is not in it.`),
    );
  }

  private level_controls(): HTMLElement {
    const boxes = this.record.levels.map((level, index) => {
      const leaves = level.leaves.array.count / 3;
      const step = this.record.motion.knots.length > 2 || this.record.levels.some((each) => each.step > 0) ? `step ${level.step + 1}, ` : "";
      return checkbox(`${step}level ${level.level}: ${leaves} boxes of ${number_text(level.leaf_size, this.record.unit)}`, false, (on) => {
        if (on) this.state.levels.add(index);
        else this.state.levels.delete(index);
        this.view.update();
      });
    });
    return element("div", {}, element("h2", {}, "Where the map is stored finely"), ...boxes, element("p", { class: "soft" }, "Boxes of 8³ nodes of each level, around the source."));
  }

  // ---- lists and text

  private anchor_switch(): HTMLElement {
    return checkbox("Show the anchors on the models", this.state.anchors, (on) => {
      this.state.anchors = on;
      this.view.update();
    });
  }

  private choose_anchor(index: number): void {
    this.state.chosen_anchor = index;
    const anchor = this.record.anchors[index];
    this.view.update();
    this.view.fly_to(new Vector3(...anchor.a), new Vector3(...anchor.b));
  }

  private about(): HTMLElement {
    const decimated = this.record.meshes.filter((mesh) => mesh.original !== null);
    const notes = [
      ...this.record.notes,
      ...decimated.map((mesh) => `${mesh.name}: ${(mesh.faces.count / 3).toLocaleString("en")} of ${mesh.faces_in_file.toLocaleString("en")} triangles are shown; carried vertices and values are those of the file.`),
    ];
    return element(
      "section", {},
      element("h2", {}, "How to reproduce"),
      element("pre", {}, this.record.command),
      element("h2", {}, "About this page"),
      element("ul", { class: "plain" }, ...notes.map((note) => element("li", {}, note))),
      element("h2", {}, "The map"),
      object_view(this.record.info, this.record.unit, ["anchors"]),
    );
  }

  // ---- time

  private set_time(t: number): void {
    this.state.t = t;
    this.time.value = String(t);
    this.time_text.textContent = `t = ${t.toFixed(3).replace(/\.?0+$/, "")}`;
    this.view.update();
  }

  private toggle_play(): void {
    this.playing = !this.playing;
    this.play.textContent = this.playing ? "❚❚ Pause" : "▶ Play";
    if (!this.playing) return;
    if (this.state.t >= 1) this.set_time(0);
    let before = performance.now();
    const step = (now: number): void => {
      if (!this.playing) return;
      const t = Math.min(1, this.state.t + (now - before) / (1000 * seconds_of_play));
      before = now;
      this.set_time(t);
      if (t < 1) requestAnimationFrame(step);
      else this.toggle_play();
    };
    requestAnimationFrame(step);
  }

  // ---- pointing

  private wire(): void {
    let waiting: [number, number] | null = null;
    const hover = (x: number, y: number): void => {
      if (waiting === null) requestAnimationFrame(() => { if (waiting !== null) this.hover(...waiting); waiting = null; });
      waiting = [x, y];
    };
    add_controls(this.stage, { click: (x, y) => this.pin(x, y), hover, leave: () => { this.readout.hidden = true; this.pieces?.show(-1, null); waiting = null; } });
    this.canvas.addEventListener("keydown", (event) => {
      const step = event.key === "[" ? -0.05 : event.key === "]" ? 0.05 : 0;
      if (event.key === " ") this.toggle_play();
      else if (step !== 0) this.set_time(Math.min(1, Math.max(0, Math.round((this.state.t + step) * 1000) / 1000)));
      else return;
      event.preventDefault();
    });
    let was_narrow = window.innerWidth <= 760;
    window.addEventListener("resize", () => {
      const narrow = window.innerWidth <= 760;
      if (narrow !== was_narrow) this.relay_out();
      was_narrow = narrow;
    });
  }

  private value_text(shown: Shown, vertex: number): string {
    const field = this.state.coloured.includes(shown.index) ? shown.model.field(this.state.field) : null;
    return field === null ? "" : `${field.record.label} ${number_text(field.values[vertex], field.record.unit)}`;
  }

  private hover(x: number, y: number): void {
    const found = this.view.find(x, y);
    this.pieces?.show(found?.shown.index ?? -1, found?.hit.face ?? null);
    this.readout.hidden = found === null;
    if (found === null) return;
    const at = found.hit.point.toArray().map((value) => number_text(value)).join(", ");
    const value = this.value_text(found.shown, found.hit.vertex);
    this.readout.textContent = `${found.shown.model.record.name}, vertex ${found.shown.model.number_in_file(found.hit.vertex)}\n${at}${value === "" ? "" : `\n${value}`}`;
    this.readout.style.left = `${Math.min(x + 14, this.canvas.clientWidth - this.readout.offsetWidth - 4)}px`;
    this.readout.style.top = `${Math.max(4, y - this.readout.offsetHeight - 8)}px`;
  }

  private pin(x: number, y: number): void {
    const found: Found | null = this.view.find(x, y);
    if (found === null) return;
    const pin: Pin = { content: found.content, shown: found.shown, vertex: found.hit.vertex, label: element("div", { class: "pin" }) };
    this.label_pin(pin);
    this.stage_box.append(pin.label);
    this.pins.push(pin);
    this.stage.draw_soon();
  }

  private label_pin(pin: Pin): void {
    const text = this.value_text(pin.shown, pin.vertex) || `vertex ${pin.shown.model.number_in_file(pin.vertex)}`;
    pin.label.replaceChildren(element("span", {}, text));
  }

  private draw_pins(): void {
    for (const pin of this.pins) {
      const place = this.stage.pixel_of(pin.content.pane, pin.shown.surface.at(pin.vertex));
      pin.label.style.left = `${place.x}px`;
      pin.label.style.top = `${place.y}px`;
    }
  }

  private clear_pins(): void {
    for (const pin of this.pins) pin.label.remove();
    this.pins = [];
  }

  private relay_out(): void {
    this.clear_pins();
    // On a narrow screen there is no space over the models.
    if (window.innerWidth <= 760) this.stage_box.after(this.legend.element);
    else this.stage_box.append(this.legend.element);
    this.view.lay_out();
    for (const old of this.stage_box.querySelectorAll(".pane-label, .pane-line")) old.remove();
    this.view.contents.forEach((content, i) => {
      const { pane } = content;
      const label = element("div", { class: "pane-label" }, pane.label);
      label.style.left = `calc(${100 * pane.left}% + 8px)`;
      label.style.top = `calc(${100 * pane.top}% + 8px)`;
      this.stage_box.append(label);
      if (i === 0) return;
      const line = element("div", { class: "pane-line" });
      const upright = pane.left > 0;
      Object.assign(line.style, upright ? { left: `${100 * pane.left}%`, top: "0", bottom: "0", width: "1px" } : { top: `${100 * pane.top}%`, left: "0", right: "0", height: "1px" });
      this.stage_box.append(line);
    });
    this.recolour();
  }

  /** For tests and for the console of the browser. */
  private expose(): void {
    Object.assign(window, {
      bespoke: {
        place: (mesh: number, vertex: number) => this.view.carried_place(mesh, vertex).toArray(),
        frames_drawn: () => this.stage.frames_drawn,
        view: () => structuredClone({ ...this.stage.view, centre: this.stage.view.centre.toArray() }),
        draw: () => this.stage.draw(),
        piece_pixel: (mesh: number, face: number) => this.pieces?.pixel_of(mesh, face) ?? null,
        highlighted_pieces: () => this.pieces?.highlights ?? [],
        highlighted_faces: () => this.view.highlights,
        pixel: (mesh: number, face: number) => this.view.pixel_of_face(mesh, face),
      },
    });
  }
}
