"""Has the service write and verify programs, and judges the receipts with check.py: each has to hold as it is, and
none may hold once a digit of it was altered. Usage: altered.py SIGNED_ADDRESS PLAIN_ADDRESS PUBLIC_KEY [ALTERATIONS]
"""
import copy
import json
import random
import sys
import urllib.request

import check as checker

EXAMPLES = "openapi/examples"
POCKETS = ["arcs", "circle", "island", "l-shape", "rectangle"]
# Of so many alterations without a signature one has its digest made anew.
FORGED = 21
ALTERED = {"0": "123456789", "a": "bcdef"}


def post(address, path, body):
    request = urllib.request.Request(address + path, json.dumps(body).encode(), {"Content-Type": "application/json"})
    with urllib.request.urlopen(request, timeout=120) as answer:
        return json.load(answer)


def example(folder, name):
    with open(f"{EXAMPLES}/{folder}/{name}.json") as file:
        return json.load(file)


def bodies(address):
    """Bodies of requests to verify: examples, and programs that the service has written."""
    yield "pocket", example("programs-verify", "pocket")
    yield "faults", example("programs-verify", "faults")
    yield "clamp", example("programs-verify", "clamp")
    for name in POCKETS:
        body = example("pockets-plan", name)
        body.setdefault("cutting", {"feed_mm_per_min": 800})
        nc = post(address, "/v1/pockets/plan?nc=true&toolpath=false", body)["nc"]
        tool = {key: body["tool"][key] for key in ("shape", "diameter_mm", "corner_radius_mm") if key in body["tool"]}
        heights = {key: body[key] for key in ("top_z_mm", "floor_z_mm") if key in body}
        region = {"boundary": body["region"]["boundary"], "islands": body["region"].get("islands", [])}
        yield f"plan {name}", {"nc": nc, "tool": tool, "region": region, **heights, "tolerance_mm": 0.02}
    body = example("surfaces-mill", "bezier-patches")
    nc = post(address, "/v1/surfaces/mill?nc=true&toolpath=false", body)["nc"]
    tool = {key: body["tool"][key] for key in ("shape", "diameter_mm", "corner_radius_mm") if key in body["tool"]}
    yield "mill bezier-patches", {"nc": nc, "tool": tool, "surface": body["surface"], "tolerance_mm": 0.05}


def judged(receipt, program, part, key):
    try:
        checker.check(receipt, program, part, key)
    except checker.Rejected as reason:
        return f"rejected: {reason}"
    except checker.Unread as reason:
        return f"not checked further: {reason}"
    return "holds"


def altered(receipt, rng):
    """The receipt with another digit somewhere in its text."""
    text = json.dumps(receipt)
    while True:
        k = rng.randrange(len(text))
        others = ALTERED["0"] + "0" if text[k].isdigit() else ALTERED["a"] + "a" if text[k] in "abcdef" else ""
        if not others:
            continue
        changed = text[:k] + rng.choice([other for other in others if other != text[k]]) + text[k + 1:]
        try:
            value = json.loads(changed)
        except json.JSONDecodeError:
            continue
        # A digit beyond the precision of a number alters nothing.
        if value != receipt:
            return value


def forged(receipt):
    """The receipt with a digest that fits."""
    content = copy.deepcopy(receipt)
    content.pop("digest", None)
    signature = content.pop("signature", None)
    content["digest"] = checker.digest(content)
    if signature:
        content["signature"] = signature
    return content


def whitewashed(receipt):
    """The receipt of a gouging program, made to tell of none."""
    content = copy.deepcopy(receipt)
    content["verdict"], content["counts"], content["bounds"]["gouge_mm"] = "pass", [], 0.0
    for own in content["moves"]:
        own.update(gouge_mm=0.0, found_mm=0.0)
    return forged(content)


def main(signed_address, plain_address, key, n=1000):
    rng, failures, receipts = random.Random(1), [], []
    for name, body in bodies(plain_address):
        program = body["nc"].encode() if "nc" in body else json.dumps(body["toolpath"]).encode()
        for address, own_key in ((signed_address, key), (plain_address, None)):
            receipt = post(address, "/v1/programs/verify?receipt=true", body)["receipt"]
            receipts.append((name, receipt, program, body, own_key))
            if own_key:
                continue
            verdict = judged(receipt, program, body, own_key)
            print(f"{name:20} {receipt['verdict']:9} {len(receipt['moves']):6} moves  {verdict}")
            if receipt["verdict"] == "fail" and not judged(whitewashed(receipt), program, body, None).startswith("rejected"):
                failures.append(f"{name}: made to pass, and not rejected")
            if verdict.startswith("rejected"):
                failures.append(f"{name}: {verdict}")
    counts = dict.fromkeys(("as it is", "signed, digest made anew", "not signed, digest made anew"), 0)
    rejected = dict(counts)
    for k in range(int(n)):
        name, receipt, program, body, own_key = receipts[k % len(receipts)]
        bad = altered(receipt, rng)
        kinds = {"as it is": bad}
        # A forger who alters the digest and makes it anew has altered nothing. Without a signature the moves are
        # proved again, which takes seconds.
        if forged(bad) != receipt:
            if own_key:
                kinds["signed, digest made anew"] = forged(bad)
            elif k % FORGED == 0:
                kinds["not signed, digest made anew"] = forged(bad)
        for kind, own in kinds.items():
            verdict = judged(own, program, body, own_key)
            counts[kind] += 1
            rejected[kind] += verdict.startswith("rejected")
            if not verdict.startswith("rejected") and not kind.startswith("not signed"):
                failures.append(f"{name}: altered, and {verdict}")
    for kind in counts:
        print(f"altered receipts, {kind}: {rejected[kind]} of {counts[kind]} rejected")
    for name, receipt, program, body, own_key in receipts:
        try:
            checker.check_signature(receipt, own_key)
        except checker.Rejected as reason:
            failures.append(f"{name}: {reason}")
        other = program.replace(b"Y", b"X") if "nc" in body else b"[]"
        for what, own, part in (("program", other, body), ("part", program, {**body, "floor_z_mm": -77})):
            verdict = judged(receipt, own, part, own_key)
            if what not in verdict or "stale" not in verdict:
                failures.append(f"{name}, another {what}: {verdict}")
    print("\n".join(failures))
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
