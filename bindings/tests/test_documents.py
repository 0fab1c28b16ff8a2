"""What the documents show of Python runs as printed."""

import re
import subprocess
import sys
from pathlib import Path

import myoenv

ROOT = Path(__file__).parents[2]


def test_the_code_of_the_documents_runs(tmp_path):
    # The run that the document trains in its first lines, shortly.
    myoenv.train("pointing-single", until=None, steps=8192, num_envs=512, backend="cpu", out=tmp_path / "runs/mine")
    documents = [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]
    blocks = {path.name: re.findall(r"^```python\n(.*?)^```", path.read_text(), re.M | re.S) for path in documents}
    assert len(blocks["README.md"]) >= 2
    for name, code in blocks.items():
        # A reader stays in one session from the first block to the last.
        command = [sys.executable, "-W", "error", "-c", "\n".join(code)]
        run = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, timeout=600, check=False)
        assert run.returncode == 0, f"{name}: {run.stderr[-4000:]}"
