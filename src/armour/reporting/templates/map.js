"use strict";
// Answers are for thicknesses on offer; lines between them are interpolated.
const DATA = JSON.parse(document.getElementById("data").textContent);
const { threats, scores } = DATA, T = threats.length, Q = scores.length;
const margins = threats.some(t => t.margin);
const mark = t => (t + 10).toString(36).toUpperCase();
const { abs, floor, max, min, round } = Math;
const $ = id => document.getElementById(id);

// --- numbers

const bytes = text => Uint8Array.from(atob(text), each => each.charCodeAt(0)).buffer;

// Ballistic limits, stopped velocities, by score (NaN: unknown), and the greatest scores that are stated.
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
  const excluded = new Set(pair.excluded), rank = pair.areal.map(each => round(each * 1e9));
  pair.onOffer = pair.offered[0].flatMap(i => pair.offered[1].map(j => i * m + j));
  // Sort by areal density; equals keep their order.
  pair.designs = pair.onOffer.filter(k => !excluded.has(k)).sort((a, b) => rank[a] - rank[b] || a - b);
  pair.said = pair.untested ? `${pair.ceramic} (untested)` : pair.ceramic;
  pair.name = pair.ceramic ? `${pair.said} on ${pair.backing}` : pair.backing;
  pair.unknown = Uint8Array.from(pair.areal, (_, k) => threats.some((_, t) => isNaN(pair.stops[(k * T + t) * Q])));
  pair.known = pair.unknown.includes(0);
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
// The score that is stated: at most the greatest.
const score = (pair, d, v) => min(byTests(pair, d, v), pair.most[d]);
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
  pair: 0, confidence: DATA.confidence ? 100 * DATA.confidence : null, velocities: threats.map(t => t.velocity),
  most: DATA.most ?? Infinity, lines: "0", tests: true, cursor: null, pins: [],
};
const on = (element, type, act) => element.addEventListener(type, act);
const current = () => DATA.pairs[state.pair];
// Required score against each threat; null: none.
const confidences = () => threats.map(t => t.own ?? (state.confidence === null ? null : state.confidence / 100));
const wanted = () => confidences().map(c => c && scoreOf(c));
const required = t => state.velocities[t] + threats[t].margin;
const anyAsked = () => wanted().some(z => z !== null);

// Velocities that designs stop with a score, NaN where it is not stated; the last are kept.
function sure(pair, t, z) {
  const of = (pair.sure ??= {}), key = [t, z === 0];
  if (of[key]?.z !== z) of[key] = { z, values: pair.areal.map((_, k) => (pair.most[k * T + t] < z - 1e-6 ? NaN : stopped(pair, k * T + t, z))) };
  return of[key].values;
}
const scored = (pair, k, t) => score(pair, k * T + t, state.velocities[t]);
const isKnown = (pair, k) => !pair.unknown[k];
const light = (pair, k) => pair.areal[k] <= state.most + 1e-9;
// 32-bit floats are right to 1e-4 m/s.
const stops = (pair, k, t, z, by = score) =>
  (!limited(t, z) || pair.limits[k * T + t] >= required(t) - 1e-4) && (z === null || by(pair, k * T + t, state.velocities[t]) >= z - 1e-6);
// Whether the limit by the model decides: if a margin or no probability is required.
const limited = (t, z) => z === null || threats[t].margin > 0;

