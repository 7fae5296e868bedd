#!/usr/bin/env python3
"""Pockets side by side: toolpathd's /v1/pockets/plan, FreeCAD's Path workbench and the crate BREP_cam.

    compare.py [--service http://127.0.0.1:8080] [--only circle,comb] [--programs toolpathd,freecad,brep] ...

All get the examples of openapi/examples/pockets-plan with one level: wall, islands, cutter, stepover and feed; `slot_feed_mm_per_min` is
left out. Each path is read as G-code and judged here, by code that none of the three uses. The rule for times is one for all:

* rapids at 10,000 mm/min; feed moves at the example's feed, slower where they would come down faster than half of the feed;
* heights above 2 mm count as 2 mm; the time begins above the first descent and ends above the last cut.

FreeCAD needs `freecadcmd`, BREP_cam needs cargo. NumPy, Shapely and Numba are installed into --venv when this Python lacks them.
"""

import argparse
import glob
import http.client
import json
import math
import os
import re
import statistics
import subprocess
import sys
import tempfile
import time
import urllib.parse

NEEDED = ("numpy", "shapely", "numba")
HERE = os.path.dirname(os.path.abspath(__file__))
EXAMPLES = os.path.join(HERE, "..", "..", "..", "openapi", "examples", "pockets-plan")
RAPID, ABOVE = 10_000.0, 2.0
# Of a path that passes; FreeCAD's own tolerance of Adaptive is 0.1 mm.
UNCUT_MAX, GOUGE_MAX, RAPID_ANGLE_MAX = 0.05, 0.05, 5.0
# Material thinner than this is not counted as cut, so that a pass along a finished wall has no angle.
SKIN = 1e-3


def installed(folder):
    """Runs this script again in a virtual environment that has what it needs."""
    python = os.path.join(folder, "bin", "python")
    if not os.path.exists(python):
        subprocess.run([sys.executable, "-m", "venv", folder], check=True)
    if subprocess.run([python, "-c", f"import {', '.join(NEEDED)}"], capture_output=True, check=False).returncode != 0:
        subprocess.run([python, "-m", "pip", "install", "--quiet", "--disable-pip-version-check", *NEEDED], check=True)
    os.execv(python, [python, os.path.abspath(__file__), *sys.argv[1:]])


try:
    import numpy as np
    import shapely
    from numba import njit
except ImportError:
    if any(word in sys.argv for word in ("-h", "--help")):
        np = shapely = None
        njit = lambda function: function
    else:
        given = [word.split("=", 1)[1] for word in sys.argv if word.startswith("--venv=")]
        given += [after for word, after in zip(sys.argv, sys.argv[1:]) if word == "--venv"]
        installed(os.path.abspath(given[0] if given else "peers-venv"))


# ---------------------------------------------------------------------------------------------------------------- inputs


class Pocket:
    def __init__(self, path):
        self.name = os.path.splitext(os.path.basename(path))[0]
        with open(path, encoding="utf-8") as file:
            body = json.load(file)
        self.floor = -float(body["stepdown_max_mm"])
        body["floor_z_mm"] = self.floor
        body["cutting"].pop("slot_feed_mm_per_min", None)
        self.body = body
        self.radius = body["tool"]["diameter_mm"] / 2
        self.stepover, self.feed = float(body["stepover_mm"]), float(body["cutting"]["feed_mm_per_min"])
        region = body["region"]
        self.outlines = [[(*vertex, 0.0)[:3] for vertex in outline] for outline in (region["boundary"], *region.get("islands", []))]
        wall, *islands = (shapely.Polygon(chords(outline, 1e-5)) for outline in self.outlines)
        self.shape = wall.difference(shapely.union_all(islands)) if islands else wall
        assert self.shape.is_valid, self.name
        self.reach = self.shape.buffer(-self.radius, quad_segs=256).buffer(self.radius, quad_segs=256)

    def straight_angle(self):
        return math.degrees(math.acos(1 - self.stepover / self.radius))


