"""Whether the equations are those used to compute the tests: what is replaced, and a digest of the core's code."""

from functools import cache
from hashlib import sha256
from pathlib import Path

from armour.core import state
from armour.engine.changes import changed_names
from armour.evidence.fit import shipped_data

CORE_FOLDER = Path(state.__file__).parent


def changed_equations() -> str:
    """Describe the equations if they are not those used to compute the tests; "" if they are."""
    if names := changed_names():
        return f"{names} changed"
    return "" if core_digest() == shipped_data()["core"]["sha256"] else "the equations as they are in armour/core"


@cache
def core_digest(core: Path = CORE_FOLDER) -> str:
    """Return a hash of the code of the core; comments, docstrings and the layout of the lines do not count.

    Without source files, it is the hash of no code, which differs from that stored with the tests.
    """
    import tokenize  # slow to import

    layout = (tokenize.COMMENT, tokenize.NL, tokenize.ENDMARKER)
    content = sha256()
    for path in sorted(core.glob("*.py")):
        words, statement = [path.name], []
        with path.open(encoding="utf-8") as file:
            for token in tokenize.generate_tokens(file.readline):
                if token.type in (tokenize.INDENT, tokenize.DEDENT):
                    words.append(tokenize.tok_name[token.type])
                elif token.type != tokenize.NEWLINE:
                    statement += [token] * (token.type not in layout)
                else:
                    if any(part.type != tokenize.STRING for part in statement):
                        # Since Python 3.12, an f-string is several tokens, and the spaces in its braces are none.
                        words += ["".join("".join(part.string for part in statement).split()), "NEWLINE"]
                    statement = []
        content.update(sha256("\n".join(words).encode()).digest())
    return content.hexdigest()
