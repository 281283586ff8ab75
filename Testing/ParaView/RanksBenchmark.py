# SPDX-License-Identifier: BSD-3-Clause
"""Testing/Benchmarks/ranks.py measures every filter by real ranks and by parts, and says of what it refuses why."""
import json
import os
import re
import subprocess

import lacuna_test

lacuna_test.program("mpirun")
file = lacuna_test.output("RanksBenchmark.json")
script = os.path.join(lacuna_test.ROOT, "Testing", "Benchmarks", "ranks.py")
done = subprocess.run([lacuna_test.program("python3"), script, "--quick", "--benchmark_out", file], env=lacuna_test.mpi_environment(), check=False,
                      timeout=900, text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
print(done.stdout)
assert done.returncode == 0, done.returncode
with open(file, encoding="utf-8") as opened:
    rows = {row["name"]: row["cpu_time"] for row in json.load(opened)["benchmarks"]}
cases = {name.split("/")[0] for name in rows}
assert cases == {"occluded-angle", "swept-volume", "iso-ray-caster", "speckle", "rbf-interpolator"}, cases
refused = {(case, int(ranks), kind) for case, ranks, kind, why in re.findall(r"^(\S+), (\d+) ranks, (\w+): (.+bytes.+)$", done.stdout, re.MULTILINE)}
for case in cases:
    for kind in "strong", "weak":
        for way, numbers in ("ranks", (1, 2)), ("parts", (1, 2, 10, 100, 1000)):
            for ranks in numbers:
                name = f"{case}/{kind}/{way}:{ranks}"
                # all that is refused takes more memory than there may be, with a thousand times the work
                assert rows.get(name, 0) > 0 or (case, ranks, kind) in refused and (kind, way, ranks) == ("weak", "parts", 1000), name