def arc_of(start, end, bulge):
    """Centre, radius, angle at the start and angle turned."""
    (x, y), (u, v) = start, end
    k = (1 - bulge * bulge) / (4 * bulge)
    centre = ((x + u) / 2 - k * (v - y), (y + v) / 2 + k * (u - x))
    return centre, math.dist(centre, start), math.atan2(y - centre[1], x - centre[0]), 4 * math.atan(bulge)


def along(centre, radius, begin, turn, error):
    """Points of an arc after its start, chords off by at most `error`."""
    count = max(1, math.ceil(abs(turn) / (2 * math.acos(max(0.0, 1 - error / radius)))))
    return [(centre[0] + radius * math.cos(begin + turn * k / count), centre[1] + radius * math.sin(begin + turn * k / count))
            for k in range(1, count + 1)]


def chords(outline, error):
    points = []
    for (x, y, bulge), (u, v, _) in zip(outline, outline[1:] + outline[:1]):
        points.append((x, y))
        if bulge:
            points += along(*arc_of((x, y), (u, v), bulge), error)[:-1]
    return points


def part_of(pocket):
    """Triangles of the part: the floor, the walls, and the top around the pocket and on its islands."""
    outer = shapely.Polygon(chords(pocket.outlines[0], 5e-4))
    islands = [shapely.Polygon(chords(outline, 5e-4)) for outline in pocket.outlines[1:]]
    cut = outer.difference(shapely.union_all(islands)) if islands else outer
    x0, y0, x1, y1 = cut.bounds
    top = shapely.box(x0 - 20, y0 - 20, x1 + 20, y1 + 20).difference(cut)
    flat = lambda shape, z: [[c for x, y in list(t.exterior.coords)[:3] for c in (x, y, z)]
                             for t in shapely.constrained_delaunay_triangles(shape).geoms]
    triangles = flat(cut, pocket.floor) + flat(top, 0.0)
    for polygon in getattr(cut, "geoms", [cut]):
        for ring in (polygon.exterior, *polygon.interiors):
            for (x, y), (u, v) in zip(ring.coords, ring.coords[1:]):
                triangles += [[x, y, pocket.floor, u, v, pocket.floor, u, v, 0.0], [x, y, pocket.floor, u, v, 0.0, x, y, 0.0]]
    return triangles


def edges_of(outline):
    edges = []
    for (x, y, bulge), (u, v, _) in zip(outline, outline[1:] + outline[:1]):
        if not bulge:
            edges.append([x, y, u, v])
            continue
        (cx, cy), radius, begin, turn = arc_of((x, y), (u, v), bulge)
        parts = math.ceil(abs(turn) / 1.6)
        stops = [(cx + radius * math.cos(begin + turn * k / parts), cy + radius * math.sin(begin + turn * k / parts)) for k in range(1, parts)]
        stops = [(x, y), *stops, (u, v)]
        edges += [[*a, *b, cx, cy, 1.0 if turn > 0 else -1.0] for a, b in zip(stops, stops[1:])]
    return edges


# -------------------------------------------------------------------------------------------------------------- programs


class Failed(Exception):
    pass


class Toolpathd:
    name = "toolpathd"
    operations = {"its choice": None, "engagement": ["engagement"]}

    def __init__(self, options):
        self.options = options
        self.parts = urllib.parse.urlsplit(options.service)

    def plan(self, pocket, patterns):
        body = dict(pocket.body, **({"patterns": patterns} if patterns else {}))
        seconds = []
        for _ in range(self.options.runs):
            connection = http.client.HTTPConnection(self.parts.hostname, self.parts.port or 80, timeout=self.options.timeout)
            begun = time.perf_counter()
            connection.request("POST", self.parts.path.rstrip("/") + "/v1/pockets/plan?nc=true&toolpath=false", json.dumps(body),
                               {"Content-Type": "application/json", "Accept": "application/json"})
            answer = connection.getresponse()
            text = answer.read()
            wall = time.perf_counter() - begun
            connection.close()
            if answer.status != 200:
                raise Failed(f"{answer.status} {' '.join(text[:200].decode().split())}")
            compute = re.search(r"compute[^,]*?dur=([\d.]+)", answer.getheader("Server-Timing", ""))
            seconds.append(float(compute[1]) / 1e3 if compute else wall)
        answer = json.loads(text)
        level = answer["report"]["levels"][0]
        chosen = next(c for c in level["candidates"] if c["pattern"] == level["chosen"])
        claims = {"pattern": level["chosen"], "time_s": chosen["time_s"], "lifts": chosen["n_retracts"],
                  "uncut_area_mm2": chosen["uncut_area_mm2"], "gouge_mm": answer["report"]["gouge_max_mm"],
                  "angle": chosen["engagement_max_deg"], "exceptions": chosen.get("engagement_exceptions")}
        return answer["nc"], statistics.median(seconds), level["chosen"], claims


