// Figures as SVG: axes, curves and marks. A place is [document, branch, n]: the point n of the
// branch, or for n < 0 the special point with the label -n.

const SVG = "http://www.w3.org/2000/svg";
const DASHES = { Dashed: "7 4", Dotted: "2 3" };
const WIDTHS = { Thin: 1, DottedLine: 1.5, Dotted: 1.2 };
const MOST_LABELS = 60;
/** A mark or a point is meant by the pointer within this number of pixels. */
const REACH = 14;
/** Half the length of an arrow, and of the cap of a bar, in pixels. */
const ARROW = 7;
const CAP = 5;
const MARGIN = { left: 66, right: 16, top: 16, bottom: 46 };

const polygon = (count, turn = 0, r = 5.5) => Array.from({ length: count }, (_, k) => {
  const angle = (2 * Math.PI * k) / count - Math.PI / 2 + turn;
  return `${(r * Math.cos(angle)).toFixed(2)} ${(r * Math.sin(angle)).toFixed(2)}`;
}).join("L");
const circle = r => `M${-r} 0A${r} ${r} 0 1 0 ${r} 0A${r} ${r} 0 1 0 ${-r} 0Z`;
const star = () => Array.from({ length: 10 }, (_, k) => {
  const [angle, r] = [(Math.PI * k) / 5 - Math.PI / 2, k % 2 ? 2.8 : 6.5];
  return `${(r * Math.cos(angle)).toFixed(2)} ${(r * Math.sin(angle)).toFixed(2)}`;
}).join("L");
// The shape of each symbol, its colour, and whether it is filled.
const SYMBOLS = {
  Disc: [circle(4.5), "#d53c00", true], Ring: [circle(3.5), "#222", false], Square: ["M-4 -4H4V4H-4Z", "#222", true],
  Diamond: [`M${polygon(4)}Z`, "#00488c", true], Star: [`M${star()}Z`, "#c88c00", true], Triangle: [`M${polygon(3)}Z`, "#007855", true],
  TriangleDown: [`M${polygon(3, Math.PI)}Z`, "#222", false], Pentagon: [`M${polygon(5)}Z`, "#78288c", true],
  Hexagon: [`M${polygon(6)}Z`, "#784b28", true], TriangleLeft: [`M${polygon(3, -Math.PI / 2)}Z`, "#e66e00", true],
  Cross: ["M-4 -4L4 4M-4 4L4 -4", "#222", false], Doubtful: [circle(4.5), "#8c8c8c", false], Number: ["", "#222", false],
};

const make = (tag, attributes = {}, text) => {
  const element = document.createElementNS(SVG, tag);
  Object.entries(attributes).forEach(([name, value]) => element.setAttribute(name, value));
  if (text !== undefined) element.textContent = text;
  return element;
};

const SUPERSCRIPTS = { "-": "⁻", 0: "⁰", 1: "¹", 2: "²", 3: "³", 4: "⁴", 5: "⁵", 6: "⁶", 7: "⁷", 8: "⁸", 9: "⁹" };
const power = exponent => `10${[...String(exponent)].map(letter => SUPERSCRIPTS[letter]).join("")}`;

/** Formats a number for readers. */
export const format = (value, digits = 6) => {
  const text = String(Number(value.toPrecision(digits)));
  const [mantissa, exponent] = text.split("e");
  const scaled = exponent === undefined ? mantissa : `${mantissa} · ${power(Number(exponent))}`;
  return scaled.replaceAll("-", "−");
};

/** Ticks at multiples of 1, 2 or 5 times a power of ten. */
const ticksBetween = ([low, high], count) => {
  const rough = (high - low) / Math.max(1, count);
  const unit = 10 ** Math.floor(Math.log10(rough));
  const step = unit * [1, 2, 5, 10].find(factor => factor * unit >= rough * 0.999);
  const first = Math.ceil(low / step - 1e-9);
  const values = [];
  for (let k = first; k * step <= high + 1e-9 * step; k += 1) values.push(k * step);
  // One tick shows no scale.
  if (values.length < 2 && count < 16) return ticksBetween([low, high], 2 * count);
  return [values, step];
};

