"""Measurements of speed and robustness; `python -m benchmarks` runs them all."""
