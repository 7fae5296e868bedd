"""Everything that is measured of one answer. See judge.py for what the figures mean."""

import math

import numpy
from scipy import ndimage

from motion import FLAT, FZ, HEIGHT_MM, TZ, Motion, chords_of, counts_of, least_distances
from outlines import Outlines, Raster, points
from sweeping import CUT, LEAD_IN, LEAD_OUT, LINK, PLUNGE, RAMP, RAPID, sweep, walls_over_time

# Points on the leading half of the rim.
RIM_POINTS = 180
# The rule of load: the angle may be this much above that of a straight pass; and what the measure may be off, degrees.
LOAD_FACTOR, ANGLE_SLACK_DEG = 1.1, 0.75
# From this angle on a cut is a slot, degrees. Below the next it is none: the rim only brushes an edge.
SLOT_DEG, BRUSH_DEG = 165.0, 4.0
# A share of the requested feed from which a cut is at full feed.
FULL_FEED = 0.99
# A pass nearer to its distance from a wall is a wall pass, mm; a shorter one is a touch in passing.
WALL_PASS_MM, WALL_RUN_MM = 2e-3, 1.0
# A roughing pass is farther than this from wall passes, mm.
ROUGH_MM = 0.05
KINK_DEG = 30.0
# A wall has reached its size once less than this stands on it, mm.
DONE_MM = 5e-3
# Where a corner keeps more than this, no wall pass is near, mm.
CORNER_MM = 0.3
# Clearances are looked up to here, mm.
REACH_MM = 3.0
# Samples of a path at walls are this far apart, mm; a gouge from this depth on is a fault, mm.
FINE_MM, GOUGE_MM = 0.02, 1.5e-3
# Largest number of cells of all levels.
CELLS = 24_000_000


def left_on_walls(body):
    """What the job leaves on walls and islands, mm."""
    finishes = body.get("finish") and (body["finish"].get("walls") is not None) and body.get("only") != "roughing"
    return 0.0 if finishes else float(body.get("allowance_mm") or 0.0)


class Scene:
    """The pocket of a body, and its cells."""

    def __init__(self, body, n_levels):
        self.radius = body["tool"]["diameter_mm"] / 2
        self.left_mm = left_on_walls(body)
        region = body["region"]
        self.boundary, self.islands = region["boundary"], region.get("islands") or []
        reach = 1.3 * self.radius + self.left_mm + REACH_MM + 0.5
        self.reach = reach
        self.outlines = Outlines([self.boundary, *self.islands], reach, max(self.radius / 2, 0.5))
        own = Outlines([self.boundary], 1.0, 50.0)
        area = (own.high - own.low).prod()
        cell = max(self.radius / 50, math.sqrt(area * n_levels / CELLS))
        self.raster = Raster(own.low, own.high, cell)
        self.inside = self.raster.inside(self.boundary, self.islands)
        far = self.outlines.distances(*self.raster.middles())
        self.signed = numpy.where(self.inside, far, -far)
        self.find_touched_walls()
        centres = self.signed >= self.radius + self.left_mm
        # In a slot as wide as the cutter no cell's middle is a centre, but the middles of touches are.
        i, j = self.cells_at(self.touching)
        centres[j, i] = True
        self.to_centre = ndimage.distance_transform_edt(~centres) * cell if centres.any() else numpy.full(centres.shape, 1e9)
        self.emptied = self.emptied_field(body.get("cleared") or [])
        if body.get("only") == "finishing":
            # Only the allowance stands.
            rest = self.radius + float(body.get("allowance_mm") or 0.0) - self.signed
            self.emptied = numpy.minimum(self.emptied, rest.astype(numpy.float32))

    def emptied_field(self, cleared):
        """The field of what earlier tools have emptied: above the radius where material stands."""
        field = numpy.full(self.inside.shape, 1e6, numpy.float32)
        for one in cleared:
            if "boundary" not in one:
                raise NotJudged("cleared by a program")
            signed, _ = self.raster.signed(one["boundary"], one.get("islands") or [], 2 * self.radius, self.radius)
            field = numpy.minimum(field, (self.radius - signed).astype(numpy.float32))
        return field

    def find_touched_walls(self):
        """Samples of walls and islands, which of them the cutter touches somewhere, and the centres of these touches."""
        spacing = max(0.05, min(0.1, self.radius / 40))
        self.samples, self.normals = points(self.outlines.rows, spacing)
        self.reachable = numpy.zeros(len(self.samples), bool)
        away, found = self.radius + self.left_mm, []
        for side in (away, -away):
            centre = self.samples + side * self.normals
            fits = self.is_inside(*centre.T) & (self.outlines.distances(*centre.T) >= away - 1e-6)
            self.reachable |= fits
            found.append(centre[fits])
        self.touching = numpy.concatenate(found)

    def cells_at(self, places):
        i = numpy.clip(((places[:, 0] - self.raster.left) / self.raster.cell).astype(int), 0, self.raster.nx - 1)
        j = numpy.clip(((places[:, 1] - self.raster.bottom) / self.raster.cell).astype(int), 0, self.raster.ny - 1)
        return i, j

    def is_inside(self, xs, ys):
        i, j = self.cells_at(numpy.stack([xs, ys], 1))
        return self.inside[j, i]

    def wall_distances(self, xs, ys):
        """Distance of the cutter's centre to walls and islands, below zero where the centre is in the part."""
        far = self.outlines.distances(xs, ys)
        return numpy.where(self.is_inside(xs, ys) | (far < 2 * self.raster.cell), far, -far)


