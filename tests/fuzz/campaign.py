"""Command line of all fuzzers: runs many seeds in parallel, each with a time limit, up to a number or a total time."""

from __future__ import annotations

import argparse
import multiprocessing
import os
import signal
import time
from collections import Counter
from collections.abc import Callable
from types import FrameType

TOO_LONG = 120
"""Processor seconds after which a seed counts as hanging; the largest of these models takes a few."""

_ASLEEP = 30 * TOO_LONG
"""Seconds after which a seed counts as hanging although it used little processor time, on a busy machine."""

_TOLD = 60
"""Seconds between two reports of progress."""

_MOST_FAILURES = 30
"""Number of failures after which no new seed starts: more would have a common reason."""

Draw = Callable[[int], tuple[Counter[str], list[str]]]
"""Function that runs a seed and returns outcomes and faults."""


class Hang(BaseException):
    """A seed took too long."""


def _late(number: int, frame: FrameType | None) -> None:
    raise Hang(f"longer than {TOO_LONG} s of the processor" if number == signal.SIGPROF else f"longer than {_ASLEEP} s")


def _work(draw: Draw, seeds: multiprocessing.SimpleQueue, found: multiprocessing.SimpleQueue) -> None:
    for ends in (signal.SIGPROF, signal.SIGALRM):
        signal.signal(ends, _late)
    while (seed := seeds.get()) is not None:
        found.put((seed, None, 0.0, []))
        begun = time.perf_counter()
        signal.setitimer(signal.ITIMER_PROF, TOO_LONG)
        signal.alarm(_ASLEEP)
        try:
            outcomes, wrong = draw(seed)
        except BaseException as error:  # A fuzzer looks for every exception that ends a run.
            outcomes, wrong = Counter({"fault": 1}), [f"{type(error).__name__}: {error}"]
        signal.setitimer(signal.ITIMER_PROF, 0)
        signal.alarm(0)
        found.put((seed, outcomes, time.perf_counter() - begun, wrong))


def run(draw: Draw, first: int, count: int, processes: int, seconds: float) -> int:
    """Run ``count`` seeds, or as many as start within ``seconds``; print failures at once; return their number."""
    seeds, found = multiprocessing.SimpleQueue(), multiprocessing.SimpleQueue()
    workers = [multiprocessing.Process(target=_work, args=(draw, seeds, found), daemon=True) for _ in range(processes)]
    for worker in workers:
        worker.start()
    begun = told = time.monotonic()
    given = done = failures = 0
    open_, outcomes, slowest = set(), Counter(), (0.0, first)
    while True:
        while (
            given < count
            and given - done < processes
            and time.monotonic() - begun < seconds
            and failures < _MOST_FAILURES
        ):
            seeds.put(first + given)
            given += 1
        if done == given:
            break
        while found.empty():
            time.sleep(0.002)
            if not all(worker.is_alive() for worker in workers):
                for seed in sorted(open_):
                    print(f"seed {seed}: this or another one that was open ended its process", flush=True)
                return failures + 1
        seed, outcome, spent, wrong = found.get()
        if outcome is None:
            open_.add(seed)
            continue
        open_.discard(seed)
        done += 1
        outcomes += outcome
        slowest = max(slowest, (spent, seed))
        if wrong:
            failures += 1
            print(f"seed {seed}: {'; '.join(wrong)}", flush=True)
        if time.monotonic() - told > _TOLD:
            told = time.monotonic()
            print(f"{done} seeds: {dict(sorted(outcomes.items()))}, {failures} failures", flush=True)
    for _ in workers:
        seeds.put(None)
    print(f"{done} seeds from {first}: {dict(sorted(outcomes.items()))}, {failures} failures")
    print(f"{time.monotonic() - begun:.0f} s; slowest: seed {slowest[1]}, {slowest[0]:.1f} s")
    return failures


def main(says: str | None, draw: Draw, show: Callable[[int], None], count: int = 100_000, check: int = 100) -> int:
    """Show one seed, or run many, as the command line requests; return 1 if any fails."""
    parser = argparse.ArgumentParser(description=says, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=count)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--seconds", type=float, default=float("inf"), help="begin no seed after that")
    parser.add_argument("--processes", type=int, default=os.cpu_count())
    parser.add_argument("--show", type=int)
    parser.add_argument("--check", action="store_true")
    given = parser.parse_args()
    if given.show is not None:
        show(given.show)
        print(*draw(given.show), sep="\n")
        return 0
    return min(run(draw, given.first, check if given.check else given.count, given.processes, given.seconds), 1)
