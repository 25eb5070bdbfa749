import pytest

from bikesim.model.law import Law


def test_the_laws_are_told_by_name():
    assert [str(law) for law in Law] == ["paper", "momentum", "off"]


@pytest.mark.parametrize("name", ["Paper", "", "on"])
def test_another_name_is_no_law(name: str):
    with pytest.raises(ValueError, match="is not a valid Law"):
        Law(name)