class NotJudged(Exception):
    """The body uses something that this judge does not know."""


def judge(body, answer):
    """Figures of an answer; `faults` names what must not be, in a few words each."""
    if "region" not in body or body.get("heights") or body.get("surface"):
        raise NotJudged("no walls of lines and arcs")
    for unknown in ("open", "stock"):
        if body.get(unknown) or (body.get("region") or {}).get(unknown):
            raise NotJudged(unknown)
    motion = Motion(answer, body)
    levels = motion.levels()
    scene = Scene(body, max(1, len(levels)))
    path = Path(motion, scene, levels, body.get("top_z_mm") or 0.0)
    figures = {"n_moves": len(motion.moves), "levels": levels, "faults": []}
    for part in (gouge, load, material, coverage, walls, leads, kinks, times, depths):
        figures.update(part(path, scene, motion, body, figures["faults"]))
    rate = body["stepover_mm"] * body["cutting"]["feed_mm_per_min"]
    figures["nominal"] = [minutes * rate / area for minutes, area in zip(figures["minutes"], figures["areas"]) if area > 0]
    return figures


class Path:
    """The chords of an answer's moves, with what was swept along them."""

    def __init__(self, motion, scene, levels, top):
        self.motion, self.levels, self.top = motion, levels, top
        moves = motion.moves
        lowest = numpy.minimum(moves[:, FZ], moves[:, TZ])
        self.low_moves = lowest < top - HEIGHT_MM
        self.counts = counts_of(moves, self.low_moves, scene.radius)
        self.firsts = numpy.cumsum(self.counts) - self.counts
        self.chords, self.rows, self.owners = chords_of(moves, self.counts)
        self.kinds = motion.kinds[self.owners]
        self.lengths = numpy.hypot(self.chords[:, 3] - self.chords[:, 0], self.chords[:, 4] - self.chords[:, 1])
        self.floor = self.floor_levels()
        self.layers = self.layers_of(numpy.minimum(self.chords[:, 2], self.chords[:, 5]))
        rim = numpy.pi * ((numpy.arange(RIM_POINTS) + 0.5) / RIM_POINTS - 0.5)
        rim = numpy.stack([numpy.cos(rim), numpy.sin(rim)], 1)
        self.fields = numpy.repeat(scene.emptied[None], max(1, len(levels)), 0)
        raster = scene.raster
        angles, above, self.hits = sweep(
            self.chords, self.floor, self.layers, self.kinds, self.fields, scene.signed.astype(numpy.float32),
            raster.left, raster.bottom, raster.cell, scene.radius, rim)
        self.angles, self.above = numpy.degrees(angles), numpy.degrees(above)
        self.wall = numpy.full(len(self.chords) + 1, scene.reach)
        low = numpy.append(self.low_moves[self.owners], False) | numpy.append(False, self.low_moves[self.owners])
        ends = numpy.concatenate([self.chords[:1, :2], self.chords[:, 3:5]])
        self.wall[low] = scene.wall_distances(ends[low, 0], ends[low, 1])

    def floor_levels(self):
        """The level whose floor a feed chord follows, else -1."""
        found = numpy.full(len(self.chords), -1)
        for level, z in enumerate(self.levels):
            at = (numpy.abs(self.chords[:, 2] - z) < 2 * HEIGHT_MM) & (numpy.abs(self.chords[:, 5] - z) < 2 * HEIGHT_MM)
            found[at & (self.kinds != RAPID)] = level
        return found

    def layers_of(self, heights):
        """The first level at or below a height; -1 above the stock."""
        found = numpy.full(len(heights), -1)
        for level, z in reversed(list(enumerate(self.levels))):
            found[heights >= z - 2 * HEIGHT_MM] = level
        found[heights >= self.top - HEIGHT_MM] = -1
        return numpy.where((found < 0) & (heights < self.top - HEIGHT_MM), len(self.levels) - 1, found)

    def where(self, k):
        x, y, z = self.chords[k, 3:6]
        return f"({x:.2f}, {y:.2f}, {z:.2f})"


