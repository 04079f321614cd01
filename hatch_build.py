"""Compile the loops of `armour.engine.loops` when the program is built, by numba, into a library of C.

The library needs no numba, and fits every Python on its system.  Without it, Python runs the loops.
`python hatch_build.py` builds the library in a clone.
"""

import os
import shutil
import subprocess
import sys
import sysconfig
from importlib.util import find_spec
from pathlib import Path
from tempfile import TemporaryDirectory
from types import FunctionType
from typing import Any, NamedTuple

from hatchling.builders.hooks.plugin.interface import BuildHookInterface

sys.path.insert(0, str(Path(__file__).parent / "src"))
from armour.engine import compiled, loops
from armour.engine.changes import MODULES

NUMBA = ("numba>=0.62.0; python_version < '3.16'", "numpy>=2.0.1")
ZIG = sys.executable, "-m", "ziglang", "cc"


class System(NamedTuple):
    """A system as LLVM and as zig name it; "" is this one, and its own C compiler."""

    triple: str = ""
    zig: str = ""


WINDOWS = System("x86_64-pc-windows-gnu", "x86_64-windows-gnu")
# The systems that `make release` builds wheels for, by the tags of these.
SYSTEMS = {
    "manylinux_2_17_x86_64": System("x86_64-unknown-linux-gnu", "x86_64-linux-gnu.2.17"),
    "manylinux_2_17_aarch64": System("aarch64-unknown-linux-gnu", "aarch64-linux-gnu.2.17"),
    "musllinux_1_2_x86_64": System("x86_64-unknown-linux-musl", "x86_64-linux-musl"),
    "musllinux_1_2_aarch64": System("aarch64-unknown-linux-musl", "aarch64-linux-musl"),
    "macosx_11_0_x86_64": System("x86_64-apple-macosx11.0", "x86_64-macos.11.0"),
    "macosx_11_0_arm64": System("arm64-apple-macosx11.0", "aarch64-macos.11.0"),
    "win_amd64": WINDOWS,
}


class Hook(BuildHookInterface[Any]):
    """Adds the compiled loops to a wheel or to a clone."""

    PLUGIN_NAME = "custom"

    def dependencies(self) -> list[str]:
        """Return what building the library needs: nothing if it is there."""
        if compiled.library():
            return []
        return [*NUMBA] if linker() else [*NUMBA, "ziglang"]

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:  # noqa: ARG002
        """Add the library of a system, and name the wheel after it: this one, or that of ``ARMOUR_WHEEL_FOR``."""
        if tag := os.environ.get("ARMOUR_WHEEL_FOR", ""):
            content = linked(SYSTEMS[tag])
            file = Path(self.directory, compiled.library_name(content))
            file.write_bytes(content)
            build_data["force_include"][str(file)] = f"armour/engine/{file.name}"
        elif obstacle := build():
            self.app.display_warning(f"armour will compute in plain Python, a hundred times slower: {obstacle}")
            return
        else:
            tag = sysconfig.get_platform().replace("-", "_").replace(".", "_")
            build_data["artifacts"].append("compiled-*.so")
        build_data["pure_python"] = False
        build_data["tag"] = f"py3-none-{tag}"


def build() -> str:
    """Build the library for this system, unless it is there; return why that is not possible, "" if it is."""
    if compiled.library():
        return ""
    if not find_spec("numba"):
        return "numba is not installed"
    if not (linker() or find_spec("ziglang")):
        return "there is no C compiler; install one, or ziglang by pip"
    content = linked(WINDOWS if sys.platform == "win32" else System())
    for file in compiled.FOLDER.glob("compiled-*.so"):
        file.unlink()
    (compiled.FOLDER / compiled.library_name(content)).write_bytes(content)
    return ""


