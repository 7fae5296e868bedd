"""Calls every operation of the service at the given address, with the client generated from the contract."""

import base64
import io
import sys

from toolpathd_client import Client, models, types
from toolpathd_client.api.curves import fit_arcs, interpolate_curve, put_arcs
from toolpathd_client.api.dnc import list_controls, send_program
from toolpathd_client.api.five_axis import list_machines, smooth_path
from toolpathd_client.api.operation import get_metrics, livez, readyz
from toolpathd_client.api.parts import inspect_part
from toolpathd_client.api.pockets import plan_pocket
from toolpathd_client.api.programs import read_program, verify_program, write_program
from toolpathd_client.api.service import get_contract, get_limits, list_dialects
from toolpathd_client.api.surfaces import drop_cutter, mill_surface, model_surface

client = Client(base_url=sys.argv[1], raise_on_unexpected_status=True)


def fetched(operation, kind, **arguments):
    """The JSON answer of an operation; fails unless the answer has the type that the contract names."""
    answer = operation.sync(client=client, **arguments)
    assert isinstance(answer, kind), answer
    return answer


limits = fetched(get_limits, models.ServerLimits)
assert limits.workers >= 1
dialects = fetched(list_dialects, models.Dialects)
assert dialects.default in [dialect.name for dialect in dialects.dialects]

surface = models.PointGrid.from_dict(
    {"kind": "point_grid", "points": [[[0, 0, 0], [0, 1, 0]], [[10, 0, 0], [10, 1, 0]]]}
)
tool = models.Tool(shape=models.ToolShape.BALL, diameter_mm=6)
strategy = models.ClCartesian.from_dict({"kind": "cl_cartesian", "stepover_mm": 2})
cutting = models.Cutting(feed_mm_per_min=500)
mill = models.MillRequest(surface=surface, tool=tool, strategy=strategy, tolerance_mm=0.01, cutting=cutting)

answer = fetched(mill_surface, models.AnswerMillReport, body=mill, nc=True, toolpath=True)
assert answer.report.n_passes == 2 and answer.report.gouge_max_mm <= 0.01, answer.report
assert answer.measures.total_time_s > 0
assert "M30" in answer.nc

# The toolpath of one answer is the request of another operation.
write = models.WriteRequest(toolpath=answer.toolpath, cutting=cutting)
written = fetched(write_program, models.AnswerWriteReport, body=write, format_=models.WriteProgramFormat.JSON)
assert written.report.n_blocks > 2 and "G1" in written.nc, written

# The client decodes JSON only, so NC text is fetched by the request that the generated function builds.
request = mill_surface._get_kwargs(body=mill, format_=models.MillSurfaceFormat.GCODE)
program = client.get_httpx_client().request(**request)
assert program.status_code == 200 and program.headers["content-type"].startswith("text/x-gcode"), program
assert program.text == answer.nc

model = fetched(model_surface, models.AnswerModelReport, body=models.ModelRequest(surface=surface))
assert model.report.n_patches == 1 and model.report.bounds.max_[0] == 10, model.report
drop = models.DropRequest(surface=surface, tool=tool, points=[[5, 0.5], [50, 50]])
tips = fetched(drop_cutter, models.AnswerDropReport, body=drop).report.tips
assert tips[0][:2] == [5, 0.5] and tips[1] is None, tips

curve = models.Graph.from_dict({"kind": "graph", "expression": "sin(x)", "domain": [0, 6.5]})
band = models.Band(below_mm=0.1, above_mm=0.1)
interpolate = models.InterpolateRequest(curve=curve, method=models.InterpolationMethod.ARC, band=band)
elements = fetched(interpolate_curve, models.AnswerInterpolateReport, body=interpolate)
assert elements.report.deviation_max_mm <= 0.1, elements.report
fit = models.FitRequest(polyline=[[0, 0], [10, 0], [20, 0]], tolerance_mm=0.01)
assert fetched(fit_arcs, models.AnswerAnyFitReport, body=fit).report.n_lines == 1

assert fetched(put_arcs, models.AnswerAnyFitReport, body=fit).report.n_lines == 1

pocket = models.PocketRequest.from_dict(
    {
        "region": {"boundary": [[0, 0], [50, 0], [50, 30], [0, 30]]},
        "floor_z_mm": -3,
        "stepdown_max_mm": 3,
        "stepover_mm": 3,
        "tool": {"shape": "flat", "diameter_mm": 8},
        "cutting": {"feed_mm_per_min": 800},
    }
)
planned = fetched(plan_pocket, models.AnswerPocketReport, body=pocket, points=True)
assert len(planned.report.levels) == 1 and len(planned.polyline) > 2, planned.report
points = base64.b64encode(b"0 0 0\n0 9 1\n9 0 1\n9 9 0\n").decode()
inspect = models.InspectRequest.from_dict({"file": {"name": "a.xyz", "base64": points}, "units": "mm"})
inspected = fetched(inspect_part, models.AnswerInspectReport, body=inspect)
assert inspected.report.points.grid.n_rows == 2, inspected.report
path = [{"tip": [0, 0, 0], "axis": [0, 0, 1]}, {"tip": [10, 0, 0], "axis": [0, 0, 1]}]
smooth = {"path": path, "feed_mm_per_min": 800, "tolerance_mm": 0.01, "tolerance_deg": 0.5}
smoothed = fetched(smooth_path, models.AnswerSmoothReport, body=models.SmoothRequest.from_dict(smooth))
assert smoothed.report.within_tolerance, smoothed.report
text = "G21 G90\nG0 X0 Y0 Z5\nG1 X10 F500\nM2\n"
read = fetched(read_program, models.AnswerReadReport, body=models.ReadRequest(nc=text))
# A program may be sent as it is, too.
sent = types.File(payload=io.BytesIO(text.encode()))
assert fetched(read_program, models.AnswerReadReport, body=sent).measures.cutting_length_mm == 10
verify = {"nc": text, "start": [0, 0, 0], "tool": {"shape": "flat", "diameter_mm": 4}, "tolerance_mm": 0.01}
verify["stock"] = {"kind": "box", "min": [0, -5, -9], "max": [10, 5, 1]}
verdict = fetched(verify_program, models.AnswerVerifyReport, body=models.VerifyRequest.from_dict(verify))
assert verdict.report.verdict.value in ("pass", "fail", "undecided"), verdict.report
assert fetched(list_controls, models.DncTargets).targets == []
refused = fetched(send_program, models.Problem, target="none", body=types.File(payload=io.BytesIO(b"M2")))
assert refused.code == models.ProblemCode.NOT_FOUND, refused
assert len(fetched(list_machines, models.Machines).machines) > 0
assert fetched(get_contract, models.GetContractResponse200)["openapi"].startswith("3.1")
for probe in [livez, readyz, get_metrics]:
    assert fetched(probe, str), probe

mill.tolerance_mm = -1
problem = fetched(mill_surface, models.Problem, body=mill)
assert problem.code == models.ProblemCode.INVALID_REQUEST, problem
assert [error.pointer for error in problem.errors] == ["#/tolerance_mm"], problem
print("Python: the client called every operation")
