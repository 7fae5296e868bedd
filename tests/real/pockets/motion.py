"""Moves of an answer as an array, and as chords short enough for a raster."""

import math

import numpy
from numba import njit

from outlines import nearest
from sweeping import CUT, LEAD_IN, LEAD_OUT, LINK, PLUNGE, RAMP, RAPID

ROLES = {"cut": CUT, "plunge": PLUNGE, "ramp": RAMP, "lead_in": LEAD_IN, "link": LINK, "lead_out": LEAD_OUT}
# Columns of a move: kind (0 line, 1 arc), its ends, centre, radii at both ends, start angle, signed sweep, length in the plane.
ARC, FX, FY, FZ, TX, TY, TZ, CX, CY, R0, R1, A0, TURN, FLAT = range(14)
# Longest chord, mm, and the sagitta that it may have on an arc, as a share of the cutter's radius.
CHORD_MM = 0.1
SAGITTA_SHARE = 1e-4
# Heights that differ by less are the same, mm.
HEIGHT_MM = 1e-4


class Motion:
    """All moves of an answer, in order: `moves`, `kinds`, `feeds` (mm/min, of rapids the traverse rate) and their times in minutes."""

    def __init__(self, answer, body):
        rapid = body["cutting"].get("rapid_feed_mm_per_min") or 10000.0
        at = answer["toolpath"]["start"]
        rows, kinds, feeds = [], [], []
        for one in answer["toolpath"]["passes"]:
            for move in one["moves"]:
                if move["kind"] == "dwell":
                    continue
                if move["kind"] not in ("rapid", "line", "arc"):
                    raise ValueError(f"a pocket has no move of kind {move['kind']}")
                rows.append(move_row(move, at))
                kinds.append(RAPID if move["kind"] == "rapid" else ROLES[move.get("role", "cut")])
                feeds.append(rapid if move["kind"] == "rapid" else move["feed_mm_per_min"])
                at = move["to"]
        self.moves = numpy.array(rows)
        self.kinds = numpy.array(kinds)
        self.feeds = numpy.array(feeds)
        self.lengths = numpy.hypot(self.moves[:, FLAT], self.moves[:, TZ] - self.moves[:, FZ])
        self.minutes = self.lengths / self.feeds
        self.directions = numpy.array([ends_of(row) for row in self.moves])

    def levels(self):
        """Heights on which the cutter cuts level, from the top down; a height on which it hardly cuts is none."""
        level = (numpy.abs(self.moves[:, TZ] - self.moves[:, FZ]) < HEIGHT_MM) & (self.kinds == CUT) & (self.moves[:, FLAT] > 0)
        sums = {}
        for z, length in zip(self.moves[level, TZ], self.moves[level, FLAT]):
            key = next((one for one in sums if abs(one - z) < 2 * HEIGHT_MM), z)
            sums[key] = sums.get(key, 0.0) + length
        most = max(sums.values(), default=0.0)
        return sorted((z for z, length in sums.items() if length > 0.01 * most), reverse=True)


def move_row(move, at):
    (x0, y0, z0), (x1, y1, z1) = at, move["to"]
    if move["kind"] != "arc":
        return [0, x0, y0, z0, x1, y1, z1, 0, 0, 0, 0, 0, 0, math.hypot(x1 - x0, y1 - y0)]
    cx, cy = move["center"][:2]
    start, end = math.atan2(y0 - cy, x0 - cx), math.atan2(y1 - cy, x1 - cx)
    turn = (end - start) % (2 * math.pi)
    if move["direction"] == "cw":
        turn -= 2 * math.pi
    if math.hypot(x1 - x0, y1 - y0) < 1e-9:
        turn = 2 * math.pi if move["direction"] == "ccw" else -2 * math.pi
    first, last = math.hypot(x0 - cx, y0 - cy), math.hypot(x1 - cx, y1 - cy)
    return [1, x0, y0, z0, x1, y1, z1, cx, cy, first, last, start, turn, abs(turn) * (first + last) / 2]


