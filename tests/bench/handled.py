"""An emulated bar whose node has other sensors than it believes, and a person who turns it."""

import math

import numpy as np

from bikesim.bench.calibration import NodeCalibration
from bikesim.bench.emulated.steer_node import USUAL_CALIBRATION, EmulatedSteerNode
from bikesim.bench.frame import Frame

SENSORS = NodeCalibration(0.47, 5.2, 0.512, 9.6, 3.3)
POSITIONS = [math.radians(one) for one in (-30, 0, 30)]


class HandledBar(EmulatedSteerNode):
    """Its bar is where the person holds it, or is swung to and fro by 25 deg.

    `noise`: of both raw values, rms.
    """

    swinging = False

    def __init__(
        self,
        sensors: NodeCalibration = SENSORS,
        stored: NodeCalibration | None = USUAL_CALIBRATION,
        noise: float = 0.0,
    ) -> None:
        super().__init__(sensors=sensors, stored=stored)
        self.estop_closed = False
        self._noise, self._random = noise, np.random.default_rng(5)

    def advance(self, time: float) -> list[Frame]:
        if self.swinging:
            self.steer = math.radians(25) * math.sin(4 * time)
            self.steer_rate = 4 * math.radians(25) * math.cos(4 * time)
        if self._noise:
            s = self.sensors
            pot, gyro = self._noise * self._random.standard_normal(2)
            self.pot = s.pot_zero + self.steer / s.angle_scale + pot
            self.gyro = s.gyro_zero + self.steer_rate / s.rate_scale + gyro
        return super().advance(time)


class Person:
    """Does what is asked, `off` [deg] beside it; answers a position with what he reads."""

    def __init__(self, node: HandledBar, *, off: dict[str, float] | None = None) -> None:
        self._node, self._off = node, off or {}
        self.says: dict[str, str] = {}
        self.asked: list[str] = []

    def __call__(self, question: str) -> str:
        self.asked.append(question)
        if "swing" in question:
            self._node.swinging = True
            return ""
        where = question.removeprefix("turn the bar to ").partition(" deg")[0]
        self._node.steer = math.radians(float(where) + self._off.get(where, 0.0))
        return self.says.get(where, "")
