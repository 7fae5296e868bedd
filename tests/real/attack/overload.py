"""Asks for twice and four times as much as the service can hold, with clients that try again when refused.
Good: at least 90 % of the answers per second of a few clients, and only 503 with Retry-After besides 200.

Answers are counted per second of processor time that the service used or could have used. Other load on the
machine therefore changes the figures little.
"""

import collections
import re
import socket
import threading
import time
from pathlib import Path

from bodies import MILL, THIRD_OF_A_SECOND
from connection import Connection
from service import TICKS, Service

WORKERS, QUEUE = 2, 16
# The small crowd is never refused, and gives the peak. The others are 2 and 4 times the queue.
SMALL, CROWDS = 4, (32, 64)
# Each crowd is measured in turns, so that other load on the machine affects all crowds alike. The turns end
# when every figure is CLEAR of the least goodput, or after TURNS: one turn is about 25 answers, a few too many
# or too few by chance.
LEAST_TURNS, TURNS, MEASURED_S, WARM_UP_S = 2, 8, 4, 1
GOODPUT, CLEAR = 0.9, 0.94
# Longest time that a refused client waits, whatever Retry-After says.
WAIT_S = 0.5
PATIENCE_S = 30


def attack():
    figures, failures = [], []
    for name, settings in [("", []), ("with a deadline of 8 s: ", ["--deadline-s", "8"])]:
        loads = {clients: Load() for clients in (SMALL, *CROWDS)}
        with Service("--workers", str(WORKERS), "--queue", str(QUEUE), "--log", "warn", *settings) as service:
            for turn in range(1, TURNS + 1):
                for clients, load in loads.items():
                    Crowd(service, load).run(clients)
                peak = loads[SMALL].goodput()
                if turn >= LEAST_TURNS and all(load.goodput() >= CLEAR * peak for load in loads.values()):
                    break
        per_s = loads[SMALL].answers / (turn * MEASURED_S)
        crowds = [
            f"{clients} clients {load.goodput() / peak:.0%} {dict(load.statuses)}"
            for clients, load in loads.items()
        ]
        rate = f"peak {peak:.2f} answers per second of a processor, {per_s:.1f} per second, {turn} turns"
        figures.append(f"{name}{rate}; {', '.join(crowds)}")
        for clients, load in loads.items():
            failures.extend(f"{name}{clients} clients: {failure}" for failure in load.failures(peak))
    return "; ".join(figures), failures


class Load:
    """What the crowds of one size were answered."""

    def __init__(self):
        self.statuses = collections.Counter()
        self.processor_s = 0
        self.answers = 0
        self.without_retry_after = 0

    def goodput(self):
        """Answers per second of processor time."""
        return self.answers / self.processor_s

    def failures(self, peak):
        if self.goodput() < GOODPUT * peak:
            yield f"goodput is {self.goodput() / peak:.0%} of the peak"
        others = {status: n for status, n in self.statuses.items() if status not in (200, 503)}
        if others:
            yield f"answered {others}"
        if self.without_retry_after:
            yield f"{self.without_retry_after} refusals without Retry-After"


class Crowd:
    """Clients that ask again and again, each over one connection."""

    def __init__(self, service, load):
        self.service, self.load, self.lock = service, load, threading.Lock()
        self.begin = time.monotonic() + WARM_UP_S
        self.end = self.begin + MEASURED_S
        self.connections = []

    def run(self, clients):
        threads = [threading.Thread(target=self.client, daemon=True) for _ in range(clients)]
        for thread in threads:
            thread.start()
        time.sleep(max(0, self.begin - time.monotonic()))
        before = usable_s(self.service)
        time.sleep(max(0, self.end - time.monotonic()))
        self.load.processor_s += usable_s(self.service) - before
        # Answers that are under way do not count, except for the part of their computation before the end.
        time.sleep(0.5)
        for connection in self.connections:
            connection.socket.shutdown(socket.SHUT_RDWR)
        for thread in threads:
            thread.join(WAIT_S + 1)
            if thread.is_alive():
                raise RuntimeError("a client of the crowd did not end")
        for connection in self.connections:
            connection.close()

    def client(self):
        connection = Connection(self.service, PATIENCE_S)
        with self.lock:
            self.connections.append(connection)
        while time.monotonic() < self.end:
            try:
                answer = connection.ask("POST", MILL, THIRD_OF_A_SECOND)
            except (OSError, ValueError) as error:
                if time.monotonic() < self.end:
                    with self.lock:
                        self.load.statuses[f"no answer: {error}"] += 1
                return
            with self.lock:
                self.count(answer, time.monotonic())
            if answer.status == 503:
                time.sleep(min(float(answer.headers.get("retry-after", WAIT_S)), WAIT_S))

    def count(self, answer, now):
        self.load.statuses[answer.status] += 1
        if answer.status == 503:
            self.load.without_retry_after += "retry-after" not in answer.headers
        if answer.status == 200:
            # An answer counts by the part of its computation within the measured time.
            timing = re.search(r"compute;dur=([\d.]+)", answer.headers.get("server-timing", ""))
            took = max(float(timing[1]) / 1000 if timing else 0, 1e-3)
            self.load.answers += max(0, min(now, self.end) - max(now - took, self.begin)) / took


def usable_s(service):
    """Processor time that the service has used, and that nobody has used, in seconds."""
    idle = Path("/proc/stat").read_text().split()[4:6]
    return service.cpu_s() + sum(map(int, idle)) / TICKS
