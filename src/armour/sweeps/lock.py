"""A private folder that is locked for one process; the system unlocks it when that process ends."""

import os
import sys
from contextlib import suppress
from pathlib import Path

from armour.errors import InputError, Problem
from armour.files import make_private

NAME = "lock"

if sys.platform == "win32":
    import msvcrt

    def _lock(handle: int) -> None:
        msvcrt.locking(handle, msvcrt.LK_NBLCK, 1)

else:
    import fcntl

    def _lock(handle: int) -> None:
        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)


def make(folder: Path) -> None:
    """Make a folder that only this user can enter; raise an InputError if there is one that others may have changed."""
    while True:
        with suppress(FileNotFoundError):  # another process has just removed it
            if make_private(folder):
                return
            message = "must be a folder of yours that no other user can write; choose another output, or move it"
            raise InputError([Problem(str(folder), "", message)])


def locked(folder: Path) -> int | None:
    """Lock a folder and return its open lock, or None if another process has locked it."""
    lock = folder / NAME
    while True:
        make(folder)
        try:
            handle = os.open(lock, os.O_RDWR | os.O_CREAT | getattr(os, "O_NOFOLLOW", 0), 0o600)
        except FileNotFoundError:  # another process has just removed the folder
            continue
        try:
            _lock(handle)
        except (BlockingIOError, PermissionError):
            os.close(handle)
            return None
        except OSError:
            os.close(handle)
            raise
        if holds(handle, folder):
            return handle
        os.close(handle)  # another process has just removed this file


def unlock(handle: int, folder: Path, *, remove: bool) -> None:
    """Unlock a folder; remove it if it is empty but for the lock, if asked for."""
    lock = folder / NAME
    # Windows removes no open file; elsewhere, a process that came after the unlocking would lose its own.
    if remove and sys.platform != "win32":
        lock.unlink(missing_ok=True)
    os.close(handle)
    if remove and sys.platform == "win32":
        with suppress(OSError):
            lock.unlink()
    if remove:
        with suppress(OSError):
            folder.rmdir()


def holds(handle: int, folder: Path) -> bool:
    """Return whether an open lock is that of the folder, which another process may have removed and made anew."""
    try:
        return os.path.samestat(os.fstat(handle), (folder / NAME).lstat())
    except FileNotFoundError:
        return False
