// The attractors at a point of a diagram in two parameters: the user moves a cross, and a phase
// portrait shows the motions that are found there.

import { add } from "./controls.js";
import { Plot, format } from "./figure.js";
import { follow } from "./server.js";

/** A search that is out of date may still end within this time, in milliseconds. */
const PATIENCE = 250;
/** The pause after the last key before the search is refined, in milliseconds. */
const PAUSE = 350;
/** An arrow key moves the cross by this share of an axis, with the shift key by the second one. */
const STEPS = [0.01, 0.002];
const KEYS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };

export class Attractors {
  #turn = 0;
  #on = false;
  #plane = null;
  #plot = null;
  #at = null;
  #end = [];
  #found = [];
  #shown = [null, null];
  #current = null;
  #pending = null;
  #timer = 0;

  constructor(element, page, tip) {
    [this.element, this.page] = [element, page];
    add(element, "h2", "Attractors in two parameters");
    const line = add(element, "div", undefined, { className: "line" });
    this.toggle = add(line, "button", "Show attractors", { id: "attractors-toggle", type: "button" });
    this.toggle.setAttribute("aria-pressed", "false");
    this.text = add(line, "span", "", { id: "attractors-text", className: "quiet" });
    this.text.setAttribute("role", "status");
    this.body = add(element, "div", undefined, { className: "attractors", hidden: true });
    this.selects = ["horizontal", "vertical"].map((name, axis) => {
      const select = add(add(line, "label", `${name} `), "select", undefined, { id: `attractors-${axis ? "y" : "x"}` });
      select.addEventListener("change", () => {
        this.#shown[axis] = select.value;
        this.#request(true);
      });
      return select;
    });
    this.portrait = new Plot(add(this.body, "div", undefined, { className: "plot" }), { id: "attractors", tip });
    this.list = add(this.body, "ul", undefined, { id: "attractors-list" });
    this.cross = Object.assign(document.createElement("button"), { type: "button", className: "cross" });
    this.toggle.addEventListener("click", () => this.#switch(!this.#on));
    this.#listen();
    this.#switch(false);
  }

  /** A new diagram is complete; `shown(k)` is the element and the plot of a panel. */
  show(drawing, shown, values) {
    const k = drawing.planes.findIndex(Boolean);
    this.element.hidden = k < 0;
    this.colours = drawing.colours;
    const names = drawing.planes[k] ?? null;
    const same = names?.join("\n") === this.#plane?.join("\n");
    [this.#plane, this.#plot] = [names, k < 0 ? null : shown(k).plot];
    if (!names) return this.#switch(false);
    if (!same) [this.#at, this.#end] = [null, []];
    this.values = values;
    if (this.#on) this.#switch(true);
  }

  #switch(on) {
    this.#on = on;
    this.toggle.setAttribute("aria-pressed", String(on));
    this.toggle.textContent = on ? "Hide attractors" : "Show attractors";
    this.body.hidden = !on;
    this.selects.forEach(select => { select.parentElement.hidden = !on; });
    if (this.drawnIn && this.drawnIn !== this.#plot) this.drawnIn.drawn = null;
    if (!on || !this.#plot) {
      this.#current?.abort.abort();
      [this.#current, this.#pending, this.#found] = [null, null, []];
      document.body.dataset.attractors = "off";
      this.cross.remove();
      this.text.textContent = "";
      return;
    }
    this.drawnIn = this.#plot;
    if (this.cross.parentElement !== this.#plot.element) this.#plot.element.append(this.cross);
    this.cross.setAttribute("aria-label", `Point (${this.#plane.join(", ")}) at which attractors are shown; move with the arrow keys`);
    this.#plot.drawn = () => this.#place();
    this.#at ??= this.#middle();
    this.#place();
    this.#request(true);
  }

  /** The present values of the parameters, if the diagram contains them; otherwise its middle. */
  #middle() {
    const [x, y] = this.#plot.ranges;
    const own = this.#plane.map(name => this.values[name]);
    const inside = [x, y].every(([low, high], axis) => own[axis] > low && own[axis] < high);
    return inside ? own : this.#plot.fromShare([0.5, 0.5]);
  }

  #place() {
    const at = this.#at && this.#plot?.toPixels(this.#at);
    this.cross.hidden = !at;
    if (!at) return;
    [this.cross.style.left, this.cross.style.top] = at.map(pixel => `${pixel}px`);
  }

  #move(at, refined) {
    this.#at = at;
    this.#place();
    this.#request(refined);
  }

  #listen() {
    const { cross } = this;
    const at = event => {
      const box = this.#plot.element.getBoundingClientRect();
      return this.#plot.fromPixels([event.clientX - box.left, event.clientY - box.top]);
    };
    let held = false;
    cross.addEventListener("pointerdown", event => {
      held = true;
      cross.setPointerCapture(event.pointerId);
    });
    cross.addEventListener("pointermove", event => {
      if (held) this.#move(at(event), false);
    });
    ["pointerup", "pointercancel"].forEach(name => cross.addEventListener(name, () => {
      if (held) this.#request(true);
      held = false;
    }));
    cross.addEventListener("keydown", event => {
      const by = KEYS[event.key];
      if (!by) return;
      event.preventDefault();
      const step = STEPS[event.shiftKey ? 1 : 0];
      const share = this.#plot.toShare(this.#at);
      this.#move(this.#plot.fromShare(share.map((part, axis) => part + step * by[axis])), false);
      clearTimeout(this.#timer);
      this.#timer = setTimeout(() => this.#request(true), PAUSE);
    });
  }

  // A search that will soon be complete is not cancelled, so that the portrait follows a drag.
  #request(refined) {
    if (!this.#on || !this.#plane) return;
    clearTimeout(this.#timer);
    this.#pending = { refined, begun: performance.now() };
    document.body.dataset.attractors = "running";
    const age = this.#current ? performance.now() - this.#current.begun : Infinity;
    if (!this.#current || this.#current.refined || age > PATIENCE) this.#start();
  }

  #start() {
    if (!this.#pending) return;
    this.#current?.abort.abort();
    this.#turn += 1;
    const own = { ...this.#pending, abort: new AbortController(), found: null };
    [this.#current, this.#pending] = [own, null];
    const at = this.#plane.map((name, axis) => [name, this.#at[axis]]);
    const place = { at, from: this.#end, shown: this.#shown, refined: own.refined };
    follow({ attractors: { page: this.page, turn: this.#turn, place } }, own.abort.signal, message => { if (this.#current === own) this.#take(own, message); })
      .then(ended => { if (!ended) throw new Error("The connection was lost."); })
      .catch(error => { if (this.#current === own) this.#say(error.message); })
      .finally(() => {
        if (this.#current !== own) return;
        this.#current = null;
        if (!this.#pending) document.body.dataset.attractors = own.refined ? "done" : "quick";
        this.#start();
      });
  }

  #take(own, { states, shown, attractor, searched, failed }) {
    if (states) this.#axes(states, shown);
    if (attractor) {
      own.found ??= [];
      own.found.push(attractor);
      const [first] = own.found;
      this.#end = first.end.every(([, value]) => Number.isFinite(value)) ? first.end : [];
      this.#found = own.found;
      this.#draw(!own.refined);
      if (own.found.length === 1) document.body.dataset.dragged = String(Math.round(performance.now() - own.begun));
      this.#say(own.refined ? "searching from further initial states …" : "");
    }
    if (searched) this.#say(own.refined ? `from ${searched.starts} initial states` : "");
    if (failed) this.#say(failed.message);
  }

  #say(text) {
    const at = this.#plane.map((name, axis) => `${name} = ${format(this.#at[axis], 4)}`).join(", ");
    this.text.textContent = text ? `${at}: ${text}` : at;
  }

  #axes(states, shown) {
    this.axes = shown;
    this.selects.forEach((select, axis) => {
      const names = states.includes(shown[axis]) ? states : [shown[axis], ...states];
      if (select.dataset.names !== names.join("\n")) {
        select.dataset.names = names.join("\n");
        select.replaceChildren();
        names.forEach(name => add(select, "option", name, { value: name }));
      }
      select.value = shown[axis];
    });
  }

  #draw(steady) {
    const name = k => `${k + 1}`;
    const curves = this.#found.map(({ points, rests, certain }, k) => ({ name: name(k), style: rests ? "Blots" : certain ? "Solid" : "Thin", points, from: points.map(() => null) }));
    const names = curves.map(curve => curve.name);
    this.portrait.show({ labels: this.axes, logarithmic: [false, false], names, curves, marks: [], meanings: [], beside: [], walls: [] }, { colours: this.colours, steady });
    this.list.replaceChildren();
    this.#found.forEach(({ label, certain }, k) => {
      const item = add(this.list, "li", undefined, { className: certain ? "" : "uncertain" });
      const key = add(item, "span", undefined, { className: "key" });
      add(key, "i").style.borderTopColor = this.colours[k % this.colours.length];
      add(key, "span", label);
    });
  }
}
