type Child = Node | string | null;
type Properties = Record<string, unknown>;

/** An element with properties (on… are listeners, aria-… and data-… attributes) and children. */
export function element<K extends keyof HTMLElementTagNameMap>(
  tag: K, properties: Properties = {}, ...children: Child[]
): HTMLElementTagNameMap[K] {
  const made = document.createElement(tag);
  for (const [name, value] of Object.entries(properties)) {
    if (name.startsWith("on")) made.addEventListener(name.slice(2), value as EventListener);
    else if (name.includes("-") || name === "role" || name === "for" || name === "class") made.setAttribute(name, String(value));
    else (made as unknown as Properties)[name] = value;
  }
  made.append(...children.filter((child) => child !== null));
  return made;
}

/** A control with its name before it. */
export function row(label: string, control: HTMLElement, ...more: Child[]): HTMLLabelElement {
  return element("label", { class: "row" }, element("span", {}, label), control, ...more);
}

export function choice(
  options: { value: string; label: string }[], value: string, changed: (value: string) => void, name = "",
): HTMLSelectElement {
  const select = element("select", { onchange: () => changed(select.value) });
  if (name !== "") select.setAttribute("aria-label", name);
  for (const option of options) select.append(element("option", { value: option.value }, option.label));
  select.value = value;
  return select;
}

export function checkbox(label: string, checked: boolean, changed: (checked: boolean) => void): HTMLLabelElement {
  const box = element("input", { type: "checkbox", checked, onchange: () => changed(box.checked) });
  return element("label", { class: "row" }, box, element("span", {}, label));
}

export function slider(
  label: string, low: number, high: number, step: number, value: number, changed: (value: number) => void,
): HTMLInputElement {
  const input = element("input", { type: "range", "aria-label": label, oninput: () => changed(Number(input.value)) });
  Object.assign(input, { min: String(low), max: String(high), step: String(step), value: String(value) });
  return input;
}

/** Buttons of which one is pressed. */
export function button_group(
  name: string, options: { value: string; label: string }[], value: string, changed: (value: string) => void,
): HTMLDivElement {
  const group = element("div", { class: "group", role: "group", "aria-label": name });
  const press = (chosen: string): void => {
    for (const button of group.children) button.setAttribute("aria-pressed", String((button as HTMLElement).dataset.value === chosen));
  };
  for (const option of options)
    group.append(
      element("button", { type: "button", "data-value": option.value, onclick: () => { press(option.value); changed(option.value); } }, option.label),
    );
  press(value);
  return group;
}

/** Panels of which one is shown, chosen by tabs. */
export function tabs(panels: { title: string; body: HTMLElement }[], shown: (title: string) => void = () => undefined): HTMLElement[] {
  const list = element("div", { role: "tablist", "aria-label": "Panels" });
  const show = (index: number, focus: boolean): void => {
    shown(panels[index].title);
    panels.forEach((panel, i) => {
      const tab = list.children[i] as HTMLElement;
      tab.setAttribute("aria-selected", String(i === index));
      tab.tabIndex = i === index ? 0 : -1;
      panel.body.hidden = i !== index;
      if (i === index && focus) tab.focus();
    });
  };
  panels.forEach((panel, i) => {
    panel.body.setAttribute("role", "tabpanel");
    panel.body.id = `panel-${i}`;
    panel.body.setAttribute("aria-label", panel.title);
    list.append(element("button", { type: "button", role: "tab", "aria-controls": panel.body.id, onclick: () => show(i, false) }, panel.title));
  });
  list.addEventListener("keydown", (event) => {
    const by = event.key === "ArrowRight" ? 1 : event.key === "ArrowLeft" ? -1 : 0;
    if (by === 0) return;
    const now = [...list.children].indexOf(document.activeElement as Element);
    show((now + by + panels.length) % panels.length, true);
  });
  show(0, false);
  return [list, ...panels.map((panel) => panel.body)];
}

/** Switches between the light and the dark colours; the system's are the first. */
export function theme_button(changed: () => void): HTMLButtonElement {
  const is_dark = (): boolean => {
    const chosen = document.documentElement.dataset.theme;
    return chosen === undefined ? window.matchMedia("(prefers-color-scheme: dark)").matches : chosen === "dark";
  };
  const flip = (): void => {
    document.documentElement.dataset.theme = is_dark() ? "light" : "dark";
    changed();
  };
  window.matchMedia("(prefers-color-scheme: dark)").addEventListener("change", changed);
  return element("button", { type: "button", title: "Light or dark colours", "aria-label": "Light or dark colours", onclick: flip }, "◐");
}

/** A file that the browser puts where it puts downloads. */
export function save_text(name: string, text: string): void {
  const url = URL.createObjectURL(new Blob([text], { type: "text/plain" }));
  element("a", { href: url, download: name }).click();
  setTimeout(() => URL.revokeObjectURL(url), 1000);
}
