// The start of the first run, and bounds and marks of branches.

import { add, numberIn } from "./controls.js";

/** A field whose number is taken when it is left; `formulas` are taken as texts. */
const fieldIn = (line, label, value, take, formulas = false) => {
  const field = add(line, "input", undefined, { type: "text", inputMode: "decimal", value: value ?? "", autocomplete: "off" });
  field.setAttribute("aria-label", label);
  field.addEventListener("change", () => {
    const number = numberIn(field);
    const wrong = typeof number === "string" && !formulas;
    field.setAttribute("aria-invalid", String(wrong));
    if (!wrong) take(number);
  });
  return field;
};

export class Request {
  #shown = "";

  constructor(element, state) {
    [this.element, this.state] = [element, state];
  }

  /** Shows the request for a description of the scene and the columns of the last result. */
  show(description, columns) {
    const { state, settle, bounds, marks } = this.state().setup;
    const shown = JSON.stringify([description.states, columns, state, settle, bounds, marks]);
    if (shown === this.#shown) return;
    this.#shown = shown;
    this.element.replaceChildren();
    this.#start(description.states, state, settle);
    const names = [...new Set([...description.parameters.map(it => it.name), ...columns])];
    this.#bounds(names, bounds);
    this.#marks(names, marks);
  }

  #part(title) {
    const part = add(this.element, "fieldset");
    add(part, "legend", title);
    return part;
  }

  #start(states, given, settle) {
    const part = this.#part("Start of the first run");
    states.slice(0, 12).forEach(name => {
      const line = add(part, "div", undefined, { className: "line" });
      const label = add(line, "label", name, { htmlFor: `start-${name}` });
      const value = given.find(([key]) => key === name)?.[1];
      const take = number => {
        const others = this.state().setup.state.filter(([key]) => key !== name);
        this.state().edit({ state: number === null ? others : [...others, [name, number]] });
      };
      fieldIn(line, `start, ${name}`, value, take).id = label.htmlFor;
    });
    const line = add(part, "div", undefined, { className: "line" });
    const label = add(line, "label", "settle for", { htmlFor: "settle" });
    fieldIn(line, "time of simulation before the first run", settle, number => this.state().edit({ settle: number })).id = label.htmlFor;
  }

  #name(line, label, names, chosen, take) {
    const select = add(line, "select");
    select.setAttribute("aria-label", label);
    [...new Set([chosen, ...names])].forEach(name => add(select, "option", name, { value: name }));
    select.value = chosen;
    select.addEventListener("change", () => take(select.value));
  }

  #list(part, key, values, line, fresh) {
    const replace = (k, value) => {
      const all = this.state().setup[key];
      this.state().edit({ [key]: all.flatMap((it, i) => (i !== k ? [it] : value === null ? [] : [value])) });
    };
    values.forEach((value, k) => {
      const element = add(part, "div", undefined, { className: "line" });
      line(element, value, changed => replace(k, changed));
      add(element, "button", "remove", { type: "button" }).addEventListener("click", () => replace(k, null));
    });
    add(part, "button", "add", { type: "button" }).addEventListener("click", () => this.state().edit({ [key]: [...this.state().setup[key], fresh] }));
  }

  #bounds(names, bounds) {
    this.#list(this.#part("Branches end where a value leaves its bounds"), "bounds", bounds, (line, bound, replace) => {
      this.#name(line, "bounded column", names, bound.name, name => replace({ ...bound, name }));
      fieldIn(line, "lower bound", bound.low, number => replace({ ...bound, low: number }), true);
      add(line, "span", "to");
      fieldIn(line, "upper bound", bound.high, number => replace({ ...bound, high: number }), true);
    }, { name: names.at(-1), low: null, high: null });
  }

  #marks(names, marks) {
    this.#list(this.#part("Marks at values"), "marks", marks, (line, [name, value], replace) => {
      this.#name(line, "marked column", names, name, chosen => replace([chosen, value]));
      fieldIn(line, "marked value", value, number => replace([name, number ?? 0]));
    }, [names[0], 0]);
  }
}