class FreeCad:
    name = "FreeCAD"
    operations = {
        "Offset": {"operation": "Offset"},
        "Offset, tool kept down": {"operation": "Offset", "keep_down": True},
        "ZigZag": {"operation": "ZigZag"},
        "ZigZagOffset": {"operation": "ZigZagOffset"},
        "Line": {"operation": "Line"},
        "Adaptive": {"operation": "Adaptive"},
        "Adaptive, finer": {"operation": "Adaptive", "adaptive_tolerance": 0.01},
    }

    def __init__(self, options):
        self.options = options

    def plan(self, pocket, settings):
        given = {"radius": pocket.radius, "stepover": pocket.stepover, "floor": pocket.floor, "feed": pocket.feed, "keep_down": False,
                 "tolerance": 0.001, "adaptive_tolerance": 0.1, "outlines": pocket.outlines, **settings}
        with tempfile.TemporaryDirectory() as folder:
            names = {"POCKET_IN": os.path.join(folder, "in.json"), "POCKET_OUT": os.path.join(folder, "out.nc")}
            with open(names["POCKET_IN"], "w", encoding="ascii") as file:
                json.dump(given, file)
            seconds = []
            for _ in range(self.options.runs):
                text, said = run([self.options.freecad, os.path.join(HERE, "freecad_path.py")], "", self.options.timeout,
                                 dict(os.environ, QT_QPA_PLATFORM="offscreen", **names))
                if not os.path.exists(names["POCKET_OUT"]):
                    raise Failed(([line for line in (text + said).splitlines() if "Error" in line] or ["no path"])[-1][:160])
                with open(names["POCKET_OUT"], encoding="ascii") as file:
                    program = file.read()
                seconds.append(float(re.search(r"SECONDS ([\d.e-]+)", program)[1]))
        return program, statistics.median(seconds), "", None


class BrepCam:
    name = "BREP_cam"
    operations = {
        "pocket": {"operation": "pocket", "helix": 0.9},
        "pocket, plunges": {"operation": "pocket", "helix": 0.0},
        "adaptive": {"operation": "adaptive", "helix": 0.9},
    }

    def __init__(self, options):
        self.options = options
        manifest = os.path.join(HERE, "brep_cam", "Cargo.toml")
        command = ["cargo", "build", "--release", "--quiet", "--manifest-path", manifest, "--target-dir", options.brep_target]
        subprocess.run(command, check=True)
        self.program = os.path.join(options.brep_target, "release", "pocket-paths-of-brep-cam")

    def plan(self, pocket, settings):
        given = {"radius": pocket.radius, "stepover": pocket.stepover, "floor": pocket.floor, "feed": pocket.feed, "tolerance": 0.001,
                 "keep_down": 1000.0, "triangles": part_of(pocket), "loops": [edges_of(outline) for outline in loops_of(pocket)],
                 **settings, "helix": settings["helix"] * 2 * pocket.radius}
        seconds = []
        for _ in range(self.options.runs):
            program, said = run([self.program], json.dumps(given), self.options.timeout, None)
            found = re.search(r"SECONDS ([\d.e-]+)", program)
            if not found:
                raise Failed((said.strip() or "no path").splitlines()[-1][:160])
            seconds.append(float(found[1]))
        return program, statistics.median(seconds), "", None


