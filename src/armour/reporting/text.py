"""Text from files made safe for terminals and XML."""

import unicodedata


def printable(text: str) -> str:
    """Escape control characters, line ends among them, so that a text from a file is shown and not obeyed."""
    return text if text.isprintable() else "".join(_shown(character) for character in text)


def _shown(character: str) -> str:
    # Categories C: control, format, surrogate, private and unassigned; Zl and Zp: separators of lines and paragraphs.
    category = unicodedata.category(character)
    hidden = category.startswith("C") or category in ("Zl", "Zp")
    return character.encode("unicode_escape").decode("ascii") if hidden else character
