"""Judges pockets that a service plans, by moving the disc of the cutter over cells of the stock.

The script knows nothing of how the service works. It posts bodies to POST /v1/pockets/plan and measures the toolpath:

gouge      depth to which the cutter comes into walls or islands, mm, from closed forms
uncut      area in the cutter's reach that stands on a level, mm2, and its share, %
over       share of the cut length whose angle in material is above 1.1 times that of a straight pass: at full feed / at any feed, %
slot       share of the cut length that is a slot: at full feed / at any feed, %
nominal    time of a level over area / (stepover x feed), the worst level
lifts      lifts between the first and the last cut of a level, the worst level
clear      least distance between the cutter's side and walls that have reached their size, of rapids, plunges, ramps and links
           below the stock's top, and of the outer ends of leads, mm; `near`: number of moves nearer than `clearance_side_mm`
lead       wall passes / their ends without a lead, largest kink at an end in degrees, least overlap of closed passes in mm
kinks      kinks of more than 30 degrees of roughing passes on the floor
mat        rapids in material / length of links through material, mm / plunges in material
stands     least and most that stands on walls where the cutter reaches, mm

Usage: judge.py [--url URL] [--only TEXT] [--population NAME ...] [--patterns P,...] [--set KEY=JSON ...]
                [--body FILE ...] [--list] [--strict] [--count N] [--json FILE]
"""

import argparse
import json
import math
import pathlib
import sys
import time
import urllib.error
import urllib.request

import numpy

from cases import POPULATIONS
from measure import NotJudged, judge

# What `run` insists on: the first word of such a fault.
HARD = ("gouge", "uncut", "rapid", "nothing")
# Share of the bodies that has to be planned, at least, with `--strict`.
PLANNED = 0.8
# Longest time of a call, s.
LONGEST_S = 600


def plan(url, body):
    """Status, answer and seconds of a call."""
    request = urllib.request.Request(f"{url}/v1/pockets/plan", json.dumps(body).encode(), {"content-type": "application/json"})
    begin = time.monotonic()
    try:
        with urllib.request.urlopen(request, timeout=LONGEST_S) as answer:
            return answer.status, json.load(answer), time.monotonic() - begin
    except urllib.error.HTTPError as error:
        return error.code, json.load(error), time.monotonic() - begin


def overridden(body, changes):
    """A body with members set: keys may have dots."""
    body = json.loads(json.dumps(body))
    for key, value in changes:
        at = body
        *parents, last = key.split(".")
        for parent in parents:
            at = at.setdefault(parent, {})
        at[last] = value
    return body


HEAD = (f"{'case':<30}{'plan s':>7} {'gouge':>7} {'uncut mm2':>9} {'%':>6} {'over%':>6}{'/any':>6} {'slot%':>6}{'/any':>6} {'nominal':>7} {'lifts':>5} "
        f"{'clear':>8} {'near':>5} {'wall':>4}/{'no':<3}{'kink':>5}{'lap':>7} {'kinks':>5} {'mat':>13} {'stands':>17}  pattern")


def row(name, seconds, f, patterns):
    mat = f"{f['rapids_hit']}/{f['links_hit']:.1f}/{f['plunges']}"
    stands = f"{f['stands_least']:.4f}..{f['stands_most']:.4f}"
    return (f"{name:<30}{seconds:7.2f} {f['gouge']:7.4f} {f['uncut']:9.3f} {f['uncut_share']:6.3f} {f['over_full']:6.1f}{f['over_any']:6.1f} "
            f"{f['slot_full']:6.1f}{f['slot_any']:6.1f} {max(f['nominal'], default=0):7.3f} {max(f['lifts'], default=0):5} {f['clear']:8.4f} {f['n_near']:5} "
            f"{f['n_wall_passes']:4}/{f['no_lead']:<3}{f['lead_kink']:5.0f}{f['overlap_least']:7.2f} {f['kinks']:5} {mat:>13} {stands:>17}  {patterns}")


def details(f):
    """The places behind the figures."""
    lines = [f"      near {gap:.4f}: {what} at {where}" for gap, what, where in f["near"][:8]]
    lines += [f"      lead: {one}" for one in f["lead_bad"][:8]]
    lines += [f"      kink {angle:.0f} deg at {where}" for angle, where in f["kinks_listed"][:5]]
    return lines


def geometric(values):
    values = [max(one, 1e-9) for one in values]
    return math.exp(sum(map(math.log, values)) / len(values)) if values else float("nan")


