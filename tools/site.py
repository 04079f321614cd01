"""Hooks of the site, which mkdocs.yml names: they fill pages with what the program says of itself.

A line ``<!-- site: NAME ARGUMENT ... -->`` of a page stands for the Markdown that the function of this name in `PARTS`
returns.
"""

import json
import re
import tomllib
from collections.abc import Mapping
from functools import cache, partial
from html import unescape
from pathlib import Path
from typing import Any

import numpy as np
import typer.cli
from latex2mathml.converter import convert
from markdown.extensions.toc import slugify
from mkdocs.structure.files import File
from typer.testing import CliRunner

import armour
from armour.analysis.evaluate import groups_of
from armour.analysis.quantities import label_and_unit
from armour.columns import COUNTED, OUTCOME_WORDS, UNITS, USUAL_NAMES, YES_OR_NO
from armour.csv_files import shipped_rows
from armour.reporting.formats import markdown_table
from armour.reporting.table import in_words
from armour.reporting.views.library import entry_table, entry_tables, tables_by_kind, threat_table
from armour.scenario.inputs import BACKING, CERAMIC, INPUTS, NAMES, Kind
from armour.scenario.library import named_threats
from armour.scenario.scenario import scenario_schema
from armour.units import words_and_unit
from armour.validation.tested import wilkins_tests

DOCS = Path(__file__).parents[1] / "docs"
# Pages of the site whose text is kept elsewhere in the repository.
OUTSIDE = {"contributing.md": "CONTRIBUTING.md", "changes.md": "CHANGELOG.md"}
# Weight in the search, by folder or page: pages that answer a question come before those that list names, and those on
# the project itself last.
WEIGHTS = {"howto": 10.0, "learn": 1.0, "tutorials": 3.0, "reference": 0.1, "reference/api": 0.02}
WEIGHTS |= dict.fromkeys(
    ["changes.md", "contributing.md", "design.md", "performance.md", "study.ipynb", "evidence/campaigns.md"], 0.02
)
WEIGHTS |= dict.fromkeys(["evidence/left-out.md", "evidence/own-tests.md"], 0.02)
# Pages that stood beside the home page and are now in evidence/; links to their old places go on.
MOVED = ("campaigns", "left-out", "methods", "own-tests", "plates", "validation")
FORWARD = """<!doctype html>
<meta charset="utf-8">
<title>Moved</title>
<script>location.replace("{place}" + location.hash)</script>
<p>This page moved to <a href="{place}">{place}</a>.</p>
"""


def names(package: str) -> list[str]:
    """Return the public names of a package, functions first."""
    public = (name for name in dir(armour) if getattr(armour, name).__module__.split(".")[1] == package)
    return sorted(public, key=lambda name: isinstance(getattr(armour, name), type))


def api(package: str) -> str:
    """Return the directives of mkdocstrings for the public names of a package."""
    return "\n\n".join(f"::: armour.{name}" for name in names(package))


def described(*names: str) -> str:
    """Return a table of public names, linked to their descriptions, with the first lines of these."""
    first_lines = ((getattr(armour, name).__doc__ or "").strip().splitlines()[0] for name in names)
    rows = (f"| [`{name}`][armour.{name}] | {line} |" for name, line in zip(names, first_lines, strict=True))
    return "\n".join(["| name | description |", "|---|---|", *rows])


def commands() -> str:
    """Return what typer says of the commands, without the title."""
    text = CliRunner().invoke(typer.cli.app, ["armour.cli.app", "utils", "docs", "--name", "armour"]).stdout
    # typer shortens what it lists.
    for name, words in re.findall(r"^##+ `armour (?:\w+ )?([\w-]+)`\n\n(.+)$", text, re.MULTILINE):
        text = re.sub(rf"^\* `{name}`: .*$", f"* `{name}`: {words}", text, flags=re.MULTILINE)
    return text.partition("\n")[2]


def keys() -> str:
    """Return a table of all keys of a scenario: meaning, unit and symbol."""
    schema = scenario_schema()
    meanings: dict[str, dict[str, None]] = {}
    for section in (schema, *schema["$defs"].values()):
        for key, content in section["properties"].items():
            meanings.setdefault(key, {})
            if not content["description"].startswith("Distribution of the input"):
                meanings[key][content["description"]] = None
    rows = ["| key | meaning | unit | symbol |", "|---|---|---|---|"]
    for key in sorted(meanings):
        symbols = ", ".join(one.field for one in INPUTS.values() if one.key == key and one.field)
        rows.append(f"| `{key}` | {' '.join(meanings[key])} | {label_and_unit(key)[1]} | {symbols} |")
    return "\n".join(rows)


