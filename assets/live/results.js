// The diagrams, the table of special points, and the details of a point.

import { add, numberIn } from "./controls.js";
import { Plot } from "./figure.js";
import { showKey, showTip } from "./key.js";

/** All diagrams of a result. */
export class Panels {
  #shown = [];

  /** `actions.select(place)` and `actions.axes(x, y)` answer the user; `actions.bars(bars)` are the bars to show. */
  constructor(element, actions) {
    [this.element, this.actions] = [element, actions];
  }

  show(drawing, axes, steady) {
    this.drawing = drawing;
    this.#count(drawing.panels.length);
    if (drawing.panels.length) drawing.panels[0].bars = this.actions.bars(drawing.bars);
    drawing.panels.forEach((panel, k) => {
      const { plot, key } = this.#shown[k];
      plot.show(panel, { colours: drawing.colours, steady });
      showKey(key, panel, drawing.colours);
    });
    this.#showAxes(drawing.columns, axes);
  }

  /** Shows the ranges of simulated histories over the first diagram. */
  bars(bars) {
    if (!this.drawing?.panels.length) return;
    this.drawing.bars = bars;
    this.drawing.panels[0].bars = this.actions.bars(bars);
    this.#shown[0].plot.show(this.drawing.panels[0], { colours: this.drawing.colours, steady: true });
  }

  /** Shows the branches that are being traced over the last ones. */
  partial(panel, colours) {
    if (!this.#shown.length) this.#count(1);
    this.#shown[0].plot.show(panel, { colours: colours ?? this.drawing?.colours ?? ["#0072b2"], partial: true });
  }

  /** The element and the plot of a panel. */
  at(k) { return this.#shown[k]; }

  select(place) {
    this.#shown.forEach(({ plot }) => plot.select(place));
  }

  #count(count) {
    while (this.#shown.length > Math.max(1, count)) this.#shown.pop().element.remove();
    while (this.#shown.length < count) {
      const element = add(this.element, "div", undefined, { className: "panel" });
      const place = add(element, "div", undefined, { className: "plot" });
      const controls = add(element, "div", undefined, { className: "controls" });
      const selects = this.#shown.length ? null : this.#selects(controls);
      const key = add(controls, "span", undefined, { className: "controls" });
      const plot = new Plot(place, { id: `panel-${this.#shown.length}`, select: this.actions.select, tip: showTip });
      this.#shown.push({ element, plot, key, selects });
    }
  }

  #selects(controls) {
    return ["x", "y"].map((axis, k) => {
      const label = add(controls, "label", k ? "vertical" : "horizontal");
      const select = add(label, "select", undefined, { id: `axis-${axis}` });
      select.addEventListener("change", () => this.actions.axes(axis, select.value || null));
      return select;
    });
  }

  #showAxes(columns, axes) {
    const [first] = this.#shown;
    const names = columns.join("\n");
    first?.selects.forEach((select, k) => {
      if (select.dataset.names !== names) {
        select.dataset.names = names;
        select.replaceChildren();
        ["", ...columns].forEach(name => add(select, "option", name || "default", { value: name }));
      }
      select.value = axes[k] ?? "";
    });
  }
}

/** The table of special points. */
export class Table {
  constructor(element, select) {
    [this.element, this.select] = [element, select];
  }

  show(branches, selected) {
    const table = this.element.querySelector("table");
    const focused = document.activeElement?.closest?.("#points tr")?.dataset.place;
    table.replaceChildren();
    const head = add(add(table, "thead"), "tr");
    ["branch", "label", "kind", "at", "error", "unstable", "numbers"].forEach(text => add(head, "th", text));
    const body = add(table, "tbody");
    branches.forEach((branch, b) => branch.special.forEach(point => {
      const place = [0, b, -point.label];
      const row = add(body, "tr", undefined, { tabIndex: 0 });
      row.dataset.place = place.join();
      row.setAttribute("aria-selected", String(selected?.join() === place.join()));
      const kind = point.converged ? point.kind : `${point.kind}?`;
      [branch.name, point.label, kind, point.at.join(", "), point.error, point.unstable ?? "", point.numbers.join(", ")].forEach((text, k) => {
        const cell = add(row, "td", String(text));
        if (k === 2) [cell.className, cell.title] = ["kind", point.meaning];
      });
      row.addEventListener("click", () => this.select(place));
      row.addEventListener("keydown", event => this.#key(event, row, place));
      if (row.dataset.place === focused) row.focus({ preventScroll: true });
    }));
    this.element.hidden = !body.children.length;
  }

  choose(place) {
    this.element.querySelectorAll("tbody tr").forEach(row => row.setAttribute("aria-selected", String(row.dataset.place === place?.join())));
  }

  #key(event, row, place) {
    const next = { ArrowDown: row.nextElementSibling, ArrowUp: row.previousElementSibling }[event.key];
    if (event.key === "Enter" || event.key === " ") this.select(place, true);
    else if (next) next.focus();
    else return;
    event.preventDefault();
  }
}

