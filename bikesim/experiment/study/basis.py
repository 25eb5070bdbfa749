"""What a batch's results depend on besides its scenarios: the software, and files by content."""

from collections.abc import Iterable
from typing import NamedTuple, Self

from bikesim.experiment.scenario import Scenario
from bikesim.experiment.study.named_files import Files, files_of_each, union
from bikesim.experiment.study.versions import Versions


class Basis(NamedTuple):
    """The versions, and the files that the batch's scenarios are made of, with their digests.

    It travels with each batch: a worker may have begun, or been replaced, long after the others,
    and on a machine where files of the same names are others.
    """

    versions: Versions
    files: Files

    @classmethod
    def of(cls, scenarios: Iterable[Scenario]) -> Self:
        """That of this process, for these scenarios, now."""
        return cls(Versions.gather(), union(files_of_each(scenarios)))

    def difference(self, there: "Basis") -> str:
        """In what a worker's differs from this one, in a line; empty where they are the same."""
        if there.versions != self.versions:
            return f"its worker has {there.versions}; the experiment began with {self.versions}"
        names = sorted(self.files.keys() | there.files.keys())
        changed = (name for name in names if self.files.get(name) != there.files.get(name))
        if (name := next(changed, None)) is None:
            return ""
        if name in there.files:
            return f"{name}: for its worker it is not the one that the experiment began with"
        return f"{name}: its worker has none, the experiment began with one"
