"""Print the lowest versions that pyproject.toml allows, as constraints for pip."""

import re
import tomllib
from itertools import chain
from pathlib import Path

project = tomllib.loads(Path("pyproject.toml").read_text(encoding="utf-8"))["project"]
for requirement in chain(project["dependencies"], *project["optional-dependencies"].values()):
    found = re.fullmatch(r"([\w-]+)>=([\d.]+)(; python_version < '[\d.]+')?", requirement)
    assert found, f"pyproject.toml: {requirement}: must be a name, >=, the lowest version and perhaps a marker"
    print(f"{found[1]}=={found[2]}")
