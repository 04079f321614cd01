"use strict";
// The designs of a scenario: answers are those of the thicknesses on offer, lines between them are interpolated.
const DATA = JSON.parse(document.getElementById("data").textContent);
const { threats, scores } = DATA, T = threats.length, Q = scores.length;
const MIDDLE = { "text-anchor": "middle" }, SMALL = { "font-size": 11 };
const LETTERS = "ABCDEFGHIJKLMNOPQRSTUVWXYZ", MAX_PINS = 6;
const $ = id => document.getElementById(id);

// --- numbers

const bytes = text => Uint8Array.from(atob(text), each => each.charCodeAt(0)).buffer;

// Limits and velocities that are stopped, in the order of their scores; NaN where they are unknown.
function decoded(pair) {
  const floats = new Float32Array(bytes(pair.floats)), differences = new Uint16Array(bytes(pair.differences));
  const count = pair.ceramics.length * pair.backings.length;
  pair.limits = new Float64Array(count * T);
  pair.stops = new Float64Array(count * T * Q);
  for (let d = 0; d < count * T; d++) {
    pair.limits[d] = floats[2 * d];
    let velocity = floats[2 * d + 1] || NaN;
    for (let q = 0; q < Q; q++) {
      if (q) velocity += pair.step * differences[d * (Q - 1) + q - 1];
      pair.stops[d * Q + q] = velocity;
    }
  }
  pair.areal = new Float64Array(count);
  pair.places = pair.ceramics.flatMap((c, i) => pair.backings.map((b, j) => {
    pair.areal[i * pair.backings.length + j] = (pair.densities[0] * c + pair.densities[1] * b) / 1000 + DATA.added.areal;
    return [i, j];
  }));
  const excluded = new Set(pair.excluded);
  pair.onOffer = pair.offered[0].flatMap(i => pair.offered[1].map(j => i * pair.backings.length + j));
  pair.designs = pair.onOffer.filter(k => !excluded.has(k));
  pair.name = pair.ceramic ? `${pair.ceramic} on ${pair.backing}` : pair.backing;
  pair.known = pair.stops.some(each => each > 0);
}

