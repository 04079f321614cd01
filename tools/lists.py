"""Write the lists of commands, keys, columns and library entries into the pages of docs/.

    python -m tools.lists

What stands between the lines ``<!-- site: NAME ARGUMENT ... -->`` and ``<!-- end -->`` of a page is the Markdown
that the function of this name returns.  Where the second line is missing, `tools.site` puts it there on the site.
"""

import json
import re
import tomllib
from collections.abc import Iterable, Mapping, Sequence
from functools import cache
from inspect import getdoc
from itertools import chain
from pathlib import Path
from typing import Any

from markdown.extensions.toc import slugify

import armour
from armour.cli.app import COMMANDS, named, told
from armour.columns import COUNTED, OUTCOME_WORDS, UNITS, USUAL_NAMES, YES_OR_NO
from armour.reporting.formats import markdown_table
from armour.reporting.table import in_words
from armour.reporting.views.library import tables_by_kind
from armour.scenario.inputs import INPUTS, Kind
from armour.scenario.library import named_threats
from armour.scenario.scenario import scenario_schema
from armour.units import words_and_unit
from armour.validation.tested import tested_with
from tools import budget

DOCS = Path(__file__).parents[1] / "docs"
# Pages of the API that are not named after the package.
PAGES = {"engine": "analysis"}


def _table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """Return a table in Markdown."""
    return "\n".join(f"| {' | '.join(line)} |" for line in (head, ["---"] * len(head), *rows))


def commands() -> str:
    """Return the commands with their arguments, options and examples, as their help shows them."""
    programs = dict(budget.commands())
    parts = []
    for function in chain.from_iterable(COMMANDS.values()):
        (words, examples), name = told(function), named(function)
        rows = [_option(param) for param in programs[name].params if not getattr(param, "hidden", False)]
        parts += [
            f"## `armour {name}`",
            words,
            *[_table(("option", "meaning"), rows)] * bool(rows),
            "\n".join(["```sh", *examples, "```"]),
        ]
    return "\n\n".join(parts)


def _option(param: Any) -> tuple[str, str]:
    """Return the row of an option, or of an argument."""
    names = param.opts if param.param_type_name == "option" else []
    return f"`{' '.join(filter(None, [*names, param.metavar]))}`", param.help


def described(*names: str) -> str:
    """Return a table of public names, linked to their pages, with the first lines of their descriptions."""
    rows = []
    for name in names:
        described = getattr(armour, name)
        package, words = described.__module__.split(".")[1], getdoc(described) or ""
        rows.append((f"[`{name}`](api/{PAGES.get(package, package)}.md)", words.splitlines()[0]))
    return _table(("name", "description"), rows)


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
        rows.append((name, content["description"], _kind(content, places), shown))
    words = section.get("description", "A number of the library.")
    return "\n\n".join([f"## {heading}", words, _table(("key", "meaning", "value", "default"), rows)])


def _kind(content: Mapping[str, Any], places: Mapping[str, str]) -> str:
    """Return the values that a key may have, in words."""
    if "$ref" in content:
        place = places[content["$ref"].rsplit("/", 1)[1]]
        return f"[{place}](#{slugify(place.replace('`', ''), '-')})"
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
    bounds = [f"{sign} {content[word]:.7g}" for word, sign in signs.items() if word in content]
    kind = {"string": "text", "boolean": "`true`, `false`", "integer": "whole number"}.get(content["type"], "number")
    return ", ".join([kind, *bounds])


def inputs() -> str:
    """Return a table of the names of inputs, with their words."""
    return _table(("name", "in words"), ((f"`{name}`", in_words(name)) for name in INPUTS))


def column_names() -> str:
    """Return a table of the names and units of columns of tables that people write."""
    rows = []
    for key, names in USUAL_NAMES.items():
        # Tests may have the names of shots.
        own = [name for name in names if key != "test" or name not in USUAL_NAMES["shot"]]
        units = UNITS.get(words_and_unit(key)[1], {})
        if key not in ("impact.velocity_m_s", "outcome"):
            rows.append((f"`{key}`", ", ".join(dict.fromkeys(own)), ", ".join(units)))
    return _table(("key", "names", "units"), rows)


def result_words() -> str:
    """Return a table of the words for results."""
    return _table(("stopped", "perforated"), OUTCOME_WORDS)


def count_words() -> str:
    """Return a table of the words for shots that count and those that do not."""
    return _table(("does not count", "counts"), (*YES_OR_NO, *COUNTED))


def library(kind: Any) -> str:
    """Return a table of the entries of a kind."""
    entries_of_kind = named_threats() if kind == "threat" else armour.shipped_library().entries[kind]
    return markdown_table(*tables_by_kind({kind: entries_of_kind}))


def entries(kind: Kind) -> str:
    """Return the values of the entries of a kind, with their sources, and what they were tested with."""
    parts = []
    for name, entry in armour.shipped_library().entries[kind].items():
        said = [entry.description, f"also {', '.join(entry.aliases)}" if entry.aliases else ""]
        said += [f"doubtful: {entry.doubtful}" if entry.doubtful else ""]
        said.append(f"tested with: {', '.join(tested_with().get((kind, name), ['none']))}")
        values = [f"* `{key}` {value.value:g}, {value.status}: {value.source}" for key, value in entry.values.items()]
        parts += [f"## {name}", "; ".join(filter(None, said)) + ".", "\n".join(values)]
    return "\n\n".join(parts)


def threats() -> str:
    """Return the sources of the threats."""
    return "\n\n".join(f"## {name}\n\n{threat.source}." for name, threat in named_threats().items())


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
    return f"### {key}\n\n{words}.\n\n{source['use']} *{source['checked']}.*"


LISTS = (
    *(column_names, commands, count_words, described, entries, inputs),
    *(library, references, result_words, scenario, threats),
)
PARTS = {part.__name__: part for part in LISTS}


def written(markdown: str) -> str:
    """Return a page with the lists between its marks as they are now."""
    return budget.LIST.sub(lambda part: f"{part[1]}\n{PARTS[part[2]](*part[3].split())}\n\n{part[4]}", markdown)


def main() -> None:
    """Write the lists of all pages."""
    for page in DOCS.rglob("*.md"):
        text = page.read_text(encoding="utf-8")
        if (found := written(text)) != text:
            page.write_text(found, encoding="utf-8")


if __name__ == "__main__":
    main()
