"""The script of the page with the mode shapes, which runs in the browser."""

SCRIPT = """
const state = window.nw_gear_shapes = window.nw_gear_shapes || {};
const POINTS = 72;

function at(parts, k, phase) {
  return parts[0][k] * Math.cos(phase) - parts[1][k] * Math.sin(phase);
}

function circle(x, y, radius, turn) {
  const xs = [], ys = [];
  for (let i = 0; i <= POINTS; i++) {
    xs.push(x + radius * Math.cos(turn + 2 * Math.PI * i / POINTS));
    ys.push(y + radius * Math.sin(turn + 2 * Math.PI * i / POINTS));
  }
  xs.push(x); ys.push(y);
  return [xs, ys];
}

function outline(mode, scale, phase) {
  const lines = {xs: [], ys: [], colour: [], width: []};
  const n = data.ring_angle.length;
  const edge = [[], []];
  for (const radius of data.ring_radii) {
    const xs = [], ys = [];
    for (let i = 0; i <= n; i++) {
      const k = i % n, a = data.ring_angle[k];
      const w = scale * at(data.ring.w[mode], k, phase), v = scale * at(data.ring.v[mode], k, phase);
      xs.push((radius + w) * Math.cos(a) - v * Math.sin(a));
      ys.push((radius + w) * Math.sin(a) + v * Math.cos(a));
    }
    edge[0].push(xs); edge[1].push(ys);
    lines.xs.push(xs); lines.ys.push(ys); lines.colour.push(data.black); lines.width.push(2);
  }
  const every = Math.max(1, Math.round(n / 36));
  for (let k = 0; k < n; k += every) {
    lines.xs.push([edge[0][0][k], edge[0][1][k]]); lines.ys.push([edge[1][0][k], edge[1][1][k]]);
    lines.colour.push(data.black); lines.width.push(1);
  }
  for (const gear of data.gears) {
    const m = gear.motion[mode];
    const [xs, ys] = circle(gear.x + scale * at(m, 0, phase), gear.y + scale * at(m, 1, phase), gear.radius,
                            scale * at(m, 2, phase));
    lines.xs.push(xs); lines.ys.push(ys); lines.colour.push(gear.colour); lines.width.push(2);
  }
  return lines;
}

function bars(source, range, top) {
  range.factors = [...top.name].reverse();
  source.data = {name: top.name, share: top.share};
}

function draw(phase) {
  const mode = Number(select.value);
  moved.data = outline(mode, size.value, phase);
  const turned = (parts) => data.ring_angle.map((_, k) => at(parts[mode], k, phase));
  ring.data = {angle: ring.data.angle, w: turned(data.ring.w), v: turned(data.ring.v), z: turned(data.ring.z)};
  bodies.data = {body: data.bodies, axial: data.bodies.map((_, k) => at(data.axial[mode], k, phase))};
}

function settle() {
  const mode = Number(select.value);
  if (rest.data.xs.length == 0) {
    const {xs, ys} = outline(mode, 0, 0);
    rest.data = {xs, ys};
  }
  facts.text = data.facts[mode];
  bars(kinetic, kinetic_range, data.kinetic[mode]);
  bars(strain, strain_range, data.strain[mode]);
  draw(0);
}

settle();
if (state.timer) { clearInterval(state.timer); state.timer = null; }
if (moving.active) {
  let phase = 0;
  state.timer = setInterval(() => { phase += 2 * Math.PI / 40; draw(phase); }, 40);
}
"""
