"""Bodies to plan: examples of the contract, ordinary pockets, random ones, and the same pocket moved, turned, mirrored and split."""

import copy
import json
import math
import pathlib
import random

ROOT = pathlib.Path(__file__).resolve().parents[3]
SEED = 38
EXAMPLES = ROOT / "openapi/examples/pockets-plan"
# Bulge of a quarter circle.
QUARTER = math.tan(math.pi / 8)


def examples():
    """The examples of the contract."""
    return {file.stem: json.loads(file.read_text()) for file in sorted(EXAMPLES.glob("*.json"))}


def body(boundary, islands=(), diameter=10.0, stepover=None, depth=5.0, stepdown=None, feed=1000, **more):
    """A pocket with round numbers. `depth` and `stepdown` in mm below zero."""
    return {
        "region": {"boundary": boundary, "islands": list(islands)}, "floor_z_mm": -depth, "stepdown_max_mm": stepdown or depth,
        "tool": {"shape": "flat", "diameter_mm": diameter, "number": 1}, "stepover_mm": stepover or 0.4 * diameter,
        "cutting": {"feed_mm_per_min": feed, "spindle_rpm": 6000}, "program": {"work_offset": "G54"}, **more,
    }


def block(x0, y0, x1, y1):
    return [[x0, y0], [x1, y0], [x1, y1], [x0, y1]]


def disc(x, y, radius):
    return [[x - radius, y, 1], [x + radius, y, 1]]


def slot(x0, y0, x1, y1, radius):
    """A block with half circles at its ends."""
    length = math.hypot(x1 - x0, y1 - y0)
    nx, ny = -(y1 - y0) / length * radius, (x1 - x0) / length * radius
    return [[x0 - nx, y0 - ny], [x1 - nx, y1 - ny, 1], [x1 + nx, y1 + ny], [x0 + nx, y0 + ny, 1]]


def filleted(corners, radius):
    """A polygon with every corner rounded by an arc, as large as half of its edges allows."""
    found = []
    for k, (x, y) in enumerate(corners):
        (ax, ay), (bx, by) = corners[k - 1], corners[(k + 1) % len(corners)]
        la, lb = math.hypot(ax - x, ay - y), math.hypot(bx - x, by - y)
        ua, ub = ((ax - x) / la, (ay - y) / la), ((bx - x) / lb, (by - y) / lb)
        turn = math.pi - math.acos(max(-1.0, min(1.0, ua[0] * ub[0] + ua[1] * ub[1])))
        if turn < 1e-6 or radius <= 0:
            found.append([x, y])
            continue
        cut = min(radius * math.tan(turn / 2), 0.45 * la, 0.45 * lb)
        side = math.copysign(1, -ua[0] * ub[1] + ua[1] * ub[0])
        found.append([x + cut * ua[0], y + cut * ua[1], side * math.tan(turn / 4)])
        found.append([x + cut * ub[0], y + cut * ub[1]])
    return found


def ring_of(count, radius_of, x=0.0, y=0.0):
    return [[x + radius_of(k) * math.cos(2 * math.pi * k / count), y + radius_of(k) * math.sin(2 * math.pi * k / count)] for k in range(count)]