def summary(results, refused):
    """Lines about all cases together."""
    figures = [f for _, f in results]
    if not figures:
        return [f"no case was planned, {len(refused)} refused"]
    nominal = [one for f in figures for one in f["nominal"]]
    lifts = [one for f in figures for one in f["lifts"]]
    cut = sum(f["cut_length"] for f in figures)
    weighted = lambda key: sum(f[key] * f["cut_length"] for f in figures) / cut
    worst = lambda key, most=True: (max if most else min)(results, key=lambda pair: pair[1][key])
    named = lambda key, most=True: f"{worst(key, most)[1][key]:.4g} ({worst(key, most)[0]})"
    passes, ends = sum(f["n_wall_passes"] for f in figures), sum(f["lead_ends"] for f in figures)
    return [
        f"{len(figures)} planned, {len(refused)} refused" + (f": {', '.join(f'{name} {why}' for name, why in refused)}" if refused else ""),
        f"gouge: worst {named('gouge')};  uncut: {sum(f['uncut_share'] > 0.05 for f in figures)} cases above 0.05 %, worst {named('uncut_share')} %",
        f"above 1.1 x straight: at full feed {weighted('over_full'):.1f} % of all length, median case {numpy.median([f['over_full'] for f in figures]):.1f}, worst {named('over_full')}; at any feed {weighted('over_any'):.1f} %",
        f"slots: at full feed {weighted('slot_full'):.1f} % of all length, worst {named('slot_full')}; at any feed {weighted('slot_any'):.1f} %",
        f"time over nominal, per level: geometric mean {geometric(nominal):.3f}, least {min(nominal):.3f}, worst {max(nominal):.3f}",
        f"lifts per level: mean {numpy.mean(lifts):.1f}, median {numpy.median(lifts):.0f}, worst {max(lifts)}",
        f"clearance: {sum(f['n_near'] > 0 for f in figures)} cases with a move nearer than asked, {sum(f['n_near'] for f in figures)} moves; least {named('clear', False)}",
        f"leads: {passes} wall passes, {sum(f['no_lead'] for f in figures)} of {ends} ends without a lead, {sum(len(f['lead_bad']) for f in figures)} not tangential or without; "
        f"worst kink {named('lead_kink')} deg; {sum(f['open_wall_passes'] for f in figures)} passes do not overlap their start",
        f"kinks in roughing: {sum(f['kinks'] for f in figures)}, worst {named('kinks')}",
        f"material: {sum(f['rapids_hit'] > 0 for f in figures)} cases with rapids in it, links {sum(f['links_hit'] for f in figures):.1f} mm, plunges {sum(f['plunges'] for f in figures)}",
        f"walls: most that stands {named('stands_most')}, least {named('stands_least', False)}",
        f"cases with faults: {sum(bool(f['faults']) for f in figures)} of {len(figures)}; hard: {sum(any(one.startswith(HARD) for one in f['faults']) for f in figures)}",
    ]


def transform_lines(results, refused):
    """Times of the same pocket said in other ways."""
    groups = {}
    for name, f in results:
        if "/" in name:
            groups.setdefault(name.split("/")[0], {})[name.split("/")[1]] = f["total_s"]
    lines, ratios = [], []
    for name, times in groups.items():
        base = times.get("as-it-is")
        if base:
            lines.append(f"  {name:<24}" + "".join(f" {way} {seconds / base:.3f}" for way, seconds in times.items() if way != "as-it-is"))
            ratios += [max(seconds / base, base / seconds) for seconds in times.values()]
    if ratios:
        lines.append(f"  times of the same pocket: worst ratio {max(ratios):.3f}, {sum(one > 1.02 for one in ratios)} of {len(ratios)} differ by more than 2 %")
    return lines


def bodies_of(options):
    bodies = {}
    for name in options.population or ([] if options.body else ["examples", "ordinary"]):
        for case, body in POPULATIONS[name]().items():
            bodies[case if case not in bodies else f"{name}:{case}"] = body
    for file in options.body or []:
        bodies[pathlib.Path(file).stem] = json.loads(pathlib.Path(file).read_text())
    bodies = {name: body for name, body in bodies.items() if not options.only or any(text in name for text in options.only.split(","))}
    return dict(list(bodies.items())[: options.count])


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--url", default="http://127.0.0.1:8301")
    parser.add_argument("--only", help="cases whose name contains one of these texts, with commas between them")
    parser.add_argument("--population", action="append", choices=list(POPULATIONS))
    parser.add_argument("--patterns", help="patterns to ask for, with commas between them")
    parser.add_argument("--set", action="append", default=[], metavar="KEY=JSON")
    parser.add_argument("--body", action="append", metavar="FILE", help="a body of your own")
    parser.add_argument("--count", type=int, help="only the first cases")
    parser.add_argument("--list", action="store_true", help="list places below each row")
    parser.add_argument("--strict", action="store_true", help="exit code 1 for gouges, uncut material and rapids in material, and where too many are refused")
    parser.add_argument("--json", help="write all figures to this file")
    options = parser.parse_args()
    if "://" not in options.url:
        options.url = f"http://{options.url}"
    changes = [(key, json.loads(value)) for key, value in (one.split("=", 1) for one in options.set)]
    if options.patterns:
        changes.append(("patterns", options.patterns.split(",")))
    results, refused, failed = [], [], []
    print(HEAD)
    for name, body in bodies_of(options).items():
        body = overridden(body, changes)
        status, answer, seconds = plan(options.url, body)
        if status != 200:
            refused.append((name, answer.get("code", str(status))))
            print(f"{name:<30}{seconds:7.2f} refused {status} {answer.get('code')}: {answer.get('detail', '')[:160]}", flush=True)
            continue
        try:
            figures = judge(body, answer)
        except NotJudged as why:
            print(f"{name:<30}{seconds:7.2f} not judged: {why}", flush=True)
            continue
        chosen = ",".join(dict.fromkeys(str(level["chosen"]) for level in answer["report"]["levels"]))
        print(row(name, seconds, figures, chosen))
        for line in [f"    ! {fault}" for fault in figures["faults"]] + (details(figures) if options.list else []):
            print(line)
        sys.stdout.flush()
        results.append((name, figures))
        failed += [name] * any(fault.startswith(HARD) for fault in figures["faults"])
    print()
    for line in summary(results, refused) + transform_lines(results, refused):
        print(line)
    if options.json:
        pathlib.Path(options.json).write_text(json.dumps(dict(results), default=float))
    if options.strict and (failed or len(results) < PLANNED * (len(results) + len(refused)) or not results):
        print(f"failed: {', '.join(failed) or 'too few were planned'}")
        sys.exit(1)


if __name__ == "__main__":
    main()
