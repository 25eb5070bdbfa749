"""The state machine against the tables of the standard."""

import pytest

from bikesim.bench.cia402 import Goal, State, next_controlword, state_of
from bikesim.bench.emulated.power_stage import PowerStage

# IEC 61800-7-201, table "state coding": xxxx xxxx x0xx 0000 and so on.
CODING = {
    State.NOT_READY: "x0xx0000",
    State.SWITCH_ON_DISABLED: "x1xx0000",
    State.READY_TO_SWITCH_ON: "x01x0001",
    State.SWITCHED_ON: "x01x0011",
    State.OPERATION_ENABLED: "x01x0111",
    State.QUICK_STOP_ACTIVE: "x00x0111",
    State.FAULT_REACTION_ACTIVE: "x0xx1111",
    State.FAULT: "x0xx1000",
}


def coded(word: int) -> State:
    for state, pattern in CODING.items():
        bits = f"{word & 0xFF:08b}"
        if all(p in ("x", b) for p, b in zip(pattern, bits, strict=True)):
            return state
    return State.UNKNOWN


def test_each_statusword_tells_the_state_of_the_standard():
    for word in range(0x100):
        assert state_of(word) is state_of(word | 0x1200) is coded(word)


def test_from_disabled_to_enabled_in_three_words():
    stage, words, last = PowerStage(), [], 0
    while state_of(stage.statusword) is not State.OPERATION_ENABLED and len(words) < 9:
        last = next_controlword(Goal.ENABLED, state_of(stage.statusword), last)
        words.append(last)
        stage.control(last)
    assert words == [0x06, 0x07, 0x0F]
    assert next_controlword(Goal.ENABLED, State.OPERATION_ENABLED, 0x0F) == 0x0F


@pytest.mark.parametrize("state", State)
def test_disabling_asks_for_no_voltage_whatever_the_state(state: State):
    assert next_controlword(Goal.DISABLED, state, 0x0F) == 0


@pytest.mark.parametrize("state", [State.FAULT, State.FAULT_REACTION_ACTIVE, State.UNKNOWN])
def test_a_fault_is_not_reset_by_wanting_to_enable(state: State):
    word = 0
    for _ in range(4):
        word = next_controlword(Goal.ENABLED, state, word)
        assert word == 0


def test_a_fault_is_reset_by_a_rising_edge():
    stage = PowerStage()
    stage.fail(0.0)
    stage.advance(1.0)
    stage.control(0x80)
    stage.fail(1.0)
    stage.advance(2.0)
    stage.control(0x80)
    assert stage.state is State.FAULT  # it was up all the time
    last = 0x80
    for _ in range(2):
        last = next_controlword(Goal.RESET, stage.state, last)
        stage.control(last)
    assert stage.state is State.SWITCH_ON_DISABLED


# The transitions of the standard's figure that a controlword makes.
TRANSITIONS = [
    (State.SWITCH_ON_DISABLED, 0x06, State.READY_TO_SWITCH_ON),  # 2
    (State.SWITCH_ON_DISABLED, 0x0F, State.SWITCH_ON_DISABLED),
    (State.READY_TO_SWITCH_ON, 0x07, State.SWITCHED_ON),  # 3
    (State.SWITCHED_ON, 0x0F, State.OPERATION_ENABLED),  # 4
    (State.OPERATION_ENABLED, 0x07, State.SWITCHED_ON),  # 5
    (State.SWITCHED_ON, 0x06, State.READY_TO_SWITCH_ON),  # 6
    (State.READY_TO_SWITCH_ON, 0x00, State.SWITCH_ON_DISABLED),  # 7
    (State.OPERATION_ENABLED, 0x06, State.READY_TO_SWITCH_ON),  # 8
    (State.OPERATION_ENABLED, 0x00, State.SWITCH_ON_DISABLED),  # 9
    (State.SWITCHED_ON, 0x00, State.SWITCH_ON_DISABLED),  # 10
    (State.OPERATION_ENABLED, 0x02, State.QUICK_STOP_ACTIVE),  # 11
    (State.QUICK_STOP_ACTIVE, 0x00, State.SWITCH_ON_DISABLED),  # 12
    (State.QUICK_STOP_ACTIVE, 0x0F, State.QUICK_STOP_ACTIVE),
    (State.FAULT, 0x0F, State.FAULT),
    (State.FAULT, 0x80, State.SWITCH_ON_DISABLED),  # 15
    (State.FAULT_REACTION_ACTIVE, 0x80, State.FAULT_REACTION_ACTIVE),
]


@pytest.mark.parametrize(("before", "word", "after"), TRANSITIONS, ids=str)
def test_the_emulated_drives_transitions(before: State, word: int, after: State):
    stage = PowerStage()
    stage.state = before
    stage.control(word)
    assert stage.state is after
    assert state_of(stage.statusword) is after


def test_a_fault_whose_cause_remains_is_not_reset():
    stage = PowerStage()
    stage.state, stage.cause_remains = State.FAULT, True
    assert not stage.control(0x80)
    assert stage.state is State.FAULT
