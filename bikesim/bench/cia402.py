"""The state machine of a CiA 402 drive (IEC 61800-7-201), as seen through its two words."""

from enum import Enum, IntEnum

CYCLIC_SYNCHRONOUS_TORQUE = 10  # object 6060

DISABLE_VOLTAGE = 0x00
QUICK_STOP = 0x02
SHUTDOWN = 0x06
SWITCH_ON = 0x07
ENABLE_OPERATION = 0x0F
FAULT_RESET = 0x80  # acts when it rises


class State(Enum):
    """What a drive's statusword (6041) says; the value is (mask, what is left under it)."""

    NOT_READY = (0x4F, 0x00)
    SWITCH_ON_DISABLED = (0x4F, 0x40)
    READY_TO_SWITCH_ON = (0x6F, 0x21)
    SWITCHED_ON = (0x6F, 0x23)
    OPERATION_ENABLED = (0x6F, 0x27)
    QUICK_STOP_ACTIVE = (0x6F, 0x07)
    FAULT_REACTION_ACTIVE = (0x4F, 0x0F)
    FAULT = (0x4F, 0x08)
    UNKNOWN = (0x00, 0x00)

    @property
    def told(self) -> str:
        """For a person."""
        return self.name.replace("_", " ").lower()


def _of(status: int) -> State:
    matching = (s for s in State if status & s.value[0] == s.value[1])
    return next(matching, State.UNKNOWN)


# Of all that the seven bits may be: a tick looks it up.
_STATES = tuple(_of(status) for status in range(0x80))


def state_of(statusword: int) -> State:
    """The state that a statusword tells."""
    return _STATES[statusword & 0x7F]


class Goal(Enum):
    """Where a drive is to be brought. A fault is reset only when that is the goal."""

    ENABLED = "enabled"
    DISABLED = "disabled"
    RESET = "reset"


_TOWARDS_ENABLED = {
    State.SWITCH_ON_DISABLED: SHUTDOWN,
    State.READY_TO_SWITCH_ON: SWITCH_ON,
    State.SWITCHED_ON: ENABLE_OPERATION,
    State.OPERATION_ENABLED: ENABLE_OPERATION,
}


def next_controlword(goal: Goal, state: State, last: int) -> int:
    """The controlword (6040) to send, for the state just seen and the one sent last.

    Whatever is not on the way asks for no voltage: a drive in fault or quick stop stays there
    until a person wants otherwise.
    """
    if goal is Goal.ENABLED:
        return _TOWARDS_ENABLED.get(state, DISABLE_VOLTAGE)
    if goal is Goal.RESET and state is State.FAULT:
        # It acts as it rises: down and up again until the fault is gone.
        return DISABLE_VOLTAGE if last & FAULT_RESET else FAULT_RESET
    return DISABLE_VOLTAGE


class NmtState(IntEnum):
    """What a heartbeat tells (CiA 301)."""

    BOOT_UP = 0
    STOPPED = 4
    OPERATIONAL = 5
    PRE_OPERATIONAL = 127


class NmtCommand(IntEnum):
    """What the master tells a node."""

    START = 0x01
    STOP = 0x02
    ENTER_PRE_OPERATIONAL = 0x80
    RESET_NODE = 0x81
    RESET_COMMUNICATION = 0x82


HEARTBEAT_LOST = 0x8130  # emergency error code of CiA 301: a consumer missed a heartbeat
