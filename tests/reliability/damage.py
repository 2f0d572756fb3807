"""Files cut and flipped: read as they were, refused, or told to have lost something; never silently another number."""

import functools
import pathlib
import random

from command import call, scratch
from judges import contents, half_files, misbehaviour, numbers, tallied

ONE_JOB = {"FRFID_JOBS": "1"}  # the cases are done side by side
MEANINGS = {0: "done", 1: "refused", 2: "refused", 3: "told"}


def cuts(content, count, seed=1):
    """The content cut at `count` places, at every one where there are no more; the places that are drawn differ by seed."""
    places = range(len(content))
    if count < len(content):
        places = sorted(random.Random(seed).sample(places, count))
    return ((f"cut at byte {place}", content[:place]) for place in places)


def flips(content, count, seed=1):
    """The content with a bit flipped, `count` times; in every byte once where there are no more bytes."""
    draw = random.Random(seed)
    places = range(len(content)) if count >= len(content) else sorted(draw.sample(range(len(content)), count))
    for place in places:
        bit = draw.randrange(8)
        flipped = bytearray(content)
        flipped[place] ^= 1 << bit
        yield f"bit {bit} of byte {place} flipped", bytes(flipped)


def place_of(folder, command):
    return pathlib.Path(folder) / command[command.index("-o") + 1]


def output(folder, command):
    """What a command wrote: numbers of a result, bytes of any other file, a folder of them; None where there is nothing."""
    path = place_of(folder, command)
    if path.is_dir():
        return contents(path)
    if not path.exists():
        return None
    return numbers(path) if path.suffix == ".json" else path.read_bytes()


def follow_up(material, command):
    """A run of ours that was recovered is estimated with the others: it says itself what is missing in it."""
    return ["estimate", "-o", "of_again.json", "again"] if command[0] == "recover" and material.name.startswith("run") else None


def done_with(material, content):
    """(command, how it ended, what it wrote, what of it is not whole) for every command, in a folder of its own."""
    with scratch() as folder:
        material.lay(folder, content)
        for command in material.commands:
            said = call(folder, *command, env=ONE_JOB)
            yield command, said, output(folder, command), half_files(place_of(folder, command))
            after = follow_up(material, command)
            if after and said.code in (0, 3):
                yield after, call(folder, *after, env=ONE_JOB), output(folder, after), half_files(place_of(folder, after))


def sound_outputs(material):
    """What every command makes of the sound file."""
    made = {}
    for command, said, written, _ in done_with(material, material.content):
        assert said.code == 0 and written is not None, f"{material.name}: {command}: {said.text}"
        made[command[0], command[-1]] = written
    return made


def judge(material, sound, what, content):
    """The cases of one damaged file: a list of (outcome, fault or None)."""
    judged = []
    for command, said, written, halves in done_with(material, content):
        where = f"{what}, {command[0]}"
        outcome, fault = MEANINGS.get(said.code, "ended badly"), misbehaviour(said)
        is_other = said.code == 0 and written != sound[command[0], command[-1]]
        if said.code == 0:
            outcome = "silently another" if is_other else "as it was"
        if said.code in (1, 2) and written is not None and command[0] != "run":  # which keeps the runs before
            fault = fault or f"refused, and an output is there: {said.first_line}"
        if is_other and material.is_checked:
            fault = fault or "exit code 0 with another output"
        if halves:
            fault = fault or f"half files: {halves}"
        judged.append((f"{command[0]} {outcome}", fault and f"{where}: {fault}"))
    return judged


def loop(material, damages, n_workers=2, what="damage"):
    """Every damage of a material through every command."""
    sound = sound_outputs(material)
    cases = (functools.partial(judge, material, sound, place, content) for place, content in damages)
    return tallied(f"{what} of {material.name}", cases, n_workers)
