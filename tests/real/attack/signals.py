"""Sends signals while a request runs. Good: after SIGHUP, SIGTERM and SIGINT the request is answered and the
program ends with exit code 0; a second SIGTERM ends the program within 3 s, long before its job ends.
"""

import signal
import subprocess
import time

from bodies import MILL, SECOND, TWENTY_SECONDS
from connection import Connection, head
from service import Service

# Seconds after the request at which the signal is sent, and between the two signals.
RUNS_S, BETWEEN_S = 0.3, 1
DRAINED_WITHIN_S, ENDED_WITHIN_S = 30, 3


def attack():
    figures, failures = [], []
    for number in (signal.SIGHUP, signal.SIGTERM, signal.SIGINT):
        status, code = drained(number)
        figures.append(f"{number.name}: request {status}, exit code {code}")
        if status != 200:
            failures.append(f"{number.name}: the running request was answered with {status}")
        if code != 0:
            failures.append(f"{number.name}: exit code {code}")
    seconds = ended_at_once()
    figures.append(f"second SIGTERM: {'no end' if seconds is None else f'end after {seconds:.2f} s'}")
    if seconds is None:
        failures.append(f"the program did not end within {ENDED_WITHIN_S} s of the second SIGTERM")
    return "; ".join(figures), failures


def drained(number):
    """The status of a request that runs when the signal arrives, and the exit code."""
    with Service("--log", "warn") as service, Connection(service, DRAINED_WITHIN_S) as connection:
        connection.socket.sendall(head("POST", MILL, len(SECOND)) + SECOND)
        time.sleep(RUNS_S)
        service.process.send_signal(number)
        try:
            status = connection.answer().status
        except (OSError, ValueError) as error:
            status = f"no answer ({error})"
        connection.close()
        try:
            code = service.process.wait(DRAINED_WITHIN_S)
        except subprocess.TimeoutExpired:
            code = None
        return status, code


def ended_at_once():
    """Seconds from the second signal to the end; None if the program does not end in time."""
    with Service("--log", "warn") as service, Connection(service) as connection:
        connection.socket.sendall(head("POST", MILL, len(TWENTY_SECONDS)) + TWENTY_SECONDS)
        time.sleep(RUNS_S)
        service.process.send_signal(signal.SIGTERM)
        time.sleep(BETWEEN_S)
        if not service.is_alive():
            raise RuntimeError("the program ended at the first signal, although a request was running")
        code, seconds = service.terminate(ENDED_WITHIN_S)
        return None if code is None else seconds
