"use strict";
// Elements of a page, and rows of its tables.

// An element with properties or attributes, but for those undefined, and what is in it.
function made(tag, properties, ...content) {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(properties)) {
    if (value === undefined) continue;
    if (name in element) element[name] = value;
    else element.setAttribute(name, value);
  }
  element.append(...content);
  return element;
}

// A row of texts below a head; each may have a class: [text, class].
function tableRow(head, cells, className) {
  return made("tr", { className }, made("th", { scope: "row" }, head), ...cells.map(([text, kind]) => made("td", { className: kind || undefined }, text)));
}

function tableHead(texts, className) {
  return made("thead", {}, made("tr", {}, ...texts.map((text) => made("th", { scope: "col", className }, text))));
}
