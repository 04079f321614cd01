"""The keys of configs/references.toml are those that pages, sources, library and suites cite."""

import re
import tomllib
from pathlib import Path

import armour

ROOT = Path(__file__).parents[2]
FOLDERS = (*(ROOT / name for name in ("configs", "docs", "scenarios", "suites", "tests")), Path(armour.__file__).parent)
SOURCES = tomllib.loads((ROOT / "configs" / "references.toml").read_text(encoding="utf-8"))


def cited() -> set[str]:
    """What stands in brackets and is a key, or looks like one."""
    found: set[str] = set()
    for folder in FOLDERS:
        for path in folder.rglob("*"):
            if path.suffix in (".md", ".py", ".toml") and path.name != "references.toml":
                words = re.findall(r"\[(\w+)\]", path.read_text(encoding="utf-8"))
                found.update(word for word in words if word in SOURCES or re.fullmatch(r"[A-Z][a-z]+\d{4}", word))
    for path in (*ROOT.glob("configs/*.toml"), *ROOT.glob("suites/*.toml")):
        for source in re.findall(r'source = "(.*?)"', path.read_text(encoding="utf-8")):
            found.update(re.findall(r"\[(\w+)\]", source))
    return found


def test_every_key_cited_is_listed_and_every_key_listed_is_cited():
    assert cited() == SOURCES.keys()


def test_every_entry_says_what_it_is_used_for_and_how_far_it_was_checked():
    known = {"authors", "title", "where", "year", "doi", "use", "checked"}
    for key, source in SOURCES.items():
        assert {"title", "use", "checked"} <= source.keys() <= known, key
        assert re.fullmatch(r"(Checked|Not checked|[\w ,]+ checked).*", source["checked"]), key
        assert re.fullmatch(r"10\.\d{4,}/\S+", source.get("doi", "10.1000/x")), key
