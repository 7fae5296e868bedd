#!/usr/bin/env python3
"""Sections of an offset side by side: toolpathd's /v1/surfaces/mill and Open CASCADE.

    compare.py [--service http://127.0.0.1:8080] [--venv FOLDER] ...

The surface is z = 10 sin(pi x / 40) cos(pi y / 40) over 80 x 80 mm, interpolated through 9 x 9 points; nowhere is it as hollow as the ball of
10 mm is round, so the ball's centre runs on sections of the offset surface, whole. Open CASCADE makes these by GeomAPI_IntSS of a
Geom_OffsetSurface and planes, and by BRepAlgoAPI_Section of an offset face; the service mills with the same planes, and what it answers is a
path of arcs and lines within its tolerance. The judge knows the control nets: a point of the centre's path is off by its distance from the
surface less the radius. Start the service as `taskset -c 0 toolpathd --workers 1` to measure one thread.
NumPy and cadquery-ocp are installed into --venv when this Python lacks them.
"""

import argparse
import http.client
import importlib
import json
import math
import os
import re
import statistics
import subprocess
import sys
import time
import urllib.parse

NEEDED = {"numpy": "numpy", "OCP": "cadquery-ocp"}
SIDE_MM = 80.0
# The largest distance between neighbouring points of a path that are judged.
STEP_MM = 0.2


def installed(folder):
    """Runs this script again in a virtual environment that has what it needs."""
    python = os.path.join(folder, "bin", "python")
    if not os.path.exists(python):
        subprocess.run([sys.executable, "-m", "venv", folder], check=True)
    if subprocess.run([python, "-c", f"import {', '.join(NEEDED)}"], capture_output=True, check=False).returncode != 0:
        subprocess.run([python, "-m", "pip", "install", "--quiet", "--disable-pip-version-check", *NEEDED.values()], check=True)
    os.execv(python, [python, os.path.abspath(__file__), *sys.argv[1:]])


try:
    import numpy as np
    import OCP  # noqa: F401
except ImportError:
    if not any(word in sys.argv for word in ("-h", "--help")):
        given = [word.split("=", 1)[1] for word in sys.argv if word.startswith("--venv=")]
        given += [after for word, after in zip(sys.argv, sys.argv[1:]) if word == "--venv"]
        installed(os.path.abspath(given[0] if given else "peers-venv"))


def surface(n):
    node = [SIDE_MM * k / (n - 1) for k in range(n)]
    height = lambda x, y: 10 * math.sin(math.pi * x / 40) * math.cos(math.pi * y / 40)
    points = [[[x, y, height(x, y)] for y in node] for x in node]
    return {"kind": "point_grid", "points": points, "twist": "spline", "ends": "not_a_knot"}


# ----------------------------------------------------------------------------------------------------------------- judge


def bernstein(t, order=0):
    s = 1 - t
    if order == 0:
        return np.stack([s**3, 3 * s * s * t, 3 * s * t * t, t**3], -1)
    if order == 1:
        return np.stack([-3 * s * s, 3 * s * (s - 2 * t), 3 * t * (2 * s - t), 3 * t * t], -1)
    return np.stack([6 * s, 6 * (t - 2 * s), 6 * (s - 2 * t), 6 * t], -1)


