"""The attackers of the memory of the service. Each runs until `stop` is set, then closes its connections, and
counts what it tries."""

import itertools
import select
import socket
import threading
import time

from bodies import dear_requests, large_requests
from connection import Connection, head
from streams import hungry_streams

# Connections of each attacker. Together they stay below the 1,024 connections that the service allows.
UNREAD, SLOW, SENDERS, HEADS = 100, 200, 8, 300
# Smallest receive buffer that a client can ask for; Linux makes it 2 kB.
TINY_BUFFER = 1024
# Seconds that a sender of a large body waits for the answer: longer than the service may compute by default.
WAIT_S = 30
# Seconds between bursts of heads; the service closes such a connection after 10 s.
BURST_S = 5


def unread(service, stop, counts):
    """Asks for large answers over HTTP/1, and never reads them."""
    requests = [
        head(method, path, len(body) if body else None) + (body or b"")
        for method, path, body in dear_requests()
    ]
    wanted = itertools.cycle(requests)
    connections = [None] * UNREAD
    while not stop.wait(0.5):
        for k, connection in enumerate(connections):
            if connection and is_waiting(connection):
                continue
            if connection:
                connection.close()
            connections[k] = opened(service, next(wanted), receive_buffer=TINY_BUFFER)
            counts["unread"] += 1
    close(connections)


def is_waiting(connection):
    """Whether the connection is still of use to the attacker: open, and not refused."""
    try:
        begin = connection.socket.recv(16, socket.MSG_PEEK | socket.MSG_DONTWAIT)
    except BlockingIOError:
        return True
    except OSError:
        return False
    return begin.startswith(b"HTTP/1.1 200")


def slow(service, stop, counts):
    """Announces bodies of 16 MB and sends a byte a second."""
    begin = head("POST", "/v1/arcs/fit", 16_000_000)
    drip(service, stop, counts, "slow", SLOW, begin)


def drip(service, stop, counts, name, n, begin):
    connections = [None] * n
    while not stop.wait(1):
        for k, connection in enumerate(connections):
            try:
                connection.socket.send(b" ")
            except (OSError, AttributeError):
                close([connection])
                connections[k] = opened(service, begin)
                counts[name] += 1
    close(connections)


def large(service, stop, counts):
    """Sends large bodies, plain and gzip, from several connections at a time."""
    requests = [
        head("POST", path, len(body), ["Content-Encoding: gzip"] if is_gzip else []) + body
        for path, body, is_gzip in large_requests()
    ]
    wanted, lock = itertools.cycle(requests), threading.Lock()

    def sender():
        while not stop.is_set():
            with lock:
                request = next(wanted)
            connection = opened(service, request)
            counts["large"] += 1
            until = time.monotonic() + WAIT_S
            while connection and time.monotonic() < until and not stop.is_set():
                # The first byte of the answer, or the end of the connection, ends the wait.
                if select.select([connection.socket], [], [], 0.2)[0]:
                    break
            close([connection])
            stop.wait(0.1)

    threads = [threading.Thread(target=sender, daemon=True) for _ in range(SENDERS)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()


def heads(service, stop, counts):
    """Sends bursts of long heads that do not end."""
    begin = b"GET /livez HTTP/1.1\r\nHost: localhost\r\n"
    lines = b"".join(b"X-Line-%d: %s\r\n" % (k, b"a" * 1000) for k in range(59))
    connections = []
    while not stop.is_set():
        close(connections)
        connections = [opened(service, begin + lines) for _ in range(HEADS)]
        counts["heads"] += HEADS
        stop.wait(BURST_S)
    close(connections)


def opened(service, begin, timeout=5, receive_buffer=None):
    """A connection over which `begin` is sent; None if the service does not take it."""
    connection = None
    try:
        connection = Connection(service, timeout, receive_buffer)
        connection.socket.sendall(begin)
        return connection
    except OSError:
        close([connection])
        return None


def close(connections):
    for connection in connections:
        if connection:
            connection.close()


ATTACKERS = {"streams": hungry_streams, "unread": unread, "slow": slow, "large": large, "heads": heads}
