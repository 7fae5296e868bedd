"""The disc of the cutter, moved over cells of the stock in the order of the path.

For each level a field holds, for the middle of each cell, the distance to the nearest place of the cutter's centre at that
level so far. Where this distance is above the cutter's radius, material stands. Between the middles the field is
interpolated, so the edge of the material is known to a small part of a cell. Right behind the cutter its path is looked up
exactly, because there the field would blur what the rim has cut just now.
"""

import math

import numpy
from numba import njit

from outlines import distance

# The path enters the field only this far behind the cutter, as a share of its radius.
DELAY = 0.3
# The path enters the field in lumps of about this length, as a share of the radius.
LUMP = 0.2
# What interpolation may be off, as a share of the radius: nearer to the edge of the material, or to a wall, is no contact.
FIELD_SLACK = 0.002
WALL_SLACK = 0.004
# A move that must not cut is looked at again after this share of the radius.
LOOK = 0.25

RAPID, CUT, PLUNGE, RAMP, LEAD_IN, LINK, LEAD_OUT = range(7)


@njit(cache=True)
def between(field, left, bottom, cell, x, y):
    """The field at a point, interpolated between the middles of four cells."""
    u, v = (x - left) / cell - 0.5, (y - bottom) / cell - 0.5
    i, j = int(math.floor(u)), int(math.floor(v))
    if i < 0 or j < 0 or i + 1 >= field.shape[1] or j + 1 >= field.shape[0]:
        return -1.0
    u -= i
    v -= j
    return (1 - v) * ((1 - u) * field[j, i] + u * field[j, i + 1]) + v * ((1 - u) * field[j + 1, i] + u * field[j + 1, i + 1])


@njit(cache=True)
def is_above(field, left, bottom, cell, x, y, limit):
    """Whether the field at a point is above a limit: far from the limit one cell tells."""
    i, j = int((x - left) / cell), int((y - bottom) / cell)
    if i < 1 or j < 1 or i + 1 >= field.shape[1] or j + 1 >= field.shape[0]:
        return False
    here = field[j, i]
    # The point is at most 0.71 cells from the middle, and a distance changes no faster than its place.
    if here > limit + cell:
        return True
    if here < limit - cell:
        return False
    return between(field, left, bottom, cell, x, y) > limit


@njit(cache=True)
def to_chord(x, y, x0, y0, x1, y1):
    dx, dy = x1 - x0, y1 - y0
    square = dx * dx + dy * dy
    share = 0.0
    if square > 0.0:
        share = min(1.0, max(0.0, ((x - x0) * dx + (y - y0) * dy) / square))
    ex, ey = x - x0 - share * dx, y - y0 - share * dy
    return math.sqrt(ex * ex + ey * ey)


@njit(cache=True)
def stamp(field, left, bottom, cell, radius, x0, y0, x1, y1):
    """Enters a chord of the centre's path into a field."""
    far = radius + 2.5 * cell
    deep = radius - 3.0 * cell
    ny, nx = field.shape
    low = max(0, int(math.floor((min(y0, y1) - far - bottom) / cell - 0.5)))
    high = min(ny - 1, int(math.ceil((max(y0, y1) + far - bottom) / cell - 0.5)))
    first = max(0, int(math.floor((min(x0, x1) - far - left) / cell - 0.5)))
    last = min(nx - 1, int(math.ceil((max(x0, x1) + far - left) / cell - 0.5)))
    for j in range(low, high + 1):
        y = bottom + (j + 0.5) * cell
        for i in range(first, last + 1):
            # What is deep in cut ground need not be known better.
            if field[j, i] > deep:
                there = to_chord(left + (i + 0.5) * cell, y, x0, y0, x1, y1)
                if there < field[j, i] and there <= far:
                    field[j, i] = there


@njit(cache=True)
def is_straight(before, after):
    """Whether a chord goes on in the direction of the chord before it."""
    ax, ay = before[3] - before[0], before[4] - before[1]
    bx, by = after[3] - after[0], after[4] - after[1]
    return abs(ax * by - ay * bx) < 1e-9 and ax * bx + ay * by > 0


