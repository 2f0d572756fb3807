// Cursor, zoom, choice of the panel and check boxes.

function panelAt([x, y]) {
  return panels.find((p) => x >= p.x && x <= p.x + p.width && y >= p.y && y <= p.y + p.height);
}

function hzAt(panel, x) {
  return view.low * (view.high / view.low) ** Math.min(Math.max((x - panel.x) / panel.width, 0), 1);
}

function zoomTo(low, high) {
  if (high / low > 1.0005) { view.low = low; view.high = high; }
  draw();
}

/** Turns a dragged rectangle into a zoom: of the frequency in all panels, of the magnitude too if it is high enough. */
function endDrag() {
  const { panel, from, to } = view.drag, order = (a, b) => [Math.min(a, b), Math.max(a, b)];
  const [left, right] = order(from[0], to[0]), [top, bottom] = order(from[1], to[1]);
  const valueAt = (y) => panel.high - ((y - panel.y) / panel.height) * (panel.high - panel.low);
  view.drag = null;
  const [low, high] = [valueAt(bottom), valueAt(top)];
  if (!panel.phase && bottom - top > 30 && high - low > 1e-3) view.db = [low, high];
  if (right - left > 8) zoomTo(hzAt(panel, left), hzAt(panel, right));
  else if (bottom - top < 4 && !view.only && entries.length > 1) enlarge(panel.entry);
  else draw();
}

/** Shows one entry in all the width, or all of them again. */
function enlarge(entry) {
  if (entries.length < 2) return;
  view.only = entry;
  view.wants = entry ? "one" : "all";
  if (entry) view.entry = entry;
  draw();
}

/** Moves to the entry `rows` below and `columns` to the right, at the edge to the other one. */
function step(rows, columns) {
  const now = view.entry || entries[0], wrap = (value, count) => (value + count) % count;
  const output = wrap(now.output + rows, data.outputs.length), input = wrap(now.input + columns, data.inputs.length);
  toEntry(entries[output * data.inputs.length + input]);
}

function toEntry(entry) {
  view.entry = entry;
  if (view.cursor === null && visible()[0]) view.cursor = visible()[0].hz[0];
  if (view.only) view.only = entry;
  draw();
}

/** The key that asks for another panel, or for one alone; whether there was one. */
function changePanel(key) {
  const at = entries.indexOf(view.entry || entries[0]), last = entries.length;
  if (key === "ArrowUp") step(-1, 0);
  else if (key === "ArrowDown") step(1, 0);
  else if (key === "PageUp") toEntry(entries[(at + last - 1) % last]);
  else if (key === "PageDown") toEntry(entries[(at + 1) % last]);
  else if (key === "Enter") enlarge(view.only ? null : view.entry || entries[0]);
  else return false;
  return true;
}

function listenToPointer() {
  const at = (event) => [event.offsetX, event.offsetY];
  canvas.addEventListener("pointerdown", (event) => {
    const panel = panelAt(at(event));
    if (!panel || event.button !== 0) return;
    view.drag = { panel, from: at(event), to: at(event) };
    canvas.setPointerCapture(event.pointerId);
  });
  canvas.addEventListener("pointermove", (event) => {
    const panel = panelAt(at(event)), curve = visible()[0];
    if (view.drag) view.drag.to = at(event);
    if (panel && curve) {
      view.entry = panel.entry;
      view.cursor = curve.hz[nearest(curve, hzAt(panel, event.offsetX))];
    }
    requestAnimationFrame(() => show());
  });
  canvas.addEventListener("pointerup", () => { if (view.drag) endDrag(); });
  canvas.addEventListener("pointercancel", () => { view.drag = null; show(); });
  canvas.addEventListener("dblclick", () => { showAll(); draw(); }); // the two clicks before it undo each other
}

