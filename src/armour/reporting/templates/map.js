"use strict";
// Answers are for thicknesses on offer; lines between them are interpolated.
const DATA = JSON.parse(document.getElementById("data").textContent);
const { threats } = DATA, T = threats.length, Q = DATA.probabilities.length;
const [FAILS, PERFORATED, NOT_KNOWN, STOPPED, EXPECTED, PASSES] = DATA.verdicts.keys();
const mark = t => (t + 10).toString(36).toUpperCase();
const { abs, ceil, floor, max, min, round } = Math;
const $ = id => document.getElementById(id);

// --- numbers

const bytes = text => Uint8Array.from(atob(text), each => each.charCodeAt(0)).buffer;

// Limits by the model, stopped velocities, by score (NaN: not known), and the greatest scores that are stated.
function decoded(pair) {
  const floats = new Float32Array(bytes(pair.floats)), differences = new Uint16Array(bytes(pair.differences));
  const m = pair.backings.length, count = pair.ceramics.length * m;
  pair.limits = new Float64Array(count * T);
  pair.stops = new Float64Array(count * T * Q);
  pair.most = new Float64Array(count * T).fill(Infinity);
  for (let d = 0; d < count * T; d++) {
    pair.limits[d] = floats[3 * d];
    if (floats[3 * d + 2] < 1) pair.most[d] = scoreOf(floats[3 * d + 2]);
    let velocity = floats[3 * d + 1] || NaN;
    for (let q = 0; q < Q; q++) {
      if (q) velocity += pair.step * differences[d * (Q - 1) + q - 1];
      pair.stops[d * Q + q] = velocity;
    }
  }
  pair.areal = Float64Array.from({ length: count }, (_, k) =>
    (pair.densities[0] * pair.ceramics[floor(k / m)] + pair.densities[1] * pair.backings[k % m]) / 1000 + DATA.added.areal);
  pair.excluded = new Set(pair.excluded);
  const rank = pair.areal.map(each => round(each * 1e9));
  pair.onOffer = pair.offered[0].flatMap(i => pair.offered[1].map(j => i * m + j));
  // Sort by areal density; equals keep their order.
  pair.designs = pair.onOffer.filter(k => !pair.excluded.has(k)).sort((a, b) => rank[a] - rank[b] || a - b);
  pair.name = pair.ceramic ? `${pair.ceramic} on ${pair.backing}` : pair.backing;
  pair.unknown = Uint8Array.from(pair.areal, (_, k) => +threats.some((_, t) => !tells(pair, k, t)));
  pair.known = pair.unknown.includes(0);
  pair.asked = {};
}

// Probability below a normal score (Abramowitz and Stegun 26.2.17), and its inverse.
function below(z) {
  const t = 1 / (1 + 0.2316419 * abs(z)), density = 0.3989422804014327 * Math.exp(-z * z / 2);
  const tail = density * t * (0.31938153 + t * (-0.356563782 + t * (1.781477937 + t * (-1.821255978 + t * 1.330274429))));
  return z > 0 ? 1 - tail : tail;
}
function scoreOf(probability) {
  let low = -6, high = 6;
  for (let n = 0; n < 50; n++) if (below((low + high) / 2) < probability) low = (low + high) / 2; else high = (low + high) / 2;
  return high;
}

const scores = DATA.probabilities.map(scoreOf), EVEN = DATA.probabilities.indexOf(0.5);

// Slope of the score over the velocity at a node: monotone cubic interpolation (Fritsch and Butland).
function slope(V, o, q) {
  if (q === 0 || q === Q - 1) {
    const n = q ? -1 : 1, h = n * (V[o + q + n] - V[o + q]), k = n * (V[o + q + 2 * n] - V[o + q + n]);
    const a = n * (scores[q + n] - scores[q]) / h, b = n * (scores[q + 2 * n] - scores[q + n]) / (k || 1), m = ((2 * h + k) * a - h * b) / (h + k);
    return m < 0 ? max(m, 3 * a) : 0;
  }
  const h = V[o + q] - V[o + q - 1], k = V[o + q + 1] - V[o + q];
  if (!(h > 0 && k > 0)) return 0;
  const a = (scores[q] - scores[q - 1]) / h, b = (scores[q + 1] - scores[q]) / k;
  return 3 * (h + k) / ((2 * k + h) / a + (k + 2 * h) / b);
}
const hermite = (y, z, a, b, t) => ((2 * t - 3) * t * t + 1) * y + (3 - 2 * t) * t * t * z + (1 - t) * (1 - t) * t * a - (1 - t) * t * t * b;
// Score with which a design stops a velocity by the tests: infinite beyond 1 and 99 %, NaN where it is unknown.
function byTests(pair, d, v) {
  const V = pair.stops, o = d * Q;
  if (isNaN(V[o])) return NaN;
  if (v < V[o]) return Infinity;
  if (v > V[o + Q - 1]) return -Infinity;
  let q = 0;
  while (q < Q - 2 && v >= V[o + q + 1]) q++;
  if (v === V[o + q]) return scores[q];
  const h = V[o + q + 1] - V[o + q];
  return hermite(scores[q], scores[q + 1], slope(V, o, q) * h, slope(V, o, q + 1) * h, (v - V[o + q]) / h);
}
// Velocity that a design stops with a score by the tests.
function stopped(pair, d, z) {
  const V = pair.stops, o = d * Q;
  let q = 0;
  while (q < Q - 2 && scores[q + 1] > z) q++;
  if (z >= scores[q]) return V[o + q];
  const h = V[o + q + 1] - V[o + q], a = slope(V, o, q) * h, b = slope(V, o, q + 1) * h;
  let low = 0, high = 1;
  for (let n = 0; n < 12; n++) {
    const middle = (low + high) / 2;
    if (hermite(scores[q], scores[q + 1], a, b, middle) > z) low = middle; else high = middle;
  }
  return V[o + q] + low * h;
}

// --- what is asked

const state = {
  pair: 0, probability: DATA.probability ? 100 * DATA.probability : null, velocities: threats.map(t => t.velocity),
  most: DATA.most ?? Infinity, lines: "0", tests: true, cursor: null, pins: [],
};
const on = (element, type, act) => element.addEventListener(type, act);
const current = () => DATA.pairs[state.pair];
// Required probability against each threat, and its score; null: none.
const required = () => threats.map(t => t.own ?? (state.probability === null ? null : state.probability / 100));
const wanted = () => required().map(p => p && scoreOf(p));
const anyAsked = () => required().some(p => p !== null);
const none = threats.map(() => null), margins = threats.some(t => t.margin);

// Whether tests tell how likely a design is to stop a shot; if so, the score that is stated, else NaN.
const tells = (pair, k, t) => !isNaN(pair.stops[(k * T + t) * Q]);
const isKnown = (pair, k) => !pair.unknown[k];
const scored = (pair, k, t) => min(byTests(pair, k * T + t, state.velocities[t]), pair.most[k * T + t]);
// Limit of a design: the expected one or, where no tests tell, that by the model.
const limit = (pair, k, t) => (tells(pair, k, t) ? pair.stops[(k * T + t) * Q + EVEN] : pair.limits[k * T + t]);
const tile = (pair, k) => thicknesses(pair, k)[0];
const testsOf = (pair, k) => pair.tested[+(tile(pair, k) > 0)];
const light = (pair, k) => pair.areal[k] <= state.most + 1e-9;

