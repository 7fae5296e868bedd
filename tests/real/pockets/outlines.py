"""Outlines of lines and arcs: distances, insides and offsets, in closed form.

An element is a row of numbers: kind (0 line, 1 arc), start x and y, end x and y, and for an arc its centre x and y, radius,
start angle and signed sweep, in mm and radians. Distances are those to the exact element.
"""

import math

import numpy
from numba import njit

# Columns of an element.
KIND, X0, Y0, X1, Y1, CX, CY, RADIUS, ANGLE, SWEEP = range(10)
COLUMNS = 10
# A bulge below this is a straight line.
FLAT_BULGE = 1e-12
# Angle that a chord of a filled outline spans at most, radians: its sagitta is then below 1e-4 of the radius.
FILL_CHORD = 0.02


def element(start, end, bulge=0.0):
    """The element from `start` to `end` with the bulge of DXF."""
    (x0, y0), (x1, y1) = start, end
    row = [0.0, x0, y0, x1, y1, 0.0, 0.0, 0.0, 0.0, 0.0]
    if abs(bulge) > FLAT_BULGE:
        along = (1 / bulge - bulge) / 4
        cx = (x0 + x1) / 2 - along * (y1 - y0)
        cy = (y0 + y1) / 2 + along * (x1 - x0)
        row = [1.0, x0, y0, x1, y1, cx, cy, math.hypot(x0 - cx, y0 - cy), math.atan2(y0 - cy, x0 - cx), 4 * math.atan(bulge)]
    return row


def elements(outline):
    """The elements of a closed outline of vertices [x, y] or [x, y, bulge]."""
    rows = []
    for k, vertex in enumerate(outline):
        after = outline[(k + 1) % len(outline)]
        if math.hypot(after[0] - vertex[0], after[1] - vertex[1]) > 0:
            rows.append(element(vertex[:2], after[:2], vertex[2] if len(vertex) > 2 else 0.0))
    return numpy.array(rows, dtype=float).reshape(-1, COLUMNS)


def points(rows, spacing):
    """Points on elements, about `spacing` mm apart, with the normals to their left."""
    found, normals = [], []
    for row in rows:
        if row[KIND] == 0:
            length = math.hypot(row[X1] - row[X0], row[Y1] - row[Y0])
            shares = (numpy.arange(max(1, math.ceil(length / spacing))) + 0.5) / max(1, math.ceil(length / spacing))
            found.append(numpy.stack([row[X0] + shares * (row[X1] - row[X0]), row[Y0] + shares * (row[Y1] - row[Y0])], 1))
            normal = [-(row[Y1] - row[Y0]) / length, (row[X1] - row[X0]) / length]
            normals.append(numpy.tile(normal, (len(shares), 1)))
        else:
            number = max(2, math.ceil(abs(row[SWEEP]) * row[RADIUS] / spacing))
            angles = row[ANGLE] + row[SWEEP] * (numpy.arange(number) + 0.5) / number
            outward = numpy.stack([numpy.cos(angles), numpy.sin(angles)], 1)
            found.append(row[[CX, CY]] + row[RADIUS] * outward)
            normals.append(-outward * math.copysign(1, row[SWEEP]))
    return numpy.concatenate(found), numpy.concatenate(normals)


def polygon(rows):
    """The corners of a polygon that follows the elements."""
    corners = []
    for row in rows:
        if row[KIND] == 0:
            corners.append([[row[X0], row[Y0]]])
        else:
            number = max(2, math.ceil(abs(row[SWEEP]) / FILL_CHORD))
            angles = row[ANGLE] + row[SWEEP] * numpy.arange(number) / number
            corners.append(numpy.stack([row[CX] + row[RADIUS] * numpy.cos(angles), row[CY] + row[RADIUS] * numpy.sin(angles)], 1))
    return numpy.concatenate(corners).astype(float)


@njit(cache=True)
def distance(row, x, y):
    """Distance of a point to an element."""
    if row[0] == 0.0:
        dx, dy = row[3] - row[1], row[4] - row[2]
        square = dx * dx + dy * dy
        share = 0.0
        if square > 0.0:
            share = min(1.0, max(0.0, ((x - row[1]) * dx + (y - row[2]) * dy) / square))
        return math.hypot(x - row[1] - share * dx, y - row[2] - share * dy)
    dx, dy = x - row[5], y - row[6]
    turn = math.atan2(dy, dx) - row[8]
    if row[9] < 0.0:
        turn = -turn
    turn -= 2 * math.pi * math.floor(turn / (2 * math.pi))
    if turn <= abs(row[9]):
        return abs(math.hypot(dx, dy) - row[7])
    return min(math.hypot(x - row[1], y - row[2]), math.hypot(x - row[3], y - row[4]))


