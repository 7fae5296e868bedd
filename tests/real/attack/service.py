"""Starts the service for an attack, and reads its processor time and its memory."""

import os
import select
import signal
import subprocess
import tempfile
import time
from pathlib import Path

from connection import Connection

ROOT = Path(__file__).resolve().parents[3]
TARGET = os.environ.get("CARGO_TARGET_DIR", "target")
PROGRAM = os.environ.get("TOOLPATHD", str(ROOT / TARGET / "debug/toolpathd"))

# Seconds in which the service must print its address.
START_LIMIT_S = 30
# Ticks of processor time in a second.
TICKS = os.sysconf("SC_CLK_TCK")


class Service:
    """The running program. Its log goes to a file of its own unless `stderr` says otherwise."""

    def __init__(self, *settings, stderr=None, before=None):
        self.log_file = tempfile.TemporaryFile()
        command = [PROGRAM, "--listen", "127.0.0.1:0", *settings]
        self.process = subprocess.Popen(
            command, stdout=subprocess.PIPE, stderr=stderr or self.log_file, preexec_fn=before
        )
        self.pid = self.process.pid
        is_ready, _, _ = select.select([self.process.stdout], [], [], START_LIMIT_S)
        line = self.process.stdout.readline().decode() if is_ready else ""
        if not line.startswith("listening on http://"):
            self.end()
            raise RuntimeError(f"the service did not start: {line} {self.log()}")
        host, port = line.removeprefix("listening on http://").strip().rsplit(":", 1)
        self.address = (host, int(port))

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.end()

    def end(self):
        """Kills the service and waits for its end."""
        self.process.kill()
        self.process.wait()
        self.process.stdout.close()

    def exit_code(self, number, limit_s):
        """Sends a signal. Returns the exit code and the seconds until the end; None if it takes too long."""
        started = time.monotonic()
        self.process.send_signal(number)
        try:
            return self.process.wait(limit_s), time.monotonic() - started
        except subprocess.TimeoutExpired:
            return None, time.monotonic() - started

    def terminate(self, limit_s):
        """Like `exit_code`, with SIGTERM."""
        return self.exit_code(signal.SIGTERM, limit_s)

    def log(self):
        self.log_file.seek(0)
        return self.log_file.read().decode(errors="replace")

    def cpu_s(self):
        """Processor time that the service has used, in seconds; the resolution is a tick (mostly 10 ms)."""
        fields = Path(f"/proc/{self.pid}/stat").read_text().rsplit(")", 1)[1].split()
        return (int(fields[11]) + int(fields[12])) / TICKS

    def memory_bytes(self, name="VmHWM"):
        """Memory of the service: `VmHWM` at its peak, `VmRSS` now. 0 if the service has ended."""
        try:
            lines = Path(f"/proc/{self.pid}/status").read_text().splitlines()
        except OSError:
            return 0
        return next((int(line.split()[1]) * 1024 for line in lines if line.startswith(name + ":")), 0)

    def is_alive(self):
        return self.process.poll() is None

    def ask(self, method, path, body=None, headers=(), timeout=10):
        """The answer to one request over a connection of its own."""
        with Connection(self, timeout) as connection:
            return connection.ask(method, path, body, headers)