NAMES = {RAPID: "rapid", CUT: "cut", PLUNGE: "plunge", RAMP: "ramp", LEAD_IN: "lead in", LINK: "link", LEAD_OUT: "lead out"}


def gouge(path, scene, motion, body, faults):
    """Least distance of the centre to walls, less radius."""
    ends = path.wall
    near = path.low_moves[path.owners] & ((ends[:-1] + ends[1:] - path.lengths) / 2 < scene.radius + 1e-3)
    chosen = numpy.flatnonzero(near)
    least, where = path.wall.min(), None
    if len(chosen):
        raster = scene.raster
        found = least_distances(
            motion.moves, path.firsts, path.counts, path.owners, chosen, FINE_MM, scene.inside, raster.left, raster.bottom, raster.cell,
            *scene.outlines.buckets)
        least, where = found.min(), path.where(chosen[found.argmin()])
    if least < scene.radius - GOUGE_MM:
        faults.append(f"gouge {scene.radius - least:.4f} at {where}")
    return {"gouge": max(0.0, scene.radius - least), "wall_least": least - scene.radius}


def load(path, scene, motion, body, faults):
    """Shares of the cut length above the angle of a straight pass, and as slots."""
    ratio = min(2.0, 2 * body["stepover_mm"] / body["tool"]["diameter_mm"])
    limit = LOAD_FACTOR * math.degrees(math.acos(1 - ratio)) + ANGLE_SLACK_DEG
    cuts = (path.floor >= 0) & (path.kinds != LINK)
    whole = max(path.lengths[cuts].sum(), 1e-9)
    over = cuts & (path.angles > limit)
    full = motion.feeds[path.owners] >= FULL_FEED * body["cutting"]["feed_mm_per_min"]
    share = lambda which: 100 * path.lengths[which].sum() / whole
    slot = cuts & (path.angles >= SLOT_DEG)
    worst = numpy.argmax(numpy.where(cuts & full, path.angles, 0))
    result = {"over_full": share(over & full), "over_any": share(over), "slot_full": share(slot & full), "slot_any": share(slot),
              "angle_full_max": path.angles[worst], "angle_limit": limit, "air": share(cuts & (path.angles < BRUSH_DEG)),
              "n_feeds": len(set(numpy.round(motion.feeds[(motion.kinds == CUT)], 3))), "cut_length": whole}
    if result["over_full"] > 2.0:
        faults.append(f"load: {result['over_full']:.1f} % above the limit at full feed, worst {path.angles[worst]:.0f} deg at {path.where(worst)}")
    return result


