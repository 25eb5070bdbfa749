"""The state machine inside an emulated CiA 402 drive, as the standard's figure has it."""

from bikesim.bench.cia402 import FAULT_RESET, State

_SWITCH_ON, _ENABLE_VOLTAGE, _NO_QUICK_STOP, _ENABLE = 0x01, 0x02, 0x04, 0x08

_STATUSWORD = {
    State.NOT_READY: 0x0000,
    State.SWITCH_ON_DISABLED: 0x0240,
    State.READY_TO_SWITCH_ON: 0x0231,
    State.SWITCHED_ON: 0x0233,
    State.OPERATION_ENABLED: 0x1237,  # bit 12: it follows the target
    State.QUICK_STOP_ACTIVE: 0x0217,
    State.FAULT_REACTION_ACTIVE: 0x021F,
    State.FAULT: 0x0218,
}

# A fault reaction is over, and may be seen, after so long [s].
_REACTION_TIME = 0.002


class PowerStage:
    """Follows controlwords; has torque only in "operation enabled"."""

    def __init__(self) -> None:
        self.state = State.SWITCH_ON_DISABLED
        self.cause_remains = False
        self.quick_stop_option = 2  # object 605A; 0: the motor is free at once
        self._last = 0
        self._reaction_ends = 0.0

    @property
    def statusword(self) -> int:
        """Object 6041."""
        return _STATUSWORD[self.state]

    def control(self, word: int) -> bool:
        """Takes a controlword; whether it reset a fault."""
        rising = word & ~self._last
        self._last = word
        if self.state is State.FAULT:
            if rising & FAULT_RESET and not self.cause_remains:
                self.state = State.SWITCH_ON_DISABLED
                return True
        elif self.state is not State.FAULT_REACTION_ACTIVE:
            self.state = self._next(word)
        return False

    def fail(self, time: float) -> None:
        """Something is wrong: the motor is free at once."""
        if self.state is not State.FAULT:
            self.state = State.FAULT_REACTION_ACTIVE
            self._reaction_ends = time + _REACTION_TIME

    def disable(self) -> None:
        """As a controlword that disables the voltage does."""
        if self.state not in (State.FAULT, State.FAULT_REACTION_ACTIVE):
            self.state = State.SWITCH_ON_DISABLED

    def advance(self, time: float) -> None:
        """Ends a fault reaction in fault."""
        if self.state is State.FAULT_REACTION_ACTIVE and time >= self._reaction_ends:
            self.state = State.FAULT

    def _next(self, word: int) -> State:
        if not word & _ENABLE_VOLTAGE:
            return State.SWITCH_ON_DISABLED
        if not word & _NO_QUICK_STOP:
            return self._quick_stop()
        if not word & _SWITCH_ON and self.state is not State.QUICK_STOP_ACTIVE:
            return State.READY_TO_SWITCH_ON
        return self._switched(word)

    def _switched(self, word: int) -> State:
        if self.state is State.READY_TO_SWITCH_ON:
            return State.SWITCHED_ON
        if self.state in (State.SWITCHED_ON, State.OPERATION_ENABLED):
            return State.OPERATION_ENABLED if word & _ENABLE else State.SWITCHED_ON
        return self.state

    def _quick_stop(self) -> State:
        running = self.state in (State.OPERATION_ENABLED, State.QUICK_STOP_ACTIVE)
        if running and self.quick_stop_option:
            return State.QUICK_STOP_ACTIVE
        return State.SWITCH_ON_DISABLED