class Judge:
    """Distances of points from the surface, which here is a graph with patches on a square grid."""

    def __init__(self, nets):
        self.nets, self.per_side = nets, len(nets)

    def at(self, u, v, du=0, dv=0):
        """Of the whole surface, parameters from 0 to 1."""
        u, v = u * self.per_side, v * self.per_side
        i, j = (np.clip(np.floor(w).astype(int), 0, self.per_side - 1) for w in (u, v))
        scale = self.per_side ** (du + dv)
        return scale * np.einsum("ka,kb,kabc->kc", bernstein(u - i, du), bernstein(v - j, dv), self.nets[i, j])

    def distance(self, points):
        """Newton's method for the nearest point, started below each point and at the foot that the normal there suggests."""
        best = np.full(len(points), np.inf)
        start = np.clip(points[:, :2] / SIDE_MM, 0, 1).T
        below = self.at(*start)
        normal = np.cross(self.at(*start, 1, 0), self.at(*start, 0, 1))
        normal /= np.linalg.norm(normal, axis=1)[:, None]
        lean = np.linalg.norm(points - below, axis=1) * normal[:, 2]  # as if the surface were a plane
        for to in (start, start - (lean[:, None] * normal[:, :2] / SIDE_MM).T):
            u, v = np.clip(to, 0, 1)
            for _ in range(15):
                s, su, sv = self.at(u, v), self.at(u, v, 1, 0), self.at(u, v, 0, 1)
                d = s - points
                dot = lambda p, q: (p * q).sum(1)
                slope = dot(d, su), dot(d, sv)
                free = [~((w <= 0) & (g > 0) | (w >= 1) & (g < 0)) for w, g in zip((u, v), slope)]
                g, h = slope[0] * free[0], slope[1] * free[1]
                gauss = dot(su, su), dot(su, sv) * (free[0] & free[1]), dot(sv, sv)
                full = (
                    gauss[0] + dot(d, self.at(u, v, 2, 0)),
                    gauss[1] + dot(d, self.at(u, v, 1, 1)) * (free[0] & free[1]),
                    gauss[2] + dot(d, self.at(u, v, 0, 2)),
                )
                is_convex = (full[0] > 0) & (full[0] * full[2] > full[1] ** 2)
                a, b, c = (np.where(is_convex, f, k) for f, k in zip(full, gauss))
                det = a * c - b * b
                u = np.clip(u + np.clip((b * h - c * g) / det, -0.1, 0.1), 0, 1)
                v = np.clip(v + np.clip((b * g - a * h) / det, -0.1, 0.1), 0, 1)
            best = np.minimum(best, np.linalg.norm(self.at(u, v) - points, axis=1))
        return best


def judged(judge, paths, radius):
    """Largest distance inside and outside the offset over dense points of the centre's paths, and their length."""
    points = np.concatenate(paths)
    off = np.concatenate([judge.distance(points[k : k + 20_000]) for k in range(0, len(points), 20_000)]) - radius
    length = sum(float(np.linalg.norm(np.diff(path, axis=0), axis=1).sum()) for path in paths)
    return max(0.0, -off.min()), max(0.0, off.max()), length


# -------------------------------------------------------------------------------------------------------------- programs


