"""A memory cgroup for the service: a limit as in a container, and the peak of everything that the service
uses, the buffers of its sockets included."""

import contextlib
import os
import time
from pathlib import Path

ROOT = Path("/sys/fs/cgroup")

# Seconds in which the kernel must let go of the processes of a group that has ended.
REMOVE_LIMIT_S = 5


class Group:
    """The cgroup in a folder, with the names of its files in version 1 or 2 of cgroups."""

    def __init__(self, folder, limit_file, peak_file):
        self.folder, self.limit_file, self.peak_file = folder, limit_file, peak_file

    def make(self, limit_bytes):
        self.folder.mkdir()
        (self.folder / self.limit_file).write_text(str(limit_bytes))

    def enter(self):
        """Puts the calling process into the group; runs in the child before it becomes the service."""
        (self.folder / "cgroup.procs").write_text(str(os.getpid()))

    def peak_bytes(self):
        return int((self.folder / self.peak_file).read_text())

    def remove(self):
        until = time.monotonic() + REMOVE_LIMIT_S
        while self.folder.exists() and time.monotonic() < until:
            with contextlib.suppress(OSError):
                self.folder.rmdir()
            time.sleep(0.05)


@contextlib.contextmanager
def limited(limit_bytes):
    """A group with the limit; None where no group can be made."""
    name = f"toolpathd-attack-{os.getpid()}"
    if (ROOT / "cgroup.controllers").exists():
        group = Group(ROOT / name, "memory.max", "memory.peak")
    else:
        group = Group(ROOT / "memory" / name, "memory.limit_in_bytes", "memory.max_usage_in_bytes")
    try:
        group.make(limit_bytes)
        group.peak_bytes()
    except OSError:
        group.remove()
        yield None
        return
    try:
        yield group
    finally:
        group.remove()