// Greatest velocities at which designs do what is required of them; the last are kept.
function speeds(pair, t, z) {
  const key = [t, z === null];
  if (pair.asked[key]?.z !== z) {
    const { margin } = threats[t], values = pair.areal.map((_, k) => {
      const byLimit = limit(pair, k, t) - margin;
      return z === null || !tells(pair, k, t) ? byLimit : min(stopped(pair, k * T + t, z), margin ? byLimit : Infinity);
    });
    pair.asked[key] = { z, values };
  }
  return pair.asked[key].values;
}
// Rank of a design in a search: 1 fails, 2 rests on one source, 3 is not known or not stated, 4 holds; 0 is no metal.
const states = (pair, k, t, z) => (tells(pair, k, t) ? pair.most[k * T + t] >= (z ?? 0) - 1e-6 : z === null);
function rank(pair, k, t, z) {
  // 32-bit floats are right to 1e-4 m/s.
  const reaches = speeds(pair, t, z)[k] >= state.velocities[t] - 1e-4;
  return min(testsOf(pair, k).rank, !reaches ? 1 : tells(pair, k, t) && states(pair, k, t, z) ? 4 : 3);
}
const leastRank = (pair, k, asked) => min(...asked.map((z, t) => rank(pair, k, t, z)));
const tooLow = (pair, k, t) => !tells(pair, k, t) && pair.low[t] && !tile(pair, k);
// Verdict on a design against a threat, as check gives it.
function verdict(pair, k, t, z = wanted()[t]) {
  if (testsOf(pair, k).unsound) return NOT_KNOWN;
  const fails = z === null && !threats[t].margin && !tells(pair, k, t) ? PERFORATED : FAILS;
  if (rank(pair, k, t, z) === 1) return tooLow(pair, k, t) ? NOT_KNOWN : fails;
  if (!states(pair, k, t, z)) return NOT_KNOWN;
  return z !== null ? PASSES : tells(pair, k, t) ? EXPECTED : STOPPED;
}
const judged = (pair, k) => min(light(pair, k) && !pair.excluded.has(k) ? PASSES : FAILS, ...wanted().map((z, t) => verdict(pair, k, t, z)));
const isGood = (pair, k) => judged(pair, k) >= STOPPED;

// Lightest design of at least a rank, of known probability if possible.
function lightest(pair, least, asked = wanted()) {
  const key = [least, asked, state.velocities, state.most].join("|"), found = (pair.found ??= new Map());
  if (!found.has(key)) {
    if (found.size > 19) found.clear();
    const fits = k => light(pair, k) && leastRank(pair, k, asked) >= least;
    found.set(key, pair.designs.find(k => isKnown(pair, k) && fits(k)) ?? pair.designs.find(fits) ?? null);
  }
  return found.get(key);
}
// Design of a pair to show, as optimise does: the lightest of the highest rank or, if all fail, the nearest.
function answer(pair) {
  for (const rank of [4, 3, 2]) {
    const found = lightest(pair, rank);
    if (found !== null) return { k: found, rank, lack: 0 };
  }
  const asked = wanted(), within = pair.designs.filter(k => light(pair, k));
  let k = null, lack = Infinity;
  for (const each of within.length ? within : pair.designs.slice(0, 1)) {
    const lacks = asked.map((z, t) => state.velocities[t] - speeds(pair, t, z)[each]);
    // One of which it is not known that it fails comes first; last of these, without a metal.
    const by = testsOf(pair, each).rank ? max(...lacks) - 1e6 * lacks.every((by, t) => by <= 0 || tooLow(pair, each, t)) : -1e5;
    if (by < lack) [k, lack] = [each, by];
  }
  return { k, rank: 1, lack };
}
// What no required probability would give, where one is.
const even = pair => (anyAsked() ? lightest(pair, 4, none) : null);

// Areal density of the lightest design over x, given the greatest x that a design reaches.
function curve(pair, xs, reach) {
  const ys = xs.map(() => Infinity);
  let n = 0;
  for (const known of [true, false])
    for (const k of pair.designs) {
      if (n === xs.length || !light(pair, k)) break;
      if (isKnown(pair, k) !== known) continue;
      for (const most = reach(k); xs[n] <= most; n++) ys[n] = pair.areal[k];
    }
  return ys;
}
function overProbability(pair, xs) {
  const own = threats.map(t => t.own && scoreOf(t.own)), first = lightest(pair, 4, own) ?? lightest(pair, 3, own);
  const ys = curve(pair, xs.map(x => scoreOf(x / 100)), k =>
    leastRank(pair, k, own) === 4 ? min(...own.map((z, t) => (z === null ? scored(pair, k, t) : Infinity))) + 1e-6 : NaN);
  return [pair.areal[first] ?? Infinity, ...ys.slice(1)];
}
function overVelocity(pair, t, xs) {
  const asked = wanted(), fast = speeds(pair, t, asked[t]);
  return curve(pair, xs, k =>
    !testsOf(pair, k).unsound && states(pair, k, t, asked[t]) && asked.every((z, i) => i === t || verdict(pair, k, i, z) >= STOPPED) ? fast[k] + 1e-4 : NaN);
}

// Greatest velocities at which designs do what is required, minus those of one threat or all, m/s; NaN for some.
function reserve(pair, asked, keeps, only) {
  const most = Float64Array.from(pair.areal, (_, k) => (keeps(k) ? Infinity : NaN));
  for (const t of only === undefined ? threats.keys() : [only]) {
    const values = speeds(pair, t, asked[t]);
    for (let k = 0; k < most.length; k++) most[k] = min(most[k], values[k] - state.velocities[t]);
  }
  return most;
}

// --- words

