#!/usr/bin/env python3
"""Keeps what a bench measured, with machine, versions, date and command, and makes tables of it.

    python3 benches/record.py run NAME [--seed N] [--note TEXT] -- COMMAND ...
    python3 benches/record.py criterion NAME [--seed N] [--note TEXT] -- COMMAND ...
    python3 benches/record.py tables [--check] FILE.md ...

`run` runs a command that prints JSON (`myo bench ... --json`, or one object per line) and writes
`benches/records/NAME.json`. `criterion` does the same for `cargo bench -p myo-benches`, whose results it finds in
Criterion's own files. `tables` fills in every block of a document that names a record and its columns, `column` or
`column=heading`:

    <!-- record NAME: envs, control_steps_per_s=control steps/s -->
    <!-- end of record -->

With `--check` it changes nothing and fails if a table is not what its record says. Python's own library is enough.
"""

import argparse
import datetime
import json
import math
import os
import platform
import re
import shlex
import subprocess
import sys
import time
from pathlib import Path

REPOSITORY = Path(__file__).resolve().parent.parent
RECORDS = REPOSITORY / "benches" / "records"
BLOCK = re.compile(r"(<!-- record (?P<name>[\w-]+): (?P<columns>.*?) -->\n).*?(<!-- end of record -->)", re.S)


def said(*command: str) -> str | None:
    """What a program prints, if it is there and succeeds."""
    try:
        done = subprocess.run(command, capture_output=True, text=True, cwd=REPOSITORY, timeout=60, check=True)
    except (OSError, subprocess.SubprocessError):
        return None
    return done.stdout.strip() or None


def first_line_with(path: str, key: str) -> str | None:
    """The value of the first line of a file that begins with a key."""
    try:
        lines = Path(path).read_text().splitlines()
    except OSError:
        return None
    return next((line.split(":", 1)[1].strip() for line in lines if line.startswith(key)), None)


def machine() -> dict:
    """Where this runs."""
    cards = said("nvidia-smi", "--query-gpu=name,driver_version", "--format=csv,noheader")
    return {
        "processor": first_line_with("/proc/cpuinfo", "model name") or platform.processor() or platform.machine(),
        "threads": len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count(),
        "memory": first_line_with("/proc/meminfo", "MemTotal"),
        "cards": cards.splitlines() if cards else [],
        "system": platform.platform(),
    }


def versions() -> dict:
    """What runs here: the commit, whether something was changed since, and the compiler."""
    changed = said("git", "status", "--porcelain", "--untracked-files=no")
    return {
        # A copy without its history is told what it is.
        "commit": os.environ.get("MYO_COMMIT") or said("git", "describe", "--always", "--tags", "--abbrev=12"),
        "changed": changed is not None,
        "compiler": said("rustc", "--version"),
        "python": platform.python_version(),
    }


def write(path: Path, text: str) -> None:
    """All of a file or nothing of it."""
    path.parent.mkdir(parents=True, exist_ok=True)
    part = path.with_name(path.name + ".part")
    part.write_text(text)
    part.replace(path)


def rows_of(text: str) -> list[dict]:
    """Rows that a command printed: an object with `rows`, one object, or an object per line."""
    try:
        whole = json.loads(text)
    except json.JSONDecodeError:
        whole = [json.loads(line) for line in text.splitlines() if line.startswith("{")]
    if isinstance(whole, dict):
        whole = whole.get("rows", [whole])
    if not whole:
        raise SystemExit("the command printed no rows; does it lack `--json`?")
    return whole


def criterion_rows(since: float) -> list[dict]:
    """Results of Criterion that are newer than a time: seconds per iteration and elements per second."""
    target = Path(os.environ.get("CARGO_TARGET_DIR", REPOSITORY / "target"))
    rows = []
    for path in sorted((target / "criterion").glob("**/new/estimates.json")):
        if path.stat().st_mtime < since:
            continue
        estimates = json.loads(path.read_text())
        bench = json.loads((path.parent / "benchmark.json").read_text())
        median = estimates["median"]
        seconds = median["point_estimate"] * 1e-9
        bounds = median["confidence_interval"]
        row = {"bench": bench["full_id"], "seconds": seconds}
        row["seconds_low"], row["seconds_high"] = (bounds[f"{end}_bound"] * 1e-9 for end in ("lower", "upper"))
        throughput = bench.get("throughput") or {}
        if "Elements" in throughput:
            row["elements_per_s"] = throughput["Elements"] / seconds
        rows.append(row)
    if not rows:
        raise SystemExit(f"no new results are in {target / 'criterion'}; was it `cargo bench`, without `--test`?")
    return rows


