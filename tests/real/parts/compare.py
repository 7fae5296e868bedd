"""Compares the figures of STEP files with those of Open CASCADE. Usage: compare.py FIGURES FILE...

FIGURES holds the lines of figures.rs for the files. Each face is found in Open CASCADE by its instance. Its area may
differ by 1e-6 and its box by 1e-5 of its size, and points of its B-spline may be 1e-8 mm from the surface.
"""

import json
import sys

from OCP.Bnd import Bnd_Box
from OCP.BRep import BRep_Tool
from OCP.BRepBndLib import BRepBndLib
from OCP.BRepGProp import BRepGProp
from OCP.Geom import Geom_RectangularTrimmedSurface
from OCP.GeomAPI import GeomAPI_ProjectPointOnSurf
from OCP.gp import gp_Pnt
from OCP.GProp import GProp_GProps
from OCP.STEPControl import STEPControl_Reader
from OCP.TopAbs import TopAbs_FACE
from OCP.TopExp import TopExp_Explorer
from OCP.TopoDS import TopoDS

AREA_SHARE = 1e-6
BOX_SHARE = 1e-5
POINT_MM = 1e-8


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


def faces_of(path):
    """The faces that Open CASCADE reads, by the number of their instance."""
    reader = STEPControl_Reader()
    reader.ReadFile(path)
    reader.TransferRoots()
    process = reader.WS().TransferReader()
    model = reader.StepModel()
    found = {}
    explorer = TopExp_Explorer(reader.OneShape(), TopAbs_FACE)
    while explorer.More():
        face = TopoDS.Face_s(explorer.Current())
        entity = process.EntityFromShapeResult(face, 1) or process.EntityFromShapeResult(face, -1)
        number = model.IdentLabel(entity) if entity is not None else 0
        found.setdefault(number, []).append(face)
        explorer.Next()
    return found


def surface_distance(face, point):
    surface = BRep_Tool.Surface_s(face)
    while isinstance(surface, Geom_RectangularTrimmedSurface):
        surface = surface.BasisSurface()
    search = GeomAPI_ProjectPointOnSurf(gp_Pnt(*point), surface)
    return search.LowerDistance() if search.NbPoints() else None


def compare(figures, path, counts):
    faults = []
    if "error" in figures:
        return [f"not read: {figures['error']}"]
    others = faces_of(path)
    n_others = sum(len(faces) for faces in others.values())
    if n_others != len(figures["faces"]):
        faults.append(f"{len(figures['faces'])} faces, Open CASCADE has {n_others}; left out: {figures['left_out']}")
    pools = {number: [(face, areas_of(face), box_of(face)) for face in faces] for number, faces in others.items()}
    everything = [one for pool in pools.values() for one in pool]
    for face in figures["faces"]:
        pool = pools.get(face["entity"]) or everything
        size = max(face["box"][k + 3] - face["box"][k] for k in range(3))

        def miss(one):
            return max(abs(a - b) for a, b in zip(face["box"], one[2])) + min(abs(area - face["area"]) for area in one[1]) / size

        other, areas, box = min(pool, key=miss)
        name = f"#{face['entity']} {face['kind']}"
        counts["faces"] += 1
        counts[face["kind"]] = counts.get(face["kind"], 0) + 1
        share = min(abs(face["area"] / area - 1) for area in areas)
        counts["area"] = max(counts["area"], share) if share <= AREA_SHARE else counts["area"]
        if share > AREA_SHARE:
            faults.append(f"{name}: the area is {face['area']}, Open CASCADE has {areas}: {share:.1e}")
        gap = max(abs(a - b) for a, b in zip(face["box"], box)) / size
        if gap > BOX_SHARE:
            faults.append(f"{name}: the box is off by {gap:.1e} of its size: {face['box']}, {box}")
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


def main(report, paths):
    counts = {"faces": 0, "points": 0, "area": 0.0, "distance": 0.0}
    by_path = {one["path"]: one for one in map(json.loads, open(report))}
    wrong = 0
    for path in paths:
        faults = compare(by_path[path], path, counts)
        wrong += bool(faults)
        for fault in faults[:6]:
            print(f"{path}: {fault}")
        if len(faults) > 6:
            print(f"{path}: and {len(faults) - 6} more")
    print(f"{len(paths)} files, {wrong} of them differ; {counts}")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1], sys.argv[2:]))