def ends_of(row):
    """Directions of motion at the start and at the end, in the plane; zero for a move straight down or up."""
    if row[ARC]:
        sign = math.copysign(1, row[TURN])
        start, end = row[A0], row[A0] + row[TURN]
        return [-sign * math.sin(start), sign * math.cos(start), -sign * math.sin(end), sign * math.cos(end)]
    if row[FLAT] < 1e-12:
        return [0.0, 0.0, 0.0, 0.0]
    ux, uy = (row[TX] - row[FX]) / row[FLAT], (row[TY] - row[FY]) / row[FLAT]
    return [ux, uy, ux, uy]


@njit(cache=True)
def place(row, share):
    """Where a move is after a share of its length."""
    z = row[3] + share * (row[6] - row[3])
    if row[0] == 0.0:
        return row[1] + share * (row[4] - row[1]), row[2] + share * (row[5] - row[2]), z
    angle = row[11] + share * row[12]
    radius = row[9] + share * (row[10] - row[9])
    return row[7] + radius * math.cos(angle), row[8] + radius * math.sin(angle), z


@njit(cache=True)
def chords_of(moves, counts):
    """Chords (x0, y0, z0, x1, y1, z1) of all moves, the same as elements, and the move of each."""
    total = counts.sum()
    chords, rows, owners = numpy.empty((total, 6)), numpy.zeros((total, 10)), numpy.empty(total, numpy.int64)
    at = 0
    for m in range(len(moves)):
        x0, y0, z0 = moves[m, 1], moves[m, 2], moves[m, 3]
        for k in range(counts[m]):
            if k + 1 == counts[m]:
                x1, y1, z1 = moves[m, 4], moves[m, 5], moves[m, 6]
            else:
                x1, y1, z1 = place(moves[m], (k + 1) / counts[m])
            chords[at] = (x0, y0, z0, x1, y1, z1)
            rows[at, 1:5] = (x0, y0, x1, y1)
            if moves[m, 0] == 1.0 and moves[m, 13] > 1e-9:
                rows[at, 0] = 1.0
                rows[at, 5:8] = (moves[m, 7], moves[m, 8], moves[m, 9])
                rows[at, 8] = math.atan2(y0 - moves[m, 8], x0 - moves[m, 7])
                rows[at, 9] = moves[m, 12] / counts[m]
            owners[at] = m
            x0, y0, z0 = x1, y1, z1
            at += 1
    return chords, rows, owners


def counts_of(moves, low, radius):
    """Numbers of chords: one for a move that stays above the stock."""
    longest = numpy.full(len(moves), min(CHORD_MM, radius / 15))
    arcs = moves[:, ARC] == 1
    longest[arcs] = numpy.minimum(longest[arcs], numpy.sqrt(8 * SAGITTA_SHARE * radius * numpy.maximum(moves[arcs, R0], 1e-3)))
    counts = numpy.maximum(1, numpy.ceil(moves[:, FLAT] / longest - 1e-9)).astype(numpy.int64)
    counts[~low] = 1
    return counts


@njit(cache=True)
def least_distances(moves, firsts, counts, owners, chosen, fine, inside, left, bottom, cell, rows, starts, lists, grid_left, grid_bottom, size, nx, ny, reach):
    """For each chosen chord the least distance of its part of the move to the outlines, below zero in the part."""
    found = numpy.empty(len(chosen))
    for at in range(len(chosen)):
        k = chosen[at]
        m = owners[k]
        number = max(2, int(math.ceil(moves[m, 13] / counts[m] / fine)))
        least = reach
        for n in range(number + 1):
            x, y, _ = place(moves[m], (k - firsts[m] + n / number) / counts[m])
            far = nearest(rows, starts, lists, grid_left, grid_bottom, size, nx, ny, reach, x, y)
            i, j = int((x - left) / cell), int((y - bottom) / cell)
            if far > 2 * cell and not (0 <= i < inside.shape[1] and 0 <= j < inside.shape[0] and inside[j, i]):
                far = -far
            least = min(least, far)
        found[at] = least
    return found