def loops_of(pocket):
    """Outlines that do not cross: where islands overlap each other or the wall, of what remains."""
    wall, *islands = (shapely.Polygon(chords(outline, 1e-5)) for outline in pocket.outlines)
    apart = all(wall.contains_properly(a) for a in islands) and len(islands) < 50
    apart = apart and not any(a.intersects(b) for k, a in enumerate(islands) for b in islands[:k])
    if apart or len(islands) >= 50:
        return pocket.outlines
    polygons = getattr(pocket.shape, "geoms", [pocket.shape])
    return [[(x, y, 0.0) for x, y in list(ring.coords)[:-1]] for polygon in polygons for ring in (polygon.exterior, *polygon.interiors)]


def run(command, text, timeout, environment):
    try:
        done = subprocess.run(command, input=text, capture_output=True, text=True, timeout=timeout, env=environment, check=False)
    except subprocess.TimeoutExpired as late:
        raise Failed(f"no path after {timeout} s") from late
    if done.returncode < 0:
        raise Failed(f"crashed with signal {-done.returncode}")
    return done.stdout, done.stderr


# -------------------------------------------------------------------------------------------------------------- the path


def read(program, error):
    """Moves of G0 to G3 in the plane XY: (rapid, points). Heights above ABOVE count as ABOVE."""
    at, word, moves = [None, None, None], None, []
    for line in program.splitlines():
        line = re.sub(r"\(.*?\)|;.*", "", line).upper()
        words = re.findall(r"([A-Z])\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:E[-+]?\d+)?)", line)
        codes = [float(value) for letter, value in words if letter == "G"]
        if any(code in (28.0, 30.0, 53.0) for code in codes):
            continue
        word = next((int(code) for code in codes if code in (0.0, 1.0, 2.0, 3.0)), word)
        values = {letter: float(value) for letter, value in words}
        if not any(letter in values for letter in "XYZIJ") or word is None:
            continue
        to = [values.get(letter, old) for letter, old in zip("XYZ", at)]
        if to[2] is not None:
            to[2] = min(to[2], ABOVE)
        if None not in at:
            (x, y, z), (u, v, w) = at, to
            if word < 2:
                points = [(x, y, z), (u, v, w)]
            else:
                centre = (x + values.get("I", 0.0), y + values.get("J", 0.0))
                begin, end = math.atan2(y - centre[1], x - centre[0]), math.atan2(v - centre[1], u - centre[0])
                turn = (end - begin) % math.tau if word == 3 else -((begin - end) % math.tau)
                if math.dist((x, y), (u, v)) < 1e-9 or abs(turn) < 1e-9:
                    turn = math.copysign(math.tau, 1 if word == 3 else -1)
                flat = along(centre, math.dist(centre, (x, y)), begin, turn, error)
                flat[-1] = (u, v)
                points = [(x, y, z)] + [(px, py, z + (w - z) * k / len(flat)) for k, (px, py) in enumerate(flat, 1)]
            moves.append((word == 0, points))
        at = to
    low = [k for k, (_, points) in enumerate(moves) if min(p[2] for p in points) < 0]
    if not low:
        raise Failed("the path cuts nothing")
    first = low[0]
    while first and moves[first - 1][1][0][:2] == moves[first][1][0][:2]:
        first -= 1
    moves = moves[first:low[-1] + 1]
    x, y, z = moves[-1][1][-1]
    if z < ABOVE:
        moves.append((True, [(x, y, z), (x, y, ABOVE)]))
    return moves


def seconds_of(moves, feed):
    total = 0.0
    for rapid, points in moves:
        for a, b in zip(points, points[1:]):
            length = math.dist(a, b)
            total += 60 * (length / RAPID if rapid else max(length / feed, (a[2] - b[2]) / (feed / 2)))
    return total