def scenario() -> str:
    """Return a table of the keys of every section of a scenario, by the JSON Schema."""
    schema = scenario_schema()
    places = _places(schema)
    parts = [_section("The file", {**schema, "description": "Keys of the file itself, and its sections."}, places)]
    parts += (_section(place, schema["$defs"][name], places) for name, place in places.items())
    return "\n\n".join(parts)


def _places(schema: Mapping[str, Any]) -> dict[str, str]:
    """Return the heading of every definition of the schema: its place in a file, or its name if there are several."""
    found: dict[str, list[str]] = {}

    def search(section: Mapping[str, Any], path: str) -> None:
        for key, content in section["properties"].items():
            text = json.dumps(content)
            for name in re.findall(r'"#/\$defs/(\w+)"', text):
                deeper = f"{path}{key}" + (".NAME" if "additionalProperties" in text else "")
                heading = f"[[{deeper}]]" if '"items": {"$ref"' in text else f"[{deeper}]"
                if heading not in found.setdefault(name, []):
                    found[name].append(heading)
                    search(schema["$defs"][name], f"{deeper}.")

    search(schema, "")
    return {
        name: f"`{names[0]}`" if len(names) == 1 else name.strip("_").split("_")[0] for name, names in found.items()
    }


def _section(heading: str, section: Mapping[str, Any], places: Mapping[str, str]) -> str:
    rows = []
    for key, content in section["properties"].items():
        default = content.get("default")
        shown = "" if default in (None, "", []) or isinstance(default, dict) else f"`{json.dumps(default)}`"
        name = f"**`{key}`**" if key in section.get("required", []) else f"`{key}`"
        rows.append(f"| {name} | {content['description']} | {_kind(content, places)} | {shown} |")
    head = ["| key | meaning | value | default |", "|---|---|---|---|"]
    return "\n".join([f"## {heading}\n", section.get("description", "A number of the library.") + "\n", *head, *rows])


def _kind(content: Mapping[str, Any], places: Mapping[str, str]) -> str:
    """Return the values that a key may have, in words."""
    if "$ref" in content:
        place = places[content["$ref"].rsplit("/", 1)[1]]
        return f"[{place}](#{_anchor(place)})"
    if found := content.get("anyOf") or content.get("oneOf"):
        return " or ".join(_kind(part, places) for part in found if part.get("type") != "null")
    if "const" in content or "enum" in content:
        return ", ".join(f"`{json.dumps(value)}`" for value in content.get("enum", [content.get("const")]))
    if content["type"] == "array":
        parts = content.get("prefixItems") or [content["items"]]
        return f"list of: {' and '.join(_kind(part, places) for part in parts)}"
    if content["type"] == "object":
        inner = content.get("additionalProperties")
        return f"by name: {_kind(inner, places)}" if isinstance(inner, dict) else "table"
    signs = {"exclusiveMinimum": ">", "minimum": "≥", "exclusiveMaximum": "<", "maximum": "≤"}
    bounds = [f"{sign} {content[word]:g}" for word, sign in signs.items() if word in content]
    kind = {"string": "text", "boolean": "`true`, `false`", "integer": "whole number"}.get(content["type"], "number")
    return ", ".join([kind, *bounds])


def _anchor(heading: str) -> str:
    return str(slugify(heading.replace("`", ""), "-"))


def inputs() -> str:
    """Return a table of the names of inputs, with their words."""
    return "\n".join(["| name | in words |", "|---|---|", *(f"| `{name}` | {in_words(name)} |" for name in INPUTS)])


def column_names() -> str:
    """Return a table of the names and units of columns of tables that people write."""
    lines = ["| key | names | units |", "|---|---|---|"]
    for key, names in USUAL_NAMES.items():
        # Tests may have the names of shots.
        own = [name for name in names if key != "test" or name not in USUAL_NAMES["shot"]]
        units = UNITS.get(words_and_unit(key)[1], {})
        if key not in ("impact.velocity_m_s", "outcome"):
            lines.append(f"| `{key}` | {', '.join(dict.fromkeys(own))} | {', '.join(units)} |")
    return "\n".join(lines)


def result_words() -> str:
    """Return a table of the words for results."""
    return "\n".join(["| stopped | perforated |", "|---|---|", *(f"| {no} | {yes} |" for no, yes in OUTCOME_WORDS)])


