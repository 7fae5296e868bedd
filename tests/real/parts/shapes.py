"""Writes STEP files of every kind of face with Open CASCADE. Usage: shapes.py FOLDER"""

import math
import sys
from pathlib import Path

from OCP.BRepAlgoAPI import BRepAlgoAPI_Common, BRepAlgoAPI_Cut, BRepAlgoAPI_Fuse
from OCP.BRepBuilderAPI import (
    BRepBuilderAPI_MakeEdge,
    BRepBuilderAPI_MakeFace,
    BRepBuilderAPI_MakeWire,
    BRepBuilderAPI_NurbsConvert,
    BRepBuilderAPI_Transform,
)
from OCP.BRepFilletAPI import BRepFilletAPI_MakeChamfer, BRepFilletAPI_MakeFillet
from OCP.BRepOffsetAPI import BRepOffsetAPI_MakePipe, BRepOffsetAPI_ThruSections
from OCP.BRepPrimAPI import (
    BRepPrimAPI_MakeBox,
    BRepPrimAPI_MakeCone,
    BRepPrimAPI_MakeCylinder,
    BRepPrimAPI_MakePrism,
    BRepPrimAPI_MakeRevol,
    BRepPrimAPI_MakeSphere,
    BRepPrimAPI_MakeTorus,
)
from OCP.Geom import Geom_Ellipse
from OCP.GeomAPI import GeomAPI_PointsToBSpline, GeomAPI_PointsToBSplineSurface
from OCP.gp import gp_Ax1, gp_Ax2, gp_Circ, gp_Dir, gp_Elips, gp_Pnt, gp_Trsf, gp_Vec
from OCP.IFSelect import IFSelect_RetDone
from OCP.Interface import Interface_Static
from OCP.STEPControl import STEPControl_AsIs, STEPControl_Writer
from OCP.TColgp import TColgp_Array1OfPnt, TColgp_Array2OfPnt
from OCP.TopAbs import TopAbs_EDGE
from OCP.TopExp import TopExp_Explorer
from OCP.TopoDS import TopoDS


def edges(shape):
    explorer = TopExp_Explorer(shape, TopAbs_EDGE)
    while explorer.More():
        yield TopoDS.Edge_s(explorer.Current())
        explorer.Next()


def axes(x=0, y=0, z=0, dx=0, dy=0, dz=1):
    return gp_Ax2(gp_Pnt(x, y, z), gp_Dir(dx, dy, dz))


def block():
    return BRepPrimAPI_MakeBox(40.0, 30.0, 20.0).Shape()


def cut(shape, *tools):
    for tool in tools:
        shape = BRepAlgoAPI_Cut(shape, tool).Shape()
    return shape


def turned(shape):
    move = gp_Trsf()
    move.SetRotation(gp_Ax1(gp_Pnt(1, 2, 3), gp_Dir(1, 2, 0.5)), 0.7)
    return BRepBuilderAPI_Transform(shape, move, True).Shape()


def filleted(shape, radius):
    fillet = BRepFilletAPI_MakeFillet(shape)
    for edge in edges(shape):
        fillet.Add(radius, edge)
    return fillet.Shape()


def chamfered(shape, size):
    chamfer = BRepFilletAPI_MakeChamfer(shape)
    for edge in edges(shape):
        chamfer.Add(size, edge)
    return chamfer.Shape()


def spline_edge(points):
    array = TColgp_Array1OfPnt(1, len(points))
    for k, point in enumerate(points):
        array.SetValue(k + 1, gp_Pnt(*point))
    return BRepBuilderAPI_MakeEdge(GeomAPI_PointsToBSpline(array).Curve()).Edge()


def wire(*parts):
    make = BRepBuilderAPI_MakeWire()
    for part in parts:
        make.Add(part)
    return make.Wire()


def line(a, b):
    return BRepBuilderAPI_MakeEdge(gp_Pnt(*a), gp_Pnt(*b)).Edge()


def wavy_surface():
    n = 9
    array = TColgp_Array2OfPnt(1, n, 1, n)
    for i in range(n):
        for j in range(n):
            height = 3 * math.sin(0.7 * i) * math.cos(0.5 * j)
            array.SetValue(i + 1, j + 1, gp_Pnt(5.0 * i, 4.0 * j, height))
    return GeomAPI_PointsToBSplineSurface(array).Surface()


def wavy_face():
    return BRepBuilderAPI_MakeFace(wavy_surface(), 1e-6).Face()


def wavy_block():
    """A block whose top is a spline, with a hole through the spline."""
    walls = BRepPrimAPI_MakePrism(wavy_face(), gp_Vec(0, 0, -20)).Shape()
    hole = BRepPrimAPI_MakeCylinder(axes(18, 15, -50), 4.0, 100.0).Shape()
    return cut(walls, hole)


