"""Friction torque of a Dynamixel XL330 servo that swings a pendulum, by inverse dynamics.

Recorded by the BAM project (Duclusaud, Passault, Padois, Ly, "Extended Friction Models for the Physics Simulation of
Servo Actuators", arXiv 2410.08650): a mass of 0.49 kg on an arm of 0.1 m, the servo in position control with firmware
gains of 100 to 800 along three trajectories, position, speed, PWM, supply and temperature some 190 times a second.

The rig has no torque sensor. The friction torque is what is left of the motor's torque:

    friction = u / a − m g l sin(q) − J q̈ − (e / a) q̇,    u = duty · 7.4 V

with four constants read off the moving samples of the training recordings by least squares: a (V per N·m of output), J
(load with arm and rotor), e (back EMF and viscous friction, which cannot be told apart), and a Coulomb torque that is
fitted along so that it does not bias the others, and then stays in the output.

Defects and their handling:

- The load register is a signed count stored unsigned: values above 32767 are negative. 885 counts are full duty.
- The recorded supply flickers between about 6 and 8 V with the PWM, so the nominal 7.4 V, which the mean of the
  readings (7.3 V) supports, is used; the readings are a channel.
- The position has steps of 1.53 mrad. Speed and acceleration come from a cubic Savitzky-Golay filter of 0.1 s over it,
  not from the speed register, which has steps of 24 mrad/s.
- The arm's mass was not recorded: it is in a and J.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray
from scipy.constants import g as GRAVITY
from scipy.signal import savgol_filter

from .base import Dataset, DatasetSource, Recording
from .recorded import sensor_noise, until_first_turn
from .store import require

__all__ = ["ServoLog", "ServoPendulum", "drive_constants"]

Floats = NDArray[np.float64]

FOLDER = "bam/data.bak/raw"
TRAJECTORY = "sin_time_square"
TRAIN, TEST = (200, 800), (100, 400)
"""Firmware gains of the split."""

FULL_DUTY = 885.0
MOVING = 0.2
"""rad/s. Below it the servo may stick, and friction takes any value up to its limit."""

STEP = 0.005
WINDOW = 21
QUANTUM = 2.0 * np.pi / 4096.0


class ServoPendulum(DatasetSource):
    """Swings of rising frequency: trained at gains 200 and 800, tested at 100 and 400."""

    id: ClassVar[str] = "servo-pendulum"
    title: ClassVar[str] = "servo on a pendulum, friction torque by inverse dynamics"
    summary: ClassVar[str] = "recorded: friction torque of an XL330 servo, swings of rising frequency at four gains"
    kind: ClassVar[str] = "recorded"
    licence: ClassVar[str] = "Apache-2.0"
    extended: ClassVar[bool] = True

    def recordings(self) -> dict[str, Recording]:
        """Every published log at its full rate less 10 samples at either end, with the friction torque as output.

        Raises
        ------
        DatasetUnavailableError
            If the files are not on this machine.
        """
        logs = [ServoLog(json.loads(path.read_text(encoding="utf-8"))) for path in require(self.id).values()]
        drive = drive_constants([log for log in logs if log.trajectory == TRAJECTORY and log.gain in TRAIN])
        return {log.name: log.recording(drive) for log in logs}

    def load(self) -> Dataset:
        recordings = self.recordings()
        train, test = ([recordings[f"{TRAJECTORY}, gain {gain}"] for gain in gains] for gains in (TRAIN, TEST))
        x_sigma, y_sigma = sensor_noise([*train, *test])
        return Dataset(
            id=self.id,
            title=self.title,
            train=train,
            test=test,
            split="Trained at position gains of 200 and 800, tested at 100 and 400: other amplitudes and speeds.",
            x_name="position",
            x_unit="rad",
            y_name="friction torque",
            y_unit="N·m",
            source="Duclusaud, Passault, Padois, Ly, arXiv 2410.08650; Rhoban/bam",
            licence=self.licence,
            x_sigma=max(x_sigma, QUANTUM / np.sqrt(12.0)),
            y_sigma=y_sigma,
            assumptions=(
                "There is no torque sensor: friction is the motor's torque less gravity, inertia and a term in proportion "
                "to speed (back EMF and viscous friction together). The constants are fitted to the training recordings, "
                "with a supply of 7.4 V.",
                "Fitted to each recording alone, the voltage per torque rises from 8.4 (gain 100) to 12.6 V per N·m (gain "
                "800), so the output holds errors of the motor's model too: 30 to 52 mN·m rms, as much as the Coulomb "
                "friction. Scores here are dominated by them and bound a model's error from above only.",
                "The models see the position; what friction owes to load and speed they cannot follow.",
                "Only the swings of rising frequency are in the split: on the other trajectories the servo mostly sticks, "
                "where the torque is not a function of the motion. They are among the recordings.",
                "The temperature rose from 28 to 39 °C in the order of the gains.",
                "bam scores the position error of a simulated servo; a score of the friction torque cannot be compared "
                "with its models M1 to M6.",
                "Nothing is thinned. The noise of the output is that of the duty's steps; the position's is its step / √12.",
            ),
        )


class ServoLog:
    """One log as published, and the terms of the servo's balance of voltages."""

    def __init__(self, document: dict[str, Any]) -> None:
        self.trajectory = str(document["trajectory"])
        self.gain = int(document["kp"])
        entries = document["entries"]
        self.channels = {
            name: np.array([entry[key] for entry in entries], dtype=np.float64)
            for name, key in (
                ("goal_position_rad", "goal_position"), ("speed_rad_s", "speed"), ("pwm_duty", "load"),
                ("supply_v", "input_volts"), ("temperature_c", "temp"),
            )
        }  # fmt: skip
        counts = self.channels["pwm_duty"]
        self.channels["pwm_duty"] = np.where(counts > 32767, counts - 65536, counts) / FULL_DUTY
        time = np.array([entry["timestamp"] for entry in entries])
        self.time = time - time[0]
        self.position = np.array([entry["position"] for entry in entries], dtype=np.float64)
        self.channels["gravity_torque_nm"] = document["mass"] * GRAVITY * document["length"] * np.sin(self.position)
        self.voltage = float(document["vin"]) * self.channels["pwm_duty"]
        grid = np.arange(0.0, self.time[-1] + STEP, STEP)
        even = np.interp(grid, self.time, self.position)
        self.speed, self.acceleration = (
            np.interp(self.time, grid, savgol_filter(even, WINDOW, 3, deriv=order, delta=STEP)) for order in (1, 2)
        )

    @property
    def name(self) -> str:
        return f"{self.trajectory}, gain {self.gain}"

    def moving(self) -> NDArray[np.bool_]:
        keep = np.abs(self.speed) > MOVING
        keep[: WINDOW // 2] = keep[-(WINDOW // 2) :] = False
        return keep

    def terms(self) -> Floats:
        """Gravity torque, acceleration, speed and its sign, shape (n, 4)."""
        return np.column_stack([self.channels["gravity_torque_nm"], self.acceleration, self.speed, np.sign(self.speed)])

    def recording(self, drive: Floats) -> Recording:
        friction = (self.voltage - self.terms()[:, :3] @ drive[:3]) / drive[0]
        # Within half a window of the ends the filter extrapolates.
        inner = slice(WINDOW // 2, -(WINDOW // 2))
        return until_first_turn(
            Recording(
                self.name,
                self.time[inner] - self.time[inner][0],
                self.position[inner],
                friction[inner],
                channels={name: series[inner] for name, series in self.channels.items()},
                conditions={"trajectory": self.trajectory, "position gain": str(self.gain)},
            ),
            0.1,
        )


def drive_constants(logs: Sequence[ServoLog]) -> Floats:
    """Voltage per unit of each of :meth:`ServoLog.terms`, shape (4,)."""
    moving = [log.moving() for log in logs]
    design = np.concatenate([log.terms()[keep] for log, keep in zip(logs, moving, strict=True)])
    voltage = np.concatenate([log.voltage[keep] for log, keep in zip(logs, moving, strict=True)])
    return np.linalg.lstsq(design, voltage, rcond=None)[0]
