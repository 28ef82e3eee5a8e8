// The phase plane of a point: simulations from the states that the user chooses, nullclines and
// directions of the vector field.

import { add, numberIn } from "./controls.js";
import { Plot, format } from "./figure.js";
import { showKey, showTip } from "./key.js";
import { follow } from "./server.js";

/** The most states with a field for the initial value. */
const MOST_FIELDS = 12;
/** A click is a simulation if no second click follows within this time, in milliseconds. */
const DOUBLE = 250;
/** Clicked values are rounded to a part of the visible range, at most one of this number of parts. */
const PARTS = 1000;

const isInside = (value, [low, high]) => value >= low && value <= high;
/** Rounds a value to a decimal that is not far from it in units of a range. */
const rounded = (value, [low, high]) => {
  const step = 10 ** Math.floor(Math.log10((high - low) / PARTS));
  return Number((Math.round(value / step) * step).toPrecision(12));
};

/** The simulations of a result, and the phase plane of the selected point. */
export class Plane {
  #page;
  #actions;
  #last = 0;
  #runs = [];
  #all = [];
  #abort = null;
  #timer = 0;
  // The selected point with its details, its controls, and its choices.
  #at = null;
  #choices = {};
  #field = null;

  /** `actions.bars(bars)` shows ranges over the diagram, and `actions.lost()` reports a lost connection. */
  constructor(page, actions) {
    [this.#page, this.#actions] = [page, actions];
  }

  /** Forgets all simulations, because the result is out of date. */
  forget() {
    this.leave();
    [this.#runs, this.#all] = [[], []];
  }

  /** Leaves the point: a running simulation is cancelled. */
  leave() {
    clearTimeout(this.#timer);
    this.#abort?.abort();
    [this.#abort, this.#at, this.#field] = [null, null, null];
  }

  /** The bars of simulations that are not cleared, with their titles. */
  bars(bars) {
    const known = new Set(this.#runs.map(run => run.number));
    const title = ({ number, state, low, high }) => `simulation ${number}: ${state} from ${format(low)} to ${format(high)}`;
    return bars.filter(bar => known.has(bar.number)).map(bar => ({ ...bar, title: title(bar) }));
  }

  /** Shows the phase plane of a point in an element. */
  show(parent, details, place, colours) {
    const last = this.#at;
    const key = place.join();
    if (last && last.key !== key) this.leave();
    if (this.#choices.key !== key) this.#choices = { ...this.#choices, key, start: {}, duration: null, wide: 1 };
    const { states } = details.plane;
    const element = add(parent, "div", undefined, { className: "panel plane" });
    this.#at = { key, place, details, colours, element, states, at: { branch: place[1], point: place[2] } };
    this.#choosePair(details);
    add(element, "h3", this.#pair.length ? "Phase plane" : "Simulation");
    if (this.#pair.length) this.#plane(element);
    this.#form(element);
    this.#status = add(element, "p", "", { className: "outcome", hidden: true });
    this.#status.setAttribute("role", "status");
    this.#course = add(element, "div", undefined, { className: "course", hidden: true });
    const plot = add(this.#course, "div", undefined, { className: "plot" });
    this.#key = add(this.#course, "div", undefined, { className: "controls" });
    this.#history = new Plot(plot, { id: "history", tip: showTip });
    this.#draw();
    this.#ask();
  }

  #status;
  #course;
  #key;
  #history;
  #plot;
  #legend;
  #pair = [];
  #fields;
  #duration;
  #buttons;

  /** The states on the axes: the last choice, the states of a phase portrait, or the first two. */
  #choosePair({ plane: { states }, profiles }) {
    const isState = name => states.some(it => it.name === name);
    const chosen = this.#choices.pair?.every(isState) ? this.#choices.pair : null;
    const portrait = profiles.find(it => isState(it.along) && isState(it.name));
    const usual = portrait ? [portrait.along, portrait.name] : states.slice(0, 2).map(it => it.name);
    this.#pair = states.length < 2 ? [] : chosen ?? usual;
  }

  #plane(element) {
    const { details: { plane }, states } = this.#at;
    const controls = add(element, "div", undefined, { className: "controls" });
    if (states.length > 2) ["horizontal", "vertical"].forEach((axis, k) => this.#select(controls, axis, k));
    if (plane.has_field) {
      const label = add(controls, "label");
      const box = add(label, "input", undefined, { type: "checkbox", id: "nullclines", checked: this.#choices.hidden !== true });
      label.append("nullclines and directions");
      box.addEventListener("change", () => {
        this.#choices.hidden = !box.checked;
        this.#draw();
        this.#ask();
      });
    }
    const wide = (text, factor, title) => add(controls, "button", text, { type: "button", title }).addEventListener("click", () => {
      this.#choices.wide *= factor;
      this.#draw();
      this.#ask();
    });
    wide("wider", 2, "Show twice the range of both states");
    wide("narrower", 0.5, "Show half the range of both states");
    const place = add(element, "div", undefined, { className: "plot" });
    this.#legend = add(element, "div", undefined, { className: "controls" });
    this.#plot = new Plot(place, { id: "plane", tip: showTip, zoomed: () => this.#ask(), click: (values, event) => this.#click(values, event) });
  }

  #select(controls, axis, k) {
    const label = add(controls, "label", axis);
    const select = add(label, "select", undefined, { id: `plane-${axis}` });
    this.#at.states.forEach(it => add(select, "option", it.name, { value: it.name }));
    select.value = this.#pair[k];
    select.addEventListener("change", () => {
      const other = this.#pair[1 - k];
      // The two axes show different states.
      const next = select.value === other ? [...this.#pair].reverse() : this.#pair.map((name, i) => (i === k ? select.value : name));
      this.#choices.pair = next;
      this.#rebuild();
      document.getElementById(select.id).focus();
    });
  }

  /** Shows the same point with other states on the axes. */
  #rebuild() {
    const { element, details, place, colours } = this.#at;
    const parent = document.createElement("div");
    const status = this.#status;
    this.show(parent, details, place, colours);
    element.replaceWith(this.#at.element);
    this.#status.replaceWith(status);
    this.#status = status;
  }

  #form(element) {
    const { details: { plane }, states } = this.#at;
    const form = add(element, "form", undefined, { className: "start", noValidate: true });
    const first = states.filter(it => this.#pair.includes(it.name));
    const others = states.filter(it => !this.#pair.includes(it.name)).slice(0, Math.max(0, MOST_FIELDS - first.length));
    this.#fields = new Map();
    const field = (text, name, value) => {
      const label = add(form, "label", text);
      const input = add(label, "input", undefined, { type: "text", inputMode: "decimal", autocomplete: "off", value });
      input.setAttribute("aria-label", name);
      return input;
    };
    [...first, ...others].forEach(({ name, value }) => {
      const input = field(name, `initial ${name}`, this.#choices.start[name] ?? value);
      input.addEventListener("change", () => { this.#choices.start[name] = input.value; });
      this.#fields.set(name, input);
    });
    const unit = plane.unit === "periods" ? "duration in periods" : "duration";
    this.#duration = field(unit, "duration of the simulation", this.#choices.duration ?? plane.duration);
    this.#duration.addEventListener("change", () => { this.#choices.duration = this.#duration.value; });
    const button = (text, click) => {
      const added = add(form, "button", text, { type: click ? "button" : "submit" });
      if (click) added.addEventListener("click", click);
      return added;
    };
    button("Simulate");
    this.#buttons = {
      stop: button("Stop", () => this.#abort?.abort()),
      clear: button("Clear", () => this.#clear()),
    };
    this.#buttons.clear.title = "Remove all simulations, also over the diagram";
    form.addEventListener("submit", event => {
      event.preventDefault();
      this.#submit();
    });
    const begins = plane.mode === null ? [] : [`Simulations begin in the mode “${plane.mode}”.`];
    if (plane.unit === "periods") begins.push("Simulations begin at the time 0.");
    if (this.#pair.length) begins.unshift("Click in the plane to simulate from there.");
    add(element, "small", begins.join(" "));
    this.#busy(this.#abort !== null);
  }

  #busy(busy) {
    this.#buttons.stop.hidden = !busy;
    this.#buttons.clear.disabled = !this.#runs.length;
    this.#at.element.dataset.busy = String(busy);
  }

  #say(text, wrong = false) {
    this.#status.hidden = text === "";
    this.#status.textContent = text;
    this.#status.classList.toggle("wrong", wrong);
  }

  #click(values, event) {
    clearTimeout(this.#timer);
    // A double click shows the whole plane again.
    if (event.detail > 1) return;
    const ranges = this.#plot.ranges;
    this.#timer = setTimeout(() => {
      this.#pair.forEach((name, axis) => {
        this.#choices.start[name] = this.#fields.get(name).value = String(rounded(values[axis], ranges[axis]));
      });
      this.#submit();
    }, DOUBLE);
  }

  #submit() {
    const number = field => {
      const value = numberIn(field);
      const wrong = typeof value !== "number";
      field.setAttribute("aria-invalid", String(wrong));
      return wrong ? null : value;
    };
    const start = this.#at.states.map(({ name, value }) => [name, this.#fields.has(name) ? number(this.#fields.get(name)) : value]);
    const duration = number(this.#duration);
    const isPositive = duration !== null && duration > 0;
    this.#duration.setAttribute("aria-invalid", String(!isPositive));
    if (!isPositive || start.some(([, value]) => value === null)) {
      return this.#say("The initial states must be numbers, and the duration must be a number above 0.", true);
    }
    this.#simulate(start, duration);
  }

  async #simulate(state, duration) {
    this.#abort?.abort();
    const [own, at] = [new AbortController(), this.#at];
    this.#abort = own;
    this.#last += 1;
    const run = { number: this.#last, key: at.key };
    this.#busy(true);
    this.#say(`simulating …`);
    const call = { simulate: { page: this.#page, number: run.number, at: at.at, state, duration } };
    const current = () => this.#abort === own && !own.signal.aborted;
    try {
      const ended = await follow(call, own.signal, message => { if (current()) this.#take(run, message); });
      if (!ended && current()) throw new TypeError("the connection was lost");
    } catch (error) {
      if (error.name !== "AbortError" && current()) this.#actions.lost();
      else if (this.#abort === own && this.#at) this.#say("The simulation was stopped.");
    }
    if (this.#abort !== own) return;
    this.#abort = null;
    if (this.#at) this.#busy(false);
  }

  #take(run, { failed, simulated, bars }) {
    if (failed) return this.#say(failed.message, true);
    if (!simulated) return;
    Object.assign(run, simulated);
    this.#runs.push(run);
    [this.#all] = [bars];
    this.#actions.bars(bars);
    this.#draw();
    this.#tell(run);
  }

  /** The end of a simulation in words, and what the picture omits. */
  #tell(run) {
    const end = run.rows.at(-1);
    const values = run.states.map((name, k) => (end[k + 1] === null ? [] : `${name} = ${format(end[k + 1])}`)).flat();
    const notes = [`Simulation ${run.number} ends at t = ${format(end[0])} with ${values.slice(0, MOST_FIELDS).join(", ")}.`];
    const points = this.#pair.length ? this.#points(run) : [];
    const inside = point => point.every((value, axis) => isInside(value, this.#plot.ranges[axis]));
    if (!points.every(inside)) notes.push("Parts of it are outside the picture.");
    if (run.is_thinned) notes.push("The picture omits some of its points.");
    this.#say(notes.join(" "));
  }

  /** The course of a simulation in the plane. */
  #points({ states, rows }) {
    const [x, y] = this.#pair.map(name => states.indexOf(name) + 1);
    return rows.map(row => [row[x], row[y]]).filter(point => point.every(value => value !== null));
  }

  #clear() {
    clearTimeout(this.#timer);
    this.#abort?.abort();
    this.#runs = [];
    this.#actions.bars(this.#all);
    this.#say("");
    this.#draw();
    this.#busy(false);
  }

  /** The orbit of the selected point in the plane; empty for an equilibrium. */
  #orbit() {
    const { profiles } = this.#at.details;
    const [x, y] = this.#pair;
    const portrait = (along, name) => profiles.find(it => it.along === along && it.name === name)?.points;
    const turned = portrait(y, x)?.map(([a, b]) => [b, a]);
    const [first, second] = [x, y].map(name => portrait("time", name));
    const inTime = first && second && first.length === second.length ? first.map(([, value], k) => [value, second[k][1]]) : [];
    return portrait(x, y) ?? turned ?? inTime;
  }

  #draw() {
    const { element, key, states, colours } = this.#at;
    const runs = this.#runs.filter(run => run.key === key);
    const last = runs.at(-1);
    element.dataset.simulations = String(runs.length);
    element.dataset.end = JSON.stringify(last ? Object.fromEntries(last.states.map((name, k) => [name, last.rows.at(-1)[k + 1]])) : {});
    if (this.#pair.length) this.#drawPlane(runs);
    this.#course.hidden = !last;
    if (!last) return;
    const names = this.#pair.length ? this.#pair : states.map(it => it.name);
    const curves = names.map(name => {
      const k = last.states.indexOf(name) + 1;
      const points = last.rows.filter(row => row[k] !== null).map(row => [row[0], row[k]]);
      return { name, style: "Solid", points, from: points.map(() => null) };
    });
    const panel = { labels: ["time", names.join(", ")], logarithmic: [false, false], names, curves, marks: [], meanings: [], beside: [], walls: [] };
    this.#history.show(panel, { colours });
    showKey(this.#key, panel, colours);
  }

  #drawPlane(runs) {
    const { details: { plane }, states, colours } = this.#at;
    const { wide, hidden } = this.#choices;
    const own = this.#pair.map(name => states.find(it => it.name === name));
    const extent = own.map(({ low, high }) => {
      const [middle, half] = [(low + high) / 2, (wide * (high - low)) / 2];
      return [middle - half, middle + half];
    });
    const curve = (name, style, points) => ({ name, style, points, from: points.map(() => null) });
    const field = plane.has_field && !hidden ? this.#field : null;
    const nullclines = this.#pair.map(name => `${name}′ = 0`);
    const orbit = this.#orbit();
    const curves = [
      ...(field ? nullclines.flatMap((name, k) => field.nullclines[k].map(line => curve(name, "Dashed", line))) : []),
      ...(orbit.length ? [curve("orbit", "Solid", orbit)] : []),
      ...runs.map(run => curve(`simulation ${run.number}`, "Solid", this.#points(run))),
    ];
    const mark = (at, symbol, meaning) => ({ at, symbol, label: "", meaning, from: null });
    const marks = runs.flatMap(run => this.#points(run).slice(0, 1).map(at => mark(at, "Ring", `start of simulation ${run.number}`)));
    if (plane.is_equilibrium) marks.push(mark(own.map(it => it.value), "Disc", "equilibrium"));
    const names = ["orbit", ...nullclines, ...runs.map(run => `simulation ${run.number}`)];
    const panel = { labels: this.#pair, logarithmic: [false, false], names, dashed: nullclines, curves, marks, meanings: [], beside: [], walls: [], extent, arrows: field?.arrows };
    this.#plot.show(panel, { colours });
    showKey(this.#legend, panel, colours);
  }

  /** Asks for the vector field in the visible ranges, unless it is hidden. */
  async #ask() {
    const at = this.#at;
    if (!at?.details.plane.has_field || this.#choices.hidden || !this.#plot?.ranges) return;
    const ranges = this.#plot.ranges;
    const wanted = JSON.stringify([at.key, this.#pair, ranges]);
    if (this.#field?.wanted === wanted) return;
    this.#wanted = wanted;
    const call = { field: { page: this.#page, at: at.at, states: this.#pair, ranges } };
    try {
      await follow(call, AbortSignal.timeout(60000), ({ field, failed }) => {
        if (this.#wanted !== wanted || this.#at !== at) return;
        if (failed) this.#say(failed.message, true);
        if (field) {
          this.#field = { ...field, wanted };
          this.#draw();
          at.element.dataset.field = String(ranges.flat());
        }
      });
    } catch {
      if (this.#at === at) this.#actions.lost();
    }
  }

  #wanted = "";
}