const trimmed = x => String(+x.toFixed(3));
const areal = x => x.toFixed(1);
// As `beside` of Python.
function beside(value, bound, digits, atMost) {
  if (isFinite(bound)) digits = max(digits, (String(+bound.toPrecision(10)).split(".")[1] ?? "").length);
  const scale = 10 ** digits, side = atMost ? -1 : 1;
  let rounded = floor(value * scale + 0.5 + 1e-6) / scale;
  if (side * value < side * bound && side * bound <= side * rounded) rounded = (atMost ? ceil : floor)(value * scale) / scale;
  return rounded.toFixed(digits);
}
const weight = (pair, k) => `${areal(pair.areal[k])} kg/m²${pair.hull && ` (${whole(pair, k)} with the back plate, which exists)`}`;
const whole = (pair, k) => areal(pair.areal[k] + pair.hull);
const signed = x => `${x < 0 ? "−" : "+"}${areal(abs(x))}`;
// A probability is rounded down, so that none is shown that is not reached; it is as exact as the one required.
function chance(z, p = null) {
  const digits = p === null ? 0 : (String(+(100 * p).toPrecision(8)).split(".")[1] ?? "").length;
  if (isNaN(z)) return "not known";
  if (z === Infinity || (below(z) > 0.99 && !digits)) return `above ${trimmed(100 * (digits ? DATA.probabilities[0] : 0.99))} %`;
  return below(z) < 0.01 ? "below 1 %" : `${(floor(100 * below(z) * 10 ** digits + 1e-4) / 10 ** digits).toFixed(digits)} %`;
}
function stops(pair, k, t) {
  const z = scored(pair, k, t), { floor } = testsOf(pair, k).threats[t];
  return `${floor && below(z) <= 0.99 ? "at least " : ""}${chance(z, required()[t])}`;
}
const letter = t => (T > 1 ? `${mark(t)} ` : "");
const shot = t => `${threats[t].words[0]} at ${trimmed(state.velocities[t])} m/s${threats[t].words[1]}`;
function thicknesses(pair, k) {
  const m = pair.backings.length;
  return [pair.ceramics[floor(k / m)], pair.backings[k % m]];
}
const layers = (pair, k, ceramic, backing) => `${tile(pair, k) ? `${trimmed(tile(pair, k))}${ceramic} on ` : ""}${trimmed(thicknesses(pair, k)[1])} ${backing}`;
const armour = (pair, k) => layers(pair, k, ` mm ${pair.ceramic}`, `mm ${pair.backing}`);
const short = (pair, k) => layers(pair, k, "", "mm");
const thickness = (pair, k) => tile(pair, k) + thicknesses(pair, k)[1] * !pair.hull + DATA.added.thickness;
// The threat that decides: that of the worst verdict and, of equals, the likeliest to fail.
function deciding(pair, k) {
  const by = threats.map((_, t) => {
    const known = tells(pair, k, t), shown = limit(pair, k, t), v = state.velocities[t];
    return [verdict(pair, k, t), known ? below(scored(pair, k, t)) - required()[t] : shown - v - threats[t].margin, shown / v];
  });
  return [...by.keys()].sort((a, b) => by[a][0] - by[b][0] || by[a][1] - by[b][1] || by[a][2] - by[b][2])[0];
}
const worst = (pair, k, t = deciding(pair, k)) => (tells(pair, k, t) ? stops(pair, k, t) : DATA.verdicts[verdict(pair, k, t)]);
// The probability required against all threats; null: others against some.
function percent() {
  const asked = new Set(required());
  return asked.size > 1 ? null : `${trimmed(100 * ([...asked][0] ?? 0.5))} %`;
}
const doesStop = () => (percent() && !margins ? `stops with ${percent()}` : "does what is required");
const byModel = (pair, k, t) => (tells(pair, k, t) ? "expected" : "by the model");
const limitText = (pair, k, t) => beside(limit(pair, k, t), state.velocities[t] + threats[t].margin, 0);
// Speed up to which a shot is stopped with the required or the usual probability; "" where that is not stated.
const usual = t => required()[t] ?? DATA.usual;
function safe(pair, k, t) {
  const z = scoreOf(usual(t)), d = k * T + t;
  return tells(pair, k, t) && pair.most[d] >= z - 1e-6 ? `${beside(stopped(pair, d, z), state.velocities[t], 0)} m/s` : "";
}
// In what a design is far from the tests.
function far(pair, k, t) {
  const { tiles, plates, far } = testsOf(pair, k).threats[t], m = pair.backings.length;
  return [pair.untested && tile(pair, k) ? `${pair.ceramic} (no test)` : "", tiles[floor(k / m)], plates[k % m], ...far].filter(Boolean).join(", ");
}
const isFar = (pair, k) => threats.some((_, t) => far(pair, k, t));
const bounded = (pair, k) => [["areal density", pair.areal[k], state.most, "kg/m²"], ["thickness", thickness(pair, k), DATA.thickest ?? Infinity, "mm"]];
// What optimise and check say of a design.
function headline(pair, k) {
  if (k === null) return `No ${pair.name} is on offer within the limits of the scenario.`;
  const found = judged(pair, k), untold = threats.some((_, t) => !tells(pair, k, t));
  const least = found <= PERFORATED ? "nearest" : untold ? "lightest by the model" : found === NOT_KNOWN ? "lightest with tests" : "lightest";
  const amounts = bounded(pair, k).map(([, value, most, unit]) => `${beside(value, most, 1, true).replace(unit === "mm" ? /\.0$/ : "", "")}${isFinite(most) ? ` of at most ${trimmed(most)}` : ""} ${unit}`);
  return `${least}: ${armour(pair, k)}, ${amounts.join(", ")}`;
}
function sentence(pair, k) {
  const found = judged(pair, k), word = DATA.verdicts[found], alike = T > 1 && new Set(threats.map((_, t) => verdict(pair, k, t))).size === 1;
  const over = bounded(pair, k).filter(([, value, most]) => value > most + 1e-9).map(([what, value, most, unit]) => `${what} ${beside(value, most, 1, true)} ${unit}, at most ${trimmed(most)} ${unit} allowed`);
  if (over.length || pair.excluded.has(k)) return `${word}: ${over.join("; ") || "cost beyond the most allowed"}`;
  const kept = (margins || DATA.limited || DATA.thickest || isFinite(state.most)) && (found === STOPPED || found === EXPECTED);
  return `${word}${alike ? " against every threat" : ""}: ${reasons(pair, k, deciding(pair, k))}${kept ? "; keeps all limits of [design]" : ""}`;
}
function reasons(pair, k, t) {
  const tests = testsOf(pair, k), found = verdict(pair, k, t), p = required()[t], { margin } = threats[t], name = shot(t);
  const asked = `(${p === null ? "none required" : `${trimmed(100 * p)} % required`})${DATA.exact ? ", with exact inputs" : ""}`, limited = `limit ${limitText(pair, k, t)} m/s`;
  if (tests.unsound) return tests.unsound;
  const above = limit(pair, k, t) - state.velocities[t] + 1e-4;
  if (margin && above < margin) return `${limited} ${byModel(pair, k, t)} against ${name}; ${margin} m/s above it required`;
  const likely = stops(pair, k, t);
  if (tells(pair, k, t)) return found === EXPECTED ? `a shot of ${name}, with ${likely} ${asked}` : `stops a shot of ${name} with ${found === NOT_KNOWN ? `at most ${likely} so far from the tests` : likely} ${asked}`;
  if (found === STOPPED || found === PERFORATED) return `${name}, ${limited}`;
  return `${found === NOT_KNOWN ? `${tests.threats[t].why}; ` : ""}${name} ${above < 0 ? "perforates" : "is stopped"} by the model, ${limited}`;
}
function besides(pair, best, ring) {
  const words = best === null ? [] : pair.caveats.filter(each => thicknesses(pair, best)[0] <= each[1]).map(each => each[0]);
  if (ring !== null) words.push(`Without a required probability: ${short(pair, ring)}, ${areal(pair.areal[ring])} kg/m².`);
  return words.join(" ");
}
// Order of pairs by what is shown of them.
function better([p, a], [q, b]) {
  if (a.k === null || b.k === null) return (a.k === null) - (b.k === null);
  return b.rank - a.rank || isKnown(q, b.k) - isKnown(p, a.k) || a.lack - b.lack || p.areal[a.k] - q.areal[b.k];
}

