"""``python -m armour``."""

from armour.cli import main

main()