class OpenCascade:
    def __init__(self, nets, radius):
        from OCP.Geom import Geom_BSplineSurface, Geom_OffsetSurface
        from OCP.gp import gp_Pnt

        n = len(nets)
        poles = self.array("Array2_gp_Pnt", "TColgp", "TColgp_Array2OfPnt", 1, 3 * n + 1, 1, 3 * n + 1)
        for i in range(n):
            for j in range(n):
                for a in range(4):
                    for b in range(4):
                        poles.SetValue(3 * i + a + 1, 3 * j + b + 1, gp_Pnt(*nets[i, j, a, b].tolist()))
        knots = self.array("Array1_double", "TColStd", "TColStd_Array1OfReal", 1, n + 1)
        times = self.array("Array1_int", "TColStd", "TColStd_Array1OfInteger", 1, n + 1)
        for k in range(n + 1):
            knots.SetValue(k + 1, float(k))
            times.SetValue(k + 1, 4 if k in (0, n) else 3)
        self.surface = Geom_BSplineSurface(poles, knots, knots, times, times, 3, 3)
        # The patches are a spline that is twice differentiable: its knots are single.
        for k in range(2, n + 1):
            if not (self.surface.RemoveUKnot(k, 1, 1e-9) and self.surface.RemoveVKnot(k, 1, 1e-9)):
                raise ValueError("the patches do not join smoothly")
        self.radius = radius
        self.offset = Geom_OffsetSurface(self.surface, radius)

    @staticmethod
    def array(name, module, older, *bounds):
        """Makes an array; version 8 renamed the array types."""
        try:
            return getattr(importlib.import_module("OCP.collections"), name)(*bounds)
        except (ImportError, AttributeError):
            return getattr(importlib.import_module(f"OCP.{module}"), older)(*bounds)

    def intersections(self, heights, tolerance):
        """Curves of the offset surface in planes of constant y, by GeomAPI_IntSS."""
        from OCP.Geom import Geom_Plane
        from OCP.GeomAPI import GeomAPI_IntSS
        from OCP.gp import gp_Dir, gp_Pnt

        curves, lost = [], 0
        for y in heights:
            found = GeomAPI_IntSS(self.offset, Geom_Plane(gp_Pnt(0, y, 0), gp_Dir(0, 1, 0)), tolerance)
            lost += not found.IsDone() or found.NbLines() == 0
            curves += [found.Line(k) for k in range(1, found.NbLines() + 1)] if found.IsDone() else []
        return curves, lost

    def sections(self, heights):
        """The same by BRepAlgoAPI_Section of a face that BRepOffsetAPI_MakeOffsetShape made."""
        from OCP.BRep import BRep_Tool
        from OCP.BRepAlgoAPI import BRepAlgoAPI_Section
        from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeFace
        from OCP.BRepOffsetAPI import BRepOffsetAPI_MakeOffsetShape
        from OCP.Geom import Geom_TrimmedCurve
        from OCP.gp import gp_Dir, gp_Pln, gp_Pnt
        from OCP.TopAbs import TopAbs_EDGE
        from OCP.TopExp import TopExp_Explorer
        from OCP.TopoDS import TopoDS

        maker = BRepOffsetAPI_MakeOffsetShape()
        maker.PerformBySimple(BRepBuilderAPI_MakeFace(self.surface, 1e-6).Face(), self.radius)
        shape = maker.Shape()
        curves, lost = [], 0
        for y in heights:
            section = BRepAlgoAPI_Section(shape, gp_Pln(gp_Pnt(0, y, 0), gp_Dir(0, 1, 0)), False)
            section.Approximation(True)
            section.Build()
            explorer = TopExp_Explorer(section.Shape(), TopAbs_EDGE)
            found = []
            while explorer.More():
                edge = explorer.Current()
                edge = getattr(TopoDS, "Edge_s", getattr(TopoDS, "Edge", None))(edge)
                curve = getattr(BRep_Tool, "Curve_s", getattr(BRep_Tool, "Curve", None))(edge, 0.0, 1.0)
                from_to = getattr(BRep_Tool, "Range_s", None)
                if from_to is not None:
                    first, last = from_to(edge) if self.returns_range(from_to, edge) else (curve.FirstParameter(), curve.LastParameter())
                    curve = Geom_TrimmedCurve(curve, first, last)
                found.append(curve)
                explorer.Next()
            lost += not found
            curves += found
        return curves, lost

    @staticmethod
    def returns_range(from_to, edge):
        try:
            return isinstance(from_to(edge), tuple)
        except TypeError:
            return False

    @staticmethod
    def points(curve):
        from OCP.GeomAdaptor import GeomAdaptor_Curve

        adaptor = GeomAdaptor_Curve(curve)
        first, last = adaptor.FirstParameter(), adaptor.LastParameter()
        coarse = np.array([[getattr(adaptor.Value(t), axis)() for axis in "XYZ"] for t in np.linspace(first, last, 101)])
        n = max(101, math.ceil(2 * np.linalg.norm(np.diff(coarse, axis=0), axis=1).sum() / STEP_MM))
        return np.array([[getattr(adaptor.Value(t), axis)() for axis in "XYZ"] for t in np.linspace(first, last, n).tolist()])


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
        return json.loads(content), wall, float(compute[1]) / 1e3 if compute else wall

    def mill(self, shape, radius, stepover, tolerance, engine):
        body = {
            "surface": shape,
            "tool": {"shape": "ball", "diameter_mm": 2 * radius},
            "strategy": {"kind": "cl_cartesian", "plane": "zx", "stepover_mm": stepover, "direction": "one_way"},
            "tolerance_mm": tolerance,
            "cutting": {"feed_mm_per_min": 1000},
            "program": {"decimals": 6},
        }
        if engine:
            body["engine"] = engine
        return self.post("/v1/surfaces/mill", body)


