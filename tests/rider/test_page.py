"""The rider that docs/riders.md shows."""

import re
from pathlib import Path

import pytest

from bikesim.experiment.run import build, ride_parts
from bikesim.experiment.scenario import Scenario
from bikesim.path.settings import PathSettings
from bikesim.record.channels import TICK_CHANNELS
from bikesim.rider.contract import check
from bikesim.rider.kinds import HUMAN_KEYS
from bikesim.rider.settings import RiderSettings

PAGE = Path(__file__).resolve().parents[2] / "docs" / "riders.md"


@pytest.fixture
def shown(tmp_path: Path) -> RiderSettings:
    """The example, in a file."""
    (text,) = re.findall(r"```python\n(.*?)```", PAGE.read_text(encoding="utf-8"), re.DOTALL)
    assert len(text.splitlines()) <= 20
    file = tmp_path / "my_rider.py"
    file.write_text(text)
    return RiderSettings(name=f"{file}:MyRider")


def test_he_changes_lanes(shown: RiderSettings):
    rows: list[tuple[float, ...]] = []

    class Rows:
        append = staticmethod(rows.append)

    path = PathSettings(kind="lane-change")
    scenario = Scenario(rider=shown, speed=5.0, path=path, duration=15.0, period=2e-3)
    ending = ride_parts(build(scenario), Rows())
    assert not ending.fell
    y = [channel.name for channel in TICK_CHANNELS].index("y")
    assert rows[-1][y] == pytest.approx(2.0, abs=0.1)


def test_he_keeps_the_contract(shown: RiderSettings, setting):
    assert all(one.passed for one in check(shown, setting(step=2e-3)))


def test_the_page_has_every_part_of_a_body():
    text = PAGE.read_text(encoding="utf-8")
    bandwidths = [key for key in HUMAN_KEYS if key.endswith("noise_bandwidth")]
    assert len(bandwidths) == 3  # told together
    assert [key for key in HUMAN_KEYS if key not in text and key not in bandwidths] == []
