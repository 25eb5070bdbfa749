import pytest

from bikesim.record.channels import TICK_CHANNELS, TIMING_CHANNELS, Channel


@pytest.mark.parametrize("channel", TICK_CHANNELS + TIMING_CHANNELS, ids=lambda c: c.name)
def test_every_channel_says_unit_sign_and_meaning(channel: Channel):
    assert channel.unit
    assert channel.sign
    assert channel.description


def test_names_are_unique():
    names = [channel.name for channel in TICK_CHANNELS + TIMING_CHANNELS]
    assert len(set(names)) == len(names)


@pytest.mark.parametrize("name", ["", "steer rate", "a,b", "a/b", "φ"])
def test_a_name_that_no_table_could_carry_is_refused(name: str):
    with pytest.raises(ValueError, match="identifier"):
        Channel(name, "1", "", "")
