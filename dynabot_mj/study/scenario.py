"""What a study is: the frozen configuration, and what follows from it: cases, periods, fields, radio links.

The defaults reproduce Table III of the paper; those that the paper does not give are one parameter set found to do so,
not an identification. `"auto"` marks a value that follows from others; it stays in the saved file, which therefore
describes the same study when one of those others is changed. `dynabot_mj.study.configuration` reads and writes TOML.
"""

from dataclasses import replace
from typing import Annotated, Literal, get_args

from pydantic import Field
from pydantic.dataclasses import dataclass

from dynabot_mj.common.exceptions import InputError
from dynabot_mj.common.validation import STRICT, Positive
from dynabot_mj.formation import laws
from dynabot_mj.formation.options import CompletionOptions, FieldOptions, StartOptions
from dynabot_mj.perception.options import FilterOptions, FittedOptions, SurrogateOptions
from dynabot_mj.plants.kinds import COMPARED, PlantName
from dynabot_mj.plants.options import VehicleOptions
from dynabot_mj.sensing.options import SensorOptions
from dynabot_mj.study.methods import BUILT_IN, PUBLISHED, Method
from dynabot_mj.testbed import paper, schedule
from dynabot_mj.testbed.options import ProcessorOptions, RadioOptions

PerceptionName = Literal["gauss-markov", "filter", "fitted"]
VelocityName = Literal["auto", "estimate", "truth", "odometry", "reference"]

ESTIMATORS = PUBLISHED
PERCEPTIONS: tuple[PerceptionName, ...] = get_args(PerceptionName)
VELOCITIES: tuple[VelocityName, ...] = get_args(VelocityName)

# By the number of robots: 80 s reproduces Table III; more robots take longer, and in these times more than 95 % of the
# point masses of the slowest row, gps, arrive (docs/measures.md).
DURATIONS = {2: 80.0, 3: 80.0, 4: 100.0, 5: 120.0, 6: 160.0, 7: 240.0}  # [s]; ours


@dataclass(frozen=True, kw_only=True, config=STRICT)
class Scenario:
    """A study: which robots, which methods, how many trials; `configuration.build` makes one from plain values.

    Attributes:
        trials: Of each case.
        first_trial: Number of the first.
        seed: Of all random numbers.
        robots: n, 2 to 7.
        duration: Of a trial [s]; auto: by the number of robots.
        plants: Which there are: point masses, rigid bodies.
        estimators: Which rows of Table III there are.
        perception: What robots believe of themselves.
        velocity: Where the velocity of the dissipation comes from; auto: true where it is exact, else estimated.
        controller: The built-in law, or a function of the user's, `my_module:my_law`.
        mass: Of a particle [kg]; auto: that of the rigid robot.
        collision_distance: Between two centres, below which they have collided [m].
        field: Of the potential.
        start: Where and how robots begin.
        vehicle: Rigid robots and their ground.
        processor: Which the tasks share.
        radio: The messages.
        surrogate: The paper's error.
        completion: How a formation is judged at the end.
        sensors: Their errors and faults.
        filter: Of perception `filter`.
        fitted: Errors of perception `fitted`.
        method: Gains, periods and errors of each estimator.

    Example:
        >>> setup = dy.Scenario(robots=4, plants=("particle",))
        >>> len(dy.cases(setup))
        4
    """

    trials: Annotated[int, Field(ge=1, le=1_000_000)] = paper.TRIALS_TABLE_III
    first_trial: Annotated[int, Field(ge=0, lt=2**31)] = 0  # trials first_trial .. first_trial + trials - 1 are run
    seed: Annotated[int, Field(ge=0, lt=2**63)] = 0
    robots: Annotated[int, Field(ge=2, le=paper.FLEET_SIZE)] = paper.ROBOTS
    # [s]; auto: `DURATIONS`
    duration: Annotated[float, Field(gt=0.0, le=10_000.0, allow_inf_nan=False)] | Literal["auto"] = "auto"
    plants: Annotated[tuple[PlantName, ...], Field(min_length=1)] = COMPARED
    estimators: Annotated[tuple[str, ...], Field(min_length=1)] = ESTIMATORS  # names of methods
    perception: Annotated[tuple[PerceptionName, ...], Field(min_length=1)] = ("gauss-markov",)
    # Of the dissipation. auto: the true one for perfect and gauss-markov, else the estimated one, on both plants alike.
    # odometry (wheels and accelerometer) and reference (of the steering law) exist on the rigid plant only.
    velocity: VelocityName = "auto"
    # Or a function of the user's, `my_module:my_law`, see `dynabot_mj.controllers.law`.
    controller: str = laws.BUILT_IN
    mass: Positive | Literal["auto"] = "auto"  # of a particle [kg]; auto: that of the rigid robot with its payload
    collision_distance: Positive = 0.40  # between two centres, below which they have collided [m]; ours
    field: FieldOptions = FieldOptions()
    start: StartOptions = StartOptions()
    vehicle: VehicleOptions = VehicleOptions()
    processor: ProcessorOptions = ProcessorOptions()
    radio: RadioOptions = RadioOptions()
    surrogate: SurrogateOptions = SurrogateOptions()
    completion: CompletionOptions = CompletionOptions()
    sensors: SensorOptions = SensorOptions()
    filter: FilterOptions = FilterOptions()
    fitted: FittedOptions = FittedOptions()
    method: dict[str, Method] = Field(default_factory=lambda: dict(BUILT_IN))  # by name


