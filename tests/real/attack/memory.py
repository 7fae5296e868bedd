"""Attacks the memory of the service from all sides for 40 s, within a memory limit of 1 GiB. Good: the
service lives, uses at most 90 % of the limit, and answers a small request within 1 s when the attack ends.

TOOLPATHD_ATTACKERS=streams,heads lets only these attackers run, and TOOLPATHD_ATTACK_S sets the seconds.
"""

import collections
import os
import threading
import time

import group
from attackers import ATTACKERS
from bodies import SMALL
from service import Service

LIMIT_BYTES = 1 << 30
SHARE = 0.9
ATTACK_S = float(os.environ.get("TOOLPATHD_ATTACK_S", "40"))
NAMES = [name for name in os.environ.get("TOOLPATHD_ATTACKERS", "").split(",") if name] or list(ATTACKERS)

# Seconds between the normal requests, the patience of their caller, and the time for one after the attack.
EVERY_S = 0.5
PATIENCE_S = 5
ANSWERED_WITHIN_S = 1


def attack():
    with group.limited(LIMIT_BYTES) as limited:
        with Service("--log", "warn", before=limited.enter if limited else None) as service:
            return attacked(service, limited)


def attacked(service, limited):
    stop = threading.Event()
    counts = collections.Counter()
    threads = [
        threading.Thread(target=ATTACKERS[name], args=(service, stop, counts), daemon=True) for name in NAMES
    ]
    for thread in threads:
        thread.start()
    normal, died_s = normal_requests(service)
    stop.set()
    for thread in threads:
        thread.join(10)

    peak = service.memory_bytes()
    if limited:
        peak, where = limited.peak_bytes(), "of the cgroup"
    else:
        where = "of the process; no cgroup could be made"
    tried = ", ".join(f"{name} {counts[name]}" for name in NAMES)
    figures = (
        f"peak {peak / 2**20:.0f} MiB ({peak / LIMIT_BYTES:.0%} of 1 GiB, {where}); normal requests: "
        f"{normal[200]} answered, {normal[503]} refused, {normal['failed']} failed; attacks: {tried}"
    )
    failures = []
    if peak > SHARE * LIMIT_BYTES:
        failures.append(f"the peak is {peak / LIMIT_BYTES:.0%} of 1 GiB")
    if died_s is not None or not service.is_alive():
        when = "at the end" if died_s is None else f"after {died_s:.0f} s"
        code = service.process.poll()
        failures.append(f"the service died {when}: exit code {code}; {service.log()[-300:]}")
        return figures, failures
    seconds = until_answered(service)
    if seconds is None or seconds > ANSWERED_WITHIN_S:
        failures.append(f"after the attack a small request was not answered within {ANSWERED_WITHIN_S} s")
    return f"{figures}; then answered after {seconds or PATIENCE_S:.2f} s", failures


def normal_requests(service):
    """Sends small requests during the attack. Returns their counts, and when the service died, if it did."""
    normal = collections.Counter()
    started = time.monotonic()
    while (passed := time.monotonic() - started) < ATTACK_S:
        if not service.is_alive():
            return normal, passed
        try:
            normal[service.ask("POST", *SMALL, timeout=PATIENCE_S).status] += 1
        except OSError:
            normal["failed"] += 1
        time.sleep(max(0, EVERY_S - (time.monotonic() - started - passed)))
    return normal, None


def until_answered(service):
    """Seconds until a small request is answered, after refusals at the most; None if none is answered."""
    started = time.monotonic()
    while time.monotonic() - started < PATIENCE_S:
        try:
            if service.ask("POST", *SMALL, timeout=PATIENCE_S).status == 200:
                return time.monotonic() - started
        except OSError:
            pass
        time.sleep(0.05)
    return None
