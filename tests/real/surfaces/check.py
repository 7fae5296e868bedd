"""Mills random surfaces over HTTP and judges every program by a dense computation of its own.

Surfaces: cones, funnels, domes, outline and bands closed on themselves, with seams and poles turned and shifted against the
passes, and open surfaces: planes, waves, V grooves, ridges. Every boundary and every cutter takes part.

For many points of a surface, from its formula, the script computes how deep the cutter enters there, and how far the point is
from everything that the cutter has swept. Tips of the cutter dropped onto the surface tell what the cutter can reach at all.

A row names a job and its figures. The script ends with exit code 1 if a job breaks a statement of its own report:
* deeper than `gouge_max_mm`,
* farther from what is swept than `scallop_max_mm`, where the cutter reaches, but for the very edge of the part and of what is reached,
* farther from everything the cutter reaches than `rest_max_mm`,
* an axis outside the outline with `boundary: inside`.

Usage: check.py ADDRESS [JOBS [SEED]]
"""

import json
import math
import random
import sys
import urllib.error
import urllib.request

import numpy
from scipy.spatial import cKDTree

# Distance of neighbouring samples of a path, as a share of the cutter's radius.
STEP_SHARE = 0.025
# What sampling may add to a distance, mm.
SAMPLING_MM = 2e-3
# A cutter beside the part reaches places at the very edge that no position over the part reaches. So near to the edge, mm, scallop
# is not told from rest. Nor is it so near to a place that is not reached: tips at a raster reach a little less, or seem to reach more.
EDGE_MM, BORDER_MM = 0.05, 0.35
# A point that the cutter misses by less than this when dropped anywhere counts as reached, mm.
REACHED_MM = 4e-3


def post(address, path, body):
    request = urllib.request.Request(f"http://{address}{path}", json.dumps(body).encode(), {"content-type": "application/json"})
    try:
        with urllib.request.urlopen(request, timeout=120) as answer:
            return answer.status, json.load(answer)
    except urllib.error.HTTPError as error:
        return error.code, json.load(error)


# ---- surfaces: a body and points from a formula of its own

SQUARE = math.sqrt(0.5)


def circle_of(radius, height, turn, x, y):
    """Nine control points of a circle, closed at the angle `turn`."""
    points = []
    for k in range(9):
        angle, far = turn + k * math.pi / 4, radius * (math.sqrt(2) if k % 2 else 1.0)
        points.append([x + far * math.cos(angle), y + far * math.sin(angle), height])
    return points


CIRCLE = {"degree_u": 2, "knots_u": [0, 0, 0, 1, 1, 2, 2, 3, 3, 4, 4, 4]}
AROUND = numpy.linspace(0, 2 * math.pi, 181)[:-1]


def turned(profile, weights, turn, x, y):
    """A NURBS surface from a profile (radius, height) of degree 1 or 2, turned about an upright axis."""
    rows = [circle_of(radius, height, turn, x, y) for radius, height in profile]
    degree = len(profile) - 1
    return {
        "kind": "nurbs", **CIRCLE, "degree_v": degree, "knots_v": [0] * (degree + 1) + [1] * (degree + 1),
        "control_points": [[row[k] for row in rows] for k in range(9)],
        "weights": [[weight * (SQUARE if k % 2 else 1.0) for weight in weights] for k in range(9)],
    }


def round_points(radii, heights, x, y):
    return numpy.array([
        [x + radius * math.cos(angle), y + radius * math.sin(angle), height]
        for radius, height in zip(radii, heights) for angle in AROUND
    ])


def cone(rng):
    out, inn, height = rng.uniform(14, 22), rng.uniform(5, 9), rng.uniform(-7, 7)
    turn, x, y = rng.choice([0, math.pi / 2, rng.uniform(0, 6.3)]), rng.choice([0, rng.uniform(-1, 1)]), rng.choice([0, rng.uniform(-1, 1)])
    share = numpy.linspace(0, 1, 30)
    outline = {"middle": (x, y), "out": out, "hole": inn}
    return turned([(out, 0), (inn, height)], [1, 1], turn, x, y), round_points(out + (inn - out) * share, height * share, x, y), outline


def dome(rng):
    radius, height = rng.uniform(8, 16), rng.uniform(3, 9)
    turn, x, y = rng.choice([0, math.pi / 2, rng.uniform(0, 6.3)]), rng.choice([0, rng.uniform(-1, 1)]), rng.choice([0, rng.uniform(-1, 1)])
    angle = numpy.linspace(0.15, 1, 30) * math.pi / 2
    low = radius * math.cos(angle[0])
    # A quarter of an ellipse by a rational parabola; the steep foot is left out by a smaller weight of the middle.
    share = numpy.linspace(0, 1, 30)
    weight = rng.uniform(0.4, 0.7)
    bottom, middle, top = (low, 0.0), (low * 0.98, height), (0.0, height)
    basis = [(1 - share) ** 2, 2 * share * (1 - share) * weight, share**2]
    total = sum(basis)
    radii = sum(b * p[0] for b, p in zip(basis, (bottom, middle, top))) / total
    heights = sum(b * p[1] for b, p in zip(basis, (bottom, middle, top))) / total
    return turned([bottom, middle, top], [1, weight, 1], turn, x, y), round_points(radii, heights, x, y), {"middle": (x, y), "out": low, "hole": 0}


