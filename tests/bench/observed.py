"""What a guard sees of a bench on which all is well."""

from bikesim.bench.faults import Observation

SOUND = Observation(
    time=1.0, steer=0.1, steer_rate=0.0, fresh=True, sample_time=1.0, age=0.001,
    bad_frames=0, frozen_frames=0, pot_ok=True, gyro_ok=True, vref_ok=True, estop_closed=True,
    drive_age=0.001, drive_heartbeat_age=0.05, drive_trouble="", drive_error="",
    torque_measured=0.0, torque_sent=0.0, late=0.0, bus_trouble="", second_master=False,
)  # fmt: skip
