"""What the page does by itself when someone zooms or chooses: JavaScript for Bokeh's callbacks."""

ZOOM = """
// Rebin the fine envelope for the visible stretch, and show single samples where some are on the page.
const key = "zoom_" + shown.id;
clearTimeout(globalThis[key]);
globalThis[key] = setTimeout(() => {
  const t = fine.data.t, columns = Object.keys(fine.data).filter(name => name != "t");
  const below = x => {
    let a = 0, b = t.length;
    while (a < b) { const m = (a + b) >> 1; if (t[m] < x) a = m + 1; else b = m; }
    return a;
  };
  const first = Math.max(0, below(range.start) - 1), last = Math.min(t.length, below(range.end) + 2);
  const factor = Math.max(1, Math.ceil((last - first) / most));
  const edges = [];
  for (let i = first; i < last; ) {
    let j = Math.min(i + factor, last);
    if (isNaN(fine.data[columns[0]][i])) j = i + 1;
    else for (let k = i + 1; k < j; k++) if (isNaN(fine.data[columns[0]][k])) { j = k; break; }
    edges.push([i, j]);
    i = j;
  }
  const data = {t: new Float64Array(edges.map(([i, j]) => 0.5 * (t[i] + t[j - 1])))};
  for (const name of columns) {
    const from = fine.data[name], better = name.startsWith("low_") ? Math.min : Math.max;
    data[name] = new Float32Array(edges.map(([i, j]) => {
      let v = from[i];
      for (let k = i + 1; k < j; k++) v = better(v, from[k]);
      return v;
    }));
  }
  shown.data = data;
  const exact = {t: []}, names = Object.keys(samples.data).filter(name => name != "t");
  for (const name of names) exact[name] = [];
  if (range.end - range.start <= longest) {
    let until = -Infinity;
    const order = windows.map((_, i) => i).sort((a, b) => begins[a] - begins[b]);
    for (const i of order) {
      const dt = windows[i].data.dt;
      let some = false;
      for (let k = 0; k < dt.length; k++) {
        const at = begins[i] + dt[k];
        if (at <= until || at < range.start || at > range.end) continue;
        if (!some && exact.t.length) { exact.t.push(at); for (const name of names) exact[name].push(NaN); }
        some = true;
        exact.t.push(at);
        for (const name of names) exact[name].push(windows[i].data[name][k]);
        until = at;
      }
    }
  }
  samples.data = exact;
}, 40);
"""

CHOOSE = """
// Show another stretch of samples: figures over time, wavelet maps, and the phase diagrams that belong to it.
const i = pick.options.indexOf(pick.value);
const of = windows[i].data, n = of.dt.length, begin = begins[i], end = begin + of.dt[n - 1];
const data = {t: new Float64Array(n)};
for (let k = 0; k < n; k++) data.t[k] = begin + of.dt[k];
for (const name of Object.keys(now.data)) if (name != "t") data[name] = of[name];
now.data = data;
stages.forEach((stage, s) => {
  const f = frequencies[i][s], shown = f > 0.01 ? Math.min(end - begin, cycles / f) : end - begin;
  const figure = figures[s], stop = end, start = end - shown;
  figure.x_range.setv({bounds: null});
  figure.x_range.setv({start, end: stop, reset_start: start, reset_end: stop, bounds: [begin, end]});
  let low = Infinity, high = -Infinity;
  for (const mesh of meshes[s]) for (let k = 0; k < n; k++) if (data.t[k] >= start && data[mesh][k] === data[mesh][k]) {
    low = Math.min(low, data[mesh][k]); high = Math.max(high, data[mesh][k]);
  }
  const room = Math.max(0.08 * (high - low), 1e-3);
  figure.y_range.setv({start: low - room, end: high + room, reset_start: low - room, reset_end: high + room});
  if (maps.length) {
    const map = maps[s];
    map.source.data = {image: map.holder.data[String(i)], x: [begin], y: [map.y], dw: [end - begin], dh: [map.dh]};
    map.range.setv({bounds: null});
    map.range.setv({start: begin, end, reset_start: begin, reset_end: end, bounds: [begin, end]});
  }
});
if (place) { place.end = Math.max(0.01, end - begin); place.value = Math.min(place.value, place.end); }
"""

PATHS = """
// Phase diagrams: some mesh cycles of the chosen stretch, interpolated between samples.
const i = pick.options.indexOf(pick.value);
const of = windows[i].data, slow = knots[i].data, n = of.dt.length;
const levelAt = (name, time) => {
  const t = slow.t; let k = 0;
  while (k < t.length - 2 && t[k + 1] < time) k++;
  const share = t.length > 1 ? (time - t[k]) / (t[k + 1] - t[k]) : 0;
  return t.length > 1 ? slow[name][k] + share * (slow[name][k + 1] - slow[name][k]) : slow[name][0];
};
stages.forEach((stage, s) => {
  const f = frequencies[i][s];
  if (!(f > 0.01)) return;
  const last = Math.min(place.value, of.dt[n - 1]), first = Math.max(0, last - many.value / f);
  const step = Math.max(0.02, Math.min(1, rate / (points * f))), from = first * rate, to = Math.min(last * rate, n - 1);
  for (const mesh of meshes[s]) {
    const x = of[mesh], v = of["v_" + mesh], xs = [], vs = [];
    for (let p = from; p <= to; p += step) {
      const k = Math.min(Math.floor(p), n - 2), u = p - k, h = 1e3 / rate;  // mm/s times h is µm
      const w = 1 - u, a = (1 + 2 * u) * w * w, b = u * w * w, c = u * u * (3 - 2 * u), d = u * u * (u - 1);
      const before = v[Math.max(0, k - 1)], after = v[Math.min(n - 1, k + 2)];
      xs.push(a * x[k] + b * h * v[k] + c * x[k + 1] + d * h * v[k + 1] - levelAt(mesh, p / rate));
      vs.push(a * v[k] + b * 0.5 * (v[k + 1] - before) + c * v[k + 1] + d * 0.5 * (after - v[k]));
    }
    paths[mesh].data = {x: xs, v: vs};
  }
  const text = `Stage ${stage}: phase diagram, ${many.value} mesh cycles before ${(begins[i] + last).toFixed(2)} s`;
  if (portraits[s]) portraits[s].title.text = text;
});
"""

POINTS = """
// Poincaré sections: the points of the chosen time.
const [first, last] = when.value;
every.forEach((all, s) => {
  const t = all.data.t, planet = all.data.planet;
  let count = 0;
  for (const [number, source] of Object.entries(planets[s])) {
    const xs = [], vs = [];
    for (let k = 0; k < t.length; k++) if (planet[k] == number && t[k] >= first && t[k] <= last) {
      xs.push(all.data.x[k]); vs.push(all.data.v[k]);
    }
    count += xs.length;
    source.data = {x: xs, v: vs};
  }
  const text = `Stage ${stages[s]}: Poincaré section, ${first.toFixed(0)} to ${last.toFixed(0)} s (${count} points)`;
  sections[s].title.text = text;
});
"""
