// The page: each change of the setup is traced by the server, and the last picture stays until the
// next one is there.

import { Editor, Parameters, Settings, add } from "./controls.js";
import { Attractors } from "./attractors.js";
import { showTip } from "./key.js";
import { Details, Panels, Table, showNotes } from "./results.js";
import { Plane } from "./plane.js";
import { Request } from "./request.js";
import { ask, fetchFile, follow } from "./server.js";
import { State, setupOfLink } from "./state.js";
import { Sweep } from "./sweep.js";

/** A trace that is out of date may still end within this time, in milliseconds. */
const PATIENCE = 250;
/** If a full trace takes longer than this time, in milliseconds, the next one may be preceded by a draft. */
const SLOW = 400;
/** The interval at which the server is asked whether it is there, in milliseconds. */
const ALIVE = 2000;

const $ = selector => document.querySelector(selector);
const id = crypto.randomUUID();
let state;
let turn = 0;
let current = null;
let pending = null;
let last = null;
// The durations of the last full trace and of the last draft, in milliseconds.
const durations = { full: 0, draft: 0 };
let selected = null;
// The setup of the last complete result.
let traced = null;

const editor = new Editor($(".editor"), () => state);
const parameters = new Parameters($("#parameters .rows"), () => state);
const settings = new Settings($("#settings"), () => state);
const asked = new Request($("#request .rows"), () => state);
let described = null;
const panels = new Panels($("#panels"), { select: place => select(place), axes: (axis, name) => chooseAxis(axis, name), bars: bars => plane.bars(bars) });
const table = new Table($("#points"), (place, focus) => select(place, focus));
const sweep = new Sweep($("#sweep"), id, () => panels.at(0)?.plot);
const attractors = new Attractors($("#attractors"), id, showTip);
const plane = new Plane(id, { bars: bars => panels.bars(bars), lost: () => lost() });
const details = new Details($("#details"), run => state.edit({ runs: [...state.setup.runs, run] }), plane);

const say = text => { $("#status .text").textContent = text; };

// Traces. While a control is dragged, drafts are traced, and a trace that is soon complete is not cancelled. In slow
// scenes, a full trace is preceded by a draft if drafts are much faster, so that the diagram is soon complete.
const request = live => {
  const worthwhile = durations.full > SLOW && durations.draft < durations.full / 2;
  pending = { live, draft: live || worthwhile, begun: performance.now() };
  document.body.dataset.busy = "true";
  sweep.changed();
  if (!current) return start();
  const age = performance.now() - current.begun;
  if (!live || age > PATIENCE) return start();
  clearTimeout(current.timer);
  current.timer = setTimeout(start, PATIENCE - age);
};
const start = () => {
  if (!pending) return;
  if (current) {
    clearTimeout(current.timer);
    current.abort.abort();
  }
  const { live, draft, begun } = pending;
  pending = null;
  turn += 1;
  const own = { turn, live, draft, input: begun, begun: performance.now(), abort: new AbortController(), setup: state.setup, timer: 0 };
  current = own;
  $("#stop").hidden = false;
  document.body.dataset.busy = "true";
  const call = { trace: { page: id, turn, setup: { ...own.setup, draft } } };
  follow(call, own.abort.signal, message => { if (current === own) take(own, message); })
    .then(ended => { if (!ended) throw new TypeError("the connection was lost"); })
    .catch(error => { if (current === own && error.name !== "AbortError") lost(); })
    .finally(() => {
      if (current !== own) return;
      clearTimeout(own.timer);
      current = null;
      if (own.draft && !own.live && own.setup === traced && !last.stopped) pending ??= { live: false, draft: false, begun: own.input };
      $("#stop").hidden = true;
      document.body.dataset.busy = "false";
      document.body.dataset.turn = String(own.turn);
      if (!pending && traced === own.setup) sweep.finished();
      start();
    });
};

const take = (own, message) => {
  if (message.described) {
    described = message.described;
    parameters.show(described);
    sweep.describe(described);
    document.title = `${message.described.title || "tangency"} – tangency`;
  }
  if (message.partial) {
    own.first ??= performance.now() - own.input;
    panels.partial(message.partial);
    say("tracing …");
  }
  if (message.failed) fail(message.failed);
  if (message.done) finish(own, message.done);
};

const fail = trouble => {
  const { set, runs, along, bounds, marks, state: start } = state.setup;
  const changed = [set, runs, along, bounds, marks, start].some(it => it.length);
  const reset = changed ? () => state.edit({ set: [], runs: [], along: [], bounds: [], marks: [], state: [], settle: null }) : null;
  const atField = parameters.mark(trouble) || settings.mark(trouble);
  editor.mark(atField ? null : trouble, trouble.line ? null : reset);
  say("The picture shows the last result without errors.");
  document.body.dataset.trouble = trouble.message;
};

const finish = (own, done) => {
  last = done;
  traced = own.setup;
  plane.forget();
  delete document.body.dataset.trouble;
  [parameters, settings, editor].forEach(it => it.mark(null));
  panels.show(done.drawing, [own.setup.x, own.setup.y], own.live);
  showAttractors(done.drawing);
  table.show(done.branches, selected);
  showNotes($("#notes"), done, own.setup.runs, name => state.edit({ runs: state.setup.runs.filter(run => run.name !== name) }));
  $("#command").textContent = done.command;
  const points = done.branches.reduce((sum, branch) => sum + branch.special.length, 0);
  const count = (n, word, many) => `${n} ${n === 1 ? word : many}`;
  const stopped = done.stopped ? "stopped before its end: " : "";
  say(done.drawing.trouble ?? `${stopped}${count(done.branches.length, "branch", "branches")}, ${count(points, "special point", "special points")}, ${Math.round(done.millis)} ms`);
  if (described) asked.show(described, done.drawing.columns);
  document.body.dataset.first = String(Math.round(own.first ?? performance.now() - own.input));
  document.body.dataset.millis = String(Math.round(done.millis));
  if (!done.stopped) durations[own.draft ? "draft" : "full"] = done.millis;
  // A trace after a draft does not change the diagram visibly.
  if (own.draft || document.body.dataset.input !== String(own.input)) {
    document.body.dataset.latency = String(Math.round(performance.now() - own.input));
  }
  document.body.dataset.input = String(own.input);
  if (selected) refresh();
  if (!own.live && $("#settings").open) showSettings();
};