def extruded_spline():
    curve = spline_edge([(0, 0, 0), (10, 8, 0), (20, -3, 0), (30, 5, 0)])
    profile = wire(curve, line((30, 5, 0), (30, 25, 0)), line((30, 25, 0), (0, 25, 0)), line((0, 25, 0), (0, 0, 0)))
    return BRepPrimAPI_MakePrism(BRepBuilderAPI_MakeFace(profile).Face(), gp_Vec(2, 1, 12)).Shape()


def revolved_spline(angle):
    curve = spline_edge([(5, 0, 0), (9, 0, 6), (4, 0, 12), (8, 0, 20)])
    profile = wire(curve, line((8, 0, 20), (0, 0, 20)), line((0, 0, 20), (0, 0, 0)), line((0, 0, 0), (5, 0, 0)))
    face = BRepBuilderAPI_MakeFace(profile).Face()
    axis = gp_Ax1(gp_Pnt(0, 0, 0), gp_Dir(0, 0, 1))
    return BRepPrimAPI_MakeRevol(face, axis, angle).Shape()


def revolved_to_axis():
    """A drop: the profile ends on the axis at both ends."""
    curve = spline_edge([(0, 0, 0), (7, 0, 4), (4, 0, 12), (0, 0, 18)])
    face = BRepBuilderAPI_MakeFace(wire(curve, line((0, 0, 18), (0, 0, 0)))).Face()
    return BRepPrimAPI_MakeRevol(face, gp_Ax1(gp_Pnt(0, 0, 0), gp_Dir(0, 0, 1))).Shape()


def elliptic_prism():
    ellipse = BRepBuilderAPI_MakeEdge(gp_Elips(axes(), 12.0, 7.0)).Edge()
    return BRepPrimAPI_MakePrism(BRepBuilderAPI_MakeFace(wire(ellipse)).Face(), gp_Vec(0, 3, 15)).Shape()


def elliptic_ring():
    """An ellipse turned about an axis beside it: a surface of revolution with a closed profile."""
    ellipse = BRepBuilderAPI_MakeEdge(gp_Elips(gp_Ax2(gp_Pnt(20, 0, 0), gp_Dir(0, 1, 0)), 5.0, 3.0)).Edge()
    face = BRepBuilderAPI_MakeFace(wire(ellipse)).Face()
    return BRepPrimAPI_MakeRevol(face, gp_Ax1(gp_Pnt(0, 0, 0), gp_Dir(0, 0, 1))).Shape()


def loft(closed_ends):
    make = BRepOffsetAPI_ThruSections(True, False)
    for z, radius in [(0, 10), (10, 6), (20, 12)]:
        make.AddWire(wire(BRepBuilderAPI_MakeEdge(gp_Circ(axes(z=z), radius)).Edge()))
    return make.Shape()


def pipe():
    path = wire(spline_edge([(0, 0, 0), (10, 0, 10), (25, 10, 12), (30, 25, 20)]))
    circle = BRepBuilderAPI_MakeEdge(gp_Circ(axes(dx=1, dz=1), 3.0)).Edge()
    return BRepOffsetAPI_MakePipe(path, BRepBuilderAPI_MakeFace(wire(circle)).Face()).Shape()


def drilled_block():
    """A through hole, a blind hole with a flat end, one with a cone, one with a ball and a counterbore."""
    through = BRepPrimAPI_MakeCylinder(axes(8, 8, -1), 3.0, 30.0).Shape()
    blind = BRepPrimAPI_MakeCylinder(axes(20, 8, 8), 2.5, 30.0).Shape()
    drill = BRepAlgoAPI_Fuse(
        BRepPrimAPI_MakeCylinder(axes(32, 8, 8), 2.0, 30.0).Shape(),
        BRepPrimAPI_MakeCone(axes(32, 8, 6.8), 0.0, 2.0, 1.2).Shape(),
    ).Shape()
    ball = BRepAlgoAPI_Fuse(
        BRepPrimAPI_MakeCylinder(axes(8, 20, 9), 2.0, 30.0).Shape(),
        BRepPrimAPI_MakeSphere(gp_Pnt(8, 20, 9), 2.0).Shape(),
    ).Shape()
    bore = BRepAlgoAPI_Fuse(
        BRepPrimAPI_MakeCylinder(axes(25, 20, -1), 2.0, 30.0).Shape(),
        BRepPrimAPI_MakeCylinder(axes(25, 20, 14), 4.0, 30.0).Shape(),
    ).Shape()
    return cut(block(), through, blind, drill, ball, bore)


def crossed_cylinders():
    a = BRepPrimAPI_MakeCylinder(axes(0, 0, -20), 8.0, 40.0).Shape()
    b = BRepPrimAPI_MakeCylinder(axes(-20, 0, 0, 1, 0, 0), 5.0, 40.0).Shape()
    return BRepAlgoAPI_Fuse(a, b).Shape()


def sphere_with_holes():
    ball = BRepPrimAPI_MakeSphere(10.0).Shape()
    side = BRepPrimAPI_MakeCylinder(axes(0, 0, 0, 1, 0.3, 0.2), 3.0, 30.0).Shape()
    top = BRepPrimAPI_MakeCylinder(axes(0, 0, 0), 2.0, 30.0).Shape()
    return cut(ball, side, top)


