"""Takes every connection that the service allows with callers that send a byte a second, of the head of a
request and then of its body. Good: `toolpathd healthcheck` and GET /readyz are answered within 4 s.
"""

import contextlib
import subprocess
import threading
import time

from attackers import drip
from connection import head
from service import PROGRAM, Service

CONNECTIONS = 1024
CHECKS, EVERY_S = 6, 2
# Seconds that the health check of the image waits.
ANSWERED_WITHIN_S = 4

HEAD = b"GET /livez HTTP/1.1\r\nHost: localhost\r\nX-Name: "
BODY = head("POST", "/v1/arcs/fit", 1000)


def attack():
    figures, failures = [], []
    for name, begin in [("heads", HEAD), ("bodies", BODY)]:
        with Service("--connections", str(CONNECTIONS), "--log", "warn") as service:
            healthy, ready, opened = checks(service, begin)
        times = [seconds for seconds in healthy if seconds is not None]
        slowest = f"slowest {max(times):.2f} s" if times else "none in time"
        figures.append(
            f"{name}: healthcheck {len(times)} of {CHECKS}, {slowest}; readyz {ready} of {CHECKS}; "
            f"{opened} connections opened"
        )
        if len(times) < CHECKS:
            what = f"failed or took over {ANSWERED_WITHIN_S} s"
            failures.append(f"{name}: {CHECKS - len(times)} of {CHECKS} health checks {what}")
        if ready < CHECKS:
            failures.append(f"{name}: {CHECKS - ready} of {CHECKS} requests of /readyz were not answered")
    return "; ".join(figures), failures


def checks(service, begin):
    """Seconds of each health check, None for a failed one; the number of answers of /readyz; and the number
    of connections that the callers have opened."""
    stop, counts = threading.Event(), {"drip": 0}
    arguments = (service, stop, counts, "drip", CONNECTIONS, begin)
    thread = threading.Thread(target=drip, args=arguments, daemon=True)
    thread.start()
    until = time.monotonic() + 10
    while counts["drip"] < CONNECTIONS and time.monotonic() < until:
        time.sleep(0.1)
    # All connections stand before the first check.
    time.sleep(1)
    healthy, ready = [], 0
    for _ in range(CHECKS):
        started = time.monotonic()
        healthy.append(check_health(service))
        with contextlib.suppress(OSError, ValueError):
            ready += service.ask("GET", "/readyz", timeout=ANSWERED_WITHIN_S).status == 200
        time.sleep(max(0, started + EVERY_S - time.monotonic()))
    stop.set()
    thread.join(5)
    return healthy, ready, counts["drip"]


def check_health(service):
    command = [PROGRAM, "healthcheck", "--listen", "{}:{}".format(*service.address)]
    started = time.monotonic()
    try:
        done = subprocess.run(command, stderr=subprocess.DEVNULL, timeout=ANSWERED_WITHIN_S)
    except subprocess.TimeoutExpired:
        return None
    return time.monotonic() - started if done.returncode == 0 else None