def material(path, scene, motion, body, faults):
    """Links, rapids and plunges through material, and cuts deeper than a level."""
    links = (path.floor >= 0) & (path.kinds == LINK) & (path.angles > BRUSH_DEG)
    low = (path.floor < 0) & path.hits
    rapids = low & (path.kinds == RAPID)
    raised = low & numpy.isin(path.kinds, (LINK, LEAD_IN, LEAD_OUT, CUT))
    plunges = low & (path.kinds == PLUNGE)
    deep = (path.floor >= 0) & (path.above > BRUSH_DEG) & (path.kinds != LINK)
    length = path.lengths[links].sum() + path.lengths[raised].sum()
    if rapids.any():
        faults.append(f"rapid in material at {path.where(numpy.flatnonzero(rapids)[0])}")
    if length > 0.5 or raised.any():
        faults.append(f"link through material, {length:.2f} mm, at {path.where(numpy.flatnonzero(links | raised)[0])}")
    finishing = bool(body.get("finish"))
    if path.lengths[deep].sum() > 0.5 and not finishing:
        faults.append(f"deeper than a level for {path.lengths[deep].sum():.2f} mm at {path.where(numpy.flatnonzero(deep)[0])}")
    return {"rapids_hit": int(rapids.sum()), "links_hit": length, "plunges": len(set(path.owners[plunges])), "deep": path.lengths[deep].sum()}


def coverage(path, scene, motion, body, faults):
    """What the cutter reaches and has not cut, for each level."""
    cell = scene.raster.cell
    to_centre = scene.to_centre
    within = (to_centre <= scene.radius) & scene.inside
    surely = (to_centre <= scene.radius - cell) & (scene.signed > 0.5 * cell)
    material = scene.emptied > scene.radius
    uncut, largest, areas = [], 0.0, []
    for level in range(len(path.levels)):
        field = path.fields[level:].min(0)
        rest = surely & (field > scene.radius + 0.25 * cell)
        areas.append((within & material).sum() * cell * cell)
        uncut.append(rest.sum() * cell * cell)
        if rest.any():
            names, number = ndimage.label(rest)
            sizes = ndimage.sum(rest, names, range(1, number + 1)) * cell * cell
            if sizes.max() > largest:
                largest = sizes.max()
                j, i = ndimage.center_of_mass(rest, names, int(sizes.argmax()) + 1)
                where = f"({scene.raster.left + (i + 0.5) * cell:.2f}, {scene.raster.bottom + (j + 0.5) * cell:.2f}, {path.levels[level]:.2f})"
    share = 100 * max((rest / max(area, 1e-9) for rest, area in zip(uncut, areas)), default=0.0)
    # One row of cells along a fifth of the rim may be due to the cells alone.
    if share > 0.05 and largest > 4 * cell * cell:
        faults.append(f"uncut {max(uncut):.3f} mm2, largest {largest:.3f} at {where}")
    if not path.levels and to_centre.max() < 1e9:
        faults.append("nothing is cut")
    return {"uncut": max(uncut, default=0.0), "uncut_share": share, "uncut_largest": largest, "areas": areas}


def wall_samples(scene):
    """Points on walls and islands, which of them the cutter has to touch, and what stands on each at most once it has its size, mm."""
    samples, reachable, cell = scene.samples, scene.reachable.copy(), scene.raster.cell
    # In corners narrower than the cutter, and between short edges, something stands for good: to a cell this is known, too.
    i, j = scene.cells_at(samples)
    beyond = scene.to_centre[j, i] - scene.radius
    done_below = numpy.where(reachable, scene.left_mm + DONE_MM, numpy.where(beyond < scene.left_mm + CORNER_MM, beyond + cell, -1.0))
    # What an earlier tool has emptied needs no touch.
    for side in (2 * cell, -2 * cell):
        i, j = scene.cells_at(samples + side * scene.normals)
        reachable &= ~(scene.inside[j, i] & (scene.emptied[j, i] <= scene.radius + 2 * cell))
    return samples, reachable, done_below