// Lightest design that meets what is asked, of known probability if possible.
function lightest(pair, asked = wanted()) {
  const key = [asked, state.velocities, state.most].join("|"), found = (pair.found ??= new Map());
  if (!found.has(key)) {
    if (found.size > 9) found.clear();
    let other = null, known = null;
    for (const k of pair.designs) {
      if (!light(pair, k)) break;
      if (!asked.every((z, t) => stops(pair, k, t, z))) continue;
      if (isKnown(pair, k)) {
        known = k;
        break;
      }
      other ??= k;
    }
    found.set(key, known ?? other);
  }
  return found.get(key);
}
// Design of a pair to show: the lightest known to meet what is asked; else the lightest by the computed limit; else the
// nearest.
function answer(pair) {
  const best = pair.single || DATA.interlayer ? null : lightest(pair);
  if (best !== null) return { k: best, reason: "" };
  const asked = wanted(), within = pair.designs.filter(k => light(pair, k));
  const reach = within.filter(k => asked.every((z, t) => stops(pair, k, t, isNaN(scored(pair, k, t)) ? null : z, byTests)));
  const reaches = reach.find(k => isKnown(pair, k)) ?? reach[0];
  if (pair.unlike && within.length) return { k: within[0], reason: "no metal" };
  if (reaches !== undefined) return { k: reaches, reason: pair.single ? "single" : "not known" };
  let nearest = null, least = Infinity;
  for (const k of within.length ? within : pair.designs.slice(0, 1)) {
    const lacks = max(...threats.map((_, t) => lack(pair, k, t)));
    if (lacks < least) [nearest, least] = [k, lacks];
  }
  const low = within.length && threats.every((_, t) => pair.low[t] || lack(pair, nearest, t) <= 0);
  return { k: nearest, reason: low ? "low limit" : "none passes" };
}
// Shortfall of the limit from the required one, m/s.
function lack(pair, k, t) {
  const d = k * T + t, z = isNaN(scored(pair, k, t)) ? null : wanted()[t], sure = z === null ? Infinity : stopped(pair, d, z);
  return max(limited(t, z) ? required(t) - pair.limits[d] : -Infinity, state.velocities[t] - sure);
}
const even = pair => pair.designs.find(k => light(pair, k) && threats.every((_, t) => scored(pair, k, t) >= 0)) ?? null;

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
function overConfidence(pair, xs) {
  const asked = wanted().map((z, t) => (threats[t].own === null ? null : z)), none = lightest(pair, asked);
  const ys = curve(pair, xs.map(x => scoreOf(x / 100)), k =>
    asked.every((z, t) => (z === null && !limited(t, 0)) || stops(pair, k, t, z)) ? threats.reduce((least, { own }, t) => (own === null ? min(least, scored(pair, k, t)) : least), Infinity) + 1e-6 : NaN);
  return [none === null ? Infinity : pair.areal[none], ...ys.slice(1)];
}
function overVelocity(pair, t, xs) {
  const asked = wanted(), fast = asked[t] !== null && sure(pair, t, asked[t]);
  return curve(pair, xs, k =>
    asked.every((z, i) => i === t || stops(pair, k, i, z)) ? min(limited(t, asked[t]) ? pair.limits[k * T + t] - threats[t].margin : Infinity, fast ? fast[k] : Infinity) + 1e-4 : NaN);
}

// Velocities stopped, with the required or an even chance, minus those of one threat or all, m/s.
function reserve(pair, asked, only) {
  const least = new Float64Array(pair.areal.length).fill(Infinity);
  for (let t = 0; t < T; t++) {
    if (only !== undefined && t !== only) continue;
    const v = state.velocities[t], z = asked ? asked[t] : 0, values = z === null ? null : sure(pair, t, z);
    for (let k = 0; k < least.length; k++) {
      if (values) least[k] = min(least[k], values[k] - v);
      if (asked && limited(t, z)) least[k] = min(least[k], pair.limits[k * T + t] - v - threats[t].margin);
    }
  }
  return least;
}

// --- words

const trimmed = x => String(+x.toFixed(3));
const areal = x => x.toFixed(1);
const whole = (pair, k) => areal(pair.areal[k] + pair.hull);
const weight = (pair, k) => `${areal(pair.areal[k])} kg/m²${pair.hull && ` (${whole(pair, k)} with the back plate, which exists)`}`;
const signed = x => `${x < 0 ? "−" : "+"}${areal(abs(x))}`;
// A probability is rounded down, so that none is shown that is not reached.
function chance(z) {
  if (isNaN(z)) return "unknown";
  if (z === Infinity) return "above 99 %";
  return z === -Infinity ? "below 1 %" : `${floor(100 * below(z) + 1e-4)} %`;
}
const letter = t => (T > 1 ? `${mark(t)} ` : "");
const shot = t =>
  `${threats[t].name} at ${trimmed(state.velocities[t])} m/s${threats[t].obliquity ? `, ${threats[t].obliquity}°` : ""}`;
const listed = words => (words.length > 1 ? `${words.slice(0, -1).join(", ")} and ${words.at(-1)}` : words[0]);
const allThreats = () => (T > 3 ? `all ${T} threats` : listed(threats.map((_, t) => shot(t))));
function thicknesses(pair, k) {
  const m = pair.backings.length;
  return [pair.ceramics[floor(k / m)], pair.backings[k % m]];
}
function armour(pair, k) {
  const [c, b] = thicknesses(pair, k);
  return pair.ceramic ? `${trimmed(c)} mm ${pair.said} on ${trimmed(b)} mm ${pair.backing}` : `${trimmed(b)} mm ${pair.backing}`;
}
function short(pair, k) {
  const [c, b] = thicknesses(pair, k);
  return pair.ceramic ? `${trimmed(c)} on ${trimmed(b)} mm` : `${trimmed(b)} mm`;
}
// The threat that is most likely to perforate or, where that is unknown, the one with the least margin.
function governing(pair, k) {
  const of = threats.map((_, t) => scored(pair, k, t));
  const by = of.some(isNaN) || of.every(z => z === Infinity) ? threats.map((_, t) => pair.limits[k * T + t] - required(t)) : of;
  return by.indexOf(min(...by));
}
const worst = (pair, k) => {
  const of = threats.map((_, t) => scored(pair, k, t));
  return of.some(isNaN) ? NaN : min(...of);
};
function percent() {
  const asked = new Set(confidences());
  return asked.size > 1 ? null : `${trimmed(100 * [...asked][0])} %`;
}
// The distributions of inputs are not sampled here.
const exact = DATA.exact ? ", with exact inputs" : "";
const confidenceWords = () => `with ${percent() ?? "the"} confidence${margins ? " and the margin" : ""}${percent() && !margins ? "" : " asked for"}${exact}`;
const plus = margins ? " plus the margin" : "";

