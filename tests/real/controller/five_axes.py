"""Runs LinuxCNC's own interpreter on programs of five axes, and compares every motion with the words of its block.

Usage: five_axes.py DIRECTORY, which holds programs for LinuxCNC.
"""

import os
import re
import subprocess
import sys
import tempfile

# The interpreter prints four decimals.
AGREEMENT = 0.51e-4
LETTERS = "XYZABC"


def expected(text):
    """The positions after each block of motion: X, Y and Z in mm, A, B and C in degrees."""
    at = dict.fromkeys(LETTERS, 0.0)
    places = []
    for line in text.splitlines():
        if line.startswith("(") or "G4 " in line:
            continue
        if "G53" in line or "G28" in line:
            # The machine's coordinates: the interpreter starts with both origins at one place.
            at["Z"] = 0.0
            places.append([at[letter] for letter in LETTERS])
            continue
        words = {letter: float(value) for letter, value in re.findall(r"([XYZABC])(-?[0-9.]+)", line)}
        if words:
            at.update(words)
            places.append([at[letter] for letter in LETTERS])
    return places


def interpreted(path):
    """The positions of the motions that the interpreter prints."""
    with tempfile.TemporaryDirectory() as home:
        with open(os.path.join(home, "tool.tbl"), "w", encoding="ascii") as table:
            table.writelines(f"T{k} P{k} Z0.0 D0.1\n" for k in range(1, 100))
        command = ["rs274", "-t", "tool.tbl", "-g", os.path.abspath(path)]
        run = subprocess.run(
            command, cwd=home, env={**os.environ, "HOME": home}, capture_output=True, text=True, timeout=300, check=False
        )
    if run.returncode != 0:
        raise SystemExit(f"{path}: refused: {run.stderr}")
    motions = re.findall(r"STRAIGHT_(?:FEED|TRAVERSE)\(([^)]*)\)", run.stdout)
    return [[float(value) for value in motion.split(",")] for motion in motions]


def main(directory):
    names = sorted(name for name in os.listdir(directory) if name.endswith(".ngc"))
    if not names:
        raise SystemExit(f"no programs in {directory}")
    total, farthest = 0, 0.0
    for name in names:
        path = os.path.join(directory, name)
        with open(path, encoding="ascii") as file:
            wanted = expected(file.read())
        found = interpreted(path)
        if len(found) != len(wanted):
            raise SystemExit(f"{name}: {len(found)} motions instead of {len(wanted)}")
        for k, (a, b) in enumerate(zip(found, wanted)):
            off = max(abs(x - y) for x, y in zip(a, b))
            farthest = max(farthest, off)
            if off > AGREEMENT:
                raise SystemExit(f"{name}: motion {k} goes to {a} instead of {b}")
        total += len(found)
    print(f"five axes: {len(names)} programs, {total} motions, apart from the text {farthest:.5f} mm or degrees")


main(sys.argv[1])
