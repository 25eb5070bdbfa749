"""The part of the firmware that is the board's own."""

import shutil
import subprocess
from pathlib import Path

import pytest

# Syntax, where no cross compiler is at hand: sizes of registers and the assembler are the board's.
BOARD = ("board_stm32f3.c", "memory_stm32f3.c", "start_stm32f3.c", "main.c")


@pytest.mark.parametrize("file", BOARD)
def test_the_boards_part_has_no_mistake_that_this_compiler_sees(repository: Path, file: str):
    compiler = shutil.which("arm-none-eabi-gcc")
    flags = ["-mcpu=cortex-m4", "-mthumb"] if compiler else ["-Wno-int-to-pointer-cast"]
    checked = subprocess.run(
        [compiler or "cc", "-std=c99", "-Wall", "-Wextra", "-Werror", "-pedantic",
         "-ffreestanding", "-fsyntax-only", *flags, file],
        cwd=repository / "hardware" / "firmware", capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert checked.returncode == 0, checked.stderr