function headline(pair, { k, reason }) {
  if (k === null) return `No ${pair.name} is on offer within the limits of the scenario.`;
  const named = `${armour(pair, k)}, ${weight(pair, k)},`, lead = `${named} is the lightest`;
  if (/none|low/.test(reason)) {
    const lacks = threats.map((_, t) => [lack(pair, k, t), t]).filter(([by]) => by > 0).map(([by, t]) => `${round(by) || "less than 1"} m/s against ${threats[t].name}`);
    const over = light(pair, k) ? [] : [`${areal(pair.areal[k] - state.most)} kg/m² too much`];
    return `${reason === "low limit" ? "Not known, as the limit is too low" : "None passes"}: the nearest, ${named} lacks ${listed([...lacks, ...over])}.`;
  }
  if (reason === "single") return `One source alone gives the flow stress of ${pair.ceramic}, so that no design of it is named lightest. By it, ${named} reaches ${allThreats()}${plus}.`;
  if (reason === "no metal") return `Not known: ${pair.unlike}.`;
  if (reason && isKnown(pair, k)) return `Not known: ${named} is far from the tests, where ${chance(worst(pair, k))} is the most that is stated.`;
  if (reason) return `Not known: ${lead} that reaches ${allThreats()}${plus} by the computed limit. How likely it is to stop is unknown${DATA.interlayer && `: ${DATA.interlayer}`}.`;
  if (anyAsked()) return `${lead} that stops ${allThreats()} ${confidenceWords()}.`;
  const z = worst(pair, k);
  const sure = isNaN(z) ? "How likely it is to stop is unknown." : `The ${T > 1 ? "least " : ""}probability of stopping is ${chance(z)}.`;
  return `${lead} whose computed ballistic limit reaches ${allThreats()}${plus}. ${sure}`;
}
function besides(pair, best, ring) {
  const words = [];
  const untested = threats.flatMap((_, t) => (pair.designs.some(k => !isNaN(scored(pair, k, t))) ? [] : [shot(t)]));
  if (best !== null) words.push(...pair.caveats.filter(each => thicknesses(pair, best)[0] <= each[1]).map(each => each[0]));
  if (pair.outside) words.push(`All lie outside the tests in ${pair.outside}.`);
  if (untested.length) words.push(`No test like ${pair.name} against ${untested.length === T ? allThreats() : listed(untested)} is known, so no probability is known.`);
  if (ring !== null && best !== null && anyAsked() && pair.areal[best] > pair.areal[ring]) {
    const more = pair.areal[best] - pair.areal[ring];
    words.push(`${short(pair, ring)}, ${areal(pair.areal[ring])} kg/m², stops more often than not: what is asked for weighs ${areal(more)} kg/m² (${round(100 * more / pair.areal[ring])} %) more.`);
  }
  const own = best === null ? Infinity : pair.areal[best];
  const rival = DATA.pairs.map(p => [p, lightest(p)]).filter(([p, k]) => k !== null && p !== pair && !p.single && !DATA.interlayer && p.areal[k] < own - 1e-9 && (isKnown(p, k) || !pair.known))
    .sort((a, b) => a[0].areal[a[1]] - b[0].areal[b[1]])[0];
  if (rival) words.push(`${armour(rival[0], rival[1])} is lighter, ${areal(rival[0].areal[rival[1]])} kg/m².`);
  if (pair.free.some(Boolean)) words.push("Any thickness is on offer; of those between the steps of this map a lighter one may do.");
  return words.join(" ");
}