def lifts_of(moves):
    """How often the tool goes up between the first and the last cut."""
    count, rising = 0, False
    for _, points in moves:
        for a, b in zip(points, points[1:]):
            if b[2] > a[2] + 0.01:
                count += not rising
                rising = True
            elif b[2] < a[2] - 0.01 or math.dist(a[:2], b[:2]) > 0:
                rising = rising and b[2] > a[2] - 1e-9 and math.dist(a[:2], b[:2]) == 0
    return count - 1


# ------------------------------------------------------------------------------------------------------------- the judge


def uncut_of(moves, pocket):
    """Share of the reachable area that no move at the floor sweeps, in percent."""
    runs, run_now = [], []
    for rapid, points in moves:
        for a, b in zip(points, points[1:]):
            if max(a[2], b[2]) > pocket.floor + 0.002:
                continue
            if not run_now or run_now[-1] != a[:2] or len(run_now) > 60:
                run_now = [a[:2]]
                runs.append(run_now)
            run_now.append(b[:2])
    lines = [shapely.LineString(line) for line in runs]
    if not lines:
        return 100.0
    swept = shapely.union_all(shapely.buffer(lines, pocket.radius, quad_segs=96))
    return 100 * pocket.reach.difference(swept).area / pocket.reach.area


def below_top(moves, spacing):
    """Points of all moves below the top, at most `spacing` apart."""
    pieces = []
    for _, points in moves:
        for a, b in zip(points, points[1:]):
            if min(a[2], b[2]) < -1e-6:
                count = max(1, math.ceil(math.dist(a, b) / spacing))
                t = np.linspace(0, 1, count + 1)[:, None]
                line = np.array(a) * (1 - t) + np.array(b) * t
                pieces.append(line[line[:, 2] < -1e-6, :2])
    return np.concatenate(pieces)


def clearance(points, pocket):
    """Distance to the nearest wall, negative outside the pocket."""
    edge = pocket.shape.boundary
    shapely.prepare(edge)
    shapely.prepare(pocket.shape)
    far = shapely.distance(shapely.points(points), edge)
    return np.where(shapely.contains_xy(pocket.shape, points[:, 0], points[:, 1]), far, -far)


@njit
def inside(x, y, ring):
    odd = False
    for k in range(ring.shape[0]):
        if (ring[k, 1] > y) != (ring[k, 3] > y):
            if x < ring[k, 0] + (y - ring[k, 1]) * (ring[k, 2] - ring[k, 0]) / (ring[k, 3] - ring[k, 1]):
                odd = not odd
    return odd


@njit
def distance2(x, y, s):
    dx, dy = s[2] - s[0], s[3] - s[1]
    t = ((x - s[0]) * dx + (y - s[1]) * dy) / max(dx * dx + dy * dy, 1e-30)
    t = min(1.0, max(0.0, t))
    ex, ey = x - s[0] - t * dx, y - s[1] - t * dy
    return ex * ex + ey * ey


