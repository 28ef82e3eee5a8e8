// The text of equations, and the fields and sliders of parameters and settings.

import { format } from "./figure.js";

/** The steps of a slider. */
const STEPS = 1000;

export const add = (parent, tag, text, properties = {}) => {
  const element = Object.assign(document.createElement(tag), properties);
  if (text !== undefined) element.textContent = text;
  parent.append(element);
  return element;
};

/** The number in a field, or its formula; `null` for an empty field. */
export const numberIn = field => {
  const text = field.value.trim();
  if (text === "") return null;
  return Number.isFinite(Number(text)) ? Number(text) : text;
};

/** The text of a model, with the place of an error marked. */
export class Editor {
  constructor(element, state) {
    [this.area, this.marks] = [element.querySelector("textarea"), element.querySelector("pre")];
    this.area.addEventListener("input", () => {
      this.mark(null);
      state().edit({ text: this.area.value }, "text");
    });
    this.area.addEventListener("scroll", () => this.#scroll());
    this.trouble = document.getElementById("trouble");
  }

  show(text) {
    if (this.area.value !== text) this.area.value = text;
  }

  /** Marks the place of an error, and shows its message. */
  mark(trouble, reset = null) {
    this.marks.replaceChildren();
    this.trouble.hidden = trouble === null;
    this.trouble.replaceChildren();
    if (trouble === null) return;
    if (trouble.line) {
      const lines = this.area.value.split("\n");
      const letters = [...(lines[trouble.line - 1] ?? "")];
      const [from, to] = [trouble.column - 1, trouble.column - 1 + trouble.width];
      this.marks.append(lines.slice(0, trouble.line - 1).map(line => `${line}\n`).join("") + letters.slice(0, from).join(""));
      add(this.marks, "mark", letters.slice(from, to).join("") || " ");
      this.marks.append(`${letters.slice(to).join("")}\n${lines.slice(trouble.line).join("\n")}`);
      this.#scroll();
      const place = add(this.trouble, "button", `line ${trouble.line}, column ${trouble.column}`, { type: "button" });
      place.addEventListener("click", () => {
        const before = lines.slice(0, trouble.line - 1).reduce((sum, line) => sum + line.length + 1, 0);
        const start = before + letters.slice(0, from).join("").length;
        this.area.focus();
        this.area.setSelectionRange(start, start + letters.slice(from, to).join("").length);
      });
    }
    this.trouble.append(trouble.message);
    if (reset) {
      this.trouble.append(" ");
      add(this.trouble, "button", "Discard changed values", { type: "button" }).addEventListener("click", reset);
    }
  }

  #scroll() {
    [this.marks.scrollTop, this.marks.scrollLeft] = [this.area.scrollTop, this.area.scrollLeft];
  }
}

/** The fields of parameters: a number, a slider, and the range of varied ones. */
export class Parameters {
  #rows = new Map();
  #names = "";

  constructor(element, state) {
    [this.element, this.state] = [element, state];
  }

  show(description) {
    const names = JSON.stringify([description.parameters.map(it => it.name), description.is_scene]);
    if (names !== this.#names) {
      this.#names = names;
      this.#rows.clear();
      this.element.replaceChildren();
      description.parameters.forEach(it => this.#rows.set(it.name, this.#row(it, description)));
    }
    description.parameters.forEach(it => this.#update(this.#rows.get(it.name), it, description));
  }

  /** Shows an error at the field of a parameter; returns whether there is such a field. */
  mark(trouble) {
    this.#rows.forEach(row => {
      row.field.removeAttribute("aria-invalid");
      row.wrong.hidden = true;
    });
    const row = trouble && this.#rows.get(trouble.name);
    if (!row) return false;
    row.field.setAttribute("aria-invalid", "true");
    row.wrong.hidden = false;
    row.wrong.textContent = trouble.message;
    return true;
  }

