"""Lets the log fail in three ways: the disk is full, the reader of the pipe has gone, and the reader does not
read. Good: every request is answered, and SIGTERM ends the service with exit code 0 within 10 s.
"""

import contextlib
import os

from connection import Connection
from service import Service

REQUESTS = 600
# The log line of a request holds the path, so that these requests write 600 kB, ten times what a pipe holds.
PATH = "/" + "long" * 250
# Patience of the caller. After some requests without an answer the rest is not tried.
PATIENCE_S = 10
GIVEN_UP_AFTER = 3
ENDED_WITHIN_S = 10


def attack():
    figures, failures = [], []
    for name, log in [("full disk", full_disk), ("closed pipe", closed_pipe), ("unread pipe", unread_pipe)]:
        with log() as stderr, Service("--log", "info", stderr=stderr) as service:
            answered = requests(service)
            code, seconds = service.terminate(ENDED_WITHIN_S)
        end = "no end" if code is None else f"exit code {code} after {seconds:.1f} s"
        figures.append(f"{name}: {answered} of {REQUESTS} answered, {end}")
        if answered < REQUESTS:
            failures.append(f"{name}: {REQUESTS - answered} of {REQUESTS} requests were not answered")
        if code != 0:
            failures.append(f"{name}: after SIGTERM {end}, within {ENDED_WITHIN_S} s")
    return "; ".join(figures), failures


def requests(service):
    """The number of requests that are answered, one after the other."""
    answered, lost, connection = 0, 0, None
    for _ in range(REQUESTS):
        try:
            connection = connection or Connection(service, PATIENCE_S)
            answered += connection.ask("GET", PATH).status == 404
        except (OSError, ValueError):
            if connection:
                connection.close()
            connection, lost = None, lost + 1
            if lost == GIVEN_UP_AFTER:
                break
    if connection:
        connection.close()
    return answered


@contextlib.contextmanager
def full_disk():
    with open("/dev/full", "w") as full:
        yield full


@contextlib.contextmanager
def closed_pipe():
    reader, writer = os.pipe()
    os.close(reader)
    yield writer
    os.close(writer)


@contextlib.contextmanager
def unread_pipe():
    """A pipe that is full already."""
    reader, writer = os.pipe()
    os.set_blocking(writer, False)
    with contextlib.suppress(BlockingIOError):
        while True:
            os.write(writer, b"a")
    # The service shares this property of the pipe, and a log mostly goes to a pipe that blocks.
    os.set_blocking(writer, True)
    yield writer
    os.close(reader)
    os.close(writer)
