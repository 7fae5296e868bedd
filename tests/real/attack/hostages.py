"""Keeps both workers busy with jobs of 20 s. Good: a job of 0.1 s is answered within 5 s all the same, also
while further long jobs wait, and a program that is rewritten as a stream is answered whole.
"""

import contextlib
import threading
import time

from bodies import MILL, TENTH_OF_A_SECOND, TWENTY_SECONDS
from connection import Connection, head
from service import Service

WORKERS, QUEUED, SHORT_JOBS = 2, 6, 10
# Seconds after which the caller of a short job, or of a program, gives up.
PATIENCE_S, PROGRAM_PATIENCE_S = 5, 60
# Lines of the program; each has some 27 bytes.
LINES = 100_000


def attack():
    with Service("--workers", str(WORKERS), "--log", "warn") as service:
        with hostage_takers(service, WORKERS):
            times = short_jobs(service)
            program_s, program_failure = rewrite(service)
        # Some short jobs more, while long jobs wait before them.
        with hostage_takers(service, WORKERS + QUEUED):
            behind = short_jobs(service)
    lost = (times + behind).count(float("inf"))
    waiting = f"behind {QUEUED} waiting jobs: {shown(behind)}"
    figures = f"short jobs: {shown(times)}; {waiting}; program: {program_s:.1f} s"
    failures = [program_failure] if program_failure else []
    if lost:
        failures.append(f"{lost} of {2 * SHORT_JOBS} short jobs were not answered within {PATIENCE_S} s")
    return figures, failures


def shown(times):
    lost = sum(seconds == float("inf") for seconds in times)
    answered = sorted(seconds for seconds in times if seconds != float("inf"))
    figures = "none answered"
    if answered:
        figures = f"median {answered[len(answered) // 2]:.2f} s, most {answered[-1]:.2f} s"
    return f"{figures}, {lost} given up after {PATIENCE_S} s"


@contextlib.contextmanager
def hostage_takers(service, n):
    """Callers that keep `n` long jobs in the service."""
    stop, connections = threading.Event(), []

    def caller():
        while not stop.is_set():
            with contextlib.suppress(OSError, ValueError), Connection(service, timeout=60) as connection:
                connections.append(connection)
                status = connection.ask("POST", MILL, TWENTY_SECONDS).status
                # A job that the service gives up, for example at the deadline, is sent again.
                stop.wait(0 if status == 200 else 0.1)

    threads = [threading.Thread(target=caller, daemon=True) for _ in range(n)]
    for thread in threads:
        thread.start()
    time.sleep(1)
    yield
    stop.set()
    for connection in connections:
        with contextlib.suppress(OSError):
            connection.socket.shutdown(2)
    for thread in threads:
        thread.join(2)


def short_jobs(service):
    """Seconds until each of some short jobs is answered; infinite without an answer in time."""
    times = []
    for _ in range(SHORT_JOBS):
        started = time.monotonic()
        try:
            status = service.ask("POST", MILL, TENTH_OF_A_SECOND, timeout=PATIENCE_S).status
        except OSError:
            status = None
        times.append(time.monotonic() - started if status == 200 else float("inf"))
        time.sleep(0.1)
    return times


def rewrite(service):
    """Rewrites a program as a stream. Returns the seconds, and what went wrong, if anything did."""
    lines = "".join(f"G1 X{k / 100:.3f} Y{k % 97 / 50:.3f} Z-1\n" for k in range(LINES))
    program = f"G17 G21 G90 G94\nG0 X0 Y0 Z5\nG1 Z-1 F300\n{lines}M30\n".encode()
    started, failure = time.monotonic(), None
    # A watchdog, because a service that answers a little now and then has no single long pause.
    with Connection(service, PROGRAM_PATIENCE_S) as connection:
        watchdog = threading.Timer(PROGRAM_PATIENCE_S, connection.socket.shutdown, [2])
        watchdog.start()
        try:
            path, headers = "/v1/arcs/fit?tolerance_mm=0.005", ["Content-Type: text/x-gcode"]
            sender = threading.Thread(target=send, args=(connection, path, headers, program), daemon=True)
            sender.start()
            answer = connection.answer()
            if answer.status != 200 or not answer.body.rstrip().endswith(b"M30"):
                failure = f"the program was answered with {answer.status}: {answer.body[-200:]}"
        except (OSError, ValueError) as error:
            failure = f"the program was not answered whole: {error}"
        finally:
            watchdog.cancel()
    return time.monotonic() - started, failure


def send(connection, path, headers, program):
    with contextlib.suppress(OSError):
        connection.socket.sendall(head("PUT", path, len(program), headers) + program)
