"""A self-contained page of HTML: it loads nothing, runs nothing, and reads well on a phone and in the dark."""

import base64
import importlib.resources
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from html import escape

from dynabot_mj.common.tables import Table

# Nothing from elsewhere and no scripts; pictures, films and style only from the page itself.
_POLICY = "default-src 'none'; style-src 'unsafe-inline'; img-src data:; media-src data:"


@dataclass(frozen=True, kw_only=True)
class Section:
    """A part of the page with a title, which the table of contents lists."""

    title: str
    parts: Sequence[str]  # of HTML

    @property
    def name(self) -> str:
        """What links to it are called."""
        return re.sub(r"\W+", "-", self.title.lower()).strip("-")


def html(title: str, introduction: str, sections: Sequence[Section], footer: str) -> str:
    """Returns the page.

    Args:
        title: Plain text.
        introduction: HTML behind the title.
        sections: In their order.
        footer: HTML.
    """
    style = importlib.resources.files(__package__).joinpath("page.css").read_text(encoding="utf-8")
    contents = "\n".join(f'<li><a href="#{one.name}">{escape(one.title)}</a></li>' for one in sections)
    body = "\n".join(
        f'<section>\n<h2 id="{one.name}">{escape(one.title)}</h2>\n' + "\n".join(one.parts) + "\n</section>"
        for one in sections
    )
    return f"""<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta http-equiv="Content-Security-Policy" content="{_POLICY}">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>{escape(title)}</title>
<link rel="icon" href="data:,">
<style>
{style}</style>
</head>
<body>
<header>
<h1>{escape(title)}</h1>
{introduction}
<nav aria-label="Contents">
<ol>
{contents}
</ol>
</nav>
</header>
<main>
{body}
</main>
<footer>
{footer}
</footer>
</body>
</html>
"""


def paragraphs(text: str) -> str:
    """Returns plain text, whose paragraphs are apart by an empty line, as HTML."""
    return "\n".join(f"<p>{escape(' '.join(part.split()))}</p>" for part in text.split("\n\n"))


def heading(text: str) -> str:
    """Returns a heading inside a section."""
    return f"<h3>{escape(text)}</h3>"


def figure(svg: str, caption: str) -> str:
    """Returns a figure of `report.svg` with its caption, in a box of its own that scrolls where it is too wide."""
    return (
        f'<figure>\n<div class="sheet" tabindex="0">{svg}</div>\n<figcaption>{escape(caption)}</figcaption>\n</figure>'
    )


def film(clip: bytes, caption: str) -> str:
    """Returns a film, an mp4 file, with its caption."""
    source = f"data:video/mp4;base64,{base64.b64encode(clip).decode()}"
    told = escape(caption)
    return (
        f'<figure>\n<video controls muted loop playsinline preload="metadata" aria-label="{told}" src="{source}">'
        f"</video>\n<figcaption>{told}</figcaption>\n</figure>"
    )


def table(shown: Table) -> str:
    """Returns a table and its note, in a box of its own that scrolls where it is too wide.

    Rows that have nothing in their first cell belong to the row above, whose first cell they repeat.
    """
    rows, group = [], ""
    for cells in shown.body:
        again = not cells[0]
        group = group if again else cells[0]
        first = f'<td class="again">{escape(group)}</td>' if again else f"<td>{escape(group)}</td>"
        others = "".join(f"<td>{escape(cell)}</td>" for cell in cells[1:])
        rows.append(f"<tr>{first}{others}</tr>" if again else f'<tr class="first">{first}{others}</tr>')
    head = "".join(f'<th scope="col">{escape(cell)}</th>' for cell in shown.header)
    content = f"<thead><tr>{head}</tr></thead>\n<tbody>\n" + "\n".join(rows) + "\n</tbody>"
    box = f'<div class="wide" tabindex="0"><table>\n{content}\n</table></div>'
    return f'{box}\n<div class="note">{paragraphs(shown.note)}</div>' if shown.note else box


def downloads(files: Mapping[str, str]) -> str:
    """Returns links that save CSV files, which the page carries, by name."""
    links = [
        f'<a download="{escape(name)}" href="data:text/csv;base64,{base64.b64encode(text.encode()).decode()}">'
        f"{escape(name)}</a>"
        for name, text in files.items()
    ]
    return '<div class="downloads">' + "\n".join(links) + "</div>"


def facts(pairs: Mapping[str, str]) -> str:
    """Returns names and what there is to say of them; the latter are HTML."""
    rows = "\n".join(f"<dt>{escape(key)}</dt>\n<dd>{value}</dd>" for key, value in pairs.items())
    return f"<dl>\n{rows}\n</dl>"


def collapsed(title: str, text: str) -> str:
    """Returns a longer plain text that is shown when it is asked for."""
    return f"<details>\n<summary>{escape(title)}</summary>\n<pre>{escape(text)}</pre>\n</details>"
