#!/usr/bin/env python3
"""Dropped cutters side by side: toolpathd's /v1/surfaces/drop and OpenCAMLib's BatchDropCutter and PathDropCutter.

    compare.py [--service http://127.0.0.1:8080] [--venv FOLDER] ...

Both get the same surface: z = 10 sin(pi x / 40) cos(pi y / 40) over 80 x 80 mm, interpolated through 9 x 9 points. The patches come from
the service's /v1/surfaces/model; OpenCAMLib gets triangles whose corners lie on them. The judge of both is `Reference`, which knows the
control nets and shares no code with either. Start the service as `taskset -c 0 toolpathd --workers 1` to measure one
thread; OpenCAMLib is told to take one. NumPy and OpenCAMLib are installed into --venv when this Python lacks them.
"""

import argparse
import http.client
import json
import math
import os
import platform
import re
import statistics
import subprocess
import sys
import time
import urllib.parse

NEEDED = ("numpy", "opencamlib")
SIDE_MM = 80.0
GOLDEN = (math.sqrt(5) - 1) / 2


def installed(folder):
    """Runs this script again in a virtual environment that has what it needs."""
    python = os.path.join(folder, "bin", "python")
    if not os.path.exists(python):
        subprocess.run([sys.executable, "-m", "venv", folder], check=True)
    if subprocess.run([python, "-c", f"import {', '.join(NEEDED)}"], capture_output=True, check=False).returncode != 0:
        subprocess.run([python, "-m", "pip", "install", "--quiet", "--disable-pip-version-check", *NEEDED], check=True)
    os.execv(python, [python, os.path.abspath(__file__), *sys.argv[1:]])


os.environ.setdefault("OMP_NUM_THREADS", "1")
try:
    import numpy as np
    import opencamlib as ocl
except ImportError:
    if any(word in sys.argv for word in ("-h", "--help")):
        np = ocl = None
    else:
        given = [word.split("=", 1)[1] for word in sys.argv if word.startswith("--venv=")]
        given += [after for word, after in zip(sys.argv, sys.argv[1:]) if word == "--venv"]
        installed(os.path.abspath(given[0] if given else "peers-venv"))


# ---------------------------------------------------------------------------------------------------------------- inputs


def surface(n):
    node = [SIDE_MM * k / (n - 1) for k in range(n)]
    height = lambda x, y: 10 * math.sin(math.pi * x / 40) * math.cos(math.pi * y / 40)
    points = [[[x, y, height(x, y)] for y in node] for x in node]
    return {"kind": "point_grid", "points": points, "twist": "spline", "ends": "not_a_knot"}


def random_points(n, margin):
    rng = np.random.default_rng(20)
    return rng.uniform(-margin, SIDE_MM + margin, (n, 2))