@njit(cache=True)
def enter(chords, levels, first, end, fields, left, bottom, cell, radius):
    """Enters chords into the fields of their levels; chords of one straight line go together."""
    k = first
    while k < end:
        last = k
        if levels[k] >= 0:
            while last + 1 < end and levels[last + 1] == levels[k] and is_straight(chords[last], chords[last + 1]):
                last += 1
            stamp(fields[levels[k]], left, bottom, cell, radius, chords[k, 0], chords[k, 1], chords[last, 3], chords[last, 4])
        k = last + 1


@njit(cache=True)
def meets(field, signed, left, bottom, cell, radius, x, y):
    """Whether the disc about a place touches material that stands, with a margin of a cell and a half."""
    within = radius - 1.5 * cell
    ny, nx = field.shape
    low = max(0, int(math.ceil((y - within - bottom) / cell - 0.5)))
    high = min(ny - 1, int(math.floor((y + within - bottom) / cell - 0.5)))
    for j in range(low, high + 1):
        dy = bottom + (j + 0.5) * cell - y
        half = math.sqrt(max(0.0, within * within - dy * dy))
        first = max(0, int(math.ceil((x - half - left) / cell - 0.5)))
        last = min(nx - 1, int(math.floor((x + half - left) / cell - 0.5)))
        for i in range(first, last + 1):
            if field[j, i] > radius + 0.25 * cell and signed[j, i] > 1.5 * cell:
                return True
    return False


@njit(cache=True)
def sweep(chords, levels, layers, kinds, fields, signed, left, bottom, cell, radius, rim):
    """Moves the cutter along chords (x0, y0, z0, x1, y1, z1).

    levels: level whose floor a feed chord follows, else -1; layers: the layer that the chord's lowest point is in, -1 above the
    stock; rim: cosines and sines of points of the leading half circle, from the left to the right.
    Returns for each chord the angle in material, the angle in material that stands in the layer above, too (radians), and whether
    a chord that does not follow a floor meets material.
    """
    number = len(chords)
    angles, above = numpy.zeros(number), numpy.zeros(number)
    hits = numpy.zeros(number, numpy.bool_)
    along = numpy.zeros(number + 1)
    # Chords from `pending` on are not in the field yet; the path last turned where chord `turned` begins.
    pending = turned = 0
    looked = -1e9
    step = math.pi / len(rim)
    for k in range(number):
        x0, y0, z0, x1, y1, z1 = chords[k]
        length = math.hypot(x1 - x0, y1 - y0)
        along[k + 1] = along[k] + length
        if levels[k] < 0:
            enter(chords, levels, pending, k, fields, left, bottom, cell, radius)
            pending = turned = k + 1
            if layers[k] >= 0 and kinds[k] != RAMP and not (length < 1e-9 and z1 >= z0):
                if z1 < z0 or along[k + 1] - looked > LOOK * radius or (k + 1 < number and kinds[k + 1] != kinds[k]):
                    looked = along[k + 1]
                    hits[k] = meets(fields[layers[k]], signed, left, bottom, cell, radius, x1, y1)
            continue
        level = levels[k]
        if k > pending and not is_straight(chords[k - 1], chords[k]):
            turned = k
        if along[k] - along[pending] > (DELAY + LUMP) * radius:
            first = pending
            while pending < k and along[k] - along[pending + 1] > DELAY * radius:
                pending += 1
            enter(chords, levels, first, pending, fields, left, bottom, cell, radius)
        if length < 1e-9:
            continue
        ux, uy = (x1 - x0) / length, (y1 - y0) / length
        mx, my = (x0 + x1) / 2, (y0 + y1) / 2
        field = fields[level]
        count, count_above = 0, 0
        for r in range(len(rim)):
            # A point of the rim: `rim` holds its parts along the motion and to its left.
            x = mx + radius * (rim[r, 0] * ux - rim[r, 1] * uy)
            y = my + radius * (rim[r, 0] * uy + rim[r, 1] * ux)
            if not is_above(field, left, bottom, cell, x, y, radius * (1 + FIELD_SLACK)):
                continue
            if not is_above(signed, left, bottom, cell, x, y, WALL_SLACK * radius):
                continue
            fresh = True
            if turned > pending:
                for p in range(pending, k):
                    c = chords[p]
                    if to_chord(x, y, c[0], c[1], c[3], c[4]) < radius * (1 - 1e-4):
                        fresh = False
                        break
            if fresh:
                count += 1
                if level > 0 and is_above(fields[level - 1], left, bottom, cell, x, y, radius * (1 + FIELD_SLACK)):
                    count_above += 1
        angles[k] = count * step
        above[k] = count_above * step
    enter(chords, levels, pending, number, fields, left, bottom, cell, radius)
    return angles, above, hits