def count_words() -> str:
    """Return a table of the words for shots that count and those that do not."""
    pairs = (*YES_OR_NO, *COUNTED)
    return "\n".join(["| does not count | counts |", "|---|---|", *(f"| {no} | {yes} |" for no, yes in pairs)])


@cache
def tested_with() -> dict[tuple[Kind, str], tuple[str, ...]]:
    """Return what each library entry was tested with, by its kind and name: rounds for a material, and vice versa."""
    # Files of the same name in the working folder must not replace the shipped ones.
    shipped, wilkins = armour.shipped_library(), wilkins_tests().scenarios[0]
    rounds = shipped.known("projectile")
    plates = [row for row in shipped_rows("tests/plates") if row["round"] in rounds]
    tested: dict[tuple[Kind, str], dict[str, None]] = {}

    def add(kind: Kind, name: str, words: str) -> None:
        tested.setdefault((kind, name), {})[words] = None

    bare = {
        NAMES["backing"]: np.array([row["plate"] for row in plates]),
        NAMES["projectile"]: np.array([rounds[row["round"]] for row in plates]),
        BACKING: np.array([float(row[BACKING]) for row in plates]),
    }
    for group in groups_of(wilkins.replaced({CERAMIC: 0.0}), bare):
        if group.variants.errors.known.any():
            metal, projectile = (str(bare[NAMES[role]][group.where[0]]) for role in ("backing", "projectile"))
            add("metal", metal, projectile)
            add("projectile", projectile, metal)
    metal, projectile = wilkins.armour.backing, wilkins.impact.projectile
    for ceramic in shipped.names("ceramic"):
        [group] = groups_of(wilkins.replaced({NAMES["ceramic"]: ceramic}), wilkins_tests().columns)
        if group.variants.errors.known.any():
            add("ceramic", ceramic, f"{projectile}, on {metal}")
            add("metal", metal, f"{projectile}, with {wilkins.armour.ceramic}")
            add("projectile", projectile, f"{wilkins.armour.ceramic} on {metal}")
    return {entry: tuple(words) for entry, words in tested.items()}


def library(kind: Any) -> str:
    """Return a table of the entries of a kind, with what each was tested with and links to the values."""
    [table] = tables_by_kind({kind: named_threats() if kind == "threat" else armour.shipped_library().entries[kind]})
    head, rule, *rows = (line.split(" | ", 1) for line in markdown_table(table).splitlines())
    lines = [f"{head[0]} | tested with | {head[1]}", f"{rule[0]} | --- | {rule[1]}"]
    for (name, *cells), (_, values) in zip(table.texts(), rows, strict=True):
        key: tuple[Any, str] = ("projectile", cells[1]) if kind == "threat" else (kind, name)
        first, *others = tested_with().get(key, [""])
        tests = f"{first} and {len(others)} more" if others else first
        lines.append(f"| [{name}](library/{kind}s.md#{_anchor(name)}) | {tests} | {values}")
    return "\n".join(lines)


def entries(kind: Kind) -> str:
    """Return the values of the entries of a kind, with their sources, and what they were tested with."""
    parts = []
    for name, entry in armour.shipped_library().entries[kind].items():
        tests = ", ".join(tested_with().get((kind, name), ["none"]))
        parts += [f"## {name}", *map(str, entry_tables(entry)[:-1])]
        parts += [f"Tested with: {tests}.", markdown_table(entry_table(entry))]
    return "\n\n".join(parts)


def threats() -> str:
    """Return the values of the threats, with their sources."""
    return "\n\n".join(
        f"## {name}\n\n{markdown_table(threat_table({name: threat}))}\n\nSource: {threat.source}."
        for name, threat in named_threats().items()
    )


@cache
def sources() -> dict[str, dict[str, str]]:
    """Return the bibliography by key."""
    return tomllib.loads((DOCS.parent / "configs" / "references.toml").read_text(encoding="utf-8"))


def references() -> str:
    """Return the bibliography, in the order of the keys."""
    return "\n\n".join(_entry(key, sources()[key]) for key in sorted(sources(), key=str.lower))


def _entry(key: str, source: Mapping[str, str]) -> str:
    """Return an entry of the bibliography as Markdown."""
    words = ", ".join(source[part] for part in ("authors", "title", "where", "year") if part in source)
    if doi := source.get("doi"):
        words += f", [doi {doi}](https://doi.org/{doi})"
    return f"### {key} {{#{key}}}\n\n{words}.\n\n{source['use']} *{source['checked']}.*"