  #row({ name }, description) {
    const element = add(this.element, "div", undefined, { className: "parameter" });
    const id = `parameter-${name}`;
    add(element, "label", name, { htmlFor: id });
    const buttons = add(element, "span");
    const reset = add(buttons, "button", "reset", { type: "button", hidden: true, title: `Reset ${name} to the value in the text` });
    const field = add(element, "input", undefined, { id, className: "value", type: "text", inputMode: "decimal", autocomplete: "off" });
    const slider = add(element, "input", undefined, { type: "range", min: 0, max: STEPS, step: 1 });
    slider.setAttribute("aria-label", `${name}, slider`);
    const row = { element, field, slider, reset, low: 0, high: 1, range: null, vary: null };
    if (!description.is_scene) {
      row.vary = add(buttons, "button", "vary", { type: "button", title: `Continue the solutions in ${name}` });
      row.vary.addEventListener("click", () => this.state().edit({ along: [{ name, low: row.low, high: row.high }], runs: [] }));
    }
    row.wrong = add(element, "p", "", { className: "wrong", hidden: true });
    const valueOf = () => row.low + ((row.high - row.low) * slider.valueAsNumber) / STEPS;
    slider.addEventListener("input", () => {
      const value = String(Number(valueOf().toPrecision(4)));
      field.value = value;
      this.state().setValue(name, value, true);
    });
    slider.addEventListener("change", () => this.state().changed(false));
    field.addEventListener("change", () => {
      const value = field.value.trim();
      this.state().setValue(name, value === "" ? null : value);
    });
    reset.addEventListener("click", () => this.state().setValue(name, null));
    return row;
  }

  #update(row, { name, value, low, high, set_by: setBy }, description) {
    const range = description.along.find(it => it.name === name);
    const outside = value !== null && (value < row.low || value > row.high);
    if (outside || row.low === row.high || !row.seen) [row.low, row.high, row.seen] = [low, high, true];
    if (range && range.low !== undefined && range.high !== undefined && range.low < range.high) [row.low, row.high] = [range.low, range.high];
    const shown = this.state().value(name) ?? (value === null ? "" : String(value));
    if (document.activeElement !== row.field) row.field.value = shown;
    if (document.activeElement !== row.slider && value !== null) {
      row.slider.value = Math.round((STEPS * (value - row.low)) / (row.high - row.low));
    }
    row.slider.setAttribute("aria-valuetext", value === null ? "" : format(value));
    row.reset.hidden = this.state().value(name) === undefined;
    if (row.vary) row.vary.hidden = Boolean(range);
    row.field.disabled = row.slider.disabled = setBy !== null;
    row.element.title = setBy === null ? "" : `Set by the run ${setBy} of the scene`;
    row.element.classList.toggle("varied", Boolean(range));
    this.#showRange(row, name, range);
  }

  /** The ends of the range in which a parameter varies. */
  #showRange(row, name, range) {
    if (!range) {
      row.range?.remove();
      row.range = null;
      return;
    }
    if (!row.range) {
      row.range = add(row.element, "div", undefined, { className: "range" });
      add(row.range, "span", "varied from");
      const ends = ["low", "high"].map((end, k) => {
        if (k) add(row.range, "span", "to");
        const field = add(row.range, "input", undefined, { type: "text", inputMode: "decimal", placeholder: "open" });
        field.setAttribute("aria-label", `${name}, ${k ? "upper" : "lower"} end of its range`);
        return field;
      });
      const changed = () => {
        const [low, high] = ends.map(numberIn);
        this.state().setRange({ name, low, high });
      };
      ends.forEach(field => field.addEventListener("change", changed));
      row.ends = ends;
    }
    [range.low, range.high].forEach((value, k) => {
      if (document.activeElement !== row.ends[k]) row.ends[k].value = value ?? "";
    });
  }
}

/** The fields of settings with their meanings. */
export class Settings {
  constructor(element, state) {
    [this.element, this.state] = [element.querySelector(".rows"), state];
    this.fields = new Map();
  }

  show(settings) {
    const names = settings.map(it => it.name).join();
    if (names !== this.names) {
      this.names = names;
      this.fields.clear();
      this.element.replaceChildren();
      settings.forEach(it => this.#field(it));
    }
    settings.forEach(({ name, value, set_by: setBy }) => {
      const { field } = this.fields.get(name);
      if (document.activeElement !== field) field.value = this.state().value(name) ?? value;
      field.disabled = setBy !== null;
    });
  }

  mark(trouble) {
    this.fields.forEach(({ field, wrong }) => {
      field.removeAttribute("aria-invalid");
      wrong.hidden = true;
    });
    const own = trouble && this.fields.get(trouble.name);
    if (!own) return false;
    own.field.setAttribute("aria-invalid", "true");
    own.wrong.hidden = false;
    own.wrong.textContent = trouble.message;
    return true;
  }

  #field({ name, meaning }) {
    const row = add(this.element, "div", undefined, { className: "setting" });
    const id = `setting-${name}`;
    add(row, "label", name, { htmlFor: id });
    const field = add(row, "input", undefined, { id, type: "text", autocomplete: "off" });
    const help = add(row, "small", meaning, { id: `${id}-meaning` });
    field.setAttribute("aria-describedby", help.id);
    const wrong = add(row, "p", "", { className: "wrong", hidden: true });
    field.addEventListener("change", () => {
      const value = field.value.trim();
      this.state().setValue(name, value === "" ? null : value);
    });
    this.fields.set(name, { field, wrong });
  }
}