@njit(cache=True)
def near_samples(order, starts, left, bottom, size, nx, ny, x, y, reach, found):
    """Writes the indices of samples in squares within `reach` of a point; returns their number."""
    count = 0
    first, last = max(0, int((x - reach - left) // size)), min(nx - 1, int((x + reach - left) // size))
    low, high = max(0, int((y - reach - bottom) // size)), min(ny - 1, int((y + reach - bottom) // size))
    for j in range(low, high + 1):
        for i in range(first, last + 1):
            for at in range(starts[j * nx + i], starts[j * nx + i + 1]):
                found[count] = order[at]
                count += 1
    return count


@njit(cache=True)
def walls_over_time(rows, levels, layers, needs, samples, done_below, order, starts, left, bottom, size, nx, ny, n_levels, radius, left_mm, reach):
    """What stands on samples of the walls, and the distance of moves that must keep clear to samples that have reached their size.

    rows: the chords as elements, in order. needs: 0 nothing, 1 the whole chord, 2 its start, 3 its end keep clear.
    A sample has reached its size in a layer once no more than its `done_below` stands on it, mm.
    Returns what stands for each level and sample (mm), and for each chord its clearance (mm, `reach` where there is none): the
    distance from the cutter's side to what stands on finished samples.
    """
    stands = numpy.full((n_levels, len(samples)), 1e9)
    done = numpy.zeros((n_levels, len(samples)), numpy.bool_)
    clear = numpy.full(len(rows), reach)
    found = numpy.empty(len(samples), numpy.int64)
    for k in range(len(rows)):
        row = rows[k]
        x, y = (row[1] + row[3]) / 2, (row[2] + row[4]) / 2
        half = math.hypot(row[3] - row[1], row[4] - row[2]) / 2
        if needs[k] > 0 and layers[k] >= 0:
            count = near_samples(order, starts, left, bottom, size, nx, ny, x, y, radius + reach + half, found)
            for at in range(count):
                w = found[at]
                rest = 1e9
                for level in range(layers[k] + 1):
                    if done[level, w]:
                        rest = min(rest, stands[level, w])
                if rest < 1e9:
                    if needs[k] == 1:
                        far = distance(row, samples[w, 0], samples[w, 1])
                    elif needs[k] == 2:
                        far = math.hypot(row[1] - samples[w, 0], row[2] - samples[w, 1])
                    else:
                        far = math.hypot(row[3] - samples[w, 0], row[4] - samples[w, 1])
                    clear[k] = min(clear[k], far - radius - max(0.0, rest))
        if levels[k] >= 0:
            count = near_samples(order, starts, left, bottom, size, nx, ny, x, y, radius + left_mm + 1.0 + half, found)
            for at in range(count):
                w = found[at]
                far = distance(row, samples[w, 0], samples[w, 1]) - radius
                if far < stands[levels[k], w]:
                    stands[levels[k], w] = far
                    if far <= done_below[w]:
                        done[levels[k], w] = True
    return stands, clear
