"""Entry point of ``python -m armour``."""

from armour.cli import main

main()
