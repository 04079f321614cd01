"""Pages in Chromium, where there is one."""

import shutil
import subprocess
from pathlib import Path

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