def ring(rng):
    """A bead around a circle: two edges, a crest between them."""
    inn, out, height = rng.uniform(6, 8), rng.uniform(16, 22), rng.uniform(1, 5)
    turn, x, y = rng.choice([0, math.pi / 2, rng.uniform(0, 6.3)]), rng.choice([0, rng.uniform(-1, 1)]), rng.choice([0, rng.uniform(-1, 1)])
    share = numpy.linspace(0, 1, 40)
    basis = [(1 - share) ** 2, 2 * share * (1 - share), share**2]
    profile = [(out, 0.0), (0.5 * (inn + out), 2 * height), (inn, 0.0)]
    radii, heights = (sum(b * p[k] for b, p in zip(basis, profile)) for k in (0, 1))
    return turned(profile, [1, 1, 1], turn, x, y), round_points(radii, heights, x, y), {"middle": (x, y), "out": out, "hole": inn}


def plane(rng):
    a, b, width, depth = rng.uniform(-0.6, 0.6), rng.uniform(-0.6, 0.6), rng.uniform(20, 35), rng.uniform(20, 35)
    points = [[[x, y, a * x + b * y] for y in (0, depth)] for x in (0, width)]
    xs, ys = (g.ravel() for g in numpy.meshgrid(numpy.linspace(0, width, 70), numpy.linspace(0, depth, 70)))
    return {"kind": "point_grid", "points": points, "ends": "natural"}, numpy.stack([xs, ys, a * xs + b * ys], 1), {"box": (width, depth)}


def sweep(rng, heights):
    """A section of straight lines in xz, swept along y; closed form of the same lines."""
    depth = rng.uniform(16, 24)
    basic = " ".join(f"l({x},{z})" for x, z in heights)
    xs = numpy.unique(numpy.concatenate([numpy.linspace(heights[0][0], heights[-1][0], 120), [x for x, _ in heights]]))
    zs = numpy.interp(xs, [x for x, _ in heights], [z for _, z in heights])
    gx, gy = numpy.meshgrid(xs, numpy.linspace(0, depth, 40), indexing="ij")
    gz = numpy.repeat(zs[:, None], 40, 1)
    body = {"kind": "parallel_sweep", "basic": basic, "drive": f"l(0,0) l({depth},0)"}
    return body, numpy.stack([gx.ravel(), gy.ravel(), gz.ravel()], 1), {"box": (heights[-1][0], depth)}


def groove(rng):
    half = math.radians(rng.uniform(15, 60))
    deep = rng.uniform(4, 8)
    run = round(deep * math.tan(half), 3)
    return sweep(rng, [(0, deep), (run, 0.0), (2 * run, deep)])


def ridge(rng):
    rise = round(rng.uniform(2, 8), 3)
    return sweep(rng, [(0, 0), (10, rise), (20, 0)])


def wave(rng):
    """A wave that a bicubic surface of Bezier patches states exactly: z = a (x/l)(1-x/l) + b (y/m)(1-y/m)."""
    a, b, length, depth = rng.uniform(-12, 12), rng.uniform(-12, 12), rng.uniform(24, 36), rng.uniform(20, 30)

    def net(p):
        third = [0, p / 3, p / 3, 0]
        return third

    za, zb = net(a), net(b)
    patch = [[[length * i / 3, depth * j / 3, za[i] + zb[j]] for j in range(4)] for i in range(4)]
    s, t = (g.ravel() for g in numpy.meshgrid(numpy.linspace(0, 1, 70), numpy.linspace(0, 1, 70)))
    z = a * s * (1 - s) + b * t * (1 - t)
    return {"kind": "bezier_patches", "patches": [[patch]]}, numpy.stack([length * s, depth * t, z], 1), {"box": (length, depth)}


SURFACES = [cone, dome, ring, plane, groove, ridge, wave]


# ---- the path

def tips(toolpath, step):
    """Samples of the feed moves: all of them, and those that cut a pass."""
    at, feeds, cuts = numpy.array(toolpath["start"]), [], []
    for one_pass in toolpath["passes"]:
        for move in one_pass["moves"]:
            if move["kind"] == "dwell":
                continue
            to = numpy.array(move["to"])
            if move["kind"] == "rapid":
                at = to
                continue
            if move["kind"] == "arc":
                points = arc(at, to, numpy.array(move["center"]), move["plane"], move["direction"], step)
            else:
                n = max(1, math.ceil(numpy.linalg.norm(to - at) / step))
                points = at + (to - at) * numpy.linspace(0, 1, n + 1)[:, None]
            feeds.append(points)
            if move["role"] == "cut":
                cuts.append(points)
            at = to
    return numpy.concatenate(feeds), numpy.concatenate(cuts)