def cuts(toolpath):
    """The cut moves: (start, move)."""
    at = toolpath["start"]
    for one in toolpath["passes"]:
        for move in one["moves"]:
            if move["kind"] == "dwell":
                continue
            if move["kind"] != "rapid" and move["role"] == "cut":
                yield np.array(at), move
            at = move["to"]


def points_of(start, move):
    end = np.array(move["to"])
    if move["kind"] == "line":
        n = max(2, math.ceil(np.linalg.norm(end - start) / STEP_MM) + 1)
        return start + (end - start) * np.linspace(0, 1, n)[:, None]
    if move["kind"] != "arc" or move["plane"] != "zx":
        raise ValueError(f"{move['kind']} in {move.get('plane')} is not understood")
    c = np.array(move["center"])
    a, b = (np.arctan2(p[0] - c[0], p[2] - c[2]) for p in (start, end))  # seen from +y, z to the right
    turn = b - a
    if move["direction"] == "cw":
        turn -= 2 * math.pi * (turn > -1e-12)
    else:
        turn += 2 * math.pi * (turn < 1e-12)
    ra, rb = (math.hypot(p[0] - c[0], p[2] - c[2]) for p in (start, end))
    s = np.linspace(0, 1, max(3, math.ceil(abs(turn) * max(ra, rb) / STEP_MM) + 1))
    r, angle = ra + (rb - ra) * s, a + turn * s
    return np.column_stack([c[0] + r * np.sin(angle), start[1] + (end[1] - start[1]) * s, c[2] + r * np.cos(angle)])


# ----------------------------------------------------------------------------------------------------------------- table


