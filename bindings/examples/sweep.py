"""Where may a button be? 24 places times 3 seeds on a Ray cluster of two workers: `python sweep.py --folder layouts`.

Stopped and started again, it goes on. Needs `pip install myoenv[sweep]`.
"""

import argparse
import statistics

import ray
from ray.cluster_utils import Cluster

from myoenv.sweep import button_grid, sweep

parser = argparse.ArgumentParser(description=__doc__)
parser.add_argument("--folder", default="sweep")
parser.add_argument("--columns", type=int, default=6)
parser.add_argument("--rows", type=int, default=4)
parser.add_argument("--seeds", type=int, default=3)
parser.add_argument("--steps", type=int, default=4_000_000, help="control steps of a trial at most")
args = parser.parse_args()

# Two workers on this machine. On a cluster that runs: `sweep(..., address="auto")`, and none of this.
cluster = Cluster(initialize_head=True, head_node_args={"num_cpus": 1, "include_dashboard": False})
cluster.add_node(num_cpus=1)
ray.init(address=cluster.address, log_to_driver=False)

rows = sweep(
    button_grid(columns=args.columns, rows=args.rows),
    seeds=range(1, args.seeds + 1),
    folder=args.folder,
    steps=args.steps,
    progress=lambda row: print(row["layout"], row["seed"], row["error"] or f"success {row['success']:.1%}", flush=True),
)
ray.shutdown()
cluster.shutdown()

done = [row for row in rows if not row["error"]]
print("layout  success  seconds to press")
for layout in dict.fromkeys(row["layout"] for row in done):
    of_layout = [row for row in done if row["layout"] == layout]
    times = [row["target_1_time_s"] for row in of_layout if row["target_1_time_s"] is not None]
    press = f"{statistics.mean(times):.2f}" if times else "never"
    print(f"{layout:6}  {statistics.mean(row['success'] for row in of_layout):7.1%}  {press}")
if done:
    rate = sum(row["env_steps"] for row in done) / sum(row["wall_s"] for row in done)
    print(f"{rate:,.0f} steps/s on each worker, learning included")
