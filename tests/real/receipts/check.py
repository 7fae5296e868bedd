#!/usr/bin/env python3
"""Checks a receipt of /v1/programs/verify. Needs nothing but Python, and shares nothing with the service.

Usage: check.py RECEIPT PROGRAM PART [PUBLIC_KEY]

RECEIPT     the receipt, or an answer that holds it, in JSON
PROGRAM     the NC text, or the toolpath in JSON
PART        the request that was verified, in JSON, or its members of part, tools, stock, fixtures and travel
PUBLIC_KEY  the key that has to have signed, as `signature.public_key` states it

What is checked:
1. The digest of the receipt, its signature, and the digests of program, part, tools, stock, fixtures and travel.
2. Whether verdict, counts and bounds go together.
3. For an upright pocket: the depth of the cutter in walls and floor, proved anew over the whole of each move, to a
   quarter of the tolerance. For a surface of Bezier patches: the same at places close to each other, which can refute
   a bound and not prove it. For other surfaces, and for programs with words that this checker does not read, it says
   that the bounds were not checked.

Distances from clamps and from the holder, the travel, and what becomes of the stock are not proved anew. The exit code
is 0 where the receipt holds, 1 where it is rejected, 3 where it holds as far as it was checked.
"""
import base64
import hashlib
import json
import math
import re
import sys


def no_number(text):
    raise Rejected(f"{text} is no number of JSON")


def once(members):
    """The members of an object, none of which may stand twice."""
    if len(dict(members)) < len(members):
        raise Rejected("a member stands twice")
    return dict(members)


def read_json(text):
    return json.loads(text, parse_constant=no_number, object_pairs_hook=once)


class Rejected(Exception):
    """The receipt does not hold."""


class Unread(Exception):
    """The checker does not know enough to check further."""


# ---------------------------------------------------------------- digests

def number_text(value):
    """A number as RFC 8785 writes it: the shortest digits, as ECMAScript prints them."""
    if isinstance(value, int):
        value = float(value)
    if value == 0:
        return "0"
    sign = "-" if value < 0 else ""
    mantissa, exponent = repr(abs(value)), 0
    if "e" in mantissa:
        mantissa, exponent = mantissa.split("e")
    whole, _, part = mantissa.partition(".")
    digits = (whole + part).lstrip("0")
    point = len(whole) + int(exponent) - (len(whole + part) - len(digits))
    digits = digits.rstrip("0")
    n = len(digits)
    if n <= point <= 21:
        return sign + digits + "0" * (point - n)
    if 0 < point <= 21:
        return sign + digits[:point] + "." + digits[point:]
    if -6 < point <= 0:
        return sign + "0." + "0" * -point + digits
    power = f"e{point - 1:+d}"
    return sign + digits[0] + ("." + digits[1:] if n > 1 else "") + power


def canonical(value):
    """Canonical JSON (RFC 8785), without members that are null."""
    if isinstance(value, bool) or value is None or isinstance(value, str):
        return json.dumps(value, ensure_ascii=False)
    if isinstance(value, (int, float)):
        return number_text(value)
    if isinstance(value, list):
        return "[" + ",".join(map(canonical, value)) + "]"
    names = sorted((name for name in value if value[name] is not None), key=lambda name: name.encode("utf-16-be"))
    return "{" + ",".join(canonical(name) + ":" + canonical(value[name]) for name in names) + "}"


def digest(value):
    text = value if isinstance(value, bytes) else canonical(value).encode()
    return hashlib.sha256(text).hexdigest()


DIGESTED = {
    "part": ["surface", "allowance_mm", "region", "top_z_mm", "floor_z_mm"],
    "tools": ["tool", "tools"],
    "stock": ["stock"],
    "fixtures": ["fixtures"],
    "travel": ["travel"],
}


