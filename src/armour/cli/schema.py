"""``armour schema``."""

from armour.cli.runner import print_json


def schema() -> None:
    """Print the JSON Schema of the scenario, by which editors complete and check it."""
    from armour.scenario.loading import scenario_schema

    print_json(scenario_schema())
