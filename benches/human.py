#!/usr/bin/env python3
"""What the documents tell of users who are people, measured anew on a machine with graphics cards.

    python3 benches/human.py OUT [--cards 4] [--each 2] [--seconds 550] [--only NAMES] [--myo target/release/myo]

Times are measured first, each on a card that does nothing else; then users learn presets, findings and protocols, on
every card some at once. What is not done after so many seconds is interrupted with its checkpoints, and the same
command goes on with it. `OUT/answers` has what was printed, a file for each job; `OUT/log` what was said meanwhile.
"""

import argparse
import json
import signal
import subprocess
import sys
import threading
import time
from dataclasses import dataclass, field
from pathlib import Path

from findings import FINDINGS, Users

SEEDS = 5
PRESETS = ("pointing", "ar", "hello", "choice", "mobile-typing", "public-display")
#: Millions of control steps after which a user of a preset, of a finding or of a protocol stops in any case.
PRESET_STEPS = 150
FINDING_STEPS = {1: 150, 2: 150, 3: 150, 4: 200, 5: 110, 6: 400}
PROTOCOL_STEPS = {"F1": 250, "T1": 150, "E2": 60, "K3": 70, "S1": 150, "T3": 55}
#: Single episodes of a user of a preset.
EPISODES = 1000
#: Seconds that what is interrupted has to write its checkpoint.
PATIENCE = 30

#: A human on the default arm who has learnt nothing: protocols make it practise.
BASE = {
    "version": 2,
    "name": "base",
    "user": "human",
    "model": "myo-arm",
    "scene": {
        "ball": {
            "kind": "sphere",
            "at": {"x": 0.5, "y": [-0.2, 0.3], "z": [-0.3, 0.3]},
            "radius": [0.05, 0.15],
        }
    },
    "script": [{"dwell": {"in": "ball", "for_s": 0.25}}],
    "time_limit_s": 4,
}


class Interrupted(Exception):
    """The time was up."""


class Card:
    """Runs the program on a card, until the time is up."""

    def __init__(self, args, number, until):
        self.myo, self.out, self.number, self.until = args.myo, args.out, number, until
        self.on_card = ["--backend", "gpu", "--device", str(number)]

    def call(self, *words, partly=False):
        """What a command prints, `partly` also what one told that failed then; it may be interrupted before."""
        left = self.until - time.monotonic()
        if left <= 0:
            raise Interrupted
        with (self.out / "log").open("ab") as log:
            process = subprocess.Popen([self.myo, *map(str, words)], stdout=subprocess.PIPE, stderr=log, text=True)
            try:
                printed, _ = process.communicate(timeout=left)
            except subprocess.TimeoutExpired:
                process.send_signal(signal.SIGINT)
                process.communicate(timeout=PATIENCE)
                raise Interrupted from None
        if process.returncode and not (partly and printed):
            raise subprocess.CalledProcessError(process.returncode, process.args)
        return printed

    def trained(self, folder, *words):
        """Trains users, or goes on with them."""
        if folder.exists():
            self.call("train", "--resume", folder)
        else:
            self.call("train", *words, "--out", folder, *self.on_card)


class UsersOfCard(Users):
    """Users of findings that learn on a card."""

    def __init__(self, card, steps):
        options = ["--steps", f"{steps}M", *card.on_card]
        super().__init__(card.myo, folder(card.out / "findings"), SEEDS, options)
        self.card = card

    def call(self, *words):
        return self.card.call(*words)


@dataclass
class Job:
    """Something to measure: `work` takes a card and returns what is to be kept."""

    name: str
    work: callable
    #: On a card that does nothing else.
    alone: bool = False
    #: Names of jobs that must be done before.
    after: list = field(default_factory=list)


def folder(path):
    """The folder, which is there then."""
    path.mkdir(parents=True, exist_ok=True)
    return path


def times():
    """Of training to the plateau, of the environment with and without fatigue, and the published experiments."""

    def plateau(*user):
        words = ["bench", "train", "pointing", *user, "--until", "plateau", "--seeds", 3, "--json"]
        return lambda card: card.call(*words, *card.on_card)

    def environment(name, more):
        def work(card):
            task = card.out / f"{name}.yaml"
            task.write_text(json.dumps({**BASE, **more}))
            return card.call("bench", "env", "--task", task, "--envs", "4096,65536", "--json", *card.on_card)

        return work

    def published(card):
        card.call("bench", "published", "--out", card.out / "published", *card.on_card)
        return (card.out / "published/published.json").read_text()

    return [
        Job("env-base", environment("base", {}), alone=True),
        Job("env-tired", environment("tired", {"fatigue": {"speed": 1}}), alone=True),
        Job("plateau-human", plateau(), alone=True),
        Job("plateau-fastest", plateau("--user", "fastest"), alone=True),
        Job("published", published, alone=True),
    ]


def presets():
    """Users of each preset, trained to their plateau and asked."""

    def work(preset):
        def ask(card):
            users = card.out / "presets" / preset
            card.trained(users, preset, "--seeds", SEEDS, "--steps", f"{PRESET_STEPS}M")
            seeds = range(1, SEEDS + 1)
            asked = [card.call("eval", users / f"seed-{seed}", "--json", "--episodes", EPISODES) for seed in seeds]
            return json.dumps([json.loads(told) for told in asked])

        return ask

    def beside(card):
        users = ["--beside", card.out / "presets/pointing"]
        card.call("bench", "published", "--only", "figures", *users, "--out", card.out / "published", *card.on_card)
        return (card.out / "published/published.json").read_text()

    jobs = [Job(f"preset-{preset}", work(preset)) for preset in PRESETS]
    return [*jobs, Job("published-beside", beside, after=["published", "preset-pointing"])]


