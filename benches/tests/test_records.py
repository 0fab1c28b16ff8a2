"""Records and tables, and the scripts that measure peers, with programs that only pretend to measure."""

import ast
import json
import re
import subprocess
import sys
from pathlib import Path

import pytest

BENCHES = Path(__file__).resolve().parent.parent
sys.path[:0] = [str(BENCHES), str(BENCHES / "peers")]

import measure  # noqa: E402
import record  # noqa: E402

ROWS = 'import json; print(json.dumps({"rows": [{"envs": 1024, "speed": 7583000.0}, {"envs": 64, "speed": 0.000123}]}))'


@pytest.fixture
def records(tmp_path, monkeypatch):
    """An empty folder of records."""
    monkeypatch.setattr(record, "RECORDS", tmp_path)
    return tmp_path


def call(monkeypatch, *arguments: str) -> None:
    """As from the command line."""
    monkeypatch.setattr(sys, "argv", ["record.py", *arguments])
    record.main()


def test_a_record_says_what_was_measured_where_and_by_what(records, monkeypatch):
    call(monkeypatch, "run", "speed", "--seed", "1", "--", sys.executable, "-c", ROWS)
    kept = json.loads((records / "speed.json").read_text())
    assert kept["rows"] == [{"envs": 1024, "speed": 7583000.0}, {"envs": 64, "speed": 0.000123}]
    assert kept["seed"] == 1 and kept["command"].startswith(sys.executable)
    assert kept["machine"]["processor"] and kept["machine"]["threads"] >= 1
    assert re.match(r"\d{4}-\d\d-\d\dT", kept["date"]) and {"commit", "changed", "compiler"} <= set(kept)


@pytest.mark.parametrize("code", ["raise SystemExit(3)", "print('no rows')"])
def test_nothing_is_kept_of_a_command_that_fails_or_prints_no_rows(records, monkeypatch, code):
    with pytest.raises(SystemExit, match=r"exit status 3|no rows"):
        call(monkeypatch, "run", "speed", "--", sys.executable, "-c", code)
    assert list(records.iterdir()) == []


def test_a_table_is_that_of_its_record(records, monkeypatch):
    call(monkeypatch, "run", "speed", "--", sys.executable, "-c", ROWS)
    page = records / "page.md"
    page.write_text("before\n<!-- record speed: envs, speed=steps/s -->\n<!-- end of record -->\nafter\n")
    with pytest.raises(SystemExit, match="differs from its record"):
        call(monkeypatch, "tables", "--check", str(page))
    call(monkeypatch, "tables", str(page))
    text = page.read_text()
    assert "| envs | steps/s |\n| --- | --- |\n| 1,024 | 7.58 M |\n| 64 | 0.000123 |\n<!-- end" in text
    assert text.startswith("before\n") and text.endswith("after\n")
    call(monkeypatch, "tables", "--check", str(page))
    page.write_text(text.replace("7.58 M", "7.59 M"))
    with pytest.raises(SystemExit, match="differs from its record"):
        call(monkeypatch, "tables", "--check", str(page))


def test_a_column_that_no_row_has_is_refused():
    with pytest.raises(SystemExit, match="no row has `sped`; there are envs, speed"):
        record.table([{"envs": 1, "speed": 2.0}], "envs, sped")


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (None, "-"),
        (1024, "1,024"),
        (True, "True"),
        (0.0, "0.0"),
        (54_200.0, "54.2 k"),
        (5.4e9, "5.40 G"),
        (999.4, "999"),
        (19.44, "19.4"),
        (1.0, "1.00"),
        (0.00142, "0.00142"),
        (float("nan"), "nan"),
    ],
)
def test_cells(value, text):
    assert record.shown(value) == text


def test_results_of_criterion_are_found(tmp_path, monkeypatch):
    folder = tmp_path / "criterion" / "physics" / "arm" / "f64" / "new"
    folder.mkdir(parents=True)
    interval = {"lower_bound": 1.5e6, "upper_bound": 2.5e6}
    estimates = {"median": {"point_estimate": 2e6, "confidence_interval": interval}}
    (folder / "estimates.json").write_text(json.dumps(estimates))
    (folder / "benchmark.json").write_text(json.dumps({"full_id": "physics/arm/f64", "throughput": {"Elements": 100}}))
    monkeypatch.setenv("CARGO_TARGET_DIR", str(tmp_path))
    (row,) = record.criterion_rows(0)
    expected = {"seconds": 0.002, "seconds_low": 0.0015, "seconds_high": 0.0025, "elements_per_s": 50_000}
    assert row.pop("bench") == "physics/arm/f64" and row == pytest.approx(expected)
    with pytest.raises(SystemExit, match="no new results"):
        record.criterion_rows(2**40)


def test_tables_of_the_documents_are_those_of_their_records():
    for page in sorted((BENCHES.parent / "docs").glob("*.md")):
        text = page.read_text()
        assert record.filled(text) == text, page


def test_every_peer_is_pinned_and_can_be_read():
    for name, script in measure.PEERS.items():
        lines = (measure.HERE / "requirements" / f"{name}.txt").read_text().splitlines()
        packages = [line for line in lines if line and not line.startswith("#")]
        assert packages and all("==" in line for line in packages), name
        ast.parse((measure.HERE / script).read_text())
    sizes = json.loads((measure.HERE / "peers.json").read_text())
    assert all(set(sizes[kind]) <= set(measure.NAMES) for kind in ("card", "processor", "small"))


MYO = """#!{python}
import json, sys
if sys.argv[1:3] == ["model", "export"]:
    print("<mujoco/>")
else:
    row = {{"backend": "cpu", "version": "0", "threads": 1, "level": "avx2", "envs": 64, "control_steps_per_s": 2e5,
           "control_steps_per_s_median": 1e5, "physics_steps_per_s": 5e6}}
    print(json.dumps({{"rows": [row]}}))
"""
STEP = """#!{python}
print('{{"what": "gradient step", "system": "Myo", "samples": 1280, "gradient_step_s": 0.00011}}')
"""


def test_peers_that_cannot_run_are_left_out_with_the_reason(tmp_path):
    for name, text in {"myo": MYO, "gradient_step": STEP}.items():
        (tmp_path / name).write_text(text.format(python=sys.executable))
        (tmp_path / name).chmod(0o755)
    command = [sys.executable, measure.HERE / "measure.py", "--small", "--processor", "--only", "myo", "torch"]
    more = ["--programs", tmp_path, "--python", "/no/python", "--out", tmp_path]
    environment = {"CARGO_TARGET_DIR": str(tmp_path), "PATH": "/usr/bin:/bin"}
    done = subprocess.run([*command, *more], text=True, capture_output=True, env=environment)
    assert done.returncode == 0, done.stderr
    kept = json.loads((tmp_path / "peers.json").read_text())
    assert [row["what"] for row in kept["rows"]] == ["environment, pointing-single", "gradient step"]
    assert "torch is left out" in kept["note"] and "/no/python" in kept["note"]
    page = (tmp_path / "peers.md").read_text()
    assert "| Myo | 0 | 1 threads, avx2 | 64 | 200 k | 100 k | 5.00 M |" in page and "torch is left out" in page
