"""The columns of the results table."""

import json
from typing import TYPE_CHECKING

from bikesim.experiment.metric_table import METRICS
from bikesim.experiment.study.versions import Versions

if TYPE_CHECKING:
    import pyarrow as pa

    from bikesim.experiment.study.factors import Factor
    from bikesim.experiment.study.plan import Study
    from bikesim.experiment.study.work import Done

# Who computed a run, and when: the only columns that depend on it.
PROVENANCE = ("worker", "batch", "started", "seconds", *Versions._fields)

# Names that a factor cannot have.
RESERVED = (
    "run", "condition_number", "condition", "seed", *(metric.name for metric in METRICS),
    "ending", "ticks", "record", "video", *PROVENANCE,
)  # fmt: skip


def schema_of(study: "Study") -> "pa.Schema":
    """Names and types; each metric's unit is in its metadata."""
    import pyarrow as pa

    text, number, whole = pa.string(), pa.float64(), pa.int64()
    return pa.schema(
        [
            pa.field("run", text),
            pa.field("condition_number", whole),
            pa.field("condition", text),
            *(pa.field(factor.name, _kind(factor)) for factor in study.factors),
            pa.field("seed", whole),
            *(pa.field(one.name, number, metadata={"unit": one.unit}) for one in METRICS),
            pa.field("ending", text),
            pa.field("ticks", whole),
            pa.field("record", text),
            pa.field("video", text),
            pa.field("worker", text),
            pa.field("batch", whole),
            pa.field("started", text),
            pa.field("seconds", number, metadata={"unit": "s"}),
            *(pa.field(name, text) for name in Versions._fields),
        ],
        metadata={"factors": json.dumps([factor.name for factor in study.factors])},
    )


def table_of(
    batch: int, done: "Done", worker: str, study: "Study", schema: "pa.Schema"
) -> "pa.Table":
    """The rows of a batch. `seconds` is a run's share of what the batch took."""
    import pyarrow as pa

    share = done.seconds / max(1, len(done.results))
    by = (worker, batch, done.started, share, *done.versions)
    rows = []
    for result, metrics in zip(done.results, done.metrics, strict=True):
        condition = study.condition(result.run.condition)
        rows.append(
            (
                str(result.run), condition.number, condition.name, *condition.values,
                result.run.seed, *metrics,
                result.ending, result.ticks, None, None, *by,
            )
        )  # fmt: skip
    columns = zip(*rows, strict=True) if rows else ([] for _ in schema)
    arrays = [pa.array(c, field.type) for c, field in zip(columns, schema, strict=True)]
    return pa.Table.from_arrays(arrays, schema=schema)


def _kind(factor: "Factor") -> "pa.DataType":
    import pyarrow as pa

    kinds = {type(level.value) for level in factor.levels}
    if kinds == {bool}:
        return pa.bool_()
    if kinds == {int}:
        return pa.int64()
    return pa.float64() if kinds <= {int, float} else pa.string()
