"""What numba compiles: loops over many impacts, that call the functions of the other files as they are.

Only imported to compile; `armour.engine.compiled` loads what has been compiled.
"""

from types import FunctionType, ModuleType
from typing import Any

import llvmlite.binding as llvm
import numba
from numba import types
from numba.extending import register_jitable

from armour.core import equations, rk4, run, search, stages, state
from armour.core.state import Parameters


def let_compiled_code_call(module: ModuleType) -> None:
    """Mark the functions of a module for numba."""
    for function in vars(module).values():
        if isinstance(function, FunctionType) and function.__module__ == module.__name__:
            register_jitable(function)


for _module in (equations, state, stages, rk4, run, search):
    let_compiled_code_call(_module)


@register_jitable
def armour_at(rows: Any, i: int) -> Parameters:
    """Armour of row i."""
    r = 13 * i
    return Parameters(
        rows[r],
        rows[r + 1],
        rows[r + 2],
        rows[r + 3],
        rows[r + 4],
        rows[r + 5],
        rows[r + 6],
        rows[r + 7],
        rows[r + 8],
        rows[r + 9],
        rows[r + 10],
        rows[r + 11],
        rows[r + 12] > 0.5,
    )


def impacts(
    count: int, rows: Any, velocities: Any, V_arrest: float, given: float, max_steps: int, counts: Any, ends: Any
) -> None:
    """Outcome and steps of each impact into ``counts``, time and state at its end into ``ends``."""
    for i in range(count):
        p = armour_at(rows, i)
        end = run.run(p, velocities[i], search.time_step(p, velocities[i], given), V_arrest, max_steps)
        counts[2 * i] = end.outcome
        counts[2 * i + 1] = end.steps
        ends[6 * i] = end.t
        ends[6 * i + 1] = end.y.Z
        ends[6 * i + 2] = end.y.L
        ends[6 * i + 3] = end.y.V
        ends[6 * i + 4] = end.y.W
        ends[6 * i + 5] = end.y.h


def ballistic_limits(
    count: int,
    rows: Any,
    low: float,
    high: float,
    tolerance: float,
    V_arrest: float,
    given: float,
    max_steps: int,
    counts: Any,
    ends: Any,
) -> None:
    """Runs of each search and whether it is resolved into ``counts``, its bracket into ``ends``."""
    for i in range(count):
        found = search.ballistic_limit_of(armour_at(rows, i), low, high, tolerance, V_arrest, given, max_steps)
        counts[2 * i], counts[2 * i + 1] = found.runs, found.resolved
        ends[2 * i], ends[2 * i + 1] = found.low, found.high


def least_thicknesses(
    count: int,
    rows: Any,
    velocities: Any,
    thin: float,
    thick: float,
    tolerance: float,
    V_arrest: float,
    given: float,
    max_steps: int,
    counts: Any,
    ends: Any,
) -> None:
    """As `limits`, of the ceramic thickness."""
    for i in range(count):
        p = armour_at(rows, i)
        found = search.least_ceramic_thickness(p, velocities[i], thin, thick, tolerance, V_arrest, given, max_steps)
        counts[2 * i], counts[2 * i + 1] = found.runs, found.resolved
        ends[2 * i], ends[2 * i + 1] = -found.low, -found.high


_i, _f = types.int64, types.float64
_at: Any = types.CPointer
_is, _fs = _at(types.int64), _at(types.float64)

KERNELS = {
    "impacts": (impacts, (_i, _fs, _fs, _f, _f, _i, _is, _fs)),
    "ballistic_limits": (ballistic_limits, (_i, _fs, _f, _f, _f, _f, _f, _i, _is, _fs)),
    "least_thicknesses": (least_thicknesses, (_i, _fs, _fs, _f, _f, _f, _f, _f, _i, _is, _fs)),
}


def object_code(name: str) -> bytes:
    """Machine code of a kernel for this processor, as a function of that name that needs nothing of numba's."""
    function, arguments = KERNELS[name]
    options: Any = {"error_model": "numpy", "_nrt": False, "no_cpython_wrapper": True, "no_cfunc_wrapper": True}
    compiler: Any = numba.njit(types.void(*arguments), **options)
    kernel = compiler(function)
    module = llvm.parse_assembly(kernel.inspect_llvm(arguments))
    module.get_function(kernel.overloads[arguments].fndesc.llvm_func_name).name = name
    machine = llvm.Target.from_default_triple().create_target_machine(
        cpu=llvm.get_host_cpu_name(),
        features=llvm.get_host_cpu_features().flatten(),
        opt=3,
        reloc="pic",
        codemodel="default",
        jit=True,
    )
    return bytes(machine.emit_object(module))
