# SPDX-License-Identifier: BSD-3-Clause
"""How long each source, reader, filter and writer takes in ParaView, the first time, with its inputs made.

    . build/release/lacuna-env.sh
    python3 Testing/Benchmarks/every.py [--benchmark_filter=Mirror]

What is measured, and how large it is, is of memory.py (the smaller of its sizes). Each is measured in a process of its own,
so that nothing is known of an earlier run.
"""
import memory
from harness.rows import Program
from harness.sizes import SIZES


def prepare(name):
    def measured():
        taken, made, peak, clock, processor = memory.apart(name, memory.CASES[name], SIZES[name][0])
        return {"real_time": clock, "cpu_time": processor, "input": taken / 1e6, "output": made / 1e6, "peak": peak / 1e6}
    return lambda: measured


program = Program(__doc__)
for case in memory.CASES:
    program.add(case, prepare(case))

if __name__ == "__main__":
    program.main()