const showAttractors = drawing => {
  const values = Object.fromEntries((described?.parameters ?? []).map(({ name, value }) => [name, value]));
  attractors.show(drawing, k => panels.at(k), values);
};

// Points.
const select = async (place, focus = false) => {
  selected = place;
  panels.select(place);
  table.choose(place);
  await refresh();
  if (focus) $("#details").focus();
};
const refresh = async () => {
  const place = selected;
  if (!place) return;
  const number = turn;
  try {
    const answer = await ask({ point: { page: id, at: { branch: place[1], point: place[2] } } });
    if (selected !== place || number !== turn) return;
    details.show(answer.details, place, last.drawing.colours);
    panels.select(place);
  } catch (error) {
    // The point has gone.
    if (number === turn && error.trouble) {
      selected = null;
      details.hide();
      panels.select(null);
      table.choose(null);
    } else if (number === turn) lost();
  }
};

const chooseAxis = async (axis, name) => {
  state.setup = { ...state.setup, [axis]: name };
  traced = null;
  try {
    const { drawing } = await ask({ axes: { page: id, x: state.setup.x, y: state.setup.y } });
    if (!drawing.panels.length) throw new Error(drawing.trouble);
    last.drawing = drawing;
    sweep.changed();
    panels.show(drawing, [state.setup.x, state.setup.y], false);
    showAttractors(drawing);
    sweep.finished();
    say("");
  } catch (error) {
    say(error.message);
  }
  state.link();
};

const showSettings = async () => {
  try {
    settings.show((await ask({ settings: { setup: state.setup } })).settings);
  } catch (error) {
    if (!error.trouble) lost();
  }
};

// The setup has changed.
const changed = live => {
  editor.show(state.setup.text);
  $("#undo").disabled = !state.canUndo;
  $("#redo").disabled = !state.canRedo;
  $("#depth").value = String(state.setup.depth);
  request(live);
};

// Files.
const save = async (format, ending) => {
  try {
    const file = await fetchFile({ file: { page: id, format } });
    const url = URL.createObjectURL(file);
    Object.assign(document.createElement("a"), { href: url, download: `${state.setup.name || "scene"}.${ending}` }).click();
    setTimeout(() => URL.revokeObjectURL(url), 2000);
    say(`saved ${state.setup.name || "scene"}.${ending}`);
  } catch (error) {
    say(error.message);
  }
  $("#save").open = false;
};
const copy = async (text, what) => {
  try {
    await navigator.clipboard.writeText(text);
    say(`${what} copied`);
  } catch {
    say(text);
  }
};

// The server.
const lost = () => {
  $("#gone").hidden = false;
  $("#gone").textContent = "The program does not answer: it has ended, or is stopped. This page tries again every two seconds; after a new start, open the address that the program prints, with the part of this address from # on.";
  document.body.dataset.gone = "true";
};
const watch = async () => {
  try {
    await ask({ alive: {} }, ALIVE);
    if (document.body.dataset.gone === "true") {
      document.body.dataset.gone = "false";
      $("#gone").hidden = true;
      request(false);
    }
  } catch {
    lost();
  }
  setTimeout(watch, ALIVE);
};

const open = async () => {
  const opened = await ask({ open: {} });
  const examples = $("#example");
  add(examples, "option", "choose …", { value: "" });
  opened.examples.forEach(({ name, summary }) => add(examples, "option", `${name}: ${summary}`, { value: name }));
  examples.addEventListener("change", async () => {
    if (!examples.value) return;
    const { setup } = await ask({ example: { name: examples.value } });
    examples.value = "";
    selected = null;
    details.hide();
    state.edit(setup);
  });
  state = new State({ ...opened.setup, ...(await setupOfLink()) }, changed);
  changed(false);
  document.body.dataset.ready = "true";
  setTimeout(watch, ALIVE);
};

$("#undo").addEventListener("click", () => state.undo());
$("#redo").addEventListener("click", () => state.redo());
$("#depth").addEventListener("change", () => state.edit({ depth: Number($("#depth").value) }));
$("#stop").addEventListener("click", () => ask({ stop: { page: id } }));
$("#link").addEventListener("click", async () => copy(await state.link(), "link"));
$("#copy").addEventListener("click", () => copy($("#command").textContent, "command"));
$("#settings").addEventListener("toggle", () => { if ($("#settings").open) showSettings(); });
document.querySelectorAll("#save button").forEach(button => button.addEventListener("click", () => save(button.dataset.format, button.dataset.ending)));
document.addEventListener("keydown", event => {
  const inText = ["TEXTAREA"].includes(document.activeElement?.tagName) || document.activeElement?.type === "text";
  if (event.key === "Escape") $("#save").open = false;
  if (!(event.ctrlKey || event.metaKey) || event.key.toLowerCase() !== "z" || inText) return;
  event.preventDefault();
  if (event.shiftKey) state.redo(); else state.undo();
});
open().catch(lost);
