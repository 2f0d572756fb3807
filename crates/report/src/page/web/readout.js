// Values as text: below the cursor, and all of an entry in a table.

/** One row per visible curve: what it says at its line nearest to the cursor, in the entry under the cursor. */
function writeReadout() {
  const table = root.querySelector(".readout table"), rows = visible().map((curve) => [curve.label, ...values(curve)]);
  const all = [view.entry ? name(view.entry) : "Curve", ...rows.flat()].join("\n");
  if (table.dataset.said === all) return; // whoever listens hears what is new
  table.dataset.said = all;
  table.querySelector("tbody").replaceChildren(...rows.map(tableRow));
  table.querySelectorAll("td").forEach((cell, n) => { cell.dataset.unit = ["Hz", "dB", "deg", ""][n % 4]; });
  table.querySelector("th").textContent = view.entry ? name(view.entry) : "Curve";
}

/** A row of text, its name first. */
function tableRow(texts) {
  const row = document.createElement("tr");
  texts.forEach((text, n) => {
    const cell = document.createElement(n ? "td" : "th");
    if (!n) cell.scope = "row";
    cell.textContent = text;
    row.append(cell);
  });
  return row;
}

/** Frequency, magnitude, phase and 95 % region of a curve at the cursor, as text. */
function values(curve) {
  const none = "\u2013";
  if (view.cursor === null || !view.entry) return [none, none, none, none];
  return valuesAt(curve, nearest(curve, view.cursor), view.entry);
}

/** The same at a line of an entry. */
function valuesAt(curve, k, entry) {
  const i = place(k, entry), known = radius(curve, i), size = curve.magnitude[i];
  const region = ({ rho, kind }) =>
    db(1 + rho / size).toPrecision(2) + " dB, " + halfWidth(rho, size).toPrecision(2) + " deg (" + kind + ")";
  const hz = number(curve.hz[k]) + (curve.flagged[k] ? " (flagged)" : "");
  return [hz, number(curve.db[i], 2), number(curve.phase[i], 1), known ? region(known) : "\u2013"];
}

/** A table of every line of an entry for each visible curve, made when it is unfolded. */
function writeValues() {
  const fold = root.querySelector(".values");
  fold.querySelectorAll(".scroll").forEach((old) => old.remove());
  if (!fold.open) return;
  const entry = view.entry || entries[0];
  for (const curve of visible()) {
    const frame = document.createElement("div"), table = document.createElement("table");
    frame.className = "scroll";
    table.createCaption().textContent = curve.label + ": " + name(entry);
    const head = document.createElement("tr"), body = document.createElement("tbody");
    head.append(...[...root.querySelectorAll(".readout thead th")].slice(1).map((cell) => cell.cloneNode(true)));
    table.createTHead().append(head);
    body.append(...Array.from(curve.hz, (_, k) => tableRow(valuesAt(curve, k, entry))));
    table.append(body);
    frame.append(table);
    fold.append(frame);
  }
}
