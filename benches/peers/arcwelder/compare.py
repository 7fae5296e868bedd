#!/usr/bin/env python3
"""Arc fitting side by side: toolpathd's /v1/arcs/fit and ArcWelder.

    compare.py --arcwelder PATH [--service http://127.0.0.1:8080] [--peer-only] ...

Both get the same programs of G1 blocks, written here, and both answers are judged by the evaluator below, which shares no code with
either. Standard library only; docs/comparison.md says what the figures mean.
"""

import argparse
import bisect
import http.client
import json
import math
import os
import random
import re
import statistics
import subprocess
import sys
import tempfile
import time
import urllib.parse

DECIMALS = 3
FEED = 600
# Two errors of the evaluator: arcs become chords with this sagitta, and the search for the maximum stops at this gap.
SAGITTA_MM = 1e-6
GAP_MM = 1e-6


# ---------------------------------------------------------------------------------------------------------------- inputs


def sine():
    return [(20 * i / 999, 3 * math.sin(20 * i / 999)) for i in range(1000)]


def spiral(r0, r1, turns, n):
    points = []
    for i in range(n):
        t = i / (n - 1)
        r, a = r0 + (r1 - r0) * t, 2 * math.pi * turns * t
        points.append((r * math.cos(a), r * math.sin(a)))
    return points


def noisy_circle():
    rng = random.Random(20)
    points = []
    for i in range(400):
        r, a = 20 + rng.uniform(-2e-3, 2e-3), 2 * math.pi * i / 400
        points.append((r * math.cos(a), r * math.sin(a)))
    return points + points[:1]


def spline():
    """A clamped uniform cubic B-spline of ten random control points."""
    rng = random.Random(7)
    net = [(rng.uniform(0, 100), rng.uniform(0, 60)) for _ in range(10)]
    knots = [0.0] * 4 + [float(i) for i in range(1, 7)] + [7.0] * 4

    def at(u):
        k = min(max(bisect.bisect_right(knots, u) - 1, 3), len(net) - 1)
        d = [net[k - 3 + j] for j in range(4)]
        for level in range(1, 4):
            for j in range(3, level - 1, -1):
                low, high = knots[k - 3 + j], knots[k + 1 + j - level]
                a = (u - low) / (high - low)
                d[j] = tuple((1 - a) * p + a * q for p, q in zip(d[j - 1], d[j]))
        return d[3]

    return [at(7 * i / 2999) for i in range(3000)]


def arc_points(cx, cy, r, a0, a1, chord):
    n = max(1, round(r * abs(a1 - a0) / chord))
    return [(cx + r * math.cos(a0 + (a1 - a0) * i / n), cy + r * math.sin(a0 + (a1 - a0) * i / n)) for i in range(n + 1)]


def rounded_rectangle():
    """80 x 50, corners of radius 8 in chords of 0.05 mm, each side one block; it starts in the middle of a side."""
    w, h, r, q = 80.0, 50.0, 8.0, math.pi / 2
    points = [(w / 2, 0.0)]
    for cx, cy, a in ((w - r, r, -q), (w - r, h - r, 0.0), (r, h - r, q), (r, r, 2 * q)):
        points += arc_points(cx, cy, r, a, a + q, 0.05)
    return points + [(w / 2, 0.0)]


def corners():
    """Arcs in chords, corners, a line and an arc that are run back over, teeth, cusps. What is straight is one block."""
    pi = math.pi
    points = [(0.0, 0.0), (10.0, 0.0), (6.0, 0.0), (10.0, 0.0)]  # back over 4 mm, and forth again
    points += arc_points(10, 5, 5, -pi / 2, 0, 0.05)
    points += arc_points(10, 5, 5, 0, -pi / 6, 0.05) + arc_points(10, 5, 5, -pi / 6, 0, 0.05)  # back over a third of the arc
    points += [(15.0, 10.0)]
    for tooth in range(8):
        points += [(14.5 - tooth, 12.0), (14.0 - tooth, 10.0)]
    for cusp in range(4):  # half circles that meet in cusps
        points += arc_points(5.5 - 3 * cusp, 10, 1.5, 0, pi, 0.03)
    return points


