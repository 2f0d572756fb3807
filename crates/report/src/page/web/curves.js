// One diagram of a frfid report: its data and the axes it is drawn on. Numbers come as base64 of little-endian float32.
// `root` is its section of the page and `data` its part of the data block.

const DEG = 180 / Math.PI;
const DASHES = [[], [7, 3], [7, 2, 2, 2], [2, 2]];
const MARKERS = ["dot", "diamond", "square", "ring"];
const LEVELS = [["noise", "noise level"], ["total", "total level"],
  ["nonlinear", "nonlinear distortion of one realization"]];

const canvas = root.querySelector("canvas");
const curves = data.curves.map(decoded);
const entries = data.outputs.flatMap((_, output) => data.inputs.map((_, input) => ({ output, input })));
/**
 * The band and magnitudes in view (`db` null: what the curves need), the entry and frequency under the cursor, the entry
 * that is shown alone, and whether the reader wants "all", "one" or "any", whatever has room.
 */
const view = { low: 1, high: 10, db: null, entry: null, cursor: null, drag: null,
  only: null, wants: "any" };
const shown = { phase: data.outputs.length <= 3 && data.inputs.length <= 3, region: true, noise: false, total: false, nonlinear: false };
/** What the reader has chosen, and not the room there is. */
const asked = { phase: false };
giveInks();

function floats(text) {
  if (text === null) return null;
  const bytes = Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
  const words = new DataView(bytes.buffer);
  return Float64Array.from({ length: bytes.length / 4 }, (_, k) => words.getFloat32(4 * k, true));
}

/** One curve: dB and degrees of every entry, and standard deviations where they are known. */
function decoded(raw) {
  const re = floats(raw.re), im = floats(raw.im);
  const magnitude = re.map((x, i) => Math.hypot(x, im[i]));
  return {
    label: raw.label, style: raw.style, place: raw, visible: true, hz: floats(raw.frequency_hz), magnitude,
    db: magnitude.map(db), phase: re.map((x, i) => Math.atan2(im[i], x) * DEG),
    noise: floats(raw.noise_deviation), noiseFactor: raw.noise_factor,
    total: floats(raw.total_deviation), totalFactor: raw.total_factor,
    nonlinear: floats(raw.nonlinear_deviation), flagged: raw.flagged || [],
  };
}

/** Colours, dashes and markers, those of the printed figures. */
function giveInks() {
  for (const curve of curves) {
    const { color, shape } = curve.place;
    Object.assign(curve, { color: "--reference", dash: [], width: 1, marker: null });
    if (curve.style === "reference") continue;
    curve.color = "--curve" + (color % 5);
    if (curve.style === "line") Object.assign(curve, { dash: DASHES[shape % 4], width: 1.8 });
    else Object.assign(curve, { marker: MARKERS[shape % 4], width: 0 });
  }
}

function db(magnitude) { return 20 * Math.log10(magnitude); }

function name(entry) { return data.inputs[entry.input] + " \u2192 " + data.outputs[entry.output]; }

/** The entries that are drawn. */
function drawn() { return view.only ? [view.only] : entries; }

function visible() { return curves.filter((curve) => curve.visible && curve.hz.length); }

/** Where entry (output, input) at frequency k stands in the arrays. */
function place(k, entry) { return (k * data.outputs.length + entry.output) * data.inputs.length + entry.input; }

/** Radius of the 95 % region at a place: of the total where it is known, else of the noise, else null. */
function radius(curve, i) {
  for (const kind of ["total", "noise"]) {
    const factor = curve[kind + "Factor"];
    if (curve[kind] && factor !== null) return { rho: factor * curve[kind][i], kind };
  }
  return null;
}

/** Half width in degrees of the phase of a region. */
function halfWidth(rho, magnitude) { return rho < magnitude ? Math.asin(rho / magnitude) * DEG : 180; }

/** The line of a curve nearest to a frequency. */
function nearest(curve, hz) {
  let best = 0, least = Infinity;
  curve.hz.forEach((value, k) => {
    const distance = Math.abs(Math.log(value / hz));
    if (distance < least) { least = distance; best = k; }
  });
  return best;
}