NAMED = (
    *(api, column_names, commands, count_words, described, entries, inputs, keys),
    *(library, references, result_words, scenario, threats),
)
PARTS = {part.__name__: part for part in NAMED}


def filled(markdown: str) -> str:
    """Return a page with its parts in their places."""
    return re.sub(r"^<!-- site: (\w+)(.*) -->$", lambda part: PARTS[part[1]](*part[2].split()), markdown, flags=re.M)


def on_files(files: Any, config: Any) -> Any:
    """Add the pages that are kept outside of docs/, and those that forward from the old places of moved ones."""
    for page, source in OUTSIDE.items():
        text = (DOCS.parent / source).read_text(encoding="utf-8").replace("](docs/", "](")
        files.append(File.generated(config, page, content=_inside(text, "")))
    for name in MOVED:
        place = f"evidence/{name}.html"
        files.append(File.generated(config, f"{name}.html", content=FORWARD.format(place=place)))
    return files


def on_page_markdown(markdown: str, page: Any, **_: Any) -> str:
    """Fill a page, rank it for the search, name links by titles, and make links of the keys of the bibliography."""
    path = page.file.src_uri
    page.meta["search"] = {"boost": WEIGHTS.get(path, WEIGHTS.get(path.rpartition("/")[0], 1.0))}
    up = "../" * path.count("/")
    titled = partial(_titled, (DOCS / path).parent)
    text = re.sub(r"\[[\w/-]+\.(?:md|ipynb)\]\(([^)#]+)", titled, _inside(markdown, f"../{up}"))
    text = re.sub(r"\\\[(\w+)\]", lambda key: f"[{key[1]}]" if key[1] in sources() else key[0], filled(text))
    return "\n".join([text, "", *(f"[{key}]: {up}references.md#{key}" for key in sources())])


def on_page_content(html: str, **_: Any) -> str:
    """Return the page with its formulas as MathML and its drawings inline, in the colours of the page."""
    html = re.sub(r'<(span|div) class="arithmatex">\\[\[(](.+?)\\[\])]</\1>', _formula, html, flags=re.DOTALL)
    html = re.sub(r'<img alt="([^"]+)" src="[./]*images/([\w-]+\.svg)" ?/?>', _drawing, html)
    # A reference to the bibliography keeps its brackets.
    html = re.sub(r'(<a href="[^"]*references\.html#(\w+)">\2</a>)', r"[\1]", html)
    # mkdocstrings puts a dash before a description that is empty, and takes a type in words for Python.
    return re.sub(r'\u2013\s*<div class="doc-md-description">\s*</div>', "", html).replace("path - like", "path-like")


def _formula(found: re.Match[str]) -> str:
    """Return a formula in LaTeX as MathML, with the number of the equation beside it."""
    latex, _, tag = unescape(found[2]).partition(r"\tag")
    if found[1] == "span":
        return convert(latex)
    number = f"<span>({tag.strip().strip('{}')})</span>" if tag else ""
    return f'<div class="formula">{convert(latex.strip(), display="block")}{number}</div>'


def _drawing(found: re.Match[str]) -> str:
    """Return a drawing that takes the colour of the text as a part of the page; charts remain pictures."""
    drawing = (DOCS / "images" / found[2]).read_text(encoding="utf-8")
    if "currentColor" not in drawing:
        return found[0]
    # Its style is for where it is a picture.
    drawing = re.sub(r"<style>.*?</style>", "", drawing, flags=re.DOTALL)
    return drawing.replace("<svg ", f'<svg class="drawing" role="img" aria-label="{found[1]}" ', 1)


def _inside(markdown: str, up: str) -> str:
    """Return a page with its links to the pages kept outside of docs/ as links to those of the site."""
    for page, source in OUTSIDE.items():
        markdown = markdown.replace(f"]({up}{source}", f"]({up.removeprefix('../')}{page}")
    return markdown


def _titled(folder: Path, link: re.Match[str]) -> str:
    """Return the beginning of a link whose text is a path, with the title of the page in place of the path."""
    path = folder / link[1]
    source = path if path.exists() else DOCS.parent / OUTSIDE[path.name]
    title = re.search(r"^# (.+)$", source.read_text(encoding="utf-8"), re.MULTILINE)
    return f"[{title[1] if title else 'the notebook'}]({link[1]}"