def ordinary():
    """Pockets as they stand on drawings."""
    teeth = []
    for k in range(24):
        for share, radius in ((0.0, 34), (0.12, 44), (0.5, 44), (0.62, 34)):
            angle = 2 * math.pi * (k // 2 * 2 + 2 * share) / 24
            if k % 2 == 0:
                teeth.append([radius * math.cos(angle), radius * math.sin(angle)])
    kidney_turn = math.tan(math.radians(150) / 4)
    end = [math.cos(math.radians(150)), math.sin(math.radians(150))]
    kidney = [[50, 0, kidney_turn], [50 * end[0], 50 * end[1], 1], [22 * end[0], 22 * end[1], -kidney_turn], [22, 0, 1]]
    comb = [[0, 0], [150, 0]]
    for k in range(5):
        right = 150 - 32 * k
        comb += [[right, 70], [right - 22, 70]] + ([[right - 22, 25], [right - 32, 25]] if k < 4 else [])
    half_neck = 6.0
    keyhole = [[half_neck, 20], [80, 14], [80, 26], [half_neck, 26]]
    at = math.sqrt(20 ** 2 - 6 ** 2)
    keyhole = [[at, 6, math.tan((2 * math.pi - 2 * math.asin(6 / 20)) / 4)], [at, -6], [70, -6, 1], [70, 6]]
    grid = [block(10 + 16 * (k % 10), 10 + 16 * (k // 10), 16 + 16 * (k % 10), 16 + 16 * (k // 10)) for k in range(100)]
    return {
        "rectangle": body(filleted(block(0, 0, 120, 80), 6), diameter=10, stepover=4),
        "sharp-rectangle": body(block(0, 0, 100, 60), diameter=12, stepover=6, depth=8, stepdown=4),
        "small-stepover": body(filleted(block(0, 0, 90, 60), 6), diameter=10, stepover=1.0, depth=10, feed=2500),
        "l": body([[0, 0], [110, 0], [110, 45], [45, 45], [45, 100], [0, 100]], diameter=12, stepover=4.8),
        "t": body([[0, 60], [0, 30], [45, 30], [45, -40], [75, -40], [75, 30], [120, 30], [120, 60]], diameter=8, stepover=3.2),
        "circle": body(disc(0, 0, 35), diameter=12, stepover=4.8, depth=12, stepdown=4),
        "slot": body(slot(0, 0, 70, 0, 9), diameter=10, stepover=4),
        "wide-slot": body(slot(0, 0, 80, 20, 22), diameter=16, stepover=6),
        "keyhole": body(keyhole, diameter=8, stepover=3.2),
        "islands": body(filleted(block(0, 0, 140, 100), 8), [disc(40, 50, 12), block(80, 30, 105, 65), slot(70, 82, 100, 82, 5)], diameter=10, stepover=4),
        "comb": body(comb, diameter=10, stepover=4),
        "star": body(ring_of(10, lambda k: 55 if k % 2 == 0 else 26), diameter=8, stepover=3.2),
        "kidney": body(kidney, diameter=10, stepover=4),
        "gear": body(teeth, [disc(0, 0, 12)], diameter=5, stepover=2),
        "hundred-islands": body(block(0, 0, 170, 170), grid, diameter=6, stepover=2.4),
        "frame": body(filleted(block(0, 0, 120, 90), 5), [filleted(block(24, 24, 96, 66), 5)], diameter=8, stepover=3.2, depth=9, stepdown=3),
    }


def union_of_blocks(chance, size):
    """The outline and holes of blocks on a grid of `size` mm that touch along edges."""
    nx, ny = chance.randint(4, 9), chance.randint(4, 8)
    cells = set()
    for _ in range(chance.randint(1, 4)):
        w, h = chance.randint(1, nx), chance.randint(1, ny)
        if not cells:
            w, h = max(2, w), max(2, h)
        x, y = chance.randint(0, nx - w), chance.randint(0, ny - h)
        new = {(x + i, y + j) for i in range(w) for j in range(h)}
        if not cells or any((i + a, j + b) in cells for i, j in new for a, b in ((0, 0), (1, 0), (-1, 0), (0, 1), (0, -1))):
            cells |= new
    edges = {}
    for i, j in cells:
        for a, b, start, end in ((0, -1, (i, j), (i + 1, j)), (1, 0, (i + 1, j), (i + 1, j + 1)), (0, 1, (i + 1, j + 1), (i, j + 1)), (-1, 0, (i, j + 1), (i, j))):
            if (i + a, j + b) not in cells:
                edges.setdefault(start, []).append(end)
    if any(len(ends) > 1 for ends in edges.values()):
        return union_of_blocks(chance, size)
    loops = []
    while edges:
        start = min(edges)
        loop, at = [start], edges.pop(start)[0]
        while at != start:
            loop.append(at)
            at = edges.pop(at)[0]
        kept = [p for k, p in enumerate(loop) if (p[0] - loop[k - 1][0]) * (loop[(k + 1) % len(loop)][1] - p[1]) != (p[1] - loop[k - 1][1]) * (loop[(k + 1) % len(loop)][0] - p[0])]
        loops.append([[size * x, size * y] for x, y in kept])
    area = lambda loop: sum(loop[k - 1][0] * p[1] - p[0] * loop[k - 1][1] for k, p in enumerate(loop)) / 2
    loops.sort(key=area)
    return loops[-1], loops[:-1]


def random_case(number):
    chance = random.Random(f"{SEED} {number}")
    diameter = float(chance.randint(3, 25))
    kind = chance.choice(["blocks"] * 5 + ["disc", "slot", "star", "keyhole", "smooth"])
    # Widths in diameters decide how much room there is; numbers on a drawing are round.
    unit = max(1.0, round(diameter * chance.choice([0.9, 1.25, 1.6, 2.2])))
    islands = []
    if kind == "blocks":
        outline, islands = union_of_blocks(chance, unit)
        if chance.random() < 0.5:
            outline = filleted(outline, chance.choice([0.3, 0.5, 0.6]) * diameter)
    elif kind == "disc":
        outline = disc(0, 0, unit * chance.randint(2, 4))
    elif kind == "slot":
        outline = slot(0, 0, unit * chance.randint(2, 8), unit * chance.randint(0, 4), max(0.55 * diameter, unit * chance.choice([0.5, 1, 2])))
    elif kind == "star":
        many = 2 * chance.randint(3, 7)
        far, near = unit * 5, unit * chance.choice([2, 2.5, 3, 4])
        outline = filleted(ring_of(many, lambda k: far if k % 2 == 0 else near), chance.choice([0, 0.5, 0.7]) * diameter)
    elif kind == "keyhole":
        big, half = unit * chance.randint(2, 4), max(0.55 * diameter, 0.5 * unit)
        at = math.sqrt(big * big - half * half)
        outline = [[at, half, math.tan((2 * math.pi - 2 * math.asin(half / big)) / 4)], [at, -half], [at + 5 * unit, -half, 1], [at + 5 * unit, half]]
    else:
        waves, depth = chance.randint(2, 6), chance.uniform(0.05, 0.3)
        outline = ring_of(120, lambda k: unit * 4 * (1 + depth * math.cos(waves * 2 * math.pi * k / 120)))
    xs, ys = [p[0] for p in outline], [p[1] for p in outline]
    for _ in range(chance.choice([0, 0, 1, 2, 3, 4])):
        x, y = round(chance.uniform(min(xs), max(xs))), round(chance.uniform(min(ys), max(ys)))
        size = max(1, round(diameter * chance.uniform(0.2, 1.2)))
        islands.append(chance.choice([disc(x, y, size), block(x, y, x + size, y + 2 * size), slot(x, y, x + 2 * size, y + size, size)]))
    # A path of a few tens of metres is enough.
    area = (max(xs) - min(xs)) * (max(ys) - min(ys))
    least = area / 15000
    stepover = max(round(diameter * chance.uniform(0.05, 0.6), 2), round(min(least, 0.5 * diameter), 2), 0.1)
    levels = chance.choice([1, 1, 1, 2, 3])
    stepdown = max(1.0, round(diameter / 3, 1))
    more = {"direction": chance.choice(["climb", "climb", "conventional"])}
    return body(outline, islands, diameter, stepover, depth=levels * stepdown, stepdown=stepdown, feed=chance.choice([600, 1000, 2500]), **more)


def random_cases(count=200):
    return {f"random-{number:03}": random_case(number) for number in range(count)}


def changed(original, change, mirrored=False):
    """A body whose outlines went through `change`, which maps a point."""
    one = copy.deepcopy(original)
    regions = [one["region"], *(part for part in one.get("cleared") or [] if "boundary" in part)]
    for region in regions:
        for outline in [region["boundary"], *(region.get("islands") or [])]:
            for vertex in outline:
                vertex[:2] = change(vertex[0], vertex[1])
                if mirrored and len(vertex) > 2:
                    vertex[2] = -vertex[2]
    return one


def reshaped(original, change):
    """A body whose outlines are replaced by `change` of each."""
    one = copy.deepcopy(original)
    for region in [one["region"], *(part for part in one.get("cleared") or [] if "boundary" in part)]:
        region["boundary"] = change(region["boundary"])
        region["islands"] = [change(island) for island in region.get("islands") or []]
    return one


def backwards(outline):
    bulges = [vertex[2] if len(vertex) > 2 else 0 for vertex in outline]
    count = len(outline)
    found = []
    for k in range(count - 1, -1, -1):
        bulge = -bulges[k - 1]
        found.append(outline[k][:2] + ([bulge] if bulge else []))
    return found


def split(outline):
    """Every edge in two; arcs are halved, too."""
    found = []
    for k, vertex in enumerate(outline):
        after = outline[(k + 1) % len(outline)]
        bulge = vertex[2] if len(vertex) > 2 else 0
        x, y = (vertex[0] + after[0]) / 2, (vertex[1] + after[1]) / 2
        if bulge:
            # The middle of the arc is beside the middle of the chord by half the chord times the bulge.
            x, y = x + bulge * (after[1] - vertex[1]) / 2, y - bulge * (after[0] - vertex[0]) / 2
            half = math.tan(math.atan(bulge) / 2)
            found += [[vertex[0], vertex[1], half], [x, y, half]]
        else:
            found += [vertex[:2], [x, y]]
    return found


def turned(degrees):
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    return lambda x, y: [x * c - y * s, x * s + y * c]


def transforms(name, original):
    """The same pocket, said in other ways."""
    return {
        f"{name}/as-it-is": original,
        f"{name}/moved": changed(original, lambda x, y: [x + 137.31, y - 71.77]),
        f"{name}/turned-33": changed(original, turned(33)),
        f"{name}/turned-90": changed(original, turned(90)),
        f"{name}/mirrored": changed(original, lambda x, y: [-x, y], mirrored=True),
        f"{name}/reversed": reshaped(original, backwards),
        f"{name}/other-start": reshaped(original, lambda outline: outline[len(outline) // 2:] + outline[:len(outline) // 2]),
        f"{name}/split": reshaped(original, split),
    }


def all_transforms():
    found = {}
    for name, original in {**examples(), **ordinary()}.items():
        if "region" in original and not original.get("heights") and not original.get("surface") and not name.startswith(("hundred", "noisy")):
            found.update(transforms(name, original))
    return found


POPULATIONS = {"examples": examples, "ordinary": ordinary, "random": random_cases, "transforms": all_transforms}
