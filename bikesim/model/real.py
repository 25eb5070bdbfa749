"""The type of a quantity that serves one rig or many."""

from typing import Any, TypeAlias

# A float for one rig; for a batch, an array with a value for each.
Real: TypeAlias = Any
