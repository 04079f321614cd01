"""Pictures of results by matplotlib: a module of the name of each class of result, with ``draw(result, sheet)``."""
