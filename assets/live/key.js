// The names of curves and the meanings of their styles, and the values at the pointer.

import { add } from "./controls.js";

const LOOKS = { Dashed: "dashed", Dotted: "dotted", Thin: "thin", DottedLine: "dotted and joined", Dots: "dots", Solid: "solid" };
const BORDERS = { Dashed: "dashed", Dotted: "dotted" };

/** The values at the pointer. */
const tip = document.getElementById("tip");
export const showTip = (text, event) => {
  tip.hidden = text === null;
  if (text === null) return;
  tip.textContent = text;
  tip.style.left = `${Math.max(4, Math.min(event.clientX + 16, innerWidth - tip.offsetWidth - 8))}px`;
  tip.style.top = `${Math.max(4, Math.min(event.clientY + 16, innerHeight - tip.offsetHeight - 8))}px`;
};

/** The names of curves and the meanings of their styles. */
export const showKey = (element, panel, colours) => {
  element.replaceChildren();
  const drawn = name => panel.curves.some(curve => curve.name === name);
  const names = panel.names.filter(name => name && drawn(name));
  if (panel.names.length > 1) names.forEach(name => {
    const key = add(element, "span", undefined, { className: "key" });
    const line = add(key, "i");
    line.style.color = colours[panel.names.indexOf(name) % colours.length];
    if (panel.dashed?.includes(name)) line.style.borderTopStyle = "dashed";
    add(key, "span", name);
  });
  panel.meanings.filter(([style]) => panel.curves.some(curve => curve.style === style)).forEach(([style, meaning]) => {
    const key = add(element, "span", undefined, { className: "key", title: LOOKS[style] ?? "" });
    add(key, "i").style.borderTopStyle = BORDERS[style] ?? "solid";
    add(key, "span", meaning);
  });
};