def inputs():
    shapes = [
        ("sine", "sine, 1,000 points", sine()),
        ("spiral", "spiral, 2,000 points", spiral(5, 20, 3, 2000)),
        ("noisy-circle", "circle with noise, 400 points", noisy_circle()),
        ("spline", "spline, 3,000 points", spline()),
        ("rectangle", "rounded rectangle", rounded_rectangle()),
        ("long-spiral", "spiral, 10,000 points", spiral(5, 50, 8, 10000)),
        ("corners", "corners and reversals", corners()),
    ]
    made = []
    for key, title, points in shapes:
        # The polyline of the program: rounded vertices, without neighbours that rounding made equal.
        rounded = []
        for x, y in points:
            p = (round(x, DECIMALS) + 0.0, round(y, DECIMALS) + 0.0)
            if not rounded or rounded[-1] != p:
                rounded.append(p)
        made.append((key, title, rounded))
    return made


def program(polyline, extruding=False):
    (x, y), rest = polyline[0], polyline[1:]
    lines = ["G21", "G90", "G17", "G94"] + (["M83"] if extruding else [])
    lines.append(f"G0 X{x:.{DECIMALS}f} Y{y:.{DECIMALS}f} Z0.{'0' * DECIMALS}")
    for i, (u, v) in enumerate(rest):
        e = f" E{0.05 * math.dist((x, y), (u, v)):.6f}" if extruding else ""
        f = f" F{FEED}" if i == 0 else ""
        lines.append(f"G1 X{u:.{DECIMALS}f} Y{v:.{DECIMALS}f}{e}{f}")
        x, y = u, v
    return "\n".join(lines + ["M2", ""])


# ------------------------------------------------------------------------------------------------------------- evaluator

# G codes that move nothing: dwell, plane xy, compensations off, coordinates, path modes, no cycle, centres of arcs from the start, units
# of feed and speed.
UNMOVED = (4, 17, 40, 43, 49, 54, 61, 64, 80, 91.1, 94, 97)
WORD = re.compile(r"([A-Z])\s*([+-]?(?:\d+\.?\d*|\.\d+))")


def read_program(text):
    """The feed moves in xy of a program: ("line", start, end) and ("arc", start, end, centre, clockwise).

    G20, G21, G90, G91 and I J from the start are understood; any other word that could move is an error.
    """
    moves, motion, unit, relative = [], 0, 1.0, False
    position = [0.0, 0.0]
    for number, raw in enumerate(text.splitlines(), 1):
        block = re.sub(r"\([^)]*\)", "", raw.split(";")[0]).strip().upper()
        if not block or block == "%" or block[0] == "O":
            continue
        words = WORD.findall(block)
        values = {}
        for letter, value in words:
            if letter != "G":
                values[letter] = float(value)
                continue
            code = float(value)
            if code in (0, 1, 2, 3):
                motion = int(code)
            elif code in (20, 21):
                unit = 25.4 if code == 20 else 1.0
            elif code in (90, 91):
                relative = code == 91
            elif code not in UNMOVED:
                raise ValueError(f"line {number}: {raw}: not understood")
        if not {"X", "Y"} & values.keys() and not (motion > 1 and {"I", "J"} & values.keys()):
            continue
        target = [
            position[axis] * relative + values[letter] * unit if letter in values else position[axis] for axis, letter in enumerate("XY")
        ]
        start, end = tuple(position), tuple(target)
        if motion == 1 and start != end:
            moves.append(("line", start, end))
        elif motion > 1:
            if "R" in values:
                raise ValueError(f"line {number}: {raw}: arcs by R are not understood")
            centre = (start[0] + values.get("I", 0.0) * unit, start[1] + values.get("J", 0.0) * unit)
            moves.append(("arc", start, end, centre, motion == 2))
        position = target
    return moves


def sweep(move):
    """Radii at start and end, angle at the start, signed angle."""
    _, start, end, centre, clockwise = move
    a0 = math.atan2(start[1] - centre[1], start[0] - centre[0])
    a1 = math.atan2(end[1] - centre[1], end[0] - centre[0])
    turn = a1 - a0
    if clockwise:
        turn = turn if turn < 0 else turn - 2 * math.pi
    else:
        turn = turn if turn > 0 else turn + 2 * math.pi
    return math.dist(start, centre), math.dist(end, centre), a0, turn