def linker() -> list[str]:
    """Return the command of the C compiler of this system if there is one that links."""
    command = [os.environ.get("CC") or "cc", "-shared"]
    with TemporaryDirectory() as folder:
        source = Path(folder, "empty.c")
        source.touch()
        tried = [*command, "-o", f"{folder}/empty.so", str(source), "-lm"]
        works = shutil.which(command[0]) and not subprocess.run(tried, capture_output=True, check=False).returncode
    return command if works else []


def linked(system: System) -> bytes:
    """Return the content of a library for a system."""
    with TemporaryDirectory() as folder:
        objects = [str(Path(folder, f"{name}.o")) for name in loops.LOOP_NAMES]
        for path, code in zip(objects, machine_code(system.triple), strict=True):
            Path(path).write_bytes(code)
        foreign = [*ZIG, "-shared", *(["-target", system.zig] if system.zig else [])]
        command = (not system.zig and linker()) or foreign
        # A name without the folder, as a library of macOS has the name in it.
        subprocess.run([*command, "-o", "compiled.so", *objects, "-lm"], cwd=folder, check=True)
        return Path(folder, "compiled.so").read_bytes()


def machine_code(triple: str) -> list[bytes]:
    """Compile each loop for a system; "" is this one."""
    os.environ |= {"NUMBA_CPU_NAME": "generic", "NUMBA_CPU_FEATURES": ""}
    import llvmlite.binding as llvm
    import numba
    from numba import types
    from numba.extending import overload, register_jitable

    from armour.core import rk4, stages
    from armour.core.state import Parameters

    # Nothing but this code calls it, and nothing in it needs reference counts.
    options: Any = {"no_cfunc_wrapper": True, "_nrt": False}
    # Called in every step: numba would not inline them by itself, which takes a fifth longer.
    inlined = stages.rates, rk4.step
    # Make the functions of the core callable from compiled code.
    for module in MODULES:
        for function in vars(module).values():
            if isinstance(function, FunctionType) and function.__module__ == module.__name__:
                register_jitable(**options, forceinline=function in inlined)(function)

    @overload(loops.parameters_at, jit_options=options, strict=False)
    def parameters_at(rows: Any, i: Any) -> Any:  # noqa: ARG001 (numba gives types, by these names)
        """Compile `loops.parameters_at`: numba cannot convert an array to a list."""
        return lambda rows, i: Parameters(
            rows[i, 0], rows[i, 1], rows[i, 2], rows[i, 3], rows[i, 4], rows[i, 5], rows[i, 6], rows[i, 7], rows[i, 8],
            rows[i, 9], rows[i, 10], rows[i, 11], rows[i, 12], rows[i, 13], rows[i, 14], rows[i, 15], int(rows[i, 16]),
            int(rows[i, 17]),
        )  # fmt: skip

    number, integer = types.float64, types.int64
    line, table = types.Array(number, 1, "C", readonly=True), types.Array(number, 2, "C", readonly=True)
    results = integer[:, ::1], number[:, ::1]
    signatures = {
        "impacts": (table, line, types.Tuple((number, number, integer)), *results),
        "ballistic_limits": (table, types.Tuple((line, number, number, number, integer)), *results),
    }
    llvm.initialize_all_targets()
    llvm.initialize_all_asmprinters()
    target = llvm.Target.from_triple(triple or llvm.get_process_triple())
    # Without `-ffp-contract`, LLVM joins no multiplication with an addition: all systems round as Python does.
    machine = target.create_target_machine(cpu="generic", opt=3, reloc="pic")
    njit: Any = numba.njit  # its stubs lack some options
    codes = []
    for name in loops.LOOP_NAMES:
        kernel = njit(**options, error_model="numpy", no_cpython_wrapper=True)(getattr(loops, name))
        kernel.compile(types.void(*signatures[name]))
        [result] = kernel.overloads.values()
        module = llvm.parse_assembly(
            result.library.get_llvm_str().replace(result.fndesc.llvm_func_name, f"armour_{name}")
        )
        module.triple, module.data_layout = machine.triple, str(machine.target_data)
        codes.append(machine.emit_object(module))
    return codes


if __name__ == "__main__":
    sys.exit(build() or 0)
