// A sweep over the continuation parameter: its points under the diagram, and its progress.

import { add } from "./controls.js";
import { format } from "./figure.js";
import { ask, follow } from "./server.js";

/** The colours and the meanings of the points, by the names of sweeps. */
const LOOKS = { up: ["#8d969e", "increasing"], down: ["#5b95c9", "decreasing"] };

export class Sweep {
  #turn = 0;
  #running = null;
  #curves = [];
  #possible = false;
  #swept = false;
  #frame = 0;

  /** `plot()` is the diagram; it is undefined before the first result. */
  constructor(element, page, plot) {
    [this.element, this.page, this.plot] = [element, page, plot];
    add(element, "h2", "Sweep");
    this.why = add(element, "p", "", { className: "quiet" });
    this.form = add(element, "form", undefined, { className: "line" });
    this.range = add(this.form, "span", "", { className: "quiet" });
    const label = text => add(this.form, "label", text);
    this.count = add(label("values "), "input", undefined, { id: "sweep-count", type: "text", inputMode: "numeric", value: "101", autocomplete: "off" });
    this.both = this.#checkbox("sweep-both", "both directions", true);
    this.atLabel = label("sampled at ");
    this.at = add(this.atLabel, "select", undefined, { id: "sweep-at" });
    this.repeat = this.#checkbox("sweep-repeat", "repeat after each change", false);
    this.start = add(this.form, "button", "Sweep", { id: "sweep-start", type: "submit", disabled: true });
    this.stop = add(this.form, "button", "Stop sweep", { id: "sweep-stop", type: "button", hidden: true });
    this.bar = add(this.form, "progress", undefined, { id: "sweep-progress", hidden: true });
    this.bar.setAttribute("aria-label", "finished runs of the sweep");
    this.text = add(this.form, "span", "", { id: "sweep-text" });
    this.text.setAttribute("role", "status");
    this.key = add(this.form, "span", undefined, { className: "line" });
    this.form.addEventListener("submit", event => {
      event.preventDefault();
      this.#begin();
    });
    this.stop.addEventListener("click", () => ask({ stop_sweep: { page: this.page } }).catch(() => {}));
    [this.count, this.both, this.at].forEach(field => field.addEventListener("change", () => this.changed()));
    document.body.dataset.sweep = "none";
  }

  /** Shows the range of the continuation parameter, or the reason why no sweep is possible. */
  describe({ along, sweep }) {
    const [range] = along;
    const end = value => (typeof value === "number" ? format(value) : value ?? "an open end");
    this.#possible = sweep.why_not === null && Boolean(range);
    this.form.hidden = !this.#possible;
    this.why.textContent = sweep.why_not ?? (range ? "" : "The runs vary no parameter.");
    this.why.hidden = this.#possible;
    if (range) this.range.textContent = `${range.name} from ${end(range.low)} to ${end(range.high)}`;
    const names = sweep.events.join("\n");
    this.atLabel.hidden = names === "";
    if (this.at.dataset.names === names) return;
    this.at.dataset.names = names;
    this.at.replaceChildren();
    sweep.events.forEach(name => add(this.at, "option", name, { value: name }));
  }

  /** An input has changed: the points of the last sweep are out of date. */
  changed() {
    this.#running?.abort.abort();
    this.#end();
    this.start.disabled = true;
    this.#show([]);
    this.#say("");
    document.body.dataset.sweep = "none";
    // The fields of the sweep do not trace the diagram again.
    if (document.body.dataset.busy === "false") this.finished();
  }

  /** A new diagram is complete. */
  finished() {
    this.start.disabled = !this.#possible;
    if (this.#possible && this.#swept && this.repeat.checked && !this.#running) this.#begin();
  }

  #checkbox(id, text, checked) {
    const label = add(this.form, "label");
    const box = add(label, "input", undefined, { id, type: "checkbox", checked });
    label.append(` ${text}`);
    return box;
  }

  #begin() {
    const count = Number(this.count.value);
    const wrong = !Number.isInteger(count) || count < 1;
    this.count.setAttribute("aria-invalid", String(wrong));
    if (wrong) return this.#say("The number of values must be a positive integer.", true);
    this.#running?.abort.abort();
    this.#show([]);
    this.#say("");
    this.#turn += 1;
    this.#swept = true;
    const own = { abort: new AbortController() };
    this.#running = own;
    this.stop.hidden = this.bar.hidden = false;
    this.bar.removeAttribute("value");
    document.body.dataset.sweep = "running";
    const sweep = { count, both: this.both.checked, at: this.at.value || null };
    follow({ sweep: { page: this.page, turn: this.#turn, sweep } }, own.abort.signal, message => { if (this.#running === own) this.#take(message); })
      .then(ended => { if (!ended) throw new Error("The connection was lost."); })
      .catch(error => { if (this.#running === own) this.#say(error.message, true); })
      .finally(() => {
        if (this.#running !== own) return;
        this.#end();
        document.body.dataset.sweep = "done";
      });
  }

  #end() {
    this.#running = null;
    this.stop.hidden = this.bar.hidden = true;
  }

  #take({ specks, swept, failed }) {
    if (specks) {
      const { progress, curves } = specks;
      curves.forEach(({ name, points }) => {
        const known = this.#curves.find(curve => curve.name === name);
        if (known) points.forEach(point => known.points.push(point));
        else this.#curves.push({ name, points, colour: (LOOKS[name] ?? LOOKS.up)[0] });
      });
      this.#show(this.#curves);
      [this.bar.max, this.bar.value] = [progress.total, progress.done];
      this.#say(`${progress.done} of ${progress.total} runs`);
    }
    if (swept) {
      cancelAnimationFrame(this.#frame);
      this.plot()?.specks(this.#curves);
      const runs = swept.stopped ? `stopped after ${swept.done} of ${swept.total} runs` : `${swept.done} runs`;
      this.#say(swept.failed ? `${runs}; ${swept.failed} failed: ${swept.why}` : runs, swept.failed > 0);
    }
    if (failed) this.#say(failed.message, true);
  }

  /** Draws the points in the next frame. */
  #show(curves) {
    this.#curves = curves;
    if (curves.length !== this.key.children.length) {
      this.key.replaceChildren();
      curves.forEach(({ name, colour }) => {
        const key = add(this.key, "span", undefined, { className: "key" });
        add(key, "i").style.borderTopColor = colour;
        add(key, "span", (LOOKS[name] ?? [])[1] ?? name);
      });
    }
    cancelAnimationFrame(this.#frame);
    if (!curves.length) return this.plot()?.specks([]);
    this.#frame = requestAnimationFrame(() => this.plot()?.specks(this.#curves));
  }

  #say(text, wrong = false) {
    this.text.textContent = text;
    this.text.className = wrong ? "wrong" : "quiet";
  }
}
