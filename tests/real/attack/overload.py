"""Asks for twice and four times as much as the service can hold, with clients that try again when refused, and
then holds connections that stop within the head of a request. Good: at least half of the answers per second of a few
clients, only 503 with Retry-After besides 200, an answer to each health check meanwhile, and an end of such heads.

Answers are counted per second of processor time that the service used or could have used. Other load on the
machine therefore changes the figures little. Times are printed and have no limit.
"""

import collections
import contextlib
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
# Each crowd is measured in turns, so that other load on the machine affects all crowds alike.
TURNS, MEASURED_S, WARM_UP_S = 2, 4, 1
# Least answers as a share of the peak. The shares are about 0.95; a queue that collapses leaves almost nothing.
GOODPUT = 0.5
# Connections that stop within a head, and the time for the service to close them all; it should after 10 s.
PARTIAL_HEADS, CLOSED_WITHIN_S = 200, 30
# Seconds between health checks.
EVERY_S = 0.2
# Longest time that a refused client waits, whatever Retry-After says.
WAIT_S = 0.5
PATIENCE_S = 30


def attack():
    figures, failures = [], []
    for name, settings in [("", []), ("with a deadline of 8 s: ", ["--deadline-s", "8"])]:
        loads = {clients: Load() for clients in (SMALL, *CROWDS)}
        with Service("--workers", str(WORKERS), "--queue", str(QUEUE), "--log", "warn", *settings) as service:
            for _ in range(TURNS):
                for clients, load in loads.items():
                    Crowd(service, load).run(clients)
                    if not service.is_alive():
                        raise RuntimeError(f"the service died beside {clients} clients: {service.log()[-300:]}")
            # The deadline of a computation changes nothing for heads.
            heads_figures, heads_failures = ("", []) if settings else partial_heads(service)
        peak = loads[SMALL].goodput()
        if not peak:
            raise RuntimeError(f"{SMALL} clients got no answer: {dict(loads[SMALL].statuses)}")
        per_s = loads[SMALL].answers / (TURNS * MEASURED_S)
        rate = f"peak {peak:.2f} answers per second of a processor, {per_s:.1f} per second"
        crowds = [f"{clients} clients {load.figures(peak)}" for clients, load in loads.items()]
        figures.append("; ".join(filter(None, [f"{name}{rate}", ", ".join(crowds), heads_figures])))
        for clients, load in loads.items():
            failures.extend(f"{name}{clients} clients: {failure}" for failure in load.failures(peak))
        failures.extend(name + failure for failure in heads_failures)
    return "; ".join(figures), failures


def partial_heads(service):
    """Figures and failures of the service beside connections that stop within the head of a request."""
    opened = time.monotonic()
    stuck = [Connection(service, PATIENCE_S) for _ in range(PARTIAL_HEADS)]
    for connection in stuck:
        connection.socket.sendall(b"POST /v1/surfaces/mill HTTP/1.1\r\nHost: localhost\r\nContent-")
    checks, passed = [], 0
    while stuck and passed < CLOSED_WITHIN_S:
        checks.append(health(service))
        time.sleep(EVERY_S)
        for connection in [own for own in stuck if is_closed(own)]:
            connection.close()
            stuck.remove(connection)
        passed = time.monotonic() - opened
    failures = [f"{checks.count(None)} health checks beside partial heads were not answered"] if None in checks else []
    if stuck:
        failures.append(f"{len(stuck)} of {PARTIAL_HEADS} partial heads were open after {passed:.0f} s")
    for connection in stuck:
        connection.close()
    return f"{PARTIAL_HEADS} partial heads: {len(stuck)} open after {passed:.1f} s, health {shown(checks)}", failures


def is_closed(connection):
    """Whether the service has closed the connection, perhaps after an answer."""
    connection.socket.setblocking(False)
    try:
        while connection.socket.recv(1024):
            pass
    except BlockingIOError:
        return False
    except OSError:
        pass
    return True


def health(service):
    """Seconds until a health check is answered; None without an answer."""
    started = time.monotonic()
    with contextlib.suppress(OSError, ValueError):
        if service.ask("GET", "/livez", timeout=PATIENCE_S).status == 200:
            return time.monotonic() - started
    return None


def shown(times):
    """Median and 99 % of times in s, and their number."""
    known = sorted(seconds for seconds in times if seconds is not None)
    if not known:
        return "none"
    median, p99 = (1000 * known[round(share * (len(known) - 1))] for share in (0.5, 0.99))
    return f"median {median:.0f} ms, p99 {p99:.0f} ms of {len(known)}"


class Load:
    """What the crowds of one size were answered."""

    def __init__(self):
        self.statuses = collections.Counter()
        self.processor_s = 0
        self.answers = 0
        self.without_retry_after = 0
        # Seconds of each answer with a status, and of each health check beside the crowd.
        self.took = collections.defaultdict(list)
        self.checks = []

    def figures(self, peak):
        latency = "; ".join(f"{status} {shown(took)}" for status, took in sorted(self.took.items()))
        return f"{self.goodput() / peak:.0%} {dict(self.statuses)} ({latency}; health {shown(self.checks)})"

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
        if None in self.checks:
            yield f"{self.checks.count(None)} of {len(self.checks)} health checks were not answered"


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
        # The last check begins early enough to end within the measured time.
        while time.monotonic() < self.end - 2 * EVERY_S:
            self.load.checks.append(health(self.service))
            time.sleep(EVERY_S)
        time.sleep(max(0, self.end - time.monotonic()))
        self.load.processor_s += usable_s(self.service) - before
        # Answers that are under way do not count, except for the part of their computation before the end.
        time.sleep(0.5)
        for connection in self.connections:
            connection.socket.shutdown(socket.SHUT_RDWR)
        for thread in threads:
            thread.join(PATIENCE_S)
            if thread.is_alive():
                raise RuntimeError("a client of the crowd did not end")
        for connection in self.connections:
            connection.close()

    def client(self):
        connection = Connection(self.service, PATIENCE_S)
        with self.lock:
            self.connections.append(connection)
        while (asked := time.monotonic()) < self.end:
            try:
                answer = connection.ask("POST", MILL, THIRD_OF_A_SECOND)
            except (OSError, ValueError) as error:
                if time.monotonic() < self.end:
                    with self.lock:
                        self.load.statuses[f"no answer: {error}"] += 1
                return
            with self.lock:
                self.count(answer, asked, time.monotonic())
            if answer.status == 503:
                time.sleep(min(float(answer.headers.get("retry-after", WAIT_S)), WAIT_S))

    def count(self, answer, asked, now):
        self.load.statuses[answer.status] += 1
        self.load.took[answer.status].append(now - asked)
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