def findings():
    """Users of each finding; all are judged in the end."""

    def work(number, study):
        return lambda card: str(UsersOfCard(card, FINDING_STEPS[number]).trained(study))

    def judge(card):
        words = [sys.executable, Path(__file__).parent / "findings.py", "--out", card.out / "findings"]
        told = subprocess.run([*words, "--myo", card.myo], stdout=subprocess.PIPE, text=True)
        # It ends with 1 where a finding does not hold, which is an answer.
        if told.returncode not in (0, 1) or not told.stdout:
            raise subprocess.CalledProcessError(told.returncode, told.args)
        return told.stdout

    jobs = [
        Job(f"finding-{number}-{place}", work(number, study))
        for number, _, studies, _ in FINDINGS
        for place, study in enumerate(studies, 1)
    ]
    return [*jobs, Job("findings", judge, after=[job.name for job in jobs])]


def protocols():
    """Users who practise what protocols ask, each protocol beside the others, and all bands in the end."""

    def base(card, name):
        user = folder(card.out / "protocols") / name
        if not user.exists():
            task = card.out / f"base-{name}.yaml"
            task.write_text(json.dumps(BASE))
            words = ["--seed", 1, "--steps", "60k", "--until", "off", "--backend", "cpu"]
            card.call("train", task, *words, "--out", user)
        return user

    def asked(card, user, name, millions):
        words = ["--protocol", name, "--seeds", SEEDS, "--steps", f"{millions}M", "--json"]
        # Where somebody has not learnt all of it, what was learnt is told.
        return card.call("eval", user, *words, *card.on_card, partly=True)

    def work(name, millions):
        return lambda card: asked(card, base(card, name), name, millions)

    def bands(card):
        user = base(card, "bands")
        for name in PROTOCOL_STEPS:
            for practised in (card.out / "protocols" / name / "protocols").iterdir():
                if practised.is_dir() and not (folder(user / "protocols") / practised.name).exists():
                    practised.rename(user / "protocols" / practised.name)
        told = {name: json.loads(asked(card, user, name, 1)) for name in ("K1", "K2", "K5")}
        return json.dumps({**told, "bands": json.loads(asked(card, user, "bands", 1))})

    jobs = [Job(name, work(name, millions)) for name, millions in PROTOCOL_STEPS.items()]
    return [*jobs, Job("bands", bands, after=[job.name for job in jobs])]


def carry_out(jobs, args):
    """Does jobs on all cards until all are done or the time is up; the names of those that are not done."""
    until, lock = time.monotonic() + args.seconds, threading.Condition()
    answers = folder(args.out / "answers")
    done = {path.stem for path in answers.iterdir()}
    waiting, failed, at_work = [job for job in jobs if job.name not in done], {}, set()

    def take():
        """The next job that can begin; waits while others may yet be done."""
        with lock:
            while waiting and time.monotonic() < until:
                ready = [job for job in waiting if done.issuperset(job.after)]
                if ready:
                    waiting.remove(ready[0])
                    at_work.add(ready[0].name)
                    return ready[0]
                if not at_work:
                    return None
                lock.wait(1)
        return None

    def work(card):
        while job := take():
            begun = time.monotonic()
            try:
                answer = job.work(card)
                (answers / f"{job.name}.json").write_text(answer)
                says = f"{time.monotonic() - begun:.1f} s on card {card.number}"
            except Interrupted:
                failed[job.name] = says = "interrupted"
            except (subprocess.SubprocessError, OSError, ValueError) as error:
                failed[job.name] = says = f"failed: {error}"
            with lock:
                at_work.discard(job.name)
                if job.name not in failed:
                    done.add(job.name)
                lock.notify_all()
            print(f"{job.name}: {says}", flush=True)

    threads = [
        threading.Thread(target=work, args=(Card(args, number, until),))
        for number in range(args.cards)
        for _ in range(args.each)
    ]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    return [job.name for job in jobs if job.name not in done]


def alone(jobs, args):
    """Does jobs one after the other on each card, one card beside another."""
    args = argparse.Namespace(**{**vars(args), "each": 1})
    return carry_out(jobs, args)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("out", type=Path, help="where users and answers are kept")
    parser.add_argument("--cards", type=int, default=1)
    parser.add_argument("--each", type=int, default=2, help="jobs of one card at once")
    parser.add_argument("--seconds", type=float, default=1e6, help="after which what is not done is interrupted")
    parser.add_argument("--only", help="names of jobs, such as F1,preset-ar")
    parser.add_argument("--myo", default="target/release/myo", help="the program")
    args = parser.parse_args()
    folder(args.out)
    begun, jobs = time.monotonic(), [*times(), *findings(), *protocols(), *presets()]
    if args.only:
        jobs = [job for job in jobs if job.name in args.only.split(",")]
    left = alone([job for job in jobs if job.alone], args)
    args.seconds -= time.monotonic() - begun
    left += carry_out([job for job in jobs if not job.alone], args)
    print(f"{len(jobs) - len(left)} of {len(jobs)} done; left: {', '.join(left) or 'none'}")
    return 1 if left else 0


if __name__ == "__main__":
    sys.exit(main())
