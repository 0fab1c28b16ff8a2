#!/usr/bin/env python3
"""Measures other people's programs beside Myo, and writes one table: `peers.json` and `peers.md`.

    python3 benches/peers/measure.py                        # everything that this machine can run
    python3 benches/peers/measure.py --only myo torch       # some of it
    python3 benches/peers/measure.py --small                # seconds: does it work?
    python3 benches/peers/measure.py --python python3       # without installing anything: a machine without network

The same body (`myo model export mobl-arms`), the same 25 physics steps of 2 ms in a control step, the same kind of
random excitations, one program at a time. Sizes are in `peers.json`; they are those for a card if there is an NVIDIA
card. Every peer gets a virtual environment of its own under `target/peers`, with the versions in `requirements`, unless
`--python` names an interpreter that has what it needs. What cannot run is left out, and the table says why.
"""

import argparse
import datetime
import json
import os
import shutil
import subprocess
import sys
import time
from pathlib import Path

HERE = Path(__file__).resolve().parent
REPOSITORY = HERE.parent.parent
sys.path.insert(0, str(HERE.parent))

import record  # noqa: E402

TARGET = Path(os.environ.get("CARGO_TARGET_DIR", REPOSITORY / "target")).resolve()
# What measures each.
PEERS = {
    "mujoco": "../../myo/src/cli/bench/step_mujoco.py",
    "mjx": "mjx_steps.py",
    "warp": "mujoco_warp_steps.py",
    "torch": "torch_learner.py",
    "arms": "../../bindings/examples/compare.py",
}
NAMES = ["myo", *PEERS]
# What is added on a machine with an NVIDIA card.
FOR_CARDS = {"mjx": ["jax[cuda13]==0.10.2"]}
LONGEST_S = 900


class LeftOut(Exception):
    """Why a peer was not measured."""


def run(command: list, cwd: Path = REPOSITORY, **more) -> str:
    """What a command prints; its errors and messages go to the terminal and, cut short, into the reason."""
    print("+", *[str(part)[:120] for part in command], file=sys.stderr, flush=True)
    try:
        words = [str(part) for part in command]
        done = subprocess.run(words, text=True, capture_output=True, timeout=LONGEST_S, cwd=cwd, **more)
    except OSError as error:
        raise LeftOut(str(error)) from None
    except subprocess.TimeoutExpired:
        raise LeftOut(f"not done after {LONGEST_S} s") from None
    sys.stderr.write(done.stderr)
    if done.returncode != 0:
        said = [line for line in done.stderr.splitlines() if line.strip()]
        raise LeftOut(said[-1][:300] if said else f"exit status {done.returncode}")
    return done.stdout


class Bench:
    """Paths and choices of one call."""

    def __init__(self, args: argparse.Namespace) -> None:
        self.args = args
        self.card = not args.processor and shutil.which("nvidia-smi") is not None and bool(record.machine()["cards"])
        self.all = json.loads((HERE / "peers.json").read_text())
        self.sizes = self.all["small" if args.small else "card" if self.card else "processor"]
        self.folder = TARGET / "peers"
        self.model = self.folder / f"{self.all['model']}.xml"

    def program(self, *names: str) -> list:
        """How to start `myo`, or an example of the benches: built before, or by cargo."""
        folder = Path(self.args.programs) if self.args.programs else None
        if folder:
            return [folder / names[-1]]
        cargo = ["cargo", "run", "--release", "--quiet"]
        if names == ("myo",):
            return [*cargo, "-p", "myo-sim", "--"]
        return [*cargo, "-p", "myo-benches", "--example", names[-1], "--"]

    def python(self, peer: str) -> list:
        """The interpreter of a peer, with its packages."""
        if self.args.python:
            return [self.args.python]
        place = self.folder / peer
        python = place / "bin" / "python"
        if not python.exists():
            run([sys.executable, "-m", "venv", place])
        more = FOR_CARDS.get(peer, []) if self.card else []
        pip = [python, "-m", "pip", "install", "--quiet", "--disable-pip-version-check"]
        run([*pip, "-r", HERE / "requirements" / f"{peer}.txt", *more])
        return [python]

    def export(self) -> None:
        """Writes the model that all of them simulate."""
        self.folder.mkdir(parents=True, exist_ok=True)
        if not (self.args.programs and self.model.exists()):
            record.write(self.model, run([*self.program("myo"), "model", "export", self.all["model"]]))

    def environment(self) -> dict:
        """Of a peer's process."""
        quiet = {"XLA_PYTHON_CLIENT_PREALLOCATE": "false", "PYTHONDONTWRITEBYTECODE": "1"}
        hidden = {} if self.card else {"CUDA_VISIBLE_DEVICES": ""}
        return {**os.environ, **quiet, **hidden}

    def peer(self, name: str) -> list[dict]:
        """Rows of somebody else's program."""
        python = self.python(name)
        if name == "mujoco":
            return self.in_turns(python[0])
        script = HERE / PEERS[name]
        sizes = self.sizes.get(name, {})
        if name == "arms":
            options = [f"--{key}={value}" for key, value in sizes.items()]
            return self.rows([*python, script, "--json", *options], self.folder)
        settings = {
            **sizes,
            "file": str(self.model),
            "substeps": self.all["physics_steps_per_control_step"],
            "seed": self.all["seed"],
            "networks": self.all["networks"],
        }
        return self.rows([*python, script, json.dumps(settings)], self.folder)

    def rows(self, command: list, cwd: Path = REPOSITORY) -> list[dict]:
        """What a script printed, an object per line. Some leave files where they run."""
        return record.rows_of(run(command, cwd, env=self.environment()))

    def in_turns(self, python: object) -> list[dict]:
        """Physics on one core: Myo and MuJoCo's C library in turns."""
        arguments = ["bench", "physics", "--threads", "1", "--model", self.all["model"], "--against-mujoco", python]
        return self.measured(arguments, "physics, one core, in turns")

    def myo(self) -> list[dict]:
        """Rows of our own."""
        envs = ",".join(str(n) for n in self.sizes["myo"]["envs"])
        single = ["bench", "env", "--task", "pointing-single", "--envs", envs]
        rows = self.measured(single, "environment, pointing-single")
        gradient = ["card"] if self.card else ["processor"]
        if self.card:
            card = ["--backend", "gpu", "--envs", envs, "--part"]
            rows += self.measured(["bench", "env", "--task", "ar", *card, "physics"], "physics")
            rows += self.measured(["bench", "env", "--task", "ar", *card, "env"], "environment, ar")
        samples = [str(n) for n in self.sizes["torch"]["batches"]]
        return rows + self.rows([*self.program("examples", "gradient_step"), *gradient, *samples])

    def measured(self, arguments: list[str], what: str) -> list[dict]:
        """Rows of `myo bench`, in the words of the table."""

        def row(r: dict) -> dict:
            other = r["backend"] not in ("cpu", "gpu")
            level = f", {r['level']}" if r.get("level") else ""
            where = r.get("device") or f"{r['threads']} threads{level}"
            keep = [
                "envs",
                "control_steps_per_s",
                "control_steps_per_s_median",
                "physics_steps_per_s",
                "ready_s",
                "ratio",
            ]
            kept = {key: r[key] for key in keep if key in r}
            version = None if other else r["version"]
            return {
                "what": what,
                "system": r["backend"] if other else "Myo",
                "version": version,
                "device": where,
                **kept,
            }

        found = json.loads(run([*self.program("myo"), *arguments, "--json"]))["rows"]
        return [row(r) for r in found]


