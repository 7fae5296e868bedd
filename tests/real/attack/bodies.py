"""Bodies of requests for the attacks, with the time that their computation takes on one
processor in a release build."""

import gzip
import json
import math

from service import ROOT

MILL = "/v1/surfaces/mill?toolpath=false"


def example(name):
    """The body of an example of the contract, such as `surfaces-mill/die.json`."""
    return (ROOT / "openapi/examples" / name).read_bytes()


def packed(body):
    return json.dumps(body, separators=(",", ":")).encode()


def job(stepover_mm, shape="bull_nose", **members):
    """The body of a milling job: a wave of 60 mm by 60 mm."""

    def height(i, j):
        return round(10 * math.sin(math.pi * i / 8) * math.cos(math.pi * j / 8), 6)

    points = [[[5 * i, 5 * j, height(i, j)] for j in range(13)] for i in range(13)]
    tool = {"shape": shape, "diameter_mm": 10}
    if shape == "bull_nose":
        tool["corner_radius_mm"] = 2
    body = {
        "surface": {"kind": "point_grid", "points": points},
        "tool": tool,
        "strategy": {"kind": "cl_cartesian", "stepover_mm": stepover_mm},
        "tolerance_mm": 0.01,
        "cutting": {"feed_mm_per_min": 800},
    }
    return packed(body | members)


TENTH_OF_A_SECOND = job(1.5, "ball")
THIRD_OF_A_SECOND = job(3)
SECOND = job(0.75)
TEN_SECONDS = job(0.06)
TWENTY_SECONDS = job(0.03)

# A small request, which takes about a millisecond.
SMALL = ("/v1/curves/interpolate?toolpath=false", example("curves-interpolate/sine.json"))


def dear_requests():
    """Small requests with large answers: method, path and body. The answers have 29, 29, 9, 3 and 1 MB."""
    cylinder = json.loads(example("surfaces-model/cylinder.json"))
    fine = packed(cylinder | {"wires": {"pitch_mm": 0.003, "direction": "x"}})
    coarse = packed(cylinder | {"wires": {"pitch_mm": 0.01, "direction": "x"}})
    lines = job(0.3, "ball", interpolation="lines", step_length_mm=0.02)
    return [
        ("POST", "/v1/surfaces/model", fine),
        ("POST", "/v1/surfaces/model?format=json", fine),
        ("POST", "/v1/surfaces/model", coarse),
        ("POST", "/v1/surfaces/mill?nc=true&toolpath=true", lines),
        ("POST", "/v1/surfaces/model?format=svg", coarse),
        ("GET", "/openapi.json", None),
    ]


def large_requests():
    """Requests that are large once decoded: path, body, and whether the body is gzip."""
    points = b'{"polyline":[' + b"[0,0]," * 2_796_000 + b'[0,0]],"tolerance_mm":0.01}'
    empty = b'{"polyline":[' + b"[]," * 5_590_000 + b'[0,0]],"tolerance_mm":0.01}'
    rows = b'{"surface":{"kind":"point_grid","points":[' + b"[[0,0,0]]," * 1_677_000 + b"[[0,0,0]]]}}"
    grid = [[[i, j, i * j % 3] for j in range(500)] for i in range(500)]
    surface = {"surface": {"kind": "point_grid", "points": grid}}
    zigzag = [[i / 10, i % 2 / 10 + i % 7 * 0.3] for i in range(250_000)]
    fit = {"polyline": zigzag, "tolerance_mm": 0.01, "method": "biarc", "cutting": {"feed_mm_per_min": 100}}
    return [
        ("/v1/arcs/fit", points, False),
        ("/v1/arcs/fit", gzip.compress(empty), True),
        ("/v1/surfaces/model", gzip.compress(rows), True),
        # Legal: as many points as the service allows.
        ("/v1/arcs/fit?nc=true&toolpath=true", gzip.compress(packed(fit)), True),
        ("/v1/surfaces/model", gzip.compress(packed(surface)), True),
    ]