@njit
def angles(samples, segments, ends, starts, cells, low, columns, rows, side, radius, skin, ring):
    """The angle at each sample `x, y, dx, dy, before, length, gouging, half turn`: what the front half of the cutter's circle has before it.

    Swept is what the segments with an index below `before` sweep; with `dx = dy = 0` the whole disc is asked, and the answer is a share.
    """
    found = np.zeros(samples.shape[0])
    stamp = np.full(segments.shape[0], -1)
    near = np.empty(segments.shape[0], np.int64)
    qx, qy = np.empty(1800), np.empty(1800)
    for i in range(samples.shape[0]):
        x, y, dx, dy, before, length, gouging = samples[i]
        count = 0
        c0, c1 = int((x - 2 * radius - 0.01 - low[0]) / side), int((x + 2 * radius + 0.01 - low[0]) / side)
        r0, r1 = int((y - 2 * radius - 0.01 - low[1]) / side), int((y + 2 * radius + 0.01 - low[1]) / side)
        for c in range(max(0, c0), min(columns - 1, c1) + 1):
            for r in range(max(0, r0), min(rows - 1, r1) + 1):
                for k in range(starts[c * rows + r], starts[c * rows + r + 1]):
                    s = cells[k]
                    if s >= before:
                        break
                    if stamp[s] != i:
                        stamp[s] = i
                        if distance2(x, y, segments[s]) < (2 * radius + 0.01) ** 2:
                            near[count] = s
                            count += 1
        points = 0
        if dx == 0 and dy == 0:
            for ring_radius in (0.2, 0.5, 0.8, 0.99):
                for k in range(90):
                    a = math.tau * k / 90
                    qx[points], qy[points] = x + radius * ring_radius * math.cos(a), y + radius * ring_radius * math.sin(a)
                    points += 1
        else:
            for k in range(360):
                a = (k + 0.5) / 360 * math.pi - math.pi / 2
                c, s_ = math.cos(a) * radius, math.sin(a) * radius
                qx[points], qy[points] = x + dx * c - dy * s_, y + dy * c + dx * s_
                points += 1
        # The newest segments first: they lie nearest.
        order = np.sort(near[:count])[::-1]
        standing = 0
        last = 0
        for k in range(points):
            hit = False
            for j in range(-1, count):
                s = last if j < 0 else order[j]
                if j < 0 and (count == 0 or last >= before):
                    continue
                reach = radius + (skin if length - ends[s] > 1.0 else -1e-9)
                if distance2(qx[k], qy[k], segments[s]) < reach * reach:
                    hit = True
                    last = s
                    break
            if not hit and gouging > 0 and not inside(qx[k], qy[k], ring):
                hit = True
            standing += not hit
        found[i] = standing / points
    return found


def engagement_of(moves, pocket, spacing):
    """The largest angle of feed moves in degrees with its place, of rapids, and the share of material below rapids straight down.

    What a descent sweeps counts as cut for the angle, and the descent itself is not asked.
    """
    segments, ends, samples, kinds, length = [], [], [], [], 0.0
    for rapid, points in moves:
        for a, b in zip(points, points[1:]):
            if min(a[2], b[2]) >= -1e-6:
                continue
            flat = math.dist(a[:2], b[:2])
            if b[2] < a[2] - 1e-9:
                if rapid and flat == 0:
                    samples.append((*b[:2], 0.0, 0.0, len(segments), length))
                    kinds.append(2)
            elif flat > 0:
                dx, dy = (b[0] - a[0]) / flat, (b[1] - a[1]) / flat
                count = max(1, math.ceil(flat / spacing))
                for k in range(count):
                    t = (k + 0.5) / count
                    samples.append((a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1]), dx, dy, len(segments), length + t * flat))
                    kinds.append(int(rapid))
            length += flat
            if b[2] <= a[2] + 1e-9:
                segments.append((*a[:2], *b[:2]))
                ends.append(length)
    segments, samples, kinds = np.array(segments), np.array(samples), np.array(kinds)
    # A sample of a dense curve stands for its neighbours: not more than `spacing` apart.
    keep = np.ones(len(samples), bool)
    last = -1.0
    for k in range(len(samples)):
        if kinds[k] == 0 and samples[k, 5] - last < 0.8 * spacing and samples[k, 5] >= last:
            keep[k] = False
        elif kinds[k] == 0:
            last = samples[k, 5]
    samples, kinds = samples[keep], kinds[keep]
    gouging = clearance(samples[:, :2], pocket) < pocket.radius - 2e-3
    samples = np.column_stack((samples, gouging.astype(float)))

    side = 2.0
    low = segments.reshape(-1, 2).min(0) - 1
    columns, rows = (int(n) + 2 for n in (segments.reshape(-1, 2).max(0) - low) / side)
    lists = [[] for _ in range(columns * rows)]
    for k, (x, y, u, v) in enumerate(segments.tolist()):
        steps = max(1, math.ceil(math.dist((x, y), (u, v)) / (0.4 * side)))
        seen = {(int((x + (u - x) * j / steps - low[0]) / side), int((y + (v - y) * j / steps - low[1]) / side)) for j in range(steps + 1)}
        for c, r in seen:
            lists[c * rows + r].append(k)
    starts = np.concatenate(([0], np.cumsum([len(one) for one in lists]))).astype(np.int64)
    cells = np.array([k for one in lists for k in one], np.int64)
    rings = [np.array(ring.coords) for p in getattr(pocket.shape, "geoms", [pocket.shape]) for ring in (p.exterior, *p.interiors)]
    ring = np.concatenate([np.column_stack((r[:-1], r[1:])) for r in rings])
    found = angles(samples, segments, np.array(ends), starts, cells, low, columns, rows, side, pocket.radius, SKIN, ring)
    worst = lambda kind: max(((float(found[k]), samples[k, :2].tolist()) for k in np.flatnonzero(kinds == kind)), default=(0.0, None))
    feed, rapid, down = worst(0), worst(1), worst(2)
    return {"angle": 180 * feed[0], "angle_at": feed[1], "rapid_angle": 180 * rapid[0], "rapid_at": rapid[1], "rapid_down": down[0],
            "over_mm": float(spacing * np.sum(180 * found[kinds == 0] > 1.1 * pocket.straight_angle() + 1))}


