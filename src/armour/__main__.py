"""Entry point of ``python -m armour``."""

from armour.cli.main import main

main()