def line_points(n, margin):
    """Points equally spaced along 50 lines from edge to edge, like passes, a little askew to miss the seams of the patches."""
    lines, per_line = 50, max(2, n // 50)
    at = np.linspace(-margin, SIDE_MM + margin, per_line)
    across = np.linspace(0.37, SIDE_MM - 0.41, lines)
    return np.concatenate([np.column_stack([at, np.full(per_line, y) + 1e-3 * at]) for y in across])


# -------------------------------------------------------------------------------------------------------------- surfaces


def bernstein(t, order=0):
    """The cubic Bernstein polynomials, or their derivatives, at an array of parameters."""
    s = 1 - t
    if order == 0:
        return np.stack([s**3, 3 * s * s * t, 3 * s * t * t, t**3], -1)
    if order == 1:
        return np.stack([-3 * s * s, 3 * s * (s - 2 * t), 3 * t * (2 * s - t), 3 * t * t], -1)
    return np.stack([6 * s, 6 * (t - 2 * s), 6 * (s - 2 * t), 6 * t], -1)


def on_patches(nets, i, u, v, du=0, dv=0):
    """Points or derivatives of patch i[k] at (u[k], v[k])."""
    return np.einsum("ka,kb,kabc->kc", bernstein(u, du), bernstein(v, dv), nets[i])


def samples(nets, per_side):
    t = np.linspace(0, 1, per_side)
    return np.einsum("ia,jb,nabc->nijc", bernstein(t), bernstein(t), nets)


def triangles(nets, per_side):
    """2 per_side^2 triangles a patch, with corners on the surface."""
    found = []
    for grid in samples(nets, per_side + 1):
        p, q, r, s = grid[:-1, :-1], grid[1:, :-1], grid[:-1, 1:], grid[1:, 1:]
        found += [np.stack([p, q, s], 2).reshape(-1, 3, 3), np.stack([p, s, r], 2).reshape(-1, 3, 3)]
    return np.concatenate(found)


class Reference:
    """Tips of a ball cutter by the definition: the largest S_z - R + sqrt(R^2 - r^2) over the points S of the surface.

    A dense scan finds where the largest values are; Newton's method ends in the patches and a golden section on their boundaries.
    Every value belongs to a point of the surface that the cutter must clear: none is too high.
    """

    def __init__(self, nets, radius, per_side=41, starts=16):
        self.nets, self.radius, self.starts = nets, radius, starts
        grid = samples(nets, per_side)
        self.t = np.linspace(0, 1, per_side)
        self.index = np.stack(np.meshgrid(np.arange(len(nets)), self.t, self.t, indexing="ij"), -1).reshape(-1, 3)
        self.points = grid.reshape(-1, 3)
        self.blocks = self.index[:, 0] * 10_000 + (self.index[:, 1] * 9.999).astype(int) * 100 + (self.index[:, 2] * 9.999).astype(int)
        edges = np.concatenate([nets[:, 0], nets[:, -1], nets[:, :, 0], nets[:, :, -1]])
        self.edges = edges[np.unique(edges.reshape(len(edges), -1).round(9), axis=0, return_index=True)[1]]
        self.edge_t = np.linspace(0, 1, 2 * per_side - 1)
        self.edge_points = np.einsum("ta,eac->etc", bernstein(self.edge_t), self.edges)

    def height(self, found, tips):
        square = ((found[..., :2] - tips) ** 2).sum(-1)
        with np.errstate(invalid="ignore"):
            root = np.sqrt(self.radius**2 - square)
        return np.where(square <= self.radius**2, found[..., 2] - self.radius + root, -np.inf)

    def drop(self, tips):
        """Heights of the tips; -inf beside the surface."""
        return np.array([self.drop_one(tip) for tip in tips])

    def drop_one(self, tip):
        scan = self.height(self.points, tip)
        best = max(scan.max(), self.height(self.edge_points, tip).max())
        order = np.argsort(-scan)[: 40 * self.starts]
        order = order[np.isfinite(scan[order])]
        if len(order):
            _, first = np.unique(self.blocks[order], return_index=True)  # one start from each block of samples
            best = max(best, self.climb(order[np.sort(first)[: self.starts]], tip))
        return max(best, self.along_edges(tip))

    def climb(self, order, tip):
        i, u, v = self.index[order, 0].astype(int), self.index[order, 1].copy(), self.index[order, 2].copy()
        value = self.height(on_patches(self.nets, i, u, v), tip)
        live = np.ones(len(u), bool)
        for _ in range(60):
            at = on_patches(self.nets, i, u, v)
            d = at[:, :2] - tip
            depth = np.sqrt(np.maximum(self.radius**2 - (d * d).sum(1), 1e-18))
            first = [on_patches(self.nets, i, u, v, *k) for k in ((1, 0), (0, 1))]
            slope = [s[:, 2] - (d * s[:, :2]).sum(1) / depth for s in first]

            def bend(a, b, order_):
                s = on_patches(self.nets, i, u, v, *order_)
                da, db = (d * first[a][:, :2]).sum(1), (d * first[b][:, :2]).sum(1)
                plane = (first[a][:, :2] * first[b][:, :2]).sum(1) + (d * s[:, :2]).sum(1)
                return s[:, 2] - plane / depth - da * db / depth**3

            a, b, c = bend(0, 0, (2, 0)), bend(0, 1, (1, 1)), bend(1, 1, (0, 2))
            free = [~((w <= 0) & (g < 0) | (w >= 1) & (g > 0)) for w, g in zip((u, v), slope)]
            g, h, b = slope[0] * free[0], slope[1] * free[1], b * (free[0] & free[1])
            # Where the Hessian is not negative definite, it is made so.
            shift = np.maximum(0, (a + c) / 2 + np.hypot((a - c) / 2, b) + 1e-9 * (abs(a) + abs(c)) + 1e-12)
            a, c = a - 2 * shift, c - 2 * shift
            det = a * c - b * b
            du, dv = (-c * g + b * h) / det * free[0], (b * g - a * h) / det * free[1]
            scale, moved = np.ones(len(u)), np.zeros(len(u))
            waiting = live.copy()
            for _ in range(40):
                to_u, to_v = np.clip(u + scale * du, 0, 1), np.clip(v + scale * dv, 0, 1)
                there = self.height(on_patches(self.nets, i, to_u, to_v), tip)
                better = waiting & (there > value)
                moved = np.where(better, np.maximum(abs(to_u - u), abs(to_v - v)), moved)
                u, v, value = np.where(better, to_u, u), np.where(better, to_v, v), np.where(better, there, value)
                waiting &= ~better
                scale = np.where(waiting, scale / 2, scale)
                if not waiting.any():
                    break
            live &= moved > 1e-14
            if not live.any():
                break
        return value.max()

    def along_edges(self, tip):
        near = ((self.edge_points[..., :2] - tip) ** 2).sum(-1).min(1) < (self.radius + 1) ** 2
        edges = self.edges[near]
        if not len(edges):
            return -np.inf
        step = self.edge_t[1]
        at = lambda e, t: np.einsum("...a,...ac->...c", bernstein(t), edges[e])
        scan = self.height(self.edge_points[near], tip)
        e, k = np.unravel_index(np.argsort(-scan, axis=None)[:60], scan.shape)
        inside = lambda t: ((at(e, t)[:, :2] - tip) ** 2).sum(1) <= self.radius**2
        low, high = np.maximum(0, self.edge_t[k] - step), np.minimum(1, self.edge_t[k] + step)
        good = np.isfinite(scan[e, k])
        best = -np.inf
        ends = []
        for end in (low, high):  # not beyond the cutter
            near_t, far = self.edge_t[k].copy(), end.copy()
            is_in = inside(far)
            for _ in range(55):
                middle = (near_t + far) / 2
                hit = inside(middle)
                near_t, far = np.where(hit, middle, near_t), np.where(hit, far, middle)
            ends.append(np.where(is_in, end, near_t))
        low, high = ends
        for _ in range(70):
            p, q = high - GOLDEN * (high - low), low + GOLDEN * (high - low)
            left = self.height(at(e, p), tip) > self.height(at(e, q), tip)
            low, high = np.where(left, low, p), np.where(left, q, high)
        for t in (low, high, *ends):
            values = self.height(at(e, t), tip)[good]
            best = max(best, values.max(initial=-np.inf))
        return best


def self_test():
    """The reference on a sphere-like bowl and a plane with closed forms."""
    third = np.array([-20, -20 / 3, 20 / 3, 20])
    plane = np.array([[[[x, y, 0.5 * x - 0.25 * y] for y in third] for x in third]])
    rise = 5 * (math.sqrt(1 + 0.5**2 + 0.25**2) - 1)
    assert abs(Reference(plane, 5.0).drop([(1.3, -2.1)])[0] - (0.65 + 0.525 + rise)) < 1e-12
    square = np.array([400, -400 / 3, -400 / 3, 400])
    bowl = np.array([[[[x, y, 0.4 * (sx + sy)] for y, sy in zip(third, square)] for x, sx in zip(third, square)]])
    assert abs(Reference(bowl, 2.5).drop([(0.0, 0.0)])[0] - 0.625) < 1e-12
    beside = Reference(plane, 5.0).drop([(23.0, 1.0), (25.1, 1.0)])
    assert abs(beside[0] - (10 - 0.25 * 1 - 5 + 4)) < 0.2 and beside[1] == -math.inf, beside


# -------------------------------------------------------------------------------------------------------------- programs


class OpenCamLib:
    def __init__(self, corners, radius):
        self.mesh = ocl.STLSurf()
        for triangle in corners.tolist():
            self.mesh.addTriangle(ocl.Triangle(*(ocl.Point(*corner) for corner in triangle)))
        self.cutter = ocl.BallCutter(2 * radius, 100.0)
        self.lowest = float(corners[..., 2].min()) - 1.0

    def batch(self, points):
        """Heights (None beside the surface), seconds to drop, and seconds with building the tree and the points."""
        begun = time.perf_counter()
        drop = ocl.BatchDropCutter()
        drop.setThreads(1)
        drop.setSTL(self.mesh)
        drop.setCutter(self.cutter)
        for x, y in points.tolist():
            drop.appendPoint(ocl.CLPoint(x, y, self.lowest - 1e3))
        ready = time.perf_counter()
        drop.run()
        done = time.perf_counter()
        heights = [None if p.z <= self.lowest - 999 else p.z for p in drop.getCLPoints()]
        return heights, done - ready, time.perf_counter() - begun

    def path(self, points, per_line):
        """The same for points along lines, by PathDropCutter, which drops them one at a time."""
        begun = time.perf_counter()
        # The library keeps no reference to its arguments: the lines must live as long as the path.
        path, lines = ocl.Path(), []
        for from_ in range(0, len(points), per_line):
            (ax, ay), (bx, by) = points[from_], points[from_ + per_line - 1]
            lines.append(ocl.Line(ocl.Point(ax, ay, 0), ocl.Point(bx, by, 0)))
            path.append(lines[-1])
        drop = ocl.PathDropCutter()
        drop.setSTL(self.mesh)
        drop.setCutter(self.cutter)
        drop.setZ(self.lowest - 1e3)
        drop.setSampling(math.dist((ax, ay), (bx, by)) / (per_line - 1) * (1 + 1e-9))
        drop.setPath(path)
        ready = time.perf_counter()
        drop.run()
        done = time.perf_counter()
        found = drop.getCLPoints()
        return found, done - ready, time.perf_counter() - begun


class Service:
    def __init__(self, base):
        parts = urllib.parse.urlsplit(base)
        self.connection = http.client.HTTPConnection(parts.hostname, parts.port or 80, timeout=600)
        self.prefix = parts.path.rstrip("/")

    def post(self, path, body):
        text = json.dumps(body)
        for fresh in (False, True):
            try:
                begun = time.perf_counter()
                self.connection.request("POST", self.prefix + path, text, {"Content-Type": "application/json", "Accept": "application/json"})
                answer = self.connection.getresponse()
                content = answer.read()
                break
            except (http.client.HTTPException, ConnectionError):
                self.connection.close()  # idle while others ran
                if fresh:
                    raise
        wall = time.perf_counter() - begun
        if answer.status != 200:
            raise RuntimeError(f"{path}: {answer.status} {' '.join(content[:400].decode().split())}")
        compute = re.search(r"compute[^,]*?dur=([\d.]+)", answer.getheader("Server-Timing", ""))
        return json.loads(content), wall, float(compute[1]) / 1e3 if compute else None

    def drop(self, shape, radius, points):
        tool = {"shape": "ball", "diameter_mm": 2 * radius}
        answer, wall, compute = self.post("/v1/surfaces/drop", {"surface": shape, "tool": tool, "points": points.tolist()})
        tips = answer["report"]["tips"]
        return [None if tip is None else tip[2] for tip in tips], compute, wall


# --------------------------------------------------------------------------------------------------------------- figures


def errors(found, exact):
    """The largest error downward and upward, the median, and how many points touch where the reference is beside, or the reverse."""
    pairs = [(z, t) for z, t in zip(found, exact) if z is not None and math.isfinite(t)]
    other = sum((z is None) != (not math.isfinite(t)) for z, t in zip(found, exact))
    gaps = [z - t for z, t in pairs]
    return max(0.0, -min(gaps)), max(0.0, max(gaps)), statistics.median(abs(gap) for gap in gaps), other


def rate(count, seconds):
    return f"{count / seconds:,.0f}" if seconds else "-"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--service", metavar="URL", default="http://127.0.0.1:8080", help="base URL of toolpathd")
    parser.add_argument("--venv", metavar="FOLDER", default="peers-venv", help="virtual environment to make where modules are missing")
    parser.add_argument("--peer-only", action="store_true", help="OpenCAMLib alone (the patches still come from the service)")
    parser.add_argument("--points", type=int, default=20_000, help="of each kind")
    parser.add_argument("--judged", type=int, default=400, help="points of each kind held against the reference")
    parser.add_argument("--per-side", default="12", help="squares along a patch, with commas: 12 makes 18,432 triangles")
    parser.add_argument("--diameter", type=float, default=10.0, help="of the ball, mm")
    parser.add_argument("--grid", type=int, default=9, help="points of the grid along a side")
    parser.add_argument("--margin", type=float, default=3.0, help="how far beside the surface points lie, mm")
    parser.add_argument("--runs", type=int, default=7, help="rounds, in turn, for the medians")
    parser.add_argument("--json", metavar="FILE", help="the figures, unrounded")
    options = parser.parse_args()

    self_test()
    radius = options.diameter / 2
    service = Service(options.service)
    shape = surface(options.grid)
    model = service.post("/v1/surfaces/model", {"surface": shape})[0]["report"]
    nets = np.array([net for row in model["patches"] for net in row])
    reference = Reference(nets, radius)
    kinds = {"random": random_points(options.points, options.margin), "lines": line_points(options.points, options.margin)}
    judged = {}
    for kind, points in kinds.items():
        chosen = np.sort(np.random.default_rng(4).choice(len(points), min(options.judged, len(points)), replace=False))
        judged[kind] = (chosen, reference.drop(points[chosen]))
    print(f"OpenCAMLib {ocl.version()}, Python {platform.python_version()}, {len(nets)} patches", file=sys.stderr)

    peers = {}
    for per_side in (int(word) for word in options.per_side.split(",")):
        corners = triangles(nets, per_side)
        peers[len(corners)] = OpenCamLib(corners, radius)
    seconds, heights = {}, {}

    def note(key, z, run, whole):
        seconds.setdefault(key, []).append((run, whole))
        heights[key] = z

    for _ in range(options.runs):
        for kind, points in kinds.items():
            for count, peer in peers.items():
                note((f"OpenCAMLib batch, {count:,} triangles", kind), *peer.batch(points))
                if kind == "lines":
                    found, run, whole = peer.path(points, len(points) // 50)
                    note((f"OpenCAMLib path, {count:,} triangles", kind), found, run, whole)
            if not options.peer_only:
                z, compute, wall = service.drop(shape, radius, points)
                note(("toolpathd", kind), z, compute if compute is not None else wall, wall)

    print("| program | points | a second | with set-up or transfer | too low, mm | too high, mm | median, mm | beside otherwise |")
    print("|---|---|--:|--:|--:|--:|--:|--:|")
    figures = []
    for key in sorted(seconds):
        name, kind = key
        chosen, exact = judged[kind]
        run, whole = (statistics.median(column) for column in zip(*seconds[key]))
        z = heights[key]
        count = len(z)
        if name.startswith("OpenCAMLib path"):  # it spaces its points itself: the judge looks at where they are
            pick = np.sort(np.random.default_rng(5).choice(count, min(options.judged, count), replace=False))
            low = next(iter(peers.values())).lowest
            exact = reference.drop([(z[k].x, z[k].y) for k in pick])
            values = [None if z[k].z <= low - 999 else z[k].z for k in pick]
        else:
            values = [z[k] for k in chosen]
        low, high, median, other = errors(values, exact)
        print(f"| {name} | {count:,} {kind} | {rate(count, run)} | {rate(count, whole)} | {low:.2e} | {high:.2e} | {median:.2e} | {other} |")
        figures.append({"program": name, "kind": kind, "count": count, "run_s": [r for r, _ in seconds[key]],
                        "whole_s": [w for _, w in seconds[key]], "too_low": low, "too_high": high, "median": median, "other": other})
    if options.json:
        with open(options.json, "w", encoding="ascii") as file:
            json.dump(figures, file, indent=1)


if __name__ == "__main__":
    main()