def chords(moves):
    """The path as chords within SAGITTA_MM of it. An arc whose radii differ is the spiral that controls make of it."""
    path = [moves[0][1]]
    for move in moves:
        if move[0] == "arc":
            r0, r1, a0, turn = sweep(move)
            cx, cy = move[3]
            step = 2 * math.sqrt(2 * SAGITTA_MM / max(r0, r1))
            n = max(2, math.ceil(abs(turn) / step))
            for i in range(1, n):
                r, a = r0 + (r1 - r0) * i / n, a0 + turn * i / n
                path.append((cx + r * math.cos(a), cy + r * math.sin(a)))
        path.append(move[2])
    return path


class Segments:
    """Nearest segment of a polyline, by a grid."""

    def __init__(self, path, cell):
        self.path, self.cell, self.grid = path, cell, {}
        for i in range(len(path) - 1):
            (ax, ay), (bx, by) = path[i], path[i + 1]
            n = max(1, math.ceil(2 * math.dist(path[i], path[i + 1]) / cell))
            for k in range(n + 1):
                key = (math.floor((ax + (bx - ax) * k / n) / cell), math.floor((ay + (by - ay) * k / n) / cell))
                held = self.grid.setdefault(key, [])
                if not held or held[-1] != i:
                    held.append(i)

    def distance(self, i, p):
        (ax, ay), (bx, by) = self.path[i], self.path[i + 1]
        ux, uy, vx, vy = bx - ax, by - ay, p[0] - ax, p[1] - ay
        square = ux * ux + uy * uy
        t = 0.0 if square == 0.0 else min(1.0, max(0.0, (ux * vx + uy * vy) / square))
        return math.hypot(vx - t * ux, vy - t * uy)

    def nearest(self, p, near=None):
        """(distance, segment); `near` is a segment to begin with."""
        best, at = (math.inf, None) if near is None else (self.distance(near, p), near)
        kx, ky = math.floor(p[0] / self.cell), math.floor(p[1] / self.cell)
        ring = 0
        while True:
            for x in range(kx - ring, kx + ring + 1):
                inner = abs(x - kx) != ring
                for y in (ky - ring, ky + ring) if inner and ring else range(ky - ring, ky + ring + 1):
                    for i in self.grid.get((x, y), ()):
                        d = self.distance(i, p)
                        if d < best:
                            best, at = d, i
            # A segment is listed in cells at most half a cell beside it, so a segment not seen yet is at least this far away.
            if best <= max(0.0, ring - 0.5) * self.cell:
                return best, at
            # The nearest segment found is nearer than any segment of the next ring, by the place of the point in its cell.
            room = min(p[0] - (kx - ring) * self.cell, (kx + ring + 1) * self.cell - p[0])
            room = min(room, p[1] - (ky - ring) * self.cell, (ky + ring + 1) * self.cell - p[1])
            if best <= room - 0.25 * self.cell:
                return best, at
            ring += 1


def one_sided(path, target):
    """The largest distance of a point of the polyline `path` from `target`, at most GAP_MM too small.

    The distance from one segment, a convex set, is convex along a piece: between the ends it is no larger than at the ends.
    """
    near, ends, largest = None, [], 0.0
    for p in path:
        d, near = target.nearest(p, near)
        ends.append(near)
        largest = max(largest, d)
    work = [(path[i], path[i + 1], ends[i], ends[i + 1]) for i in range(len(path) - 1)]
    while work:
        a, b, i, j = work.pop()
        if min(max(target.distance(k, a), target.distance(k, b)) for k in {i, j}) <= largest + GAP_MM:
            continue
        middle = ((a[0] + b[0]) / 2, (a[1] + b[1]) / 2)
        if middle == a or middle == b:
            continue
        d, k = target.nearest(middle, i)
        largest = max(largest, d)
        if max(target.distance(k, a), target.distance(k, b)) <= largest + GAP_MM:
            continue
        work += [(a, middle, i, k), (middle, b, k, j)]
    return largest


def length(path):
    return sum(math.dist(path[i], path[i + 1]) for i in range(len(path) - 1))


def cell_of(path):
    return max(0.05, 2 * statistics.median(math.dist(path[i], path[i + 1]) for i in range(len(path) - 1)))