def arc(start, end, center, plane, direction, step):
    a, b, c = {"xy": (0, 1, 2), "zx": (2, 0, 1), "yz": (1, 2, 0)}[plane]
    first, last = start - center, end - center
    radius = math.hypot(first[a], first[b])
    from_angle, to_angle = math.atan2(first[b], first[a]), math.atan2(last[b], last[a])
    turn = (to_angle - from_angle) % (2 * math.pi) if direction == "ccw" else -((from_angle - to_angle) % (2 * math.pi))
    if abs(turn) < 1e-12:
        turn = 2 * math.pi if direction == "ccw" else -2 * math.pi
    n = max(2, math.ceil(radius * abs(turn) / step))
    share = numpy.linspace(0, 1, n + 1)
    points = numpy.empty((n + 1, 3))
    points[:, a] = center[a] + radius * numpy.cos(from_angle + turn * share)
    points[:, b] = center[b] + radius * numpy.sin(from_angle + turn * share)
    points[:, c] = start[c] + (end[c] - start[c]) * share
    return points


# ---- the cutter

def distance(points, tip, flat, corner):
    """Distance of points from the cutter with its shank: negative inside."""
    off = points - tip
    out = numpy.hypot(off[..., 0], off[..., 1]) - flat
    below = corner - off[..., 2]
    outside = numpy.hypot(numpy.maximum(out, 0), numpy.maximum(below, 0))
    inside = numpy.minimum(numpy.maximum(out, below), 0)
    return outside + inside - corner


def least_distance(points, tips, flat, corner, near):
    """For each point the least distance from the cutter over all tips; tips farther than `near` in plan do not count."""
    tree = cKDTree(tips[:, :2])
    least = numpy.full(len(points), numpy.inf)
    for k, neighbours in enumerate(tree.query_ball_point(points[:, :2], near)):
        if neighbours:
            least[k] = distance(points[k], tips[neighbours], flat, corner).min()
    return least


def beyond(points, outline, margin):
    """How far axes lie beyond an outline that is inset by `margin`, mm: a rectangle, or circles around and within."""
    x, y = points[:, 0], points[:, 1]
    if "box" in outline:
        width, depth = outline["box"]
        return numpy.max([margin - x, x - width + margin, margin - y, y - depth + margin], 0)
    middle_x, middle_y = outline["middle"]
    far = numpy.hypot(x - middle_x, y - middle_y)
    return numpy.maximum(far - outline["out"] + margin, outline["hole"] + margin - far if outline["hole"] else -numpy.inf)


# ---- jobs

def job(rng):
    maker = rng.choice(SURFACES)
    surface, points, outline = maker(rng)
    diameter = rng.choice([3, 4, 6, 8])
    shape = rng.choice(["ball", "ball", "flat", "bull_nose"])
    tool = {"shape": shape, "diameter_mm": diameter}
    if shape == "bull_nose":
        tool["corner_radius_mm"] = rng.choice([0.5, 1.0])
    step = {"stepover_mm": rng.choice([0.5, 1.0, 0.3 * diameter, round(rng.uniform(0.3, 2.5), 3)])}
    if rng.random() < 0.25:
        step = {"scallop_height_mm": rng.choice([0.01, 0.02, 0.05])}
    body = {
        "surface": surface, "tool": tool,
        "strategy": {"kind": "cl_cartesian", "plane": rng.choice(["zx", "yz"]), "direction": rng.choice(["zigzag", "one_way"]), **step},
        "boundary": rng.choice(["on", "on", "inside", "past"]), "tolerance_mm": 0.01,
        "cutting": {"feed_mm_per_min": 1000, "spindle_rpm": 8000}, "stock": {"kind": "block", "top_z_mm": 30.0},
    }
    if rng.random() < 0.2:
        body["allowance_mm"] = 0.2
    if rng.random() < 0.3:
        body["exit"] = {"kind": "arc", "radius_mm": 2}
        body["entry"] = {"kind": "arc", "radius_mm": 2}
    return maker.__name__, body, points, outline


