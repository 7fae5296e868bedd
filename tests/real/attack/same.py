"""Sends the same requests again and again, to services with 1, 2 and 8 workers. Good: for each request all
answers are the same, byte for byte, with the same digest.
"""

import base64
import collections
import hashlib
import threading

from bodies import example
from connection import Connection
from service import Service

REQUESTS = {
    "mill": ("/v1/surfaces/mill", "surfaces-mill/wire-union.json"),
    "model": ("/v1/surfaces/model", "surfaces-model/ruled.json"),
    "smooth": ("/v1/five-axis/smooth", "five-axis-smooth/wave.json"),
    "interpolate": ("/v1/curves/interpolate", "curves-interpolate/in-band.json"),
    "fit": ("/v1/arcs/fit", "arcs-fit/sine.json"),
}
TIMES = 360
WORKERS = (1, 2, 8)
# Connections that share the requests.
CONNECTIONS = 4
PATIENCE_S = 60


def attack():
    answers = {name: collections.Counter() for name in REQUESTS}
    failures = []
    for workers in WORKERS:
        with Service("--workers", str(workers), "--log", "warn") as service:
            lock, arguments = threading.Lock(), (service, answers, failures)
            threads = [
                threading.Thread(target=caller, args=(*arguments, lock), daemon=True)
                for _ in range(CONNECTIONS)
            ]
            for thread in threads:
                thread.start()
            for thread in threads:
                thread.join(600)
    expected = TIMES * len(WORKERS)
    for name, counted in answers.items():
        if len(counted) != 1 or counted.total() != expected:
            failures.append(f"{name}: {len(counted)} different answers among {counted.total()}")
    figures = ", ".join(f"{name} {len(counted)}" for name, counted in answers.items())
    return f"different answers among {expected}: {figures}", failures


def caller(service, answers, failures, lock):
    """Sends a share of the requests, the requests in turns."""
    with Connection(service, PATIENCE_S) as connection:
        for _ in range(TIMES // CONNECTIONS):
            for name, (path, file) in REQUESTS.items():
                answer = connection.ask("POST", path, example(file))
                digest = answer.headers.get("repr-digest")
                found = base64.b64encode(hashlib.sha256(answer.body).digest()).decode()
                with lock:
                    answers[name][answer.status, digest, found] += 1
                    if answer.status != 200 or digest != f"sha-256=:{found}:":
                        failures.append(f"{name}: status {answer.status}, digest {digest}, not {found}")
                        return
