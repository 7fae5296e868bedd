"""Compares the figures of STEP files with those of Open CASCADE. Usage: compare.py FIGURES SHARE FILE...

FIGURES holds the lines of figures.rs for the files. Each face is compared with the face of Open CASCADE with the most
similar box and area. Its area may differ by SHARE, its box by 10 SHARE of its size, and points of its B-spline may be
1e-8 mm from the surface. SHARE is 1e-6 for files whose edges meet; files of kernels with edges within 0.01 mm need
1e-3. Open CASCADE integrates oblique extrusions within 2e-5 only.
"""

import json
import sys

from OCP.Bnd import Bnd_Box
from OCP.BRep import BRep_Tool
from OCP.BRepBndLib import BRepBndLib
from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeVertex
from OCP.BRepClass3d import BRepClass3d_SolidClassifier
from OCP.BRepExtrema import BRepExtrema_DistShapeShape
from OCP.BRepGProp import BRepGProp
from OCP.BRepMesh import BRepMesh_IncrementalMesh
from OCP.Geom import Geom_RectangularTrimmedSurface
from OCP.GeomAPI import GeomAPI_ProjectPointOnSurf
from OCP.gp import gp_Pnt
from OCP.GProp import GProp_GProps
from OCP.STEPControl import STEPControl_Reader
from OCP.TopAbs import TopAbs_FACE, TopAbs_IN, TopAbs_OUT, TopAbs_SOLID
from OCP.TopExp import TopExp_Explorer
from OCP.TopLoc import TopLoc_Location
from OCP.TopoDS import TopoDS

EXTRUSION_SHARE = 2e-5
POINT_MM = 1e-8
MESH_SHARE = 1e-4
# Trims are compared in files of at most so many faces: Open CASCADE takes long for each point.
MOST_TRIMS = 60
CURVED = ("spline", "revolution", "extrusion", "torus", "sphere", "cone")


def areas_of(face):
    """The area by the two methods of Open CASCADE, each of which fails for some faces."""
    adaptive, plain = GProp_GProps(), GProp_GProps()
    BRepGProp.SurfaceProperties_s(face, adaptive, 1e-9)
    BRepGProp.SurfaceProperties_s(face, plain)
    return [adaptive.Mass(), plain.Mass()]


def box_of(face):
    box = Bnd_Box()
    BRepBndLib.AddOptimal_s(face, box, False, False)
    return list(box.Get())


def mesh_box(face, size):
    """The box of a fine mesh. `box_of` takes the whole rectangle of parameters of a trimmed spline."""
    BRepMesh_IncrementalMesh(face, MESH_SHARE * size, False, 0.1)
    place = TopLoc_Location()
    mesh = BRep_Tool.Triangulation_s(face, place)
    if mesh is None:
        return None
    points = [mesh.Node(k).Transformed(place.Transformation()) for k in range(1, mesh.NbNodes() + 1)]
    places = [(point.X(), point.Y(), point.Z()) for point in points]
    return [pick(axis) for pick in (min, max) for axis in zip(*places)]


def shape_of(path):
    reader = STEPControl_Reader()
    reader.ReadFile(path)
    reader.TransferRoots()
    return reader.OneShape()


def parts_of(shape, kind):
    explorer = TopExp_Explorer(shape, kind)
    while explorer.More():
        yield explorer.Current()
        explorer.Next()


def faults_inside(face, other, solid, size, slack):
    """Points within the trim must lie on the trimmed face, with the solid behind them."""
    for x, y, z, *normal in face["inside"]:
        point = gp_Pnt(x, y, z)
        distance = BRepExtrema_DistShapeShape(BRepBuilderAPI_MakeVertex(point).Vertex(), other).Value()
        if distance > 1e-6 + slack:
            yield f"{[x, y, z]} is {distance:.1e} mm from the trimmed face"
        if solid is None:
            continue
        step = 1e-4 * size + 2 * slack
        before, behind = (gp_Pnt(x + s * normal[0], y + s * normal[1], z + s * normal[2]) for s in (step, -step))
        states = [BRepClass3d_SolidClassifier(solid, place, 1e-7).State() for place in (before, behind)]
        if states != [TopAbs_OUT, TopAbs_IN]:
            yield f"the solid is not behind {[x, y, z]}: {states}"