def self_test(judge, nets):
    """Checks the judge: points at a known distance from the surface, and from the corner of the control net."""
    inner = judge.at(np.array([0.31, 0.77]), np.array([0.42, 0.13]))
    su, sv = (judge.at(np.array([0.31, 0.77]), np.array([0.42, 0.13]), *k) for k in ((1, 0), (0, 1)))
    normal = np.cross(su, sv)
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    assert abs(judge.distance(inner + 5 * normal) - 5).max() < 1e-10
    assert abs(judge.distance(nets[0, 0, 0, 0][None] - [3.0, 4.0, 0.0]) - 5).max() < 0.2
    arc = {"kind": "arc", "to": [0.0, 0.0, 1.0], "center": [0.0, 0.0, 0.0], "plane": "zx", "direction": "cw"}
    found = points_of(np.array([1.0, 0.0, 0.0]), arc)  # a quarter from +x to +z, clockwise seen from +y
    assert abs(np.linalg.norm(np.diff(found, axis=0), axis=1).sum() - math.pi / 2) < 1e-2


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--service", metavar="URL", default="http://127.0.0.1:8080", help="base URL of toolpathd")
    parser.add_argument("--venv", metavar="FOLDER", default="peers-venv", help="virtual environment to make where modules are missing")
    parser.add_argument("--planes", type=int, default=100, help="without the first and last")
    parser.add_argument("--radius", type=float, default=5.0, help="of the ball, mm")
    parser.add_argument("--grid", type=int, default=9, help="points of the grid along a side")
    parser.add_argument("--tolerances", default="0.01,0.001", help="of the service, mm, with commas")
    parser.add_argument("--peer-tolerances", default="1e-4,1e-7", help="of GeomAPI_IntSS, mm, with commas")
    parser.add_argument("--engines", default="offset_section,contact", help="of the service, with commas")
    parser.add_argument("--runs", type=int, default=5, help="rounds, in turn, for the medians")
    parser.add_argument("--json", metavar="FILE", help="the figures, unrounded")
    options = parser.parse_args()

    service = Service(options.service)
    shape = surface(options.grid)
    nets = np.array(service.post("/v1/surfaces/model", {"surface": shape})[0]["report"]["patches"])
    judge = Judge(nets)
    self_test(judge, nets)
    # The planes are those of the service. The outermost planes only touch the offset, and are left out for all.
    radius = options.radius
    engines = options.engines.split(",")
    stepover, heights = SIDE_MM / (options.planes + 1), []
    for _ in range(4):
        answer, _, _ = service.mill(shape, radius, stepover, 0.01, engines[0])
        heights = sorted({round(float(start[1]), 9) for start, _ in cuts(answer["toolpath"])})
        if len(heights) == options.planes + 2:
            break
        # The outermost planes may lie a little inside the ends.
        stepover = (heights[-1] - heights[0] + 0.05) / (options.planes + 1)
    inner = heights[1:-1]
    print(f"{len(inner)} planes from y = {inner[0]:.4f} to {inner[-1]:.4f}", file=sys.stderr)

    peer = OpenCascade(nets, radius)
    programs = {}
    for tolerance in options.peer_tolerances.split(","):
        programs[f"Open CASCADE GeomAPI_IntSS, {tolerance}"] = lambda tolerance=tolerance: peer.intersections(inner, float(tolerance))
    programs["Open CASCADE BRepAlgoAPI_Section"] = lambda: peer.sections(inner)
    for engine in engines:
        for tolerance in options.tolerances.split(","):
            programs[f"toolpathd {engine}, {tolerance}"] = lambda engine=engine, tolerance=tolerance: service.mill(
                shape, radius, stepover, float(tolerance), engine
            )

    walls, computes, results = {}, {}, {}
    for _ in range(options.runs):
        for name, run in list(programs.items()):
            begun = time.perf_counter()
            try:
                results[name] = run()
            except RuntimeError as error:
                print(f"{name}: {error}", file=sys.stderr)
                del programs[name]
                continue
            walls.setdefault(name, []).append(time.perf_counter() - begun)
            if name.startswith("toolpathd"):
                computes.setdefault(name, []).append(results[name][2])

    print("| program | planes | curves or moves | time, ms | of it compute | inside the offset, mm | outside, mm | length, mm | lost |")
    print("|---|--:|--:|--:|--:|--:|--:|--:|--:|")
    figures = []
    for name in programs:
        if name.startswith("toolpathd"):
            moves = list(cuts(results[name][0]["toolpath"]))
            found = sorted({round(float(start[1]), 6) for start, _ in moves})
            paths = [points_of(*m) + [0, 0, radius] for m in moves if found[0] + 1e-5 < m[0][1] < found[-1] - 1e-5]
            planes = len(found) - 2
            lost = len(inner) - planes
        else:
            curves, lost = results[name]
            paths = [peer.points(curve) for curve in curves]
            planes = len(inner)
        inside, outside, length = judged(judge, paths, radius)
        wall = statistics.median(walls[name])
        compute = statistics.median(computes[name]) if name in computes else None
        cell = f"{compute * 1e3:,.0f}" if compute is not None else ""
        print(f"| {name} | {planes} | {len(paths):,} | {wall * 1e3:,.0f} | {cell} | {inside:.2e} | {outside:.2e} | {length:,.3f} | {lost} |")
        figures.append({"program": name, "planes": planes, "pieces": len(paths), "wall_s": walls[name], "compute_s": computes.get(name),
                        "inside": inside, "outside": outside, "length": length, "lost": lost})
    if options.json:
        with open(options.json, "w", encoding="ascii") as file:
            json.dump(figures, file, indent=1)


if __name__ == "__main__":
    main()
