"""The command of a child process that runs a module of ours."""

import json
import sys
from pathlib import Path

# `python -m` and `python -c` put the current folder first: another checkout's bikesim there, or a
# signal.py of the user's, would be found before what this process runs. -P leaves it out.
_FIND_AS_WE_DO = (
    "import json, runpy, sys; sys.path[:] = json.loads(sys.argv.pop(1)); "
    "runpy.run_module(sys.argv.pop(1), run_name='__main__', alter_sys=True)"
)


def child_command(module: str, *arguments: str) -> list[str]:
    """Like `python -m MODULE ARGUMENTS...`; each import finds there what it would find here."""
    path = [str(Path(place).absolute()) for place in sys.path]
    return [sys.executable, "-P", "-c", _FIND_AS_WE_DO, json.dumps(path), module, *arguments]