@njit(cache=True)
def bucket_lists(rows, left, bottom, size, nx, ny, reach):
    """For each square of a grid the elements within `reach` of any of its points, as counts' sums and a list of indices."""
    near = reach + size * 0.7072
    starts = numpy.zeros(nx * ny + 1, numpy.int64)
    lists = numpy.zeros(0, numpy.int64)
    for pass_ in range(2):
        total = 0
        for j in range(ny):
            for i in range(nx):
                x, y = left + (i + 0.5) * size, bottom + (j + 0.5) * size
                starts[j * nx + i] = total
                for k in range(len(rows)):
                    if distance(rows[k], x, y) <= near:
                        if pass_ == 1:
                            lists[total] = k
                        total += 1
        starts[nx * ny] = total
        if pass_ == 0:
            lists = numpy.zeros(total, numpy.int64)
    return starts, lists


@njit(cache=True)
def nearest(rows, starts, lists, left, bottom, size, nx, ny, reach, x, y):
    """Distance of a point to the elements, at most `reach`."""
    i, j = int(math.floor((x - left) / size)), int(math.floor((y - bottom) / size))
    least = reach
    if 0 <= i < nx and 0 <= j < ny:
        for at in range(starts[j * nx + i], starts[j * nx + i + 1]):
            least = min(least, distance(rows[lists[at]], x, y))
    else:
        for k in range(len(rows)):
            least = min(least, distance(rows[k], x, y))
    return least


@njit(cache=True)
def nearest_all(rows, starts, lists, left, bottom, size, nx, ny, reach, xs, ys):
    """`nearest` for many points."""
    found = numpy.empty(len(xs))
    for k in range(len(xs)):
        found[k] = nearest(rows, starts, lists, left, bottom, size, nx, ny, reach, xs[k], ys[k])
    return found


@njit(cache=True)
def fill(mask, corners, left, bottom, cell, value):
    """Sets the cells whose middles are inside a polygon."""
    ny, nx = mask.shape
    number = len(corners)
    crossings = numpy.empty(number + 1)
    for j in range(ny):
        y = bottom + (j + 0.5) * cell
        count = 0
        for k in range(number):
            x0, y0 = corners[k]
            x1, y1 = corners[(k + 1) % number]
            if (y0 <= y) != (y1 <= y):
                crossings[count] = x0 + (y - y0) / (y1 - y0) * (x1 - x0)
                count += 1
        ordered = numpy.sort(crossings[:count])
        for k in range(0, count - 1, 2):
            first = max(0, int(math.ceil((ordered[k] - left) / cell - 0.5)))
            last = min(nx - 1, int(math.floor((ordered[k + 1] - left) / cell - 0.5)))
            for i in range(first, last + 1):
                mask[j, i] = value


class Outlines:
    """Elements of several outlines, with the distance of any point to the nearest of them, up to `reach` mm."""

    def __init__(self, outlines, reach, bucket):
        self.parts = [elements(one) for one in outlines]
        self.rows = numpy.concatenate(self.parts) if self.parts else numpy.zeros((0, COLUMNS))
        around = numpy.concatenate([polygon(part) for part in self.parts])
        self.low, self.high = around.min(0), around.max(0)
        left, bottom = self.low - reach
        nx, ny = (numpy.ceil((self.high - self.low + 2 * reach) / bucket).astype(int) + 1).tolist()
        starts, lists = bucket_lists(self.rows, left, bottom, bucket, nx, ny, reach)
        self.buckets = (self.rows, starts, lists, left, bottom, bucket, nx, ny, reach)

    def distances(self, xs, ys):
        return nearest_all(*self.buckets, numpy.ascontiguousarray(xs, float).ravel(), numpy.ascontiguousarray(ys, float).ravel()).reshape(numpy.shape(xs))


class Raster:
    """Square cells over a rectangle."""

    def __init__(self, low, high, cell):
        self.cell = cell
        self.left, self.bottom = float(low[0]) - 3 * cell, float(low[1]) - 3 * cell
        self.nx = int(math.ceil((high[0] - low[0]) / cell)) + 6
        self.ny = int(math.ceil((high[1] - low[1]) / cell)) + 6

    def middles(self):
        xs = self.left + (numpy.arange(self.nx) + 0.5) * self.cell
        ys = self.bottom + (numpy.arange(self.ny) + 0.5) * self.cell
        return numpy.meshgrid(xs, ys)

    def inside(self, boundary, islands):
        """The cells inside an outline and outside all islands."""
        mask = numpy.zeros((self.ny, self.nx), numpy.bool_)
        fill(mask, polygon(elements(boundary)), self.left, self.bottom, self.cell, True)
        for island in islands:
            fill(mask, polygon(elements(island)), self.left, self.bottom, self.cell, False)
        return mask

    def signed(self, boundary, islands, reach, bucket):
        """Distance of each cell's middle to the outlines, above zero inside, at most `reach`."""
        outlines = Outlines([boundary, *islands], reach, bucket)
        far = outlines.distances(*self.middles())
        return numpy.where(self.inside(boundary, islands), far, -far), outlines