def judged(program, pocket, options):
    fine = read(program, 1e-4)
    points = below_top(fine, 0.05)
    gaps = clearance(points, pocket)
    at = int(np.argmin(gaps))
    result = {"time_s": seconds_of(fine, pocket.feed), "lifts": lifts_of(fine), "uncut": uncut_of(fine, pocket),
              "gouge": max(0.0, pocket.radius - float(gaps[at])), "gouge_at": points[at].tolist()}
    begun = time.perf_counter()
    if pocket.name in options.without_angle:
        result["angle"] = None
    else:
        result.update(engagement_of(read(program, 1e-3), pocket, options.spacing))
    result["judged_in_s"] = time.perf_counter() - begun
    wrong = []
    if result["uncut"] > UNCUT_MAX:
        wrong.append(f"{result['uncut']:.2f} % uncut")
    if result["gouge"] > GOUGE_MAX:
        wrong.append("cuts into the part")
    if result.get("rapid_angle", 0) > RAPID_ANGLE_MAX:
        wrong.append(f"rapid through material ({result['rapid_angle']:.0f}°)")
    if result.get("rapid_down", 0) > 0.01:
        wrong.append("rapid down into material")
    result["wrong"] = wrong
    return result


def self_test():
    """A circle and two straight passes, whose figures are known."""
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "slot.json")
        with open(path, "w", encoding="ascii") as file:
            json.dump({"region": {"boundary": [[0, 0], [100, 0], [100, 13], [0, 13]]}, "stepdown_max_mm": 5, "stepover_mm": 3,
                       "tool": {"diameter_mm": 10}, "cutting": {"feed_mm_per_min": 600}}, file)
        pocket = Pocket(path)
    program = "G0 X5 Y5 Z20\nG0 Z2\nG1 Z-5\nG1 X95\nG0 Z2\nG0 X5 Y8\nG1 Z-5\nG1 X95\nG0 Z20\n"
    moves = read(program, 1e-4)
    assert lifts_of(moves) == 1
    assert abs(seconds_of(moves, 600) - (2 * 9 + 2 * 1.4 + 60 * (14 + math.hypot(90, 3)) / RAPID)) < 1e-9
    assert abs(engagement_of(moves, pocket, 0.1)["angle"] - 180) < 1
    # The first pass as a ramp, which is not asked: the second has the angle of its stepover, a third over it none.
    beside = "G0 X5 Y5 Z2\nG1 Z-4.9\nG1 X95 Z-5\nG0 Z2\nG0 X5 Y8\nG1 Z-5\nG1 X60\n"
    assert abs(engagement_of(read(beside, 1e-4), pocket, 0.1)["angle"] - pocket.straight_angle()) < 0.6
    over = "G0 X5 Y5 Z2\nG1 Z-4.9\nG1 X95 Z-5\nG1 X5\n"
    assert engagement_of(read(over, 1e-4), pocket, 0.1)["angle"] == 0
    across = engagement_of(read(beside.replace("G0 Z2\nG0 X5 Y8\nG1 Z-5\nG1 X60", "G0 X5 Y8"), 1e-4), pocket, 0.1)
    assert across["rapid_angle"] > 60
    assert engagement_of(read(beside.replace("G1 Z-5", "G0 Z-5"), 1e-4), pocket, 0.1)["rapid_down"] > 0.1
    assert 0.01 < uncut_of(moves, pocket) < 0.1 and abs(clearance(np.array([(50.0, 4.9)]), pocket)[0] - 4.9) < 1e-12


