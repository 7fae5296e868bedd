"""Shows that the judge measures what it says, and that it sees faults that are put into good answers.

Closed forms come first: straight passes beside cut ground have a known angle, and slots have 180 degrees. Then answers of the
service are spoilt in one way at a time; the judge has to name each fault, and not to name it before.

Usage: selftest.py URL
"""

import copy
import math
import sys

import numpy

from cases import block, body, disc
from judge import plan
from measure import judge

FEED = 1000


def moves_of(answer):
    return [move for one in answer["toolpath"]["passes"] for move in one["moves"]]


def by_hand(moves, start=(0.0, 0.0, 10.0)):
    """An answer that holds these moves alone."""
    return {"toolpath": {"start": list(start), "passes": [{"level": 0, "moves": moves}]}, "report": {"levels": [{"z_mm": -5.0, "chosen": None}]}}


def line(x, y, z=-5.0, role="cut", feed=FEED):
    return {"kind": "line", "to": [x, y, z], "role": role, "feed_mm_per_min": feed}


def rapid(x, y, z):
    return {"kind": "rapid", "to": [x, y, z]}


def straight_passes(share):
    """Rows in a wide pocket, `share` of the diameter apart."""
    step = 10 * share
    moves = []
    for k in range(4):
        y = 20 + k * step
        moves += [rapid(10, y, 2), line(10, y, -5.0, "ramp"), line(80, y), rapid(80, y, 2)]
    pocket = body(block(0, 0, 100, 60), diameter=10.0, stepover=step, feed=FEED)
    return pocket, by_hand(moves)


def check_angles():
    """The angles of rows are acos(1 - 2 share); of the first row 180 degrees."""
    from measure import Path, Scene
    from motion import Motion
    for share in (0.05, 0.2, 0.4, 0.5, 0.6, 0.8):
        pocket, answer = straight_passes(share)
        motion = Motion(answer, pocket)
        path = Path(motion, Scene(pocket, 1), motion.levels(), 0.0)
        middle = (path.floor >= 0) & (path.chords[:, 0] > 25) & (path.chords[:, 0] < 65)
        for row in range(4):
            angles = path.angles[middle & (numpy.abs(path.chords[:, 1] - 20 - 10 * share * row) < 1e-6)]
            expected = 180.0 if row == 0 else math.degrees(math.acos(1 - 2 * share))
            # Cells and interpolation may bias a shallow cut by a few hundredths of its depth.
            slack = 1.0 + 0.02 * expected
            assert abs(numpy.median(angles) - expected) < slack, f"share {share}, row {row}: {numpy.median(angles):.2f}, not {expected:.2f}"
            assert numpy.ptp(angles) < 2.0, f"share {share}, row {row}: angles from {angles.min():.2f} to {angles.max():.2f}"
    print("angles of straight passes and slots: as the closed form says")


def check_round():
    """A circle of the centre, 30 mm, about a disc cut to 27: the angle has a closed form by the law of cosines."""
    from measure import Path, Scene
    from motion import Motion
    pocket = body(disc(0, 0, 60), diameter=10.0, stepover=3.0, feed=FEED)
    moves = [rapid(0, 0, 10), line(0, 0, -5.0, "ramp")]
    radii = [3.0 * k for k in range(1, 11)]
    for radius in radii:
        half = lambda x, to: {"kind": "arc", "to": [to, 0.0, -5.0], "center": [0.0, 0.0, -5.0], "direction": "ccw", "role": "cut", "feed_mm_per_min": FEED}
        moves += [line(radius, 0), half(radius, -radius), half(-radius, radius)]
    motion = Motion(by_hand(moves), pocket)
    path = Path(motion, Scene(pocket, 1), motion.levels(), 0.0)
    far = numpy.hypot(path.chords[:, 0], path.chords[:, 1])
    on = (path.floor >= 0) & (numpy.abs(far - 30) < 1e-3) & (path.chords[:, 0] < -10)
    # Cut ground reaches to 27 + 5; the rim about (30, 0) leaves it at an angle `a` from outward.
    outward = math.degrees(math.acos((32.0 ** 2 - 30.0 ** 2 - 25) / (2 * 30 * 5)))
    assert abs(numpy.median(path.angles[on]) - outward) < 1.5, f"{numpy.median(path.angles[on]):.2f}, not {outward:.2f}"
    print("angle on a ring about a disc: as the law of cosines says")


def first_word(figures):
    return {fault.split()[0].rstrip(":") for fault in figures["faults"]}


def into_wall(answer):
    """A cut along the wall at x = 95 moved 0.05 mm into it, with the move before."""
    moves = moves_of(answer)
    for before, move in zip(moves, moves[1:]):
        if move.get("role") == "cut" and abs(move["to"][0] - 95) < 2e-3 and abs(before["to"][0] - 95) < 2e-3 and move["kind"] == "line" and abs(move["to"][1] - before["to"][1]) > 5:
            before["to"][0] += 0.05
            move["to"][0] += 0.05
            return
    raise AssertionError("no pass along the wall")


