"""Plans a pocket with FreeCAD's Path workbench; `freecadcmd freecad_path.py`, files named by POCKET_IN and POCKET_OUT.

POCKET_IN is JSON: `radius`, `stepover`, `floor`, `feed`, `operation` (`Offset`, `ZigZag`, `ZigZagOffset`, `Line`, `Grid` or `Adaptive`),
`keep_down`, `tolerance` and `outlines`: vertices `[x, y, bulge]` of the wall, then of the islands. POCKET_OUT gets the path as G-code.
"""

import json
import math
import os
import time
import traceback

import FreeCAD
import Part
import Path
import PathScripts.PathAdaptive as PathAdaptive
import PathScripts.PathJob as PathJob
import PathScripts.PathPocketShape as PathPocketShape
from FreeCAD import Vector

with open(os.environ["POCKET_IN"], encoding="ascii") as file:
    pocket = json.load(file)


def face(outline):
    edges = []
    for (x, y, bulge), (u, v, _) in zip(outline, outline[1:] + outline[:1]):
        start, end = Vector(x, y, 0), Vector(u, v, 0)
        if bulge:
            middle = Vector((x + u) / 2 + bulge * (v - y) / 2, (y + v) / 2 - bulge * (u - x) / 2, 0)
            edges.append(Part.Arc(start, middle, end).toShape())
        else:
            edges.append(Part.LineSegment(start, end).toShape())
    return Part.Face(Part.Wire(edges))


def plan():
    floor = pocket["floor"]
    document = FreeCAD.newDocument("pocket")
    shape = face(pocket["outlines"][0])
    islands = [face(outline) for outline in pocket["outlines"][1:]]
    if islands:
        shape = shape.cut(islands)
    bounds = shape.BoundBox
    corner = Vector(bounds.XMin - 20, bounds.YMin - 20, floor - 5)
    block = Part.makeBox(bounds.XLength + 40, bounds.YLength + 40, 5 - floor, corner)
    shape.translate(Vector(0, 0, floor))
    part = document.addObject("Part::Feature", "part")
    part.Shape = block.cut(shape.extrude(Vector(0, 0, -floor)))
    floors = [f"Face{k}" for k, f in enumerate(part.Shape.Faces, 1)
              if f.BoundBox.ZLength < 1e-6 and abs(f.BoundBox.ZMin - floor) < 1e-6]

    job = PathJob.Create("job", [part])
    job.GeometryTolerance.Value = pocket["tolerance"]
    model = job.Model.Group[0]
    controller = job.Tools.Group[0]
    controller.Tool.Diameter = 2 * pocket["radius"]
    # FreeCAD counts a feed in mm/s.
    controller.HorizFeed.Value = pocket["feed"] / 60
    controller.VertFeed.Value = pocket["feed"] / 120
    document.recompute()

    adaptive = pocket["operation"] == "Adaptive"
    operation = (PathAdaptive if adaptive else PathPocketShape).Create("operation")
    operation.Base = [(model, floors)]
    operation.StepOver = round(100 * pocket["stepover"] / (2 * pocket["radius"]))
    for name, value in (("StartDepth", 0), ("FinalDepth", floor), ("StepDown", -floor), ("ClearanceHeight", 2), ("SafeHeight", 2)):
        operation.setExpression(name, None)
        setattr(operation, name, value)
    if adaptive:
        operation.Tolerance = pocket["adaptive_tolerance"]
    else:
        operation.OffsetPattern = pocket["operation"]
        operation.StartAt = "Center"
        operation.CutMode = "Climb"
        operation.KeepToolDown = pocket["keep_down"]
    begun = time.perf_counter()
    document.recompute()
    seconds = time.perf_counter() - begun
    with open(os.environ["POCKET_OUT"], "w", encoding="ascii") as file:
        file.write(f"(VERSION {'.'.join(FreeCAD.Version()[:3])})\n(SECONDS {seconds})\n(STEPOVER {operation.StepOver})\n")
        for command in operation.Path.Commands:
            if command.Name in ("G0", "G1", "G2", "G3"):
                words = (f"{axis}{value:.6f}" for axis, value in command.Parameters.items() if axis in "XYZIJ")
                file.write(f"{command.Name} {' '.join(words)}\n")


try:
    plan()
except BaseException:
    traceback.print_exc()
os._exit(0)