# --------------------------------------------------------------------------------------------------------------- figures


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--service", metavar="URL", default="http://127.0.0.1:8080", help="base URL of toolpathd")
    parser.add_argument("--venv", metavar="FOLDER", default="peers-venv", help="virtual environment to make where modules are missing")
    parser.add_argument("--freecad", metavar="PROGRAM", default="freecadcmd", help="FreeCAD without windows")
    parser.add_argument("--brep-target", metavar="FOLDER", default="peers-target", help="where cargo builds the program that runs BREP_cam")
    parser.add_argument("--programs", default="toolpathd,freecad,brep", help="which, with commas")
    parser.add_argument("--only", default="", help="examples, with commas; all without")
    parser.add_argument("--skip", default="", help="operations, with semicolons, as `Adaptive, finer;Line`")
    parser.add_argument("--without-angle", default="", help="examples whose angle is not sampled, with commas")
    parser.add_argument("--spacing", type=float, default=0.1, help="of the places where the angle is asked, mm")
    parser.add_argument("--runs", type=int, default=1, help="of each, for the median of the planning time")
    parser.add_argument("--timeout", type=float, default=180.0, help="of each plan, s")
    parser.add_argument("--keep", metavar="FOLDER", help="every program as a file")
    parser.add_argument("--json", metavar="FILE", help="the figures, unrounded")
    options = parser.parse_args()
    options.without_angle = set(options.without_angle.split(","))

    self_test()
    kinds = {"toolpathd": Toolpathd, "freecad": FreeCad, "brep": BrepCam}
    programs = [kinds[name](options) for name in options.programs.split(",")]
    only = set(filter(None, options.only.split(",")))
    figures = []
    print("| example | program | time, s | lifts | uncut, % | gouge, mm | largest angle, ° | planning, s | remark |")
    print("|---|---|--:|--:|--:|--:|--:|--:|---|")
    for path in sorted(glob.glob(os.path.join(EXAMPLES, "*.json"))):
        if only and os.path.splitext(os.path.basename(path))[0] not in only:
            continue
        pocket = Pocket(path)
        for program in programs:
            for operation, settings in program.operations.items():
                if operation in options.skip.split(";"):
                    continue
                row = {"example": pocket.name, "program": program.name, "operation": operation, "straight_angle": pocket.straight_angle()}
                try:
                    text, row["planning_s"], said, row["claims"] = program.plan(pocket, settings)
                    if options.keep:
                        os.makedirs(options.keep, exist_ok=True)
                        name = f"{pocket.name}-{program.name}-{operation}.nc".replace(", ", "-").replace(" ", "-")
                        with open(os.path.join(options.keep, name), "w", encoding="utf-8") as file:
                            file.write(text)
                    row.update(judged(text, pocket, options))
                    angle = "not sampled" if row["angle"] is None else f"{row['angle']:.1f}"
                    remark = ", ".join([said] * bool(said) + row["wrong"])
                    print(f"| {pocket.name} | {program.name}, {operation} | {row['time_s']:.1f} | {row['lifts']} | {row['uncut']:.4f} "
                          f"| {row['gouge']:.4f} | {angle} | {row['planning_s']:.3f} | {remark} |", flush=True)
                except Failed as failed:
                    row["failed"] = str(failed)
                    print(f"| {pocket.name} | {program.name}, {operation} | - | - | - | - | - | - | failed: {failed} |", flush=True)
                figures.append(row)
                if options.json:
                    with open(options.json, "w", encoding="ascii") as file:
                        json.dump(figures, file, indent=1)


if __name__ == "__main__":
    main()
