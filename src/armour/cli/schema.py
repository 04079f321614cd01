"""``armour schema``."""

from armour.cli.common import print_json


def schema() -> None:
    """Print the JSON Schema of the scenario, by which editors complete and check it."""
    from armour.scenario import scenario_schema

    print_json(scenario_schema())
