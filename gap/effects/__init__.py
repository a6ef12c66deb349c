"""The catalogue: one file an effect.  ``CATALOGUE`` lists them all; a name bears one effect, ``effect("stiction")``."""

from collections.abc import Iterable

from blocks.ports import nearest
from gap.effects.boil_off_rate import BoilOffRate
from gap.effects.compression import Compression
from gap.effects.compressor_fouling import CompressorFouling
from gap.effects.compressor_map_shift import CompressorMapShift
from gap.effects.controller_filter import ControllerFilter
from gap.effects.controller_gain import ControllerGain
from gap.effects.controller_integral_time import ControllerIntegralTime
from gap.effects.controller_limits import ControllerLimits
from gap.effects.dead_time import DeadTime
from gap.effects.deadband import Deadband
from gap.effects.gas_temperature import GasTemperature
from gap.effects.horizontal_separator import HorizontalSeparator
from gap.effects.line_friction import LineFriction
from gap.effects.positioner_lag import PositionerLag
from gap.effects.process_gain import ProcessGain
from gap.effects.process_time_constant import ProcessTimeConstant
from gap.effects.quantisation import Quantisation
from gap.effects.real_gas import RealGas
from gap.effects.recycle_leak import RecycleLeak
from gap.effects.scan_time import ScanTime
from gap.effects.second_lag import SecondLag
from gap.effects.sensor_bias import SensorBias
from gap.effects.sensor_drift import SensorDrift
from gap.effects.sensor_lag import SensorLag
from gap.effects.sensor_noise import SensorNoise
from gap.effects.sensor_saturation import SensorSaturation
from gap.effects.sensor_span import SensorSpan
from gap.effects.shaft_friction import ShaftFriction
from gap.effects.sine_disturbance import SineDisturbance
from gap.effects.slug import Slug
from gap.effects.step_disturbance import StepDisturbance
from gap.effects.stiction import Stiction
from gap.effects.tank_overflow import TankOverflow
from gap.effects.valve_characteristic import ValveCharacteristic
from gap.effects.valve_gain import ValveGain
from gap.effects.valve_leak import ValveLeak
from gap.effects.valve_rate_limit import ValveRateLimit
from gap.effects.valve_saturation import ValveSaturation
from gap.effects.vapour_pressure import VapourPressure
from gap.insertion.effect import Effect, EffectError

CATALOGUE: tuple[Effect, ...] = (
    Stiction(), Deadband(), ValveLeak(), ValveSaturation(), ValveRateLimit(), PositionerLag(), ValveCharacteristic(),
    ValveGain(),
    DeadTime(), ProcessGain(), ProcessTimeConstant(), SecondLag(), TankOverflow(),
    SensorBias(), SensorDrift(), SensorSpan(), SensorLag(), SensorNoise(), Quantisation(), SensorSaturation(),
    Compression(),
    ControllerGain(), ControllerIntegralTime(), ControllerLimits(), ControllerFilter(), ScanTime(),
    SineDisturbance(), StepDisturbance(), Slug(),
    HorizontalSeparator(), BoilOffRate(), VapourPressure(), RealGas(), GasTemperature(),
    CompressorFouling(), CompressorMapShift(), RecycleLeak(), ShaftFriction(), LineFriction(),
)  # fmt: skip


def effect(name: str, catalogue: Iterable[Effect] = CATALOGUE) -> Effect:
    """Return an effect by name; raise ``EffectError`` with the nearest name if there is none.

    >>> effect("dead_time")
    <Effect dead_time at a process: theta [s]>
    """
    known = {one.name: one for one in catalogue}
    if name not in known:
        raise EffectError(f"there is no effect '{name}'; {nearest(name, list(known))}")
    return known[name]
