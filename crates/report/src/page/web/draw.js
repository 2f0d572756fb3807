// The matrix of Bode diagrams on the canvas: one row per output, one column per input, common axes.

const FONT = "12px system-ui, 'Segoe UI', Roboto, Arial, sans-serif";
const LEFT = 58, RIGHT = 10, TITLE = 24, GAP = 12, BELOW = 40;
const NARROWEST = 130; // of a panel among others
const sheet = document.createElement("canvas");
let panels = [], paint = {};

/** Draws all panels on the sheet behind the canvas, for the width there is, and shows it. */
function draw() {
  chooseEntries();
  const { width, height } = layOut(), most = 16000;
  const scale = Math.min(window.devicePixelRatio || 1, most / width, most / height);
  for (const target of [sheet, canvas]) {
    target.width = Math.round(width * scale);
    target.height = Math.round(height * scale);
    target.getContext("2d").scale(scale, scale);
  }
  canvas.style.width = width + "px";
  canvas.style.height = height + "px";
  const style = getComputedStyle(document.documentElement), pen = sheet.getContext("2d");
  const colors = ["--paper", "--ink", "--soft", "--edge", "--fine", ...curves.map((curve) => curve.color)];
  paint = Object.fromEntries(colors.map((color) => [color, style.getPropertyValue(color).trim()]));
  pen.fillStyle = paint["--paper"];
  pen.fillRect(0, 0, width, height);
  pen.font = FONT;
  panels.forEach((panel) => drawPanel(pen, panel));
  show(width, height);
  root.dataset.drawn = String(panels.length);
  writeValues();
}

/** One entry where the window has no room for all, unless the reader wants all. */
function chooseEntries() {
  const room = canvas.parentElement.clientWidth, isNarrow = room < LEFT + RIGHT + data.inputs.length * NARROWEST;
  if (view.wants === "any") view.only = isNarrow && entries.length > 1 ? view.entry || entries[0] : null;
  const choice = root.querySelector("select"), names = drawn().map(name).join(", ");
  if (choice) choice.value = view.only ? String(entries.indexOf(view.only)) : "";
  canvas.setAttribute("aria-label", (drawn().length > 1 ? "Bode diagrams of all entries: " : "Bode diagram: ") + names);
}

/** Puts the sheet on the canvas, with cursor and zoom rectangle. */
function show(width = parseFloat(canvas.style.width), height = parseFloat(canvas.style.height)) {
  const pen = canvas.getContext("2d");
  pen.drawImage(sheet, 0, 0, width, height);
  const inside = view.cursor >= view.low && view.cursor <= view.high;
  if (inside) panels.forEach((panel) => rule(pen, panel, "--soft", [view.cursor], []));
  if (view.drag) {
    const { from, to } = view.drag;
    pen.globalAlpha = 0.15;
    pen.fillStyle = paint["--ink"];
    pen.fillRect(from[0], from[1], to[0] - from[0], to[1] - from[1]);
    pen.globalAlpha = 1;
  }
  writeReadout();
}

/** Places the panels; returns the size of the whole. */
function layOut() {
  const single = drawn().length === 1, columns = single ? 1 : data.inputs.length, rows = single ? 1 : data.outputs.length;
  const width = Math.max(canvas.parentElement.clientWidth, LEFT + RIGHT + columns * (single ? 190 : NARROWEST));
  const across = (width - LEFT - RIGHT - (columns - 1) * GAP) / columns;
  const withPhase = shown.phase || (view.only && !asked.phase); // alone there is room for it
  const tall = single ? 260 : Math.min(Math.max(0.6 * across, 110), 190), short = !withPhase ? 0 : single ? 170 : 95;
  const cell = TITLE + tall + (short ? GAP + short : 0) + 6;
  const [low, high] = view.db || magnitudeRange(), [least, most] = phaseRange();
  panels = drawn().flatMap((entry) => {
    const [row, column] = single ? [0, 0] : [entry.output, entry.input], y = row * cell + TITLE, bottom = row === rows - 1;
    const common = { entry, x: LEFT + column * (across + GAP), width: across, isLeft: column === 0 };
    const magnitude = { ...common, phase: false, y, height: tall, low, high, bottom: bottom && !short };
    const phase = { ...common, phase: true, y: y + tall + GAP, height: short, low: least, high: most, bottom };
    return short ? [magnitude, phase] : [magnitude];
  });
  return { width, height: rows * cell + BELOW };
}

function toX(panel, hz) { return panel.x + (panel.width * Math.log(hz / view.low)) / Math.log(view.high / view.low); }

function toY(panel, value) {
  const share = (value - panel.low) / (panel.high - panel.low);
  return panel.y + panel.height * (1 - Math.min(Math.max(share, -3), 4));
}

function drawPanel(pen, panel) {
  const { x, y, width, height, low, high } = panel;
  const across = logTicks(view.low, view.high, width);
  const up = panel.phase ? degreeTicks(low, high, height) : linearTicks(low, high, height, 28);
  rule(pen, panel, "--fine", across.fine, up.fine);
  rule(pen, panel, "--edge", across.labelled, up.labelled);
  pen.save();
  pen.beginPath();
  pen.rect(x, y, width, height);
  pen.clip();
  const isReference = (curve) => curve.style === "reference"; // on top
  [...visible()].sort((a, b) => isReference(a) - isReference(b)).forEach((curve) => drawCurve(pen, panel, curve));
  visible().filter((curve) => curve.flagged.includes(true)).forEach((curve, n) => drawFlags(pen, panel, curve, n));
  pen.restore();
  pen.strokeStyle = paint["--ink"];
  pen.lineWidth = 1;
  pen.strokeRect(x, y, width, height);
  writeLabels(pen, panel, across.labelled, up.labelled);
}