def judge(address, name, body, points, outline):
    """The row of a job and the statements that it breaks; `None` for the statements where the job is refused."""
    status, answer = post(address, "/v1/surfaces/mill", body)
    title = f"{name:7} {body['tool']['shape']:9} {body['tool']['diameter_mm']} {body['boundary']:6}"
    if status != 200:
        return f"{title} {status} {answer.get('code')}: {answer.get('errors') or answer.get('detail')}", None
    report, radius = answer["report"], body["tool"]["diameter_mm"] / 2
    corner = {"ball": radius, "flat": 0.0}.get(body["tool"]["shape"], body["tool"].get("corner_radius_mm"))
    left = body.get("allowance_mm", 0.0)
    flat, corner = radius - corner, corner + left
    feeds, cuts = (path - [0, 0, left] for path in tips(answer["toolpath"], STEP_SHARE * radius))
    uncut = numpy.maximum(least_distance(points, cuts, flat, corner, radius + 3.0), 0)
    depth = max(0.0, -least_distance(points, feeds, flat, corner, radius + left).min() - left)
    axes = reachable(address, body, points, radius + left)
    if body["boundary"] == "inside":
        axes = axes[beyond(axes, outline, radius) <= 0]
    rest = numpy.maximum(least_distance(points, axes, flat, corner, radius + 3.0), 0)
    reached, at_edge = rest <= REACHED_MM, beyond(points, outline, EDGE_MM) > 0
    judged = reached & ~at_edge
    if not reached.all():
        judged &= cKDTree(points[~reached]).query(points)[0] > BORDER_MM
    scallop, rest_max = (uncut[judged].max() if judged.any() else 0.0), rest.max()
    stated_scallop, stated_rest = report.get("scallop_max_mm"), report.get("rest_max_mm")
    faults = []
    if depth > report["gouge_max_mm"] + SAMPLING_MM:
        faults.append(f"cuts {depth:.4f} deep")
    allowed = SAMPLING_MM + report["deviation_max_mm"]
    for kind, stated in [(judged, stated_scallop), (points[:, 2] < numpy.inf, max(stated_scallop or 0, stated_rest or 0))]:
        if kind.any() and stated is not None and uncut[kind].max() > stated + allowed:
            place = points[kind][uncut[kind].argmax()]
            faults.append(f"leaves {uncut[kind].max():.4f} where {stated:.4f} is stated, at {numpy.round(place, 3).tolist()}")
    if stated_scallop is None:
        faults.append("states no scallop")
    asked = body["strategy"].get("scallop_height_mm")
    if asked is not None and scallop > asked + allowed:
        faults.append(f"leaves {scallop:.4f} where {asked} is asked")
    if body["boundary"] == "inside":
        out = beyond(feeds, outline, radius).max()
        if out > 0.02:
            faults.append(f"leaves the outline by {out:.3f}")
    ratio = stated_scallop / scallop if stated_scallop and scallop > 1e-3 else 0.0
    figures = f"scallop {stated_scallop if stated_scallop is None else round(stated_scallop, 4)} / {scallop:.4f} ({ratio:.2f})"
    figures += f" rest {stated_rest if stated_rest is None else round(stated_rest, 4)} / {rest_max:.4f} gouge {report['gouge_max_mm']:.4f} / {depth:.4f}"
    return f"{title} {figures} {' '.join(warning['code'] for warning in answer['warnings'])}", faults


def reachable(address, body, points, radius):
    """Tips of the enlarged cutter dropped at a raster of places over and around the surface."""
    (x0, y0), (x1, y1) = points[:, :2].min(0) - radius, points[:, :2].max(0) + radius
    step = max(0.15, math.sqrt((x1 - x0) * (y1 - y0) / 12_000))
    xs, ys = numpy.arange(x0, x1, step), numpy.arange(y0, y1, step)
    places = [[float(x), float(y)] for x in xs for y in ys]
    left = body.get("allowance_mm", 0.0)
    tool = dict(body["tool"])
    if left:
        tool["diameter_mm"] += 2 * left
        if tool["shape"] != "ball":
            tool["shape"], tool["corner_radius_mm"] = "bull_nose", tool.get("corner_radius_mm", 0.0) + left
    status, answer = post(address, "/v1/surfaces/drop", {"surface": body["surface"], "tool": tool, "points": places})
    if status != 200:
        raise SystemExit(f"drop: {status} {answer}")
    return numpy.array([tip for tip in answer["report"]["tips"] if tip is not None])


def main():
    address = sys.argv[1].removeprefix("http://")
    jobs = int(sys.argv[2]) if len(sys.argv) > 2 else 40
    seed = int(sys.argv[3]) if len(sys.argv) > 3 else 1
    rng, broken, refused = random.Random(seed), 0, 0
    for k in range(jobs):
        row, faults = judge(address, *job(rng))
        refused += faults is None
        broken += bool(faults)
        print(f"{k:3} {row}{'' if not faults else '   FAULT: ' + '; '.join(faults)}", flush=True)
    print(f"{jobs - broken - refused} passed, {broken} failed, {refused} skipped")
    sys.exit(1 if broken else 0)


if __name__ == "__main__":
    main()