def written(rows: list[dict], left_out: dict[str, str]) -> str:
    """The rows as tables of markdown, one for each thing measured."""
    speed = "system, version, device, envs=environments, control_steps_per_s=control steps/s, "
    speed += "control_steps_per_s_median=median, physics_steps_per_s=physics steps/s, "
    speed += "simulated_s_per_s=simulated s per s, ready_s=ready after s, "
    speed += "difference_rad=rad from MuJoCo C, ratio"
    gradient = "system, version, device, samples, gradient_step_s=seconds, gradient_step_s_median=median"
    text = ""
    for what in dict.fromkeys(row["what"] for row in rows):
        some = [row for row in rows if row["what"] == what]
        wanted = gradient if "gradient_step_s" in some[0] else speed
        columns = [c for c in wanted.split(", ") if any(c.partition("=")[0] in row for row in some)]
        text += f"## {what[0].upper() + what[1:]}\n{record.table(some, ', '.join(columns))}\n"
    return text + "".join(f"{name} is left out: {reason}\n\n" for name, reason in left_out.items())


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--only", nargs="+", choices=NAMES, default=NAMES, metavar="NAME", help=", ".join(NAMES))
    parser.add_argument("--small", action="store_true", help="as little as possible, to see that it works")
    parser.add_argument("--processor", action="store_true", help="leave the card alone")
    parser.add_argument("--python", help="interpreter for all peers; nothing is installed")
    parser.add_argument("--programs", help="folder with the programs `myo` and `gradient_step`, built before")
    parser.add_argument("--out", type=Path, default=REPOSITORY / "benches" / "records", help="folder of the results")
    args = parser.parse_args()
    bench = Bench(args)
    started, start = datetime.datetime.now(datetime.UTC), time.time()
    rows, left_out, shown = [], {}, ""
    command = " ".join(["python3 benches/peers/measure.py", *sys.argv[1:]])
    bench.export()
    for name in args.only:
        try:
            rows += bench.myo() if name == "myo" else bench.peer(name)
        except LeftOut as reason:
            left_out[name] = str(reason)
            print(f"{name} is left out: {reason}", file=sys.stderr, flush=True)
        # After each of them, so that a run that is stopped leaves what it had.
        note = "; ".join(f"{name} is left out: {reason}" for name, reason in left_out.items()) or None
        seconds, seed = time.time() - start, bench.all["seed"]
        text = record.dump(rows, command=command, started=started, seconds=seconds, seed=seed, note=note)
        record.write(args.out / "peers.json", text)
        shown = written(rows, left_out)
        record.write(args.out / "peers.md", record.caption(json.loads(text)) + shown)
    print(shown)
    sys.exit(1 if set(left_out) == set(args.only) else 0)


if __name__ == "__main__":
    main()
