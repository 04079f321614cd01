"""The model: an impact, by the equations of the paper, and the search for the ballistic limit."""

from armour.core import search  # noqa: F401 (imports all others)
from armour.core.replaced import remember

remember()
