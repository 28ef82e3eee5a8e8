"use strict";
// Everything on the page, from the data in it. A place is [document, branch, n]: the point n of the
// branch, or for n < 0 the special point with the label -n.
(() => {
  const data = JSON.parse(document.getElementById("data").textContent);
  const DIGITS = 12, MOST_LABELS = 60, MOST_ROWS = 20;
  // A mark is meant by the pointer within this number of pixels, whatever else is near.
  const REACH = 7;
  const DASHES = { Dashed: "dash", Dotted: "dot" };
  const WIDTHS = { Thin: 1, DottedLine: 1.5, Dotted: 1.2 };
  const SYMBOLS = {
    Disc: ["circle", "#d53c00"], Ring: ["circle-open", "#222"], Square: ["square", "#222"],
    Diamond: ["diamond", "#00488c"], Star: ["star", "#c88c00"], Triangle: ["triangle-up", "#007855"],
    TriangleDown: ["triangle-down-open", "#222"], Pentagon: ["pentagon", "#78288c"],
    Hexagon: ["hexagon", "#784b28"], TriangleLeft: ["triangle-left", "#e66e00"], Cross: ["x", "#222"],
    Plus: ["cross", "#222"], FourStar: ["star-diamond", "#a0003c"], SixStar: ["hexagram", "#6e6e00"],
    OpenStar: ["star-open", "#c88c00"], OpenTriangle: ["triangle-up-open", "#007855"],
    TriangleRight: ["triangle-right", "#2896d2"], OpenDiamond: ["diamond-open", "#00488c"],
    OpenSquare: ["square-open", "#222"], OpenPentagon: ["pentagon-open", "#78288c"],
    OpenHexagon: ["hexagon-open", "#784b28"],
    Doubtful: ["circle-open", "#8c8c8c"], Number: ["circle", "#222"],
  };
  const SPOTS = { Specks: 3, Blots: 5 };
  const isSpots = curve => curve.style in SPOTS;
  const hidden = { curves: new Set(), marks: new Set() };
  let selected = [];

  // Elements and numbers.
  const $ = (selector, from = document) => from.querySelector(selector);
  const add = (parent, tag, text, properties = {}) => {
    const element = Object.assign(document.createElement(tag), properties);
    if (text !== undefined) element.textContent = text;
    parent.append(element);
    return element;
  };
  const number = value => (value === null || value === undefined ? "" : String(Number(value.toPrecision(DIGITS))));
  const short = value => String(Number(value.toPrecision(2)));
  // Plotly takes some tags of HTML in its texts.
  const plain = text => text.replaceAll("&", "&amp;").replaceAll("<", "&lt;");
  const colour = (names, name) => data.colours[Math.max(0, names.indexOf(name)) % data.colours.length];

  // The data of a place.
  const branchAt = place => data.documents[place[0]].branches[place[1]];
  const specialAt = place => branchAt(place).special.find(point => point.label === -place[2]);
  const valueAt = (place, column) =>
    place[2] < 0 ? specialAt(place).values[column] : branchAt(place).values[column][place[2]];
  const same = (a, b) => a && b && a.length === b.length && a.every((part, k) => part === b[k]);
  const nameOf = place => {
    const [document, branch] = [data.documents[place[0]], branchAt(place)];
    const name = data.documents.length > 1 ? `${document.name}: ${branch.name}` : branch.name;
    if (place[2] >= 0) return `${name}, point ${place[2]}`;
    const { kind, meaning, label, converged } = specialAt(place);
    return `${name}: ${kind} ${label}, ${meaning}${converged ? "" : " (not converged)"}`;
  };

  // All values of a place, as rows of a name and a text.
  const rowsOf = place => {
    const branch = branchAt(place);
    const special = place[2] < 0 ? specialAt(place) : null;
    const order = branch.columns.map((_, column) => column);
    const released = column => branch.released.includes(branch.columns[column]);
    order.sort((a, b) => released(b) - released(a));
    const rows = order.map(column => {
      const name = branch.columns[column];
      const error = special && name === branch.released[0] ? ` ± ${short(special.error)}` : "";
      return [name, number(valueAt(place, column)) + error];
    });
    const unstable = special ? special.unstable : branch.unstable[place[2]];
    if (unstable !== null && unstable !== undefined) rows.push(["unstable directions", String(unstable)]);
    if (!special && !branch.admissible[place[2]]) rows.push(["virtual", "beyond a grazing"]);
    if (special) {
      special.numbers.forEach(({ name, value, error }) =>
        rows.push([name, `${number(value)} ± ${short(error)}`]));
      special.eigenvalues.forEach(([real, imaginary], k) => {
        const i = imaginary === 0 ? "" : ` ${imaginary < 0 ? "−" : "+"} ${number(Math.abs(imaginary))} i`;
        rows.push([`eigenvalue or multiplier ${k + 1}`, number(real) + i]);
      });
      special.sensitivities.forEach(({ by, slopes }) => slopes.forEach((slope, k) =>
        rows.push([`d${branch.released[k]}/d${by}`, number(slope)])));
    }
    return rows;
  };

  // A panel: its figure, or all branches in other columns.
  const panels = data.panels.map((figure, index) => ({ figure, index, axes: [null, null], curves: [], marks: [] }));
  const isDiagram = figure => figure.curves.some(curve => curve.from.length && curve.from[0].length === 3);
  const columnsFor = (branch, name) => branch.shows[name] ?? [];

  // All curves of diagrams have their colours by the order of these names.
  const names = [...new Set([...data.panels.filter(isDiagram).flatMap(figure => figure.names), ...data.spine.names])];

  // The curves and marks of a panel in its present axes.
  const fill = panel => {
    const [x, y] = panel.axes;
    if (x === null) {
      panel.curves = panel.figure.curves.map(curve => ({ ...curve, x: curve.points.map(p => p[0]), y: curve.points.map(p => p[1]) }));
      panel.marks = panel.figure.marks.map(mark => ({ ...mark, x: mark.at[0], y: mark.at[1] }));
      panel.names = isDiagram(panel.figure) ? names : panel.figure.names;
      return;
    }
    const pairs = place => {
      const branch = branchAt(place);
      return columnsFor(branch, x).slice(0, 1).flatMap(a => columnsFor(branch, y).map(b => [a, b]));
    };
    panel.names = names;
    panel.curves = data.spine.curves.flatMap(curve => pairs(curve.from[0]).map(([a, b]) => ({
      ...curve, x: curve.from.map(place => valueAt(place, a)), y: curve.from.map(place => valueAt(place, b)),
    })));
    panel.marks = data.spine.marks.flatMap(mark => pairs(mark.from).map(([a, b]) => ({
      ...mark, x: valueAt(mark.from, a), y: valueAt(mark.from, b),
    })));
  };

  const isShown = (set, name) => !set.has(name);
  const curvesShown = panel => panel.curves.filter(curve => !isDiagram(panel.figure) || isShown(hidden.curves, curve.name));

  // The pixel of a value on an axis.
  const at = (axis, value) => axis.c2p(value);

  // The dots of a sweep are too many for elements: they are painted as images, anew for each view.
  const cornersOf = (panel, curve, first) => {
    const reduce = (values, of) => values.reduce((a, b) => of(a, b), values[0]);
    const ends = values => [reduce(values, Math.min), reduce(values, Math.max)];
    const corners = {
      x: ends(curve.x), y: ends(curve.y), name: plain(curve.name), mode: "markers", opacity: 0, hoverinfo: "skip", showlegend: false,
    };
    const key = { ...corners, x: [null], y: [null], opacity: 1, marker: { color: colour(panel.names, curve.name), size: 5 } };
    return first && !isDiagram(panel.figure) ? [corners, { ...key, showlegend: true }] : [corners];
  };
  const paint = panel => {
    // Small spots are painted last.
    const spots = ["Blots", "Specks"].flatMap(style => curvesShown(panel).filter(curve => curve.style === style));
    const images = spots.length ? [{ ...painted(panel, spots), layer: "above" }] : [];
    if (images.length || (panel.plot.layout.images ?? []).length) Plotly.relayout(panel.plot, { images });
  };
  const painted = (panel, spots) => {
    const { xaxis, yaxis, _size } = panel.plot._fullLayout;
    const canvas = Object.assign(document.createElement("canvas"), { width: 2 * _size.w, height: 2 * _size.h });
    const context = canvas.getContext("2d");
    spots.forEach(curve => {
      const size = SPOTS[curve.style];
      context.fillStyle = colour(panel.names, curve.name);
      curve.x.forEach((x, k) => context.fillRect(2 * at(xaxis, x) - size / 2, 2 * at(yaxis, curve.y[k]) - size / 2, size, size));
    });
    const [[left, right], [bottom, top]] = [xaxis.range, yaxis.range];
    return {
      source: canvas.toDataURL(), xref: "x", yref: "y", x: left, y: top, sizex: right - left, sizey: top - bottom, sizing: "stretch",
    };
  };
  const traces = panel => {
    const diagram = isDiagram(panel.figure);
    const curves = curvesShown(panel);
    const lines = curves.flatMap((curve, k) => {
      const first = curves.findIndex(it => it.name === curve.name) === k;
      if (isSpots(curve)) return cornersOf(panel, curve, first);
      const shade = colour(panel.names, curve.name);
      const dots = curve.style === "Dots";
      return {
        x: curve.x, y: curve.y, customdata: curve.from.length ? curve.from : undefined, name: plain(curve.name),
        mode: dots ? "markers" : curve.style === "DottedLine" ? "lines+markers" : "lines",
        line: { color: shade, width: WIDTHS[curve.style] ?? 2, dash: DASHES[curve.style] ?? "solid", shape: panel.axes[0] === null ? "linear" : "spline" },
        marker: { color: shade, size: 5 }, hoverinfo: "none",
        legendgroup: curve.name, showlegend: !diagram && first,
      };
    });
    const marks = panel.marks.filter(mark => !diagram || isShown(hidden.marks, mark.meaning));
    const symbols = [...new Set(marks.map(mark => mark.symbol))].map(symbol => {
      const all = marks.filter(mark => mark.symbol === symbol);
      const [shape, color] = SYMBOLS[symbol] ?? SYMBOLS.Cross;
      return {
        x: all.map(mark => mark.x), y: all.map(mark => mark.y), customdata: all.map(mark => mark.from),
        text: all.map(mark => plain(mark.label)), mode: marks.length <= MOST_LABELS ? "markers+text" : "markers",
        textposition: "top center", textfont: { size: 11 }, marker: { symbol: shape, color, size: 9, line: { width: 1.5, color: shape.endsWith("open") ? color : "#fff" } },
        hoverinfo: "none", showlegend: false, cliponaxis: false,
      };
    });
    // The last trace: rings around the selected points.
    const selection = {
      x: [], y: [], mode: "markers", marker: { symbol: "circle-open", size: 15, color: "#0072b2", line: { width: 2.5 } }, hoverinfo: "skip", showlegend: false,
    };
    return [...lines, ...symbols, selection];
  };

  const labelOf = name => data.documents.map(it => it.labels[name]).find(Boolean) ?? name;
  // The titles of both axes of a panel.
  const titlesOf = ({ figure, axes: [x, y] }) => (x === null ? figure.labels : [labelOf(x), labelOf(y)]);
  const layoutOf = panel => {
    const { figure, axes: [x, y] } = panel;
    const own = x === null;
    const titles = titlesOf(panel);
    const axis = title => ({ title: { text: plain(title) }, automargin: true, exponentformat: "power", zeroline: false, linecolor: "#888", mirror: true, showline: true });
    const layout = {
      margin: { l: 60, r: 14, t: 8, b: 48 }, hovermode: "closest", dragmode: "zoom", showlegend: !isDiagram(figure) && new Set(figure.curves.map(curve => curve.name)).size > 1,
      legend: { orientation: "h", y: -0.22 }, font: { size: 12, color: "#1d2125" },
      xaxis: axis(titles[0]), yaxis: axis(titles[1]),
      // A view stays while branches are switched off and on.
      uirevision: JSON.stringify(panel.axes),
    };
    if (own && figure.heights.length) {
      Object.assign(layout.yaxis, { tickvals: figure.heights.map((_, k) => k), ticktext: figure.heights.map(plain) });
    }
    const logarithmic = own ? figure.logarithmic : [x, y].map(name => data.logarithmic.includes(name));
    ["xaxis", "yaxis"].forEach((name, k) => { if (logarithmic[k]) layout[name].type = "log"; });
    if (own) {
      const shownEnd = k => end => (end === null || !logarithmic[k] ? end : Math.log10(end));
      ["xaxis", "yaxis"].forEach((name, k) => {
        if (figure.ends[k].some(end => end !== null)) layout[name].range = figure.ends[k].map(shownEnd(k));
      });
      const wall = ([k, place]) => (k === 0
        ? { type: "line", x0: place, x1: place, y0: 0, y1: 1, yref: "paper", line: { color: "#555", width: 2 } }
        : { type: "line", y0: place, y1: place, x0: 0, x1: 1, xref: "paper", line: { color: "#555", width: 2 } });
      const tiles = figure.tiles.map(tile => ({
        type: "rect", layer: "below", line: { width: 0 }, fillcolor: tile.colour,
        x0: tile.at[0] - tile.size[0] / 2, x1: tile.at[0] + tile.size[0] / 2, y0: tile.at[1] - tile.size[1] / 2, y1: tile.at[1] + tile.size[1] / 2,
      }));
      layout.shapes = [...tiles, ...figure.walls.map(wall)];
      if (figure.beside.length) layout.annotations = textsBeside(figure);
    }
    return layout;
  };

  // Texts on both sides of curves, at the middle of each part.
  const textsBeside = figure => {
    const shown = point => point.map((value, axis) => (figure.logarithmic[axis] ? Math.log10(value) : value));
    const all = figure.curves.flatMap(curve => curve.points.map(shown));
    const end = (axis, of) => all.reduce((most, point) => of(most, point[axis]), all[0][axis]);
    const size = [0, 1].map(axis => end(axis, Math.max) - end(axis, Math.min) || 1);
    const parts = figure.beside.filter(part => part.points.length > 1 && isShown(hidden.curves, part.curve));
    return parts.flatMap(({ points, sides }) => {
      const places = points.map(shown);
      const step = k => [0, 1].map(axis => (places[k][axis] - places[k - 1][axis]) / size[axis]);
      const way = places.map((_, k) => (k ? Math.hypot(...step(k)) : 0));
      way.forEach((part, k) => { if (k) way[k] = way[k - 1] + part; });
      const k = Math.max(1, way.findIndex(part => 2 * part >= way[way.length - 1]));
      const [at, [across, up]] = [places[k], step(k)];
      const length = Math.hypot(across, up) || 1;
      return sides.map((text, side) => {
        const reach = side === 0 ? 14 : -14;
        return {
          x: at[0], y: at[1], text: plain(text), showarrow: false, font: { size: 10, color: "#6e6e6e" },
          xshift: (-reach * up) / length, yshift: (reach * across) / length,
        };
      });
    });
  };

  // Where a place is in a panel: on a curve, or as a mark.
  const findIn = (panel, place) => {
    const found = [];
    panel.marks.forEach(mark => { if (same(mark.from, place)) found.push([mark.x, mark.y]); });
    if (!found.length) panel.curves.forEach(curve => {
      const k = curve.from.findIndex(from => same(from, place));
      if (k >= 0) found.push([curve.x[k], curve.y[k]]);
    });
    return found;
  };
  const ringSelected = panel => {
    const places = selected.flatMap(place => findIn(panel, place));
    Plotly.restyle(panel.plot, { x: [places.map(p => p[0])], y: [places.map(p => p[1])] }, [panel.plot.data.length - 1]);
  };
  // The ring at the pointer lies above the plot: Plotly repeats a hover after each change of a plot, so that a
  // hover that changes the plot may never end.
  const ringMeant = (panel, place) => {
    panel.plot.querySelectorAll(".ring").forEach(ring => ring.remove());
    if (!place) return;
    const { xaxis, yaxis, _size } = panel.plot._fullLayout;
    findIn(panel, place).map(([x, y]) => [at(xaxis, x), at(yaxis, y)]).forEach(([x, y]) => {
      if (x < 0 || x > _size.w || y < 0 || y > _size.h) return;
      const ring = add(panel.plot, "div", undefined, { className: "ring" });
      Object.assign(ring.style, { left: `${_size.l + x}px`, top: `${_size.t + y}px` });
    });
  };

  // The place that the pointer means: a mark nearby, or the nearest point.
  const meant = (panel, { points, event }) => {
    const { xaxis, yaxis, _size } = panel.plot._fullLayout;
    const box = panel.plot.getBoundingClientRect();
    const pointer = [event.clientX - box.left - _size.l, event.clientY - box.top - _size.t];
    const distance = mark => Math.hypot(at(xaxis, mark.x) - pointer[0], at(yaxis, mark.y) - pointer[1]);
    const marks = panel.marks.filter(mark => mark.from && isShown(hidden.marks, mark.meaning) && distance(mark) <= REACH);
    marks.sort((a, b) => distance(a) - distance(b));
    const place = marks.length ? marks[0].from : points[0].customdata;
    return Array.isArray(place) && place.length === 3 ? place : null;
  };

  const tip = $("#tip");
  const showTip = (place, event) => {
    tip.replaceChildren();
    add(tip, "strong", nameOf(place));
    const table = add(tip, "table");
    const rows = rowsOf(place);
    rows.slice(0, MOST_ROWS).forEach(([name, value]) => {
      const row = add(table, "tr");
      add(row, "td", name);
      add(row, "td", value);
    });
    if (rows.length > MOST_ROWS) add(tip, "div", `and ${rows.length - MOST_ROWS} more`);
    tip.hidden = false;
    const [width, height] = [tip.offsetWidth, tip.offsetHeight];
    tip.style.left = `${Math.max(4, Math.min(event.clientX + 16, innerWidth - width - 8))}px`;
    tip.style.top = `${Math.max(4, Math.min(event.clientY + 16, innerHeight - height - 8))}px`;
  };
  const hideTip = () => { tip.hidden = true; };

  const draw = panel => {
    fill(panel);
    Plotly.react(panel.plot, traces(panel), layoutOf(panel), {
      responsive: true, displaylogo: false, scrollZoom: true,
      toImageButtonOptions: { format: "svg", filename: fileName(panel) },
    });
    ringSelected(panel);
    ringMeant(panel, null);
    paint(panel);
  };
  const fileName = panel => `${(data.title || "tangency").replace(/[^\p{L}\p{N}]+/gu, "-")}-${panel.index + 1}`;

  // Files.
  const save = (name, type, text) => {
    const url = URL.createObjectURL(new Blob([text], { type }));
    const link = Object.assign(document.createElement("a"), { href: url, download: name });
    link.click();
    setTimeout(() => URL.revokeObjectURL(url), 1000);
  };
  const quoted = text => (/[",\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text);
  const csv = rows => rows.map(row => row.map(cell => (typeof cell === "string" ? quoted(cell) : cell ?? "")).join(",")).join("\n") + "\n";
  const csvOf = panel => csv([
    ["curve", "point", "label", ...titlesOf(panel)],
    ...curvesShown(panel).flatMap(curve => curve.x.flatMap((x, k) => {
      // Between two points of a branch a curve has further vertices, from the first of them.
      if (k && same(curve.from[k], curve.from[k - 1])) return [];
      const n = (curve.from[k] ?? [])[2];
      return [[curve.name, n >= 0 ? n : "", n < 0 ? -n : "", x, curve.y[k]]];
    })),
  ]);
  const allPoints = () => {
    const columns = [...new Set(data.documents.flatMap(it => it.branches.flatMap(branch => branch.columns)))];
    const rows = data.documents.flatMap(it => it.branches.flatMap(branch => branch.unstable.map((unstable, n) => [
      it.name, branch.name, n, ...columns.map(name => {
        const column = branch.columns.indexOf(name);
        return column < 0 ? "" : branch.values[column][n];
      }), unstable, branch.admissible[n],
    ])));
    return csv([["document", "branch", "point", ...columns, "unstable", "admissible"], ...rows]);
  };

  // Panels with their controls.
  const choices = [...new Set(data.documents.flatMap(it => it.branches.flatMap(branch => Object.keys(branch.shows))))];
  const selector = (parent, label, options, change) => {
    const field = add(add(parent, "label", label), "select");
    options.forEach(([value, text]) => add(field, "option", text, { value }));
    field.addEventListener("change", () => change(field.value));
    return field;
  };
  panels.forEach(panel => {
    const box = add($("#panels"), "section", undefined, { className: "panel" });
    if (panel.figure.title && panel.index > 0) add(box, "h2", panel.figure.title);
    const controls = add(box, "div", undefined, { className: "controls" });
    panel.plot = add(box, "div", undefined, { className: "plot" });
    if (panel.figure.beside.length) add(box, "div", data.regions, { className: "meaning" });
    new Map(panel.figure.tiles.map(tile => [tile.meaning, tile.colour])).forEach((shade, meaning) => {
      const entry = add(box, "div", undefined, { className: "meaning" });
      add(entry, "span", undefined, { className: "swatch" }).style.background = shade;
      add(entry, "span", meaning);
    });
    if (isDiagram(panel.figure)) {
      const options = [["", "as drawn"], ...choices.map(name => [name, name])];
      const change = () => {
        const chosen = fields.map(field => field.value);
        const first = data.spine.curves.length ? branchAt(data.spine.curves[0].from[0]) : null;
        // One axis alone: the other one shows the continued parameter, or the first other column.
        if (chosen.some(Boolean) && first) {
          if (!chosen[0]) fields[0].value = chosen[0] = first.released[0];
          if (!chosen[1]) fields[1].value = chosen[1] = first.columns.find(name => name !== chosen[0] && !first.released.includes(name)) ?? first.columns[0];
        }
        panel.axes = chosen.some(Boolean) ? chosen : [null, null];
        draw(panel);
      };
      const fields = ["horizontal", "vertical"].map(label => selector(controls, label, options, change));
    }
    const button = (text, action) => add(controls, "button", text).addEventListener("click", action);
    button("SVG", () => Plotly.downloadImage(panel.plot, { format: "svg", filename: fileName(panel), width: 900, height: 600 }));
    button("CSV", () => save(`${fileName(panel)}.csv`, "text/csv", csvOf(panel)));
  });
  // Only now is the width of each panel known.
  panels.forEach(panel => {
    draw(panel);
    panel.plot.on("plotly_hover", event => {
      const place = meant(panel, event);
      if (!place) return;
      showTip(place, event.event);
      panels.forEach(it => ringMeant(it, place));
    });
    panel.plot.on("plotly_relayout", change => {
      if (!Object.keys(change).some(key => key.includes("axis"))) return;
      ringMeant(panel, null);
      paint(panel);
    });
    panel.plot.on("plotly_unhover", () => {
      hideTip();
      panels.forEach(it => ringMeant(it, null));
    });
    panel.plot.on("plotly_click", event => {
      const place = meant(panel, event);
      if (place) select(place, event.event.shiftKey);
    });
  });

  // The solution at selected points.
  const solution = $("#solution");
  const view = { group: "", axes: ["", "", ""] };
  // Phase responses have units of their own, and are shown without the states.
  const RESPONSES = "phase responses";
  const isResponse = name => name.startsWith("phase_response_");
  const channelsOf = point => {
    const groups = new Map();
    point.profiles.forEach(profile => {
      if (!groups.has(profile.along)) groups.set(profile.along, new Map());
      const group = groups.get(profile.along);
      let name = profile.name;
      while (group.has(name)) name += "′";
      group.set(name, profile.points);
    });
    return groups;
  };
  // Values of several channels at their common times, some of which a mode may lack; a gap where time stands still: there the motion jumps.
  const joined = (group, along, names) => {
    const own = names.filter(name => name !== along).map(name => group.get(name));
    if (!own.length) own.push(group.values().next().value);
    if (own.some(points => !points)) return names.map(() => []);
    const known = own.map(points => {
      const values = new Map();
      points.forEach(([time, value]) => { if (values.has(time)) values.get(time).push(value); else values.set(time, [value]); });
      return values;
    });
    const shortest = own.reduce((a, b) => (b.length < a.length ? b : a));
    const rows = [], seen = new Map();
    shortest.forEach(([time], k) => {
      const n = seen.get(time) ?? 0;
      seen.set(time, n + 1);
      const values = known.map(it => (it.get(time) ?? [])[n]);
      if (values.includes(undefined)) return;
      if (k > 0 && shortest[k - 1][0] === time) rows.push(null);
      rows.push([time, ...values]);
    });
    let column = 0;
    return names.map(name => {
      const k = name === along ? 0 : ++column;
      return rows.map(row => row && row[k]);
    });
  };
  const solutionCurves = shown => {
    const [x, y, z] = view.axes;
    const names = [...channelsOf(specialAt(shown[0])).get(view.group).keys()];
    const vertical = y === RESPONSES ? names.filter(isResponse) : y ? [y] : z ? [names[0]] : names.filter(name => !isResponse(name));
    const curves = shown.flatMap(place => {
      const group = channelsOf(specialAt(place)).get(view.group);
      if (!group) return [];
      return vertical.map(name => {
        const text = [shown.length > 1 ? nameOf(place) : "", vertical.length > 1 ? name : ""].filter(Boolean).join(", ");
        const values = joined(group, view.group, z ? [x, name, z] : [x, name]);
        const curve = { x: values[0], y: values[1], mode: "lines", name: plain(text), type: z ? "scatter3d" : "scatter" };
        return z ? { ...curve, z: values[2] } : curve;
      });
    });
    curves.forEach((curve, k) => { curve.line = { color: data.colours[k % data.colours.length], width: z ? 4 : 2 }; });
    const titled = text => ({ title: { text: plain(text) }, exponentformat: "power" });
    const label = vertical.length === 1 ? labelOf(vertical[0]) : "";
    const layout = { margin: { l: 60, r: 14, t: 8, b: 48 }, showlegend: curves.length > 1, font: { size: 12 } };
    if (z) layout.scene = { xaxis: titled(labelOf(x)), yaxis: titled(label), zaxis: titled(labelOf(z)) };
    else Object.assign(layout, { xaxis: titled(labelOf(x)), yaxis: titled(label) });
    return [curves, layout];
  };
  const drawSolution = () => {
    const shown = selected.filter(place => place[2] < 0 && specialAt(place).profiles.length);
    const controls = $(".controls", solution);
    controls.replaceChildren();
    solution.hidden = !selected.length;
    if (!selected.length) return;
    $("h2", solution).textContent = selected.map(nameOf).join("; ");
    const table = $(".values", solution);
    table.replaceChildren();
    const last = selected[selected.length - 1];
    rowsOf(last).forEach(([name, value]) => {
      const row = add(table, "tr");
      add(row, "th", name);
      add(row, "td", value);
    });
    const plot = $(".plot", solution);
    plot.hidden = !shown.length;
    if (!shown.length) {
      add(controls, "span", last[2] < 0 ? "No profiles were saved with this point." : "Solutions are saved at special points: click one of them.");
      return;
    }
    const first = channelsOf(specialAt(shown[0]));
    const alongs = [...first.keys()];
    if (!first.has(view.group)) [view.group, view.axes] = [alongs.includes("time") ? "time" : alongs[0], ["", "", ""]];
    const names = [view.group, ...first.get(view.group).keys()];
    if (!names.includes(view.axes[0])) view.axes = [view.group, "", ""];
    if (alongs.length > 1) {
      selector(controls, "over", alongs.map(name => [name, name]), value => {
        [view.group, view.axes] = [value, ["", "", ""]];
        drawSolution();
      }).value = view.group;
    }
    const responses = names.some(isResponse) ? [[RESPONSES, RESPONSES]] : [];
    const entries = [names.map(name => [name, name]), [["", "all"], ...responses, ...names.slice(1).map(name => [name, name])], [["", "none"], ...names.slice(1).map(name => [name, name])]];
    ["horizontal", "vertical", "depth"].forEach((label, k) => {
      selector(controls, label, entries[k], value => {
        view.axes[k] = value;
        drawSolution();
      }).value = view.axes[k];
    });
    add(controls, "span", "Shift-click another special point to compare.");
    const [curves, layout] = solutionCurves(shown);
    Plotly.react(plot, curves, layout, { responsive: true, displaylogo: false });
  };

  const select = (place, too) => {
    const kept = too ? selected.filter(it => !same(it, place)) : [];
    selected = [...kept, place].slice(-6);
    panels.forEach(ringSelected);
    document.querySelectorAll("#table tbody tr").forEach(row => {
      row.setAttribute("aria-selected", String(selected.some(it => same(it, row.place))));
    });
    drawSolution();
  };

  // The side: branches and kinds of points, on and off.
  const toggles = (parent, names, set, key) => names.forEach(name => {
    const label = add(parent, "label");
    const box = add(label, "input", undefined, { type: "checkbox", checked: true });
    label.append(key(name));
    add(label, "span", name);
    box.addEventListener("change", () => {
      if (box.checked) set.delete(name); else set.add(name);
      panels.filter(panel => isDiagram(panel.figure)).forEach(draw);
    });
  });
  toggles($("#branches"), names, hidden.curves, name => {
    const key = Object.assign(document.createElement("span"), { className: "key" });
    key.style.borderColor = colour(names, name);
    return key;
  });
  const meanings = data.panels.flatMap(figure => figure.meanings);
  new Map(meanings).forEach((meaning, style) => {
    const look = { Dashed: "dashed", Dotted: "dotted", Thin: "thin", DottedLine: "dotted and joined", Dots: "dots" }[style] ?? "solid";
    add($("#branches"), "div", `${look}: ${meaning}`, { className: "meaning" });
  });
  const marks = new Map(data.spine.marks.map(mark => [mark.meaning, mark]));
  toggles($("#marks"), [...marks.keys()], hidden.marks, meaning => {
    const mark = marks.get(meaning);
    const kind = mark.symbol === "Doubtful" ? "?" : specialAt(mark.from).kind;
    return Object.assign(document.createElement("span"), { className: "symbol", textContent: kind });
  });
  $("#branches").hidden = !names.length;
  $("#marks").hidden = !marks.size;

  // The table of special points.
  const special = data.documents.flatMap((it, d) => it.branches.flatMap((branch, b) => branch.special.map(point => [d, b, -point.label])));
  const table = $("#table table");
  const head = add(add(table, "thead"), "tr");
  ["branch", "label", "kind", "continued parameter", "error", "unstable"].forEach(text => add(head, "th", text));
  const body = add(table, "tbody");
  special.forEach(place => {
    const [branch, point] = [branchAt(place), specialAt(place)];
    const row = add(body, "tr", undefined, { tabIndex: 0, place });
    const name = branch.released[0];
    const value = name === undefined ? "" : `${name} = ${number(point.values[branch.columns.indexOf(name)])}`;
    [data.documents.length > 1 ? `${data.documents[place[0]].name}: ${branch.name}` : branch.name, String(point.label),
      point.converged ? point.kind : `${point.kind}?`, value, short(point.error), point.unstable ?? ""].forEach(text => add(row, "td", text));
    row.setAttribute("aria-selected", "false");
    row.addEventListener("click", event => select(place, event.shiftKey));
    row.addEventListener("keydown", event => { if (event.key === "Enter") select(place, event.shiftKey); });
  });
  $("#table").hidden = !special.length;

  // Words.
  $("h1").textContent = data.title;
  const list = $("#notes ul");
  data.documents.forEach(it => it.branches.forEach(branch => {
    add(list, "li", data.documents.length > 1 ? `${it.name}: ${branch.summary}` : branch.summary);
    branch.warnings.forEach(text => add(list, "li", `warning: ${text}`, { className: "warning" }));
  }));
  data.documents.forEach(it => it.settings.forEach(([name, value]) => {
    add($("#notes dl"), "dt", data.documents.length > 1 ? `${it.name}: ${name}` : name);
    add($("#notes dl"), "dd", value);
  }));
  $("#notes").hidden = !data.documents.length;
  $("#download-csv").addEventListener("click", () => save("points.csv", "text/csv", allPoints()));
  $("#download-json").addEventListener("click", () => save("results.json", "application/json", JSON.stringify(data.documents)));
  document.body.dataset.ready = "true";
})();