def record(args: argparse.Namespace) -> None:
    """Runs a command and keeps what it measured."""
    if not re.fullmatch(r"[\w-]+", args.name):
        raise SystemExit(f"`{args.name}` is no name of a record; take letters, digits, `-` and `_`")
    started, start = datetime.datetime.now(datetime.UTC), time.time()
    by_criterion = args.action == "criterion"
    done = subprocess.run(args.command, stdout=None if by_criterion else subprocess.PIPE, text=True)
    if done.returncode != 0:
        command = shlex.join(args.command)
        raise SystemExit(f"`{command}` failed with exit status {done.returncode}; no record was written")
    rows = criterion_rows(start) if by_criterion else rows_of(done.stdout)
    path = RECORDS / f"{args.name}.json"
    command, seconds = shlex.join(args.command), time.time() - start
    write(path, dump(rows, command=command, started=started, seconds=seconds, seed=args.seed, note=args.note))
    print(f"{path}: {len(rows)} rows", file=sys.stderr)


def dump(rows: list[dict], *, started: datetime.datetime, seconds: float, **more) -> str:
    """A record as JSON, a row per line: what was measured, when, for how long, and where."""
    when = {"date": started.isoformat(timespec="seconds"), "seconds": round(seconds, 1)}
    head = {**more, **when, "machine": machine(), **versions()}
    text = json.dumps(head, indent=1).removesuffix("\n}")
    return text + ',\n "rows": [\n  ' + ",\n  ".join(json.dumps(row) for row in rows) + "\n ]\n}\n"


def shown(value: object) -> str:
    """A cell: three digits of a number, large ones in k, M, G, small ones in scientific notation; words as they are."""
    if value is None:
        return "-"
    if isinstance(value, bool) or not isinstance(value, int | float):
        return str(value)
    if isinstance(value, int) and abs(value) < 1_000_000:
        return f"{value:,}"
    if not math.isfinite(value) or value == 0:
        return str(value)
    for unit, size in (("G", 1e9), ("M", 1e6), ("k", 1e3), ("", 1.0)):
        if abs(value) >= size:
            digits = max(0, 2 - math.floor(math.log10(abs(value) / size)))
            return f"{value / size:.{digits}f}" + (f" {unit}" if unit else "")
    return f"{value:.3g}"


def table(rows: list[dict], columns: str) -> str:
    """Rows as a table of markdown."""
    pairs = [tuple(part.strip() for part in column.partition("=")[::2]) for column in columns.split(",")]
    missing = [key for key, _ in pairs if not any(key in row for row in rows)]
    if missing:
        raise SystemExit(f"no row has `{missing[0]}`; there are {', '.join(sorted(set().union(*rows)))}")
    lines = [[heading or key for key, heading in pairs], ["---"] * len(pairs)]
    lines += [[shown(row.get(key)) for key, _ in pairs] for row in rows]
    return "".join("| " + " | ".join(line) + " |\n" for line in lines)


def caption(kept: dict) -> str:
    """Command, machine, version and date of a record, in a line."""
    place, changed = kept["machine"], " with changes" if kept["changed"] else ""
    commit = kept["commit"] and f"commit {kept['commit']}{changed}"
    parts = [place["processor"], f"{place['threads']} hardware threads", *place["cards"], kept["compiler"], commit]
    where = ", ".join(part for part in [*parts, kept["date"][:10]] if part)
    note = f" {kept['note']}." if kept["note"] else ""
    return f"`{kept['command']}`: {where}.{note}\n\n"


def filled(text: str) -> str:
    """A document with the tables of its records."""

    def fill(block: re.Match) -> str:
        path = RECORDS / f"{block['name']}.json"
        if not path.exists():
            raise SystemExit(f"there is no record {path}")
        kept = json.loads(path.read_text())
        return block[1] + caption(kept) + table(kept["rows"], block["columns"]) + block[4]

    return BLOCK.sub(fill, text)


def tables(args: argparse.Namespace) -> None:
    """Fills in the tables of documents, or checks them."""
    for path in args.files:
        text = path.read_text()
        new = filled(text)
        if new != text and args.check:
            raise SystemExit(f"{path}: a table differs from its record; run `python3 benches/record.py tables {path}`")
        if new != text:
            write(path, new)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    actions = parser.add_subparsers(dest="action", required=True)
    for action in ("run", "criterion"):
        one = actions.add_parser(action)
        one.add_argument("name")
        one.add_argument("--seed", type=int)
        one.add_argument("--note")
        one.add_argument("command", nargs="+")
        one.set_defaults(do=record)
    one = actions.add_parser("tables")
    one.add_argument("--check", action="store_true")
    one.add_argument("files", type=Path, nargs="+")
    one.set_defaults(do=tables)
    args = parser.parse_args()
    args.do(args)


if __name__ == "__main__":
    main()
