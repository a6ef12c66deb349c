"""The one style sheet of all pages: day, night and print, wide screens and narrow ones."""

from collections.abc import Mapping
from string import Template

from stickslip.logs.style import AT_NIGHT, NIGHT, PAGE

__all__ = ["CSS", "in_variables"]


def _variables(colours: Mapping[str, str], picture: Mapping[str, str]) -> str:
    named = [f"--{name}: {colour};" for name, colour in colours.items()]
    return " ".join(named + [f"--x{day[1:]}: {shown};" for day, shown in picture.items()])


def in_variables(svg: str) -> str:
    """Return a picture whose colours are those of the page: by day as drawn, at night as ``stickslip.logs.style`` says.

    >>> from stickslip.logs.style import RED
    >>> in_variables(f"stroke: {RED}; fill: none")
    'stroke: var(--xb00020); fill: none'
    """
    for colour in AT_NIGHT:
        svg = svg.replace(f": {colour}", f": var(--x{colour[1:]})")
    return svg


CSS = Template("""
:root { color-scheme: light dark; $day }
@media (prefers-color-scheme: dark) { :root { $night } }
@media print { :root { color-scheme: light; $day } }
* { box-sizing: border-box; }
html { -webkit-text-size-adjust: 100%; }
body { font: 16px/1.55 system-ui, -apple-system, "Segoe UI", Roboto, Arial, sans-serif; color: var(--ink);
  background: var(--ground); margin: 0; }
main { max-width: 1100px; margin: 0 auto; padding: 32px 20px 64px; }
h1 { font-size: 30px; line-height: 1.25; margin: 0 0 6px; letter-spacing: -0.01em; }
h2 { font-size: 20px; line-height: 1.3; margin: 0; }
h1, h2, dd, li, p, figcaption { overflow-wrap: anywhere; } td { overflow-wrap: break-word; max-width: 30em; }
.lead { color: var(--soft); margin: 0 0 22px; max-width: 76ch; }
nav { font-size: 14.5px; margin: 0 0 6px; line-height: 2; }
nav a { margin-right: 18px; white-space: nowrap; }
article { background: var(--card); border: 1px solid var(--line); border-radius: 10px; padding: 20px 22px;
  margin: 18px 0; }
header.row { display: flex; gap: 4px 12px; align-items: baseline; flex-wrap: wrap; }
.badge { font-size: 13px; font-weight: 650; padding: 2px 10px; border-radius: 99px; border: 1px solid transparent; }
.bad { background: var(--bad); color: var(--bad_ink); border-color: var(--bad_line); }
.good { background: var(--good); color: var(--good_ink); border-color: var(--good_line); }
.open { background: var(--open); color: var(--open_ink); border-color: var(--open_line); }
td .badge { white-space: nowrap; font-weight: 600; }
.aside { color: var(--soft); font-size: 14px; }
.reason { margin: 10px 0 4px; max-width: 80ch; }
.soft { color: var(--soft); margin: 6px 0; max-width: 80ch; }
.guide { max-width: 80ch; }
.label { color: var(--soft); font-size: 14px; font-weight: 600; margin: 14px 0 0; }
ul.notes { color: var(--soft); font-size: 14.5px; margin: 2px 0 8px; padding-left: 18px; }
dl { display: grid; grid-template-columns: max-content 1fr; gap: 4px 18px; margin: 14px 0 4px; max-width: 88ch; }
dt { color: var(--soft); } dd { margin: 0; }
figure { margin: 14px 0 0; }
figure svg { width: 100%; height: auto; display: block; }
figure svg text { fill: var(--ink); }
figure.scroll svg { min-width: 680px; }
.grid { display: grid; grid-template-columns: repeat(auto-fit, minmax(min(420px, 100%), 1fr)); gap: 10px 24px; }
.grid > figure { min-width: 0; max-width: 600px; }
.grid.wide { grid-template-columns: 2.2fr 1fr; } .grid.wide > figure { max-width: none; }
figcaption { color: var(--soft); font-size: 14.5px; max-width: 80ch; margin: 4px 0 18px; position: sticky; left: 0;
  width: fit-content; }
figcaption strong { color: var(--ink); font-weight: 600; }
/* A shade at the edge tells that a table or a picture goes on to the side. */
.scroll { overflow-x: auto; background: linear-gradient(to left, var(--card), var(--card)) left / 24px 100%,
  linear-gradient(to left, var(--card), var(--card)) right / 24px 100%,
  linear-gradient(to left, transparent, var(--hint)) right / 12px 100%,
  linear-gradient(to right, transparent, var(--hint)) left / 12px 100%;
  background-repeat: no-repeat; background-attachment: local, local, scroll, scroll; }
table { border-collapse: collapse; margin: 6px 0 0; font-size: 14.5px; width: 100%; }
th, td { text-align: left; padding: 6px 14px 6px 0; border-bottom: 1px solid var(--line); vertical-align: top; }
th { color: var(--soft); font-weight: 600; overflow-wrap: normal; }
td { min-width: 5.5em; } td.long { min-width: 15em; } th:first-child:not(.num), td:first-child:not(.num) {
  min-width: 7.5em; }
.num { text-align: right; white-space: nowrap; font-variant-numeric: tabular-nums; min-width: 0; }
tr.missed td { background: var(--missed); }
tr.missed td.mark { color: var(--bad_ink); font-weight: 650; white-space: nowrap; }
/* A table whose rows are put in order by the choice above it: every row carries its place in each order. */
.orders { display: flex; flex-wrap: wrap; gap: 6px; align-items: baseline; font-size: 14px; margin: 8px 0 2px;
  color: var(--soft); }
.orders label { padding: 1px 10px; border: 1px solid var(--line); border-radius: 99px; cursor: pointer;
  color: var(--link); }
input.order { position: absolute; opacity: 0; pointer-events: none; }
.orders, input.order { display: none; }
@supports (grid-template-columns: subgrid) {
  .orders { display: flex; } input.order { display: inline; }
  table.ordered { display: grid; width: max-content; min-width: 100%; max-width: 1900px; }
  table.ordered th { white-space: nowrap; }
  table.ordered thead, table.ordered tbody, table.ordered tr { display: grid; grid-column: 1 / -1;
    grid-template-columns: subgrid; }
  table.ordered tr { border-bottom: 1px solid var(--line); } table.ordered th, table.ordered td { border: 0; }
}
sup { line-height: 0; } ol.foot { color: var(--soft); font-size: 14px; margin: 8px 0 0; padding-left: 28px; }
ol.foot li { max-width: 80ch; }
a { color: var(--link); } footer { color: var(--soft); font-size: 13.5px; margin-top: 28px; }
@media (max-width: 900px) { .grid.wide { grid-template-columns: minmax(0, 1fr); }
  .grid.wide > figure:not(.scroll) { max-width: 600px; } }
@media (max-width: 560px) { main { padding: 20px 10px 40px; } article { padding: 16px 14px; } h1 { font-size: 24px; }
  dl { grid-template-columns: 1fr; gap: 0; } dd { margin-bottom: 8px; }
  table:not(.ordered) th.num { white-space: normal; } }
@media print { body { background: none; font-size: 10.5pt; } main { max-width: none; padding: 0; }
  nav { display: none; }
  article { break-inside: auto; border: 0; padding: 0; } tr, svg, figure.scroll, .grid > figure { break-inside: avoid; }
  /* What leads to a picture or a table stays with it: its heading, and the words between them. */
  h2, .label, header.row, p.soft, p.reason { break-after: avoid; break-inside: avoid; }
  figcaption, p + .grid { break-before: avoid; } thead { display: table-header-group; }
  .grid { grid-template-columns: 1fr 1fr; } .grid.wide { display: block; }
  .grid.wide > figure:not(.scroll) { max-width: 50%; }
  .scroll { overflow: visible; background: none; } figure.scroll svg { min-width: 0; } .orders { display: none; }
  table { font-size: 9pt; } td, td.long, td:first-child:not(.num), th:first-child:not(.num) {
  min-width: 0; }
  .num { white-space: normal; } table.ordered { display: table; width: 100%; }
  table.ordered thead { display: table-header-group; } table.ordered tbody { display: table-row-group; }
  table.ordered tr { display: table-row; } table.ordered th { white-space: normal; } }
""").substitute(day=_variables(PAGE, {colour: colour for colour in AT_NIGHT}), night=_variables(NIGHT, AT_NIGHT))