// Quote for a shell.
const quoted = word => (/^[\w@%+=:,./-]+$/.test(word) ? word : `'${word.replaceAll("'", `'"'"'`)}'`);
function command(pair, k) {
  const t = deciding(pair, k), threat = threats[t], [c, b] = thicknesses(pair, k), own = DATA.own;
  const changes = new Map(DATA.changes.map(change => [change.split("=")[0].trim(), change]));
  const set = (key, value, same) => same !== value && changes.set(key, `${key}=${typeof value === "string" ? JSON.stringify(value) : value}`);
  if (pair.ceramic) {
    set("armour.ceramic", pair.ceramic, own.ceramic);
    set("armour.ceramic_thickness_mm", c);
  }
  set("armour.backing", pair.backing, own.backing);
  set("armour.backing_thickness_mm", b);
  set("impact.projectile", threat.projectile, own.projectile);
  set("impact.velocity_m_s", state.velocities[t], own.velocity);
  set("impact.obliquity_deg", threat.obliquity, own.obliquity);
  return [...DATA.command, ...[...changes.values()].flatMap(change => ["--set", change])].map(quoted).join(" ");
}

// --- elements

const SVG = "http://www.w3.org/2000/svg";
function make(element, attributes, children) {
  for (const [name, value] of Object.entries(attributes ?? {})) element.setAttribute(name, value);
  element.append(...children.filter(each => each !== null));
  return element;
}
const html = (tag, attributes, ...children) => make(document.createElement(tag), attributes, children);
const svg = (tag, attributes, ...children) => make(document.createElementNS(SVG, tag), attributes, children);
function button(words, act) {
  const made = html("button", { type: "button" }, words);
  on(made, "click", () => act(made));
  return made;
}
const circle = (cx, cy, r, of) => svg("circle", { class: of, cx, cy, r });
// A design, hollow if it is far from the tests.
const spot = (pair, k, [x, y], r, of) => circle(x, y, r, `spot ${of}${isFar(pair, k) ? " far" : ""}`);
const small = (width, height) => svg("svg", { viewBox: `0 0 ${width} ${height}`, "aria-hidden": "true" });
const path = (points, of) => svg("path", { class: of, d: `M${points.map(p => `${p[0].toFixed(1)} ${p[1].toFixed(1)}`).join("L")}` });
const text = (x, y, words, of, more) => svg("text", { x: x.toFixed(1), y: y.toFixed(1), class: of, "font-size": 12, ...more }, words);

// Multiples of 1, 2 or 5 times a power of ten.
function ticks(low, high, count) {
  const raw = (high - low) / count || 1, power = 10 ** floor(Math.log10(raw));
  const step = power * [1, 2, 5, 10].find(m => m * power >= raw * 0.999), found = [];
  for (let n = ceil(low / step - 1e-9); n * step <= high + 1e-9 * step; n++) found.push(+(n * step).toPrecision(12));
  return found;
}

// --- the map

// Lines where a field over the nodes has a value, in pixels; fields are NaN where they are unknown.
function contour(view, field, level) {
  const { n, m, x, y } = view, ends = new Map(), segments = [], used = new Set(), lines = [];
  const at = (a, b, edge) => {
    const part = (level - field[a]) / (field[b] - field[a]), i = floor(a / m), j = a % m;
    return { edge, point: [x[j] + part * (x[b % m] - x[j]), y[i] + part * (y[floor(b / m)] - y[i])] };
  };
  for (let i = 0; i < n - 1; i++)
    for (let j = 0; j < m - 1; j++) {
      const a = i * m + j, side = field[a] < level;
      if (side === field[a + 1] < level && side === field[a + m] < level && side === field[a + m + 1] < level) continue;
      if (isNaN(field[a] + field[a + 1] + field[a + m] + field[a + m + 1])) continue;
      const found = [];
      for (const [p, q, edge] of [[a, a + 1, 2 * a], [a + 1, a + m + 1, 2 * a + 3], [a + m, a + m + 1, 2 * (a + m)], [a, a + m, 2 * a + 1]])
        if (field[p] < level !== field[q] < level) found.push(at(p, q, edge));
      for (let s = 0; s + 1 < found.length; s += 2) {
        const segment = [found[s], found[s + 1]];
        segments.push(segment);
        for (const { edge } of segment) ends.set(edge, [...(ends.get(edge) ?? []), segment]);
      }
    }
  for (const first of segments) {
    if (used.has(first)) continue;
    used.add(first);
    const line = first.map(end => end.point);
    for (const [end, add] of [[1, "push"], [0, "unshift"]])
      for (let { edge } = first[end], next; (next = ends.get(edge).find(each => !used.has(each))); ) {
        used.add(next);
        const other = next[next[0].edge === edge ? 1 : 0];
        line[add](other.point);
        edge = other.edge;
      }
    lines.push(line);
  }
  return lines;
}
// The cells where a field is at least a value, cut at it, in tenths of pixels.
function area(view, field, level, of) {
  const { n, m } = view, [x, y] = [view.x, view.y].map(each => each.map(at => round(10 * at)));
  let drawn = "";
  for (let i = 0; i < n - 1; i++) {
    let start = -1;
    for (let j = 0; j < m; j++) {
      const a = i * m + j, full = j < m - 1 ? (field[a] >= level) + (field[a + 1] >= level) + (field[a + m] >= level) + (field[a + m + 1] >= level) : 0;
      if (full === 4) {
        if (start < 0) start = j;
        continue;
      }
      if (start >= 0) drawn += `M${x[start]} ${y[i]}H${x[j]}V${y[i + 1]}H${x[start]}Z`;
      start = -1;
      if (!full) continue;
      const nodes = [[a, j, i], [a + 1, j + 1, i], [a + m + 1, j + 1, i + 1], [a + m, j, i + 1]];
      if (nodes.some(([k]) => isNaN(field[k]))) continue;
      const corners = [];
      nodes.forEach(([k, l, o], c) => {
        const [p, q, r] = nodes[(c + 1) % 4];
        if (field[k] >= level) corners.push(`${x[l]} ${y[o]}`);
        if (field[k] >= level !== field[p] >= level) {
          const part = (level - field[k]) / (field[p] - field[k]);
          corners.push(`${round(x[l] + part * (x[q] - x[l]))} ${round(y[o] + part * (y[r] - y[o]))}`);
        }
      });
      drawn += `M${corners.join("L")}Z`;
    }
  }
  return svg("path", { class: of, d: drawn, transform: "scale(.1)" });
}

// Kept while pair and width stay.
let view = null;
function viewOf(pair) {
  const narrow = $("map").parentNode.clientWidth < 520;
  const flat = min(pair.ceramics.length, pair.backings.length) > 1;
  const [width, height] = narrow ? [390, 400] : [760, flat ? 600 : 460], frame = { left: flat ? 34 : 52, right: width - 48, top: 8, bottom: height - 24 };
  const scale = (values, from, to) => {
    const [low, high] = values.length > 1 ? [values[0], values.at(-1)] : [values[0] - 1, values[0] + 1];
    return { low, high, at: value => from + (to - from) * (value - low) / (high - low) };
  };
  if (!flat) return lineViewOf(pair, { pair, narrow, width, height, frame, n: pair.ceramics.length, m: pair.backings.length }, scale);
  const across = scale(pair.backings, frame.left, frame.right), up = scale(pair.ceramics, frame.bottom, frame.top);
  const [x, y] = [pair.backings.map(across.at), pair.ceramics.map(up.at)];
  return { pair, grey: {}, equal: {}, width, height, narrow, frame, across, up, n: pair.ceramics.length, m: pair.backings.length, x, y };
}

// How far a design exceeds what is required, m/s, over the thickness if only one varies.
const excess = (pair, k, t) => speeds(pair, t, wanted()[t])[k] - state.velocities[t];
function lineViewOf(pair, view, scale) {
  const { frame } = view, values = view.m > 1 ? pair.backings : pair.ceramics;
  const every = [0, ...pair.areal.keys().flatMap(k => threats.map((_, t) => excess(pair, k, t)))];
  const spare = 0.05 * (max(...every) - min(...every));
  return { ...view, line: true, values, across: scale(values, frame.left + 10, frame.right - 10), up: scale([min(...every) - spare, max(...every) + spare], frame.bottom, frame.top) };
}
function drawLines(pair, lines, words) {
  const { across, up, values, frame } = view, colours = ["blue", "red", "green", "ink"], ends = [];
  lines.append(path([[frame.left, up.at(0)], [frame.right, up.at(0)]], "ink"));
  words.append(text(frame.left + 8, up.at(0) - 6, "required", "halo strong"));
  const at = (n, most) => [across.at(values[n]), up.at(most)];
  threats.forEach((_, t) => {
    const line = values.map((_, n) => at(n, excess(pair, n, t)));
    lines.append(path(line, `limit ${colours[t % 4]}`));
    let y = line.at(-1)[1] + 4;
    while (ends.some(end => abs(end - y) < 13)) y += 13;
    ends.push(y);
    words.append(text(frame.right - 2, y, T > 1 ? mark(t) : "", "strong"));
  });
}

// Distance of words from the frame and other words.
function roomOf(points) {
  const { frame, taken } = view;
  let room = Infinity;
  for (const [x, y] of points) {
    room = min(room, x - frame.left, frame.right - x, y - frame.top, frame.bottom - y);
    for (const [a, b] of taken) room = min(room, Math.sqrt((x - a) ** 2 / 4 + (y - b) ** 2));
  }
  return room;
}
// Put words on the longest line, where there is the most room.
function label(lines, said, of) {
  const { taken, words } = view;
  const line = lines.reduce((a, b) => (b.length > a.length ? b : a), []), half = 3.2 * said.length;
  let best = null, most = 8;
  for (let s = 1; s < line.length - 1; s += ceil(line.length / 40)) {
    const [x, y] = line[s], [a, b] = [line[max(s - 3, 0)], line[min(s + 3, line.length - 1)]];
    let angle = Math.atan2(b[1] - a[1], b[0] - a[0]);
    if (abs(angle) > Math.PI / 2) angle -= Math.PI * Math.sign(angle);
    const points = [-1, 0, 1].map(n => [x + n * half * Math.cos(angle), y + n * half * Math.sin(angle)]), room = roomOf(points);
    if (room > most) [best, most] = [{ x, y, angle, points }, room];
  }
  if (best === null) return;
  const { x, y, angle, points } = best;
  taken.push(...points);
  words.append(text(x, y + 4, said, `halo mid small ${of}`, { transform: `rotate(${(angle * 180 / Math.PI).toFixed(1)} ${x.toFixed(1)} ${y.toFixed(1)})` }));
}
function limitLines(pair, t) {
  // Limits change at once where no probability is known.
  const own = [false, true].map(known => pair.areal.map((_, k) => (tells(pair, k, t) === known ? limit(pair, k, t) : NaN))), group = svg("g");
  const every = [...pair.areal.keys()].map(k => limit(pair, k, t)), levels = ticks(min(...every), max(...every), view.narrow ? 6 : 12);
  const lines = levels.map(level => [level, own.flatMap(some => contour(view, some, level))]);
  for (const [, found] of lines) group.append(...found.map(line => path(line, "grey")));
  return { lines, group };
}
function drawMap(pair, best, ring) {
  if (view?.pair !== pair || view.line) view = viewOf(pair);
  const { frame, width, height, across, up } = view, box = $("map");
  const areas = svg("g"), lines = svg("g"), marks = svg("g"), words = (view.words = svg("g")), taken = (view.taken = []);
  const asked = wanted(), sound = k => !testsOf(pair, k).unsound, flat = !view.line;
  const keeps = k => sound(k) && (isKnown(pair, k) || !pair.known) && asked.every((z, t) => states(pair, k, t, z));
  const fields = {
    asked: reserve(pair, asked, keeps), byModel: reserve(pair, none, k => !isKnown(pair, k)),
    unstated: reserve(pair, asked, k => isKnown(pair, k) && sound(k)),
    fails: pair.areal.map((_, k) => (isKnown(pair, k) && sound(k) ? max(...threats.map((_, t) => state.velocities[t] - limit(pair, k, t))) : NaN)),
  };
  if (!flat) drawLines(pair, lines, words);
  else areas.append(area(view, fields.byModel.map(v => (pair.known || anyAsked()) - isNaN(v)), 1e-3, "unknown"), area(view, fields.unstated, 0, "unknown"), area(view, fields.fails, 0, "fails"), area(view, fields.asked, 0, "stops"));

  // Designs first: labels of lines keep clear of their words.
  const right = [], bestOf = best !== null && isGood(pair, best) ? "best" : "poor";
  const colours = [[ring, "even", "t-red", "red thin"], [best, bestOf, bestOf === "best" ? "t-blue" : "strong", "blue thin"]];
  for (const [k, of, colour, line] of colours) {
    if (k === null || (of === "even" && k === best)) continue;
    const [x, y] = placeOf(pair, k), above = of !== "even";
    marks.append(spot(pair, k, [x, y], above ? 7 : 6, of));
    const said = [short(pair, k), `${areal(pair.areal[k])} kg/m², ${worst(pair, k)}`], room = 6.6 * max(...said.map(w => w.length));
    const side = (above ? x + 12 + room < width : x - 12 - room < frame.left) ? 1 : -1, top = y + (above ? -20 : 18);
    said.forEach((w, n) => words.append(text(x + 12 * side, top + 14 * n, w, `halo ${side > 0 ? "" : "end"} ${colour}`)));
    taken.push([x, y], ...[0.2, 0.5, 0.8].map(part => [x + side * (12 + part * room), top + 4]));
    right.push([pair.areal[k], line, colour]);
  }

  const { tile: tiles, plate: plates } = pair.tested[1]?.threats[state.lines === "none" ? 0 : +state.lines] ?? {};
  if (state.tests && pair.known && tiles && plates && flat) {
    const cut = (value, of) => of.at(min(max(value, of.low), of.high)), [left, end] = plates.map(mm => cut(mm, across)), [low, high] = tiles.map(mm => cut(mm, up));
    if (end > left && low > high) {
      lines.append(svg("rect", { class: "green", x: left, y: high, width: end - left, height: low - high }));
      taken.push([end - 30, high - 8], [end - 80, high - 8]);
      words.append(text(end - 4, high - 5, "thicknesses tested", "halo end small t-green"));
    }
  }
  const heights = [];
  // Lines of equal areal density are straight.
  const straight = (value, of, colour, said) => {
    const [line] = (view.equal[value] ??= contour(view, pair.areal, value));
    if (!line) return;
    const ends = [line[0], line.at(-1)].sort((a, b) => a[0] - b[0]), [x, y] = ends[1];
    lines.append(path(ends, of));
    if (x > frame.right - 1 && heights.every(h => abs(h - y) > 13)) {
      heights.push(y);
      words.append(text(frame.right + 9, y + 4, said, colour));
    }
  };
  if (flat) {
    for (const [value, of, colour] of right.reverse()) straight(value, of, colour, areal(value));
    for (const value of ticks(pair.areal[0], pair.areal.at(-1), view.narrow ? 4 : 6)) straight(value, "dotted", "t-soft", trimmed(value));
    const grey = state.lines === "none" ? null : (view.grey[state.lines] ??= limitLines(pair, +state.lines));
    if (grey) lines.append(grey.group);
    const front = svg("g");
    const drawn = (field, of, said, colour) => {
      const found = contour(view, field, 0);
      front.append(...found.map(line => path(line, of)));
      label(found, said, colour);
    };
    drawn(fields.byModel, "ink", "stopped by the model", "strong");
    if (pair.known) {
      drawn(fields.fails, "red", "stops with 50 %", "t-red");
      if (anyAsked() || margins) drawn(fields.asked, "blue", doesStop(), "t-blue");
      if (anyAsked() && T > 1 && T < 5) threats.forEach((_, t) => drawn(reserve(pair, asked, keeps, t), "blue fine", mark(t), "t-blue"));
    }
    if (grey)
      for (const [level, found] of grey.lines) label(found, String(level), "t-soft");
    lines.append(front);
  }
  if (pair.onOffer.length <= 400) for (const k of pair.onOffer) lines.append(spot(pair, k, placeOf(pair, k), 2.6, isGood(pair, k) ? "dot on" : "dot"));
  const axes = svg("g");
  axes.append(svg("rect", { class: "frame", x: frame.left, y: frame.top, width: frame.right - frame.left, height: frame.bottom - frame.top }));
  const bottom = flat ? pair.backings : view.values, marked = bottom.length > 1 ? ticks(across.low, across.high, view.narrow ? 5 : 8) : bottom;
  for (const b of marked) axes.append(text(across.at(b), frame.bottom + 16, trimmed(b), "t-soft mid"));
  for (const c of ticks(up.low, up.high, view.narrow ? 5 : 9))
    axes.append(text(frame.left - 6, up.at(c) + 4, flat ? trimmed(c) : (c > 0 ? "+" : "") + trimmed(c).replace("-", "−"), "t-soft end"));
  box.setAttribute("viewBox", `0 0 ${width} ${height}`);
  box.setAttribute("aria-label", `Map of ${pair.name}. ${headline(pair, answer(pair).k)}`);
  box.replaceChildren(areas, lines, axes, marks, words, svg("g", { id: "over" }));
  const tints = pair.known ? `Blue: ${doesStop()}. Red: below 50 %. Grey: not known.` : anyAsked() ? "Grey: not known." : "Blue: stopped by the model.";
  const legend = flat ? [tints, "Dotted: equal areal density.", ...(state.lines === "none" ? [] : [`Thin: equal limit, ${pair.known ? "expected" : "by the model"}, m/s.`])] : [];
  legend.push(pair.onOffer.length > 400 ? "" : "Dots: on offer, blue where they hold.", "Hollow: far from the tests.");
  $("options").style.display = flat ? "" : "none";
  $("legend").textContent = legend.join(" ");
  $("areal-name").hidden = !flat;
  const [up_, right_] = [`tile ${pair.ceramic}, mm`, `plate ${pair.backing}, mm`], lineOf = !pair.known ? "limit by the model" : anyAsked() ? "speed that is stopped as required" : "expected limit";
  $("y-name").textContent = flat ? `↑ ${up_}` : `↑ ${lineOf}, less velocity${margins ? " and margin" : ""}, m/s`;
  $("x-name").textContent = `${flat || view.m > 1 ? right_ : up_} →`;
  drawOver(pair);
}

const placeOf = (pair, k) =>
  view.line ? [view.across.at(view.values[k]), view.up.at(min(...threats.map((_, t) => excess(pair, k, t))))] : [view.x[k % view.m], view.y[floor(k / view.m)]];
// The pointer and the pins.
function drawOver(pair) {
  const over = $("over"), { frame } = view;
  over.replaceChildren();
  state.pins.forEach((pin, n) => {
    if (pin.pair !== pair) return;
    const [x, y] = placeOf(pair, pin.k);
    over.append(circle(x, y, 8, "pin"), text(x, y + 4, n + 1, "pin-text mid"));
  });
  if (state.cursor === null) return;
  const [c, b] = thicknesses(pair, state.cursor), [x, y] = placeOf(pair, state.cursor);
  over.append(path([[frame.left, y], [x, y]], "cross"), path([[x, frame.bottom], [x, y]], "cross"), circle(x, y, 8, "cursor"));
  const chip = (cx, cy, said, width) => over.append(svg("rect", { class: "pin", x: cx - width / 2, y: cy - 10, width, height: 19, rx: 3 }), text(cx, cy + 4, said, "pin-text mid"));
  if (pair.ceramic && !view.line) chip(frame.left - 15, y, trimmed(c), 32);
  chip(x, frame.bottom + 13, trimmed(view.line && view.m === 1 ? c : b), 32);
  const said = `${areal(pair.areal[state.cursor])} kg/m² · ${worst(pair, state.cursor)}`, width = 7 * said.length + 8;
  chip(min(max(x, frame.left + width / 2), view.width - width / 2), y > 40 ? y - 24 : y + 26, said, width);
}

function drawPairs() {
  const box = $("pairs");
  box.hidden = DATA.pairs.length < 2;
  if (box.hidden) return;
  const rows = DATA.pairs.map(pair => [pair, answer(pair).k, even(pair)]);
  const values = rows.flatMap(([p, a, b]) => [a, b].filter(k => k !== null).map(k => p.areal[k]));
  const low = min(...values), high = max(...values), at = v => 8 + 80 * (high > low ? (v - low) / (high - low) : 0.5);
  const focused = box.contains(document.activeElement);
  box.replaceChildren(box.querySelector("legend"), ...rows.map(([pair, best, ring], n) => {
    const input = html("input", { type: "radio", name: "pair", value: n });
    input.checked = current() === pair;
    on(input, "change", () => { state.pair = n; state.cursor = null; draw(); });
    const picture = small(210, 18);
    const places = [ring, best].filter(k => k !== null).map(k => at(pair.areal[k]));
    if (places.length === 2) picture.append(path([[places[0], 9], [places[1], 9]], "frame"));
    if (ring !== null) picture.append(spot(pair, ring, [at(pair.areal[ring]), 9], 4, "even"));
    const found = best === null ? FAILS : judged(pair, best);
    if (best !== null) picture.append(spot(pair, best, [at(pair.areal[best]), 9], 5, found >= STOPPED ? "best" : "poor"));
    const said = best === null ? "none" : areal(pair.areal[best]) + (found > STOPPED ? "" : found === STOPPED ? " by the model" : `, ${DATA.verdicts[found]}`);
    picture.append(text(places.length ? max(...places) + 9 : 8, 13, said, "small"));
    return html("div", { class: "pair" }, html("label", {}, input, ` ${pair.name}`), picture);
  }));
  if (focused) box.querySelector("input:checked").focus();
}

// Draw a curve above a slider, and the place of its value.
function drawCurve(slider, xs, ys, value) {
  const real = ys.filter(isFinite), picture = slider.picture, at = x => 4 + 292 * (x - xs[0]) / (xs.at(-1) - xs[0]);
  picture.replaceChildren();
  if (!real.length) return picture.append(text(4, 28, "none", "t-soft small"));
  const low = min(...real), high = max(...real), up = y => 34 - 14 * (high > low ? (y - low) / (high - low) : 0);
  const points = xs.map((x, n) => [at(x), up(ys[n])]).filter((_, n) => isFinite(ys[n]));
  picture.append(path(points, "frame"), text(4, points[0][1] - 5, areal(real[0]), "t-soft small"));
  const [end, top] = points.at(-1);
  if (end - at(value) > 80) picture.append(text(end, top - 5, areal(real.at(-1)), "t-soft small end"));
  if (end < 215) picture.append(text(300, 40, "none", "t-soft small end"));
  const pair = current(), { k: best } = answer(pair);
  if (best === null || !isGood(pair, best)) return;
  const x = at(value), y = up(pair.areal[best]);
  picture.append(spot(pair, best, [x, y], 4, "best"));
  if (x > 50) picture.append(text(min(x, 266), y - 8, `${areal(pair.areal[best])} kg/m²`, "strong small mid"));
}
const sliders = [];
function slider(name, low, high, step, value, said, changed, points, into = $("sliders")) {
  const input = html("input", { type: "range", min: low, max: high, step, "aria-label": name }), output = html("output");
  input.value = value;
  const picture = small(300, 42);
  const made = { input, picture, show: () => {
    output.textContent = said();
    input.setAttribute("aria-valuetext", said());
    if (points) points(made);
  } };
  on(input, "input", () => { changed(+input.value); state.cursor = null; frame ??= requestAnimationFrame(draw); });
  into.append(html("div", { class: "slider" }, html("div", {}, html("span", {}, name), output), points ? picture : null, input));
  sliders.push(made);
}
function makeSliders() {
  const spread = (low, high, count) => Array.from({ length: count + 1 }, (_, n) => low + (high - low) * n / count), percents = spread(50, 99, 49);
  if (threats.some(t => t.own === null))
    slider("Required probability", 50, 99, state.probability === null || Number.isInteger(state.probability) ? 1 : "any", state.probability ?? 50,
      () => (state.probability === null ? "none" : `${trimmed(state.probability)} %`),
      value => { state.probability = value > 50 ? value : null; },
      made => drawCurve(made, percents, overProbability(current(), percents), state.probability ?? 50));
  // Many sliders would hide what follows.
  const many = T > 3 ? html("details", {}, html("summary", {}, `Velocities of the ${T} threats`)) : null;
  if (many) $("sliders").append(many);
  threats.forEach((threat, t) => {
    const reach = max(round(0.35 * threat.velocity), 1), low = threat.velocity - reach, high = threat.velocity + reach, xs = spread(low, high, 60);
    const own = threat.own === null ? "" : `, ${trimmed(100 * threat.own)} % required`;
    slider(`${letter(t)}${threat.name}${threat.obliquity ? ` at ${threat.obliquity}°` : ""}${own}`, low, high, 1, threat.velocity,
      () => `${trimmed(state.velocities[t])} m/s${threat.margin ? `, limit ${threat.margin} above` : ""}`,
      value => { state.velocities[t] = value; },
      made => drawCurve(made, xs, overVelocity(current(), t, xs), state.velocities[t]), many ?? $("sliders"));
  });
  const every = DATA.pairs.flatMap(p => [p.areal[0], p.areal.at(-1)]), low = floor(min(...every)), high = ceil(max(...every));
  slider("Greatest areal density", low, high, 0.5, min(state.most, high), () => (state.most < Infinity ? `${trimmed(state.most)} kg/m²` : "any"),
    value => { state.most = value < high ? value : Infinity; });
}

function crossSection(pair, k) {
  const [c, b] = thicknesses(pair, k), rods = threats.map(t => t.rod), longest = max(...rods.map(r => r[0]));
  const [front, between, behind] = DATA.layers, layers = [...front, ["ceramic", c], ...between, ["metal", b], ...behind], thick = layers.reduce((sum, of) => sum + of[1], 0);
  const angles = threats.map(t => t.obliquity * Math.PI / 180), rows = rods.map((r, t) => 1.7 * r[1] + 2 + r[0] * Math.sin(angles[t])), tall = max(rows.reduce((a, d) => a + d, 0), 0.8 * thick), wide = longest + thick + 12, gap = longest + 3;
  const font = max(wide, tall * 2) / 26, picture = svg("svg", { viewBox: `0 0 ${max(wide, tall * 2)} ${tall + 3.4 * font}`, role: "img", "aria-label": `Cross-section to scale: ${armour(pair, k)}` });
  const sized = { "font-size": font }, top = 1.4 * font;
  let x = gap;
  for (const [kind, mm, name] of layers) {
    picture.append(svg("rect", { class: kind, x, y: top, width: mm, height: tall }, name ? svg("title", {}, name) : null));
    x += mm;
  }
  picture.append(text(gap + thick / 2, font, short(pair, k), "mid", sized));
  let y = top + (tall - rows.reduce((a, d) => a + d, 0)) / 2;
  rods.forEach((rod, t) => {
    const middle = y + rows[t] - 0.85 * rod[1] - 1, tip = gap - 2 - 0.5 * rod[1] * Math.sin(angles[t]);
    const drawn = svg("g", { transform: `rotate(${threats[t].obliquity} ${tip} ${middle})` }, svg("rect", { class: "rod", x: tip - rod[0], y: middle - rod[1] / 2, width: rod[0], height: rod[1] }));
    if (T > 1) drawn.append(text(tip - rod[0] / 2, middle + font / 3, mark(t), "pin-text mid", sized));
    picture.append(drawn);
    y += rows[t];
  });
  const base = top + tall + 1.2 * font;
  picture.append(svg("rect", { class: "pin", x: 1, y: base - 0.3, width: 10, height: font / 12 }), text(12, base + font / 3, "10 mm", "", sized));
  return picture;
}
// Distribution of the velocities up to which a shot is stopped, 1 to 99 %, cut at the velocity.
function distribution(pair, d, v) {
  const V = pair.stops, o = d * Q, low = V[o], high = V[o + Q - 1], from = min(low, v), to = max(high, v);
  const at = x => 300 * (x - from) / (to - from), count = 240, heights = [];
  for (let n = 0; n <= count; n++) {
    const x = low + (high - low) * n / count, h = (high - low) / count;
    heights.push([x, below(byTests(pair, d, max(x - h, low))) - below(byTests(pair, d, min(x + h, high)))]);
  }
  heights[0][1] = heights[1][1] / 2;
  heights[count][1] = heights[count - 1][1] / 2;
  const most = max(...heights.map(h => h[1])), shape = points => points.length > 1 ? `M${at(points[0][0])} 44${points.map(p => `L${at(p[0]).toFixed(1)} ${(44 - 38 * p[1] / most).toFixed(1)}`).join("")}L${at(points.at(-1)[0])} 44Z` : "";
  const picture = small(300, 46);
  picture.append(svg("path", { class: "below", d: shape(heights.filter(h => h[0] <= v)) }), svg("path", { class: "above", d: shape(heights.filter(h => h[0] >= v)) }));
  picture.append(path([[at(v), 2], [at(v), 46]], "bar"));
  return picture;
}
function drawDesign(pair, best) {
  const k = state.cursor ?? best, box = $("design"), focused = box.contains(document.activeElement);
  box.replaceChildren();
  if (k === null) return box.append(html("p", { class: "soft" }, "Point at a design to read it."));
  const pinned = state.pins.some(p => p.pair === pair && p.k === k);
  box.append(html("h2", {}, armour(pair, k)));
  const difference = best === null || k === best ? "" : ` (${signed(pair.areal[k] - pair.areal[best])})`;
  box.append(html("p", {}, `${weight(pair, k)}${difference}, ${trimmed(thickness(pair, k))} mm thick`));
  if (k !== best) box.append(html("p", { class: COLOURS[judged(pair, k)] }, sentence(pair, k)));
  box.append(crossSection(pair, k));
  const row = (name, value, of) => value && box.append(html("div", { class: "row" }, html("span", {}, name), html(of ?? "b", {}, value)));
  threats.forEach((_, t) => {
    const d = k * T + t;
    box.append(html("h3", {}, `${letter(t)}${shot(t)}`));
    row("stops", stops(pair, k, t));
    if (tells(pair, k, t)) box.append(distribution(pair, d, state.velocities[t]));
    row(`limit ${byModel(pair, k, t)}`, `${limitText(pair, k, t)} m/s`);
    row(`${trimmed(100 * usual(t))} % up to`, safe(pair, k, t));
    row("far from the tests", far(pair, k, t), "i");
  });
  box.append(button(pinned ? "Remove the pin" : "Pin this design", () => pin(k)));
  if (focused) box.lastChild.focus();
}
function pin(k) {
  const pair = current(), place = state.pins.findIndex(p => p.pair === pair && p.k === k);
  if (place >= 0) state.pins.splice(place, 1);
  else state.pins = [...state.pins, { pair, k }].slice(-6);
  drawOver(pair);
  drawDesign(pair, answer(pair).k);
  drawTable(pair, answer(pair).k, even(pair));
}
const parts = words => words.split(/ (?=--set )/).flatMap(part => [html("span", {}, part), " "]);
async function copy(words, code, button) {
  try {
    await navigator.clipboard.writeText(words);
    button.textContent = "Copied";
  } catch {
    getSelection().selectAllChildren(code);
    button.textContent = "Selected";
  }
}
function drawTable(pair, best, ring) {
  const rows = [[pair, best, "●", "t-blue"], [pair, ring === best ? null : ring, "●", "t-red"], ...state.pins.map((p, n) => [p.pair, p.k, n + 1, "disc", p])].filter(row => row[1] !== null);
  const from = best === null ? null : pair.areal[best];
  const shown = k => (T > 2 ? [deciding(current(), k)] : threats.map((_, t) => t));
  const heads = ["armour", "kg/m²", ...(current().hull ? ["whole"] : []), ...(from === null ? [] : [`from ${areal(from)}`]), ...(T > 2 ? ["decides", "limit, m/s", "stops"] : threats.flatMap((_, t) => [`${letter(t)}limit, m/s`, `${letter(t)}stops`]))];
  const body = html("tbody");
  for (const [of, k, sign, colour, pinned] of rows) {
    const difference = from === null ? 0 : of.areal[k] - from;
    const cells = [areal(of.areal[k]), ...(of.hull ? [whole(of, k)] : []), ...(from === null ? [] : [abs(difference) < 0.05 ? "" : signed(difference)]),
      ...shown(k).flatMap(t => [...(T > 2 ? [mark(t)] : []), limitText(of, k, t) + (tells(of, k, t) ? "" : "*"), stops(of, k, t)])];
    body.append(html("tr", {}, html("td", {}, html("span", {}, html("span", { class: colour }, sign), " ", armour(of, k))), ...cells.map((cell, i) => html("td", { "data-label": heads[i + 1] }, html("span", {}, cell)))));
    const words = command(of, k), code = html("code", {}, ...parts(words));
    const remove = pinned ? button("Remove", () => { state.pins = state.pins.filter(p => p !== pinned); draw(); }) : null;
    body.append(html("tr", { class: "command" }, html("td", { colspan: heads.length }, code, button("Copy", made => copy(words, code, made)), " ", remove)));
  }
  $("table").replaceChildren(html("table", {}, html("thead", {}, html("tr", {}, ...heads.map(each => html("th", { scope: "col" }, each)))), body));
  if (body.textContent.includes("*")) $("table").append(html("p", { class: "soft" }, "* by the model"));
}
function drawNotes(pair) {
  const said = [
    DATA.answer.length && `As the scenario asks: ${DATA.answer.join("; ")}.`,
    pair.known && `Probabilities of ${pair.name} rest on: ${[...new Set(pair.tested.flatMap(tests => tests?.threats.map(each => each.source) ?? []))].filter(Boolean).join("; ")}.`,
    `${pair.onOffer.length.toLocaleString("en")} designs of this pair are on offer, and exact; lines between them are interpolated.${pair.coarser ? " To keep the page small, they are coarser than they could be." : ""}`,
    ...DATA.notes,
  ];
  $("notes").replaceChildren(...said.filter(Boolean).map(each => html("p", {}, each)));
}

const COLOURS = ["t-red", "t-red", "t-yellow", "", "", "t-green"];
let frame = null;
function draw() {
  frame = null;
  const pair = current(), found = answer(pair), best = found.k, ring = even(pair);
  $("headline").textContent = headline(pair, best);
  $("verdict").textContent = best === null ? "" : sentence(pair, best);
  $("verdict").className = best === null ? "" : COLOURS[judged(pair, best)];
  $("beside").textContent = besides(pair, best, ring);
  drawMap(pair, best, ring);
  drawPairs();
  for (const each of sliders) each.show();
  drawDesign(pair, best);
  drawTable(pair, best, ring);
  drawNotes(pair);
}

// --- pointer and keys

function move(k) {
  if (k === state.cursor) return;
  const pair = current();
  state.cursor = k;
  drawOver(pair);
  drawDesign(pair, answer(pair).k);
}
function nearest(event) {
  const pair = current(), box = $("map").getBoundingClientRect(), factor = view.width / box.width;
  const [x, y] = [(event.clientX - box.left) * factor, (event.clientY - box.top) * factor];
  if (view.line) return pair.onOffer.reduce((a, b) => (abs(placeOf(pair, b)[0] - x) < abs(placeOf(pair, a)[0] - x) ? b : a));
  const closest = (places, at, to) => places.reduce((a, b) => (abs(at[b] - to) < abs(at[a] - to) ? b : a));
  return closest(pair.offered[0], view.y, y) * view.m + closest(pair.offered[1], view.x, x);
}
function keyed(event) {
  const pair = current(), moves = { ArrowUp: [1, 0], ArrowDown: [-1, 0], ArrowRight: [0, 1], ArrowLeft: [0, -1] };
  if (view.line && view.m === 1) Object.assign(moves, { ArrowRight: [1, 0], ArrowLeft: [-1, 0] });
  if (event.key === "Home") move(answer(pair).k);
  else if (event.key === "Escape") move(null);
  else if (event.key === "Enter") { if ((state.cursor ?? answer(pair).k) !== null) pin(state.cursor ?? answer(pair).k); }
  else if (moves[event.key]) {
    const at = state.cursor ?? answer(pair).k ?? pair.onOffer[0], from = [floor(at / view.m), at % view.m], step = event.shiftKey ? 5 : 1;
    const [i, j] = [0, 1].map(axis => {
      const of = pair.offered[axis], place = of.indexOf(from[axis]) + step * moves[event.key][axis];
      return of[min(max(place, 0), of.length - 1)];
    });
    move(i * view.m + j);
  } else return;
  event.preventDefault();
}
function start() {
  DATA.pairs.forEach(decoded);
  state.pair = DATA.pairs.map((p, n) => [p, answer(p), n]).sort(better)[0][2];
  for (let t = 0; t < T; t++) $("lines").append(html("option", { value: t }, T > 1 ? `limit against ${mark(t)}` : "limit"));
  $("lines").append(html("option", { value: "none" }, "areal density only"));
  makeSliders();
  on($("lines"), "change", () => { state.lines = $("lines").value; draw(); });
  on($("tests"), "change", () => { state.tests = $("tests").checked; draw(); });
  const map = $("map");
  on(map, "pointermove", event => move(nearest(event)));
  on(map, "pointerdown", event => move(nearest(event)));
  on(map, "pointerleave", event => event.pointerType !== "touch" && move(null));
  on(map, "click", event => event.pointerType !== "touch" && pin(nearest(event)));
  on(map, "keydown", keyed);
  let width = innerWidth;
  addEventListener("resize", () => { if (innerWidth !== width) { width = innerWidth; view = null; draw(); } });
  draw();
}
start();
