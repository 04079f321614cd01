"""Pages in Chromium, where there is one."""

import json
import re
import shutil
import subprocess
from base64 import b64encode
from collections.abc import Sequence
from hashlib import sha256
from pathlib import Path
from typing import Any, NamedTuple

import pytest

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
QUIET = (
    "--headless --no-sandbox --disable-gpu --disable-quic --no-first-run --disable-background-networking "
    "--disable-component-update --disable-sync --hide-scrollbars --allow-file-access-from-files"
)
needs_chromium = pytest.mark.skipif(CHROMIUM is None, reason="needs Chromium")


def browse(page: Path, *options: str) -> str:
    """What Chromium writes when it opens a page."""
    command = [str(CHROMIUM), *QUIET.split(), f"--user-data-dir={page.parent / 'profile'}", *options, page.as_uri()]
    return subprocess.run(command, capture_output=True, text=True, timeout=120, check=True).stdout


class Question(NamedTuple):
    """A page, a script that returns what is asked of it, or a promise, and the width of its frame."""

    content: str
    script: str
    width: int = 1280


WATCH = """const said = [];
  addEventListener("error", e => said.push(e.message));
  addEventListener("securitypolicyviolation", e => said.push(e.violatedDirective + " " + e.blockedURI));"""


def framed(question: Question) -> str:
    """The page of a question with its script, which the policy admits, and with one that watches."""
    after = f"""(async () => {{
      let found; try {{ found = await (async () => {{ {question.script} }})(); }} catch (e) {{ said.push(String(e)); }}
      const asked = performance.getEntriesByType("resource").map(entry => entry.name);
      document.body.innerHTML = "";
      const pre = document.createElement("pre");
      pre.id = "found";
      pre.textContent = JSON.stringify({{ said, asked, found }});
      document.body.append(pre);
      }})();"""
    hashes = " ".join(f"'sha256-{b64encode(sha256(text.encode()).digest()).decode()}'" for text in (WATCH, after))
    content = question.content.replace("script-src '", f"script-src {hashes} '", 1)
    content = content.replace("<title>", f"<script>{WATCH}</script><title>", 1)
    return content.replace("</body>", f"<script>{after}</script></body>")


def browsed(folder: Path, questions: Sequence[Question]) -> list[Any]:
    """What the scripts return, all in one start of the browser; without an error or a request."""
    # The window of a browser cannot be as narrow as a telephone's; a frame can.
    frames = ""
    for number, question in enumerate(questions):
        (folder / f"{number}.html").write_text(framed(question))
        frames += f'<iframe src="{number}.html" style="width: {question.width}px; height: 900px"></iframe>'
    take = """setTimeout(() => {
      const found = [...document.querySelectorAll("iframe")].map(frame =>
        JSON.parse(frame.contentDocument.getElementById("found").textContent));
      document.body.textContent = JSON.stringify(found);
    }, 4000);"""
    (folder / "outer.html").write_text(f"<body>{frames}<script>{take}</script></body>")
    window = ("--window-size=1400,1200", "--virtual-time-budget=8000", "--dump-dom")
    written = browse(folder / "outer.html", *window)
    [text] = re.findall(r"<body>(.*)</body>", written, re.DOTALL)
    results = json.loads(text.replace("&lt;", "<").replace("&gt;", ">").replace("&amp;", "&"))
    assert [(result["said"], result["asked"]) for result in results] == [([], [])] * len(questions)
    return [result["found"] for result in results]