/** Lines across a panel at frequencies and values. */
function rule(pen, panel, color, frequencies, values) {
  pen.strokeStyle = paint[color];
  pen.lineWidth = 1;
  pen.beginPath();
  for (const hz of frequencies) {
    pen.moveTo(toX(panel, hz), panel.y);
    pen.lineTo(toX(panel, hz), panel.y + panel.height);
  }
  for (const value of values) {
    pen.moveTo(panel.x, toY(panel, value));
    pen.lineTo(panel.x + panel.width, toY(panel, value));
  }
  pen.stroke();
}

function writeLabels(pen, panel, across, up) {
  const { x, y, width, height, entry } = panel, middle = x + width / 2;
  pen.fillStyle = paint["--ink"];
  pen.textAlign = "center";
  if (!panel.phase) pen.fillText(name(entry), middle, y - 8, width);
  if (panel.bottom) {
    for (const hz of across) pen.fillText(number(hz), toX(panel, hz), y + height + 15);
    pen.fillText("Frequency in Hz", middle, y + height + 33);
  }
  if (!panel.isLeft) return;
  pen.save();
  pen.translate(13, y + height / 2);
  pen.rotate(-Math.PI / 2);
  pen.fillText(panel.phase ? "Phase in deg" : "Magnitude in dB", 0, 0);
  pen.restore();
  pen.textAlign = "right";
  for (const value of up) pen.fillText(number(value), x - 5, toY(panel, value) + 4);
}

/** One curve in one panel: region, levels, line, markers. */
function drawCurve(pen, panel, curve) {
  const all = (values) => Array.from(curve.hz, (_, k) => [k, values[place(k, panel.entry)]]);
  const runs = panel.phase ? unwrapped(curve, panel.entry) : [all(curve.db)];
  for (const run of runs) {
    if (shown.region && radius(curve, 0)) fillRegion(pen, panel, curve, run);
    if (curve.width) stroke(pen, panel, curve, run, curve.width, curve.dash);
  }
  if (!panel.phase) {
    LEVELS.forEach(([kind], n) => {
      if (shown[kind] && curve[kind]) stroke(pen, panel, curve, all(curve[kind].map(db)), 1.2, DASHES[3 - n]);
    });
  }
  for (const [k, value] of all(panel.phase ? curve.phase : curve.db)) {
    if (!Number.isFinite(value)) continue;
    const [x, y] = [toX(panel, curve.hz[k]), toY(panel, value)];
    if (curve.marker) drawMarker(pen, curve, x, y);
  }
}

/** Ticks at the lines that are not to be trusted, where they hide no curve: in the n-th row below the upper edge. */
function drawFlags(pen, panel, curve, n) {
  const y = panel.y + 2 + 7 * n;
  pen.strokeStyle = paint[curve.color];
  pen.lineWidth = 1.2;
  pen.beginPath();
  curve.hz.forEach((hz, k) => {
    if (!curve.flagged[k]) return;
    pen.moveTo(toX(panel, hz), y);
    pen.lineTo(toX(panel, hz), y + 6);
  });
  pen.stroke();
}

function stroke(pen, panel, curve, run, width, dash) {
  pen.strokeStyle = paint[curve.color];
  pen.lineWidth = width;
  pen.lineJoin = "round";
  pen.setLineDash(dash);
  pen.beginPath();
  let down = false;
  for (const [k, value] of run) {
    if (down && Number.isFinite(value)) pen.lineTo(toX(panel, curve.hz[k]), toY(panel, value));
    else if (Number.isFinite(value)) pen.moveTo(toX(panel, curve.hz[k]), toY(panel, value));
    down = Number.isFinite(value);
  }
  pen.stroke();
  pen.setLineDash([]);
}

/** Shades the 95 % region: 20 lg(|G| -+ rho), arg G -+ asin(rho / |G|). */
function fillRegion(pen, panel, curve, run) {
  const edge = (k, value, sign) => {
    const i = place(k, panel.entry), { rho } = radius(curve, i), magnitude = curve.magnitude[i];
    return panel.phase ? value + sign * halfWidth(rho, magnitude) : db(Math.max(magnitude + sign * rho, 1e-300));
  };
  pen.beginPath();
  for (const [k, value] of run) pen.lineTo(toX(panel, curve.hz[k]), toY(panel, edge(k, value, -1)));
  for (const [k, value] of [...run].reverse()) pen.lineTo(toX(panel, curve.hz[k]), toY(panel, edge(k, value, 1)));
  pen.globalAlpha = 0.22;
  pen.fillStyle = paint[curve.color];
  pen.fill();
  pen.globalAlpha = 1;
}

function isOpen(marker) { return marker === "diamond" || marker === "ring"; }

function drawMarker(pen, curve, x, y) {
  const color = paint[curve.color], r = 3.2;
  pen.beginPath();
  if (curve.marker === "diamond") {
    for (const [dx, dy] of [[-r, 0], [0, -r], [r, 0], [0, r]]) pen.lineTo(x + dx, y + dy);
    pen.closePath();
  } else if (curve.marker === "square") pen.rect(x - 2.2, y - 2.2, 4.4, 4.4);
  else pen.arc(x, y, 2.5, 0, 2 * Math.PI);
  pen.fillStyle = isOpen(curve.marker) ? paint["--paper"] : color;
  pen.fill();
  if (!isOpen(curve.marker)) return;
  pen.strokeStyle = color;
  pen.lineWidth = 1.2;
  pen.stroke();
}
