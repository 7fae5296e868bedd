"""Sends eight bodies of 16 MB at once that the service must refuse, plain and in gzip, within a memory limit of
1 GiB. Good: every caller gets its refusal (422 with the violation) or 503, one of them 422; the service lives and
uses at most 75 % of the limit; and one such body alone is refused within a few seconds in a development build.

TOOLPATHD_REFUSED_AT_ONCE=2 sends as many at once.
"""

import collections
import gzip
import json
import os
import threading
import time

import group
from service import Service

LIMIT_BYTES = 1 << 30
SHARE = 0.75
AT_ONCE = int(os.environ.get("TOOLPATHD_REFUSED_AT_ONCE", "8"))

# Seconds in which a body that is alone must be refused, and the patience of a caller among several. A release build
# refuses a body within a second; a development build on a busy machine takes a few.
ALONE_WITHIN_S = 8
PATIENCE_S = 60


def bodies():
    """For each kind of violation: path, body, and how the detail of the refusal begins."""
    rows = b"[" + b"[[0,0,0]]," * 1_677_000 + b"[[0,0,0]]]"
    points = b"[" + b"[0,0]," * 2_796_000 + b"[0,0]]"
    empty = b"[" + b"[]," * 5_589_999 + b"[]]"
    grid = b'{"surface":{"kind":"point_grid","points":' + rows + b"}"
    return {
        "unknown member": ("/v1/surfaces/model", grid + b',"colour":1}', "#/colour: "),
        "wrong type": ("/v1/arcs/fit", b'{"polyline":' + points + b',"tolerance_mm":"0.01"}', "#/tolerance_mm: "),
        "missing member": ("/v1/arcs/fit", b'{"polyline":' + points + b"}", "#/tolerance_mm: "),
        "5,590,000 violations": (
            "/v1/arcs/fit",
            b'{"tolerance_mm":0.01,"polyline":' + empty + b"}",
            "5590000 violations; the first at #/polyline/0",
        ),
    }


def attack():
    figures, failures = [], []
    for kind, (path, body, begins) in bodies().items():
        for coding in ["plain", "gzip"]:
            headers = ["Content-Encoding: gzip"] if coding == "gzip" else []
            sent = gzip.compress(body, 1) if coding == "gzip" else body
            told, wrong = refused(path, sent, headers, begins)
            figures.append(f"{kind} {coding} {told}")
            failures += [f"{kind} {coding}: {fault}" for fault in wrong]
    return "; ".join(figures), failures


def refused(path, body, headers, begins):
    with group.limited(LIMIT_BYTES) as limited:
        with Service("--log", "warn", before=limited.enter if limited else None) as service:
            return judged(service, limited, path, body, headers, begins)


def judged(service, limited, path, body, headers, begins):
    failures = []

    def ask(into):
        try:
            answer = service.ask("POST", path, body, headers, timeout=PATIENCE_S)
            into[answer.status] += 1
            detail = json.loads(answer.body)["detail"]
            if answer.status == 422 and not detail.startswith(begins):
                failures.append(f"the refusal says: {detail[:200]}")
        except OSError as error:
            into["failed"] += 1
            failures.append(f"a caller got no answer: {error}")

    alone, together = collections.Counter(), collections.Counter()
    began = time.monotonic()
    ask(alone)
    alone_s = time.monotonic() - began
    callers = [threading.Thread(target=ask, args=(together,)) for _ in range(AT_ONCE)]
    for caller in callers:
        caller.start()
    for caller in callers:
        caller.join()
    peak = limited.peak_bytes() if limited else service.memory_bytes()
    if not service.is_alive():
        failures.append(f"the service died: {service.log()[-300:]}")
    if alone[422] != 1 or alone_s > ALONE_WITHIN_S:
        failures.append(f"alone: {dict(alone)} after {alone_s:.1f} s")
    if not together[422] or together[422] + together[503] != AT_ONCE:
        failures.append(f"together: {dict(together)}")
    if peak > SHARE * LIMIT_BYTES:
        failures.append(f"the peak is {peak / LIMIT_BYTES:.0%} of 1 GiB")
    return f"alone {alone_s:.2f} s, {AT_ONCE} at once {dict(together)}, peak {peak / LIMIT_BYTES:.0%}", failures
