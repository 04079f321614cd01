"""Commands that answer a question about a scenario: `question` makes one of a function that computes the answer."""

import inspect
from collections.abc import Callable, Sequence
from functools import wraps
from pathlib import Path
from typing import Annotated, Any

from armour.cli.console import progress
from armour.cli.options import AsJson, Changes, Force, PlotFile, ScenarioFile, option
from armour.cli.runner import check_outputs, read_scenario, respond, say_if_compiling, warnings_of

# Options of every question, after its own.
COMMON = {"plot": (PlotFile, None), "force": (Force, False), "changes": (Changes, None), "as_json": (AsJson, False)}


def question(
    *reads: str,
    what: str = "the answer",
    unit: str = "impacts",
    first: str = "",
    csv_help: str = "",
    of_threats: bool = False,
    **keys: tuple[str, Any],
) -> Callable[[Callable[..., tuple[Any, Sequence[str]]]], Callable[..., None]]:
    """Make a command of a function (scenario, on_progress, options), which returns a result and its warnings.

    The command checks the outputs, reads the scenario with what ``--set`` changes of the sections that it ``reads`` for
    ``what`` it answers, computes, writes the files, shows and warns.  Its options are those of the function, the common
    ones, and by name those that set a key of the scenario, each with the key and its type; with ``csv_help`` also
    ``--csv``, for the CSV of the view.  What is done ``first`` is said before the progress, which is counted in a
    ``unit``; without it, the engine is compiled.
    """

    def made(function: Callable[..., tuple[Any, Sequence[str]]]) -> Callable[..., None]:
        @wraps(function)
        def command(
            scenario: Path,
            plot: Path | None,
            force: bool,
            changes: list[str] | None,
            as_json: bool,
            csv: Path | None = None,
            **options: Any,
        ) -> None:
            from armour.reporting.show import view_of

            check_outputs(csv=csv, plot=plot, force=force)
            settings = {f"--{name}": (key, options.pop(name)) for name, (key, _kind) in keys.items()}
            loaded = read_scenario(scenario, changes, reads, settings, what)
            if not first:
                say_if_compiling()
            with progress(unit, first=first) as count:
                result, warnings = function(loaded, count, **options)
            view = view_of(result)
            respond(
                result.to_dict(),
                view.tables(result),
                as_json=as_json,
                of=result._heading(),
                files=[(csv, lambda: view.csv(result))],
                plot=plot,
                chart=lambda: view.chart(result),
                warnings=warnings_of(loaded, warnings, of_threats=of_threats),
            )

        own = [each for each in inspect.signature(function).parameters.values() if each.kind is each.KEYWORD_ONLY]
        table = [_option("csv", Annotated[Path | None, option(csv_help, "--csv", metavar="FILE")], None)]
        setting = [_option(name, kind, None) for name, (_key, kind) in keys.items()]
        common = [_option(name, kind, value) for name, (kind, value) in COMMON.items()]
        file = inspect.Parameter("scenario", inspect.Parameter.POSITIONAL_OR_KEYWORD, annotation=ScenarioFile)
        parameters = [file, *own, *setting, *(table if csv_help else []), *common]
        command.__dict__["__signature__"] = inspect.Signature(parameters)
        command.__annotations__ = {each.name: each.annotation for each in parameters}
        return command

    return made


def _option(name: str, kind: Any, default: Any) -> inspect.Parameter:
    return inspect.Parameter(name, inspect.Parameter.KEYWORD_ONLY, annotation=kind, default=default)
