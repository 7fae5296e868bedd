"""Sends five-axis programs and point files to the service.

`check.py ADDRESS` sends the files in `files`, and compares poses, length and time of each path, and the words that the
reader leaves alone, with figures that follow from the text of the file in closed form.

`check.py ADDRESS fetched [FOLDER]` sends public files, which it fetches into the folder, or takes from there. Says
NOT CHECKED for a file that cannot be fetched. Prints a row for each file: the poses that are read or the line of the
refusal, the time of the file's own feeds, and the time of the answer with and without limits of the axes. A time of the
file is computed here from its text alone: minutes of G93 blocks, or lengths over feeds.
"""

import json
import math
import os
import re
import sys
import tempfile
import urllib.error
import urllib.parse
import urllib.request

LINUXCNC = "LinuxCNC/linuxcnc/5c41560ebbc3a40f84a5547bc6f7c5cd9278ba6b/configs/sim/axis/vismach/5axis/"
HUST = "zhxinhust/virtualfiveaxisCNCmachining/c6d312807c4a3d5b5cecfc074b3bdd00a292911d/Data/Input/"
TILTING = LINUXCNC + "table-rotary-tilting/demos/"

# Address, form, machine, and the line of the refusal, or none for a file that is read whole.
FILES = [
    (TILTING + "impeller-7bl-xyzac.ngc", "nc", "table_table_ac", None),
    (TILTING + "boat-xyzac.ngc", "nc", "table_table_ac", 320),
    (TILTING + "boat-xyzbc.ngc", "nc", "table_table_bc", None),
    (TILTING + "xyzac_switchkins.ngc", "nc", "table_table_ac", 2),
    (LINUXCNC + "bridgemill/5axisgui.ngc", "nc", "table_table_bc", 1),
    (HUST + "PathPointsFile.cls", "cl", "table_table_ac", None),
    (HUST + "pathdata2.txt", "cl", "table_table_ac", None),
    (HUST + "tool path data3.txt", "cl", "table_table_ac", None),
    (HUST + "yelun.txt", "cl", "table_table_ac", None),
    (HUST + "tool path data.txt", "path", "table_table_ac", None),
    (HUST + "Open pocket curve.txt", "path", "table_table_ac", None),
]

# The feed of files that state none, and that of rapids, mm/min.
FEED, RAPID = 1000.0, 10_000.0

OWN_FILES = os.path.join(os.path.dirname(os.path.abspath(__file__)), "files")
# In strip-xyzbc.ngc the words are positions of the axes. B leans the table by 30 degrees, with the tool above its centre.
# C then leads the tip around a circle: by a rapid along the chord of a quarter, by a cut along the arc of another one.
CHORD = 2 * 60 * math.sin(math.radians(30)) * math.sin(math.radians(45))
ARC = 50 * math.sin(math.radians(30)) * math.radians(90)
# File, form, machine, poses, the length in mm of each motion behind the first pose with its time in s, and the words left
# alone. A cut that turns an axis by its angle has as many poses as its tolerance needs.
OWN = [
    ("columns.txt", "path", "table_table_ac", 4, [(220, 220 / FEED * 60)], None),
    (
        "strip.cl", "cl", "table_table_ac", 8,
        [(60, 6), (50, 2.5), (50, 2.5), (10, 0.5), (120, 120 / RAPID * 60), (10, 0.5), (100, 5)],
        "CUTTER in line 5, comment in line 17",
    ),
    (
        "strip-xyzac.ngc", "nc", "table_table_ac", None,
        [(50, 50 / RAPID * 60), (10, 2), (50, 2), (50, 2), (0, 3), (50, 2), (60, 60 / RAPID * 60)],
        "comment in line 12",
    ),
    (
        "strip-xyzbc.ngc", "nc", "table_table_bc", None,
        [(CHORD, CHORD / RAPID * 60), (10, 2), (50, 2), (50, 2), (ARC, 3), (10, 10 / RAPID * 60)],
        "G64 in line 7",
    ),
]
# File, form, machine, and the line and the word of its refusal.
OWN_REFUSED = [
    ("unknown.cl", "cl", "table_table_ac", 4, "WOBBLE"),
    ("unknown.ngc", "nc", "table_table_ac", 4, "M123"),
]
# The service divides arcs of axes into chords within its tolerance.
AGREEMENT = 1e-3

LIMITS = {
    **{axis: {"speed": 500, "acceleration": 5000, "jerk": 100_000} for axis in "XYZ"},
    **{axis: {"speed": 360, "acceleration": 3000, "jerk": 100_000} for axis in "ABC"},
}


def fetched(address, folder):
    """The text of a file, and `None` where it cannot be fetched."""
    place = os.path.join(folder, os.path.basename(address))
    if not os.path.exists(place):
        source = "https://raw.githubusercontent.com/" + urllib.parse.quote(address)
        try:
            with urllib.request.urlopen(source, timeout=60) as answer:
                content = answer.read()
        except (urllib.error.URLError, TimeoutError):
            return None
        with open(place, "wb") as file:
            file.write(content)
    with open(place, encoding="latin-1") as file:
        return file.read()


def points(text):
    """The poses of a file of columns, or of GOTO statements."""
    rows = [re.findall(r"[-+]?\d*\.?\d+(?:[eE][-+]?\d+)?", line.replace("GOTO/", "")) for line in text.splitlines()]
    poses = [[float(x) for x in row] for row in rows if len(row) == 6]
    # One file states the axis from the spindle to the tip.
    if sum(pose[5] for pose in poses) < 0:
        poses = [[*pose[:3], *(-x for x in pose[3:])] for pose in poses]
    return poses


