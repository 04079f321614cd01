"""A folder is locked by one process, whatever others do to it meanwhile."""

import os
from errno import EBADF, ENOLCK
from pathlib import Path

import pytest

from armour.sweeps import lock
from armour.sweeps.lock import NAME, holds, locked, unlock


@pytest.mark.parametrize("removed", ["before the lock is opened", "after it is opened"])
def test_a_folder_that_another_process_removes_is_made_anew(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, removed: str
):
    folder, opened = tmp_path / "parts", os.open
    others = [removed]

    def racing(path: Path, *args: int) -> int:
        if not others:
            return opened(path, *args)
        others.pop()
        if removed == "before the lock is opened":
            folder.rmdir()
            return opened(path, *args)
        handle = opened(path, *args)
        path.unlink()
        return handle

    monkeypatch.setattr("armour.sweeps.lock.os.open", racing)
    handle = locked(folder)
    assert handle is not None
    assert not others
    assert holds(handle, folder)
    assert locked(folder) is None
    unlock(handle, folder, remove=True)
    assert not folder.exists()


def test_a_file_system_without_locks_is_told(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    tried: list[int] = []

    def refused(handle: int) -> None:
        tried.append(handle)
        raise OSError(ENOLCK, os.strerror(ENOLCK))

    monkeypatch.setattr(lock, "_lock", refused)
    with pytest.raises(OSError, match=os.strerror(ENOLCK)):
        locked(tmp_path)
    with pytest.raises(OSError, match=os.strerror(EBADF)):
        os.fstat(tried[0])
    assert (tmp_path / NAME).exists()
