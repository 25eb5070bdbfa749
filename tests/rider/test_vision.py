import numpy as np
import pytest

from bikesim.errors import InputError
from bikesim.rider.settings import RiderSettings
from bikesim.rider.vision import VisionSettings


def test_by_default_all_is_shown_at_once():
    vision = VisionSettings()
    assert (vision.roll_cue, vision.preview, vision.delay, vision.occlusions) == (True, None, 0, ())


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"occlusions": [[2.0, 1.0]]}, "[2.0, 1.0]: must end after it begins"),
        ({"occlusions": [[1.0, 1.0]]}, "must end after it begins"),
        ({"occlusions": [[1.0, 3.0], [2.0, 4.0]]}, "must rise and not overlap"),
        ({"occlusions": [[3.0, 4.0], [1.0, 2.0]]}, "must rise and not overlap"),
        ({"occlusions": [[1.0]]}, "vision.occlusions.0"),
        ({"occlusions": 3.0}, "vision.occlusions = 3.0: must be a list"),
        ({"delay": -0.1}, "vision.delay = -0.1: must be at least 0 and at most 5"),
        ({"preview": -1.0}, "vision.preview = -1.0: must be at least 0"),
        ({"roll_cue": 1}, "vision.roll_cue = 1: must be"),
        ({"rollcue": True}, "did you mean roll_cue?"),
    ],
    ids=str,
)
def test_what_cannot_be_is_refused_in_one_line(given: dict, message: str):
    with pytest.raises(InputError) as error:
        VisionSettings(**given)
    assert message in str(error.value)
    assert "\n" not in str(error.value)


def test_intervals_may_touch():
    assert len(VisionSettings(occlusions=((1.0, 2.0), (2.0, 3.0))).occlusions) == 2


def test_the_preview_is_told_to_the_brain(tmp_path, make_many, make, seen):
    """Of many, to each his own; what the setting says is not exceeded."""
    file = tmp_path / "far.py"
    file.write_text(
        "class Far:\n"
        "    def __init__(self, setting): self.preview = setting.preview\n"
        "    def intend(self, steer, steer_rate, seen): return self.preview + 0.0 * steer\n"
    )
    name = f"{file}:Far"
    alone = make(name, vision=VisionSettings(preview=2.5))
    assert alone.torque(0.0, 0.0, seen()) == 2.5
    visions = [VisionSettings(preview=2.5), VisionSettings(preview=None)]
    many = make_many([RiderSettings(name=name)] * 2, visions, preview=3.0)
    assert many.torque(np.zeros(2), np.zeros(2), seen(np.zeros(2))).tolist() == [2.5, 3.0]
