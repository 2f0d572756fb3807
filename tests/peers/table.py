"""Rows of the first table, their verdicts, and how both tables are printed."""

from dataclasses import dataclass

MOST_SIGMA = 6.0  # an entry of G or of a covariance may err by this


@dataclass
class Row:
    group: str
    cases: int
    compared: str
    difference: float | None  # largest, relative
    allowed: float | None
    ours: str  # what frfid's error is
    theirs: str
    is_right: bool  # whether frfid is, by the known answer
    remark: str = ""  # what is expected to be different, and why

    @property
    def agrees(self):
        return self.difference is None or bool(self.difference <= self.allowed)

    @property
    def verdict(self):
        if not self.is_right:
            return "FRFID IS WRONG"
        return "DIFFERENT" if not self.agrees else self.remark or "same"

    @property
    def passes(self):
        return self.is_right and self.agrees


def sigma_row(group, cases, compared, difference, allowed, ours, theirs, remark=""):
    """A row whose errors are in standard deviations."""
    return Row(group, cases, compared, difference, allowed, f"{ours:.1f} s", f"{theirs:.1f} s", bool(ours < MOST_SIGMA), remark)


def print_rows(rows):
    """Each as it comes, in columns."""
    line = "{:33} {:>5}  {:29} {:>10} {:>7}  {:>9} {:>9}  {}"
    print(line.format("scenarios", "cases", "compared", "difference", "allowed", "frfid off", "peer off", "verdict"))
    for row in rows:
        difference = "" if row.difference is None else f"{row.difference:.0e}"
        allowed = "" if row.allowed is None else f"{row.allowed:.0e}"
        print(line.format(row.group, row.cases, row.compared, difference, allowed, row.ours, row.theirs, row.verdict), flush=True)
        yield row


def print_capabilities(rows):
    """(what, frfid, best-linear-approximation, pyFRF)."""
    line = "{:54} {:22} {:22} {}"
    print(line.format("what it gives", "frfid", "best-linear-approx.", "pyFRF"))
    for row in rows:
        print(line.format(*row), flush=True)
