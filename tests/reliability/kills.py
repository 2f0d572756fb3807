"""The command killed at any time, twice, and started again: nothing half done passes for done, and the end is the same to the byte."""

import functools
import pathlib
import random
import shutil
import signal

from command import call, scratch
from judges import contents, half_files, misbehaviour, tallied
from materials import DESCRIPTION, SHAPED, made

LONGER = DESCRIPTION.replace("realizations = 2", "realizations = 60")
COMMANDS = {
    "design": ["design", "x.toml", "-o", "new.mcap"],
    "run": ["run", "plan.mcap", "-o", "new"],
    "estimate": ["estimate", "logs", "-o", "new.json", "--report", "new.html"],
    "shape": ["shape", "shaped.toml", "-o", "new"],
}
SIGNALS = [signal.SIGKILL, signal.SIGTERM]
INTERRUPTED = 130


class Loop:
    def __init__(self, folder, name):
        self.folder, self.name = folder, name
        (folder / "x.toml").write_text(LONGER)
        (folder / "shaped.toml").write_text(SHAPED)
        made(folder, "design", "x.toml", "-o", "plan.mcap")
        made(folder, "run", "plan.mcap", "-o", "logs")
        with self.laid() as place:
            said = call(place, *COMMANDS[name])
            self.code, self.seconds, self.sound = said.code, said.seconds, contents(place)

    def laid(self):
        place = scratch()
        shutil.copytree(self.folder, place.name, dirs_exist_ok=True)
        return place

    def judge(self, seed):
        """Killed twice, at times that are drawn, then left alone."""
        draw = random.Random(seed)
        fault, outcomes = None, []
        with self.laid() as place:
            for _ in range(2):
                number = draw.choice(SIGNALS)
                said = call(place, *COMMANDS[self.name], kill=(number, draw.uniform(0, self.seconds)))
                is_killed = said.code in (-number, INTERRUPTED)
                halves = half_files(place)
                fault = fault or (f"half files after {number.name}: {halves}" if halves else None)
                fault = fault or (None if is_killed else misbehaviour(said))
                outcomes.append((f"{'killed' if is_killed else 'too late'} by {number.name}", None))
            end, wrong = self.finished(place)
        return [*outcomes, (end, (fault or wrong) and f"seed {seed}: {fault or wrong}")]

    def finished(self, place):
        """The same command, with --force where it asks for it: how it went, and what is wrong at the end."""
        said, end = call(place, *COMMANDS[self.name]), "the same at the end"
        if said.code in (1, 2) and "--force" in said.text:
            said, end = call(place, *COMMANDS[self.name], "--force"), "the same at the end, with --force"
        if said.code != self.code:
            return "not done at the end", f"afterwards: {said.text.strip()[-300:]}"
        left = [name for name in contents(place, parts=True) if name.endswith(".part")]
        if contents(place) != self.sound or left:
            return "another end", f"other files at the end; left: {left}"
        return end, None


def loop(name, count, seed=1, n_workers=2):
    with scratch() as folder:
        killed = Loop(pathlib.Path(folder), name)
        return tallied(f"kills of {name}", [functools.partial(killed.judge, f"{seed} {k}") for k in range(count)], n_workers)
