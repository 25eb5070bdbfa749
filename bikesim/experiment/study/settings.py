"""What an experiment is: everything that its file may say, validated."""

from typing import Annotated, Any, ClassVar, Literal, Self

from pydantic import Field, Strict, field_validator, model_validator

from bikesim.errors import InputError, unknown
from bikesim.experiment.metric_table import METRICS
from bikesim.settings import Settings

_Seed = Annotated[int, Field(ge=0, lt=2**63)]
# TOML has lists, not tuples.
_List = Strict(False)
Kept = Literal["none", "first", "falls", "all"]


class Contrast(Settings):
    """What is compared over the same seeds: two levels of a factor, or two conditions by name.

    Levels are compared at each combination of the other factors.
    """

    table: ClassVar[str] = "report.contrasts"

    factor: str = Field(default="", description="A factor by its name.")
    levels: Annotated[tuple[bool | int | float | str, ...], _List] = Field(
        default=(),
        min_length=2,
        max_length=2,
        description="Two of its levels; the difference is the second less the first.",
    )
    of: str = Field(default="", description="A condition by its name, of the grid or beside it.")
    against: str = Field(
        default="", description="Another; the difference is that of `of` less this one's."
    )

    @model_validator(mode="after")
    def _one_way(self) -> Self:
        by_level, by_name = (self.factor, self.levels), (self.of, self.against)
        if any(by_level) == any(by_name) or not (all(by_level) or all(by_name)):
            raise ValueError(
                "report.contrasts: must be given: factor and levels, or of and against"
            )
        return self


class ReportSettings(Settings):
    """What the report shows first."""

    table: ClassVar[str] = "report"

    metrics: Annotated[tuple[str, ...], _List] = Field(
        default=("roll_rms", "steer_rms", "rider_torque_rms", "lateral_rms"),
        description="The primary metrics, by name.",
    )
    contrasts: Annotated[tuple[Contrast, ...], _List] = Field(
        default=(),
        description="What is compared; default: the first level of each factor with each other.",
    )

    @field_validator("metrics")
    @classmethod
    def _known(cls, names: tuple[str, ...]) -> tuple[str, ...]:
        known = [metric.name for metric in METRICS]
        for name in names:
            if name not in known:
                raise InputError(f"report.metrics: {unknown('metric', name, known)}")
        return names


class ExtraCondition(Settings):
    """A condition beside the grid."""

    table: ClassVar[str] = "conditions"

    name: Annotated[str, Field(min_length=1)] = Field(description="What it is called.")
    set: dict[str, Any] = Field(description="The scenario's keys that it replaces.")


class Experiment(Settings):
    """The keys of an experiment's file."""

    title: str = Field(default="", description="What the report is called.")
    description: str = Field(default="", description="What is asked, in a few sentences.")
    scenario: dict[str, Any] = Field(
        default={}, description="What all runs have in common: the keys of a scenario."
    )
    factors: dict[str, Any] = Field(default={}, description="What is varied: a grid.")
    conditions: Annotated[tuple[ExtraCondition, ...], _List] = Field(
        default=(), description="Conditions beside the grid."
    )
    seeds: Annotated[tuple[_Seed, ...], _List] = Field(
        description="How many (1, 2, ... N), or a list; the same ones in every condition."
    )
    keep: Kept = Field(default="none", description="Which runs leave a full record.")
    keep_limit: Annotated[int, Field(ge=0, le=100_000)] = Field(
        default=100, description="Records at most."
    )
    videos: Kept = Field(default="none", description="Which of the kept runs are filmed.")
    video_limit: Annotated[int, Field(ge=0, le=10_000)] = Field(
        default=10, description="Videos at most."
    )
    batch_size: Annotated[int, Field(ge=1, le=65536)] = Field(
        default=512, description="Runs ridden together, at most."
    )
    max_runs: Annotated[int, Field(ge=1)] = Field(
        default=1_000_000, description="More than these are refused."
    )
    report: ReportSettings = Field(default=ReportSettings(), description="What it shows first.")
    folder: str = Field(
        default="", description="Where files that it names are sought first; default: beside it."
    )

    @field_validator("seeds", mode="before")
    @classmethod
    def _counted(cls, given: Any) -> Any:
        if isinstance(given, list | tuple):
            return given
        if isinstance(given, bool) or not isinstance(given, int):
            raise ValueError("must be how many (50), or a list of them ([1, 2, 3])")
        if given > 10**7:  # before they are made
            raise ValueError(f"{given} are too many: at most {10**7}")
        return tuple(range(1, given + 1))

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        if not self.seeds:
            raise ValueError("seeds: there are none, so the experiment has 0 runs")
        if len(set(self.seeds)) < len(self.seeds):
            twice = next(seed for seed in self.seeds if self.seeds.count(seed) > 1)
            raise ValueError(f"seeds: {twice} is there twice")
        if "seed" in self.scenario:
            raise ValueError("scenario.seed: an experiment has seeds, beside its [scenario]")
        return self