// Quote for a shell.
const quoted = word => (/^[\w@%+=:,./-]+$/.test(word) ? word : `'${word.replaceAll("'", `'"'"'`)}'`);
function command(pair, k) {
  const t = governing(pair, k), threat = threats[t], [c, b] = thicknesses(pair, k), own = DATA.own;
  const changes = new Map([...DATA.changes, ...pair.changes].map(change => [change.split("=")[0].trim(), change]));
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
const square = (x, y, r, of) => svg("rect", { class: of, x: x - r, y: y - r, width: 5, height: 5 });
const small = (width, height) => svg("svg", { viewBox: `0 0 ${width} ${height}`, "aria-hidden": "true" });
const path = (points, of) => svg("path", { class: of, d: `M${points.map(p => `${p[0].toFixed(1)} ${p[1].toFixed(1)}`).join("L")}` });
const text = (x, y, words, of, more) => svg("text", { x: x.toFixed(1), y: y.toFixed(1), class: of, "font-size": 12, ...more }, words);

// Multiples of 1, 2 or 5 times a power of ten.
function ticks(low, high, count) {
  const raw = (high - low) / count || 1, power = 10 ** floor(Math.log10(raw));
  const step = power * [1, 2, 5, 10].find(m => m * power >= raw * 0.999), found = [];
  for (let n = Math.ceil(low / step - 1e-9); n * step <= high + 1e-9 * step; n++) found.push(+(n * step).toPrecision(12));
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
  const near = [[x, width], [y, height]].map(([places, size]) =>
    Array.from({ length: size }, (_, at) => places.reduce((best, place, n) => (abs(place - at) < abs(places[best] - at) ? n : best), 0)));
  return { pair, grey: {}, equal: {}, near, width, height, narrow, frame, across, up, n: pair.ceramics.length, m: pair.backings.length, x, y };
}

// Margins over the thickness, if only one varies.
const margin = (pair, k, t) => pair.limits[k * T + t] - required(t);
function lineViewOf(pair, view, scale) {
  const { frame } = view, values = view.m > 1 ? pair.backings : pair.ceramics;
  const over = (pair.over ?? []).flat().map((limit, d) => limit - required(d % T));
  const every = [0, ...over, ...pair.areal.keys().flatMap(k => threats.map((_, t) => margin(pair, k, t)))];
  const spare = 0.05 * (max(...every) - min(...every));
  return { ...view, line: true, values, across: scale(values, frame.left + 10, frame.right - 10), up: scale([min(...every) - spare, max(...every) + spare], frame.bottom, frame.top) };
}
function drawLines(pair, lines, words) {
  const { across, up, values, frame } = view, colours = ["blue", "red", "green", "ink"], ends = [];
  lines.append(path([[frame.left, up.at(0)], [frame.right, up.at(0)]], "ink"));
  words.append(text(frame.left + 8, up.at(0) - 6, "required", "halo strong"));
  const at = (n, t, limit) => [across.at(values[n]), up.at(limit - required(t))];
  threats.forEach((_, t) => {
    if (!pair.over || (T > 3 && t !== governing(pair, answer(pair).k))) return;
    const [least, greatest] = pair.over.map(limits => values.map((_, n) => at(n, t, limits[n * T + t])));
    lines.append(svg("path", { class: `band ${colours[t % 4]}`, d: `M${[...least, ...greatest.reverse()].map(p => p.map(c => c.toFixed(1)).join(" ")).join("L")}Z` }));
  });
  threats.forEach((_, t) => {
    const line = values.map((_, n) => at(n, t, pair.limits[n * T + t]));
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
  for (let s = 1; s < line.length - 1; s += Math.ceil(line.length / 40)) {
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
// Put words where a field is above 0 and has most room.
function caption(field, said, of) {
  const { frame, near, m, taken, words } = view, half = 3.6 * said.length;
  let best = null, most = 14;
  const inside = (x, y) => field[near[1][round(y)] * m + near[0][round(x)]] > 0;
  for (let y = frame.top + 20; y < frame.bottom - 12; y += 20)
    for (let x = frame.left + half + 8; x < frame.right - half - 8; x += 20) {
      if (!inside(x - half, y + 10) || !inside(x + half, y - 14) || !inside(x + half, y + 10) || !inside(x - half, y - 14)) continue;
      const points = [[x - half, y], [x, y], [x + half, y]], room = roomOf(points);
      if (room > most) [best, most] = [points, room];
    }
  if (best === null) return;
  taken.push(...best);
  words.append(text(best[1][0], best[1][1] + 4, said, `halo mid ${of}`));
}

function limitLines(pair, t) {
  const own = pair.areal.map((_, k) => pair.limits[k * T + t]), group = svg("g");
  const sorted = own.slice().sort(), lines = ticks(sorted[0], sorted.at(-1), view.narrow ? 6 : 12).map(level => [level, contour(view, own, level)]);
  for (const [, found] of lines) group.append(...found.map(line => path(line, "grey")));
  return { lines, group };
}
function drawMap(pair, best, ring) {
  if (view?.pair !== pair || view.line) view = viewOf(pair);
  const { frame, width, height, across, up } = view, box = $("map");
  const areas = svg("g"), lines = svg("g"), marks = svg("g"), words = (view.words = svg("g")), taken = (view.taken = []);
  const asked = wanted(), fields = { asked: reserve(pair, asked), even: reserve(pair, null).map(each => -each) };
  const flat = !view.line;
  if (!flat) drawLines(pair, lines, words);
  if (flat) {
    if (pair.known) areas.append(view.unknown ??= area(view, fields.even.map(v => +isNaN(v)), 1e-3, "unknown"), area(view, fields.even, 0, "fails"));
    if (anyAsked()) areas.append(area(view, fields.asked, 0, "stops"));
  }

  // Designs first: labels of lines keep clear of their words.
  const right = [], colours = [[ring, "even", "t-red", "red thin"], [best, answer(pair).reason ? "cursor" : "best", anyAsked() ? "t-blue" : "strong", "blue thin"]];
  for (const [k, of, colour, line] of colours) {
    if (k === null || (of === "even" && k === best)) continue;
    const [x, y] = placeOf(pair, k), above = of !== "even";
    marks.append(circle(x, y, above ? 7.5 : 6, of));
    const said = [short(pair, k), `${areal(pair.areal[k])} kg/m², ${chance(worst(pair, k))}`], room = 6.6 * max(...said.map(w => w.length));
    const side = (above ? x + 12 + room < width : x - 12 - room < frame.left) ? 1 : -1, top = y + (above ? -20 : 18);
    said.forEach((w, n) => words.append(text(x + 12 * side, top + 14 * n, w, `halo ${side > 0 ? "" : "end"} ${colour}`)));
    taken.push([x, y], ...[0.2, 0.5, 0.8].map(part => [x + side * (12 + part * room), top + 4]));
    right.push([pair.areal[k], line, colour]);
  }

  const outline = state.tests && pair.tested[state.lines === "none" ? 0 : +state.lines];
  if (outline && flat) {
    const cut = (value, of) => of.at(min(max(value, of.low), of.high)), [[a, b], [c, d]] = outline;
    const [left, end, low, high] = [cut(c, across), cut(d, across), cut(a, up), cut(b, up)];
    if (end > left && low > high) {
      lines.append(svg("rect", { class: "green", x: left, y: high, width: end - left, height: low - high }));
      taken.push([end - 30, low - 8], [end - 80, low - 8]);
      words.append(text(end - 4, low - 5, "thicknesses tested", "halo end small t-green"));
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
    const front = svg("g"), known = pair.known && anyAsked();
    const drawn = (field, of, said, colour) => {
      const found = contour(view, field, 0);
      front.append(...found.map(line => path(line, of)));
      label(found, said, colour);
    };
    if (pair.known) drawn(fields.even, "red", "50 %", "t-red");
    if (known) drawn(fields.asked, "blue", percent() ?? "asked for", "t-blue");
    else drawn(pair.known ? fields.asked : reserve(pair, asked.map(() => null)), "ink", `computed limit = velocity${margins ? " + margin" : ""}`, "strong");
    if (pair.known) caption(fields.even, view.narrow ? "perforated" : "perforated more often than not", "t-red");
    if (known) {
      caption(fields.asked, percent() ? `${percent()} or more stopped` : "meets the requirements", "t-blue");
      label(contour(view, fields.asked.map((each, k) => each - fields.even[k]), 0), "stopped, but less surely", "t-soft");
    }
    if (known && T > 1 && T < 5)
      threats.forEach((_, t) => {
        drawn(reserve(pair, asked, t), "blue fine", mark(t), "t-blue");
        drawn(reserve(pair, null, t), "red fine", mark(t), "t-red");
      });
    if (grey)
      for (const [level, found] of grey.lines) label(found, String(level), "t-soft");
    lines.append(front);
  }
  if (pair.onOffer.length <= 400) {
    // Over one thickness, by the computed limit where no probability is known, with the least flow stress of sources.
    const reached = (k, t, z) => stops(pair, k, t, (view.line || !pair.known) && isNaN(scored(pair, k, t)) ? null : z) && (!pair.over || pair.over[0][k * T + t] >= required(t));
    const passing = new Set(pair.designs.filter(k => light(pair, k) && asked.every((z, t) => reached(k, t, z))));
    for (const k of pair.onOffer) lines.append((pair.inside.includes(k) ? circle : square)(...placeOf(pair, k), 2.6, passing.has(k) ? "dot on" : "dot"));
  }
  const axes = svg("g");
  axes.append(svg("rect", { class: "frame", x: frame.left, y: frame.top, width: frame.right - frame.left, height: frame.bottom - frame.top }));
  const bottom = flat ? pair.backings : view.values, marked = bottom.length > 1 ? ticks(across.low, across.high, view.narrow ? 5 : 8) : bottom;
  for (const b of marked) if (abs(across.at(b) - frame.left) < width && across.at(b) <= frame.right && across.at(b) >= frame.left) axes.append(text(across.at(b), frame.bottom + 16, trimmed(b), "t-soft mid"));
  for (const c of flat || view.line ? ticks(up.low, up.high, view.narrow ? 5 : 9) : [])
    axes.append(text(frame.left - 6, up.at(c) + 4, flat ? trimmed(c) : (c > 0 ? "+" : "") + trimmed(c).replace("-", "−"), "t-soft end"));
  box.setAttribute("viewBox", `0 0 ${width} ${height}`);
  box.setAttribute("aria-label", `Map of ${pair.name}. ${headline(pair, answer(pair))}`);
  box.replaceChildren(areas, lines, axes, marks, words, svg("g", { id: "over" }));
  const said = flat ? ["Dotted: equal areal density.", ...(state.lines === "none" ? [] : ["Thin: equal ballistic limit, m/s."])]
    : [`Lines: the computed limit against ${T > 1 ? "each threat" : "the threat"}, less the one required.`, ...(pair.over ? [`Band${T > 3 ? " of the threat that governs" : "s"}: over the flow stresses that sources give.`] : [])];
  if (pair.onOffer.length <= 400) said.push(`Dots: on offer, filled where they ${flat || pair.known ? "do what is asked for" : `reach what is required by the computed limit${pair.over ? ", even with the least of these flow stresses" : ""}`}; squares: outside tests.`);
  $("options").style.display = flat ? "" : "none";
  said.push("Point at a design to read it, click to pin it. Keys: arrows move (Shift: five steps), Home goes to the lightest, Enter pins, Escape leaves.");
  $("keys").textContent = said.join(" ");
  $("areal-name").hidden = !flat;
  const [up_, right_] = [`ceramic ${pair.said}, mm`, `back plate ${pair.backing}, mm`];
  $("y-name").textContent = flat ? `↑ ${up_}` : "↑ computed limit less the one required, m/s";
  $("x-name").textContent = `${flat || view.m > 1 ? right_ : up_} →`;
  drawOver(pair);
}

const placeOf = (pair, k) =>
  view.line ? [view.across.at(view.values[k]), view.up.at(min(...threats.map((_, t) => margin(pair, k, t))))] : [view.x[k % view.m], view.y[floor(k / view.m)]];
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
  const said = `${areal(pair.areal[state.cursor])} kg/m² · ${chance(worst(pair, state.cursor))}`, width = 7 * said.length + 8;
  chip(min(max(x, frame.left + width / 2), view.width - width / 2), y > 40 ? y - 24 : y + 26, said, width);
}

function drawPairs() {
  const box = $("pairs");
  box.hidden = DATA.pairs.length < 2;
  if (box.hidden) return;
  const rows = DATA.pairs.map(pair => [pair, answer(pair).k, even(pair)]);
  const values = rows.flatMap(([p, a, b]) => [a, b].filter(k => k !== null).map(k => p.areal[k]));
  const low = min(...values), high = max(...values), at = v => 8 + 96 * (high > low ? (v - low) / (high - low) : 0.5);
  const focused = box.contains(document.activeElement);
  box.replaceChildren(box.querySelector("legend"), ...rows.map(([pair, best, ring], n) => {
    const input = html("input", { type: "radio", name: "pair", value: n });
    input.checked = current() === pair;
    on(input, "change", () => { state.pair = n; state.cursor = null; draw(); });
    const picture = small(210, 18);
    const places = [ring, best].filter(k => k !== null).map(k => at(pair.areal[k]));
    if (places.length === 2) picture.append(path([[places[0], 9], [places[1], 9]], "frame"));
    if (ring !== null) picture.append(circle(at(pair.areal[ring]), 9, 4, "even"));
    if (best !== null) picture.append(circle(at(pair.areal[best]), 9, 5, isKnown(pair, best) && !answer(pair).reason ? "best" : "cursor"));
    const { k, reason } = answer(pair), words = { single: "one source", "none passes": "none" }[reason] ?? reason;
    const said = reason === "none passes" ? words : `${areal(pair.areal[k])}${words || isKnown(pair, k) ? "" : ", unknown"}${words && `, ${words}`}`;
    picture.append(text(places.length ? max(...places) + 9 : 8, 13, said, "small"));
    return html("div", { class: "pair" }, html("label", {}, input, ` ${pair.name}`), picture);
  }));
  if (focused) box.querySelector("input:checked").focus();
}

// Draw a curve above a slider, and the place of its value.
function drawCurve(slider, xs, ys, value) {
  const real = ys.filter(isFinite), picture = slider.picture, at = x => 4 + 292 * (x - xs[0]) / (xs.at(-1) - xs[0]);
  picture.replaceChildren();
  if (!real.length) return picture.append(text(4, 28, current().known ? "none" : "unknown", "t-soft small"));
  const low = min(...real), high = max(...real), up = y => 34 - 14 * (high > low ? (y - low) / (high - low) : 0);
  const points = xs.map((x, n) => [at(x), up(ys[n])]).filter((_, n) => isFinite(ys[n]));
  picture.append(path(points, "frame"), text(4, points[0][1] - 5, areal(real[0]), "t-soft small"));
  const [end, top] = points.at(-1);
  if (end - at(value) > 80) picture.append(text(end, top - 5, areal(real.at(-1)), "t-soft small end"));
  if (end < 215) picture.append(text(300, 40, current().known ? "none" : "unknown", "t-soft small end"));
  const pair = current(), best = lightest(pair);
  if (best === null) return;
  const x = at(value), y = up(pair.areal[best]);
  picture.append(circle(x, y, 4.5, "best"));
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
    slider("Confidence", 50, 99, state.confidence === null || Number.isInteger(state.confidence) ? 1 : "any", state.confidence ?? 50,
      () => (state.confidence === null ? "none asked for" : `${trimmed(state.confidence)} %`),
      value => { state.confidence = value > 50 ? value : null; },
      made => drawCurve(made, percents, overConfidence(current(), percents), state.confidence ?? 50));
  // Many sliders would hide what follows.
  const many = T > 3 ? html("details", {}, html("summary", {}, `Velocities of the ${T} threats`)) : null;
  if (many) $("sliders").append(many);
  threats.forEach((threat, t) => {
    const reach = max(round(0.35 * threat.velocity), 1), low = threat.velocity - reach, high = threat.velocity + reach, xs = spread(low, high, 60);
    const own = threat.own === null ? "" : `, ${trimmed(100 * threat.own)} % asked for`;
    slider(`${letter(t)}${threat.name}${threat.obliquity ? ` at ${threat.obliquity}°` : ""}${own}`, low, high, 1, threat.velocity,
      () => `${trimmed(state.velocities[t])} m/s${threat.margin ? ` + ${threat.margin}` : ""}`,
      value => { state.velocities[t] = value; },
      made => drawCurve(made, xs, overVelocity(current(), t, xs), state.velocities[t]), many ?? $("sliders"));
  });
  const every = DATA.pairs.flatMap(p => [p.areal[0], p.areal.at(-1)]), low = floor(min(...every)), high = Math.ceil(max(...every));
  slider("Greatest areal density", low, high, 0.5, min(state.most, high), () => (state.most < Infinity ? `${trimmed(state.most)} kg/m²` : "any"),
    value => { state.most = value < high ? value : Infinity; });
}

function crossSection(pair, k) {
  const [c, b] = thicknesses(pair, k), rods = threats.map(t => t.rod), longest = max(...rods.map(r => r[0]));
  const [front, between, behind] = DATA.layers, layers = [...front, ["ceramic", c * !!pair.ceramic], ...between, ["metal", b], ...behind], thick = layers.reduce((sum, of) => sum + of[1], 0);
  const angles = threats.map(t => t.obliquity * Math.PI / 180), rows = rods.map((r, t) => 1.7 * r[1] + 2 + r[0] * Math.sin(angles[t])), tall = max(rows.reduce((a, d) => a + d, 0), 0.8 * thick), wide = longest + thick + 12, gap = longest + 3;
  const font = max(wide, tall * 2) / 26, picture = svg("svg", { viewBox: `0 0 ${max(wide, tall * 2)} ${tall + 3.4 * font}`, role: "img", "aria-label": `Cross-section to scale: ${armour(pair, k)}` });
  const sized = { "font-size": font }, top = 1.4 * font;
  let x = gap;
  for (const [kind, mm, name] of layers) {
    picture.append(svg("rect", { class: kind, x, y: top, width: mm, height: tall }, name ? svg("title", {}, name) : null));
    x += mm;
  }
  picture.append(text(gap + thick / 2, font, pair.ceramic ? `${trimmed(c)} + ${trimmed(b)} mm` : `${trimmed(b)} mm`, "mid", sized));
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
// The limit's distribution, 1 to 99 %, cut at the velocity.
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
  const [c, b] = thicknesses(pair, k), governs = governing(pair, k), pinned = state.pins.some(p => p.pair === pair && p.k === k);
  box.append(html("h2", {}, armour(pair, k)));
  const difference = best === null || k === best ? "" : ` (${signed(pair.areal[k] - pair.areal[best])})`;
  box.append(html("p", {}, `${weight(pair, k)}${difference}, ${trimmed(c * !!pair.ceramic + b * !pair.hull + DATA.added.thickness)} mm thick`, k === best ? html("span", { class: "t-blue" }, { "": anyAsked() ? ` lightest that meets the requirements${exact}` : " lightest", "not known": " lightest by the computed limit", "none passes": " nearest", single: "", "no metal": "" }[answer(pair).reason]) : null));
  if (pair.excluded.includes(k)) box.append(html("p", { class: "t-red" }, "Beyond the limits of the scenario."));
  box.append(crossSection(pair, k));
  threats.forEach((threat, t) => {
    const d = k * T + t, v = state.velocities[t], z = score(pair, d, v), limit = pair.limits[d];
    box.append(html("div", { class: "row" }, html("span", {}, `${letter(t)}${shot(t)}`), html("b", {}, isNaN(z) ? "probability unknown" : `${chance(z)} stopped`)));
    if (!isNaN(z)) box.append(distribution(pair, d, v));
    const above = round(limit - v), over = pair.over && pair.over.map(limits => round(limits[d])).join(" to ");
    box.append(html("p", { class: "soft" }, `Computed limit ${round(limit)} m/s${over ? `, ${over} over the sources` : ""}, margin ${above < 0 ? "−" : "+"}${abs(above)} m/s${T > 1 && t === governs ? "; governs" : ""}`));
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
  const rows = [[pair, best, "●", "t-blue"], [pair, ring === best ? null : ring, "○", "t-red"], ...state.pins.map((p, n) => [p.pair, p.k, n + 1, "disc", p])].filter(row => row[1] !== null);
  const from = best === null ? null : pair.areal[best];
  const shown = k => (T > 2 ? [governing(current(), k)] : threats.map((_, t) => t));
  const heads = ["armour", "kg/m²", ...(current().hull ? ["whole"] : []), ...(from === null ? [] : [`from ${areal(from)}`]), ...(T > 2 ? ["governs", "limit, m/s", "stopped"] : threats.flatMap((_, t) => [`${letter(t)}limit, m/s`, `${letter(t)}stopped`]))];
  const body = html("tbody");
  for (const [of, k, sign, colour, pinned] of rows) {
    const difference = from === null ? 0 : of.areal[k] - from;
    const cells = [areal(of.areal[k]), ...(of.hull ? [whole(of, k)] : []), ...(from === null ? [] : [abs(difference) < 0.05 ? "" : signed(difference)]),
      ...shown(k).flatMap(t => [...(T > 2 ? [mark(t)] : []), String(round(of.limits[k * T + t])), chance(scored(of, k, t))])];
    body.append(html("tr", {}, html("td", {}, html("span", {}, html("span", { class: colour }, sign), " ", armour(of, k))), ...cells.map((cell, i) => html("td", { "data-label": heads[i + 1] }, html("span", {}, cell)))));
    const words = command(of, k), code = html("code", {}, ...parts(words));
    const remove = pinned ? button("Remove", () => { state.pins = state.pins.filter(p => p !== pinned); draw(); }) : null;
    body.append(html("tr", { class: "command" }, html("td", { colspan: heads.length }, code, button("Copy", made => copy(words, code, made)), " ", remove)));
  }
  $("table").replaceChildren(html("table", {}, html("thead", {}, html("tr", {}, ...heads.map(each => html("th", { scope: "col" }, each)))), body));
}
function drawNotes(pair) {
  const said = [
    DATA.answer.length && `As the scenario asks: ${DATA.answer.join("; ")}.`,
    pair.known && `Probabilities of ${pair.name} rest on: ${pair.source}.`,
    "Probabilities are those of one shot and of the error of the model, as the evidence gives it; they are no probability of survival.",
    `${pair.onOffer.length.toLocaleString("en")} designs of this pair are ${pair.free.some(Boolean) ? "shown" : "on offer, and exact"}; lines between them are interpolated.${pair.coarser ? " To keep the page small, they are coarser than they could be." : ""}`,
    pair.known && pair.unknown.includes(1) && "Grey: the probability is unknown, as such thicknesses are too unlike the tests.",
    ...DATA.notes, `armour ${DATA.version}${DATA.title ? `; scenario: ${DATA.title}` : ""}`,
  ];
  $("notes").replaceChildren(...said.filter(Boolean).map(each => html("p", {}, each)));
}

let frame = null;
function draw() {
  frame = null;
  const pair = current(), found = answer(pair), best = found.k, ring = even(pair);
  $("headline").textContent = headline(pair, found);
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
  // The pair of materials that comes first is the one with the lightest design that is known to do what is asked.
  const rank = ["", "not known", "none passes", "single", "no metal"], found = DATA.pairs.map((p, n) => [n, p, answer(p)]).filter(([, , a]) => a.k !== null);
  const lacks = ([, p, { k }]) => max(...threats.map((_, t) => lack(p, k, t)));
  found.sort((a, b) => {
    const [[, p, { k, reason }], [, q, other]] = [a, b];
    if (reason === "none passes" && other.reason === reason) return lacks(a) - lacks(b);
    return rank.indexOf(reason) - rank.indexOf(other.reason) || isKnown(q, other.k) - isKnown(p, k) || p.areal[k] - q.areal[other.k];
  });
  state.pair = found.length ? found[0][0] : 0;
  $("about").textContent = DATA.subject;
  for (let t = 0; t < T; t++) $("lines").append(html("option", { value: t }, T > 1 ? `ballistic limit against ${mark(t)}` : "ballistic limit"));
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