/** A scale from values to pixels. */
class Scale {
  constructor([low, high], [from, to], logarithmic) {
    this.logarithmic = logarithmic;
    this.range = [low, high];
    this.pixels = [from, to];
    [this.a, this.b] = logarithmic ? [Math.log10(low), Math.log10(high)] : [low, high];
  }
  to(value) {
    const at = this.logarithmic ? Math.log10(value) : value;
    return this.pixels[0] + ((at - this.a) / (this.b - this.a)) * (this.pixels[1] - this.pixels[0]);
  }
  from(pixel) {
    const at = this.a + ((pixel - this.pixels[0]) / (this.pixels[1] - this.pixels[0])) * (this.b - this.a);
    return this.logarithmic ? 10 ** at : at;
  }
  ticks(count) {
    if (this.logarithmic) {
      const [first, last] = [Math.ceil(this.a - 1e-9), Math.floor(this.b + 1e-9)];
      if (last > first) {
        const every = Math.max(1, Math.ceil((last - first + 1) / count));
        const powers = Array.from({ length: last - first + 1 }, (_, k) => first + k).filter(k => (k - first) % every === 0);
        return powers.map(k => [10 ** k, power(k).replaceAll("-", "−")]);
      }
      return ticksBetween(this.range, count)[0].filter(value => value > 0).map(value => [value, format(value)]);
    }
    const [values, step] = ticksBetween(this.range, count);
    const size = Math.max(...values.map(Math.abs), step);
    const exponent = Math.floor(Math.log10(size) + 1e-9);
    if (exponent >= 6 || exponent < -4) {
      const digits = Math.max(0, exponent - Math.floor(Math.log10(step) + 1e-9));
      return values.map(value => [value, value === 0 ? "0" : `${(value / 10 ** exponent).toFixed(digits)} · ${power(exponent)}`.replaceAll("-", "−")]);
    }
    const digits = Math.max(0, -Math.floor(Math.log10(step) + 1e-9));
    return values.map(value => [value, (Math.abs(value) < step / 1e6 ? 0 : value).toFixed(digits).replaceAll("-", "−")]);
  }
}

/** The range of all points on an axis, with a margin, or the given range of the panel. */
const extentOf = (panel, axis, logarithmic, specks) => {
  if (panel.extent) return panel.extent[axis];
  const shown = panel.marks.filter(mark => mark.symbol !== "Doubtful").map(mark => mark.at[axis]);
  const bars = (panel.bars ?? []).flatMap(bar => (axis ? [bar.low, bar.high] : [bar.at]));
  const [least, most] = [[...panel.curves, ...specks].flatMap(curve => curve.points.map(point => point[axis])), shown, bars]
    .flat().filter(value => !logarithmic || value > 0).reduce(([low, high], value) => [Math.min(low, value), Math.max(high, value)], [Infinity, -Infinity]);
  if (least > most) return [0, 1];
  if (logarithmic) return least === most ? [least / 2, most * 2] : [least / (most / least) ** 0.04, most * (most / least) ** 0.04];
  // Values that differ by rounding are equal.
  const size = Math.max(Math.abs(least), Math.abs(most));
  const margin = most - least > 1e-9 * size ? 0.04 * (most - least) : size * 0.1 || 1;
  return [least - margin, most + margin];
};

const same = (a, b) => Boolean(a && b) && a.length === b.length && a.every((part, k) => part === b[k]);

export class Plot {
  #panel = null;
  #scales = null;
  #ranges = null;
  #key = "";
  #zoom = null;
  #selected = null;
  #old = null;
  #specks = [];
  /** Called after the plot is drawn. */
  drawn = null;