def check_digests(receipt, program, part):
    content = {name: value for name, value in receipt.items() if name not in ("digest", "signature")}
    if receipt.get("digest") != digest(content):
        raise Rejected("the receipt was altered: its digest does not fit its content")
    is_text = "program" in receipt["premises"]
    own = {"program": digest(program if is_text else read_json(program))}
    for name, members in DIGESTED.items():
        own[name] = digest({member: part[member] for member in members if member in part})
    if set(receipt["digests"]) != set(own):
        raise Rejected("the receipt lacks digests, or has others")
    for name, value in own.items():
        if receipt["digests"][name] != value:
            raise Rejected(f"the receipt is stale: {name} is not what was verified")


# ---------------------------------------------------------------- signature: Ed25519, RFC 8032

PRIME = 2**255 - 19
ORDER = 2**252 + 27742317777372353535851937790883648493
CURVE = -121665 * pow(121666, -1, PRIME) % PRIME
ROOT_OF_MINUS_ONE = pow(2, (PRIME - 1) // 4, PRIME)


def point(data):
    """The point (x, y) of 32 bytes."""
    y = int.from_bytes(data, "little")
    sign, y = y >> 255, y & (2**255 - 1)
    square = (y * y - 1) * pow(CURVE * y * y + 1, -1, PRIME) % PRIME
    x = pow(square, (PRIME + 3) // 8, PRIME)
    if x * x % PRIME != square:
        x = x * ROOT_OF_MINUS_ONE % PRIME
    if x * x % PRIME != square or y >= PRIME or (x == 0 and sign):
        raise Rejected("the signature holds no point of the curve")
    return (PRIME - x if x % 2 != sign else x), y


def plus(one, other):
    (a, b), (c, d) = one, other
    product = CURVE * a * b * c * d % PRIME
    x = (a * d + b * c) * pow(1 + product, -1, PRIME)
    y = (b * d + a * c) * pow(1 - product, -1, PRIME)
    return x % PRIME, y % PRIME


def times(factor, base):
    total = (0, 1)
    while factor:
        if factor % 2:
            total = plus(total, base)
        base, factor = plus(base, base), factor // 2
    return total


def check_signature(receipt, key):
    signature = receipt.get("signature")
    if signature is None:
        if key:
            raise Rejected("the receipt is not signed")
        return
    if set(signature) != {"algorithm", "public_key", "value"} or signature["algorithm"] != "ed25519":
        raise Rejected("the signature is of another kind")
    if key and signature["public_key"] != key:
        raise Rejected("another key has signed the receipt")
    try:
        public, value = (base64.b64decode(signature[name], validate=True) for name in ("public_key", "value"))
    except ValueError:
        raise Rejected("the signature is no base64") from None
    if any(base64.b64encode(own).decode() != signature[name] for own, name in ((public, "public_key"), (value, "value"))):
        raise Rejected("the signature is written in an unusual way")
    if len(public) != 32 or len(value) != 64:
        raise Rejected("the signature has another length")
    text = f"toolpathd receipt 1\n{receipt['digest']}".encode()
    first, second = value[:32], int.from_bytes(value[32:], "little")
    challenge = int.from_bytes(hashlib.sha512(first + public + text).digest(), "little") % ORDER
    if times(8, point(public)) == (0, 1):
        raise Rejected("the key is no key: anything would be signed by it")
    base = point((4 * pow(5, -1, PRIME) % PRIME).to_bytes(32, "little"))
    if second >= ORDER or times(second, base) != plus(point(first), times(challenge, point(public))):
        raise Rejected("the signature does not fit the receipt")


# ---------------------------------------------------------------- what has to go together

def check_premises(receipt, part):
    """Whether the request asked for what the receipt was made with."""
    premises = receipt["premises"]
    stated = premises | (premises.get("program") or {})
    names = ["tolerance_mm", "control_tolerance_mm", "clearance_mm", "allowed_excess_mm", "cell_mm", "rapids"]
    names += ["dialect", "units", "without_point", "start", "block_delete", "compensation"]
    for name in names:
        if part.get(name) is not None and part[name] != stated.get(name):
            raise Rejected(f"the request has another {name} than the receipt")


def check_figures(receipt):
    if receipt.get("schema") != "toolpathd-receipt-1":
        raise Rejected("this is no receipt, or one of another form")
    moves, bounds, premises = receipt["moves"], receipt["bounds"], receipt["premises"]
    figures = [premises[name] for name in ("control_tolerance_mm", "arcs_moved_mm", "clearance_mm", "tolerance_mm")]
    figures += [own["gouge_mm"] for own in moves] + [count["count"] for count in receipt["counts"]]
    if not all(isinstance(own, (int, float)) and 0 <= own < 1e9 for own in figures):
        raise Rejected("a figure is no number, or below zero")
    certainties = {count["certainty"] for count in receipt["counts"] if count["count"] > 0}
    verdict = "fail" if "certain" in certainties else "undecided" if "possible" in certainties else "pass"
    if receipt["verdict"] != verdict:
        raise Rejected(f"the findings come to {verdict}, and the verdict is {receipt['verdict']}")
    for own in moves:
        if own.get("found_mm", 0) > own["gouge_mm"]:
            raise Rejected(f"a depth was found beyond its bound: {own}")
    if moves and bounds.get("gouge_mm") != max(own["gouge_mm"] for own in moves):
        raise Rejected("the bound of all moves is not the largest of their bounds")
    names = {count["kind"] for count in receipt["counts"] if count["count"] > 0}
    is_deep = bounds.get("gouge_mm", 0) > premises["tolerance_mm"]
    if is_deep != bool(names & {"gouge", "rapid_through_part"}):
        raise Rejected("the findings do not go with the bound of all moves")


# ---------------------------------------------------------------- the program

LEFT_ALONE = {"M", "S", "T", "H", "D", "F", "O", "N"}
WORD = re.compile(r"([A-Z])\s*([-+]?\d*\.?\d*)")
PLANES = {17: (0, 1), 18: (2, 0), 19: (1, 2)}


def moves_of_text(text, premises):
    """The moves of a program of ISO words: pairs of a line and a function of a fraction, with its length."""
    factor = 25.4 if premises["units"] == "inch" else 1.0
    at, code, axes, relative = list(premises.get("start") or [None] * 3), None, (0, 1), False
    ways = []
    for line, row in enumerate(re.split("\r\n|\r|\n", text), 1):
        row = re.sub(r"\([^)]*\)|;.*", "", row).strip().upper()
        if row in ("", "%"):
            continue
        words = {}
        for letter, number in WORD.findall(row):
            if not re.search("[0-9]", number):
                raise Unread(f"line {line}: {letter} has no number")
            if letter == "G":
                words.setdefault("G", []).append(float(number))
            elif letter in words:
                raise Unread(f"line {line}: {letter} stands twice")
            else:
                words[letter] = number
        if WORD.sub("", row).strip() or row[0] == "/":
            raise Unread(f"line {line}: {row}")
        if float(words.get("M") or 0) == 6:
            at = [None] * 3
        home = False
        for number in words.get("G", []):
            if number in (0, 1, 2, 3):
                code = int(number)
            elif number in PLANES:
                axes = PLANES[int(number)]
            elif number in (20, 21):
                factor = 25.4 if number == 20 else 1.0
            elif number in (90, 91):
                relative = number == 91
            elif number == 28:
                home = True
            elif number not in (4, 40, 43, 49, 54, 64, 80, 94, 61, 90.1, 91.1):
                raise Unread(f"line {line}: G{number:g}")
        length = {}
        for letter, number in words.items():
            if letter in ("X", "Y", "Z", "I", "J", "K", "R"):
                steps = premises["without_point"] == "increments" and "." not in number
                unit = (0.001 if factor == 1.0 else 0.0001) if steps else 1.0
                length[letter] = float(number) * unit * factor
            elif letter in ("P", "Q") and {4, 64} & set(words.get("G", [])):
                continue
            elif letter != "G" and letter not in LEFT_ALONE:
                raise Unread(f"line {line}: {letter}")
        if 4 in words.get("G", []):
            continue
        named = [k for k, letter in enumerate("XYZ") if letter in length]
        if home:
            if not relative or any(length["XYZ"[k]] != 0 for k in named):
                raise Unread(f"line {line}: the way home leads over another place")
            for k in named:
                at[k] = None
            continue
        if not named and not {"I", "J", "K", "R"} & set(length):
            continue
        to = list(at)
        for k in named:
            step = length["XYZ"[k]]
            to[k] = step if not relative else None if at[k] is None else at[k] + step
        if code is None:
            raise Unread(f"line {line}: no motion is in force")
        if None not in at and None not in to:
            if code < 2 and at == to:
                continue
            if code > 1:
                ways.append((line, [arc(at, to, code, axes, length)]))
            elif code == 0 and premises["rapids"] == "dog_leg":
                ways.append((line, [straight(at, to), *dog_leg(at, to)]))
            else:
                ways.append((line, [straight(at, to)]))
        elif code != 0:
            raise Unread(f"line {line}: a cut from a place that is not known")
        at = to
    return ways


def straight(start, end):
    start, end = tuple(start), tuple(end)
    return math.dist(start, end), lambda t: [a + t * (b - a) for a, b in zip(start, end)]


def dog_leg(start, end):
    """All axes run at one speed until each has arrived."""
    way = [b - a for a, b in zip(start, end)]
    stops = sorted({abs(own) for own in way})
    places = [start] + [[a + max(-s, min(s, w)) for a, w in zip(start, way)] for s in stops]
    return [straight(a, b) for a, b in zip(places, places[1:])]


def arc(start, end, code, axes, length):
    a, b = axes
    normal = 3 - a - b
    if "R" in length:
        radius = length["R"]
        half = [(end[a] - start[a]) / 2, (end[b] - start[b]) / 2]
        chord = math.hypot(*half)
        rise = math.sqrt(max(radius * radius - chord * chord, 0)) * (1 if (radius > 0) == (code == 3) else -1)
        center = [start[a] + half[0] - half[1] / chord * rise, start[b] + half[1] + half[0] / chord * rise]
    else:
        offset = [length.get("IJK"[k], 0.0) for k in (a, b)]
        center = [start[a] + offset[0], start[b] + offset[1]]
    first = math.atan2(start[b] - center[1], start[a] - center[0])
    last = math.atan2(end[b] - center[1], end[a] - center[0])
    radii = [math.hypot(p[a] - center[0], p[b] - center[1]) for p in (start, end)]
    turn = (last - first) % (2 * math.pi)
    if turn < 1e-9 or turn > 2 * math.pi - 1e-9:
        turn = 2 * math.pi
    if code == 2 and turn != 2 * math.pi:
        turn -= 2 * math.pi
    elif code == 2:
        turn = -turn

    def at(t):
        place, radius = [0.0] * 3, radii[0] + t * (radii[1] - radii[0])
        place[a] = center[0] + radius * math.cos(first + t * turn)
        place[b] = center[1] + radius * math.sin(first + t * turn)
        place[normal] = start[normal] + t * (end[normal] - start[normal])
        return place

    return math.hypot(max(radii) * turn, end[normal] - start[normal], radii[1] - radii[0]), at


# ---------------------------------------------------------------- the part

def depth_of(tool, distance, height):
    """How deep a place lies in the cutter: at a distance from its axis and at a height over its tip."""
    radius = tool["diameter_mm"] / 2
    corner = {"ball": radius, "flat": 0.0}.get(tool["shape"], tool.get("corner_radius_mm", 0.0))
    if distance > radius - corner and height < corner:
        return corner - math.hypot(distance - (radius - corner), corner - height)
    return min(radius - distance, height)


class Pocket:
    """Upright walls up to a top, and a floor."""

    proves = True

    def __init__(self, part):
        outlines = [part["region"]["boundary"], *(part["region"].get("islands") or [])]
        self.outlines = [[side(a, b) for a, b in zip(own, own[1:] + own[:1])] for own in outlines]
        self.top, self.floor = part.get("top_z_mm") or 0.0, part["floor_z_mm"]

    def depth(self, tool, place):
        x, y, z = place
        distance = min(distance(x, y) for own in self.outlines for distance, _ in own)
        # A ray just beside the place meets no corner.
        inside = [sum(crossings(x, y + 1.234e-7) for _, crossings in own) % 2 == 1 for own in self.outlines]
        if not inside[0] or any(inside[1:]):
            distance = 0.0
        return max(depth_of(tool, 0.0, self.floor - z), depth_of(tool, distance, self.top - z))


def side(start, end):
    """A side of an outline: its distance from a place, and how often it crosses the ray from there along x."""
    (a, b), (c, d) = start[:2], end[:2]
    bulge = start[2] if len(start) > 2 and start[2] else 0.0
    dx, dy = c - a, d - b
    if bulge == 0.0:

        def distance(x, y):
            t = ((x - a) * dx + (y - b) * dy) / (dx * dx + dy * dy or 1.0)
            t = max(0.0, min(1.0, t))
            return math.hypot(x - a - t * dx, y - b - t * dy)

        return distance, lambda x, y: (b > y) != (d > y) and x < a + (y - b) / dy * dx
    away = (1 - bulge * bulge) / (4 * bulge)
    center = (a + c) / 2 - dy * away, (b + d) / 2 + dx * away
    radius = math.hypot(a - center[0], b - center[1])
    first, turn = math.atan2(b - center[1], a - center[0]), 4 * math.atan(bulge)

    def is_on(x, y):
        run = math.atan2(y - center[1], x - center[0]) - first
        return (run if turn > 0 else -run) % (2 * math.pi) <= abs(turn)

    def distance_of_arc(x, y):
        if is_on(x, y):
            return abs(math.hypot(x - center[0], y - center[1]) - radius)
        return min(math.hypot(x - a, y - b), math.hypot(x - c, y - d))

    def crossings(x, y):
        half = math.sqrt(max(radius * radius - (y - center[1]) ** 2, 0.0))
        return sum(x < own and is_on(own, y) for own in (center[0] - half, center[0] + half) if half > 0)

    return distance_of_arc, crossings


class Patches:
    """A surface of Bezier patches, as places close to each other."""

    proves = False
    STEPS = 60

    def __init__(self, part):
        if part.get("allowance_mm"):
            raise Unread("the part is grown by an allowance")
        self.cells = {}
        for net in (net for row in part["surface"]["patches"] for net in row):
            for i in range(self.STEPS + 1):
                row = [blend(own, i / self.STEPS) for own in zip(*net)]
                for j in range(self.STEPS + 1):
                    x, y, z = blend(row, j / self.STEPS)
                    self.cells.setdefault((math.floor(x), math.floor(y)), []).append((x, y, z))

    def depth(self, tool, place):
        x, y, z = place
        radius = tool["diameter_mm"] / 2
        deepest = -math.inf
        for i in range(math.floor(x - radius), math.floor(x + radius) + 1):
            for j in range(math.floor(y - radius), math.floor(y + radius) + 1):
                for p, q, r in self.cells.get((i, j), ()):
                    deepest = max(deepest, depth_of(tool, math.hypot(p - x, q - y), r - z))
        return deepest


def blend(points, t):
    """The place of a Bezier curve: de Casteljau's method."""
    points = [tuple(own) for own in points]
    while len(points) > 1:
        points = [tuple(u + t * (v - u) for u, v in zip(a, b)) for a, b in zip(points, points[1:])]
    return points[0]


# ---------------------------------------------------------------- the bounds

MOST_PIECES = 200_000


def check_bound(stated, move, tool, part, slack, fine):
    """Whether the cutter enters the part at most as deep as stated on the whole of a move.

    Where the tip moves by some length, the depth changes by no more. So a piece of the move is no deeper than its
    middle and half its length.
    """
    length, at = move
    pieces = [(0.0, 1.0)]
    for _ in range(MOST_PIECES):
        if not pieces:
            return
        begin, end = pieces.pop()
        depth, half = part.depth(tool, at((begin + end) / 2)) + slack, (end - begin) * length / 2
        if depth > stated + fine / 2 and depth > 0:
            raise Rejected(f"the cutter enters the part by {depth:.5f} mm; stated is {stated}")
        if depth + half > max(stated, 0.0) + fine and (part.proves or half > tool["diameter_mm"] / 16):
            middle = (begin + end) / 2
            pieces += [(begin, middle), (middle, end)]
    raise Unread("a move takes too long to check")


def check_moves(receipt, program, part):
    """Proves the bound of each move anew. Raises `Unread` where that is beyond this checker."""
    premises, tools = receipt["premises"], [part["tool"]] if part.get("tool") else part["tools"]
    if len(tools) != 1 or "program" not in premises:
        raise Unread("only programs of one tool are checked move by move")
    if part.get("region"):
        solid = Pocket(part)
    elif (part.get("surface") or {}).get("kind") == "bezier_patches":
        solid = Patches(part)
    else:
        raise Unread("the part is of a kind that this checker does not know")
    if premises["program"]["offsets"] or premises["program"]["compensation"] == "compute":
        raise Unread("offsets and computed contours are not checked move by move")
    ways = moves_of_text(program.decode(), premises["program"] | {"rapids": premises["rapids"]})
    stated = {}
    for own in receipt["moves"]:
        stated[own["line"]] = max(own["gouge_mm"], stated.get(own["line"], 0.0))
    if {line for line, _ in ways} != set(stated):
        raise Rejected("the moves of the receipt are not those of the program")
    slack = premises["control_tolerance_mm"] + premises["arcs_moved_mm"]
    for line, moves in ways:
        for move in moves:
            check_bound(stated[line], move, tools[0], solid, slack, premises["tolerance_mm"] / 4)
    if not solid.proves:
        raise Unread("the bounds of the surface were not refuted at places close to each other")
    if any(part.get(name) for name in ("fixtures", "travel", "stock")) or tools[0].get("holder"):
        raise Unread("the moves hold; clamps, travel, stock and holder are not proved anew")


def check(receipt, program, part, key=None):
    """Raises `Rejected` where the receipt does not hold, `Unread` where it holds as far as it can be checked."""
    try:
        receipt = receipt.get("receipt", receipt)
        check_digests(receipt, program, part)
        check_signature(receipt, key)
        check_figures(receipt)
        check_premises(receipt, part)
        check_moves(receipt, program, part)
    except (KeyError, TypeError, AttributeError, ValueError, RecursionError, OverflowError) as error:
        raise Rejected(f"the receipt has not the form of one: {error!r}") from None


def main(receipt, program, part, key=None):
    try:
        with open(receipt, encoding="utf-8-sig") as one, open(part, encoding="utf-8-sig") as third:
            receipt, part = read_json(one.read()), read_json(third.read())
        with open(program, "rb") as other:
            check(receipt, other.read(), part, key)
    except (OSError, ValueError, RecursionError) as error:
        print(f"not read: {error}")
        return 1
    except Rejected as reason:
        print(f"rejected: {reason}")
        return 1
    except Unread as reason:
        print(f"not checked further: {reason}")
        return 3
    print(f"holds: {receipt.get('receipt', receipt)['verdict']}")
    return 0


if __name__ == "__main__":
    if len(sys.argv) not in (4, 5):
        sys.exit(__doc__)
    sys.exit(main(*sys.argv[1:]))
