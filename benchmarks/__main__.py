"""Runs every benchmark, or those named: `python -m benchmarks tick`."""

import sys
from importlib import import_module

BENCHMARKS = (
    "accuracy",
    "riders",
    "hess",
    "tick",
    "video",
    "kill",
    "identify",
    "throughput",
    "study",
    "dask",
    "bench",
)


def main(names: list[str]) -> int:
    """Run the benchmarks named, all if none is; each prints what it measured."""
    strange = [name for name in names if name not in BENCHMARKS]
    if strange:
        print(f"unknown benchmark {strange[0]!r}; known: {', '.join(BENCHMARKS)}", file=sys.stderr)
        return 2
    for name in names or BENCHMARKS:
        print(f"== {name}", flush=True)
        import_module(f"benchmarks.{name}").main()
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
