// The setup of the page, with its history and the link that opens it again.

/** The edits with the same key within this time, in milliseconds, are undone together. */
const TOGETHER = 1200;
/** The most setups that can be undone. */
const MOST = 200;
/** The letters before the setup in the fragment of a link. */
const BEFORE = "#s=";

const toText = bytes => btoa(Array.from(bytes, byte => String.fromCharCode(byte)).join("")).replaceAll("+", "-").replaceAll("/", "_").replaceAll("=", "");
const toBytes = text => Uint8Array.from(atob(text.replaceAll("-", "+").replaceAll("_", "/")), letter => letter.charCodeAt(0));
const through = async (bytes, stream) => new Uint8Array(await new Response(new Blob([bytes]).stream().pipeThrough(stream)).arrayBuffer());

/** Returns the fragment of a link with a setup. */
const fragmentOf = async setup => BEFORE + toText(await through(new TextEncoder().encode(JSON.stringify(setup)), new CompressionStream("deflate-raw")));

/** Returns the setup in the fragment of the address; `null` without one. */
export const setupOfLink = async () => {
  if (!location.hash.startsWith(BEFORE)) return null;
  try {
    const bytes = await through(toBytes(location.hash.slice(BEFORE.length)), new DecompressionStream("deflate-raw"));
    return JSON.parse(new TextDecoder().decode(bytes));
  } catch {
    return null;
  }
};

export class State {
  #past = [];
  #future = [];
  #last = { key: null, time: 0 };
  #writing = 0;

  constructor(setup, changed) {
    this.setup = setup;
    this.changed = changed;
  }

  get canUndo() { return this.#past.length > 0; }
  get canRedo() { return this.#future.length > 0; }

  /** Changes some fields of the setup. `live` is true while a control is dragged. */
  edit(change, key = null, live = false) {
    const now = performance.now();
    const together = key !== null && key === this.#last.key && now - this.#last.time < TOGETHER;
    if (!together) this.#past.push(this.setup);
    this.#past.splice(0, this.#past.length - MOST);
    this.#future = [];
    this.#last = { key, time: now };
    this.setup = { ...this.setup, ...change };
    this.changed(live);
    this.#write();
  }

  undo() { this.#go(this.#past, this.#future); }
  redo() { this.#go(this.#future, this.#past); }

  #go(from, to) {
    if (!from.length) return;
    to.push(this.setup);
    this.setup = from.pop();
    this.#last = { key: null, time: 0 };
    this.changed(false);
    this.#write();
  }

  /** The address of the page always opens the present setup. */
  #write() {
    clearTimeout(this.#writing);
    this.#writing = setTimeout(() => this.link(), 300);
  }

  async link() {
    history.replaceState(null, "", await fragmentOf(this.setup));
    return location.href;
  }

  // The changed values, by the names of parameters and settings.
  value(name) { return this.setup.set.find(([key]) => key === name)?.[1]; }
  setValue(name, value, live = false) {
    const others = this.setup.set.filter(([key]) => key !== name);
    this.edit({ set: value === null ? others : [...others, [name, value]] }, live ? `set ${name}` : null, live);
  }

  range(name) { return this.setup.along.find(range => range.name === name); }
  setRange(range) {
    const others = this.setup.along.filter(it => it.name !== range.name);
    this.edit({ along: [range, ...others] });
  }
}