// Probability below a normal score (Abramowitz and Stegun 26.2.17), and its inverse.
function below(z) {
  const t = 1 / (1 + 0.2316419 * Math.abs(z)), density = 0.3989422804014327 * Math.exp(-z * z / 2);
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
    return m < 0 ? Math.max(m, 3 * a) : 0;
  }
  const h = V[o + q] - V[o + q - 1], k = V[o + q + 1] - V[o + q];
  if (!(h > 0 && k > 0)) return 0;
  const a = (scores[q] - scores[q - 1]) / h, b = (scores[q + 1] - scores[q]) / k;
  return 3 * (h + k) / ((2 * k + h) / a + (k + 2 * h) / b);
}
const hermite = (y, z, a, b, t) => ((2 * t - 3) * t * t + 1) * y + (3 - 2 * t) * t * t * z + (1 - t) * (1 - t) * t * a - (1 - t) * t * t * b;
// Score with which a design stops a velocity: infinite beyond 1 and 99 %, NaN where it is unknown.
function score(pair, d, v) {
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
// Velocity that a design stops with a score.
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
// Scores that are asked for against each threat; null where none is.
const confidences = () => threats.map(t => t.own ?? (state.confidence === null ? null : state.confidence / 100));
const wanted = () => confidences().map(c => c && scoreOf(c));
const required = t => state.velocities[t] + threats[t].margin;
const anyAsked = () => wanted().some(z => z !== null);

// Scores of the designs against a threat, and the velocities that they stop with a score, of which the last are kept.
function kept(pair, name, t, x, of) {
  const key = name + t, there = (pair.kept ??= {})[key];
  if (there && there.x === x) return there.values;
  const values = new Float64Array(pair.areal.length);
  for (let k = 0; k < values.length; k++) values[k] = of(pair, k * T + t, x);
  pair.kept[key] = { x, values };
  return values;
}
const chances = (pair, t) => kept(pair, "score", t, state.velocities[t], score);
const sure = (pair, t, z) => kept(pair, "sure", t, z, stopped);
const scored = (pair, k, t) => chances(pair, t)[k];

const isKnown = (pair, k) => threats.every((_, t) => !isNaN(scored(pair, k, t)));
const light = (pair, k) => pair.areal[k] <= state.most + 1e-9;
// A float of 32 bits is right to 1e-4 m/s.
const stops = (pair, k, t, z) =>
  pair.limits[k * T + t] >= required(t) - 1e-4 && (z === null || scored(pair, k, t) >= z - 1e-6);

// Lightest of the designs on offer for which a condition holds, of equals the first.
function least(pair, holds) {
  let best = null;
  for (const k of pair.designs)
    if ((best === null || pair.areal[k] < pair.areal[best] - 1e-9) && light(pair, k) && holds(k)) best = k;
  return best;
}
function lightest(pair, asked = wanted()) {
  const key = [asked, state.velocities, state.most].join("|"), found = (pair.found ??= new Map());
  if (!found.has(key)) {
    if (found.size > 9) found.clear();
    const holds = k => asked.every((z, t) => stops(pair, k, t, z));
    found.set(key, least(pair, k => isKnown(pair, k) && holds(k)) ?? least(pair, holds));
  }
  return found.get(key);
}
const even = pair => least(pair, k => threats.every((_, t) => scored(pair, k, t) >= 0));

// Areal density of the lightest design over x, given designs with the greatest x that they reach.
function curve(reaching, xs) {
  const known = xs.map(() => Infinity), others = [...known];
  for (const [most, areal, isKnown] of reaching) {
    let low = 0, high = xs.length;
    while (low < high) if (xs[(low + high) >> 1] <= most) low = ((low + high) >> 1) + 1; else high = (low + high) >> 1;
    const of = isKnown ? known : others;
    if (low) of[low - 1] = Math.min(of[low - 1], areal);
  }
  for (let n = xs.length - 2; n >= 0; n--) for (const of of [known, others]) of[n] = Math.min(of[n], of[n + 1]);
  return known.map((areal, n) => (areal < Infinity ? areal : others[n]));
}
function overConfidence(pair, xs) {
  const asked = wanted(), reaching = [];
  for (const k of pair.designs) {
    if (!light(pair, k) || !threats.every((t, i) => stops(pair, k, i, t.own === null ? null : asked[i]))) continue;
    const least = Math.min(...threats.map((t, i) => (t.own === null ? scored(pair, k, i) : Infinity)));
    reaching.push([isNaN(least) ? -Infinity : least + 1e-6, pair.areal[k], true]);
  }
  const none = lightest(pair, threats.map((t, i) => (t.own === null ? null : asked[i])));
  return curve(reaching, xs.map(x => scoreOf(x / 100))).map((y, n) => (n ? y : none === null ? Infinity : pair.areal[none]));
}
function overVelocity(pair, t, xs) {
  const asked = wanted(), reaching = [];
  for (const k of pair.designs) {
    if (!light(pair, k) || !threats.every((_, i) => i === t || stops(pair, k, i, asked[i]))) continue;
    const d = k * T + t, most = pair.limits[d] - threats[t].margin;
    const fast = asked[t] === null ? Infinity : sure(pair, t, asked[t])[k];
    if (!isNaN(fast)) reaching.push([Math.min(most, fast) + 1e-4, pair.areal[k], isKnown(pair, k)]);
  }
  return curve(reaching, xs);
}

// --- words

const trimmed = x => String(+x.toFixed(3));
const areal = x => x.toFixed(1);
// Percentages are rounded down, so that none is shown that is not reached.
function chance(z) {
  if (isNaN(z)) return "unknown";
  if (z === Infinity) return "above 99 %";
  return z === -Infinity ? "below 1 %" : `${Math.floor(100 * below(z) + 1e-4)} %`;
}
const letter = t => (T > 1 ? `${LETTERS[t % 26]} ` : "");
const shot = t =>
  `${threats[t].name} at ${trimmed(state.velocities[t])} m/s${threats[t].obliquity ? `, ${threats[t].obliquity}°` : ""}`;
const listed = words => (words.length > 1 ? `${words.slice(0, -1).join(", ")} and ${words.at(-1)}` : words[0]);
const allThreats = () => listed(threats.map((_, t) => shot(t)));
function thicknesses(pair, k) {
  const [i, j] = pair.places[k];
  return [pair.ceramics[i], pair.backings[j]];
}
function armour(pair, k) {
  const [c, b] = thicknesses(pair, k);
  return pair.ceramic ? `${trimmed(c)} mm ${pair.ceramic} on ${trimmed(b)} mm ${pair.backing}` : `${trimmed(b)} mm ${pair.backing}`;
}
function short(pair, k) {
  const [c, b] = thicknesses(pair, k);
  return pair.ceramic ? `${trimmed(c)} on ${trimmed(b)} mm` : `${trimmed(b)} mm`;
}
// The threat that is most likely to perforate or, where that is unknown, the one with the least margin.
function governing(pair, k) {
  const of = threats.map((_, t) => scored(pair, k, t));
  const by = of.some(isNaN) || of.every(z => z === Infinity) ? threats.map((_, t) => pair.limits[k * T + t] - required(t)) : of;
  return by.indexOf(Math.min(...by));
}
const worst = (pair, k) => {
  const of = threats.map((_, t) => scored(pair, k, t));
  return of.some(isNaN) ? NaN : Math.min(...of);
};
function confidenceWords() {
  const asked = new Set(confidences());
  return asked.size > 1 ? "the confidence asked for" : `${trimmed(100 * [...asked][0])} % confidence`;
}
const within = () => (state.most < Infinity ? ` within ${areal(state.most)} kg/m²` : "");
const marginWords = () => (threats.some(t => t.margin) ? " plus the margin" : "");

function headline(pair, best) {
  if (best !== null && anyAsked())
    return `${armour(pair, best)}, ${areal(pair.areal[best])} kg/m², is the lightest that stops ${allThreats()} with ${confidenceWords()}.`;
  if (best !== null) {
    const z = worst(pair, best);
    const sure = isNaN(z) ? "How likely it is to stop is unknown." : `It stops with a probability of ${chance(z)}.`;
    return `${armour(pair, best)}, ${areal(pair.areal[best])} kg/m², is the lightest whose computed ballistic limit reaches ${allThreats()}${marginWords()}. ${sure}`;
  }
  const of = `No ${pair.name} on offer${within()}`;
  return anyAsked() ? `${of} is known to stop ${allThreats()} with ${confidenceWords()}.` :
    `${of} has a computed ballistic limit that reaches ${allThreats()}${marginWords()}.`;
}
function besides(pair, best, ring) {
  const words = [];
  if (!pair.known) words.push(`No test of ${pair.name} is known, so that no probability is.`);
  if (ring !== null && best !== null && anyAsked() && pair.areal[best] > pair.areal[ring]) {
    const more = pair.areal[best] - pair.areal[ring];
    words.push(`${short(pair, ring)}, ${areal(pair.areal[ring])} kg/m², stops more often than not: what is asked for costs ${areal(more)} kg/m², ${Math.round(100 * more / pair.areal[ring])} % more.`);
  }
  const own = best === null ? Infinity : pair.areal[best];
  const rival = DATA.pairs.map(p => [p, lightest(p)]).filter(([p, k]) => k !== null && p !== pair && p.areal[k] < own - 1e-9 && (isKnown(p, k) || !pair.known))
    .sort((a, b) => a[0].areal[a[1]] - b[0].areal[b[1]])[0];
  if (rival) words.push(`${armour(rival[0], rival[1])} is lighter, ${areal(rival[0].areal[rival[1]])} kg/m².`);
  if (pair.free.some(Boolean)) words.push("Any thickness is on offer; of those between the steps of this map a lighter one may do.");
  return words.join(" ");
}

// Words of a shell, quoted where they must be.
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
const path = (points, of) => svg("path", { class: of, d: `M${points.map(p => `${p[0].toFixed(1)} ${p[1].toFixed(1)}`).join("L")}` });
const text = (x, y, words, of, more) => svg("text", { x: x.toFixed(1), y: y.toFixed(1), class: of, "font-size": 12, ...more }, words);

// Values at equal distances of 1, 2 or 5 times a power of ten.
function ticks(low, high, count) {
  const raw = (high - low) / count || 1, power = 10 ** Math.floor(Math.log10(raw));
  const step = power * [1, 2, 5, 10].find(m => m * power >= raw * 0.999), found = [];
  for (let n = Math.ceil(low / step - 1e-9); n * step <= high + 1e-9 * step; n++) found.push(+(n * step).toPrecision(12));
  return found;
}

// --- the map

// Lines where a field over the nodes has a value, in pixels; fields are NaN where they are unknown.
function contour(view, field, level) {
  const { n, m, x, y } = view, ends = new Map(), segments = [];
  const at = (a, b, edge) => {
    const part = (level - field[a]) / (field[b] - field[a]);
    const [i, j, k, l] = [Math.floor(a / m), a % m, Math.floor(b / m), b % m];
    return { edge, point: [x[j] + part * (x[l] - x[j]), y[i] + part * (y[k] - y[i])] };
  };
  for (let i = 0; i < n - 1; i++)
    for (let j = 0; j < m - 1; j++) {
      const a = i * m + j, side = field[a] < level;
      if (side === field[a + 1] < level && side === field[a + m] < level && side === field[a + m + 1] < level) continue;
      const found = [];
      for (const [p, q, edge] of [[a, a + 1, 2 * a], [a + 1, a + m + 1, 2 * a + 3], [a + m, a + m + 1, 2 * (a + m)], [a, a + m, 2 * a + 1]])
        if (field[p] < level !== field[q] < level) found.push(at(p, q, edge));
      if (isNaN(field[a] + field[a + 1] + field[a + m] + field[a + m + 1])) continue;
      for (let s = 0; s + 1 < found.length; s += 2) {
        const segment = [found[s], found[s + 1]];
        segments.push(segment);
        for (const end of segment) ends.set(end.edge, [...(ends.get(end.edge) ?? []), segment]);
      }
    }
  const used = new Set(), lines = [];
  const follow = (segment, from) => {
    const points = [];
    for (let next = segment, edge = from; next; ) {
      used.add(next);
      const end = next[0].edge === edge ? next[1] : next[0];
      points.push(end.point);
      edge = end.edge;
      next = ends.get(edge).find(each => !used.has(each));
    }
    return points;
  };
  for (const segment of segments) {
    if (used.has(segment)) continue;
    const forward = follow(segment, segment[0].edge), other = ends.get(segment[0].edge).find(each => !used.has(each));
    lines.push([...(other ? follow(other, segment[0].edge).reverse() : []), segment[0].point, ...forward]);
  }
  return lines;
}
// The area where a field is at least a value, as the path of its cells cut at that value.
function area(view, field, level, of) {
  const { n, m, x, y } = view, parts = [];
  const round = p => `${p[0].toFixed(1)} ${p[1].toFixed(1)}`;
  for (let i = 0; i < n - 1; i++) {
    let start = -1;
    for (let j = 0; j < m; j++) {
      const a = i * m + j, full = j < m - 1 ? (field[a] >= level) + (field[a + 1] >= level) + (field[a + m] >= level) + (field[a + m + 1] >= level) : 0;
      if (full === 4) {
        if (start < 0) start = j;
        continue;
      }
      if (start >= 0) parts.push(`M${round([x[start], y[i]])}H${x[j].toFixed(1)}V${y[i + 1].toFixed(1)}H${x[start].toFixed(1)}Z`);
      start = -1;
      if (!full) continue;
      const nodes = [[a, j, i], [a + 1, j + 1, i], [a + m + 1, j + 1, i + 1], [a + m, j, i + 1]];
      if (nodes.some(([k]) => isNaN(field[k]))) continue;
      const corners = [];
      nodes.forEach(([k, l, o], c) => {
        const [p, q, r] = nodes[(c + 1) % 4];
        if (field[k] >= level) corners.push([x[l], y[o]]);
        if (field[k] >= level !== field[p] >= level) {
          const part = (level - field[k]) / (field[p] - field[k]);
          corners.push([x[l] + part * (x[q] - x[l]), y[o] + part * (y[r] - y[o])]);
        }
      });
      parts.push(`M${corners.map(round).join("L")}Z`);
    }
  }
  return svg("path", { class: of, d: parts.join("") });
}

let view;
function viewOf(pair) {
  const narrow = $("map").parentNode.clientWidth < 520;
  const flat = Math.min(pair.ceramics.length, pair.backings.length) > 1, tall = flat || pair.ceramics.length > 1;
  const [width, height] = narrow ? [390, tall ? 400 : 170] : [760, tall ? 600 : 190], frame = { left: 34, right: width - 48, top: 8, bottom: height - 24 };
  const scale = (values, from, to) => {
    const [low, high] = values.length > 1 ? [values[0], values.at(-1)] : [values[0] - 1, values[0] + 1];
    return { low, high, at: value => from + (to - from) * (value - low) / (high - low) };
  };
  const across = scale(pair.backings, frame.left, frame.right), up = scale(pair.ceramics, frame.bottom, frame.top);
  return { width, height, narrow, frame, across, up, n: pair.ceramics.length, m: pair.backings.length, x: pair.backings.map(across.at), y: pair.ceramics.map(up.at) };
}

// Put words on the longest of some lines, where it is farthest from the frame and from other words.
function label(lines, words, of, taken, group) {
  const { frame } = view, line = lines.reduce((a, b) => (b.length > a.length ? b : a), []);
  let best = null, most = 16;
  for (let s = 1; s < line.length - 1; s++) {
    const [x, y] = line[s];
    const edge = Math.min(x - frame.left, frame.right - x, y - frame.top, frame.bottom - y);
    const room = Math.min(edge, ...taken.map(([a, b]) => 0.5 * Math.hypot(x - a, 2 * (y - b))));
    if (room > most) [best, most] = [s, room];
  }
  if (best === null) return;
  const [x, y] = line[best], [a, b] = [line[best - 1], line[best + 1]];
  let angle = Math.atan2(b[1] - a[1], b[0] - a[0]) * 180 / Math.PI;
  if (Math.abs(angle) > 90) angle -= 180 * Math.sign(angle);
  taken.push([x, y]);
  group.append(text(x, y + 4, words, `halo ${of}`, { "text-anchor": "middle", "font-size": 11.5, transform: `rotate(${angle.toFixed(1)} ${x.toFixed(1)} ${y.toFixed(1)})` }));
}

function drawMap(pair, best, ring) {
  view = viewOf(pair);
  const { frame, width, height, across, up } = view, box = $("map"), count = pair.areal.length;
  const areas = svg("g"), lines = svg("g"), words = svg("g"), marks = svg("g"), taken = [];
  const asked = wanted(), fields = { asked: new Float64Array(count), even: new Float64Array(count), unknown: new Float64Array(count) };
  const fast = threats.map((_, t) => asked[t] !== null && sure(pair, t, asked[t])), evens = threats.map((_, t) => kept(pair, "even", t, 0, stopped));
  for (let k = 0; k < count; k++) {
    let a = Infinity, e = Infinity;
    for (let t = 0; t < T; t++) {
      const v = state.velocities[t];
      a = Math.min(a, pair.limits[k * T + t] - required(t), fast[t] ? fast[t][k] - v : Infinity);
      e = Math.min(e, evens[t][k] - v);
    }
    fields.asked[k] = a;
    fields.even[k] = -e;
    fields.unknown[k] = isNaN(e) ? 1 : 0;
  }
  const flat = view.n > 1 && view.m > 1;
  if (flat) {
    if (pair.known) areas.append(area(view, fields.unknown, 1e-3, "unknown"), area(view, fields.even, 0, "fails"));
    if (anyAsked()) areas.append(area(view, fields.asked, 0, "stops"));
  }

  // Designs first: labels of lines keep clear of their words.
  const right = [], colours = [[ring, "even", "t-red", "red thin"], [best, "best", anyAsked() ? "t-blue" : "strong", "blue thin"]];
  for (const [k, of, colour, line] of colours) {
    if (k === null || (of === "even" && k === best)) continue;
    const [c, b] = thicknesses(pair, k), [x, y] = [across.at(b), up.at(c)], above = of === "best";
    marks.append(svg("circle", { class: of, cx: x, cy: y, r: above ? 7.5 : 6 }));
    const said = [short(pair, k), `${areal(pair.areal[k])} kg/m², ${chance(worst(pair, k))}`], room = 6.6 * Math.max(...said.map(w => w.length));
    const start = above ? x + 12 + room < width : x - 12 - room < frame.left, middle = x + (start ? 12 : -12) + (start ? 0.5 : -0.5) * room;
    said.forEach((w, n) => words.append(text(x + (start ? 12 : -12), y + (above ? -20 : 18) + 14 * n, w, `halo ${colour}`, { "text-anchor": start ? "start" : "end" })));
    taken.push([middle, y + (above ? -16 : 22)], [middle - room / 3, y + (above ? -16 : 22)], [middle + room / 3, y + (above ? -16 : 22)], [x, y]);
    right.push([pair.areal[k], line, colour]);
  }

  // Lines of equal areal density are straight.
  const [rc, rb] = pair.densities, [lightestHere, heaviest] = [pair.areal[0], pair.areal[count - 1]];
  const heights = [];
  const straight = (value, of, colour, strong) => {
    const ends = [];
    for (const x of [across.low, across.high]) {
      const c = rc > 0 && pair.ceramic ? (1000 * (value - DATA.added.areal) - rb * x) / rc : NaN;
      if (c >= up.low - 1e-9 && c <= up.high + 1e-9) ends.push([across.at(x), up.at(c)]);
    }
    for (const c of [up.low, up.high]) {
      const x = (1000 * (value - DATA.added.areal) - (pair.ceramic ? rc * c : 0)) / rb;
      if (x > across.low && x < across.high) ends.push([across.at(x), up.at(c)]);
    }
    if (ends.length < 2) return;
    ends.sort((a, b) => a[0] - b[0]);
    lines.append(path([ends[0], ends.at(-1)], of));
    const [x, y] = ends.at(-1);
    if (x > frame.right - 1 && heights.every(h => Math.abs(h - y) > 13)) {
      heights.push(y);
      words.append(text(frame.right + 9, y + 4, strong ? areal(value) : trimmed(value), colour));
    }
  };
  if (flat) {
    for (const [value, of, colour] of right.reverse()) straight(value, of, colour, true);
    for (const value of ticks(lightestHere, heaviest, view.narrow ? 4 : 6)) straight(value, "dotted", "t-soft", false);
    const drawn = (field, level, of, said, colour, group = lines) => {
      const found = contour(view, field, level);
      for (const line of found) group.append(path(line, of));
      if (said) label(found, said, colour, taken, words);
    };
    const front = svg("g");
    if (pair.known) drawn(fields.even, 0, "red", "50 %", "t-red", front);
    if (anyAsked()) drawn(fields.asked, 0, "blue", pair.known ? (threats.every(t => t.own === null) ? `${trimmed(state.confidence)} %` : "asked for") : "", "t-blue", front);
    else drawn(fields.asked, 0, "ink", `computed limit = velocity${threats.some(t => t.margin) ? " + margin" : ""}`, "strong", front);
    if (state.lines !== "none") {
      const own = Float64Array.from({ length: count }, (_, k) => pair.limits[k * T + +state.lines]);
      for (const level of ticks(Math.min(...own), Math.max(...own), view.narrow ? 6 : 10)) drawn(own, level, "grey", String(level), "t-soft");
    }
    lines.append(front);
  }
  const outline = state.tests && pair.tested[state.lines === "none" ? 0 : +state.lines];
  if (outline && flat) {
    const cut = (value, of) => Math.min(Math.max(value, of.low), of.high), [[a, b], [c, d]] = outline;
    const [left, end, low, high] = [across.at(cut(c, across)), across.at(cut(d, across)), up.at(cut(a, up)), up.at(cut(b, up))];
    if (end > left && low > high) {
      lines.append(svg("rect", { class: "green", x: left, y: high, width: end - left, height: low - high }));
      words.append(text(end - 4, low - 5, "thicknesses tested", "halo t-green", { "text-anchor": "end", "font-size": 11.5 }));
    }
  }
  if (pair.onOffer.length <= 400) {
    const passing = new Set(pair.designs.filter(k => light(pair, k) && asked.every((z, t) => stops(pair, k, t, z))));
    for (const k of pair.onOffer) {
      const [c, b] = thicknesses(pair, k);
      lines.append(svg("circle", { class: passing.has(k) ? "dot on" : "dot", cx: across.at(b), cy: up.at(c), r: 2.6 }));
    }
  }
  const axes = svg("g");
  axes.append(svg("rect", { class: "frame", x: frame.left, y: frame.top, width: frame.right - frame.left, height: frame.bottom - frame.top }));
  const marked = (values, of, low, high) => (values.length > 1 ? ticks(low, high, of) : values);
  for (const b of marked(pair.backings, view.narrow ? 5 : 8, across.low, across.high))
    axes.append(text(across.at(b), frame.bottom + 16, trimmed(b), "t-soft", MIDDLE));
  for (const c of marked(pair.ceramics, view.narrow ? 5 : 9, up.low, up.high))
    axes.append(text(frame.left - 6, up.at(c) + 4, trimmed(c), "t-soft", { "text-anchor": "end" }));
  box.setAttribute("viewBox", `0 0 ${width} ${height}`);
  box.setAttribute("aria-label", `Map of ${pair.name}. ${headline(pair, best)}`);
  box.replaceChildren(areas, lines, axes, marks, words, svg("g", { id: "over" }));
  const said = flat ? ["Dotted: equal areal density.", ...(state.lines === "none" ? [] : ["Thin: equal ballistic limit, m/s."])] : [];
  if (flat && pair.known) said.push("Red: perforated more often than not.", ...(anyAsked() ? ["Blue: stops as asked for."] : []));
  if (pair.onOffer.length <= 400) said.push("Dots: on offer, filled where they do what is asked for.");
  said.push("Point at a design to read it, click to pin it. Keys: arrows move (Shift: five steps), Home goes to the lightest, Enter pins, Escape leaves.");
  $("keys").textContent = said.join(" ");
  $("areal-name").hidden = !flat;
  $("y-name").textContent = pair.ceramic ? `↑ ceramic ${pair.ceramic}, mm` : "";
  $("x-name").textContent = `back plate ${pair.backing}, mm →`;
  drawOver(pair);
}

// What follows the pointer, and the pins.
function drawOver(pair) {
  const over = $("over"), { frame, across, up } = view;
  over.replaceChildren();
  state.pins.forEach((pin, n) => {
    if (pin.pair !== pair) return;
    const [c, b] = thicknesses(pair, pin.k), [x, y] = [across.at(b), up.at(c)];
    over.append(svg("circle", { class: "pin", cx: x, cy: y, r: 8 }), text(x, y + 4, String(n + 1), "pin-text", MIDDLE));
  });
  if (state.cursor === null) return;
  const [c, b] = thicknesses(pair, state.cursor), [x, y] = [across.at(b), up.at(c)];
  over.append(path([[frame.left, y], [x, y]], "cross"), path([[x, frame.bottom], [x, y]], "cross"), svg("circle", { class: "cursor", cx: x, cy: y, r: 8 }));
  const chip = (cx, cy, said, width) => over.append(svg("rect", { class: "pin", x: cx - width / 2, y: cy - 10, width, height: 19, rx: 3 }), text(cx, cy + 4, said, "pin-text", MIDDLE));
  if (pair.ceramic) chip(frame.left - 15, y, trimmed(c), 32);
  chip(x, frame.bottom + 13, trimmed(b), 32);
  const said = `${areal(pair.areal[state.cursor])} kg/m² · ${chance(worst(pair, state.cursor))}`, width = 7 * said.length + 8;
  chip(Math.min(Math.max(x, width / 2), view.width - width / 2), y > 40 ? y - 24 : y + 26, said, width);
}

// --- beside the map

function drawPairs() {
  const box = $("pairs");
  box.hidden = DATA.pairs.length < 2;
  if (box.hidden) return;
  const rows = DATA.pairs.map(pair => [pair, lightest(pair), even(pair)]);
  const values = rows.flatMap(([p, a, b]) => [a, b].filter(k => k !== null).map(k => p.areal[k]));
  const low = Math.min(...values), high = Math.max(...values), at = v => 8 + 96 * (high > low ? (v - low) / (high - low) : 0.5);
  const focused = box.contains(document.activeElement);
  box.replaceChildren(box.querySelector("legend"), ...rows.map(([pair, best, ring], n) => {
    const input = html("input", { type: "radio", name: "pair", value: n });
    input.checked = DATA.pairs[state.pair] === pair;
    input.addEventListener("change", () => { state.pair = n; state.cursor = null; draw(); });
    const picture = svg("svg", { viewBox: "0 0 210 18", "aria-hidden": "true" });
    const places = [ring, best].filter(k => k !== null).map(k => at(pair.areal[k]));
    if (places.length === 2) picture.append(path([[places[0], 9], [places[1], 9]], "frame"));
    if (ring !== null) picture.append(svg("circle", { class: "even", cx: at(pair.areal[ring]), cy: 9, r: 4 }));
    if (best !== null) picture.append(svg("circle", { class: isKnown(pair, best) ? "best" : "cursor", cx: at(pair.areal[best]), cy: 9, r: 5 }));
    const said = best === null ? (pair.known ? "none on offer" : "unknown") : areal(pair.areal[best]) + (isKnown(pair, best) ? "" : ", unknown");
    picture.append(text(places.length ? Math.max(...places) + 9 : 8, 13, said, "", { "font-size": 11.5 }));
    return html("div", { class: "pair" }, html("label", {}, input, ` ${pair.name}`), picture);
  }));
  if (focused) box.querySelector("input:checked").focus();
}

// Draw a curve above a slider, with the place of its value.
function drawCurve(slider, xs, ys, value) {
  const real = ys.filter(Number.isFinite), picture = slider.picture, at = x => 4 + 292 * (x - xs[0]) / (xs.at(-1) - xs[0]);
  picture.replaceChildren();
  if (!real.length) return picture.append(text(4, 28, "none on offer", "t-soft", SMALL));
  const low = Math.min(...real), high = Math.max(...real), up = y => 34 - 14 * (high > low ? (y - low) / (high - low) : 0);
  const points = xs.map((x, n) => [at(x), up(ys[n])]).filter((_, n) => Number.isFinite(ys[n]));
  picture.append(path(points, "frame"), text(4, points[0][1] - 5, areal(real[0]), "t-soft", SMALL));
  if (points.at(-1)[0] < 215) picture.append(text(300, 40, "none on offer", "t-soft", { "font-size": 11, "text-anchor": "end" }));
  const pair = DATA.pairs[state.pair], best = lightest(pair);
  if (best === null) return;
  const x = at(value), y = up(pair.areal[best]);
  picture.append(svg("circle", { class: "best", cx: x, cy: y, r: 4.5 }));
  if (x > 50) picture.append(text(Math.min(x, 266), y - 8, `${areal(pair.areal[best])} kg/m²`, "strong", { "font-size": 11, "text-anchor": "middle" }));
}
const sliders = [];
function slider(name, min, max, step, value, said, changed, points) {
  const input = html("input", { type: "range", min, max, step, "aria-label": name }), output = html("output");
  input.value = value;
  const picture = svg("svg", { viewBox: "0 0 300 42", "aria-hidden": "true" });
  const made = { input, picture, show: () => {
    output.textContent = said();
    input.setAttribute("aria-valuetext", said());
    if (points) points(made);
  } };
  input.addEventListener("input", () => { changed(+input.value); state.cursor = null; draw(); });
  $("sliders").append(html("div", { class: "slider" }, html("div", {}, html("span", {}, name), output), points ? picture : null, input));
  sliders.push(made);
}
function makeSliders() {
  const spread = (low, high, count) => Array.from({ length: count + 1 }, (_, n) => low + (high - low) * n / count);
  if (threats.some(t => t.own === null))
    slider("Confidence", 50, 99, state.confidence === null || Number.isInteger(state.confidence) ? 1 : "any", state.confidence ?? 50,
      () => (state.confidence === null ? "none asked for" : `${trimmed(state.confidence)} %`),
      value => { state.confidence = value > 50 ? value : null; },
      made => drawCurve(made, spread(50, 99, 49), overConfidence(DATA.pairs[state.pair], spread(50, 99, 49)), state.confidence ?? 50));
  threats.forEach((threat, t) => {
    const reach = Math.max(Math.round(0.35 * threat.velocity), 1), low = threat.velocity - reach, high = threat.velocity + reach;
    const own = threat.own === null ? "" : `, ${trimmed(100 * threat.own)} % asked for`;
    slider(`${letter(t)}${threat.name}${threat.obliquity ? ` at ${threat.obliquity}°` : ""}${own}`, low, high, 1, threat.velocity,
      () => `${trimmed(state.velocities[t])} m/s${threat.margin ? ` + ${threat.margin}` : ""}`,
      value => { state.velocities[t] = value; },
      made => drawCurve(made, spread(low, high, 60), overVelocity(DATA.pairs[state.pair], t, spread(low, high, 60)), state.velocities[t]));
  });
  const every = DATA.pairs.flatMap(p => [p.areal[0], p.areal.at(-1)]), low = Math.floor(Math.min(...every)), high = Math.ceil(Math.max(...every));
  slider("Greatest areal density", low, high, 0.5, Math.min(state.most, high), () => (state.most < Infinity ? `${trimmed(state.most)} kg/m²` : "any"),
    value => { state.most = value < high ? value : Infinity; });
}

function crossSection(pair, k) {
  const [c, b] = thicknesses(pair, k), rods = threats.map(t => t.rod), longest = Math.max(...rods.map(r => r[0]));
  const angles = threats.map(t => t.obliquity * Math.PI / 180), rows = rods.map((r, t) => 1.7 * r[1] + 2 + r[0] * Math.sin(angles[t])), tall = Math.max(rows.reduce((a, d) => a + d, 0), 0.8 * (c + b)), wide = longest + c + b + 12, gap = longest + 3;
  const font = Math.max(wide, tall * 2) / 26, picture = svg("svg", { viewBox: `0 0 ${Math.max(wide, tall * 2)} ${tall + 3.4 * font}`, role: "img", "aria-label": `Cross-section to scale: ${armour(pair, k)}` });
  const sized = { "font-size": font, "text-anchor": "middle" }, top = 1.4 * font;
  if (pair.ceramic) picture.append(svg("rect", { class: "ceramic", x: gap, y: top, width: c, height: tall }));
  picture.append(svg("rect", { class: "metal", x: gap + c, y: top, width: b, height: tall }));
  picture.append(text(gap + (c + b) / 2, font, pair.ceramic ? `${trimmed(c)} + ${trimmed(b)} mm` : `${trimmed(b)} mm`, "", sized));
  let y = top + (tall - rows.reduce((a, d) => a + d, 0)) / 2;
  rods.forEach((rod, t) => {
    const middle = y + rows[t] - 0.85 * rod[1] - 1, tip = gap - 2 - 0.5 * rod[1] * Math.sin(angles[t]);
    const drawn = svg("g", { transform: `rotate(${threats[t].obliquity} ${tip} ${middle})` }, svg("rect", { class: "rod", x: tip - rod[0], y: middle - rod[1] / 2, width: rod[0], height: rod[1] }));
    if (T > 1) drawn.append(text(tip - rod[0] / 2, middle + font / 3, LETTERS[t % 26], "pin-text", sized));
    picture.append(drawn);
    y += rows[t];
  });
  const base = top + tall + 1.2 * font;
  picture.append(svg("rect", { class: "pin", x: 1, y: base - 0.3, width: 10, height: font / 12 }), text(12, base + font / 3, "10 mm", "", { "font-size": font }));
  return picture;
}
// The distribution of the ballistic limit, from 1 to 99 %, cut at the velocity of the threat.
function distribution(pair, d, v) {
  const V = pair.stops, o = d * Q, low = V[o], high = V[o + Q - 1], from = Math.min(low, v), to = Math.max(high, v);
  const at = x => 300 * (x - from) / (to - from), count = 90, heights = [];
  for (let n = 0; n <= count; n++) {
    const x = low + (high - low) * n / count, h = (high - low) / count;
    heights.push([x, below(score(pair, d, Math.max(x - h, low))) - below(score(pair, d, Math.min(x + h, high)))]);
  }
  heights[0][1] = heights[1][1] / 2;
  heights[count][1] = heights[count - 1][1] / 2;
  const most = Math.max(...heights.map(h => h[1])), shape = points => points.length > 1 ? `M${at(points[0][0])} 44${points.map(p => `L${at(p[0]).toFixed(1)} ${(44 - 38 * p[1] / most).toFixed(1)}`).join("")}L${at(points.at(-1)[0])} 44Z` : "";
  const picture = svg("svg", { viewBox: "0 0 300 46", "aria-hidden": "true" });
  picture.append(svg("path", { class: "below", d: shape(heights.filter(h => h[0] <= v)) }), svg("path", { class: "above", d: shape(heights.filter(h => h[0] >= v)) }));
  picture.append(path([[at(v), 2], [at(v), 46]], "bar"));
  return picture;
}
function drawDesign(pair, best) {
  const k = state.cursor ?? best, box = $("design");
  box.replaceChildren();
  if (k === null) return box.append(html("p", { class: "soft" }, "Point at a design to read it."));
  const [c, b] = thicknesses(pair, k), governs = governing(pair, k), pinned = state.pins.some(p => p.pair === pair && p.k === k);
  box.append(html("h2", {}, armour(pair, k)));
  const difference = best === null || k === best ? "" : ` (${pair.areal[k] < pair.areal[best] ? "−" : "+"}${areal(Math.abs(pair.areal[k] - pair.areal[best]))})`;
  box.append(html("p", {}, `${areal(pair.areal[k])} kg/m²${difference}, ${trimmed(c * !!pair.ceramic + b + DATA.added.thickness)} mm thick`, k === best ? html("span", { class: "t-blue" }, ` lightest${anyAsked() ? " as asked for" : ""}`) : null));
  if (pair.excluded.includes(k)) box.append(html("p", { class: "t-red" }, "Beyond the limits of the scenario."));
  box.append(crossSection(pair, k));
  threats.forEach((threat, t) => {
    const d = k * T + t, v = state.velocities[t], z = score(pair, d, v), limit = pair.limits[d];
    box.append(html("div", { class: "row" }, html("span", {}, `${letter(t)}${shot(t)}`), html("b", {}, isNaN(z) ? "probability unknown" : `${chance(z)} stopped`)));
    if (!isNaN(z)) box.append(distribution(pair, d, v));
    const margin = Math.floor(limit + 1e-4) - v;
    box.append(html("p", { class: "soft" }, `Computed limit ${Math.floor(limit + 1e-4)} m/s, margin ${margin < 0 ? "−" : "+"}${trimmed(Math.abs(margin))} m/s${T > 1 && t === governs ? "; governs" : ""}`));
  });
  const button = html("button", { type: "button" }, pinned ? "Remove the pin" : "Pin this design");
  button.addEventListener("click", () => pin(k));
  box.append(button);
}
function pin(k) {
  const pair = DATA.pairs[state.pair], place = state.pins.findIndex(p => p.pair === pair && p.k === k);
  if (place >= 0) state.pins.splice(place, 1);
  else state.pins = [...state.pins, { pair, k }].slice(-MAX_PINS);
  drawOver(pair);
  drawDesign(pair, lightest(pair));
  drawTable(pair, lightest(pair), even(pair));
}
const parts = words => words.split(/ (?=--set )/).flatMap(part => [html("span", {}, part), " "]);
async function copy(words, code, button) {
  try {
    await navigator.clipboard.writeText(words);
    button.textContent = "Copied";
  } catch {
    getSelection().selectAllChildren(code);
    button.textContent = document.execCommand("copy") ? "Copied" : "Selected";
  }
}
function drawTable(pair, best, ring) {
  const rows = [[pair, best, "●", "t-blue"], [pair, ring === best ? null : ring, "○", "t-red"], ...state.pins.map((p, n) => [p.pair, p.k, String(n + 1), "", p])].filter(row => row[1] !== null);
  const from = best === null ? null : pair.areal[best];
  const heads = ["armour", "kg/m²", ...(from === null ? [] : [`from ${areal(from)}`]), ...threats.flatMap((_, t) => [`${letter(t)}limit, m/s`, `${letter(t)}stopped`])];
  const body = html("tbody");
  for (const [of, k, mark, colour, pinned] of rows) {
    const difference = from === null ? 0 : of.areal[k] - from;
    const cells = [areal(of.areal[k]), ...(from === null ? [] : [Math.abs(difference) < 0.05 ? "" : `${difference < 0 ? "−" : "+"}${areal(Math.abs(difference))}`]),
      ...threats.flatMap((_, t) => [String(Math.floor(of.limits[k * T + t] + 1e-4)), chance(scored(of, k, t))])];
    body.append(html("tr", {}, html("td", {}, html("span", {}, html("span", { class: colour }, `${mark} `), armour(of, k))), ...cells.map((cell, i) => html("td", { "data-label": heads[i + 1] }, html("span", {}, cell)))));
    const words = command(of, k), code = html("code", {}, ...parts(words)), button = html("button", { type: "button" }, "Copy");
    button.addEventListener("click", () => copy(words, code, button));
    const cell = html("td", { colspan: heads.length }, code, button);
    if (pinned) {
      const remove = html("button", { type: "button" }, "Remove");
      remove.addEventListener("click", () => { state.pins = state.pins.filter(p => p !== pinned); draw(); });
      cell.append(" ", remove);
    }
    body.append(html("tr", { class: "command" }, cell));
  }
  $("table").replaceChildren(html("table", {}, html("thead", {}, html("tr", {}, ...heads.map(each => html("th", { scope: "col" }, each)))), body));
}
function drawNotes(pair) {
  const kinds = pair.onOffer.length, said = [
    pair.known && `Probabilities of ${pair.name} rest on: ${pair.source}.`,
    "Probabilities are those of one shot and of the error of the model, as the evidence gives it; they are no probability of survival.",
    `${kinds} designs of this pair are ${pair.free.some(Boolean) ? "shown of any thickness on offer" : "on offer, and exact"}; lines between them are interpolated.${pair.coarser ? " To keep the page small, they are coarser than they could be." : ""}`,
    pair.known && pair.stops.some(isNaN) && "Grey: the probability is unknown, as such thicknesses are too unlike the tests.",
    ...DATA.notes, `armour ${DATA.version}${DATA.title ? `; ${DATA.title}` : ""}`,
  ];
  $("notes").replaceChildren(...said.filter(Boolean).map(each => html("p", {}, each)));
}

function draw() {
  const pair = DATA.pairs[state.pair], best = lightest(pair), ring = even(pair);
  $("headline").textContent = headline(pair, best);
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
  const pair = DATA.pairs[state.pair];
  state.cursor = k;
  drawOver(pair);
  drawDesign(pair, lightest(pair));
}
function nearest(event) {
  const pair = DATA.pairs[state.pair], box = $("map").getBoundingClientRect(), factor = view.width / box.width;
  const [x, y] = [(event.clientX - box.left) * factor, (event.clientY - box.top) * factor];
  const closest = (places, at, to) => places.reduce((a, b) => (Math.abs(at[b] - to) < Math.abs(at[a] - to) ? b : a));
  return closest(pair.offered[0], view.y, y) * view.m + closest(pair.offered[1], view.x, x);
}
function keyed(event) {
  const pair = DATA.pairs[state.pair], moves = { ArrowUp: [1, 0], ArrowDown: [-1, 0], ArrowRight: [0, 1], ArrowLeft: [0, -1] };
  if (event.key === "Home") move(lightest(pair));
  else if (event.key === "Escape") move(null);
  else if (event.key === "Enter") { if ((state.cursor ?? lightest(pair)) !== null) pin(state.cursor ?? lightest(pair)); }
  else if (moves[event.key]) {
    const from = pair.places[state.cursor ?? lightest(pair) ?? pair.onOffer[0]], step = event.shiftKey ? 5 : 1;
    const [i, j] = [0, 1].map(axis => {
      const of = pair.offered[axis], place = of.indexOf(from[axis]) + step * moves[event.key][axis];
      return of[Math.min(Math.max(place, 0), of.length - 1)];
    });
    move(i * view.m + j);
  } else return;
  event.preventDefault();
}
function start() {
  DATA.pairs.forEach(decoded);
  // The pair of materials that comes first is the one with the lightest design that is known to do what is asked.
  const found = DATA.pairs.map((p, n) => [n, p, lightest(p)]).filter(([, , k]) => k !== null);
  found.sort(([, p, k], [, q, l]) => isKnown(q, l) - isKnown(p, k) || p.areal[k] - q.areal[l]);
  state.pair = found.length ? found[0][0] : 0;
  $("about").textContent = DATA.subject;
  for (let t = 0; t < T; t++) $("lines").append(html("option", { value: t }, T > 1 ? `ballistic limit against ${LETTERS[t % 26]}` : "ballistic limit"));
  $("lines").append(html("option", { value: "none" }, "areal density only"));
  makeSliders();
  $("lines").addEventListener("change", () => { state.lines = $("lines").value; draw(); });
  $("tests").addEventListener("change", () => { state.tests = $("tests").checked; draw(); });
  const map = $("map");
  map.addEventListener("pointermove", event => move(nearest(event)));
  map.addEventListener("pointerdown", event => move(nearest(event)));
  map.addEventListener("pointerleave", event => event.pointerType !== "touch" && move(null));
  map.addEventListener("click", event => event.pointerType !== "touch" && pin(nearest(event)));
  map.addEventListener("keydown", keyed);
  let width = innerWidth;
  addEventListener("resize", () => { if (innerWidth !== width) { width = innerWidth; draw(); } });
  draw();
}
start();
