"""Comparison of Papilio with other programs: the same work, timed alternately, as a table in docs/peers.md.

    cargo xtask peers

makes an environment with the packages listed there, builds Papilio's program (validation/examples/peers) and runs
this file with the path of that program.

For each task, Papilio and the peer run alternately, ROUNDS times, with one thread each. The table has the median of the CPU
seconds, the ratio, and the difference of the results. Run nothing else at the same time.
"""

import importlib.metadata
import json
import os
import pathlib
import platform
import statistics
import subprocess
import sys
import time
from functools import partial

# These must be set before the import of any package that counts the cores.
os.environ |= {name: "1" for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")}

import numpy as np

import colours
import designs
import films
import matrices
import scenes

ROUNDS = 5
PAGE = pathlib.Path(__file__).parents[2] / "docs" / "peers.md"
MARKS = ("<!-- measured -->\n", "<!-- end -->\n")


class Papilio:
    """A task of Papilio's program, to be timed."""

    def __init__(self, program, *words, seconds=2.0):
        self.command = [program, *words, str(seconds)]

    def __call__(self):
        """Returns the CPU seconds of one repetition, and the result."""
        told = subprocess.run(self.command, check=True, capture_output=True, text=True)
        seconds, numbers = told.stdout.splitlines()
        return float(seconds), np.array(numbers.split(), dtype=float)


def timed(work, problem):
    """Returns a function that times a peer, over at least the time that its clock resolves."""

    def once():
        start, count = time.process_time(), 0
        while True:
            result = work(problem)
            count += 1
            seconds = time.process_time() - start
            if seconds > 0.5:
                return seconds / count, np.asarray(result).ravel()

    return once


def in_turn(*sides, rounds=ROUNDS):
    """Runs all sides alternately, and returns the median of the seconds and the result of each."""
    for side in sides[1:]:
        # The first run includes imports and other initialisation.
        side()
    runs = [[side() for side in sides] for _ in range(rounds)]

    def median(number):
        return statistics.median(run[number][0] for run in runs)

    return [(median(number), runs[0][number][1]) for number in range(len(sides))]


def shown(seconds):
    scale, unit = next((s, u) for s, u in ((1, "s"), (1e3, "ms"), (1e6, "us")) if seconds * s >= 1 or u == "us")
    value = seconds * scale
    return f"{value:.0f} {unit}" if value >= 100 else f"{value:.3g} {unit}"


def speed_up(ours, theirs):
    ratio = theirs / ours
    return f"{ratio:,.0f}" if ratio >= 10 else f"{ratio:.2g}"


def row(task, peer, ours, theirs, difference):
    return f"| {task} | {peer} | {shown(theirs)} | {shown(ours)} | {speed_up(ours, theirs)} | {difference} |"


def largest_difference(a, b):
    return f"{np.max(np.abs(a - b)):.1e}"


def rows(program, given):
    """Yields the rows of the table, which take minutes."""
    problem = films.problem(given)
    for peer, work in films.PEERS.items():
        (ours, a), (theirs, b) = in_turn(Papilio(program, "films"), timed(work, problem))
        yield row("films", peer, ours, theirs, largest_difference(a, b))

    own = timed(films.from_python, problem)
    for peer in ("tmm", "tmm_fast"):
        (ours, a), (theirs, b) = in_turn(own, timed(films.PEERS[peer], problem))
        yield row("films from Python", peer, ours, theirs, largest_difference(a, b))

    work = colours.PEERS["colour-science"]
    (ours, a), (theirs, b) = in_turn(Papilio(program, "colours"), timed(work, colours.problem(given)))
    yield row("colours", "colour-science", ours, theirs, largest_difference(a, b))

    work = designs.PEERS["tmm_fast + colour-science"]
    theirs = timed(work, designs.problem(given))
    (ours, a), (whole, _), (theirs, b) = in_turn(Papilio(program, "designs"), Papilio(program, "displays"), theirs)
    yield row("designs, bare film", "tmm_fast + colour-science", ours, theirs, largest_difference(a, b))
    yield row("designs, whole displays vs. bare films", "tmm_fast + colour-science", whole, theirs, "-")

    # Each task takes half a minute.
    work = matrices.PEERS["pywincalc"]
    (ours, a), (theirs, b) = in_turn(Papilio(program, "matrices"), timed(work, given), rounds=3)
    yield row("matrices", "pywincalc", ours, theirs, largest_difference(a[-1], b))

    for luminous, kind, task in ((True, "luminous", "scene, Y"), (False, "bands", "scene, every band")):
        for light, label in (("sky", "sky"), ("lamp", "disc")):
            yield from scene_rows(program, given, (luminous, kind, light), f"{task}, {label}")


def scene_rows(program, given, case, task):
    luminous, kind, light = case
    solvers, variants = ("adding", "monte-carlo"), ("scalar_spectral", "llvm_ad_spectral")
    ours = [Papilio(program, "scenes", kind, light, solver) for solver in solvers]
    theirs = [partial(scenes.measured, variant, given, luminous, light) for variant in variants]
    measured = in_turn(*ours, *theirs, rounds=3)
    for variant, (peer, b) in zip(variants, measured[len(solvers) :]):
        both = measured[: len(solvers)]
        means = [np.mean(a[-1] if luminous else a[:-1]) for _, a in both]
        far = " / ".join(f"{100 * (np.mean(b) / mean - 1):+.1f}" for mean in means)
        seconds = " / ".join(shown(papilio) for papilio, _ in both)
        ratios = " / ".join(speed_up(papilio, peer) for papilio, _ in both)
        yield f"| {task} | Mitsuba 3 {variant} | {shown(peer)} | {seconds} | {ratios} | {far} % |"


def versions():
    names = ["tmm", "tmm_fast", "PyMoosh", "pyElli", "colour-science", "pywincalc", "mitsuba", "numpy"]
    told = ", ".join(f"{name} {importlib.metadata.version(name)}" for name in names)
    return f"{told}; Python {platform.python_version()}"


def processor():
    lines = pathlib.Path("/proc/cpuinfo")
    names = [l for l in lines.read_text().splitlines() if l.startswith("model name")] if lines.exists() else []
    return names[0].split(":")[1].strip() if names else platform.processor()


def main():
    program = sys.argv[1]
    given = json.loads(subprocess.run([program, "inputs"], check=True, capture_output=True, text=True).stdout)
    head = "| task | peer | peer, CPU | Papilio, CPU | speed-up | results differ by |"
    lines = [head, "|---|---|---|---|---|---|"]
    for line in rows(program, given):
        print(line, flush=True)
        lines.append(line)
    before, rest = PAGE.read_text().split(MARKS[0])
    after = rest.split(MARKS[1])[1]
    made = "\n".join([*lines, "", f"{processor()}, one core; {versions()}.", ""])
    PAGE.write_text(before + MARKS[0] + "\n" + made + "\n" + MARKS[1] + after)


if __name__ == "__main__":
    main()
