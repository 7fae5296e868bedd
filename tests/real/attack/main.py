"""Runs the attacks named as arguments, or all of them, one after the other. Prints a line of figures for each
attack. An attack that finds a failure runs once more, because other load on the machine may be the reason. Exits with 1
if an attack found failures both times.

Each attack is a module with a function `attack`, which returns its figures as a text and a list of failures.
"""

import importlib
import resource
import sys
import time
import traceback

ATTACKS = ["memory", "refused", "log", "gone", "overload", "hostages", "drip", "same", "signals", "heads"]

# Open files that the attacks and the service need: 1,024 connections at both ends, and some.
OPEN_FILES = 8192


def main(names):
    unknown = [name for name in names if name not in ATTACKS]
    if unknown:
        sys.exit(f"there is no attack {', '.join(unknown)}; the attacks are {', '.join(ATTACKS)}")
    # The service inherits the limit.
    _, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    files = OPEN_FILES if hard == resource.RLIM_INFINITY else min(OPEN_FILES, hard)
    resource.setrlimit(resource.RLIMIT_NOFILE, (files, hard))
    has_failed = False
    for name in names or ATTACKS:
        has_failed |= not (passes(name, "fails, and runs once more") or passes(name, "FAILED"))
    return 1 if has_failed else 0


def passes(name, verdict):
    """Runs an attack and prints its figures, and each failure with the verdict."""
    started, used = time.monotonic(), time.process_time()
    try:
        figures, failures = importlib.import_module(name).attack()
    except Exception as error:
        traceback.print_exc()
        figures, failures = "stopped", [f"{type(error).__name__}: {error}"]
    # Attackers that use much processor time would measure themselves.
    own = f"attackers used {time.process_time() - used:.1f} s of processor time"
    took = f"{time.monotonic() - started:.0f} s; {own}"
    print(f"{name} ({took}): {figures}", flush=True)
    for failure in failures:
        print(f"    {verdict}: {failure}", flush=True)
    return not failures


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
