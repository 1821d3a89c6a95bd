import { changed, file_names, file_texts, left_out } from "../anchor_files/anchor_files";
import { anchor_formats, type AnchorFormat } from "../anchor_files/format";
import { choice, element, row } from "../controls/elements";
import type { ModelsOfFiles } from "./file_models";
import type { Work } from "./history";

const formats: AnchorFormat[] = ["csv", "meshlab", "markups", "fiducials", "landmarks", "wrap", "indices"];

/** Saves the work for other programs, and says before what their formats have no place for. */
export class ExportPanel {
  readonly body = element("div", { role: "group", "aria-label": "Save for another program" });
  private format: AnchorFormat = "csv";
  private readonly note = element("p", { role: "status", "aria-label": "What the format keeps" });
  private readonly button = element("button", { type: "button", onclick: () => this.save() });
  private readonly system: HTMLElement;

  constructor(private readonly work: () => Work, private readonly unit: string, private readonly models: ModelsOfFiles, private readonly save_file: (name: string, text: string) => void) {
    const options = formats.map((value) => ({ value, label: `${anchor_formats[value].label} (${anchor_formats[value].ending})` }));
    const select = choice(options, this.format, (value) => { this.format = value as AnchorFormat; this.show(); }, "Format of another program");
    this.system = models.system_row(() => undefined);
    this.body.append(row("Or save as", select), this.system, this.note, element("p", {}, this.button));
    this.show();
  }

  show(): void {
    const record = anchor_formats[this.format];
    const lost = left_out(this.work(), this.unit, this.format);
    const refusal = record.of_model ? this.models.thinned : "";
    const notes = [lost.length === 0 ? "" : `Left out, since the format cannot store it: ${lost.join(", ")}.`, changed(this.work(), this.format)];
    const text = refusal === "" ? notes.filter((each) => each !== "").join(" ") : `${refusal[0].toUpperCase()}${refusal.slice(1)}.`;
    if (this.note.textContent !== text) this.note.textContent = text;
    this.note.className = lost.length > 0 || refusal !== "" ? "warn" : "soft";
    this.note.hidden = text === "";
    this.system.hidden = !record.of_patient;
    this.button.textContent = `Save ${file_names(this.format).join(" and ")}`;
    this.button.disabled = refusal !== "";
  }

  private save(): void {
    const texts = file_texts(this.work(), this.format, this.models);
    file_names(this.format).forEach((name, i) => this.save_file(name, texts[i]));
  }
}