def surface_distance(face, point):
    surface = BRep_Tool.Surface_s(face)
    while isinstance(surface, Geom_RectangularTrimmedSurface):
        surface = surface.BasisSurface()
    search = GeomAPI_ProjectPointOnSurf(gp_Pnt(*point), surface)
    return search.LowerDistance() if search.NbPoints() else None


def compare(figures, path, allowed, counts):
    faults = []
    if "error" in figures:
        return [f"not read: {figures['error']}"]
    shape = shape_of(path)
    faces = [TopoDS.Face_s(face) for face in parts_of(shape, TopAbs_FACE)]
    others = [(face, areas_of(face), box_of(face)) for face in faces]
    solids = list(parts_of(shape, TopAbs_SOLID))
    solid = solids[0] if len(solids) == 1 else None
    if len(others) != len(figures["faces"]):
        faults.append(f"{len(figures['faces'])} faces, Open CASCADE has {len(others)}; {figures['left_out']}")
    for face in figures["faces"]:
        size = max(face["box"][k + 3] - face["box"][k] for k in range(3))

        def miss(one):
            return max(abs(a - b) for a, b in zip(face["box"], one[2])) + min(abs(area - face["area"]) for area in one[1]) / size

        other, areas, box = min(others, key=miss)
        name = f"#{face['entity']} {face['kind']}"
        counts["faces"] += 1
        counts[face["kind"]] = counts.get(face["kind"], 0) + 1
        share = min(abs(face["area"] / area - 1) for area in areas)
        # What the edges that leave the surface may change.
        slack = 2 * face["deviation"] if face["deviation"] > 1e-6 else 0.0
        limit = max(allowed, EXTRUSION_SHARE) if face["kind"] == "extrusion" else allowed
        limit += 4 * slack * size / face["area"]
        if share <= limit:
            counts["area"] = max(counts["area"], share)
        else:
            faults.append(f"{name}: the area is {face['area']}, Open CASCADE has {areas}: {share:.1e}")
        gap = max(abs(a - b) for a, b in zip(face["box"], box)) / size
        if gap > 10 * allowed + slack / size and face["kind"] in CURVED:
            mesh = mesh_box(other, size)
            gap = max(abs(a - b) for a, b in zip(face["box"], mesh)) / size - 2 * MESH_SHARE if mesh else gap
        if gap > 10 * allowed + slack / size:
            faults.append(f"{name}: the box is off by {gap:.1e} of its size: {face['box']}, {box}")
        if len(faces) <= MOST_TRIMS:
            faults += [f"{name}: {fault}" for fault in faults_inside(face, other, solid, size, slack)]
            counts["inside"] += len(face["inside"])
        for point in face["points"]:
            distance = surface_distance(other, point)
            if distance is None:
                continue
            counts["points"] += 1
            if distance > POINT_MM:
                faults.append(f"{name}: {point} is {distance:.1e} mm from the surface")
            else:
                counts["distance"] = max(counts["distance"], distance)
    return faults


def main(report, allowed, paths):
    counts = {"faces": 0, "points": 0, "inside": 0, "area": 0.0, "distance": 0.0}
    by_path = {one["path"]: one for one in map(json.loads, open(report))}
    wrong = 0
    for path in paths:
        faults = compare(by_path[path], path, float(allowed), counts)
        wrong += bool(faults)
        for fault in faults[:6]:
            print(f"{path}: {fault}")
        if len(faults) > 6:
            print(f"{path}: and {len(faults) - 6} more")
    print(f"{len(paths)} files, {wrong} of them differ; {counts}")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1], sys.argv[2], sys.argv[3:]))
