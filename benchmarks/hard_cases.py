"""Count right-hand-side evaluations of the hard cases, for closing and with error estimates.

Run: python benchmarks/hard_cases.py [SHOWN] (default: 12). Jacobians count as in a result (`numerics.rhs_evaluations`),
so that the counts do not depend on the computer. Prints the most expensive cases and the sums.
"""

from __future__ import annotations

import sys
from collections import Counter
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
sys.path[:0] = [str(ROOT / "tests" / name) for name in ("hard", "laws")]
from hard_cases import CASES  # noqa: E402
from scenes import make  # noqa: E402

from screwsim.cycle.guess import lease_for  # noqa: E402
from screwsim.cycle.problem import problem_of  # noqa: E402
from screwsim.model import leases  # noqa: E402
from screwsim.solve.accurately import solve  # noqa: E402


def main() -> None:
    """Print the table."""
    found: list[tuple[int, int, str, str]] = []
    for case in CASES:
        if case.status == "refused":
            continue
        problem = problem_of(make(case.changes))
        machinery = lease_for(problem)
        before = machinery.counts.copy()
        solved = solve(problem, machinery)
        counts = machinery.evaluations_of(machinery.counts - before), machinery.evaluations_of(solved.cost.counts)
        found.append((*counts, solved.cycle.status, case.name))
        leases.give_back(machinery)
    found.sort(reverse=True)
    print(f"{'with estimate':>13} {'closing':>12}  status      case")
    for total, closing, status, name in found[: int(sys.argv[1]) if len(sys.argv) > 1 else 12]:
        print(f"{total:13,} {closing:12,}  {status:10}  {name}")
    sums = (sum(row[k] for row in found) for k in (0, 1))
    print("{:13,} {:12,}  {} cases: {}".format(*sums, len(found), dict(Counter(row[2] for row in found))))


if __name__ == "__main__":
    main()