def sorted_samples(samples, size):
    left, bottom = samples.min(0) - size
    nx, ny = (numpy.ceil((samples.max(0) - samples.min(0)) / size).astype(int) + 3).tolist()
    keys = ((samples[:, 1] - bottom) // size).astype(int) * nx + ((samples[:, 0] - left) // size).astype(int)
    order = numpy.argsort(keys, kind="stable")
    starts = numpy.searchsorted(keys[order], numpy.arange(nx * ny + 1))
    return order, starts, left, bottom, size, nx, ny


def walls(path, scene, motion, body, faults):
    """What stands on walls at the end, and how near other moves come to walls that have their size."""
    samples, reachable, done_below = wall_samples(scene)
    needs = numpy.zeros(len(path.chords), numpy.int64)
    flat = path.floor >= 0
    needs[numpy.isin(path.kinds, (RAPID, PLUNGE, RAMP, LINK)) | (numpy.isin(path.kinds, (LEAD_IN, LEAD_OUT)) & ~flat)] = 1
    # Of a lead along the floor its outer end alone must be clear.
    lead_in, lead_out = flat & (path.kinds == LEAD_IN), flat & (path.kinds == LEAD_OUT)
    needs[lead_in & ~numpy.append(False, lead_in[:-1])] = 2
    needs[lead_out & ~numpy.append(lead_out[1:], False)] = 3
    needs[~path.low_moves[path.owners]] = 0
    stands, clear = walls_over_time(
        path.rows, path.floor, path.layers, needs, samples, done_below, *sorted_samples(samples, scene.radius / 2),
        max(1, len(path.levels)), scene.radius, scene.left_mm, REACH_MM)
    asked = body.get("clearance_side_mm") or max(0.2, scene.radius / 25)
    near = numpy.flatnonzero((needs > 0) & (clear < asked - 1e-3))
    listed = {}
    for k in near:
        m = path.owners[k]
        if m not in listed or clear[k] < listed[m][0]:
            listed[m] = (clear[k], NAMES[path.kinds[k]], path.where(k))
    simple = numpy.minimum(path.wall[:-1], path.wall[1:])[needs == 1]
    final = numpy.array([stands[level:].min(0) for level in range(len(path.levels))]).reshape(-1, len(samples))
    most = final[:, reachable].max() if final.size and reachable.any() else 0.0
    lowest = final[:, reachable].min() if final.size and reachable.any() else 0.0
    if most - scene.left_mm > 2e-3:
        level, w = numpy.unravel_index(numpy.where(reachable, final, -1).argmax(), final.shape)
        amount = f"{most:.4f}" if most < 1e6 else "over 1"
        faults.append(f"{amount} mm stands on the wall at ({samples[w, 0]:.2f}, {samples[w, 1]:.2f}, {path.levels[level]:.2f})")
    if scene.left_mm - lowest > 2e-3:
        faults.append(f"only {lowest:.4f} mm is left on the wall, not {scene.left_mm}")
    return {"clear": min([clear.min(initial=REACH_MM)]), "clear_asked": asked, "n_near": len(listed),
            "near": sorted(listed.values())[:20], "clear_simple": simple.min(initial=scene.reach) - scene.radius,
            "stands_most": min(most, 99.0), "stands_least": lowest, "stands_mean_over": float(numpy.mean(final[:, reachable] > scene.left_mm + 2e-3)) if final.size else 0.0}


def wall_runs(path, scene):
    """First and last chords of wall passes."""
    near = numpy.zeros(len(path.wall), bool)
    for left in {0.0, scene.left_mm}:
        near |= numpy.abs(path.wall - scene.radius - left) <= WALL_PASS_MM
    on = (path.floor >= 0) & near[:-1] & near[1:]
    edges = numpy.flatnonzero(numpy.diff(numpy.concatenate([[0], on.astype(int), [0]])))
    runs = [(a, b - 1) for a, b in zip(edges[::2], edges[1::2])]
    return [(a, b) for a, b in runs if path.lengths[a:b + 1].sum() >= WALL_RUN_MM]


def leads(path, scene, motion, body, faults):
    """How wall passes begin and end: the largest kink at their ends, and what they overlap."""
    window = 0.06 * scene.radius + 0.05
    runs = wall_runs(path, scene)
    without, worst, overlaps, open_runs, bad = 0, 0.0, [], 0, []
    for first, last in runs:
        for end, step in ((first, -1), (last, 1)):
            angle, k, walked = 0.0, end, 0.0
            # From a little inside the pass outward, over what is within the window.
            while walked < window and first <= k - step <= last:
                k -= step
                walked += path.lengths[k]
            walked = -walked
            lone = False
            while walked < window:
                after = k + step
                if not 0 <= after < len(path.chords) or path.floor[after] < 0:
                    lone = True
                    break
                if path.owners[after] != path.owners[k]:
                    pair = (path.owners[k], path.owners[after]) if step > 0 else (path.owners[after], path.owners[k])
                    angle = max(angle, turn_between(motion, *pair))
                k = after
                walked += path.lengths[k]
            without += lone
            if not lone:
                worst = max(worst, angle)
            if lone or angle > 1.0:
                bad.append(f"{'no lead' if lone else f'{angle:.0f} deg'} {'in' if step < 0 else 'out'} at {path.where(end)}")
        along = numpy.cumsum(path.lengths[first:last + 1])
        early = along < along[-1] / 2
        far = numpy.hypot(*(path.chords[first:last + 1, :2][early] - path.chords[last, 3:5]).T)
        if len(far) and far.min() < 0.06:
            overlaps.append(along[far.argmin()] - path.lengths[first + far.argmin()])
        else:
            open_runs += 1
    return {"n_wall_passes": len(runs), "no_lead": without, "lead_ends": 2 * len(runs), "lead_kink": worst, "lead_bad": bad,
            "overlap_least": min(overlaps, default=float("nan")), "open_wall_passes": open_runs}


def turn_between(motion, before, after):
    """Angle between two moves at their joint, degrees."""
    a, b = motion.directions[before, 2:], motion.directions[after, :2]
    if not a.any() or not b.any():
        return 0.0
    return math.degrees(abs(math.atan2(a[0] * b[1] - a[1] * b[0], a @ b)))


def kinks(path, scene, motion, body, faults):
    """Kinks of roughing passes on the floor."""
    last = numpy.searchsorted(path.owners, numpy.arange(len(motion.moves)), "right") - 1
    found, previous = [], -1
    for m in range(len(motion.moves)):
        if motion.moves[m, FLAT] < 0.01 and path.floor[last[m]] >= 0:
            continue
        if previous >= 0 and path.floor[last[m]] >= 0 and path.floor[last[previous]] == path.floor[last[m]]:
            if not numpy.any(path.floor[last[previous] + 1:last[m]] < 0):
                angle = turn_between(motion, previous, m)
                if angle > KINK_DEG and path.wall[last[previous] + 1] > scene.radius + scene.left_mm + ROUGH_MM:
                    found.append((angle, path.where(last[previous])))
        previous = m
    return {"kinks": len(found), "kinks_listed": sorted(found, reverse=True)[:10]}


def times(path, scene, motion, body, faults):
    """Time of each level over area / (stepover x feed), and its lifts."""
    first = numpy.searchsorted(path.owners, numpy.arange(len(motion.moves)))
    last = numpy.searchsorted(path.owners, numpy.arange(len(motion.moves)), "right") - 1
    deepest = numpy.array([path.layers[a:b + 1].max() for a, b in zip(first, last)])
    # A move above the stock belongs to the level that follows, at the end to the one before.
    owner = deepest.copy()
    for m in range(len(owner) - 2, -1, -1):
        if owner[m] < 0:
            owner[m] = owner[m + 1]
    for m in range(1, len(owner)):
        if owner[m] < 0:
            owner[m] = owner[m - 1]
    count = max(1, len(path.levels))
    minutes, lifts = [], []
    for level in range(count):
        minutes.append(motion.minutes[owner == level].sum())
        up = [m for m in range(len(owner)) if deepest[m] == level and motion.moves[m, TZ] > motion.moves[m, FZ] + HEIGHT_MM
              and (motion.kinds[m] == RAPID or motion.moves[m, TZ] >= (path.levels[level - 1] if level else path.top) - HEIGHT_MM)]
        cuts = numpy.flatnonzero((owner == level) & (motion.kinds == CUT))
        lifts.append(sum(1 for m in up if len(cuts) and m < cuts[-1]))
    return {"minutes": minutes, "lifts": lifts, "total_s": 60 * motion.minutes.sum()}


def depths(path, scene, motion, body, faults):
    """Distances of levels, and the floor."""
    if not path.levels:
        return {"stepdown": 0.0}
    tops = [path.top, *path.levels[:-1]]
    step = max(a - b for a, b in zip(tops, path.levels))
    if step > body["stepdown_max_mm"] + 1e-3:
        faults.append(f"stepdown {step:.4f}")
    floor = body["floor_z_mm"] + (0.0 if body.get("finish") and body["finish"].get("floor") is not None else float(body.get("floor_allowance_mm") or 0.0))
    lowest = motion.moves[:, TZ].min()
    if abs(lowest - floor) > 1e-3:
        faults.append(f"the lowest move is at {lowest:.4f}, the floor at {floor:.4f}")
    return {"stepdown": step}
