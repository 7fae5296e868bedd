"""Sends long jobs and goes away, in ways that hide the end of the connection from the service. Good: the
service is idle from 1 s after the end. Callers that have only closed their sending side get their answer.
"""

import json
import socket
import time

from bodies import MILL, TEN_SECONDS, THIRD_OF_A_SECOND
from connection import Connection, head
from service import Service
from streams import Client

# When the measurement begins after the caller has gone, and how long it takes.
BEGIN_S, MEASURED_S = 1, 1
# The same for a caller of server-sent events: the service notices at the next event that it cannot send.
EVENTS_BEGIN_S = 3
# Most processor time of a service that is idle, as a share of a processor.
IDLE = 0.1
# Processor time that shows that the job is running, and the time to wait for it.
RUNNING_S, RUNNING_LIMIT_S = 0.2, 10

JOB = head("POST", MILL, len(TEN_SECONDS)) + TEN_SECONDS


def attack():
    cases = [
        ("closed", over_http1(JOB), BEGIN_S),
        ("one byte more", over_http1(JOB + b"X"), BEGIN_S),
        ("second request", over_http1(JOB + head("GET", "/livez")), BEGIN_S),
        ("second job", over_http1(JOB + JOB), BEGIN_S),
        ("100 kB more", over_http1(JOB + b"X" * 100_000), BEGIN_S),
        ("half a body", over_http1(JOB[: -len(TEN_SECONDS) // 2], runs=False), BEGIN_S),
        ("stream reset", reset_stream, BEGIN_S),
        ("connection of streams closed", close_streams, BEGIN_S),
        ("events", over_http1(events()), EVENTS_BEGIN_S),
    ]
    figures, failures = [], []
    for name, leave, begin_s in cases:
        with Service("--workers", "2", "--log", "warn") as service:
            if not leave(service):
                failures.append(f"{name}: the job did not begin to run, so that nothing was measured")
                continue
            time.sleep(begin_s)
            before, started = service.cpu_s(), time.monotonic()
            time.sleep(MEASURED_S)
            share = (service.cpu_s() - before) / (time.monotonic() - started)
        figures.append(f"{name} {share:.0%}")
        if share >= IDLE:
            failures.append(f"{name}: {begin_s} s after the end the service used {share:.0%} of a processor")
    half, half_failures = half_closed()
    return f"processor in use after: {', '.join(figures)}; half-closed: {half}", failures + half_failures


def over_http1(sent, runs=True):
    """A caller that sends bytes and closes when the job runs. `runs` is false where no job can begin."""

    def leave(service):
        with Connection(service) as connection:
            connection.socket.sendall(sent)
            if not runs:
                time.sleep(0.3)
            return not runs or is_running(service)

    return leave


def reset_stream(service):
    client = Client(service, window=None, timeout=30)
    stream = client.send("POST", MILL, TEN_SECONDS)
    has_run = is_running(service)
    client.reset(stream)
    # The connection stays open during the measurement; the end of the program closes it.
    service.client = client
    return has_run


def close_streams(service):
    client = Client(service, window=None, timeout=30)
    client.send("POST", MILL, TEN_SECONDS)
    has_run = is_running(service)
    client.close()
    return has_run


def events():
    return head("POST", MILL, len(TEN_SECONDS), ["Accept: text/event-stream"]) + TEN_SECONDS


def is_running(service):
    """Waits until the service computes; false if it does not."""
    begun, until = service.cpu_s(), time.monotonic() + RUNNING_LIMIT_S
    while time.monotonic() < until:
        if service.cpu_s() - begun >= RUNNING_S:
            return True
        time.sleep(0.02)
    return False


def half_closed():
    """Callers that close their sending side after the request, and wait for the answer."""
    figures, failures = [], []
    with Service("--log", "warn") as service:
        # Whether the service sees the end before it has answered is a matter of chance with short requests.
        requests = [
            ("GET /livez", ("GET", "/livez"), [], 50),
            ("a job", ("POST", MILL, THIRD_OF_A_SECOND), [100], 3),
        ]
        for name, request, permitted, times in requests:
            found = [fault_half_closed(service, request, permitted) for _ in range(times)]
            faults = [fault for fault in found if fault]
            figures.append(f"{name} {times - len(faults)} of {times}")
            if faults:
                failures.append(f"half-closed, {name}: {len(faults)} of {times}: {faults[0]}")
    return ", ".join(figures), failures


def fault_half_closed(service, request, permitted):
    """What is wrong with the answer to a caller that is half-closed; None if nothing is."""
    try:
        answer = ask_half_closed(service, *request)
    except OSError as error:
        return f"no whole answer: {error}"
    if answer.status != 200:
        return f"status {answer.status}"
    if request[0] == "POST" and "report" not in json.loads(answer.body):
        return "the answer has no report"
    if [status for status in answer.interim if status not in permitted]:
        return f"interim answers {answer.interim}"
    return None


def ask_half_closed(service, method, path, body=None):
    with Connection(service, timeout=30) as connection:
        connection.socket.sendall(head(method, path, len(body) if body else None) + (body or b""))
        connection.socket.shutdown(socket.SHUT_WR)
        return connection.answer()
