import pytest

from bikesim.errors import InputError
from bikesim.path.building import make_path
from bikesim.path.settings import PATH_KINDS, PathSettings


def test_by_kind_it_has_the_figures_of_that_kind():
    path = PathSettings(kind="circle", radius=12.0)
    assert (path.radius, path.side, path.start, path.offset) == (12, "right", 20, None)


def test_resolved_it_is_the_same_again():
    for kind in PATH_KINDS[:-1]:
        path = PathSettings(kind=kind)
        assert PathSettings(**path.model_dump(exclude_none=True)) == path


def test_the_same_settings_give_the_same_path():
    assert make_path(PathSettings(kind="slalom")) is make_path(PathSettings(kind="slalom"))


@pytest.mark.parametrize(
    ("figures", "told"),
    [
        ({"kind": "zigzag"}, "unknown path.kind 'zigzag'; known: straight, lane-change"),
        ({"kind": "circel"}, "unknown path.kind 'circel'; did you mean circle?"),
        ({"radius": 9.0}, "path.radius = 9.0: kind straight has no such figure"),
        ({"kind": "slalom", "radius": 9.0}, "path.radius = 9.0: kind slalom has no"),
        ({"kind": "circle", "radius": 1.0}, "path.radius = 1.0: must be at least 2 and at most"),
        ({"kind": "circle", "radius": "wide"}, "path.radius = 'wide': must be a number"),
        ({"kind": "circle", "raduis": 9.0}, "unknown key of [path] 'raduis'; did you mean radius?"),
        ({"kind": "lane-change", "length": 2.0}, "path: bends with a radius of"),
        ({"kind": "csv"}, "path: of kind csv: file must be given"),
        ({"kind": "csv", "file": 3}, "path.file = 3: must be text"),
        ({"kind": "csv", "points": [[0, 1, 2]]}, "path.points.0 = [0, 1, 2]: must be a list of 2"),
        ({"kind": 3}, "path.kind = 3: must be text"),
    ],
)
def test_refused_in_one_line(figures, told: str):
    with pytest.raises(InputError) as refused:
        PathSettings(**figures)
    assert str(refused.value).startswith(told)
    assert "\n" not in str(refused.value)
