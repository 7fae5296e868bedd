"""Runs the random tests of the crates and of tests/it on fresh seeds.

First every kept case runs again. Each line of tests/real/explore/cases is a case that failed once: a seed, a test binary and
the name of a test. If a kept case fails, the script ends with exit code 1. Then random tests run on fresh seeds until the
time is over. A failure on a fresh seed need not come from the latest change. So the script prints it as a line
`FOUND seed=... test=...` with the smallest case, and still ends with exit code 0. The whole outputs go to a folder of
temporary files. Who mends such a failure adds its seed to the kept cases.

EXPLORE_SECONDS  time for fresh seeds in seconds; 300 if not given
EXPLORE_SEED     the seed from which all other seeds follow; random if not given

To run one test on one seed and see its output:
PROPTEST_RNG_SEED=<seed> cargo test <name of the test>
"""

import concurrent.futures
import json
import os
import pathlib
import random
import re
import subprocess
import sys
import tempfile
import threading
import time

ROOT = pathlib.Path(__file__).resolve().parents[3]
CASES = ROOT / "tests/real/explore/cases"
FOUND = pathlib.Path(tempfile.gettempdir()) / "toolpathd-explore"
SECONDS = float(os.environ.get("EXPLORE_SECONDS", "300"))
SEED = int(os.environ.get("EXPLORE_SEED", random.SystemRandom().randrange(1 << 32)))

# Longest time of one test, in seconds. A test that takes longer counts as failed.
LONGEST = 300

# The test binaries, each with the folder of its sources.
FOLDERS = {name: ROOT / "src" / name for name in ["core", "post", "plot", "server"]} | {"it": ROOT / "tests/it"}

# Matches a function, together with the attribute that makes the function a test.
FUNCTION = re.compile(r"(#\[(?:tokio::)?test\]\s*(?:#\[[^\]]*\]\s*|//[^\n]*\s*)*)?\bfn (\w+)(?:<[^(]*>)?\(([^{)]*)")


def binaries():
    """The paths of the test binaries of the crates and of tests/it, by name. .ci/run has built them already."""
    build = ["cargo", "test", "--locked", "--quiet", "--no-run", "--lib", "--test", "it", "--message-format=json"]
    lines = subprocess.run(build, cwd=ROOT, stdout=subprocess.PIPE, check=True, text=True).stdout.splitlines()
    artifacts = [json.loads(line) for line in lines if line.startswith("{")]
    tests = [one for one in artifacts if one.get("executable") and one["profile"]["test"]]
    return {one["target"]["name"].removeprefix("toolpathd_"): one["executable"] for one in tests}


def random_tests(folder):
    """The names of random tests. A random test takes arguments from proptest, or draws random numbers, itself or in a function."""
    names = []
    for path in sorted(folder.rglob("*.rs")):
        text = path.read_text()
        functions = list(FUNCTION.finditer(text))
        ends = [function.start() for function in functions[1:]] + [len(text)]
        bodies = {one[2]: text[one.end() : end] for one, end in zip(functions, ends)}
        asks = ["Random::stream", "TestRunner"]
        asks += [one[2] for one in functions if not one[1] and any(word in bodies[one[2]] for word in asks)]
        asking = re.compile("|".join(rf"\b{word}\b" for word in asks))
        module = "::".join(part for part in path.relative_to(folder).with_suffix("").parts if part != "lib")
        names += [
            (module, one[2]) for one in functions if one[1] and (one[3].strip() or asking.search(bodies[one[2]]))
        ]
    return names


def listed(executable):
    shown = subprocess.run([executable, "--list", "--format=terse"], stdout=subprocess.PIPE, check=True, text=True)
    return [line.removesuffix(": test") for line in shown.stdout.splitlines() if line.endswith(": test")]


def run(executable, name, seed):
    """The output of a test that fails; an empty text if the test passes."""
    environment = {**os.environ, "PROPTEST_RNG_SEED": str(seed), "PROPTEST_DISABLE_FAILURE_PERSISTENCE": "true"}
    command = [executable, "--exact", name, "--test-threads=1"]
    try:
        done = subprocess.run(
            command, cwd=ROOT, env=environment, timeout=LONGEST, text=True,
            stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
        )
    except subprocess.TimeoutExpired:
        return f"has not ended after {LONGEST} s"
    if done.returncode == 0 and " 1 passed" not in done.stdout:
        return f"is no test of this binary\n{done.stdout}"
    return "" if done.returncode == 0 else done.stdout


def kept():
    lines = CASES.read_text().splitlines() if CASES.exists() else []
    return [line.split() for line in lines if line.strip() and not line.startswith("#")]


def again(executables):
    """Runs the kept cases and returns the number of failures."""
    failed = 0
    for seed, binary, name in kept():
        output = run(executables[binary], name, seed)
        if output:
            failed += 1
            print(f"a kept case fails: seed {seed}, {binary} {name}\n{output}", flush=True)
    print(f"{len(kept())} kept cases, {failed} of them fail", flush=True)
    return failed


def smallest(output):
    """The smallest case that proptest has found, else what the test said when it failed."""
    case = re.search(r"^Test failed: (.*?)^\s*successes: ", output, re.S | re.M)
    said = re.search(r"panicked at [^\n]*\n(.*?)^(?:note: |failures:|$)", output, re.S | re.M)
    return (case or said)[1].strip() if case or said else output


def explore(executables):
    """Tries fresh seeds until the time is over. Ends the script where no test ran."""
    tests = []
    for binary, folder in FOLDERS.items():
        names = listed(executables[binary])
        for module, function in random_tests(folder):
            tests += [(binary, name) for name in names if re.fullmatch(rf"{module}(::)?(\w+::)*{function}", name)]
    tests = sorted(set(tests))
    print(f"{len(tests)} random tests for {SECONDS:.0f} s, EXPLORE_SEED={SEED}", flush=True)
    source, lock, end = random.Random(SEED), threading.Lock(), time.monotonic() + SECONDS
    waiting, runs, found = [], [0], []

    def worker():
        while time.monotonic() < end:
            with lock:
                if not waiting:
                    waiting.extend(source.sample(tests, len(tests)))
                (binary, name), seed = waiting.pop(), source.randrange(1 << 32)
            output = run(executables[binary], name, seed)
            with lock:
                runs[0] += 1
                if output:
                    FOUND.mkdir(parents=True, exist_ok=True)
                    found.append(FOUND / f"{seed}-{binary}-{name.replace('::', '.')}")
                    found[-1].write_text(output)
                    print(f"FOUND seed={seed} test={binary}::{name}\n{smallest(output)}", flush=True)

    with concurrent.futures.ThreadPoolExecutor() as pool:
        count = os.cpu_count() or 1
        for one in [pool.submit(worker) for _ in range(count)]:
            one.result()
    print(f"{runs[0]} runs, {len(found)} failures" + (f", whose outputs are in {FOUND}" if found else ""))
    if not runs[0]:
        sys.exit("no random test ran")


if __name__ == "__main__":
    built = binaries()
    n_failed = again(built)
    explore(built)
    sys.exit(1 if n_failed else 0)
