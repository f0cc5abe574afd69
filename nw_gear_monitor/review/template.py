"""The page around the figures: one HTML text with its style, for Jinja with autoescaping."""

STYLE = """
:root { --ink: #2b2f36; --soft: #5b626d; --line: #dfe2e6; --tint: #f5f6f8; --accent: #0072b2; }
* { box-sizing: border-box; }
html { scroll-behavior: smooth; scroll-padding-top: 52px; }
body { margin: 0; color: var(--ink); background: #fff;
  font: 15px/1.5 system-ui, -apple-system, "Segoe UI", Roboto, "Helvetica Neue", Arial, sans-serif; }
header.page, main { max-width: 1480px; margin: 0 auto; padding: 0 24px; }
header.page { padding-top: 22px; }
h1 { font-size: 24px; margin: 0 0 2px; }
h2 { font-size: 19px; margin: 36px 0 4px; padding-top: 10px; border-top: 1px solid var(--line); }
h2 a, h2 a:visited { color: inherit; text-decoration: none; }
h3 { font-size: 15px; margin: 18px 0 4px; }
p { margin: 4px 0 10px; max-width: 95ch; }
.soft, .note { color: var(--soft); }
.note { font-size: 13px; }
nav { position: sticky; top: 0; z-index: 50; margin-top: 10px; background: #fffffff2;
  border-bottom: 1px solid var(--line); }
nav div { max-width: 1480px; margin: 0 auto; padding: 7px 24px; font-size: 13.5px;
  display: flex; gap: 4px 18px; flex-wrap: wrap; }
nav a { color: var(--accent); text-decoration: none; }
nav a:hover { text-decoration: underline; }
.headline { font-size: 16px; font-weight: 600; margin: 14px 0 12px; padding: 10px 14px;
  border-left: 5px solid var(--band); background: var(--tint); max-width: none; }
.remark { margin: 8px 0; padding: 8px 14px; border-left: 5px solid #e69f00; background: #fdf6e7; max-width: none; }
.missing { margin: 8px 0; padding: 8px 14px; border-left: 5px solid #8a8f98; background: var(--tint); max-width: none; }
dl.facts { display: grid; grid-template-columns: repeat(auto-fit, minmax(310px, 1fr)); gap: 2px 28px; margin: 8px 0; }
dl.facts div { display: flex; gap: 10px; padding: 3px 0; border-bottom: 1px solid var(--tint); }
dl.facts div:last-child { grid-column: 1 / -1; }
dl.facts dt { flex: 0 0 118px; color: var(--soft); }
dl.facts dd { margin: 0; overflow-wrap: anywhere; }
table { border-collapse: collapse; margin: 8px 0 12px; font-size: 14px; }
th, td { text-align: left; padding: 4px 14px 4px 0; border-bottom: 1px solid var(--line); vertical-align: top; }
th { font-weight: 600; color: var(--soft); white-space: nowrap; }
td.n, th.n { text-align: right; font-variant-numeric: tabular-nums; white-space: nowrap; }
.wide { overflow-x: auto; }
.chip { display: inline-block; padding: 0 8px; margin-right: 5px; border-radius: 9px; border: 1px solid #00000022;
  white-space: nowrap; }
.grid { display: grid; gap: 10px 18px; margin: 8px 0; }
.c1 { grid-template-columns: minmax(0, 1fr); }
.c2 { grid-template-columns: repeat(2, minmax(0, 1fr)); }
.c3 { grid-template-columns: repeat(3, minmax(0, 1fr)); }
@media (max-width: 980px) { .c2, .c3 { grid-template-columns: minmax(0, 1fr); } }
details { margin: 6px 0; border: 1px solid var(--line); border-radius: 4px; padding: 6px 12px; }
summary { cursor: pointer; font-weight: 600; }
pre { font-size: 12.5px; line-height: 1.4; overflow: auto; max-height: 420px; padding: 10px;
  background: var(--tint); }
footer { color: var(--soft); font-size: 12.5px; margin: 30px 0 24px; padding-top: 8px;
  border-top: 1px solid var(--line); }
@media print { nav { display: none; } .grid > div { break-inside: avoid; } }
"""

PAGE = """<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<link rel="icon" href="data:,">
<title>{{ title }}</title>
<style>{{ style }}</style>
{{ resources }}
</head>
<body>
<header class="page">
<h1>{{ title }}</h1>
<div class="soft">{{ subtitle }}</div>
</header>
<nav><div>{% for section in sections %}<a href="#{{ section.anchor }}">{{ section.title }}</a>{% endfor %}</div></nav>
<main>
{% for section in sections %}
<section id="{{ section.anchor }}">
<h2><a href="#{{ section.anchor }}">{{ section.title }}</a></h2>
{% if section.anchor == "summary" %}{% include "summary" %}{% endif %}
{% if section.text %}<p class="soft">{{ section.text }}</p>{% endif %}
{% for words in section.missing %}<p class="missing">{{ words }}</p>{% endfor %}
{% for row in section.rows %}
<div class="grid c{{ row.columns }}">{% for name in row.names %}<div>{{ divs[name] }}</div>{% endfor %}</div>
{% endfor %}
{% for table in section.tables %}{% include "table" %}{% endfor %}
{% for part in section.details %}
<details><summary>{{ part.title }}</summary><pre>{{ part.text }}</pre></details>
{% endfor %}
</section>
{% endfor %}
<footer>{{ footer }}</footer>
</main>
{{ script }}
</body>
</html>
"""

SUMMARY = """
{% for colour, words in headlines %}
<p class="headline" style="--band: {{ colour }}">{{ words }}</p>
{% endfor %}
{% for words in remarks %}<p class="remark">{{ words }}</p>{% endfor %}
{% if facts %}
<dl class="facts">{% for name, value in facts %}<div><dt>{{ name }}</dt><dd>{{ value }}</dd></div>{% endfor %}</dl>
{% endif %}
"""

TABLE = """
{% if table.folded %}<details><summary>{{ table.title }}</summary>{% else %}<h3>{{ table.title }}</h3>{% endif %}
<div class="wide"><table>
<thead><tr>
{% for cell in table.head %}
<th{% if loop.index0 in table.numeric %} class="n"{% endif %}>{{ cell }}</th>
{% endfor %}
</tr></thead>
<tbody>
{% for row in table.rows %}
<tr>
{% for cell in row %}
<td{% if loop.index0 in table.numeric %} class="n"{% endif %}>
{% if cell is string %}
{{ cell }}
{% else %}
{% for chip in cell %}
<span class="chip" style="background:{{ chip.colour }};color:{{ chip.ink }}">{{ chip.text }}</span>
{% endfor %}
{% endif %}
</td>
{% endfor %}
</tr>
{% endfor %}
</tbody>
</table></div>
{% if table.note %}<p class="note">{{ table.note }}</p>{% endif %}
{% if table.folded %}</details>{% endif %}
"""