def own_time(text, form):
    """The seconds that the feed blocks of a file take by its own feeds."""
    if form != "nc":
        tips = [row[:3] for row in points(text)]
        return sum(math.dist(a, b) for a, b in zip(tips, tips[1:])) / FEED * 60
    at, motion, feed, inverse, seconds = [0.0] * 3, 0, 0.0, False, 0.0
    for line in text.splitlines():
        words = re.findall(r"([A-Z])\s*([-+]?\d*\.?\d+)", re.sub(r"\([^)]*\)|;.*", "", line.upper()))
        before = list(at)
        for letter, value in ((letter, float(value)) for letter, value in words):
            if letter == "G" and value in (93, 94):
                inverse = value == 93
            elif letter == "G" and value in (0, 1):
                motion = int(value)
            elif letter == "F":
                feed = value
            elif letter in "XYZ":
                at["XYZ".index(letter)] = value
        moves = any(letter in "XYZABC" for letter, _ in words)
        if moves and motion == 1:
            seconds += 60 / feed if inverse else math.dist(before, at) / feed * 60
    return seconds


def post(address, body):
    """Status and JSON of an answer."""
    request = urllib.request.Request(
        f"{address}/v1/five-axis/smooth", json.dumps(body).encode(), {"Content-Type": "application/json"}
    )
    try:
        with urllib.request.urlopen(request, timeout=120) as answer:
            return answer.status, json.load(answer)
    except urllib.error.HTTPError as error:
        return error.code, json.load(error)


def result(status, answer):
    if status == 200:
        return f"{answer['report']['cycle_time_s']:.1f}"
    errors = answer.get("errors") or [answer]
    return errors[0]["detail"]


def body_of(text, form, machine):
    """The request of a file, without limits of the axes."""
    member = text
    if form == "path":
        member = [{"tip": row[:3], "axis": row[3:]} for row in points(text)]
    return {
        form: member,
        "tolerance_mm": 0.02,
        "tolerance_deg": 0.2,
        "feed_mm_per_min": FEED,
        "machine": {"name": machine},
        "sample_period_ms": 100,
    }


def words_left_alone(answer):
    return [own["detail"] for own in answer["warnings"] if own["code"] == "words_left_alone"]


def sent(address, name, form, machine):
    """Status and JSON of the answer to a file of our own. The method `linear` rounds no corner."""
    with open(os.path.join(OWN_FILES, name), encoding="ascii") as file:
        return post(address, {**body_of(file.read(), form, machine), "method": "linear"})


def check_own(address):
    wrong = []
    for name, form, machine, poses, motions, left in OWN:
        status, answer = sent(address, name, form, machine)
        if status != 200:
            wrong.append(f"{name}: {status} {answer}")
            continue
        report = answer["report"]
        found = report["n_poses"], report["length_mm"], report["cycle_time_s"]
        length, time = (sum(column) for column in zip(*motions))
        print(f"{name}: {found[0]} poses, {found[1]:.3f} mm, {found[2]:.3f} s")
        if poses not in (None, found[0]):
            wrong.append(f"{name}: {found[0]} poses instead of {poses}")
        if not math.isclose(found[1], length, rel_tol=AGREEMENT) or not math.isclose(found[2], time, rel_tol=AGREEMENT):
            wrong.append(f"{name}: not {length:.3f} mm and {time:.3f} s")
        told = [detail.split(": ", 1)[1] for detail in words_left_alone(answer)]
        if told != [left] * (left is not None):
            wrong.append(f"{name}: left alone are {told} instead of {left}")
    for name, form, machine, line, word in OWN_REFUSED:
        status, answer = sent(address, name, form, machine)
        detail = result(status, answer)
        print(f"{name}: {detail}")
        if status != 422 or not detail.startswith(f"line {line}: ") or word not in detail:
            wrong.append(f"{name}: {status}, not refused at line {line} for {word}")
    return wrong


def check_fetched(address, folder):
    print("| file | read | own feeds, s | constant feed, s | within limits, s |\n|---|---|---|---|---|")
    wrong = []
    for source, form, machine, refused in FILES:
        name = os.path.basename(source)
        text = fetched(source, folder)
        if text is None:
            print(f"| {name} | NOT CHECKED: the network is missing | | | |")
            continue
        body = body_of(text, form, machine)
        rotary = machine[-2:].upper()
        limits = {axis: LIMITS[axis] for axis in "XYZ" + rotary}
        status, answer = post(address, body)
        within = post(address, {**body, "limits": limits})
        found = re.match(r"line (\d+): (.*)", result(status, answer))
        line = int(found[1]) if found else None
        if found:
            row = [f"refused at line {line}: {found[2]}", f"{own_time(text, form):.1f}", "", ""]
        else:
            row = ["whole", f"{own_time(text, form):.1f}", result(status, answer), result(*within)]
        print(f"| {name} | {' | '.join(row)} |", flush=True)
        if line != refused or status not in (200, 422):
            wrong.append(f"{name}: refused at line {line} instead of {refused}")
        if status == 200:
            for detail in words_left_alone(answer):
                print(f"<!-- {name}: {detail} -->")
    return wrong


def main(address, what="own", folder=None):
    if what not in ("own", "fetched"):
        raise SystemExit("usage: run [fetched [FOLDER]]")
    wrong = check_own(address) if what == "own" else check_fetched(address, folder or tempfile.mkdtemp())
    if wrong:
        raise SystemExit("\n".join(wrong))


main(*sys.argv[1:])