def evaluate(text, polyline):
    moves = read_program(text)
    if not moves:
        raise ValueError("a program without feed moves in xy")
    arcs = [move for move in moves if move[0] == "arc"]
    gaps = sum(1 for a, b in zip(moves, moves[1:]) if a[2] != b[1])
    path = chords(moves)
    radii = [sweep(move)[:2] for move in arcs]
    there = one_sided(path, Segments(polyline, cell_of(polyline)))
    back = one_sided(polyline, Segments(path, cell_of(path)))
    return {
        "arcs": len(arcs),
        "lines": len(moves) - len(arcs),
        "deviation": max(there, back),
        "out_to_in": there,
        "in_to_out": back,
        "mismatch": max((abs(a - b) for a, b in radii), default=0.0),
        "largest_radius": max((max(r) for r in radii), default=0.0),
        "length": length(path) - length(polyline),
        "ends": max(math.dist(path[0], polyline[0]), math.dist(path[-1], polyline[-1])),
        "gaps": gaps,
    }


def self_test():
    def near(a, b):
        assert abs(a - b) < 4e-6, (a, b)

    square = [(0.0, 0.0), (10.0, 0.0), (10.0, 10.0)]
    near(evaluate("G0 X0 Y0\nG1 X10 Y10", square)["deviation"], math.sqrt(50))
    near(evaluate("G0 X0 Y0\nG1 X10\nY10", square)["deviation"], 0)
    near(evaluate("G0 X0 Y0\nG1 X10\nY7", square)["in_to_out"], 3)
    half = evaluate("G0 X0 Y0\nG3 X10 I5 J0\nG1 Y10", square)  # the half circle below the first side
    near(half["out_to_in"], 5)
    assert (half["arcs"], half["lines"]) == (1, 1)
    near(half["length"], 5 * math.pi - 10)
    r = 20.0  # a chord of two degrees dips by the sagitta
    ring = [(r * math.cos(math.radians(2 * i)), r * math.sin(math.radians(2 * i))) for i in range(46)]
    quarter = evaluate(f"G0 X{r} Y0\nG3 X{ring[-1][0]:.9f} Y{ring[-1][1]:.9f} I-{r} J0", ring)
    near(quarter["deviation"], r * (1 - math.cos(math.radians(1))))
    circle = [(r * math.cos(math.radians(i)), r * math.sin(math.radians(i))) for i in range(361)]
    near(evaluate(f"G0 X{r} Y0\nG2 X{r} Y0 I-{r} J0", circle)["deviation"], r * (1 - math.cos(math.radians(0.5))))
    near(evaluate("G0 X0 Y0\nG3 X10.002 Y0 I5 J0", [(0.0, 0.0), (10.0, 0.0)])["mismatch"], 0.002)
    # The grid against the plain search.
    rng = random.Random(1)
    path = [(rng.uniform(0, 9), rng.uniform(0, 9)) for _ in range(60)]
    for cell in (0.05, 0.4, 3.0):
        grid = Segments(path, cell)
        for _ in range(200):
            p = (rng.uniform(-2, 11), rng.uniform(-2, 11))
            assert grid.nearest(p)[0] == min(grid.distance(i, p) for i in range(59)), (cell, p)


# -------------------------------------------------------------------------------------------------------------- programs


class ArcWelder:
    def __init__(self, binary, folder, settings):
        self.binary, self.folder, self.settings = binary, folder, settings
        found = subprocess.run([binary, "--version"], capture_output=True, text=True, check=False).stdout
        self.version = (re.search(r"version:\s*(\S+)", found) or [None, "unknown"])[1]
        self.idle = statistics.median(self.timed([binary, "--version"])[0] for _ in range(9))

    @staticmethod
    def timed(command):
        begun = time.perf_counter()
        code = subprocess.run(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, check=False).returncode
        return time.perf_counter() - begun, code

    def run(self, polyline, tolerance, runs):
        s = self.settings
        source, target = os.path.join(self.folder, "in.gcode"), os.path.join(self.folder, "out.gcode")
        with open(source, "w", encoding="ascii") as file:
            file.write(program(polyline, extruding=s.peer_extruding))
        command = [self.binary, source, target, f"-r={2 * tolerance:.10g}", f"-t={s.peer_path_tolerance:g}", "-m=9999"]
        command += [f"-x={s.peer_decimals}", "-e=6", "-v=0", "-p=NONE", "-l=ERROR"] + ([] if s.peer_extruding else ["-y"])
        times = []
        for _ in range(runs):
            if os.path.exists(target):
                os.remove(target)
            wall, code = self.timed(command)
            if code != 0:
                raise RuntimeError(f"{' '.join(command)}: exit {code}")
            times.append(wall)
        with open(target, encoding="utf-8") as file:
            took = statistics.median(times)
            return file.read(), took, max(0.0, took - self.idle)