function listenToKeys() {
  canvas.addEventListener("keydown", (event) => {
    const curve = visible()[0], inView = view.cursor >= view.low && view.cursor <= view.high;
    const middle = inView ? view.cursor : Math.sqrt(view.low * view.high);
    const step = { ArrowLeft: -1, ArrowRight: 1 }[event.key], power = { "+": 0.5, "-": 2 }[event.key];
    if (step && curve) {
      const k = nearest(curve, middle) + (inView ? step : 0);
      view.cursor = curve.hz[Math.min(Math.max(k, 0), curve.hz.length - 1)];
      view.entry = view.entry || entries[0];
      show();
    } else if (power) zoomTo(middle * (view.low / middle) ** power, middle * (view.high / middle) ** power);
    else if (event.key === "Escape" && view.only) enlarge(null);
    else if (event.key === "0" || event.key === "Escape") { showAll(); draw(); }
    else if (entries.length < 2 || !changePanel(event.key)) return;
    event.preventDefault();
  });
}

/** A check box that draws anew when it is used. */
function addToggle(text, checked, use, ...sample) {
  const label = document.createElement("label"), box = document.createElement("input");
  box.type = "checkbox";
  box.checked = checked;
  box.addEventListener("change", () => { use(box.checked); draw(); });
  label.append(box, ...sample, text);
  root.querySelector(".controls").append(label);
}

/** The ink of a curve as it stands in a legend. */
function swatch(curve) {
  const make = (kind, attributes) => {
    const element = document.createElementNS("http://www.w3.org/2000/svg", kind);
    Object.entries(attributes).forEach(([key, value]) => element.setAttribute(key, value));
    return element;
  };
  const svg = make("svg", { viewBox: "0 0 30 12" }), color = "var(" + curve.color + ")";
  const line = { d: "M0 6H30", stroke: color, "stroke-width": curve.width, "stroke-dasharray": curve.dash.join(" ") };
  if (curve.width) svg.append(make("path", line));
  const round = "M12 6a3 3 0 1 0 6 0a3 3 0 1 0 -6 0z";
  const outline = { dot: round, ring: round, square: "M12.5 3.5h5v5h-5z", diamond: "M11 6l4-4 4 4-4 4z" }[curve.marker];
  if (outline) svg.append(make("path", { d: outline, fill: isOpen(curve.marker) ? "none" : color, stroke: color }));
  return svg;
}

/** The list of entries, for those who do not point. */
function addChoice() {
  const label = document.createElement("label"), choice = document.createElement("select");
  choice.append(new Option("all panels", ""), ...entries.map((entry, n) => new Option(name(entry), String(n))));
  choice.addEventListener("change", () => enlarge(choice.value ? entries[+choice.value] : null));
  label.append("show ", choice);
  root.querySelector(".controls").append(label);
}

function addControls() {
  if (entries.length > 1) addChoice();
  for (const curve of curves) addToggle(curve.label, true, (on) => { curve.visible = on; }, swatch(curve));
  addToggle("phase", shown.phase, (on) => { shown.phase = on; asked.phase = true; });
  if (curves.some((curve) => curve.noise || curve.total)) {
    addToggle("95 % region", shown.region, (on) => { shown.region = on; });
  }
  for (const [kind, text] of LEVELS) {
    if (curves.some((curve) => curve[kind])) addToggle(text, shown[kind], (on) => { shown[kind] = on; });
  }
  if (curves.some((curve) => curve.flagged.includes(true))) {
    const note = document.createElement("span");
    note.textContent = "ticks at the upper edge: flagged lines";
    root.querySelector(".controls").append(note);
  }
  const button = document.createElement("button");
  button.type = "button";
  button.textContent = "Whole band";
  button.addEventListener("click", () => { showAll(); draw(); });
  root.querySelector(".controls").append(button);
}

root.querySelector(".values").addEventListener("toggle", writeValues);
addControls();
showAll();
draw();
listenToPointer();
listenToKeys();
new ResizeObserver(() => draw()).observe(canvas.parentElement);
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => draw());
const print = (on) => { document.documentElement.classList.toggle("print", on); draw(); };
window.addEventListener("beforeprint", () => print(true));
window.addEventListener("afterprint", () => print(false));