def without_end(answer):
    """The last two fifths of the moves of the last level are left out."""
    moves = answer["toolpath"]["passes"][-1]["moves"]
    del moves[len(moves) * 3 // 5:]
    moves.append(rapid(*moves[-1]["to"][:2], 20))


def low_rapid(answer):
    """The first way across comes down into the stock, before anything is cut."""
    moves = moves_of(answer)
    first = next(move for move in moves if move["kind"] == "rapid")
    one = answer["toolpath"]["passes"][0]
    one["moves"][:0] = [rapid(20, 20, 10), rapid(20, 20, -5), rapid(60, 30, -5), rapid(60, 30, 10), rapid(*first["to"][:2], 10)]


def fast_slot(answer):
    """Every cut runs at the full feed."""
    for move in moves_of(answer):
        if move["kind"] != "rapid":
            move["feed_mm_per_min"] = FEED


def without_level(answer):
    """The upper level is left out."""
    answer["toolpath"]["passes"] = [one for one in answer["toolpath"]["passes"] if one["level"] != 0]


def too_deep(answer):
    """The upper level ends early, so the lower level cuts two at once."""
    moves = answer["toolpath"]["passes"][0]["moves"]
    del moves[len(moves) // 2:]
    moves.append(rapid(*moves[-1]["to"][:2], 20))


def link_through(answer):
    """A way through the stock at the floor, as a link, before anything else."""
    answer["toolpath"]["passes"][0]["moves"][:0] = [rapid(20, 20, 10), line(20, 20, -5.0, "ramp"), line(80, 40, -5.0, "link"), rapid(80, 40, 10)]


def thick_wall(answer):
    """All that was cut along the wall at x = 95 keeps 0.02 mm from it."""
    for move in moves_of(answer):
        if abs(move["to"][0] - 95) < 2e-3:
            move["to"][0] -= 0.02


def main():
    url = sys.argv[1] if "://" in sys.argv[1] else f"http://{sys.argv[1]}"
    check_angles()
    check_round()
    pocket = body(block(0, 0, 100, 60), diameter=10.0, stepover=3.0, depth=10, stepdown=5, feed=FEED)
    pocket["cutting"]["slot_feed_mm_per_min"] = 0.4 * FEED
    status, good, _ = plan(url, pocket)
    assert status == 200, good
    before = first_word(judge(pocket, good))
    for spoil, word in ((into_wall, "gouge"), (without_end, "uncut"), (low_rapid, "rapid"), (fast_slot, "load"), (without_level, "stepdown"), (too_deep, "deeper"), (link_through, "link"), (thick_wall, "0.0200")):
        spoilt = copy.deepcopy(good)
        spoil(spoilt)
        named = first_word(judge(pocket, spoilt))
        assert word not in before, f"{word} is named in a good answer"
        assert word in named, f"{spoil.__name__}: {word} is not named among {sorted(named)}"
        print(f"{spoil.__name__}: named")
    check_leads()
    check_allowance()
    print("the judge sees every fault")


def check_leads():
    """A wall pass with quarter circles is clean; without them, entered straight and lifted at the wall, it is named."""
    pocket = body(block(0, 0, 60, 40), diameter=10.0, stepover=4.0, feed=FEED)
    arc = lambda x, y, cx, cy, role: {"kind": "arc", "to": [x, y, -5.0], "center": [cx, cy, -5.0], "direction": "ccw", "role": role, "feed_mm_per_min": FEED}
    around = [line(55, 5), line(55, 35), line(5, 35), line(5, 5), line(31, 5)]
    clean = [rapid(27, 8, 10), line(27, 8, -5.0, "ramp"), arc(30, 5, 30, 8, "lead_in"), *around, arc(34, 8, 31, 8, "lead_out"), rapid(34, 8, 10)]
    found = judge(pocket, by_hand(clean))
    assert found["n_wall_passes"] == 1 and found["no_lead"] == 0 and found["lead_kink"] < 1e-6, found
    assert abs(found["overlap_least"] - 1.0) < 0.5, found["overlap_least"]
    assert found["n_near"] == 0 and found["clear"] >= 0.2, (found["clear"], found["near"])
    rough = [rapid(30, 15, 10), line(30, 15, -5.0, "ramp"), line(30, 5), *around, rapid(31, 5, 10)]
    found = judge(pocket, by_hand(rough))
    assert found["no_lead"] == 1 and found["lead_kink"] > 89 and found["n_near"] == 1 and found["clear"] < 1e-3, found
    print("leads, overlap and lifts at walls: as they are")


def check_allowance():
    """What a wall pass leaves is measured, and is a fault only where it is not what the body asks for."""
    pocket = body(block(0, 0, 60, 40), diameter=10.0, stepover=4.0, feed=FEED)
    def ring(left):
        low, x, y = 5 + left, 55 - left, 35 - left
        return [rapid(30, 15, 10), line(30, 15, -5.0, "ramp"), line(30, low), line(x, low), line(x, y), line(low, y), line(low, low), line(31, low), rapid(31, low, 10)]
    for asked, cut, is_fault in ((0.0, 0.0, False), (0.3, 0.3, False), (0.3, 0.0, True), (0.3, 0.31, True), (0.0, 0.3, True)):
        found = judge({**pocket, "allowance_mm": asked}, by_hand(ring(cut)))
        # Where more stands than was asked for, most stands beside the corners.
        most = found["stands_most"] - cut
        assert (0 <= most + 1e-6 < 0.1 if cut > asked else abs(most) < 1e-6) and abs(found["stands_least"] - cut) < 1e-6, (asked, cut, found["stands_least"], found["stands_most"])
        named = any("on the wall" in fault for fault in found["faults"])
        assert named == is_fault, (asked, cut, found["faults"])
    print("allowances: as they are")


if __name__ == "__main__":
    main()