def half_sphere_on_its_side():
    """The bounds pass both poles of the sphere."""
    slab = BRepPrimAPI_MakeBox(gp_Pnt(-20, 0, -20), 40.0, 20.0, 40.0).Shape()
    return BRepAlgoAPI_Common(BRepPrimAPI_MakeSphere(10.0).Shape(), slab).Shape()


def torus_with_a_hole():
    ring = BRepPrimAPI_MakeTorus(20.0, 5.0).Shape()
    return cut(ring, BRepPrimAPI_MakeCylinder(axes(20, 0, 0, 0.2, 0.1, 1), 2.0, 30.0).Shape())


def cone_with_a_hole():
    cone = BRepPrimAPI_MakeCone(12.0, 0.0, 24.0).Shape()
    return cut(cone, BRepPrimAPI_MakeCylinder(axes(-20, 0, 8, 1, 0, 0), 3.0, 40.0).Shape())


SHAPES = {
    "block": block,
    "block_turned": lambda: turned(block()),
    "block_filleted": lambda: turned(filleted(block(), 3.0)),
    "block_chamfered": lambda: chamfered(block(), 2.0),
    "block_drilled": drilled_block,
    "cylinder": lambda: turned(BRepPrimAPI_MakeCylinder(7.0, 20.0).Shape()),
    "cylinder_part": lambda: BRepPrimAPI_MakeCylinder(7.0, 20.0, 2.0).Shape(),
    "cylinder_cut": lambda: cut(
        BRepPrimAPI_MakeCylinder(7.0, 20.0).Shape(), turned(BRepPrimAPI_MakeBox(gp_Pnt(-30, -30, 12), 60.0, 60.0, 60.0).Shape())
    ),
    "cylinders_crossed": crossed_cylinders,
    "cone": lambda: turned(BRepPrimAPI_MakeCone(12.0, 4.0, 15.0).Shape()),
    "cone_apex": lambda: BRepPrimAPI_MakeCone(12.0, 0.0, 15.0).Shape(),
    "cone_apex_below": lambda: BRepPrimAPI_MakeCone(0.0, 12.0, 15.0, 4.0).Shape(),
    "cone_hole": cone_with_a_hole,
    "cone_hyperbola": lambda: cut(
        BRepPrimAPI_MakeCone(12.0, 0.0, 15.0).Shape(), BRepPrimAPI_MakeBox(gp_Pnt(5, -30, -1), 60.0, 60.0, 60.0).Shape()
    ),
    "sphere": lambda: turned(BRepPrimAPI_MakeSphere(10.0).Shape()),
    "sphere_part": lambda: turned(BRepPrimAPI_MakeSphere(10.0, -0.5, 1.0, 2.0).Shape()),
    "sphere_octant": lambda: BRepPrimAPI_MakeSphere(10.0, 0.0, math.pi / 2, math.pi / 2).Shape(),
    "sphere_side": half_sphere_on_its_side,
    "sphere_holes": sphere_with_holes,
    "torus": lambda: turned(BRepPrimAPI_MakeTorus(20.0, 5.0).Shape()),
    "torus_part": lambda: BRepPrimAPI_MakeTorus(20.0, 5.0, 1.5).Shape(),
    "torus_hole": torus_with_a_hole,
    "wavy_face": wavy_face,
    "wavy_block": lambda: turned(wavy_block()),
    "extruded_spline": extruded_spline,
    "revolved_spline": lambda: turned(revolved_spline(2 * math.pi)),
    "revolved_part": lambda: revolved_spline(2.0),
    "revolved_to_axis": lambda: turned(revolved_to_axis()),
    "elliptic_prism": elliptic_prism,
    "elliptic_ring": lambda: turned(elliptic_ring()),
    "loft": lambda: turned(loft(True)),
    "pipe": pipe,
}

# Shapes whose faces are written again as splines.
AS_SPLINES = [
    "block_drilled", "block_filleted", "cone_apex", "cylinder", "cylinders_crossed", "sphere", "sphere_holes", "torus",
    "torus_hole", "revolved_to_axis", "elliptic_ring",
]


def write(shape, path, schema, unit):
    Interface_Static.SetCVal_s("write.step.schema", schema)
    Interface_Static.SetCVal_s("write.step.unit", unit)
    writer = STEPControl_Writer()
    writer.Transfer(shape, STEPControl_AsIs)
    assert writer.Write(str(path)) == IFSelect_RetDone, path


def main(folder):
    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    schemas = ["AP203", "AP214IS", "AP242DIS"]
    units = ["MM", "INCH", "M"]
    for k, (name, make) in enumerate(SHAPES.items()):
        shape = make()
        write(shape, folder / f"{name}.step", schemas[k % 3], units[k // 3 % 3])
        if name in AS_SPLINES:
            splines = BRepBuilderAPI_NurbsConvert(shape, True).Shape()
            write(splines, folder / f"{name}_as_splines.step", "AP214IS", "MM")


if __name__ == "__main__":
    main(sys.argv[1])
