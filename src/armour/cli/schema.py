"""``armour schema``."""

from armour.cli.console import show_json


def schema() -> None:
    """Print the JSON Schema of a scenario.

    Editors complete and check scenario files with it.
    """
    from armour.scenario.loading import scenario_schema

    show_json(scenario_schema())
