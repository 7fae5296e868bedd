"""Prints the points that LinuxCNC's interpreter computes on each spline block of a program, one block a line, in mm.

The stand-alone interpreter prints NURBS_FEED without points. LinuxCNC's module for previews runs the same interpreter and
computes points at equal steps of the parameter with the interpreter's own functions. The module has no tool table, so
tool changes and tool lengths are removed from the program. The tools of these tests have no length.
"""

import re
import sys

import gcode

MM_PER_INCH = 25.4
TOOL = re.compile(r"(T\d+ M6|G43 H\d+)")
TOOLLESS = "toolless.ngc"


class Canon:
    """Takes all calls of the interpreter and keeps the feed motions of spline blocks."""

    parameter_file = "preview.var"

    def __init__(self, lines):
        self.lines = lines
        self.points = None
        self.blocks = []

    def next_line(self, state):
        self.points = None
        if "G5.1" in self.lines[state.sequence_number - 1]:
            self.points = []
            self.blocks.append(self.points)

    def straight_feed(self, x, y, z, *_):
        if self.points is not None:
            self.points.append([MM_PER_INCH * value for value in (x, y, z)])

    def get_external_length_units(self):
        return 1 / MM_PER_INCH

    def get_external_angular_units(self):
        return 1.0

    def get_axis_mask(self):
        return 7

    def get_block_delete(self):
        return 0

    def get_tool(self, pocket):
        return (pocket,) + 9 * (0.0,) + (0.1, 0.0, 0.0, 0)

    def __getattr__(self, name):
        if name.startswith("_"):
            raise AttributeError(name)
        return lambda *_, **__: None


def main(path):
    with open(path, encoding="ascii") as program:
        lines = [TOOL.sub("", line) for line in program.read().splitlines()]
    with open(TOOLLESS, "w", encoding="ascii") as program:
        program.write("\n".join(lines) + "\n")
    open(Canon.parameter_file, "w", encoding="ascii").close()
    canon = Canon(lines)
    result, line = gcode.parse(TOOLLESS, canon, "", "")
    if result > gcode.MIN_ERROR:
        sys.exit(f"line {line}: {gcode.strerror(result)}")
    for points in canon.blocks:
        print(*(repr(value) for point in points for value in point))


main(sys.argv[1])
