"""Faults at a chosen step of what a program does to files."""

import io
import os
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from errno import ENOSPC
from pathlib import Path
from typing import Any
from unittest.mock import patch

# Functions of os that change what is on disk, also those behind the methods of Path.
STEPS = ("open", "mkdir", "fsync", "replace", "unlink", "rmdir")
# Steps that need no space.
FREEING = ("unlink", "rmdir")

# Called with the name of each step from a chosen one on, before it.
Fault = Callable[[str], None]


def full_disk(step: str) -> None:
    """Refuse what needs space."""
    if step not in FREEING:
        raise OSError(ENOSPC, os.strerror(ENOSPC))


@contextmanager
def faults(first: int, fault: Fault) -> Iterator[list[str]]:
    """Let a fault come before each step on files from one on, the first being 0; half a write is done before its own.

    Give the names of the steps so far.
    """
    steps: list[str] = []

    def step(name: str) -> bool:
        steps.append(name)
        return len(steps) > first

    def hooked(name: str) -> Callable[..., Any]:
        original = getattr(os, name)

        def call(*args: Any, **kwargs: Any) -> Any:
            if step(name):
                fault(name)
            return original(*args, **kwargs)

        return call

    class File(io.FileIO):
        def write(self, data: Any) -> int:
            if step("write"):
                super().write(bytes(data)[: len(bytes(data)) // 2])
                fault("write")
            return super().write(data)

    open_path = Path.open

    def opened(path: Path, mode: str = "r", *args: Any, **kwargs: Any) -> Any:
        if mode != "xb":
            return open_path(path, mode, *args, **kwargs)
        if step("create"):
            fault("create")
        return io.BufferedWriter(File(path, "xb"))

    with ExitStack() as stack:
        for name in STEPS:
            stack.enter_context(patch.object(os, name, hooked(name)))
        stack.enter_context(patch.object(Path, "open", opened))
        yield steps
