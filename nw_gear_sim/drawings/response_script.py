"""The scripts of the page of responses, which run in the browser."""

CHOSEN = """
const point = data[Number(select.value)], si = units.active == 1;
for (const [mesh, view] of Object.entries(views)) {
  const d = point[mesh], um = si ? 1e6 * d.b : 1, hz = si ? d.wn / (2 * Math.PI) : 1, s = si ? 1 / d.wn : 1;
  const mms = si ? 1e3 * d.b * d.wn : 1;
  const times = (values, k) => Float64Array.from(values, v => v * k);
  view.history.data = {t: times(d.t, s), x: times(d.x, um)};
  view.spectrum.data = {f: times(d.f, hz), a: times(d.a, um)};
  view.phase.data = {x: times(d.px, um), v: times(d.pv, mms)};
  view.section.data = {x: times(d.sx, um), v: times(d.sv, mms)};
  const orders = [0.5, 1, 2, 3, 4, 5];
  view.orders.data = {f: orders.map(k => k * d.fm * hz), name: orders.map(k => k == 1 ? "f_m" : k + " f_m")};
  view.image.data = {image: [d.image], x: [0], y: [d.low * hz], dw: [d.length * s], dh: [(d.high - d.low) * hz]};
  const line = times(d.line, hz), before = times(d.edge, s), after = Float64Array.from(before, v => d.length * s - v);
  view.cone.data = {xs: [before, after], ys: [line, line]};
  view.map_y.start = d.low * hz; view.map_y.end = d.high * hz;
  view.map_x.start = 0; view.map_x.end = d.length * s;
  view.facts.text = d.facts;
  const labels = si ? ["Time (s)", "x (um)", "Frequency (Hz)", "Amplitude (um)", "v (mm/s)"]
                    : ["tau = omega_n t", "x / b", "omega / omega_n", "Amplitude / b", "v / (b omega_n)"];
  for (const [k, name] of view.axes) k.axis_label = labels[name];
  const title = view.map_title;
  title.text = `Wavelet map, colours from ${(Math.pow(10, d.top - decades) * um).toPrecision(2)} to ` +
               `${(Math.pow(10, d.top) * um).toPrecision(2)} ${si ? "um" : "b"}`;
}
"""

SURFACES = """
const a = azimuth.value * Math.PI / 180, e = elevation.value * Math.PI / 180, si = units.active == 1;
const ca = Math.cos(a), sa = Math.sin(a), ce = Math.cos(e), se = Math.sin(e);
const flat = (x, y, z) => [x * ca - y * sa, (x * sa + y * ca) * se + z * ce];
for (const view of views) {
  const lines = view.lines, order = lines.map((_, k) => k);
  if (ca < 0) order.reverse();
  const out = {xs: [], ys: [], colour: []};
  for (const k of order.reverse()) {
    const line = lines[k], n = line.x.length, xs = new Float64Array(n), ys = new Float64Array(n);
    for (let i = 0; i < n; i++) [xs[i], ys[i]] = flat(line.x[i], line.y, line.z[i]);
    out.xs.push(xs); out.ys.push(ys); out.colour.push(line.colour);
  }
  view.source.data = out;
  const frame = {xs: [], ys: []}, text = {x: [], y: [], text: []};
  const edge = (p, q) => {
    const [x0, y0] = flat(...p), [x1, y1] = flat(...q);
    frame.xs.push([x0, x1]); frame.ys.push([y0, y1]);
  };
  for (const [p, q] of view.edges) edge(p, q);
  for (const mark of view.marks) {
    const [x, y] = flat(...mark.at);
    text.x.push(x); text.y.push(y); text.text.push(si ? mark.si : mark.text);
    if (mark.to) edge(mark.at, mark.to);
  }
  view.frame.data = frame; view.text.data = text;
}
"""

TURN = """
const wrap = (v, low, high) => Math.min(high, Math.max(low, v));
azimuth.value = wrap(azimuth.value + 0.4 * (cb_obj.delta_x - (window.nw_gear_turn || [0, 0])[0]), -180, 180);
elevation.value = wrap(elevation.value + 0.4 * (cb_obj.delta_y - (window.nw_gear_turn || [0, 0])[1]), -10, 90);
window.nw_gear_turn = [cb_obj.delta_x, cb_obj.delta_y];
"""

TURN_BEGINS = "window.nw_gear_turn = [0, 0];"
