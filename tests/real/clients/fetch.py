"""Fetches JSON and NC text from the service at the given address, with the client generated from the contract."""

import sys

from toolpathd_client import Client, models
from toolpathd_client.api.curves import fit_arcs, interpolate_curve
from toolpathd_client.api.programs import write_program
from toolpathd_client.api.service import get_limits, list_dialects
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

mill.tolerance_mm = -1
problem = fetched(mill_surface, models.Problem, body=mill)
assert problem.code == models.ProblemCode.INVALID_REQUEST, problem
assert [error.pointer for error in problem.errors] == ["#/tolerance_mm"], problem
print("Python: the client fetched JSON and NC text")
