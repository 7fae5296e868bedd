"""Reads the heads of all kinds of answers, sends heads that a service must not trust, and starts the service
with settings that make no sense. Good: no answer without the headers that protect a browser, no request for
another host is served, log lines stay short, and such settings are refused with a message.
"""

import subprocess

from bodies import example
from connection import Connection
from service import PROGRAM, Service

DIE = example("surfaces-mill/one-pass.json")
# Method, path, headers, body and the expected status.
ANSWERS = [
    ("GET", "/", [], None, 200),
    ("GET", "/livez", [], None, 200),
    ("GET", "/readyz", [], None, 200),
    ("GET", "/metrics", [], None, 200),
    ("GET", "/openapi.json", [], None, 200),
    ("GET", "/docs", [], None, 303),
    ("GET", "/docs/", [], None, 200),
    ("GET", "/docs/swagger-ui.css", [], None, 200),
    ("GET", "/docs/missing", [], None, 404),
    ("GET", "/v1/limits", [], None, 200),
    ("GET", "/v1/dialects", [], None, 200),
    ("GET", "/missing", [], None, 404),
    ("GET", "/v1/surfaces/mill", [], None, 405),
    ("DELETE", "/livez", [], None, 405),
    ("OPTIONS", "/v1/surfaces/mill", ["Origin: http://attacker.example"], None, None),
    ("POST", "/v1/surfaces/mill", [], b"{}", 422),
    ("POST", "/v1/surfaces/mill", [], b"{", 400),
    ("POST", "/v1/surfaces/mill", ["Content-Type: text/html"], DIE, 415),
    ("POST", "/v1/surfaces/mill", [], DIE, 200),
    ("POST", "/v1/surfaces/mill?format=html", [], DIE, 200),
    ("POST", "/v1/surfaces/mill?format=svg", [], DIE, 200),
    ("POST", "/v1/surfaces/mill?format=gcode", [], DIE, 200),
    ("POST", "/v1/surfaces/mill", ["Accept: text/event-stream"], DIE, 200),
]
PROTECTING = ["x-content-type-options", "content-security-policy"]

# A path, and the length that the log line of its request must stay below.
LONG_PATH = "/" + "a" * 20_000
LINE_BYTES = 2000

BAD_SETTINGS = [["--log", "nonsense=xx"], ["--log", "nonsense=="], ["--body-limit", "0"]]


def attack():
    failures = []
    with Service("--log", "info") as service:
        bare = unprotected(service, failures)
        hosts(service, failures)
        longest = log_line(service, failures)
    accepted = [" ".join(settings) for settings in BAD_SETTINGS if is_accepted(settings, failures)]
    figures = (
        f"{bare} of {len(ANSWERS)} answers lack a header; log line of {longest} bytes; "
        f"bad settings accepted: {', '.join(accepted) or 'none'}"
    )
    return figures, failures


def unprotected(service, failures):
    """The number of answers that lack a protecting header."""
    bare = 0
    for method, path, headers, body, expected in ANSWERS:
        answer = service.ask(method, path, body, headers)
        if expected and answer.status != expected:
            failures.append(f"{method} {path} {headers}: status {answer.status} instead of {expected}")
        lacking = [name for name in PROTECTING if name not in answer.headers]
        if answer.headers.get("x-content-type-options", "nosniff") != "nosniff":
            lacking.append("nosniff")
        if lacking:
            bare += 1
            failures.append(f"{method} {path} ({answer.status}) lacks {', '.join(lacking)}")
    return bare


def hosts(service, failures):
    port = service.address[1]
    refused, taken = range(400, 500), [200]
    cases = [
        ("Host: attacker.example", refused),
        (f"Host: attacker.example:{port}", refused),
        ("Host: localhost.attacker.example", refused),
        ("Host: localhost", taken),
        (f"Host: localhost:{port}", taken),
        (f"Host: 127.0.0.1:{port}", taken),
        ("Host: toolpathd", taken),
        (f"Host: localhost\r\nHost: 127.0.0.1:{port}", [400]),
        ("X-No-Host: 1", [400]),
    ]
    for lines, expected in cases:
        with Connection(service) as connection:
            connection.socket.sendall(f"GET /v1/limits HTTP/1.1\r\n{lines}\r\n\r\n".encode())
            status = connection.answer().status
        if status not in expected:
            failures.append(f"{lines!r}: status {status}")


def log_line(service, failures):
    """The length of the longest line in the log, after a request with a long path."""
    service.ask("GET", LONG_PATH)
    longest = max((len(line) for line in service.log().splitlines()), default=0)
    if not longest:
        failures.append("the log has no line")
    if longest >= LINE_BYTES:
        failures.append(f"a log line has {longest} bytes")
    return longest


def is_accepted(settings, failures):
    command = [PROGRAM, "--listen", "127.0.0.1:0", *settings]
    try:
        done = subprocess.run(command, capture_output=True, timeout=10)
    except subprocess.TimeoutExpired:
        failures.append(f"{settings} was accepted at start")
        return True
    if done.returncode == 0 or not done.stderr.strip():
        failures.append(f"{settings}: exit code {done.returncode}, message {done.stderr!r}")
    return False
