"""The parameters of a four-wheel skid-steer vehicle that the local laws need."""

from dataclasses import dataclass


@dataclass(frozen=True, kw_only=True)
class Vehicle:
    """Geometry, inertia and limits, filled from the compiled model by `dynabot_mj.scene`."""

    mass: float  # total [kg]
    wheel_inertia: float  # of one wheel about its axle, rotor included [kg m^2]
    wheel_radius: float  # rolling radius under load [m]
    track: float  # between left and right wheels [m]
    wheelbase: float  # between front and rear axles [m]
    length: float  # of the hull [m]
    breadth: float  # of the hull [m]
    friction: float  # Coulomb coefficient between tyre and ground
    torque_limit: float  # of one motor, by its current limit [Nm]

    @property
    def effective_mass(self) -> float:
        """Mass felt when accelerating straight ahead, the wheels' rotation included [kg]."""
        return self.mass + 4.0 * self.wheel_inertia / self.wheel_radius**2

    @property
    def turning_track(self) -> float:
        """T + L^2 / T: the track that turns a skidding vehicle's wheel-speed difference into its yaw rate [m].

        With all wheels sliding, Coulomb friction turns the vehicle at (v_right - v_left) / (T + L^2 / T) instead of the
        (v_right - v_left) / T of rolling wheels.
        """
        return self.track + self.wheelbase**2 / self.track
