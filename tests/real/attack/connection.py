"""Raw connections to the service over HTTP/1.1."""

import socket
from typing import NamedTuple


class Answer(NamedTuple):
    """An answer over HTTP/1; `interim` has the statuses of the interim heads before it."""

    status: int
    headers: dict
    body: bytes
    interim: list


def head(method, path, length=None, headers=()):
    """The head of a request."""
    lines = [f"{method} {path} HTTP/1.1", *headers]
    if not any(line.lower().startswith("host:") for line in headers):
        lines.append("Host: localhost")
    if length is not None:
        lines.append(f"Content-Length: {length}")
    return "\r\n".join([*lines, "", ""]).encode()


class Connection:
    """A connection over HTTP/1.1. `receive_buffer` sets the size of the kernel's buffer, in bytes."""

    def __init__(self, service, timeout=10, receive_buffer=None):
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_STREAM)
        if receive_buffer:
            self.socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, receive_buffer)
        self.socket.settimeout(timeout)
        try:
            self.socket.connect(service.address)
        except OSError:
            self.socket.close()
            raise
        self.socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        self.reader = self.socket.makefile("rb")

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()

    def close(self):
        self.reader.close()
        self.socket.close()

    def ask(self, method, path, body=None, headers=()):
        self.socket.sendall(head(method, path, None if body is None else len(body), headers) + (body or b""))
        return self.answer()

    def answer(self):
        """Reads the next answer, with the interim heads before it."""
        interim = []
        while True:
            status, headers = self._head()
            if status >= 200:
                return Answer(status, headers, self._body(headers), interim)
            interim.append(status)

    def _head(self):
        line = self.reader.readline().split()
        if len(line) < 2:
            raise ConnectionError("the service closed the connection without an answer")
        headers = {}
        while (field := self.reader.readline().strip()):
            name, _, value = field.decode("latin-1").partition(":")
            headers[name.lower()] = value.strip()
        return int(line[1]), headers

    def _body(self, headers):
        if headers.get("transfer-encoding") != "chunked":
            length = int(headers.get("content-length", 0))
            return self._exactly(length)
        parts = []
        while True:
            size = self.reader.readline()
            if not size.endswith(b"\n"):
                raise ConnectionError(f"the answer ended after {sum(map(len, parts))} bytes, before its end")
            part = self._exactly(int(size.split(b";")[0], 16))
            self.reader.readline()
            if not part:
                return b"".join(parts)
            parts.append(part)

    def _exactly(self, length):
        body = self.reader.read(length)
        if len(body) < length:
            raise ConnectionError(f"the answer ended after {len(body)} of {length} bytes")
        return body
