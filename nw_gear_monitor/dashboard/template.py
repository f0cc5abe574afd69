"""The page around the figures: a Jinja template in which every part has its place."""

from __future__ import annotations

from jinja2 import Environment, Template

STYLE = """
:root { --ink: #2b2f36; --soft: #5b626d; --line: #dfe2e6; --tint: #f5f6f8; --accent: #0072b2; }
* { box-sizing: border-box; }
html { scroll-padding-top: 46px; }
body { margin: 0; color: var(--ink); background: #fff;
  font: 15px/1.5 system-ui, -apple-system, "Segoe UI", Roboto, "Helvetica Neue", Arial, sans-serif; }
header, main { max-width: 1480px; margin: 0 auto; padding: 0 24px; }
header { padding-top: 16px; }
h1 { font-size: 24px; margin: 0; }
h2 { font-size: 19px; margin: 26px 0 4px; padding-top: 8px; border-top: 1px solid var(--line); }
h3 { font-size: 15px; margin: 8px 0 2px; }
.soft { color: var(--soft); }
nav { position: sticky; top: 0; z-index: 50; margin-top: 6px; background: #fffffff2;
  border-bottom: 1px solid var(--line); }
nav div { max-width: 1480px; margin: 0 auto; padding: 6px 24px; font-size: 13.5px;
  display: flex; gap: 4px 18px; flex-wrap: wrap; }
nav a { color: var(--accent); text-decoration: none; }
.grid { display: grid; gap: 8px 18px; margin: 6px 0; }
.c2 { grid-template-columns: repeat(2, minmax(0, 1fr)); }
.c3 { grid-template-columns: repeat(3, minmax(0, 1fr)); }
.box { border: 1px solid var(--line); border-radius: 4px; padding: 6px 12px 10px; }
@media (max-width: 980px) { .c2, .c3 { grid-template-columns: minmax(0, 1fr); } }
#lost { display: none; margin: 8px 0; padding: 8px 14px; border-left: 5px solid #d55e00; background: #fdeee5;
  font-weight: 600; }
"""

PAGE = """{% from macros import embed %}<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<link rel="icon" href="data:,">
<title>{{ title | e }}</title>
<style>{{ page_style }}</style>
{{ bokeh_css if bokeh_css }}
{{ bokeh_js if bokeh_js }}
</head>
<body>
<header><h1>{{ title | e }}</h1>{{ embed(roots.banner) }}
<p id="lost">The dashboard has gone away; this page is stale. It asks again every few seconds.</p></header>
<nav><div><a href="#control">Control</a><a href="#states">States and alarms</a><a href="#operation">Operation</a>
<a href="#waves">Waveform</a><a href="#spectra">Spectra</a><a href="#planes">Phase and Poincaré</a>
<a href="#indicators">Indicators</a></div></nav>
<main>
<section id="control"><h2>Control</h2>
<div class="grid c3"><div class="box"><h3>Run</h3>{{ embed(roots.run) }}</div>
<div class="box"><h3>Wind</h3>{{ embed(roots.wind_controls) }}</div>
<div class="box"><h3>What came of it</h3>{{ embed(roots.answers) }}</div></div>
<div class="box"><h3>Faults</h3>{{ embed(roots.fault_controls) }}</div></section>
<section id="states"><h2>States and alarms</h2>
{{ embed(roots.states) }}
<div class="grid c2"><div><h3>Stages and bearings</h3>{{ embed(roots.states_text) }}</div>
<div><h3>Truth</h3>{{ embed(roots.truth_text) }}
<h3>Alarms</h3>{{ embed(roots.alarms_text) }}{{ embed(roots.alarm_controls) }}</div></div></section>
<section id="operation"><h2>Operation</h2>
<div class="grid c3"><div>{{ embed(roots.wind) }}</div><div>{{ embed(roots.speed) }}</div>
<div>{{ embed(roots.torque) }}</div></div></section>
<section id="waves"><h2>Waveform</h2>
{% for stage in stages %}{{ embed(roots["displacement_" + stage]) }}{% endfor %}{{ embed(roots.forces) }}</section>
<section id="spectra"><h2>Spectra</h2>
{% for topic in ("spectrum", "orders") %}<div class="grid c3">
{% for stage in stages %}<div>{{ embed(roots[topic + "_" + stage]) }}</div>{% endfor %}</div>{% endfor %}</section>
<section id="planes"><h2>Phase diagrams and Poincaré maps</h2>
{% for kind in ("phase", "section") %}<div class="grid c3">
{% for stage in stages %}<div>{{ embed(roots[kind + "_" + stage]) }}</div>{% endfor %}</div>{% endfor %}</section>
<section id="indicators"><h2>Indicators</h2>
<div class="grid c2">{% for i in range(1, 7) %}<div>{{ embed(roots["choice_" ~ i]) }}
{{ embed(roots["indicator_" ~ i]) }}</div>{% endfor %}</div></section>
</main>
{{ plot_script }}
<script>{{ watch }}</script>
</body>
</html>
"""

WATCH = """
(() => {  // says so when nothing comes from the server any more, and begins anew once it is there again
  const lost = document.getElementById("lost"), began = Date.now();
  const look = async () => {
    const silent = Date.now() - (window.lastPulse ?? began);
    lost.style.display = silent > 6000 ? "block" : "none";
    if (silent > 20000) {
      try {
        if ((await fetch("alive", {cache: "no-store", signal: AbortSignal.timeout(5000)})).ok) location.reload();
      } catch (error) {}
    }
    setTimeout(look, 1000);
  };
  look();
})();
"""


def page_template() -> Template:
    """The template; what Bokeh fills in is HTML already."""
    return Environment(autoescape=False).from_string(PAGE)
