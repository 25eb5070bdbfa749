"""The statistics of an experiment for programs."""

import json
import math
from typing import Any

import numpy as np

from bikesim.experiment.metric_table import BY_NAME
from bikesim.report.experiment.data import Data
from bikesim.report.experiment.findings import Findings


def told_json(data: Data, findings: Findings) -> str:
    """All that the page says in figures, SI, in the names of the code; NaN and ∞ are null."""
    told = {
        "title": data.title,
        "runs": len(data.table),
        "planned": data.planned,
        "factors": [factor._asdict() for factor in data.factors],
        "units": {name: BY_NAME[name].unit for name in data.metrics},
        **findings._asdict(),
        "facts": dict(data.facts),
    }
    return json.dumps(_plain(told), indent=1, ensure_ascii=False) + "\n"


def _plain(value: Any) -> Any:
    """Tuples with names as objects, arrays as lists."""
    if hasattr(value, "_asdict"):
        value = value._asdict()
    if isinstance(value, dict):
        return {key: _plain(one) for key, one in value.items()}
    if isinstance(value, np.ndarray):
        value = value.tolist()
    if isinstance(value, list | tuple):
        return [_plain(one) for one in value]
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    return value
