"""The parameters of a four-wheel skid-steer vehicle that the local laws and their design model need."""

from dataclasses import dataclass

GRAVITY = 9.81  # [m/s^2]


@dataclass(frozen=True, kw_only=True)
class Vehicle:
    """Geometry, inertia, motors and limits, filled from the compiled model by `dynabot_mj.plants.scene`."""

    mass: float  # total, with the payload [kg]
    yaw_inertia: float  # of the whole vehicle about the vertical through its centre of mass [kg m^2]
    mass_centre_height: float  # of the centre of mass above the ground [m]
    mass_centre_forward: float  # of the centre of mass ahead of the chassis' origin [m]
    wheel_inertia: float  # of one wheel about its axle, rotor included [kg m^2]
    wheel_damping: float  # viscous friction of one wheel's bearings [Nm s/rad]
    wheel_radius: float  # rolling radius under load [m]
    track: float  # between left and right wheels [m]
    wheelbase: float  # between front and rear axles [m]
    length: float  # of the hull [m]
    breadth: float  # of the hull [m]
    margin: float  # around the hull, in which contact begins [m]
    friction: float  # Coulomb coefficient between tyre and ground
    resistance: float  # of one motor's winding [ohm]
    torque_constant: float  # of one motor at the wheel; its back-EMF constant too [Nm/A]
    voltage: float  # largest of one motor [V]
    torque_limit: float  # of one motor, by its current limit [Nm]
    servo_gain: float  # of a motor's own speed loop [Nm s/rad]

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

    @property
    def current_limit(self) -> float:
        """Largest current of one motor [A]."""
        return self.torque_limit / self.torque_constant
