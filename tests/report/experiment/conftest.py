from itertools import product

import numpy as np
import pandas as pd
import pytest

from bikesim.experiment.metrics import Metrics
from bikesim.report.experiment.comparisons import comparisons
from bikesim.report.experiment.data import Condition, Data, Factor, Kept, shown

FACTORS = (
    Factor("law", "law", "", ("paper", "off")),
    Factor("vision.roll_cue", "roll cue", "", (True, False)),
    Factor("speed", "speed", "m/s", (2.5, 5.0, 7.0)),
)
SEEDS = 12


def conditions() -> tuple[Condition, ...]:
    return tuple(
        Condition(", ".join(f"{f.label}={shown(v)}" for f, v in zip(FACTORS, levels, strict=True)),
                  levels)
        for levels in product(*(factor.levels for factor in FACTORS))
    )  # fmt: skip


def table() -> pd.DataFrame:
    """With haptics off all fall below 5 m/s; roll is 0.02 rad with the roll cue, 0.03 without."""
    rows = []
    for condition in conditions():
        law, roll_cue, speed = condition.levels
        for seed in range(1, SEEDS + 1):
            noise = np.random.default_rng(seed).normal()
            fell = law == "off" and speed < 5
            time = 2.0 + 0.1 * seed
            roll = (0.02 if roll_cue else 0.03) * (1 + 0.05 * noise) + 1e-4 * (seed % 3)
            metrics = dict.fromkeys(Metrics._fields, float("nan")) | {
                "fell": float(fell),
                "fall_time": time if fell else float("nan"),
                "duration": time if fell else 20.0,
                "roll_rms": 0.5 if fell else roll,
                "lateral_rms": 0.1,
            }
            ending = "fell to the left" if fell else "end of run"
            rows.append(
                {"condition": condition.name, "seed": seed, "ending": ending, **metrics}
                | dict(zip((f.name for f in FACTORS), condition.levels, strict=True))
            )
    return pd.DataFrame(rows)


@pytest.fixture(scope="session")
def data() -> Data:
    """An experiment of twelve conditions and as many seeds, made up."""
    made = conditions()
    return Data(
        title="Made up & <tested>",
        description="What does it say?",
        factors=FACTORS,
        conditions=made,
        table=table(),
        metrics=("fall_time", "roll_rms", "lateral_rms"),
        comparisons=comparisons((), FACTORS, made),
        planned=len(made) * SEEDS,
        facts=(("bikesim", "1.2.3"),),
        kept=(Kept(made[0].name, 1, "records/a b.h5", "videos/a b.mp4"),),
        toml='title = "Made up"',
    )