class Service:
    def __init__(self, base):
        parts = urllib.parse.urlsplit(base)
        self.connection = http.client.HTTPConnection(parts.hostname, parts.port or 80, timeout=600)
        self.prefix = parts.path.rstrip("/")

    def post(self, query, body, kind):
        path = f"{self.prefix}/v1/arcs/fit?{urllib.parse.urlencode(query)}"
        begun = time.perf_counter()
        self.connection.request("POST", path, body, {"Content-Type": kind, "Accept": "text/x-gcode"})
        answer = self.connection.getresponse()
        text = answer.read().decode()
        wall = time.perf_counter() - begun
        if answer.status != 200:
            raise RuntimeError(f"{path}: {answer.status} {' '.join(text[:300].split())}")
        if answer.getheader("Content-Type", "").startswith("application/json"):
            text = json.loads(text)["nc"]
        compute = re.search(r"compute[^,]*?dur=([\d.]+)", answer.getheader("Server-Timing", ""))
        return text, wall, float(compute[1]) / 1e3 if compute else None

    def run(self, polyline, tolerance, method, bare, runs):
        query = {"dialect": "linuxcnc", "method": method}
        if bare:
            kind = "application/json"
            body = json.dumps({"polyline": polyline, "tolerance_mm": tolerance, "measure": "polyline"})
        else:
            kind = "text/x-gcode"
            query["tolerance_mm"] = f"{tolerance:g}"
            body = program(polyline)
        # The service may have closed the idle connection while the last answers were judged; the first request opens a new one.
        self.connection.close()
        answers = [self.post(query, body, kind) for _ in range(runs)]
        computes = [compute for _, _, compute in answers if compute is not None]
        return answers[-1][0], statistics.median(wall for _, wall, _ in answers), statistics.median(computes) if computes else None


# ----------------------------------------------------------------------------------------------------------------- table


def milliseconds(seconds):
    return f"{seconds * 1e3:,.1f}" if seconds < 0.1 else f"{seconds * 1e3:,.0f}"


def wide(figures, names):
    """A row for each input and tolerance."""
    yield "| input | blocks | tolerance |" + "".join(f" {name} | deviation | time, ms |" for name in names)
    yield "|---|--:|--:|" + "--:|--:|--:|" * len(names)
    rows = {}
    for f in figures:
        rows.setdefault((f["title"], f["blocks"], f["tolerance"]), {})[f["program"]] = f
    for (title, blocks, tolerance), row in rows.items():
        cells = []
        for f in (row.get(name) for name in names):
            cells.append(f" {f['arcs'] + f['lines']:,} ({f['arcs']:,}) | {deviation(f)} | {took(f)} |" if f else " | | |")
        yield f"| {title} | {blocks:,} | {tolerance:g} |" + "".join(cells)


def deviation(f):
    exceeded = "**" if f["deviation"] > f["tolerance"] + 5e-6 else ""
    return f"{exceeded}{f['deviation']:.5f}{exceeded}"