/** Runs of [index, degrees] between the wraps; each goes on by one point beyond the edge. */
function unwrapped(curve, entry) {
  const runs = [[]];
  curve.hz.forEach((_, k) => {
    const value = curve.phase[place(k, entry)], run = runs[runs.length - 1], last = run[run.length - 1];
    const turns = last ? Math.round((value - last[1]) / 360) : 0;
    if (turns) {
      run.push([k, value - 360 * turns]);
      runs.push([[last[0], last[1] + 360 * turns]]);
    }
    runs[runs.length - 1].push([k, value]);
  });
  return runs;
}

// ---- axes ---------------------------------------------------------------------------------------------------------

/** A number for people: six digits at most, true minus sign. */
function number(value, digits) {
  const text = digits === undefined ? String(+value.toPrecision(6)) : value.toFixed(digits);
  return text.replace("-", "\u2212");
}

/** Ticks of a logarithmic axis: every digit for the grid, and those that have room for labels. */
function logTicks(low, high, length) {
  const decade = length / Math.log10(high / low), fine = [], labelled = [];
  const sets = [[1, 2, 3, 4, 5, 6, 7, 8, 9], [1, 2, 5], [1]], gaps = [10 / 9, 2, 1e9];
  const room = 8 + 7 * Math.max(number(low, low < 1 ? 2 : 0).length, number(high, 0).length);
  const digits = sets.find((_, n) => decade * Math.log10(gaps[n]) > room) || [1];
  for (let power = Math.floor(Math.log10(low)); power <= Math.ceil(Math.log10(high)); power++) {
    for (let digit = 1; digit < 10; digit++) {
      const value = Number(digit + "e" + power);
      if (value < low * (1 - 1e-9) || value > high * (1 + 1e-9)) continue;
      fine.push(value);
      if (digits.includes(digit)) labelled.push(value);
    }
  }
  return labelled.length > 2 ? { fine, labelled } : linearTicks(low, high, length, 45);
}

function linearTicks(low, high, length, room) {
  const least = ((high - low) * room) / length, ten = 10 ** Math.floor(Math.log10(least));
  const step = [1, 2, 5, 10].map((digit) => digit * ten).find((s) => s >= least * (1 - 1e-9));
  return { fine: multiples(low, high, step / 2), labelled: multiples(low, high, step) };
}

function degreeTicks(low, high, length) {
  const step = high - low > 270 || length < 120 ? 90 : 45;
  return { fine: multiples(low, high, step / 3), labelled: multiples(low, high, step) };
}

function multiples(low, high, step) {
  const found = [];
  for (let k = Math.ceil(low / step - 1e-6); k <= Math.floor(high / step + 1e-6); k++) found.push(k * step);
  return found;
}

/** Least and greatest finite value of `values(curve, place)` over visible curves, all entries and the band in view. */
function extent(values) {
  let low = Infinity, high = -Infinity;
  for (const curve of visible()) {
    curve.hz.forEach((hz, k) => {
      if (hz < view.low || hz > view.high) return;
      for (const value of drawn().flatMap((entry) => values(curve, place(k, entry)))) {
        if (Number.isFinite(value)) { low = Math.min(low, value); high = Math.max(high, value); }
      }
    });
  }
  return low <= high ? [low, high] : [-1, 1];
}

function magnitudeRange() {
  const levels = LEVELS.map(([kind]) => kind).filter((kind) => shown[kind]);
  const known = (curve) => levels.filter((kind) => curve[kind]);
  const values = (curve, i) => [curve.db[i], ...known(curve).map((kind) => db(curve[kind][i]))];
  const [low, high] = extent(values), room = Math.max(0.05 * (high - low), 0.5);
  return [low - room, high + room];
}

function phaseRange() {
  const [low, high] = extent((curve, i) => [curve.phase[i]]);
  return [Math.max(Math.floor((low - 3) / 45) * 45, -180), Math.min(Math.ceil((high + 3) / 45) * 45, 180)];
}

/** The band that holds every curve. */
function showAll() {
  const all = curves.flatMap((curve) => [...curve.hz]).filter((hz) => hz > 0 && hz < Infinity);
  view.low = all.reduce((a, b) => Math.min(a, b), Infinity);
  view.high = all.reduce((a, b) => Math.max(a, b), 0);
  if (!all.length) { view.low = 1; view.high = 10; } // frequencies beyond float32
  if (!(view.high > view.low)) { view.low /= 2; view.high *= 2; }
  view.db = null;
}
