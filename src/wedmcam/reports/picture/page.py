"""A picture to work with: the SVG with wheel and drag, beside it every block, in one file.

A block that is clicked in the table lights up in the picture, and the other way round: who stands
at the machine with a block number finds the place. The page needs no network and holds no dates.
"""

from __future__ import annotations

from collections.abc import Sequence

from wedmcam.ir.understanding import HEADINGS, Understanding
from wedmcam.reports.picture.sheet import words

_STYLE = """
body{margin:0;font:13px Helvetica,Arial,sans-serif;color:#1f2933;display:flex;height:100vh}
#picture{flex:1;overflow:hidden;min-width:0}#picture svg{width:100%;height:100%;cursor:grab}
#side{width:26rem;overflow:auto;border-left:1px solid #cbd2d9}
h1{font-size:15px;margin:8px}pre{white-space:pre-wrap;margin:8px;color:#7b341e}
table{border-collapse:collapse;width:100%}td,th{padding:2px 6px;text-align:right}
td:nth-child(3),th:nth-child(3){text-align:left}thead th{position:sticky;top:0;background:#fff}
tbody tr{cursor:pointer}tr.lit{background:#ffe8a3}path.lit{stroke:#d9480f!important;
stroke-width:4px!important;vector-effect:non-scaling-stroke}
@media print{#side{display:none}}
"""

_SCRIPT = """
const svg=document.querySelector('svg'),rows={},paths={};
const box=svg.viewBox.baseVal,whole=[box.x,box.y,box.width,box.height];
for(const r of document.querySelectorAll('tbody tr'))rows[r.cells[0].textContent]=r;
for(const t of document.querySelectorAll('#drawing path>title')){
  const m=/^block (\\d+):/.exec(t.textContent);if(m)paths[m[1]]=t.parentNode;}
function light(n,scroll){
  for(const e of document.querySelectorAll('.lit'))e.classList.remove('lit');
  if(paths[n])paths[n].classList.add('lit');
  if(rows[n]){rows[n].classList.add('lit');if(scroll)rows[n].scrollIntoView({block:'center'});}}
for(const n in rows)rows[n].onclick=()=>light(n,false);
for(const n in paths)paths[n].addEventListener('click',()=>light(n,true));
function at(e){const p=new DOMPoint(e.clientX,e.clientY);
  return p.matrixTransform(svg.getScreenCTM().inverse());}
svg.addEventListener('wheel',e=>{e.preventDefault();const p=at(e),k=e.deltaY<0?0.8:1.25;
  box.x=p.x-(p.x-box.x)*k;box.y=p.y-(p.y-box.y)*k;box.width*=k;box.height*=k;},{passive:false});
let held=null;svg.addEventListener('pointerdown',e=>{held=at(e);});
window.addEventListener('pointerup',()=>{held=null;});
svg.addEventListener('pointermove',e=>{if(!held)return;const p=at(e);
  box.x+=held.x-p.x;box.y+=held.y-p.y;});
svg.addEventListener('dblclick',()=>{[box.x,box.y,box.width,box.height]=whole;});
"""


def page(
    svg: str,
    *,
    title: str,
    head: Sequence[str] = (),
    rows: Sequence[Sequence[str]] = (),
    report: str = "",
    known: Understanding | None = None,
) -> str:
    """Return an HTML page of a picture.

    Args:
        svg: of `svg.plot` or `svg.plot_contours`.
        title: the file's name.
        head: names of the columns of ``rows``; the first is the number of the block.
        rows: a row a block.
        report: findings, as people read them.
        known: what was understood: a table of the contours stands before that of the blocks.
    """
    picture = svg[svg.index("<svg") :]
    cells = "\n".join(
        f"<tr>{''.join(f'<td>{words(cell)}</td>' for cell in row)}</tr>" for row in rows
    )
    names = "".join(f"<th>{words(name)}</th>" for name in head)
    lines = "\n".join(words(line) for line in report.split("\n")) if report else ""
    table = f"<table><thead><tr>{names}</tr></thead>\n<tbody>\n{cells}\n</tbody></table>"
    return (
        '<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8">\n'
        f"<title>{words(title)}</title><style>{_STYLE}</style></head>\n<body>"
        f'<div id="picture">{picture}</div>\n<div id="side"><h1>{words(title)}</h1>\n'
        + (f"<pre>{lines}</pre>\n" if lines else "")
        + (_contours(known) if known is not None else "")
        + (table if rows else "")
        + f"</div>\n<script>{_SCRIPT}</script></body></html>\n"
    )


def _contours(known: Understanding) -> str:
    """Return what was understood as a list that opens: the counts first."""
    rows = [
        "<li>" + "<br>".join(words(f"{h}: {c}") for h, c in zip(HEADINGS, row.cells, strict=True))
        for row in known.rows
    ]
    threads = "".join(f"<p>{words(sentence)}</p>" for sentence in known.threads)
    return (
        f'<details id="understood"><summary>cuts {words(known.counts)}</summary>'
        f"{threads}<ol>{''.join(rows)}</ol></details>\n"
    )