/** The values, the phase plane and the profiles of a point, and the runs that can continue there. */
export class Details {
  constructor(element, follow, plane) {
    [this.element, this.follow, this.plane] = [element, follow, plane];
  }

  hide() {
    this.element.hidden = true;
    this.plane.leave();
  }

  show(details, place, colours) {
    this.element.hidden = false;
    this.element.replaceChildren();
    add(this.element, "h2", details.title);
    if (details.follow_ups.length) {
      const follow = add(this.element, "div", undefined, { className: "follow" });
      details.follow_ups.forEach(it => this.#followUp(follow, it));
    }
    const table = add(add(this.element, "div", undefined, { className: "scroll" }), "table");
    details.rows.forEach(([name, value]) => {
      const row = add(table, "tr");
      add(row, "th", name, { scope: "row" });
      add(row, "td", value);
    });
    const profiles = add(this.element, "div", undefined, { className: "profiles" });
    if (!details.profiles.length && !details.plane) add(profiles, "span", "Profiles are saved at special points of orbits and boundary-value problems.");
    if (details.plane) this.plane.show(profiles, details, place, colours);
    else this.plane.leave();
    // The phase plane shows the phase portraits.
    const isState = name => details.plane?.states.some(it => it.name === name);
    const others = details.profiles.filter(it => !(isState(it.along) && isState(it.name)));
    [...new Set(others.map(it => it.along))].forEach((along, k) => this.#profiles(profiles, along, others.filter(it => it.along === along), colours, k));
  }

  #profiles(parent, along, profiles, colours, k) {
    const element = add(parent, "div", undefined, { className: "panel" });
    const place = add(element, "div", undefined, { className: "plot" });
    const key = add(element, "div", undefined, { className: "controls" });
    const curves = profiles.map(({ name, points }) => ({ name, style: "Solid", points, from: points.map(() => null) }));
    const names = profiles.map(it => it.name);
    const panel = { labels: [along, names.join(", ")], logarithmic: [false, false], names, curves, marks: [], meanings: [], beside: [], walls: [] };
    new Plot(place, { id: `profile-${k}`, tip: showTip }).show(panel, { colours });
    showKey(key, panel, colours);
  }

  /** A button for a run; a curve in two parameters has fields for its second parameter. */
  #followUp(parent, { title, run, second }) {
    if (!second.length) {
      add(parent, "button", `Follow: ${title}`, { type: "button" }).addEventListener("click", () => this.follow(run));
      return;
    }
    const form = add(parent, "form");
    const field = (label, value) => {
      const input = add(form, "input", undefined, { type: "text", inputMode: "decimal", value });
      input.setAttribute("aria-label", label);
      return input;
    };
    add(form, "button", `Follow: ${title}`, { type: "submit" });
    add(form, "span", "with");
    const select = add(form, "select");
    select.setAttribute("aria-label", "second parameter");
    second.forEach(it => add(select, "option", it.name, { value: it.name }));
    add(form, "span", "from");
    const low = field("lower end of the second parameter", second[0].low);
    add(form, "span", "to");
    const high = field("upper end of the second parameter", second[0].high);
    select.addEventListener("change", () => {
      const range = second.find(it => it.name === select.value);
      [low.value, high.value] = [range.low, range.high];
    });
    form.addEventListener("submit", event => {
      event.preventDefault();
      const range = { name: select.value, low: numberIn(low), high: numberIn(high) };
      this.follow({ ...run, along: [run.along[0], range] });
    });
  }
}

/** The branches in words, with the runs that were added. */
export const showNotes = (element, { branches, failed, warnings }, runs, remove) => {
  const list = element.querySelector("ul");
  list.replaceChildren();
  const removable = (item, name) => {
    if (runs.some(run => run.name === name)) add(item, "button", "remove", { type: "button" }).addEventListener("click", () => remove(name));
  };
  branches.forEach(branch => {
    removable(add(list, "li", branch.summary), branch.name);
    branch.warnings.forEach(text => add(list, "li", text, { className: "warning" }));
  });
  failed.forEach(trouble => removable(add(list, "li", trouble.message, { className: "wrong" }), trouble.run));
  warnings.forEach(text => add(list, "li", text, { className: "warning" }));
};