def took(f):
    return milliseconds(f["seconds"]) + (f" ({milliseconds(f['net_seconds'])})" if f["net_seconds"] is not None else "")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--arcwelder", metavar="PATH", help="its console program")
    parser.add_argument("--service", metavar="URL", default="http://127.0.0.1:8080", help="base URL of toolpathd")
    parser.add_argument("--peer-only", action="store_true", help="ArcWelder alone")
    parser.add_argument("--service-only", action="store_true", help="toolpathd alone")
    parser.add_argument("--methods", default="optimal,greedy", help="of the service")
    parser.add_argument("--bare", action="store_true", help="also post the polyline as JSON")
    parser.add_argument("--runs", type=int, default=7, help="of each, for the median")
    parser.add_argument("--tolerances", default="0.01,0.002,0.0006", help="in mm")
    parser.add_argument("--inputs", help="only these, by key, with commas")
    parser.add_argument("--peer-extruding", action="store_true", help="give ArcWelder E words rather than its option for travel arcs")
    parser.add_argument("--peer-path-tolerance", type=float, default=0.25)
    parser.add_argument("--peer-decimals", type=int, default=DECIMALS, help="ArcWelder's decimals, 3 to 6")
    parser.add_argument("--keep", metavar="FOLDER", help="leave inputs and outputs there")
    parser.add_argument("--wide", action="store_true", help="a row for each input and tolerance, as in docs/comparison.md")
    parser.add_argument("--json", metavar="FILE", help="the figures, unrounded")
    given = parser.parse_args()

    self_test()
    shapes = inputs()
    if given.inputs:
        wanted = given.inputs.split(",")
        unknown = set(wanted) - {key for key, _, _ in shapes}
        if unknown:
            parser.error(f"no such inputs: {', '.join(sorted(unknown))}")
        shapes = [shape for shape in shapes if shape[0] in wanted]
    if given.keep:
        os.makedirs(given.keep, exist_ok=True)

    figures = []
    progress = sys.stderr if given.wide else sys.stdout
    with tempfile.TemporaryDirectory() as folder:
        programs = []
        if not given.service_only:
            if not given.arcwelder:
                parser.error("--arcwelder PATH is needed")
            peer = ArcWelder(given.arcwelder, folder, given)
            print(f"ArcWelder {peer.version}; its process that does nothing takes {milliseconds(peer.idle)} ms.\n", file=sys.stderr)
            programs.append(("ArcWelder", lambda line, tolerance: peer.run(line, tolerance, given.runs)))
        if not given.peer_only:
            service = Service(given.service)
            for method in given.methods.split(","):
                for bare in (False, True) if given.bare else (False,):
                    programs.append(
                        (
                            f"toolpathd {method}{', JSON' if bare else ''}",
                            lambda line, tolerance, method=method, bare=bare: service.run(line, tolerance, method, bare, given.runs),
                        )
                    )

        print(
            "| input | blocks | tolerance | program | arcs | lines | together | deviation | radius mismatch | length | time, ms |",
            file=progress,
        )
        print("|---|--:|--:|---|--:|--:|--:|--:|--:|--:|--:|", file=progress)
        for key, title, polyline in shapes:
            if given.keep:
                with open(os.path.join(given.keep, f"{key}.ngc"), "w", encoding="ascii") as file:
                    file.write(program(polyline))
            for tolerance in (float(word) for word in given.tolerances.split(",")):
                if key == "noisy-circle" and tolerance < 0.002:
                    continue  # less than the noise
                for name, run in programs:
                    try:
                        text, seconds, net = run(polyline, tolerance)
                    except (RuntimeError, OSError, http.client.HTTPException) as error:
                        print(f"{key} {tolerance:g} {name}: {error}", file=sys.stderr)
                        continue
                    if given.keep:
                        kept = f"{key}-{tolerance:g}-{name.replace(', ', '-').replace(' ', '-')}.ngc"
                        with open(os.path.join(given.keep, kept), "w", encoding="utf-8") as file:
                            file.write(text)
                    try:
                        f = evaluate(text, polyline)
                    except ValueError as error:
                        print(f"{key} {tolerance:g} {name}: {error}", file=sys.stderr)
                        continue
                    f |= {"input": key, "title": title, "blocks": len(polyline) - 1, "tolerance": tolerance, "program": name}
                    f |= {"seconds": seconds, "net_seconds": net}
                    figures.append(f)
                    print(
                        f"| {title} | {f['blocks']:,} | {tolerance:g} | {name} | {f['arcs']:,} "
                        f"| {f['lines']:,} | {f['arcs'] + f['lines']:,} | {deviation(f)} "
                        f"| {f['mismatch']:.4f} | {f['length']:+.3f} | {took(f)} |",
                        file=progress,
                        flush=True,
                    )
                    if f["gaps"] or f["ends"] > tolerance:
                        print(f"{key} {tolerance:g} {name}: {f['gaps']} gaps, ends off by {f['ends']:.4f}", file=sys.stderr)
    if given.wide:
        print("\n".join(wide(figures, [name for name, _ in programs])))
    if given.json:
        with open(given.json, "w", encoding="ascii") as file:
            json.dump(figures, file, indent=1)


if __name__ == "__main__":
    main()
