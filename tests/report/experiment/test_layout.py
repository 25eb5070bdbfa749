from bikesim.report.experiment.data import Condition, Data, Factor
from bikesim.report.experiment.layout import arrange


def test_numbers_along_the_axis_the_fewest_levels_by_colour_the_rest_in_panels(data: Data):
    layout = arrange(data.factors, data.conditions)
    assert layout.axis == data.factors[2]
    assert layout.places == (2.5, 5.0, 7.0)
    assert layout.colours == ("law paper", "law off")
    assert layout.panels == ("roll cue on", "roll cue off")


def test_each_condition_has_a_place_of_its_own(data: Data):
    marks = arrange(data.factors, data.conditions).marks
    assert [mark.condition for mark in marks] == list(data.conditions)
    assert len({mark[1:] for mark in marks}) == 12


def test_one_factor():
    factor = Factor("law", "law", "", ("paper", "off"))
    layout = arrange((factor,), [Condition(v, (v,)) for v in factor.levels])
    assert (layout.places, layout.colours, layout.panels) == (("paper", "off"), (), ("",))


def test_a_factor_of_one_level_is_left_out(data: Data):
    alone = Factor("bicycle", "bicycle", "", ("benchmark",))
    more = [Condition(one.name, (*one.levels, "benchmark")) for one in data.conditions]
    assert arrange((*data.factors, alone), more).panels == ("roll cue on", "roll cue off")


def test_extra_conditions_lie_in_one_line_by_their_names(data: Data):
    extra = Condition("extra", (None, True, 3.0))
    layout = arrange(data.factors, (*data.conditions, extra))
    assert layout.axis is None
    assert layout.places[-1] == "extra"
    assert not layout.numeric


def test_no_factors():
    assert arrange((), [Condition("base", ())]).places == ("base",)