  /**
   * A plot in an element. `options.select(place)` and `options.tip(text, event)` answer the pointer,
   * `options.click(values, event)` a click beside marks and points that can be selected, and
   * `options.zoomed()` a change of the visible ranges.
   */
  constructor(element, options) {
    this.element = element;
    this.options = options;
    this.svg = make("svg", { role: "img" });
    element.append(this.svg);
    new ResizeObserver(() => this.#draw()).observe(element);
    this.#listen();
  }

  /** Shows a panel. With `steady`, axes keep their ranges as long as these suit the curves. */
  show(panel, { colours, steady = false, partial = false } = {}) {
    if (partial && this.#panel && !this.#old) this.#old = this.#panel;
    if (!partial) this.#old = null;
    const key = JSON.stringify([panel.labels, panel.logarithmic, panel.extent]);
    if (key !== this.#key) [this.#key, this.#zoom, this.#ranges, this.#old] = [key, null, null, null];
    this.#panel = panel;
    this.colours = colours;
    this.#ranges = [0, 1].map(axis => this.#rangeOf(axis, steady || partial));
    this.#draw();
  }

  /** The visible ranges of the axes. */
  get ranges() { return this.#zoom ?? this.#ranges; }

  /** Draws the points of sweeps under the curves: `groups` with a name, a colour and points. */
  specks(groups) {
    if (!groups.length && !this.#specks.length) return;
    this.#specks = groups;
    if (!this.#panel) return;
    this.#ranges = [0, 1].map(axis => this.#rangeOf(axis, true));
    this.#draw();
  }

  /** The place of a point in pixels; `null` outside the axes. */
  toPixels(point) {
    if (!this.#scales) return null;
    const at = point.map((value, axis) => this.#scales[axis].to(value));
    const [x, y] = this.#scales.map(({ pixels }) => pixels);
    return at[0] >= x[0] - 1 && at[0] <= x[1] + 1 && at[1] <= y[0] + 1 && at[1] >= y[1] - 1 ? at : null;
  }

  /** The point at a place in pixels, or the nearest point within the axes. */
  fromPixels(at) {
    return at.map((pixel, axis) => {
      const { pixels: [a, b] } = this.#scales[axis];
      return this.#scales[axis].from(Math.min(Math.max(pixel, Math.min(a, b)), Math.max(a, b)));
    });
  }

  /** The place of a point as shares of both axes, and the point at such a place. */
  toShare(point) {
    return this.#scales.map((scale, axis) => (scale.to(point[axis]) - scale.pixels[0]) / (scale.pixels[1] - scale.pixels[0]));
  }
  fromShare(share) {
    return this.fromPixels(this.#scales.map(({ pixels: [a, b] }, axis) => a + share[axis] * (b - a)));
  }

  /** Draws a ring around a place. */
  select(place) {
    this.#selected = place;
    this.#ring();
  }

  #rangeOf(axis, steady) {
    const next = extentOf(this.#panel, axis, this.#panel.logarithmic[axis], this.#specks);
    const last = this.#ranges?.[axis];
    if (!steady || !last) return next;
    const fits = last[0] <= next[0] + 0.04 * (last[1] - last[0]) && last[1] >= next[1] - 0.04 * (last[1] - last[0]);
    const fills = next[1] - next[0] > 0.45 * (last[1] - last[0]);
    return fits && (fills || this.#old) ? last : [Math.min(next[0], this.#old ? last[0] : next[0]), Math.max(next[1], this.#old ? last[1] : next[1])];
  }

  #draw() {
    const [width, height] = [this.element.clientWidth, this.element.clientHeight];
    if (!this.#panel || width < 50 || height < 50) return;
    const panel = this.#panel;
    const [x, y] = this.#zoom ?? this.#ranges;
    this.#scales = [
      new Scale(x, [MARGIN.left, width - MARGIN.right], panel.logarithmic[0]),
      new Scale(y, [height - MARGIN.bottom, MARGIN.top], panel.logarithmic[1]),
    ];
    this.svg.setAttribute("viewBox", `0 0 ${width} ${height}`);
    this.svg.setAttribute("aria-label", `${panel.labels[1]} over ${panel.labels[0]}`);
    const clip = make("clipPath", { id: `inside-${this.options.id}` });
    const box = { x: MARGIN.left, y: MARGIN.top, width: width - MARGIN.left - MARGIN.right, height: height - MARGIN.top - MARGIN.bottom };
    clip.append(make("rect", box));
    const inside = make("g", { "clip-path": `url(#inside-${this.options.id})` });
    if (this.#old) {
      const old = make("g", { class: "old" });
      this.#curves(this.#old, old);
      inside.append(old);
    }
    this.#spots(inside);
    this.#walls(panel, inside, box);
    this.#arrows(panel.arrows ?? [], inside);
    this.#curves(panel, inside);
    this.#bars(panel.bars ?? [], inside);
    this.rings = make("g");
    this.svg.replaceChildren(clip, ...this.#axes(panel, box), inside, make("rect", { ...box, class: "frame" }), this.#marks(panel, box), this.rings);
    this.#ring();
    this.drawn?.();
  }

  /** The points of sweeps, of which one is drawn at each place. */
  #spots(group) {
    const [x, y] = this.#scales;
    this.#specks.forEach(({ name, colour, points }) => {
      const places = new Set(points.map(([a, b]) => [x.to(a), y.to(b)].map(pixel => Math.round(pixel * 2) / 2)).filter(at => at.every(Number.isFinite)).map(at => at.join(" ")));
      const d = [...places].map(place => `M${place}h0`).join("");
      group.append(make("path", { class: "specks", d, stroke: colour, "data-name": name, "data-count": points.length }));
    });
  }

  #axes(panel, box) {
    const [x, y] = this.#scales;
    const all = [];
    x.ticks(Math.max(2, Math.floor(box.width / 90))).forEach(([value, text]) => {
      const at = x.to(value);
      all.push(make("line", { class: "grid", x1: at, x2: at, y1: box.y, y2: box.y + box.height }));
      all.push(make("line", { class: "axis", x1: at, x2: at, y1: box.y + box.height, y2: box.y + box.height + 5 }));
      all.push(make("text", { class: "tick", x: at, y: box.y + box.height + 18, "text-anchor": "middle" }, text));
    });
    y.ticks(Math.max(2, Math.floor(box.height / 55))).forEach(([value, text]) => {
      const at = y.to(value);
      all.push(make("line", { class: "grid", x1: box.x, x2: box.x + box.width, y1: at, y2: at }));
      all.push(make("line", { class: "axis", x1: box.x - 5, x2: box.x, y1: at, y2: at }));
      all.push(make("text", { class: "tick", x: box.x - 8, y: at + 4, "text-anchor": "end" }, text));
    });
    all.push(make("text", { x: box.x + box.width / 2, y: box.y + box.height + 38, "text-anchor": "middle" }, panel.labels[0]));
    const turned = `rotate(-90) translate(${-(box.y + box.height / 2)} 14)`;
    all.push(make("text", { transform: turned, "text-anchor": "middle" }, panel.labels[1]));
    return all;
  }

  #curves(panel, group) {
    const [x, y] = this.#scales;
    panel.curves.forEach(curve => {
      const colour = this.colours[Math.max(0, panel.names.indexOf(curve.name)) % this.colours.length];
      const at = curve.points.map(([a, b]) => [x.to(a), y.to(b)]);
      const dots = () => at.forEach(([a, b]) => group.append(make("circle", { cx: a, cy: b, r: curve.style === "Blots" ? 4 : 2, fill: colour })));
      if (["Dots", "Specks", "Blots"].includes(curve.style)) return dots();
      const path = at.map(([a, b], k) => `${k ? "L" : "M"}${a.toFixed(1)} ${b.toFixed(1)}`).join("");
      const attributes = { d: path, fill: "none", stroke: colour, "stroke-width": WIDTHS[curve.style] ?? 2, "stroke-linejoin": "round", "data-name": curve.name };
      if (DASHES[curve.style]) attributes["stroke-dasharray"] = DASHES[curve.style];
      group.append(make("path", attributes));
      if (curve.style === "DottedLine") dots();
    });
    panel.beside.filter(part => part.points.length > 1).forEach(part => {
      const k = Math.max(1, Math.floor(part.points.length / 2));
      const [[a, b], [c, d]] = [part.points[k - 1], part.points[k]].map(([p, q]) => [x.to(p), y.to(q)]);
      const length = Math.hypot(c - a, d - b) || 1;
      part.sides.forEach((text, side) => {
        const reach = side === 0 ? 14 : -14;
        const place = { x: c + (reach * (d - b)) / length, y: d - (reach * (c - a)) / length + 4 };
        group.append(make("text", { class: "beside", "text-anchor": "middle", ...place }, text));
      });
    });
  }

  #walls(panel, group, box) {
    panel.walls.forEach(([axis, at]) => {
      const place = this.#scales[axis].to(at);
      const line = axis === 0 ? { x1: place, x2: place, y1: box.y, y2: box.y + box.height } : { y1: place, y2: place, x1: box.x, x2: box.x + box.width };
      group.append(make("line", { ...line, stroke: "#555", "stroke-width": 2 }));
    });
  }

  /** Arrows of equal length in the given directions, around their places. */
  #arrows(arrows, group) {
    const [x, y] = this.#scales;
    const path = arrows.map(([place, direction]) => {
      const at = [x.to(place[0]), y.to(place[1])];
      const along = [x, y].map((scale, axis) => direction[axis] * (scale.pixels[1] - scale.pixels[0]));
      const [u, v] = along.map(part => (ARROW * part) / Math.hypot(...along));
      const [[a, b], [c, d]] = [[at[0] - u, at[1] - v], [at[0] + u, at[1] + v]];
      const head = [-1, 1].map(side => `${(c - 0.6 * u + 0.4 * side * v).toFixed(1)} ${(d - 0.6 * v - 0.4 * side * u).toFixed(1)}`);
      return `M${a.toFixed(1)} ${b.toFixed(1)}L${c.toFixed(1)} ${d.toFixed(1)}M${head[0]}L${c.toFixed(1)} ${d.toFixed(1)}L${head[1]}`;
    }).join("");
    if (path) group.append(make("path", { d: path, class: "arrows" }));
  }

  /** Vertical bars with a cap at each end. */
  #bars(bars, group) {
    const [x, y] = this.#scales;
    bars.forEach(({ number, at, low, high, title }) => {
      const [place, ends] = [x.to(at), [y.to(low), y.to(high)]];
      const caps = ends.map(end => `M${place - CAP} ${end}H${place + CAP}`).join("");
      const bar = make("path", { d: `M${place} ${ends[0]}V${ends[1]}${caps}`, class: "bar", "data-number": number, "data-at": at, "data-low": low, "data-high": high });
      bar.append(make("title", {}, title));
      group.append(bar);
    });
  }

  #inside(at, box) {
    return at[0] >= box.x - 1 && at[0] <= box.x + box.width + 1 && at[1] >= box.y - 1 && at[1] <= box.y + box.height + 1;
  }

  #marks(panel, box) {
    const group = make("g");
    const shown = panel.marks.map(mark => ({ mark, at: mark.at.map((value, axis) => this.#scales[axis].to(value)) })).filter(({ at }) => this.#inside(at, box));
    const taken = shown.map(({ at: [x, y] }) => [x - 6, y - 6, x + 6, y + 6]);
    const vertices = panel.curves.flatMap(curve => curve.points.map(([a, b]) => [this.#scales[0].to(a), this.#scales[1].to(b)]));
    shown.forEach(({ mark, at: [x, y] }) => {
      const [path, colour, filled] = SYMBOLS[mark.symbol] ?? SYMBOLS.Cross;
      const symbol = make("path", {
        d: path || circle(5), transform: `translate(${x} ${y})`, class: "symbol", fill: path === "" ? "transparent" : filled ? colour : "#fff",
        stroke: path === "" ? "transparent" : filled ? "#fff" : colour, "stroke-width": filled ? 1 : 1.6, "data-label": mark.label,
      });
      symbol.append(make("title", {}, [mark.label, mark.meaning].filter(Boolean).join(": ")));
      group.append(symbol);
      if (shown.length <= MOST_LABELS && mark.label) group.append(this.#label(mark.label, [x, y], taken, vertices, box));
    });
    return group;
  }

  /** A label beside a mark, where it covers the least. */
  #label(text, [x, y], taken, vertices, box) {
    const [width, height] = [text.length * 6.6 + 2, 13];
    const places = [[0, -9, "middle"], [9, -5, "start"], [9, 13, "start"], [-9, -5, "end"], [-9, 13, "end"], [0, 19, "middle"]];
    const boxed = ([dx, dy, anchor]) => {
      const left = x + dx - (anchor === "middle" ? width / 2 : anchor === "end" ? width : 0);
      return [left, y + dy - height + 2, left + width, y + dy + 2];
    };
    const overlaps = ([a, b, c, d]) => ([e, f, g, h]) => a < g && e < c && b < h && f < d;
    const cost = place => {
      const own = boxed(place);
      const outside = own[0] < box.x || own[2] > box.x + box.width || own[1] < box.y ? 50 : 0;
      const near = vertices.filter(([a, b]) => a > own[0] && a < own[2] && b > own[1] && b < own[3]).length;
      return outside + 20 * Math.max(0, taken.filter(overlaps(own)).length) + Math.min(near, 10);
    };
    const costs = places.map(cost);
    const best = places[costs.indexOf(Math.min(...costs))];
    taken.push(boxed(best));
    return make("text", { class: "mark", x: x + best[0], y: y + best[1], "text-anchor": best[2] }, text);
  }

  /** Where a place is in the plot, in pixels. */
  find(place) {
    const panel = this.#panel;
    const marks = panel.marks.filter(mark => same(mark.from, place)).map(mark => mark.at);
    const points = marks.length ? marks : panel.curves.flatMap(curve => {
      const k = curve.from.findIndex(from => same(from, place));
      return k < 0 ? [] : [curve.points[k]];
    });
    return points.map(([a, b]) => [this.#scales[0].to(a), this.#scales[1].to(b)]);
  }

  #ring(meant = null) {
    if (!this.rings || !this.#panel) return;
    const all = this.#selected ? this.find(this.#selected).map(([cx, cy]) => make("circle", { class: "ring", cx, cy, r: 9 })) : [];
    if (meant) all.push(make("circle", { class: "meant", cx: meant[0], cy: meant[1], r: 8 }));
    this.rings.replaceChildren(...all);
  }

  /** The mark or point nearest to the pointer. */
  #meant(event) {
    if (!this.#panel || !this.#scales) return null;
    const box = this.svg.getBoundingClientRect();
    const [x, y] = [event.clientX - box.left, event.clientY - box.top];
    let [best, least] = [null, REACH];
    const consider = (point, from, name, label, bonus) => {
      const at = [this.#scales[0].to(point[0]), this.#scales[1].to(point[1])];
      const distance = Math.hypot(at[0] - x, at[1] - y) - bonus;
      if (distance < least) [best, least] = [{ at, point, from, name, label }, distance];
    };
    this.#panel.curves.forEach(curve => curve.points.forEach((point, k) => consider(point, curve.from[k], curve.name, "", 0)));
    this.#panel.marks.forEach(mark => consider(mark.at, mark.from, mark.meaning, mark.label, 6));
    this.#specks.forEach(({ name, points }) => points.forEach(point => consider(point, null, `sweep ${name}`, "", -6)));
    return best;
  }

  #listen() {
    let [press, dragged] = [null, false];
    const at = event => {
      const box = this.svg.getBoundingClientRect();
      return [event.clientX - box.left, event.clientY - box.top];
    };
    this.svg.addEventListener("pointerdown", event => {
      if (event.button !== 0 || event.pointerType === "touch") return;
      [press, dragged] = [{ from: at(event), box: make("rect", { class: "box" }) }, false];
      this.svg.setPointerCapture(event.pointerId);
    });
    this.svg.addEventListener("pointermove", event => {
      if (press) {
        const [[a, b], [c, d]] = [press.from, at(event)];
        Object.entries({ x: Math.min(a, c), y: Math.min(b, d), width: Math.abs(c - a), height: Math.abs(d - b) }).forEach(([name, value]) => press.box.setAttribute(name, value));
        if (Math.abs(c - a) > 6 || Math.abs(d - b) > 6) this.svg.append(press.box);
        return;
      }
      const meant = this.#meant(event);
      this.#ring(meant?.at);
      const texts = meant && [meant.label || meant.name, ...this.#panel.labels.map((label, axis) => `${label} = ${format(meant.point[axis], 8)}`)];
      this.options.tip?.(texts ? texts.filter(Boolean).join("\n") : null, event);
    });
    this.svg.addEventListener("pointerleave", event => {
      this.#ring();
      this.options.tip?.(null, event);
    });
    this.svg.addEventListener("pointerup", event => {
      if (!press) return;
      const [[a, b], [c, d]] = [press.from, at(event)];
      press.box.remove();
      press = null;
      dragged = Math.abs(c - a) > 6 || Math.abs(d - b) > 6;
      if (Math.abs(c - a) > 12 && Math.abs(d - b) > 12 && this.#scales) {
        const [x, y] = this.#scales;
        this.#zoom = [[x.from(Math.min(a, c)), x.from(Math.max(a, c))], [y.from(Math.max(b, d)), y.from(Math.min(b, d))]];
        this.#draw();
        this.options.zoomed?.();
      }
    });
    this.svg.addEventListener("click", event => {
      const meant = this.#meant(event);
      if (meant?.from?.length === 3) {
        this.options.select?.(meant.from);
        return;
      }
      if (!this.#scales || dragged) return;
      const values = at(event).map((pixel, axis) => this.#scales[axis].from(pixel));
      const inside = values.every((value, axis) => value >= this.ranges[axis][0] && value <= this.ranges[axis][1]);
      if (inside) this.options.click?.(values, event);
    });
    this.svg.addEventListener("dblclick", () => {
      this.#zoom = null;
      this.#draw();
      this.options.zoomed?.();
    });
  }
}