@dataclass(frozen=True, kw_only=True)
class Case:
    """One plant with one estimator: what one row of the result table is about.

    Attributes:
        plant: Point masses or rigid bodies.
        perception: What robots believe of themselves; None for the estimator `perfect`.
        estimator: Whose periods, gains and errors they have.

    Example:
        >>> dy.Case(plant="rigid", perception="filter", estimator="coupled").label
        'rigid/filter/coupled'
    """

    plant: PlantName
    perception: PerceptionName | None  # None for the estimator `perfect`
    estimator: str

    @property
    def label(self) -> str:
        """E.g. `particle/gauss-markov/gps` or `rigid/perfect`."""
        return "/".join(part for part in (self.plant, self.perception, self.estimator) if part)


def cases(setup: Scenario) -> list[Case]:
    """Returns the cases of a study, the plants of one method side by side.

    Args:
        setup: The study's configuration.

    Example:
        >>> [case.label for case in dy.cases(dy.build_scenario({"estimators": ["perfect"]}))]
        ['particle/perfect', 'rigid/perfect']
    """
    return [
        Case(plant=plant, perception=perception, estimator=estimator)
        for estimator in dict.fromkeys(setup.estimators)
        for perception in ([None] if estimator == "perfect" else dict.fromkeys(setup.perception))
        for plant in dict.fromkeys(setup.plants)
    ]


def duration(setup: Scenario) -> float:
    """Returns how long a trial lasts [s]."""
    return DURATIONS[setup.robots] if setup.duration == "auto" else setup.duration


def velocity(setup: Scenario, case: Case) -> VelocityName:
    """Returns where the velocity of a case's dissipation comes from."""
    if setup.velocity != "auto":
        return setup.velocity
    return "truth" if case.perception in (None, "gauss-markov") else "estimate"


def method(setup: Scenario, estimator: str) -> Method:
    """Returns the parameters of a row."""
    return setup.method[estimator]


def periods(setup: Scenario, estimator: str) -> tuple[int, int]:
    """Returns the sampling and the control period of a row in whole timer ticks.

    Raises:
        InfeasibleScheduleError: If the processor cannot keep them; `perfect` is outside Eq. 2 and not judged.
        InputError: If a given period is not a whole number of ticks.
    """
    row, processor = method(setup, estimator), setup.processor
    judged = (setup.robots, row.estimation_time)
    if row.sample_period == "auto":
        exact = schedule.period(*judged, processor.utilisation)
        sample_period = schedule.rounded(exact, processor.tick)
    else:
        sample_period = row.sample_period
    control_period = sample_period if row.control_period == "auto" else row.control_period
    ticks = []
    for name, value in (("sample_period", sample_period), ("control_period", control_period)):
        count = round(value / processor.tick)
        if count < 1 or abs(count * processor.tick - value) > 1e-9:
            raise InputError(
                f"method.{estimator}.{name} = {value:g} s given, it must be a whole number of timer ticks "
                f"of {processor.tick:g} s"
            )
        ticks.append(count)
    if estimator != "perfect":
        schedule.require_feasible(*judged, sample_period, control_period, processor.utilisation, processor.tick)
    return ticks[0], ticks[1]


def loads(setup: Scenario) -> dict[str, float]:
    """Returns the load of the processor, Eq. 2, under the periods of each row that is judged by it."""
    found: dict[str, float] = {}
    for estimator in setup.estimators:
        if estimator != "perfect":
            sample_period, control_period = (ticks * setup.processor.tick for ticks in periods(setup, estimator))
            estimation_time = method(setup, estimator).estimation_time
            found[estimator] = schedule.utilisation(setup.robots, estimation_time, sample_period, control_period)
    return found


def one_trial(setup: Scenario, label: str, trial: int) -> Scenario:
    """Returns the study of a single trial of one case.

    Args:
        setup: The study that has it.
        label: Of the case, see `Case.label`.
        trial: Its number.
    """
    case = next(case for case in cases(setup) if case.label == label)
    return replace(
        setup,
        trials=1,
        first_trial=trial,
        plants=(case.plant,),
        estimators=(case.estimator,),
        perception=setup.perception if case.perception is None else (case.perception,),
    )
